//! The angular momentum that free bodies lose when the second net puts them back, and get again.
//!
//! A body is put back along the chord of its way. Where a contact had bent that way, its momentum
//! is not along the chord, and about any point there is less or more of it than before.

use glam::{DMat3, DVec3};

use crate::collision::islands::Islands;
use crate::collision::traveller::Traveller;
use crate::storage::body_index::Slot;
use crate::storage::world_columns::WorldColumns;

/// Bodies may have this times the energy that they had when they get angular momentum, ...
const MAX_GROWTH: f64 = 2.0;
/// ... and get no less than this part of it.
const MIN_PART: f64 = 1e-3;
/// How exactly bodies that turn as one have the angular momentum, as a part of it: points in a line
/// cannot have any about that.
const EXACTNESS: f64 = 1e-6;

/// Memory of what is lost; nothing in it outlives a substep. Numbers of travellers are the slots of
/// groups.
#[derive(Clone, Default)]
pub(crate) struct LostMomentum {
    /// Position and momenta of each traveller that is free, before any is stopped.
    before: Vec<Option<[DVec3; 3]>>,
    groups: Islands,
    /// Each traveller of a group after the lowest of the group.
    members: Vec<[Slot; 2]>,
    bodies: Vec<Body>,
}

/// A traveller of a group.
#[derive(Clone)]
struct Body {
    traveller: usize,
    position: DVec3,
    mass: f64,
    inertia: DMat3,
}

impl LostMomentum {
    /// To be called before any is stopped.
    pub(crate) fn begin(&mut self, travellers: &[Traveller], columns: &WorldColumns<'_>) {
        self.before.clear();
        self.before.extend(travellers.iter().map(|it| it.motion(travellers, columns)));
    }

    /// Gives free bodies that stopped each other, and nothing else, the angular momentum that they
    /// had. Each pair of `stopped` is a traveller that was stopped, after what stopped it.
    pub(crate) fn give_back(
        &mut self,
        travellers: &[Traveller],
        stopped: &mut [[Slot; 2]],
        columns: &mut WorldColumns<'_>,
    ) {
        let Self { before, groups, members, bodies } = self;
        groups.join(travellers.len(), stopped.iter().copied(), |_| true);
        members.clear();
        members.extend(stopped.iter().flatten().map(|it| [groups.root(*it), *it]));
        members.sort_unstable();
        members.dedup();
        stopped.sort_by_key(|pair| groups.root(pair[0]));
        let pairs = stopped.chunk_by(|a, b| groups.root(a[0]) == groups.root(b[0]));
        for (group, pairs) in members.chunk_by(|a, b| a[0] == b[0]).zip(pairs) {
            let members = || group.iter().map(|[_, it]| it.index());
            let Some(lost) = lost(members(), before, travellers, columns) else { continue };
            bodies.clear();
            bodies.extend(members().filter_map(|number| Body::of(number, travellers, columns)));
            if let Some(turn) = Turn::with(bodies, lost) {
                turn.give(travellers, pairs, columns);
            }
        }
    }
}

/// What bodies have lost of their angular momentum [kg m^2/s]; `None` where one is not free.
fn lost(
    members: impl Iterator<Item = usize> + Clone,
    before: &[Option<[DVec3; 3]>],
    travellers: &[Traveller],
    columns: &WorldColumns<'_>,
) -> Option<DVec3> {
    // About one of them: about what is far away, rounding of linear momenta would count.
    let about = members.clone().find_map(|it| before[it]).map_or(DVec3::ZERO, |[position, ..]| position);
    let momentum = |[position, linear, spin]: [DVec3; 3]| (position - about).cross(linear) + spin;
    members.into_iter().try_fold(DVec3::ZERO, |lost, it| {
        Some(lost + momentum(before[it]?) - momentum(travellers[it].motion(travellers, columns)?))
    })
}

impl Body {
    fn of(traveller: usize, travellers: &[Traveller], columns: &WorldColumns<'_>) -> Option<Self> {
        let [position, ..] = travellers[traveller].motion(travellers, columns)?;
        let (mass, inertia) = travellers[traveller].mass_and_inertia(columns)?;
        Some(Self { traveller, position, mass, inertia })
    }
}

