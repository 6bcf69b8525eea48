//! Mass properties of homogeneous bodies that are not a [`Shape`](crate::Shape) of their own, in
//! closed form.
//!
//! Axes lie along y. Hollow ones are written so that a thin wall costs no digits: `R^n - r^n` never
//! occurs.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use crate::inertia::parallel_axis;
use crate::mass_properties::MassProperties;
use crate::revolved::Revolved;
use crate::shape::{Amount, axial_and_transverse, check_length, check_radii};
use crate::shape_error::{ShapeError, ShapeErrorReason};

impl MassProperties {
    /// Half a solid sphere: flat face in the plane y = 0, centred on the origin, dome towards +y
    /// \[m\].
    ///
    /// Centre of mass at `y = 3/8 r`; `I_yy = 2/5 m r^2`, `I_xx = I_zz = 83/320 m r^2`.
    ///
    /// # Errors
    /// A length or an amount that is zero, negative, not finite or absurd.
    pub fn hemisphere(radius: f64, amount: Amount) -> Result<Self, ShapeError> {
        check_length("radius", radius)?;
        let r2 = radius * radius;
        let m = amount.mass(Some(2.0 / 3.0 * PI * r2 * radius), "hemisphere")?;
        solid(m, 0.375 * radius, axial_and_transverse(0.4 * m * r2, 83.0 / 320.0 * m * r2))
    }

