//! A body of a mechanism, in double precision.

use tumble_math::lane::{Quat, Vec3};

use crate::integrators::derived::symmetric_product;
use crate::integrators::state::Moments;
use crate::joints::axis_lock::AxisLock;
use crate::math::{Real, double, double_quat, quat, real, vec3};
use crate::solver::body_rows::{DeltaPose, WorldInverseInertia};
use crate::solver::mechanism::joint_rows::IDENTITY;
use crate::solver::solver_bodies::{SolverBodies, SolverRow, halved};

/// A body as the joints of its mechanism see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MechanismBody {
    pub(crate) row: SolverRow,
    /// Zero of a body that is not dynamic [1/kg].
    pub(crate) inverse_mass: f64,
    /// Its own principal moments [kg m^2].
    own_moments: Vec3<f64>,
    /// The same, raised to the load.
    pub(crate) moments: Vec3<f64>,
    pub(crate) inverse_moments: Vec3<f64>,
    /// Whether impulses turn it.
    pub(crate) turns: bool,
    /// What each moment is raised to at least, for what the joints pull at it [kg m^2].
    pub(crate) load: f64,
    /// Centre of mass when the step began \[m\].
    pub(crate) center: Vec3<f64>,
    /// How far it has gone since \[m\].
    pub(crate) translation: Vec3<f64>,
    /// Of the principal frame; of a body that is not dynamic, of its own.
    pub(crate) orientation: Quat<f64>,
    /// When the step began.
    start: Quat<f64>,
    /// [kg m/s]; velocity \[m/s\] of a body that is not dynamic.
    pub(crate) linear: Vec3<f64>,
    /// [kg m^2/s]; angular velocity \[rad/s\] of a body that is not dynamic.
    pub(crate) angular: Vec3<f64>,
    /// Inverse inertia in the world [1/(kg m^2)]: `xx yy zz`, then `yz zx xy`.
    pub(crate) inverse_inertia: [Vec3<f64>; 2],
    /// What forces do in half a substep [N s] [N m s], and what damping leaves.
    kick: [Vec3<f64>; 2],
    kept: [f64; 2],
    /// Angular momentum of raised moments that was dropped since the body was read, less what was
    /// made [kg m^2/s].
    pub(crate) dropped: Vec3<f64>,
    /// What damping did since the body was read \[J\].
    pub(crate) damping_work: f64,
}

/// What a substep changes of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SavedBody {
    load: f64,
    translation: Vec3<f64>,
    orientation: Quat<f64>,
    linear: Vec3<f64>,
    angular: Vec3<f64>,
    dropped: Vec3<f64>,
    damping_work: f64,
}

/// A body turns under its load by at most the square root of this [rad] a substep: what is
/// lighter is given that much inertia.
const MAX_SQUARED_ANGLE: f64 = 0.5;
/// What is this many times the inertia is a sudden load.
const SUDDEN: f64 = 2.0;
/// What is left of the raised inertia in the next substep, where the load is gone.
const KEPT_LOAD: f64 = 0.9;

impl MechanismBody {
    /// Reads a row of the solver, with the load of the last substep.
    pub(crate) fn read(bodies: &SolverBodies, row: SolverRow, load: f64) -> Self {
        let i = row.index();
        let (motion, pose, delta) = (&bodies.motion[i], &bodies.pose[i], &bodies.delta_pose[i]);
        let [zero, one] = [0.0, 1.0].map(Vec3::splat);
        let orientation: Quat<f64> = double_quat(pose.orientation).into();
        let mut it = Self {
            row,
            inverse_mass: 0.0,
            own_moments: one,
            moments: one,
            inverse_moments: one,
            turns: false,
            load,
            center: double(pose.center).into(),
            translation: double(delta.translation).into(),
            orientation,
            start: orientation,
            linear: double(motion.momentum).into(),
            angular: double(motion.angular_momentum).into(),
            inverse_inertia: [zero; 2],
            kick: [zero; 2],
            kept: [1.0; 2],
            dropped: zero,
            damping_work: 0.0,
        };
        if bodies.is_dynamic(row) {
            let inertia = &bodies.inertia[i];
            it.inverse_mass = f64::from(motion.inverse_mass);
            it.own_moments = double(inertia.moments).into();
            it.moments = it.own_moments;
            it.turns = inertia.turns != 0.0;
            let kick = halved(bodies.force_impulse[i], 1);
            it.kick = [kick.linear, kick.angular].map(|of_forces| double(of_forces).into());
            it.kept = [kick.kept_linear, kick.kept_angular].map(f64::from);
            it.raise(load);
        } else {
            it.read_motion(bodies);
        }
        it
    }

