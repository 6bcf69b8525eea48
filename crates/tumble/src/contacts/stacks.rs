//! How stiff contacts have to be for what is stacked on them to stand.

use rayon::prelude::*;
use tumble_math::lane::Vec3;

use super::contact::Contact;
use super::islands::Islands;
use super::soft::Softness;
use super::solver_bodies::SolverBodies;
use super::touching::{Contacts, NONE, Shape};
use crate::math::Real;
use crate::settings::Settings;
use crate::threads::InParts;

/// The loads of a world's bodies on each other under gravity, and the islands that need shorter substeps to bear them.
///
/// A contact is a spring whose stiffness goes with the square of the substeps' rate. A column of such springs buckles when the moment of
/// what leans beats their resistance to tilting: for one joint when `W H > k`, with the weight `W` of all that is above, the height `H`
/// of its centre over the joint and the rotational stiffness `k`; for joints in series when the sum of `W H / k` is about one (Euler's
/// column under its own weight: 1.3).
#[derive(Clone, Default)]
pub(super) struct Stacks {
    /// By slot, of what impulses move: one over the mass, and the inverse inertia about the two horizontal directions and off its diagonal.
    mobilities: Vec<[Real; 4]>,
    /// By contact.
    supports: Vec<Support>,
    /// By slot.
    loads: Vec<Load>,
    /// Where the supports of each slot begin among `by_upper`.
    begins: Vec<u32>,
    by_upper: Vec<u32>,
    /// Slots that rest on something, from the top, with their heights \[m\].
    order: Vec<(Real, u32)>,
    islands: Islands,
    /// By slot of an island's root, how often its substeps were halved before.
    before: Vec<u8>,
}

/// So many contacts are taken by one thread at a time.
const PART: usize = 512;

/// How a contact bears its upper body.
#[derive(Clone, Copy)]
struct Support {
    /// Slots; the first is [`NONE`] if it bears nothing.
    upper: u32,
    lower: u32,
    base: Base,
    /// Whether it is a face.
    is_face: bool,
    margin: Real,
}

/// What a body rests on: sums over points by their stiffness [N/m].
#[derive(Clone, Copy, Default)]
struct Base {
    stiffness: Real,
    /// Of horizontal places from the upper body's centre of mass, of their squares and product, and of heights.
    first: [Real; 2],
    second: [Real; 3],
    height: Real,
}

/// What rests on a body.
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
const LEAST_SLOPE: Real = 0.5;
/// Least `k / (W H)` of a column that is left as it is: it buckles at 1/1.3.
const LEAST_STIFFNESS: Real = 1.25;
/// What `k / (W H)` becomes at least where there is less. Layers of several blocks side by side still shake at half of it.
const STIFFNESS: Real = 2.5;
/// How deep \[margins\] a body in a stack may be pressed in by its load: a tenth of half its thickness.
const MOST_DEPTH: Real = 5.0;
/// What is deeper \[margins\] does not rest but was shot in: twice half its thickness.
const DEEP: Real = 100.0;
/// Root mean square distance from the middle \[margins\] of what a body rests on, below which that is an edge or a corner and not a face.
const LEAST_SPREAD: Real = 8.0;
/// Substeps are halved as often as this at most.
pub(super) const MOST_HALVINGS: u8 = 6;
/// By how much what is needed must have fallen before an island has longer substeps again: a change of stiffness is a small push.
const SLACK: Real = 2.0;

impl Contacts {
    /// Adds how often the substeps of each contact of this world are to be halved.
    pub(super) fn add_halvings(&mut self, settings: &Settings, bodies: &SolverBodies, halvings: &mut Vec<u8>) {
        let first = halvings.len();
        halvings.resize(first + self.contacts.len(), 0);
        let Self { contacts, shapes, rows, stacks, .. } = self;
        let in_need = stacks.load(contacts, (shapes, rows), bodies, settings);
        if in_need || contacts.iter().any(|contact| contact.halvings() > 0) {
            stacks.halve(contacts, shapes, &mut halvings[first..]);
        }
    }
}

