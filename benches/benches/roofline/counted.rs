//! A number type that counts the arithmetic operations done with it.

use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use tumble::math::Real;
use tumble_math::lane::Lane;

/// Operations by what they cost: a processor has one unit for division and root, and several for
/// all else.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Operations {
    /// Additions, subtractions and multiplications.
    pub(crate) simple: f64,
    /// Divisions and square roots.
    pub(crate) slow: f64,
    /// Comparisons, selections and changes of sign.
    pub(crate) logical: f64,
}

impl Operations {
    pub(crate) fn per(self, bodies: usize) -> Self {
        let n = bodies as f64;
        Self { simple: self.simple / n, slow: self.slow / n, logical: self.logical / n }
    }
}

impl AddAssign for Operations {
    fn add_assign(&mut self, other: Self) {
        self.simple += other.simple;
        self.slow += other.slow;
        self.logical += other.logical;
    }
}

thread_local! {
    static DONE: Cell<Operations> = const { Cell::new(Operations { simple: 0.0, slow: 0.0, logical: 0.0 }) };
}

/// What a computation with [`Counted`] numbers does.
pub(crate) fn count<R>(computation: impl FnOnce() -> R) -> Operations {
    DONE.set(Operations::default());
    computation();
    DONE.get()
}

fn add(operations: Operations) {
    let mut done = DONE.get();
    done += operations;
    DONE.set(done);
}

fn simple() {
    add(Operations { simple: 1.0, ..Operations::default() });
}

fn slow() {
    add(Operations { slow: 1.0, ..Operations::default() });
}

fn logical() {
    add(Operations { logical: 1.0, ..Operations::default() });
}

/// A number of one body that counts what is done with it.
#[derive(Clone, Copy)]
pub(crate) struct Counted(pub(crate) Real);

macro_rules! operator {
    ($Trait:ident $method:ident $counts:ident) => {
        impl $Trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                $counts();
                Self(self.0.$method(other.0))
            }
        }
    };
}

operator!(Add add simple);
operator!(Sub sub simple);
operator!(Mul mul simple);
operator!(Div div slow);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        logical();
        Self(-self.0)
    }
}

impl Lane for Counted {
    type Mask = bool;

    const ROUNDING: f64 = <Real as Lane>::ROUNDING;

    fn splat(value: f64) -> Self {
        Self(Lane::splat(value))
    }

    fn sqrt(self) -> Self {
        slow();
        Self(self.0.sqrt())
    }

    fn lt(self, other: Self) -> bool {
        logical();
        self.0 < other.0
    }

    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        logical();
        if mask { if_true } else { if_false }
    }

    fn any(mask: bool) -> bool {
        logical();
        mask
    }

    fn all(mask: bool) -> bool {
        logical();
        mask
    }

    fn exp2_of_integer(self) -> Self {
        logical();
        Self(self.0.exp2_of_integer())
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = Lane::sin_cos(self.0);
        (Self(sine), Self(cosine))
    }
}
