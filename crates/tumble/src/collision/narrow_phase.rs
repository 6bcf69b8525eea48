//! Narrow phase of sphere and cuboid pairs in SIMD lanes.

use std::marker::PhantomData;
use std::ops::Range;

use rayon::prelude::*;
use tumble_collide::lanes::{CuboidLanes, ManifoldLanes, cuboid_gap, cuboid_pair, sphere_pair};
use tumble_collide::{ColliderShape, Isometry, MAX_MANIFOLD_POINTS};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider::Collider;
use crate::collision::contact::{ContactRecord, UpdateRule};
use crate::collision::contact_rows::{ContactGeometry, PointPair};
use crate::math::Real;
use crate::simd::block_lanes::put;
use crate::simd::{BLOCK, HALF_BLOCK, Kernel, Octet, Tile, dispatch_in_blocks, gather, octet, store_rows};
use crate::storage::body_index::Slot;
use crate::threads::InParts;

/// Shapes whose pairs are tested in lanes, by slot.
#[derive(Clone, Default)]
pub(crate) struct ShapeLanes {
    poses: Vec<ShapePose>,
    sizes: Vec<ShapeSize>,
}

octet! {
    /// Where a shape is.
    struct ShapePose<T> {
        /// Of its origin \[m\].
        position: Vec3<T>,
        orientation: Quat<T>,
        _unused: T,
    }
}

octet! {
    /// How far a shape extends.
    struct ShapeSize<T> {
        /// Half of them; of a ball its radius first \[m\].
        extents: Vec3<T>,
        /// Its origin from the body's centre of mass, world frame \[m\].
        offset: Vec3<T>,
        /// How far it looks for others \[m\].
        reach: T,
        /// The same without what its velocity adds \[m\]; zero for non-dynamic bodies.
        margin: T,
    }
}

/// Which lanes a shape is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum LaneKind {
    Cuboid,
    Sphere,
    /// None: pairs with it are tested one by one.
    Other,
}

impl LaneKind {
    pub(crate) fn of(geometry: &ColliderShape<Real>) -> Self {
        match geometry {
            ColliderShape::Cuboid { .. } => Self::Cuboid,
            ColliderShape::Sphere { .. } => Self::Sphere,
            _ => Self::Other,
        }
    }

    /// Of the shapes of two colliders; of a body that lost its collider it is [`Self::Other`].
    pub(crate) fn of_both([first, second]: [Option<&Collider>; 2]) -> Self {
        let kind = |collider: Option<&Collider>| collider.map_or(Self::Other, |it| Self::of(it.geometry()));
        Self::both(kind(first), kind(second))
    }

    /// Of a pair.
    pub(crate) fn both(first: Self, second: Self) -> Self {
        if first == second { first } else { Self::Other }
    }
}

impl ShapeLanes {
    pub(crate) fn reset(&mut self, count: usize) {
        // One more, for lanes without a pair.
        self.poses.clear();
        self.poses.resize(count + 1, ShapePose::ZERO);
        self.sizes.clear();
        self.sizes.resize(count + 1, ShapeSize::ZERO);
    }

    /// A slot without pairs.
    fn nobody(&self) -> u32 {
        (self.poses.len() - 1) as u32
    }

    pub(crate) fn set_reach(&mut self, slot: usize, reach: Real) {
        self.sizes[slot].reach = reach;
    }

    /// Some slots, to be set.
    pub(crate) fn part(&mut self, slots: Range<usize>) -> ShapeLanesPart<'_> {
        ShapeLanesPart { poses: &mut self.poses[slots.clone()], sizes: &mut self.sizes[slots] }
    }
}

/// Some neighbouring slots.
pub(crate) struct ShapeLanesPart<'a> {
    poses: &'a mut [ShapePose],
    sizes: &'a mut [ShapeSize],
}

