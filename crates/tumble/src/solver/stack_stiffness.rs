//! How stiff contacts have to be for what is stacked on them to stand.

use std::ops::Range;

use rayon::prelude::*;
use tumble_collide::MAX_MANIFOLD_POINTS;
use tumble_math::lane::Vec3;

use crate::collision::contact::{ContactRecord, MAX_HALVINGS};
use crate::collision::contact_rows::{ContactGeometry, ContactLanes};
use crate::collision::islands::Islands;
use crate::collision::pipeline::PART;
use crate::math::Real;
use crate::settings::Settings;
use crate::simd::{
    BLOCK, HALF_BLOCK, Kernel, Octet, Tile, dispatch_in_blocks, gather_rows, octet, select_rows, store_rows,
};
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::solver::contact::softness::Softness;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::storage::body_index::Slot;
use crate::threads::InParts;

/// The loads of a world's bodies on each other under gravity, and the islands that need shorter
/// substeps to bear them.
///
/// A contact is a spring whose stiffness goes with the square of the substeps' rate. A column of
/// such springs buckles when the moment of what leans beats their resistance to tilting: for one
/// joint when `W H > k`, with the weight `W` of all that is above, the height `H` of its centre
/// over the joint and the rotational stiffness `k`; for joints in series when the sum of `W H / k`
/// is about one (Euler's column under its own weight: 1.3).
#[derive(Clone, Default)]
pub(crate) struct Stacks {
    /// By slot.
    bodies: Vec<StackBody>,
    /// By contact; in whole blocks.
    supports: Vec<Support>,
    /// By slot.
    loads: Vec<Load>,
    /// The upper and the lower body of each contact; no slots where it bears nothing.
    pairs: Vec<[Slot; 2]>,
    /// Where the supports of each slot begin among `by_upper`.
    begins: Vec<u32>,
    /// The number of a support, and the slot of the lower body.
    by_upper: Vec<(u32, Slot)>,
    /// By slot: how many supports hand it loads that have not done so.
    waiting: Vec<u32>,
    /// Slots that rest on something, each after all that rest on it.
    order: Vec<Slot>,
    islands: Islands,
    /// By slot of an island's root, how often its substeps were halved before.
    before: Vec<u8>,
}

octet! {
    /// A body as its loads see it.
    struct StackBody<T> {
        /// Of mass \[m\].
        center: Vec3<T>,
        /// [1/kg]; zero for non-dynamic bodies.
        inverse_mass: T,
        /// Inverse inertia about the two horizontal directions [1/(kg m^2)]: `xx yy xy`.
        inverse_inertia: [T; 3],
        /// One where the body is dynamic, else zero.
        is_dynamic: T,
    }
}

octet! {
    /// How a contact bears its upper body: sums over its points, as [`Base`] has them.
    struct Support<T> {
        /// [N/m]; below zero where the first body is the upper one, zero where the contact bears
        /// nothing.
        signed_stiffness: T,
        first: [T; 2],
        second: [T; 3],
        height: T,
        /// The margin \[m\]; below zero where fewer than three points bear.
        signed_margin: T,
    }
}

/// The support of a body: sums over points by their stiffness [N/m].
#[derive(Clone, Copy, Default)]
struct Base {
    stiffness: Real,
    /// Of horizontal places from the upper body's centre of mass, of their squares and product, and
    /// of heights.
    first: [Real; 2],
    second: [Real; 3],
    height: Real,
}

/// The load on a body.
#[derive(Clone, Copy, Default)]
struct Load {
    /// Weight of it and of what it bears \[N\], and their moment about height zero [N m].
    weight: Real,
    moment: Real,
    /// Sum of `W H / k` over the joints from the top.
    lean: Real,
    /// The stiffness that is needed, over that which there is.
    need: Real,
}

/// Least vertical part of the normal of a contact that bears.
const MIN_SLOPE: f64 = 0.5;
/// Least `k / (W H)` of a column that is left as it is: it buckles at 1/1.3.
const MIN_STIFFNESS: Real = 1.25;
/// Least `k / (W H)`. Layers of several blocks side by side still shake at half of it.
const STIFFNESS: Real = 2.5;
/// How deep \[margins\] a body in a stack may be pressed in by its load: a tenth of half its
/// thickness.
const MAX_DEPTH: Real = 5.0;
/// A body that is deeper \[margins\] was shot in and does not rest: twice half its thickness.
const DEEP: f64 = 100.0;
/// Root mean square distance from the middle \[margins\] of what a body rests on, below which that
/// is an edge or a corner and not a face.
const MIN_SPREAD: Real = 8.0;
/// By how much what is needed must have fallen before an island has longer substeps again: a change
/// of stiffness is a small push.
const SLACK: Real = 2.0;

