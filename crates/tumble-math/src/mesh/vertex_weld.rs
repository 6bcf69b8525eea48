//! Vertices at the same place, or nearly so.

use std::cmp::Ordering;
use std::collections::HashMap;

use glam::DVec3;

/// Cells of the grid are this many times the distance of near-duplicates wide: wide enough that few
/// vertices are so close to the side of their cell that others must be searched.
const CELL: f64 = 4.0;

/// For each vertex the first one at exactly the same place (`-0.0` is `0.0`).
pub(crate) fn first_at_same_place(positions: &[DVec3]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    let at = |vertex: u32| positions[vertex as usize];
    order.sort_unstable_by(|a, b| compared(at(*a), at(*b)).then(a.cmp(b)));
    let mut first = vec![0; positions.len()];
    let mut current = None;
    for vertex in order {
        let same = current.filter(|earlier| at(*earlier) == at(vertex));
        let representative = same.unwrap_or(vertex);
        first[vertex as usize] = representative;
        current = Some(representative);
    }
    first
}

fn compared(a: DVec3, b: DVec3) -> Ordering {
    // Adding zero makes -0.0 positive, so that this order agrees with `==`.
    let (a, b) = (a + DVec3::ZERO, b + DVec3::ZERO);
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}

/// For each vertex in use one that stays, itself or an earlier one closer than `distance`. Vertices
/// go in the order of their indices, and those that stay are further apart than `distance`; so a
/// chain of close vertices does not collapse into one, and however many vertices there are in a
/// cell, few of them stay.
///
/// `first` is what [`first_at_same_place`] gave; vertices that are not in use stay what they are
/// there.
pub(crate) fn first_nearby(positions: &[DVec3], first: &[u32], used: &[bool], distance: f64) -> Vec<u32> {
    let mut near = first.to_vec();
    let low = positions.iter().zip(used).filter(|(_, used)| **used).fold(DVec3::INFINITY, |low, (p, _)| low.min(*p));
    if distance <= 0.0 {
        return near;
    }
    let mut kept = Kept { positions, distance, low, newest: HashMap::new(), older: vec![None; positions.len()] };
    for vertex in 0..positions.len() as u32 {
        let index = vertex as usize;
        if !used[index] {
            continue;
        }
        near[index] = match first[index] {
            earlier if earlier != vertex => near[earlier as usize],
            _ => kept.near(vertex).unwrap_or_else(|| kept.keep(vertex)),
        };
    }
    near
}

/// The vertices that stay, in a grid; those of one cell are a linked list.
struct Kept<'a> {
    positions: &'a [DVec3],
    distance: f64,
    low: DVec3,
    newest: HashMap<[i64; 3], u32>,
    older: Vec<Option<u32>>,
}

impl Kept<'_> {
    /// In cells. The lowest vertex is in the middle of its cell, as meshes like to have sides
    /// there.
    fn scaled(&self, vertex: u32) -> [f64; 3] {
        let offset = self.positions[vertex as usize] - self.low;
        (offset / (CELL * self.distance) + DVec3::splat(0.5)).to_array()
    }

    fn keep(&mut self, vertex: u32) -> u32 {
        let cell = self.scaled(vertex).map(|x| x.floor() as i64);
        self.older[vertex as usize] = self.newest.insert(cell, vertex);
        vertex
    }

    /// The earliest vertex that stays and is closer than the distance.
    fn near(&self, vertex: u32) -> Option<u32> {
        let scaled = self.scaled(vertex);
        let margin = 1.0 / CELL;
        let low = scaled.map(|x| (x - margin).floor() as i64);
        let high = scaled.map(|x| (x + margin).floor() as i64);
        let mut nearest = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    nearest = earlier(nearest, self.near_in([x, y, z], self.positions[vertex as usize]));
                }
            }
        }
        nearest
    }

    fn near_in(&self, cell: [i64; 3], position: DVec3) -> Option<u32> {
        let mut found = None;
        let mut next = self.newest.get(&cell).copied();
        while let Some(kept) = next {
            if (self.positions[kept as usize] - position).length() < self.distance {
                found = Some(kept); // the list goes from new to old: the last one found is the earliest
            }
            next = self.older[kept as usize];
        }
        found
    }
}

fn earlier(a: Option<u32>, b: Option<u32>) -> Option<u32> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}
