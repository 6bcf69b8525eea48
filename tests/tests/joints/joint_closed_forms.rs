//! Promise: bodies on joints move as the closed forms of mechanics say: pendulum, gyroscope in
//! gimbals, Foucault's pendulum, carousel and universal joint, to the second order in the substep,
//! and what cylinder, plane and weld leave free; what a hinge carries is what it should; energy has
//! no trend.
//!
//! Why: joints that are soft, or that lose energy, are what other engines are known for. It fails
//! if a row's axis is taken from the wrong body, an arm or a frame is forgotten, or
//! positions and velocities are met at different times.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::math::Real;
use tumble::{Joint, RigidBody, Shape, weld};
use tumble_tests::references::real_quat;
use tumble_tests::{DOUBLE, attitude_error, by_precision, dvec3, seconds};

/// Complete elliptic integral of the first kind of the parameter m, by the arithmetic-geometric
/// mean.
fn elliptic_k(m: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (1.0 - m).sqrt());
    for _ in 0..10 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// A rod of 1 kg and 1 m on a hinge about z, horizontal and at rest, with its joint.
fn rod_pendulum(dt: f64, substeps: u32) -> (Rig, Entity, Entity) {
    let mut rig = Rig::new(down(), dt, substeps);
    let ground = rig.ground();
    let rod = rig.spawn(rod(1.0, 1.0, DVec3::X * 0.5));
    let joint = rig.join_at(Joint::hinge(ground, rod), ORIGIN, DVec3::Z);
    (rig, rod, joint)
}

/// Of the rod let go at 90 degrees \[s\].
fn exact_period() -> f64 {
    4.0 * elliptic_k(0.5) / (1.5 * G).sqrt()
}

/// The period of the rod, from crossings of the lowest point in ten swings, found on the cubic
/// through angles and rates of both ends of the step.
fn measured_period(substep: f64) -> f64 {
    let (mut rig, rod, _) = rod_pendulum(substep, 1);
    let h = seconds(substep as Real);
    let mut crossings = Vec::new();
    let mut before = (FRAC_PI_2, 0.0);
    while crossings.len() < 11 {
        rig.step();
        let now = (angle_from_down(rig.position(rod)), rig.angular_velocity(rod).z);
        if before.0 < 0.0 && now.0 >= 0.0 {
            crossings.push(rig.simulation.time() - h + h * root_of_cubic(before, now, h));
        }
        before = now;
    }
    (crossings[10] - crossings[0]) / 10.0
}

/// Where in a step the cubic through values and slopes at its ends is zero, from 0 to 1.
fn root_of_cubic((y0, v0): (f64, f64), (y1, v1): (f64, f64), h: f64) -> f64 {
    let cubic = |s: f64| {
        let r = 1.0 - s;
        r * r * ((1.0 + 2.0 * s) * y0 + s * h * v0) + s * s * ((3.0 - 2.0 * s) * y1 - r * h * v1)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if cubic(middle) < 0.0 { low = middle } else { high = middle }
    }
    low
}

#[test]
fn a_rod_has_the_elliptic_period() {
    let exact = exact_period();
    let errors = [60.0, 120.0, 240.0].map(|rate| measured_period(1.0 / rate) / exact - 1.0);
    println!("period {exact:.7} s, off by {errors:?} of it at 60, 120, 240 substeps/s");
    assert!(errors[2].abs() <= 6e-5, "{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((ratio - 4.0).abs() <= by_precision(0.4, 0.2), "{ratio}");
    }
}

/// Along the rod `5/2 m g cos`, across it `1/4 m g sin`.
#[test]
fn the_hinge_carries_what_the_closed_form_says() {
    let (mut rig, rod, joint) = rod_pendulum(1.0 / 960.0, 1);
    let mut worst = 0.0_f64;
    let mut most = 0.0_f64;
    let mut before = FRAC_PI_2;
    for _ in 0..2000 {
        rig.step();
        let now = angle_from_down(rig.position(rod));
        let (sine, cosine) = (0.5 * (before + now)).sin_cos();
        before = now;
        let inward = DVec3::new(-sine, cosine, 0.0) * (2.5 * G * cosine);
        let across = DVec3::new(cosine, sine, 0.0) * (0.25 * G * sine);
        let force = dvec3(rig.load(joint).force);
        worst = worst.max((force - inward - across).length());
        most = most.max(force.length());
    }
    println!("force off by {worst:.1e} N, at most {:.6} m g", most / G);
    assert!(worst <= by_precision(4e-3, 1e-4) && (most / G - 2.5).abs() <= 1e-4, "{worst:e} N, {most} N");
}

