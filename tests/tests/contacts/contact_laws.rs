//! Promise: what a contact does is what statics and the theory of impacts have on paper: what tips
//! and what does not, the impulse of a blow that turns both bodies, when sliding has stopped, how
//! fast an overlap goes.
//!
//! Why: each expression that is behind these was once changed by hand, a sign, a factor, a term,
//! and no test noticed.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{CombineRule, Material};
use tumble_math::PrincipalInertia;
use tumble_tests::touching::{collider, ground, pose, spawn, surfaced, velocity};
use tumble_tests::{Draw, by_precision, dvec3, quat, run, vec3};

const G: f64 = 9.81;
/// A substep at default settings \[s\].
const SUBSTEP: f64 = 1.0 / 240.0;

/// A block that juts out over the edge of a table tips where its centre of mass does, and falls
/// over the edge as `d^2 a/dt^2 = m g x/(I + m r^2)`: any size, any direction, an edge of the table
/// along any axis.
#[test]
fn what_juts_out_tips_from_half_its_length_on() {
    for case in 0..60 {
        let mut draw = Draw::new(1907, case);
        let half = DVec3::new(1.0, draw.between(0.1, 0.6), draw.between(0.3, 2.0)) * draw.log_between(0.1, 5.0);
        let out = if case % 2 == 0 { draw.between(0.05, 0.45) } else { draw.between(0.55, 0.75) };
        let about = DQuat::from_rotation_y(draw.between(0.0, TAU));
        let table = DVec3::new(3.0, 1.0, 3.0) * half.max_element();
        let mut world = World::new();
        let surface = Material::new(1.0, 0.0);
        let shape = Shape::cuboid(table);
        let fixed =
            RigidBody::new(shape.clone()).fixed().orientation(quat(about)).position(vec3(DVec3::NEG_Y * table.y));
        spawn(&mut world, fixed, surfaced(collider(&shape), surface));
        // The edge is at table.x; the block ends at `out` of its length beyond it.
        let center = DVec3::new(table.x - half.x + 2.0 * half.x * out, half.y, 0.0);
        let body = RigidBody::new(Shape::cuboid(half)).mass(draw.log_between(1e-3, 1e6));
        let body = body.position(vec3(about * center)).orientation(quat(about));
        let block = spawn(&mut world, body, surfaced(collider(&Shape::cuboid(half)), surface));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let tilt = |world: &World| (pose(world, block).orientation * Vec3::Y).angle_between(Vec3::Y);
        if case % 2 == 0 {
            run(&mut simulation, &mut world, 120);
            // It sinks by 69 micrometres, and all of it into the edge where it juts out that far.
            let most = 1e-3_f64.max(20.0 * 69e-6 / half.x);
            assert!(f64::from(tilt(&world)) < most, "case {case}: {out} of it out, tilts by {}", tilt(&world));
            continue;
        }
        let lever = center.x - table.x;
        let moment = (half.x * half.x + half.y * half.y) / 3.0 + lever * lever + half.y * half.y;
        let rate = G * lever / moment;
        // Until it has tilted by a tenth: cos and the height of its middle then change the torque
        // by that part.
        let steps = ((0.2 / rate).sqrt() * 60.0).ceil();
        run(&mut simulation, &mut world, steps as u32);
        let expected = 0.5 * rate * (steps / 60.0).powi(2);
        let error = f64::from(tilt(&world)) / expected - 1.0;
        // Half of a substep in each of the steps, and what it sinks by first.
        let allowed = 0.12 * (1.0 + half.y / lever) + 1.0 / steps;
        println!("case {case}: {out:.2} out, {steps} steps, {error:.3} of {allowed:.3}");
        assert!(error.abs() < allowed, "case {case}: {out} of it out, tilts by {} for {expected}", tilt(&world));
    }
}

/// A body of a blow.
struct Part {
    entity: Entity,
    mass: f64,
    /// In the world \[kg m^2\].
    inertia: DMat3,
    velocity: DVec3,
    spin: DVec3,
    center: DVec3,
}

impl Part {
    fn new(draw: &mut Draw, mass: f64, size: f64) -> Self {
        let moments = (DVec3::ONE + draw.vector(0.3)) * (0.3 * mass * size * size);
        let inertia = DMat3::from_diagonal(moments);
        let (velocity, spin, center) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        Self { entity: Entity::DANGLING, mass, inertia, velocity, spin, center }
    }

