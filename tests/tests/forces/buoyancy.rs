//! Promise: `Buoyancy` is Archimedes' lift at the centroid of what is under water, exact for
//! spheres and boxes in every attitude and at every depth; what floats lies as deep as it weighs,
//! heaves at its frequency, rights itself by its metacentric height or turns over; its energy is
//! the one that the lift is the slope of.
//!
//! Why: a raft that tips over for no reason, or lies an inch too high in one attitude, is a wrong
//! clip of a box somewhere. It fails if a case of the clipping is wrong, if a corner or a face that
//! lies just in the surface counts twice or not at all, or if the lift acts at the wrong point.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::Integrator::{self, MoserVeselov, RungeKutta4, SemiImplicitEuler};
use tumble::math::{Quat, Real, Vec3};
use tumble::{BodyOrder, Buoyancy, Damping, GravityScale, Hull, Momentum, Pose, RigidBody, Rng, Shape, Totals};
use tumble_tests::{EPSILON, attitude_error, by_precision, dquat, dvec3, run, seconds, simulation};

use crate::nets;

const DT: Real = 1.0 / 128.0;
const GRAVITY: f64 = 10.0;

/// Along no axis, to see that up is against gravity.
fn gravity() -> Vec3 {
    Vec3::new(6.0, 0.0, -8.0)
}

fn up() -> DVec3 {
    -dvec3(gravity()).normalize()
}

/// A body that only the water acts on; what it weighs is left out.
fn floating(buoyancy: Buoyancy, pose: Pose) -> (World, Entity) {
    let mut world = World::new();
    let body = RigidBody::new(Shape::sphere(1.0))
        .without_collider()
        .mass(1.0)
        .position(pose.position)
        .orientation(pose.orientation);
    let body = body.build().unwrap().spawn(&mut world);
    world.insert(body, (buoyancy, GravityScale(0.0))).unwrap();
    (world, body)
}

/// The wrench of the water: what a step of a second adds to the momenta of a body at rest.
fn lift(buoyancy: Buoyancy, pose: Pose) -> (DVec3, DVec3) {
    let (mut world, body) = floating(buoyancy, pose);
    simulation(SemiImplicitEuler, gravity(), 1.0).step(&mut world);
    let momentum = *world.get::<&Momentum>(body).unwrap();
    (dvec3(momentum.linear), dvec3(momentum.angular))
}

fn potential(buoyancy: Buoyancy, pose: Pose) -> f64 {
    let (world, _) = floating(buoyancy, pose);
    let simulation = simulation(SemiImplicitEuler, gravity(), 1.0);
    Totals::of(&world, simulation.settings(), &BodyOrder::of(&world)).force_potential
}

/// Volume and first moment about the origin of the part of a turned box below the plane
/// `up . x = 0`, by slices: between two corners in height the area of a slice is a polynomial of
/// second degree in height and its moment one of third, so that two points of Gauss are exact.
/// Shares nothing with how the engine does it.
fn by_slices(half: DVec3, orientation: DQuat, center: DVec3, up: DVec3) -> (f64, DVec3) {
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        center + orientation * (half * DVec3::new(sign(1), sign(2), sign(4)))
    };
    let corners: Vec<DVec3> = (0..8).map(corner).collect();
    let mut levels: Vec<f64> = corners.iter().map(|c| up.dot(*c)).filter(|z| *z < 0.0).chain([0.0]).collect();
    levels.sort_unstable_by(f64::total_cmp);
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    for pair in levels.windows(2) {
        let (middle, reach) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        for z in [middle - reach / 3.0_f64.sqrt(), middle + reach / 3.0_f64.sqrt()] {
            let (area, centroid) = slice(&corners, up, z);
            volume += area * reach;
            moment += centroid * (area * reach);
        }
    }
    (volume, moment)
}

/// Area and centroid of the cut through a box at a height.
fn slice(corners: &[DVec3], up: DVec3, z: f64) -> (f64, DVec3) {
    let mut points = Vec::new();
    for i in 0..8_usize {
        for bit in [1, 2, 4] {
            let (a, b) = (corners[i], corners[i | bit]);
            let (below, above) = (up.dot(a) - z, up.dot(b) - z);
            if i & bit == 0 && (below < 0.0) != (above < 0.0) {
                points.push(a + (b - a) * (below / (below - above)));
            }
        }
    }
    if points.len() < 3 {
        return (0.0, DVec3::ZERO);
    }
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let (east, north) = up.any_orthonormal_pair();
    points.sort_by(|a, b| {
        let angle = |p: &DVec3| (*p - middle).dot(north).atan2((*p - middle).dot(east));
        angle(a).total_cmp(&angle(b))
    });
    let (mut area, mut moment) = (0.0, DVec3::ZERO);
    for i in 0..points.len() {
        let (a, b) = (points[i] - middle, points[(i + 1) % points.len()] - middle);
        let triangle = 0.5 * a.cross(b).length();
        area += triangle;
        moment += (a + b) * (triangle / 3.0);
    }
    (area, if area > 0.0 { middle + moment / area } else { middle })
}

