//! Promise: frusta of cones and capsules whose ends differ have the volume, centre and inertia of
//! their geometry, also where they become a cone, a cylinder, a capsule or a sphere.
//!
//! It fails if a segment of a sphere is on the wrong side of its circle, or if digits are lost
//! where one sphere nearly holds the other.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use tumble_math::{Amount, MassProperties, Shape};
use tumble_tests::largest;

/// Of density one.
fn body(shape: &Shape) -> MassProperties {
    shape.mass_properties(Amount::Density(1.0)).unwrap()
}

/// Relative to the mass, the size and the largest moment.
fn difference(a: &MassProperties, b: &MassProperties) -> f64 {
    let tensor = largest(a.tensor_about_center() - b.tensor_about_center()) / largest(b.tensor_about_center());
    let size = (largest(b.tensor_about_center()) / b.mass()).sqrt();
    let center = (a.center_of_mass() - b.center_of_mass()).length() / size;
    tensor.max(center).max((a.mass() / b.mass() - 1.0).abs())
}

/// The solid whose squared radius at the height y is given, between two heights, by Simpson's rule
/// in `steps` pieces.
fn integrated(squared_radius: impl Fn(f64) -> f64, low: f64, high: f64, steps: u32) -> MassProperties {
    let step = (high - low) / f64::from(steps);
    let (mut area, mut first, mut second, mut fourth) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..=2 * steps {
        let weight = if i == 0 || i == 2 * steps {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        };
        let y = low + 0.5 * step * f64::from(i);
        let section = weight * step / 6.0 * PI * squared_radius(y);
        area += section;
        first += section * y;
        second += section * y * y;
        fourth += section * squared_radius(y);
    }
    let (center, axial) = (first / area, 0.5 * fourth);
    let transverse = 0.5 * axial + second - center * first;
    let tensor = DMat3::from_diagonal(DVec3::new(transverse, axial, transverse));
    let inertia = tumble_math::InertiaTensor::new(tensor).unwrap();
    MassProperties::new(area, DVec3::Y * center, inertia).unwrap()
}

/// The squared radius, at height y, of all spheres whose centre and radius go evenly from one to
/// the other: their union is the hull. At height y the largest is that of the t in 0 to 1 for which
/// `(a + (b - a) t)^2 - (y + h - 2 h t)^2` is largest, at an end or where the derivative is zero.
fn swept(a: f64, b: f64, h: f64, y: f64) -> f64 {
    let at = |t: f64| {
        let (radius, height) = (a + (b - a) * t, y + h - 2.0 * h * t);
        radius * radius - height * height
    };
    let flat = (2.0 * h * (y + h) + a * (b - a)) / (4.0 * h * h - (b - a) * (b - a));
    at(0.0).max(at(1.0)).max(at(flat.clamp(0.0, 1.0))).max(0.0)
}

#[test]
fn tapered_capsules_by_quadrature() {
    for (a, b, h) in
        [(0.3, 0.2, 0.5), (0.1, 0.4, 0.2), (0.5, 0.0, 0.4), (0.0, 1.0, 0.55), (1.0, 0.2, 5.0), (1.0, 0.4, 0.31)]
    {
        let exact = body(&Shape::tapered_capsule(a, b, h));
        let (low, high) = (f64::min(-h - a, h - b), f64::max(h + b, a - h));
        // Simpson's rule on pieces of polynomials whose second derivatives jump at two circles that
        // are no ends of pieces: an error of some jump times step^3, of 1e-5 the third power.
        let quadrature = integrated(|y| swept(a, b, h, y), low, high, 100_000);
        assert!(difference(&exact, &quadrature) <= 1e-12, "{a} {b} {h}: {:e}", difference(&exact, &quadrature));
        assert_eq!(Shape::tapered_capsule(a, b, h).volume(), Some(exact.mass()));
    }
}

