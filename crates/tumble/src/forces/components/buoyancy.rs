//! Buoyancy of spheres and boxes in still water, from the exact submerged volume and centroid.

use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::forces::force_law::BodyState;
use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::math::{Real, Vec3, dquat, dvec3};

/// The lift of a body in still water: `F = -rho V g` at the centroid of the volume `V` that is
/// under water (Archimedes).
///
/// Up is against the simulation's gravity; the surface is the plane of all points `level` above the
/// origin. Volume and centroid are exact for both hulls, so a box rights itself or turns over as it
/// should. The energy is `rho g` times the integral of depth over the volume. The water does not
/// resist: that is [`Damping`](crate::Damping)'s or [`Drag`](crate::Drag)'s. Without gravity there
/// is no lift.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// // A ball of half the density of water, with its centre in the surface: lift and weight cancel.
/// let ball = RigidBody::new(Shape::sphere(0.5)).density(500.0).build()?.spawn(&mut world);
/// world.insert_one(ball, Buoyancy::new(Hull::Sphere { radius: 0.5 }))?;
/// Simulation::new(Settings::default())?.step(&mut world);
/// assert!(world.get::<&Velocity>(ball)?.linear.y.abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Buoyancy {
    /// Density of the water [kg/m^3].
    pub density: Real,
    /// Height of the surface above the world's origin \[m\].
    pub level: Real,
    /// What floats.
    pub hull: Hull,
    /// Centre of the hull \[m\], from the centre of mass along the body's axes. A boat with ballast
    /// has it above.
    pub center: Vec3,
}

/// Shapes that float.
///
/// ```
/// # use tumble::prelude::*;
/// let raft = Hull::Cuboid { half_extents: Vec3::new(1.0, 0.1, 2.0) };
/// let afloat_on_a_lake = Buoyancy { level: 120.0, ..Buoyancy::new(raft) };
/// # assert_eq!(afloat_on_a_lake.density, 1000.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hull {
    /// A ball.
    Sphere {
        /// Radius \[m\].
        radius: Real,
    },
    /// A box along the body's axes.
    Cuboid {
        /// Half its lengths \[m\].
        half_extents: Vec3,
    },
}

impl Buoyancy {
    /// Of a hull around the centre of mass in fresh water, 1000 kg/m^3, whose surface goes through
    /// the origin.
    pub fn new(hull: Hull) -> Self {
        Self { density: 1000.0, level: 0.0, hull, center: Vec3::ZERO }
    }
}

impl SimdForceLaw<9> for Buoyancy {
    fn numbers(&self) -> [Real; 9] {
        // A negative radius tells the cuboid.
        let (radius, h) = match self.hull {
            Hull::Sphere { radius } => (radius.max(0.0), Vec3::ZERO),
            Hull::Cuboid { half_extents } => (-1.0, half_extents),
        };
        let c = self.center;
        [self.density, self.level, radius, h.x, h.y, h.z, c.x, c.y, c.z]
    }

    #[inline(always)]
    fn wrench<L: Lane>([density, level, radius, hx, hy, hz, cx, cy, cz]: [L; 9], body: &SimdBody<L>) -> SimdWrench<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let strength = body.gravity.dot(body.gravity).sqrt();
        let up = body.gravity * L::select(zero.lt(strength), -(one / strength), zero);
        let up_body = body.orientation.rotate_back(up);
        let center = LaneVec3::new(cx, cy, cz);
        let height = (up.dot(body.position) - level) + up_body.dot(center);
        let sphere = Submerged { volume: cap(radius, height), centroid: LaneVec3::zero() };
        let cuboid = Submerged::cuboid(LaneVec3::new(hx, hy, hz), up_body, height);
        let is_cuboid = radius.lt(zero);
        let volume = L::select(is_cuboid, cuboid.volume, sphere.volume);
        // The centroid of a cap is straight below or above the centre, where its arm makes no
        // torque.
        let centroid = LaneVec3::select(is_cuboid, cuboid.centroid, sphere.centroid);
        let lift = body.gravity * -(density * volume);
        SimdWrench::force_at(lift, body.orientation.rotate(center + centroid))
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn potential(&self, state: &BodyState<'_>) -> f64 {
        let gravity = dvec3(state.context().gravity);
        let (strength, up) = (gravity.length(), -gravity.normalize_or_zero());
        let orientation = dquat(state.orientation);
        let up_body = orientation.inverse() * up;
        let height = up.dot(dvec3(state.position)) - f64::from(self.level) + up_body.dot(dvec3(self.center));
        let moment = match self.hull {
            Hull::Sphere { radius } => cap_moment(f64::from(radius).max(0.0), height),
            Hull::Cuboid { half_extents } => {
                let under = Submerged::cuboid(dvec3(half_extents).into(), up_body.into(), height);
                -under.volume * (height + up_body.dot(under.centroid.into()))
            }
        };
        f64::from(self.density) * strength * moment
    }
}

