//! The status of a world in a sweep, as its row in the result file names it.

/// What a world of a sweep came to, as its row says it.
///
/// ```
/// use tumble_sweep::RunStatus;
///
/// assert_eq!(RunStatus::NotFinite.name(), "not-finite");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunStatus {
    /// It was run to its end; only then does anything follow in the row.
    Ok,
    /// No body, or no simulation, has the values that were drawn.
    Impossible,
    /// Its state, or its energy, stopped being finite.
    NotFinite,
}

impl RunStatus {
    const ALL: [Self; 3] = [Self::Ok, Self::Impossible, Self::NotFinite];

    /// The word for it in a row.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Impossible => "impossible",
            Self::NotFinite => "not-finite",
        }
    }

    /// The one that a row has this word for.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|outcome| outcome.name() == name)
    }
}
