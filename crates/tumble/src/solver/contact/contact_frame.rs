//! A tile's contacts and their bodies, as they are at one moment of the step.

use tumble_math::lane::{Quat, Vec3};

use crate::integrators::derived::symmetric_product;
use crate::simd::block_lanes::{gather_two_vectors, vector_at};
use crate::simd::{BLOCK, Eight, Rows, Tile, gather};
use crate::solver::contact::constraint::Block;
use crate::solver::contact::effective_mass::Mobility;

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
    pub(crate) fn load(delta_pose: &[Eight], rows: &[[u32; BLOCK]; 2], lane: usize) -> Self {
        let [ax, ay, az, ai, aj, ak, aw, a_turned] = gather(delta_pose, &rows[0], lane);
        let [bx, by, bz, bi, bj, bk, bw, b_turned]: [T; 8] = gather(delta_pose, &rows[1], lane);
        Self {
            linear: [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz)],
            rotation: [Quat { x: ai, y: aj, z: ak, w: aw }, Quat { x: bi, y: bj, z: bk, w: bw }],
            turned: b_turned.max(a_turned),
        }
    }

    /// Seen from the first at the middle of the contact, to first order in the angles.
    #[inline(always)]
    pub(crate) fn relative(&self, arms: [Vec3<T>; 2]) -> Relative<T> {
        let two = T::splat(2.0);
        let turned = [self.rotation[0].vector() * two, self.rotation[1].vector() * two];
        Relative::new(self.linear, turned, arms)
    }
}

/// Linear and angular momenta of a tile's bodies. Where they are `has_non_dynamic`, impulses move
/// only the second of each.
pub(crate) struct Momenta<T> {
    has_non_dynamic: bool,
    linear: [Vec3<T>; 2],
    angular: [Vec3<T>; 2],
}

impl<T: Tile> Momenta<T> {
    /// From rows that have nothing else; zero of what impulses do not move.
    #[inline(always)]
    pub(crate) fn load(rows: &Rows<'_>, block: usize, lane: usize) -> Self {
        let has_non_dynamic = rows.has_non_dynamic();
        let zero = T::splat(0.0);
        let [a, b, c, d, e, f] = if has_non_dynamic { [zero; 6] } else { rows.gather(block, 0, lane) };
        let first = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let [a, b, c, d, e, f] = rows.gather(block, 1, lane);
        let second = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        Self { has_non_dynamic, linear: [first.0, second.0], angular: [first.1, second.1] }
    }

    /// An impulse in the middle and an angular impulse on the second bodies, the opposite on the
    /// first.
    #[inline(always)]
    pub(crate) fn push(&mut self, arms: [Vec3<T>; 2], linear: Vec3<T>, angular: Vec3<T>) {
        if !self.has_non_dynamic {
            self.linear[0] = self.linear[0] - linear;
            self.angular[0] = self.angular[0] - (arms[0].cross(linear) + angular);
        }
        self.linear[1] = self.linear[1] + linear;
        self.angular[1] = self.angular[1] + (arms[1].cross(linear) + angular);
    }

    /// Writes them back, with one more number behind each.
    #[inline(always)]
    pub(crate) fn store(&self, numbers: [T; 2], rows: &mut Rows<'_>, block: usize, lane: usize) {
        let row = |which: usize| (self.linear[which], self.angular[which], numbers[which]);
        if !self.has_non_dynamic {
            rows.scatter(in_a_row(row(0)), block, 0, lane);
        }
        rows.scatter(in_a_row(row(1)), block, 1, lane);
    }
}

#[inline(always)]
fn in_a_row<T: Tile>((p, l, number): (Vec3<T>, Vec3<T>, T)) -> [T; 8] {
    [p.x, p.y, p.z, l.x, l.y, l.z, number, T::splat(0.0)]
}

/// The bodies of a tile's contacts.
pub(crate) struct BodyLanes<T> {
    /// Of what impulses do not move, the velocities.
    momenta: Momenta<T>,
    inverse_mass: [T; 2],
}

impl<T: Tile> BodyLanes<T> {
    #[inline(always)]
    pub(crate) fn load(motion: &Rows<'_>, block: usize, lane: usize) -> Self {
        let [a, b, c, d, e, f, first_mass] = motion.gather(block, 0, lane);
        let first = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let [a, b, c, d, e, f, second_mass] = motion.gather(block, 1, lane);
        let second = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        let (linear, angular) = ([first.0, second.0], [first.1, second.1]);
        let momenta = Momenta { has_non_dynamic: motion.has_non_dynamic(), linear, angular };
        Self { momenta, inverse_mass: [first_mass, second_mass] }
    }

    /// Sum of the inverse masses of what impulses move [1/kg].
    #[inline(always)]
    pub(crate) fn inverse_mass(&self) -> T {
        if self.momenta.has_non_dynamic { self.inverse_mass[1] } else { self.inverse_mass[0] + self.inverse_mass[1] }
    }

    /// How they answer to impulses.
    #[inline(always)]
    pub(crate) fn mobility(&self, inv_inertia: &InverseInertias<T>) -> Mobility<T> {
        Mobility {
            inv_inertia: inv_inertia.of_what_moves(self.momenta.has_non_dynamic),
            inverse_mass: self.inverse_mass(),
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
    pub(crate) fn store(&self, motion: &mut Rows<'_>, block: usize, lane: usize) {
        self.momenta.store(self.inverse_mass, motion, block, lane);
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
    pub(crate) fn load(inv_inertia: &[Eight], indices: &[[u32; BLOCK]; 2], lane: usize) -> Self {
        let first = gather_two_vectors(inv_inertia, &indices[0], lane);
        let second = gather_two_vectors(inv_inertia, &indices[1], lane);
        Self { diagonal: [first.0, second.0], off_diagonal: [first.1, second.1] }
    }

    /// The same where the first bodies do not answer, if they are `has_non_dynamic`.
    #[inline(always)]
    pub(crate) fn of_what_moves(&self, has_non_dynamic: bool) -> Self {
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
