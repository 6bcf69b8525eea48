use std::ops::AddAssign;

/// Work done on a body since it got this component \[J\], by what did it. [`Ledger::attach`](crate::Ledger::attach) adds it.
///
/// The sum is the change of the body's kinetic energy in steps. What happens between steps, such as an impulse or another
/// [`Inertia`](crate::Inertia), is not in it.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Work {
    /// By gravity.
    pub gravity: f64,
    /// By the forces that the caller added to the [`Wrench`](crate::Wrench).
    pub applied: f64,
    /// By damping; never positive.
    pub damping: f64,
    /// By each force law, in the order they were added; the last is the sum of all from there on.
    pub laws: [f64; Self::LAWS],
    /// What nothing did: energy that the integrator made or lost, rounding included.
    pub integrator: f64,
}

impl Work {
    /// How many force laws have an entry of their own.
    pub const LAWS: usize = 8;

    /// By all of them \[J\].
    pub fn total(&self) -> f64 {
        self.gravity + self.applied + self.damping + self.integrator + self.laws.iter().sum::<f64>()
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.gravity += other.gravity;
        self.applied += other.applied;
        self.damping += other.damping;
        self.integrator += other.integrator;
        for (sum, law) in self.laws.iter_mut().zip(other.laws) {
            *sum += law;
        }
    }
}
