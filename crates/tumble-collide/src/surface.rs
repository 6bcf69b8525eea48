//! What meshes and height fields have in common: triangles that know what is beyond their sides.

use crate::aabb::Aabb;
use crate::query::line::Line;
use crate::support_map::{Vector, unit};

/// Triangles, counter-clockwise as seen from outside. Side `k` goes from corner `k` to the next.
pub(crate) trait Surface {
    /// How many triangles there are.
    fn count(&self) -> u32;

    /// Numbers of a triangle's corners.
    fn corners(&self, triangle: u32) -> [u32; 3];

    fn point(&self, number: u32) -> Vector;

    /// The triangle beyond a side.
    fn across(&self, triangle: u32, side: usize) -> Option<u32>;

    /// Shows the other ends of all sides at a corner, given by number.
    fn corners_beside(&self, corner: u32, visit: &mut dyn FnMut(u32));

    /// Shows the triangles that a box may meet.
    fn near(&self, aabb: &Aabb<f64>, visit: &mut dyn FnMut(u32));

    /// Shows the triangles that may be met by a box that reaches `half` \[m\] from a line and is
    /// moved along it, from the line's point on and up to the distance `most` \[m\], which `visit`
    /// may shorten: it returns the new one. Nearer ones come earlier, more or less.
    fn along(&self, line: &Line, half: Vector, most: f64, visit: &mut dyn FnMut(u32) -> f64);

    /// The same of triangles that may be nearer to a point than `most` \[m\].
    fn around(&self, point: Vector, most: f64, visit: &mut dyn FnMut(u32) -> f64);

    fn patches(&self) -> &Patches;

    fn triangle(&self, triangle: u32) -> [Vector; 3] {
        let [a, b, c] = self.corners(triangle);
        [self.point(a), self.point(b), self.point(c)]
    }

    /// The ends of each side of the triangles, of two that are next to each other once.
    fn edges(&self) -> impl Iterator<Item = [Vector; 2]> + '_ {
        (0..self.count()).flat_map(move |triangle| {
            let corners = self.triangle(triangle);
            let is_first = move |side: &usize| self.across(triangle, *side).is_none_or(|beyond| triangle < beyond);
            (0..3).filter(is_first).map(move |side| [corners[side], corners[(side + 1) % 3]])
        })
    }

    /// Unit normal, or zero of a triangle without area.
    fn normal(&self, triangle: u32) -> Vector {
        normal_of(&self.triangle(triangle))
    }

    /// The corner of the triangle beyond a side that is not on the side.
    fn opposite(&self, triangle: u32, side: usize) -> Option<Vector> {
        let corners = self.corners(triangle);
        let ends = [corners[side], corners[(side + 1) % 3]];
        let beyond = self.corners(self.across(triangle, side)?);
        beyond.into_iter().find(|corner| !ends.contains(corner)).map(|corner| self.point(corner))
    }
}

/// The unit normal of a triangle, or zero if it has no area.
pub(crate) fn normal_of([a, b, c]: &[Vector; 3]) -> Vector {
    unit((*b - *a).cross(*c - *a))
}

/// What is precomputed of a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Patches {
    /// By triangle, the number of the flat piece it is in.
    patch: Vec<u32>,
    count: u32,
    /// By triangle, a bit for each side that sticks out, and one for each corner with such a side.
    edges: Vec<u8>,
}

/// Normals whose scalar product is less than one by no more than this belong to one flat piece:
/// half a thousandth of a radian.
const ONE_PLANE: f64 = 1e-7;
/// Sine of the least angle by which a side sticks out: what lies between the normals of two
/// triangles has to be held by the side, however little that is.
const STICKS_OUT: f64 = 1e-9;
/// The bit of the first corner.
const CORNER: u32 = 4;

impl Patches {
    pub(crate) fn of(surface: &impl Surface) -> Self {
        let count = surface.count() as usize;
        let mut this = Self { patch: vec![u32::MAX; count], count: 0, edges: vec![0; count] };
        let mut members = Vec::new();
        for seed in 0..surface.count() {
            if this.patch[seed as usize] != u32::MAX {
                continue;
            }
            let normal = surface.normal(seed);
            this.patch[seed as usize] = this.count;
            members.push(seed);
            while let Some(member) = members.pop() {
                for other in (0..3).filter_map(|side| surface.across(member, side)) {
                    if this.patch[other as usize] == u32::MAX && surface.normal(other).dot(normal) >= 1.0 - ONE_PLANE {
                        this.patch[other as usize] = this.count;
                        members.push(other);
                    }
                }
            }
            this.count += 1;
        }
        this.find_edges(surface);
        this
    }

    fn find_edges(&mut self, surface: &impl Surface) {
        let mut sharp_corners = Vec::new();
        for triangle in 0..surface.count() {
            let corners = surface.corners(triangle);
            for side in (0..3).filter(|side| sticks_out(surface, triangle, *side)) {
                self.edges[triangle as usize] |= 1 << side;
                sharp_corners.extend([corners[side], corners[(side + 1) % 3]]);
            }
        }
        sharp_corners.sort_unstable();
        for (triangle, edges) in (0..).zip(&mut self.edges) {
            for (bit, corner) in (CORNER..).zip(surface.corners(triangle)) {
                *edges |= u8::from(sharp_corners.binary_search(&corner).is_ok()) << bit;
            }
        }
    }

    pub(crate) fn of_triangle(&self, triangle: u32) -> u32 {
        self.patch[triangle as usize]
    }

    pub(crate) fn count(&self) -> u32 {
        self.count
    }

    pub(crate) fn is_edge(&self, triangle: u32, side: usize) -> bool {
        self.edges[triangle as usize] & 1 << side != 0
    }

    /// Whether anything of a triangle sticks out.
    pub(crate) fn has_edge(&self, triangle: u32) -> bool {
        self.edges[triangle as usize] != 0
    }

    /// Whether a side at a corner sticks out, of this triangle or another.
    pub(crate) fn is_sharp(&self, triangle: u32, corner: usize) -> bool {
        u32::from(self.edges[triangle as usize]) >> (CORNER + corner as u32) & 1 == 1
    }
}

/// Whether a side is where the surface ends, or turns away from its outside.
fn sticks_out(surface: &impl Surface, triangle: u32, side: usize) -> bool {
    let Some(opposite) = surface.opposite(triangle, side) else { return true };
    let away = opposite - surface.triangle(triangle)[side];
    let height = surface.normal(triangle).dot(away);
    // The sine of the angle to the other triangle, from its height over this one's plane.
    let ends = surface.triangle(triangle);
    let along = unit(ends[(side + 1) % 3] - ends[side]);
    let across = away - along * along.dot(away);
    height < -STICKS_OUT * across.dot(across).sqrt()
}