    fn spawn(&mut self, world: &mut World, shape: &Shape, orientation: DQuat, surface: Material) {
        let moments = DVec3::new(self.inertia.x_axis.x, self.inertia.y_axis.y, self.inertia.z_axis.z);
        let body = RigidBody::new(shape.clone())
            .mass(self.mass)
            .principal_inertia(PrincipalInertia { moments, axes: DQuat::IDENTITY })
            .position(vec3(self.center))
            .orientation(quat(orientation))
            .linear_velocity(vec3(self.velocity))
            .angular_velocity(vec3(self.spin));
        let rotation = DMat3::from_quat(orientation);
        self.inertia = rotation * self.inertia * rotation.transpose();
        self.entity = spawn(world, body, surfaced(collider(shape), surface));
    }

    /// Change of the velocity at an arm by an impulse along `n` there, along `n`.
    fn answer(&self, arm: DVec3, n: DVec3) -> f64 {
        1.0 / self.mass + (self.inertia.inverse() * arm.cross(n)).cross(arm).dot(n)
    }
}

/// A corner of one box hits the face of another, both free, both off their centres, without
/// friction: `J = (1 + e) v_n/(n K n)`, where both bodies turn.
#[test]
fn a_blow_turns_both_bodies_as_their_arms_have_it() {
    let mut worst = 0.0_f64;
    for case in 0..300 {
        let mut draw = Draw::new(1907, case);
        let size = draw.log_between(0.05, 5.0);
        let mass = draw.log_between(1e-3, 1e6);
        let ratio = draw.log_between(0.1, 10.0);
        let (mut target, mut striker) = (Part::new(&mut draw, mass, size), Part::new(&mut draw, mass * ratio, size));
        let surface = Material::new(0.0, draw.between(0.3, 1.0) as Real);
        let half = DVec3::new(1.0, 0.4, 1.0) * size;
        // The place on the upper face of the target, and the corner that comes down on it, tilted.
        let place = DVec3::new(draw.between(-0.7, 0.7), 0.4, draw.between(-0.7, 0.7)) * size;
        let corner = DVec3::new(0.4, -0.5, 0.3) * size;
        let upright = DQuat::from_rotation_arc(corner.normalize(), DVec3::NEG_Y);
        let tilted =
            DQuat::from_axis_angle(DVec3::new(draw.between(-1.0, 1.0), 0.0, draw.between(-1.0, 1.0)).normalize(), 0.3)
                * upright;
        let turned = draw.orientation();
        let normal = turned * DVec3::Y;
        striker.center = turned * (place - tilted * corner) + normal * (1e-4 * size);
        let speed = draw.between(2.0, 10.0);
        striker.velocity = normal * -speed;
        let mut world = World::new();
        let shape = Shape::cuboid(corner.abs());
        if case % 2 == 0 {
            target.spawn(&mut world, &Shape::cuboid(half), turned, surface);
            striker.spawn(&mut world, &shape, turned * tilted, surface);
        } else {
            striker.spawn(&mut world, &shape, turned * tilted, surface);
            target.spawn(&mut world, &Shape::cuboid(half), turned, surface);
        }
        // So short a step that nothing turns in it: 0.4 mm of a metre.
        let dt = 4e-4 * size / speed;
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(dt as Real);
        let mut simulation = Simulation::new(settings).unwrap();
        run(&mut simulation, &mut world, 3);

        let arms = [turned * place, turned * (tilted * corner)];
        let answers = target.answer(arms[0], normal) + striker.answer(arms[1], normal);
        let impulse = (1.0 + f64::from(surface.restitution)) * speed / answers;
        for (part, arm, sign) in [(&target, arms[0], -1.0), (&striker, arms[1], 1.0)] {
            let now = velocity(&world, part.entity);
            let gained = [dvec3(now.linear) - part.velocity, dvec3(now.angular)];
            let jump = normal * (sign * impulse);
            let expected = [jump / part.mass, part.inertia.inverse() * arm.cross(jump)];
            let scale = [impulse / part.mass, expected[1].length() + impulse / part.mass / size];
            for which in 0..2 {
                let error = (gained[which] - expected[which]).length() / scale[which];
                worst = worst.max(error);
                // What the bodies turn until the end of the blow, 1e-3 at the most, and its arm
                // with that.
                assert!(error < 4e-3, "case {case}, {which}: {} for {}, {error}", gained[which], expected[which]);
            }
        }
    }
    println!("worst: {worst:e}");
}