impl Stacks {
    /// Adds how often the substeps of each contact of a world are to be halved.
    pub(crate) fn add_halvings(
        &mut self,
        contacts: &mut [ContactRecord],
        constrained: &ConstrainedBodies,
        settings: &Settings,
        bodies: &SolverBodies,
        halvings: &mut Vec<u8>,
    ) {
        let first = halvings.len();
        halvings.resize(first + contacts.len(), 0);
        let in_need = self.load(contacts, constrained, bodies, settings);
        if in_need || contacts.iter().any(|contact| contact.halvings() > 0) {
            let moves = |slot: Slot| constrained.row(slot).is_some_and(|row| bodies.is_dynamic(row));
            self.halve(contacts, moves, &mut halvings[first..]);
        }
    }

    /// Works out the loads; returns whether any contact is not stiff enough.
    fn load(
        &mut self,
        contacts: &[ContactRecord],
        constrained: &ConstrainedBodies,
        bodies: &SolverBodies,
        settings: &Settings,
    ) -> bool {
        let slots = constrained.rows().len();
        let gravity = Vec3::from(settings.gravity);
        let g = gravity.dot(gravity).sqrt();
        self.loads.clear();
        self.loads.resize(slots, Load::default());
        if g == 0.0 || contacts.is_empty() {
            return false;
        }
        let up = gravity * (-1.0 / g);
        self.read_bodies(constrained, bodies, sides(up));
        self.find_supports(contacts, up, settings);
        self.sum_loads(up, g) > 1.0
    }

    /// Reads the bodies, by slot; `sides` are two horizontal directions.
    fn read_bodies(&mut self, constrained: &ConstrainedBodies, bodies: &SolverBodies, sides: [Vec3<Real>; 2]) {
        let read = |row: Option<SolverRow>| {
            let Some(row) = row else { return StackBody::ZERO };
            let center = bodies.center(row);
            if !bodies.is_dynamic(row) {
                return StackBody { center, ..StackBody::ZERO };
            }
            let (inverse_mass, inverse_inertia) = bodies.mobility(row, sides);
            StackBody { center, inverse_mass, inverse_inertia, is_dynamic: 1.0 }
        };
        self.bodies.resize(constrained.rows().len(), StackBody::ZERO);
        self.bodies.par_chunks_mut(PART).enumerate().by_at_least(2).for_each(|(part, these)| {
            let slots = (part * PART) as u32..;
            slots.map(Slot).zip(these).for_each(|(slot, body)| *body = read(constrained.row(slot)));
        });
    }

    /// Finds which contacts bear which bodies.
    fn find_supports(&mut self, contacts: &[ContactRecord], up: Vec3<Real>, settings: &Settings) {
        let Self { bodies, supports, .. } = self;
        let (bodies, sides) = (&**bodies, sides(up));
        supports.resize(contacts.len().next_multiple_of(HALF_BLOCK), Support::ZERO);
        let rates = Softness::stiffness(settings.contact_substep().into());
        let parts = supports.par_chunks_mut(PART).zip(contacts.par_chunks(PART));
        parts.by_at_least(2).for_each(|(supports, contacts)| {
            dispatch_in_blocks(&mut Bear { supports, contacts, bodies, up, sides, rates });
        });
        self.order_slots(contacts);
    }

