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
        let points = contact.rows().iter().map(|row| KeptPoint {
            feature: row.feature,
            place: contact.place_of(row),
            impulse: row.impulse,
        });
        Self {
            keys,
            points: points.collect(),
            sliding: contact.friction.linear(contact),
            turning: contact.friction.turning(contact),
        }
    }

    /// Gives the impulses to the same points of a new contact: those with the same feature, and then to each that has none the nearest.
    pub(super) fn hand_over(&self, contact: &mut Constraint) {
        let places: Vec<Vec3<Real>> = contact.rows().iter().map(|row| contact.place_of(row)).collect();
        let mut taken = vec![false; self.points.len()];
        let mut held = vec![false; places.len()];
        for (row, held) in contact.rows_mut().iter_mut().zip(&mut held) {
            let same = self.points.iter().zip(&mut taken).find(|(old, taken)| !**taken && old.feature == row.feature);
            if let Some((old, taken)) = same {
                row.impulse = old.impulse;
                (*taken, *held) = (true, true);
            }
        }
        for ((row, place), _) in contact.rows_mut().iter_mut().zip(places).zip(held).filter(|(_, held)| !held) {
            let mut nearest: Option<(usize, Real)> = None;
            for (index, old) in self.points.iter().enumerate().filter(|(index, _)| !taken[*index]) {
                let apart = old.place - place;
                let distance = apart.dot(apart);
                if distance <= SAME_PLACE * SAME_PLACE && nearest.is_none_or(|(_, least)| distance < least) {
                    nearest = Some((index, distance));
                }
            }
            if let Some((index, _)) = nearest {
                row.impulse = self.points[index].impulse;
                taken[index] = true;
            }
        }
        contact.hold_friction(self.sliding, self.turning);
    }
}