    /// A body that does not move, at the centre of mass of this one, with the axes of the world.
    pub(crate) fn ground_at(body: &Self) -> Self {
        let [zero, one] = [0.0, 1.0].map(Vec3::splat);
        Self {
            inverse_mass: 0.0,
            own_moments: one,
            moments: one,
            inverse_moments: one,
            turns: false,
            load: 0.0,
            orientation: IDENTITY,
            start: IDENTITY,
            linear: zero,
            angular: zero,
            inverse_inertia: [zero; 2],
            kick: [zero; 2],
            kept: [1.0; 2],
            dropped: zero,
            damping_work: 0.0,
            ..*body
        }
    }

    /// Writes its pose without what rounding has moved along and about locked axes.
    pub(crate) fn hold(&self, lock: AxisLock, bodies: &mut SolverBodies) {
        let i = self.row.index();
        let delta = &mut bodies.delta_pose[i];
        delta.translation = vec3(lock.along_free(double(delta.translation))).into();
        if self.turns && lock.locks_rotation() {
            let rotation = lock.free_part(double_quat(delta.rotation));
            delta.rotation = quat(rotation).into();
            bodies.pose[i].orientation = single_quat(Quat::from(rotation) * self.start);
        }
    }

    /// Reads again what others change in the course of a step.
    pub(crate) fn read_motion(&mut self, bodies: &SolverBodies) {
        let i = self.row.index();
        let (motion, delta) = (&bodies.motion[i], &bodies.delta_pose[i]);
        self.linear = double(motion.momentum).into();
        self.angular = double(motion.angular_momentum).into();
        self.translation = double(delta.translation).into();
        if self.inverse_mass == 0.0 {
            let turned: Quat<f64> = double_quat(delta.rotation).into();
            self.orientation = turned * self.start;
        } else {
            self.orientation = double_quat(bodies.pose[i].orientation).into();
            self.update_inertia();
        }
    }

    /// Writes to its row what a step has changed.
    pub(crate) fn write(&self, bodies: &mut SolverBodies) {
        let i = self.row.index();
        if self.inverse_mass == 0.0 {
            return;
        }
        let motion = &mut bodies.motion[i];
        (motion.momentum, motion.angular_momentum) = (single(self.linear), single(self.angular));
        bodies.pose[i].orientation = single_quat(self.orientation);
        let [diagonal, off_diagonal] = self.inverse_inertia.map(single);
        bodies.inv_inertia[i] = WorldInverseInertia { diagonal, off_diagonal, ..bodies.inv_inertia[i] };
        bodies.delta_pose[i] = DeltaPose {
            translation: single(self.translation),
            rotation: single_quat(self.orientation * self.start.conjugate()),
            has_turned: 1.0,
        };
    }

    /// Reads what contacts did after the joints, and writes to its row, at the end of a step, the
    /// momentum with its own moments.
    pub(crate) fn write_own_momentum(&mut self, bodies: &mut SolverBodies) {
        self.read_motion(bodies);
        if self.turns && self.load > 0.0 {
            self.take_own_moments();
            let i = self.row.index();
            bodies.motion[i].angular_momentum = single(self.angular);
            bodies.inertia[i].moments = single(self.moments);
        }
    }

    /// Writes to its row what impulses have changed, and the raised moments that it moves on with.
    pub(crate) fn write_momentum(&self, bodies: &mut SolverBodies) {
        let i = self.row.index();
        if self.inverse_mass == 0.0 {
            return;
        }
        let motion = &mut bodies.motion[i];
        (motion.momentum, motion.angular_momentum) = (single(self.linear), single(self.angular));
        if self.turns && self.load > 0.0 {
            let inertia = &mut bodies.inertia[i];
            (inertia.moments, inertia.inverse_moments) = (single(self.moments), single(self.inverse_moments));
            let [diagonal, off_diagonal] = self.inverse_inertia.map(single);
            bodies.inv_inertia[i] = WorldInverseInertia { diagonal, off_diagonal, ..bodies.inv_inertia[i] };
        }
    }

    /// Sets the moments of inertia to a load [kg m^2], with the angular velocity that it has.
    fn raise(&mut self, load: f64) {
        let (own, before) = (self.own_moments, self.moments);
        self.load = load;
        self.moments = Vec3::new(own.x.max(load), own.y.max(load), own.z.max(load));
        self.scale_momentum(before, self.moments);
        self.inverse_moments = Vec3::new(1.0 / self.moments.x, 1.0 / self.moments.y, 1.0 / self.moments.z);
        self.update_inertia();
    }

