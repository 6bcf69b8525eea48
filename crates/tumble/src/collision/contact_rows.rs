//! The numbers of a contact record as rows of eight, and those of a tile's contacts.

use tumble_collide::MAX_MANIFOLD_POINTS;
use tumble_math::lane::Vec3;

use crate::collision::contact::ContactRecord;
use crate::math::Real;
use crate::simd::block_lanes::{at, vector_at};
use crate::simd::{BLOCK, Octet, Tile, gather_rows, octet};

octet! {
    /// Where the surfaces are to each other, and what they are like.
    pub(crate) struct ContactGeometry<T> {
        /// Unit vector from the first body to the second, world frame.
        pub(crate) normal: Vec3<T>,
        /// How far points go along with the second body, from 0 to 1.
        pub(crate) carried: T,
        /// How many points.
        pub(crate) count: T,
        /// As a length \[m\].
        pub(crate) rolling_resistance: T,
        pub(crate) restitution: T,
        /// The number of an [`UpdateRule`](crate::collision::contact::UpdateRule).
        pub(crate) update_rule: T,
    }
}

octet! {
    /// Two points of a contact when the step began. They are on the surface of the body that
    /// carries them, so that friction has the arm that it has when they meet.
    pub(crate) struct PointPair<T> {
        /// From the second body's centre of mass \[m\].
        pub(crate) positions: [Vec3<T>; 2],
        /// \[m\].
        pub(crate) separations: [T; 2],
    }
}

octet! {
    /// Impulses of a substep along the normal, and what limits friction by them.
    pub(crate) struct NormalImpulses<T> {
        /// \[N s\].
        pub(crate) at_points: [T; MAX_MANIFOLD_POINTS],
        pub(crate) static_friction: T,
        pub(crate) dynamic_friction: T,
        /// One less how much effective masses changed in the last substep, but not below zero.
        pub(crate) steady: T,
        /// Which share of the gap between the surfaces is before the points.
        pub(crate) gap_share: T,
    }
}

octet! {
    /// Impulses of a substep in the middle of the points, on the second body, world frame.
    pub(crate) struct WorldFriction<T> {
        /// Impulse of friction \[N s\].
        pub(crate) linear: Vec3<T>,
        /// Angular impulse of what resists twisting and rolling [N m s].
        pub(crate) angular: Vec3<T>,
        /// How near the surfaces are a contact \[m\], but for how fast they come.
        pub(crate) margin: T,
        /// How often the substeps of its island were halved.
        pub(crate) halvings: T,
    }
}

/// The contacts of a tile, one a lane.
pub(crate) struct ContactLanes<'a>([&'a ContactRecord; BLOCK]);

impl<'a> ContactLanes<'a> {
    /// Lanes without contacts.
    #[inline(always)]
    pub(crate) fn empty() -> Self {
        Self([&ContactRecord::NONE; BLOCK])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, contact: &'a ContactRecord) {
        self.0[lane] = contact;
    }

    #[inline(always)]
    pub(crate) fn geometry<T: Tile>(&self) -> ContactGeometry<T> {
        let mut rows = [ContactGeometry::zero(); BLOCK];
        let mut i = 0;
        while i < T::WIDTH {
            rows[i] = &self.0[i].geometry;
            i += 1;
        }
        gather_rows(&rows)
    }

    /// Positions of the points, and separations there.
    #[inline(always)]
    pub(crate) fn points<T: Tile>(&self) -> ([Vec3<T>; MAX_MANIFOLD_POINTS], [T; MAX_MANIFOLD_POINTS]) {
        let mut rows = [[PointPair::zero(); BLOCK]; 2];
        let mut i = 0;
        while i < T::WIDTH {
            let [first, second] = &self.0[i].points;
            (rows[0][i], rows[1][i]) = (first, second);
            i += 1;
        }
        let PointPair { positions: [a, b], separations: [s, t] } = gather_rows(&rows[0]);
        let PointPair { positions: [c, d], separations: [u, v] } = gather_rows(&rows[1]);
        ([a, b, c, d], [s, t, u, v])
    }

    #[inline(always)]
    pub(crate) fn normal_impulses<T: Tile>(&self) -> NormalImpulses<T> {
        let mut rows = [NormalImpulses::zero(); BLOCK];
        let mut i = 0;
        while i < T::WIDTH {
            rows[i] = &self.0[i].normal_impulses;
            i += 1;
        }
        gather_rows(&rows)
    }

    /// How far surfaces are from the points that go with their bodies \[m\].
    #[inline(always)]
    pub(crate) fn core_radius<T: Tile>(&self) -> T {
        let mut lanes = [0.0; BLOCK];
        let mut i = 0;
        while i < T::WIDTH {
            lanes[i] = self.0[i].core_radius;
            i += 1;
        }
        at(&lanes, 0)
    }

    #[inline(always)]
    pub(crate) fn surface_velocity<T: Tile>(&self) -> Vec3<T> {
        let (mut vectors, mut i) = ([Vec3::zero(); BLOCK], 0);
        while i < T::WIDTH {
            vectors[i] = self.0[i].surface_velocity;
            i += 1;
        }
        side_by_side(&vectors)
    }

    /// The second body's centre of mass from the first's when they meet \[m\].
    #[inline(always)]
    pub(crate) fn met_apart<T: Tile>(&self) -> Vec3<T> {
        let (mut vectors, mut i) = ([Vec3::zero(); BLOCK], 0);
        while i < T::WIDTH {
            vectors[i] = self.0[i].meeting.apart;
            i += 1;
        }
        side_by_side(&vectors)
    }

    #[inline(always)]
    pub(crate) fn friction<T: Tile>(&self) -> WorldFriction<T> {
        let mut rows = [WorldFriction::zero(); BLOCK];
        let mut i = 0;
        while i < T::WIDTH {
            rows[i] = &self.0[i].friction;
            i += 1;
        }
        gather_rows(&rows)
    }
}

/// Vectors as those of a tile.
#[inline(always)]
fn side_by_side<T: Tile>(vectors: &[Vec3<Real>; BLOCK]) -> Vec3<T> {
    let (mut lanes, mut i) = ([[0.0; BLOCK]; 3], 0);
    while i < T::WIDTH {
        let Vec3 { x, y, z } = vectors[i];
        [lanes[0][i], lanes[1][i], lanes[2][i]] = [x, y, z];
        i += 1;
    }
    vector_at(&lanes, 0)
}
