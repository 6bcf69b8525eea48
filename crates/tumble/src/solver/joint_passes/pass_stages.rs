//! Joints in passes, colored and laid out in blocks, and their stages.

use std::ops::Range;

use tumble_math::lane::{Quat, Vec3};

use crate::joints::held_impulses::RowImpulses;
use crate::math::Real;
use crate::simd::{BLOCK, Octet, RowColors};
use crate::solver::block_parts::{in_parts, run};
use crate::solver::body_rows::{BodyPose, WarmStartImpulse};
use crate::solver::contact::softness::Softness;
use crate::solver::contact::solve::StageBodies;
use crate::solver::contact_work::ContactWorks;
use crate::solver::graph_coloring::{ContactColor, GraphColoring, sort_into_buckets};
use crate::solver::joint_passes::joint_sheet::JointSheet;
use crate::solver::joint_passes::loaded_bodies::LoadedBodies;
use crate::solver::joint_passes::pass_joints::{JointBlocks, PassJoints, PrepareJoints};
use crate::solver::mechanism::fours::row;
use crate::solver::mechanism::joint_rows::Anchor;
use crate::solver::mechanism::rotations::Rotations;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};

/// The joints of a group of bodies that are solved in passes.
#[derive(Clone, Default)]
pub(crate) struct JointPasses {
    /// In the order of the list of joints.
    joints: Vec<PassedJoint>,
    pub(crate) bodies: LoadedBodies,
    coloring: GraphColoring,
    /// Joints, and the same by color and kind.
    numbers: Vec<u32>,
    order: Vec<u32>,
    /// By joint, its block among those of its kind, and its lane there.
    places: Vec<(usize, usize)>,
    /// What was laid out: while this is the same the layout is kept.
    laid_out: Vec<([SolverRow; 2], JointKind)>,
    first_non_dynamic: usize,
    balls: JointSheet<3, 6>,
    hinges: JointSheet<5, 15>,
    welds: JointSheet<6, 21>,
    /// In the order in which they are solved.
    colors: Vec<JointColor>,
    row_colors: RowColors,
    /// By row, the impulses with which the last substep ended.
    warm_start: Vec<WarmStartImpulse>,
}

/// A joint that is solved in passes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PassedJoint {
    /// Among the joints of the world.
    pub(crate) number: u32,
    kind: JointKind,
    /// Not dynamic is the first at most.
    rows: [SolverRow; 2],
    /// Whether the second of its bodies comes first here.
    is_swapped: bool,
    pub(super) anchors: [Anchor; 2],
    pub(super) impulses: RowImpulses,
}

/// How many rotations a joint locks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum JointKind {
    Ball,
    Hinge,
    Weld,
}

/// The blocks of a color, of each kind.
#[derive(Clone, Debug)]
struct JointColor {
    balls: Range<usize>,
    hinges: Range<usize>,
    welds: Range<usize>,
}

/// Kinds of joints.
const KINDS: usize = 3;
/// Colors of joints between dynamic bodies, and as many of those on others, and one more of each
/// for joints without a color.
const COLORS: usize = 2 * (ContactColor::OVERFLOW as usize + 1);

impl PassedJoint {
    /// Of bodies in these rows, of which one is dynamic, with these rotations locked, and the
    /// impulses of the last substep on the second of them; `None` for joints of other kinds.
    pub(crate) fn new(
        number: u32,
        rotations: Rotations,
        (rows, bodies): ([SolverRow; 2], &SolverBodies),
        anchors: [Anchor; 2],
        impulses: RowImpulses,
    ) -> Option<Self> {
        let (kind, turns) = match rotations {
            Rotations::Free => (JointKind::Ball, 0),
            Rotations::About(axis) => (JointKind::Hinge, axis),
            Rotations::Locked => (JointKind::Weld, 0),
            Rotations::AboutBoth(..) => return None,
        };
        let mut it = Self { number, kind, rows, is_swapped: !bodies.is_dynamic(rows[1]), anchors, impulses };
        // Turned by a third, so that the free axis is the first.
        let third: Quat<f64> = Quat { x: 0.5, y: 0.5, z: 0.5, w: 0.5 };
        for anchor in &mut it.anchors {
            let turned = (0..turns).fold(anchor.orientation(), |turned, _| turned * third);
            anchor.orientation = row(turned);
        }
        if it.is_swapped {
            it.rows.reverse();
            it.anchors.reverse();
            it.impulses = it.impulses.map(|impulse| -impulse);
        }
        Some(it)
    }
}

