//! Shapes of bodies and their mass properties.

use std::f64::consts::PI;
use std::ops::RangeInclusive;
use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};

use crate::mass_properties::{MassProperties, check_mass};
use crate::mesh::SolidMesh;
use crate::revolved::Revolved;
use crate::shape_error::{ShapeError, ShapeErrorReason};

/// The shape of a homogeneous body, in its own frame.
///
/// Axes of revolution lie along local y, the origin is at mid-height (as in parry and in glTF's
/// KHR_implicit_shapes). The inertia is about the centre of mass, `m` is the mass, `h` the half
/// height, `r` the radius.
///
/// Nothing is checked until [`mass_properties`](Self::mass_properties), whose errors name the
/// parameter. The formulas are textbook ones, tested against 40-digit integrals.
///
/// ```
/// use tumble_math::{Amount, Shape};
///
/// let brick = Shape::cuboid([0.1, 0.05, 0.03]).mass_properties(Amount::Density(2000.0))?;
/// assert!((brick.mass() - 2.4).abs() < 1e-15);
///
/// let error = Shape::sphere(-1.0).mass_properties(Amount::Mass(1.0)).unwrap_err();
/// assert_eq!(error.to_string(), "radius must be a length from 1e-90 to 1e90 m, it is -1.0");
/// # Ok::<(), tumble_math::ShapeError>(())
/// ```
#[doc(alias("box", "ball", "sphere", "cuboid", "geometry"))]
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A point mass at the origin: no volume, no inertia.
    Point,
    /// A solid sphere. `I = 2/5 m r^2`.
    Sphere {
        /// Radius \[m\].
        radius: f64,
    },
    /// An infinitely thin spherical shell. `I = 2/3 m r^2`. It has no volume, so it needs a mass.
    HollowSphere {
        /// Radius \[m\].
        radius: f64,
    },
    /// A block. `I_xx = m/3 (b^2 + c^2)` with half extents `a, b, c`.
    Cuboid {
        /// Half the lengths of the edges along x, y, z \[m\].
        half_extents: DVec3,
    },
    /// A solid cylinder along y. `I_yy = m r^2/2`, `I_xx = I_zz = m (r^2/4 + h^2/3)`.
    Cylinder {
        /// Radius \[m\].
        radius: f64,
        /// Half the height \[m\].
        half_height: f64,
    },
    /// A cylinder along y with a half sphere on each end.
    ///
    /// With the masses `c` of the cylinder and `s` of the two caps, `c : s = 3h : 2r`,
    /// `I_yy = c r^2/2 + 2/5 s r^2` and
    /// `I_xx = I_zz = c (r^2/4 + h^2/3) + s (2/5 r^2 + 3/4 h r + h^2)`.
    Capsule {
        /// Radius \[m\].
        radius: f64,
        /// Half the distance between the centres of the caps \[m\].
        half_height: f64,
    },
    /// A solid cone along y, apex at `+half_height`, base at `-half_height`; its centre of mass is
    /// at `-half_height/2`. `I_yy = 3/10 m r^2`, `I_xx = I_zz = 3/20 m (r^2 + h^2)`.
    Cone {
        /// Radius of the base \[m\].
        radius: f64,
        /// Half the height \[m\].
        half_height: f64,
    },
    /// A solid frustum of a cone along y: a cylinder whose ends differ. One of the radii may be
    /// zero, but not both. Formulas: [`MassProperties::frustum`].
    Frustum {
        /// Radius at `-half_height` \[m\].
        radius_bottom: f64,
        /// Radius at `+half_height` \[m\].
        radius_top: f64,
        /// Half the height \[m\].
        half_height: f64,
    },
    /// The convex hull of two spheres on y: a capsule whose ends differ. One of the radii may be
    /// zero, but not both. If one sphere holds the other, it is all. See
    /// [`MassProperties::tapered_capsule`].
    TaperedCapsule {
        /// Radius of the sphere about `-half_height` \[m\].
        radius_bottom: f64,
        /// Radius of the sphere about `+half_height` \[m\].
        radius_top: f64,
        /// Half the distance between the centres of the spheres \[m\].
        half_height: f64,
    },
    /// A solid ellipsoid. `I_xx = m/5 (b^2 + c^2)` with semi-axes `a, b, c`.
    Ellipsoid {
        /// Semi-axes along x, y, z \[m\].
        radii: DVec3,
    },
    /// What a triangle mesh bounds, exactly; in the frame of its vertices.
    Mesh(Arc<SolidMesh>),
    /// Shapes fixed to each other, each with its own pose and mass. Where they overlap, both masses
    /// count.
    Compound(Vec<Part>),
}