/// Friction of a square plate whose half side is 1, as the limit surface of its patch has it, in
/// substeps: what holds if it can, with one mass for sliding and twisting where it cannot, and by
/// the lesser coefficient where static friction would not stop that.
struct Plate {
    still: f64,
    moving: f64,
}

impl Plate {
    /// Mean distance from the middle of a square of side 2, as the engine has it, and the moment
    /// about the vertical over the mass.
    const RADIUS: f64 = 0.541 * std::f64::consts::SQRT_2;
    const MOMENT: f64 = 2.0 / 3.0;
    /// Mean of what an impulse does along a direction, over one over the mass: half of it for the
    /// twist.
    const MEAN: f64 = 1.0 + 0.5 * Self::RADIUS * Self::RADIUS / Self::MOMENT;

    /// What is left of a speed that friction resists with this mass, as a part of the body's: one
    /// along the ground, the moment over the square of the radius for the twist.
    fn after(&self, speed: f64, mass: f64) -> f64 {
        let hold = self.still * G * SUBSTEP;
        if speed * mass <= hold {
            0.0
        } else if speed / Self::MEAN <= hold {
            speed - speed / Self::MEAN / mass
        } else {
            speed - self.moving * G * SUBSTEP / mass
        }
    }

    /// A plate so flat that friction does not tip it, at rest on the ground.
    fn at_rest(draw: &mut Draw) -> (Self, World, Entity, Simulation) {
        let plate = Self { still: draw.between(2.0, 6.0), moving: draw.between(0.05, 0.4) };
        let surface = Material { static_friction: plate.still as Real, ..Material::new(plate.moving as Real, 0.0) };
        let (half, mut world) = (DVec3::new(1.0, 1e-3, 1.0), World::new());
        ground(&mut world, surface, Quat::IDENTITY);
        let moments = DVec3::new(1.0, 2.0, 1.0) / 3.0;
        let body = RigidBody::new(Shape::cuboid(half))
            .mass(1.0)
            .principal_inertia(PrincipalInertia { moments, axes: DQuat::IDENTITY })
            .position(vec3(DVec3::Y * half.y))
            .orientation(quat(DQuat::from_rotation_y(draw.between(0.0, TAU))));
        let body = spawn(&mut world, body, surfaced(collider(&Shape::cuboid(half)), surface));
        // One substep a step: what a second begins with is the friction of the first.
        let settings = Settings::default().with_dt(SUBSTEP as Real).with_contact_substeps(1);
        let mut simulation = Simulation::new(settings).unwrap();
        run(&mut simulation, &mut world, 240);
        (plate, world, body, simulation)
    }
}

/// Sliding is over when static friction can take what is left in one substep: above, a plate goes
/// on with `mu_d g`. In any direction.
#[test]
fn what_static_friction_stops_in_a_substep_has_stopped() {
    for case in 0..80 {
        let mut draw = Draw::new(1907, case);
        let (plate, mut world, body, mut simulation) = Plate::at_rest(&mut draw);
        let start = draw.between(0.1, 2.5) * plate.still * G * SUBSTEP;
        let way = DQuat::from_rotation_y(draw.between(0.0, TAU)) * DVec3::X;
        world.get::<&mut Momentum>(body).unwrap().linear = vec3(way * start);
        simulation.step(&mut world);
        let expected = plate.after(start, 1.0);
        let left = dvec3(velocity(&world, body).linear);
        assert!(
            (left - way * expected).length() < 5e-3 * start,
            "case {case}: {left} for {} of {start}",
            way * expected
        );
    }
}

