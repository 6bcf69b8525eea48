//! Contact constraints in SIMD blocks: normal points, friction, rolling resistance and restitution.

use crate::simd::BLOCK;
use crate::simd::block_lanes::Lanes;

/// Contacts side by side that have no dynamic body in common, of up to `P` points each with `C`
/// couplings between them.
///
/// A contact is a small problem in a frame of its own: impulses along the normal at its points, and
/// in one point in their middle friction and what resists turning. Both bodies are pushed at one
/// point of the world with equal and opposite impulses, so that momentum and angular momentum of
/// the two are kept to rounding. With the middle `c`, the normal `n` from the first body to the
/// second and the tangents `t1`, `t2 = n x t1`, the relative velocity along the normal at the point
/// `c + a t1 + b t2` is `n.u - a t2.r + b t1.r`, where `u` is the relative velocity at `c` and `r`
/// the relative angular velocity.
///
/// Fields are in the order in which stages need them, so that early stages do not fetch those of
/// the last.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Block<const P: usize, const C: usize> {
    /// The middle from the centres of mass of both bodies \[m\].
    pub(crate) arms: [[Lanes; 3]; 2],
    pub(crate) normal: [Lanes; 3],
    /// The first tangent.
    pub(crate) tangent: [Lanes; 3],
    pub(crate) points: [Point; P],
    /// Velocity at the second of two points that a unit impulse at the first gives [1/kg]: 01 02 03
    /// 12 13 23.
    pub(crate) couplings: [Lanes; C],
    pub(crate) friction: Friction,
    pub(crate) start: Start<P>,
    /// Which contacts.
    pub(crate) contacts: [u32; BLOCK],
    /// How many lanes have one.
    pub(crate) count: usize,
}

/// The geometry of contacts at the start of the step, from which that of each substep follows as
/// the bodies move.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Start<const P: usize> {
    /// The middle from the second body's centre of mass \[m\].
    pub(crate) arm: [Lanes; 3],
    /// The second body's centre of mass from the first's \[m\].
    pub(crate) apart: [Lanes; 3],
    /// How much of the middle is fixed to the second body, from 0 to 1.
    pub(crate) carried: Lanes,
    /// How far its surface is from the points that are fixed to it \[m\].
    pub(crate) core_radius: Lanes,
    /// The number of an [`UpdateRule`](crate::collision::contact::UpdateRule).
    pub(crate) update_rule: Lanes,
    /// How far an arm may change \[m\] before the effective masses are computed again; below zero
    /// where that is done in any case.
    pub(crate) slide: Lanes,
    /// One less how much effective masses have changed in the last substep, but not below zero.
    pub(crate) steady: Lanes,
    /// Above zero where the impulses of this substep are an impact's: the next begins without.
    pub(crate) is_impact: Lanes,
    /// Impulse along the normal of the substeps so far \[N s\].
    pub(crate) total_impulse: Lanes,
    /// By how much the velocity along the normal at the contact is to be less than in the middle of
    /// a substep, as the arms change \[m/s\].
    pub(crate) lead: Lanes,
    pub(crate) separations: [Lanes; P],
    pub(crate) normal: [Lanes; 3],
    pub(crate) tangent: [Lanes; 3],
    pub(crate) offsets: [[Lanes; 2]; P],
}

/// The normal constraint at one point: its impulse never pulls.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Point {
    /// Where the point is from the middle of the contact, along the tangents \[m\].
    pub(crate) offset: [Lanes; 2],
    /// Separation \[m\].
    pub(crate) separation: Lanes,
    /// One over the velocity along the normal that a unit impulse gives \[kg\].
    pub(crate) mass: Lanes,
    /// Impulse of a substep \[N s\].
    pub(crate) impulse: Lanes,
}

