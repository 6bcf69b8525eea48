//! Contacts of round shapes whose constraints are renewed in every substep.

use rayon::prelude::*;
use tumble_collide::{Isometry, MAX_MANIFOLD_POINTS, Manifold};
use tumble_math::lane::Vec3;

use crate::collision::contact::ContactRecord;
use crate::collision::crossed_axes::CrossedAxes;
use crate::collision::round_contact::RoundContact;
use crate::math::Real;
use crate::simd::block_lanes::{put, put_vector};
use crate::solver::body_rows::DeltaPose;
use crate::solver::contact::constraint::{Block, Rolling};
use crate::solver::contact::contact_frame::{ContactFrame, DeltaPoses, along_normal};
use crate::solver::contact::friction::FrictionImpulse;
use crate::solver::contact::line::Line;
use crate::solver::contact::prepare::MIN_WEIGHT;
use crate::solver::contact::update_geometry::tangents;
use crate::solver::solver_bodies::SolverRow;
use crate::threads::InParts;

/// A round contact among those of a group of the solver.
#[derive(Clone)]
pub(crate) struct RoundConstraint {
    contact: RoundContact,
    pub(crate) rows: [SolverRow; 2],
    /// Of the points in the middle of the contact.
    weights: [Real; MAX_MANIFOLD_POINTS],
}

/// Contacts found by one thread at a time.
const PART: usize = 32;
/// A point that is not there any more is this far away \[m\].
const FAR: Real = 1e6;

impl RoundConstraint {
    /// Of a contact between these rows, the number of which is one from `first` on.
    pub(crate) fn new(mut round: RoundContact, contact: &ContactRecord, rows: [SolverRow; 2], first: u32) -> Self {
        let nearest = (0..contact.count()).map(|j| contact.separation(j)).fold(Real::INFINITY, Real::min).max(0.0);
        let weights = std::array::from_fn(|j| {
            if j < contact.count() { point_weight((contact.separation(j) - nearest) / contact.margin()) } else { 0.0 }
        });
        round.contact += first;
        Self { contact: round, rows, weights }
    }

    /// Of capsules that cross.
    pub(crate) fn crossed_axes(&self) -> Option<&CrossedAxes> {
        self.contact.crossed_axes.as_ref()
    }

    /// Its number among the contacts.
    pub(crate) fn number(&self) -> u32 {
        self.contact.contact
    }
}

/// Weight in the middle of its contact of a point that is this many margins further than the
/// nearest, as [`Prepare`](crate::solver::contact::prepare::Prepare) has it.
pub(crate) fn point_weight(margins: Real) -> Real {
    (2.0 - margins).clamp(crate::math::real(MIN_WEIGHT), 1.0)
}

/// The manifolds now of the contacts with these numbers whose bodies have moved, about the second
/// body's centre of mass.
pub(crate) fn find(
    rounds: &[RoundConstraint],
    numbers: &[u32],
    delta_pose: &[DeltaPose],
) -> Vec<Option<Manifold<Real>>> {
    let mut found = vec![None; numbers.len()];
    let parts = numbers.par_chunks(PART).zip(found.par_chunks_mut(PART));
    parts.by_at_least(2).for_each(|(numbers, found)| {
        // The manifolds of bodies that touch in several parts are found once.
        let mut of_pair = Vec::new();
        let mut last: Option<(&RoundConstraint, bool)> = None;
        for (number, found) in numbers.iter().zip(found) {
            let round = &rounds[*number as usize];
            let known = last.filter(|(last, _)| last.rows == round.rows && last.contact.is_found_with(&round.contact));
            let has_moved = known.map_or_else(
                || {
                    of_pair.clear();
                    let deltas = round.rows.map(|row| delta_pose[row.index()]);
                    let has_turned = deltas.iter().any(|delta| delta.has_turned != 0.0);
                    let delta_poses =
                        deltas.map(|delta| Isometry { position: delta.translation, orientation: delta.rotation });
                    round.contact.find(delta_poses, has_turned, &mut of_pair)
                },
                |(_, has_moved)| has_moved,
            );
            last = Some((round, has_moved));
            *found = has_moved.then(|| round.contact.of_part(&of_pair));
        }
    });
    found
}

/// The lane of a block that a round contact is in.
pub(crate) struct RoundLane<'a, const P: usize, const C: usize> {
    pub(crate) block: &'a mut Block<P, C>,
    pub(crate) rolling: Option<&'a mut Rolling>,
    pub(crate) line: Option<&'a mut Line>,
    pub(crate) lane: usize,
}

