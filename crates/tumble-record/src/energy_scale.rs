//! What a change of energy is compared to.

use tumble::Totals;

/// The largest of `|E|` and the kinetic energy at the start, and of what kinetic energy and
/// potentials have `exchanged` \[J\]: a body dropped from rest at the origin has no energy at all.
///
/// ```
/// use tumble::energy::Totals;
/// use tumble_record::energy_scale;
///
/// let start = Totals { linear_kinetic: 2.0, potential: -2.0, ..Totals::default() };
/// assert_eq!((energy_scale(&start, 0.5), energy_scale(&start, 3.0)), (2.0, 3.0));
/// ```
#[must_use]
pub fn energy_scale(start: &Totals, exchanged: f64) -> f64 {
    start.energy().abs().max(start.kinetic()).max(exchanged)
}
