//! Impulses of springs between bodies in a kick.

use rayon::prelude::*;
use tumble_math::lane::{Lane, Vec3};

use crate::forces::pairwise::Spring;
use crate::forces::spring_potential::{End, Hooke, pull};
use crate::forces::stable_spring::{MAX_ANGLE, MAX_ANGLE_IN_A_NET, stable_damping};
use crate::math::Real;
use crate::range::{MAX_IMPULSE, MAX_SPEED, within};
use crate::storage::body_index::{BodyIndex, BodyView, Slot};
use crate::threads::InParts;

/// A spring and the slots of its bodies.
#[derive(Clone, Copy)]
struct Connection {
    slots: [usize; 2],
    spring: Spring,
}

/// A spring in a kick, before velocities are known.
#[derive(Clone, Copy)]
struct Pull {
    slots: [usize; 2],
    /// From one attachment to the other, of unit length.
    direction: Vec3<Real>,
    /// From the centres of mass to the attachments \[m\].
    arms: [Vec3<Real>; 2],
    /// Of the elongation [N s].
    impulse: Real,
    /// Beside it, what draws the arms in: on the first body [N s],
    drawing: Vec3<Real>,
    /// and the angular impulses on both [N m s].
    drawing_turns: [Vec3<Real>; 2],
    /// Over the speed of elongation \[kg\].
    damping: Real,
}

/// Changes of linear [kg m/s] and angular [kg m^2/s] momentum.
#[derive(Clone, Copy)]
pub(crate) struct Impulse {
    pub(crate) linear: Vec3<Real>,
    pub(crate) angular: Vec3<Real>,
}

impl Impulse {
    pub(crate) fn zero() -> Self {
        Self { linear: Vec3::zero(), angular: Vec3::zero() }
    }
}

/// The springs between bodies, in the order of their bodies' slots.
#[derive(Clone, Default)]
pub(crate) struct Springs {
    connections: Vec<Connection>,
    /// Where each slot's entries in `ends` begin, and where the last one's end.
    first_end: Vec<usize>,
    /// For each slot its springs, in order: the spring's index, and which end of it.
    ends: Vec<(usize, usize)>,
    pulls: Vec<Pull>,
    /// The impulses of each spring on its bodies.
    impulses: Vec<[Impulse; 2]>,
}

/// Springs that are computed by one thread at a time.
const PART: usize = 1024;

impl Springs {
    /// Reads the springs of a world; those whose bodies are not there, or one and the same,
    /// are left out.
    pub(crate) fn find(&mut self, world: &hecs::World, body_index: &BodyIndex) {
        self.connections.clear();
        for archetype in world.archetypes() {
            let Some(springs) = archetype.get::<&Spring>() else { continue };
            let pulls = |spring: &&Spring| spring.stiffness != 0.0 || spring.damping != 0.0;
            let is_there = |spring: &&Spring| spring.bodies.iter().all(|body| world.contains(*body));
            for spring in springs.iter().filter(pulls).filter(is_there) {
                let [a, b] = spring.bodies.map(|body| body_index.slot(body.id()).map(Slot::index));
                if let (Some(a), Some(b)) = (a, b)
                    && a != b
                {
                    self.connections.push(Connection { slots: [a, b], spring: *spring });
                }
            }
        }
        if !self.connections.is_sorted_by(|a, b| a.order() < b.order()) {
            self.connections.sort_unstable_by_key(Connection::order);
        }
        self.list_ends(body_index.len());
    }

