use super::booking::Bookings;
use super::contact::Contact;
use super::materials::Extras;
use super::passes::Moment;
use super::refine::{self, Round};
use super::solver::{Pass, Solver};
use super::solver_bodies::SolverBodies;
use crate::settings::Settings;

/// The bodies that touch something and what is done to them in a substep of the settings: those of one world, or of several.
#[derive(Clone, Default)]
pub(crate) struct Pushing {
    pub(super) bodies: SolverBodies,
    pub(super) bookings: Bookings,
    /// Contacts that are found again in each substep.
    pub(super) rounds: Vec<Round>,
    solver: Solver,
}

impl Pushing {
    /// Makes room for so many bodies that impulses move and so many that they do not.
    pub(super) fn reset(&mut self, [moved, unmoved]: [usize; 2]) {
        self.bookings.clear();
        self.rounds.clear();
        self.bodies.reset(moved, unmoved);
    }

    /// Pushes the bodies apart that contacts between these rows hold apart, and leaves them where they are after one substep of the settings; the contacts get the impulses.
    pub(super) fn push(
        &mut self,
        contacts: &mut [Contact],
        rows: impl Fn(&Contact) -> [u32; 2],
        settings: &Settings,
        extras: Extras,
    ) {
        let (substeps, h) = (settings.contact_substeps_each(), settings.contact_substep());
        let (Self { bodies, bookings, rounds, solver }, biased) = (self, Pass::biased(h));
        solver.lay_out(contacts, rows, bodies, extras);
        refine::leave_out_needles(rounds, bodies);
        solver.locate(contacts.len(), rounds);
        bodies.with_poses(|bodies, poses| solver.run(Pass::Prepare(contacts, poses), bodies));
        for substep in 0..substeps {
            bookings.before_kick(bodies);
            bodies.kick();
            bookings.before_push(bodies);
            // Before the impulses of the last step act: bodies that those push together have not come together, and to bounce them would make energy.
            if extras.bounces {
                let moment = if substep == 0 { Moment::FirstKicked } else { Moment::Kicked };
                solver.run(Pass::NoteApproach(h, moment), bodies);
            }
            bodies.hold();
            solver.run(biased, bodies);
            bookings.before_motion(bodies);
            bodies.drift(h);
            solver.refine(rounds, &bodies.moved);
            bookings.after_motion(bodies);
            if extras.bounces {
                solver.run(Pass::NoteApproach(h, Moment::Moved), bodies);
            }
            solver.run(Pass::Relax(h, substep + 1 < substeps), bodies);
            bookings.after_substep(bodies);
        }
        if extras.bounces {
            solver.run(Pass::Rebound(settings.restitution_threshold), bodies);
        }
        solver.keep(contacts);
    }
}
