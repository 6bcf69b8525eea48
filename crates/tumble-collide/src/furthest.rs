//! Support queries on large point sets with a tree of bounding boxes.

use std::cmp::Ordering;

use crate::support_map::Vector;
use crate::work;

/// Vectors of a leaf; with fewer than twice as many there is no tree.
const LEAF: usize = 8;

/// Part of the products of lengths by which a scalar product may be off for rounding: three
/// products and two sums in either.
const ROUNDING: f64 = 1e-14;

/// Many vectors, to find the one furthest in a direction: the same as by going through all, the
/// first of equal ones.
///
/// A tree of boxes. A box is left out when none of its corners is as far as the best so far: of 1e5
/// points on a sphere some hundred are tested.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Furthest {
    nodes: Vec<Node>,
    /// The indices of the vectors, leaf by leaf.
    indices: Vec<u32>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    center: Vector,
    half: Vector,
    /// Range of the indices.
    from: u32,
    to: u32,
    /// The second of two halves, the first being the next node; zero for a leaf.
    second: u32,
}

impl Furthest {
    pub(crate) fn new(vectors: &[Vector]) -> Self {
        let mut this = Self::default();
        if vectors.len() >= 2 * LEAF {
            let mut indices: Vec<u32> = (0..vectors.len() as u32).collect();
            this.divide(vectors, &mut indices, 0);
            this.indices = indices;
        }
        this
    }

    fn divide(&mut self, vectors: &[Vector], indices: &mut [u32], from: u32) {
        let at = |index: &u32| vectors[*index as usize];
        let all = || indices.iter().map(at);
        let each =
            |a: Vector, b: Vector, of: fn(f64, f64) -> f64| Vector::new(of(a.x, b.x), of(a.y, b.y), of(a.z, b.z));
        let low = all().fold(Vector::splat(f64::INFINITY), |low, v| each(low, v, f64::min));
        let high = all().fold(Vector::splat(f64::NEG_INFINITY), |high, v| each(high, v, f64::max));
        let (place, to) = (self.nodes.len(), from + indices.len() as u32);
        let (center, half) = ((low + high) * 0.5, (high - low) * 0.5);
        self.nodes.push(Node { center, half, from, to, second: 0 });
        if indices.len() <= LEAF {
            return;
        }
        let along = |v: Vector| match half {
            half if half.x >= half.y && half.x >= half.z => v.x,
            half if half.y >= half.z => v.y,
            _ => v.z,
        };
        let middle = indices.len() / 2;
        indices.select_nth_unstable_by(middle, |a, b| along(at(a)).total_cmp(&along(at(b))).then(a.cmp(b)));
        let (first, second) = indices.split_at_mut(middle);
        self.divide(vectors, first, from);
        self.nodes[place].second = self.nodes.len() as u32;
        self.divide(vectors, second, from + middle as u32);
    }

    /// The index of the vector furthest in a direction; none where no scalar product is a number.
    pub(crate) fn find(&self, vectors: &[Vector], d: Vector) -> Option<usize> {
        let mut best = (f64::NEG_INFINITY, None);
        if self.nodes.is_empty() {
            work::multiplied(vectors.len());
            for (index, vector) in vectors.iter().enumerate() {
                let along = vector.dot(d);
                if along > best.0 {
                    best = (along, Some(index));
                }
            }
        } else {
            self.search(vectors, d, 0, &mut best);
        }
        best.1
    }

    fn search(&self, vectors: &[Vector], d: Vector, place: usize, best: &mut (f64, Option<usize>)) {
        let node = &self.nodes[place];
        if node.second > 0 {
            let mut halves = [place + 1, node.second as usize].map(|half| (self.nodes[half].most(d), half));
            if halves[1].0 > halves[0].0 {
                halves.swap(0, 1);
            }
            work::multiplied(2);
            for (most, half) in halves {
                // What is not a number is gone through.
                if most.partial_cmp(&best.0) != Some(Ordering::Less) {
                    self.search(vectors, d, half, best);
                }
            }
            return;
        }
        let indices = &self.indices[node.from as usize..node.to as usize];
        work::multiplied(indices.len());
        for index in indices.iter().map(|index| *index as usize) {
            let along = vectors[index].dot(d);
            if along > best.0 || (along == best.0 && best.1.is_some_and(|other| index < other)) {
                *best = (along, Some(index));
            }
        }
    }
}

impl Node {
    /// No vector is further in a direction.
    fn most(&self, d: Vector) -> f64 {
        let away = Vector::new(d.x.abs(), d.y.abs(), d.z.abs());
        let size = Vector::new(self.center.x.abs(), self.center.y.abs(), self.center.z.abs()) + self.half;
        self.center.dot(d) + self.half.dot(away) + size.dot(away) * ROUNDING
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vectors() -> impl Strategy<Value = Vec<Vector>> {
        let number = || prop_oneof![-1.0..1.0_f64, Just(0.0), Just(0.5), Just(-0.5)];
        // With equal numbers many are equally far.
        let vector = [number(), number(), number()].prop_map(|[x, y, z]| Vector::new(x, y, z));
        prop::collection::vec(vector, 1..300)
    }

    proptest! {
        #[test]
        fn it_is_that_of_going_through_all(vectors in vectors(), directions in vectors()) {
            let bvh = Furthest::new(&vectors);
            let all = Furthest::default();
            for d in directions.into_iter().chain([Vector::new(f64::NAN, 0.0, 1.0), Vector::new(1e200, 1e-200, 0.0)]) {
                prop_assert_eq!(bvh.find(&vectors, d), all.find(&vectors, d));
            }
        }
    }

    /// Points on a ball are the worst there is: all are corners of their hull. What is gone through
    /// grows as the root of their number.
    #[test]
    fn of_many_points_few_are_tested() {
        for count in [1000, 10_000, 100_000_u32] {
            // Evenly spread, by the golden angle.
            let vectors: Vec<Vector> = (0..count)
                .map(|i| {
                    let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(count);
                    let (sin, cos) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
                    let radius = (1.0 - y * y).sqrt();
                    Vector::new(radius * cos, y, radius * sin)
                })
                .collect();
            let bvh = Furthest::new(&vectors);
            let _ = work::multiplications();
            for (i, vector) in vectors.iter().enumerate().step_by(97) {
                assert_eq!(bvh.find(&vectors, *vector), Some(i));
                let looked = work::multiplications();
                assert!(looked <= 16 * f64::from(count).sqrt() as usize, "{looked} of {count}");
            }
        }
    }
}
