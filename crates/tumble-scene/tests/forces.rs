//! Promise: each force of a scene file becomes the engine's component with the same numbers,
//! whichever format it is written in.
//!
//! Why: a default that differs from what the documentation says, or a point that is taken from
//! another origin, makes a simulation that is wrong and looks right.

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    AngularVelocityServo, BodyId, Buoyancy, ConstantWrench, Damping, Drag, Frame, GravityMass, GravityScale, Hull,
    Magnus, PointGravity, Spring, SpringToPoint, Thruster, Wind,
};
use tumble_scene::{Audit, Force, RunOverrides, Scene, SceneTemplate};

const JSON: &str = r#"{ "bodies": [ { "name": "box", "shape": { "cuboid": { "half_extents": [1, 2, 3] } }, "mass": 5, "forces": [
    { "damping": { "linear": 0.5 } }, { "gravity_scale": 2 }, { "drag": { "linear": 0.1, "angular": [1, 2, 3] } },
    { "wind": [4, 5, 6] }, { "magnus": { "coefficient": -0.25 } },
    { "thruster": { "force": [0, 0, 7], "point": [1, 0, 0], "throttle": 0.5 } },
    { "constant_wrench": { "torque": [0, 1, 0], "frame": "body" } },
    { "spring_to_point": { "anchor": [0, 9, 0], "attachment": [0, 1, 0], "rest_length": 2, "stiffness": 30, "damping": 0.5 } },
    { "point_gravity": { "mu": 3.986e14 } }, { "gravity_mass": { "mu": 1e3, "softening": 0.25 } }, { "buoyancy": {} },
    { "angular_velocity_servo": { "target": [0, 0, 1], "max_torque": 2 } } ] } ] }"#;

const RON: &str = r#"( bodies: [ ( name: "box", shape: cuboid(half_extents: (1, 2, 3)), mass: 5, forces: [
    damping(linear: 0.5), gravity_scale(2), drag(linear: 0.1, angular: (1, 2, 3)), wind((4, 5, 6)), magnus(coefficient: -0.25),
    thruster(force: (0, 0, 7), point: [1, 0, 0], throttle: 0.5), constant_wrench(torque: (0, 1, 0), frame: body),
    spring_to_point(anchor: (0, 9, 0), attachment: (0, 1, 0), rest_length: 2, stiffness: 30, damping: 0.5),
    point_gravity(mu: 3.986e14), gravity_mass(mu: 1e3, softening: 0.25), buoyancy(),
    angular_velocity_servo(target: (0, 0, 1), max_torque: 2) ] ) ] )"#;

fn spawned(scene: Scene) -> World {
    let mut world = World::new();
    scene.spawn(&mut world).unwrap();
    world
}

