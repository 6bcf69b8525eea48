//! How the joints of a world are solved.

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
/// let settings = Settings::default().with_joints(JointSolver::Passes);
/// assert_eq!(settings.joints, JointSolver::Passes);
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
