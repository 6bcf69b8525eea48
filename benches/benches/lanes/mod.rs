//! Vector registers of the widest instruction set of the machine, by a library that is not the
//! engine's: what is measured against the engine is not to share its code.

use std::ops::{Add, Div, Mul, Sub};

use pulp::Simd;
use tumble::math::Real;

/// Real numbers of neighbouring bodies, in the precision of the build. Nothing is fused.
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    register: Register<S>,
}

// What a derive would make asks for more than that of `S`.
impl<S: Simd> Clone for Lanes<S> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Simd> Copy for Lanes<S> {}

macro_rules! precision {
    ($registers:ident, $real:ident, $splat:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident, $as_mut:ident) => {
        /// A vector register.
        pub(crate) type Register<S> = <S as Simd>::$registers;

        impl<S: Simd> Lanes<S> {
            #[inline(always)]
            pub(crate) fn splat(simd: S, value: Real) -> Self {
                Self { simd, register: simd.$splat(value) }
            }

            #[inline(always)]
            pub(crate) fn sqrt(self) -> Self {
                Self { simd: self.simd, register: self.simd.$sqrt(self.register) }
            }
        }

        /// A column as registers; what does not fill one at its end is left out.
        #[inline(always)]
        pub(crate) fn registers<S: Simd>(column: &mut [Real]) -> &mut [Register<S>] {
            S::$as_mut(column).0
        }

        precision!(operator Add add $add);
        precision!(operator Sub sub $sub);
        precision!(operator Mul mul $mul);
        precision!(operator Div div $div);
    };
    (operator $Trait:ident $method:ident $operation:ident) => {
        impl<S: Simd> $Trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { simd: self.simd, register: self.simd.$operation(self.register, other.register) }
            }
        }
    };
}

#[cfg(not(feature = "f64"))]
precision!(f32s, f32, splat_f32s, add_f32s, sub_f32s, mul_f32s, div_f32s, sqrt_f32s, as_mut_simd_f32s);
#[cfg(feature = "f64")]
precision!(f64s, f64, splat_f64s, add_f64s, sub_f64s, mul_f64s, div_f64s, sqrt_f64s, as_mut_simd_f64s);

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(crate) fn load(simd: S, register: &Register<S>) -> Self {
        Self { simd, register: *register }
    }

    #[inline(always)]
    pub(crate) fn store(self, register: &mut Register<S>) {
        *register = self.register;
    }
}
