//! How each contact bears its upper body under gravity.

use tumble_collide::MAX_MANIFOLD_POINTS;
use tumble_math::lane::Vec3;

use crate::collision::contact::ContactRecord;
use crate::collision::contact_rows::{ContactGeometry, ContactLanes};
use crate::math::Real;
use crate::simd::{BLOCK, Kernel, Octet, Tile, gather_rows, octet, select_rows, store_rows};
use crate::storage::body_index::Slot;

octet! {
    /// A body as its loads see it.
    pub(super) struct StackBody<T> {
        /// Of mass \[m\].
        pub(super) center: Vec3<T>,
        /// [1/kg]; zero for non-dynamic bodies.
        pub(super) inverse_mass: T,
        /// Inverse inertia about the two horizontal directions [1/(kg m^2)]: `xx yy xy`.
        pub(super) inverse_inertia: [T; 3],
        /// One where the body is dynamic, else zero.
        pub(super) is_dynamic: T,
    }
}

octet! {
    /// How a contact bears its upper body: sums over its points, as [`Base`] has them.
    pub(super) struct Support<T> {
        /// [N/m]; below zero where the first body is the upper one, zero where the contact bears
        /// nothing.
        pub(super) signed_stiffness: T,
        first: [T; 2],
        second: [T; 3],
        height: T,
        /// The margin \[m\]; below zero where fewer than three points bear.
        pub(super) signed_margin: T,
    }
}

/// The support of a body or of several: sums over points by their stiffness [N/m].
#[derive(Clone, Copy)]
pub(super) struct Base {
    pub(super) stiffness: Real,
    /// Of horizontal places from the upper body's centre of mass, of their squares and product, and
    /// of heights.
    first: [Real; 2],
    second: [Real; 3],
    height: Real,
    /// Whether a contact of three points or more bears.
    on_face: bool,
    /// The least margin of its contacts \[m\].
    pub(super) margin: Real,
}

/// Least vertical part of the normal of a contact that bears.
const MIN_SLOPE: f64 = 0.5;
/// A body that is deeper \[margins\] was shot in and does not rest: twice half its thickness.
const DEEP: f64 = 100.0;
/// Root mean square distance from the middle \[margins\] of what a body rests on, below which that
/// is an edge or a corner and not a face.
const MIN_SPREAD: Real = 8.0;

impl Base {
    pub(super) const NONE: Self =
        Self { stiffness: 0.0, first: [0.0; 2], second: [0.0; 3], height: 0.0, on_face: false, margin: Real::INFINITY };

    pub(super) fn of(&Support { signed_stiffness, first, second, height, signed_margin }: &Support) -> Self {
        let (stiffness, on_face, margin) = (signed_stiffness.abs(), signed_margin > 0.0, signed_margin.abs());
        Self { stiffness, first, second, height, on_face, margin }
    }

    /// One spring at a horizontal place, and at no height.
    pub(super) fn at([x, y]: [Real; 2], stiffness: Real) -> Self {
        let (first, second) =
            ([x * stiffness, y * stiffness], [x * x * stiffness, y * y * stiffness, x * y * stiffness]);
        Self { stiffness, first, second, ..Self::NONE }
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.stiffness += other.stiffness;
        self.height += other.height;
        self.on_face |= other.on_face;
        self.margin = self.margin.min(other.margin);
        self.first.iter_mut().zip(other.first).for_each(|(sum, it)| *sum += it);
        self.second.iter_mut().zip(other.second).for_each(|(sum, it)| *sum += it);
    }

    /// The same from a place which this horizontal vector and height lead back from.
    pub(super) fn moved(&self, [dx, dy]: [Real; 2], up: Real) -> Self {
        let Self { stiffness, first: [x, y], second: [xx, yy, xy], height, .. } = *self;
        Self {
            first: [x + dx * stiffness, y + dy * stiffness],
            second: [
                xx + dx * (2.0 * x + dx * stiffness),
                yy + dy * (2.0 * y + dy * stiffness),
                xy + dx * y + dy * (x + dx * stiffness),
            ],
            height: height + up * stiffness,
            ..*self
        }
    }

    /// The resistance to tilting about its middle, about the axis where that is least [N m].
    pub(super) fn least(&self) -> Real {
        let Self { stiffness, first: [x, y], second: [xx, yy, xy], .. } = *self;
        let (xx, yy, xy) = (xx - x * x / stiffness, yy - y * y / stiffness, xy - x * y / stiffness);
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        mean - (half * half + xy * xy).sqrt()
    }

    /// The moment about this support [N m] of a weight \[N\] with its moment about height zero;
    /// the body's height is in \[m\].
    pub(super) fn lever(&self, [weight, moment]: [Real; 2], height: Real) -> Real {
        moment - weight * (height + self.height / self.stiffness)
    }

    /// `W H / k` for a lever `W H` [N m].
    pub(super) fn lean(&self, lever: Real) -> Real {
        let (least, spread) = (self.least(), MIN_SPREAD * self.margin);
        if self.on_face && lever > 0.0 && least > spread * spread * self.stiffness { lever / least } else { 0.0 }
    }
}

/// Two horizontal directions.
pub(super) fn sides(up: Vec3<Real>) -> [Vec3<Real>; 2] {
    let least = if up.x * up.x <= 0.5 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let side = up.cross(least);
    let side = side * (1.0 / side.dot(side).sqrt());
    [side, up.cross(side)]
}

