//! Four numbers of double precision side by side, in builds of either precision.

use std::ops::{Add, Div, Mul, Neg, Sub};

use tumble_math::lane::Lane;

/// Four numbers in memory.
pub(crate) type Four = [f64; 4];

/// A lane of four numbers of double precision.
pub(crate) trait FourLane: Lane {
    fn load(numbers: &Four) -> Self;

    fn store(self, numbers: &mut Four);

    /// The first numbers of the four rows, then the second ones, and so on.
    #[inline(always)]
    fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
        let mut rows = [[0.0; 4]; 4];
        a.store(&mut rows[0]);
        b.store(&mut rows[1]);
        c.store(&mut rows[2]);
        d.store(&mut rows[3]);
        let [[a, e, i, m], [b, f, j, n], [c, g, k, o], [d, h, l, p]] = rows;
        [Self::load(&[a, b, c, d]), Self::load(&[e, f, g, h]), Self::load(&[i, j, k, l]), Self::load(&[m, n, o, p])]
    }
}

/// A computation with fours.
pub(crate) trait FourKernel {
    /// Must be `#[inline(always)]`, as must be all that it calls with fours; see
    /// [`Kernel::tile`](super::Kernel::tile).
    fn run<T: FourLane>(self);

    /// Runs it with fours of no instruction set: one function, whatever it is called by.
    #[cfg(not(vectors_alone))]
    fn portably(self)
    where
        Self: Sized,
    {
        self.run::<PortableFour>();
    }
}

/// Fours of no particular instruction set: the reference.
#[cfg_attr(vectors_alone, allow(dead_code, reason = "the fours are those of vectors"))]
#[derive(Clone, Copy)]
pub(super) struct PortableFour([f64; 4]);

macro_rules! by_number {
    ($($Operator:ident: $method:ident),+) => {
        $(
            impl $Operator for PortableFour {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
                    Self([a.$method(e), b.$method(f), c.$method(g), d.$method(h)])
                }
            }
        )+
    };
}

by_number!(Add: add, Sub: sub, Mul: mul, Div: div);

impl Neg for PortableFour {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([-a, -b, -c, -d])
    }
}

impl Lane for PortableFour {
    type Mask = [bool; 4];

    const ROUNDING: f64 = <f64 as Lane>::ROUNDING;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([a.sqrt(), b.sqrt(), c.sqrt(), d.sqrt()])
    }

    #[inline(always)]
    fn lt(self, other: Self) -> [bool; 4] {
        let ([a, b, c, d], [e, f, g, h]) = (self.0, other.0);
        [a < e, b < f, c < g, d < h]
    }

    #[inline(always)]
    fn select(mask: [bool; 4], if_true: Self, if_false: Self) -> Self {
        let ([a, b, c, d], [e, f, g, h], [i, j, k, l]) = (mask, if_true.0, if_false.0);
        Self([if a { e } else { i }, if b { f } else { j }, if c { g } else { k }, if d { h } else { l }])
    }

    #[inline(always)]
    fn any([a, b, c, d]: [bool; 4]) -> bool {
        a | b | c | d
    }

    #[inline(always)]
    fn all([a, b, c, d]: [bool; 4]) -> bool {
        a & b & c & d
    }

    #[inline(always)]
    fn exp2_of_integer(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([a.exp2_of_integer(), b.exp2_of_integer(), c.exp2_of_integer(), d.exp2_of_integer()])
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let [a, b, c, d] = self.0;
        let (a, b, c, d) = (Lane::sin_cos(a), Lane::sin_cos(b), Lane::sin_cos(c), Lane::sin_cos(d));
        (Self([a.0, b.0, c.0, d.0]), Self([a.1, b.1, c.1, d.1]))
    }
}

impl FourLane for PortableFour {
    #[inline(always)]
    fn load(numbers: &Four) -> Self {
        Self(*numbers)
    }

    #[inline(always)]
    fn store(self, numbers: &mut Four) {
        *numbers = self.0;
    }
}
