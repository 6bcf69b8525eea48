//! Wireframes of primitive shapes: edges, circles and meridians.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DQuat, DVec2, DVec3};
use tumble_math::Shape;

/// Strokes of a circle.
const SEGMENTS: u32 = 24;
/// Lines along a surface of revolution.
const MERIDIANS: u32 = 4;

/// The edges of a shape whose frame is at `position`, turned by `orientation`; of round ones
/// circles and meridians.
pub(crate) fn outline(shape: &Shape, position: DVec3, orientation: DQuat, draw: &mut dyn FnMut(DVec3, DVec3)) {
    let mut edge = |from: DVec3, to: DVec3| draw(position + orientation * from, position + orientation * to);
    match *shape {
        Shape::Cuboid { half_extents } => cuboid(half_extents, &mut edge),
        Shape::Sphere { radius } | Shape::HollowSphere { radius } => capsule([radius, radius], 0.0, &mut edge),
        Shape::Ellipsoid { radii } => {
            capsule([1.0, 1.0], 0.0, &mut |from, to| edge(from * radii, to * radii));
        }
        Shape::Cylinder { radius, half_height } => frustum([radius, radius], half_height, &mut edge),
        Shape::Cone { radius, half_height } => frustum([radius, 0.0], half_height, &mut edge),
        Shape::Frustum { radius_bottom, radius_top, half_height } => {
            frustum([radius_bottom, radius_top], half_height, &mut edge);
        }
        Shape::Capsule { radius, half_height } => capsule([radius, radius], half_height, &mut edge),
        Shape::TaperedCapsule { radius_bottom, radius_top, half_height } => {
            capsule([radius_bottom, radius_top], half_height, &mut edge);
        }
        Shape::Mesh(ref solid) => {
            let mesh = solid.mesh();
            for &[a, b, c] in mesh.triangles() {
                // Of the two triangles at an edge, one goes along it upwards.
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    if let (true, Some(&from), Some(&to)) =
                        (from < to, mesh.positions().get(from as usize), mesh.positions().get(to as usize))
                    {
                        edge(from, to);
                    }
                }
            }
        }
        Shape::Compound(ref parts) => {
            for part in parts {
                outline(&part.shape, part.position, part.orientation.normalize(), &mut edge);
            }
        }
        // A point has no edges.
        _ => {}
    }
}

fn cuboid(half_extents: DVec3, edge: &mut dyn FnMut(DVec3, DVec3)) {
    for (along, u, v) in
        [(DVec3::X, DVec3::Y, DVec3::Z), (DVec3::Y, DVec3::Z, DVec3::X), (DVec3::Z, DVec3::X, DVec3::Y)]
    {
        for side in [u + v, u - v, -u + v, -u - v] {
            edge((side - along) * half_extents, (side + along) * half_extents);
        }
    }
}

/// The frustum of a cone along y between circles of two radii.
fn frustum([bottom, top]: [f64; 2], half_height: f64, edge: &mut dyn FnMut(DVec3, DVec3)) {
    let ends = [DVec2::new(bottom, -half_height), DVec2::new(top, half_height)];
    revolved(&ends, edge);
    ends.into_iter().for_each(|end| circle(end, edge));
}

/// The hull of two balls on y; a ball where they are one.
fn capsule([bottom, top]: [f64; 2], half_height: f64, edge: &mut dyn FnMut(DVec3, DVec3)) {
    let difference = bottom - top;
    if half_height > 0.0 && difference.abs() >= 2.0 * half_height {
        // One ball holds the other.
        let radius = bottom.max(top);
        let center = DVec3::Y * if difference > 0.0 { -half_height } else { half_height };
        return capsule([radius, radius], 0.0, &mut |from, to| edge(from + center, to + center));
    }
    // Latitude at which the cone between the balls touches both.
    let touching = if half_height > 0.0 { (difference / (2.0 * half_height)).asin() } else { 0.0 };
    let mut profile = Vec::new();
    for (radius, center, [from, to]) in
        [(bottom, -half_height, [-FRAC_PI_2, touching]), (top, half_height, [touching, FRAC_PI_2])]
    {
        let steps = SEGMENTS / 4;
        profile.extend((0..=steps).map(|step| {
            let latitude = from + (to - from) * f64::from(step) / f64::from(steps);
            DVec2::new(radius * latitude.cos(), center + radius * latitude.sin())
        }));
    }
    revolved(&profile, edge);
    let widest = profile.len() / 2;
    circle(profile[widest], edge);
    if half_height > 0.0 {
        circle(profile[widest - 1], edge);
    }
}

/// Meridians of what comes of a line of points, each a radius and a height, turned about y.
fn revolved(profile: &[DVec2], edge: &mut dyn FnMut(DVec3, DVec3)) {
    for meridian in 0..MERIDIANS {
        let turn = TAU * f64::from(meridian) / f64::from(MERIDIANS);
        for pair in profile.windows(2) {
            // Two caps of a ball meet in one point.
            if let (true, &[from, to]) = (pair[0] != pair[1], pair) {
                edge(turned(from, turn), turned(to, turn));
            }
        }
    }
}

/// A circle about y, given by its radius and height.
fn circle(at: DVec2, edge: &mut dyn FnMut(DVec3, DVec3)) {
    if at.x > 0.0 {
        for segment in 0..SEGMENTS {
            let turn = |segment| TAU * f64::from(segment) / f64::from(SEGMENTS);
            edge(turned(at, turn(segment)), turned(at, turn(segment + 1)));
        }
    }
}

fn turned(at: DVec2, turn: f64) -> DVec3 {
    DVec3::new(at.x * turn.cos(), at.y, at.x * turn.sin())
}
