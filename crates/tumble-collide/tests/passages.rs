//! Promise: on its way to a half-space a shape is stopped before its core is in it, however it and
//! the plane move and turn, and no earlier than when the shape touches it; what stays clear of the
//! plane is not stopped.
//!
//! Why: the second net trusts it. A bound on how fast a point comes nearer that leaves out the turn
//! of the plane lets rods into the ground; one that is too large stops what flies past.

#![allow(clippy::unwrap_used, reason = "a test without what it tests is to fail")]

mod shapes_at_random;

use shapes_at_random::{Random, Vector, solid};
use tumble_collide::{ColliderShape, Course, Isometry, Passage};
use tumble_math::lane::Vec3;

/// Shapes with how far they reach beyond their core at most, in half thicknesses: its half, all
/// around, and at edges and corners.
const KINDS: [(&str, f64); 6] =
    [("sphere", 0.5), ("cuboid", 0.87), ("capsule", 0.5), ("cylinder", 0.71), ("tapered", 0.5), ("ellipsoid", 0.5)];
/// Moments of a way that are tested.
const MOMENTS: u32 = 400;
/// Of half a thickness, what stays free at most.
const CLEARANCE: f64 = 0.0101;

/// The normal of a half-space.
fn up(at: &Isometry<f64>) -> Vector {
    at.orientation.rotate(Vec3::new(0.0, 1.0, 0.0))
}

/// How far the lowest point of a shape is over the plane at a moment \[m\].
fn height(shape: &ColliderShape<f64>, [ground, body]: [&Course; 2], moment: f64) -> f64 {
    let [ground, body] = [ground, body].map(|course| course.at(moment));
    let up = up(&ground);
    let lowest =
        body.position + body.orientation.rotate(shape.furthest(body.orientation.rotate_back(up * -1.0)).unwrap());
    up.dot(lowest - ground.position)
}

#[test]
fn nothing_gets_through_a_half_space() {
    for (kind, beyond) in KINDS {
        let (mut stopped, mut tight) = (0, 0);
        for case in 0..400 {
            let mut random = Random::new(case);
            let (shape, size) = solid(kind, &mut random);
            let plane = random.placement(size);
            let body = Isometry { position: Vec3::zero(), orientation: random.rotation() };
            let stays = |at: &Isometry<f64>| Course::new(at, at.position, Vec3::zero(), Vec3::zero());
            let low = height(&shape, [&stays(&plane), &stays(&body)], 0.0);
            let body = Isometry { position: up(&plane) * (random.between(1e-3, 0.5) * size - low), ..body };
            // The centre of mass is not the middle.
            let off = random.vector(0.3 * size);
            let spin = random.direction() * random.between(0.0, 3.0);
            let way = random.direction() * (random.between(0.0, 2.0) * size);
            let course = Course::new(&body, body.position + off, way, spin);
            let ground = if random.often(0.5) {
                let turn = random.direction() * random.between(0.0, 1.0);
                Course::new(&plane, plane.position + random.vector(size), random.vector(0.5 * size), turn)
            } else {
                stays(&plane)
            };
            let courses = [&ground, &course];
            let thickness = shape.ccd_thickness();
            let found = Passage::find([&ColliderShape::HalfSpace, &shape], courses);
            let until = found.map_or(1.0, |found| found.until);
            let least = -beyond * thickness - 1e-9 * size;
            for i in 0..=MOMENTS {
                let moment = until * f64::from(i) / f64::from(MOMENTS);
                let height = height(&shape, courses, moment);
                assert!(height > least, "{kind} {case}: {height} m at {moment} of {until}, half thickness {thickness}");
            }
            if let Some(found) = found {
                stopped += 1;
                let up = up(&ground.at(until));
                assert!((found.normal - up).dot(found.normal - up) < 1e-18, "{kind} {case}");
                let on_plane = up.dot(found.point - ground.at(until).position);
                assert!(on_plane.abs() < 1e-9 * size, "{kind} {case}: {on_plane} m off the plane");
                tight += u32::from(height(&shape, courses, until) < CLEARANCE * thickness);
            }
        }
        // A way that is bent takes more advances than there are, now and then.
        assert!(stopped > 50 && tight * 20 > stopped * 19, "{kind}: {stopped} stopped, {tight} at the plane");
    }
}

/// What turns about its lowest point by less than a radian has a course that dips below the plane.
/// It crosses if and only if it is in the plane in the end.
#[test]
fn what_is_in_front_again_does_not_cross() {
    let (mut dipped, mut crossed) = (0, 0);
    for (kind, beyond) in KINDS {
        for case in 0..2000 {
            let mut random = Random::new(case);
            let (shape, size) = solid(kind, &mut random);
            let turned = Isometry { position: Vec3::zero(), orientation: random.rotation() };
            let down = turned.orientation.rotate_back(Vec3::new(0.0, -1.0, 0.0));
            let pivot = turned.orientation.rotate(shape.furthest(down).unwrap());
            // The pivot is the origin but for a little height.
            let thickness = shape.ccd_thickness();
            let lift = Vec3::new(0.0, 0.05 * thickness, 0.0);
            let body = Isometry { position: lift - pivot, ..turned };
            let turn = random.direction() * random.between(0.1, 0.95);
            let spun = Course::new(&body, Vec3::zero(), Vec3::zero(), turn).at(1.0).position;
            let course = Course::new(&body, body.position, spun - body.position, turn);
            let stays = Course::new(&Isometry::at(Vec3::<f64>::zero()), Vec3::zero(), Vec3::zero(), Vec3::zero());
            let (shapes, courses) = ([&ColliderShape::HalfSpace, &shape], [&stays, &course]);
            let [found, crossing] = [Passage::find(shapes, courses), Passage::find_crossing(shapes, courses)];
            let end = height(&shape, courses, 1.0);
            if end > 0.0 {
                assert_eq!(crossing, None, "{kind} {case}: {end} m in the end, size {size}");
                dipped += u32::from(found.is_some());
            } else if end < -beyond * thickness - 1e-9 * size {
                assert!(crossing.is_some() && crossing == found, "{kind} {case}: {end} m in the end");
                crossed += 1;
            }
        }
    }
    assert!(dipped > 30 && crossed > 1000, "{dipped} dipped, {crossed} crossed");
}

/// A ball that falls straight down is stopped where half its radius is in the ground.
#[test]
fn a_ball_is_stopped_as_the_closed_form_has_it() {
    for case in 0..1000 {
        let mut random = Random::new(case);
        let (radius, height) = (random.log_between(0.01, 100.0), random.between(1.0, 10.0));
        let at = Isometry::at(Vec3::new(0.0, radius * height, 0.0));
        let fall = radius * random.between(0.5, 20.0);
        let course = Course::new(&at, at.position, Vec3::new(0.0, -fall, 0.0), Vec3::zero());
        let zero = Vec3::<f64>::zero();
        let stays = Course::new(&Isometry::at(zero), zero, zero, zero);
        let ball = ColliderShape::Sphere { radius };
        let found = Passage::find([&ColliderShape::HalfSpace, &ball], [&stays, &course]).map(|found| found.until);
        let expected = radius * (height - 0.5) / fall;
        match found {
            Some(until) => {
                assert!((0.0..0.011 * radius / fall).contains(&(expected - until)), "{until} for {expected}");
            }
            None => assert!(expected > 1.0, "{expected}"),
        }
    }
}
