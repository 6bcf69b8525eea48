//! A tile's contacts and their bodies, as they are at one moment of the step.

use tumble_math::lane::{Quat, Vec3};

use crate::integrators::derived::symmetric_product;
use crate::simd::block_lanes::vector_at;
use crate::simd::{Rows, Tile};
use crate::solver::body_rows::{BodyMotion, DeltaPose, WarmStartImpulse, WorldInverseInertia};
use crate::solver::contact::constraint::Block;
use crate::solver::contact::effective_mass::Mobility;
use crate::solver::locked_bodies::BlockLocks;

/// The motion of the second body seen from the first, at the middle of the contact: velocities, or
/// displacements.
#[derive(Clone, Copy)]
pub(crate) struct Relative<T> {
    pub(crate) linear: Vec3<T>,
    pub(crate) angular: Vec3<T>,
}

impl<T: Tile> Relative<T> {
    #[inline(always)]
    fn new(linear: [Vec3<T>; 2], angular: [Vec3<T>; 2], arms: [Vec3<T>; 2]) -> Self {
        let first = linear[0] + angular[0].cross(arms[0]);
        let second = linear[1] + angular[1].cross(arms[1]);
        Self { linear: second - first, angular: angular[1] - angular[0] }
    }

    /// With less of a linear velocity.
    #[inline(always)]
    pub(crate) fn less(self, velocity: Vec3<T>) -> Self {
        Self { linear: self.linear - velocity, ..self }
    }
}

/// Where contacts are and which way they look.
pub(crate) struct ContactFrame<T> {
    pub(crate) normal: Vec3<T>,
    pub(crate) tangents: [Vec3<T>; 2],
    /// From the centres of mass of both bodies to the middle of the contact \[m\].
    pub(crate) arms: [Vec3<T>; 2],
}

impl<T: Tile> ContactFrame<T> {
    #[inline(always)]
    pub(crate) fn load<const P: usize, const C: usize>(block: &Block<P, C>, lane: usize) -> Self {
        let normal = vector_at(&block.normal, lane);
        let tangent: Vec3<T> = vector_at(&block.tangent, lane);
        let arms = [vector_at(&block.arms[0], lane), vector_at(&block.arms[1], lane)];
        Self { normal, tangents: [tangent, normal.cross(tangent)], arms }
    }

    /// Along the normal, and about both tangents: what the motion of every point along the normal
    /// is made of.
    #[inline(always)]
    pub(crate) fn normal_parts(&self, motion: &Relative<T>) -> [T; 3] {
        let [first, second] = self.tangents;
        [self.normal.dot(motion.linear), first.dot(motion.angular), second.dot(motion.angular)]
    }
}

/// Motion along the normal at a point of a contact.
#[inline(always)]
pub(crate) fn along_normal<T: Tile>([linear, about_1, about_2]: [T; 3], a: T, b: T) -> T {
    linear - a * about_2 + b * about_1
}

/// How two bodies moved since the step began.
pub(crate) struct DeltaPoses<T> {
    pub(crate) linear: [Vec3<T>; 2],
    pub(crate) rotation: [Quat<T>; 2],
    /// Above zero where one of them has turned by more than its tolerance.
    pub(crate) turned: T,
}

impl<T: Tile> DeltaPoses<T> {
    #[inline(always)]
    pub(crate) fn new([first, second]: [DeltaPose<T>; 2]) -> Self {
        Self {
            linear: [first.translation, second.translation],
            rotation: [first.rotation, second.rotation],
            turned: second.has_turned.max(first.has_turned),
        }
    }

    /// Seen from the first at the middle of the contact, to first order in the angles. Where arms
    /// are those of a meeting, it is the way that their ends go as they turn then: by the angles.
    #[inline(always)]
    pub(crate) fn relative(&self, arms: [Vec3<T>; 2], is_meeting: T::Mask) -> Relative<T> {
        let two = T::splat(2.0);
        let mut turned = [self.rotation[0].vector() * two, self.rotation[1].vector() * two];
        if T::any(is_meeting) {
            let [first, second] = turned;
            let angles = [first * angle_of_chord(first), second * angle_of_chord(second)];
            turned = [Vec3::select(is_meeting, angles[0], first), Vec3::select(is_meeting, angles[1], second)];
        }
        Relative::new(self.linear, turned, arms)
    }
}

/// An angle over its chord, twice the sine of its half: to 1e-3 up to an angle of 1.3 \[rad\].
#[inline(always)]
fn angle_of_chord<T: Tile>(chord: Vec3<T>) -> T {
    let square = chord.dot(chord);
    let (a, b, c) = (T::splat(1.0 / 24.0), T::splat(3.0 / 640.0), T::splat(5.0 / 7168.0));
    T::splat(1.0) + square * (a + square * (b + square * c))
}

/// The locks of a tile's bodies, of its block and from its lane on; none where no body of the world
/// has locked axes.
#[derive(Clone, Copy)]
pub(crate) struct TileLocks<'a>(Option<(&'a BlockLocks, usize)>);

