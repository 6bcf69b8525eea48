//! Joints in SIMD blocks: balls, hinges and welds.

use crate::math::real;
use crate::simd::BLOCK;
use crate::simd::block_lanes::Lanes;
use crate::solver::joint_passes::pass_stages::PassedJoint;

/// Joints side by side that have no dynamic body in common, of `R` rows each, with the `M` numbers
/// of the lower triangle of a matrix of these.
///
/// All translations are locked, by rows along the axes of the world, and rotations by rows about
/// axes of the first frame. Both bodies are pushed at one point, half way between both anchors, so
/// that momentum and angular momentum of the two are kept to rounding.
#[derive(Clone)]
#[repr(C, align(64))]
pub(crate) struct JointBlock<const R: usize, const M: usize> {
    /// From the centres of mass of both bodies to the point where they are pushed \[m\].
    pub(super) arms: [[Lanes; 3]; 2],
    /// From the first anchor to the second \[m\].
    pub(super) gap: [Lanes; 3],
    /// Of the matrix that takes impulses to velocities.
    pub(super) factors: [Lanes; M],
    /// Impulses of a substep on the second body \[N s\] [N m s].
    pub(super) impulses: [Lanes; R],
    /// From the centres of mass to the anchors when the step began \[m\]; before
    /// [`PrepareJoints`](super::pass_joints::PrepareJoints) along the axes of the bodies.
    pub(super) anchors: [[Lanes; 3]; 2],
    /// From the first centre of mass to the second when the step began \[m\].
    pub(super) between: [Lanes; 3],
    /// Impulse \[N s\] and angular impulse about the second anchor [N m s] of the substeps so far.
    pub(super) done: [[Lanes; 3]; 2],
    /// How many lanes have one.
    pub(super) count: usize,
}

/// The locked rotations of the joints of a block.
#[derive(Clone)]
#[repr(C, align(64))]
pub(crate) struct BlockRotations {
    /// About what rows turn, and the errors \[rad\].
    pub(super) axes: [[Lanes; 3]; 3],
    pub(super) errors: [Lanes; 3],
    /// Orientations of both frames when the step began; before that against their bodies.
    pub(super) frames: [[Lanes; 4]; 2],
}

const NONE: Lanes = [0.0; BLOCK];

impl<const R: usize, const M: usize> JointBlock<R, M> {
    pub(super) const EMPTY: Self = Self {
        arms: [[NONE; 3]; 2],
        gap: [NONE; 3],
        factors: [NONE; M],
        impulses: [NONE; R],
        anchors: [[NONE; 3]; 2],
        between: [NONE; 3],
        done: [[NONE; 3]; 2],
        count: 0,
    };
}

impl<const R: usize, const M: usize> JointBlock<R, M> {
    /// Begins a step with the joints of these numbers; lanes without one have no impulse.
    pub(super) fn fill(&mut self, numbers: &[u32; BLOCK], joints: &[PassedJoint]) {
        (self.impulses, self.done) = ([NONE; R], [[NONE; 3]; 2]);
        for (lane, number) in numbers[..self.count].iter().enumerate() {
            let PassedJoint { anchors, impulses, .. } = &joints[*number as usize];
            for (ours, anchor) in self.anchors.iter_mut().zip(anchors) {
                ours.iter_mut().zip(anchor.position).for_each(|(lanes, it)| lanes[lane] = real(it));
            }
            self.impulses.iter_mut().zip(impulses).for_each(|(lanes, it)| lanes[lane] = *it);
        }
    }
}

impl BlockRotations {
    pub(super) const EMPTY: Self = Self { axes: [[NONE; 3]; 3], errors: [NONE; 3], frames: [[NONE; 4]; 2] };
}
