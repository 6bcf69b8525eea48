//! A body of a mechanism, in double precision.

use tumble_math::lane::{Quat, Vec3};

use crate::integrators::derived::symmetric_product;
use crate::integrators::state::Moments;
use crate::joints::axis_lock::AxisLock;
use crate::math::{Real, double, double_quat, quat, real, vec3};
use crate::simd::Four;
use crate::solver::body_rows::{DeltaPose, WorldInverseInertia};
use crate::solver::mechanism::fours::{quaternion, row, row_of, vector};
use crate::solver::mechanism::joint_rows::IDENTITY;
use crate::solver::mechanism::raised_inertia::{SUDDEN, load_of, momentum_with};
use crate::solver::solver_bodies::{SolverBodies, SolverRow, halved};

/// A body as the joints of its mechanism see it.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct MechanismBody {
    /// Momentum [kg m/s], or velocity \[m/s\] of a body that is not dynamic; and inverse mass
    /// [1/kg], zero of a body that is not dynamic.
    pub(super) linear: Four,
    /// Angular momentum [kg m^2/s], or angular velocity \[rad/s\] of a body that is not dynamic;
    /// and one if impulses turn it, else zero.
    pub(super) angular: Four,
    /// Inverse inertia in the world [1/(kg m^2)]: `xx yy zz`, then `yz zx xy`.
    pub(super) inverse_inertia: [Four; 2],
    /// How far it has gone since the step began \[m\].
    pub(super) translation: Four,
    /// Of the principal frame; of a body that is not dynamic, of its own.
    pub(super) orientation: Four,
    /// Principal moments, raised to the load, and the load: what each is raised to at least, for
    /// what the joints pull at it [kg m^2].
    pub(super) moments: Four,
    pub(super) inverse_moments: Four,
    /// Its own principal moments [kg m^2].
    pub(super) own_moments: Four,
    /// What forces do in half a substep [N s] [N m s], and what damping leaves.
    pub(super) kick: [Four; 2],
    kept: [f64; 2],
    pub(crate) row: SolverRow,
    /// Centre of mass when the step began \[m\].
    pub(crate) center: Vec3<f64>,
    /// Orientation when the step began.
    start: Quat<f64>,
    /// Angular momentum of raised moments that was dropped since the body was read, less what was
    /// made [kg m^2/s]; and what damping did since \[J\].
    pub(super) dropped: Four,
}

/// What a substep changes of a body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SavedBody {
    pub(super) linear: Four,
    pub(super) angular: Four,
    pub(super) translation: Four,
    pub(super) orientation: Four,
    pub(super) load: f64,
    pub(super) dropped: Four,
}

impl MechanismBody {
    /// Reads a row of the solver, with the load of the last substep.
    pub(crate) fn read(bodies: &SolverBodies, of: SolverRow, load: f64) -> Self {
        let i = of.index();
        let (motion, pose, delta) = (&bodies.motion[i], &bodies.pose[i], &bodies.delta_pose[i]);
        let orientation: Quat<f64> = double_quat(pose.orientation).into();
        let mut it = Self {
            linear: row_of(double(motion.momentum).into(), 0.0),
            angular: row_of(double(motion.angular_momentum).into(), 0.0),
            inverse_inertia: [[0.0; 4]; 2],
            translation: row_of(double(delta.translation).into(), 0.0),
            orientation: row(orientation),
            moments: [1.0, 1.0, 1.0, load],
            inverse_moments: [1.0; 4],
            own_moments: [1.0; 4],
            kick: [[0.0; 4]; 2],
            kept: [1.0; 2],
            row: of,
            center: double(pose.center).into(),
            start: orientation,
            dropped: [0.0; 4],
        };
        if bodies.is_dynamic(of) {
            let inertia = &bodies.inertia[i];
            it.linear[3] = f64::from(motion.inverse_mass);
            let Vec3 { x, y, z } = double(inertia.moments).into();
            it.own_moments = [x, y, z, x.min(y).min(z)];
            it.moments = [x, y, z, load];
            it.angular[3] = if inertia.turns != 0.0 { 1.0 } else { 0.0 };
            let kick = halved(bodies.force_impulse[i], 1);
            it.kick = [kick.linear, kick.angular].map(|of_forces| row_of(double(of_forces).into(), 0.0));
            it.kept = [kick.kept_linear, kick.kept_angular].map(f64::from);
            it.raise(load);
        } else {
            it.read_motion(bodies);
        }
        it
    }

