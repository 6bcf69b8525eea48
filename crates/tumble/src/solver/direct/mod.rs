//! Direct contacts: those of the bodies of a mechanism, solved together with its joints.
//!
//! In passes, an impulse at a light foot is answered by the foot alone and not by the heavy trunk
//! that stands on it. Here a contact is answered by all that its mechanism moves: the response of
//! every row to an impulse along every other is taken through the joints' matrix, and the impulses
//! are found in that small dense problem.

pub(crate) mod contact_problem;
#[cfg(test)]
mod contact_problem_tests;
mod contact_sweep;
pub(crate) mod dense;
pub(crate) mod direct_choice;
pub(crate) mod direct_contact;
pub(crate) mod direct_contacts;
pub(crate) mod direct_group;
pub(crate) mod direct_lanes;
mod newton_step;
