//! Memory traffic and arithmetic operations of one body in one step.

use hecs::World;
use tumble::math::{Quat, Real, Vec3};
use tumble::{Inertia, InverseInertia, Mass, Momentum, Pose, Velocity, Wrench};
use tumble_math::FreeRotation;
use tumble_math::lane::{Lane, Quat as LaneQuat, Vec3 as LaneVec3};

use crate::counted::{Counted, Operations, count};

/// What a step does with the columns of a box.
pub(crate) struct Traffic {
    /// The component, its size, and how many of its bytes are read and written.
    pub(crate) columns: [(&'static str, usize, usize, usize); 7],
}

impl Traffic {
    pub(crate) fn of_a_box() -> Self {
        let updated = |name, size| (name, size, size, size);
        let read = |name, size| (name, size, size, 0);
        let written = |name, size| (name, size, 0, size);
        Self {
            columns: [
                updated("Pose", size_of::<Pose>()),
                updated("Momentum", size_of::<Momentum>()),
                // Nothing was applied, so there is nothing to clear.
                read("Wrench", size_of::<Wrench>()),
                read("Mass", size_of::<Mass>()),
                read("Inertia", size_of::<Inertia>()),
                written("Velocity", size_of::<Velocity>()),
                written("InverseInertia", size_of::<InverseInertia>()),
            ],
        }
    }

    /// Bytes of memory that a box takes.
    pub(crate) fn size(&self) -> usize {
        self.columns.iter().map(|column| column.1).sum()
    }

    pub(crate) fn read(&self) -> usize {
        self.columns.iter().map(|column| column.2).sum()
    }

    pub(crate) fn written(&self) -> usize {
        self.columns.iter().map(|column| column.3).sum()
    }

    /// Bytes that are read only because a cache line is fetched before it is written to.
    pub(crate) fn allocated(&self) -> usize {
        self.columns.iter().filter(|column| column.2 == 0).map(|column| column.3).sum()
    }
}

/// What is computed for a body in a step: in the drift, by running the engine's own map with
/// numbers that count, and in all the rest, by computing the formulas of the documentation with
/// them.
pub(crate) fn operations(world: &mut World, dt: Real) -> [Operations; 2] {
    let (mut drift, mut rest) = (Operations::default(), Operations::default());
    let mut bodies = 0;
    for (pose, momentum, mass, inertia) in world.query_mut::<(&Pose, &Momentum, &Mass, &Inertia)>() {
        let (h, m) = (Counted(dt), Counted(mass.kilograms()));
        let (q, p, l) = (quat(pose.orientation), vector(momentum.linear), vector(momentum.angular));
        let (moments, inverse) = (vector(inertia.moments()), vector(inertia.inverse_moments()));
        drift += count(|| FreeRotation::new(moments, inverse, None, h).rotate(q, l));
        rest += count(|| all_but_the_drift(q, p, l, m, inverse, h));
        bodies += 1;
    }
    [drift, rest].map(|operations| operations.per(bodies))
}

fn vector(v: Vec3) -> LaneVec3<Counted> {
    LaneVec3::new(Counted(v.x), Counted(v.y), Counted(v.z))
}

fn quat(q: Quat) -> LaneQuat<Counted> {
    LaneQuat { x: Counted(q.x), y: Counted(q.y), z: Counted(q.z), w: Counted(q.w) }
}

/// Gravity on the wrench, half a kick, the way in a straight line, half a kick; velocities and the
/// inverse inertia in the world.
fn all_but_the_drift<L: Lane>(
    q: LaneQuat<L>,
    p: LaneVec3<L>,
    l: LaneVec3<L>,
    m: L,
    inverse: LaneVec3<L>,
    h: L,
) -> [LaneVec3<L>; 5] {
    let (half, per_mass) = (h * L::splat(0.5), L::splat(1.0) / m);
    let (gravity, wrench) = (LaneVec3::splat(h), LaneVec3::splat(h));
    let force = wrench + gravity * m;
    let p = p + force * half;
    let l = l + wrench * half;
    let way = l + p * per_mass * h;
    let p = p + force * half;
    let l = l + wrench * half;

    let [a, b, c] = q.axes();
    let (ai, bi, ci) = (a * inverse.x, b * inverse.y, c * inverse.z);
    let diagonal = a.scale(ai) + b.scale(bi) + c.scale(ci);
    let mixed = |r: LaneVec3<L>, i: LaneVec3<L>| LaneVec3::new(r.y * i.z, r.z * i.x, r.x * i.y);
    let off_diagonal = mixed(a, ai) + mixed(b, bi) + mixed(c, ci);
    let (d, o) = (diagonal, off_diagonal);
    let spin = LaneVec3::new(
        d.x * l.x + o.z * l.y + o.y * l.z,
        o.z * l.x + d.y * l.y + o.x * l.z,
        o.y * l.x + o.x * l.y + d.z * l.z,
    );
    [way, p * per_mass, spin, diagonal, off_diagonal]
}
