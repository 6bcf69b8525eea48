//! Where a collider is in a substep, and how its body moves on.

use tumble_collide::{Aabb, ColliderShape, Isometry, Proxy};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::narrow_phase::{LaneKind, ShapeLanes};
use crate::math::Real;
use crate::storage::body_index::{Slot, by_new_slot};

/// By slot: where bodies with colliders are in this substep.
#[derive(Clone, Default)]
pub(crate) struct ColliderStates {
    pub(crate) states: Vec<ColliderState>,
    /// Apart from the states, for most are asked no more.
    pub(crate) activity: Vec<Activity>,
    pub(crate) proxies: Vec<Proxy<Real>>,
    /// The same, larger by what sensors look ahead; empty where there are none.
    pub(crate) sensed_proxies: Vec<Proxy<Real>>,
    pub(crate) lanes: ShapeLanes,
}

impl ColliderStates {
    /// What the broad phase searches: the proxies that hold the others.
    pub(crate) fn searched(&self) -> &[Proxy<Real>] {
        if self.sensed_proxies.is_empty() { &self.proxies } else { &self.sensed_proxies }
    }

    /// Gives the states the slots that their bodies have now; `slots` are these by slot before.
    pub(crate) fn renumber(&mut self, slots: &[Slot], count: usize) {
        self.states = by_new_slot(std::mem::take(&mut self.states), slots, count, ColliderState::NOWHERE);
    }
}

/// What a body with a collider does in a substep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Activity {
    /// It is dynamic and awake.
    Awake,
    /// It is dynamic but sleeps, and is taken for one that is not.
    Asleep,
    /// It is not dynamic, or has no collider.
    NotDynamic,
}

/// Where a body with a collider is at the start of a step.
#[derive(Clone, Copy)]
pub(crate) struct ColliderState {
    pub(crate) placement: Isometry<Real>,
    /// Centre of mass \[m\].
    pub(crate) center: Vec3<Real>,
    pub(crate) kind: LaneKind,
    /// Whether the body is dynamic and awake, and whether it is fixed.
    pub(crate) is_dynamic: bool,
    pub(crate) is_fixed: bool,
    /// How far from its surface another's may be to be a contact, with the other's reach added
    /// \[m\].
    pub(crate) reach: Real,
    /// The same without what its velocity adds \[m\]; zero for non-dynamic bodies.
    pub(crate) margin: Real,
    /// Of its collider where that is thinnest \[m\].
    pub(crate) half_thickness: Real,
    /// Linear and angular, of non-dynamic bodies [m/s] [rad/s].
    pub(crate) velocity: (Vec3<Real>, Vec3<Real>),
    pub(crate) motion: Motion,
}

/// How a body with a collider moves without contacts, through a step and one more substep: so far
/// contacts look ahead.
#[derive(Clone, Copy)]
pub(crate) struct Motion {
    /// How far its centre of mass goes as it goes at the start \[m\].
    pub(crate) way: Vec3<Real>,
    /// How much further gravity takes it \[m\]; zero where that is little beside its thickness.
    pub(crate) drop: Vec3<Real>,
    /// By which angle it turns, about this direction \[rad\]; zero where that is negligible.
    pub(crate) turn: Vec3<Real>,
    /// By which angle its axis turns \[rad\], of what is symmetric about one through its centre of
    /// mass: turning about that moves nothing of its outside.
    pub(crate) axis_turn: Option<Real>,
    /// How far from its centre of mass its collider reaches \[m\].
    pub(crate) radius: Real,
}

impl Motion {
    pub(crate) const NONE: Self = {
        let zero = Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        Self { way: zero, drop: zero, turn: zero, axis_turn: None, radius: 0.0 }
    };
}

impl ColliderState {
    /// The proxy of nothing, which is nowhere.
    pub(crate) fn no_proxy() -> Proxy<Real> {
        Proxy { aabb: Some(Aabb::about(Vec3::splat(Real::NAN), Vec3::zero())), moves: false }
    }

    /// Its proxy in the broad phase.
    pub(crate) fn proxy(&self, geometry: &ColliderShape<Real>, moves: bool) -> Proxy<Real> {
        Proxy { aabb: geometry.aabb(&self.placement, self.reach), moves }
    }

    /// Known by its centre of mass alone.
    pub(crate) fn at_center([x, y, z]: [Real; 3]) -> Self {
        Self { center: Vec3::new(x, y, z), ..Self::NOWHERE }
    }

    pub(crate) fn center(&self) -> [Real; 3] {
        [self.center.x, self.center.y, self.center.z]
    }

    pub(crate) const NOWHERE: Self = {
        let zero = Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        let orientation = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        Self {
            placement: Isometry { position: zero, orientation },
            center: zero,
            kind: LaneKind::Other,
            is_dynamic: false,
            is_fixed: false,
            reach: 0.0,
            margin: 0.0,
            half_thickness: 0.0,
            velocity: (zero, zero),
            motion: Motion::NONE,
        }
    };
}