/// The reference itself, where the answer is known: half a cube, a corner cut off, all and nothing.
#[test]
fn slices_are_right() {
    let turned = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 1.0);
    let near = |found: (f64, DVec3), volume: f64, moment: DVec3| {
        assert!((found.0 - volume).abs() < 1e-14 && (found.1 - moment).length() < 1e-14, "{found:?}");
    };
    let half = DVec3::new(0.5, 1.0, 1.5);
    near(by_slices(half, DQuat::IDENTITY, DVec3::ZERO, DVec3::Y), 3.0, DVec3::NEG_Y * 1.5);
    near(by_slices(half, turned, DVec3::Y * -4.0, DVec3::Y), 6.0, DVec3::Y * -24.0);
    near(by_slices(half, turned, DVec3::Y * 4.0, DVec3::Y), 0.0, DVec3::ZERO);
    // A corner of a cube, cut at a third of its diagonal, with three equal edges of length 1: a
    // volume of 1/6.
    let to_corner = DQuat::from_rotation_arc(DVec3::ONE.normalize(), DVec3::NEG_Y);
    let height = 1.0 / 3.0_f64.sqrt();
    let found = by_slices(DVec3::ONE, to_corner, DVec3::Y * (3.0_f64.sqrt() - height), DVec3::Y);
    near(found, 1.0 / 6.0, DVec3::NEG_Y * (height / 4.0 / 6.0));
}

/// Attitudes: at random, along the axes, on edges and corners, and a hair beside.
fn attitudes(rng: &mut Rng) -> Vec<Quat> {
    let quarter = std::f64::consts::FRAC_PI_4 as Real;
    let mut special = vec![Quat::IDENTITY, Quat::from_rotation_x(2.0 * quarter), Quat::from_rotation_y(2.0 * quarter)];
    special.extend([Quat::from_rotation_x(quarter), Quat::from_rotation_z(1e-4), Quat::from_rotation_y(1e-7)]);
    special.push(Quat::from_rotation_arc(Vec3::ONE.normalize(), Vec3::Y));
    // The same relative to the surface, which is not along an axis of the world.
    let level = DQuat::from_rotation_arc(DVec3::Y, up());
    let level = Quat::from_xyzw(level.x as Real, level.y as Real, level.z as Real, level.w as Real);
    let leveled: Vec<Quat> = special.iter().map(|q| (level * *q).normalize()).collect();
    special.into_iter().chain(leveled).chain((0..300).map(|_| rng.orientation())).collect()
}