    /// Orders supports by the slot of the upper body, keeping their order, and slots so that each
    /// comes after all that rest on it; kept where the same bodies bear each other as before.
    fn order_slots(&mut self, contacts: &[ContactRecord]) {
        let slots = self.bodies.len();
        let pairs =
            self.supports.iter().zip(contacts).map(|(support, contact)| upper_and_lower(support, contact.slots));
        if self.begins.len() == slots + 2 && pairs.clone().eq(self.pairs.iter().copied()) {
            return;
        }
        self.pairs.clear();
        self.pairs.extend(pairs);
        let Self { begins, by_upper, pairs, waiting, order, .. } = self;
        order_by_upper(pairs, slots, begins, by_upper);
        let supports_of = |slot: Slot| &by_upper[range_of(begins, slot)];
        waiting.clear();
        waiting.resize(slots, 0);
        by_upper.iter().for_each(|(_, lower)| waiting[lower.index()] += 1);
        let bears_on = |slot: Slot| !range_of(begins, slot).is_empty();
        order.clear();
        order.extend((0..slots as u32).map(Slot).filter(|slot| bears_on(*slot) && waiting[slot.index()] == 0));
        let (mut next, mut first_left) = (0, 0);
        loop {
            // Of bodies that bear each other in a ring the one with the lowest slot begins.
            if next == order.len() {
                let mut left = (first_left..slots as u32).map(Slot);
                let Some(slot) = left.find(|slot| bears_on(*slot) && waiting[slot.index()] > 0) else { break };
                (waiting[slot.index()], first_left) = (0, slot.0 + 1);
                order.push(slot);
            }
            let slot = order[next];
            next += 1;
            for (_, lower) in supports_of(slot) {
                let waiting = &mut waiting[lower.index()];
                if *waiting == 1 && bears_on(*lower) {
                    order.push(*lower);
                }
                *waiting = waiting.saturating_sub(1);
            }
        }
    }

    /// Sums loads from the top down; returns the stiffness that is needed most, over that which
    /// there is.
    fn sum_loads(&mut self, up: Vec3<Real>, g: Real) -> Real {
        let Self { bodies, supports, loads, begins, by_upper, order, .. } = self;
        let bodies = &**bodies;
        let supports_of = |slot: Slot| {
            let of_slot = by_upper[range_of(begins, slot)].iter();
            of_slot.map(|(index, lower)| (&supports[*index as usize], *lower))
        };
        let mut most = 0.0;
        for slot in order.iter().copied() {
            let StackBody { center, inverse_mass, .. } = bodies[slot.index()];
            let height = center.dot(up);
            let load = &mut loads[slot.index()];
            let (mut base, mut on_face, mut margin) = (Base::default(), false, Real::INFINITY);
            let mut is_stacked = load.weight > 0.0;
            for (support, lower) in supports_of(slot) {
                base.add(&Base::of(support));
                on_face |= support.signed_margin > 0.0;
                is_stacked |= bodies[lower.index()].is_dynamic > 0.0;
                margin = margin.min(support.signed_margin.abs());
            }
            let own = g / inverse_mass;
            load.weight += own;
            load.moment += own * height;
            load.lean += base.lean(on_face, load, (height, MIN_SPREAD * margin));
            let depth = if is_stacked { load.weight / (base.stiffness * margin) } else { 0.0 };
            let stands = load.lean * MIN_STIFFNESS <= 1.0;
            let stiffness = if stands { MIN_STIFFNESS } else { STIFFNESS };
            load.need = (load.lean * stiffness).max(depth / MAX_DEPTH);
            most = load.need.max(most);
            let Load { weight, moment, lean, .. } = *load;
            for (support, lower) in supports_of(slot) {
                let share = support.signed_stiffness.abs() / base.stiffness;
                let below = &mut loads[lower.index()];
                below.weight += share * weight;
                below.moment += share * moment;
                below.lean = below.lean.max(lean);
            }
        }
        most
    }

    /// Halves the substeps of whole islands, as often as the body needs it that needs it most.
    fn halve(&mut self, contacts: &mut [ContactRecord], moves: impl Fn(Slot) -> bool, halvings: &mut [u8]) {
        let Self { loads, islands, .. } = self;
        let slots = loads.len();
        islands.join(slots, contacts.iter().map(|contact| contact.slots), moves);
        for slot in (0..slots as u32).map(Slot) {
            let root = islands.root(slot).index();
            loads[root].need = loads[slot.index()].need.max(loads[root].need);
        }
        self.before.clear();
        self.before.resize(slots, 0);
        for contact in &*contacts {
            let before = &mut self.before[islands.root(contact.slots[1]).index()];
            *before = contact.halvings().max(*before);
        }
        for (contact, halvings) in contacts.iter_mut().zip(halvings) {
            let root = islands.root(contact.slots[1]).index();
            let need = loads[root].need;
            *halvings = self.before[root].clamp(halvings_for(need), halvings_for(SLACK * need));
            // Longer substeps begin with the impulses of a shorter one: what an impact gave in it
            // is no force.
            contact.scale_impulses(1.0 / (1u32 << contact.halvings().max(*halvings)) as Real);
            contact.set_halvings(*halvings);
        }
    }
}