impl ShapeLanesPart<'_> {
    /// The first `middle`, and the others.
    pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
        let (poses, other_poses) = self.poses.split_at_mut(middle);
        let (sizes, other_sizes) = self.sizes.split_at_mut(middle);
        (Self { poses, sizes }, Self { poses: other_poses, sizes: other_sizes })
    }

    pub(crate) fn set(
        &mut self,
        slot: usize,
        geometry: &ColliderShape<Real>,
        at: &Isometry<Real>,
        center: Vec3<Real>,
        (reach, margin): (Real, Real),
    ) {
        let extents = match *geometry {
            ColliderShape::Cuboid { half_extents } => half_extents,
            ColliderShape::Sphere { radius } => Vec3::new(radius, 0.0, 0.0),
            _ => Vec3::zero(),
        };
        self.set_extents(slot, extents, at, (at.position - center, reach, margin));
    }

    /// Sets a shape by how far it extends, its origin from the body's centre of mass, its reach and
    /// its margin \[m\].
    #[inline]
    pub(crate) fn set_extents(
        &mut self,
        slot: usize,
        extents: Vec3<Real>,
        at: &Isometry<Real>,
        (offset, reach, margin): (Vec3<Real>, Real, Real),
    ) {
        self.poses[slot] = ShapePose { position: at.position, orientation: at.orientation, _unused: 0.0 };
        self.sizes[slot] = ShapeSize { extents, offset, reach, margin };
    }
}

/// Blocks of pairs that one thread tests at a time.
const PART: usize = 16;

/// Pairs of one kind, in blocks, and what was found out about them.
#[derive(Clone, Default)]
pub(crate) struct Pairs {
    pairs: Vec<[Slot; 2]>,
    blocks: Vec<[[u32; BLOCK]; 2]>,
    gaps: Vec<Real>,
}

impl Pairs {
    pub(crate) fn clear(&mut self) {
        self.pairs.clear();
    }

    pub(crate) fn push(&mut self, pair: [Slot; 2]) {
        self.pairs.push(pair);
    }

    /// Writes contacts of the pairs that may touch, in their order, over those from `begin` on.
    /// Returns their end, and whether there are some without points among them.
    pub(crate) fn touch(
        &mut self,
        kind: LaneKind,
        shapes: &ShapeLanes,
        contacts: &mut Vec<ContactRecord>,
        begin: usize,
    ) -> (usize, bool) {
        match kind {
            LaneKind::Cuboid => self.touch_as::<Cuboids>(kind, shapes, contacts, begin),
            LaneKind::Sphere | LaneKind::Other => self.touch_as::<Spheres>(kind, shapes, contacts, begin),
        }
    }

    fn touch_as<S: LaneShape>(
        &mut self,
        kind: LaneKind,
        shapes: &ShapeLanes,
        contacts: &mut Vec<ContactRecord>,
        begin: usize,
    ) -> (usize, bool) {
        self.fill_blocks(shapes.nobody());
        self.gaps.clear();
        self.gaps.resize(self.pairs.len().next_multiple_of(HALF_BLOCK), 0.0);
        let parts = self.blocks.par_chunks(PART).zip(self.gaps.par_chunks_mut(PART * BLOCK));
        parts.by_at_least(1).for_each(|(blocks, gaps)| {
            dispatch_in_blocks(&mut Gaps::<S> { blocks, shapes, gaps, kind: PhantomData });
        });
        let mut gaps = self.gaps.iter();
        // What is not a number is not near.
        self.pairs.retain(|_| gaps.next().is_some_and(|gap| *gap <= 0.0));
        self.fill_blocks(shapes.nobody());

        // What is there is not cleared first: many contacts are more than caches hold, and this way
        // they are written once.
        let end = begin + self.pairs.len().next_multiple_of(HALF_BLOCK);
        if contacts.len() < end {
            contacts.resize(end, ContactRecord::NONE);
        }
        let parts = self.blocks.par_chunks(PART).zip(contacts[begin..end].par_chunks_mut(PART * BLOCK));
        let parts = parts.zip(self.pairs.par_chunks(PART * BLOCK)).by_at_least(1).map(|((blocks, found), pairs)| {
            dispatch_in_blocks(&mut Manifolds::<S> { blocks, shapes, found, kind: PhantomData });
            let found = &mut found[..pairs.len()];
            found.iter_mut().for_each(|contact| contact.begin(kind));
            found.iter().any(|contact| contact.count() == 0)
        });
        (begin + self.pairs.len(), parts.reduce(|| false, |some, others| some | others))
    }

    fn fill_blocks(&mut self, nobody: u32) {
        self.blocks.clear();
        self.blocks.extend(self.pairs.chunks(BLOCK).map(|chunk| {
            let mut block = [[nobody; BLOCK]; 2];
            for (lane, [first, second]) in chunk.iter().enumerate() {
                (block[0][lane], block[1][lane]) = (first.0, second.0);
            }
            block
        }));
    }
}

