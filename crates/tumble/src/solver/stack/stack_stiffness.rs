//! How stiff contacts have to be for what is stacked on them to stand.

use rayon::prelude::*;
use tumble_math::lane::Vec3;

use crate::collision::contact::{ContactRecord, MAX_HALVINGS};
use crate::collision::islands::Islands;
use crate::collision::pipeline::PART;
use crate::math::Real;
use crate::settings::Settings;
use crate::simd::{HALF_BLOCK, Octet, dispatch_in_blocks};
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::solver::contact::softness::Softness;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::solver::stack::layers::{Layers, Pile};
use crate::solver::stack::load_order::LoadOrder;
use crate::solver::stack::supports::{Base, Bear, StackBody, Support, sides, upper_and_lower};
use crate::storage::body_index::Slot;
use crate::threads::InParts;

/// The loads of a world's bodies on each other under gravity, and the islands that need shorter
/// substeps to bear them.
///
/// A contact is a spring whose stiffness goes with the square of the substeps' rate. A column of
/// such springs buckles when the moment of what leans beats their resistance to tilting: for one
/// joint when `W H > k`, with the weight `W` of all that is above, the height `H` of its centre
/// over the joint and the rotational stiffness `k`; for joints in series when the sum of `W H / k`
/// is about one (Euler's column under its own weight: 1.3). What is laid in bond is stiffer: see
/// [`Layers`].
#[derive(Clone, Default)]
pub(crate) struct Stacks {
    /// By slot.
    bodies: Vec<StackBody>,
    /// By contact; in whole blocks.
    supports: Vec<Support>,
    /// By slot.
    loads: Vec<Load>,
    /// By slot, how a body resists tilting with what it rests on [N m].
    resistances: Vec<Real>,
    order: LoadOrder,
    layers: Layers,
    islands: Islands,
    /// By slot of an island's root, how often its substeps were halved before.
    before: Vec<u8>,
}

/// The load on a body.
#[derive(Clone, Copy, Default)]
struct Load {
    /// Weight of it and of what it bears \[N\], and their moment about height zero [N m].
    weight: Real,
    moment: Real,
    /// The moment of what it bears about the joints of that [N m].
    borne: Real,
    /// How much of the moment about its joint layers resist [N m].
    resisted: Real,
    /// The stiffness that is needed, over that which there is, if no layer resists anything.
    as_column: Real,
    /// Sum of `W H / k` over the joints from the top.
    lean: Real,
    /// The stiffness that is needed, over that which there is.
    need: Real,
}