    /// Takes the sum over its joints of impulse times arm [kg m^2/s] in a substep of `h` \[s\].
    pub(crate) fn take_load(&mut self, impulse_times_arm: f64, h: f64) {
        if !self.turns {
            return;
        }
        let mut load = (h * impulse_times_arm / MAX_SQUARED_ANGLE).max(KEPT_LOAD * self.load);
        if load <= self.least_moment() {
            // It changes nothing now, and nothing that is left of it will.
            load = 0.0;
        }
        if load == 0.0 && self.load == 0.0 {
            return;
        }
        if load > self.load {
            self.slow_down(load);
        } else {
            self.raise(load);
        }
    }

    /// The same before the body moves, where the load has grown beyond what the inertia that it
    /// has would not do for this substep. Returns whether it has.
    pub(crate) fn take_sudden_load(&mut self, impulse_times_arm: f64, h: f64) -> bool {
        let load = h * impulse_times_arm / MAX_SQUARED_ANGLE;
        let is_sudden = self.turns && load > SUDDEN * self.load.max(self.least_moment());
        if is_sudden {
            self.slow_down(load);
        }
        is_sudden
    }

    fn least_moment(&self) -> f64 {
        self.own_moments.x.min(self.own_moments.y).min(self.own_moments.z)
    }

    /// Raises the inertia at the angular momentum that it has. Less inertia does not speed it up:
    /// neither makes energy.
    fn slow_down(&mut self, load: f64) {
        let (angular, dropped) = (self.angular, self.dropped);
        self.raise(load);
        (self.angular, self.dropped) = (angular, dropped);
    }

    /// Changes the angular momentum from that with these moments to that with others, at the same
    /// angular velocity.
    fn scale_momentum(&mut self, before: Vec3<f64>, after: Vec3<f64>) {
        if self.turns && (before.x != after.x || before.y != after.y || before.z != after.z) {
            let y = self.orientation.rotate_back(self.angular);
            let ratio = Vec3::new(after.x / before.x, after.y / before.y, after.z / before.z);
            let scaled = self.orientation.rotate(y.scale(ratio));
            self.dropped = self.dropped + self.angular - scaled;
            self.angular = scaled;
        }
    }

    /// Gives it its own moments, at the angular velocity that it has.
    pub(crate) fn take_own_moments(&mut self) {
        if self.load > 0.0 {
            let load = self.load;
            self.raise(0.0);
            self.load = load;
        }
    }

    /// By its greatest moment \[m\]; zero of a body that does not turn.
    pub(crate) fn radius_of_gyration(&self) -> f64 {
        let Vec3 { x, y, z } = self.own_moments;
        if self.turns { (x.max(y).max(z) * self.inverse_mass).sqrt() } else { 0.0 }
    }

    /// Mass \[kg\] of a dynamic body.
    pub(crate) fn mass(&self) -> f64 {
        1.0 / self.inverse_mass
    }

    /// Centre of mass \[m\].
    pub(crate) fn position(&self) -> Vec3<f64> {
        self.center + self.translation
    }

    /// Its own moments about its centre of mass in the world [kg m^2]: `xx yy zz`, then `yz zx xy`.
    pub(crate) fn own_inertia(&self) -> [Vec3<f64>; 2] {
        if !self.turns {
            return [Vec3::zero(); 2];
        }
        // The inverse of the inverse moments.
        let of_world = Moments { moments: self.own_moments, inverse_moments: self.own_moments, axes: None };
        of_world.inverse_in_world(self.orientation).into()
    }

    /// Adds a rotation of the whole, about a point from which its centre of mass is at `arm`.
    pub(crate) fn turn_along(&mut self, angular_velocity: Vec3<f64>, arm: Vec3<f64>) {
        let [diagonal, off_diagonal] = self.own_inertia();
        self.linear = self.linear + angular_velocity.cross(arm) * self.mass();
        self.angular = self.angular + symmetric_product(diagonal, off_diagonal, angular_velocity);
    }

    /// With the moments that it has now \[J\].
    pub(crate) fn kinetic_energy(&self) -> f64 {
        0.5 * (self.linear.dot(self.linear_velocity()) + self.angular.dot(self.times_inverse_inertia(self.angular)))
    }

    /// Of what it moves against these velocities, linear and angular \[J\].
    pub(crate) fn kinetic_energy_against(&self, velocities: (Vec3<f64>, Vec3<f64>)) -> f64 {
        let [linear, angular] = self.momenta_at(velocities);
        Self { linear: self.linear - linear, angular: self.angular - angular, ..*self }.kinetic_energy()
    }

    /// Keeps this share of what it moves against these velocities.
    pub(crate) fn keep_of_motion(&mut self, kept: f64, velocities: (Vec3<f64>, Vec3<f64>)) {
        let [linear, angular] = self.momenta_at(velocities);
        self.linear = linear + (self.linear - linear) * kept;
        self.angular = angular + (self.angular - angular) * kept;
    }