    /// Sorts the springs' ends by slot, the springs of each in their order.
    fn list_ends(&mut self, slots: usize) {
        self.first_end.clear();
        self.first_end.resize(slots + 1, 0);
        for slot in self.connections.iter().flat_map(|connection| connection.slots) {
            self.first_end[slot + 1] += 1;
        }
        for slot in 0..slots {
            self.first_end[slot + 1] += self.first_end[slot];
        }
        self.ends.clear();
        self.ends.resize(2 * self.connections.len(), (0, 0));
        for (index, connection) in self.connections.iter().enumerate() {
            for (end, &slot) in connection.slots.iter().enumerate() {
                self.ends[self.first_end[slot]] = (index, end);
                self.first_end[slot] += 1;
            }
        }
        // Each beginning has moved to its end, which is the beginning of the next.
        self.first_end.rotate_right(1);
        self.first_end[0] = 0;
    }

    /// Whether any spring is damped in this kick, so that what it does depends on velocities.
    pub(crate) fn are_damped(&self) -> bool {
        self.pulls.iter().any(|pull| pull.damping != 0.0)
    }

    /// Finds out how each spring pulls in a kick of the duration `t` \[s\], in substeps of `h`
    /// \[s\].
    pub(crate) fn prepare(&mut self, body_index: &BodyIndex, t: Real, h: Real) {
        let Self { connections, first_end, pulls, .. } = self;
        let springs_of = |slot: usize| (first_end[slot + 1] - first_end[slot]) as Real;
        pulls.clear();
        pulls.resize(connections.len(), Pull::none());
        let parts = pulls.par_chunks_mut(PART).zip(connections.par_chunks(PART));
        parts.by_at_least(1).for_each(|(pulls, connections)| {
            for (pull, connection) in pulls.iter_mut().zip(connections) {
                let shares = connection.slots.map(springs_of);
                let bodies = connection.slots.map(|slot| &body_index.views[slot]);
                *pull = Some(connection.pull(bodies, shares, t, h))
                    .filter(|pull| pull.is_in_range() && bodies.iter().all(|view| view.is_in_range()))
                    .unwrap_or(Pull::none());
            }
        });
    }

    /// Computes what the springs do to bodies that have these velocities.
    pub(crate) fn update(&mut self, velocities: &[Velocities]) {
        self.impulses.resize(self.pulls.len(), [Impulse::zero(); 2]);
        let parts = self.impulses.par_chunks_mut(PART).zip(self.pulls.par_chunks(PART));
        parts.by_at_least(1).for_each(|(impulses, pulls)| {
            for (impulse, pull) in impulses.iter_mut().zip(pulls) {
                *impulse = pull.impulses(velocities);
            }
        });
    }

    /// The impulse of all springs on a body.
    pub(crate) fn impulse(&self, slot: usize) -> Impulse {
        let mut sum = Impulse::zero();
        for &(index, end) in &self.ends[self.first_end[slot]..self.first_end[slot + 1]] {
            let Impulse { linear, angular } = self.impulses[index][end];
            sum = Impulse { linear: sum.linear + linear, angular: sum.angular + angular };
        }
        sum
    }
}

impl Connection {
    /// Equal only for springs that do the same.
    fn order(&self) -> ([usize; 2], [u64; 9]) {
        let Spring { attachments: [a, b], rest_length, stiffness, damping, .. } = self.spring;
        let numbers = [a.x, a.y, a.z, b.x, b.y, b.z, rest_length, stiffness, damping];
        (self.slots, numbers.map(|number| u64::from(number.to_bits())))
    }

