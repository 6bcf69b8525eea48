//! Edges of a surface: which triangles meet in them, and whether they run along them in opposite
//! directions.

/// A side of a triangle, as an edge between two vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    low: u32,
    high: u32,
    /// Three times the triangle, plus the number of the corner it starts at.
    number: u32,
    /// Whether the triangle runs from `low` to `high`.
    forward: bool,
}

/// What lies across a side of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Across {
    /// Nothing.
    Hole,
    /// The one other triangle, and whether it runs along the edge the other way, as it should.
    Triangle { triangle: u32, agrees: bool },
    /// More than one; this is the next of them.
    Crowd { next: Option<u32> },
}

/// The edges of a surface.
#[derive(Clone, Debug)]
pub(crate) struct Edges {
    sides: Vec<Side>,
    /// For each side by its number, where it stands in `sides`.
    places: Vec<u32>,
    /// Edges with one triangle.
    pub(crate) open: usize,
    /// Edges with more than two triangles.
    pub(crate) overfull: usize,
    /// Edges along which their two triangles run the same way.
    pub(crate) reversed: usize,
}

impl Edges {
    pub(crate) fn of(triangles: &[[u32; 3]]) -> Self {
        let mut sides = Vec::with_capacity(3 * triangles.len());
        for (&[a, b, c], triangle) in triangles.iter().zip(0_u32..) {
            for ((from, to), corner) in [(a, b), (b, c), (c, a)].into_iter().zip(0..) {
                sides.push(Side {
                    low: from.min(to),
                    high: from.max(to),
                    number: 3 * triangle + corner,
                    forward: from < to,
                });
            }
        }
        sides.sort_unstable();
        let mut places = vec![0; sides.len()];
        for (side, place) in sides.iter().zip(0..) {
            places[side.number as usize] = place;
        }
        let (mut open, mut overfull, mut reversed) = (0, 0, 0);
        for edge in sides.chunk_by(same_edge) {
            match edge {
                [_] => open += 1,
                [a, b] => reversed += usize::from(a.forward == b.forward),
                _ => overfull += 1,
            }
        }
        Self { sides, places, open, overfull, reversed }
    }

    /// What lies across the side of a triangle that starts at the corner 0, 1 or 2.
    pub(crate) fn across(&self, triangle: u32, corner: u32) -> Across {
        let place = self.places[(3 * triangle + corner) as usize] as usize;
        let own = self.sides[place];
        let at =
            |place: Option<usize>| place.and_then(|place| self.sides.get(place)).filter(|side| same_edge(&own, side));
        let (before, after) = (at(place.checked_sub(1)), at(Some(place + 1)));
        let (other, further) = match (before, after) {
            (None, None) => return Across::Hole,
            (Some(_), Some(next)) => return Across::Crowd { next: Some(next.number / 3) },
            (Some(other), None) => (other, at(place.checked_sub(2))),
            (None, Some(other)) => (other, at(Some(place + 2))),
        };
        if further.is_some() {
            return Across::Crowd { next: after.map(|side| side.number / 3) };
        }
        Across::Triangle { triangle: other.number / 3, agrees: other.forward != own.forward }
    }
}

fn same_edge(a: &Side, b: &Side) -> bool {
    (a.low, a.high) == (b.low, b.high)
}
