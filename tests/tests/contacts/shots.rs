//! Promise: nothing gets through anything: no shot of any shape through a wall of a millimetre,
//! still or moving, nor out of a closed box, nor through another shot, at up to a kilometre a
//! second.
//!
//! Why: what is foreseen is foreseen with the velocities that a step begins with, and a blow
//! changes them within it. It fails if what a body really does in a step is not followed.
//!
//! `TUMBLE_SHOTS=100000` draws as many of each shape; without it some hundreds.

use glam::DVec3;
use hecs::World;
use tumble::math::Vec3;
use tumble::prelude::*;
use tumble_tests::touching::{closed_box, spawn, surfaced};
use tumble_tests::{Draw, cases, dvec3, quat, real, vec3};

fn shots() -> u64 {
    std::env::var("TUMBLE_SHOTS").ok().and_then(|count| count.parse().ok()).unwrap_or_else(|| u64::from(cases(200)))
}

const KINDS: [&str; 7] = ["ball", "box", "rod", "can", "top", "hull", "dumbbell"];

fn shot(kind: &str, draw: &mut Draw) -> (Shape, Collider) {
    let size = draw.log_between(0.01, 0.3);
    let [a, b, c] = [(); 3].map(|()| size * draw.log_between(0.1, 1.0));
    let shape = match kind {
        "ball" => Shape::sphere(size),
        "box" => Shape::cuboid([a, b, c]),
        "rod" if draw.often(0.5) => Shape::cuboid([0.05 * size, size, 0.05 * size]),
        "rod" => Shape::Capsule { radius: 0.05 * size, half_height: size },
        "can" => Shape::Cylinder { radius: a, half_height: b },
        "top" => match draw.between(0.0, 3.0) as u32 {
            0 => Shape::Cone { radius: a, half_height: b },
            1 => Shape::TaperedCapsule { radius_bottom: a, radius_top: 0.3 * a, half_height: b },
            _ => Shape::Ellipsoid { radii: DVec3::new(a, b, a) },
        },
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

/// Least and most angular speed of shots [rad/s].
const SPINS: [f64; 2] = [0.1, 200.0];
/// Of those that turn by more than half a turn in a substep.
const FAST_SPINS: [f64; 2] = [500.0, 3000.0];

fn body(shape: &Shape, spins: [f64; 2], draw: &mut Draw) -> RigidBody {
    let turned = draw.orientation();
    // Of many things, about their axis.
    let about = if draw.often(0.3) { turned * DVec3::Y } else { draw.direction() };
    let spin = about * draw.log_between(spins[0], spins[1]);
    let body = RigidBody::new(shape.clone()).orientation(quat(turned)).angular_velocity(vec3(spin));
    if matches!(shape, Shape::Compound(_)) { body } else { body.mass(1.0) }
}

/// No point of a shot is further from its centre \[m\].
const REACH: f64 = 0.6;
/// Half the thickness of a wall \[m\].
const THIN: f64 = 0.0005;

/// Of all shots at walls of a kind, which are on the other side after a while, or stuck in it.
fn through_walls(kind: &str, wall: &str, spins: [f64; 2]) -> Vec<u64> {
    (0..shots()).filter(|case| is_through_or_stuck(kind, wall, spins, &mut Draw::new(2330, *case))).collect()
}

fn is_through_or_stuck(kind: &str, wall: &str, spins: [f64; 2], draw: &mut Draw) -> bool {
    let (shape, collider) = shot(kind, draw);
    // What neither bounces nor is rubbed stays at the wall longest.
    let surface = if spins == FAST_SPINS { Material::new(0.0, 0.0) } else { material(draw) };
    let mut world = World::new();
    let drift = if wall == "moving" { vec3(draw.direction() * draw.log_between(0.1, 100.0)) } else { Vec3::ZERO };
    let turned = quat(draw.orientation());
    let gate = RigidBody::new(Shape::Point).orientation(turned);
    let gate = if wall == "moving" { gate.kinematic().linear_velocity(drift) } else { gate.fixed() };
    let gate = spawn(&mut world, gate, surfaced(collider_of(wall), surface));
    let speed = draw.log_between(1.0, 1000.0);
    let up = turned * Vec3::Y;
    let across = |v: Vec3| v - up * v.dot(up);
    // At most 60 degrees from the normal.
    let side = across(vec3(draw.vector(1.0))).normalize_or_zero() * real(draw.between(0.0, 1.7));
    let way = (side - up).normalize();
    let dt = 1.0 / draw.log_between(30.0, if spins == FAST_SPINS { 60.0 } else { 240.0 });
    let far = 0.7 + draw.between(0.0, 3.0) * speed * dt;
    let target = across(turned * vec3(draw.vector(2.0)));
    let it = body(&shape, spins, draw).position(target - way * real(far)).linear_velocity(drift + way * real(speed));
    let it = spawn(&mut world, it, surfaced(collider, surface));
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(real(dt));
    let mut simulation = Simulation::new(settings).unwrap();
    let steps = (far / (speed * dt)) as u32 + 60;
    // Where its velocity would have taken it: what is stuck in the wall says that it goes on.
    let mut height = f64::from((target - way * real(far)).dot(up));
    (0..steps).any(|_| {
        simulation.step(&mut world);
        let velocity = world.get::<&Velocity>(it).unwrap().linear - drift;
        height += dt * f64::from(velocity.dot(up));
        let [place, of_gate] = [it, gate].map(|it| world.get::<&Pose>(it).unwrap().position);
        let from_gate = place - of_gate;
        // The wall ends 20 m from its middle.
        let is_beside = across(from_gate).length() > 19.0;
        !is_beside && (from_gate.dot(up) < -real(REACH) || height < -REACH - 10.0 * speed * dt)
    })
}

fn collider_of(wall: &str) -> Collider {
    match wall {
        "mesh" => {
            let corner = |x: f64, z: f64| glam::DVec3::new(x, 0.0, z) * 20.0;
            let corners = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
            Collider::mesh(corners, &[[0, 1, 2], [0, 2, 3]]).unwrap()
        }
        "heights" => Collider::height_field([0.0; 81], 9, [5.0, 5.0]).unwrap(),
        _ => Collider::new(&Shape::cuboid([20.0, THIN, 20.0])).unwrap(),
    }
}

/// Energy of motion \[J\] against a frame that moves at a velocity.
fn energy_against(world: &World, body: hecs::Entity, frame: glam::DVec3) -> f64 {
    let (momentum, mass) = (*world.get::<&Momentum>(body).unwrap(), world.get::<&Mass>(body).unwrap().kilograms());
    let velocity = *world.get::<&Velocity>(body).unwrap();
    let turning = dvec3(momentum.angular).dot(dvec3(velocity.angular));
    0.5 * (f64::from(mass) * (dvec3(velocity.linear) - frame).length_squared() + turning)
}

/// A shot at a wall that moves, or stands still: what it has of its energy against the wall from
/// step to step, over what it began with, and for a ball by how much it is off the closed form of
/// the blow, over its speed.
fn bounce(kind: &str, is_moving: bool, draw: &mut Draw) -> (f64, f64) {
    let (shape, collider) = shot(kind, draw);
    let surface = material(draw);
    let mut world = World::new();
    let drift = if is_moving { draw.direction() * draw.log_between(0.1, 100.0) } else { glam::DVec3::ZERO };
    let gate = RigidBody::new(Shape::Point).kinematic().linear_velocity(vec3(drift));
    spawn(&mut world, gate, surfaced(collider_of("box"), surface));
    let speed = draw.log_between(10.0, 1000.0);
    let way = (draw.direction().reject_from(glam::DVec3::Y) * draw.between(0.0, 1.7) - glam::DVec3::Y).normalize();
    let dt = 1.0 / draw.log_between(30.0, 240.0);
    let far = 0.7 + draw.between(0.0, 3.0) * speed * dt;
    let (start, spin) = (drift + way * speed, draw.direction() * draw.log_between(0.1, 200.0));
    let it =
        body(&shape, SPINS, draw).position(vec3(way * -far)).linear_velocity(vec3(start)).angular_velocity(vec3(spin));
    let it = spawn(&mut world, it, surfaced(collider, surface));
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(real(dt))).unwrap();
    let (first, mut most) = (energy_against(&world, it, drift), 0.0_f64);
    for _ in 0..(far / (speed * dt)) as u32 + 5 {
        // What has ends, and spins by more than half a turn in a substep, has contacts at random.
        let spins = dvec3(world.get::<&Velocity>(it).unwrap().angular).length();
        let angle = spins * f64::from(simulation.settings().contact_substep());
        if kind != "ball" && angle > std::f64::consts::PI {
            break;
        }
        simulation.step(&mut world);
        most = most.max(energy_against(&world, it, drift));
    }
    let Shape::Sphere { radius } = shape else { return (most / first, 0.0) };
    let [coming, normal] = [start - drift, glam::DVec3::Y];
    let pressed = -(1.0 + f64::from(surface.restitution)) * coming.y;
    let slip = coming.reject_from(normal) + spin.cross(normal * -radius);
    let rubbed = (2.0 / 7.0 * slip.length()).min(f64::from(surface.static_friction) * pressed);
    let leaving = coming + normal * pressed - slip.normalize_or_zero() * rubbed;
    let left = dvec3(world.get::<&Velocity>(it).unwrap().linear) - drift;
    (most / first, (left - leaving).length() / speed)
}

/// Balls leave as the closed form has it, so as a run in small steps; what has corners hits several
/// times, and small steps of two lengths disagree, but nothing leaves with more energy.
#[test]
fn shots_bounce_as_they_should() {
    for is_moving in [false, true] {
        for kind in KINDS {
            let (mut gains, mut off) = (Vec::new(), Vec::new());
            for case in 0..shots() {
                let (gain, error) = bounce(kind, is_moving, &mut Draw::new(2333, case));
                gains.push(gain);
                off.push(error);
            }
            let most = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
            assert!(most(&gains) < 1.01, "{kind}, moving {is_moving}: {}", most(&gains));
            assert!(most(&off) < 0.01, "{kind}, moving {is_moving}: {}", most(&off));
        }
    }
}

/// Whether one of these gets out of a closed box in this time \[s\].
fn gets_out(world: &mut World, all: &[hecs::Entity], seconds: f64, draw: &mut Draw) -> bool {
    let dt = 1.0 / draw.log_between(30.0, 240.0);
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(real(dt));
    let mut simulation = Simulation::new(settings).unwrap();
    (0..(seconds / dt) as u32).any(|_| {
        simulation.step(world);
        let out = real(1.0 + REACH);
        all.iter().any(|it| world.get::<&Pose>(*it).unwrap().position.abs().max_element() > out)
    })
}

/// Of all shots in a closed box, which get out of it within a second.
fn out_of_a_box(kind: &str) -> Vec<u64> {
    (0..shots()).filter(|case| is_out_of_a_box(kind, &mut Draw::new(2331, *case))).collect()
}

fn is_out_of_a_box(kind: &str, draw: &mut Draw) -> bool {
    let (shape, collider) = shot(kind, draw);
    let surface = material(draw);
    let mut world = World::new();
    closed_box(&mut world, THIN, surface);
    let speed = draw.log_between(1.0, 1000.0);
    let place = draw.vector(0.5);
    let it = body(&shape, SPINS, draw).position(vec3(place)).linear_velocity(vec3(draw.direction() * speed));
    let it = spawn(&mut world, it, surfaced(collider, surface));
    gets_out(&mut world, &[it], 1.0, draw)
}

/// Whether one of several in a closed box gets out of it within half a second.
fn is_one_of_several_out(draw: &mut Draw) -> bool {
    let surface = material(draw);
    let mut world = World::new();
    closed_box(&mut world, THIN, surface);
    let speed = draw.log_between(1.0, 1000.0);
    let places = [-0.6, -0.2, 0.2, 0.6].map(|x| DVec3::new(x, draw.between(-0.6, 0.6), draw.between(-0.6, 0.6)));
    let all = places.map(|place| {
        let kind = KINDS[draw.between(0.0, KINDS.len() as f64) as usize];
        let (shape, collider) = shot(kind, draw);
        let it = body(&shape, SPINS, draw).mass(draw.log_between(0.1, 10.0)).position(vec3(place));
        spawn(&mut world, it.linear_velocity(vec3(draw.direction() * speed)), surfaced(collider, surface))
    });
    gets_out(&mut world, &all, 0.5, draw)
}

#[test]
fn none_of_several_gets_out_of_a_closed_box() {
    let out: Vec<u64> = (0..shots()).filter(|case| is_one_of_several_out(&mut Draw::new(2334, *case))).collect();
    assert!(out.is_empty(), "{} of {}: {out:?}", out.len(), shots());
}

#[test]
fn no_shot_gets_through_a_wall() {
    for kind in KINDS {
        for wall in ["still", "moving", "mesh", "heights"] {
            let through = through_walls(kind, wall, SPINS);
            assert!(through.is_empty(), "{kind} {wall}: {} of {}: {through:?}", through.len(), shots());
        }
    }
}

/// The last pose does not tell how often they have turned.
#[test]
fn no_shot_that_spins_fast_gets_through_a_wall() {
    for kind in KINDS {
        for wall in ["still", "moving"] {
            let through = through_walls(kind, wall, FAST_SPINS);
            assert!(through.is_empty(), "{kind} {wall}: {} of {}: {through:?}", through.len(), shots());
        }
    }
}

#[test]
fn nothing_gets_out_of_a_closed_box() {
    for kind in KINDS {
        let out = out_of_a_box(kind);
        assert!(out.is_empty(), "{kind}: {} of {}: {out:?}", out.len(), shots());
    }
}

/// Of the ball within a shot \[m\].
fn inner_radius(shape: &Shape) -> f64 {
    match *shape {
        Shape::Sphere { radius } => radius,
        Shape::Cuboid { half_extents } => half_extents.min_element(),
        Shape::Cylinder { radius, half_height } => radius.min(half_height),
        _ => unreachable!("not shot at others"),
    }
}

/// Two free shots aimed at each other's middle: how near their middles come to each other on the
/// straight ways from step to step, in radii of the balls within both, and how much of the momentum
/// of a blow that stops both they give each other.
fn nearest_middles(kinds: [&str; 2], draw: &mut Draw) -> [f64; 2] {
    let [(a, of_a), (b, of_b)] = kinds.map(|kind| shot(kind, draw));
    let radii = inner_radius(&a) + inner_radius(&b);
    let along = draw.direction();
    let miss = along.any_orthonormal_vector() * draw.between(0.0, 0.4 * radii);
    let (speed, share) = (draw.log_between(5.0, 1000.0), draw.between(0.0, 1.0));
    let dt = 1.0 / draw.log_between(30.0, 240.0);
    let far = 1.2 + draw.between(0.0, 3.0) * speed * dt;
    let mut world = World::new();
    let first = body(&a, SPINS, draw).mass(1.0).position(vec3(miss)).linear_velocity(vec3(along * (speed * share)));
    let first = spawn(&mut world, first, of_a);
    let mass = draw.log_between(0.1, 10.0);
    let way = along * (speed * (share - 1.0));
    let second = body(&b, SPINS, draw).mass(mass).position(vec3(along * far)).linear_velocity(vec3(way));
    let second = spawn(&mut world, second, of_b);
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(real(dt));
    let mut simulation = Simulation::new(settings).unwrap();
    let apart = |world: &World| {
        let [a, b] = [first, second].map(|it| dvec3(world.get::<&Pose>(it).unwrap().position));
        b - a
    };
    let (mut before, mut nearest) = (apart(&world), f64::INFINITY);
    for _ in 0..(far / (speed * dt)) as u32 + 4 {
        simulation.step(&mut world);
        let now = apart(&world);
        let way = now - before;
        let moment = (-before.dot(way) / way.length_squared()).clamp(0.0, 1.0);
        nearest = nearest.min((before + way * moment).length());
        before = now;
    }
    let momentum = dvec3(world.get::<&Momentum>(first).unwrap().linear);
    let given = (momentum - along * (speed * share)).length() / (speed * mass / (1.0 + mass));
    [nearest / radii, given]
}

/// What deflects another by little lets it pass with the radii of both between the middles; what is
/// nearer than half of them, and was not given a tenth of the momentum of a blow, went through.
#[test]
fn no_shot_gets_through_another() {
    for kinds in [["box", "box"], ["can", "box"], ["can", "can"], ["ball", "box"], ["ball", "can"], ["ball", "ball"]] {
        let is_through = |case: &u64| {
            let [nearest, given] = nearest_middles(kinds, &mut Draw::new(2332, *case));
            nearest < 0.5 && given < 0.1
        };
        let through: Vec<u64> = (0..shots()).filter(is_through).collect();
        assert!(through.is_empty(), "{kinds:?}: {} of {}: {through:?}", through.len(), shots());
    }
}
