//! The names of axes in files.

use tumble::Axes;
use tumble_import::FieldError;

/// What each axis is called, in the order of [`Axes::EACH`].
pub(crate) const NAMES: [&str; 6] = ["linear_x", "linear_y", "linear_z", "angular_x", "angular_y", "angular_z"];

/// The axes of these names.
///
/// # Errors
/// [`FieldError`] where one is no axis, or is given twice.
pub(crate) fn axes(field: &str, names: &[String]) -> Result<Axes, FieldError> {
    names.iter().enumerate().try_fold(Axes::NONE, |axes, (index, name)| {
        let error = |problem| FieldError::new(format!("{field}[{index}]"), problem);
        let named = named_axes().find(|(known, _)| known == name);
        let (_, axis) = named.ok_or_else(|| error(format!("must be one of {}, not {name:?}", NAMES.join(", "))))?;
        if axes.contains(axis) {
            return Err(error("is given twice".to_owned()));
        }
        Ok(axes | axis)
    })
}

/// Each axis with its name.
pub(crate) fn named_axes() -> impl Iterator<Item = (&'static str, Axes)> {
    NAMES.into_iter().zip(Axes::EACH)
}
