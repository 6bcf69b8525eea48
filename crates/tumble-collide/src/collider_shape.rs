//! Collision shapes and their placement: AABBs, support points, and the parts of compounds.

use std::sync::Arc;

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::aabb::Aabb;
use crate::compound::Compound;
use crate::convex_hull::ConvexHull;
use crate::cuboids::{CuboidLanes, cuboid_reach};
use crate::height_field::HeightField;
use crate::mesh::Mesh;
use crate::mesh_pair;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, narrow, unit, wide};
use crate::surface::Surface;

/// A shape that others can touch, in its own frame: axes of revolution lie along y, and the origin
/// is at mid-height, as in [`tumble_math::Shape`]. Lengths are in metres.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry};
/// use tumble_math::lane::Vec3;
///
/// let can = ColliderShape::Cylinder { radius: 0.5, half_height: 2.0 };
/// let aabb = can.aabb(&Isometry::at(Vec3::new(1.0, 0.0, 0.0)), 0.0).unwrap();
/// assert_eq!((aabb.low, aabb.high), (Vec3::new(0.5, -2.0, -0.5), Vec3::new(1.5, 2.0, 0.5)));
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ColliderShape<R> {
    /// A ball about the origin.
    Sphere {
        /// \[m\]
        radius: R,
    },
    /// A box about the origin.
    Cuboid {
        /// Half the lengths of its edges along x, y and z \[m\].
        half_extents: Vec3<R>,
    },
    /// A cylinder along y with a half ball on each end.
    Capsule {
        /// \[m\]
        radius: R,
        /// Half the distance of the centres of its ends \[m\].
        half_height: R,
    },
    /// A cylinder along y. It is round: it rolls.
    Cylinder {
        /// \[m\]
        radius: R,
        /// Half the distance of its caps \[m\].
        half_height: R,
    },
    /// A cone along y, its base at `-half_height` and its tip at `+half_height`.
    Cone {
        /// Of the base \[m\].
        radius: R,
        /// Half the distance of tip and base \[m\].
        half_height: R,
    },
    /// A cone along y without its tip: a cylinder whose ends differ.
    Frustum {
        /// At `-half_height` \[m\].
        radius_bottom: R,
        /// At `+half_height` \[m\].
        radius_top: R,
        /// Half the distance of its caps \[m\].
        half_height: R,
    },
    /// A capsule along y whose ends differ.
    TaperedCapsule {
        /// Of the ball about `-half_height` \[m\].
        radius_bottom: R,
        /// Of the ball about `+half_height` \[m\].
        radius_top: R,
        /// Half the distance of the centres of its ends \[m\].
        half_height: R,
    },
    /// An ellipsoid about the origin.
    Ellipsoid {
        /// Along x, y and z \[m\].
        radii: Vec3<R>,
    },
    /// The convex hull of points.
    Hull(Arc<ConvexHull>),
    /// A surface of triangles. It touches everything but other surfaces.
    Mesh(Arc<Mesh>),
    /// Ground given by heights. It touches everything but other surfaces.
    HeightField(Arc<HeightField>),
    /// Several shapes, each at its place.
    Compound(Arc<Compound<R>>),
    /// All below the plane y = 0: infinite ground.
    HalfSpace,
}

/// Cosine of a thousandth of a radian.
const ALONG_NORMAL: f64 = 1.0 - 5e-7;

/// Where the frame of a shape is.
///
/// ```
/// use tumble_collide::Isometry;
/// use tumble_math::lane::{Quat, Vec3};
///
/// let turned = Isometry {
///     position: Vec3::new(1.0, 0.0, 0.0),
///     orientation: Quat { x: 0.0, y: 0.0, z: 1.0, w: 0.0 },
/// };
/// let part = turned.then(&Isometry::at(Vec3::new(0.25, 0.0, 0.0)));
/// assert_eq!(part.position, Vec3::new(0.75, 0.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isometry<R> {
    /// Its origin \[m\].
    pub position: Vec3<R>,
    /// Unit quaternion from the shape's coordinates to the world's.
    pub orientation: Quat<R>,
}

impl<R: Scalar> Isometry<R> {
    /// Not turned.
    pub fn at(position: Vec3<R>) -> Self {
        let zero = Vec3::zero();
        Self { position, orientation: Quat::from_parts(R::splat(1.0), zero) }
    }

