//! A robot on four legs, read from a URDF file, stands and then walks: each step gives its servos
//! their targets. As many as are wanted walk side by side in a batch.
//!
//! ```sh
//! cargo run --release -p tumble-scene --example quadruped -- 4096
//! ```

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::time::Instant;

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Axes, Batch, BodyId, Collider, Drive, Drives, Mass, Material, Momentum, Pose, RigidBody, Rng, Shape, Simulation,
    Trial,
};
use tumble_scene::Scene;

const ROBOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/quadruped.urdf");
const LEGS: [&str; 4] = ["front-left", "front-right", "rear-left", "rear-right"];
/// Of thigh and shank \[m\].
const LINK: Real = 0.22;
/// Radius of a foot, which is a ball, and how far the hips are below the torso's frame \[m\].
const FOOT: Real = 0.03;
const HIPS: Real = 0.03;
/// How far it falls to begin with \[m\].
const FALL: Real = 0.02;
/// Angles of hip and knee at rest \[rad\].
const STANCE: [f64; 2] = [-0.5, 1.0];
/// How far a hip swings and a knee lifts \[rad\], and how often \[Hz\].
const SWING: f64 = 0.15;
const LIFT: f64 = 0.3;
const STEPS_PER_SECOND: f64 = 2.5;
/// How long it stands before it walks \[s\].
const STANDS: f64 = 1.0;

/// Where the parts of a robot are in its world.
pub(crate) struct Robot {
    /// Its largest part.
    pub(crate) torso: Entity,
    /// By leg, of hip and knee.
    servos: [[Entity; 2]; 4],
}

impl Robot {
    /// Reads the robot and puts it on the ground, with feet and servos.
    pub(crate) fn spawn(world: &mut World) -> Result<(Self, Simulation), Box<dyn Error>> {
        let mut scene = Scene::open(ROBOT)?;
        scene.settings.contact_substeps = 4;
        let simulation = Simulation::new(scene.settings)?;
        let names = scene.spawn(world)?;
        let bodies: Vec<_> = world.query::<(Entity, &BodyId)>().iter().map(|(it, id)| (it, id.0)).collect();
        let body = |name: &str| bodies.iter().find(|(_, id)| names.of(*id) == name).map(|(body, _)| *body);
        let part = |leg: &str, part: &str| format!("{leg}-{part}");

        // Links of URDF touch nothing by themselves. The frame of a shank is at its knee.
        let material = Material::new(0.8, 0.0);
        for leg in LEGS {
            let shank = body(&part(leg, "shank")).ok_or("the robot has no shank")?;
            let foot = Pose { position: Vec3::Z * -LINK, orientation: Quat::IDENTITY };
            let foot = Collider::new(&Shape::sphere(FOOT))?.with_offset(foot)?.with_material(material)?;
            world.insert_one(shank, foot)?;
        }
        // The ground of a robot is along z: its half space is turned from y.
        let up = Quat::from_rotation_x(PI as Real / 2.0);
        let height = -(HIPS + 2.0 * LINK + FOOT + FALL);
        let ground = RigidBody::new(Shape::Point).fixed().position(Vec3::Z * height).orientation(up);
        ground.build()?.spawn_with(world, (Collider::half_space().with_material(material)?,));

        let mut servos = [[Entity::DANGLING; 2]; 4];
        for (leg, servos) in LEGS.iter().zip(&mut servos) {
            for (servo, name) in servos.iter_mut().zip(["hip", "knee"]) {
                *servo = names.joint(&part(leg, name)).ok_or("the robot has no such joint")?;
                let drive = Drive::position(Axes::ANGULAR_X, 0.0).with_stiffness(200.0, 6.0).with_max_force(80.0);
                world.insert_one(*servo, Drives::from(drive))?;
            }
        }
        Ok((Self { torso: body("torso").ok_or("the robot has no torso")?, servos }, simulation))
    }

    /// Gives the servos their targets for the next step: where these are in its middle, and how
    /// fast they move.
    #[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
    pub(crate) fn drive(&self, Trial { simulation, world }: &mut Trial) -> Result<(), hecs::ComponentError> {
        let (time, dt) = (simulation.time(), f64::from(simulation.settings().dt));
        for (leg, servos) in self.servos.iter().enumerate() {
            let (before, after) = (targets(leg, time), targets(leg, time + dt));
            for (servo, (before, after)) in servos.iter().zip(before.into_iter().zip(after)) {
                let mut drives = world.get::<&mut Drives>(*servo)?;
                drives.0[0].position = Some((0.5 * (before + after)) as Real);
                drives.0[0].velocity = ((after - before) / dt) as Real;
            }
        }
        Ok(())
    }
}

/// Where hip and knee of a leg are to be at a time \[s\]: from straight legs in the stance, then
/// diagonal legs step together.
fn targets(leg: usize, time: f64) -> [f64; 2] {
    let bent = (time / (0.5 * STANDS)).min(1.0);
    let phase = TAU * STEPS_PER_SECOND * (time - STANDS) + if leg == 0 || leg == 3 { 0.0 } else { PI };
    let [swing, lift] = if time < STANDS { [0.0; 2] } else { [SWING * phase.sin(), LIFT * phase.cos()] };
    [bent * STANCE[0] + swing - 0.5 * lift, bent * STANCE[1] + lift]
}

/// A robot, pushed a little.
pub(crate) fn trial(rng: &mut Rng) -> Result<(Robot, Trial), Box<dyn Error>> {
    let mut world = World::new();
    let (robot, simulation) = Robot::spawn(&mut world)?;
    let mass = world.get::<&Mass>(robot.torso)?.kilograms();
    world.get::<&mut Momentum>(robot.torso)?.linear = rng.vector(-0.2, 0.2) * mass;
    Ok((robot, Trial { simulation, world }))
}

fn main() -> Result<(), Box<dyn Error>> {
    let count: usize = std::env::args().nth(1).map_or(Ok(1), |count| count.parse())?;
    if count == 0 {
        return Err("at least one robot has to walk".into());
    }
    let mut robots = Vec::with_capacity(count);
    let mut batch = Batch::new();
    for index in 0..count {
        let (robot, trial) = trial(&mut Rng::stream(1, index as u64))?;
        robots.push(robot);
        batch.push(trial);
    }
    let begin = Instant::now();
    for _ in 0..600 {
        batch.map(|index, trial| robots[index].drive(trial)).into_iter().collect::<Result<(), _>>()?;
        batch.step_many(1);
    }
    let seconds = begin.elapsed().as_secs_f64();
    let ends = batch.map(|index, trial| trial.world.get::<&Pose>(robots[index].torso).map(|pose| *pose));
    let (mut upright, mut ways) = (0, Vec::with_capacity(count));
    for pose in ends {
        let pose = pose?;
        upright += usize::from((pose.orientation * Vec3::Z).z > 0.9);
        ways.push(pose.position.x);
    }
    ways.sort_by(Real::total_cmp);
    println!("{upright} of {count} robots stand after 10 s, and have walked {} m in the median", ways[count / 2]);
    println!("{:.0} steps of a robot a second", 600.0 * count as f64 / seconds);
    Ok(())
}