    /// Its impulse in a kick over the time `t` in substeps of `h`. Each body lends the spring its
    /// share of mass and inertia, one part for every spring that it has. What the spring moves is
    /// taken at its lightest, so that it does not depend on attitude: a stiffness that changes as
    /// bodies turn has no potential, and energy would not come back.
    fn pull(&self, [a, b]: [&BodyView; 2], shares: [Real; 2], t: Real, h: Real) -> Pull {
        let spring = &self.spring;
        let end = |view: &BodyView, at: crate::math::Vec3, share: Real| {
            let moving = view.inverse_mass * share;
            let turning = (view.most_inverse_mass_at(at) * share - moving).max(0.0);
            End { arm: view.state.orientation.rotate(at.into()), inverse_masses: [moving, turning] }
        };
        let [at_a, at_b] = spring.attachments;
        let ends = [end(a, at_a, shares[0]), end(b, at_b, shares[1])];
        let in_a_net =
            [(a, shares[0]), (b, shares[1])].iter().any(|(view, share)| view.constants.is_some() && *share > 1.0);
        let most_angle = Real::splat(if in_a_net { MAX_ANGLE_IN_A_NET } else { MAX_ANGLE });
        let hooke = Hooke { stiffness: spring.stiffness, rest_length: spring.rest_length, h };
        let pull = pull(hooke, b.state.position - a.state.position, ends, most_angle);
        let inverse_mass: Real = ends.iter().flat_map(|end| end.inverse_masses).sum();
        let damping = stable_damping(spring.damping, inverse_mass, t) * t + pull.damping;
        Pull {
            slots: self.slots,
            direction: pull.direction,
            arms: pull.arms,
            impulse: pull.tension * t,
            drawing: pull.drawing * t,
            drawing_turns: pull.drawing_torques.map(|torque| torque * t),
            damping: damping.min(1.0 / inverse_mass),
        }
    }
}

impl Pull {
    fn none() -> Self {
        let zero = Vec3::zero();
        let (impulse, damping) = (0.0, 0.0);
        let (arms, drawing_turns) = ([zero; 2], [zero; 2]);
        Self { slots: [0; 2], direction: zero, arms, impulse, drawing: zero, drawing_turns, damping }
    }

    fn is_in_range(&self) -> bool {
        let arms = self.arms.iter().all(|arm| within(*arm, MAX_SPEED));
        let impulse = self.impulse.abs() <= MAX_IMPULSE && (0.0..=MAX_IMPULSE).contains(&self.damping);
        let turns = self.drawing_turns.iter().all(|turn| within(*turn, MAX_IMPULSE));
        arms && impulse && turns && within(self.drawing, MAX_IMPULSE) && within(self.direction, 2.0)
    }

    fn impulses(&self, velocities: &[Velocities]) -> [Impulse; 2] {
        if self.impulse == 0.0 && self.damping == 0.0 {
            // One of the bodies may be one whose velocity is no number.
            return [Impulse::zero(); 2];
        }
        let [at_a, at_b] = [0, 1].map(|end| velocities[self.slots[end]].at(self.arms[end]));
        let impulse = self.impulse + self.damping * self.direction.dot(at_b - at_a);
        let (on_a, on_b) = (self.direction * impulse, self.direction * -impulse);
        [
            Impulse { linear: on_a + self.drawing, angular: self.arms[0].cross(on_a) + self.drawing_turns[0] },
            Impulse { linear: on_b - self.drawing, angular: self.arms[1].cross(on_b) + self.drawing_turns[1] },
        ]
    }
}

impl BodyView {
    /// As that of [`Constants`](crate::integrators::state::Constants); zero for non-dynamic bodies.
    fn most_inverse_mass_at(&self, point_body: crate::math::Vec3) -> Real {
        self.constants.map_or(0.0, |constants| constants.most_inverse_mass_at(point_body.into()))
    }
}

/// Linear [m/s] and angular [rad/s] velocity of a body.
#[derive(Clone, Copy)]
pub(crate) struct Velocities {
    pub(crate) linear: Vec3<Real>,
    pub(crate) angular: Vec3<Real>,
}

impl Velocities {
    /// Those of a body after half of an impulse.
    pub(crate) fn halfway(view: &BodyView, impulse: &Impulse) -> Self {
        let turned = view.derived.apply_inverse_inertia(impulse.angular);
        Self {
            linear: view.derived.linear + impulse.linear * (0.5 * view.inverse_mass),
            angular: view.derived.angular + turned * 0.5,
        }
    }

    /// Of the body's material at `arm` from its centre of mass.
    fn at(&self, arm: Vec3<Real>) -> Vec3<Real> {
        self.linear + self.angular.cross(arm)
    }
}