    /// Where something placed `inner` in this frame is in the world.
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        Self { position: self.to_world(inner.position), orientation: self.orientation * inner.orientation }
    }

    /// Whether it is a place: finite, and turned by a quaternion that is about a unit.
    #[inline]
    pub(crate) fn is_somewhere(&self) -> bool {
        let (square, length) = (self.position.dot(self.position), self.orientation.length_squared());
        square < R::splat(f64::INFINITY) && length > R::splat(0.5) && length < R::splat(2.0)
    }

    /// World coordinates of a point of the shape.
    #[inline]
    pub(crate) fn to_world(self, point: Vec3<R>) -> Vec3<R> {
        self.position + self.orientation.rotate(point)
    }

    /// The shape's coordinates of a point of the world.
    #[inline]
    pub(crate) fn to_local(self, point: Vec3<R>) -> Vec3<R> {
        self.orientation.rotate_back(point - self.position)
    }
}

impl<R: Scalar> ColliderShape<R> {
    /// The smallest box along the world's axes that holds the shape, and `margin` \[m\] around it;
    /// `None` for what has no end.
    ///
    /// Of a mesh or a height field it is that of the box along its own axes.
    pub fn aabb(&self, at: &Isometry<R>, margin: R) -> Option<Aabb<R>> {
        let [x, y, z] = at.orientation.axes();
        let rows = [Vec3::new(x.x, y.x, z.x), Vec3::new(x.y, y.y, z.y), Vec3::new(x.z, y.z, z.z)];
        let of_box = |center: Vec3<R>, h: Vec3<R>| {
            let reach = cuboid_reach(&CuboidLanes { half_extents: h, orientation: at.orientation });
            Aabb::about(at.to_world(center), reach + Vec3::splat(margin))
        };
        let of_surface =
            |aabb: Aabb<f64>| of_box(narrow((aabb.low + aabb.high) * 0.5), narrow((aabb.high - aabb.low) * 0.5));
        match self {
            Self::Sphere { radius } => Some(Aabb::about(at.position, Vec3::splat(*radius + margin))),
            Self::Cuboid { half_extents } => Some(of_box(Vec3::zero(), *half_extents)),
            Self::HalfSpace => None,
            Self::Mesh(mesh) => Some(of_surface(mesh.aabb())),
            Self::HeightField(field) => Some(of_surface(field.aabb())),
            Self::Compound(compound) => {
                let mut all: Option<Aabb<R>> = None;
                for (_, at, part) in compound.placed(at) {
                    let aabb = part.aabb(&at, margin)?;
                    all = Some(all.map_or(aabb, |all: Aabb<R>| all.union(&aabb)));
                }
                // Nothing at all is a point.
                all.or_else(|| Some(Aabb::about(at.position, Vec3::splat(margin))))
            }
            _ => {
                let (support_map, layer) = Convex::of(self)?;
                let more = R::splat(layer) + margin;
                // Row by row: the world's axes as the shape sees them.
                let reach = |row: Vec3<R>, sign: f64| {
                    let d = Vector::new(row.x.into(), row.y.into(), row.z.into()) * sign;
                    R::splat(support_map.support(d).dot(d))
                };
                let [high, low] = [1.0, -1.0].map(|sign| {
                    let [x, y, z] = rows.map(|row| reach(row, sign) + more);
                    Vec3::new(x, y, z)
                });
                Some(Aabb { low: at.position - low, high: at.position + high })
            }
        }
    }

    /// Whether some of its surface is curved: where such a shape rolls, its contacts move over it.
    ///
    /// ```
    /// use tumble_collide::ColliderShape;
    /// use tumble_math::lane::Vec3;
    ///
    /// assert!(ColliderShape::Cylinder { radius: 0.5, half_height: 1.0 }.is_round());
    /// assert!(!ColliderShape::Cuboid { half_extents: Vec3::splat(1.0) }.is_round());
    /// ```
    pub fn is_round(&self) -> bool {
        match self {
            Self::Cuboid { .. } | Self::Hull(_) | Self::Mesh(_) | Self::HeightField(_) | Self::HalfSpace => false,
            Self::Compound(compound) => compound.has_round_part(),
            _ => true,
        }
    }

