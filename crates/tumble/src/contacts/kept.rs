use tumble_collide::MOST_POINTS;
use tumble_math::lane::Vec3;

use super::constraint::Constraint;
use crate::math::Real;
use crate::members::Key;

/// What is left of a contact for the next step: where its points were and what held the bodies there.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    /// Of both bodies, the lesser first.
    pub(super) keys: [Key; 2],
    points: Vec<KeptPoint>,
    /// Impulse of friction in a substep, world frame.
    sliding: Vec3<Real>,
    /// Angular impulse of what resists twisting and rolling, world frame.
    turning: Vec3<Real>,
}

#[derive(Clone, Copy, Debug)]
struct KeptPoint {
    feature: u32,
    /// From the first body's centre of mass \[m\].
    place: Vec3<Real>,
    impulse: Real,
}

/// Points that moved no further than this \[m\] are the same, whatever features meet there now.
const SAME_PLACE: Real = 0.01;

impl Kept {
    pub(super) fn of(keys: [Key; 2], contact: &Constraint) -> Self {
        let points = contact.rows().iter().enumerate().map(|(j, row)| KeptPoint {
            feature: row.feature,
            place: contact.place_of(j),
            impulse: row.impulse,
        });
        Self {
            keys,
            points: points.collect(),
            sliding: contact.friction.linear(contact),
            turning: contact.friction.turning(contact),
        }
    }

    /// Gives the impulses to the same points of a new contact. The same are those where nearly the same features meet nearly where they did, then
    /// what is there now whatever meets, then what slid on with its features. (Where an edge lies along another, features alone would
    /// not do: they cross anywhere along their length, from step to step.)
    pub(super) fn hand_over(&self, contact: &mut Constraint) {
        let places: [Vec3<Real>; MOST_POINTS] = std::array::from_fn(|j| contact.place_of(j));
        let (mut taken, mut held) = ([false; MOST_POINTS], [false; MOST_POINTS]);
        let distance = |old: &KeptPoint, j: usize| {
            let apart = old.place - places[j];
            apart.dot(apart)
        };
        type Same = fn(u32, u32, Real) -> bool;
        let ways: [Same; 3] = [
            |old, new, distance| old == new && distance <= SAME_PLACE * SAME_PLACE,
            |_, _, distance| distance <= SAME_PLACE * SAME_PLACE,
            |old, new, _| old == new,
        ];
        for same in ways {
            for (j, row) in contact.rows_mut().iter_mut().enumerate() {
                if held[j] {
                    continue;
                }
                let mut nearest: Option<(usize, Real)> = None;
                for (index, old) in self.points.iter().enumerate().filter(|(index, _)| !taken[*index]) {
                    let distance = distance(old, j);
                    if same(old.feature, row.feature, distance) && nearest.is_none_or(|(_, least)| distance < least) {
                        nearest = Some((index, distance));
                    }
                }
                if let Some((index, _)) = nearest {
                    row.impulse = self.points[index].impulse;
                    (taken[index], held[j]) = (true, true);
                }
            }
        }
        contact.hold_friction(self.sliding, self.turning);
    }
}