fn world(bodies: &str) -> World {
    spawned(Scene::from_json(&format!(r#"{{ "bodies": [{bodies}] }}"#), "scene").unwrap())
}

fn forces(scene: &str) -> Vec<Force> {
    let audit = Audit::from_json(scene, "scene").unwrap();
    assert!(!audit.has_problems(), "{audit:?}");
    audit.bodies[0].forces.clone()
}

fn body(world: &World, id: u64) -> Entity {
    world.query::<(Entity, &BodyId)>().iter().find(|(_, of)| of.0 == id).unwrap().0
}

fn get<T: hecs::Component + Copy>(world: &World, id: u64) -> T {
    *world.get::<&T>(body(world, id)).unwrap()
}

fn springs(world: &World) -> Vec<Spring> {
    world.query::<&Spring>().iter().copied().collect()
}

#[test]
fn every_force_becomes_its_component() {
    for scene in [Scene::from_json(JSON, "scene").unwrap(), Scene::from_ron(RON, "scene").unwrap()] {
        let world = spawned(scene);
        assert_eq!(get::<Damping>(&world, 0), Damping { linear: 0.5, angular: 0.0 });
        assert_eq!(get::<GravityScale>(&world, 0), GravityScale(2.0));
        assert_eq!(get::<Drag>(&world, 0), Drag { linear: Vec3::splat(0.1), angular: Vec3::new(1.0, 2.0, 3.0) });
        assert_eq!(get::<Wind>(&world, 0), Wind(Vec3::new(4.0, 5.0, 6.0)));
        assert_eq!(get::<Magnus>(&world, 0), Magnus { coefficient: -0.25 });
        let nozzle = Thruster { throttle: 0.5, ..Thruster::new(Vec3::Z * 7.0, Vec3::X) };
        assert_eq!(get::<Thruster>(&world, 0), nozzle);
        let wrench = ConstantWrench { force: Vec3::ZERO, torque: Vec3::Y, frame: Frame::Body };
        assert_eq!(get::<ConstantWrench>(&world, 0), wrench);
        let spring = SpringToPoint {
            anchor: Vec3::Y * 9.0,
            attachment: Vec3::Y,
            rest_length: 2.0,
            stiffness: 30.0,
            damping: 0.5,
        };
        assert_eq!(get::<SpringToPoint>(&world, 0), spring);
        let earth = PointGravity { center: Vec3::ZERO, mu: 3.986e14, softening: 0.0 };
        assert_eq!(get::<PointGravity>(&world, 0), earth);
        assert_eq!(get::<GravityMass>(&world, 0), GravityMass { mu: 1e3, softening: 0.25 });
        let hull = Hull::Cuboid { half_extents: Vec3::new(1.0, 2.0, 3.0) };
        assert_eq!(get::<Buoyancy>(&world, 0), Buoyancy::new(hull));
        let servo = AngularVelocityServo { target: Vec3::Z, frame: Frame::World, max_torque: 2.0 };
        assert_eq!(get::<AngularVelocityServo>(&world, 0), servo);
    }
}

#[test]
fn what_is_listed_can_be_written_into_a_scene() {
    let listed = forces(JSON);
    assert_eq!(listed.len(), 12);
    let spring = r#"{ "spring": { "to": "body-1", "stiffness": 2 } }, { "buoyancy": { "hull": { "sphere": { "radius": 2 } } } }"#;
    let scene = |forces: &str| {
        format!(
            r#"{{ "bodies": [ {{ "mass": 1, "forces": [{forces}] }}, {{ "name": "body-1", "fixed": true, "position": [3, 4, 0] }} ] }}"#
        )
    };
    for listed in [listed, forces(&scene(spring))] {
        let texts: Vec<String> = listed.iter().map(|force| serde_json::to_string(force).unwrap()).collect();
        assert_eq!(forces(&scene(&texts.join(", "))), listed);
    }
}

#[test]
fn no_limit_of_torque_is_an_infinite_one() {
    let world = world(
        r#"{ "shape": { "sphere": { "radius": 1 } }, "mass": 1, "forces": [ { "angular_velocity_servo": { "target": [0, 0, 0] } } ] }"#,
    );
    assert_eq!(get::<AngularVelocityServo>(&world, 0).max_torque, Real::INFINITY);
}

#[test]
fn nozzles_add_up_each_as_far_as_it_is_open() {
    let world = world(
        r#"{ "shape": { "sphere": { "radius": 1 } }, "mass": 1, "forces": [
            { "thruster": { "force": [0, 0, 2], "point": [1, 0, 0], "throttle": 0.5 } },
            { "thruster": { "force": [0, 0, -1], "point": [-1, 0, 0] } } ] }"#,
    );
    let thruster = get::<Thruster>(&world, 0);
    assert_eq!((thruster.force, thruster.torque, thruster.throttle), (Vec3::ZERO, Vec3::Y * -2.0, 1.0));
}

#[test]
fn points_are_in_the_bodys_frame_and_components_have_them_from_the_centre_of_mass() {
    // A cone's centre of mass is half a half height below the middle.
    let world = world(
        r#"{ "name": "cone", "shape": { "cone": { "radius": 1, "half_height": 2 } }, "mass": 1, "position": [7, 8, 9], "forces": [
            { "spring_to_point": { "anchor": [0, 0, 0], "attachment": [0, 2, 0], "stiffness": 1 } },
            { "thruster": { "force": [1, 0, 0], "point": [0, -1, 0] } },
            { "buoyancy": { "hull": { "sphere": { "radius": 1 } }, "center": [0, 1, 0] } },
            { "spring": { "to": "wall", "attachment": [0, 2, 0], "attachment_to": [1, 0, 0], "stiffness": 5 } } ] },
          { "name": "wall", "fixed": true, "shape": { "cone": { "radius": 1, "half_height": 2 } }, "position": [6, 7, 9] }"#,
    );
    assert_eq!(get::<SpringToPoint>(&world, 0).attachment, Vec3::Y * 3.0);
    // A force at the centre of mass has no torque.
    assert_eq!(get::<Thruster>(&world, 0).torque, Vec3::ZERO);
    assert_eq!(get::<Buoyancy>(&world, 0).center, Vec3::Y * 2.0);
    let spring = springs(&world)[0];
    assert_eq!(spring.bodies, [body(&world, 0), body(&world, 1)]);
    // The wall has no mass, so its place is the origin of its frame.
    assert_eq!(spring.attachments, [Vec3::Y * 3.0, Vec3::X]);
    // From (7, 10, 9) to (7, 7, 9).
    assert_eq!((spring.rest_length, spring.stiffness, spring.damping), (3.0, 5.0, 0.0));
}

