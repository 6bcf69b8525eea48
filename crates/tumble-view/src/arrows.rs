//! How long arrows are.

use hecs::{Entity, World};
use tumble::glam::DVec3;
use tumble::math::{Real, Vec3};
use tumble::{ConstantWrench, DebugView, Momentum, Simulation, Thruster, Velocity, Wrench};

use crate::convert::{dvec3, real};
use crate::layers::{Layer, Layers};

/// In each picture what is remembered of the largest force of contacts is this part of what it was:
/// a second later little is left of it.
const FADING: f64 = 0.96;
/// Width of the cross at a point of contact, to the length of the largest arrow.
const CROSS: f64 = 0.12;

/// The largest of each kind of vector that was drawn since the start, so that arrows of one kind
/// can be compared, over bodies and over time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Largest {
    /// [kg m/s]
    momentum: f64,
    /// [kg m^2/s]
    angular_momentum: f64,
    /// [rad/s]
    angular_velocity: f64,
    /// Forces \[N\] and torques [N m], which have arrows of one scale.
    force: f64,
    /// At a point of contact \[N\]. It fades, for a hit may be a hundred times what the body
    /// weighs.
    contact_force: f64,
}

impl Largest {
    /// Takes in how things stand.
    pub(crate) fn look(&mut self, world: &World) {
        for momentum in &mut world.query::<&Momentum>() {
            grow(&mut self.momentum, dvec3(momentum.linear));
            grow(&mut self.angular_momentum, dvec3(momentum.angular));
        }
        for velocity in &mut world.query::<&Velocity>() {
            grow(&mut self.angular_velocity, dvec3(velocity.angular));
        }
        for wrench in &mut world.query::<&Wrench>() {
            grow(&mut self.force, dvec3(wrench.force));
            grow(&mut self.force, dvec3(wrench.torque));
        }
        for constant in &mut world.query::<&ConstantWrench>() {
            grow(&mut self.force, dvec3(constant.force));
            grow(&mut self.force, dvec3(constant.torque));
        }
        for thruster in &mut world.query::<&Thruster>() {
            grow(&mut self.force, dvec3(thruster.force * thruster.throttle));
            grow(&mut self.force, dvec3(thruster.torque * thruster.throttle));
        }
    }

    /// Takes in what pushes bodies apart; to be called once for each picture.
    pub(crate) fn look_at_contacts(&mut self, simulation: &Simulation) {
        self.contact_force *= FADING;
        let substep = f64::from(simulation.settings().contact_substep());
        for contact in simulation.contacts() {
            for point in contact.points() {
                grow(&mut self.contact_force, dvec3(contact.normal) * (f64::from(point.impulse) / substep));
            }
        }
    }

    /// What the engine is to draw; the largest arrow of each kind has this length \[m\].
    pub(crate) fn view(&self, layers: Layers, length: f64, alpha: Real) -> DebugView {
        let scale = |layer, largest: f64, part: f64| {
            let scale = real(part * length / largest);
            (layers.has(layer) && largest > 0.0 && scale.is_finite()).then_some(scale)
        };
        DebugView {
            ellipsoids: layers.has(Layer::Ellipsoids),
            axes: layers.has(Layer::Axes).then_some(real(0.8 * length)),
            momentum: scale(Layer::Momentum, self.momentum, 1.0),
            // Not the same, for the two are parallel where a body spins about an axis of its own.
            angular_momentum: scale(Layer::AngularMomentum, self.angular_momentum, 1.15),
            angular_velocity: scale(Layer::AngularVelocity, self.angular_velocity, 0.9),
            forces: scale(Layer::Forces, self.force, 1.0),
            contacts: layers.has(Layer::Contacts).then_some(real(CROSS * length)),
            contact_forces: scale(Layer::Contacts, self.contact_force, 1.0),
            alpha,
            ..DebugView::nothing()
        }
    }
}

fn grow(largest: &mut f64, vector: DVec3) {
    let length = vector.length();
    if length.is_finite() {
        *largest = largest.max(length);
    }
}

/// Arrows of moving bodies are this long \[m\], of bodies that reach so far, in a frame of this
/// radius.
pub(crate) fn length(reaches: impl Iterator<Item = f64>, radius: f64) -> f64 {
    let mut reaches: Vec<f64> = reaches.collect();
    reaches.sort_by(f64::total_cmp);
    let typical = reaches.get(reaches.len() / 2).copied().unwrap_or(0.0);
    // Bodies that are small beside the distances between them are drawn larger than they are.
    (1.7 * typical).max(0.06 * radius)
}

