//! Contacts as they are after their bodies have moved in a substep.

use tumble_math::lane::Vec3;

use crate::collision::contact::UpdateRule;
use crate::simd::Tile;
use crate::simd::block_lanes::{Lanes, at, put, put_vector, vector_at};
use crate::solver::contact::capsule_axes::CapsuleAxes;
use crate::solver::contact::constraint::{Block, Rolling};
use crate::solver::contact::contact_frame::{BodyLanes, ContactFrame, DeltaPoses, InverseInertias, along_normal};
use crate::solver::contact::effective_mass;
use crate::solver::contact::effective_mass::{Mobility, put_where};
use crate::solver::contact::line::Line;

/// Square of half of what an arm, or a spin, changes in a substep over itself, from which on it is
/// another and nothing lags.
pub(crate) const LAG: f64 = 1.0 / 16.0;

/// Moves the contacts of a tile with their bodies. Returns by how much the relative velocity in the
/// middle differs from its mean over the substep of `h` \[s\]: of those that roll, and along the
/// surface of others whose bodies turn.
///
/// Contacts hold over a substep, `x' = x + h v`, if velocities vanish in its middle: at the arms
/// `(r + r')/2`, with the spin that free rotation has there, `w' - h/2 I^-1 (L x w)`. With those of
/// its end, what rolls gains or loses energy, and what stands on a platform that turns creeps
/// inwards, to first order in `h`.
#[inline(always)]
pub(crate) fn follow<T: Tile, const P: usize, const C: usize>(
    block: &mut Block<P, C>,
    (rolling, line, axes): (Option<&mut Rolling>, Option<&mut Line>, Option<&CapsuleAxes>),
    (lane, h): (usize, T),
    delta_pose: &DeltaPoses<T>,
    (bodies, inv_inertia): (&BodyLanes<'_, T>, &InverseInertias<T>),
) -> Vec3<T> {
    let before: [Vec3<T>; 2] = [vector_at(&block.arms[0], lane), vector_at(&block.arms[1], lane)];
    refresh(block, (rolling, axes), lane, delta_pose, &bodies.mobility(inv_inertia));
    let rule: T = at(&block.start.update_rule, lane);
    let found = T::select(at::<T>(&block.start.slide, lane).lt(T::splat(0.0)), T::splat(1.0), T::splat(0.0));
    let rolls = T::splat(0.0).lt(found.max(of_rule(rule, UpdateRule::RoundOnFlat)));
    let turned = delta_pose.turned * of_rule(rule, UpdateRule::BodyFixed);
    let has_turned = T::splat(0.0).lt(turned);
    if !T::any(rolls) && !T::any(has_turned) {
        return Vec3::zero();
    }
    let (spins, gains) = bodies.free_spins(inv_inertia);
    let mut lags = [Vec3::zero(); 2];
    let mut which = 0;
    while which < 2 {
        let arm: Vec3<T> = vector_at(&block.arms[which], lane);
        // An arm that is fixed to its body turns with it.
        let way = Vec3::select(rolls, arm - before[which], spins[which].cross(arm) * h);
        lags[which] = lag([way * T::splat(0.5), arm], spins[which], gains[which], h);
        which += 1;
    }
    let (apart, normal): (Vec3<T>, Vec3<T>) = (lags[1] - lags[0], vector_at(&block.normal, lane));
    if let Some(line) = line {
        let motion = (spins[1] - spins[0], (gains[1] - gains[0]) * (h * T::splat(0.5)));
        line.find_lag(lane, (normal, vector_at(&block.tangent, lane)), motion);
    }
    let along_surface = apart - normal * normal.dot(apart);
    Vec3::select(rolls, apart, Vec3::select(has_turned, along_surface, Vec3::zero()))
}

/// By how much the velocity at the end of an arm differs from that in the middle of a substep, of
/// which half the way that the arm goes in it is given.
#[inline(always)]
fn lag<T: Tile>([way, arm]: [Vec3<T>; 2], spin: Vec3<T>, gain: Vec3<T>, h: T) -> Vec3<T> {
    let (half, limit) = (T::splat(0.5), T::splat(LAG));
    let gain = gain * (h * half);
    let lag = spin.cross(way) + gain.cross(arm - way);
    let lag = Vec3::select(way.dot(way).lt(arm.dot(arm) * limit), lag, Vec3::zero());
    Vec3::select(gain.dot(gain).lt(spin.dot(spin) * limit), lag, Vec3::zero())
}

/// The contacts of a tile where their bodies have moved to: separations and arms in any case;
/// normals, tangents, offsets and effective masses where a body has turned, or an arm has changed,
/// by more than a tolerance.
///
/// The reference body of a contact is the one that the normal turns with, the other carries the
/// points. Points are fixed to a body, so a corner on a face is exact at any angle; what is cut by
/// edges is right to first order.
#[inline(always)]
fn refresh<T: Tile, const P: usize, const C: usize>(
    block: &mut Block<P, C>,
    (mut rolling, axes): (Option<&mut Rolling>, Option<&CapsuleAxes>),
    lane: usize,
    delta_pose: &DeltaPoses<T>,
    mobility: &Mobility<'_, T>,
) {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let start = &block.start;
    let (arm, apart): (Vec3<T>, Vec3<T>) = (vector_at(&start.arm, lane), vector_at(&start.apart, lane));
    let carried: T = at(&start.carried, lane);
    let slid = delta_pose.linear[1] - delta_pose.linear[0];
    let frame = ContactFrame::<T>::load(block, lane);

    let rule: T = at(&start.update_rule, lane);
    // What has the arms of a later meeting has them all the time.
    let past = slid * (one - of_meeting(rule));
    let now = apart + past;
    let between_centers = of_rule(rule, UpdateRule::LineOfCenters);
    let turns_with_body = of_rule(rule, UpdateRule::BodyFixed).max(of_rule(rule, UpdateRule::RoundOnFlat));
    let second = arm + past * (carried - one);
    let is_meeting = is_rule(rule, UpdateRule::Meeting);
    let way = frame.normal_parts(&delta_pose.relative([arm + apart, arm], is_meeting));
    put_vector(second + now, &mut block.arms[0], lane);
    put_vector(second, &mut block.arms[1], lane);
    let mut j = 0;
    while j < P {
        let offset = &block.points[j].offset;
        let way = along_normal(way, at(&offset[0], lane), at(&offset[1], lane));
        put(at::<T>(&block.start.separations[j], lane) + way, &mut block.points[j].separation, lane);
        j += 1;
    }
    if P == 1 && T::any(zero.lt(between_centers)) {
        along_centers(block, lane, (between_centers, arm, apart, now));
    }
    if P == 1 {
        // However they turn.
        let meeting = of_rule(rule, UpdateRule::MeetingCenters);
        let separation = at::<T>(&block.start.separations[0], lane) + frame.normal.dot(slid);
        put_where(meeting, separation, &mut block.points[0].separation, lane);
        if let Some(axes) = axes {
            axes.find((&mut *block, rolling.as_deref_mut()), lane, (delta_pose, now));
        }
    }

    // An arm that slides along with the other body changes what impulses do.
    let slide = T::select(
        at::<T>(&block.start.slide, lane).lt(largest(past * carried).max(largest(past * (carried - one)))),
        one,
        zero,
    );
    // Balls respond alike in all directions, unless axes of theirs are locked.
    let of_locks = if mobility.locks.are_there() { one } else { zero };
    let changed = T::select(zero.lt(of_balls(rule)), of_locks, slide.max(delta_pose.turned));
    if T::any(zero.lt(changed)) {
        turn(block, lane, delta_pose, (carried, past, now), delta_pose.turned * turns_with_body);
        let steady = effective_mass::compute(block, rolling, lane, mobility, changed);
        put(steady, &mut block.start.steady, lane);
    } else {
        put(one, &mut block.start.steady, lane);
    }
}

/// Where numbers are those of a rule.
#[inline(always)]
pub(crate) fn is_rule<T: Tile>(number: T, rule: UpdateRule) -> T::Mask {
    (number - T::splat(rule.number())).abs().lt(T::splat(0.5))
}

/// One where numbers are those of a rule of balls, else zero.
#[inline(always)]
pub(crate) fn of_balls<T: Tile>(number: T) -> T {
    of_rule(number, UpdateRule::LineOfCenters).max(of_rule(number, UpdateRule::MeetingCenters))
}

/// One where numbers are those of bodies that meet later in the step, else zero.
#[inline(always)]
pub(crate) fn of_meeting<T: Tile>(number: T) -> T {
    of_rule(number, UpdateRule::Meeting).max(of_rule(number, UpdateRule::MeetingCenters))
}

/// One where numbers are those of a rule, else zero.
#[inline(always)]
pub(crate) fn of_rule<T: Tile>(number: T, rule: UpdateRule) -> T {
    T::select(is_rule(number, rule), T::splat(1.0), T::splat(0.0))
}

/// The contact of balls, along the line of their centres.
#[inline(always)]
fn along_centers<T: Tile, const P: usize, const C: usize>(
    block: &mut Block<P, C>,
    lane: usize,
    (which, arm, apart, now): (T, Vec3<T>, Vec3<T>, Vec3<T>),
) {
    let (zero, one, half) = (T::splat(0.0), T::splat(1.0), T::splat(0.5));
    let which = T::select(zero.lt(now.dot(now)), which, zero);
    let start: Vec3<T> = vector_at(&block.start.normal, lane);
    let gap: T = at(&block.start.separations[0], lane);
    let distance = now.dot(now).sqrt();
    let normal = now * (one / distance);
    let separation = distance - (start.dot(apart) - gap);
    let second = normal * (start.dot(arm) + gap * half - separation * half);
    move_point((block, None), (which, lane), (normal, separation), [second + now, second]);
}

/// Moves contacts of one point where `which` is above zero: to this normal and separation, with
/// these arms. What is along their tangents goes over to the new ones.
#[inline(always)]
pub(crate) fn move_point<T: Tile, const P: usize, const C: usize>(
    (block, rolling): (&mut Block<P, C>, Option<&mut Rolling>),
    (which, lane): (T, usize),
    (normal, separation): (Vec3<T>, T),
    arms: [Vec3<T>; 2],
) {
    let before = ContactFrame::<T>::load(block, lane).tangents;
    let tangents = tangents(normal);
    put_where(which, separation, &mut block.points[0].separation, lane);
    put_vector_where(which, normal, &mut block.normal, lane);
    put_vector_where(which, tangents[0], &mut block.tangent, lane);
    put_vector_where(which, arms[0], &mut block.arms[0], lane);
    put_vector_where(which, arms[1], &mut block.arms[1], lane);
    go_over([&before, &tangents], &mut block.friction.sliding, (which, lane));
    if let Some(rolling) = rolling {
        go_over([&before, &tangents], &mut rolling.impulse, (which, lane));
    }
}

/// Has what is along some tangents be along others, where `which` is above zero.
#[inline(always)]
fn go_over<T: Tile>([old, new]: [&[Vec3<T>; 2]; 2], along: &mut [Lanes; 2], (which, lane): (T, usize)) {
    let [u, v]: [T; 2] = [at(&along[0], lane), at(&along[1], lane)];
    let world = old[0] * u + old[1] * v;
    put_where(which, new[0].dot(world), &mut along[0], lane);
    put_where(which, new[1].dot(world), &mut along[1], lane);
}

/// Turns the geometry of the step's start with the bodies.
#[inline(always)]
fn turn<T: Tile, const P: usize, const C: usize>(
    block: &mut Block<P, C>,
    lane: usize,
    delta_pose: &DeltaPoses<T>,
    (carried, slid, now): (T, Vec3<T>, Vec3<T>),
    turned: T,
) {
    let one = T::splat(1.0);
    let start = &block.start;
    let (normal, tangent): (Vec3<T>, Vec3<T>) = (vector_at(&start.normal, lane), vector_at(&start.tangent, lane));
    // What is fixed to a round body is its core.
    let core_radius: T = at(&start.core_radius, lane);
    let arm: Vec3<T> = vector_at(&start.arm, lane) + normal * core_radius;
    let first_arm = arm + vector_at(&start.apart, lane);
    let turned_arms = [delta_pose.rotation[0].rotate(first_arm), delta_pose.rotation[1].rotate(arm)];
    let second = turned_arms[1] * carried + (turned_arms[0] - now) * (one - carried);
    let gap = slid + (turned_arms[1] - arm) - (turned_arms[0] - first_arm);

    let first_is_reference = T::splat(0.5 - 1e-3).lt(carried);
    let select = |a, b| tumble_math::lane::Quat::select(first_is_reference, a, b);
    let reference = select(delta_pose.rotation[0], delta_pose.rotation[1]);
    let material = select(delta_pose.rotation[1], delta_pose.rotation[0]);
    let sign = T::select(first_is_reference, one, -one);
    let (s, t) = (material.rotate(tangent), material.rotate(normal.cross(tangent)));
    let normal = reference.rotate(normal);
    let second = second - normal * core_radius;
    let tangents = [reference.rotate(tangent), normal.cross(reference.rotate(tangent))];
    put_vector_where(turned, normal, &mut block.normal, lane);
    put_vector_where(turned, tangents[0], &mut block.tangent, lane);
    put_vector_where(turned, second + now, &mut block.arms[0], lane);
    put_vector_where(turned, second, &mut block.arms[1], lane);
    let mut j = 0;
    while j < P {
        let offset = &block.start.offsets[j];
        let (a, b): (T, T) = (at(&offset[0], lane), at(&offset[1], lane));
        let from_middle = s * a + t * b;
        let separation = at::<T>(&block.start.separations[j], lane) + normal.dot(gap) + normal.dot(from_middle) * sign;
        let point = &mut block.points[j];
        put_where(turned, separation, &mut point.separation, lane);
        put_where(turned, tangents[0].dot(from_middle), &mut point.offset[0], lane);
        put_where(turned, tangents[1].dot(from_middle), &mut point.offset[1], lane);
        j += 1;
    }
}

#[inline(always)]
fn put_vector_where<T: Tile>(changed: T, vector: Vec3<T>, numbers: &mut [Lanes; 3], lane: usize) {
    put_where(changed, vector.x, &mut numbers[0], lane);
    put_where(changed, vector.y, &mut numbers[1], lane);
    put_where(changed, vector.z, &mut numbers[2], lane);
}

#[inline(always)]
fn largest<T: Tile>(v: Vec3<T>) -> T {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}

/// Two unit vectors, each perpendicular to the other and to `n`: the first as near as it can be to
/// the axis that `n` is farthest from.
#[inline(always)]
pub(crate) fn tangents<T: Tile>(n: Vec3<T>) -> [Vec3<T>; 2] {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (x, y, z) = (n.x.abs(), n.y.abs(), n.z.abs());
    let least = z.min(y);
    let y_axis = Vec3::new(zero, one, zero);
    let axis = Vec3::select(z.lt(y), Vec3::new(zero, zero, one), y_axis);
    let axis = Vec3::select(least.lt(x), axis, Vec3::new(one, zero, zero));
    let across = axis - n * n.dot(axis);
    let first = across * (one / across.dot(across).sqrt());
    [first, n.cross(first)]
}
