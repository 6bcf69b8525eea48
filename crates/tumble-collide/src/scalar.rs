//! The floating-point types that collision detection supports.

use tumble_math::lane::Lane;

/// The precision contacts are computed in: `f32` or `f64`.
///
/// ```
/// use tumble_collide::{ColliderShape, Scalar};
///
/// fn unit_ball<R: Scalar>() -> ColliderShape<R> {
///     ColliderShape::Sphere { radius: R::splat(1.0) }
/// }
///
/// assert!(matches!(unit_ball::<f32>(), ColliderShape::Sphere { radius: 1.0 }));
/// ```
pub trait Scalar:
    Lane<Mask = bool> + PartialOrd + Into<f64> + Default + std::fmt::Debug + Send + Sync + 'static
{
}

impl Scalar for f32 {}
impl Scalar for f64 {}
