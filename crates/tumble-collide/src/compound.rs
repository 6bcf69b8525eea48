//! Compound shapes: a flat list of placed shapes with numbered parts.

use crate::collider_shape::{ColliderShape, Isometry};
use crate::scalar::Scalar;
use crate::support_map::{Vector, wide};

/// A shape, and where it is in its compound.
type Part<R> = (Isometry<R>, ColliderShape<R>);

/// Shapes fixed to each other, made to be touched: each at a place in the compound's frame.
///
/// ```
/// use tumble_collide::{ColliderShape, Compound, Isometry};
/// use tumble_math::lane::Vec3;
///
/// let sphere =
///     |x: f64| (Isometry::at(Vec3::new(x, 0.0, 0.0)), ColliderShape::Sphere { radius: 0.5 });
/// let dumbbell = Compound::new([sphere(-1.0), sphere(1.0)]);
/// assert_eq!(dumbbell.parts().len(), 2);
/// assert_eq!(dumbbell.reach(), Some(1.5));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Compound<R> {
    parts: Vec<Part<R>>,
    /// Of each part, the first of the numbers that its own parts have.
    numbers: Vec<u32>,
}

impl<R: Scalar> Compound<R> {
    /// From its parts; the parts of a compound among them become parts of this one.
    pub fn new(parts: impl IntoIterator<Item = (Isometry<R>, ColliderShape<R>)>) -> Self {
        let mut this = Self { parts: Vec::new(), numbers: Vec::new() };
        let mut next = 0_u32;
        for (at, shape) in parts {
            let inner = match &shape {
                ColliderShape::Compound(compound) => {
                    compound.parts.iter().map(|(inner, part)| (at.then(inner), part.clone())).collect()
                }
                _ => vec![(at, shape)],
            };
            for part in inner {
                this.numbers.push(next);
                next = next.saturating_add(part.1.parts());
                this.parts.push(part);
            }
        }
        this
    }

    /// Its parts, none of them a compound.
    #[must_use]
    pub fn parts(&self) -> &[(Isometry<R>, ColliderShape<R>)] {
        &self.parts
    }

    /// Each part with its place in the world and the first of its numbers.
    pub(crate) fn placed(&self, at: &Isometry<R>) -> impl Iterator<Item = (u32, Isometry<R>, &ColliderShape<R>)> {
        self.parts.iter().zip(&self.numbers).map(|((inner, part), number)| (*number, at.then(inner), part))
    }

    pub(crate) fn has_round_part(&self) -> bool {
        self.parts.iter().any(|(_, part)| part.is_round())
    }

    /// The part that has a number, and the first of the numbers that it has.
    pub(crate) fn part_of(&self, number: u32) -> Option<(u32, &Part<R>)> {
        let place = self.numbers.partition_point(|first| *first <= number).checked_sub(1)?;
        self.numbers.get(place).copied().zip(self.parts.get(place))
    }

    /// The first of the numbers of a part, by its place in the list; zero where there is none.
    #[must_use]
    pub fn number_of(&self, part: usize) -> u32 {
        self.numbers.get(part).copied().unwrap_or(0)
    }

    /// How many numbers its parts have.
    pub(crate) fn count(&self) -> u32 {
        let last = self.parts.last().zip(self.numbers.last());
        last.map_or(0, |((_, part), number)| number.saturating_add(part.parts()))
    }

    /// The longest distance of a point of it from its origin \[m\], or somewhat more; `None` if a
    /// part has no end.
    #[must_use]
    pub fn reach(&self) -> Option<R> {
        let mut most = R::splat(0.0);
        for (at, part) in &self.parts {
            let place: Vector = wide(at.position);
            most = most.max(R::splat(place.dot(place).sqrt()) + part.reach()?);
        }
        Some(most)
    }
}
