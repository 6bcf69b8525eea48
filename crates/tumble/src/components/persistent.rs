use crate::math::Real;

/// How many times the simulation's gravity acts on a body; 1 for a body without this component, 0 for one that floats.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct GravityScale(pub Real);

/// Decay of the momenta at constant rates: `dP/dt = F - linear P`, `dL/dt = torque - angular L`.
///
/// The decay over a step is exact at any rate and step, never unstable; a rate that is not positive does nothing.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)]
pub struct Damping {
    /// Rate at which linear momentum decays [1/s].
    pub linear: Real,
    /// Rate at which angular momentum decays [1/s].
    pub angular: Real,
}