impl<'a> TileLocks<'a> {
    #[inline(always)]
    pub(crate) fn of(locks: &'a [BlockLocks], block: usize, lane: usize) -> Self {
        match locks.get(block) {
            Some(locks) => Self(Some((locks, lane))),
            None => Self(None),
        }
    }

    /// The locked translations of the first and the second bodies: one along a locked axis, else
    /// zero.
    #[inline(always)]
    pub(crate) fn load<T: Tile>(self) -> Option<[Vec3<T>; 2]> {
        let (BlockLocks { translations: [first, second] }, lane) = self.0?;
        Some([vector_at(first, lane), vector_at(second, lane)])
    }

    #[inline(always)]
    pub(crate) fn are_there(self) -> bool {
        self.0.is_some()
    }
}

/// Linear and angular momenta of a tile's bodies. With `has_non_dynamic` only the second of each is
/// dynamic.
pub(crate) struct Momenta<'a, T> {
    has_non_dynamic: bool,
    linear: [Vec3<T>; 2],
    angular: [Vec3<T>; 2],
    locks: TileLocks<'a>,
}

impl<'a, T: Tile> Momenta<'a, T> {
    /// The impulses of a warm start; zero for non-dynamic bodies.
    #[inline(always)]
    pub(crate) fn of_warm_start(
        rows: &Rows<'_, WarmStartImpulse>,
        (block, lane): (usize, usize),
        locks: TileLocks<'a>,
    ) -> Self {
        let has_non_dynamic = rows.has_non_dynamic();
        let zero = Vec3::zero();
        let first = if has_non_dynamic {
            WarmStartImpulse { linear: zero, angular: zero, pull: T::splat(0.0), _unused: T::splat(0.0) }
        } else {
            rows.gather::<T>(block, 0, lane)
        };
        let second = rows.gather::<T>(block, 1, lane);
        let (linear, angular) = ([first.linear, second.linear], [first.angular, second.angular]);
        Self { has_non_dynamic, linear, angular, locks }
    }

    /// An impulse in the middle and an angular impulse on the second bodies, the opposite on the
    /// first.
    #[inline(always)]
    pub(crate) fn push(&mut self, arms: [Vec3<T>; 2], linear: Vec3<T>, angular: Vec3<T>) {
        // What holds a locked axis takes the impulse along it, but not its torque.
        let [to_first, to_second] = match self.locks.load() {
            Some([first, second]) => [linear - linear.scale(first), linear - linear.scale(second)],
            None => [linear; 2],
        };
        if !self.has_non_dynamic {
            self.linear[0] = self.linear[0] - to_first;
            self.angular[0] = self.angular[0] - (arms[0].cross(linear) + angular);
        }
        self.linear[1] = self.linear[1] + to_second;
        self.angular[1] = self.angular[1] + (arms[1].cross(linear) + angular);
    }

    /// Writes them back as a warm start.
    #[inline(always)]
    pub(crate) fn store_warm_start(&self, rows: &mut Rows<'_, WarmStartImpulse>, block: usize, lane: usize) {
        if !self.has_non_dynamic {
            rows.scatter(self.warm_start(0), block, 0, lane);
        }
        rows.scatter(self.warm_start(1), block, 1, lane);
    }

    /// Of the first or the second bodies.
    #[inline(always)]
    fn warm_start(&self, which: usize) -> WarmStartImpulse<T> {
        WarmStartImpulse {
            linear: self.linear[which],
            angular: self.angular[which],
            pull: T::splat(0.0),
            _unused: T::splat(0.0),
        }
    }
}

/// The bodies of a tile's contacts.
pub(crate) struct BodyLanes<'a, T> {
    /// Of non-dynamic bodies the velocities.
    momenta: Momenta<'a, T>,
    inverse_mass: [T; 2],
}

impl<'a, T: Tile> BodyLanes<'a, T> {
    #[inline(always)]
    pub(crate) fn load(motion: &Rows<'_, BodyMotion>, block: usize, lane: usize, locks: &'a [BlockLocks]) -> Self {
        let first = motion.gather::<T>(block, 0, lane);
        let second = motion.gather::<T>(block, 1, lane);
        let linear = [first.momentum, second.momentum];
        let angular = [first.angular_momentum, second.angular_momentum];
        let locks = TileLocks::of(locks, block, lane);
        let momenta = Momenta { has_non_dynamic: motion.has_non_dynamic(), linear, angular, locks };
        Self { momenta, inverse_mass: [first.inverse_mass, second.inverse_mass] }
    }

    /// Sum of the inverse masses of the dynamic bodies [1/kg].
    #[inline(always)]
    pub(crate) fn inverse_mass(&self) -> T {
        if self.momenta.has_non_dynamic { self.inverse_mass[1] } else { self.inverse_mass[0] + self.inverse_mass[1] }
    }

