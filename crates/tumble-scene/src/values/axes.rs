//! The names of axes in files.

use tumble::Axes;

/// What each axis is called, in the order of [`Axes::EACH`].
pub(crate) const NAMES: [&str; 6] = ["linear_x", "linear_y", "linear_z", "angular_x", "angular_y", "angular_z"];

/// Each axis with its name.
pub(crate) fn named_axes() -> impl Iterator<Item = (&'static str, Axes)> {
    NAMES.into_iter().zip(Axes::EACH)
}
