//! Contacts of round shapes, found again where their bodies have moved to within a step.

use rayon::prelude::*;
use tumble_collide::{ColliderShape, Isometry, MAX_MANIFOLD_POINTS, Manifold, contact_manifolds};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::find_contacts::Contacts;
use crate::math::Real;
use crate::simd::block_lanes::{put, put_vector};
use crate::simd::{BLOCK, Eight};
use crate::solver::contact::constraint::{Block, Rolling};
use crate::solver::contact::contact_frame::{ContactFrame, DeltaPoses, along_normal};
use crate::solver::contact::friction::FrictionImpulse;
use crate::solver::contact::prepare::MIN_WEIGHT;
use crate::solver::contact::update_geometry::tangents;
use crate::solver::solver_bodies::SolverBodies;
use crate::threads::InParts;

/// A contact of which a shape is round. Lengths are from the second body's centre of mass when the
/// step began.
#[derive(Clone)]
pub(crate) struct RoundContact {
    /// Its number among the contacts.
    pub(crate) contact: u32,
    pub(crate) rows: [u32; 2],
    part: u32,
    geometries: [ColliderShape<Real>; 2],
    placements: [Isometry<Real>; 2],
    /// What the middle of the contact is made of.
    weights: [Real; MAX_MANIFOLD_POINTS],
    /// Whether impulses move the second body alone.
    pub(crate) alone: bool,
    /// The first body's centre of mass.
    apart: Vec3<Real>,
    /// How near surfaces are a contact \[m\].
    margin: Real,
}

/// Contacts found by one thread at a time.
const PART: usize = 32;
/// A point that is not there any more is this far away \[m\].
const FAR: Real = 1e6;
/// Least inverse moment over the greatest of a body whose contacts are found again. A needle that
/// spins turns over between substeps, and impulses that are taken back at other places than they
/// were given heat it up.
const MIN_RATIO: Real = 1.0 / 400.0;
/// A pair that has moved by less than this part of its margin is where it was.
const STILL: Real = 1e-3;

impl Contacts {
    /// Adds the round contacts, with numbers from `first` on.
    pub(crate) fn add_round_contacts(&self, first: usize, rounds: &mut Vec<RoundContact>) {
        for (index, contact) in self.contacts.iter().enumerate().filter(|(_, contact)| contact.is_refined()) {
            let shapes = contact.slots.map(|slot| &self.shapes[slot as usize]);
            let colliders = contact.slots.map(|slot| self.colliders[slot as usize].as_ref());
            let [Some((a, _)), Some((b, _))] = colliders else { continue };
            let origin = shapes[1].center;
            let nearest = (0..contact.count()).map(|j| contact.separation(j)).fold(Real::INFINITY, Real::min).max(0.0);
            let placements = shapes.map(|shape| Isometry {
                position: shape.placement.position - origin,
                orientation: shape.placement.orientation,
            });
            rounds.push(RoundContact {
                contact: (first + index) as u32,
                rows: self.rows_of(contact),
                part: contact.part,
                geometries: [a.geometry.clone(), b.geometry.clone()],
                placements,
                weights: std::array::from_fn(|j| {
                    if j < contact.count() { weight((contact.separation(j) - nearest) / contact.margin()) } else { 0.0 }
                }),
                alone: !shapes[0].moves,
                apart: shapes[0].center - origin,
                margin: shapes[0].reach + shapes[1].reach,
            });
        }
    }
}

/// Weight in the middle of its contact of a point that is this many margins further than the
/// nearest, as [`Prepare`](crate::solver::contact::prepare::Prepare) has it.
fn weight(margins: Real) -> Real {
    (2.0 - margins).clamp(crate::math::real(MIN_WEIGHT), 1.0)
}

