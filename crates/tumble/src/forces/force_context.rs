//! Inputs of force laws beyond the body state: wind, gravity, kick time and substep length.

use hecs::EntityRef;

use crate::components::Wind;
use crate::math::{Real, Vec3};
use crate::settings::Settings;

/// The inputs of laws beside time and the state of a body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ForceContext {
    /// Velocity of the medium around the body [m/s].
    pub(crate) wind: Vec3,
    /// The simulation's gravity [m/s^2].
    pub(crate) gravity: Vec3,
    /// The time over which a kick applies the force of one evaluation \[s\]; zero where the
    /// integrator does not kick, but takes rates at stages.
    pub(crate) kick: Real,
    /// Length of a substep \[s\].
    pub(crate) substep: Real,
}

impl ForceContext {
    /// Those of a body in still air.
    pub(crate) fn new(settings: &Settings) -> Self {
        let substep = settings.substep();
        let kick = settings.integrator.law_kick(substep);
        Self { wind: Vec3::ZERO, gravity: settings.gravity, kick, substep }
    }

    /// Those of a body, with its own wind.
    pub(crate) fn of_body(body: EntityRef<'_>, settings: &Settings) -> Self {
        Self { wind: body.get::<&Wind>().map_or(Vec3::ZERO, |wind| wind.0), ..Self::new(settings) }
    }
}