    /// A solid frustum of a cone, radii `bottom` at `-half_height` and `top` at `+half_height`
    /// \[m\]. One of the radii may be zero.
    ///
    /// With `a`, `b` the two radii, `H` the height, `S2 = a^2 + ab + b^2`,
    /// `S4 = a^4 + a^3 b + a^2 b^2 + a b^3 + b^4`:
    ///
    /// ```text
    /// V = pi H S2/3              y_c = H (b - a)(b + a)/(4 S2)
    /// I_yy = 3/10 m S4/S2
    /// I_xx = I_zz = 1/2 I_yy + 3/80 m H^2 (a^4 + 4a^3 b + 10a^2 b^2 + 4a b^3 + b^4)/S2^2
    /// ```
    ///
    /// From the integrals of `r^2`, `t r^2`, `t^2 r^2` and `r^4` over `r = a + (b - a) t`; all
    /// terms positive, so nothing cancels.
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere).
    pub fn frustum(bottom: f64, top: f64, half_height: f64, amount: Amount) -> Result<Self, ShapeError> {
        check_radii("bottom", bottom, "top", top)?;
        check_length("half_height", half_height)?;
        of_revolution(&Revolved::frustum(bottom, top, half_height), amount, "frustum")
    }

    /// The convex hull of two solid spheres, of the radii `bottom` about `-half_height` and `top`
    /// about `+half_height` on y \[m\], one of which may be zero: a capsule whose ends differ, as
    /// in glTF's KHR_implicit_shapes. If one sphere holds the other, it is all.
    ///
    /// Two segments of spheres and a frustum between the circles in which a cone touches both
    /// spheres.
    ///
    /// ```
    /// use tumble_math::{Amount, MassProperties};
    /// let club = MassProperties::tapered_capsule(0.02, 0.05, 0.2, Amount::Density(700.0))?;
    /// assert!(club.center_of_mass().y > 0.07); // towards the thick end
    /// # Ok::<(), tumble_math::ShapeError>(())
    /// ```
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere).
    pub fn tapered_capsule(bottom: f64, top: f64, half_height: f64, amount: Amount) -> Result<Self, ShapeError> {
        check_radii("bottom", bottom, "top", top)?;
        check_length("half_height", half_height)?;
        of_revolution(&Revolved::tapered_capsule(bottom, top, half_height), amount, "tapered capsule")
    }

    /// A solid pyramid on a rectangle: base `2 half_x` by `2 half_z` at `y = -half_height`, apex at
    /// `+half_height` \[m\].
    ///
    /// Centre of mass at `y = -h/2`; `I_yy = m/5 (a^2 + b^2)`, `I_xx = m (b^2/5 + 3/20 h^2)`,
    /// `I_zz = m (a^2/5 + 3/20 h^2)` with `a, b` the halves along x and z and `h` the half height.
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere).
    pub fn pyramid(half_x: f64, half_z: f64, half_height: f64, amount: Amount) -> Result<Self, ShapeError> {
        check_length("half_x", half_x)?;
        check_length("half_z", half_z)?;
        check_length("half_height", half_height)?;
        let m = amount.mass(Some(8.0 / 3.0 * half_x * half_z * half_height), "pyramid")?;
        let (x2, z2, h2) = (0.2 * half_x * half_x, 0.2 * half_z * half_z, 0.15 * half_height * half_height);
        solid(m, -0.5 * half_height, DVec3::new(z2 + h2, x2 + z2, x2 + h2) * m)
    }

    /// A solid tetrahedron with these corners \[m\], in any order.
    ///
    /// About its centre it has the inertia of four particles of `m/20` at the corners, since
    /// `integral of x x^T dV = V/20 (sum p_i p_i^T + (sum p_i)(sum p_i)^T)` and the last sum is
    /// zero there. Source: F. Tonon, "Explicit exact formulas for the 3-D tetrahedron inertia
    /// tensor", J. Math. Stat. 1 (2005).
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere); corners that lie in a plane.
    pub fn tetrahedron(corners: [DVec3; 4], amount: Amount) -> Result<Self, ShapeError> {
        let edges = [corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]];
        let largest = edges.iter().fold(0.0_f64, |largest, e| largest.max(e.abs().max_element()));
        check_length("corners", largest)?;
        // The determinant of edges scaled to one carries a few eps; below that there is no volume.
        let [a, b, c] = edges.map(|edge| edge / largest);
        let determinant = a.cross(b).dot(c).abs();
        let solid = determinant > 16.0 * f64::EPSILON;
        if !solid {
            return Err(ShapeError::here(ShapeErrorReason::Flat));
        }
        let m = amount.mass(Some(determinant / 6.0 * largest * largest * largest), "tetrahedron")?;
        // From the first corner, so that a tetrahedron far from the origin keeps its digits.
        let center = (edges[0] + edges[1] + edges[2]) * 0.25;
        let tensor = [DVec3::ZERO, edges[0], edges[1], edges[2]]
            .iter()
            .fold(DMat3::ZERO, |tensor, corner| tensor + parallel_axis(m / 20.0, *corner - center));
        Self::from_parts(m, corners[0] + center, tensor)
            .map_err(|error| ShapeError::here(ShapeErrorReason::Pose(error)))
    }

    /// A hollow cylinder with a wall of any thickness: radii `outer` and `inner`, half height
    /// \[m\].
    ///
    /// `V = 2 pi h (R - r)(R + r)`, `I_yy = m (R^2 + r^2)/2`,
    /// `I_xx = I_zz = m ((R^2 + r^2)/4 + h^2/3)`.
    ///
    /// ```
    /// use tumble_math::{Amount, MassProperties};
    /// let pipe = MassProperties::tube(0.5, 0.4, 1.0, Amount::Mass(2.0))?;
    /// assert!((pipe.tensor_about_center().y_axis.y - 0.41).abs() < 1e-15);
    /// # Ok::<(), tumble_math::ShapeError>(())
    /// ```
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere); an inner radius that is not smaller than the outer.
    pub fn tube(outer: f64, inner: f64, half_height: f64, amount: Amount) -> Result<Self, ShapeError> {
        check_wall(outer, inner)?;
        check_length("half_height", half_height)?;
        let m = amount.mass(Some(2.0 * PI * half_height * (outer - inner) * (outer + inner)), "tube")?;
        let squares = outer * outer + inner * inner;
        let transverse = m * (0.25 * squares + half_height * half_height / 3.0);
        solid(m, 0.0, axial_and_transverse(0.5 * m * squares, transverse))
    }

    /// A hollow sphere with a wall of any thickness: radii `outer` and `inner` \[m\].
    ///
    /// ```text
    /// I = 2/5 m (R^5 - r^5)/(R^3 - r^3)
    ///   = 2/5 m (R^4 + R^3 r + R^2 r^2 + R r^3 + r^4)/(R^2 + R r + r^2)
    /// ```
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere); an inner radius that is not smaller than the outer.
    pub fn thick_shell(outer: f64, inner: f64, amount: Amount) -> Result<Self, ShapeError> {
        check_wall(outer, inner)?;
        let q = inner / outer;
        let s2 = 1.0 + q * (1.0 + q);
        let s4 = 1.0 + q * (1.0 + q * (1.0 + q * (1.0 + q)));
        let m = amount.mass(Some(4.0 / 3.0 * PI * (outer - inner) * outer * outer * s2), "thick shell")?;
        solid(m, 0.0, DVec3::splat(0.4 * m * (s4 / s2) * outer * outer))
    }

    /// An infinitely thin rod of `mass` \[kg\] along y, `half_length` \[m\].
    /// `I_xx = I_zz = m l^2/3`, none about y, so [`inertia`](Self::inertia) refuses it.
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere).
    pub fn thin_rod(half_length: f64, mass: f64) -> Result<Self, ShapeError> {
        check_length("half_length", half_length)?;
        let m = Amount::Mass(mass).mass(None, "rod")?;
        solid(m, 0.0, axial_and_transverse(0.0, m * half_length * half_length / 3.0))
    }

    /// An infinitely thin disc of `mass` \[kg\] across y, `radius` \[m\].
    /// `I_yy = m r^2/2 = I_xx + I_zz`.
    ///
    /// # Errors
    /// As [`hemisphere`](Self::hemisphere).
    pub fn thin_disc(radius: f64, mass: f64) -> Result<Self, ShapeError> {
        check_length("radius", radius)?;
        let m = Amount::Mass(mass).mass(None, "disc")?;
        let transverse = 0.25 * m * radius * radius;
        solid(m, 0.0, axial_and_transverse(2.0 * transverse, transverse))
    }
}

fn of_revolution(body: &Revolved, amount: Amount, name: &'static str) -> Result<MassProperties, ShapeError> {
    let m = amount.mass(Some(body.volume), name)?;
    solid(m, body.center, axial_and_transverse(m * body.axial, m * body.transverse))
}

/// Centre of mass on the y axis, principal axes parallel to the frame's.
fn solid(mass: f64, center_y: f64, moments: DVec3) -> Result<MassProperties, ShapeError> {
    MassProperties::from_parts(mass, DVec3::new(0.0, center_y, 0.0), DMat3::from_diagonal(moments))
        .map_err(|error| ShapeError::here(ShapeErrorReason::Mass(error)))
}

fn check_wall(outer: f64, inner: f64) -> Result<(), ShapeError> {
    check_length("outer", outer)?;
    check_length("inner", inner)?;
    if inner < outer { Ok(()) } else { Err(ShapeError::here(ShapeErrorReason::Inner { inner, outer })) }
}
