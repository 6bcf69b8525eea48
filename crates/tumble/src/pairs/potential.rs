use hecs::{EntityRef, World};

use super::{GravityMass, Spring};
use crate::body_order::BodyOrder;
use crate::components::{Mass, Momentum, Pose, Wrench};
use crate::math::{Vec3, dquat, dvec3};

/// The energy of springs between bodies and of gravity among them \[J\], in double precision; bodies whose pose is not finite are left out.
pub(crate) fn potential(world: &World, order: &BodyOrder) -> f64 {
    if !super::are_in(world) {
        return 0.0;
    }
    // The sum of energies of springs is to have the same bits wherever they lie.
    let mut springs: Vec<f64> = world.query::<&Spring>().iter().filter_map(|spring| energy(world, spring)).collect();
    springs.sort_unstable_by(f64::total_cmp);
    springs.iter().sum::<f64>() + gravity(world, order)
}

fn energy(world: &World, spring: &Spring) -> Option<f64> {
    let [a, b] = spring.bodies;
    let end = |body, attachment| point(world.entity(body).ok()?, attachment);
    let difference = end(b, spring.attachments[1])? - end(a, spring.attachments[0])?;
    let elongation = difference.length() - f64::from(spring.rest_length);
    (a != b).then_some(0.5 * f64::from(spring.stiffness) * elongation * elongation)
}

fn point(body: EntityRef<'_>, attachment: Vec3) -> Option<glam::DVec3> {
    let pose = body.get::<&Pose>().map(|pose| *pose)?;
    let point = dvec3(pose.position) + dquat(pose.orientation).normalize() * dvec3(attachment);
    point.is_finite().then_some(point)
}

/// Half of what each body's mass has in the fields of the others; whole for a pair of which only one feels the other.
fn gravity(world: &World, order: &BodyOrder) -> f64 {
    let masses: Vec<(glam::DVec3, f64, f64, f64)> = order
        .entities()
        .iter()
        .filter_map(|&entity| {
            let body = world.entity(entity).ok()?;
            let gravity = *body.get::<&GravityMass>()?;
            let position = point(body, Vec3::ZERO)?;
            let moves = body.has::<Momentum>() && body.has::<Wrench>();
            let mass = body.get::<&Mass>().filter(|_| moves).map_or(0.0, |mass| f64::from(mass.kilograms()));
            Some((position, mass, f64::from(gravity.mu), f64::from(gravity.softening).powi(2)))
        })
        .collect();
    let mut sum = 0.0;
    for (i, &(x, mass, mu, softening)) in masses.iter().enumerate() {
        for &(other_x, other_mass, other_mu, other_softening) in &masses[..i] {
            let distance = (x.distance_squared(other_x) + softening + other_softening).sqrt();
            // The two are equal where mu is in proportion to mass; a body without a field, or one that nothing moves, has energy with the other all the same.
            let strengths = [mass * other_mu, other_mass * mu];
            let is_one_sided = strengths.contains(&0.0);
            let strength = strengths.iter().sum::<f64>() * if is_one_sided { 1.0 } else { 0.5 };
            if distance > 0.0 {
                sum -= strength / distance;
            }
        }
    }
    sum
}
