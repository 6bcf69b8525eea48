//! The persistent contact record: points, surface values, and impulses for the warm start.

use glam::DVec3;
use tumble_collide::{MAX_MANIFOLD_POINTS, Manifold};
use tumble_math::lane::Vec3;

use crate::collision::collider_state::ColliderState;
use crate::collision::contact_rows::{ContactGeometry, NormalImpulses, PointPair, WorldFriction};
use crate::collision::material::Surface;
use crate::collision::narrow_phase::LaneKind;
use crate::math::{Real, dvec3};
use crate::simd::Octet;
use crate::storage::body_index::Slot;

/// A contact of two bodies: points, surface and impulses. Kept from step to step.
#[derive(Clone, Debug)]
pub(crate) struct ContactRecord {
    /// Slots of the bodies; where only one is dynamic, it is the second.
    pub(crate) slots: [Slot; 2],
    /// Of the shapes.
    pub(crate) kind: LaneKind,
    /// Which of the contacts of the two.
    pub(crate) part: u32,
    /// Whether the two touched before this step.
    pub(crate) touched: bool,
    pub(crate) features: [u32; MAX_MANIFOLD_POINTS],
    pub(crate) geometry: ContactGeometry,
    pub(crate) points: [PointPair; MAX_MANIFOLD_POINTS / 2],
    pub(crate) normal_impulses: NormalImpulses,
    pub(crate) friction: WorldFriction,
    /// Of [`UpdateRule::RoundOnFlat`]: how far the second body's surface is from the points that go
    /// with it \[m\].
    pub(crate) core_radius: Real,
    /// How the surface of the first body moves on it, less that of the second \[m/s\], world frame.
    pub(crate) surface_velocity: Vec3<Real>,
    /// Of bodies that meet later in the step.
    pub(crate) meeting: MeetingPlace,
    /// How fast the points came together when the bodies did not touch yet \[m/s\].
    pub(crate) closing_speed: Real,
    /// Along the normal, over all contact substeps, and before those in this step \[N s\].
    pub(crate) total_impulse: Real,
    pub(crate) earlier_impulse: Real,
}

/// Where and when the bodies of a contact meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeetingPlace {
    /// The second body's centre of mass from the first's then \[m\].
    pub(crate) apart: Vec3<Real>,
    /// Since the step began \[s\].
    pub(crate) time: Real,
}

impl MeetingPlace {
    pub(crate) const NONE: Self = Self { apart: Vec3 { x: 0.0, y: 0.0, z: 0.0 }, time: 0.0 };
}

/// The kind of a contact's shapes, both slots, the lower first, and the part, in one number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ContactKey(u128);

impl ContactKey {
    #[inline]
    pub(crate) fn new(kind: LaneKind, [a, b]: [Slot; 2], part: u32) -> Self {
        let (low, high) = (a.min(b), a.max(b));
        let upper = u64::from(kind as u8) << 32 | u64::from(low.0);
        let lower = u64::from(high.0) << 32 | u64::from(part);
        Self(u128::from(upper) << 64 | u128::from(lower))
    }
}

/// The second body of a contact.
#[derive(Clone, Copy)]
pub(crate) struct Second {
    /// Its centre of mass \[m\].
    pub(crate) center: Vec3<Real>,
    /// Whether the first body is not dynamic.
    pub(crate) has_non_dynamic: bool,
    /// How near its surface and the other are a contact \[m\].
    pub(crate) margin: Real,
}

impl Second {
    /// Which share of the gap between the surfaces is before a point: all of it on a non-dynamic
    /// body, so that the arms of a thin body do not depend on the penetration.
    fn share(&self, carried: Real) -> Real {
        if self.has_non_dynamic { 1.0 } else { carried }
    }
}

/// Most halvings of the substeps of a contact.
pub(crate) const MAX_HALVINGS: u8 = 6;

/// How the geometry of a contact follows the bodies within a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UpdateRule {
    /// Points and normals are fixed to the bodies.
    BodyFixed,
    /// Of balls: the normal is along the line of the centres of mass.
    LineOfCenters,
    /// Of round shapes that roll: found again in each substep.
    Refined,
    /// Of a ball about its centre of mass on a plane that does not turn: nothing changes.
    Constant,
    /// Of two balls that meet later in the step, one of which is not dynamic or that meet nothing
    /// else that is free: the normal and the arms are those that they meet with.
    MeetingCenters,
    /// The same of other shapes.
    Meeting,
    /// Of a ball or a capsule, the second body, on a plane that does not turn: points of its centre
    /// or axis are fixed to it, and its surface is before them along the normal.
    RoundOnFlat,
}

