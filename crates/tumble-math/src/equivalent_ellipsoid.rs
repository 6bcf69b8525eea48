//! The homogeneous ellipsoid that has a given mass and given principal moments.

use glam::DVec3;

/// Semi-axes \[m\], along the principal axes, of the homogeneous ellipsoid with this mass \[kg\]
/// and these principal moments [kg m^2].
///
/// From `I_x = m/5 (b^2 + c^2)` and so on, `a^2 = 5/(2m) (I_y + I_z - I_x)`. A flat body has a
/// semi-axis of zero, a point three.
///
/// ```
/// use tumble_math::{Amount, Shape, equivalent_ellipsoid};
///
/// let egg = Shape::ellipsoid([0.2, 0.3, 0.2]).mass_properties(Amount::Mass(0.5))?;
/// let [x, y, z] = egg.tensor_about_center().to_cols_array_2d();
/// let radii = equivalent_ellipsoid(egg.mass(), glam::DVec3::new(x[0], y[1], z[2]));
/// assert!((radii - glam::DVec3::new(0.2, 0.3, 0.2)).length() < 1e-12);
/// # Ok::<(), tumble_math::ShapeError>(())
/// ```
#[must_use]
pub fn equivalent_ellipsoid(mass: f64, moments: DVec3) -> DVec3 {
    // Rounding may leave a flat body a little less than nothing.
    let squares = (DVec3::splat(moments.element_sum()) - 2.0 * moments).max(DVec3::ZERO) * (2.5 / mass);
    squares.map(f64::sqrt)
}