    /// Whether any body of the world has locked axes.
    #[inline(always)]
    pub(crate) fn has_locks(&self) -> bool {
        self.momenta.locks.are_there()
    }

    /// How they answer to impulses.
    #[inline(always)]
    pub(crate) fn mobility(&self, inv_inertia: &InverseInertias<T>) -> Mobility<'a, T> {
        Mobility {
            inv_inertia: inv_inertia.of_dynamic(self.momenta.has_non_dynamic),
            inverse_mass: self.inverse_mass(),
            inverse_masses: if self.momenta.has_non_dynamic {
                [T::splat(0.0), self.inverse_mass[1]]
            } else {
                self.inverse_mass
            },
            locks: self.momenta.locks,
        }
    }

    /// The smaller of the bodies' sizes, as what turns them has it: of their mass over their
    /// inertia; infinite where impulses turn neither \[m\].
    #[inline(always)]
    pub(crate) fn least_size(&self, inv_inertia: &InverseInertias<T>) -> T {
        let [first, second] = inv_inertia.diagonal;
        let of_first = self.inverse_mass[0] / (first.x + first.y + first.z);
        let of_second = self.inverse_mass[1] / (second.x + second.y + second.z);
        of_first.min(of_second).sqrt()
    }

    /// Angular velocities `w`, and what free rotation adds to them a second, `I^-1 (L x w)`;
    /// nothing where impulses turn nothing.
    #[inline(always)]
    pub(crate) fn free_spins(&self, inv_inertia: &InverseInertias<T>) -> ([Vec3<T>; 2], [Vec3<T>; 2]) {
        let [first, second] = self.momenta.angular;
        let spins = [inv_inertia.of_first(first), inv_inertia.of_second(second)];
        let gains = [inv_inertia.of_first(first.cross(spins[0])), inv_inertia.of_second(second.cross(spins[1]))];
        (spins, gains)
    }

    /// Velocity of the second seen from the first.
    #[inline(always)]
    pub(crate) fn relative(&self, inv_inertia: &InverseInertias<T>, arms: [Vec3<T>; 2]) -> Relative<T> {
        let Momenta { linear, angular, .. } = &self.momenta;
        let first = (linear[0] * self.inverse_mass[0], inv_inertia.of_first(angular[0]));
        let second = (linear[1] * self.inverse_mass[1], inv_inertia.of_second(angular[1]));
        Relative::new([first.0, second.0], [first.1, second.1], arms)
    }

    /// An impulse in the middle and an angular impulse on the second bodies, the opposite on the
    /// first.
    #[inline(always)]
    pub(crate) fn push(&mut self, arms: [Vec3<T>; 2], linear: Vec3<T>, angular: Vec3<T>) {
        self.momenta.push(arms, linear, angular);
    }

    /// Writes back the momenta.
    #[inline(always)]
    pub(crate) fn store(&self, motion: &mut Rows<'_, BodyMotion>, block: usize, lane: usize) {
        if !self.momenta.has_non_dynamic {
            motion.scatter(self.motion(0), block, 0, lane);
        }
        motion.scatter(self.motion(1), block, 1, lane);
    }

    /// That of the first or the second bodies.
    #[inline(always)]
    fn motion(&self, which: usize) -> BodyMotion<T> {
        BodyMotion {
            momentum: self.momenta.linear[which],
            angular_momentum: self.momenta.angular[which],
            inverse_mass: self.inverse_mass[which],
            _unused: T::splat(0.0),
        }
    }
}

/// How bodies answer to angular impulses: their inverse inertia in the world. What impulses do not
/// move has one with which its angular velocity is the momentum that it is given.
pub(crate) struct InverseInertias<T> {
    diagonal: [Vec3<T>; 2],
    off_diagonal: [Vec3<T>; 2],
}

impl<T: Tile> InverseInertias<T> {
    #[inline(always)]
    pub(crate) fn new([first, second]: [WorldInverseInertia<T>; 2]) -> Self {
        let off_diagonal = [first.off_diagonal, second.off_diagonal];
        Self { diagonal: [first.diagonal, second.diagonal], off_diagonal }
    }

    /// The same where the first bodies do not answer, if they are `has_non_dynamic`.
    #[inline(always)]
    pub(crate) fn of_dynamic(&self, has_non_dynamic: bool) -> Self {
        let zero = Vec3::zero();
        let (first, beside) = if has_non_dynamic { (zero, zero) } else { (self.diagonal[0], self.off_diagonal[0]) };
        Self { diagonal: [first, self.diagonal[1]], off_diagonal: [beside, self.off_diagonal[1]] }
    }

    #[inline(always)]
    pub(crate) fn of_first(&self, v: Vec3<T>) -> Vec3<T> {
        symmetric_product(self.diagonal[0], self.off_diagonal[0], v)
    }

    #[inline(always)]
    pub(crate) fn of_second(&self, v: Vec3<T>) -> Vec3<T> {
        symmetric_product(self.diagonal[1], self.off_diagonal[1], v)
    }
}