#[test]
fn a_gravity_mass_is_that_of_the_body() {
    let earth = r#""forces": [ { "gravity_mass": {} } ]"#;
    let world = world(&format!(
        r#"{{ "mass": 5.9722e24, {earth} }}, {{ "fixed": true, "mass": 5.9722e24, {earth} }},
           {{ "shape": {{ "cuboid": {{ "half_extents": [0.5, 1, 1] }} }}, "density": 10, {earth} }},
           {{ "shape": {{ "compound": {{ "parts": [ {{ "shape": "point", "mass": 3, "position": [0, 0, 1] }}, {{ "shape": "point", "mass": 5 }},
               {{ "shape": "point", "mass": 32, "position": [1, 0, 0] }} ] }} }}, {earth} }}"#
    ));
    for (id, kilograms) in [(0, 5.9722e24), (1, 5.9722e24), (2, 40.0), (3, 40.0)] {
        assert_eq!(get::<GravityMass>(&world, id), GravityMass::of_kilograms(kilograms), "body {id}");
    }
}

#[test]
fn a_spring_lets_its_bodies_swing_and_keeps_their_momentum() {
    let scene = r#"{ "gravity": [0, 0, 0], "dt": 0.01, "bodies": [
        { "name": "a", "mass": 2, "position": [-1, 0, 0], "forces": [ { "spring": { "to": "b", "rest_length": 1, "stiffness": 4 } } ] },
        { "name": "b", "mass": 2, "position": [1, 0, 0] } ] }"#;
    let scene = Scene::from_json(scene, "scene").unwrap();
    let mut simulation = tumble::Simulation::new(scene.settings).unwrap();
    let mut world = spawned(scene);
    // A reduced mass of 1 kg: half a period is pi/2 s, and then they are as close as they were far.
    simulation.step_many(&mut world, 157);
    let pose: tumble::Pose = get(&world, 0);
    // 157 steps are 8e-4 s less than half a period, where they stand still; the engine's frequency
    // is exact.
    assert!(pose.position.x.abs() < 1e-5, "{pose:?}");
}

/// A body that a spring leads to moves from world to world; the spring's own does not.
#[test]
fn the_length_of_a_spring_is_the_distance_in_each_world() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("scene.json");
    let scene = r#"{ "bodies": [ { "name": "a", "mass": 1, "forces": [ { "spring": { "to": "b", "stiffness": 1 } },
        { "spring": { "to": "c", "stiffness": 1 } } ] }, { "name": "b", "mass": 1 }, { "name": "c", "mass": 1, "position": [0, 7, 0] } ] }"#;
    std::fs::write(&path, scene).unwrap();
    let template = SceneTemplate::open(&path.to_string_lossy(), RunOverrides::default()).unwrap();
    let fields =
        ["bodies.b.position.0", "bodies.a.forces.0.spring.stiffness"].map(|path| template.field(path).unwrap());
    let scene = template.varied(fields.to_vec());
    for (value, length) in [(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)] {
        let world = scene.build(&[value, 5.0]).unwrap().trial.world;
        let mut lengths: Vec<(Real, Real)> =
            springs(&world).iter().map(|spring| (spring.rest_length, spring.stiffness)).collect();
        lengths.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert_eq!(lengths, [(length, 5.0), (7.0, 1.0)]);
    }
}