impl UpdateRule {
    /// As records and lanes have it.
    #[inline(always)]
    pub(crate) const fn number(self) -> f64 {
        self as u8 as f64
    }
}

/// Points that moved no further than this part of the margin are the same, whatever features meet
/// there now.
const SAME_PLACE: Real = 0.5;

impl ContactRecord {
    /// Of no bodies.
    pub(crate) const NONE: Self = Self {
        kind: LaneKind::Other,
        part: 0,
        touched: false,
        slots: [Slot(0); 2],
        features: [0; MAX_MANIFOLD_POINTS],
        geometry: ContactGeometry::ZERO,
        points: [PointPair::ZERO; MAX_MANIFOLD_POINTS / 2],
        normal_impulses: NormalImpulses::ZERO,
        friction: WorldFriction::ZERO,
        core_radius: 0.0,
        surface_velocity: Vec3 { x: 0.0, y: 0.0, z: 0.0 },
        meeting: MeetingPlace::NONE,
        closing_speed: 0.0,
        total_impulse: 0.0,
        earlier_impulse: 0.0,
    };

    /// Of a manifold with points, whose normal goes from the first slot to the second; `second` is
    /// its second body.
    pub(crate) fn new(
        slots: [Slot; 2],
        part: u32,
        manifold: &Manifold<Real>,
        second: Second,
        rule: UpdateRule,
    ) -> Self {
        let (n, count) = (manifold.normal, manifold.points().len());
        let gap_share = second.share(manifold.carried);
        let mut points = [PointPair::ZERO; MAX_MANIFOLD_POINTS / 2];
        let mut features = [0; MAX_MANIFOLD_POINTS];
        for (j, point) in manifold.points().iter().enumerate() {
            let from_second = point.position - second.center + n * (point.separation * (gap_share - 0.5));
            let pair = &mut points[j / 2];
            (pair.positions[j % 2], pair.separations[j % 2]) = (from_second, point.separation);
            features[j] = point.feature;
        }
        let record = Self::without_points(slots, part, (n, rule), (gap_share, second.margin));
        let geometry = ContactGeometry { carried: manifold.carried, count: count as Real, ..record.geometry };
        Self { features, geometry, points, ..record }
    }

    /// Has points of a core go with the second body, which is as thick around it \[m\].
    pub(crate) fn go_with_core(&mut self, radius: Real) {
        (self.geometry.carried, self.core_radius) = (1.0, radius);
    }

    /// Of a blow in a point \[m\] from the second body's centre of mass, which no contact foresaw.
    pub(crate) fn of_blow(slots: [Slot; 2], part: u32, normal: Vec3<Real>, point: Vec3<Real>, margin: Real) -> Self {
        let mut blow = Self::without_points(slots, part, (normal, UpdateRule::BodyFixed), (0.0, margin));
        blow.geometry.count = 1.0;
        blow.points[0].positions[0] = point;
        blow
    }

    /// With a normal from the first slot to the second, and a margin \[m\].
    fn without_points(
        slots: [Slot; 2],
        part: u32,
        (normal, rule): (Vec3<Real>, UpdateRule),
        (gap_share, margin): (Real, Real),
    ) -> Self {
        let update_rule = crate::math::real(rule.number());
        Self {
            slots,
            part,
            geometry: ContactGeometry { normal, update_rule, ..ContactGeometry::ZERO },
            normal_impulses: NormalImpulses { steady: 1.0, gap_share, ..NormalImpulses::ZERO },
            friction: WorldFriction { margin, ..WorldFriction::ZERO },
            ..Self::NONE
        }
    }

    /// Adds what a blow between the same parts did.
    pub(crate) fn add_blow(&mut self, blow: &Self) {
        self.total_impulse += blow.total_impulse;
        self.closing_speed = self.closing_speed.max(blow.closing_speed);
    }

    /// Makes it the only contact of two shapes, without impulses.
    pub(crate) fn begin(&mut self, kind: LaneKind) {
        (self.kind, self.part, self.touched) = (kind, 0, false);
        (self.closing_speed, self.total_impulse, self.earlier_impulse) = (0.0, 0.0, 0.0);
        (self.core_radius, self.meeting) = (0.0, MeetingPlace::NONE);
        self.drop_impulses();
        let impulses = &mut self.normal_impulses;
        (impulses.steady, impulses.static_friction, impulses.dynamic_friction) = (1.0, 0.0, 0.0);
        self.set_halvings(0);
    }

