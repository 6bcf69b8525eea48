//! Promise: Andrews' squeezing mechanism, seven bodies of grams in three closed loops, is after
//! 30 ms where the Test Set for Initial Value Problem Solvers has it, with second order in the
//! substep.
//!
//! Why: it is the benchmark that codes for multibody systems are compared by. Ten hinges have 50
//! rows, of which 41 are independent, four bodies meet in one point, and a crank turns at 1140
//! rad/s. It fails if redundant rows carry what does not belong to them, or if impulses of loops
//! are split wrongly.

use crate::jointed::*;
use glam::{DQuat, DVec3};
use tumble::{ConstantWrench, Joint, Limit, Limits};
use tumble_tests::references::real_quat;
use tumble_tests::{DOUBLE, by_precision};

/// Masses \[kg\] and moments about the middle [kg m^2], in the order of the source: W. Schiehlen
/// (ed.), "Multibody Systems Handbook", 1990; F. Mazzia and C. Magherini, "Test Set for Initial
/// Value Problem Solvers", release 2.4, problem `andrews`.
const MASSES: [f64; 7] = [0.04325, 0.00365, 0.02373, 0.00706, 0.0705, 0.00706, 0.05498];
const MOMENTS: [f64; 7] = [2.194e-6, 4.41e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];
/// The points on the ground \[m\], and the torque on the crank [N m].
const A: DVec3 = DVec3::new(-0.06934, -0.00227, 0.0);
const B: DVec3 = DVec3::new(-0.03635, 0.03273, 0.0);
const C: DVec3 = DVec3::new(0.014, 0.072, 0.0);
const TORQUE: f64 = 0.033;
/// The source's angles \[rad\] beta, Theta, gamma, Phi, delta, Omega, epsilon: at the start, and
/// with their speeds [rad/s] after 30 ms.
const START: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_4,
    0.222_668_390_165_885_88,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_88,
    1.230_547_444_549_821_2,
];
const END: [f64; 7] = [
    15.810_771_196_299_04,
    -15.756_371_059_842_98,
    0.040_822_240_130_731_01,
    -0.534_730_116_322_694_8,
    0.524_409_965_880_530_4,
    0.534_730_116_322_694_8,
    1.048_080_741_042_263,
];
const SPEEDS: [f64; 7] = [
    1_139.920_302_151_208,
    -1_424.379_294_994_111,
    11.032_912_219_371_34,
    19.293_374_644_213_85,
    0.573_569_928_479_080_8,
    -19.293_374_644_213_85,
    0.323_179_165_802_695_5,
];

/// Of each body, from the source's angles or speeds.
fn of_bodies([beta, theta, gamma, phi, delta, omega, epsilon]: [f64; 7]) -> [f64; 7] {
    [beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon]
}

/// After 30 ms, the largest error of an angle \[rad\] and of a speed, of the crank's.
fn squeezed(substeps: u32) -> [f64; 2] {
    let mut rig = Rig::new(DVec3::ZERO, 1e-3, substeps);
    let ground = rig.ground();
    let angles = of_bodies(START);
    let [x, y] = [DVec3::X, DVec3::Y].map(|axis| angles.map(|angle| DQuat::from_rotation_z(angle) * axis));
    let pin = x[0] * 0.007;
    let meeting = pin - x[1] * 0.028;
    let (elbow, knee) = (A + x[4] * 0.04, A - y[6] * 0.04);
    let centers = [
        x[0] * 0.00092,
        pin - x[1] * 0.0115,
        B - y[2] * 0.01874 + x[2] * 0.01043,
        elbow - y[3] * (0.02 - 0.01421),
        A + x[4] * 0.02308 + y[4] * 0.00916,
        knee + x[5] * (0.02 - 0.01421),
        A - y[6] * 0.01228 - x[6] * 0.00449,
    ];
    let bodies = [0, 1, 2, 3, 4, 5, 6].map(|number: usize| {
        let it = body(MASSES[number], DVec3::splat(MOMENTS[number]), centers[number]);
        rig.spawn(it.orientation(real_quat(DQuat::from_rotation_z(angles[number]))))
    });
    let torque = ConstantWrench { torque: real(DVec3::Z * TORQUE), ..ConstantWrench::default() };
    rig.world.insert_one(bodies[0], torque).unwrap();
    for (body, at) in [(0, ORIGIN), (2, B), (4, A), (6, A)] {
        rig.join_at(Joint::hinge(ground, bodies[body]), at, DVec3::Z);
    }
    for (first, second, at) in
        [(0, 1, pin), (1, 2, meeting), (1, 3, meeting), (1, 5, meeting), (4, 3, elbow), (6, 5, knee)]
    {
        rig.join_at(Joint::hinge(bodies[first], bodies[second]), at, DVec3::Z);
    }
    let held = B - y[2] * 0.018 + x[2] * 0.02;
    let turned_back = DQuat::from_rotation_z(-angles[2]);
    let frames = [frame(C, DQuat::IDENTITY), frame(turned_back * (held - centers[2]), DQuat::IDENTITY)];
    let spring = rig.join(Joint::free(ground, bodies[2]).with_frames(frames[0], frames[1]));
    let length = Limit::new(0.077_85, 0.077_85).with_stiffness(4530.0, 0.0);
    rig.world.insert_one(spring, Limits { distance: Some(length), ..Limits::default() }).unwrap();
    rig.run_to(0.03);
    let (angles, speeds) = (of_bodies(END), of_bodies(SPEEDS));
    let mut worst = [0.0_f64; 2];
    for (number, body) in bodies.into_iter().enumerate() {
        let off = (rig.orientation(body) * DVec3::X - DQuat::from_rotation_z(angles[number]) * DVec3::X).length();
        let speed_off = (rig.angular_velocity(body) - DVec3::Z * speeds[number]).length() / SPEEDS[0];
        worst = [worst[0].max(off), worst[1].max(speed_off)];
    }
    println!("{substeps} substeps/ms: angles off by {:.1e} rad, speeds by {:.1e}", worst[0], worst[1]);
    worst
}

#[test]
fn andrews_squeezer_is_where_the_test_set_has_it() {
    let [coarse, fine] = [100, 200].map(squeezed);
    assert!(coarse[0] <= 5e-5 && coarse[1] <= 3e-5, "{coarse:?}");
    assert!(fine[0] <= by_precision(3e-5, 1e-5), "{fine:?}");
    assert!(!DOUBLE || (coarse[0] / fine[0] - 4.0).abs() <= 0.1, "{coarse:?} {fine:?}");
}
