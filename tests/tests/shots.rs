//! Promise: nothing gets through anything: no shot of any shape through a wall of a millimetre, still
//! or moving, nor out of a closed box, at up to a kilometre a second.
//!
//! Why: what is foreseen is foreseen with the velocities that a step begins with, and a blow changes
//! them within it. It fails if what a body really does in a step is not followed.
//!
//! `TUMBLE_SHOTS=100000` draws as many of each shape; without it some hundreds.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble_tests::Draw;
use tumble_tests::touching::{spawn, surfaced};

fn real(number: f64) -> Real {
    number as Real
}

fn vec3(v: glam::DVec3) -> Vec3 {
    Vec3::new(real(v.x), real(v.y), real(v.z))
}

fn quat(q: glam::DQuat) -> Quat {
    Quat::from_xyzw(real(q.x), real(q.y), real(q.z), real(q.w))
}

fn shots() -> u64 {
    std::env::var("TUMBLE_SHOTS").ok().and_then(|count| count.parse().ok()).unwrap_or(300)
}

const KINDS: [&str; 6] = ["ball", "box", "rod", "can", "hull", "dumbbell"];

fn shot(kind: &str, draw: &mut Draw) -> (Shape, Collider) {
    let size = draw.log_between(0.01, 0.3);
    let [a, b, c] = [(); 3].map(|()| size * draw.log_between(0.1, 1.0));
    let shape = match kind {
        "ball" => Shape::sphere(size),
        "box" => Shape::cuboid([a, b, c]),
        "rod" if draw.often(0.5) => Shape::cuboid([0.05 * size, size, 0.05 * size]),
        "rod" => Shape::Capsule { radius: 0.05 * size, half_height: size },
        "can" => Shape::Cylinder { radius: a, half_height: b },
        "dumbbell" => {
            let part = |x: f64| tumble::Part::new(Shape::sphere(a), tumble::Amount::Mass(1.0)).at([x, 0.0, 0.0]);
            Shape::compound([part(-b), part(b)])
        }
        _ => {
            let corners = [(); 12].map(|()| draw.direction() * glam::DVec3::new(a, b, c));
            return (Shape::cuboid([0.5 * a, 0.5 * b, 0.5 * c]), Collider::convex_hull(corners).unwrap());
        }
    };
    let collider = Collider::new(&shape).unwrap();
    (shape, collider)
}

fn material(draw: &mut Draw) -> Material {
    let friction = if draw.often(0.3) { 0.0 } else { draw.between(0.0, 1.0) };
    let restitution = if draw.often(0.4) { 0.0 } else { draw.between(0.0, 1.0) };
    Material::new(real(friction), real(restitution))
}

fn body(shape: Shape, draw: &mut Draw) -> RigidBody {
    let spin = draw.direction() * draw.log_between(0.1, 200.0);
    let body = RigidBody::new(shape.clone()).orientation(quat(draw.orientation())).angular_velocity(vec3(spin));
    if matches!(shape, Shape::Compound(_)) { body } else { body.mass(1.0) }
}

/// No point of a shot is further from its centre \[m\].
const REACH: f64 = 0.6;
/// Half the thickness of a wall \[m\].
const THIN: f64 = 0.0005;

/// Of all shots at one wall, how many are on its other side after a while.
fn energy(world: &World, it: Entity) -> f64 {
    let (m, v) = (*world.get::<&Momentum>(it).unwrap(), *world.get::<&Velocity>(it).unwrap());
    let dot = |a: Vec3, b: Vec3| tumble_tests::dvec3(a).dot(tumble_tests::dvec3(b));
    0.5 * (dot(m.linear, v.linear) + dot(m.angular, v.angular))
}

