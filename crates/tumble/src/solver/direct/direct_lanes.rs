//! Direct contacts out of the lanes of blocks, and their impulses back.

use tumble_math::lane::Vec3;

use crate::collision::contact::UpdateRule;
use crate::math::{Real, double, real};
use crate::simd::block_lanes::vector_at;
use crate::solver::contact::constraint::Block;
use crate::solver::contact::contact_frame::ContactFrame;
use crate::solver::contact::friction::FrictionImpulse;
use crate::solver::contact::solve::Blocks;
use crate::solver::contact::update_geometry::of_balls;
use crate::solver::direct::direct_contact::DirectContact;
use crate::solver::mechanism::mechanism_body::single;

/// Reads how a contact stands in a lane of a block, and its impulses.
pub(crate) fn read<const P: usize, const C: usize>(
    contact: &mut DirectContact,
    (blocks, index, lane): (&Blocks<'_, P, C>, usize, usize),
) {
    let block = &blocks.blocks[index];
    let frame = ContactFrame::<Real>::load(block, lane);
    contact.normal = double(frame.normal).into();
    contact.tangents = frame.tangents.map(|tangent| double(tangent).into());
    contact.arms = frame.arms.map(|arm| double(arm).into());
    contact.points = points(block, lane);
    for (j, point) in block.points.iter().enumerate().take(contact.points) {
        contact.offsets[j] = point.offset.map(|numbers| f64::from(numbers[lane]));
        let is_there = point.mass[lane] > 0.0;
        contact.separations[j] = if is_there { f64::from(point.separation[lane]) } else { f64::INFINITY };
    }
    contact.friction = block.friction.limits.map(|numbers| f64::from(numbers[lane]));
    contact.radius = f64::from(block.friction.radius[lane]);
    contact.rolling = blocks.rolling.get(index).map_or(0.0, |rolling| f64::from(rolling.length[lane]));
    contact.steady = f64::from(block.start.steady[lane]);
    let rule = block.start.update_rule[lane];
    contact.is_of_ball = P == 1 && (of_balls(rule) > 0.0 || f64::from(rule) == UpdateRule::Constant.number());
    let mut lag: Vec3<Real> = blocks.lags.get(index).map_or(Vec3::zero(), |lags| vector_at(lags, lane));
    if let Some(bounce) = blocks.bounces.get(index) {
        lag = vector_at(&bounce.lag, lane);
        contact.restitution = f64::from(bounce.restitution[lane]);
        (0..contact.points).for_each(|j| contact.met[j] = f64::from(bounce.met[j][lane]));
    }
    contact.lag = double(lag).into();
    contact.slip_reference = double(blocks.slip_reference(index, lane, lag)).into();
    read_impulses(contact, (blocks, index, lane));
}

/// How many points are there: those have a mass.
fn points<const P: usize, const C: usize>(block: &Block<P, C>, lane: usize) -> usize {
    block.points.iter().rposition(|point| point.mass[lane] > 0.0).map_or(0, |last| last + 1)
}

/// Reads the impulses in this substep, or those that it begins with.
fn read_impulses<const P: usize, const C: usize>(
    contact: &mut DirectContact,
    (blocks, index, lane): (&Blocks<'_, P, C>, usize, usize),
) {
    let block = &blocks.blocks[index];
    let friction = FrictionImpulse::<Real>::load(&block.friction, blocks.rolling.get(index), lane);
    let frame = ContactFrame::load(block, lane);
    let [linear, angular] = [friction.linear(&frame), friction.angular(&frame)].map(double).map(Vec3::from);
    for row in 0..contact.rows() {
        contact.impulses[row] = if row < contact.points {
            f64::from(block.points[row].impulse[lane])
        } else {
            let [push, about] = contact.row(row);
            push.dot(linear) + about.dot(angular)
        };
    }
}

/// Writes the impulses of a substep to the lane.
pub(crate) fn write<const P: usize, const C: usize>(
    contact: &DirectContact,
    (blocks, index, lane): (&mut Blocks<'_, P, C>, usize, usize),
) {
    let block = &mut blocks.blocks[index];
    for (j, point) in block.points.iter_mut().enumerate() {
        point.impulse[lane] = if j < contact.points { real(contact.impulses[j]) } else { 0.0 };
    }
    let mut of_friction = contact.impulses;
    of_friction[..contact.points].fill(0.0);
    let [linear, angular] = contact.impulse(&of_friction[..contact.rows()]);
    let frame = ContactFrame::<Real>::load(block, lane);
    let friction = FrictionImpulse::from_world(&frame, single(linear), single(angular));
    friction.store(&mut block.friction, blocks.rolling.get_mut(index), lane);
    block.start.is_impact[lane] = 0.0;
}
