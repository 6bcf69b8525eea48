//! Promise: a robot read from a URDF file stands on its servos and walks by the targets that they
//! are given, in the direction of its gait, whatever it is pushed with; in a batch it does so to
//! the bit as alone. The scene `walker` walks by drives that oscillate.
//!
//! Why: that is what robots are for. It fails if a servo's sign is wrong, feet slip or sink, or
//! joints of a batch are mixed up.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{Batch, BodyId, Pose, Rng, Simulation, Trial};
use tumble_scene::Scene;

#[path = "../examples/quadruped.rs"]
#[allow(dead_code, reason = "its main program is not run here")]
mod quadruped;

fn walk(trial: &mut Trial, robot: &quadruped::Robot, until: f64) {
    while trial.simulation.time() < until {
        robot.drive(trial).unwrap();
        trial.step_many(1);
    }
}

#[test]
fn a_robot_from_a_file_stands_and_walks() {
    for case in 0..8 {
        let (robot, mut trial) = quadruped::trial(&mut Rng::stream(7, case)).unwrap();
        let torso = |trial: &Trial| *trial.world.get::<&Pose>(robot.torso).unwrap();
        walk(&mut trial, &robot, 1.0);
        let stance = torso(&trial);
        walk(&mut trial, &robot, 6.0);
        let end = torso(&trial);
        let along = stance.orientation * Vec3::X;
        let way = (end.position - stance.position).dot(along);
        let ups = [stance, end].map(|pose| (pose.orientation * Vec3::Z).z);
        println!("case {case}: {way} m, up {ups:?}, sunk {}", stance.position.z - end.position.z);
        // A foot on the ground goes back by 6.6 cm, five times a second.
        assert!((way / (5.0 * 5.0 * 0.066) - 1.0).abs() < 0.1, "{way}");
        assert!(ups.iter().all(|up| *up > 0.97), "{ups:?}");
        assert!((stance.position.z - end.position.z).abs() < 0.03);
    }
}

#[test]
fn robots_of_a_batch_walk_as_alone() {
    let (mut batch, mut robots, mut alone) = (Batch::new(), Vec::new(), Vec::new());
    for index in 0..5 {
        let (robot, mut trial) = quadruped::trial(&mut Rng::stream(8, index)).unwrap();
        walk(&mut trial, &robot, 1.5);
        alone.push(trial.state_hash());
        let (robot, trial) = quadruped::trial(&mut Rng::stream(8, index)).unwrap();
        robots.push(robot);
        batch.push(trial);
    }
    while batch.trials()[0].simulation.time() < 1.5 {
        batch.map(|index, trial| robots[index].drive(trial).unwrap());
        batch.step_many(1);
    }
    assert_eq!(batch.map(|_, trial| trial.state_hash()), alone);
}

/// With the same gait, which its servos follow less closely.
#[test]
fn the_walker_walks() {
    let scene = Scene::open("walker").unwrap();
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut world = World::new();
    let names = scene.spawn(&mut world).unwrap();
    let torso = world.query::<(hecs::Entity, &BodyId)>().iter().find(|(_, id)| names.of(id.0) == "torso").unwrap().0;
    let pose = |world: &World| *world.get::<&Pose>(torso).unwrap();
    let start = pose(&world);
    let mut lowest_up: Real = 1.0;
    while simulation.time() < 10.0 {
        simulation.step(&mut world);
        lowest_up = lowest_up.min((pose(&world).orientation * Vec3::Y).y);
    }
    let way = pose(&world).position - start.position;
    println!("{way}, up {lowest_up}");
    assert!(way.x > 2.5 && way.x < 5.0 && way.z.abs() < 1.0 && way.y.abs() < 0.05, "{way}");
    assert!(lowest_up > 0.98, "{lowest_up}");
}
