//! Forces on one body now, by source.

use hecs::EntityRef;

use crate::components::work::FORCE_KINDS;
use crate::components::{Damping, GravityScale, Wrench};
use crate::forces::force_context::ForceContext;
use crate::forces::force_law::BodyState;
use crate::forces::pairwise::between_bodies::{Pull, Pulled};
use crate::forces::registry::{ForceLaws, GRAVITY_MASS, SPRING};
use crate::integrators::state::{Constants, State};
use crate::math::{Real, Vec3, vec3};
use crate::settings::Settings;

/// Forces \[N\] and torques about the centre of mass [N m] on a body, by source, world frame:
/// [`Simulation::forces`](crate::Simulation::forces).
///
/// ```
/// # use tumble::{BodyForces, prelude::*};
/// # let mut world = hecs::World::new();
/// let thruster = Thruster::new(Vec3::Z * 2.0, Vec3::ZERO);
/// let probe =
///     RigidBody::new(Shape::sphere(0.5)).mass(2.0).build()?.spawn_with(&mut world, (thruster,));
/// world.get::<&mut Wrench>(probe)?.add_force(Vec3::Y * 30.0);
/// let forces: BodyForces =
///     Simulation::new(Settings::default())?.forces(&world, probe).ok_or("not moving")?;
/// assert_eq!((forces.gravity.force, forces.applied.force), (Vec3::Y * -19.62, Vec3::Y * 30.0));
/// assert_eq!(forces.of_component("Thruster").map(|wrench| wrench.force), Some(Vec3::Z * 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BodyForces {
    /// By the simulation's gravity.
    pub gravity: Wrench,
    /// The body's [`Wrench`]: the sum of what the caller has added since the last step.
    pub applied: Wrench,
    components: [Wrench; FORCE_KINDS.len()],
    /// By each force law, in the order they were added.
    pub laws: Vec<Wrench>,
    /// By [`Damping`].
    pub damping: Wrench,
    /// By contacts: the mean over their last substep.
    pub contacts: Wrench,
}

impl BodyForces {
    /// Of a body in a state, but for other bodies.
    pub(crate) fn of(
        body: EntityRef<'_>,
        settings: &Settings,
        (laws, time): (&ForceLaws, f64),
        (constants, state): (&Constants<Real>, &State<Real>),
    ) -> Self {
        let scale = body.get::<&GravityScale>().map_or(1.0, |scale| scale.0);
        let context = ForceContext { kick: 0.0, ..ForceContext::of_body(body, settings) };
        let seen = BodyState::new((time, 0.0), (constants, &context), state);
        let mut components = [Wrench::default(); FORCE_KINDS.len()];
        ForceLaws::wrenches_of_components(body, &seen).zip(&mut components).for_each(|(wrench, it)| *it = wrench);
        let damping = body.get::<&Damping>().map_or(Damping::default(), |damping| *damping);
        Self {
            gravity: Wrench { force: settings.gravity * (constants.mass * scale), torque: Vec3::ZERO },
            applied: body.get::<&Wrench>().map_or(Wrench::default(), |wrench| *wrench),
            components,
            laws: laws.wrenches_of_added(body, &seen).collect(),
            damping: Wrench {
                force: (state.linear * -damping.linear).into(),
                torque: (state.angular * -damping.angular).into(),
            },
            contacts: Wrench::default(),
        }
    }

    pub(crate) fn add_between_bodies(&mut self, Pull { springs, gravity }: &Pull) {
        let wrench = |pulled: &Pulled| Wrench { force: vec3(pulled.force), torque: vec3(pulled.torque) };
        self.components[SPRING] = wrench(springs);
        self.components[GRAVITY_MASS] = wrench(gravity);
    }

    /// By each kind of force component, with its name.
    pub fn components(&self) -> impl Iterator<Item = (&'static str, Wrench)> + '_ {
        FORCE_KINDS.into_iter().zip(self.components)
    }

    /// By a kind of force component, by its name: `"Drag"`. `None` where no kind is called so.
    pub fn of_component(&self, name: &str) -> Option<Wrench> {
        FORCE_KINDS.iter().position(|kind| *kind == name).map(|index| self.components[index])
    }

    /// The sum of all.
    pub fn total(&self) -> Wrench {
        let mut sum = self.undamped();
        sum.add(self.damping);
        sum.add(self.contacts);
        sum
    }

    /// The sum of all but damping and contacts.
    pub(crate) fn undamped(&self) -> Wrench {
        let mut sum = self.applied;
        sum.add(self.gravity);
        self.components.iter().chain(&self.laws).for_each(|wrench| sum.add(*wrench));
        sum
    }
}