#[test]
fn frusta_by_quadrature() {
    for (a, b, h) in [(0.3, 0.2, 0.5), (0.1, 0.4, 0.02), (0.5, 0.0, 0.4), (0.0, 1.0, 10.0)] {
        let exact = body(&Shape::frustum(a, b, h));
        let radius = |y: f64| a + (b - a) * (y + h) / (2.0 * h);
        // Polynomials of degree four, on which Simpson's rule errs by step^4 = 1e-16.
        let quadrature = integrated(|y| radius(y) * radius(y), -h, h, 10_000);
        assert!(difference(&exact, &quadrature) <= 1e-13, "{a} {b} {h}: {:e}", difference(&exact, &quadrature));
        assert_eq!(Shape::frustum(a, b, h).volume(), Some(exact.mass()));
    }
}

#[test]
fn impossible_ends_are_named() {
    let error = |shape: &Shape| shape.mass_properties(Amount::Mass(1.0)).unwrap_err().to_string();
    let range = "must be a length from 1e-90 to 1e90 m, it is";
    assert_eq!(error(&Shape::frustum(0.0, 0.0, 1.0)), format!("radius_top {range} 0.0"));
    assert_eq!(error(&Shape::tapered_capsule(1.0, -1.0, 1.0)), format!("radius_top {range} -1.0"));
    assert_eq!(error(&Shape::tapered_capsule(f64::NAN, 1.0, 1.0)), format!("radius_bottom {range} NaN"));
    assert_eq!(error(&Shape::frustum(1.0, 0.5, 0.0)), format!("half_height {range} 0.0"));
}

proptest! {
    #[test]
    fn limits_are_the_simpler_shapes(r in 1e-3..1e3_f64, ratio in 1e-3..1e3_f64, less in 0.0..1.0_f64) {
        // All terms are positive, so errors are some eps each.
        let tolerance = 1e-14;
        let h = r * ratio;
        prop_assert!(difference(&body(&Shape::tapered_capsule(r, r, h)), &body(&Shape::capsule(r, h))) <= tolerance);
        prop_assert!(difference(&body(&Shape::frustum(r, r, h)), &body(&Shape::cylinder(r, h))) <= tolerance);
        prop_assert!(difference(&body(&Shape::frustum(r, 0.0, h)), &body(&Shape::cone(r, h))) <= tolerance);

        // One sphere inside the other, by 0 to 1 of the room there is.
        let distance = r * less;
        let held = Shape::tapered_capsule((r - distance) * 0.999, r, (0.5 * distance).max(1e-80));
        let sphere = body(&Shape::sphere(r)).transformed(DVec3::Y * 0.5 * distance, glam::DQuat::IDENTITY).unwrap();
        prop_assert!(difference(&body(&held), &sphere) <= tolerance);
        // Just outside of it, the little that sticks out changes little: by the square of how far,
        // and never by a jump.
        let out = body(&Shape::tapered_capsule(r * 0.5, r, r * 0.25 * (1.0 + 1e-9)));
        let sphere = body(&Shape::sphere(r)).transformed(DVec3::Y * 0.25 * r, glam::DQuat::IDENTITY).unwrap();
        prop_assert!(difference(&out, &sphere) <= 1e-8);
    }

    /// Turned upside down, the ends change places.
    #[test]
    fn upside_down(a in 0.0..2.0_f64, b in 1e-3..2.0_f64, h in 1e-2..3.0_f64) {
        for (up, down) in [
            (Shape::tapered_capsule(a, b, h), Shape::tapered_capsule(b, a, h)),
            (Shape::frustum(a, b, h), Shape::frustum(b, a, h)),
        ] {
            let turned = body(&down).transformed(DVec3::ZERO, glam::DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)).unwrap();
            prop_assert!(difference(&body(&up), &turned) <= 1e-14);
        }
    }

    /// Whatever the lengths, numbers come out that are finite and those of a body.
    #[test]
    fn extremes_are_no_trouble(exponents in prop::array::uniform3(-90.0..90.0_f64)) {
        let [a, b, h] = exponents.map(|x| 10.0_f64.powf(x));
        for shape in [Shape::tapered_capsule(a, b, h), Shape::frustum(a, b, h), Shape::frustum(a, 0.0, h)] {
            let properties = shape.mass_properties(Amount::Mass(1.0)).unwrap();
            prop_assert!(properties.center_of_mass().is_finite());
            prop_assert!(properties.tensor_about_center().col(1).y > 0.0);
            prop_assert!(properties.tensor_about_center().is_finite());
        }
    }
}
