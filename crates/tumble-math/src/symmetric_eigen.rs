//! Eigenvalues and eigenvectors of a symmetric 3x3 matrix by cyclic Jacobi rotations.

use glam::{DMat3, DVec3};

/// Sweeps before the iteration gives up. Convergence is quadratic, six suffice in practice; the
/// bound is for indefinite matrices with zeros on the diagonal, whose relative stopping rule is
/// never met.
const MAX_SWEEPS: usize = 30;

/// The eigenvalues of `matrix` and, as columns, its orthonormal eigenvectors:
/// `A = V diag(values) V^T`. `V` is orthogonal with determinant +1; the order is the one the
/// rotations leave. A diagonal matrix gives its diagonal and the identity exactly.
///
/// An off-diagonal element counts as zero once `|a_pq| <= eps sqrt(|a_pp a_qq|)`. With that rule
/// the eigenvalues of a positive definite matrix come out with small *relative* errors, also where
/// they differ by many orders of magnitude (J. Demmel and K. Veselić, "Jacobi's method is more
/// accurate than QR", SIAM J. Matrix Anal. Appl. 13, 1992). Rotation angle: W. H. Press et al.,
/// "Numerical Recipes", 3rd ed., section 11.1.
///
/// Only the upper triangle is read. The elements must be finite.
pub(crate) fn symmetric_eigen(matrix: DMat3) -> (DVec3, DMat3) {
    let diagonal = DVec3::new(matrix.x_axis.x, matrix.y_axis.y, matrix.z_axis.z);
    if matrix.y_axis.x == 0.0 && matrix.z_axis.x == 0.0 && matrix.z_axis.y == 0.0 {
        return (diagonal, DMat3::IDENTITY);
    }
    let (mut a, scale) = scaled_rows(matrix);
    let mut v = DMat3::IDENTITY.to_cols_array_2d(); // v[column][row]
    for _ in 0..MAX_SWEEPS {
        let mut done = true;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q].abs() <= f64::EPSILON * a[p][p].abs().sqrt() * a[q][q].abs().sqrt() {
                continue;
            }
            done = false;
            rotate(&mut a, &mut v, p, q);
        }
        if done {
            break;
        }
    }
    let values = DVec3::new(a[0][0], a[1][1], a[2][2]) * scale;
    (values, DMat3::from_cols_array_2d(&v))
}

/// The matrix as rows, divided by the power of two below its largest element, and that power. Exact
/// both ways (short of subnormals), and no product in a rotation can overflow.
fn scaled_rows(matrix: DMat3) -> ([[f64; 3]; 3], f64) {
    let m = matrix.to_cols_array_2d();
    let upper = [m[0][0], m[1][1], m[2][2], m[1][0], m[2][0], m[2][1]];
    let largest = upper.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let (_, exponent) = libm::frexp(largest);
    let exponent = exponent - 1; // frexp's fraction is below one, and 2^1024 is no f64
    let s = |x: f64| libm::ldexp(x, -exponent);
    let (xy, xz, yz) = (s(m[1][0]), s(m[2][0]), s(m[2][1]));
    let rows = [[s(m[0][0]), xy, xz], [xy, s(m[1][1]), yz], [xz, yz, s(m[2][2])]];
    (rows, libm::ldexp(1.0, exponent))
}

/// One Jacobi rotation in the plane `p, q`: makes `a[p][q]` zero. `t = tan` of the smaller of the
/// two angles, `t^2 + 2 theta t - 1 = 0`.
fn rotate(a: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    // For a huge theta (its square overflows to infinity) t is zero and a_pq simply dropped; it is
    // then below eps^2 of the difference of the two diagonal elements.
    let t = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    let tau = s / (1.0 + c);

    a[p][p] -= t * a[p][q];
    a[q][q] += t * a[p][q];
    a[p][q] = 0.0;
    a[q][p] = 0.0;
    let r = 3 - p - q;
    let (rp, rq) = (a[r][p], a[r][q]);
    a[r][p] = rp - s * (rq + tau * rp);
    a[r][q] = rq + s * (rp - tau * rq);
    a[p][r] = a[r][p];
    a[q][r] = a[r][q];
    let (vp, vq) = (v[p], v[q]);
    for row in 0..3 {
        v[p][row] = vp[row] - s * (vq[row] + tau * vp[row]);
        v[q][row] = vq[row] + s * (vp[row] - tau * vq[row]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symmetric(xx: f64, yy: f64, zz: f64, xy: f64, xz: f64, yz: f64) -> DMat3 {
        DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
    }

    fn ascending(matrix: DMat3) -> [f64; 3] {
        let mut values = symmetric_eigen(matrix).0.to_array();
        values.sort_by(f64::total_cmp);
        values
    }

    /// `A = D B D` with `D` from 1e-12 to 1e12 and `B` well conditioned: no body has such moments,
    /// but the solver finds them to a few eps each, where methods that look at the largest element
    /// would give the smallest no digit at all.
    #[test]
    fn graded_matrices_to_full_relative_precision() {
        let matrix = symmetric(1e-24, 1.0, 1e24, 0.25e-12, 0.125, -0.25e12);
        // From 80 digits (mpmath).
        let expected = [8.999_999_999_999_999e-25, 0.937_5, 1.0e24];
        for (value, expected) in ascending(matrix).into_iter().zip(expected) {
            assert!((value / expected - 1.0).abs() <= 8.0 * f64::EPSILON, "{value:e}");
        }
    }

    #[test]
    fn any_scale_from_the_smallest_number_to_the_largest() {
        // Eigenvalues 1, 2 and 4 times the scale.
        for scale in [1e-300, 1.0, 1e300, f64::MAX / 4.0] {
            let values = ascending(symmetric(1.5, 1.5, 4.0, 0.5, 0.0, 0.0) * scale);
            for (value, expected) in values.into_iter().zip([1.0, 2.0, 4.0]) {
                assert!((value / scale / expected - 1.0).abs() <= 4.0 * f64::EPSILON, "{value:e} at {scale:e}");
            }
        }
    }

    #[test]
    fn indefinite_and_singular_matrices_end_too() {
        // A zero diagonal never meets the relative rule; eigenvalues -1, -1, 2.
        for (value, expected) in ascending(symmetric(0.0, 0.0, 0.0, 1.0, 1.0, 1.0)).into_iter().zip([-1.0, -1.0, 2.0]) {
            assert!((value - expected).abs() <= 8.0 * f64::EPSILON);
        }
        // All ones: 0, 0, 3.
        for (value, expected) in ascending(symmetric(1.0, 1.0, 1.0, 1.0, 1.0, 1.0)).into_iter().zip([0.0, 0.0, 3.0]) {
            assert!((value - expected).abs() <= 8.0 * f64::EPSILON);
        }
        assert_eq!(symmetric_eigen(DMat3::ZERO), (DVec3::ZERO, DMat3::IDENTITY));
    }

    #[test]
    fn vectors_are_orthonormal_and_right_handed() {
        let matrix = symmetric(3.0, 2.0, 4.0, -0.7, 0.3, 1.1);
        let (values, v) = symmetric_eigen(matrix);
        let difference = v * DMat3::from_diagonal(values) * v.transpose() - matrix;
        assert!(difference.to_cols_array().iter().all(|x| x.abs() <= 16.0 * f64::EPSILON));
        assert!((v.determinant() - 1.0).abs() <= 8.0 * f64::EPSILON);
    }
}
