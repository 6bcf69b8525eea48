//! How the joints of a world are solved.

use std::fmt;
use std::str::FromStr;

/// How joints are solved: a setting of [`Settings`](crate::Settings).
///
/// Direct solution has no error to speak of, at any ratio of masses. Its cost grows with the loops
/// of a mechanism: a net of `n` joints takes `n` to the power of 1.5, where passes take `n`. Passes
/// are soft: a joint gives way by its load over a stiffness that grows with the masses of its two
/// bodies and with the square of the substeps.
///
/// ```
/// use tumble::{JointSolver, Settings};
///
/// let settings = Settings::default().with_joint_solver(JointSolver::Passes);
/// assert_eq!(settings.joint_solver, JointSolver::Passes);
/// ```
#[doc(alias("articulation", "multibody"))]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum JointSolver {
    /// In passes those of mechanisms whose matrix would fill up, as that of a net does; all others
    /// directly.
    #[default]
    Auto,
    /// All directly.
    Direct,
    /// In passes where there are any: balls, hinges and welds without limits, drives or friction,
    /// of mechanisms in which there is nothing else. All others directly.
    Passes,
}

impl JointSolver {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Direct, Self::Passes];

    /// The name that scene files use, such as `"passes"`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Direct => "direct",
            Self::Passes => "passes",
        }
    }
}

impl fmt::Display for JointSolver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that no [`JointSolver`] has.
///
/// ```
/// # use tumble::{JointSolver, UnknownJointSolver};
/// assert_eq!("auto".parse(), Ok(JointSolver::Auto));
/// assert_eq!("soft".parse::<JointSolver>(), Err(UnknownJointSolver("soft".to_owned())));
/// ```
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown joint solver '{0}'; use one of auto, direct, passes")]
pub struct UnknownJointSolver(
    /// The name.
    pub String,
);

tumble_math::debug_as_display!(UnknownJointSolver);

impl FromStr for JointSolver {
    type Err = UnknownJointSolver;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|it| it.name() == name).ok_or_else(|| UnknownJointSolver(name.to_owned()))
    }
}