impl Base {
    fn of(&Support { signed_stiffness, first, second, height, .. }: &Support) -> Self {
        Self { stiffness: signed_stiffness.abs(), first, second, height }
    }

    fn add(&mut self, other: &Self) {
        self.stiffness += other.stiffness;
        self.height += other.height;
        self.first.iter_mut().zip(other.first).for_each(|(sum, it)| *sum += it);
        self.second.iter_mut().zip(other.second).for_each(|(sum, it)| *sum += it);
    }

    /// `W H / k` of what a body at a height \[m\] bears, on points with a spread of at
    /// least \[m\].
    fn lean(&self, on_face: bool, load: &Load, (height, spread): (Real, Real)) -> Real {
        let Self { stiffness, first: [x, y], second: [xx, yy, xy], .. } = *self;
        let joint = height + self.height / stiffness;
        let lever = load.moment - load.weight * joint;
        // Of the two principal axes of where it rests, that about which it tilts more easily.
        let (xx, yy, xy) = (xx - x * x / stiffness, yy - y * y / stiffness, xy - x * y / stiffness);
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let least = mean - (half * half + xy * xy).sqrt();
        if on_face && lever > 0.0 && least > spread * spread * stiffness { lever / least } else { 0.0 }
    }
}

/// How often substeps must be halved for contacts that have to be stiffer by a factor.
fn halvings_for(need: Real) -> u8 {
    (0..MAX_HALVINGS).take_while(|times| need > (1u32 << (2 * times)) as Real).count() as u8
}

/// Two horizontal directions.
fn sides(up: Vec3<Real>) -> [Vec3<Real>; 2] {
    let least = if up.x * up.x <= 0.5 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let side = up.cross(least);
    let side = side * (1.0 / side.dot(side).sqrt());
    [side, up.cross(side)]
}

/// Works out how contacts bear their upper bodies.
struct Bear<'a> {
    supports: &'a mut [Support],
    contacts: &'a [ContactRecord],
    bodies: &'a [StackBody],
    up: Vec3<Real>,
    sides: [Vec3<Real>; 2],
    /// Stiffness for each kilogram: between dynamic bodies, and on a non-dynamic one.
    rates: [Real; 2],
}

impl Bear<'_> {
    /// The contacts from `i` on.
    #[inline(always)]
    fn contacts<T: Tile>(&self, i: usize) -> ContactLanes<'_> {
        let mut picked = ContactLanes::empty();
        let mut l = 0;
        while l < T::WIDTH && i + l < self.contacts.len() {
            picked.set(l, &self.contacts[i + l]);
            l += 1;
        }
        picked
    }

    /// The first or the second bodies of the contacts from `i` on.
    #[inline(always)]
    fn bodies<T: Tile>(&self, which: usize, i: usize) -> StackBody<T> {
        let mut picked = [StackBody::zero(); BLOCK];
        let mut l = 0;
        while l < T::WIDTH && i + l < self.contacts.len() {
            picked[l] = &self.bodies[self.contacts[i + l].slots[which].index()];
            l += 1;
        }
        gather_rows(&picked)
    }
}

