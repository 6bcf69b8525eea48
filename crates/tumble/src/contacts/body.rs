use tumble_math::FreeRotation;
use tumble_math::lane::Vec3;

use crate::derived::{Derived, derived};
use crate::integrators::Kick;
use crate::math::Real;
use crate::state::{Constants, Force, State};

/// A body as the solver sees it: momentum is what it changes, and the rest says what that does.
#[derive(Clone)]
pub(super) struct SolverBody {
    pub(super) state: State<Real>,
    /// Velocities as they follow from the momenta, and the inverse inertia in the world; both as of the last drift or impulse.
    pub(super) derived: Derived<Real>,
    /// Zero for what impulses do not move \[1/kg\].
    pub(super) inverse_mass: Real,
    /// What impulses move.
    pub(super) free: Option<Free>,
    /// Since the start of the step: how far the centre went \[m\], and how far it turned, as a vector along the axis \[rad\].
    pub(super) displacement: Relative,
}

pub(super) use super::row::Relative;

/// What only bodies have that impulses move.
#[derive(Clone)]
pub(super) struct Free {
    constants: Constants<Real>,
    kick: Kick<Real>,
    rotation: Option<FreeRotation<Real>>,
    force: Force<Real>,
}

impl Relative {
    pub(super) const ZERO: Self =
        Self { linear: Vec3 { x: 0.0, y: 0.0, z: 0.0 }, angular: Vec3 { x: 0.0, y: 0.0, z: 0.0 } };
}

impl SolverBody {
    /// A body that stays or moves as it is told, which its derived velocities say.
    pub(super) fn unmoved(state: State<Real>, derived: Derived<Real>) -> Self {
        Self { state, derived, inverse_mass: 0.0, free: None, displacement: Relative::ZERO }
    }

    /// A body that forces move, for substeps of `h` \[s\].
    pub(super) fn moved(constants: &Constants<Real>, state: State<Real>, force: Force<Real>, h: Real) -> Self {
        let state = State { orientation: state.orientation.normalize(), ..state };
        let rotation = constants
            .inertia
            .as_ref()
            .map(|inertia| FreeRotation::new(inertia.moments, inertia.inverse_moments, inertia.axes, h));
        let free = Free { constants: *constants, kick: Kick::new(constants, h), rotation, force };
        Self {
            state,
            derived: derived(constants, &state),
            inverse_mass: 1.0 / constants.mass,
            free: Some(free),
            displacement: Relative::ZERO,
        }
    }

    /// `I^-1 v` for what impulses turn, else zero.
    pub(super) fn response(&self, v: Vec3<Real>) -> Vec3<Real> {
        if self.free.is_some() { self.derived.apply_inverse_inertia(v) } else { Vec3::zero() }
    }

    /// An impulse through the centre and an angular impulse about it.
    pub(super) fn push(&mut self, linear: Vec3<Real>, angular: Vec3<Real>) {
        if self.free.is_some() {
            self.state.linear = self.state.linear + linear;
            self.state.angular = self.state.angular + angular;
            self.derived.linear = self.state.linear * self.inverse_mass;
            self.derived.angular = self.derived.apply_inverse_inertia(self.state.angular);
        }
    }

    /// Adds what forces do in a substep.
    pub(super) fn kick(&mut self) {
        if let Some(free) = &self.free {
            self.state = free.kick.kicked(self.state, free.force);
            self.push(Vec3::zero(), Vec3::zero());
        }
    }

    /// Moves by the velocities there are, which stay, for `h` \[s\]. Free rotation is exact, so a body spins on as it does without contacts.
    pub(super) fn drift(&mut self, h: Real) {
        let (v, w) = (self.derived.linear, self.derived.angular);
        self.displacement.linear = self.displacement.linear + v * h;
        self.displacement.angular = self.displacement.angular + w * h;
        if let Some(free) = &self.free {
            self.state.position = self.state.position + v * h;
            if let Some(rotation) = &free.rotation {
                self.state.orientation = rotation.rotate(self.state.orientation, self.state.angular);
            }
            self.derived = derived(&free.constants, &self.state);
        }
    }
}
