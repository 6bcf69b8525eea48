//! Rotations and rigid transforms out of matrices that are not quite ones.

use glam::{DMat3, DMat4};

use crate::rotation::NotARotation;

/// The rotation nearest to a matrix, in the sense of the sum of squares of what changes: what a
/// rotation matrix that was integrated, or multiplied a million times, should have been. The
/// orthogonal factor of the polar decomposition.
///
/// Newton's iteration `X <- (X + X^-T)/2`, scaled while the matrix is far from orthogonal. It does
/// not prefer one axis, as Gram and Schmidt's method does.
///
/// Source: N. J. Higham, "Computing the polar decomposition, with applications", SIAM J. Sci. Stat.
/// Comput. 7 (1986).
///
/// ```
/// use glam::DMat3;
/// use tumble_math::nearest_rotation;
/// let turned = DMat3::from_rotation_y(0.7);
/// let drifted = turned * 1.02 + DMat3::from_cols_array(&[1e-3; 9]);
/// let mended = nearest_rotation(drifted)?;
/// assert!((mended * mended.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-15));
/// assert!(mended.abs_diff_eq(turned, 2e-3));
/// # Ok::<(), tumble_math::NotARotation>(())
/// ```
///
/// # Errors
/// [`NotARotation`]: a matrix that is singular to rounding or not finite has no nearest rotation,
/// and one that mirrors is nearest to a reflection.
pub fn nearest_rotation(matrix: DMat3) -> Result<DMat3, NotARotation> {
    let largest = matrix.to_cols_array().iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let lost = Err(NotARotation::NotOrthonormal { error: f64::NAN });
    if !(matrix.is_finite() && largest > 0.0) {
        return lost;
    }
    let mut x = matrix * (1.0 / largest);
    let determinant = x.determinant();
    // A determinant of elements up to one is known to some eps.
    if determinant.abs() <= 16.0 * f64::EPSILON {
        return lost;
    }
    if determinant < 0.0 {
        return Err(NotARotation::Reflection { determinant });
    }
    // Quadratic from where the scale has made the determinant one; 1e-15 takes at most a dozen from
    // the edge of singularity.
    for _ in 0..64 {
        let scale = x.determinant().cbrt().recip();
        let scaled = x * scale;
        let next = (scaled + scaled.inverse().transpose()) * 0.5;
        let change = (next - x).to_cols_array().iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        x = next;
        if change <= 4.0 * f64::EPSILON {
            break;
        }
    }
    Ok(x)
}

/// The transform `m` of the frame `B` seen from the frame `A`, where `basis` takes coordinates of
/// `B` to those of `A`: `basis m basis^-1`. For rotations and tensors there is
/// [`change_of_basis`](crate::change_of_basis).
///
/// ```
/// use glam::{DMat4, DVec3};
/// use tumble_math::change_of_basis_of_transform;
/// // A shift along x, in a frame that is turned a quarter about z, is one along y.
/// let shift = DMat4::from_translation(DVec3::X);
/// let basis = DMat4::from_rotation_z(std::f64::consts::FRAC_PI_2);
/// let seen = change_of_basis_of_transform(shift, basis);
/// assert!(seen.is_some_and(|seen| seen.abs_diff_eq(DMat4::from_translation(DVec3::Y), 1e-15)));
/// ```
///
/// `None` where `basis` has no inverse.
#[must_use]
pub fn change_of_basis_of_transform(m: DMat4, basis: DMat4) -> Option<DMat4> {
    let inverse = basis.inverse();
    let invertible = basis.is_finite() && basis.determinant() != 0.0 && inverse.is_finite();
    invertible.then(|| basis * m * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    /// `R S` with a symmetric positive `S` has the orthogonal factor `R`: for stretches of a
    /// millionth to a million.
    #[test]
    fn a_stretched_rotation_is_found_again() {
        let rotation = DMat3::from_quat(DQuat::from_xyzw(0.1, -0.7, 0.3, 0.5).normalize());
        let frame = DMat3::from_quat(DQuat::from_xyzw(0.6, 0.2, -0.1, 0.4).normalize());
        for stretch in
            [DVec3::ONE, DVec3::new(1.001, 0.999, 1.0), DVec3::new(3.0, 0.2, 1.0), DVec3::new(1e3, 1e-3, 1.0)]
        {
            let symmetric = frame * DMat3::from_diagonal(stretch) * frame.transpose();
            let found = nearest_rotation(rotation * symmetric).unwrap_or(DMat3::ZERO);
            // The factor is known to eps over the smallest of the sums of two stretches, in units
            // of the largest.
            let condition =
                stretch.max_element() / (stretch.min_element() + stretch.element_sum() - stretch.max_element());
            let error = (found - rotation).to_cols_array().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            assert!(error <= 64.0 * f64::EPSILON * condition.max(1.0), "{stretch}: {error:e}");
        }
    }

    #[test]
    fn what_has_no_rotation_is_refused() {
        let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
        assert!(matches!(nearest_rotation(mirror), Err(NotARotation::Reflection { .. })));
        for bad in [DMat3::ZERO, DMat3::from_cols_array(&[1.0; 9]), DMat3::IDENTITY * f64::NAN] {
            assert!(matches!(nearest_rotation(bad), Err(NotARotation::NotOrthonormal { .. })), "{bad}");
        }
    }
}
