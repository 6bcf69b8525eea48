//! Promise: mass, centre of mass, inertia and principal moments agree with published figures.
//!
//! Every figure of `tests/data/inertia_*.json` is compared at the tolerance stated in the file,
//! relative to the largest figure of its kind (a zero has no relative error of its own). It fails
//! if a formula of a shape, the parallel-axis theorem, a frame or a sign is wrong, and prints the
//! worst error of each file when asked with `--nocapture`.

use crate::reference::{Check, list, matrix};
use glam::{DMat3, DQuat, DVec3};
use serde_json::Value;
use tumble_math::{Amount, InertiaError, InertiaTensor, MassProperties, Part, Shape, quat_from_matrix};
use tumble_tests::largest;
use tumble_tests::references::{number, parse, vector};

/// Errors relative to the expected figure.
impl Check {
    fn scalar(&mut self, what: &str, actual: f64, expected: f64) {
        self.error(what, (actual - expected).abs() / expected.abs());
    }

    fn matrix(&mut self, what: &str, actual: DMat3, expected: DMat3) {
        self.error(what, largest(actual - expected) / largest(expected));
    }

    fn each(&mut self, what: &str, actual: DVec3, expected: DVec3) {
        for axis in 0..3 {
            self.scalar(what, actual[axis], expected[axis]);
        }
    }
}

fn sorted(v: DVec3) -> DVec3 {
    let mut v = v.to_array();
    v.sort_by(f64::total_cmp);
    v.into()
}

/// Mass properties of a record of `inertia_shapes.json`, and how far up its origin lies from ours.
fn of_record(record: &Value) -> (MassProperties, f64) {
    let p = &record["params"];
    let get = |key: &str| number(&p[key]);
    let amount = match p.get("mass") {
        Some(mass) => Amount::Mass(number(mass)),
        None => Amount::Density(number(&record["density"])),
    };
    let shape = |shape: Shape| shape.mass_properties(amount).unwrap();
    match record["shape"].as_str().unwrap() {
        "box" | "khr_default_box" => (shape(Shape::cuboid(vector(&p["size"]) * 0.5)), 0.0),
        "sphere" | "khr_default_sphere" => (shape(Shape::sphere(get("radius"))), 0.0),
        "hollow_sphere_thin" => (shape(Shape::hollow_sphere(get("radius"))), 0.0),
        "hollow_sphere_thick" => (MassProperties::thick_shell(get("outer"), get("inner"), amount).unwrap(), 0.0),
        "cylinder_y" => (shape(Shape::cylinder(get("radius"), get("height") / 2.0)), 0.0),
        "khr_default_cylinder" => (shape(Shape::cylinder(get("radiusTop"), get("height") / 2.0)), 0.0),
        "tube_y" => (MassProperties::tube(get("outer"), get("inner"), get("height") / 2.0, amount).unwrap(), 0.0),
        "cone_y" => (shape(Shape::cone(get("radiusBottom"), get("height") / 2.0)), 0.0),
        "capsule_y" => (shape(Shape::capsule(get("radius"), get("height") / 2.0)), 0.0),
        "khr_default_capsule" => (shape(Shape::capsule(get("radiusTop"), get("height") / 2.0)), 0.0),
        "ellipsoid" => (shape(Shape::ellipsoid(vector(&p["semi_axes"]))), 0.0),
        "hemisphere_y" => (MassProperties::hemisphere(get("radius"), amount).unwrap(), 0.0),
        "regular_tetrahedron" => {
            let s = get("edge") / 8.0_f64.sqrt();
            let corners = [(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)];
            (MassProperties::tetrahedron(corners.map(|c| DVec3::from(c) * s), amount).unwrap(), 0.0)
        }
        "square_pyramid_y" => {
            // The record's origin is the centre of the base, ours is at mid-height.
            let (half, half_height) = (get("base") / 2.0, get("height") / 2.0);
            (MassProperties::pyramid(half, half, half_height, amount).unwrap(), half_height)
        }
        "thin_rod_y" => (MassProperties::thin_rod(get("length") / 2.0, get("mass")).unwrap(), 0.0),
        "thin_disc_y" => (MassProperties::thin_disc(get("radius"), get("mass")).unwrap(), 0.0),
        other => panic!("no code for the shape {other}"),
    }
}

#[test]
fn shapes() {
    let file = parse(include_str!("../../data/inertia_shapes.json"));
    let mut check = Check::new("inertia_shapes", &file);
    assert_eq!(list(&file, "shapes").len(), 18);
    for record in list(&file, "shapes") {
        let name = record["shape"].as_str().unwrap();
        let (actual, lift) = of_record(record);
        check.scalar(name, actual.mass(), number(&record["mass"]));
        check.vector(name, actual.center_of_mass() + DVec3::Y * lift, vector(&record["com"]));
        let tensor = actual.tensor_about_center();
        check.matrix(name, tensor, DMat3::from_diagonal(vector(&record["inertia_com"])));
        // A rod has no moment about itself and so no valid inertia; all the others have one, the
        // disc with the triangle inequality as an equality included.
        assert_eq!(actual.inertia().is_err(), name == "thin_rod_y", "{name}");
    }
    check.report();
}