/// Bodies that turn as one, which of all ways to have an angular momentum takes the least energy.
struct Turn<'a> {
    bodies: &'a [Body],
    /// Their centre of mass \[m\].
    center: DVec3,
    /// [rad/s]
    angular: DVec3,
}

impl<'a> Turn<'a> {
    /// With an angular momentum; `None` where they cannot have it.
    fn with(bodies: &'a [Body], momentum: DVec3) -> Option<Self> {
        let mass: f64 = bodies.iter().map(|it| it.mass).sum();
        let center = bodies.iter().map(|it| it.position * it.mass).sum::<DVec3>() / mass;
        let inertia = bodies.iter().fold(DMat3::ZERO, |sum, it| {
            let arm = it.position - center;
            let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
            sum + it.inertia + (DMat3::from_diagonal(DVec3::splat(arm.length_squared())) - outer) * it.mass
        });
        let angular = inertia.inverse() * momentum;
        let is_exact = (inertia * angular - momentum).length() <= EXACTNESS * momentum.length();
        is_exact.then_some(Self { bodies, center, angular })
    }

    /// Gives bodies the turn, or a part of it where it would take more energy than there is; what
    /// energy that gives is taken out along lines between centres, which turns nothing.
    fn give(&self, travellers: &[Traveller], pairs: &[[Slot; 2]], columns: &mut WorldColumns<'_>) {
        let members = || self.bodies.iter().map(|it| &travellers[it.traveller]);
        let energy = |columns: &WorldColumns<'_>| members().filter_map(|it| it.energy(columns)).sum::<f64>();
        let before: f64 = members().filter_map(Traveller::energy_before).sum();
        self.add(1.0, travellers, columns);
        let mut part = 1.0;
        while energy(columns) > MAX_GROWTH * before && part > MIN_PART {
            part *= 0.5;
            self.add(-part, travellers, columns);
        }
        let mut excess = energy(columns) - before;
        for pair in pairs {
            excess -= self.slow_along_line(pair.map(Slot::index), travellers, columns, excess);
        }
    }

    fn add(&self, part: f64, travellers: &[Traveller], columns: &mut WorldColumns<'_>) {
        for Body { traveller, position, mass, inertia } in self.bodies {
            let impulse = self.angular.cross(*position - self.center) * (part * mass);
            travellers[*traveller].add_momentum([impulse, *inertia * self.angular * part], columns);
        }
    }

    /// Takes up to an `excess` of energy \[J\] out of the motion of two of the bodies along the
    /// line between their centres of mass; returns how much.
    fn slow_along_line(
        &self,
        pair: [usize; 2],
        travellers: &[Traveller],
        columns: &mut WorldColumns<'_>,
        excess: f64,
    ) -> f64 {
        let [first, second] = pair.map(|it| &travellers[it]);
        // The bodies are in the order of their travellers.
        let inverse_mass = |it: usize| {
            let place = self.bodies.binary_search_by_key(&it, |body| body.traveller).ok()?;
            Some(1.0 / self.bodies[place].mass)
        };
        let motions = first.motion(travellers, columns).zip(second.motion(travellers, columns));
        let (Some(m), Some(n), Some(([a, p, _], [b, q, _]))) = (inverse_mass(pair[0]), inverse_mass(pair[1]), motions)
        else {
            return 0.0;
        };
        let (line, mass) = ((b - a).normalize_or_zero(), 1.0 / (m + n));
        let speed = line.dot(q * n - p * m);
        let taken = excess.min(0.5 * mass * speed * speed).max(0.0);
        let slower = speed.signum() * (speed * speed - 2.0 * taken / mass).max(0.0).sqrt();
        let impulse = line * ((slower - speed) * mass);
        first.add_momentum([-impulse, DVec3::ZERO], columns);
        second.add_momentum([impulse, DVec3::ZERO], columns);
        taken
    }
}