    /// Whether it stays where it is when it turns about its y axis.
    ///
    /// ```
    /// use tumble_collide::ColliderShape;
    /// use tumble_math::lane::Vec3;
    ///
    /// let ellipsoid = |x: f64| ColliderShape::Ellipsoid { radii: Vec3::new(x, 2.0, 1.0) };
    /// assert!(ColliderShape::Cone { radius: 0.5, half_height: 1.0 }.is_axially_symmetric());
    /// assert!(ellipsoid(1.0).is_axially_symmetric() && !ellipsoid(1.5).is_axially_symmetric());
    /// ```
    pub fn is_axially_symmetric(&self) -> bool {
        let is_half_space = matches!(self, Self::HalfSpace);
        is_half_space || Convex::of(self).is_some_and(|(inner, _)| inner.is_axially_symmetric())
    }

    /// Whether a part that [`contact_manifolds`](crate::contact_manifolds) names is a flat piece of
    /// a surface, and not a side or corner of its triangles. Other shapes have no such parts, and
    /// all of theirs count as flat.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use tumble_collide::{ColliderShape, HeightField};
    ///
    /// // Two triangles in one plane, and what is beside them.
    /// let field = HeightField::new([0.0; 4], 2, [1.0; 2]).unwrap();
    /// let flat = ColliderShape::<f64>::HeightField(Arc::new(field));
    /// assert!(flat.is_flat_part(0) && !flat.is_flat_part(1));
    /// ```
    pub fn is_flat_part(&self, part: u32) -> bool {
        match self {
            Self::Mesh(mesh) => part < mesh.patches().count(),
            Self::HeightField(field) => part < field.patches().count(),
            _ => true,
        }
    }

    /// Half its thickness where it is thinnest, or somewhat less \[m\]: what goes through it by
    /// less is still on the side it came from. Zero for surfaces.
    ///
    /// ```
    /// use tumble_collide::ColliderShape;
    /// use tumble_math::lane::Vec3;
    ///
    /// let plate = ColliderShape::Cuboid { half_extents: Vec3::new(1.0, 0.05, 2.0) };
    /// assert_eq!(plate.ccd_thickness(), 0.05);
    /// ```
    pub fn ccd_thickness(&self) -> R {
        let (zero, half) = (R::splat(0.0), R::splat(0.5));
        let least = |v: Vec3<R>| v.x.min(v.y).min(v.z);
        match self {
            Self::Sphere { radius } | Self::Capsule { radius, .. } => *radius,
            Self::Cuboid { half_extents } => least(*half_extents),
            Self::Ellipsoid { radii } => least(*radii),
            Self::Cylinder { radius, half_height } => radius.min(*half_height),
            Self::Cone { radius, half_height } => radius.min(*half_height) * half,
            Self::Frustum { radius_bottom, radius_top, half_height } => {
                radius_bottom.max(*radius_top).min(*half_height) * half
            }
            Self::TaperedCapsule { radius_bottom, radius_top, .. } => radius_bottom.min(*radius_top),
            Self::HalfSpace => R::splat(f64::INFINITY),
            Self::Mesh(_) | Self::HeightField(_) => zero,
            Self::Compound(compound) => {
                let here = Isometry::at(Vec3::zero());
                let parts = compound.placed(&here).map(|(_, _, part)| part.ccd_thickness());
                parts.reduce(Lane::min).unwrap_or(zero)
            }
            Self::Hull(_) => {
                let aabb = self.aabb(&Isometry::at(Vec3::zero()), zero);
                aabb.map_or(zero, |aabb| least(aabb.high - aabb.low) * (half * half))
            }
        }
    }