fn through_a_wall(kind: &str, wall: &str) -> Vec<u64> {
    let mut gains: Vec<(f64, u64)> = Vec::new();
    let mut through = Vec::new();
    for case in 0..shots() {
        let mut draw = Draw::new(2330, case);
        let (shape, collider) = shot(kind, &mut draw);
        let surface = material(&mut draw);
        let mut world = World::new();
        let drift = if wall == "moving" { vec3(draw.direction() * draw.log_between(0.1, 100.0)) } else { Vec3::ZERO };
        let turned = quat(draw.orientation());
        let made = RigidBody::new(Shape::Point).orientation(turned);
        let made = if wall == "moving" { made.kinematic().linear_velocity(drift) } else { made.fixed() };
        let of_wall = match wall {
            "mesh" => {
                let corner = |x: f64, z: f64| glam::DVec3::new(x, 0.0, z) * 20.0;
                let corners = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
                Collider::mesh(corners, &[[0, 1, 2], [0, 2, 3]]).unwrap()
            }
            "heights" => Collider::height_field([0.0; 81], 9, [5.0, 5.0]).unwrap(),
            _ => Collider::new(&Shape::cuboid([20.0, THIN, 20.0])).unwrap(),
        };
        let gate = spawn(&mut world, made, surfaced(of_wall, surface));
        let speed = draw.log_between(1.0, 1000.0);
        let up = turned * Vec3::Y;
        // At most 60 degrees from the normal.
        let side = vec3(draw.vector(1.0));
        let side = (side - up * side.dot(up)).normalize_or_zero() * real(draw.between(0.0, 1.7));
        let way = (side - up).normalize();
        let dt = 1.0 / draw.log_between(30.0, 240.0);
        let far = 0.7 + draw.between(0.0, 3.0) * speed * dt;
        let target = turned * vec3(draw.vector(2.0)) * Vec3::ONE;
        let target = target - up * target.dot(up);
        let it = body(shape, &mut draw).position(target - way * real(far)).linear_velocity(drift + way * real(speed));
        let it = spawn(&mut world, it, surfaced(collider, surface));
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(real(dt));
        let mut simulation = Simulation::new(settings).unwrap();
        let steps = (far / (speed * dt)) as u32 + 60;
        let trace = std::env::var("TRACE").is_ok_and(|it| it == format!("{kind} {wall} {case}"));
        if trace {
            println!("{:?} {:?} speed {speed} dt {dt}", &*world.get::<&Collider>(it).unwrap(), surface);
        }
        tumble::update_derived(&mut world);
        let before = energy(&world, it);
        let mut most: f64 = 0.0;
        for step in 0..steps {
            simulation.step(&mut world);
            most = most.max(energy(&world, it) / before - 1.0);
            if trace {
                let pose = *world.get::<&Pose>(it).unwrap();
                let gate = *world.get::<&Pose>(gate).unwrap();
                let v = *world.get::<&Velocity>(it).unwrap();
                let points = simulation
                    .contacts()
                    .flat_map(|c| c.points().iter().map(|p| p.separation).collect::<Vec<_>>())
                    .collect::<Vec<_>>();
                println!(
                    "{step}: height {} axes up {:?} v {} w {} contacts {points:?}",
                    (pose.position - gate.position).dot(up),
                    pose.orientation.inverse() * up,
                    v.linear.dot(up),
                    v.angular.length()
                );
            }
            let (place, of_gate) = (*world.get::<&Pose>(it).unwrap(), *world.get::<&Pose>(gate).unwrap());
            let from_gate = place.position - of_gate.position;
            let beside = (from_gate - up * from_gate.dot(up)).length();
            if from_gate.dot(up) < -real(REACH) && beside < 19.0 {
                through.push(case);
                break;
            }
        }
        gains.push((most, case));
    }
    gains.sort_by(|a, b| b.0.total_cmp(&a.0));
    let over = |x: f64| gains.iter().filter(|g| g.0 > x).count();
    println!(
        "{kind} {wall} gains: over 0.01 {} over .1 {} over 1 {}: {:?}",
        over(0.01),
        over(0.1),
        over(1.0),
        &gains[..5]
    );
    through
}

/// Of all shots in a closed box, how many are out of it after a second.
fn out_of_a_box(kind: &str) -> Vec<u64> {
    let mut out = Vec::new();
    for case in 0..shots() {
        let mut draw = Draw::new(2331, case);
        let (shape, collider) = shot(kind, &mut draw);
        let surface = material(&mut draw);
        let mut world = World::new();
        let half = 1.0;
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let mut extents = [half + 2.0 * THIN; 3];
                extents[axis] = THIN;
                let mut place = [0.0; 3];
                place[axis] = sign * (half + THIN);
                let shape = Shape::cuboid(extents);
                let wall = RigidBody::new(shape.clone()).fixed().position(vec3(place.into()));
                spawn(&mut world, wall, surfaced(Collider::new(&shape).unwrap(), surface));
            }
        }
        let speed = draw.log_between(1.0, 1000.0);
        let place = draw.vector(0.5);
        let it = body(shape, &mut draw).position(vec3(place)).linear_velocity(vec3(draw.direction() * speed));
        let it: Entity = spawn(&mut world, it, surfaced(collider, surface));
        let dt = 1.0 / draw.log_between(30.0, 240.0);
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(real(dt));
        let mut simulation = Simulation::new(settings).unwrap();
        let trace = std::env::var("TRACE").is_ok_and(|it| it == format!("{kind} {case}"));
        if trace {
            println!("{:?} {:?} speed {speed} dt {dt}", &*world.get::<&Collider>(it).unwrap(), surface);
        }
        for step in 0..(1.0 / dt) as u32 {
            simulation.step(&mut world);
            if trace {
                let pose = *world.get::<&Pose>(it).unwrap();
                let v = *world.get::<&Velocity>(it).unwrap();
                let points = simulation
                    .contacts()
                    .flat_map(|c| c.points().iter().map(|p| p.separation).collect::<Vec<_>>())
                    .collect::<Vec<_>>();
                println!(
                    "{step}: at {:?} axis {:?} v {:?} w {} contacts {points:?}",
                    pose.position,
                    pose.orientation * Vec3::Y,
                    v.linear,
                    v.angular.length()
                );
            }
            let place = world.get::<&Pose>(it).unwrap().position;
            if place.abs().max_element() > real(half + REACH) {
                out.push(case);
                break;
            }
        }
    }
    out
}

#[test]
fn no_shot_gets_through_a_wall() {
    for kind in KINDS {
        for wall in ["still", "moving", "mesh", "heights"] {
            let through = through_a_wall(kind, wall);
            println!("{kind} {wall}: {} of {}: {:?}", through.len(), shots(), &through[..through.len().min(8)]);
        }
    }
}

#[test]
fn nothing_gets_out_of_a_closed_box() {
    for kind in KINDS {
        let out = out_of_a_box(kind);
        println!("{kind}: {} of {}: {:?}", out.len(), shots(), &out[..out.len().min(8)]);
    }
}