    /// Whether a point of it pushed in the last substep.
    pub(crate) fn has_impulses(&self) -> bool {
        self.normal_impulses.at_points != [0.0; MAX_MANIFOLD_POINTS]
    }

    /// On the second body in the last substep [N s].
    pub(crate) fn impulse_of_substep(&self) -> DVec3 {
        let along: Real = self.normal_impulses.at_points.iter().sum();
        dvec3((self.geometry.normal * along + self.friction.linear).into())
    }

    /// Has the next step begin without the impulses of the last.
    pub(crate) fn drop_impulses(&mut self) {
        self.normal_impulses.at_points = [0.0; MAX_MANIFOLD_POINTS];
        (self.friction.linear, self.friction.angular) = (Vec3::zero(), Vec3::zero());
    }

    /// Has the next step begin with a part of the impulses of the last.
    pub(crate) fn keep_of_impulses(&mut self, part: Real) {
        self.normal_impulses.at_points.iter_mut().for_each(|impulse| *impulse *= part);
        (self.friction.linear, self.friction.angular) = (self.friction.linear * part, self.friction.angular * part);
    }

    /// Says what the surfaces are like.
    pub(crate) fn set_surface(&mut self, surface: &Surface) {
        self.geometry.rolling_resistance = surface.rolling_resistance;
        self.geometry.restitution = surface.restitution;
        self.normal_impulses.static_friction = surface.static_friction;
        self.normal_impulses.dynamic_friction = surface.dynamic_friction;
    }

    /// The sort key of contacts.
    pub(crate) fn key(&self) -> ContactKey {
        ContactKey::new(self.kind, self.slots, self.part)
    }

    /// Whether it is found again in each substep.
    pub(crate) fn is_refined(&self) -> bool {
        self.has_rule(UpdateRule::Refined)
    }

    /// Whether its points are fixed to the bodies, as between flat faces.
    pub(crate) fn is_body_fixed(&self) -> bool {
        self.has_rule(UpdateRule::BodyFixed)
    }

    /// Multiplies the impulses that it begins with.
    pub(crate) fn scale_impulses(&mut self, by: Real) {
        self.normal_impulses.at_points.iter_mut().for_each(|impulse| *impulse *= by);
        self.friction.linear = self.friction.linear * by;
        self.friction.angular = self.friction.angular * by;
    }

    /// Whether it is that of balls about their centres of mass.
    pub(crate) fn is_between_centers(&self) -> bool {
        self.has_rule(UpdateRule::LineOfCenters)
    }

    /// Whether its bodies meet later in the step, with the arms that it has.
    pub(crate) fn is_of_meeting(&self) -> bool {
        self.meeting != MeetingPlace::NONE
    }

    /// The second body's centre of mass from the first's as its arms have it, which is this when
    /// the step begins \[m\].
    pub(crate) fn apart(&self, begin: Vec3<Real>) -> Vec3<Real> {
        if self.is_of_meeting() { self.meeting.apart } else { begin }
    }

    fn has_rule(&self, rule: UpdateRule) -> bool {
        f64::from(self.geometry.update_rule) == rule.number()
    }

    /// Leaves what is found again in each substep as it is.
    pub(crate) fn hold_still(&mut self) {
        if self.is_refined() {
            self.geometry.update_rule = crate::math::real(UpdateRule::Constant.number());
        }
    }

    /// How many points.
    pub(crate) fn count(&self) -> usize {
        // Saturating to a byte takes a third of the instructions.
        usize::from(self.geometry.count as u8)
    }

    /// Half-way between the surfaces at a point, from the second body's centre of mass.
    pub(crate) fn half_way(&self, j: usize) -> Vec3<Real> {
        self.place(j) - self.geometry.normal * (self.separation(j) * (self.normal_impulses.gap_share - 0.5))
    }

    /// Where the bodies meet later in the step, from the first body's centre of mass \[m\].
    pub(crate) fn met_point(&self) -> Option<Vec3<Real>> {
        self.is_of_meeting().then(|| self.meeting.apart + self.place(0))
    }

    /// How often the substeps of its island were halved in the last step.
    pub(crate) fn halvings(&self) -> u8 {
        self.friction.halvings as u8
    }

    pub(crate) fn set_halvings(&mut self, times: u8) {
        self.friction.halvings = Real::from(times);
    }