/// One part of a [`Shape::Compound`].
///
/// ```
/// use tumble_math::{Amount, Part, Shape};
/// let arm = Part::new(Shape::cylinder(0.02, 0.3), Amount::Density(2700.0));
/// // Along x instead of y, and with one end at the origin.
/// let arm =
///     arm.turned(glam::DQuat::from_rotation_z(-std::f64::consts::FRAC_PI_2)).at([0.3, 0.0, 0.0]);
/// let center = Shape::compound([arm]).own_mass_properties()?.center_of_mass();
/// assert!(center.abs_diff_eq(glam::DVec3::X * 0.3, 1e-15));
/// # Ok::<(), tumble_math::ShapeError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Shape of the part.
    pub shape: Shape,
    /// Position of the part's frame in the compound's \[m\].
    pub position: DVec3,
    /// Rotation from the part's frame to the compound's.
    pub orientation: DQuat,
    /// Mass or density of the part.
    pub amount: Amount,
}

/// How much matter: a mass or a density.
///
/// ```
/// use tumble_math::{Amount, Shape};
/// let cube = Shape::cuboid([0.5, 0.5, 0.5]);
/// assert_eq!(
///     cube.mass_properties(Amount::Density(1000.0))?,
///     cube.mass_properties(Amount::Mass(1000.0))?
/// );
/// # Ok::<(), tumble_math::ShapeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Mass \[kg\].
    Mass(f64),
    /// Density [kg/m^3].
    Density(f64),
}

impl Part {
    /// A part at the origin of the compound's frame, not turned.
    #[must_use]
    pub fn new(shape: Shape, amount: Amount) -> Self {
        Self { shape, position: DVec3::ZERO, orientation: DQuat::IDENTITY, amount }
    }

    /// The part moved to `position` \[m\].
    #[must_use]
    pub fn at(self, position: impl Into<DVec3>) -> Self {
        Self { position: position.into(), ..self }
    }

    /// The part turned by `orientation`.
    #[must_use]
    pub fn turned(self, orientation: impl Into<DQuat>) -> Self {
        Self { orientation: orientation.into(), ..self }
    }
}

impl Shape {
    /// Lengths outside this range \[m\] are refused: their squares times a mass must stay far from
    /// underflow and overflow.
    pub const LENGTHS: RangeInclusive<f64> = 1e-90..=1e90;

    /// How deep compounds may be nested.
    pub const MAX_DEPTH: usize = 32;

    /// A solid sphere of this radius \[m\].
    #[doc(alias = "ball")]
    #[must_use]
    pub fn sphere(radius: impl Into<f64>) -> Self {
        Self::Sphere { radius: radius.into() }
    }

    /// A thin spherical shell of this radius \[m\].
    #[must_use]
    pub fn hollow_sphere(radius: impl Into<f64>) -> Self {
        Self::HollowSphere { radius: radius.into() }
    }

    /// A block with these half extents \[m\].
    #[doc(alias = "box")]
    #[must_use]
    pub fn cuboid(half_extents: impl Into<DVec3>) -> Self {
        Self::Cuboid { half_extents: half_extents.into() }
    }

    /// A cylinder along y: radius and half height \[m\].
    #[must_use]
    pub fn cylinder(radius: impl Into<f64>, half_height: impl Into<f64>) -> Self {
        Self::Cylinder { radius: radius.into(), half_height: half_height.into() }
    }

    /// A capsule along y: radius and half the distance of the cap centres \[m\].
    #[must_use]
    pub fn capsule(radius: impl Into<f64>, half_height: impl Into<f64>) -> Self {
        Self::Capsule { radius: radius.into(), half_height: half_height.into() }
    }

    /// A cone along y: radius of the base and half height \[m\].
    #[must_use]
    pub fn cone(radius: impl Into<f64>, half_height: impl Into<f64>) -> Self {
        Self::Cone { radius: radius.into(), half_height: half_height.into() }
    }

