//! Forces on a body now, by source, with the laws and contacts of a simulation.

use hecs::{Entity, World};

use crate::collision::contact::ContactRecord;
use crate::collision::pipeline::CollisionPipeline;
use crate::components::Wrench;
use crate::forces::body_forces::BodyForces;
use crate::forces::pairwise::between_bodies::forces_between_bodies;
use crate::integrators::state::moving_body;
use crate::math::{Real, Vec3};
use crate::solver::contact::round_contacts::point_weight;
use crate::step::simulation::Simulation;

impl Simulation {
    /// The forces on a body in its state now, by source; `None` for an entity
    /// that is no dynamic body.
    ///
    /// Contacts are those of the last step, and what they give is the mean over its last
    /// [`contact_substep`](crate::Settings::contact_substep), or the last of the shorter ones that
    /// a stack may take: an impact before it is not in it. Springs are as stiff as they were given,
    /// not as their step allows. Force laws are evaluated at the simulation's time.
    ///
    /// To be asked between steps: between the phases of one the [`Wrench`] holds gravity too. After
    /// a restore the impulses of contacts are taken for those of substeps of these settings.
    ///
    /// ```
    /// use tumble::prelude::*;
    ///
    /// let mut world = hecs::World::new();
    /// spawn_ground(&mut world);
    /// let stone = RigidBody::new(Shape::cuboid([0.5, 0.5, 0.5]))
    ///     .mass(2.0)
    ///     .position(Vec3::Y * 0.5)
    ///     .build()?
    ///     .spawn(&mut world);
    ///
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step_many(&mut world, 60);
    /// let forces = simulation.forces(&world, stone).ok_or("not a moving body")?;
    /// assert_eq!(forces.gravity.force, Vec3::Y * -19.62);
    /// assert!((forces.contacts.force.y - 19.62).abs() < 1e-2);
    /// assert!(forces.total().force.length() < 1e-2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn forces(&self, world: &World, entity: Entity) -> Option<BodyForces> {
        let body = world.entity(entity).ok()?;
        let (constants, state) = moving_body(body).filter(|_| body.has::<Wrench>())?;
        let mut forces = BodyForces::of(body, self.settings(), (self.laws(), self.time()), (&constants, &state));
        if let [pull] = &forces_between_bodies(world, &[entity], &[state])[..] {
            forces.add_between_bodies(pull);
        }
        if let Some(collision) = self.collision() {
            let impulse = collision.impulse_on(entity);
            let known = Some(collision.contacts.substep).filter(|substep| *substep > 0.0);
            let rate = 1.0 / known.unwrap_or(self.settings().contact_substep());
            forces.contacts = Wrench { force: impulse.force * rate, torque: impulse.torque * rate };
        }
        Some(forces)
    }
}

impl CollisionPipeline {
    /// Sum over a body's contacts: impulse \[N s\], angular impulse about the centre of mass
    /// [N m s].
    fn impulse_on(&self, entity: Entity) -> Wrench {
        let mut sum = Wrench::default();
        for contact in &self.contacts.records {
            for (which, slot) in contact.slots.into_iter().enumerate() {
                if self.cache.body_keys.entity(slot) == entity {
                    let [first, second] = contact.slots.map(|slot| Vec3::from(self.center(slot)));
                    let arm = if which == 0 { contact.apart((second - first).into()).into() } else { Vec3::ZERO };
                    let sign = if which == 0 { -1.0 } else { 1.0 };
                    sum.add(impulse_on_second(contact, arm, sign));
                }
            }
        }
        sum
    }
}

/// Impulse and angular impulse of a contact, times `sign`, about the point from which the second
/// body's centre of mass is at `arm` \[m\].
fn impulse_on_second(contact: &ContactRecord, arm: Vec3, sign: Real) -> Wrench {
    let normal = Vec3::from(contact.geometry.normal);
    let (friction, twist) = (Vec3::from(contact.friction.linear), Vec3::from(contact.friction.angular));
    let mut impulse = Wrench { force: Vec3::ZERO, torque: twist * sign };
    let place = |j: usize| -> Vec3 { arm + Vec3::from(contact.place(j)) };
    for j in 0..contact.count() {
        let along_normal = normal * (contact.normal_impulses.at_points[j] * sign);
        impulse.add_force_at(along_normal, place(j), Vec3::ZERO);
    }
    impulse.add_force_at(friction * sign, arm + middle(contact), Vec3::ZERO);
    impulse
}

/// Where friction acts, from the second body's centre of mass \[m\], as
/// [`Prepare`](crate::solver::contact::prepare::Prepare) has it.
fn middle(contact: &ContactRecord) -> Vec3 {
    let nearest = (0..contact.count()).map(|j| contact.separation(j)).fold(Real::INFINITY, Real::min).max(0.0);
    let from = if contact.is_body_fixed() { 0.0 } else { nearest };
    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
    for j in 0..contact.count() {
        let margins = (contact.separation(j) - from) / contact.margin();
        let weight = point_weight(margins);
        sum += Vec3::from(contact.place(j)) * weight;
        total += weight;
    }
    sum / total
}
