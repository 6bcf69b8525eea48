//! Boxes: the axis that separates two of them most, and the points where the faces or edges that it
//! belongs to meet.
//!
//! The separating axis test over the three face normals of each and the nine products of their
//! edges (S. Gottschalk, M. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996); the points of a face
//! contact are the corners of what is left of the face of one box that looks against the axis when
//! it is cut to the face of the other. Nothing branches on a pair, so that several are worked on
//! side by side.

mod edges;
mod faces;
mod reduction;

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::lanes::{FAR, ManifoldLanes};

/// By how much more \[m\] an edge axis must separate than the best face to be taken: a face holds a
/// body better, and a choice that changes back and forth holds it worst.
const EDGE_LEAD: f64 = 5e-4;
/// But by no more than this part of the margin.
const LEAD_SHARE: f64 = 0.025;
/// Nor is an edge axis taken at a greater cosine of the angle to the normal of the best face, about
/// five degrees: there edges cross in the plane of the face, which has more points to hold with.
/// More than a margin deep, only where one of these is as deep as the edges but for that cosine.
const FLAT: f64 = 0.996;
/// And a face of the second box than one of the first.
const SECOND_LEAD: f64 = 2.5e-4;
/// Edges at a smaller sine of the angle between them are parallel: a face separates as well.
const MIN_SINE: f64 = 5e-3;

/// Boxes about their origins, turned.
///
/// ```
/// use tumble_collide::lanes::{CuboidLanes, cuboid_gap};
/// use tumble_math::lane::{Quat, Vec3};
///
/// // An eighth of a turn about y: the corner reaches out by the square root of one half.
/// let turned = Quat {
///     x: 0.0,
///     y: (std::f64::consts::PI / 8.0).sin(),
///     z: 0.0,
///     w: (std::f64::consts::PI / 8.0).cos(),
/// };
/// let (half_extents, upright) = (Vec3::splat(0.5), Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 });
/// let first = CuboidLanes { half_extents, orientation: upright };
/// let second = CuboidLanes { half_extents, orientation: turned };
/// assert!(
///     (cuboid_gap(&first, &second, Vec3::new(2.0, 0.0, 0.0)) - (1.5 - 0.5_f64.sqrt())).abs()
///         < 1e-15
/// );
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CuboidLanes<L> {
    /// Half the lengths of their edges \[m\].
    pub half_extents: Vec3<L>,
    /// Unit quaternions from the boxes' coordinates to the world's.
    pub orientation: Quat<L>,
}

/// Two boxes side by side in space.
struct Pair<L> {
    /// The axes of both in the world, and half the lengths along them.
    axes: [[Vec3<L>; 3]; 2],
    half: [[L; 3]; 2],
    /// From the first centre to the second.
    apart: Vec3<L>,
    /// The same along the axes of both.
    along: [[L; 3]; 2],
    /// Cosines of the angles between the axes of the first and of the second, and their absolute
    /// values.
    cosines: [[L; 3]; 3],
    absolute: [[L; 3]; 3],
}

impl<L: Lane> Pair<L> {
    #[inline(always)]
    fn new(first: &CuboidLanes<L>, second: &CuboidLanes<L>, apart: Vec3<L>) -> Self {
        let (a, b) = (first.orientation.axes(), second.orientation.axes());
        let mut cosines = [[L::splat(0.0); 3]; 3];
        let mut absolute = cosines;
        let mut along = [cosines[0]; 2];
        let mut i = 0;
        while i < 3 {
            let mut j = 0;
            while j < 3 {
                cosines[i][j] = a[i].dot(b[j]);
                absolute[i][j] = cosines[i][j].abs();
                j += 1;
            }
            along[0][i] = a[i].dot(apart);
            along[1][i] = b[i].dot(apart);
            i += 1;
        }
        let (h, k) = (first.half_extents, second.half_extents);
        Self { axes: [a, b], half: [[h.x, h.y, h.z], [k.x, k.y, k.z]], apart, along, cosines, absolute }
    }

    /// How far the normals of faces separate the boxes: those of the first, then those of the
    /// second.
    #[inline(always)]
    fn face_gaps(&self) -> [L; 6] {
        let ([h, k], c) = (self.half, &self.absolute);
        let mut gaps = [L::splat(0.0); 6];
        let mut i = 0;
        while i < 3 {
            let reach = h[i] + (k[0] * c[i][0] + k[1] * c[i][1] + k[2] * c[i][2]);
            gaps[i] = self.along[0][i].abs() - reach;
            let reach = k[i] + (h[0] * c[0][i] + h[1] * c[1][i] + h[2] * c[2][i]);
            gaps[3 + i] = self.along[1][i].abs() - reach;
            i += 1;
        }
        gaps
    }
}