/// A thousand periods at 240 substeps/s. Where the map is symplectic, energy swings by a multiple
/// of `(w h)^2` and has no trend; in single precision the state is rounded 116 000 times.
#[test]
fn a_rod_keeps_its_energy_for_a_thousand_periods() {
    let (mut rig, ..) = rod_pendulum(1.0 / 60.0, 4);
    let swing = 0.5 * G;
    let mut of_periods = Vec::new();
    let steps_of_ten = (10.0 * exact_period() * 60.0) as u32;
    let mut widest = 0.0_f64;
    for _ in 0..100 {
        let mut sum = 0.0;
        for _ in 0..steps_of_ten {
            rig.step();
            sum += rig.energy();
            widest = widest.max(rig.energy().abs());
        }
        of_periods.push(sum / f64::from(steps_of_ten));
    }
    let trend = (of_periods[99] - of_periods[0]) / swing;
    println!("energy of 10 periods after 990: {trend:.1e} of the swing's, at most {:.1e} off", widest / swing);
    assert!(trend.abs() <= by_precision(1e-3, 1e-10), "{trend:e}");
    assert!(widest / swing <= by_precision(1e-3, 2e-4), "{widest:e}");
}

/// A rotor whose centre of mass is off the crossing of its axes, in two rings with mass, on three
/// hinges. With A, C the rotor's moments about the crossing and a, b, c those of the inner ring,
/// steady precession at the tilt t is `(A + b - c) cos t P^2 - C w P + m g l = 0`.
#[test]
fn a_gyroscope_in_gimbals_precesses_steadily() {
    let (mass, offset, tilt, spin) = (2.0, 0.05, 1.0_f64, 120.0);
    let (across, axial) = (4e-3, 6e-3);
    let inner = DVec3::new(2e-3, 4e-3, 2e-3);
    let outer = DVec3::new(3e-3, 3e-3, 6e-3);
    let a = (across + mass * offset * offset + inner.y - inner.z) * tilt.cos();
    let (b, c) = (axial * spin, mass * G * offset);
    let rate = 2.0 * c / (b + (b * b - 4.0 * a * c).sqrt());
    let errors = [1.0, 2.0].map(|finer| {
        let mut rig = Rig::new(DVec3::NEG_Z * G, 1e-3 / finer, 1);
        let ground = rig.ground();
        let turn = DVec3::Z * rate;
        // Tilted about x, the inner hinge.
        let to_axis = DQuat::from_rotation_x(tilt);
        let axis = to_axis * DVec3::Z;
        let outer_ring = rig.spawn(body(1.0, outer, ORIGIN).angular_velocity(real(turn)));
        let inner_ring = turned(body(1.0, inner, ORIGIN), DVec3::X, tilt).angular_velocity(real(turn));
        let inner_ring = rig.spawn(inner_ring);
        let center = axis * offset;
        // The spin is the whole angular velocity along the axis.
        let angular = turn + axis * (spin - turn.dot(axis));
        let rotor = turned(body(mass, DVec3::new(across, across, axial), center), DVec3::X, tilt);
        let rotor = rig.spawn(turning_about(rotor, center, ORIGIN, angular));
        rig.join_at(Joint::hinge(ground, outer_ring), ORIGIN, DVec3::Z);
        rig.join_at(Joint::hinge(outer_ring, inner_ring), ORIGIN, DVec3::X);
        rig.join_at(Joint::hinge(inner_ring, rotor), ORIGIN, axis);
        let (mut worst, mut gap) = (0.0_f64, 0.0_f64);
        for _ in 0..200 * finer as u32 {
            (0..10).for_each(|_| rig.step());
            let exact = DQuat::from_rotation_z(rate * rig.simulation.time()) * axis;
            worst = worst.max((rig.orientation(rotor) * DVec3::Z - exact).length());
            gap = gap.max(rig.largest_gap());
        }
        println!("gaps {gap:.1e} m");
        assert!(gap <= by_precision(2e-7, 3e-9), "{gap:e}");
        worst
    });
    println!("precession {rate:.3} rad/s, axis off by {:.1e}, {:.1e} at 1, 2 substeps/ms", errors[0], errors[1]);
    assert!(errors[0] <= 1e-4, "{errors:?}");
    let ratio = errors[0] / errors[1];
    assert!(!DOUBLE || (ratio - 4.0).abs() <= 0.2, "{ratio}");
}

