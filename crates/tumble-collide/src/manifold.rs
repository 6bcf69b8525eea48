//! The contact manifold: one normal and up to four points with separations and feature ids.

use tumble_math::lane::Vec3;

use crate::scalar::Scalar;

/// Where two shapes are nearest to touching.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, contact_manifold};
/// use tumble_math::lane::Vec3;
///
/// let cube = ColliderShape::Cuboid { half_extents: Vec3::splat(0.5) };
/// let on_it = Isometry::at(Vec3::new(0.0, 1.01, 0.0));
/// let manifold = contact_manifold(&cube, &Isometry::at(Vec3::zero()), &cube, &on_it, 0.02);
/// for point in manifold.points() {
///     assert!(
///         (point.separation - 0.01_f64).abs() < 1e-15 && (point.position.y - 0.505).abs() < 1e-15
///     );
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint<R> {
    /// World coordinates, half-way between the two surfaces \[m\].
    pub position: Vec3<R>,
    /// Distance of the surfaces along the normal \[m\]; negative where they overlap.
    pub separation: R,
    /// Which vertices, edges and faces meet here. The same from step to step while the same ones
    /// do.
    pub feature: u32,
}

/// How two shapes touch: one normal, and up to four points on it.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, contact_manifold};
/// use tumble_math::lane::Vec3;
///
/// let cube = ColliderShape::Cuboid { half_extents: Vec3::splat(0.5) };
/// let on_it = Isometry::at(Vec3::new(0.0, 1.01, 0.0));
/// let manifold = contact_manifold(&cube, &Isometry::at(Vec3::zero()), &cube, &on_it, 0.02);
/// // A centimetre apart, which is nearer than the margin: the four corners.
/// assert_eq!((manifold.points().len(), manifold.normal.y), (4, 1.0_f64));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manifold<R> {
    /// Unit vector from the first shape to the second, world frame.
    pub normal: Vec3<R>,
    /// How far the points go along with the second shape when it moves past the first, from 0 to 1:
    /// a ball takes its point with it over a floor, and a large box leaves the points of a small
    /// one where the small one is.
    pub carried: R,
    points: Points<R>,
}

/// The most points that a manifold has, as many as a flat contact needs.
pub const MAX_MANIFOLD_POINTS: usize = 4;

/// Points are in a line if twice the area of a triangle of them is less than this part of the
/// square of its longest side.
pub(crate) const NARROW: f64 = 1e-6;

/// Up to [`MAX_MANIFOLD_POINTS`] points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Points<R> {
    points: [ContactPoint<R>; MAX_MANIFOLD_POINTS],
    len: usize,
}

impl<R: Scalar> Points<R> {
    pub(crate) fn none() -> Self {
        let point = ContactPoint { position: Vec3::zero(), separation: R::splat(0.0), feature: 0 };
        Self { points: [point; MAX_MANIFOLD_POINTS], len: 0 }
    }

    pub(crate) fn iter(&self) -> std::slice::Iter<'_, ContactPoint<R>> {
        self.points.get(..self.len).unwrap_or_default().iter()
    }

    pub(crate) fn iter_mut(&mut self) -> std::slice::IterMut<'_, ContactPoint<R>> {
        self.points.get_mut(..self.len).unwrap_or_default().iter_mut()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Orders four points that go around so that each pair of opposite ones is together: a solver
    /// that goes around a tall body, point by point, makes it whirl.
    fn pair_opposite(&mut self, normal: Vec3<R>) {
        if self.len < MAX_MANIFOLD_POINTS {
            return;
        }
        let [a, b, c, d] = self.points.map(|point| point.position);
        let area = |a: Vec3<R>, b: Vec3<R>, c: Vec3<R>| normal.dot((b - a).cross(c - a));
        let around = [area(a, b, c), area(b, c, d), area(c, d, a), area(d, a, b)];
        let narrow = (c - a).dot(c - a) * R::splat(NARROW);
        let goes = |way: R| around.iter().all(|area| *area * way > narrow);
        if goes(R::splat(1.0)) || goes(R::splat(-1.0)) {
            self.points.swap(1, 2);
        }
    }

    /// Adds one where there is room.
    pub(crate) fn push(&mut self, point: ContactPoint<R>) {
        if let Some(slot) = self.points.get_mut(self.len) {
            *slot = point;
            self.len += 1;
        }
    }
}

impl<R: Scalar> Manifold<R> {
    /// The shapes are further apart than was asked for.
    pub fn none() -> Self {
        Self { normal: Vec3::zero(), carried: R::splat(0.5), points: Points::none() }
    }

    pub(crate) fn new(normal: Vec3<R>, carried: R, mut points: Points<R>) -> Self {
        points.pair_opposite(normal);
        Self { normal, carried, points }
    }

    /// One point, given on the surface of the second shape, which carries it; none where it is
    /// further than `margin` or not finite.
    pub(crate) fn of_point(normal: Vec3<R>, on_second: Vec3<R>, separation: R, feature: u32, margin: R) -> Self {
        let mut points = Points::none();
        if separation <= margin {
            let position = on_second - normal * (separation * R::splat(0.5));
            points.push(ContactPoint { position, separation, feature });
        }
        Self { normal, carried: R::splat(1.0), points }
    }

    /// The nearest point alone, halfway between the surfaces; both shapes carry it as much.
    pub(crate) fn of_nearest(normal: Vec3<R>, position: Vec3<R>, separation: R) -> Self {
        let mut points = Points::none();
        points.push(ContactPoint { position, separation, feature: u32::MAX });
        Self { normal, carried: R::splat(0.5), points }
    }

    /// The same where both shapes carry the points as much.
    pub(crate) fn carried_by_both(self) -> Self {
        Self { carried: R::splat(0.5), ..self }
    }

    /// The same seen from the other shape.
    pub(crate) fn swapped(self) -> Self {
        let one = R::splat(1.0);
        Self { normal: self.normal * -one, carried: one - self.carried, ..self }
    }

    /// The same from another frame.
    pub(crate) fn seen<S: Scalar>(
        &self,
        place: impl Fn(Vec3<R>) -> Vec3<S>,
        turn: impl Fn(Vec3<R>) -> Vec3<S>,
    ) -> Manifold<S> {
        let mut points = Points::none();
        for point in self.points() {
            points.push(ContactPoint {
                position: place(point.position),
                separation: S::splat(point.separation.into()),
                feature: point.feature,
            });
        }
        Manifold { normal: turn(self.normal), carried: S::splat(self.carried.into()), points }
    }

    /// Where they touch; none if they are further apart than was asked for.
    pub fn points(&self) -> &[ContactPoint<R>] {
        self.points.iter().as_slice()
    }
}