/// The same of a spin about the vertical, with the radius of the patch as its arm.
#[test]
fn what_static_friction_stops_spinning_in_a_substep_has_stopped() {
    for case in 0..80 {
        let mut draw = Draw::new(1907, case);
        let (plate, mut world, body, mut simulation) = Plate::at_rest(&mut draw);
        let mass = Plate::MOMENT / Plate::RADIUS.powi(2);
        let start = draw.between(0.1, 2.5) * plate.still * G * SUBSTEP / mass;
        let sign = if case % 2 == 0 { 1.0 } else { -1.0 };
        world.get::<&mut Momentum>(body).unwrap().angular =
            vec3(DVec3::Y * (sign * start / Plate::RADIUS * Plate::MOMENT));
        simulation.step(&mut world);
        let expected = plate.after(start, mass) * sign;
        let left = f64::from(velocity(&world, body).angular.y) * Plate::RADIUS;
        assert!((left - expected).abs() < 5e-3 * start, "case {case}: {left} for {expected} of {start}");
    }
}

/// A ball that touches at one point, with three different moments, turned any way about the
/// vertical: what an impulse along the ground does there is a matrix `K` with a coupling of both
/// directions. In one substep it sticks, `J = -K^-1 u`, or what slips is resisted with the mean of
/// `K`, `J = -2 u/trace(K)`, where static friction can take that, or by the dynamic coefficient.
#[test]
fn what_slips_on_a_point_is_resisted_as_its_moments_have_it() {
    let mut seen = [0; 3];
    for case in 0..120 {
        let mut draw = Draw::new(1907, case);
        let (still, moving) = (draw.between(1.0, 3.0), draw.between(0.1, 0.5));
        let surface = Material { static_friction: still as Real, ..Material::new(moving as Real, 0.0) };
        let (radius, mut world) = (draw.log_between(0.3, 3.0), World::new());
        ground(&mut world, surface, Quat::IDENTITY);
        let moments = DVec3::new(0.2, 0.6, 0.5) * (radius * radius);
        let orientation = DQuat::from_rotation_y(draw.between(0.0, TAU));
        let shape = Shape::sphere(radius);
        let body = RigidBody::new(shape.clone())
            .mass(1.0)
            .principal_inertia(PrincipalInertia { moments, axes: DQuat::IDENTITY })
            .position(vec3(DVec3::Y * radius))
            .orientation(quat(orientation));
        let ball = spawn(&mut world, body, surfaced(collider(&shape), surface));
        let settings = Settings::default().with_dt(SUBSTEP as Real).with_contact_substeps(1);
        let mut simulation = Simulation::new(settings).unwrap();
        run(&mut simulation, &mut world, 240);
        let (hold, rub) = (still * G * SUBSTEP, moving * G * SUBSTEP);
        let direction = DQuat::from_rotation_y(draw.between(0.0, TAU)) * DVec3::X;
        let slip = direction * (draw.between(0.1, 8.0) * hold);
        world.get::<&mut Momentum>(ball).unwrap().linear = vec3(slip);
        simulation.step(&mut world);

        let (rotation, arm) = (DMat3::from_quat(orientation), DVec3::NEG_Y * radius);
        let inverse = rotation * DMat3::from_diagonal(moments.recip()) * rotation.transpose();
        let answer = |j: DVec3| j + (inverse * arm.cross(j)).cross(arm);
        let (x, z) = (answer(DVec3::X), answer(DVec3::Z));
        let determinant = x.x * z.z - x.z * z.x;
        let stick = DVec3::new(z.z * slip.x - z.x * slip.z, 0.0, x.x * slip.z - x.z * slip.x) / determinant;
        let mean = slip * (2.0 / (x.x + z.z));
        let (which, impulse) = if stick.length() <= hold {
            (0, -stick)
        } else if mean.length() <= hold {
            (1, -mean)
        } else {
            (2, -direction * rub)
        };
        // Where two of the three are within rounding of each other, either may be.
        if (stick.length() / hold - 1.0).abs() < 1e-3 || (mean.length() / hold - 1.0).abs() < 1e-3 {
            continue;
        }
        seen[which] += 1;
        let now = velocity(&world, ball);
        let linear = (dvec3(now.linear) - (slip + impulse)).length() / slip.length();
        let spin = (dvec3(now.angular) - inverse * arm.cross(impulse)).length() * radius / slip.length();
        assert!(linear.max(spin) < 2e-3, "case {case}, {which}: {linear}, {spin}");
    }
    assert!(seen.iter().all(|count| *count > 8), "{seen:?}");
}