    /// A body that does not move, at the centre of mass of this one, with the axes of the world.
    pub(crate) fn ground_at(body: &Self) -> Self {
        Self {
            linear: [0.0; 4],
            angular: [0.0; 4],
            inverse_inertia: [[0.0; 4]; 2],
            orientation: row(IDENTITY),
            moments: [1.0, 1.0, 1.0, 0.0],
            inverse_moments: [1.0; 4],
            own_moments: [1.0; 4],
            kick: [[0.0; 4]; 2],
            kept: [1.0; 2],
            start: IDENTITY,
            dropped: [0.0; 4],
            ..*body
        }
    }

    /// Writes its pose without what rounding has moved along and about locked axes.
    pub(crate) fn hold(&self, lock: AxisLock, bodies: &mut SolverBodies) {
        let i = self.row.index();
        let delta = &mut bodies.delta_pose[i];
        delta.translation = vec3(lock.along_free(double(delta.translation))).into();
        if self.turns() && lock.locks_rotation() {
            let rotation = lock.free_part(double_quat(delta.rotation));
            delta.rotation = quat(rotation).into();
            bodies.pose[i].orientation = single_quat(Quat::from(rotation) * self.start);
        }
    }

    /// Reads again what others change in the course of a step.
    pub(crate) fn read_motion(&mut self, bodies: &SolverBodies) {
        let i = self.row.index();
        let (motion, delta) = (&bodies.motion[i], &bodies.delta_pose[i]);
        self.set_momenta([double(motion.momentum), double(motion.angular_momentum)].map(Vec3::from));
        self.translation = row_of(double(delta.translation).into(), 0.0);
        if self.is_moved() {
            let orientation = row(double_quat(bodies.pose[i].orientation).into());
            // Of two stages between which nothing moves the second has the inertia of the first.
            if orientation != std::mem::replace(&mut self.orientation, orientation) {
                self.update_inertia();
            }
        } else {
            let turned: Quat<f64> = double_quat(delta.rotation).into();
            self.orientation = row(turned * self.start);
        }
    }

    /// Writes to its row what a step has changed.
    pub(crate) fn write(&self, bodies: &mut SolverBodies) {
        let i = self.row.index();
        if !self.is_moved() {
            return;
        }
        let motion = &mut bodies.motion[i];
        (motion.momentum, motion.angular_momentum) = (single(self.linear()), single(self.angular()));
        bodies.pose[i].orientation = single_quat(self.orientation());
        let [diagonal, off_diagonal] = self.inverse_inertia().map(single);
        bodies.inv_inertia[i] = WorldInverseInertia { diagonal, off_diagonal, ..bodies.inv_inertia[i] };
        bodies.delta_pose[i] = DeltaPose {
            translation: single(self.translation()),
            rotation: single_quat(self.orientation() * self.start.conjugate()),
            has_turned: 1.0,
        };
    }

    /// Reads what contacts did after the joints, and writes to its row, at the end of a step, the
    /// momentum with its own moments.
    pub(crate) fn write_own_momentum(&mut self, bodies: &mut SolverBodies) {
        self.read_motion(bodies);
        if self.turns() && self.load() > 0.0 {
            self.take_own_moments();
            let i = self.row.index();
            bodies.motion[i].angular_momentum = single(self.angular());
            bodies.inertia[i].moments = single(vector(&self.moments));
        }
    }

    /// Writes to its row what impulses have changed, and the raised moments that it moves on with.
    pub(crate) fn write_momentum(&self, bodies: &mut SolverBodies) {
        let i = self.row.index();
        if !self.is_moved() {
            return;
        }
        let motion = &mut bodies.motion[i];
        (motion.momentum, motion.angular_momentum) = (single(self.linear()), single(self.angular()));
        if self.turns() && self.load() > 0.0 {
            let inertia = &mut bodies.inertia[i];
            inertia.moments = single(vector(&self.moments));
            inertia.inverse_moments = single(vector(&self.inverse_moments));
            let [diagonal, off_diagonal] = self.inverse_inertia().map(single);
            bodies.inv_inertia[i] = WorldInverseInertia { diagonal, off_diagonal, ..bodies.inv_inertia[i] };
        }
    }

