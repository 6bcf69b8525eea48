//! Layers: bodies side by side that what rests on them ties to each other.

use tumble_math::lane::Vec3;

use crate::collision::islands::Islands;
use crate::math::Real;
use crate::solver::stack::load_order::LoadOrder;
use crate::solver::stack::supports::{Base, StackBody, Support};
use crate::storage::body_index::Slot;

/// Bodies that are tied by bodies which rest on several of them.
///
/// Where all bodies of such a pile tilt alike, each that rests on several is lifted by some and
/// sinks into others: it resists tilting, whatever it rests on does. So these bodies are not links
/// of a column. Their layers as a whole are, and tilt about all that bears them.
#[derive(Clone, Default)]
pub(super) struct Layers {
    tied: Islands,
    /// By slot, the lowest slot of its layer.
    roots: Vec<Slot>,
    order: LoadOrder,
    /// By the lowest slot: whether none of the layer rests on another of it, nor it and others on
    /// each other.
    is_even: Vec<bool>,
    /// By the lowest slot.
    joints: Vec<Joint>,
}

/// What a layer rests on.
#[derive(Clone, Copy)]
struct Joint {
    /// The sum of `W H / k` over the joints of layers from the top.
    lean: Real,
    /// Weight of the layer and of what it bears \[N\], and their moment about height zero [N m].
    weight: Real,
    moment: Real,
    /// From the centre of the body with the lowest slot.
    base: Base,
}

/// The bodies of a world and how they rest on each other.
#[derive(Clone, Copy)]
pub(super) struct Pile<'a> {
    pub(super) bodies: &'a [StackBody],
    pub(super) supports: &'a [Support],
    pub(super) order: &'a LoadOrder,
    pub(super) up: Vec3<Real>,
    pub(super) sides: [Vec3<Real>; 2],
}

impl Pile<'_> {
    pub(super) fn is_dynamic(&self, slot: Slot) -> bool {
        self.bodies[slot.index()].is_dynamic > 0.0
    }

    /// The contacts that bear a body, and the body below.
    pub(super) fn supports_of(&self, slot: Slot) -> impl Iterator<Item = (&Support, Slot)> {
        self.order.supports_of(slot).iter().map(|(contact, lower)| (&self.supports[*contact as usize], *lower))
    }

    /// The horizontal way and the height from a body's centre to another's.
    fn way(&self, from: Slot, to: Slot) -> ([Real; 2], Real) {
        let way = self.bodies[to.index()].center - self.bodies[from.index()].center;
        (self.sides.map(|side| side.dot(way)), self.up.dot(way))
    }

    /// How a body resists tilting as much as all that it rests on [N m]: what is lifted or sinks in
    /// is as far from it as what it rests on.
    fn resistance(&self, slot: Slot) -> Real {
        let mut base = Base::NONE;
        for (support, lower) in self.supports_of(slot).filter(|(_, lower)| self.is_dynamic(*lower)) {
            base.add(&Base::at(self.way(slot, lower).0, support.signed_stiffness.abs()));
        }
        if base.stiffness > 0.0 { base.least().max(0.0) } else { 0.0 }
    }
}

impl Layers {
    /// Finds the layers; sets by slot how a body resists tilting with what it rests on [N m].
    pub(super) fn find(&mut self, pile: &Pile<'_>, resistances: &mut [Real]) {
        self.tie(pile);
        for slot in pile.order.slots() {
            let even = pile.supports_of(*slot).all(|(_, lower)| self.is_even[self.roots[lower.index()].index()]);
            resistances[slot.index()] = if even { pile.resistance(*slot) } else { 0.0 };
        }
    }

    fn tie(&mut self, pile: &Pile<'_>) {
        let Self { tied, roots, order, is_even, .. } = self;
        let slots = pile.bodies.len();
        let ties = pile.order.slots().iter().flat_map(|slot| {
            let below = pile.order.supports_of(*slot).iter().map(|(_, lower)| *lower);
            let moving = below.filter(|lower| pile.is_dynamic(*lower));
            moving.clone().zip(moving.skip(1)).map(<[Slot; 2]>::from)
        });
        tied.join(slots, ties, |_| true);
        roots.clear();
        roots.extend((0..slots as u32).map(|slot| tied.root(Slot(slot))));
        let root = |slot: Slot| if slot == Slot::NONE { slot } else { roots[slot.index()] };
        let pairs = pile.order.pairs().iter().map(|pair| pair.map(root));
        let apart = pairs.clone().map(|[upper, lower]| if upper == lower { [Slot::NONE; 2] } else { [upper, lower] });
        order.sort(apart, slots);
        is_even.clear();
        is_even.resize(slots, true);
        order.slots().iter().for_each(|slot| is_even[slot.index()] = false);
        order.slots_before_rings().iter().for_each(|slot| is_even[slot.index()] = true);
        for [upper, _] in pairs.filter(|[upper, lower]| upper == lower && *upper != Slot::NONE) {
            is_even[upper.index()] = false;
        }
    }

    /// Sums `W H / k` over layers, from the loads that bodies are under: weight, and moment about
    /// height zero.
    pub(super) fn sum_leans(&mut self, pile: &Pile<'_>, load: impl Fn(Slot) -> [Real; 2]) {
        let Self { roots, order, is_even, joints, .. } = self;
        joints.clear();
        joints.resize(pile.bodies.len(), Joint { lean: 0.0, weight: 0.0, moment: 0.0, base: Base::NONE });
        for slot in pile.order.slots() {
            let root = roots[slot.index()];
            let (aside, up) = pile.way(root, *slot);
            let ([weight, moment], joint) = (load(*slot), &mut joints[root.index()]);
            (joint.weight, joint.moment) = (joint.weight + weight, joint.moment + moment);
            for (support, _) in pile.supports_of(*slot) {
                joint.base.add(&Base::of(support).moved(aside, up));
            }
        }
        for root in order.slots_before_rings() {
            let joint = &mut joints[root.index()];
            if is_even[root.index()] && joint.base.stiffness > 0.0 {
                let height = pile.bodies[root.index()].center.dot(pile.up);
                let lever = joint.base.lever([joint.weight, joint.moment], height);
                joint.lean += joint.base.lean(lever);
            }
            let lean = joint.lean;
            for (_, lower) in order.supports_of(*root) {
                let below = &mut joints[lower.index()];
                below.lean = below.lean.max(lean);
            }
        }
    }

    /// These sums, each with a slot of the layer.
    pub(super) fn leans(&self) -> impl Iterator<Item = (Slot, Real)> {
        self.order.slots_before_rings().iter().map(|root| (*root, self.joints[root.index()].lean))
    }
}