/// Volume and centroid of what is under water, for boxes of many proportions in hundreds of
/// attitudes, from just touching to just drowned.
#[test]
fn a_box_displaces_what_slices_of_it_add_up_to() {
    let mut rng = Rng::new(11);
    let (mut worst, mut parts) = ((0.0_f64, 0.0_f64), [0; 3]);
    for half in [Vec3::ONE, Vec3::new(0.3, 0.5, 0.8), Vec3::new(2.0, 0.02, 1.0), Vec3::new(0.05, 3.0, 0.05)] {
        for orientation in attitudes(&mut rng) {
            let axes = dquat(orientation).inverse() * up() * dvec3(half);
            let reach = axes.abs().element_sum();
            let depths = [-1.5, -1.0, -0.9999, -0.5, 0.0, 0.3, 0.9, 0.9999, 1.0, 1.2];
            let somewhere = f64::from(rng.range(-1.1, 1.1));
            for depth in depths.into_iter().chain([somewhere]) {
                let hull_center = Vec3::new(0.2, -0.1, 0.3) * rng.range(0.0, 1.0);
                let level: Real = 0.75;
                let across = dvec3(rng.vector(-1.0, 1.0)).cross(up());
                let wanted =
                    up() * (f64::from(level) - depth * reach) + across - dquat(orientation) * dvec3(hull_center);
                let [x, y, z] = wanted.to_array().map(|number| number as Real);
                let pose = Pose { position: Vec3::new(x, y, z), orientation };
                let buoyancy =
                    Buoyancy { level, center: hull_center, ..Buoyancy::new(Hull::Cuboid { half_extents: half }) };
                let (force, torque) = lift(buoyancy, pose);

                let q = dquat(orientation);
                let from_surface = dvec3(pose.position) - up() * f64::from(level) + q * dvec3(hull_center);
                let (volume, moment) = by_slices(dvec3(half), q, from_surface, up());
                let weight = 1000.0 * GRAVITY;
                let exact_torque =
                    (moment - (dvec3(pose.position) - up() * f64::from(level)) * volume).cross(up()) * weight;
                let whole = 8.0 * f64::from(half.x * half.y * half.z) * weight;
                let size = dvec3(half).length() + dvec3(hull_center).length();
                // Rounding of the place (two metres at most), of the tilt times the length, and of
                // volumes (pyramids over faces), relative to the height of the box, 0.02 m or more.
                let face = reach / f64::from(half.min_element());
                let roundings = EPSILON * (16.0 + 16.0 * (2.0 + size) / reach + 8.0 * face);
                let errors = (
                    (force - up() * (weight * volume)).length() / whole,
                    (torque - exact_torque).length() / (whole * size),
                );
                worst = (worst.0.max(errors.0 / roundings), worst.1.max(errors.1 / roundings));
                assert!(errors.0 <= roundings, "{half}, {orientation}, {depth}: volume off by {:e}", errors.0);
                assert!(errors.1 <= roundings, "{half}, {orientation}, {depth}: torque off by {:e}", errors.1);
                parts[usize::from(volume > 0.0) + usize::from(volume * weight > 0.9999 * whole)] += 1;
            }
        }
    }
    println!("volume and torque off by {worst:.3?} of what is allowed; dry, partly and wholly wet {parts:?}");
    assert!(parts.iter().all(|part| *part > 500), "{parts:?}");
}

/// A cap of `pi c^2 (3 r - c)/3`, whose lift goes through the centre of the ball.
#[test]
fn a_ball_displaces_its_cap() {
    let radius: Real = 0.75;
    let r = f64::from(radius);
    for depth in [-2.0, -0.75, -0.5, -0.01, 0.0, 0.3, 0.7499, 0.75, 0.8, 50.0] {
        let center = Vec3::new(0.1, 0.2, -0.3);
        let orientation = Quat::from_rotation_x(1.0);
        let hull = dquat(orientation) * dvec3(center);
        let [x, y, z] = (up() * (0.5 - depth) - hull).to_array().map(|number| number as Real);
        let pose = Pose { position: Vec3::new(x, y, z), orientation };
        let buoyancy = Buoyancy { level: 0.5, density: 800.0, center, hull: Hull::Sphere { radius } };
        let (force, torque) = lift(buoyancy, pose);
        let deep = 0.5 - up().dot(dvec3(pose.position) + hull);
        let c = (r + deep).clamp(0.0, 2.0 * r);
        let exact = up() * (800.0 * GRAVITY * PI * c * c * (3.0 * r - c) / 3.0);
        let whole = 800.0 * GRAVITY * 4.0 / 3.0 * PI * r.powi(3);
        // Roundings of a place that is as far as it is deep.
        let allowed = whole * EPSILON * (16.0 + 8.0 * depth.abs().min(2.0));
        assert!((force - exact).length() <= allowed, "{depth}: {force} for {exact}");
        assert!((torque - hull.cross(exact)).length() <= allowed, "{depth}: {torque}");
    }
}

/// Lift and torque are minus the slope of the energy, by differences over what the poses really
/// differ by, for both hulls, partly in the water, drowned and dry.
#[test]
fn the_lift_is_the_slope_of_the_energy() {
    let mut rng = Rng::new(4);
    let hulls = [Hull::Cuboid { half_extents: Vec3::new(0.3, 0.5, 0.8) }, Hull::Sphere { radius: 0.6 }];
    for (hull, i) in hulls.into_iter().flat_map(|hull| (0..200).map(move |i| (hull, i))) {
        let center = rng.vector(-0.2, 0.2);
        let buoyancy = Buoyancy { level: 0.25, center, ..Buoyancy::new(hull) };
        let pose = Pose { position: rng.vector(-1.0, 1.0), orientation: rng.orientation() };
        let (force, torque) = lift(buoyancy, pose);
        let d = by_precision(1e-3, 1e-5);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            // The third derivative of the energy is rho g times a length of the waterline; a corner
            // that passes through the surface makes no more of it. Forces are 1e4 N in all.
            let allowed = 1e4 * (4.0 * d * d + by_precision(1e-4, 1e-8));
            let (there, back) = (nets::shifted(&pose, axis * d), nets::shifted(&pose, axis * -d));
            let slope = (potential(buoyancy, there) - potential(buoyancy, back)) / nets::shift(&back, &there).dot(axis);
            assert!((slope + force.dot(axis)).abs() <= allowed, "{hull:?} {i}: {slope} for {force} along {axis}");
            let (there, back) = (nets::turned(&pose, axis * d), nets::turned(&pose, axis * -d));
            let slope = (potential(buoyancy, there) - potential(buoyancy, back)) / nets::turn(&back, &there).dot(axis);
            assert!((slope + torque.dot(axis)).abs() <= allowed, "{hull:?} {i}: {slope} for {torque} about {axis}");
        }
    }
}