/// Volume \[m^3\] below the surface of a sphere whose centre is `height` \[m\] above it: a cap,
/// `pi c^2 (3 r - c)/3`.
#[inline(always)]
fn cap<L: Lane>(radius: L, height: L) -> L {
    let depth = (radius - height).max(L::splat(0.0)).min(radius + radius);
    depth * depth * (L::splat(3.0) * radius - depth) * L::splat(std::f64::consts::FRAC_PI_3)
}

/// The integral of depth over the part of a sphere below the surface [m^4].
fn cap_moment(radius: f64, height: f64) -> f64 {
    let lowest = radius - height;
    let c = lowest.clamp(0.0, 2.0 * radius);
    let of_cap = std::f64::consts::PI * c.powi(3) * (radius / 3.0 - c / 12.0);
    of_cap + cap(radius, height) * (lowest - c).max(0.0)
}

/// The part of a hull under water.
#[derive(Clone, Copy)]
struct Submerged<L> {
    /// \[m^3\]
    volume: L,
    /// From the hull's centre \[m\], body axes; zero where the volume is.
    centroid: LaneVec3<L>,
}

impl<L: Lane> Submerged<L> {
    /// Of a box whose centre is `height` \[m\] above the surface.
    ///
    /// From a point of the surface the box is a sum of tetrahedra over the triangles of its faces,
    /// each cut by the surface. The cut itself, which contains the point, adds nothing.
    #[inline(always)]
    fn cuboid(half_extents: LaneVec3<L>, up: LaneVec3<L>, height: L) -> Self {
        let zero = L::splat(0.0);
        let h = [half_extents.x, half_extents.y, half_extents.z];
        let rise = half_extents.scale(up);
        let reach = rise.x.abs() + rise.y.abs() + rise.z.abs();
        let (mut volume, mut moment) = (zero, LaneVec3::zero());
        let cut = L::select(reach.lt(height.abs()), zero, L::splat(1.0));
        let triangles = if L::any(zero.lt(cut)) { 12 } else { 0 };
        // Unrolled, the loop would be thousands of instructions for each width of tile.
        for triangle in std::hint::black_box(0)..triangles {
            let (axis, positive, first) = (triangle / 4, triangle % 4 >= 2, triangle % 2 == 0);
            let [a, b, c, d] = face(half_extents, axis, positive, up, height);
            // Six times the volume of each of two tetrahedra is the distance of the face times its
            // area.
            let (along, across) = (h[(axis + 1) % 3], h[(axis + 2) % 3]);
            let distance = h[axis] + outward(up, axis, positive) * height;
            let tetrahedron = distance * along * across * L::splat(4.0 / 6.0);
            let corners = if first { [a, b, c] } else { [a, c, d] };
            let (of_volume, of_moment) = below(corners, tetrahedron);
            volume = volume + of_volume;
            moment = moment + of_moment;
        }
        // Far from the surface the sum would be a difference of large numbers.
        let whole = L::splat(8.0) * h[0] * h[1] * h[2];
        let (dry, drowned) = (reach.lt(height), height.lt(-reach));
        let volume = L::select(dry, zero, L::select(drowned, whole, volume.max(zero)));
        let wet = L::select(zero.lt(volume), L::splat(1.0) / volume, zero);
        // The moment was taken from the point of the surface below or above the centre.
        let centroid = moment * wet + up * -height;
        let none = LaneVec3::zero();
        let centroid = LaneVec3::select(zero.lt(wet), centroid, none);
        let centroid = LaneVec3::select(drowned, none, LaneVec3::select(dry, none, centroid));
        Self { volume, centroid }
    }
}

