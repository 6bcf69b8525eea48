use super::material::{Material, Surface};

/// The materials of all colliders, each once, and what two of them make together.
#[derive(Clone, Default)]
pub(super) struct Materials {
    /// By slot, which.
    of_slots: Vec<u32>,
    different: Vec<Material>,
    /// By two of them, where there are not too many.
    surfaces: Vec<Surface>,
}

/// Of more materials the surfaces are not kept but worked out, and no two are compared but neighbours.
const MOST: usize = 32;

impl Materials {
    /// Lists those of the colliders of all slots.
    pub(super) fn list<'a>(&mut self, colliders: impl Iterator<Item = Option<&'a Material>>) {
        self.of_slots.clear();
        self.different.clear();
        for material in colliders {
            let material = material.copied().unwrap_or_default();
            let known = if self.different.len() > MOST {
                self.different.last().filter(|last| **last == material).map(|_| self.different.len() - 1)
            } else {
                self.different.iter().rposition(|known| *known == material)
            };
            self.of_slots.push(known.unwrap_or(self.different.len()) as u32);
            if known.is_none() {
                self.different.push(material);
            }
        }
        self.surfaces.clear();
        if self.different.len() <= MOST {
            let pairs = self.different.iter().flat_map(|a| self.different.iter().map(move |b| Surface::between(a, b)));
            self.surfaces.extend(pairs);
        }
    }

    /// What the surfaces of two slots' colliders are like where they touch.
    pub(super) fn between(&self, [first, second]: [u32; 2]) -> Surface {
        let [a, b] = [first, second].map(|slot| self.of_slots[slot as usize] as usize);
        match self.surfaces.get(a * self.different.len() + b) {
            Some(surface) => *surface,
            None => Surface::between(&self.different[a], &self.different[b]),
        }
    }
}
