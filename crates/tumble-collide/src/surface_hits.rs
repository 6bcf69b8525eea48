//! Points of contact with the triangles of a surface, and how those that belong together become
//! manifolds.

use std::collections::HashMap;

use crate::face_clipping::as_near;
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::manifold_reduction::{Cut, keep_nearest, reduce};
use crate::support_map::Vector;
use crate::work;

/// Cosine of directions that are the same to a face and to an edge of it: within a thousandth of a
/// radian.
const SAME: f64 = 1.0 - 5e-7;
/// Most normals of faces of one part that are compared with that of an edge.
const MAX_NORMALS: usize = 16;
/// Of more points than this the near ones are found in a grid.
const FEW: usize = 64;
/// Points nearer to each other than this \[m\], squared, are one.
const ONE_POINT: f64 = 1e-12;

/// A point of contact with a triangle, before those that belong together are collected.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub(crate) part: u32,
    pub(crate) normal: Vector,
    pub(crate) point: ContactPoint<f64>,
    pub(crate) carried: f64,
    /// Flat pieces that make this needless if they hold in the same direction.
    pub(crate) beside: Option<[u32; 3]>,
}

/// The points of a pair, and memory for putting them together.
#[derive(Default)]
pub(crate) struct Hits {
    pub(crate) list: Vec<Hit>,
    /// Parts that hold with their faces, in order, each with its normal.
    faces: Vec<(u32, Vector)>,
    points: Distinct,
}

impl Hits {
    /// Puts hits of a part together and shows the few that hold a shape, whose middle is given, as
    /// all of them would.
    pub(crate) fn collect(&mut self, margin: f64, middle: Vector, visit: &mut dyn FnMut(u32, &Manifold<f64>)) {
        let Self { list, faces, points } = self;
        faces.clear();
        faces.extend(list.iter().filter(|hit| hit.beside.is_none()).map(|hit| (hit.part, hit.normal)));
        faces.sort_by_key(|(part, _)| *part);
        faces.dedup();
        let is_held = |hit: &Hit| {
            hit.beside.is_some_and(|beside| {
                beside.into_iter().any(|part| {
                    let from = faces.partition_point(|(other, _)| *other < part);
                    let of_part = faces[from..].iter().take(MAX_NORMALS).take_while(|(other, _)| *other == part);
                    of_part.into_iter().any(|(_, normal)| {
                        work::compared(1);
                        normal.dot(hit.normal) > SAME
                    })
                })
            })
        };
        list.retain(|hit| !is_held(hit));
        // Those of one part in the order of the triangles.
        list.sort_by_key(|hit| hit.part);
        for hits in list.chunk_by(|a, b| a.part == b.part) {
            points.clear();
            let (normal, mut carried) = (hits[0].normal, 0.0);
            for hit in hits {
                carried += hit.carried / hits.len() as f64;
                points.add(&hit.point);
            }
            let points = points.points.as_slice();
            let mut few = match points {
                [] => Points::none(),
                points => reduce(points, Cut::Second, normal, margin, &[middle]),
            };
            keep_nearest(&mut few, points, as_near(points, margin), normal);
            visit(hits[0].part, &Manifold::new(normal, carried, few));
        }
    }
}

/// Points at different places: of those that are one the first.
#[derive(Default)]
struct Distinct {
    points: Vec<ContactPoint<f64>>,
    /// Once there are many, the points in each cell of a grid as wide as those that are one are
    /// apart.
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Distinct {
    fn clear(&mut self) {
        self.points.clear();
        self.cells.clear();
    }

    fn add(&mut self, point: &ContactPoint<f64>) {
        let is_near = |other: &ContactPoint<f64>| {
            work::compared(1);
            let apart = other.position - point.position;
            apart.dot(apart) < ONE_POINT
        };
        let is_there = if self.points.len() < FEW {
            self.points.iter().any(is_near)
        } else {
            if self.cells.is_empty() {
                for (number, point) in (0..).zip(&self.points) {
                    self.cells.entry(cell(point)).or_default().push(number);
                }
            }
            let [x, y, z] = cell(point);
            let around = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
            let mut near = around.filter_map(|cell| self.cells.get(&cell)).flatten();
            near.any(|number| is_near(&self.points[*number as usize]))
        };
        if !is_there {
            if self.points.len() >= FEW {
                self.cells.entry(cell(point)).or_default().push(self.points.len() as u32);
            }
            self.points.push(*point);
        }
    }
}

fn cell(point: &ContactPoint<f64>) -> [i64; 3] {
    // Places further out than 2^61 of these cells share the last.
    let most = (1_i64 << 61) as f64;
    let p = point.position * (1.0 / ONE_POINT.sqrt());
    [p.x, p.y, p.z].map(|x| x.clamp(-most, most).floor() as i64)
}
