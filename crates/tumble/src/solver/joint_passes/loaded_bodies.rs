//! The bodies of joints in passes, with the inertia that the loads of these ask for.

use tumble_math::lane::Vec3;

use crate::integrators::state::Moments;
use crate::joints::axes::Axes;
use crate::joints::axis_lock::AxisLock;
use crate::math::{Real, double, real};
use crate::solver::body_rows::{PrincipalMoments, WarmStartImpulse, WorldInverseInertia};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_misfit::return_momentum;
use crate::solver::mechanism::raised_inertia::{KEPT_LOAD, load_of, momentum_with};
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::storage::body_index::Slot;

/// The dynamic bodies that joints in passes connect, mechanism by mechanism.
#[derive(Clone, Default)]
pub(crate) struct LoadedBodies {
    bodies: Vec<LoadedBody>,
    mechanisms: Vec<LoadedMechanism>,
    /// Memory: those of a mechanism.
    turned: Vec<MechanismBody>,
}

#[derive(Clone, Copy)]
struct LoadedBody {
    row: SolverRow,
    slot: Slot,
    /// Its own principal moments, and the least; infinite of a body that does not turn [kg m^2].
    own: Vec3<Real>,
    least: Real,
    /// What each moment is raised to at least; zero where the load asks for no more [kg m^2].
    load: Real,
}

#[derive(Clone, Copy)]
struct LoadedMechanism {
    /// Where its bodies end.
    end: usize,
    /// Whether nothing else holds it.
    is_free: bool,
    /// Angular momentum of raised moments that was dropped, less what was made [kg m^2/s].
    dropped: Vec3<f64>,
}

impl LoadedBodies {
    pub(super) fn clear(&mut self) {
        self.bodies.clear();
        self.mechanisms.clear();
    }

    /// Adds a mechanism with bodies in these rows and the loads of the last substep. What is
    /// touched is held by something else.
    pub(crate) fn add_mechanism(
        &mut self,
        of_it: impl Iterator<Item = (SolverRow, Slot, f64)>,
        is_touched: bool,
        bodies: &SolverBodies,
    ) {
        let mut is_free = !is_touched;
        for (row, slot, load) in of_it {
            if !bodies.is_dynamic(row) {
                is_free = false;
                continue;
            }
            let PrincipalMoments { moments: own, turns, .. } = bodies.inertia[row.index()];
            let does_turn = turns != 0.0;
            // What does not turn takes up torques.
            is_free &= does_turn;
            let least = if does_turn { own.x.min(own.y).min(own.z) } else { Real::INFINITY };
            let load = if does_turn { real(load) } else { 0.0 };
            self.bodies.push(LoadedBody { row, slot, own, least, load });
        }
        self.mechanisms.push(LoadedMechanism { end: self.bodies.len(), is_free, dropped: Vec3::zero() });
    }

    /// The load of each body that has one; none where numbers have overflowed.
    pub(crate) fn loads(&self) -> impl Iterator<Item = (Slot, f64)> + '_ {
        self.bodies
            .iter()
            .filter(|body| body.load > 0.0 && body.load.is_finite())
            .map(|body| (body.slot, f64::from(body.load)))
    }

    /// To be called before the first substep: gives bodies the inertia of the last, at the velocity
    /// that they have.
    pub(crate) fn begin(&mut self, bodies: &mut SolverBodies) {
        self.for_each(|body| (body.load > 0.0).then(|| body.set_moments(body.raised(), true, bodies)));
    }

    /// Takes the loads of a substep of `h` \[s\], of the impulses that the next begins with: more
    /// inertia at the momentum that there is, less of it at the velocity. Neither makes energy.
    pub(crate) fn take_loads(&mut self, warm_start: &[WarmStartImpulse], h: Real, bodies: &mut SolverBodies) {
        self.for_each(|body| {
            let load = real(load_of(f64::from(warm_start[body.row.index()].pull), h.into()));
            let asked = load.max(real(KEPT_LOAD) * body.load);
            // What is no more changes nothing now, and nothing that is left of it will.
            let asked = if body.least < asked { asked } else { 0.0 };
            let is_less = asked < body.load;
            let is_other = asked != body.load;
            body.load = asked;
            is_other.then(|| body.set_moments(body.raised(), is_less, bodies))
        });
    }

    /// To be called after the last substep: gives bodies their own moments, at the velocity that
    /// they have. What flies free gets back the angular momentum that raised moments have made or
    /// dropped, as a rotation of the whole, which no joint resists.
    pub(crate) fn finish(&mut self, bodies: &mut SolverBodies) {
        self.for_each(|body| (body.load > 0.0).then(|| body.set_moments(body.own, true, bodies)));
        let Self { bodies: all, mechanisms, turned } = self;
        let mut begin = 0;
        for LoadedMechanism { end, is_free, dropped } in &*mechanisms {
            let of_it = &all[std::mem::replace(&mut begin, *end)..*end];
            if *is_free && dropped.dot(*dropped) > 0.0 {
                turned.clear();
                turned.extend(of_it.iter().map(|body| MechanismBody::read(bodies, body.row, 0.0)));
                return_momentum(turned, *dropped, AxisLock(Axes::NONE));
                turned.iter().for_each(|body| body.write_momentum(bodies));
            }
        }
    }

    /// Calls with each body, and notes what angular momentum that has dropped.
    fn for_each(&mut self, mut change: impl FnMut(&mut LoadedBody) -> Option<Vec3<Real>>) {
        let mut begin = 0;
        for mechanism in &mut self.mechanisms {
            for body in &mut self.bodies[std::mem::replace(&mut begin, mechanism.end)..mechanism.end] {
                if let Some(dropped) = change(body) {
                    mechanism.dropped = mechanism.dropped + double(dropped).into();
                }
            }
        }
    }
}

impl LoadedBody {
    fn raised(&self) -> Vec3<Real> {
        let Self { own, load, .. } = *self;
        Vec3::new(own.x.max(load), own.y.max(load), own.z.max(load))
    }

    /// Sets the moments of a body, at the angular velocity or at the angular momentum that it has.
    /// Returns how much of that it has lost.
    fn set_moments(&self, moments: Vec3<Real>, keeps_velocity: bool, bodies: &mut SolverBodies) -> Vec3<Real> {
        let i = self.row.index();
        let (orientation, before) = (bodies.pose[i].orientation, bodies.motion[i].angular_momentum);
        let after = if keeps_velocity {
            momentum_with(moments, bodies.inertia[i].moments, orientation, before)
        } else {
            before
        };
        bodies.motion[i].angular_momentum = after;
        let inverse_moments = Vec3::new(1.0 / moments.x, 1.0 / moments.y, 1.0 / moments.z);
        bodies.inertia[i] = PrincipalMoments { moments, inverse_moments, ..bodies.inertia[i] };
        let of_world = Moments { moments, inverse_moments, axes: None };
        let (diagonal, off_diagonal) = of_world.inverse_in_world(orientation);
        bodies.inv_inertia[i] = WorldInverseInertia { diagonal, off_diagonal, ..bodies.inv_inertia[i] };
        // Contacts are to have the masses of this inertia.
        bodies.delta_pose[i].has_turned = 1.0;
        before - after
    }
}
