//! Every instruction set that this machine has, beside one number at a time: all operations of
//! lanes on all kinds of numbers, and rows of every length.

use super::record::sample::Sample;
use super::record::{numbers, set_numbers};
use super::*;
use crate::components::{Damping, Inertia, Pose, PrincipalAxes, Wind};
use crate::math::{Quat, Vec3};

/// Numbers of every kind: signed zeros, subnormal ones of both precisions, infinite ones, none.
const KINDS: [f64; 17] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    3.0,
    0.1,
    -2.5,
    1e-40,
    -1e-310,
    1e30,
    -1e30,
    7e-20,
    126.0,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
    0.75,
];

/// Each kind with each.
const BODIES: usize = 17 * 17;

/// What leaves a tile of every width over, in both precisions: 32 + 16 + 8 + 4 and single ones.
const ROWS: usize = 63;

/// The `i`-th pair of kinds, and an exponent.
fn operands<T: Lane>(i: usize) -> [T; 3] {
    [T::splat(KINDS[i % 17]), T::splat(KINDS[i / 17 % 17]), T::splat((i % 254) as f64 - 126.0)]
}

const RESULTS: usize = 15;

/// All that a lane can do.
#[inline(always)]
fn results<T: Lane>([a, b, exponent]: [T; 3]) -> [T; RESULTS] {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (sine, cosine) = b.sin_cos();
    let (never, always) = (one.lt(zero), zero.lt(one));
    [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        a.sqrt(),
        a.abs(),
        T::min(a, b),
        T::max(a, b),
        T::select(a.lt(b), T::splat(2.0), b),
        exponent.exp2_of_integer(),
        sine,
        cosine,
        if T::any(never) { one } else { zero },
        if T::all(always) { one } else { zero },
    ]
}

fn is_same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

struct Operations {
    operands: [Vec<Real>; 3],
    results: [Vec<Real>; RESULTS],
}

impl Operations {
    fn of(bodies: usize) -> Self {
        let column = |k: usize| (0..bodies).map(|i| operands::<Real>(i)[k]).collect();
        Self { operands: [column(0), column(1), column(2)], results: std::array::from_fn(|_| vec![7.0; bodies]) }
    }

    #[track_caller]
    fn check(&self, level: Level) {
        for i in 0..self.operands[0].len() {
            let expected = results::<Real>(operands(i));
            for (k, expected) in expected.into_iter().enumerate() {
                let found = self.results[k][i];
                let operands = operands::<Real>(i);
                assert!(
                    is_same(found.into(), expected.into()),
                    "{level:?}, result {k} of {operands:?}: {found}, not {expected}"
                );
            }
        }
    }
}

impl Kernel for Operations {
    fn len(&self) -> usize {
        self.operands[0].len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let ([a], [b]) = (T::load(&self.operands[0][i..]), T::load(&self.operands[1][i..]));
        let [exponent] = T::load(&self.operands[2][i..]);
        let results = results([a, b, exponent]);
        let mut k = 0;
        while k < RESULTS {
            T::store([results[k]], &mut self.results[k][i..]);
            k += 1;
        }
    }
}

fn available() -> impl Iterator<Item = Level> {
    Level::ALL.iter().copied().filter(|level| level.is_available())
}

#[test]
fn operations_are_those_of_one_number() {
    for level in available() {
        let mut all = Operations::of(BODIES);
        level.run(&mut all);
        all.check(level);
        let mut blocks = Operations::of(BODIES / HALF_BLOCK * HALF_BLOCK);
        level.run_in_blocks(&mut blocks);
        blocks.check(level);
    }
}

/// Products in double precision, and one in its place for each.
struct Widening {
    factors: [Vec<Real>; 2],
    products: Vec<f64>,
}

impl Kernel for Widening {
    fn len(&self) -> usize {
        self.products.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let ([a], [b]) = (T::load(&self.factors[0][i..]), T::load(&self.factors[1][i..]));
        T::store_doubles(a.widen() * b.widen(), &mut self.products[i..]);
    }
}

#[test]
fn products_in_double_precision_are_those_of_one_number() {
    for level in available() {
        let factors = [0, 1].map(|k| (0..BODIES).map(|i| operands::<Real>(i)[k]).collect());
        let mut widening = Widening { factors, products: vec![7.0; BODIES] };
        level.run(&mut widening);
        for (i, product) in widening.products.into_iter().enumerate() {
            let [a, b] = [0, 1].map(|k| f64::from(widening.factors[k][i]));
            assert!(is_same(product, a * b), "{level:?}, {i}: {a} times {b} is not {product}");
        }
    }
}

struct Fours<'a> {
    results: &'a mut [[Four; RESULTS]],
}

impl FourKernel for Fours<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        for (i, found) in self.results.iter_mut().enumerate() {
            let column = |k: usize| [0, 1, 2, 3].map(|lane| operands::<f64>(4 * i + lane)[k]);
            let results = results([T::load(&column(0)), T::load(&column(1)), T::load(&column(2))]);
            for (number, result) in found.iter_mut().zip(results) {
                result.store(number);
            }
        }
    }
}

