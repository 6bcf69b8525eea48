//! Symmetrization of 3x3 matrices after rounding.

use glam::{DMat3, DVec3};

/// The upper triangle, mirrored: rounding may leave the two halves an ulp apart.
pub(crate) fn mirrored(m: DMat3) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(m.x_axis.x, m.y_axis.x, m.z_axis.x),
        DVec3::new(m.y_axis.x, m.y_axis.y, m.z_axis.y),
        DVec3::new(m.z_axis.x, m.z_axis.y, m.z_axis.z),
    )
}