    /// Sets the moments of inertia to a load [kg m^2], with the angular velocity that it has.
    fn raise(&mut self, load: f64) {
        let ([x, y, z, _], before) = (self.own_moments, vector(&self.moments));
        self.moments = [x.max(load), y.max(load), z.max(load), load];
        let moments = vector(&self.moments);
        self.scale_momentum(before, moments);
        self.inverse_moments = [1.0 / moments.x, 1.0 / moments.y, 1.0 / moments.z, 0.0];
        self.update_inertia();
    }

    /// Takes the sum over its joints of impulse times arm [kg m^2/s] in a substep of `h` \[s\]
    /// before it moves, if its inertia would not do for that load. Returns whether it has.
    pub(crate) fn take_sudden_load(&mut self, impulse_times_arm: f64, h: f64) -> bool {
        let load = load_of(impulse_times_arm, h);
        let is_sudden = self.turns() && load > SUDDEN * self.load().max(self.least_moment());
        if is_sudden {
            self.slow_down(load);
        }
        is_sudden
    }

    fn least_moment(&self) -> f64 {
        self.own_moments[3]
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
        if self.turns() && (before.x != after.x || before.y != after.y || before.z != after.z) {
            let scaled = momentum_with(after, before, self.orientation(), self.angular());
            self.dropped = row_of(self.dropped() + self.angular() - scaled, self.damping_work());
            self.angular = row_of(scaled, self.angular[3]);
        }
    }

    /// Gives it its own moments, at the angular velocity that it has.
    pub(crate) fn take_own_moments(&mut self) {
        let load = self.load();
        if load > 0.0 {
            self.raise(0.0);
            self.moments[3] = load;
        }
    }

    /// Zero of a body that is not dynamic [1/kg].
    #[inline(always)]
    pub(crate) fn inverse_mass(&self) -> f64 {
        self.linear[3]
    }

    /// Whether impulses move it: it is dynamic.
    #[inline(always)]
    pub(crate) fn is_moved(&self) -> bool {
        self.inverse_mass() != 0.0
    }

    /// Whether impulses turn it.
    #[inline(always)]
    pub(crate) fn turns(&self) -> bool {
        self.angular[3] != 0.0
    }

    /// Angular momentum of raised moments that was dropped since the body was read, less what was
    /// made [kg m^2/s].
    pub(crate) fn dropped(&self) -> Vec3<f64> {
        vector(&self.dropped)
    }

    /// What damping did since the body was read \[J\].
    pub(crate) fn damping_work(&self) -> f64 {
        self.dropped[3]
    }

    /// What each moment is raised to at least [kg m^2].
    pub(crate) fn load(&self) -> f64 {
        self.moments[3]
    }

    /// Momentum [kg m/s]; velocity \[m/s\] of a body that is not dynamic.
    #[inline(always)]
    pub(crate) fn linear(&self) -> Vec3<f64> {
        vector(&self.linear)
    }

    /// Angular momentum [kg m^2/s]; angular velocity \[rad/s\] of a body that is not dynamic.
    #[inline(always)]
    pub(crate) fn angular(&self) -> Vec3<f64> {
        vector(&self.angular)
    }

    /// How far it has gone since the step began \[m\].
    #[inline(always)]
    pub(crate) fn translation(&self) -> Vec3<f64> {
        vector(&self.translation)
    }

    /// Of the principal frame; of a body that is not dynamic, of its own.
    #[inline(always)]
    pub(crate) fn orientation(&self) -> Quat<f64> {
        quaternion(&self.orientation)
    }

    /// Inverse inertia in the world [1/(kg m^2)]: `xx yy zz`, then `yz zx xy`.
    #[inline(always)]
    pub(crate) fn inverse_inertia(&self) -> [Vec3<f64>; 2] {
        [vector(&self.inverse_inertia[0]), vector(&self.inverse_inertia[1])]
    }

    /// By its greatest moment \[m\]; zero of a body that does not turn.
    pub(crate) fn radius_of_gyration(&self) -> f64 {
        let [x, y, z, _] = self.own_moments;
        if self.turns() { (x.max(y).max(z) * self.inverse_mass()).sqrt() } else { 0.0 }
    }

