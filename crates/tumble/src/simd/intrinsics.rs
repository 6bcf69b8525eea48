//! Lanes and tiles out of the intrinsics of an instruction set: what all of them have in common.
//!
//! Intrinsics are `unsafe`: those of an instruction set may only run where the machine has it. A
//! module that declares lanes says how it keeps that.

/// Declares a lane: its intrinsics, and the few operations that differ in more than a name.
macro_rules! lane {
    (
        $Tile:ident, $Number:ty, $Vector:ident, $Mask:ident, $width:literal,
        $set1:ident, $load:ident, $store:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident $(, $min:ident, $max:ident)?;
        neg: |$n:ident| $neg:expr,
        lt: |$a:ident, $b:ident| $lt:expr,
        select: |$mask:ident, $if_true:ident, $if_false:ident| $select:expr,
        any: |$m:ident| $any:expr,
        all: |$every:ident| $all:expr,
        exp2: |$e:ident| $exp2:expr,
    ) => {
        #[derive(Clone, Copy)]
        pub(in crate::simd) struct $Tile($Vector);

        impl $Tile {
            #[inline(always)]
            pub(in crate::simd) fn from_array(numbers: &[$Number; $width]) -> Self {
                // SAFETY: the array has the size of the vector, and an unaligned load is used; for
                // the rest see the module.
                Self(unsafe { $load(numbers.as_ptr().cast()) })
            }

            #[inline(always)]
            pub(in crate::simd) fn to_array(self) -> [$Number; $width] {
                let mut numbers = [0.0; $width];
                // SAFETY: the array has the size of the vector, and an unaligned store is used; for
                // the rest see the module.
                unsafe { $store(numbers.as_mut_ptr().cast(), self.0) };
                numbers
            }
        }

        lane!(@operator $Tile, Add, add, $add);
        lane!(@operator $Tile, Sub, sub, $sub);
        lane!(@operator $Tile, Mul, mul, $mul);
        lane!(@operator $Tile, Div, div, $div);

        impl Neg for $Tile {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let $n = self.0;
                // SAFETY: see the module.
                Self(unsafe { $neg })
            }
        }

        impl Lane for $Tile {
            type Mask = $Mask;

            const ROUNDING: f64 = <$Number as Lane>::ROUNDING;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $set1(<$Number>::splat(value)) })
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $sqrt(self.0) })
            }

            #[inline(always)]
            fn lt(self, other: Self) -> $Mask {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: see the module.
                unsafe { $lt }
            }

            #[inline(always)]
            fn select($mask: $Mask, if_true: Self, if_false: Self) -> Self {
                let ($if_true, $if_false) = (if_true.0, if_false.0);
                // SAFETY: see the module.
                Self(unsafe { $select })
            }

            $(
                // What is passed too gives the second where a number is none or both are zero.
                #[inline(always)]
                fn min(self, other: Self) -> Self {
                    // SAFETY: see the module.
                    Self(unsafe { $min(self.0, other.0) })
                }

                #[inline(always)]
                fn max(self, other: Self) -> Self {
                    // SAFETY: see the module.
                    Self(unsafe { $max(self.0, other.0) })
                }
            )?

            #[inline(always)]
            fn any($m: $Mask) -> bool {
                // SAFETY: see the module.
                unsafe { $any }
            }

            #[inline(always)]
            fn all($every: $Mask) -> bool {
                // SAFETY: see the module.
                unsafe { $all }
            }

            #[inline(always)]
            fn exp2_of_integer(self) -> Self {
                let $e = self.0;
                // SAFETY: see the module.
                Self(unsafe { $exp2 })
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                let (mut sines, mut cosines) = (self.to_array(), [0.0; $width]);
                for (sine, cosine) in sines.iter_mut().zip(&mut cosines) {
                    (*sine, *cosine) = <$Number as Lane>::sin_cos(*sine);
                }
                (Self::from_array(&sines), Self::from_array(&cosines))
            }
        }
    };
    (@operator $Tile:ident, $Operator:ident, $method:ident, $intrinsic:ident) => {
        impl $Operator for $Tile {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

/// Makes a tile of a lane of the build's numbers.
macro_rules! tile {
    (
        $Tile:ident, $Vector:ident, $width:literal, $load:ident, $store:ident,
        or: |$x:ident, $y:ident| $or:expr,
        is_zero: |$v:ident| $is_zero:expr,
        rows: $rows:ident,
    ) => {
        #[cfg(feature = "f64")]
        impl Widen for $Tile {
            type Double = Self;

            #[inline(always)]
            fn widen(self) -> Self {
                self
            }

            #[inline(always)]
            fn store_doubles(doubles: Self, row: &mut [f64]) {
                <Self as Tile>::store([doubles], row);
            }
        }

        impl Tile for $Tile {
            const WIDTH: usize = $width;

            #[inline(always)]
            fn load<R: Record, const N: usize>(rows: &[R]) -> [Self; N] {
                let rows = &rows[..$width];
                let mut tiles = [Self::splat(0.0); N];
                if R::STRIDE == 1 {
                    // SAFETY: as many numbers behind each other as the tile is wide; for the rest
                    // see the module.
                    tiles[0] = Self(unsafe { $load(rows.as_ptr().cast()) });
                } else if $rows::transposes::<R, N>() {
                    // SAFETY: as many rows as the tile is wide, of at least N numbers each; for the
                    // rest see the module.
                    let vectors: [$Vector; N] = unsafe { $rows::load_rows(rows.as_ptr().cast(), R::STRIDE) };
                    let mut c = 0;
                    while c < N {
                        tiles[c] = Self(vectors[c]);
                        c += 1;
                    }
                } else {
                    let mut c = 0;
                    while c < N {
                        let mut lanes = [0.0; $width];
                        for (lane, row) in lanes.iter_mut().zip(rows) {
                            *lane = numbers::<R, N>(row)[c];
                        }
                        tiles[c] = Self::from_array(&lanes);
                        c += 1;
                    }
                }
                tiles
            }

            #[inline(always)]
            fn gather<const N: usize>(rows: &[&Eight; BLOCK]) -> [Self; N] {
                const { assert!($width <= BLOCK && N >= 4) };
                // SAFETY: see the module.
                let vectors: [$Vector; N] = unsafe { $rows::gather_rows(rows) };
                let mut tiles = [Self(vectors[0]); N];
                let mut c = 1;
                while c < N {
                    tiles[c] = Self(vectors[c]);
                    c += 1;
                }
                tiles
            }

            #[inline(always)]
            fn store<R: Record, const N: usize>(tiles: [Self; N], rows: &mut [R]) {
                let rows = &mut rows[..$width];
                if R::STRIDE == 1 {
                    // SAFETY: as many numbers behind each other as the tile is wide; for the rest
                    // see the module.
                    unsafe { $store(rows.as_mut_ptr().cast(), tiles[0].0) };
                } else if $rows::transposes::<R, N>() {
                    let mut vectors = [tiles[0].0; N];
                    let mut c = 1;
                    while c < N {
                        vectors[c] = tiles[c].0;
                        c += 1;
                    }
                    // SAFETY: as many rows as the tile is wide, of at least N numbers each; for the
                    // rest see the module.
                    unsafe { $rows::store_rows(vectors, rows.as_mut_ptr().cast(), R::STRIDE) };
                } else {
                    let mut lanes = [[0.0; $width]; N];
                    let mut c = 0;
                    while c < N {
                        lanes[c] = tiles[c].to_array();
                        c += 1;
                    }
                    for (i, row) in rows.iter_mut().enumerate() {
                        set_numbers::<R, N>(row, std::array::from_fn(|c| lanes[c][i]));
                    }
                }
            }

            #[inline(always)]
            fn scatter<const N: usize>(tiles: [Self; N], rows: &mut [&mut Eight; BLOCK]) {
                const { assert!($width <= BLOCK) };
                let mut vectors = [tiles[0].0; N];
                let mut c = 1;
                while c < N {
                    vectors[c] = tiles[c].0;
                    c += 1;
                }
                // SAFETY: see the module.
                unsafe { $rows::scatter_rows(vectors, rows) };
            }

            #[inline(always)]
            fn are_zero<const N: usize>(numbers: [Self; N]) -> bool {
                let mut $v = numbers[0].0;
                let mut c = 1;
                while c < N {
                    let ($x, $y) = ($v, numbers[c].0);
                    // SAFETY: see the module.
                    $v = unsafe { $or };
                    c += 1;
                }
                // SAFETY: see the module.
                unsafe { $is_zero }
            }
        }
    };
}

/// Gives a tile of four numbers of single precision the fours of double precision.
#[cfg(not(feature = "f64"))]
macro_rules! widen_to_four {
    ($Tile:ident, $Four:ty) => {
        impl Widen for $Tile {
            type Double = $Four;

            #[inline(always)]
            fn widen(self) -> $Four {
                let [a, b, c, d] = self.to_array();
                <$Four>::load(&[a.into(), b.into(), c.into(), d.into()])
            }

            #[inline(always)]
            fn store_doubles(doubles: $Four, row: &mut [f64]) {
                let mut numbers = [0.0; 4];
                doubles.store(&mut numbers);
                row[..4].copy_from_slice(&numbers);
            }
        }
    };
}

#[cfg(not(feature = "f64"))]
pub(super) use widen_to_four;
pub(super) use {lane, tile};
