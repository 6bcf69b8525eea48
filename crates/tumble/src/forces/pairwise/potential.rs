//! Potential energy of springs between bodies and of mutual gravity.

use hecs::{View, World};
use rayon::prelude::*;

use crate::components::{Mass, Momentum, Pose, Wrench};
use crate::forces::pairwise::{GravityMass, Spring};
use crate::math::{Vec3, dquat, dvec3};
use crate::storage::body_order::BodyOrder;
use crate::threads::InParts;

/// Fewest pairs of masses that are worth handing to another thread: they take some ten
/// microseconds.
const PAIRS: usize = 4096;

/// The energy of springs between bodies and of gravity among them \[J\], in double precision;
/// bodies whose pose is not finite are left out.
pub(crate) fn potential(world: &World, order: &BodyOrder) -> f64 {
    if !crate::forces::pairwise::are_in(world) {
        return 0.0;
    }
    let mut query = world.query::<&Pose>();
    let poses = query.view();
    // The sum of energies of springs is to have the same bits wherever they lie.
    let mut springs: Vec<f64> = world.query::<&Spring>().iter().filter_map(|spring| energy(&poses, spring)).collect();
    springs.sort_unstable_by(f64::total_cmp);
    springs.iter().sum::<f64>() + gravity(world, order)
}

fn energy(poses: &View<'_, &Pose>, spring: &Spring) -> Option<f64> {
    let [a, b] = spring.bodies;
    let end = |body, attachment| point(poses.get(body)?, attachment);
    let difference = end(b, spring.attachments[1])? - end(a, spring.attachments[0])?;
    let elongation = difference.length() - f64::from(spring.rest_length);
    (a != b).then_some(0.5 * f64::from(spring.stiffness) * elongation * elongation)
}

fn point(pose: &Pose, attachment: Vec3) -> Option<glam::DVec3> {
    let point = dvec3(pose.position) + dquat(pose.orientation).normalize() * dvec3(attachment);
    point.is_finite().then_some(point)
}

/// Half of what each body's mass has in the fields of the others; whole for a pair of which only
/// one feels the other.
fn gravity(world: &World, order: &BodyOrder) -> f64 {
    let mut query = world.query::<(&Pose, &GravityMass, Option<&Mass>, hecs::Satisfies<(&Momentum, &Wrench)>)>();
    let bodies = query.view();
    let masses: Vec<(glam::DVec3, f64, f64, f64)> = order
        .entities()
        .iter()
        .filter_map(|&entity| {
            let (pose, gravity, mass, moves) = bodies.get(entity)?;
            let position = point(pose, Vec3::ZERO)?;
            let mass = mass.filter(|_| moves).map_or(0.0, |mass| f64::from(mass.kilograms()));
            Some((position, mass, f64::from(gravity.mu), f64::from(gravity.softening).powi(2)))
        })
        .collect();
    // Each body with those before it, and then body after body: the order of the sum does not
    // depend on threads.
    let parts = masses.par_iter().enumerate().by_at_least(PAIRS.div_ceil(masses.len().max(1)));
    let sums: Vec<f64> = parts.map(|(i, mass)| gravity_with(mass, &masses[..i])).collect();
    sums.iter().sum()
}

/// The energy of a mass with others.
fn gravity_with(
    &(x, mass, mu, softening): &(glam::DVec3, f64, f64, f64),
    others: &[(glam::DVec3, f64, f64, f64)],
) -> f64 {
    let mut sum = 0.0;
    for &(other_x, other_mass, other_mu, other_softening) in others {
        let distance = (x.distance_squared(other_x) + softening + other_softening).sqrt();
        // The two are equal where mu is in proportion to mass; a body without a field, or one that
        // nothing moves, has energy with the other all the same.
        let strengths = [mass * other_mu, other_mass * mu];
        let is_one_sided = strengths.contains(&0.0);
        let strength = strengths.iter().sum::<f64>() * if is_one_sided { 1.0 } else { 0.5 };
        if distance > 0.0 {
            sum -= strength / distance;
        }
    }
    sum
}