impl Kernel for Bear<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.supports.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let (up, sides) = (splat(self.up), [splat(self.sides[0]), splat(self.sides[1])]);
        let contacts = self.contacts::<T>(i);
        let ContactGeometry { normal, count, .. } = contacts.geometry::<T>();
        let margin = contacts.friction::<T>().margin;
        let slope = up.dot(normal);
        let (first, second) = (self.bodies::<T>(0, i), self.bodies::<T>(1, i));
        let upper = select_rows::<T, StackBody>(zero.lt(slope), second, first);
        let lower = select_rows::<T, StackBody>(zero.lt(slope), first, second);
        let to_upper = second.center - upper.center;

        let (places, separations) = contacts.points::<T>();
        let deep = margin * T::splat(-DEEP);
        let (mut points, mut sum, mut second_moments) = (zero, [zero; 3], [zero; 3]);
        let mut j = 0;
        while j < MAX_MANIFOLD_POINTS {
            let is_point = T::select(T::splat(j as f64).lt(count), one, zero);
            let weight = T::select(margin.lt(separations[j]), zero, is_point);
            let weight = T::select(separations[j].lt(deep), zero, weight);
            let place = Vec3::select(zero.lt(weight), to_upper + places[j], Vec3::zero());
            let (x, y) = (sides[0].dot(place), sides[1].dot(place));
            points = points + weight;
            sum = [sum[0] + x, sum[1] + y, sum[2] + up.dot(place)];
            second_moments = [second_moments[0] + x * x, second_moments[1] + y * y, second_moments[2] + x * y];
            j += 1;
        }
        let apart = upper.center - lower.center;
        let (x, y, two) = (sides[0].dot(apart), sides[1].dot(apart), T::splat(2.0));
        let about_lower = [
            second_moments[0] + x * (two * sum[0] + points * x),
            second_moments[1] + y * (two * sum[1] + points * y),
            second_moments[2] + x * sum[1] + y * sum[0] + points * x * y,
        ];
        let responses =
            summed_inverse_mass(&upper, points, second_moments) + summed_inverse_mass(&lower, points, about_lower);
        let [between, on_ground] = [T::splat(self.rates[0].into()), T::splat(self.rates[1].into())];
        let rate = T::select(zero.lt(lower.is_dynamic), between, on_ground);
        // Nothing rests on a wall, nor where no point is near; non-dynamic bodies need no support.
        let stiffness = rate * points / responses;
        let stiffness = T::select(slope.abs().lt(T::splat(MIN_SLOPE)), zero, stiffness);
        let stiffness = T::select(zero.lt(points * upper.is_dynamic * margin), stiffness, zero);
        let [xx, yy, xy] = second_moments;
        let total = stiffness * points;
        let support = Support {
            signed_stiffness: T::select(zero.lt(slope), total, zero - total),
            first: [sum[0] * stiffness, sum[1] * stiffness],
            second: [xx * stiffness, yy * stiffness, xy * stiffness],
            height: sum[2] * stiffness,
            signed_margin: T::select(two.lt(points), margin, zero - margin),
        };
        store_rows(support, &mut self.supports[i..]);
    }
}

/// How points at these second moments from the centre of a body give way to impulses, summed.
#[inline(always)]
fn summed_inverse_mass<T: Tile>(body: &StackBody<T>, points: T, [xx, yy, xy]: [T; 3]) -> T {
    let [about_x, about_y, coupled] = body.inverse_inertia;
    body.inverse_mass * points + about_x * yy + about_y * xx - T::splat(2.0) * coupled * xy
}

#[inline(always)]
fn splat<T: Tile>(v: Vec3<Real>) -> Vec3<T> {
    Vec3::new(T::splat(v.x.into()), T::splat(v.y.into()), T::splat(v.z.into()))
}

/// The upper and the lower of a contact's bodies; no slots where it bears nothing.
fn upper_and_lower(support: &Support, [first, second]: [Slot; 2]) -> [Slot; 2] {
    if support.signed_stiffness == 0.0 {
        [Slot::NONE; 2]
    } else if support.signed_stiffness > 0.0 {
        [second, first]
    } else {
        [first, second]
    }
}

/// Where the supports of a slot are among those ordered by the upper body.
fn range_of(begins: &[u32], slot: Slot) -> Range<usize> {
    begins[slot.index()] as usize..begins[slot.index() + 1] as usize
}

/// Orders supports by the slot of the upper body, keeping their order.
fn order_by_upper(pairs: &[[Slot; 2]], slots: usize, begins: &mut Vec<u32>, by_upper: &mut Vec<(u32, Slot)>) {
    let pairs = || {
        let all = pairs.iter().enumerate().filter(|(_, [upper, _])| *upper != Slot::NONE);
        all.map(|(index, [upper, lower])| (upper.index(), (index as u32, *lower)))
    };
    begins.clear();
    begins.resize(slots + 2, 0);
    let mut count = 0;
    for (upper, _) in pairs() {
        begins[upper + 2] += 1;
        count += 1;
    }
    for slot in 2..begins.len() {
        begins[slot] += begins[slot - 1];
    }
    by_upper.clear();
    by_upper.resize(count, (0, Slot(0)));
    for (upper, support) in pairs() {
        let place = &mut begins[upper + 1];
        by_upper[*place as usize] = support;
        *place += 1;
    }
}
