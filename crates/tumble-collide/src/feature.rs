//! The flat piece of a shape that lies furthest in a direction: a face, an edge or a point.

use tumble_math::lane::Vec3;

use crate::manifold_reduction::pressed_in;
use crate::scalar::Scalar;

/// The most corners of a piece; of a face with more, as many are left out evenly.
pub(crate) const MAX_CORNERS: usize = 16;

/// How far a face may be out of the way and still be stood on \[m\].
#[derive(Clone, Copy)]
pub(crate) struct Near {
    pub(crate) margin: f64,
    /// How far a load presses it in.
    pub(crate) pressed: f64,
}

impl Near {
    /// Of shapes at this separation \[m\].
    pub(crate) fn at(separation: f64, margin: f64) -> Self {
        Self { margin, pressed: pressed_in(separation, margin) }
    }
}

/// A corner, and its number in the shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner<R> {
    pub(crate) at: Vec3<R>,
    pub(crate) id: u32,
}

/// One corner, the two ends of an edge, or the corners of a face counter-clockwise as seen from
/// outside, with room for `N`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Feature<R, const N: usize = MAX_CORNERS> {
    corners: [Corner<R>; N],
    len: usize,
    /// Unit normal of a face, outwards; of anything else it means nothing.
    pub(crate) normal: Vec3<R>,
}

impl<R: Scalar, const N: usize> Feature<R, N> {
    /// The corners given, as far as there is room.
    pub(crate) fn new(corners: impl IntoIterator<Item = (Vec3<R>, u32)>, normal: Vec3<R>) -> Self {
        let nowhere = Corner { at: Vec3::zero(), id: 0 };
        let mut this = Self { corners: [nowhere; N], len: 0, normal };
        for ((at, id), slot) in corners.into_iter().zip(&mut this.corners) {
            *slot = Corner { at, id };
            this.len += 1;
        }
        this
    }

    pub(crate) fn point(at: Vec3<R>) -> Self {
        Self::new([(at, 0)], Vec3::zero())
    }

    pub(crate) fn segment(from: Vec3<R>, to: Vec3<R>) -> Self {
        Self::new([(from, 0), (to, 1)], Vec3::zero())
    }

    /// The face of a box about the origin that looks most in a direction. The number of a corner
    /// has a bit for each coordinate that is positive.
    pub(crate) fn of_cuboid(half: Vec3<R>, direction: Vec3<R>) -> Self {
        let along = [direction.x, direction.y, direction.z];
        let mut axis = 0;
        for other in 1..3 {
            if along[other].abs() > along[axis].abs() {
                axis = other;
            }
        }
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let positive = along[axis] >= R::splat(0.0);
        let bits = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let corner = |place: usize| {
            let [on_u, on_v] = bits[if positive { place } else { 3 - place }];
            let id = u32::from(positive) << axis | on_u << u | on_v << v;
            let sign = |bit: u32| R::splat(if id >> bit & 1 == 1 { 1.0 } else { -1.0 });
            (half.scale(Vec3::new(sign(0), sign(1), sign(2))), id)
        };
        let unit = |of: usize| {
            R::splat(if of != axis {
                0.0
            } else if positive {
                1.0
            } else {
                -1.0
            })
        };
        Self::new((0..4).map(corner), Vec3::new(unit(0), unit(1), unit(2)))
    }

    pub(crate) fn corners(&self) -> &[Corner<R>] {
        self.corners.get(..self.len).unwrap_or_default()
    }

    /// The same in another frame.
    pub(crate) fn seen(&self, place: impl Fn(Vec3<R>) -> Vec3<R>, turn: impl Fn(Vec3<R>) -> Vec3<R>) -> Self {
        Self::new(self.corners().iter().map(|corner| (place(corner.at), corner.id)), turn(self.normal))
    }
}