/// How far apart boxes are at least \[m\]: what the normals of their faces tell. `apart` is the way
/// from the first centre to the second.
///
/// ```
/// use tumble_collide::lanes::{CuboidLanes, cuboid_gap};
/// use tumble_math::lane::{Quat, Vec3};
///
/// let upright = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
/// let cube = CuboidLanes { half_extents: Vec3::splat(0.5_f64), orientation: upright };
/// assert_eq!(cuboid_gap(&cube, &cube, Vec3::new(0.0, 1.25, 0.5)), 0.25);
/// ```
#[inline(always)]
pub fn cuboid_gap<L: Lane>(first: &CuboidLanes<L>, second: &CuboidLanes<L>, apart: Vec3<L>) -> L {
    let [a, b, c, d, e, f] = Pair::new(first, second, apart).face_gaps();
    a.max(b).max(c).max(d).max(e).max(f)
}

/// How far a box reaches from its centre along the axes of the world \[m\].
///
/// ```
/// use tumble_collide::lanes::{CuboidLanes, cuboid_reach};
/// use tumble_math::lane::{Quat, Vec3};
///
/// // A quarter of a turn about z: what was along x is along y.
/// let half = 0.5_f64.sqrt();
/// let turned = Quat { x: 0.0, y: 0.0, z: half, w: half };
/// let board = CuboidLanes { half_extents: Vec3::new(2.0, 0.5, 1.0), orientation: turned };
/// let reach = cuboid_reach(&board);
/// assert!((reach.x - 0.5).abs() < 1e-12 && (reach.y - 2.0).abs() < 1e-12 && reach.z == 1.0);
/// ```
#[inline(always)]
pub fn cuboid_reach<L: Lane>(cuboid: &CuboidLanes<L>) -> Vec3<L> {
    let (half, [x, y, z]) = (cuboid.half_extents, cuboid.orientation.axes());
    Vec3::new(along([x.x, y.x, z.x], half), along([x.y, y.y, z.y], half), along([x.z, y.z, z.z], half))
}

/// How far a box reaches along a direction that its own axes have these components along.
#[inline(always)]
fn along<L: Lane>([x, y, z]: [L; 3], half: Vec3<L>) -> L {
    x.abs() * half.x + y.abs() * half.y + z.abs() * half.z
}

/// How boxes touch, with points where they are less than `margin` \[m\] apart; `apart` is the way
/// from the first centre to the second.
///
/// ```
/// use tumble_collide::lanes::{CuboidLanes, cuboid_pair};
/// use tumble_math::lane::{Quat, Vec3};
///
/// let upright = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
/// let cube = CuboidLanes { half_extents: Vec3::splat(0.5_f64), orientation: upright };
/// // One on the other, a centimetre in it: the four corners.
/// let manifold = cuboid_pair(&cube, &cube, Vec3::new(0.0, 0.99, 0.0), 0.02);
/// assert_eq!((manifold.count, manifold.normal.y), (4.0, 1.0));
/// assert!(manifold.separations.iter().all(|separation| (separation + 0.01).abs() < 1e-15));
/// ```
#[inline(always)]
pub fn cuboid_pair<L: Lane>(
    first: &CuboidLanes<L>,
    second: &CuboidLanes<L>,
    apart: Vec3<L>,
    margin: L,
) -> ManifoldLanes<L> {
    let pair = Pair::new(first, second, apart);
    let gaps = pair.face_gaps();
    // Of small boxes the margin is small, and with it what a choice is worth.
    let most_lead = margin * L::splat(LEAD_SHARE);
    let leads = [L::splat(SECOND_LEAD).min(most_lead), L::splat(EDGE_LEAD).min(most_lead)];
    let (mut best, mut code) = (gaps[0], L::splat(0.0));
    let (mut widest, mut sum) = (gaps[0], gaps[0]);
    let mut axis = 1;
    while axis < 6 {
        let lead = if axis < 3 { L::splat(0.0) } else { leads[0] };
        let better = (best + lead).lt(gaps[axis]);
        code = L::select(better, L::splat(axis as f64), code);
        best = L::select(better, gaps[axis], best);
        widest = widest.max(gaps[axis]);
        sum = sum + gaps[axis];
        axis += 1;
    }
    let bar = best + leads[1];
    let (edge_gap, edge_code) = edges::widest_gap(&pair, bar);
    widest = widest.max(edge_gap);
    // What is not finite is not near.
    let near = L::select(margin.lt(widest), L::splat(0.0), L::splat(1.0));
    let near = L::select(sum.abs().lt(L::splat(FAR)), near, L::splat(0.0));
    let mut manifold = faces::contact(&pair, code, margin);
    let by_edges = bar.lt(edge_gap);
    if L::any(by_edges) {
        let crossing = edges::contact(&pair, edge_code, edge_gap);
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let is_flat = L::select(L::splat(FLAT).lt(crossing.normal.dot(manifold.normal)), one, zero);
        let off = (manifold.deepest() - edge_gap).abs();
        let as_deep = L::select(off.lt(L::splat(1.0 - FLAT) * edge_gap.abs()), is_flat, zero);
        let is_flat = L::select((zero - margin).lt(edge_gap), is_flat, as_deep);
        let by_edges = (is_flat * manifold.count.min(one)).lt(L::select(by_edges, one, zero));
        manifold = crossing.or(by_edges, manifold);
    }
    manifold.count = manifold.count * near;
    manifold
}
