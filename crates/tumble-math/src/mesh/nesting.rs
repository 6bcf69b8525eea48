//! Which part of a surface lies within which.

use glam::{DVec2, DVec3};

use super::connected_components::Parts;
use super::local_frame::LocalFrame;
use super::ray_crossings::{Crossing, Shadows};
use super::triangle_mesh::TriangleMesh;

/// Parts nearer to each other than this, in units of the mesh, touch. As near-duplicate vertices.
const TOUCHING: f64 = TriangleMesh::NEAR;

/// For each part how many others it lies within; zero for those that are not closed. `None` if it
/// takes more than `most` comparisons of a triangle with a line.
///
/// A part is within another if a point just inside its surface is, and its box is. The point lies
/// on a line parallel to x through the middle of the triangle that is largest as seen along x; all
/// parts that the line goes through are found at once, in a tree, so that the time for P parts is P
/// times that of one line and not P squared.
///
/// That the point is on the inner side of the surface makes parts that touch, wall to wall, lie
/// beside each other. Parts that cross each other have no answer; they get some.
pub(crate) fn depths(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    parts: &Parts,
    frame: &LocalFrame,
    most: usize,
) -> Option<Vec<u32>> {
    let mut depths = vec![0; parts.parts.len()];
    if parts.parts.iter().filter(|part| part.is_solid()).count() < 2 {
        return Some(depths);
    }
    let local: Vec<DVec3> = positions.iter().map(|p| frame.local(*p)).collect();
    let shadows = Shadows::of(&local, triangles);
    let mut found = Vec::new();
    let mut tested = 0;
    for (number, part) in parts.parts.iter().enumerate() {
        if !part.is_solid() {
            continue;
        }
        let corners = |triangle: u32| triangles[triangle as usize].map(|corner| local[corner as usize]);
        let shadow = |triangle: u32| {
            let [a, b, c] = corners(triangle);
            (b - a).cross(c - a).x.abs()
        };
        let Some(&largest) = part.triangles.iter().max_by(|a, b| shadow(**a).total_cmp(&shadow(**b))) else { continue };
        let [a, b, c] = corners(largest);
        let point = (a + b + c) / 3.0;
        tested += shadows.crossings(DVec2::new(point.y, point.z), &mut found);
        if tested > most {
            return None;
        }
        depths[number] = depth(number, largest, point.x, &mut found, parts);
    }
    Some(depths)
}

/// How many parts the point just inside part `number`, at the triangle `largest` that the line
/// meets at `x`, lies in.
fn depth(number: usize, largest: u32, x: f64, found: &mut [Crossing], parts: &Parts) -> u32 {
    let part_of = |crossing: &Crossing| parts.of_triangle[crossing.triangle as usize] as usize;
    let winding = |crossings: &[Crossing], up_to: f64| -> i32 {
        let sign = |c: &Crossing| if parts.flipped[c.triangle as usize] { -c.sign } else { c.sign };
        crossings.iter().filter(|c| c.triangle != largest && c.x <= up_to).map(sign).sum()
    };
    found.sort_unstable_by_key(|crossing| (part_of(crossing), crossing.triangle));
    let own = found.iter().position(|c| part_of(c) == number).unwrap_or(found.len());
    let own_end = found.iter().rposition(|c| part_of(c) == number).map_or(own, |last| last + 1);
    // Outside before it, the line goes in here: the point is a little further on. Else a little
    // before.
    let goes_in = winding(&found[own..own_end], x) == 0;
    let up_to = if goes_in { x + TOUCHING } else { x - TOUCHING };
    let part = &parts.parts[number];
    let holds = |crossings: &&[Crossing]| {
        let Some(first) = crossings.first() else { return false };
        let other = &parts.parts[part_of(first)];
        part_of(first) != number
            && other.is_solid()
            && other.low.cmple(part.low).all()
            && other.high.cmpge(part.high).all()
            && winding(crossings, up_to) != 0
    };
    found.chunk_by(|a, b| part_of(a) == part_of(b)).filter(holds).count() as u32
}

#[cfg(test)]
mod tests {
    use super::super::edges::Edges;
    use super::*;

    /// Tetrahedra in each other, each a quarter as large as the last; what takes too long has no
    /// answer.
    #[test]
    fn depth_and_the_end_of_patience() {
        let corners =
            [DVec3::ONE, DVec3::new(1.0, -1.0, -1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(-1.0, -1.0, 1.0)];
        let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        let positions: Vec<DVec3> = (0..20).flat_map(|i| corners.map(|corner| corner * 0.25_f64.powi(i))).collect();
        let triangles: Vec<[u32; 3]> = (0..20).flat_map(|i| faces.map(|face| face.map(|c: u32| c + 4 * i))).collect();
        let frame = LocalFrame::around(positions.iter().copied());
        let parts = Parts::of(&positions, &triangles, &Edges::of(&triangles), &frame);
        let found = depths(&positions, &triangles, &parts, &frame, 100_000);
        // From the fifteenth on they are smaller than what counts as touching, 1e-9, and what is
        // inside what is unknown.
        assert_eq!(found.map(|depths| depths[..14].to_vec()), Some((0..14).collect()));
        assert_eq!(depths(&positions, &triangles, &parts, &frame, 100), None);
    }
}
