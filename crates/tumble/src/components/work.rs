//! Work done on a body, booked by source.

use std::ops::AddAssign;

/// Kinds of forces with an account of their own: force components of a body, then forces between
/// bodies.
pub(crate) const FORCE_KINDS: [&str; 10] = [
    "Drag",
    "Magnus",
    "Thruster",
    "ConstantWrench",
    "SpringToPoint",
    "PointGravity",
    "Buoyancy",
    "AngularVelocityServo",
    "Spring",
    "GravityMass",
];

/// Work done on a body since it got this component \[J\], by what did it.
/// [`Ledger::attach`](crate::Ledger::attach) adds it.
///
/// The sum is the change of the body's kinetic energy in steps. What happens between steps, such as
/// an impulse or another [`Inertia`](crate::Inertia), is not in it; a ledger shows that as
/// [`LedgerEntry::between_steps`](crate::LedgerEntry::between_steps).
///
/// ```
/// # use tumble::{Work, prelude::*};
/// # let mut world = hecs::World::new();
/// let stone = RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
/// Ledger::attach(&mut world, &simulation);
/// simulation.step_many(&mut world, 60);
/// let work = *world.get::<&Work>(stone)?;
/// assert!((work.gravity - 9.81 * 9.81).abs() < 1e-3); // M g times g/2 metres
/// assert_eq!(work.of("Drag"), Some(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)] // What every step adds to comes first and is next to each other in memory.
pub struct Work {
    /// By gravity.
    pub gravity: f64,
    /// By the forces that the caller added to the [`Wrench`](crate::Wrench).
    pub applied: f64,
    /// By damping; never positive.
    pub damping: f64,
    /// Energy that the integrator made or lost, rounding included.
    pub integrator: f64,
    /// By each kind of force component, in the order of
    /// [`ForceLaws::COMPONENTS`](crate::ForceLaws::COMPONENTS).
    pub forces: [f64; FORCE_KINDS.len()],
    /// By each force law, in the order they were added; the last is the sum of all from there on.
    pub laws: [f64; Self::LAWS],
    /// By contacts: what pushes and friction changed of the kinetic energy. A force that pushes a
    /// body against another is booked for the way that the body went, which is none at rest; where
    /// a body touches something, forces are those of the start of the step, and what neither they
    /// nor damping nor the free motion did is the contacts'.
    pub contacts: f64,
    /// By joints: what they changed of the kinetic energy. Joints that are not driven only pass
    /// energy on, so over all bodies of a mechanism it is zero but for the error of the method and
    /// what a kinematic body does through them. What their springs gave is in it, as that of other
    /// springs is in `forces`: with the change of
    /// [`Totals::force_potential`](crate::Totals::force_potential) it is what motors, dampers and
    /// friction did.
    pub joints: f64,
    /// By falling asleep, which takes the last momentum; never positive.
    pub sleep: f64,
}

impl Work {
    /// How many force laws have an entry of their own.
    pub const LAWS: usize = 8;

    /// By all of them \[J\].
    pub fn total(&self) -> f64 {
        let of_forces = self.forces.iter().sum::<f64>() + self.laws.iter().sum::<f64>();
        self.gravity
            + self.applied
            + self.damping
            + self.contacts
            + self.joints
            + self.sleep
            + self.integrator
            + of_forces
    }

    /// By a kind of force component, by its name: `"Drag"`. `None` where no kind is called so.
    pub fn of(&self, component: &str) -> Option<f64> {
        FORCE_KINDS.iter().position(|name| *name == component).map(|index| self.forces[index])
    }

    /// How many entries there are for laws, force components among them.
    pub(crate) const LAW_ENTRIES: usize = FORCE_KINDS.len() + Self::LAWS;

    /// The entry of a law by its index among all: force components first, then those that were
    /// added.
    pub(crate) fn of_law_mut(&mut self, index: usize) -> &mut f64 {
        match index.checked_sub(self.forces.len()) {
            Some(added) => &mut self.laws[added.min(Self::LAWS - 1)],
            None => &mut self.forces[index],
        }
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.gravity += other.gravity;
        self.applied += other.applied;
        self.damping += other.damping;
        self.contacts += other.contacts;
        self.joints += other.joints;
        self.sleep += other.sleep;
        self.integrator += other.integrator;
        for (sum, force) in self.forces.iter_mut().zip(other.forces) {
            *sum += force;
        }
        for (sum, law) in self.laws.iter_mut().zip(other.laws) {
            *sum += law;
        }
    }
}
