//! Where a line parallel to x goes through the triangles of a surface.

use glam::{DVec2, DVec3};

/// As many triangles, at most, are compared one by one.
const LEAF: usize = 8;

/// A place where the line enters or leaves what the surface bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) triangle: u32,
    pub(crate) x: f64,
    /// 1 where the line goes in through the front of the triangle, -1 where it comes out through
    /// its back.
    pub(crate) sign: i32,
}

/// The triangles of a surface in a tree of rectangles, as seen along x.
///
/// Each node holds the triangles of a range of `order`, the median of their middles between its two
/// children; so the tree is balanced whatever the triangles are like, and a line visits about the
/// square root of their number, or less.
#[derive(Clone, Debug)]
pub(crate) struct Shadows<'a> {
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    order: Vec<u32>,
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    low: DVec2,
    high: DVec2,
    start: u32,
    end: u32,
    /// The second child; the first is the node after this one. `None` for a leaf.
    second: Option<u32>,
}

/// As seen along x: right is y, up is z.
fn seen(p: DVec3) -> DVec2 {
    DVec2::new(p.y, p.z)
}

impl<'a> Shadows<'a> {
    pub(crate) fn of(positions: &'a [DVec3], triangles: &'a [[u32; 3]]) -> Self {
        let order = (0..triangles.len() as u32).collect();
        let mut shadows = Self { positions, triangles, order, nodes: Vec::new() };
        shadows.divide(0, triangles.len());
        shadows
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.positions[corner as usize])
    }

    /// Makes the node of this range of `order` and all below it. Halving ends after 30 levels.
    fn divide(&mut self, start: usize, end: usize) {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for &triangle in &self.order[start..end] {
            for corner in self.corners(triangle) {
                low = low.min(seen(corner));
                high = high.max(seen(corner));
            }
        }
        let node = self.nodes.len();
        self.nodes.push(Node { low, high, start: start as u32, end: end as u32, second: None });
        if end - start <= LEAF {
            return;
        }
        let size = high - low;
        let (positions, triangles) = (self.positions, self.triangles);
        let middle_of = |triangle: u32| {
            let sum: DVec2 = triangles[triangle as usize].iter().map(|corner| seen(positions[*corner as usize])).sum();
            if size.x > size.y { sum.x } else { sum.y }
        };
        let half = (end - start) / 2;
        let _ = self.order[start..end]
            .select_nth_unstable_by(half, |a, b| middle_of(*a).total_cmp(&middle_of(*b)).then(a.cmp(b)));
        self.divide(start, start + half);
        self.nodes[node].second = Some(self.nodes.len() as u32);
        self.divide(start + half, end);
    }

    /// Puts the crossings of the line through `(y, z)` into `found` and returns how many triangles
    /// were tested.
    pub(crate) fn crossings(&self, line: DVec2, found: &mut Vec<Crossing>) -> usize {
        found.clear();
        let mut tested = 0;
        let mut waiting = vec![0_u32];
        while let Some(number) = waiting.pop() {
            let node = self.nodes[number as usize];
            tested += 1;
            if line.cmplt(node.low).any() || line.cmpgt(node.high).any() {
                continue;
            }
            if let Some(second) = node.second {
                waiting.extend([number + 1, second]);
                continue;
            }
            for &triangle in &self.order[node.start as usize..node.end as usize] {
                tested += 1;
                let crossing = crossing(self.corners(triangle), line);
                found.extend(crossing.map(|(x, sign)| Crossing { triangle, x, sign }));
            }
        }
        tested
    }
}

/// Where on x, and from which side, the line through `(y, z)` goes through a triangle.
///
/// In the plane seen along x, the triangle's outline winds around the line as often as its edges
/// cross the ray from the line to the right, up counted as 1 and down as -1. Whether an edge does
/// depends on its two ends alone, not on the triangle it is seen from, rounding included; so a line
/// can neither slip through between two triangles that share an edge nor hit both, and over a
/// closed surface the signs always add up to zero.
fn crossing(corners: [DVec3; 3], line: DVec2) -> Option<(f64, i32)> {
    let [a, b, c] = corners;
    let (mut winding, mut right, mut left) = (0, None, None);
    for (from, to) in [(a, b), (b, c), (c, a)] {
        let (below, above) = match (from.z > line.y, to.z > line.y) {
            (false, true) => (from, to),
            (true, false) => (to, from),
            _ => continue,
        };
        // At the height of the line the edge is at y = line.x + (l u + r d)/(u + d), with its ends
        // d > 0 above, u >= 0 below, l and r to the right. Only the sign of l u + r d counts.
        let (up, down) = (above.z - line.y, line.y - below.z);
        let is_right = (below.y - line.x) * up + (above.y - line.x) * down > 0.0;
        let t = down / (up + down);
        let at = (below.y + (above.y - below.y) * t - line.x, below.x + (above.x - below.x) * t);
        if is_right {
            winding += if from.z < to.z { 1 } else { -1 };
            right = Some(at);
        } else {
            left = Some(at);
        }
    }
    if winding == 0 {
        return None;
    }
    let ((right, x_right), (left, x_left)) = (right?, left?);
    let t = if right > left { (-left / (right - left)).clamp(0.0, 1.0) } else { 0.5 };
    // Seen along x, with y to the right and z up, an outline that runs counter-clockwise has its
    // normal towards the eye at +x: the line comes out.
    Some((x_left + (x_right - x_left) * t, -winding))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_a_corner_and_an_edge_goes_in_once_and_out_once() {
        // An octahedron, seen along x: lines through its corner at the middle, through edges, and
        // beside them.
        let p = [DVec3::X, DVec3::Y, DVec3::Z];
        let positions: Vec<DVec3> = p.into_iter().chain(p.map(|v| -v)).collect();
        let mut triangles = Vec::new();
        for octant in 0..8_u32 {
            let sign = |axis: u32| octant >> axis & 1;
            let corners = [3 * sign(0), 1 + 3 * sign(1), 2 + 3 * sign(2)];
            let mirrored = (sign(0) + sign(1) + sign(2)) % 2 == 1;
            triangles.push(if mirrored { [corners[0], corners[2], corners[1]] } else { corners });
        }
        let shadows = Shadows::of(&positions, &triangles);
        let mut found = Vec::new();
        for (line, half_way) in [((0.0, 0.0), 1.0), ((0.0, 0.25), 0.75), ((0.25, 0.0), 0.75), ((-0.25, 0.5), 0.25)] {
            let _ = shadows.crossings(line.into(), &mut found);
            found.sort_by(|a, b| a.x.total_cmp(&b.x));
            let places: Vec<(f64, i32)> = found.iter().map(|crossing| (crossing.x, crossing.sign)).collect();
            assert_eq!(places, [(-half_way, 1), (half_way, -1)], "{line:?}");
        }
        let _ = shadows.crossings((0.75, 0.5).into(), &mut found);
        assert_eq!(found, []);
    }
}