    /// Mass \[kg\] of a dynamic body.
    pub(crate) fn mass(&self) -> f64 {
        1.0 / self.inverse_mass()
    }

    /// Centre of mass \[m\].
    pub(crate) fn position(&self) -> Vec3<f64> {
        self.center + self.translation()
    }

    /// Its own moments about its centre of mass in the world [kg m^2]: `xx yy zz`, then `yz zx xy`.
    pub(crate) fn own_inertia(&self) -> [Vec3<f64>; 2] {
        if !self.turns() {
            return [Vec3::zero(); 2];
        }
        // The inverse of the inverse moments.
        let moments = vector(&self.own_moments);
        let of_world = Moments { moments, inverse_moments: moments, axes: None };
        of_world.inverse_in_world(self.orientation()).into()
    }

    /// Adds a rotation of the whole, about a point from which its centre of mass is at `arm`.
    pub(crate) fn turn_along(&mut self, angular_velocity: Vec3<f64>, arm: Vec3<f64>) {
        let [diagonal, off_diagonal] = self.own_inertia();
        let linear = self.linear() + angular_velocity.cross(arm) * self.mass();
        self.set_momenta([linear, self.angular() + symmetric_product(diagonal, off_diagonal, angular_velocity)]);
    }

    /// With the moments that it has now \[J\].
    pub(crate) fn kinetic_energy(&self) -> f64 {
        let (linear, angular) = (self.linear(), self.angular());
        0.5 * (linear.dot(self.linear_velocity()) + angular.dot(self.times_inverse_inertia(angular)))
    }

    /// Of what it moves against these velocities, linear and angular \[J\].
    pub(crate) fn kinetic_energy_against(&self, velocities: (Vec3<f64>, Vec3<f64>)) -> f64 {
        let [linear, angular] = self.momenta_at(velocities);
        let mut against = *self;
        against.set_momenta([self.linear() - linear, self.angular() - angular]);
        against.kinetic_energy()
    }

    /// Keeps this share of what it moves against these velocities.
    pub(crate) fn keep_of_motion(&mut self, kept: f64, velocities: (Vec3<f64>, Vec3<f64>)) {
        let [linear, angular] = self.momenta_at(velocities);
        self.set_momenta([linear + (self.linear() - linear) * kept, angular + (self.angular() - angular) * kept]);
    }

    fn set_momenta(&mut self, [linear, angular]: [Vec3<f64>; 2]) {
        self.linear = row_of(linear, self.inverse_mass());
        self.angular = row_of(angular, self.angular[3]);
    }

    /// Its momenta at these velocities, with its own moments.
    fn momenta_at(&self, (linear, angular): (Vec3<f64>, Vec3<f64>)) -> [Vec3<f64>; 2] {
        let [diagonal, off_diagonal] = self.own_inertia();
        [linear * self.mass(), symmetric_product(diagonal, off_diagonal, angular)]
    }

    /// Whether a body that impulses do not move has a velocity.
    pub(crate) fn is_moving(&self) -> bool {
        self.linear().dot(self.linear()) + self.angular().dot(self.angular()) > 0.0
    }

    fn update_inertia(&mut self) {
        if self.turns() {
            let [moments, inverse_moments] = [&self.moments, &self.inverse_moments].map(vector);
            let moments = Moments { moments, inverse_moments, axes: None };
            let (diagonal, off_diagonal) = moments.inverse_in_world(self.orientation());
            self.inverse_inertia = [row_of(diagonal, 0.0), row_of(off_diagonal, 0.0)];
        }
    }

    pub(crate) fn linear_velocity(&self) -> Vec3<f64> {
        if self.is_moved() { self.linear() * self.inverse_mass() } else { self.linear() }
    }

    pub(crate) fn angular_velocity(&self) -> Vec3<f64> {
        if self.is_moved() { self.times_inverse_inertia(self.angular()) } else { self.angular() }
    }

    pub(crate) fn times_inverse_inertia(&self, torque: Vec3<f64>) -> Vec3<f64> {
        let [diagonal, off_diagonal] = self.inverse_inertia();
        symmetric_product(diagonal, off_diagonal, torque)
    }