    /// A frustum along y: radii at the bottom and at the top, one of which may be zero, and half
    /// height \[m\].
    #[must_use]
    pub fn frustum(radius_bottom: impl Into<f64>, radius_top: impl Into<f64>, half_height: impl Into<f64>) -> Self {
        let (radius_bottom, radius_top) = (radius_bottom.into(), radius_top.into());
        Self::Frustum { radius_bottom, radius_top, half_height: half_height.into() }
    }

    /// A capsule along y whose ends differ: radii of the bottom and of the top sphere, one of which
    /// may be zero, and half the distance of their centres \[m\].
    ///
    /// ```
    /// use tumble_math::{Amount, Shape};
    /// let mass = Amount::Mass(3.0);
    /// let equal = Shape::tapered_capsule(0.2, 0.2, 0.5).mass_properties(mass)?;
    /// let capsule = Shape::capsule(0.2, 0.5).mass_properties(mass)?;
    /// let difference = equal.tensor_about_center() - capsule.tensor_about_center();
    /// assert!(difference.abs_diff_eq(glam::DMat3::ZERO, 1e-15));
    /// # Ok::<(), tumble_math::ShapeError>(())
    /// ```
    #[must_use]
    pub fn tapered_capsule(
        radius_bottom: impl Into<f64>,
        radius_top: impl Into<f64>,
        half_height: impl Into<f64>,
    ) -> Self {
        let (radius_bottom, radius_top) = (radius_bottom.into(), radius_top.into());
        Self::TaperedCapsule { radius_bottom, radius_top, half_height: half_height.into() }
    }

    /// What a triangle mesh bounds. A mesh in an `Arc` is shared by all shapes made of it.
    #[doc(alias = "trimesh")]
    #[must_use]
    pub fn mesh(mesh: impl Into<Arc<SolidMesh>>) -> Self {
        Self::Mesh(mesh.into())
    }

    /// An ellipsoid with these semi-axes \[m\].
    #[must_use]
    pub fn ellipsoid(radii: impl Into<DVec3>) -> Self {
        Self::Ellipsoid { radii: radii.into() }
    }

    /// Parts fixed to each other.
    ///
    /// ```
    /// use tumble_math::{Amount, Part, Shape};
    /// // A weight on the sphere.
    /// let earth = Part::new(Shape::sphere(1.0), Amount::Mass(10.0));
    /// let weight = Part::new(Shape::Point, Amount::Mass(1.0)).at([0.6, 0.8, 0.0]);
    /// let body = Shape::compound([earth, weight]).own_mass_properties()?;
    /// let tensor = body.tensor_about_center();
    /// assert!(tensor.x_axis.y < 0.0); // a torque about x now also turns it about y
    /// # Ok::<(), tumble_math::ShapeError>(())
    /// ```
    #[must_use]
    pub fn compound(parts: impl IntoIterator<Item = Part>) -> Self {
        Self::Compound(parts.into_iter().collect())
    }

    /// Volume [m^3]; `None` for a point and a thin shell. Of a compound, the sum over the parts
    /// (overlaps count twice), `None` if it has no parts or one of them has no volume. Not checked:
    /// nonsense lengths give a nonsense volume.
    #[must_use]
    pub fn volume(&self) -> Option<f64> {
        self.volume_within(0)
    }

    fn volume_within(&self, depth: usize) -> Option<f64> {
        match self {
            Self::Point | Self::HollowSphere { .. } => None,
            Self::Sphere { radius: r } => Some(4.0 / 3.0 * PI * r * r * r),
            Self::Cuboid { half_extents: e } => Some(8.0 * e.x * e.y * e.z),
            Self::Cylinder { radius: r, half_height: h } => Some(2.0 * PI * r * r * h),
            Self::Capsule { radius: r, half_height: h } => Some(2.0 / 3.0 * PI * r * r * (3.0 * h + 2.0 * r)),
            Self::Cone { radius: r, half_height: h } => Some(2.0 / 3.0 * PI * r * r * h),
            Self::Ellipsoid { radii } => Some(4.0 / 3.0 * PI * radii.x * radii.y * radii.z),
            Self::Frustum { radius_bottom: a, radius_top: b, half_height: h } => {
                Some(Revolved::frustum(*a, *b, *h).volume)
            }
            Self::TaperedCapsule { radius_bottom: a, radius_top: b, half_height: h } => {
                Some(Revolved::tapered_capsule(*a, *b, *h).volume)
            }
            Self::Mesh(mesh) => Some(mesh.volume()),
            Self::Compound(parts) if parts.is_empty() || depth >= Self::MAX_DEPTH => None,
            Self::Compound(parts) => parts.iter().map(|part| part.shape.volume_within(depth + 1)).sum(),
        }
    }

