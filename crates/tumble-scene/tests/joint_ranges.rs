//! Promise: a range of angles stops a joint where its file says, also beyond half a turn, in scene
//! files, robots and glTF files alike; a range of a turn or more stops nothing.
//!
//! Why: angles are read from -pi to pi, so a bound beyond has to be met by what comes round to it.
//! A reader that cuts it, or turns it back by a turn, stops an arm too early or at once.
#![allow(clippy::useless_conversion, clippy::unnecessary_cast, reason = "Real is f64 in one of the two builds")]

use std::f64::consts::{PI, TAU};

use hecs::{Entity, World};
use proptest::prelude::*;
use tumble::math::{Real, Vec3};
use tumble::{Axes, Drive, Drives, Joint, JointLoad, Simulation};
use tumble_scene::Scene;

use crate::precision::by_precision;

/// How fast a joint is driven [rad/s].
const SPEED: f64 = 3.0;

/// A wheel about z on what stands still, in each of the formats.
fn scenes([min, max]: [f64; 2]) -> [Result<Scene, String>; 3] {
    let scene = format!(
        r#"{{ "bodies": [ {{ "name": "base", "fixed": true }}, {{ "name": "wheel", "shape": {{ "sphere": {{ "radius": 0.3 }} }}, "mass": 2 }} ],
        "joints": [ {{ "between": ["base", "wheel"], "hinge": {{ "at": [0, 0, 0], "axis": [0, 0, 1] }}, "limits": {{ "angular_x": [{min}, {max}] }} }} ] }}"#
    );
    let robot = format!(
        r#"<robot name="r"><link name="world"/><link name="wheel"><inertial><mass value="2"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
        <joint name="axle" type="revolute"><parent link="world"/><child link="wheel"/><axis xyz="0 0 1"/>
        <limit lower="{min}" upper="{max}" effort="1" velocity="1"/></joint></robot>"#
    );
    let gltf = format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [ {{ "nodes": [0, 1] }} ], "nodes": [
        {{ "name": "base", "extensions": {{ "KHR_physics_rigid_bodies": {{ "joint": {{ "connectedNode": 1, "joint": 0 }} }} }} }},
        {{ "name": "wheel", "extensions": {{ "KHR_physics_rigid_bodies": {{ "motion": {{ "mass": 2, "inertiaDiagonal": [0.1, 0.1, 0.1] }} }} }} }} ],
        "extensions": {{ "KHR_physics_rigid_bodies": {{ "physicsJoints": [ {{ "limits": [ {{ "linearAxes": [0, 1, 2], "max": 0 }},
        {{ "angularAxes": [0, 1], "max": 0 }}, {{ "angularAxes": [2], "min": {min}, "max": {max} }} ] }} ] }} }} }}"#
    );
    let scenes = [
        Scene::from_json(&scene, "a.json"),
        Scene::from_urdf(&robot, "a.urdf"),
        Scene::from_gltf(gltf.as_bytes(), "a.gltf"),
    ];
    scenes.map(|scene| scene.map_err(|error| error.to_string()))
}

/// A wheel whose turns are counted.
struct Wheel {
    world: World,
    simulation: Simulation,
    joint: Entity,
    /// Of its angle in [`JointLoad::values`].
    axis: usize,
    angle: f64,
}

impl Wheel {
    fn of(scene: Scene) -> Self {
        let simulation = Simulation::new(scene.settings.with_gravity(Vec3::ZERO)).unwrap();
        let mut world = World::new();
        scene.spawn(&mut world).unwrap();
        let (joint, free) =
            world.query::<(Entity, &Joint)>().iter().map(|(it, joint)| (it, joint.free)).next().unwrap();
        let axis = (3..6).find(|axis| free.contains(Axes::EACH[*axis])).unwrap();
        Self { world, simulation, joint, axis, angle: 0.0 }
    }

    /// Drives it one way for the time in which it makes this angle if nothing stops it, and returns
    /// the least and the greatest angle on the way.
    fn drive(&mut self, by: f64) -> [f64; 2] {
        let motor = Drive::velocity(Axes::EACH[self.axis], (SPEED * by.signum()) as Real).with_max_force(20.0);
        self.world.insert_one(self.joint, Drives::from(motor)).unwrap();
        let mut on_the_way = [self.angle; 2];
        for _ in 0..(by.abs() / SPEED * 60.0).ceil() as u32 {
            self.simulation.step(&mut self.world);
            let read = f64::from(self.world.get::<&JointLoad>(self.joint).unwrap().values[self.axis]);
            let change = read - self.angle;
            self.angle += change - TAU * (change / TAU).round();
            on_the_way = [on_the_way[0].min(self.angle), on_the_way[1].max(self.angle)];
        }
        on_the_way
    }
}

/// Less than a turn, with zero inside and one bound beyond half a turn.
fn range() -> impl Strategy<Value = [f64; 2]> {
    (PI + 0.05..TAU - 0.4, 0.1..1.0, any::<bool>()).prop_map(|(far, near, is_mirrored)| {
        let near = near * (TAU - 0.2 - far);
        if is_mirrored { [-far, near] } else { [-near, far] }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_joint_stops_at_bounds_beyond_half_a_turn(range in range(), first: bool) {
        let [min, max] = range;
        for scene in scenes(range) {
            let scene = scene.unwrap();
            let origin = scene.origin.clone();
            let mut wheel = Wheel::of(scene);
            // Long enough for one and a half turns.
            let ways = if first { [TAU, -1.5 * TAU, 1.5 * TAU] } else { [-TAU, 1.5 * TAU, -1.5 * TAU] };
            for by in ways {
                let [least, most] = wheel.drive(by);
                let bound = if by > 0.0 { max } else { min };
                // Bounds are met to the rounding of angles of two turns.
                let slack = by_precision(2e-5, 1e-9);
                prop_assert!(least > min - slack && most < max + slack, "{}: {} {} of {:?}", origin, least, most, range);
                prop_assert!((wheel.angle - bound).abs() < slack, "{}: {} of {:?}", origin, wheel.angle, range);
            }
        }
    }

    /// What a robot or a glTF file gives as endless goes round; a scene file is refused, as it
    /// could leave the range out.
    #[test]
    fn a_range_of_a_turn_or_more_stops_nothing(min in -9.0..-0.1, more in 0.01..5.0) {
        let [scene, robot, gltf] = scenes([min, min + TAU + more]);
        let problem = "a.json: field joints[0].limits.angular_x: is a range of more than a turn, which bounds nothing";
        prop_assert_eq!(scene.unwrap_err(), problem);
        for scene in [robot.unwrap(), gltf.unwrap()] {
            let mut wheel = Wheel::of(scene);
            wheel.drive(2.0 * TAU);
            // It took a while to come to its speed.
            prop_assert!(wheel.angle > 1.8 * TAU, "{}", wheel.angle);
        }
    }
}
