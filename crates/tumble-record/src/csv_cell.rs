//! Escaping of names in CSV cells, so that spreadsheets do not read them as formulas.

use std::borrow::Cow;

/// What spreadsheets take for the beginning of a formula, in letters of either width, or pass over
/// before one.
const BEGINS_A_FORMULA: [char; 11] =
    ['=', '+', '-', '@', '\t', '\r', '\n', '\u{ff1d}', '\u{ff0b}', '\u{ff0d}', '\u{ff20}'];

/// A name as a cell of a table in text: an apostrophe is put before one that a spreadsheet would
/// compute, and before one that has one there.
///
/// So a reader has the name back by taking one apostrophe away where a cell begins with it.
///
/// ```
/// use tumble_record::csv_cell;
///
/// assert_eq!(csv_cell("=1+1"), "'=1+1");
/// assert_eq!(csv_cell("'twas"), "''twas");
/// assert_eq!(csv_cell("brick"), "brick");
/// let name = |cell: &str| cell.strip_prefix('\'').unwrap_or(cell).to_owned();
/// assert_eq!(name(&csv_cell("=1+1")), "=1+1");
/// ```
#[must_use]
pub fn csv_cell(name: &str) -> Cow<'_, str> {
    if name.starts_with(BEGINS_A_FORMULA) || name.starts_with('\'') {
        Cow::Owned(format!("'{name}"))
    } else {
        Cow::Borrowed(name)
    }
}
