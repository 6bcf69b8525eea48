//! What each body adds to the sums over a world, for many bodies at a time.

use glam::DVec3;
use tumble_math::lane::{Lane, Quat as LaneQuat, Vec3 as LaneVec3};

use crate::components::{GravityScale, Inertia, Mass, Momentum, Pose, PrincipalAxes};
use crate::energy::totals::Totals;
use crate::integrators::kinetic_energy::KineticEnergy;
use crate::math::{Quat, Real, Vec3};
use crate::simd::{Kernel, MAX_BODIES, Tile, dispatch, widen_quat, widen_vec};

/// Linear and rotational kinetic energy, `M g.x`, `P`, and `x x P + L`.
const TERMS: usize = 9;

/// Bodies whose terms are taken together, and the sums of all before them.
pub(crate) struct MeasuredBodies {
    gravity: DVec3,
    sums: [f64; TERMS],
    len: usize,
    given: Given,
    terms: [[f64; MAX_BODIES]; TERMS],
}

/// What the terms are taken from.
struct Given {
    pose: [Pose; MAX_BODIES],
    momentum: [Momentum; MAX_BODIES],
    mass: [Real; MAX_BODIES],
    gravity_scale: [Real; MAX_BODIES],
    /// Of a point mass boundless ones, so that its angular momentum has no energy.
    moments: [[Real; MAX_BODIES]; 3],
    axes: [PrincipalAxes; MAX_BODIES],
}

impl MeasuredBodies {
    /// None yet, in a field of gravity [m/s^2].
    pub(crate) fn new(gravity: DVec3) -> Self {
        Self {
            gravity,
            sums: [0.0; TERMS],
            len: 0,
            given: Given {
                pose: [Pose::default(); MAX_BODIES],
                momentum: [Momentum::default(); MAX_BODIES],
                mass: [0.0; MAX_BODIES],
                gravity_scale: [0.0; MAX_BODIES],
                moments: [[0.0; MAX_BODIES]; 3],
                axes: [PrincipalAxes(Quat::IDENTITY); MAX_BODIES],
            },
            terms: [[0.0; MAX_BODIES]; TERMS],
        }
    }

    /// Takes another body.
    #[inline]
    pub(crate) fn push(
        &mut self,
        (pose, momentum, mass): (&Pose, &Momentum, &Mass),
        (inertia, axes): (Option<&Inertia>, Option<&PrincipalAxes>),
        scale: Option<&GravityScale>,
    ) {
        if self.len >= MAX_BODIES {
            self.add_terms();
        }
        let (i, given) = (self.len, &mut self.given);
        self.len += 1;
        (given.pose[i], given.momentum[i]) = (*pose, *momentum);
        (given.mass[i], given.gravity_scale[i]) = (mass.kilograms(), scale.map_or(1.0, |scale| scale.0));
        let moments = inertia.map_or(Vec3::INFINITY, Inertia::moments);
        [given.moments[0][i], given.moments[1][i], given.moments[2][i]] = moments.to_array();
        given.axes[i] = axes.copied().unwrap_or(PrincipalAxes(Quat::IDENTITY));
    }

    /// The sums over all bodies, one after the other in the order in which they came.
    pub(crate) fn totals(mut self) -> Totals {
        self.add_terms();
        let [linear_kinetic, rotational_kinetic, fall, px, py, pz, lx, ly, lz] = self.sums;
        Totals {
            linear_kinetic,
            rotational_kinetic,
            potential: 0.0 - fall,
            linear_momentum: DVec3::new(px, py, pz),
            angular_momentum: DVec3::new(lx, ly, lz),
            ..Totals::default()
        }
    }

    /// Adds the terms of the bodies that are there, and forgets these.
    fn add_terms(&mut self) {
        dispatch(&mut TakeTerms { bodies: &self.given, len: self.len, gravity: self.gravity, terms: &mut self.terms });
        let mut sums = self.sums;
        for i in 0..self.len {
            for (sum, row) in sums.iter_mut().zip(&self.terms) {
                *sum += row[i];
            }
        }
        (self.sums, self.len) = (sums, 0);
    }
}

/// Takes the terms, a tile at a time.
struct TakeTerms<'k> {
    bodies: &'k Given,
    len: usize,
    gravity: DVec3,
    terms: &'k mut [[f64; MAX_BODIES]; TERMS],
}

impl Kernel for TakeTerms<'_> {
    const IS_RARE: bool = true;

    #[inline(always)]
    fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let bodies = self.bodies;
        let [qx, qy, qz, qw, x, y, z] = T::load(&bodies.pose[i..]);
        let [px, py, pz, lx, ly, lz] = T::load(&bodies.momentum[i..]);
        let [ax, ay, az, aw] = T::load(&bodies.axes[i..]);
        let [[mass], [scale]] = [T::load(&bodies.mass[i..]), T::load(&bodies.gravity_scale[i..])];
        let [[a], [b], [c]] =
            [T::load(&bodies.moments[0][i..]), T::load(&bodies.moments[1][i..]), T::load(&bodies.moments[2][i..])];
        let (linear, angular) = (LaneVec3::new(px, py, pz), LaneVec3::new(lx, ly, lz));
        let axes = widen_quat(LaneQuat { x: ax, y: ay, z: az, w: aw });
        let frame = widen_quat(LaneQuat { x: qx, y: qy, z: qz, w: qw }) * axes;
        let rotational = KineticEnergy::of_rotation(LaneVec3::new(a, b, c), frame, angular);
        let (position, p) = (widen_vec(LaneVec3::new(x, y, z)), widen_vec(linear));
        let g = self.gravity;
        let gravity = LaneVec3::new(T::Double::splat(g.x), T::Double::splat(g.y), T::Double::splat(g.z));
        let fall = mass.widen() * scale.widen() * gravity.dot(position);
        let about_origin = position.cross(p) + widen_vec(angular);
        let terms = [
            KineticEnergy::of_motion(mass, linear),
            rotational,
            fall,
            p.x,
            p.y,
            p.z,
            about_origin.x,
            about_origin.y,
            about_origin.z,
        ];
        let mut term = 0;
        while term < TERMS {
            T::store_doubles(terms[term], &mut self.terms[term][i..]);
            term += 1;
        }
    }
}
