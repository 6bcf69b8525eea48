use tumble_math::lane::Lane;

/// The precision contacts are computed in: `f32` or `f64`.
pub trait Scalar: Lane<Mask = bool> + PartialOrd + Default + std::fmt::Debug + Send + Sync + 'static {
    /// The whole number that this is.
    fn to_u32(self) -> u32;
}

impl Scalar for f32 {
    fn to_u32(self) -> u32 {
        self as u32
    }
}

impl Scalar for f64 {
    fn to_u32(self) -> u32 {
        self as u32
    }
}