/// Foucault at the pole: a ball joint under a support that turns drags nothing along, so the plane
/// of the swing stands still and turns by `-W t` as the support sees it; and the rod gets no spin.
#[test]
fn foucaults_plane_stands_still_under_a_turning_support() {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let support = RigidBody::new(Shape::Point).kinematic().angular_velocity(real(DVec3::Y * 0.7));
    let support = rig.spawn(support);
    // The rod's x points up; it hangs 20 degrees off.
    let hanging = |angle: f64| DVec3::new(angle.sin(), -angle.cos(), 0.0) * 0.5;
    let start = hanging(20.0_f64.to_radians());
    let rod =
        rig.spawn(rod(1.0, 1.0, start).orientation(real_quat(DQuat::from_rotation_arc(DVec3::X, -start.normalize()))));
    rig.join_at(Joint::ball(support, rod), ORIGIN, DVec3::X);
    let (mut aside, mut turned) = (0.0_f64, 0.0_f64);
    for _ in 0..60 * 60 {
        rig.step();
        let place = rig.position(rod);
        aside = aside.max(place.z.abs());
        // Where the plane is as the support sees it, where the swing is wide.
        if place.x > 0.16 {
            let seen = rig.orientation(support).conjugate() * place;
            let expected = 0.7 * rig.simulation.time();
            let off = (seen.z.atan2(seen.x) - expected).rem_euclid(TAU);
            turned = turned.max(off.min(TAU - off));
        }
    }
    println!("in 60 s: {aside:.1e} m aside, plane off by {turned:.1e} rad");
    // In single precision joints are met to a tenth of the rounding of the state.
    assert!(aside <= by_precision(1.2e-8, 1e-15) && turned <= by_precision(1e-5, 1e-13), "{aside:e}, {turned:e}");
}

/// The carousel: a rod on a hinge that a kinematic body carries round at `W`, `R` off the axis. It
/// keeps the tilt t at which `m g l sin t = W^2 (m R l + (A - C) sin t) cos t`, and swung by,
/// Jacobi's integral `A t'^2/2 - W^2 (m R l sin t + (A - C)/2 sin^2 t) - m g l cos t`.
#[test]
fn a_carousel_has_its_tilt_and_jacobis_integral() {
    let (speed, reach, l) = (3.0, 0.4, 0.5);
    // A rod of 1 kg and 1 m, about the hinge; its own moment about itself is a hundredth.
    let (a, c) = (1.0 / 12.0 + 0.25, 0.01 / 12.0);
    let pull = |t: f64| speed * speed * (reach * l + (a - c) * t.sin()) * t.cos() - G * l * t.sin();
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if pull(middle) > 0.0 { low = middle } else { high = middle }
    }
    let run = |start: f64, substeps: u32| {
        let mut rig = Rig::new(down(), 1.0 / 60.0, substeps);
        let turn = DVec3::Y * speed;
        let arm = rig.spawn(RigidBody::new(Shape::Point).kinematic().angular_velocity(real(turn)));
        let center = DVec3::new(reach + l * start.sin(), -l * start.cos(), 0.0);
        let rod = turned(rod(1.0, 1.0, center), DVec3::Z, start - FRAC_PI_2);
        let rod = rig.spawn(turning_about(rod, center, ORIGIN, turn));
        rig.join_at(Joint::hinge(arm, rod), DVec3::X * reach, DVec3::Z);
        let mut swing = Vec::new();
        for _ in 0..600 {
            rig.step();
            let axis = rig.orientation(arm).conjugate() * (rig.orientation(rod) * DVec3::X);
            let tilt = angle_from_down(axis);
            let rate = (rig.orientation(arm).conjugate() * rig.angular_velocity(rod)).z;
            let swung = reach * l * tilt.sin() + 0.5 * (a - c) * tilt.sin().powi(2);
            swing.push((tilt, 0.5 * a * rate * rate - speed * speed * swung - G * l * tilt.cos()));
        }
        swing
    };
    let off = run(low, 4).iter().map(|it| (it.0 - low).abs()).fold(0.0, f64::max);
    let spread = [4, 8].map(|substeps| {
        let swing = run(low + 0.8, substeps);
        swing.iter().map(|it| (it.1 - swing[0].1).abs()).fold(0.0, f64::max)
    });
    println!("tilt {low:.4} off by {off:.1e}; Jacobi's integral by {:.1e}, {:.1e} J", spread[0], spread[1]);
    assert!(off <= 5e-5, "{off:e}");
    assert!(spread[0] <= 4e-4 && (!DOUBLE || (spread[0] / spread[1] - 4.0).abs() <= 0.2), "{spread:?}");
}