/// Least `k / (W H)` of a column that is left as it is: it buckles at 1/1.3.
const MIN_STIFFNESS: Real = 1.25;
/// Least `k / (W H)`. Layers of several blocks side by side still shake at half of it.
const STIFFNESS: Real = 2.5;
/// How deep \[margins\] a body in a stack may be pressed in by its load: a tenth of half its
/// thickness.
const MAX_DEPTH: Real = 5.0;
/// Of the moment at which bodies of a layer would tilt with each other, the part under which they
/// do not shake.
const INTERLOCK: Real = 0.05;
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
        self.resistances.clear();
        self.resistances.resize(slots, 0.0);
        if g == 0.0 || contacts.is_empty() {
            return false;
        }
        let up = gravity * (-1.0 / g);
        let sides = sides(up);
        self.read_bodies(constrained, bodies, sides);
        self.find_supports(contacts, (up, sides), settings);
        // That layers are stiffer matters only where columns would not be stiff enough.
        let as_columns = self.sum_loads((up, sides), g);
        if as_columns <= 1.0 && !contacts.iter().any(|contact| contact.halvings() > 0) {
            return false;
        }
        let Self { bodies, supports, loads, order, layers, resistances, .. } = self;
        loads.iter_mut().for_each(|load| *load = Load { as_column: needed(load.lean), ..Load::default() });
        layers.find(&Pile { bodies, supports, order, up, sides }, resistances);
        let most = self.sum_loads((up, sides), g);
        self.add_layers((up, sides)).max(most) > 1.0
    }

    /// Adds what layers need as a whole; returns the most.
    fn add_layers(&mut self, (up, sides): (Vec3<Real>, [Vec3<Real>; 2])) -> Real {
        let Self { bodies, supports, loads, order, layers, .. } = self;
        let of_body = |slot: Slot| {
            let Load { weight, moment, .. } = loads[slot.index()];
            [weight, moment]
        };
        layers.sum_leans(&Pile { bodies, supports, order, up, sides }, of_body);
        let mut most = 0.0;
        for (slot, lean) in layers.leans() {
            let need = &mut loads[slot.index()].need;
            *need = needed(lean).max(*need);
            most = need.max(most);
        }
        most
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
    fn find_supports(
        &mut self,
        contacts: &[ContactRecord],
        (up, sides): (Vec3<Real>, [Vec3<Real>; 2]),
        settings: &Settings,
    ) {
        let Self { bodies, supports, order, .. } = self;
        let bodies = &**bodies;
        supports.resize(contacts.len().next_multiple_of(HALF_BLOCK), Support::ZERO);
        let rates = Softness::stiffness(settings.contact_substep().into());
        let parts = supports.par_chunks_mut(PART).zip(contacts.par_chunks(PART));
        parts.by_at_least(2).for_each(|(supports, contacts)| {
            dispatch_in_blocks(&mut Bear { supports, contacts, bodies, up, sides, rates });
        });
        let pairs = supports.iter().zip(contacts);
        order.sort(pairs.map(|(support, contact)| upper_and_lower(support, contact.slots)), bodies.len());
    }

    /// Sums loads from the top down; returns the stiffness that is needed most, over that which
    /// there is.
    fn sum_loads(&mut self, (up, sides): (Vec3<Real>, [Vec3<Real>; 2]), g: Real) -> Real {
        let Self { bodies, supports, loads, order, resistances, .. } = self;
        let pile = Pile { bodies, supports, order, up, sides };
        let mut most = 0.0;
        for slot in order.slots().iter().copied() {
            let StackBody { center, inverse_mass, .. } = pile.bodies[slot.index()];
            let height = center.dot(up);
            let load = &mut loads[slot.index()];
            let mut base = Base::NONE;
            let mut is_stacked = load.weight > 0.0;
            for (support, lower) in pile.supports_of(slot) {
                base.add(&Base::of(support));
                is_stacked |= pile.is_dynamic(lower);
            }
            let own = g / inverse_mass;
            load.weight += own;
            load.moment += own * height;
            let lever = base.lever([load.weight, load.moment], height);
            let own_lever = (lever - load.borne).max(0.0);
            let shear = own_lever / (INTERLOCK * resistances[slot.index()]);
            let is_tied = shear <= load.as_column.max(1.0);
            load.resisted += if is_tied { own_lever } else { 0.0 };
            load.lean += base.lean(lever - load.resisted);
            let depth = if is_stacked { load.weight / (base.stiffness * base.margin) } else { 0.0 };
            load.need = needed(load.lean).max(depth / MAX_DEPTH).max(if is_tied { shear } else { 0.0 });
            most = load.need.max(most);
            let Load { weight, moment, resisted, lean, .. } = *load;
            for (support, lower) in pile.supports_of(slot) {
                let share = support.signed_stiffness.abs() / base.stiffness;
                let below = &mut loads[lower.index()];
                below.weight += share * weight;
                below.moment += share * moment;
                below.borne += share * lever;
                below.resisted += share * resisted;
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

/// The stiffness that a sum of `W H / k` needs, over that which there is.
fn needed(lean: Real) -> Real {
    let stands = lean * MIN_STIFFNESS <= 1.0;
    lean * if stands { MIN_STIFFNESS } else { STIFFNESS }
}

/// How often substeps must be halved for contacts that have to be stiffer by a factor.
fn halvings_for(need: Real) -> u8 {
    (0..MAX_HALVINGS).take_while(|times| need > (1u32 << (2 * times)) as Real).count() as u8
}