#[test]
fn fours_do_what_one_number_does() {
    for level in available() {
        let mut found = [[[7.0; 4]; RESULTS]; BODIES / 4];
        level.run_fours(Fours { results: &mut found });
        for (i, found) in found.iter().enumerate() {
            let expected = [0, 1, 2, 3].map(|lane| results(operands::<f64>(4 * i + lane)));
            for (k, found) in found.iter().enumerate() {
                let is_right = expected.iter().zip(found).all(|(expected, found)| is_same(*found, expected[k]));
                assert!(is_right, "{level:?}, result {k} of four {i}: {found:?}");
            }
        }
    }
}

struct Transposed<'a> {
    rows: &'a mut [Four; 4],
}

impl FourKernel for Transposed<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        let [a, b, c, d] = self.rows;
        let columns = T::transpose([T::load(a), T::load(b), T::load(c), T::load(d)]);
        columns[0].store(a);
        columns[1].store(b);
        columns[2].store(c);
        columns[3].store(d);
    }
}

#[test]
fn fours_are_transposed() {
    for level in available() {
        let mut rows = [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| f64::from(4 * row + column)));
        level.run_fours(Transposed { rows: &mut rows });
        let expected = [0, 1, 2, 3].map(|row| [0, 1, 2, 3].map(|column| f64::from(row + 4 * column)));
        assert_eq!(rows, expected, "{level:?}");
    }
}

/// Marks where a comparison holds for some lanes of a tile, and where for all.
struct Masks {
    numbers: Vec<Real>,
    some: Vec<Real>,
    every: Vec<Real>,
    widths: Vec<usize>,
}

impl Kernel for Masks {
    fn len(&self) -> usize {
        self.numbers.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let [number] = T::load(&self.numbers[i..]);
        let is_negative = number.lt(T::splat(0.0));
        T::store([T::splat(f64::from(T::any(is_negative)))], &mut self.some[i..]);
        T::store([T::splat(f64::from(T::all(is_negative)))], &mut self.every[i..]);
        self.widths.push(T::WIDTH);
    }
}

#[test]
fn one_lane_makes_some_and_unmakes_all() {
    for (level, odd) in available().flat_map(|level| (0..ROWS).map(move |odd| (level, odd))) {
        for (usual, unusual) in [(1.0, -1.0), (-1.0, 1.0)] {
            let mut masks =
                Masks { numbers: vec![usual; ROWS], some: vec![7.0; ROWS], every: vec![7.0; ROWS], widths: Vec::new() };
            masks.numbers[odd] = unusual;
            level.run(&mut masks);
            assert!(masks.widths.is_sorted_by(|a, b| a >= b), "{level:?}: {:?}", masks.widths);
            assert_eq!(masks.widths.iter().sum::<usize>(), ROWS, "{level:?}");
            assert!(level.widths().iter().all(|width| masks.widths.contains(width)), "{level:?}: {:?}", masks.widths);
            let mut begin = 0;
            for width in &masks.widths {
                let tile = begin..begin + width;
                begin += width;
                let negative = masks.numbers[tile.clone()].iter().filter(|number| **number < 0.0).count();
                let expected = [negative > 0, negative == *width].map(|holds| if holds { 1.0 } else { 0.0 });
                assert!(
                    tile.clone().all(|i| [masks.some[i], masks.every[i]] == expected),
                    "{level:?}, {tile:?}, {odd}"
                );
            }
        }
    }
}

struct Zeros {
    columns: [Vec<Real>; 2],
    are_zero: bool,
}

impl Kernel for Zeros {
    fn len(&self) -> usize {
        self.columns[0].len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let ([a], [b]) = (T::load(&self.columns[0][i..]), T::load(&self.columns[1][i..]));
        self.are_zero &= T::are_zero([a, b]);
    }
}

#[test]
fn nothing_but_positive_zeros_is_zero() {
    for level in available() {
        let zeros = |change: Option<(usize, usize, Real)>| {
            let mut zeros = Zeros { columns: [vec![0.0; ROWS], vec![0.0; ROWS]], are_zero: true };
            if let Some((column, i, number)) = change {
                zeros.columns[column][i] = number;
            }
            level.run(&mut zeros);
            zeros.are_zero
        };
        assert!(zeros(None), "{level:?}");
        // Numbers with the sign alone, the lowest bit alone, and neither.
        for (i, number) in (0..ROWS).flat_map(|i| [-0.0, Real::from_bits(1), 1.0].map(|number| (i, number))) {
            assert!(!zeros(Some((0, i, number))) && !zeros(Some((1, i, number))), "{level:?}, {number}, {i}");
        }
    }
}

/// Turns the order of the first `N` numbers of each row round.
struct Reversal<R, const N: usize> {
    rows: Vec<R>,
}

impl<R: Record, const N: usize> Kernel for Reversal<R, N> {
    fn len(&self) -> usize {
        self.rows.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let mut loaded = T::load::<R, N>(&self.rows[i..]);
        loaded.reverse();
        T::store(loaded, &mut self.rows[i..]);
    }
}