/// Without gravity there is no lift, and in water nothing but it.
#[test]
fn without_gravity_there_is_no_lift() {
    for hull in [Hull::Sphere { radius: 1.0 }, Hull::Cuboid { half_extents: Vec3::ONE }] {
        let (mut world, body) = floating(Buoyancy::new(hull), Pose::default());
        tumble_tests::weightless(MoserVeselov, DT).step(&mut world);
        assert_eq!(*world.get::<&Momentum>(body).unwrap(), Momentum::default());
    }
}

fn with_gravity_down(integrator: Integrator) -> tumble::Simulation {
    simulation(integrator, Vec3::NEG_Y * GRAVITY as Real, DT)
}

/// A wide box of 600 kg/m^3, which lies 0.6 of its height deep and is stable.
fn raft(center: Vec3) -> (RigidBody, Buoyancy, Vec3) {
    let half_extents = Vec3::new(1.0, 0.25, 0.5);
    let body = RigidBody::new(Shape::cuboid(dvec3(half_extents))).without_collider().density(600.0);
    (body, Buoyancy { center, ..Buoyancy::new(Hull::Cuboid { half_extents }) }, half_extents)
}

/// Damped, both come to lie as deep as they weigh: a box `M/(rho A)`, a ball where its cap weighs
/// what it does.
#[test]
fn what_floats_lies_as_deep_as_it_weighs() {
    for integrator in Integrator::ALL {
        let damping = Damping { linear: 2.0, angular: 2.0 };
        let (box_body, box_hull, half) = raft(Vec3::ZERO);
        let radius: Real = 0.5;
        let ball = RigidBody::new(Shape::sphere(radius)).without_collider().density(300.0);
        let ball_hull = Buoyancy::new(Hull::Sphere { radius });
        let mut world = World::new();
        let mut place = |body: RigidBody, hull| {
            let body = body.damping(damping).position(Vec3::Y * 0.3).build().unwrap().spawn(&mut world);
            world.insert_one(body, hull).unwrap();
            body
        };
        let (raft, ball) = (place(box_body.orientation(Quat::from_rotation_z(0.3)), box_hull), place(ball, ball_hull));
        run(&mut with_gravity_down(integrator), &mut world, 6000);
        let pose = |body| *world.get::<&Pose>(body).unwrap();
        // It stalls where a kick of w^2 dt^2 of the error in depth is below a rounding. RungeKutta4
        // with damping weighs gravity and lift differently in the fourth order of the step.
        let of_weights = if integrator == RungeKutta4 { (2.0 * seconds(DT)).powi(4) } else { 0.0 };
        let allowed = 1000.0 * EPSILON + of_weights;
        let height = f64::from(pose(raft).position.y);
        let exact = f64::from(half.y) * (1.0 - 2.0 * 0.6);
        assert!((height - exact).abs() <= allowed, "{integrator}: {height} for {exact}");
        assert!(attitude_error(dquat(pose(raft).orientation), DQuat::IDENTITY) <= 2.0 * allowed, "{integrator}");
        // c^2 (3 r - c)/3 = 0.3 * 4/3 r^3 with r = 1/2: in parts of the radius c^2 (3 - c) = 1.2.
        let mut c: f64 = 0.7;
        for _ in 0..50 {
            c -= (c * c * (3.0 - c) - 1.2) / (6.0 * c - 3.0 * c * c);
        }
        let (height, exact) = (f64::from(pose(ball).position.y), 0.5 * (1.0 - c));
        assert!((height - exact).abs() <= allowed, "{integrator}: {height} for {exact}");
    }
}