/// A part's mass properties in the command module's structural frame.
fn apollo_part(part: &Value) -> MassProperties {
    let to_cm = quat_from_matrix(matrix(&part["R_part_to_cm_struct"])).unwrap();
    let struct_to_body = quat_from_matrix(matrix(&part["R_part_struct_to_body"])).unwrap();
    let in_body = InertiaTensor::new(DMat3::from_diagonal(vector(&part["inertia_diag_in_part_body"]))).unwrap();
    let in_struct = in_body.rotated(struct_to_body.conjugate()).unwrap();
    let part_in_struct =
        MassProperties::new(number(&part["mass"]), vector(&part["com_in_part_struct"]), in_struct).unwrap();
    part_in_struct.transformed(vector(&part["origin_in_cm_struct"]), to_cm).unwrap()
}

#[test]
fn apollo_lunar_module() {
    let file = parse(include_str!("../../data/inertia_compounds.json"));
    let mut check = Check::new("inertia_compounds, Apollo", &file);
    let tree = &file["subtrees"][0];
    let parts: Vec<MassProperties> = list(&file, "parts").iter().map(apollo_part).collect();
    let whole = parts.into_iter().reduce(|a, b| a + b).unwrap();
    // Back from the command module's frame to the structural frame of the lunar module, the root.
    let root = &file["parts"][0];
    let to_root = quat_from_matrix(matrix(&root["R_part_to_cm_struct"])).unwrap().conjugate();
    let back = -(to_root * vector(&root["origin_in_cm_struct"]));
    let whole = whole.transformed(back, to_root).unwrap();

    check.scalar("mass", whole.mass(), number(&tree["jeod_mass"]));
    check.vector("centre", whole.center_of_mass(), vector(&tree["computed_com"]));
    check.matrix("inertia", whole.tensor_about_center(), matrix(&tree["computed_inertia"]));
    // JEOD prints five decimals of the centre and six of the inertia: half a unit of the last
    // place.
    assert!((whole.center_of_mass() - vector(&tree["jeod_com_in_root_struct"])).abs().max_element() <= 0.5e-5);
    let jeod = DMat3::from_diagonal(vector(&tree["jeod_inertia_diag_about_com"]));
    assert!(largest(whole.tensor_about_center() - jeod) <= 0.5e-6 * 1.1);
    check.report();
}

#[test]
fn two_hemispheres_are_a_sphere() {
    let file = parse(include_str!("../../data/inertia_compounds.json"));
    let mut check = Check::new("inertia_compounds, hemispheres", &file);
    let identity = &file["identities"][0];
    let parts = list(identity, "parts").iter().map(|part| {
        let axes = quat_from_matrix(matrix(&part["R"])).unwrap();
        let inertia = InertiaTensor::from_principal(vector(&part["inertia_diag"]), axes).unwrap();
        MassProperties::new(number(&part["mass"]), vector(&part["com"]), inertia).unwrap()
    });
    let sphere = parts.reduce(|a, b| a + b).unwrap();
    check_identity(&mut check, "parts", &sphere, &identity["expected"]);

    // The same from our own hemispheres, radius 1.5 and density 50, dome up and dome down, about
    // (0, 2, 0) along y.
    let half = MassProperties::hemisphere(1.5, Amount::Density(50.0)).unwrap();
    let up = half.transformed([0.0, 0.0, 0.0], DQuat::IDENTITY).unwrap();
    let down = half.transformed([0.0, 0.0, 0.0], DQuat::from_rotation_x(std::f64::consts::PI)).unwrap();
    let sphere = (up + down).transformed([0.0, 0.0, 2.0], DQuat::IDENTITY).unwrap();
    check_identity(&mut check, "own hemispheres", &sphere, &identity["expected"]);
    check.report();
}

#[test]
fn a_box_of_boxes_is_the_box() {
    let file = parse(include_str!("../../data/inertia_compounds.json"));
    let mut check = Check::new("inertia_compounds, boxes", &file);
    let identity = &file["identities"][1];
    let (half, counts) = (DVec3::new(2.0, 4.0, 6.0), [5, 3, 2]);
    let small = half / DVec3::new(5.0, 3.0, 2.0);
    let place = |axis: usize, index: usize| small[axis] * (2 * index + 1) as f64 - half[axis];
    let mut parts = Vec::new();
    for x in 0..counts[0] {
        for y in 0..counts[1] {
            for z in 0..counts[2] {
                let position = DVec3::new(place(0, x), place(1, y), place(2, z)) + DVec3::new(1.0, 2.0, 3.0);
                parts.push(Part::new(Shape::cuboid(small), Amount::Density(100.0)).at(position));
            }
        }
    }
    let whole = Shape::compound(parts).own_mass_properties().unwrap();
    check_identity(&mut check, "boxes", &whole, &identity["expected"]);
    check.report();
}

