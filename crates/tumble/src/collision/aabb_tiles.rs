//! Where dynamic boxes and balls about their centres of mass are, a tile at a time.

use tumble_collide::lanes::{CuboidLanes, cuboid_reach};
use tumble_collide::{Aabb, ColliderShape, Isometry, Proxy};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider::Collider;
use crate::collision::collider_state::{Activity, ColliderState, Motion};
use crate::collision::narrow_phase::LaneKind;
use crate::collision::update_aabbs::{AabbUpdate, Intervals, drop_of, margin_of, turning};
use crate::integrators::clear_range::are_clearly_in_range;
use crate::integrators::state::Constants;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::simd::{BLOCK, Kernel, Octet, Tile, dispatch_blocks_and_rest, load_rows, octet, store_rows};
use crate::storage::tile_io::{load_moments, load_scale, load_state, splat};
use crate::storage::world_columns::{MomentumView, PoseView};

octet! {
    /// A box or a ball about its body's centre of mass.
    pub(crate) struct CenteredShape<T> {
        /// Half the lengths of the box \[m\]; of a ball its radius in each direction.
        half_extents: Vec3<T>,
        /// How far it reaches from its centre \[m\].
        radius: T,
        half_thickness: T,
        /// One for a ball, else zero.
        is_ball: T,
        /// One for either, zero for any other collider.
        is_centered: T,
        _unused: T,
    }
}

impl CenteredShape {
    /// That of a collider, with its body's centre of mass in the body's frame \[m\].
    pub(crate) fn of(collider: &Option<(Collider, WorldVec3)>) -> Self {
        let Some((collider, offset)) = collider else { return Self::ZERO };
        let geometry = collider.geometry();
        let (half_extents, is_ball) = match geometry {
            ColliderShape::Cuboid { half_extents } => (*half_extents, 0.0),
            ColliderShape::Sphere { radius } => (Vec3::splat(*radius), 1.0),
            _ => return Self::ZERO,
        };
        if *offset != WorldVec3::ZERO || collider.place().is_some() {
            return Self::ZERO;
        }
        let (radius, half_thickness) = (geometry.reach().unwrap_or(0.0), geometry.ccd_thickness());
        Self { half_extents, radius, half_thickness, is_ball, is_centered: 1.0, _unused: 0.0 }
    }
}

octet! {
    /// Linear parts of a body's motion.
    struct Way<T> {
        way: Vec3<T>,
        drop: Vec3<T>,
        reach: T,
        margin: T,
    }
}

octet! {
    /// How far a body turns, and half its AABB \[m\].
    struct Turn<T> {
        turn: Vec3<T>,
        half_aabb: Vec3<T>,
        radius: T,
        half_thickness: T,
    }
}

octet! {
    /// A unit quaternion.
    struct Orientation<T> {
        orientation: Quat<T>,
        _unused: [T; 4],
    }
}

/// Updates neighbouring slots of dynamic bodies, none of which sleeps or is a sensor.
pub(crate) fn update_in_tiles(
    update: &mut AabbUpdate<'_>,
    bodies: PoseView<'_>,
    dynamic: MomentumView<'_>,
    intervals: Intervals,
) {
    dispatch_blocks_and_rest(&mut AabbTiles { update, bodies, dynamic, intervals });
}

struct AabbTiles<'k, 'a> {
    update: &'k mut AabbUpdate<'a>,
    bodies: PoseView<'k>,
    dynamic: MomentumView<'k>,
    intervals: Intervals,
}

impl Kernel for AabbTiles<'_, '_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.update.states.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let zero = T::splat(0.0);
        let shape = load_rows::<T, _>(&self.update.shapes[i..]);
        if !T::all(zero.lt(shape.is_centered)) {
            return self.update_each(i, T::WIDTH);
        }
        let Intervals { interval, ahead, drop } = self.intervals;
        let (bodies, (momenta, masses, inertia)) = (&self.bodies, self.dynamic);
        let [mass] = T::load(&masses[i..]);
        let inertia = load_moments(inertia, bodies.axes, i);
        let constants = Constants { mass, inertia, damping: None };
        let state = load_state(bodies.pose, momenta, i);
        if !T::all(are_clearly_in_range(&constants, &state, shape.radius)) {
            return self.update_each(i, T::WIDTH);
        }
        let orientation = state.orientation.normalize();
        let (margin, ahead) = (margin_of(shape.half_thickness), T::splat(ahead.into()));
        let turn = match &constants.inertia {
            Some(inertia) => turning(inertia, (orientation, state.angular), ahead, (margin, shape.radius)),
            None => Vec3::zero(),
        };
        let momentum = state.linear;
        let linear = Vec3::new(momentum.x / mass, momentum.y / mass, momentum.z / mass);
        let way = linear * ahead;
        let fallen = splat::<T>(drop) * load_scale(bodies.gravity_scale, i);
        let drop = drop_of(fallen, shape.half_thickness);
        let speed = linear.dot(linear).sqrt();
        let reach = margin + speed * T::splat(interval.into()) + drop.dot(drop).sqrt();
        let half = shape.half_extents;
        let of_box = cuboid_reach(&CuboidLanes { half_extents: half, orientation });
        let half_aabb = Vec3::select(zero.lt(shape.is_ball), half, of_box) + Vec3::splat(reach);

        let (mut ways, mut turns, mut orientations) =
            ([Way::ZERO; BLOCK], [Turn::ZERO; BLOCK], [Orientation::ZERO; BLOCK]);
        store_rows(Way { way, drop, reach, margin }, &mut ways);
        let (radius, half_thickness) = (shape.radius, shape.half_thickness);
        store_rows(Turn { turn, half_aabb, radius, half_thickness }, &mut turns);
        store_rows(Orientation { orientation, _unused: [zero; 4] }, &mut orientations);
        let mut k = 0;
        while k < T::WIDTH {
            self.write(i + k, &ways[k], &turns[k], orientations[k].orientation);
            k += 1;
        }
    }
}

impl AabbTiles<'_, '_> {
    /// One body after the other.
    #[inline(never)]
    fn update_each(&mut self, first: usize, count: usize) {
        (first..first + count).for_each(|i| self.update.update(i, self.bodies, self.intervals));
    }

    fn write(&mut self, i: usize, way: &Way, turn: &Turn, orientation: Quat<Real>) {
        let update = &mut *self.update;
        let center = Vec3::from(self.bodies.pose[i].position);
        let placement = Isometry { position: center, orientation };
        let velocity = match self.bodies.velocity {
            Some(velocities) => (velocities[i].linear.into(), velocities[i].angular.into()),
            None => (Vec3::zero(), Vec3::zero()),
        };
        let is_ball = update.shapes[i].is_ball > 0.0;
        update.states[i] = ColliderState {
            placement,
            center,
            kind: if is_ball { LaneKind::Sphere } else { LaneKind::Cuboid },
            is_dynamic: true,
            is_fixed: false,
            reach: way.reach,
            margin: way.margin,
            half_thickness: turn.half_thickness,
            velocity,
            motion: Motion { way: way.way, drop: way.drop, turn: turn.turn, axis_turn: None, radius: turn.radius },
        };
        let Vec3 { x, y, z } = update.shapes[i].half_extents;
        let extents = if is_ball { Vec3::new(x, 0.0, 0.0) } else { Vec3::new(x, y, z) };
        update.lanes.set_extents(i, extents, &placement, (Vec3::zero(), way.reach, way.margin));
        update.activity[i] = Activity::Awake;
        update.proxies[i] = Proxy { aabb: Some(Aabb::about(center, turn.half_aabb)), moves: true };
    }
}
