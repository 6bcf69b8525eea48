//! The persistent contact record: points, surface values, and impulses for the warm start.

use tumble_collide::{MAX_MANIFOLD_POINTS, Manifold};
use tumble_math::lane::Vec3;

use crate::collision::material::Surface;
use crate::collision::narrow_phase::LaneKind;
use crate::math::Real;
use crate::simd::Eight;
use crate::storage::body_index::Slot;

/// Two bodies that touch: where, and what held them there. What is kept from step to step.
///
/// The numbers lie as the solver reads them, eight at a time.
#[derive(Clone, Debug)]
pub(crate) struct ContactRecord {
    /// Slots of the bodies; where impulses move only one, it is the second.
    pub(crate) slots: [Slot; 2],
    /// Of the shapes.
    pub(crate) kind: LaneKind,
    /// Which of the contacts of the two.
    pub(crate) part: u32,
    /// Whether the two touched before this step.
    pub(crate) touched: bool,
    pub(crate) features: [u32; MAX_MANIFOLD_POINTS],
    /// By [`SHAPE`] and the others.
    pub(crate) numbers: [Eight; 5],
}

/// The second body of a contact.
#[derive(Clone, Copy)]
pub(crate) struct Second {
    /// Its centre of mass \[m\].
    pub(crate) center: Vec3<Real>,
    /// Whether impulses move it alone.
    pub(crate) alone: bool,
    /// How near its surface and the other are a contact \[m\].
    pub(crate) margin: Real,
}

impl Second {
    /// Which share of the gap between the surfaces is before a point: none of it where the second
    /// alone is moved, so that what is thin has the arms that it has however deep it is in what
    /// does not move.
    fn share(&self, carried: Real) -> Real {
        if self.alone { 1.0 } else { carried }
    }
}

