//! Energy, momentum and work of all bodies: totals, and an account of where they come from.

pub(crate) mod body_terms;
pub(crate) mod ledger;
pub(crate) mod totals;

pub use crate::energy::ledger::{Ledger, LedgerEntry};
pub use crate::energy::totals::Totals;
