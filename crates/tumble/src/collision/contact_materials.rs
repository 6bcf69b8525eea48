//! The material table of a world's colliders, and the combined surface of each contact.

use crate::collision::collider::Collider;
use crate::collision::compound_parts::numbers;
use crate::collision::material::{Material, Surface};
use crate::math::Vec3;
use crate::storage::body_index::Slot;

/// What only some contacts need: rolling resistance, restitution, moving surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Extras {
    pub(crate) rolls: bool,
    pub(crate) bounces: bool,
    pub(crate) conveys: bool,
}

impl Extras {
    pub(crate) const ALL: Self = Self { rolls: true, bounces: true, conveys: true };

    /// Adds what a surface needs.
    pub(crate) fn add(&mut self, material: &Material) {
        self.rolls |= material.rolling_resistance > 0.0;
        self.bounces |= material.restitution > 0.0;
        self.conveys |= material.surface_velocity != Vec3::ZERO;
    }
}

/// The materials of all colliders, each once, and what two of them make together.
#[derive(Clone, Default)]
pub(crate) struct Materials {
    /// By slot, which; or [`OF_PARTS`] and which of the compounds.
    of_slots: Vec<u32>,
    /// Of the colliders whose parts have their own.
    compounds: Vec<Parts>,
    of_parts: Vec<OfPart>,
    /// By slot, how many numbers the parts of its shape have, as far as there are compounds.
    counts: Vec<u32>,
    different: Vec<Material>,
    /// By two of them, where there are not too many.
    surfaces: Vec<Surface>,
}

/// Which of the parts in the list are a collider's.
#[derive(Clone)]
struct Parts(std::ops::Range<usize>);

/// The first number after a part's, and which material it has.
#[derive(Clone, Copy)]
struct OfPart {
    end: u32,
    material: u32,
}

/// Marks slots whose parts have materials of their own.
const OF_PARTS: u32 = 1 << 31;

/// Of more materials the surfaces are not kept but worked out, and no two are compared but
/// neighbours.
const MAX: usize = 32;

impl Materials {
    /// Lists those of the colliders of all slots.
    pub(crate) fn list<'a>(&mut self, colliders: impl Iterator<Item = Option<&'a Collider>> + Clone) {
        self.of_slots.clear();
        self.different.clear();
        self.compounds.clear();
        self.of_parts.clear();
        for collider in colliders.clone() {
            let parts = collider.map_or(&[][..], Collider::surfaces);
            let which = if parts.is_empty() {
                self.which(collider.map(Collider::material).copied().unwrap_or_default())
            } else {
                let begin = self.of_parts.len();
                for part in parts {
                    let material = self.which(part.material);
                    self.of_parts.push(OfPart { end: part.end, material });
                }
                self.compounds.push(Parts(begin..self.of_parts.len()));
                OF_PARTS | (self.compounds.len() - 1) as u32
            };
            self.of_slots.push(which);
        }
        self.counts.clear();
        if !self.compounds.is_empty() {
            self.counts.extend(colliders.map(|collider| collider.map_or(1, |it| it.geometry().parts())));
        }
        self.surfaces.clear();
        if self.different.len() <= MAX {
            let pairs = self.different.iter().flat_map(|a| self.different.iter().map(move |b| Surface::between(a, b)));
            self.surfaces.extend(pairs);
        }
    }

    /// Which of the materials it is, a new one if it has to be.
    fn which(&mut self, material: Material) -> u32 {
        let known = if self.different.len() > MAX {
            self.different.last().filter(|last| **last == material).map(|_| self.different.len() - 1)
        } else {
            self.different.iter().rposition(|known| *known == material)
        };
        if known.is_none() {
            self.different.push(material);
        }
        known.unwrap_or(self.different.len() - 1) as u32
    }

    /// Those that any of the materials needs. Taken from the contacts they would change from step
    /// to step, and with them the rounding of other contacts.
    pub(crate) fn extras(&self) -> Extras {
        let mut extras = Extras::default();
        self.different.iter().for_each(|material| extras.add(material));
        extras
    }

    /// The combined surface of two slots' colliders in the contact of this number.
    pub(crate) fn between(&self, slots: [Slot; 2], pair: u32) -> Surface {
        let [a, b] = self.both(slots, pair);
        match self.surfaces.get(a * self.different.len() + b) {
            Some(surface) => *surface,
            None => Surface::between(&self.different[a], &self.different[b]),
        }
    }

    /// The velocities of both surfaces, in the frames of their colliders \[m/s\].
    pub(crate) fn surface_velocities(&self, slots: [Slot; 2], pair: u32) -> [Vec3; 2] {
        self.both(slots, pair).map(|which| self.different[which].surface_velocity)
    }

    /// Which materials two colliders have in the contact of this number.
    fn both(&self, slots: [Slot; 2], pair: u32) -> [usize; 2] {
        let [mut a, mut b] = slots.map(|slot| self.of_slots[slot.index()]);
        if (a | b) & OF_PARTS != 0 {
            let of_second = self.counts.get(slots[1].index()).copied().unwrap_or(1);
            let [on_first, on_second] = numbers(pair, of_second);
            (a, b) = (self.of_part(a, on_first), self.of_part(b, on_second));
        }
        [a, b].map(|which| which as usize)
    }

    /// Which material the part of a number has.
    fn of_part(&self, which: u32, number: u32) -> u32 {
        if which & OF_PARTS == 0 {
            return which;
        }
        let Parts(range) = &self.compounds[(which & !OF_PARTS) as usize];
        let parts = &self.of_parts[range.clone()];
        let part = parts.partition_point(|part| part.end <= number).min(parts.len() - 1);
        parts[part].material
    }
}