/// Works out how contacts bear their upper bodies.
pub(super) struct Bear<'a> {
    pub(super) supports: &'a mut [Support],
    pub(super) contacts: &'a [ContactRecord],
    pub(super) bodies: &'a [StackBody],
    pub(super) up: Vec3<Real>,
    pub(super) sides: [Vec3<Real>; 2],
    /// Stiffness for each kilogram: between dynamic bodies, and on a non-dynamic one.
    pub(super) rates: [Real; 2],
}

impl Bear<'_> {
    /// The contacts from `i` on.
    #[inline(always)]
    fn contacts<T: Tile>(&self, i: usize) -> ContactLanes<'_> {
        let mut picked = ContactLanes::empty();
        let mut l = 0;
        while l < T::WIDTH && i + l < self.contacts.len() {
            picked.set(l, &self.contacts[i + l]);
            l += 1;
        }
        picked
    }

    /// The first or the second bodies of the contacts from `i` on.
    #[inline(always)]
    fn bodies<T: Tile>(&self, which: usize, i: usize) -> StackBody<T> {
        let mut picked = [StackBody::zero(); BLOCK];
        let mut l = 0;
        while l < T::WIDTH && i + l < self.contacts.len() {
            picked[l] = &self.bodies[self.contacts[i + l].slots[which].index()];
            l += 1;
        }
        gather_rows(&picked)
    }
}

impl Kernel for Bear<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.supports.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let (up, sides) = (splat(self.up), [splat(self.sides[0]), splat(self.sides[1])]);
        let contacts = self.contacts::<T>(i);
        let ContactGeometry { normal, count, .. } = contacts.geometry::<T>();
        let margin = contacts.friction::<T>().margin;
        let slope = up.dot(normal);
        let (first, second) = (self.bodies::<T>(0, i), self.bodies::<T>(1, i));
        let upper = select_rows::<T, StackBody>(zero.lt(slope), second, first);
        let lower = select_rows::<T, StackBody>(zero.lt(slope), first, second);
        let to_upper = second.center - upper.center;

        let (places, separations) = contacts.points::<T>();
        let deep = margin * T::splat(-DEEP);
        let (mut points, mut sum, mut second_moments) = (zero, [zero; 3], [zero; 3]);
        let mut j = 0;
        while j < MAX_MANIFOLD_POINTS {
            let is_point = T::select(T::splat(j as f64).lt(count), one, zero);
            let weight = T::select(margin.lt(separations[j]), zero, is_point);
            let weight = T::select(separations[j].lt(deep), zero, weight);
            let place = Vec3::select(zero.lt(weight), to_upper + places[j], Vec3::zero());
            let (x, y) = (sides[0].dot(place), sides[1].dot(place));
            points = points + weight;
            sum = [sum[0] + x, sum[1] + y, sum[2] + up.dot(place)];
            second_moments = [second_moments[0] + x * x, second_moments[1] + y * y, second_moments[2] + x * y];
            j += 1;
        }
        let apart = upper.center - lower.center;
        let (x, y, two) = (sides[0].dot(apart), sides[1].dot(apart), T::splat(2.0));
        let about_lower = [
            second_moments[0] + x * (two * sum[0] + points * x),
            second_moments[1] + y * (two * sum[1] + points * y),
            second_moments[2] + x * sum[1] + y * sum[0] + points * x * y,
        ];
        let responses =
            summed_inverse_mass(&upper, points, second_moments) + summed_inverse_mass(&lower, points, about_lower);
        let [between, on_ground] = [T::splat(self.rates[0].into()), T::splat(self.rates[1].into())];
        let rate = T::select(zero.lt(lower.is_dynamic), between, on_ground);
        // Nothing rests on a wall, nor where no point is near; non-dynamic bodies need no support.
        let stiffness = rate * points / responses;
        let stiffness = T::select(slope.abs().lt(T::splat(MIN_SLOPE)), zero, stiffness);
        let stiffness = T::select(zero.lt(points * upper.is_dynamic * margin), stiffness, zero);
        let [xx, yy, xy] = second_moments;
        let total = stiffness * points;
        let support = Support {
            signed_stiffness: T::select(zero.lt(slope), total, zero - total),
            first: [sum[0] * stiffness, sum[1] * stiffness],
            second: [xx * stiffness, yy * stiffness, xy * stiffness],
            height: sum[2] * stiffness,
            signed_margin: T::select(two.lt(points), margin, zero - margin),
        };
        store_rows(support, &mut self.supports[i..]);
    }
}

/// How points at these second moments from the centre of a body give way to impulses, summed.
#[inline(always)]
fn summed_inverse_mass<T: Tile>(body: &StackBody<T>, points: T, [xx, yy, xy]: [T; 3]) -> T {
    let [about_x, about_y, coupled] = body.inverse_inertia;
    body.inverse_mass * points + about_x * yy + about_y * xx - T::splat(2.0) * coupled * xy
}

#[inline(always)]
fn splat<T: Tile>(v: Vec3<Real>) -> Vec3<T> {
    Vec3::new(T::splat(v.x.into()), T::splat(v.y.into()), T::splat(v.z.into()))
}

/// The upper and the lower of a contact's bodies; no slots where it bears nothing.
pub(super) fn upper_and_lower(support: &Support, [first, second]: [Slot; 2]) -> [Slot; 2] {
    if support.signed_stiffness == 0.0 {
        [Slot::NONE; 2]
    } else if support.signed_stiffness > 0.0 {
        [second, first]
    } else {
        [first, second]
    }
}