    /// The longest distance of a point of the shape from its origin \[m\], or somewhat more; `None`
    /// for what has no end.
    pub fn reach(&self) -> Option<R> {
        let length = |v: Vec3<R>| v.dot(v).sqrt();
        let zero = R::splat(0.0);
        let of_surface = |aabb: Aabb<f64>| {
            let most = |low: f64, high: f64| f64::max(high, -low);
            let (low, high) = (aabb.low, aabb.high);
            length(narrow(Vector::new(most(low.x, high.x), most(low.y, high.y), most(low.z, high.z))))
        };
        match self {
            Self::Sphere { radius } => Some(*radius),
            Self::Cuboid { half_extents } => Some(length(*half_extents)),
            Self::Capsule { radius, half_height } => Some(*radius + *half_height),
            Self::Cylinder { radius, half_height } | Self::Cone { radius, half_height } => {
                Some(length(Vec3::new(*radius, *half_height, zero)))
            }
            Self::Frustum { radius_bottom, radius_top, half_height } => {
                Some(length(Vec3::new(radius_bottom.max(*radius_top), *half_height, zero)))
            }
            Self::TaperedCapsule { radius_bottom, radius_top, half_height } => {
                Some(radius_bottom.max(*radius_top) + *half_height)
            }
            Self::Ellipsoid { radii } => Some(radii.x.max(radii.y).max(radii.z)),
            Self::Hull(hull) => Some(R::splat(hull.reach())),
            Self::Mesh(mesh) => Some(of_surface(mesh.aabb())),
            Self::HeightField(field) => Some(of_surface(field.aabb())),
            Self::Compound(compound) => compound.reach(),
            Self::HalfSpace => None,
        }
    }

    /// The point that is furthest in a direction, in the shape's frame; `None` of compounds,
    /// surfaces and half-spaces.
    ///
    /// ```
    /// use tumble_collide::ColliderShape;
    /// use tumble_math::lane::Vec3;
    ///
    /// let cube = ColliderShape::Cuboid { half_extents: Vec3::splat(0.5) };
    /// assert_eq!(cube.furthest(Vec3::new(1.0, 2.0, -3.0)), Some(Vec3::new(0.5, 0.5, -0.5)));
    /// ```
    pub fn furthest(&self, direction: Vec3<R>) -> Option<Vec3<R>> {
        let (support_map, layer) = Convex::of(self)?;
        let direction = wide(direction);
        Some(narrow(support_map.support(direction) + unit(direction) * layer))
    }

    /// Whether it has a flat face whose outward normal is a unit vector, to a thousandth of a
    /// radian. Always true of surfaces, whose contacts have the normals of their faces, and of
    /// half-spaces.
    ///
    /// ```
    /// use tumble_collide::ColliderShape;
    /// use tumble_math::lane::Vec3;
    ///
    /// let can = ColliderShape::Cylinder { radius: 0.5, half_height: 2.0 };
    /// assert!(can.has_face(Vec3::new(0.0, 1.0, 0.0)) && !can.has_face(Vec3::new(1.0, 0.0, 0.0)));
    /// ```
    pub fn has_face(&self, direction: Vec3<R>) -> bool {
        match Convex::of(self) {
            Some((support_map, _)) => {
                let direction = wide(direction);
                support_map.face_normal(direction).is_some_and(|normal| normal.dot(direction) > ALONG_NORMAL)
            }
            None => true,
        }
    }

    /// The part that has a number, of those that [`parts`](Self::parts) counts: the first of its
    /// numbers, its place in the whole, and its shape. The whole where that is no compound.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use tumble_collide::{ColliderShape, Compound, Isometry};
    /// use tumble_math::lane::Vec3;
    ///
    /// let sphere =
    ///     |x: f64| (Isometry::at(Vec3::new(x, 0.0, 0.0)), ColliderShape::Sphere { radius: 0.5 });
    /// let dumbbell =
    ///     ColliderShape::Compound(Arc::new(Compound::new([sphere(-1.0), sphere(1.0)])));
    /// let (first, at, part) = dumbbell.part_of(1);
    /// assert_eq!((first, at.position.x, part), (1, 1.0, &ColliderShape::Sphere { radius: 0.5 }));
    /// ```
    pub fn part_of(&self, number: u32) -> (u32, Isometry<R>, &Self) {
        let whole = (0, Isometry::at(Vec3::zero()), self);
        match self {
            Self::Compound(compound) => {
                compound.part_of(number).map_or(whole, |(first, (at, part))| (first, *at, part))
            }
            _ => whole,
        }
    }

    /// How many numbers its parts have: [`contact_manifolds`](crate::contact_manifolds) numbers a
    /// pair of parts as that of the first shape times this of the second, and that of the second.
    /// One of what has no parts.
    pub fn parts(&self) -> u32 {
        match self {
            Self::Mesh(mesh) => mesh_pair::parts(mesh.as_ref(), mesh.points().len()),
            Self::HeightField(field) => mesh_pair::parts(field.as_ref(), field.points().len()),
            Self::Compound(compound) => compound.count(),
            _ => 1,
        }
    }
}