    /// Its momenta at these velocities, with its own moments.
    fn momenta_at(&self, (linear, angular): (Vec3<f64>, Vec3<f64>)) -> [Vec3<f64>; 2] {
        let [diagonal, off_diagonal] = self.own_inertia();
        [linear * self.mass(), symmetric_product(diagonal, off_diagonal, angular)]
    }

    /// Whether a body that impulses do not move has a velocity.
    pub(crate) fn is_moving(&self) -> bool {
        self.linear.dot(self.linear) + self.angular.dot(self.angular) > 0.0
    }

    fn update_inertia(&mut self) {
        if self.turns {
            let moments = Moments { moments: self.moments, inverse_moments: self.inverse_moments, axes: None };
            self.inverse_inertia = moments.inverse_in_world(self.orientation).into();
        }
    }

    pub(crate) fn linear_velocity(&self) -> Vec3<f64> {
        if self.inverse_mass == 0.0 { self.linear } else { self.linear * self.inverse_mass }
    }

    pub(crate) fn angular_velocity(&self) -> Vec3<f64> {
        if self.inverse_mass == 0.0 { self.angular } else { self.times_inverse_inertia(self.angular) }
    }

    pub(crate) fn times_inverse_inertia(&self, torque: Vec3<f64>) -> Vec3<f64> {
        let [diagonal, off_diagonal] = self.inverse_inertia;
        symmetric_product(diagonal, off_diagonal, torque)
    }

    /// Adds an impulse \[N s\] at an arm from its centre of mass \[m\], and an angular one [N m s].
    pub(crate) fn push(&mut self, impulse: Vec3<f64>, arm: Vec3<f64>, angular: Vec3<f64>) {
        if self.inverse_mass != 0.0 {
            self.linear = self.linear + impulse;
            self.angular = self.angular + arm.cross(impulse) + angular;
        }
    }

    /// What a substep changes of it.
    pub(crate) fn saved(&self) -> SavedBody {
        let Self { load, translation, orientation, linear, angular, dropped, damping_work, .. } = *self;
        SavedBody { load, translation, orientation, linear, angular, dropped, damping_work }
    }

    /// Goes back to what it was.
    pub(crate) fn restore(&mut self, saved: &SavedBody) {
        let SavedBody { load, translation, orientation, linear, angular, dropped, damping_work } = *saved;
        (self.translation, self.orientation, self.linear) = (translation, orientation, linear);
        if self.inverse_mass != 0.0 {
            self.raise(load);
        }
        (self.angular, self.dropped, self.damping_work) = (angular, dropped, damping_work);
    }

    /// Adds what forces do in half a substep that was halved this many times.
    pub(crate) fn kick(&mut self, halvings: u32) {
        let ([linear, angular], [kept_linear, kept_angular]) = self.kick_of(halvings);
        if kept_linear != 1.0 || kept_angular != 1.0 {
            let (p, l) = (self.linear, self.angular);
            let mean = [p * (0.5 + 0.5 * kept_linear), l * (0.5 + 0.5 * kept_angular)];
            self.damping_work += (kept_linear - 1.0) * p.dot(mean[0]) * self.inverse_mass
                + (kept_angular - 1.0) * l.dot(self.times_inverse_inertia(mean[1]));
        }
        self.linear = self.linear * kept_linear + linear;
        self.angular = self.angular * kept_angular + angular;
    }

    fn kick_of(&self, halvings: u32) -> ([Vec3<f64>; 2], [f64; 2]) {
        (0..halvings).fold((self.kick, self.kept), |(kick, kept), _| {
            // Damping goes on in the second of two halves.
            let first = |kick: Vec3<f64>, kept: f64| kick * (1.0 / (1.0 + kept.sqrt()));
            ([first(kick[0], kept[0]), first(kick[1], kept[1])], kept.map(f64::sqrt))
        })
    }

    /// Whether every number of its state is one of the build.
    pub(crate) fn is_finite(&self) -> bool {
        let vectors = [self.translation, self.linear, self.angular];
        let Quat { x, y, z, w } = self.orientation;
        let most = 0.1 * f64::from(Real::MAX);
        vectors.iter().all(|v| v.dot(*v).sqrt() < most) && (x + y + z + w).is_finite()
    }
}

fn single(v: Vec3<f64>) -> Vec3<Real> {
    Vec3::new(real(v.x), real(v.y), real(v.z))
}

fn single_quat(q: Quat<f64>) -> Quat<Real> {
    Quat { x: real(q.x), y: real(q.y), z: real(q.z), w: real(q.w) }
}
