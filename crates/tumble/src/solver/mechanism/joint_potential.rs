//! Potential energy of the springs of joints: drives and soft limits of a stiffness.

use hecs::{Archetype, View, World};
use tumble_math::lane::{Quat, Vec3};

use crate::components::{Momentum, Pose};
use crate::joints::breakable::Breakable;
use crate::joints::drives::Drives;
use crate::joints::joint::Joint;
use crate::joints::joint_options::JointOptions;
use crate::joints::limits::Limits;
use crate::math::{dquat, dvec3};
use crate::solver::mechanism::free_row::FreeRow;
use crate::solver::mechanism::joint_rows::{Anchor, JointRows, Stance};

/// The energy in springs of the joints of a world \[J\], with the same bits wherever they lie.
///
/// Joints that do nothing have none, nor those of two bodies that forces do not move.
pub(crate) fn joint_potential(world: &World) -> f64 {
    let has_springs = |archetype: &&Archetype| {
        archetype.has::<Joint>() && (archetype.has::<Drives>() || archetype.has::<Limits>()) && !archetype.is_empty()
    };
    let mut archetypes = world.archetypes().filter(has_springs).peekable();
    if archetypes.peek().is_none() {
        return 0.0;
    }
    let mut query = world.query::<&Pose>();
    let poses = query.view();
    let (mut energies, mut options) = (Vec::new(), JointOptions::default());
    for archetype in archetypes {
        let Some(joints) = archetype.get::<&Joint>() else { continue };
        let breakables = archetype.get::<&Breakable>();
        for (row, joint) in joints.iter().enumerate() {
            let is_broken = breakables.as_deref().is_some_and(|breakables| breakables[row].is_broken);
            let [a, b] = joint.bodies;
            let moves = joint.bodies.iter().any(|body| world.satisfies::<&Momentum>(*body));
            if is_broken || !moves || a == b || !joint.is_in_range() {
                continue;
            }
            if let Some(stance) = stance(joint, &poses) {
                options.take_row(archetype, row, joint.free);
                // A drive that oscillates does work at any place.
                options.drives.retain(|drive| !drive.oscillates());
                energies.push(energy(joint, &options, &stance));
            }
        }
    }
    energies.sort_unstable_by(f64::total_cmp);
    energies.iter().sum()
}

/// Where a joint stands by the poses of its bodies, if these are there and finite.
fn stance(joint: &Joint, poses: &View<'_, &Pose>) -> Option<Stance> {
    let (mut arms, mut centers) = ([glam::DVec3::ZERO; 2], [glam::DVec3::ZERO; 2]);
    let mut orientations = [glam::DQuat::IDENTITY; 2];
    for (end, frame) in joint.frames.iter().enumerate() {
        let pose = poses.get(joint.bodies[end])?;
        let of_body = dquat(pose.orientation).normalize();
        centers[end] = dvec3(pose.position);
        arms[end] = of_body * dvec3(frame.position);
        orientations[end] = (of_body * dquat(frame.orientation)).normalize();
    }
    let gap = (centers[1] - centers[0]) + (arms[1] - arms[0]);
    let is_finite = gap.is_finite() && orientations.iter().all(|it| it.is_finite());
    let orientations = orientations.map(Quat::<f64>::from);
    let stance =
        Stance { anchor_arms: arms.map(Vec3::from), gap: gap.into(), orientations, axes: orientations.map(Quat::axes) };
    is_finite.then_some(stance)
}

fn energy(joint: &Joint, options: &JointOptions, stance: &Stance) -> f64 {
    let mut rows = JointRows::new([0, 1], [Anchor::CENTER; 2], joint.free, Some(options));
    rows.take_options(options, 0.0);
    let value = |row: &FreeRow| row.axis.direction(stance, joint.free, rows.reference).value;
    let of_row = |row: &FreeRow| row.potential(value(row));
    rows.free_rows.iter().map(of_row).sum()
}
