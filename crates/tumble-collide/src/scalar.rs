use tumble_math::lane::Lane;

/// The precision contacts are computed in: `f32` or `f64`.
pub trait Scalar:
    Lane<Mask = bool> + PartialOrd + Into<f64> + Default + std::fmt::Debug + Send + Sync + 'static
{
}

impl Scalar for f32 {}
impl Scalar for f64 {}
