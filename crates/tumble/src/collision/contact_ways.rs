//! Which contacts are of bodies that may miss each other, or that meet with another normal.

use tumble_math::lane::Vec3;

use crate::collision::collider_state::{ColliderState, Motion};
use crate::collision::contact::ContactRecord;
use crate::math::Real;

/// A body that passes another by more than this many margins of the smaller in a step is traced
/// even where it is nearer than the margin.
const FAST: Real = 4.0;
/// A normal that turns by less \[rad\] is the same, ...
pub(crate) const SAME_NORMAL: f64 = 1e-2;
/// ... and this of two free balls near others: where those are followed, they lose bounce.
const SAME_NORMAL_OF_FREE_BALLS: f64 = 0.1;

/// How a contact is treated, by the paths of its two bodies.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// Their contact is as it was found.
    Plain,
    /// They get through the plane of their contact, that is further than the margin or passed fast.
    Doubtful,
    /// Free balls whose line of centres turns little: they are followed where they meet nothing
    /// else that is free.
    Free,
    /// Balls that pass each other.
    Passed,
}

impl Way {
    pub(crate) fn of(contact: &ContactRecord, states: [&ColliderState; 2], fall: Real) -> Self {
        let gap = nearest(contact);
        let is_doubtful = gap > 0.0 && is_doubtful(contact, gap, states, fall);
        match (is_doubtful, contact.is_between_centers()) {
            (false, _) => Self::Plain,
            (true, false) => Self::Doubtful,
            (true, true) if balls_pass(contact, gap, states, fall) => Self::Passed,
            (true, true) => {
                let are_both_free = states.into_iter().all(|state| state.is_dynamic);
                match turn_of_balls(contact, gap, states) {
                    turn if are_both_free && turn <= SAME_NORMAL_OF_FREE_BALLS => Self::Free,
                    turn if !are_both_free && turn <= SAME_NORMAL => Self::Plain,
                    _ => Self::Doubtful,
                }
            }
        }
    }
}

/// The least separation of a contact \[m\].
pub(crate) fn nearest(contact: &ContactRecord) -> Real {
    (0..contact.count()).fold(Real::INFINITY, |least, j| least.min(contact.separation(j)))
}

/// Of a vector.
pub(crate) fn length(v: Vec3<Real>) -> Real {
    v.dot(v).sqrt()
}

/// The margin of the smaller of two bodies, beside which that of the other would be far.
pub(crate) fn least_margin(states: [&ColliderState; 2]) -> Real {
    let dynamic = states.into_iter().filter(|state| state.is_dynamic);
    dynamic.map(|state| state.margin).reduce(Real::min).unwrap_or(0.0)
}

/// Whether two bodies get through the plane of their contact, that is further than the margin or
/// passed fast.
fn is_doubtful(contact: &ContactRecord, gap: Real, states: [&ColliderState; 2], fall: Real) -> bool {
    let normal = contact.geometry.normal;
    let [Motion { way: a, turn: s, .. }, Motion { way: b, turn: t, .. }] = states.map(|state| state.motion);
    let way = b - a;
    let swing = states.map(|state| {
        let Motion { turn, axis_turn, radius, .. } = state.motion;
        let turned = length(normal.cross(turn));
        let turned = axis_turn.map_or(turned, |axis_turn| axis_turn.min(turned));
        if turned > 0.0 { turned * radius } else { 0.0 }
    });
    let (margin, least) = (contact.margin(), least_margin(states));
    // The plane turns with the bodies.
    let tilt = (length(s) + length(t)) * (gap + length(way));
    let through = gap + normal.dot(way) - swing[0] - swing[1] - tilt < fall;
    through && (gap > margin || length(way) + swing[0] + swing[1] > FAST * least)
}

/// Whether a contact that is found again in each substep, of this part of the step, is where bodies
/// meet then, with surfaces of these radii \[m\]: its plane is beside them by less than a margin.
pub(crate) fn stays_round(
    contact: &ContactRecord,
    states: [&ColliderState; 2],
    substep: Real,
    radii: [Real; 2],
) -> bool {
    let [Motion { way: a, turn: s, radius: r, .. }, Motion { way: b, turn: t, radius: q, .. }] =
        states.map(|state| state.motion);
    let way = (length(b - a) + length(s) * r + length(t) * q) * substep;
    contact.is_refined() && way * way < 2.0 * (radii[0] + radii[1]) * least_margin(states)
}

/// Whether two balls stay further apart than the margin on their ways, which for balls are lines.
fn balls_pass(contact: &ContactRecord, gap: Real, [first, second]: [&ColliderState; 2], fall: Real) -> bool {
    let apart = second.center - first.center;
    let way = second.motion.way - first.motion.way;
    let moment = (-apart.dot(way) / way.dot(way)).clamp(0.0, 1.0);
    let radii = length(apart) - gap;
    length(apart + way * moment) - radii > contact.margin() + fall
}

/// By how much the line between the centres of two balls turns on their ways, about \[rad\].
fn turn_of_balls(contact: &ContactRecord, gap: Real, [first, second]: [&ColliderState; 2]) -> f64 {
    let way = second.motion.way - first.motion.way;
    let across = length(contact.geometry.normal.cross(way));
    let radii = length(second.center - first.center) - gap;
    f64::from(across) / f64::from(radii)
}