/// Upright a box heaves as on a spring of `rho g A`, as long as its bottom is wet and its deck dry:
/// `w^2 = rho g A/M`.
#[test]
fn a_box_heaves_at_its_frequency() {
    for integrator in Integrator::ALL {
        let (body, hull, half) = raft(Vec3::ZERO);
        let rest = -0.05;
        let mut world = World::new();
        let raft = body.position(Vec3::Y * (rest + 0.125)).build().unwrap().spawn(&mut world);
        world.insert_one(raft, hull).unwrap();
        // rho g A/(0.6 rho A 2 h).
        let w = (GRAVITY / (0.6 * 2.0 * f64::from(half.y))).sqrt();
        let mut simulation = with_gravity_down(integrator);
        let x = w * seconds(DT);
        let a_step = match integrator {
            SemiImplicitEuler => x * x / 2.0,
            MoserVeselov => x.powi(3) / 6.0,
            _ => x.powi(5) / 120.0,
        };
        for step in 1..=400 {
            simulation.step(&mut world);
            let height = f64::from(world.get::<&Pose>(raft).unwrap().position.y);
            let exact = f64::from(rest) + 0.125 * (w * f64::from(step) * seconds(DT)).cos();
            // The next term of the series a step, and the volume has some roundings of the whole.
            let bound = 0.125 * f64::from(step) * (a_step * (1.0 + x) + 32.0 * EPSILON);
            assert!((height - exact).abs() <= bound, "{integrator}, {step}: {height} for {exact}");
        }
    }
}

/// Heeled by an angle about the long axis, as long as no edge passes the surface, a box is righted
/// by `rho g V sin a (GM + BM tan^2 a/2)` (the wall-sided formula), where `BM = I/V` with the
/// second moment of the waterline and `GM = KB + BM - KG`. With its centre of mass high it turns
/// over.
#[test]
fn a_box_is_righted_by_its_metacentric_height() {
    for above in [0.0, 0.1, -0.3] {
        // The centre of the hull is above the centre of mass by this: ballast, or a mast.
        let (_, hull, half) = raft(Vec3::Y * above);
        let (b, t) = (2.0 * f64::from(half.z), 2.0 * f64::from(half.y));
        let draught = 0.6 * t;
        let bm = b * b / (12.0 * draught);
        let gm = draught / 2.0 + bm - (t / 2.0 - f64::from(above));
        for angle in [0.01, -0.1, 0.2, 0.35] {
            let q = DQuat::from_rotation_x(angle);
            // The waterline stays where it was on the axis of the hull.
            let hull_center = DVec3::Y * ((t / 2.0 - draught) * angle.cos());
            let [x, y, z] = (hull_center - q * DVec3::Y * f64::from(above)).to_array().map(|number| number as Real);
            let orientation = Quat::from_xyzw(q.x as Real, q.y as Real, q.z as Real, q.w as Real);
            let (mut world, body) = floating(hull, Pose { position: Vec3::new(x, y, z), orientation });
            simulation(SemiImplicitEuler, Vec3::NEG_Y * GRAVITY as Real, 1.0).step(&mut world);
            let weight = 1000.0 * GRAVITY * 2.0 * b * draught;
            let momentum = *world.get::<&Momentum>(body).unwrap();
            let lifted = f64::from(momentum.linear.y) / weight;
            assert!((lifted - 1.0).abs() <= 64.0 * EPSILON, "{above}, {angle}: {lifted}");
            let exact = -weight * f64::sin(angle) * (gm + 0.5 * bm * f64::tan(angle).powi(2));
            let torque = f64::from(momentum.angular.x);
            assert!((torque - exact).abs() <= 64.0 * EPSILON * weight, "{above}, {angle}: {torque} for {exact}");
        }
    }
    // In motion: from a small heel the one comes back and swings, the other is on its side.
    for (above, turns_over) in [(0.0, false), (-0.45, true)] {
        let (body, hull, _) = raft(Vec3::Y * above);
        let mut world = World::new();
        let body = body.orientation(Quat::from_rotation_x(0.05)).damping(Damping { linear: 0.5, angular: 0.2 });
        let body = body.position(Vec3::Y * (-0.05 - above)).build().unwrap().spawn(&mut world);
        world.insert_one(body, hull).unwrap();
        let mut simulation = with_gravity_down(MoserVeselov);
        let mut most = 0.0_f64;
        for _ in 0..2000 {
            simulation.step(&mut world);
            most = most.max(attitude_error(dquat(world.get::<&Pose>(body).unwrap().orientation), DQuat::IDENTITY));
        }
        assert!(if turns_over { most > 1.0 } else { most < 0.06 }, "{above}: {most}");
    }
}