    /// Mass properties in the shape's own frame.
    ///
    /// A compound is put together from its parts, each with its own amount, and then scaled to the
    /// mass given here, or to the mass that the density given here makes of its volume; see
    /// [`own_mass_properties`](Self::own_mass_properties).
    ///
    /// # Errors
    /// [`ShapeError`] names the parameter at fault and, in a compound, the part: a length, a mass
    /// or a density that is zero, negative, not finite or absurd, a density for a shape without
    /// volume, an empty compound.
    pub fn mass_properties(&self, amount: Amount) -> Result<MassProperties, ShapeError> {
        self.mass_properties_within(amount, 0)
    }

    /// Mass properties of a compound from the masses and densities of its parts.
    ///
    /// # Errors
    /// As [`mass_properties`](Self::mass_properties), and [`ShapeErrorReason::NoOwnMass`] for any
    /// other shape.
    pub fn own_mass_properties(&self) -> Result<MassProperties, ShapeError> {
        match self {
            Self::Compound(parts) => combined(parts, 0),
            _ => Err(ShapeError::here(ShapeErrorReason::NoOwnMass)),
        }
    }

    fn mass_properties_within(&self, amount: Amount, depth: usize) -> Result<MassProperties, ShapeError> {
        self.check_lengths()?;
        match *self {
            Self::Compound(ref parts) => {
                let own = combined(parts, depth)?;
                let mass = amount.mass(self.volume_within(depth), self.name())?;
                return own.scaled_to_mass(mass).map_err(|error| ShapeError::here(ShapeErrorReason::Mass(error)));
            }
            Self::Mesh(ref mesh) => return mesh.mass_properties(amount),
            Self::Frustum { radius_bottom, radius_top, half_height } => {
                return MassProperties::frustum(radius_bottom, radius_top, half_height, amount);
            }
            Self::TaperedCapsule { radius_bottom, radius_top, half_height } => {
                return MassProperties::tapered_capsule(radius_bottom, radius_top, half_height, amount);
            }
            _ => {}
        }
        let m = amount.mass(self.volume(), self.name())?;
        let center = match self {
            Self::Cone { half_height, .. } => DVec3::new(0.0, -0.5 * half_height, 0.0),
            _ => DVec3::ZERO,
        };
        MassProperties::from_parts(m, center, DMat3::from_diagonal(self.moments(m)))
            .map_err(|error| ShapeError::here(ShapeErrorReason::Mass(error)))
    }

    /// Moments about the centre of mass for the mass `m`; the formulas at the variants. Zero for
    /// those that are not computed here.
    fn moments(&self, m: f64) -> DVec3 {
        match *self {
            Self::Point | Self::Compound(_) | Self::Mesh(_) | Self::Frustum { .. } | Self::TaperedCapsule { .. } => {
                DVec3::ZERO
            }
            Self::Sphere { radius: r } => DVec3::splat(0.4 * m * r * r),
            Self::HollowSphere { radius: r } => DVec3::splat(2.0 / 3.0 * m * r * r),
            Self::Cuboid { half_extents } => sums_of_others(half_extents) * (m / 3.0),
            Self::Ellipsoid { radii } => sums_of_others(radii) * (0.2 * m),
            Self::Cylinder { radius: r, half_height: h } => {
                axial_and_transverse(0.5 * m * r * r, m * (0.25 * r * r + h * h / 3.0))
            }
            Self::Cone { radius: r, half_height: h } => {
                axial_and_transverse(0.3 * m * r * r, 0.15 * m * (r * r + h * h))
            }
            Self::Capsule { radius: r, half_height: h } => {
                let cylinder = m * (3.0 * h / (3.0 * h + 2.0 * r));
                let caps = m * (2.0 * r / (3.0 * h + 2.0 * r));
                let axial = 0.5 * cylinder * r * r + 0.4 * caps * r * r;
                let transverse = cylinder * (0.25 * r * r + h * h / 3.0) + caps * (0.4 * r * r + 0.75 * h * r + h * h);
                axial_and_transverse(axial, transverse)
            }
        }
    }