/// The same ball with a resistance to rolling that nothing overcomes and no friction: it turns
/// about the vertical only after a substep.
#[test]
fn resistance_to_rolling_stops_both_directions() {
    for case in 0..24 {
        let mut draw = Draw::new(1907, case);
        let surface = Material { rolling_resistance: 1e3, ..Material::new(0.0, 0.0) };
        let (radius, mut world) = (draw.log_between(0.3, 3.0), World::new());
        ground(&mut world, surface, Quat::IDENTITY);
        let moments = DVec3::new(0.2, 0.6, 0.5) * (radius * radius);
        let shape = Shape::sphere(radius);
        let body = RigidBody::new(shape.clone())
            .mass(1.0)
            .principal_inertia(PrincipalInertia { moments, axes: DQuat::IDENTITY })
            .position(vec3(DVec3::Y * radius))
            .orientation(quat(DQuat::from_rotation_y(draw.between(0.0, TAU))));
        let ball = spawn(&mut world, body, surfaced(collider(&shape), surface));
        let settings = Settings::default().with_dt(SUBSTEP as Real).with_contact_substeps(1);
        let mut simulation = Simulation::new(settings).unwrap();
        run(&mut simulation, &mut world, 60);
        let start = draw.vector(0.1) * radius * radius;
        world.get::<&mut Momentum>(ball).unwrap().angular = vec3(start);
        simulation.step(&mut world);
        let now = dvec3(velocity(&world, ball).angular);
        let allowed = 1e-3 * start.length() / moments.x;
        assert!(now.x.abs().max(now.z.abs()) < allowed, "case {case}: {now}");
        assert!((now.y - start.y / moments.y).abs() < allowed, "case {case}: {now}");
    }
}

/// An overlap goes as the oscillator of the documents has it: with `w` of a quarter of a period in
/// a substep, and half of that between bodies that both move, a part `w h a2/((1 + a2) a1)` of it
/// in each substep, but no faster than 3 m/s.
#[test]
fn an_overlap_goes_as_the_damped_oscillator_has_it() {
    let rate = |periods: f64, damping: f64| {
        let turn = TAU * periods;
        let a1 = 2.0 * damping + turn;
        let a2 = turn * a1;
        turn / a1 * (a2 / (1.0 + a2))
    };
    for case in 0..80 {
        let mut draw = Draw::new(1907, case);
        let both_move = case % 2 == 0;
        let part = if both_move { rate(0.125, 10.0) } else { rate(0.25, 5.0) };
        let (radius, mass) = (draw.log_between(0.5, 5.0), draw.log_between(1e-3, 1e6));
        let depth = radius * draw.log_between(0.02, 0.4);
        let dt = 1.0 / draw.log_between(60.0, 500.0);
        let mut world = World::new();
        let (surface, shape) = (Material::new(0.0, 0.0), Shape::sphere(radius));
        let below = RigidBody::new(shape.clone()).position(vec3(DVec3::NEG_Y * radius));
        let below = if both_move { below.mass(mass * draw.log_between(0.1, 10.0)) } else { below.fixed() };
        let lower = spawn(&mut world, below, surfaced(collider(&shape), surface));
        let above = RigidBody::new(shape.clone()).mass(mass).position(vec3(DVec3::Y * (radius - depth)));
        let upper = spawn(&mut world, above, surfaced(collider(&shape), surface));
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(dt as Real);
        let mut simulation = Simulation::new(settings).unwrap();
        let steps = 12;
        run(&mut simulation, &mut world, steps);
        let expected = (0..4 * steps).fold(depth, |depth, _| depth - (part * depth).min(3.0 * dt / 4.0));
        let found = 2.0 * radius - f64::from(pose(&world, upper).position.y - pose(&world, lower).position.y);
        // In single precision a place is rounded in each of 48 substeps.
        let allowed = 1e-4 * depth + by_precision(48.0 * 1.2e-7 * radius, 0.0);
        assert!((found - expected).abs() < allowed, "case {case}: {found} for {expected} of {depth}");
        let velocities = [upper, lower].map(|ball| world.get::<&Velocity>(ball).map_or(Vec3::ZERO, |v| v.linear));
        let speed = f64::from(velocities[0].length() + velocities[1].length());
        assert!(speed < 1e-3 * depth / dt, "case {case}: the push's velocity is left, {speed} m/s");
    }
}

