//! Promise: mass, centre and inertia of bodies made of particles, shapes and compounds obey the
//! laws they come from, and no input panics.
//!
//! Additivity, particles against integrals, shapes cut up and put together, thin walls, and errors
//! that say which part is wrong.

use crate::strategies::{EPS, anything, length, rotation, vector};
use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;
use tumble_math::{Amount, MassProperties, Part, Shape, moment_about_axis};
use tumble_tests::largest;

fn close(a: DMat3, b: DMat3, relative: f64) -> bool {
    largest(a - b) <= relative * largest(b)
}

fn same_body(a: &MassProperties, b: &MassProperties, relative: f64) -> bool {
    let size = (largest(b.tensor_about([0.0; 3])) / b.mass()).sqrt();
    (a.mass() - b.mass()).abs() <= relative * b.mass()
        && (a.center_of_mass() - b.center_of_mass()).length() <= relative * size.max(b.center_of_mass().length())
        && largest(a.tensor_about_center() - b.tensor_about_center()) <= relative * largest(b.tensor_about([0.0; 3]))
}

fn particles() -> impl Strategy<Value = Vec<(f64, DVec3)>> {
    prop::collection::vec((0.1..10.0_f64, vector(5.0)), 4..20)
}

fn shape() -> impl Strategy<Value = Shape> {
    let lengths = || prop::array::uniform3(length());
    prop_oneof![
        length().prop_map(Shape::sphere),
        lengths().prop_map(Shape::cuboid),
        lengths().prop_map(|l| Shape::cylinder(l[0], l[1])),
        lengths().prop_map(|l| Shape::capsule(l[0], l[1])),
        lengths().prop_map(|l| Shape::cone(l[0], l[1])),
        lengths().prop_map(Shape::ellipsoid),
    ]
}