/// Reverses `N` of a record's `ALL` numbers, with a number of bodies that leaves some over.
#[track_caller]
fn check_rows<R: Record, const N: usize, const ALL: usize>(empty: R) {
    for level in available() {
        let number = |row: usize, c: usize| (100 * row + c) as Real;
        let mut rows = vec![empty; ROWS];
        for (i, row) in rows.iter_mut().enumerate() {
            set_numbers::<R, ALL>(row, std::array::from_fn(|c| number(i, c)));
        }
        let mut reversal = Reversal::<R, N> { rows };
        level.run(&mut reversal);
        for (i, row) in reversal.rows.iter().enumerate() {
            let expected = std::array::from_fn(|c| number(i, if c < N { N - 1 - c } else { c }));
            assert_eq!(numbers::<R, ALL>(row), expected, "{level:?}, row {i}");
        }
    }
}

#[test]
fn rows_of_every_length_are_loaded_and_stored() {
    check_rows::<Real, 1, 1>(0.0);
    check_rows::<Damping, 2, 2>(Damping::default());
    check_rows::<Wind, 3, 3>(Wind(Vec3::ZERO));
    check_rows::<PrincipalAxes, 4, 4>(PrincipalAxes(Quat::IDENTITY));
    check_rows::<Inertia, 6, 6>(Inertia::new([1.0; 3]).unwrap());
    check_rows::<Pose, 7, 7>(Pose::default());
    check_rows::<Pose, 3, 7>(Pose::default());
    check_rows::<Eight, 8, 8>(Eight::ZERO);
    check_rows::<Eight, 5, 8>(Eight::ZERO);
}

/// Copies rows from anywhere.
struct Gathering {
    from: Vec<Eight>,
    to: Vec<Eight>,
}

/// The row that comes to row `i`.
fn source(i: usize, rows: usize) -> usize {
    (5 * i + 3) % rows
}

impl Kernel for Gathering {
    fn len(&self) -> usize {
        self.to.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let rows = std::array::from_fn(|lane| &self.from[source(i + lane, self.from.len())]);
        let gathered: [T; 8] = T::gather(&rows);
        T::store(gathered, &mut self.to[i..]);
    }
}

#[test]
fn rows_from_anywhere_are_gathered() {
    for level in available() {
        let from: Vec<Eight> = (0..43).map(|i| Eight(std::array::from_fn(|c| (100 * i + c) as Real))).collect();
        // Two blocks and half of one.
        let mut gathering = Gathering { from: from.clone(), to: vec![Eight::ZERO; 5 * HALF_BLOCK] };
        level.run_in_blocks(&mut gathering);
        for (i, row) in gathering.to.iter().enumerate() {
            assert_eq!(row.0, from[source(i, from.len())].0, "{level:?}, row {i}");
        }
    }
}

/// Swaps the rows of each pair.
struct Swapping<'a>(Rows<'a, Sample>, usize);

impl Kernel for Swapping<'_> {
    fn len(&self) -> usize {
        self.1 * BLOCK
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let Self(rows, _) = self;
        let (block, lane) = (i / BLOCK, i % BLOCK);
        let (first, second) = (rows.gather::<T>(block, 0, lane), rows.gather::<T>(block, 1, lane));
        rows.scatter(first, block, 1, lane);
        rows.scatter(second, block, 0, lane);
    }
}

#[test]
fn rows_anywhere_are_overwritten_in_full_blocks_and_others_and_no_other_rows_are() {
    // Two full blocks, and one that ends in its second half or in its first.
    for left in [HALF_BLOCK + 3, 4] {
        let (count, rows) = (2 * BLOCK + left, 89);
        // Rows up to 88; row 90 stands for none.
        let pairs: Vec<[u32; 2]> = (0..count).map(|i| [i, i + count].map(|i| (7 * i % rows) as u32)).collect();
        swap_each(&pairs, rows as u16 + 1);
    }
}

/// Swaps the rows of each pair in blocks, and compares with rows swapped pair after pair; `none`
/// stands for no row.
fn swap_each(pairs: &[[u32; 2]], none: u16) {
    for level in available() {
        let mut colors = RowColors::default();
        colors.reset(usize::from(none) + 1);
        colors.begin(false);
        pairs.chunks(BLOCK).for_each(|block| colors.push(block.iter().copied()));
        let before: Vec<Sample> = (0..=none).map(sample).collect();
        let mut after = before.clone();
        level.run_in_blocks(&mut Swapping(colors.rows(0, &mut after), pairs.len().div_ceil(BLOCK)));
        let mut expected = before;
        pairs.iter().for_each(|[a, b]| expected.swap(*a as usize, *b as usize));
        let all = |rows: &[Sample]| rows.iter().map(numbers::<Sample, 8>).collect::<Vec<_>>();
        assert_eq!(all(&after), all(&expected), "{level:?}");
    }
}

/// Eight numbers that no other row has.
fn sample(row: u16) -> Sample {
    let mut sample = Sample::ZERO;
    set_numbers::<Sample, 8>(&mut sample, std::array::from_fn(|c| Real::from(8 * row + c as u16)));
    sample
}