/// A wheel that a torque drives along without slipping: the torque's work is torque times angle,
/// and the wheel gets it all.
#[test]
fn a_torque_on_what_rolls_does_its_work() {
    for case in 0..24 {
        let mut draw = Draw::new(1907, case);
        let radius = draw.log_between(0.05, 3.0);
        let mass = draw.log_between(1e-2, 1e4);
        let mut world = World::new();
        let surface = Material { friction_combine: CombineRule::Minimum, ..Material::new(5.0, 0.0) };
        ground(&mut world, surface, Quat::IDENTITY);
        let (shape, lying, part) = if case % 2 == 0 {
            (Shape::sphere(radius), DQuat::IDENTITY, 0.4)
        } else {
            (Shape::cylinder(radius, 0.5 * radius), DQuat::from_rotation_x(TAU / 4.0), 0.5)
        };
        let heading = DQuat::from_rotation_y(draw.between(0.0, TAU));
        let body = RigidBody::new(shape.clone()).mass(mass).position(vec3(DVec3::Y * radius));
        let wheel = spawn(&mut world, body.orientation(quat(heading * lying)), surfaced(collider(&shape), surface));
        // A fifth of what slips, and less where that would turn it by over a tenth of a radian in a
        // step.
        let acceleration = (0.3 * G * draw.between(0.1, 1.0)).min(3.0 * radius);
        let torque = mass * radius * (1.0 + part) * acceleration;
        let vector = vec3(heading * DVec3::NEG_Z * torque);
        let is_law = draw.between(0.0, 1.0) < 0.5;
        if is_law {
            world.insert_one(wheel, ConstantWrench { torque: vector, ..ConstantWrench::default() }).unwrap();
        }
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        tumble::Ledger::attach(&mut world, &simulation);
        let steps = 120;
        for _ in 0..steps {
            if !is_law {
                world.get::<&mut Wrench>(wheel).unwrap().add_torque(vector);
            }
            simulation.step(&mut world);
        }
        let work = *world.get::<&tumble::Work>(wheel).unwrap();
        let done = if is_law { work.of("ConstantWrench").unwrap() } else { work.applied };
        let way = (dvec3(pose(&world, wheel).position) * DVec3::new(1.0, 0.0, 1.0)).length();
        let seconds = f64::from(steps) / 60.0;
        // Half a substep more than at constant acceleration, as places follow velocities.
        assert!((way / (0.5 * acceleration * seconds * seconds) - 1.0).abs() < 1e-2, "case {case}: {way} m");
        assert!(
            (done / (torque * way / radius) - 1.0).abs() < 2e-3,
            "case {case}: {done} J for {}",
            torque * way / radius
        );
        let kinetic = 0.5 * mass * (1.0 + part) * dvec3(velocity(&world, wheel).linear).length_squared();
        assert!((work.total() / kinetic - 1.0).abs() < 1e-3, "case {case}: {work:?} for {kinetic} J");
        // The rest is what substeps of first order make of a constant force, and what it sinks by.
        assert!(work.contacts.abs() < 1.5e-2 * kinetic, "case {case}: {work:?}");
    }
}

/// A box that slides without friction through something thick loses `e^(-2 b t)` of its energy, all
/// of it to damping.
#[test]
fn damping_of_what_slides_does_the_work_that_decays() {
    for case in 0..12 {
        let mut draw = Draw::new(1907, case);
        let (rate, speed, half) = (draw.between(5.0, 40.0), draw.between(1.0, 5.0), draw.log_between(0.1, 2.0));
        let mut world = World::new();
        let (surface, shape) = (Material::new(0.0, 0.0), Shape::cuboid([half; 3]));
        ground(&mut world, surface, Quat::IDENTITY);
        let body = RigidBody::new(shape.clone()).mass(2.0).position(vec3(DVec3::Y * half));
        let body =
            body.linear_velocity(Vec3::X * speed as Real).damping(Damping { linear: rate as Real, angular: 0.0 });
        let body = spawn(&mut world, body, surfaced(collider(&shape), surface));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        tumble::Ledger::attach(&mut world, &simulation);
        run(&mut simulation, &mut world, 6);
        let work = *world.get::<&tumble::Work>(body).unwrap();
        let expected = speed * speed * ((-2.0 * rate * 0.1).exp() - 1.0);
        // What damping takes of the millimetres a second that gravity gives in a substep is booked
        // too.
        assert!((work.damping / expected - 1.0).abs() < 2e-3, "case {case}: {work:?} for {expected} J");
    }
}