proptest! {
    #[test]
    fn particles_are_the_definition(particles in particles(), point in vector(5.0), axis in vector(1.0)) {
        prop_assume!(axis.length() > 1e-3);
        let body = MassProperties::of_particles(particles.clone()).unwrap();
        let mass: f64 = particles.iter().map(|(mass, _)| mass).sum();
        let center = particles.iter().map(|(mass, position)| *position * *mass).sum::<DVec3>() / mass;
        // Twenty particles, one rounding each of a few products.
        let tolerance = 64.0 * EPS;
        prop_assert!((body.mass() - mass).abs() <= tolerance * mass);
        prop_assert!((body.center_of_mass() - center).length() <= tolerance * 10.0);
        let n = axis.normalize();
        let about_point = n.dot(body.tensor_about(point) * n);
        let expected = moment_about_axis(particles.clone(), point, axis);
        prop_assert!((about_point - expected).abs() <= tolerance * largest(body.tensor_about(point)));
        // Whatever the particles, what they make up is a body.
        prop_assert!(body.inertia().is_ok());
    }

    #[test]
    fn additive_in_any_grouping(particles in particles(), cut in 1..4_usize, far in vector(100.0), turn in rotation()) {
        let (left, right) = particles.split_at(cut);
        let whole = MassProperties::of_particles(particles.clone()).unwrap();
        let [left, right] = [left, right].map(|part| MassProperties::of_particles(part.to_vec()).unwrap());
        prop_assert!(same_body(&(left + right), &whole, 64.0 * EPS));
        prop_assert!(same_body(&(right + left), &whole, 64.0 * EPS));
        // Moved and turned first or last.
        let moved = |body: &MassProperties| body.transformed(far, turn).unwrap();
        prop_assert!(same_body(&(moved(&left) + moved(&right)), &moved(&whole), 64.0 * EPS));
        // And taken away again: the sum's rounding, on both, magnified by the ratio of what was
        // there to what is left.
        let again = whole.without(&right).unwrap();
        let magnified = 256.0 * EPS * whole.mass() / left.mass();
        prop_assert!((again.center_of_mass() - left.center_of_mass()).length() <= magnified * 10.0);
        let difference = again.tensor_about_center() - left.tensor_about_center();
        prop_assert!(largest(difference) <= magnified * largest(whole.tensor_about([0.0; 3])));
    }

    #[test]
    fn a_compound_is_the_sum_of_its_parts(
        parts in prop::collection::vec((shape(), vector(3.0), rotation(), 0.1..9.0_f64), 1..6),
    ) {
        let parts: Vec<Part> = parts
            .into_iter()
            .map(|(shape, position, orientation, mass)| {
                Part::new(shape, Amount::Mass(mass)).at(position).turned(orientation)
            })
            .collect();
        let sum = parts
            .iter()
            .map(|part| {
                let alone = part.shape.mass_properties(part.amount).unwrap();
                alone.transformed(part.position, part.orientation).unwrap()
            })
            .reduce(|a, b| a + b)
            .unwrap();
        let compound = Shape::compound(parts);
        prop_assert_eq!(compound.own_mass_properties().unwrap(), sum);
        let doubled = compound.mass_properties(Amount::Mass(2.0 * sum.mass())).unwrap();
        prop_assert!(same_body(&doubled, &sum.scaled_to_mass(2.0 * sum.mass()).unwrap(), 4.0 * EPS));
        prop_assert!(doubled.inertia().is_ok());
    }

    #[test]
    fn a_density_is_a_mass_over_a_volume(shape in shape(), density in 1.0..1e4_f64) {
        let body = shape.mass_properties(Amount::Density(density)).unwrap();
        prop_assert!((body.mass() / shape.volume().unwrap() / density - 1.0).abs() <= 4.0 * EPS);
        let same = shape.mass_properties(Amount::Mass(body.mass())).unwrap();
        prop_assert_eq!(body, same);
    }

    #[test]
    fn shapes_cut_up(half in prop::array::uniform3(length()), cut in 0.1..0.9_f64) {
        let amount = Amount::Density(700.0);
        let [a, h, b] = half;
        let tolerance = 32.0 * EPS;
        // A cone is a frustum and a smaller cone on top; mid-heights at -h + cut h and
        // h - (1 - cut) h.
        let (low, high) = (h * cut, h * (1.0 - cut));
        let top = Shape::cone(a * (1.0 - cut), high).mass_properties(amount).unwrap();
        let bottom = MassProperties::frustum(a, a * (1.0 - cut), low, amount).unwrap();
        let put_together = bottom.transformed([0.0, low - h, 0.0], DQuat::IDENTITY).unwrap()
            + top.transformed([0.0, h - high, 0.0], DQuat::IDENTITY).unwrap();
        prop_assert!(same_body(&put_together, &Shape::cone(a, h).mass_properties(amount).unwrap(), tolerance));
        // A frustum with equal radii is a cylinder, a capsule a cylinder and two hemispheres.
        let cylinder = Shape::cylinder(a, h).mass_properties(amount).unwrap();
        prop_assert!(same_body(&MassProperties::frustum(a, a, h, amount).unwrap(), &cylinder, tolerance));
        let cap = MassProperties::hemisphere(a, amount).unwrap();
        let upside_down = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
        let capsule = cylinder + cap.transformed([0.0, h, 0.0], DQuat::IDENTITY).unwrap()
            + cap.transformed([0.0, -h, 0.0], upside_down).unwrap();
        prop_assert!(same_body(&Shape::capsule(a, h).mass_properties(amount).unwrap(), &capsule, tolerance));
        // A tube is a cylinder without its core, a thick shell a ball without its core.
        // (Subtraction loses digits.)
        let core = Shape::cylinder(a * cut, h).mass_properties(amount).unwrap();
        let tube = MassProperties::tube(a, a * cut, h, amount).unwrap();
        prop_assert!(close(tube.tensor_about_center(), cylinder.without(&core).unwrap().tensor_about_center(), 1e-13));
        let ball = |r: f64| Shape::sphere(r).mass_properties(amount).unwrap();
        let shell = MassProperties::thick_shell(a, a * cut, amount).unwrap();
        let hollowed = ball(a).without(&ball(a * cut)).unwrap();
        prop_assert!(close(shell.tensor_about_center(), hollowed.tensor_about_center(), 1e-13));
        // A pyramid is two tetrahedra.
        let corner = |x: f64, z: f64| DVec3::new(x * a, -h, z * b);
        let pyramid = MassProperties::pyramid(a, b, h, amount).unwrap();
        let halves = [[(1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)], [(1.0, 1.0), (-1.0, -1.0), (-1.0, 1.0)]].map(|base| {
            let [p, q, r] = base.map(|(x, z)| corner(x, z));
            MassProperties::tetrahedron([p, q, r, DVec3::Y * h], amount).unwrap()
        });
        prop_assert!(same_body(&(halves[0] + halves[1]), &pyramid, tolerance));
    }

    #[test]
    fn any_body_is_judged_without_a_panic(
        lengths in prop::array::uniform3(anything()),
        amount in anything(),
        kind in 0..16_usize,
        position in prop::array::uniform3(anything()),
        orientation in prop::array::uniform4(anything()),
        density: bool,
    ) {
        let [a, b, c] = lengths;
        let amount = if density { Amount::Density(amount) } else { Amount::Mass(amount) };
        let shape = |shape: Shape| {
            let part = Part::new(shape, amount).at(position).turned(DQuat::from_array(orientation));
            Shape::compound([part]).own_mass_properties()
        };
        let body = match kind {
            0 => shape(Shape::Point),
            1 => shape(Shape::sphere(a)),
            2 => shape(Shape::hollow_sphere(a)),
            3 => shape(Shape::cuboid(lengths)),
            4 => shape(Shape::cylinder(a, b)),
            5 => shape(Shape::capsule(a, b)),
            6 => shape(Shape::cone(a, b)),
            7 => shape(Shape::ellipsoid(lengths)),
            8 => MassProperties::hemisphere(a, amount),
            9 => MassProperties::frustum(a, b, c, amount),
            10 => MassProperties::pyramid(a, b, c, amount),
            11 => MassProperties::tetrahedron([position.into(), lengths.into(), DVec3::ZERO, DVec3::X], amount),
            12 => MassProperties::tube(a, b, c, amount),
            13 => MassProperties::thick_shell(a, b, amount),
            14 => MassProperties::thin_rod(a, b),
            _ => MassProperties::thin_disc(a, b),
        };
        match body {
            Ok(body) => {
                prop_assert!(body.mass() > 0.0 && body.center_of_mass().is_finite());
                prop_assert!(body.tensor_about_center().is_finite());
                prop_assert!((body + body).tensor_about_center().is_finite());
                let _ = body.inertia();
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}

/// Walls down to an ulp of the radius: the closed forms go over into the thin shell and the thin
/// cylinder.
#[test]
fn thin_walls_cost_no_digits() {
    for wall in [1e-3, 1e-6, 1e-9, 1e-12, 4.0 * EPS] {
        let inner = 1.0 - wall;
        let thickness = 1.0 - inner; // what is left of it in f64, exactly
        let shell = MassProperties::thick_shell(1.0, inner, Amount::Density(1.0)).unwrap();
        // V = 4 pi t (1 - t + t^2/3), I = 2/3 m (1 - t + ...): series in the thickness t, next term
        // below.
        let t = thickness;
        let volume = 4.0 * std::f64::consts::PI * t * (1.0 - t + t * t / 3.0);
        assert!((shell.mass() / volume - 1.0).abs() <= 4.0 * EPS, "{wall}");
        let s4 = 5.0 - 10.0 * t + 10.0 * t * t - 5.0 * t.powi(3) + t.powi(4);
        let moment = 0.4 * shell.mass() * s4 / (3.0 - 3.0 * t + t * t);
        assert!((shell.tensor_about_center().x_axis.x / moment - 1.0).abs() <= 8.0 * EPS, "{wall}");

        let tube = MassProperties::tube(1.0, inner, 2.0, Amount::Density(1.0)).unwrap();
        let volume = 4.0 * std::f64::consts::PI * t * (2.0 - t);
        assert!((tube.mass() / volume - 1.0).abs() <= 4.0 * EPS);
        let axial = tube.mass() * (1.0 - t + 0.5 * t * t);
        assert!((tube.tensor_about_center().y_axis.y / axial - 1.0).abs() <= 4.0 * EPS);
    }
}

#[test]
fn bodies_that_cannot_be_say_where() {
    let sphere = |radius: f64| Part::new(Shape::sphere(radius), Amount::Mass(1.0));
    let inner = Part::new(Shape::compound([sphere(1.0), sphere(f64::NAN)]), Amount::Mass(1.0));
    let error = Shape::compound([sphere(1.0), inner]).own_mass_properties().unwrap_err();
    assert_eq!((error.part.as_slice(), error.field()), ([1, 1].as_slice(), "radius"));
    assert_eq!(error.path(), "parts[1].parts[1].radius");
    assert!(error.to_string().starts_with("parts[1].parts[1].radius must be"), "{error}");

    let message = |result: Result<MassProperties, tumble_math::ShapeError>| result.unwrap_err().to_string();
    assert!(message(Shape::Point.mass_properties(Amount::Density(1.0))).starts_with("density has no meaning"));
    assert!(message(Shape::hollow_sphere(1.0).mass_properties(Amount::Density(1.0))).starts_with("density"));
    assert!(message(Shape::sphere(1.0).mass_properties(Amount::Mass(0.0))).starts_with("mass must be positive"));
    assert!(message(Shape::sphere(1.0).mass_properties(Amount::Density(-1.0))).starts_with("density must be"));
    assert!(message(Shape::sphere(1.0).own_mass_properties()).starts_with("mass must be given"));
    assert!(message(Shape::compound([]).own_mass_properties()).starts_with("parts of a compound must not be empty"));
    let tilted = sphere(1.0).turned(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.5));
    assert!(message(Shape::compound([tilted]).own_mass_properties()).starts_with("parts[0].orientation must be"));
    let lost = sphere(1.0).at(DVec3::new(0.0, f64::INFINITY, 0.0));
    assert!(message(Shape::compound([lost]).own_mass_properties()).starts_with("parts[0].position"));

    let big = Shape::sphere(2.0).mass_properties(Amount::Density(1.0)).unwrap();
    let small = Shape::sphere(1.0).mass_properties(Amount::Density(1.0)).unwrap();
    assert!(small.without(&big).is_err(), "heavier than what it is taken from");
    let outside = small.transformed([5.0, 0.0, 0.0], DQuat::IDENTITY).unwrap();
    assert!(big.without(&outside).is_err(), "sticks out");
    assert!(MassProperties::of_particles([]).is_err());
    let error = MassProperties::of_particles([(1.0, DVec3::ZERO), (0.0, DVec3::X)]).unwrap_err();
    assert!(error.to_string().starts_with("particle 1: mass must be positive"), "{error}");
}

#[test]
fn deep_nesting_is_refused_not_overflowed() {
    let nested = |depth: usize| {
        (0..depth).fold(Shape::sphere(1.0), |shape, _| Shape::compound([Part::new(shape, Amount::Mass(1.0))]))
    };
    assert!(nested(Shape::MAX_DEPTH).own_mass_properties().is_ok() && nested(Shape::MAX_DEPTH).volume().is_some());
    let one_more = nested(Shape::MAX_DEPTH + 1);
    assert!(one_more.own_mass_properties().is_err() && one_more.volume().is_none());
    let deep = nested(1000);
    assert!(deep.own_mass_properties().is_err());
    assert!(deep.volume().is_none());
}
