use super::material::{Material, Surface};

/// What only some surfaces do, and takes passes and numbers of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Extras {
    pub(super) rolls: bool,
    pub(super) bounces: bool,
}

impl Extras {
    /// Adds what a surface may do, whatever it touches.
    pub(super) fn add(&mut self, material: &Material) {
        self.rolls |= material.rolling_friction > 0.0;
        self.bounces |= material.restitution > 0.0;
    }
}

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

    /// What any of them may do. That of the contacts there are would change from step to step, and with it how those without are rounded.
    pub(super) fn extras(&self) -> Extras {
        let mut extras = Extras::default();
        self.different.iter().for_each(|material| extras.add(material));
        extras
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
