//! Promise: `Drag` takes energy away, however strong it is and however differently along the axes
//! of the body.
//!
//! Why: light things in a storm are the first to explode under an explicit force. It fails if the
//! limit of a kick is put on the force as a whole: then a strong axis overshoots while the others
//! carry the speed.

use hecs::World;
use tumble::Integrator::{MoserVeselov, SemiImplicitEuler};
use tumble::math::Vec3;
use tumble::{BodyOrder, Drag, RigidBody, Shape, Totals};
use tumble_tests::{EPSILON, weightless};

/// A leaf that slips sideways, and a rod that turns end over end, far past where an explicit
/// force would explode. Rounding may add what a handful of operations do.
#[test]
fn drag_of_any_strength_takes_energy() {
    for integrator in [SemiImplicitEuler, MoserVeselov] {
        let leaf = RigidBody::new(Shape::cuboid([0.05, 0.05, 0.001]))
            .without_collider()
            .mass(0.1)
            .linear_velocity(Vec3::new(0.3, 10.0, 0.0));
        let rod = RigidBody::new(Shape::cylinder(0.01, 1.0))
            .without_collider()
            .mass(1.0)
            .angular_velocity(Vec3::new(10.0, 0.1, 0.0));
        // The first-order method gives a turning body energy of its own.
        let turning = (integrator == MoserVeselov).then_some(rod);
        for body in std::iter::once(leaf).chain(turning) {
            let mut world = World::new();
            let entity = body.build().unwrap().spawn(&mut world);
            let drag = Drag { linear: Vec3::new(100.0, 0.0, 0.0), angular: Vec3::new(1.0, 1.0, 0.0) };
            world.insert_one(entity, drag).unwrap();
            let mut simulation = weightless(integrator, 1.0 / 60.0);
            let mut before = f64::INFINITY;
            for step in 0..600 {
                let totals = Totals::of(&world, simulation.settings(), &BodyOrder::of(&world));
                let kinetic = totals.kinetic();
                assert!(
                    kinetic <= before * (1.0 + 8.0 * EPSILON),
                    "{integrator}, step {step}: {kinetic} after {before}"
                );
                before = kinetic;
                simulation.step(&mut world);
            }
        }
    }
}