    fn check_lengths(&self) -> Result<(), ShapeError> {
        match *self {
            Self::Point | Self::Compound(_) | Self::Mesh(_) => Ok(()),
            Self::Frustum { radius_bottom, radius_top, half_height }
            | Self::TaperedCapsule { radius_bottom, radius_top, half_height } => {
                check_radii("radius_bottom", radius_bottom, "radius_top", radius_top)?;
                check_length("half_height", half_height)
            }
            Self::Sphere { radius } | Self::HollowSphere { radius } => check_length("radius", radius),
            Self::Cuboid { half_extents } => check_lengths("half_extents", half_extents),
            Self::Ellipsoid { radii } => check_lengths("radii", radii),
            Self::Cylinder { radius, half_height }
            | Self::Capsule { radius, half_height }
            | Self::Cone { radius, half_height } => {
                check_length("radius", radius)?;
                check_length("half_height", half_height)
            }
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Sphere { .. } => "sphere",
            Self::HollowSphere { .. } => "hollow sphere",
            Self::Cuboid { .. } => "cuboid",
            Self::Cylinder { .. } => "cylinder",
            Self::Capsule { .. } => "capsule",
            Self::Cone { .. } => "cone",
            Self::Frustum { .. } => "frustum",
            Self::TaperedCapsule { .. } => "tapered capsule",
            Self::Ellipsoid { .. } => "ellipsoid",
            Self::Mesh(_) => "mesh",
            Self::Compound(_) => "compound that holds a point or a shell",
        }
    }
}

impl Amount {
    /// The mass \[kg\] this makes of a volume [m^3], checked. `shape` is the name for the error.
    pub(crate) fn mass(self, volume: Option<f64>, shape: &'static str) -> Result<f64, ShapeError> {
        let mass = match (self, volume) {
            (Self::Mass(mass), _) => mass,
            (Self::Density(value), _) if !(value.is_finite() && value > 0.0) => {
                return Err(ShapeError::here(ShapeErrorReason::Density { value }));
            }
            (Self::Density(density), Some(volume)) => density * volume,
            (Self::Density(_), None) => return Err(ShapeError::here(ShapeErrorReason::NoVolume { shape })),
        };
        check_mass(mass).map_err(|error| ShapeError::here(ShapeErrorReason::Mass(error)))?;
        Ok(mass)
    }
}

/// The sum of the parts of a compound.
fn combined(parts: &[Part], depth: usize) -> Result<MassProperties, ShapeError> {
    if depth >= Shape::MAX_DEPTH {
        return Err(ShapeError::here(ShapeErrorReason::TooDeep));
    }
    let mut sum: Option<MassProperties> = None;
    for (index, part) in parts.iter().enumerate() {
        let placed = part
            .shape
            .mass_properties_within(part.amount, depth + 1)
            .and_then(|properties| {
                properties
                    .transformed(part.position, part.orientation)
                    .map_err(|error| ShapeError::here(ShapeErrorReason::Pose(error)))
            })
            .map_err(|error| error.in_part(index))?;
        sum = Some(sum.map_or(placed, |sum| sum + placed));
    }
    sum.ok_or_else(|| ShapeError::here(ShapeErrorReason::NoParts))
}

/// `(y^2 + z^2, x^2 + z^2, x^2 + y^2)`.
fn sums_of_others(v: DVec3) -> DVec3 {
    let s = v * v;
    DVec3::new(s.y + s.z, s.x + s.z, s.x + s.y)
}

/// Moments of a body of revolution about y.
pub(crate) fn axial_and_transverse(axial: f64, transverse: f64) -> DVec3 {
    DVec3::new(transverse, axial, transverse)
}

pub(crate) fn check_length(name: &'static str, value: f64) -> Result<(), ShapeError> {
    if Shape::LENGTHS.contains(&value) {
        Ok(())
    } else {
        Err(ShapeError::here(ShapeErrorReason::Length { name, value }))
    }
}

/// Two radii, of which one may be zero.
pub(crate) fn check_radii(
    name: &'static str,
    value: f64,
    other: &'static str,
    other_value: f64,
) -> Result<(), ShapeError> {
    if value == 0.0 {
        return check_length(other, other_value);
    }
    check_length(name, value)?;
    if other_value == 0.0 { Ok(()) } else { check_length(other, other_value) }
}

fn check_lengths(name: &'static str, values: DVec3) -> Result<(), ShapeError> {
    values.to_array().into_iter().try_for_each(|value| check_length(name, value))
}
