//! Arithmetic that the step runs on: one number or many bodies' numbers side by side.
//!
//! Every kernel of the step is written once, generic over [`Lane`]. `f32` and `f64` are lanes of
//! one body and serve as the reference; wider lanes hold the same quantity of several bodies. Only
//! correctly rounded IEEE operations (`+ - * /` and square root) and comparisons are used, each in
//! the order written, so a body gets the same bits in every lane width and on every CPU.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number of one body, or of several bodies side by side.
///
/// Arithmetic and [`sqrt`](Lane::sqrt) are IEEE-754 correctly rounded. There is no fused
/// multiply-add, on purpose: it would give other bits on machines that lack it.
///
/// ```
/// use tumble_math::lane::Lane;
///
/// fn hypotenuse<L: Lane>(a: L, b: L) -> L {
///     (a * a + b * b).sqrt()
/// }
/// assert_eq!((hypotenuse(3.0_f32, 4.0), hypotenuse(3.0_f64, 4.0)), (5.0, 5.0));
/// ```
pub trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The outcome of a comparison, one per body.
    type Mask: Copy;

    /// Half the distance from 1 to the next representable number: the relative rounding error of
    /// one operation.
    const ROUNDING: f64;

    /// The same constant for every body, rounded to the lane's precision.
    fn splat(value: f64) -> Self;

    /// Square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;

    /// `self < other`, false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;

    /// `if_true` where the mask holds, else `if_false`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;

    /// Whether the mask holds for any body.
    fn any(mask: Self::Mask) -> bool;

    /// Whether the mask holds for every body.
    fn all(mask: Self::Mask) -> bool;

    /// `2^self` for a lane that holds integers from -126 to 127.
    fn exp2_of_integer(self) -> Self;

    /// Sine and cosine, from the portable `libm` crate rather than the platform's.
    fn sin_cos(self) -> (Self, Self);

    /// The absolute value; NaN stays NaN.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.lt(Self::splat(0.0)), -self, self)
    }

    /// The smaller of the two; `other` where `self` is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The larger of the two; `other` where `self` is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
}

macro_rules! one_body_lane {
    ($real:ident, $bits:ident, $mantissa:literal, $bias:literal, $sin_cos:path) => {
        impl Lane for $real {
            type Mask = bool;

            const ROUNDING: f64 = $real::EPSILON as f64 * 0.5;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                value as $real
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                $real::sqrt(self)
            }

            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }

            #[inline(always)]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }

            #[inline(always)]
            fn any(mask: bool) -> bool {
                mask
            }

            #[inline(always)]
            fn all(mask: bool) -> bool {
                mask
            }

            #[inline(always)]
            fn exp2_of_integer(self) -> Self {
                $real::from_bits(((self as i32 + $bias) as $bits) << $mantissa)
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }
        }
    };
}

one_body_lane!(f32, u32, 23, 127, libm::sincosf);
one_body_lane!(f64, u64, 52, 1023, libm::sincos);

/// Three lanes: a vector of each body.
///
/// ```
/// use tumble_math::lane::Vec3;
/// let (x, y) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0));
/// assert_eq!(x.cross(y), Vec3::new(0.0, 0.0, 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Vec3<L> {
    /// First component.
    pub x: L,
    /// Second component.
    pub y: L,
    /// Third component.
    pub z: L,
}

impl<L: Lane> Vec3<L> {
    /// The vector `(x, y, z)`.
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }

    /// The vector of three equal components.
    #[inline(always)]
    pub fn splat(value: L) -> Self {
        Self::new(value, value, value)
    }

    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(L::splat(0.0))
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Product component by component, as a diagonal matrix acts on a vector.
    #[inline(always)]
    pub fn scale(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(
            L::select(mask, if_true.x, if_false.x),
            L::select(mask, if_true.y, if_false.y),
            L::select(mask, if_true.z, if_false.z),
        )
    }
}

impl<L: Lane> Add for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<L: Lane> Sub for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<L: Lane> Mul<L> for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: L) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

/// A quaternion of each body: vector part `x, y, z` and scalar part `w`, the order glam stores.
///
/// ```
/// use tumble_math::lane::{Quat, Vec3};
/// let half_turn = Quat { x: 0.0, y: 0.0, z: 1.0, w: 0.0 };
/// assert_eq!(half_turn.rotate(Vec3::new(1.0, 2.0, 3.0)), Vec3::new(-1.0, -2.0, 3.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Quat<L> {
    /// First component of the vector part.
    pub x: L,
    /// Second component of the vector part.
    pub y: L,
    /// Third component of the vector part.
    pub z: L,
    /// Scalar part.
    pub w: L,
}