impl JointPasses {
    /// With no joints.
    pub(crate) fn clear(&mut self) {
        self.joints.clear();
        self.bodies.clear();
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }

    /// Adds a joint, in the order of the list.
    pub(crate) fn add(&mut self, joint: PassedJoint) {
        self.joints.push(joint);
    }

    /// The rows of their bodies.
    pub(crate) fn rows(&self) -> impl Iterator<Item = SolverRow> + '_ {
        self.joints.iter().flat_map(|joint| joint.rows)
    }

    /// To be called before the first substep: lays out the joints, and has bodies begin with the
    /// inertia and the impulses of the last substep.
    pub(crate) fn begin(&mut self, bodies: &mut SolverBodies, works: &mut ContactWorks) {
        if self.is_empty() {
            return;
        }
        works.before_joints(bodies);
        self.bodies.begin(bodies);
        works.after_joints(bodies);
        self.lay_out(bodies);
        self.warm_start.clear();
        self.warm_start.resize(bodies.first_non_dynamic(), WarmStartImpulse::ZERO);
        bodies.with_poses(|bodies, poses| self.run(JointStage::Prepare(poses), bodies));
    }

    /// Adds the impulses that the last substep ended with.
    pub(crate) fn apply_warm_start(&mut self, bodies: &mut SolverBodies, works: &mut ContactWorks) {
        if !self.is_empty() {
            works.before_joints(bodies);
            bodies.apply(&mut self.warm_start);
            works.after_joints(bodies);
        }
    }

    /// Takes errors out, softly, in a substep of `h` \[s\].
    pub(crate) fn solve(&mut self, h: Real, bodies: &mut SolverBodies, works: &mut ContactWorks) {
        if !self.is_empty() {
            works.before_joints(bodies);
            self.run(JointStage::Solve(Softness::of_joints(h.into())), bodies);
            works.after_joints(bodies);
        }
    }

    /// Takes out the velocity that this gave, once bodies have moved, and notes the loads.
    pub(crate) fn relax(&mut self, h: Real, bodies: &mut SolverBodies, works: &mut ContactWorks) {
        if !self.is_empty() {
            works.before_joints(bodies);
            self.run(JointStage::Relax, bodies);
            self.bodies.take_loads(&self.warm_start, h, bodies);
            works.after_joints(bodies);
        }
    }

    /// To be called after the last substep: bodies have their own inertia again.
    pub(crate) fn finish(&mut self, bodies: &mut SolverBodies, works: &mut ContactWorks) {
        if !self.is_empty() {
            works.before_joints(bodies);
            self.bodies.finish(bodies);
            works.after_joints(bodies);
        }
    }

    /// By joint in the order of the list: its number there, the impulses of the last substep on the
    /// second of its bodies, and what it has done in the step: impulse, and angular impulse.
    pub(crate) fn results(&self) -> impl Iterator<Item = (u32, RowImpulses, [Vec3<Real>; 2])> + '_ {
        self.joints.iter().zip(&self.places).map(|(joint, &(block, lane))| {
            let PassedJoint { number, kind, is_swapped, .. } = *joint;
            let (impulses, done) = match kind {
                JointKind::Ball => (self.balls.impulses(block, lane), self.balls.done(block, lane)),
                JointKind::Hinge => (self.hinges.impulses(block, lane), self.hinges.done(block, lane)),
                JointKind::Weld => (self.welds.impulses(block, lane), self.welds.done(block, lane)),
            };
            let sign = if is_swapped { -1.0 } else { 1.0 };
            (number, impulses.map(|it| sign * it), done.map(|it| it * sign))
        })
    }

    /// Lays out the joints, where they are others than were laid out, and fills their blocks.
    fn lay_out(&mut self, bodies: &SolverBodies) {
        let now = || self.joints.iter().map(|joint| (joint.rows, joint.kind));
        let is_kept = self.first_non_dynamic == bodies.first_non_dynamic() && now().eq(self.laid_out.iter().copied());
        if !is_kept {
            self.laid_out = now().collect();
            self.first_non_dynamic = bodies.first_non_dynamic();
            self.color();
        }
        let Self { joints, balls, hinges, welds, .. } = self;
        balls.fill(joints);
        hinges.fill(joints);
        welds.fill(joints);
    }

    /// Orders the joints by color, those between dynamic bodies first, and in each color by kind.
    fn color(&mut self) {
        let Self { joints, coloring, numbers, order, places, balls, hinges, welds, colors, row_colors, .. } = self;
        coloring.color(joints.iter().map(|joint| joint.rows), self.first_non_dynamic);
        let color = |number: u32| {
            let ContactColor { has_non_dynamic, index } = coloring.colors()[number as usize];
            usize::from(has_non_dynamic) * COLORS / 2 + index as usize
        };
        let bucket = |number: usize| color(number as u32) * KINDS + joints[number].kind as usize;
        numbers.clear();
        numbers.extend(0..joints.len() as u32);
        sort_into_buckets::<_, { COLORS * KINDS }>(numbers, bucket, order);
        places.clear();
        places.resize(joints.len(), (0, 0));
        balls.clear();
        hinges.clear();
        welds.clear();
        colors.clear();
        row_colors.reset(self.first_non_dynamic);
        for of_color in order.chunk_by(|a, b| color(*a) == color(*b)) {
            let color = color(of_color[0]);
            // Those without a color are solved one by one.
            let overflows = color % (COLORS / 2) == ContactColor::OVERFLOW as usize;
            for part in of_color.chunks(if overflows { 1 } else { of_color.len() }) {
                let begins = [balls.len(), hinges.len(), welds.len()];
                row_colors.begin(color >= COLORS / 2);
                for of_kind in part.chunk_by(|a, b| joints[*a as usize].kind == joints[*b as usize].kind) {
                    for of_block in of_kind.chunks(BLOCK) {
                        row_colors.push(of_block.iter().map(|number| joints[*number as usize].rows.map(|row| row.0)));
                        match joints[of_block[0] as usize].kind {
                            JointKind::Ball => push(balls, of_block, places),
                            JointKind::Hinge => push(hinges, of_block, places),
                            JointKind::Weld => push(welds, of_block, places),
                        }
                    }
                }
                colors.push(JointColor {
                    balls: begins[0]..balls.len(),
                    hinges: begins[1]..hinges.len(),
                    welds: begins[2]..welds.len(),
                });
            }
        }
    }

    /// Runs a stage on all joints, color by color.
    fn run(&mut self, stage: JointStage<'_>, bodies: &mut SolverBodies) {
        let Self { balls, hinges, welds, colors, row_colors, warm_start, .. } = self;
        for (index, color) in colors.iter().enumerate() {
            let SolverBodies { motion, inv_inertia, delta_pose, .. } = bodies;
            let bodies = StageBodies {
                motion: row_colors.rows(index, motion),
                warm_start: row_colors.rows(index, warm_start),
                inv_inertia,
                delta_pose,
            };
            let (of_balls, others) = bodies.split_at(color.balls.len());
            let (of_hinges, of_welds) = others.split_at(color.hinges.len());
            in_parts(balls.blocks(&color.balls), of_balls, &|blocks, bodies| stage.run_on(blocks, bodies));
            in_parts(hinges.blocks(&color.hinges), of_hinges, &|blocks, bodies| stage.run_on(blocks, bodies));
            in_parts(welds.blocks(&color.welds), of_welds, &|blocks, bodies| stage.run_on(blocks, bodies));
        }
    }
}

/// Adds a block of joints, and notes where they are.
fn push<const R: usize, const M: usize>(sheet: &mut JointSheet<R, M>, of_block: &[u32], places: &mut [(usize, usize)]) {
    of_block.iter().enumerate().for_each(|(lane, number)| places[*number as usize] = (sheet.len(), lane));
    sheet.push(of_block);
}

/// A stage, run on all joints.
#[derive(Clone, Copy)]
enum JointStage<'a> {
    /// Sets joints to where bodies with these poses are.
    Prepare(&'a [BodyPose]),
    /// Takes errors out, with softness between dynamic bodies and on others.
    Solve([Softness; 2]),
    Relax,
}

impl JointStage<'_> {
    fn run_on<const R: usize, const M: usize>(self, blocks: JointBlocks<'_, R, M>, bodies: StageBodies<'_>) {
        match self {
            Self::Prepare(poses) => run(PrepareJoints { blocks, bodies, poses }),
            Self::Solve(softness) => {
                let softness = Some(softness[usize::from(bodies.motion.has_non_dynamic())]);
                run(PassJoints { blocks, bodies, softness });
            }
            Self::Relax => run(PassJoints { blocks, bodies, softness: None }),
        }
    }
}