/// A corner, from the point of the surface below or above the box's centre, and its height above
/// the surface.
#[derive(Clone, Copy)]
struct Corner<L> {
    place: LaneVec3<L>,
    height: L,
}

/// Plus or minus a component of `up`: of the normal that leaves the box.
#[inline(always)]
fn outward<L: Lane>(up: LaneVec3<L>, axis: usize, positive: bool) -> L {
    let component = [up.x, up.y, up.z][axis];
    if positive { component } else { -component }
}

/// The corners of a face, in a row around it.
#[inline(always)]
fn face<L: Lane>(half_extents: LaneVec3<L>, axis: usize, positive: bool, up: LaneVec3<L>, height: L) -> [Corner<L>; 4] {
    let h = [half_extents.x, half_extents.y, half_extents.z];
    let center = up * height;
    let mut corners = [Corner { place: center, height }; 4];
    let mut i = 0;
    while i < 4 {
        let signs = [positive, i == 1 || i == 2, i >= 2];
        let mut components = h;
        let mut j = 0;
        while j < 3 {
            let at = (axis + j) % 3;
            components[at] = if signs[j] { h[at] } else { -h[at] };
            j += 1;
        }
        let from_center = LaneVec3::new(components[0], components[1], components[2]);
        corners[i] = Corner { place: from_center + center, height: height + up.dot(from_center) };
        i += 1;
    }
    corners
}

/// Volume and first moment of the part below the surface of a tetrahedron that stands on a triangle
/// with its tip in the surface.
///
/// Where the surface parts one corner `v` from the others, it cuts off a tetrahedron with the edges
/// from `v` shortened by `t = h_v/(h_v - h_w)` each.
#[inline(always)]
fn below<L: Lane>([a, b, c]: [Corner<L>; 3], volume: L) -> (L, LaneVec3<L>) {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let wet = [wetness(a.height), wetness(b.height), wetness(c.height)];
    let count = wet[0] + wet[1] + wet[2];
    let mostly_wet = L::splat(1.5).lt(count);
    // The corner that is alone on its side, if one is.
    let (b_alone, c_alone) = (is_alone(wet[1], mostly_wet), is_alone(wet[2], mostly_wet));
    let apex = select(c_alone, c, select(b_alone, b, a));
    let next = select(c_alone, a, select(b_alone, c, b));
    let last = select(c_alone, b, select(b_alone, a, c));
    let parted = L::select(zero.lt(count), L::select(count.lt(L::splat(2.5)), one, zero), zero);
    let is_parted = zero.lt(parted);
    let to_next = L::select(is_parted, apex.height / (apex.height - next.height), zero);
    let to_last = L::select(is_parted, apex.height / (apex.height - last.height), zero);
    let cut_off = volume * to_next * to_last;
    let cut_moment =
        (apex.place * L::splat(3.0) + (next.place - apex.place) * to_next + (last.place - apex.place) * to_last)
            * (cut_off * L::splat(0.25));
    let whole = L::select(mostly_wet, volume, zero);
    let whole_moment = (a.place + b.place + c.place) * (whole * L::splat(0.25));
    let sign = L::select(mostly_wet, -one, one);
    (whole + sign * cut_off, whole_moment + cut_moment * sign)
}

/// 1 below the surface, 0 above.
#[inline(always)]
fn wetness<L: Lane>(height: L) -> L {
    L::select(height.lt(L::splat(0.0)), L::splat(1.0), L::splat(0.0))
}

/// Whether a corner is on the other side than most.
#[inline(always)]
fn is_alone<L: Lane>(wetness: L, mostly_wet: L::Mask) -> L::Mask {
    L::splat(0.5).lt(L::select(mostly_wet, L::splat(1.0) - wetness, wetness))
}

#[inline(always)]
fn select<L: Lane>(mask: L::Mask, if_true: Corner<L>, if_false: Corner<L>) -> Corner<L> {
    Corner {
        place: LaneVec3::select(mask, if_true.place, if_false.place),
        height: L::select(mask, if_true.height, if_false.height),
    }
}