impl Stacks {
    /// Works out the loads; returns whether any contact is not stiff enough.
    fn load(
        &mut self,
        contacts: &[Contact],
        (shapes, rows): (&[Shape], &[u32]),
        bodies: &SolverBodies,
        settings: &Settings,
    ) -> bool {
        let gravity = Vec3::from(settings.gravity);
        let g = gravity.dot(gravity).sqrt();
        self.loads.clear();
        self.loads.resize(shapes.len(), Load::default());
        if g == 0.0 || contacts.is_empty() {
            return false;
        }
        let up = gravity * (-1.0 / g);
        let sides = sides(up);
        let Self { mobilities, supports, loads, begins, by_upper, order, .. } = self;
        mobilities.clear();
        mobilities.extend(
            rows.iter()
                .zip(shapes)
                .map(|(row, shape)| if *row != NONE && shape.moves { bodies.mobility(*row, sides) } else { [0.0; 4] }),
        );
        let rates = Softness::stiffness(settings.contact_substep().into());
        let bearing = Bearing { shapes, mobilities, up, sides, rates };
        supports.resize(contacts.len(), Support::NONE);
        let parts = supports.par_chunks_mut(PART).zip(contacts.par_chunks(PART));
        parts.by_at_least(2).for_each(|(supports, contacts)| {
            supports.iter_mut().zip(contacts).for_each(|(support, contact)| *support = bearing.support(contact));
        });
        order_by_upper(supports, shapes.len(), begins, by_upper);
        let supports_of = |slot: u32| {
            let range = begins[slot as usize] as usize..begins[slot as usize + 1] as usize;
            by_upper[range].iter().map(|index| &supports[*index as usize])
        };

        order.clear();
        let resting = (0..shapes.len()).filter(|slot| begins[*slot] < begins[slot + 1]);
        order.extend(resting.map(|slot| (shapes[slot].center.dot(up), slot as u32)));
        order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut most = 0.0;
        for &(height, slot) in &*order {
            let load = &mut loads[slot as usize];
            let (mut base, mut on_face, mut margin) = (Base::default(), false, Real::INFINITY);
            let mut is_stacked = load.weight > 0.0;
            for support in supports_of(slot) {
                base.add(&support.base);
                on_face |= support.is_face;
                is_stacked |= shapes[support.lower as usize].moves;
                margin = margin.min(support.margin);
            }
            let own = g / mobilities[slot as usize][0];
            load.weight += own;
            load.moment += own * height;
            load.lean += base.lean(on_face, load, (height, LEAST_SPREAD * margin));
            let depth = if is_stacked { load.weight / (base.stiffness * margin) } else { 0.0 };
            let stands = load.lean * LEAST_STIFFNESS <= 1.0;
            let stiffness = if stands { LEAST_STIFFNESS } else { STIFFNESS };
            load.need = (load.lean * stiffness).max(depth / MOST_DEPTH);
            most = load.need.max(most);
            let Load { weight, moment, lean, .. } = *load;
            for support in supports_of(slot) {
                let share = support.base.stiffness / base.stiffness;
                let below = &mut loads[support.lower as usize];
                below.weight += share * weight;
                below.moment += share * moment;
                below.lean = below.lean.max(lean);
            }
        }
        most > 1.0
    }

    /// Halves the substeps of whole islands, as often as the body needs it that needs it most.
    fn halve(&mut self, contacts: &mut [Contact], shapes: &[Shape], halvings: &mut [u8]) {
        let Self { loads, islands, .. } = self;
        islands.join(shapes.len(), contacts.iter().map(|contact| contact.slots), |slot| shapes[slot as usize].moves);
        for slot in 0..shapes.len() as u32 {
            let root = islands.root(slot);
            let need = loads[slot as usize].need.max(loads[root as usize].need);
            loads[root as usize].need = need;
        }
        self.before.clear();
        self.before.resize(shapes.len(), 0);
        for contact in &*contacts {
            let before = &mut self.before[islands.root(contact.slots[1]) as usize];
            *before = contact.halvings().max(*before);
        }
        for (contact, halvings) in contacts.iter_mut().zip(halvings) {
            let root = islands.root(contact.slots[1]) as usize;
            let need = loads[root].need;
            *halvings = self.before[root].clamp(halvings_for(need), halvings_for(SLACK * need));
            // Longer substeps begin with the impulses of a shorter one: what a blow gave in it is no force.
            contact.scale_impulses(1.0 / (1u32 << contact.halvings().max(*halvings)) as Real);
            contact.set_halvings(*halvings);
        }
    }
}

impl Support {
    const NONE: Self = Self {
        upper: NONE,
        lower: NONE,
        base: Base { stiffness: 0.0, first: [0.0; 2], second: [0.0; 3], height: 0.0 },
        is_face: false,
        margin: 0.0,
    };
}

