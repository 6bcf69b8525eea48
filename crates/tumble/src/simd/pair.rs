//! Two SIMD tiles combined into a wider one, for instruction-level parallelism.

use std::ops::{Add, Div, Mul, Neg, Sub};

use tumble_math::lane::Lane;

#[cfg(not(avx_code))]
use super::four::{Four, FourLane};
#[cfg(not(avx_code))]
use super::target::Double;
use super::{Record, Tile, Widen};

/// Two tiles side by side: while an operation of one waits for its operands, the machine works on
/// the other's.
#[derive(Clone, Copy)]
pub(super) struct Pair<T>(pub(super) T, pub(super) T);

macro_rules! both {
    ($($Operator:ident: $method:ident),+) => {
        $(
            impl<T: Lane> $Operator for Pair<T> {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    Self(self.0.$method(other.0), self.1.$method(other.1))
                }
            }
        )+
    };
}

both!(Add: add, Sub: sub, Mul: mul, Div: div);

impl<T: Lane> Neg for Pair<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<T: Lane> Lane for Pair<T> {
    type Mask = (T::Mask, T::Mask);

    const ROUNDING: f64 = T::ROUNDING;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(T::splat(value), T::splat(value))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        (self.0.lt(other.0), self.1.lt(other.1))
    }

    #[inline(always)]
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
        Self(T::select(mask.0, if_true.0, if_false.0), T::select(mask.1, if_true.1, if_false.1))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        T::any(mask.0) | T::any(mask.1)
    }

    #[inline(always)]
    fn all(mask: Self::Mask) -> bool {
        T::all(mask.0) & T::all(mask.1)
    }

    #[inline(always)]
    fn exp2_of_integer(self) -> Self {
        Self(self.0.exp2_of_integer(), self.1.exp2_of_integer())
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let ((sine_0, cosine_0), (sine_1, cosine_1)) = (self.0.sin_cos(), self.1.sin_cos());
        (Self(sine_0, sine_1), Self(cosine_0, cosine_1))
    }
}

impl<T: Tile> Widen for Pair<T> {
    type Double = Pair<T::Double>;

    #[inline(always)]
    fn widen(self) -> Self::Double {
        Pair(self.0.widen(), self.1.widen())
    }

    #[inline(always)]
    fn store_doubles(doubles: Self::Double, row: &mut [f64]) {
        T::store_doubles(doubles.0, row);
        T::store_doubles(doubles.1, &mut row[T::WIDTH..]);
    }
}

impl<T: Tile> Tile for Pair<T> {
    const WIDTH: usize = 2 * T::WIDTH;
    const IS_PAIR: bool = true;

    #[inline(always)]
    fn load<R: Record, const N: usize>(rows: &[R]) -> [Self; N] {
        let (first, second) = (T::load::<R, N>(rows), T::load::<R, N>(&rows[T::WIDTH..]));
        let mut both = [Self(first[0], second[0]); N];
        let mut c = 1;
        while c < N {
            both[c] = Self(first[c], second[c]);
            c += 1;
        }
        both
    }

    #[inline(always)]
    fn store<R: Record, const N: usize>(numbers: [Self; N], rows: &mut [R]) {
        let (mut first, mut second) = ([numbers[0].0; N], [numbers[0].1; N]);
        let mut c = 1;
        while c < N {
            (first[c], second[c]) = (numbers[c].0, numbers[c].1);
            c += 1;
        }
        T::store(first, rows);
        T::store(second, &mut rows[T::WIDTH..]);
    }

    #[inline(always)]
    fn are_zero<const N: usize>(numbers: [Self; N]) -> bool {
        let (mut first, mut second) = ([numbers[0].0; N], [numbers[0].1; N]);
        let mut c = 1;
        while c < N {
            (first[c], second[c]) = (numbers[c].0, numbers[c].1);
            c += 1;
        }
        T::are_zero(first) & T::are_zero(second)
    }
}

#[cfg(not(avx_code))]
impl FourLane for Pair<Double> {
    #[inline(always)]
    fn load(&[a, b, c, d]: &Four) -> Self {
        Self(Double::from_array(&[a, b]), Double::from_array(&[c, d]))
    }

    #[inline(always)]
    fn store(self, numbers: &mut Four) {
        let ([a, b], [c, d]) = (self.0.to_array(), self.1.to_array());
        *numbers = [a, b, c, d];
    }
}