/// Two shafts at 30 degrees: the second turns by `atan(cos b tan f)` where the first has turned by
/// f, at `cos b / (1 - sin^2 b sin^2 f)` of its speed: from 0.8660 to 1.1547.
#[test]
fn a_universal_joint_has_its_speed_ratio() {
    let bend = 30.0_f64.to_radians();
    let (speed, output) = (5.0, DVec3::new(bend.cos(), bend.sin(), 0.0));
    let mut rig = Rig::new(down(), 1.0 / 240.0, 4);
    let ground = rig.ground();
    let input = rig.spawn(RigidBody::new(Shape::Point).kinematic().angular_velocity(real(DVec3::X * speed)));
    let shaft = turned(body(2.0, DVec3::new(0.02, 0.1, 0.1), output), DVec3::Z, bend);
    let shaft = rig.spawn(shaft.angular_velocity(real(output * (speed * bend.cos()))));
    rig.join_at(Joint::hinge(ground, shaft), output * 2.0, output);
    // The cross: x of the first frame along z of the world, y of the second across the other shaft.
    let of_input = DQuat::from_rotation_arc(DVec3::X, DVec3::Z);
    let cross =
        Joint::universal(input, shaft).with_frames(frame(ORIGIN, of_input), frame(DVec3::NEG_X, DQuat::IDENTITY));
    rig.join(cross);
    let (mut of_angle, mut of_ratio) = (0.0_f64, 0.0_f64);
    let mut range = [f64::MAX, f64::MIN];
    for _ in 0..1200 {
        rig.step();
        let arm = rig.orientation(input) * DVec3::Z;
        let (sine, cosine) = (-arm.y, arm.z);
        let other = rig.orientation(shaft) * DVec3::Z;
        let across = output.cross(DVec3::Z);
        let off = (other.dot(DVec3::Z) * sine * bend.cos() - other.dot(across) * cosine).abs();
        of_angle = of_angle.max(off);
        let ratio = rig.angular_velocity(shaft).dot(output) / speed;
        of_ratio = of_ratio.max((ratio - bend.cos() / (1.0 - (bend.sin() * sine).powi(2))).abs());
        range = [range[0].min(ratio), range[1].max(ratio)];
    }
    println!("angle off by {of_angle:.1e} rad, ratio by {of_ratio:.1e}, from {:.4} to {:.4}", range[0], range[1]);
    assert!(
        of_angle <= by_precision(2e-6, 2e-10) && of_ratio <= by_precision(1e-6, 2e-11),
        "{of_angle:e}, {of_ratio:e}"
    );
    assert!((range[0] - 0.8660).abs() <= 2e-4 && (range[1] - 1.1547).abs() <= 2e-4, "{range:?}");
}

/// A body off the axis of a sleeve, with inertia about no axis of it, goes along a helix: its
/// speeds along and about the axis stay, and it turns by `asin(w h)` a substep.
#[test]
fn a_cylinder_joint_lets_a_body_go_along_a_helix() {
    let (axis, point) = (DVec3::new(0.48, 0.6, 0.64), DVec3::new(0.2, -0.1, 0.3));
    let (spin, speed) = (4.0, 0.7);
    let start = point + DVec3::new(0.3, 0.1, -0.2);
    let late = [1, 2].map(|finer| {
        let mut rig = Rig::new(ORIGIN, 1.0 / 60.0, 4 * finer);
        let ground = rig.ground();
        let spinning = body(2.0, DVec3::new(0.02, 0.03, 0.04), start).angular_velocity(real(axis * spin));
        let velocity = axis * speed + (axis * spin).cross(start - point);
        let it = rig.spawn(spinning.linear_velocity(real(velocity)));
        let joint = rig.join_at(Joint::cylinder(ground, it), point, axis);
        let (mut off, mut of_speed) = (0.0_f64, 0.0_f64);
        for _ in 0..300 {
            rig.step();
            let time = rig.simulation.time();
            let turn = DQuat::from_axis_angle(axis, spin * time);
            let exact = point + turn * (start - point) + axis * (speed * time);
            off = off.max((rig.position(it) - exact).length());
            let of_axis = (rig.velocity(it).dot(axis) - speed).abs();
            of_speed = of_speed.max(of_axis).max((rig.angular_velocity(it) - axis * spin).length());
            let values = rig.load(joint).values;
            assert!((f64::from(values[0]) - speed * time).abs() <= by_precision(1e-5, 1e-9), "{values:?}");
        }
        println!("helix off by {off:.1e} m, speeds by {of_speed:.1e}, gaps {:.1e} m", rig.largest_gap());
        assert!(rig.largest_gap() <= by_precision(4e-6, 1e-11), "{:e}", rig.largest_gap());
        assert!(of_speed <= by_precision(4e-5, 4e-10), "{of_speed:e}");
        off
    });
    assert!(late[0] <= 6e-4 && (!DOUBLE || (late[0] / late[1] - 4.0).abs() <= 0.2), "{late:?}");
}