/// A kind of shape whose pairs are tested in lanes.
trait LaneShape {
    /// The shapes of a tile, about their origins.
    type Lanes<T: Tile>;

    /// A shape of a size and an orientation.
    fn lanes<T: Tile>(pose: &ShapePose<T>, size: &ShapeSize<T>) -> Self::Lanes<T>;

    /// How far two are apart at least, `between` from the first to the second \[m\].
    fn gap<T: Tile>(first: &Self::Lanes<T>, second: &Self::Lanes<T>, between: Vec3<T>) -> T;

    fn manifold<T: Tile>(
        first: &Self::Lanes<T>,
        second: &Self::Lanes<T>,
        between: Vec3<T>,
        reach: T,
    ) -> ManifoldLanes<T>;

    /// How the geometry of a contact follows the bodies: the number of an [`UpdateRule`].
    fn update_rule<T: Tile>(offsets: [Vec3<T>; 2]) -> T;
}

struct Cuboids;

impl LaneShape for Cuboids {
    type Lanes<T: Tile> = CuboidLanes<T>;

    #[inline(always)]
    fn lanes<T: Tile>(pose: &ShapePose<T>, size: &ShapeSize<T>) -> CuboidLanes<T> {
        CuboidLanes { half_extents: size.extents, orientation: pose.orientation }
    }

    #[inline(always)]
    fn gap<T: Tile>(first: &CuboidLanes<T>, second: &CuboidLanes<T>, between: Vec3<T>) -> T {
        cuboid_gap(first, second, between)
    }

    #[inline(always)]
    fn manifold<T: Tile>(
        first: &CuboidLanes<T>,
        second: &CuboidLanes<T>,
        between: Vec3<T>,
        reach: T,
    ) -> ManifoldLanes<T> {
        cuboid_pair(first, second, between, reach)
    }

    #[inline(always)]
    fn update_rule<T: Tile>(_: [Vec3<T>; 2]) -> T {
        T::splat(UpdateRule::BodyFixed.number())
    }
}

struct Spheres;

impl LaneShape for Spheres {
    /// Radii \[m\].
    type Lanes<T: Tile> = T;

    #[inline(always)]
    fn lanes<T: Tile>(_: &ShapePose<T>, size: &ShapeSize<T>) -> T {
        size.extents.x
    }

    #[inline(always)]
    fn gap<T: Tile>(first: &T, second: &T, between: Vec3<T>) -> T {
        between.dot(between).sqrt() - (*first + *second)
    }

    #[inline(always)]
    fn manifold<T: Tile>(first: &T, second: &T, between: Vec3<T>, reach: T) -> ManifoldLanes<T> {
        sphere_pair(*first, *second, between, reach)
    }

    #[inline(always)]
    fn update_rule<T: Tile>([first, second]: [Vec3<T>; 2]) -> T {
        // Balls that are not about their centres of mass wobble.
        let off = first.dot(first) + second.dot(second);
        let [refined, centers] = [UpdateRule::Refined, UpdateRule::LineOfCenters].map(UpdateRule::number);
        T::select(T::splat(0.0).lt(off), T::splat(refined), T::splat(centers))
    }
}

/// The pairs of a tile.
struct PairLanes<T: Tile, S: LaneShape> {
    shapes: [S::Lanes<T>; 2],
    /// From the origin of the first to that of the second \[m\].
    between: Vec3<T>,
    sizes: [ShapeSize<T>; 2],
}

impl<T: Tile, S: LaneShape> PairLanes<T, S> {
    #[inline(always)]
    fn load(shapes: &ShapeLanes, rows: &[[u32; BLOCK]; 2], lane: usize) -> Self {
        let first = gather::<T, _>(&shapes.poses, &rows[0], lane);
        let second = gather::<T, _>(&shapes.poses, &rows[1], lane);
        let sizes = [gather::<T, _>(&shapes.sizes, &rows[0], lane), gather::<T, _>(&shapes.sizes, &rows[1], lane)];
        let between = second.position - first.position;
        Self { shapes: [S::lanes(&first, &sizes[0]), S::lanes(&second, &sizes[1])], between, sizes }
    }