#[test]
fn a_sphere_without_its_core_is_a_thick_shell() {
    let file = parse(include_str!("../../data/inertia_compounds.json"));
    let mut check = Check::new("inertia_compounds, hollow sphere", &file);
    let expected = &file["identities"][2]["expected"];
    let ball = |radius: f64| Shape::sphere(radius).mass_properties(Amount::Density(50.0)).unwrap();
    check_identity(&mut check, "by subtraction", &ball(2.3).without(&ball(2.1)).unwrap(), expected);
    let closed_form = MassProperties::thick_shell(2.3, 2.1, Amount::Density(50.0)).unwrap();
    check_identity(&mut check, "closed form", &closed_form, expected);
    check.report();
}

fn check_identity(check: &mut Check, what: &str, actual: &MassProperties, expected: &Value) {
    check.scalar(what, actual.mass(), number(&expected["mass"]));
    if let Some(center) = expected.get("com") {
        check.vector(what, actual.center_of_mass(), vector(center));
    }
    check.matrix(what, actual.tensor_about_center(), DMat3::from_diagonal(vector(&expected["inertia_diag"])));
}

#[test]
fn robot_links() {
    let file = parse(include_str!("../../data/inertia_robot_links.json"));
    let mut check = Check::new("inertia_robot_links", &file);
    let mut refused = 0;
    for link in list(&file, "links") {
        let name = link["link"].as_str().unwrap();
        let i = &link["inertia"];
        let (xx, xy, xz) = (number(&i["ixx"]), number(&i["ixy"]), number(&i["ixz"]));
        let (yy, yz, zz) = (number(&i["iyy"]), number(&i["iyz"]), number(&i["izz"]));
        let m = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
        let inertia = InertiaTensor::new(m).unwrap();
        check.each(name, sorted(inertia.principal().moments), vector(&link["principal"]));
        let massless = list(link, "flags").contains(&Value::from("non_positive_mass"));
        let body = MassProperties::new(number(&link["mass"]), vector(&link["com_xyz"]), inertia);
        assert_eq!(body.is_err(), massless, "{name}");
        refused += u32::from(massless);
    }
    assert_eq!(refused, 2, "iiwa link 0 and panda link 8 have no mass");
    check.report();
}

#[test]
fn spacecraft_and_a_molecule() {
    let file = parse(include_str!("../../data/inertia_spacecraft.json"));
    let mut check = Check::new("inertia_spacecraft", &file);
    for body in list(&file, "bodies") {
        let name = body["name"].as_str().unwrap();
        let m = match body.get("inertia") {
            Some(rows) => matrix(rows),
            None => of_products(&body["diag"], &body["products_as_listed"]),
        };
        if name.starts_with("water") {
            // 0.345 + 0.653 < 1: planar, and rounded to three digits.
            let strict = InertiaTensor::new(m);
            assert!(matches!(strict, Err(InertiaError::TriangleInequality { .. })), "{strict:?}");
        }
        let inertia = InertiaTensor::within_tolerance(m, 3e-3).unwrap();
        let principal = inertia.principal();
        check.each(name, sorted(principal.moments), vector(&body["principal"]));
        check.matrix(name, principal.matrix(), m);
    }
    check.report();
}

/// From a table of products of inertia, which are the integrals: the matrix has their negatives.
fn of_products(diagonal: &Value, products: &Value) -> DMat3 {
    let (xy, yz, zx) = (-number(&products["Ixy"]), -number(&products["Iyz"]), -number(&products["Izx"]));
    let d = vector(diagonal);
    DMat3::from_cols_array(&[d.x, xy, zx, xy, d.y, yz, zx, yz, d.z])
}

#[test]
fn hard_eigenvalues_and_inverses() {
    let file = parse(include_str!("../../data/inertia_eigenvalues.json"));
    let mut check = Check::new("inertia_eigenvalues", &file);
    for record in list(&file, "matrices") {
        let name = record["name"].as_str().unwrap();
        let m = matrix(&record["matrix"]);
        let inertia = InertiaTensor::new(m).unwrap();
        let principal = inertia.principal();
        check.each(name, sorted(principal.moments), vector(&record["principal"]));
        check.matrix(name, principal.matrix(), m);
        let (inverse, expected) = (inertia.inverse(), matrix(&record["inverse"]));
        for column in 0..3 {
            for row in 0..3 {
                let scale = expected.col(column)[column].sqrt() * expected.col(row)[row].sqrt();
                check.error(name, (inverse.col(column)[row] - expected.col(column)[row]).abs() / scale);
            }
        }
    }
    check.report();
}