/// A box that spins on a slope falls along a parabola: gravity along the plane acts alone, and the
/// joint carries `m g cos` across it.
#[test]
fn a_planar_joint_lets_a_body_slide_and_spin() {
    let slope = 0.4_f64;
    let normal = DVec3::new(slope.sin(), slope.cos(), 0.0);
    let along = down() - normal * down().dot(normal);
    let (velocity, spin) = (DVec3::Z * 0.8 - along * 0.1, 6.0);
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let sliding = body(3.0, DVec3::new(0.02, 0.05, 0.06), ORIGIN).linear_velocity(real(velocity));
    let it = rig.spawn(sliding.angular_velocity(real(normal * spin)));
    let joint = rig.join_at(Joint::planar(ground, it), ORIGIN, normal);
    let (mut off, mut above, mut of_load, mut of_spin) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..120 {
        rig.step();
        let time = rig.simulation.time();
        off = off.max((rig.position(it) - velocity * time - along * (0.5 * time * time)).length());
        let load = rig.load(joint);
        above = above.max(f64::from(load.values[0]).abs());
        of_load = of_load.max((dvec3(load.force) - normal * (3.0 * G * slope.cos())).length());
        of_spin = of_spin.max((rig.angular_velocity(it) - normal * spin).length());
    }
    println!("off by {off:.1e} m, {above:.1e} m off the plane, force by {of_load:.1e} N, spin by {of_spin:.1e}");
    assert!(off <= by_precision(6e-6, 1e-13) && above <= by_precision(4e-7, 1e-15), "{off:e}, {above:e}");
    assert!(of_load <= by_precision(1e-4, 1e-8) && of_spin <= by_precision(6e-6, 1e-10), "{of_load:e}, {of_spin:e}");
}

/// Two boxes on a fixed joint fly and tumble as the one body that `weld` makes of them, and keep
/// their momenta.
#[test]
fn a_fixed_joint_makes_one_body() {
    let errors = [4, 8].map(|substeps| {
        let mut rig = Rig::new(ORIGIN, 1.0 / 60.0, substeps);
        let (first, second) = (DVec3::new(0.1, 0.0, -0.2), DVec3::new(0.6, 0.3, 0.0));
        let turn = DVec3::new(1.0, 2.0, -1.5);
        let box_at = |place: DVec3, mass: f64, half: DVec3| {
            turning_about(
                RigidBody::new(Shape::cuboid(half)).without_collider().mass(mass).position(real(place)),
                place,
                ORIGIN,
                turn,
            )
        };
        let a = rig.spawn(box_at(first, 2.0, DVec3::new(0.1, 0.2, 0.3)));
        let b = rig.spawn(turned(box_at(second, 1.0, DVec3::new(0.3, 0.1, 0.1)), DVec3::Y, 0.7));
        let mut one = Rig::new(ORIGIN, 1.0 / 960.0, 1);
        let welded = weld(&rig.world, &[a, b]).unwrap().spawn(&mut one.world);
        let arm = rig.position(a) - one.position(welded);
        rig.join_at(Joint::fixed(a, b), 0.5 * (first + second), DVec3::X);
        let (start, mut worst) = (rig.totals(), [0.0_f64; 2]);
        for _ in 0..180 {
            rig.step();
            one.run_to(rig.simulation.time());
            let (turn, of_one) = (rig.orientation(a), one.orientation(welded));
            let place = one.position(welded) + of_one * arm;
            worst[0] = worst[0].max(attitude_error(turn, of_one)).max((rig.position(a) - place).length());
            let now = rig.totals();
            let momentum = (now.linear_momentum - start.linear_momentum).length();
            let angular = (now.angular_momentum - start.angular_momentum).length();
            worst[1] = worst[1].max(momentum).max(angular);
        }
        println!("{substeps} substeps: off by {:.1e} rad or m, momenta by {:.1e}", worst[0], worst[1]);
        assert!(worst[1] <= by_precision(2e-6, 2e-14), "{:e}", worst[1]);
        worst[0]
    });
    assert!(errors[0] <= 6e-4 && (!DOUBLE || (errors[0] / errors[1] - 4.0).abs() <= 0.4), "{errors:?}");
}
