//! Surfaces of revolution about y, from the profile that is turned.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec3;

use crate::tessellation::Tessellation;

/// Equal parts of a whole turn.
pub(crate) const SEGMENTS: u32 = 24;

/// Equal parts of the arc of a profile from pole to pole.
const ARC_SEGMENTS: u32 = SEGMENTS / 2;

/// A circle of the surface with the direction of its normals in the profile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ring {
    radius: f64,
    height: f64,
    normal_out: f64,
    normal_up: f64,
}

/// Turns smooth strips about y. Each strip is a list of rings from the bottom up as seen from
/// outside; ends on the axis close it.
pub(crate) fn revolve(strips: &[Vec<Ring>]) -> Tessellation {
    let mut whole = Tessellation::default();
    for strip in strips {
        for (index, ring) in strip.iter().enumerate() {
            let first = whole.positions.len() as u32;
            for segment in 0..SEGMENTS {
                let (z, x) = libm::sincos(TAU * f64::from(segment) / f64::from(SEGMENTS));
                // Adding zero makes all zeros positive: the same place is the same bits.
                whole.positions.push(DVec3::new(x * ring.radius, ring.height, z * ring.radius) + DVec3::ZERO);
                let normal = DVec3::new(x * ring.normal_out, ring.normal_up, z * ring.normal_out);
                whole.normals.push(normal.normalize_or(DVec3::Y));
            }
            if let Some(below) = index.checked_sub(1).and_then(|below| strip.get(below)) {
                join(&mut whole.triangles, [below, ring], first);
            }
        }
    }
    whole
}

/// The triangles between a ring, whose vertices begin at `first`, and the one before it.
fn join(triangles: &mut Vec<[u32; 3]>, [below, above]: [&Ring; 2], first: u32) {
    for segment in 0..SEGMENTS {
        let next = (segment + 1) % SEGMENTS;
        let (here_above, next_above) = (first + segment, first + next);
        let (here_below, next_below) = (here_above - SEGMENTS, next_above - SEGMENTS);
        // A ring on the axis is one place, and a triangle with two corners there has no area.
        if above.radius > 0.0 {
            triangles.push([here_below, here_above, next_above]);
        }
        if below.radius > 0.0 {
            let top = if above.radius > 0.0 { next_above } else { here_above };
            triangles.push([here_below, top, next_below]);
        }
    }
}

/// A ball about the origin.
pub(crate) fn ball(radius: f64) -> Vec<Ring> {
    let mut rings = Vec::new();
    arc(&mut rings, radius, 0.0, [-FRAC_PI_2, FRAC_PI_2]);
    rings
}

/// Two disks, at minus and plus the half height, and the cone between them; a disk of radius zero
/// is the apex.
pub(crate) fn cone_frustum([bottom, top]: [f64; 2], half_height: f64) -> Vec<Vec<Ring>> {
    let disk = |radius: f64, height: f64, normal_up: f64| Ring { radius, height, normal_out: 0.0, normal_up };
    let side =
        |radius: f64, height: f64| Ring { radius, height, normal_out: 2.0 * half_height, normal_up: bottom - top };
    let mut strips = vec![vec![side(bottom, -half_height), side(top, half_height)]];
    if bottom > 0.0 {
        strips.push(vec![disk(0.0, -half_height, -1.0), disk(bottom, -half_height, -1.0)]);
    }
    if top > 0.0 {
        strips.push(vec![disk(top, half_height, 1.0), disk(0.0, half_height, 1.0)]);
    }
    strips
}

/// The hull of two balls, at minus and plus the half height.
pub(crate) fn tapered_capsule([bottom, top]: [f64; 2], half_height: f64) -> Vec<Ring> {
    let sine = (bottom - top) / (2.0 * half_height);
    let mut rings = Vec::new();
    if sine >= 1.0 {
        arc(&mut rings, bottom, -half_height, [-FRAC_PI_2, FRAC_PI_2]);
    } else if sine <= -1.0 {
        arc(&mut rings, top, half_height, [-FRAC_PI_2, FRAC_PI_2]);
    } else {
        // Where the common tangent cone touches the balls, the latitude is that of its normal.
        let latitude = libm::asin(sine);
        arc(&mut rings, bottom, -half_height, [-FRAC_PI_2, latitude]);
        arc(&mut rings, top, half_height, [latitude, FRAC_PI_2]);
    }
    rings
}

/// The rings of a ball between two latitudes \[rad\].
fn arc(rings: &mut Vec<Ring>, radius: f64, center: f64, [from, to]: [f64; 2]) {
    let segments = (f64::from(ARC_SEGMENTS) * (to - from) / (2.0 * FRAC_PI_2)).ceil().max(1.0) as u32;
    for segment in 0..=segments {
        let share = f64::from(segment) / f64::from(segments);
        let latitude = from + (to - from) * share;
        let (sine, cosine) = libm::sincos(latitude);
        // A pole is on the axis, which pi/2 in floating point is not quite.
        let cosine = if latitude.abs() < FRAC_PI_2 { cosine } else { 0.0 };
        rings.push(Ring {
            radius: radius * cosine,
            height: center + radius * sine,
            normal_out: cosine,
            normal_up: sine,
        });
    }
}
