//! The built-in scenes have the figures that their sources publish.
//!
//! They are what the documentation and the benchmarks point at; a slip in a file would make every
//! comparison with a published result wrong without anything failing.
#![allow(
    clippy::excessive_precision,
    reason = "figures are quoted with all the digits they were published or computed with"
)]

use tumble_scene::{Audit, AuditedBody, Scene, builtin_names};

/// Relative error that f64 arithmetic on a handful of terms may have.
const ROUNDING: f64 = 1e-14;

fn only_body(name: &str) -> AuditedBody {
    let mut bodies = Audit::open(name).unwrap().bodies;
    assert_eq!(bodies.len(), 1);
    bodies.remove(0)
}

fn assert_close(actual: [f64; 3], expected: [f64; 3], scale: f64) {
    for (actual, expected) in actual.into_iter().zip(expected) {
        assert!((actual - expected).abs() <= ROUNDING * scale, "{actual:e} is not {expected:e}");
    }
}

fn start(name: &str) -> tumble::Totals {
    let scene = Scene::open(name).unwrap();
    let settings = scene.settings;
    let mut world = hecs::World::new();
    scene.spawn(&mut world).unwrap();
    tumble::Totals::of(&world, &settings, &tumble::BodyOrder::of(&world))
}

/// The engine rounds to f32 in the default build: a few units of the last place.
fn engine_rounding() -> f64 {
    if tumble::math::PRECISION == "f32" { 5e-7 } else { ROUNDING }
}

#[test]
fn all_can_be_opened_and_none_has_a_problem() {
    for name in builtin_names() {
        assert!(Scene::open(name).is_ok(), "{name}");
        assert!(!Audit::open(name).unwrap().has_problems(), "{name}");
    }
}

/// Mass, centre of mass and moments of the two cylinders, computed with 34 digits.
#[test]
fn t_handle() {
    let body = only_body("t-handle");
    assert!((body.mass.unwrap() - 0.026640705702441446662).abs() < ROUNDING * 0.027);
    // The centre is the difference of two parts of 2e-5 kg m.
    assert_close(body.center_of_mass.unwrap(), [-9.4339622641509433962e-7, 0.0, 0.0], 0.00085);
    let moments = [1.4044510901824194605e-5, 1.4471663178126174069e-5, 1.6958530535276815661e-6];
    assert_close(body.principal.unwrap(), moments, 1.5e-5);
    let energy = start("t-handle").energy();
    let expected = 0.0028089745386807295518;
    assert!((energy - expected).abs() < engine_rounding() * expected, "{energy}");
}

/// The matrix has the opposite signs of the products of inertia that the report lists.
#[test]
fn iss() {
    let body = only_body("iss");
    assert_eq!(body.mass, Some(400_000.0));
    let [x, y, z] = body.tensor.unwrap();
    assert_close(x, [1.02e8, -6.96e6, -5.48e6], 1.64e8);
    assert_close(y, [-6.96e6, 9.1e7, 5.9e5], 1.64e8);
    assert_close(z, [-5.48e6, 5.9e5, 1.64e8], 1.64e8);
}

#[test]
fn van_zon_top() {
    assert_eq!(only_body("van-zon-top").principal, Some([10.0, 20.0, 26.0]));
    let totals = start("van-zon-top");
    assert_eq!(totals.angular_momentum.to_array(), [10.0, 300.0, 26.0]);
    assert_eq!(totals.energy(), 2268.0);
}

#[test]
fn drake_cylinder() {
    let body = only_body("drake-cylinder");
    assert_eq!((body.mass, body.principal), (Some(1.0), Some([0.04, 0.04, 0.02])));
    let energy = start("drake-cylinder").rotational_kinetic;
    assert!((energy - 0.76).abs() < engine_rounding() * 0.76, "{energy}");
}

#[test]
fn mujoco_box() {
    let body = only_body("mujoco-box");
    assert_close(body.principal.unwrap(), [0.13 / 3.0, 0.1 / 3.0, 0.05 / 3.0], 0.05);
    let energy = start("mujoco-box").energy();
    assert!((energy - 0.49 / 3.0).abs() < engine_rounding() * 0.16, "{energy}");
}