/// Normal from the first to the second, how far points go along with the second, how many points
/// there are, resistance to rolling, restitution, and how the geometry follows the bodies in a
/// step.
pub(crate) const SHAPE: usize = 0;
/// Two points each: from the second body's centre of mass when the step began, and the separation
/// there. They are on the surface of the body that carries them, so that friction has the arm that
/// it has when they meet.
pub(crate) const POINTS: [usize; MAX_MANIFOLD_POINTS / 2] = [1, 2];
/// Impulses of a substep along the normal \[N s\], the coefficients of static and dynamic friction,
/// how steady effective masses were in the last substep, and which share of the gap between the
/// surfaces is before the points.
pub(crate) const NORMAL_IMPULSE: usize = 3;
/// Most halvings of the substeps of a contact.
pub(crate) const MAX_HALVINGS: u8 = 6;
/// No impulses.
const NEW: Eight = Eight([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
/// Impulse of friction \[N s\] and angular impulse of what resists twisting and rolling [N m s], of
/// a substep, world frame; how near the surfaces are a contact \[m\], but for how fast they come;
/// and how often the substeps of its island were halved.
pub(crate) const FRICTION_IMPULSE: usize = 4;

/// Points and normals are fixed to the bodies.
pub(crate) const MATERIAL: f64 = 0.0;
/// Of balls: the normal is along the line of the centres of mass.
pub(crate) const CENTERS: f64 = 1.0;
/// Of a ball about its centre of mass on a plane that does not turn: nothing changes.
pub(crate) const FIXED: f64 = 3.0;
/// What is round and rolls: found again in each substep.
pub(crate) const REFINED: f64 = 2.0;

/// Points that moved no further than this part of the margin are the same, whatever features meet
/// there now.
const SAME_PLACE: Real = 0.5;

impl ContactRecord {
    /// Of nobody.
    pub(crate) const NONE: Self = Self {
        kind: LaneKind::Other,
        part: 0,
        touched: false,
        slots: [Slot(0); 2],
        features: [0; MAX_MANIFOLD_POINTS],
        numbers: [Eight::ZERO; 5],
    };

    /// Of a manifold with points, whose normal goes from the first slot to the second; `second` is
    /// its second body.
    pub(crate) fn new(slots: [Slot; 2], part: u32, manifold: &Manifold<Real>, second: Second, law: f64) -> Self {
        let (n, count) = (manifold.normal, manifold.points().len());
        let mut numbers = [Eight::ZERO; 5];
        let mut features = [0; MAX_MANIFOLD_POINTS];
        for (j, point) in manifold.points().iter().enumerate() {
            let from_second =
                point.position - second.center + n * (point.separation * (second.share(manifold.carried) - 0.5));
            let place = [from_second.x, from_second.y, from_second.z, point.separation];
            numbers[POINTS[j / 2]].0[j % 2 * 4..][..4].copy_from_slice(&place);
            features[j] = point.feature;
        }
        numbers[NORMAL_IMPULSE] = NEW;
        numbers[NORMAL_IMPULSE].0[7] = second.share(manifold.carried);
        numbers[FRICTION_IMPULSE].0[6] = second.margin;
        numbers[SHAPE] = Eight([n.x, n.y, n.z, manifold.carried, count as Real, 0.0, 0.0, crate::math::real(law)]);
        Self { kind: LaneKind::Other, slots, part, touched: false, features, numbers }
    }

    /// Makes it the only contact of two shapes, without impulses.
    pub(crate) fn begin(&mut self, kind: LaneKind) {
        (self.kind, self.part, self.touched) = (kind, 0, false);
        let ([.., share], margin) = (self.numbers[NORMAL_IMPULSE].0, self.margin());
        (self.numbers[NORMAL_IMPULSE], self.numbers[FRICTION_IMPULSE]) = (NEW, Eight::ZERO);
        (self.numbers[NORMAL_IMPULSE].0[7], self.numbers[FRICTION_IMPULSE].0[6]) = (share, margin);
    }

    /// Says what the surfaces are like.
    pub(crate) fn set_surface(&mut self, surface: &Surface) {
        (self.numbers[SHAPE].0[5], self.numbers[SHAPE].0[6]) = (surface.rolling_resistance, surface.restitution);
        (self.numbers[NORMAL_IMPULSE].0[4], self.numbers[NORMAL_IMPULSE].0[5]) =
            (surface.static_friction, surface.dynamic_friction);
    }

    /// What contacts are in the order of: the kind of the shapes, both slots, the lower first, and
    /// the part.
    pub(crate) fn key(&self) -> (LaneKind, Slot, Slot, u32) {
        let [a, b] = self.slots;
        (self.kind, a.min(b), a.max(b), self.part)
    }

    /// Whether it is found again in each substep.
    pub(crate) fn is_refined(&self) -> bool {
        f64::from(self.numbers[SHAPE].0[7]) == REFINED
    }

    /// Whether its points are fixed to the bodies, as between flat faces.
    pub(crate) fn is_material(&self) -> bool {
        f64::from(self.numbers[SHAPE].0[7]) == MATERIAL
    }

    /// Multiplies the impulses that it begins with.
    pub(crate) fn scale_impulses(&mut self, by: Real) {
        self.numbers[NORMAL_IMPULSE].0[..MAX_MANIFOLD_POINTS].iter_mut().for_each(|impulse| *impulse *= by);
        self.numbers[FRICTION_IMPULSE].0[..6].iter_mut().for_each(|impulse| *impulse *= by);
    }

    /// Whether it is that of balls about their centres of mass.
    pub(crate) fn is_between_centers(&self) -> bool {
        f64::from(self.numbers[SHAPE].0[7]) == CENTERS
    }

    /// Leaves what is found again in each substep as it is.
    pub(crate) fn hold_still(&mut self) {
        if self.is_refined() {
            self.numbers[SHAPE].0[7] = crate::math::real(FIXED);
        }
    }

    /// How many points.
    pub(crate) fn count(&self) -> usize {
        self.numbers[SHAPE].0[4] as usize
    }

    /// Half-way between the surfaces at a point, from the second body's centre of mass.
    pub(crate) fn half_way(&self, j: usize) -> Vec3<Real> {
        let ([x, y, z, ..], [.., share]) = (self.numbers[SHAPE].0, self.numbers[NORMAL_IMPULSE].0);
        self.place(j) - Vec3::new(x, y, z) * (self.separation(j) * (share - 0.5))
    }

    /// How often the substeps of its island were halved in the last step.
    pub(crate) fn halvings(&self) -> u8 {
        self.numbers[FRICTION_IMPULSE].0[7] as u8
    }

    pub(crate) fn set_halvings(&mut self, times: u8) {
        self.numbers[FRICTION_IMPULSE].0[7] = Real::from(times);
    }

    /// How near the surfaces are a contact \[m\], but for how fast they come: a length that goes
    /// with the bodies' sizes.
    pub(crate) fn margin(&self) -> Real {
        self.numbers[FRICTION_IMPULSE].0[6]
    }

    /// Separation at a point \[m\].
    pub(crate) fn separation(&self, j: usize) -> Real {
        self.numbers[POINTS[j / 2]].0[j % 2 * 4 + 3]
    }

    pub(crate) fn place(&self, j: usize) -> Vec3<Real> {
        let [x, y, z, ..] = self.numbers[POINTS[j / 2]].0[j % 2 * 4..] else { return Vec3::zero() };
        Vec3::new(x, y, z)
    }

    /// Begins with the impulses of the same contact in the last step, point by point. The same are
    /// points where nearly the same features meet nearly where they did, then what is there now
    /// whatever meets, then what slid on with its features. (Where an edge lies along another,
    /// features alone would not do: they cross anywhere along their length, from step to step.)
    pub(crate) fn take_impulses_of(&mut self, old: &Self) {
        self.touched = old.touches();
        if self.slots != old.slots {
            return;
        }
        self.numbers[FRICTION_IMPULSE].0[..6].copy_from_slice(&old.numbers[FRICTION_IMPULSE].0[..6]);
        let (count, old_count) = (self.count(), old.count());
        let near = |j: usize, i: usize| {
            let apart = self.place(j) - old.place(i);
            apart.dot(apart)
        };
        let same_place = SAME_PLACE * self.margin();
        let near_enough = same_place * same_place;
        let mut held = [0.0; MAX_MANIFOLD_POINTS];
        if count == old_count && (0..count).all(|j| self.features[j] == old.features[j] && near(j, j) <= near_enough) {
            held[..count].copy_from_slice(&old.numbers[NORMAL_IMPULSE].0[..count]);
        } else {
            let (mut taken, mut found) = ([false; MAX_MANIFOLD_POINTS], [false; MAX_MANIFOLD_POINTS]);
            for way in 0..3 {
                for j in 0..count {
                    if found[j] {
                        continue;
                    }
                    let same = |i: &usize| match way {
                        0 => self.features[j] == old.features[*i] && near(j, *i) <= near_enough,
                        1 => near(j, *i) <= near_enough,
                        _ => self.features[j] == old.features[*i],
                    };
                    let candidates = (0..old_count).filter(|i| !taken[*i]).filter(same);
                    if let Some(i) = candidates.min_by(|a, b| near(j, *a).total_cmp(&near(j, *b))) {
                        (taken[i], found[j], held[j]) = (true, true, old.numbers[NORMAL_IMPULSE].0[i]);
                    }
                }
            }
        }
        self.numbers[NORMAL_IMPULSE].0[..MAX_MANIFOLD_POINTS].copy_from_slice(&held);
        self.numbers[NORMAL_IMPULSE].0[6] = old.numbers[NORMAL_IMPULSE].0[6];
        self.set_halvings(old.halvings());
    }
}

/// Surfaces as near as this \[m\] touch, as much as rounding leaves between bodies that stopped
/// each other, a hundred metres from the origin; but no nearer than this part of the margin.
const TOUCHING: [Real; 2] = [1e-4, 0.05];
/// Surfaces that touched have to be this far apart to do so no more, or this part of the margin.
const APART: [Real; 2] = [1e-3, 0.5];

impl ContactRecord {
    /// Whether the bodies touch: something holds them apart, or nothing is between them. Not to be
    /// asked before the impulses are known.
    pub(crate) fn touches(&self) -> bool {
        let [most, part] = if self.touched { APART } else { TOUCHING };
        let within = most.min(part * self.margin());
        (0..self.count()).any(|j| self.separation(j) <= within || self.numbers[NORMAL_IMPULSE].0[j] > 0.0)
    }

    /// Both slots, the lower first.
    pub(crate) fn pair(&self) -> [Slot; 2] {
        let [a, b] = self.slots;
        [a.min(b), a.max(b)]
    }
}