impl<L: Lane> Quat<L> {
    /// The quaternion `[scalar, vector]`.
    #[inline(always)]
    pub fn from_parts(scalar: L, vector: Vec3<L>) -> Self {
        Self { x: vector.x, y: vector.y, z: vector.z, w: scalar }
    }

    /// The vector part.
    #[inline(always)]
    pub fn vector(self) -> Vec3<L> {
        Vec3::new(self.x, self.y, self.z)
    }

    /// `[s, -v]`, the inverse of a unit quaternion.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z, w: self.w }
    }

    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> L {
        self.x * self.x + self.y * self.y + self.z * self.z + self.w * self.w
    }

    /// The quaternion of unit length in the same direction.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (L::splat(1.0) / self.length_squared().sqrt())
    }

    /// The columns of this unit quaternion's rotation matrix: the turned x, y and z axes.
    ///
    /// Row by row, with the scalar part s: `1 - 2y^2 - 2z^2, 2xy - 2sz, 2xz + 2sy`;
    /// `2xy + 2sz, 1 - 2x^2 - 2z^2, 2yz - 2sx`; `2xz - 2sy, 2yz + 2sx, 1 - 2x^2 - 2y^2`.
    #[inline(always)]
    pub fn axes(self) -> [Vec3<L>; 3] {
        let one = L::splat(1.0);
        let (x2, y2, z2) = (self.x + self.x, self.y + self.y, self.z + self.z);
        let (xx, yy, zz) = (self.x * x2, self.y * y2, self.z * z2);
        let (xy, yz, zx) = (self.x * y2, self.y * z2, self.z * x2);
        let (sx, sy, sz) = (self.w * x2, self.w * y2, self.w * z2);
        [
            Vec3::new(one - (yy + zz), xy + sz, zx - sy),
            Vec3::new(xy - sz, one - (xx + zz), yz + sx),
            Vec3::new(zx + sy, yz - sx, one - (xx + yy)),
        ]
    }

    /// [`normalize`](Self::normalize), or `fallback` where the squared length is zero or not
    /// finite.
    #[inline(always)]
    pub fn normalize_or(self, fallback: Self) -> Self {
        let length_squared = self.length_squared();
        let finite = length_squared.lt(L::splat(f64::INFINITY));
        let unit = Self::select(finite, self * (L::splat(1.0) / length_squared.sqrt()), fallback);
        Self::select(L::splat(0.0).lt(length_squared), unit, fallback)
    }

    /// The vector turned by this unit quaternion: body coordinates to world coordinates when it is
    /// a body's orientation.
    #[inline(always)]
    pub fn rotate(self, vector: Vec3<L>) -> Vec3<L> {
        let axis = self.vector();
        let half_turned = axis.cross(vector) * L::splat(2.0);
        vector + half_turned * self.w + axis.cross(half_turned)
    }

    /// The vector turned back: world coordinates to body coordinates.
    #[inline(always)]
    pub fn rotate_back(self, vector: Vec3<L>) -> Vec3<L> {
        self.conjugate().rotate(vector)
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self::from_parts(
            L::select(mask, if_true.w, if_false.w),
            Vec3::select(mask, if_true.vector(), if_false.vector()),
        )
    }
}

impl<L: Lane> Add for Quat<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z, w: self.w + other.w }
    }
}

impl<L: Lane> Mul<L> for Quat<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: L) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor, w: self.w * factor }
    }
}

impl<L: Lane> Mul for Quat<L> {
    type Output = Self;
    /// `[s1, v1][s2, v2] = [s1 s2 - v1.v2, s1 v2 + s2 v1 + v1 x v2]`: first `other`, then `self`.
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.vector(), other.vector());
        Self::from_parts(self.w * other.w - a.dot(b), b * self.w + a * other.w + a.cross(b))
    }
}

macro_rules! glam_conversions {
    ($real:ident, $vec3:ident, $quat:ident) => {
        impl From<glam::$vec3> for Vec3<$real> {
            #[inline(always)]
            fn from(v: glam::$vec3) -> Self {
                Self::new(v.x, v.y, v.z)
            }
        }

        impl From<Vec3<$real>> for glam::$vec3 {
            #[inline(always)]
            fn from(v: Vec3<$real>) -> Self {
                Self::new(v.x, v.y, v.z)
            }
        }

        impl From<glam::$quat> for Quat<$real> {
            #[inline(always)]
            fn from(q: glam::$quat) -> Self {
                Self { x: q.x, y: q.y, z: q.z, w: q.w }
            }
        }

        impl From<Quat<$real>> for glam::$quat {
            #[inline(always)]
            fn from(q: Quat<$real>) -> Self {
                Self::from_xyzw(q.x, q.y, q.z, q.w)
            }
        }
    };
}

glam_conversions!(f32, Vec3, Quat);
glam_conversions!(f64, DVec3, DQuat);