impl Base {
    fn add(&mut self, other: &Self) {
        self.stiffness += other.stiffness;
        self.height += other.height;
        self.first.iter_mut().zip(other.first).for_each(|(sum, it)| *sum += it);
        self.second.iter_mut().zip(other.second).for_each(|(sum, it)| *sum += it);
    }

    /// `W H / k` of what a body at a height \[m\] bears, on points that are spread by so much at least \[m\].
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
    (0..MOST_HALVINGS).take_while(|times| need > (1u32 << (2 * times)) as Real).count() as u8
}

/// Two horizontal directions.
fn sides(up: Vec3<Real>) -> [Vec3<Real>; 2] {
    let least = if up.x * up.x <= 0.5 { Vec3::new(1.0, 0.0, 0.0) } else { Vec3::new(0.0, 1.0, 0.0) };
    let side = up.cross(least);
    let side = side * (1.0 / side.dot(side).sqrt());
    [side, up.cross(side)]
}

/// What contacts bear in a world.
struct Bearing<'a> {
    /// By slot.
    shapes: &'a [Shape],
    mobilities: &'a [[Real; 4]],
    up: Vec3<Real>,
    sides: [Vec3<Real>; 2],
    /// Stiffness for each kilogram, of two moving bodies and on what does not move.
    rates: [Real; 2],
}

impl Bearing<'_> {
    fn support(&self, contact: &Contact) -> Support {
        let (slope, margin) = (contact.normal().dot(self.up), contact.margin());
        let [first, second] = contact.slots;
        let (upper, lower) = if slope > 0.0 { (second, first) } else { (first, second) };
        let [above, below] = [upper, lower].map(|slot| &self.shapes[slot as usize]);
        if slope.abs() < LEAST_SLOPE || !above.moves || margin <= 0.0 {
            return Support::NONE;
        }
        let (mut sum, mut second_moments, mut points) = ([0.0; 3], [0.0; 3], 0);
        let to_upper = self.shapes[second as usize].center - above.center;
        let near = -DEEP * margin..=margin;
        for (place, separation) in contact.points().into_iter().take(contact.count()) {
            if near.contains(&separation) {
                let place = to_upper + place;
                let (x, y) = (self.sides[0].dot(place), self.sides[1].dot(place));
                sum = [sum[0] + x, sum[1] + y, sum[2] + self.up.dot(place)];
                second_moments = [second_moments[0] + x * x, second_moments[1] + y * y, second_moments[2] + x * y];
                points += 1;
            }
        }
        let count = points as Real;
        let apart = above.center - below.center;
        let (x, y) = (self.sides[0].dot(apart), self.sides[1].dot(apart));
        let about_lower = [
            second_moments[0] + x * (2.0 * sum[0] + count * x),
            second_moments[1] + y * (2.0 * sum[1] + count * y),
            second_moments[2] + x * sum[1] + y * sum[0] + count * x * y,
        ];
        let response = |slot: u32, [xx, yy, xy]: [Real; 3]| {
            let [inverse_mass, about_x, about_y, off_diagonal] = self.mobilities[slot as usize];
            count * inverse_mass + about_x * yy + about_y * xx - 2.0 * off_diagonal * xy
        };
        let responses = response(upper, second_moments) + response(lower, about_lower);
        let k = self.rates[usize::from(!below.moves)] * count / responses;
        let base = Base {
            stiffness: k * count,
            first: [k * sum[0], k * sum[1]],
            second: second_moments.map(|sum| k * sum),
            height: k * sum[2],
        };
        if points == 0 { Support::NONE } else { Support { upper, lower, base, is_face: points > 2, margin } }
    }
}

/// Orders supports by the slot of the upper body, keeping their order.
fn order_by_upper(supports: &[Support], slots: usize, begins: &mut Vec<u32>, by_upper: &mut Vec<u32>) {
    begins.clear();
    begins.resize(slots + 2, 0);
    let upper = |support: &Support| Some(support.upper as usize).filter(|_| support.upper != NONE);
    supports.iter().filter_map(upper).for_each(|upper| begins[upper + 2] += 1);
    for slot in 2..begins.len() {
        begins[slot] += begins[slot - 1];
    }
    by_upper.clear();
    by_upper.resize(supports.len(), 0);
    for (index, upper) in supports.iter().enumerate().filter_map(|(index, it)| Some((index, upper(it)?))) {
        let place = &mut begins[upper + 1];
        by_upper[*place as usize] = index as u32;
        *place += 1;
    }
}