    /// How far apart surfaces may be to be a contact \[m\].
    #[inline(always)]
    fn reach(&self) -> T {
        self.sizes[0].reach + self.sizes[1].reach
    }
}

/// How far pairs are apart, but for their reach.
struct Gaps<'a, S> {
    blocks: &'a [[[u32; BLOCK]; 2]],
    shapes: &'a ShapeLanes,
    gaps: &'a mut [Real],
    kind: PhantomData<S>,
}

impl<S: LaneShape> Kernel for Gaps<'_, S> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.gaps.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let pairs = PairLanes::<T, S>::load(self.shapes, &self.blocks[i / BLOCK], i % BLOCK);
        let [first, second] = &pairs.shapes;
        T::store([S::gap(first, second, pairs.between) - pairs.reach()], &mut self.gaps[i..]);
    }
}

/// The manifolds of pairs.
struct Manifolds<'a, S> {
    blocks: &'a [[[u32; BLOCK]; 2]],
    shapes: &'a ShapeLanes,
    found: &'a mut [ContactRecord],
    kind: PhantomData<S>,
}

impl<S: LaneShape> Kernel for Manifolds<'_, S> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.found.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (rows, lane) = (&self.blocks[i / BLOCK], i % BLOCK);
        let pairs = PairLanes::<T, S>::load(self.shapes, rows, lane);
        let [first, second] = &pairs.shapes;
        let manifold = S::manifold(first, second, pairs.between, pairs.reach());
        let [size, other] = &pairs.sizes;
        let update_rule = S::update_rule([size.offset, other.offset]);
        let margins = [size.margin, other.margin];
        write(&manifold, other.offset, update_rule, margins, &mut self.found[i..], rows, lane);
    }
}

/// Writes a tile's manifolds as contacts; `offset` goes from the second bodies' centres of mass to
/// their shapes' origins.
#[inline(always)]
fn write<T: Tile>(
    manifold: &ManifoldLanes<T>,
    offset: Vec3<T>,
    update_rule: T,
    margins: [T; 2],
    found: &mut [ContactRecord],
    rows: &[[u32; BLOCK]; 2],
    lane: usize,
) {
    let zero = T::splat(0.0);
    let n = manifold.normal;
    let mut geometries = [ContactGeometry::ZERO; BLOCK];
    let geometry = ContactGeometry {
        normal: n,
        carried: manifold.carried,
        count: manifold.count,
        rolling_resistance: zero,
        restitution: zero,
        update_rule,
    };
    store_rows(geometry, &mut geometries);
    // As `Second::share` has it.
    let share = T::select(zero.lt(margins[0]), manifold.carried, T::splat(1.0));
    let (mut shares, mut margin) = ([0.0; BLOCK], [0.0; BLOCK]);
    put(share, &mut shares, 0);
    put(margins[0] + margins[1], &mut margin, 0);
    let mut points = [[PointPair::ZERO; BLOCK]; MAX_MANIFOLD_POINTS / 2];
    let mut half = 0;
    while half < points.len() {
        let (j, k) = (2 * half, 2 * half + 1);
        let (s, t) = (manifold.separations[j], manifold.separations[k]);
        let to_surface = share - T::splat(0.5);
        let (a, b) = (manifold.places[j] + n * (s * to_surface), manifold.places[k] + n * (t * to_surface));
        store_rows(PointPair { positions: [a + offset, b + offset], separations: [s, t] }, &mut points[half]);
        half += 1;
    }
    let mut features = [[0.0; BLOCK]; MAX_MANIFOLD_POINTS];
    let mut j = 0;
    while j < MAX_MANIFOLD_POINTS {
        put(manifold.features[j], &mut features[j], 0);
        j += 1;
    }
    let mut i = 0;
    while i < T::WIDTH {
        let contact = &mut found[i];
        contact.slots = [Slot(rows[0][lane + i]), Slot(rows[1][lane + i])];
        (contact.normal_impulses.gap_share, contact.friction.margin) = (shares[i], margin[i]);
        contact.geometry = geometries[i];
        contact.points = [points[0][i], points[1][i]];
        let mut j = 0;
        while j < MAX_MANIFOLD_POINTS {
            contact.features[j] = features[j][i] as u32;
            j += 1;
        }
        i += 1;
    }
}