    /// How near the surfaces are a contact \[m\], but for how fast they come: a length that goes
    /// with the bodies' sizes.
    pub(crate) fn margin(&self) -> Real {
        self.friction.margin
    }

    /// Separation at a point \[m\].
    pub(crate) fn separation(&self, j: usize) -> Real {
        self.points[j / 2].separations[j % 2]
    }

    /// A point from the second body's centre of mass when the step began \[m\].
    pub(crate) fn place(&self, j: usize) -> Vec3<Real> {
        self.points[j / 2].positions[j % 2]
    }

    /// How fast the points that come nearest do so, where bodies move like this in a time \[m/s\].
    pub(crate) fn closing_speed_of(&self, [first, second]: [&ColliderState; 2], time: Real) -> Real {
        let comes = |j: usize| self.geometry.normal.dot(self.passing(j, [first, second]));
        (0..self.count()).map(comes).fold(0.0, Real::max) / time
    }

    /// How far the first body moves past the second at a point, where they go on like this \[m\].
    fn passing(&self, j: usize, [first, second]: [&ColliderState; 2]) -> Vec3<Real> {
        let (arm, apart) = (self.place(j), self.apart(second.center - first.center));
        let way = |state: &ColliderState, arm: Vec3<Real>| state.motion.way + state.motion.turn.cross(arm);
        way(first, arm + apart) - way(second, arm)
    }

    /// How fast the points come together or, within the margin, move past each other, where bodies
    /// move like this in a time \[m/s\].
    pub(crate) fn fastest_approach(&self, [first, second]: [&ColliderState; 2], time: Real) -> Real {
        let comes = |j: usize| {
            let passes = self.passing(j, [first, second]);
            let meets = self.separation(j) <= self.margin();
            if meets { passes.dot(passes).sqrt() } else { self.geometry.normal.dot(passes) }
        };
        (0..self.count()).map(comes).fold(0.0, Real::max) / time
    }

    /// Along the normal over the step \[N s\].
    pub(crate) fn impulse_of_step(&self) -> Real {
        self.earlier_impulse + self.total_impulse
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
        (self.friction.linear, self.friction.angular) = (old.friction.linear, old.friction.angular);
        self.normal_impulses.steady = old.normal_impulses.steady;
        self.set_halvings(old.halvings());
        let (count, old_count) = (self.count(), old.count());
        let near = |j: usize, i: usize| {
            let apart = self.place(j) - old.place(i);
            apart.dot(apart)
        };
        let same_place = SAME_PLACE * self.margin();
        let near_enough = same_place * same_place;
        let is_same = |j: usize| (self.features[j] == old.features[j]) & (near(j, j) <= near_enough);
        let are_same = if count == 1 {
            is_same(0)
        } else {
            // Without branches, over all points that there can be.
            (0..MAX_MANIFOLD_POINTS).fold(true, |are_same, j| are_same & (is_same(j) | (j >= count)))
        };
        if count == old_count && are_same {
            let [a, b, c, d] = old.normal_impulses.at_points;
            let held = |j: usize, impulse: Real| if j < count { impulse } else { 0.0 };
            self.normal_impulses.at_points = [held(0, a), held(1, b), held(2, c), held(3, d)];
            return;
        }
        let mut held = [0.0; MAX_MANIFOLD_POINTS];
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
                    (taken[i], found[j], held[j]) = (true, true, old.normal_impulses.at_points[i]);
                }
            }
        }
        self.normal_impulses.at_points = held;
    }
}

/// Surfaces as near as this \[m\] touch, as much as rounding leaves between bodies that stopped
/// each other, a hundred metres from the origin; but no nearer than this part of the margin.
const TOUCHING: [Real; 2] = [1e-4, 0.05];
/// Surfaces that touched have to be this far apart to do so no more, or this part of the margin.
const APART: [Real; 2] = [1e-3, 0.5];

impl ContactRecord {
    /// Whether the bodies touch: something held them apart in the step, or nothing is between them.
    /// Not to be asked before the impulses are known.
    pub(crate) fn touches(&self) -> bool {
        let [most, part] = if self.touched { APART } else { TOUCHING };
        let within = most.min(part * self.margin());
        self.impulse_of_step() > 0.0 || (0..self.count()).any(|j| self.separation(j) <= within)
    }

    /// Both slots, the lower first.
    pub(crate) fn pair(&self) -> [Slot; 2] {
        let [a, b] = self.slots;
        [a.min(b), a.max(b)]
    }
}