    /// The velocities that an impulse \[N s\] and an angular one [N m s] give it.
    pub(crate) fn response_to(&self, [linear, torque]: [Vec3<f64>; 2]) -> [Vec3<f64>; 2] {
        [linear * self.inverse_mass(), self.times_inverse_inertia(torque)]
    }

    /// Adds an impulse \[N s\] at an arm from its centre of mass \[m\], and an angular one [N m s].
    pub(crate) fn push(&mut self, impulse: Vec3<f64>, arm: Vec3<f64>, angular: Vec3<f64>) {
        if self.is_moved() {
            self.set_momenta([self.linear() + impulse, self.angular() + arm.cross(impulse) + angular]);
        }
    }

    /// Goes back to what it was.
    pub(crate) fn restore(&mut self, saved: &SavedBody) {
        let SavedBody { load, translation, orientation, linear, angular, dropped } = *saved;
        (self.translation, self.orientation, self.linear) = (translation, orientation, linear);
        if self.is_moved() {
            self.raise(load);
        }
        (self.angular, self.dropped) = (angular, dropped);
    }

    /// Whether damping takes anything of its momenta.
    #[inline(always)]
    pub(super) fn is_damped(&self) -> bool {
        self.kept != [1.0; 2]
    }

    /// Adds what forces do in half a substep that was halved this many times.
    pub(crate) fn kick(&mut self, halvings: u32) {
        let ([linear, angular], [kept_linear, kept_angular]) = self.kick_of(halvings);
        if kept_linear != 1.0 || kept_angular != 1.0 {
            let (p, l) = (self.linear(), self.angular());
            let mean = [p * (0.5 + 0.5 * kept_linear), l * (0.5 + 0.5 * kept_angular)];
            self.dropped[3] += (kept_linear - 1.0) * p.dot(mean[0]) * self.inverse_mass()
                + (kept_angular - 1.0) * l.dot(self.times_inverse_inertia(mean[1]));
        }
        self.set_momenta([self.linear() * kept_linear + linear, self.angular() * kept_angular + angular]);
    }

    fn kick_of(&self, halvings: u32) -> ([Vec3<f64>; 2], [f64; 2]) {
        (0..halvings).fold((self.kick.map(|kick| vector(&kick)), self.kept), |(kick, kept), _| {
            // Damping goes on in the second of two halves.
            let first = |kick: Vec3<f64>, kept: f64| kick * (1.0 / (1.0 + kept.sqrt()));
            ([first(kick[0], kept[0]), first(kick[1], kept[1])], kept.map(f64::sqrt))
        })
    }

    /// Whether every number of its state is one of the build.
    pub(crate) fn is_finite(&self) -> bool {
        let vectors = [self.translation(), self.linear(), self.angular()];
        let [x, y, z, w] = self.orientation;
        let most = 0.1 * f64::from(Real::MAX);
        vectors.iter().all(|v| v.dot(*v).sqrt() < most) && (x + y + z + w).is_finite()
    }
}

#[cfg(test)]
impl MechanismBody {
    /// A body at rest at a place, of a mass and moments; without a mass it is fixed.
    pub(super) fn at(center: Vec3<f64>, inverse_mass: f64, moments: Vec3<f64>) -> Self {
        let mut it = Self {
            linear: [0.0, 0.0, 0.0, inverse_mass],
            angular: [0.0, 0.0, 0.0, if inverse_mass > 0.0 { 1.0 } else { 0.0 }],
            inverse_inertia: [[0.0; 4]; 2],
            translation: [0.0; 4],
            orientation: row(IDENTITY),
            moments: row_of(moments, 0.0),
            inverse_moments: [1.0; 4],
            own_moments: row_of(moments, moments.x.min(moments.y).min(moments.z)),
            kick: [[0.0; 4]; 2],
            kept: [1.0; 2],
            row: SolverRow(0),
            center,
            start: IDENTITY,
            dropped: [0.0; 4],
        };
        it.raise(0.0);
        it
    }
}

/// A vector of the build's precision.
pub(crate) fn single(v: Vec3<f64>) -> Vec3<Real> {
    Vec3::new(real(v.x), real(v.y), real(v.z))
}

fn single_quat(q: Quat<f64>) -> Quat<Real> {
    Quat { x: real(q.x), y: real(q.y), z: real(q.z), w: real(q.w) }
}