/// Calls with what acts on every body in its [`Wrench`], and leaves the world as it was.
///
/// A step sums up gravity in the wrench, uses it and sets it to zero, so it would never be seen.
pub(crate) fn with_forces(world: &mut World, gravity: Vec3, look: impl FnOnce(&World)) {
    let before: Vec<(Entity, Wrench)> =
        world.query_mut::<(Entity, &Wrench)>().into_iter().map(|(entity, wrench)| (entity, *wrench)).collect();
    tumble::accumulate_forces(world, gravity);
    look(world);
    for (entity, wrench) in before {
        if let Ok(mut now) = world.get::<&mut Wrench>(entity) {
            *now = wrench;
        }
    }
}

#[cfg(test)]
mod tests {
    use tumble::Collider;
    use tumble::prelude::*;

    use super::*;

    fn spinning() -> World {
        let mut world = World::new();
        let shape = Shape::cuboid([0.1, 0.2, 0.3]);
        let body = RigidBody::new(shape)
            .without_collider()
            .mass(2.0)
            .linear_velocity(Vec3::X * 3.0)
            .angular_velocity(Vec3::Y * 4.0);
        body.build().unwrap().spawn(&mut world);
        world
    }

    #[test]
    fn the_largest_arrow_has_the_length_asked_for() {
        let (world, mut largest) = (spinning(), Largest::default());
        largest.look(&world);
        let view = largest.view(Layers::of([Layer::Momentum, Layer::AngularVelocity]), 1.5, 1.0);
        // 6 kg m/s and 4 rad/s; a rounding of single precision.
        assert!((f64::from(view.momentum.unwrap()) * 6.0 - 1.5).abs() < 1e-6);
        assert!((f64::from(view.angular_velocity.unwrap()) * 4.0 - 0.9 * 1.5).abs() < 1e-6);
        assert_eq!((view.angular_momentum, view.axes, view.forces), (None, None, None));
        // What there is none of has no scale.
        assert_eq!(Largest::default().view(Layers::of([Layer::Momentum]), 1.0, 1.0).momentum, None);
    }

    #[test]
    fn gravity_is_seen_and_the_world_left_alone() {
        let mut world = spinning();
        let mut largest = Largest::default();
        with_forces(&mut world, Settings::default().gravity, |world| largest.look(world));
        assert!((largest.force - 2.0 * 9.81).abs() < 1e-5, "{}", largest.force);
        assert!(world.query_mut::<&Wrench>().into_iter().all(|wrench| *wrench == Wrench::default()));
    }

    /// The ball hits at about 4 m/s, and is stopped in a step of 1/60 s: some 25 times as hard as
    /// it lies there.
    #[test]
    fn a_hit_is_forgotten_in_a_second_or_two() {
        let mut world = World::new();
        let shape = Shape::sphere(0.5);
        let collider = Collider::new(&shape).unwrap();
        RigidBody::new(Shape::Point).fixed().build().unwrap().spawn_with(&mut world, (Collider::half_space(),));
        let ball = RigidBody::new(shape).mass(2.0).position(Vec3::Y * 1.4).build().unwrap();
        ball.spawn_with(&mut world, (collider,));
        let mut simulation = Simulation::new(Settings::default().with_contact_substeps(1)).unwrap();
        let (mut largest, mut hardest) = (Largest::default(), 0.0);
        let weight = 2.0 * 9.81;
        for _ in 0..240 {
            simulation.step(&mut world);
            largest.look_at_contacts(&simulation);
            hardest = f64::max(hardest, largest.contact_force);
        }
        assert!(hardest > 10.0 * weight, "{hardest}");
        // What the ground pushes with is exact to some parts in a million.
        assert!((largest.contact_force / weight - 1.0).abs() < 1e-4, "{}", largest.contact_force);
        let view = largest.view(Layers::of([Layer::Contacts]), 1.5, 1.0);
        assert!((f64::from(view.contact_forces.unwrap()) * weight - 1.5).abs() < 1e-3);
        assert_eq!((view.contacts, view.forces), (Some(real(CROSS * 1.5)), None));
    }

    #[test]
    fn arrows_are_seen_in_a_large_frame() {
        assert_eq!(length([0.1, 1.0, 0.5].into_iter(), 2.0), 0.85);
        assert_eq!(length([0.01].into_iter(), 1e12), 6e10);
        assert_eq!(length(std::iter::empty(), 1.0), 0.06);
    }
}