/// Friction against sliding and twisting in the middle of a contact. Impulses are those of a
/// substep.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Friction {
    /// Coefficients of friction: what it takes to begin to slide, and what sliding meets.
    pub(crate) limits: [Lanes; 2],
    /// Radius at which friction acts against a twist \[m\].
    pub(crate) radius: Lanes,
    /// Inverse of the 2x2 matrix that takes an impulse in the tangent plane to a velocity:
    /// `xx, xy, yy` \[kg\].
    pub(crate) mass: [Lanes; 3],
    /// Angular impulse about the normal that takes out a twist of one rad/s.
    pub(crate) twisting_mass: Lanes,
    /// Twist that a unit impulse along each tangent gives [rad/(kg m)]; of several points alone.
    pub(crate) twist_couplings: [Lanes; 2],
    /// Impulse along the tangents \[N s\].
    pub(crate) sliding: [Lanes; 2],
    /// Angular impulse about the normal [N m s].
    pub(crate) twist: Lanes,
}

/// Rolling resistance of the contacts of a block.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Rolling {
    /// As a length \[m\].
    pub(crate) length: Lanes,
    /// Inverse of the 2x2 matrix that takes an angular impulse about the tangents to an angular
    /// velocity: `xx, xy, yy` [kg m^2].
    pub(crate) mass: [Lanes; 3],
    /// Angular impulse about the tangents [N m s].
    pub(crate) impulse: [Lanes; 2],
}

/// Moving surfaces of the contacts of a block.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Belt {
    /// That of the second body relative to the first at which nothing slides \[m/s\], world frame.
    pub(crate) velocity: [Lanes; 3],
}

/// Restitution of the contacts of a block.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Bounce<const P: usize> {
    pub(crate) restitution: Lanes,
    /// The velocity in the middle after the relax stage, see
    /// [`follow`](crate::solver::contact::update_geometry::follow) [m/s].
    pub(crate) lag: [Lanes; 3],
    /// The fastest that the bodies came together at each point before it held them, in this step:
    /// velocity along the normal \[m/s\].
    pub(crate) approach: [Lanes; P],
    /// Velocity along the normal at each point before forces act on them in this substep, and what
    /// those do to it \[m/s\].
    pub(crate) before: [Lanes; P],
    pub(crate) kick: [Lanes; P],
    /// How fast they come together at each point in this substep until they meet, and before any
    /// impulse acts \[m/s\].
    pub(crate) met: [Lanes; P],
    pub(crate) coming: [Lanes; P],
    /// Energy that impulses along the normal have taken from the bodies in this step \[J\]: no more
    /// comes back.
    pub(crate) absorbed: Lanes,
}

const ZEROS: Lanes = [0.0; BLOCK];

impl<const P: usize, const C: usize> Block<P, C> {
    /// No contacts.
    pub(crate) fn empty() -> Self {
        let point = Point { offset: [ZEROS; 2], separation: ZEROS, mass: ZEROS, impulse: ZEROS };
        Self {
            arms: [[ZEROS; 3]; 2],
            normal: [ZEROS; 3],
            tangent: [ZEROS; 3],
            points: [point; P],
            couplings: [ZEROS; C],
            friction: Friction {
                limits: [ZEROS; 2],
                radius: ZEROS,
                mass: [ZEROS; 3],
                twisting_mass: ZEROS,
                twist_couplings: [ZEROS; 2],
                sliding: [ZEROS; 2],
                twist: ZEROS,
            },
            start: Start {
                arm: [ZEROS; 3],
                apart: [ZEROS; 3],
                carried: ZEROS,
                core_radius: ZEROS,
                update_rule: ZEROS,
                slide: ZEROS,
                steady: ZEROS,
                is_impact: ZEROS,
                total_impulse: ZEROS,
                lead: ZEROS,
                separations: [ZEROS; P],
                normal: [ZEROS; 3],
                tangent: [ZEROS; 3],
                offsets: [[ZEROS; 2]; P],
            },
            contacts: [0; BLOCK],
            count: 0,
        }
    }
}

impl Rolling {
    pub(crate) const NONE: Self = Self { length: ZEROS, mass: [ZEROS; 3], impulse: [ZEROS; 2] };
}

impl Belt {
    pub(crate) const NONE: Self = Self { velocity: [ZEROS; 3] };
}

impl<const P: usize> Bounce<P> {
    pub(crate) const NONE: Self = Self {
        restitution: ZEROS,
        lag: [ZEROS; 3],
        approach: [ZEROS; P],
        before: [ZEROS; P],
        kick: [ZEROS; P],
        met: [ZEROS; P],
        coming: [ZEROS; P],
        absorbed: ZEROS,
    };
}
