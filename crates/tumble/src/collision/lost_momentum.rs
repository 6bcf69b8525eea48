//! The angular momentum that free bodies lose when the second net puts them back, and get again.
//!
//! A body is put back along the chord of its way. Where a contact had bent that way, its momentum
//! is not along the chord, and about any point there is less or more of it than before.

use glam::{DMat3, DVec3};
use tumble_math::parallel_axis;

use crate::collision::islands::Islands;
use crate::collision::traveller::Traveller;
use crate::storage::body_index::Slot;
use crate::storage::world_columns::WorldColumns;

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
        stopped: &[[Slot; 2]],
        columns: &mut WorldColumns<'_>,
    ) {
        let Self { before, groups, members, bodies } = self;
        groups.join(travellers.len(), stopped.iter().copied(), |_| true);
        members.clear();
        members.extend(stopped.iter().flatten().map(|it| [groups.root(*it), *it]));
        members.sort_unstable();
        members.dedup();
        for group in members.chunk_by(|a, b| a[0] == b[0]) {
            let members = || group.iter().map(|[_, it]| it.index());
            let Some(lost) = lost(members(), before, travellers, columns) else { continue };
            bodies.clear();
            bodies.extend(members().filter_map(|number| Body::of(number, travellers, columns)));
            Whole::of(bodies).give(lost, travellers, columns);
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

/// Several bodies as one.
struct Whole<'a> {
    bodies: &'a [Body],
    mass: f64,
    /// Their centre of mass \[m\], and their inertia about it [kg m^2].
    center: DVec3,
    inertia: DMat3,
}

/// A motion of bodies as one, which of all that have its momenta takes the least energy.
struct RigidMotion {
    /// That of the centre of mass [m/s], and about it [rad/s].
    linear: DVec3,
    angular: DVec3,
    /// What it takes \[J\].
    energy: f64,
}

impl<'a> Whole<'a> {
    fn of(bodies: &'a [Body]) -> Self {
        let mass = bodies.iter().map(|it| it.mass).sum();
        let center = bodies.iter().map(|it| it.position * it.mass).sum::<DVec3>() / mass;
        let about_center = |it: &Body| it.inertia + parallel_axis(it.mass, it.position - center);
        let inertia = bodies.iter().fold(DMat3::ZERO, |sum, it| sum + about_center(it));
        Self { bodies, mass, center, inertia }
    }

    /// The motion with a momentum, and with an angular momentum about the centre of mass; `None`
    /// where they cannot have it.
    fn motion(&self, momentum: DVec3, spin: DVec3) -> Option<RigidMotion> {
        let (linear, angular) = (momentum / self.mass, self.inertia.inverse() * spin);
        let energy = 0.5 * (momentum.dot(linear) + spin.dot(angular));
        let is_exact = (self.inertia * angular - spin).length() <= EXACTNESS * spin.length();
        is_exact.then_some(RigidMotion { linear, angular, energy })
    }

    /// The motion with the momenta that they have.
    fn present_motion(&self, travellers: &[Traveller], columns: &WorldColumns<'_>) -> Option<RigidMotion> {
        let motions = self.bodies.iter().filter_map(|it| travellers[it.traveller].motion(travellers, columns));
        let [momentum, spin] = motions.fold([DVec3::ZERO; 2], |[p, l], [position, linear, spin]| {
            [p + linear, l + (position - self.center).cross(linear) + spin]
        });
        self.motion(momentum, spin)
    }

    /// The momenta of one of them in a motion.
    fn momenta(&self, motion: &RigidMotion, body: &Body) -> [DVec3; 2] {
        let velocity = motion.linear + motion.angular.cross(body.position - self.center);
        [velocity * body.mass, body.inertia * motion.angular]
    }

    /// Gives them what they have `lost` of their angular momentum, as far as there is energy for
    /// it: what that takes is taken from how they move relative to moving as one.
    fn give(&self, lost: DVec3, travellers: &[Traveller], columns: &mut WorldColumns<'_>) {
        let both = self.motion(DVec3::ZERO, lost).zip(self.present_motion(travellers, columns));
        let Some((more, now)) = both else { return };
        let members = || self.bodies.iter().map(|it| &travellers[it.traveller]);
        let before: f64 = members().filter_map(Traveller::energy_before).sum();
        // As one with a part of it they have the energy `now + b part + a part^2`.
        let (a, b, c) = (more.energy, now.angular.dot(lost), now.energy - before);
        let most = (-2.0 * c) / (b + (b * b - 4.0 * a * c).max(0.0).sqrt());
        let part = if a + b + c > 0.0 { most.clamp(0.0, 1.0) } else { 1.0 };
        for body in self.bodies {
            travellers[body.traveller].add_momentum(self.momenta(&more, body).map(|it| it * part), columns);
        }
        let energy: f64 = members().filter_map(|it| it.energy(columns)).sum();
        let least = now.energy + (b + a * part) * part;
        if energy > before && energy > least {
            let taken = 1.0 - ((before - least).max(0.0) / (energy - least)).sqrt();
            let as_one = RigidMotion {
                linear: now.linear + more.linear * part,
                angular: now.angular + more.angular * part,
                energy: least,
            };
            for body in self.bodies {
                let Some([_, linear, spin]) = travellers[body.traveller].motion(travellers, columns) else { continue };
                let [p, l] = self.momenta(&as_one, body);
                travellers[body.traveller].add_momentum([(p - linear) * taken, (l - spin) * taken], columns);
            }
        }
    }
}