/// What has become of the contacts, if their bodies have moved: manifolds about the second body's
/// centre of mass as it is now.
pub(crate) fn find(rounds: &[RoundContact], delta_pose: &[Eight]) -> Vec<Option<Manifold<Real>>> {
    let mut found = vec![None; rounds.len()];
    let parts = rounds.par_chunks(PART).zip(found.par_chunks_mut(PART));
    parts.by_at_least(2).for_each(|(rounds, found)| {
        rounds.iter().zip(found).for_each(|(round, found)| *found = round.find(delta_pose));
    });
    found
}

/// Leaves out the contacts of needles: these stay as they were found.
pub(crate) fn drop_needles(rounds: &mut Vec<RoundContact>, bodies: &SolverBodies) {
    rounds.retain(|round| round.rows.iter().all(|row| bodies.inertia_ratio(*row) >= MIN_RATIO));
}

impl RoundContact {
    fn find(&self, delta_pose: &[Eight]) -> Option<Manifold<Real>> {
        let [first, second] = self.rows.map(|row| &delta_pose[row as usize].0);
        let slid = Vec3::new(first[0] - second[0], first[1] - second[1], first[2] - second[2]);
        let still = STILL * self.margin;
        if first[7] + second[7] == 0.0 && slid.dot(slid) < still * still {
            return None;
        }

        let turn = |row: &[Real; 8]| Quat { x: row[3], y: row[4], z: row[5], w: row[6] };
        let [a, b] = &self.placements;
        let (p, q) = (turn(first), turn(second));
        let first_at = Isometry {
            position: self.apart + slid + p.rotate(a.position - self.apart),
            orientation: p * a.orientation,
        };
        let second_at = Isometry { position: q.rotate(b.position), orientation: q * b.orientation };
        let mut found = Manifold::none();
        let [one, other] = &self.geometries;
        contact_manifolds(one, &first_at, other, &second_at, self.margin, &mut |part, manifold| {
            if part == self.part {
                found = *manifold;
            }
        });
        Some(found)
    }
}

/// Writes a manifold that was found over the contact in a lane of a block.
pub(crate) fn write<const P: usize, const C: usize>(
    manifold: &Manifold<Real>,
    (block, rolling, lane): (&mut Block<P, C>, Option<&mut Rolling>, usize),
    (delta_pose, round): (&[Eight], &RoundContact),
) {
    let (rows, alone) = (round.rows, round.alone);
    let before = ContactFrame::<Real>::load(block, lane);
    let points = manifold.points();
    if points.is_empty() {
        for j in 0..P {
            block.start.separations[j][lane] = FAR;
        }
        return;
    }
    let normal = manifold.normal;
    let share = if alone { 1.0 } else { manifold.carried };
    let at = |k: usize| points[k].position + normal * (points[k].separation * (share - 0.5));
    let [s, t] = tangents::<Real>(normal);

    let old: [Vec3<Real>; P] = std::array::from_fn(|j| {
        let offset = &block.points[j].offset;
        before.arms[1] + before.tangents[0] * offset[0][lane] + before.tangents[1] * offset[1][lane]
    });
    // Which place each point has: that of the nearest that there was, or a free one.
    let mut places = [None; P];
    for k in 0..points.len() {
        let apart = |j: usize| (at(k) - old[j]).dot(at(k) - old[j]);
        let is_there = |j: &usize| places[*j].is_none() && block.points[*j].mass[lane] > 0.0;
        let nearest = (0..P).filter(is_there).min_by(|i, j| apart(*i).total_cmp(&apart(*j)));
        let place = nearest.or_else(|| (0..P).find(|j| places[*j].is_none()));
        if let Some(place) = place {
            places[place] = Some(k);
        }
    }
    let now: [Vec3<Real>; P] = std::array::from_fn(|j| places[j].map_or(old[j], at));
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

    let rows = rows.map(|row| [row; BLOCK]);
    let apart = Vec3::new(block.start.apart[0][lane], block.start.apart[1][lane], block.start.apart[2][lane]);
    let way = frame.normal_parts(&DeltaPoses::<Real>::load(delta_pose, &rows, 0).relative([middle + apart, middle]));
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