/// Writes a manifold that was found over the contact in a lane of a block.
pub(crate) fn write<const P: usize, const C: usize>(
    manifold: &Manifold<Real>,
    RoundLane { block, rolling, line, lane }: RoundLane<'_, P, C>,
    (delta_pose, round): (&[DeltaPose], &RoundConstraint),
) {
    let (rows, has_non_dynamic) = (round.rows, round.contact.has_non_dynamic);
    let before = ContactFrame::<Real>::load(block, lane);
    let points = manifold.points();
    if points.is_empty() {
        for j in 0..P {
            block.start.separations[j][lane] = FAR;
        }
        return;
    }
    let normal = manifold.normal;
    let share = if has_non_dynamic { 1.0 } else { manifold.carried };
    let at = |k: usize| points[k].position + normal * (points[k].separation * (share - 0.5));
    let [s, t] = tangents::<Real>(normal);

    let old: [Vec3<Real>; P] = std::array::from_fn(|j| {
        let offset = &block.points[j].offset;
        before.arms[1] + before.tangents[0] * offset[0][lane] + before.tangents[1] * offset[1][lane]
    });
    let is_there = std::array::from_fn(|j| block.points[j].mass[lane] > 0.0);
    let places = places((0..points.len()).map(at), (&old, is_there));
    let now: [Vec3<Real>; P] = std::array::from_fn(|j| places[j].map_or(old[j], at));
    if let (Some(line), [_, _]) = (line, points) {
        let is_known = |j: &usize| places[*j].is_some() && is_there[*j];
        let mut known = (0..P).filter(is_known).map(|j| (old[j], now[j]));
        if let (Some(first), Some(second)) = (known.next(), known.next()) {
            line.turn[lane] = Line::turn_between(normal, second.0 - first.0, second.1 - first.1);
        }
    }
    // The middle is made of the points as it was when the step began: friction that jumped to
    // another would do there what it did here.
    let total: Real = round.weights[..P].iter().sum();
    let middle = (0..P).fold(Vec3::zero(), |sum, j| sum + now[j] * (round.weights[j] / total));
    put_vector(normal, &mut block.normal, lane);
    put_vector(s, &mut block.tangent, lane);
    put_vector(middle, &mut block.start.arm, lane);
    (block.start.carried[lane], block.start.slide[lane]) = (1.0, -1.0);
    let frame = ContactFrame { normal, tangents: [s, t], arms: before.arms };
    let friction = FrictionImpulse::load(&block.friction, rolling.as_deref(), lane);
    let friction = FrictionImpulse::from_world(&frame, friction.linear(&before), friction.angular(&before));
    friction.store(&mut block.friction, rolling, lane);

    let deltas = DeltaPoses::<Real>::new(rows.map(|row| delta_pose[row.index()]));
    let apart = Vec3::new(block.start.apart[0][lane], block.start.apart[1][lane], block.start.apart[2][lane]);
    let way = frame.normal_parts(&deltas.relative([middle + apart, middle], false));
    for (j, place) in places.into_iter().enumerate() {
        // A point that is not there any more still has the impulse that it gave.
        let from_middle = now[j] - middle;
        let offset = [s.dot(from_middle), t.dot(from_middle)];
        put(offset[0], &mut block.points[j].offset[0], lane);
        put(offset[1], &mut block.points[j].offset[1], lane);
        // The refresh adds what the bodies have moved since the step began.
        let way = along_normal(way, offset[0], offset[1]);
        block.start.separations[j][lane] = place.map_or(FAR, |k| points[k].separation - way);
        let mass = &mut block.points[j].mass[lane];
        *mass = if place.is_some() && *mass == 0.0 { 1.0 } else { *mass };
    }
}

/// By place the number of the point that is there now: of those that were there before the
/// nearest, or else a free place.
fn places<const P: usize>(
    points: impl Iterator<Item = Vec3<Real>>,
    (old, is_there): (&[Vec3<Real>; P], [bool; P]),
) -> [Option<usize>; P] {
    let mut places = [None; P];
    for (number, point) in points.enumerate() {
        let apart = |j: usize| (point - old[j]).dot(point - old[j]);
        let is_free = |j: &usize| places[*j].is_none() && is_there[*j];
        let nearest = (0..P).filter(is_free).min_by(|i, j| apart(*i).total_cmp(&apart(*j)));
        let place = nearest.or_else(|| (0..P).find(|j| places[*j].is_none()));
        if let Some(place) = place {
            places[place] = Some(number);
        }
    }
    places
}
