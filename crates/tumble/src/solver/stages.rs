//! The stages of the contact solver, run color by color over blocks of constraints.

use std::ops::Range;

use crate::collision::contact::ContactRecord;
use crate::collision::contact_materials::Extras;
use crate::math::{Real, real};
use crate::simd::block_lanes::Lanes;
use crate::simd::{BLOCK, RowColors, dispatch_in_blocks};
use crate::solver::block_parts::{in_parts, run};
use crate::solver::body_rows::{BodyPose, DeltaPose};
use crate::solver::contact::capsule_axes::CapsuleAxes;
use crate::solver::contact::constraint::{Belt, Block, Bounce, Rolling};
use crate::solver::contact::follow_bodies::Follow;
use crate::solver::contact::line::Line;
use crate::solver::contact::prepare::Prepare;
use crate::solver::contact::restitution::{ApplyRestitution, RecordApproachSpeed, SubstepMoment};
use crate::solver::contact::round_contacts;
use crate::solver::contact::round_contacts::{RoundConstraint, RoundLane};
use crate::solver::contact::softness::Softness;
use crate::solver::contact::solve::{Blocks, Solve, StageBodies};
use crate::solver::contact::store_impulses::StoreImpulses;
use crate::solver::direct::direct_contact::DirectContact;
use crate::solver::direct::direct_lanes;
use crate::solver::graph_coloring::{ContactColor, GraphColoring, sort_into_buckets};
use crate::solver::locked_bodies::{BlockLocks, LockedBodies};
use crate::solver::solver_bodies::SolverBodies;
use crate::solver::substeps::GroupContact;

/// The contacts of a step, colored and laid out in blocks.
#[derive(Clone, Default)]
pub(crate) struct ContactConstraints {
    coloring: GraphColoring,
    /// Contacts by color and number of points.
    order: Vec<GroupContact>,
    ones: BlockSheet<1, 0>,
    fours: BlockSheet<4, 6>,
    /// One for each color, in the order in which they are solved.
    colors: Vec<ColorRange>,
    /// Which rows the contacts of each color change.
    row_colors: RowColors,
    /// The round contacts that are found again one by one, by their numbers among all round ones,
    /// and where they are laid out.
    found_again: Vec<u32>,
    places: Vec<Place>,
    /// Of all contacts, by their numbers.
    all_places: Vec<Place>,
    laid_out: LaidOut,
}

/// What a layout follows from: while this is the same the layout is kept.
#[derive(Clone, Default)]
struct LaidOut {
    /// Each with whether it has more than one point.
    contacts: Vec<(GroupContact, bool)>,
    first_non_dynamic: usize,
    extras: Extras,
    /// Of bodies with locked axes, which are laid out in every step.
    has_locks: bool,
}

/// Blocks of contacts of up to `P` points, and what only some have: for all blocks, or for none.
#[derive(Clone)]
struct BlockSheet<const P: usize, const C: usize> {
    blocks: Vec<Block<P, C>>,
    rolling: Vec<Rolling>,
    lines: Vec<Line>,
    axes: Vec<CapsuleAxes>,
    bounces: Vec<Bounce<P>>,
    belts: Vec<Belt>,
    locks: Vec<BlockLocks>,
    lags: Vec<[Lanes; 3]>,
}

impl<const P: usize, const C: usize> Default for BlockSheet<P, C> {
    fn default() -> Self {
        Self {
            blocks: Vec::new(),
            rolling: Vec::new(),
            lines: Vec::new(),
            axes: Vec::new(),
            bounces: Vec::new(),
            belts: Vec::new(),
            locks: Vec::new(),
            lags: Vec::new(),
        }
    }
}

/// Which of the two sheets.
#[derive(Clone, Copy, Default)]
enum Sheet {
    #[default]
    Ones,
    Fours,
}

/// Where a contact is laid out.
#[derive(Clone, Copy, Default)]
struct Place {
    sheet: Sheet,
    block: usize,
    lane: usize,
}

/// The blocks of a color, which can be solved in parallel.
#[derive(Clone, Debug)]
struct ColorRange {
    ones: Range<usize>,
    fours: Range<usize>,
}

/// A stage of the solver, run on all contacts.
#[derive(Clone, Copy)]
pub(crate) enum SolverStage<'a> {
    /// Fills the blocks for bodies with these poses, as the contacts have it.
    Prepare(&'a [ContactRecord], &'a [BodyPose]),
    /// Pushes overlapping bodies apart, with softness between dynamic bodies and on others, in
    /// substeps of `h` \[s\]. Points that approach faster than `impact_speed` [m/s] are impacts.
    Solve { softness: [Softness; 2], h: Real, impact_speed: Real },
    /// Removes the velocity that the bias gave, and applies friction; with `stores_warm_start` it
    /// stores the impulses for the next substep.
    Relax { h: Real, impact_speed: Real, stores_warm_start: bool },
    /// Has the contacts follow their bodies in a substep of this length \[s\].
    Follow(Real),
    /// Records the approach speeds in substeps of this length \[s\].
    RecordApproachSpeed(Real, SubstepMoment),
    /// Applies restitution to points that approached faster than this [m/s].
    ApplyRestitution(Real),
}

/// Colors of each kind, and one more for contacts without a color.
const COLORS: usize = ContactColor::OVERFLOW as usize + 1;

impl ContactConstraints {
    /// Lays out the contacts of a group, with room for extras; as they are where nothing of that is
    /// other than it was.
    pub(crate) fn lay_out(
        &mut self,
        all: &[ContactRecord],
        contacts: &[GroupContact],
        bodies: &SolverBodies,
        extras: Extras,
    ) {
        if self.laid_out.is_known((all, contacts), bodies, extras) {
            return;
        }
        self.laid_out.set((all, contacts), bodies, extras);
        let ends = self.sort(all, contacts, bodies.first_non_dynamic());
        let Self { order, ones, fours, colors, row_colors, .. } = self;
        colors.clear();
        row_colors.reset(bodies.first_non_dynamic());
        let (mut one, mut four) = (0, 0);
        let mut add = |has_non_dynamic, with_one: &[GroupContact], with_more: &[GroupContact]| {
            let (first_one, first_four) = (one, four);
            row_colors.begin(has_non_dynamic);
            for chunk in with_one.chunks(BLOCK) {
                row_colors.push(chunk.iter().map(|contact| contact.rows.map(|row| row.0)));
                ones.set(one, chunk, &bodies.locked);
                one += 1;
            }
            for chunk in with_more.chunks(BLOCK) {
                row_colors.push(chunk.iter().map(|contact| contact.rows.map(|row| row.0)));
                fours.set(four, chunk, &bodies.locked);
                four += 1;
            }
            colors.push(ColorRange { ones: first_one..one, fours: first_four..four });
        };
        let mut begin = 0;
        for (index, kinds) in ends.chunks_exact(2).enumerate() {
            let (with_one, with_more) = (&order[begin..kinds[0]], &order[kinds[0]..kinds[1]]);
            begin = kinds[1];
            let has_non_dynamic = index >= COLORS;
            if index % COLORS == 0 {
                with_more.chunks(1).for_each(|contact| add(has_non_dynamic, &[], contact));
            } else if !(with_one.is_empty() && with_more.is_empty()) {
                add(has_non_dynamic, with_one, with_more);
            }
        }
        ones.finish(one, extras, &bodies.locked);
        fours.finish(four, extras, &bodies.locked);
    }

    /// Sorts the contacts into the order in which they are solved: those between dynamic bodies,
    /// then those with a non-dynamic body; of each those without a color, then color by color those
    /// with one point and those with more. Returns where each of these ends.
    fn sort(
        &mut self,
        all: &[ContactRecord],
        contacts: &[GroupContact],
        first_non_dynamic: usize,
    ) -> [usize; 4 * COLORS] {
        self.coloring.color(contacts.iter().map(|contact| contact.rows), first_non_dynamic);
        let colors = self.coloring.colors();
        let kind = |index: usize| {
            let ContactColor { has_non_dynamic, index: color } = colors[index];
            let overflows = color == ContactColor::OVERFLOW;
            let place = if overflows { 0 } else { color as usize + 1 };
            (usize::from(has_non_dynamic) * COLORS + place) * 2
                + usize::from(overflows || has_more(all, &contacts[index]))
        };
        sort_into_buckets(contacts, kind, &mut self.order)
    }

    /// Runs a stage on all contacts, color by color; those with non-dynamic bodies come last.
    pub(crate) fn run(&mut self, stage: SolverStage<'_>, bodies: &mut SolverBodies) {
        let Self { ones, fours, colors, row_colors, .. } = self;
        for (index, color) in colors.iter().enumerate() {
            let SolverBodies { motion, warm_start, inv_inertia, delta_pose, .. } = bodies;
            let (inv_inertia, delta_pose) = (&**inv_inertia, &**delta_pose);
            let bodies = StageBodies {
                motion: row_colors.rows(index, motion),
                warm_start: row_colors.rows(index, warm_start),
                inv_inertia,
                delta_pose,
            };
            let (of_ones, of_fours) = bodies.split_at(color.ones.len());
            in_parts(ones.blocks(&color.ones), of_ones, &|blocks, bodies| stage.run_on(blocks, bodies));
            in_parts(fours.blocks(&color.fours), of_fours, &|blocks, bodies| stage.run_on(blocks, bodies));
        }
    }

    /// Finds out where the contacts with these numbers, in their order, are laid out.
    pub(crate) fn locate(&mut self, contacts: usize, rounds: &[RoundConstraint]) {
        self.found_again.clear();
        self.places.clear();
        self.ones.axes.clear();
        if rounds.is_empty() {
            return;
        }
        self.place_all(contacts);
        let Self { found_again, places, all_places, ones, .. } = self;
        if rounds.iter().any(|round| round.crossed_axes().is_some()) {
            ones.axes.resize(ones.blocks.len(), CapsuleAxes::NONE);
        }
        for (number, round) in (0..).zip(rounds) {
            let place = all_places[round.number() as usize];
            match (round.crossed_axes(), place.sheet) {
                (Some(axes), Sheet::Ones) => ones.axes[place.block].set(place.lane, axes),
                _ => {
                    found_again.push(number);
                    places.push(place);
                }
            }
        }
    }

    /// Finds round contacts again after their bodies have moved.
    pub(crate) fn update_round_contacts(&mut self, rounds: &[RoundConstraint], delta_pose: &[DeltaPose]) {
        let Self { ones, fours, found_again, places, .. } = self;
        let found = round_contacts::find(rounds, found_again, delta_pose);
        for ((number, place), found) in found_again.iter().zip(places).zip(found) {
            let (Some(manifold), motion) = (found, (delta_pose, &rounds[*number as usize])) else { continue };
            match place.sheet {
                Sheet::Ones => round_contacts::write(&manifold, ones.lane(place), motion),
                Sheet::Fours => round_contacts::write(&manifold, fours.lane(place), motion),
            }
        }
    }

    /// Finds out where the contacts of the group are laid out, of this many.
    pub(crate) fn place_all(&mut self, contacts: usize) {
        let Self { ones, fours, all_places, .. } = self;
        all_places.clear();
        all_places.resize(contacts, Place::default());
        ones.places(Sheet::Ones, all_places);
        fours.places(Sheet::Fours, all_places);
    }

    /// Where a contact is laid out.
    fn place(&self, contact: &DirectContact) -> Place {
        self.all_places[contact.number as usize]
    }

    /// Makes room for the lines of round contacts with several points, where there are such.
    pub(crate) fn make_room_for_lines(&mut self) {
        let are_there = self.places.iter().any(|place| matches!(place.sheet, Sheet::Fours));
        self.fours.lines.clear();
        self.fours.lines.resize(if are_there { self.fours.blocks.len() } else { 0 }, Line::NONE);
    }

    /// Makes room for what [`SolverStage::Follow`] finds.
    pub(crate) fn make_room_for_lags(&mut self) {
        self.ones.make_room_for_lags();
        self.fours.make_room_for_lags();
    }

    /// Reads a contact and its impulses.
    pub(crate) fn read_direct(&mut self, contact: &mut DirectContact) {
        let Place { sheet, block, lane } = self.place(contact);
        match sheet {
            Sheet::Ones => direct_lanes::read(contact, (&self.ones.blocks(&(block..block + 1)), 0, lane)),
            Sheet::Fours => direct_lanes::read(contact, (&self.fours.blocks(&(block..block + 1)), 0, lane)),
        }
    }

    /// Writes the impulses of a contact.
    pub(crate) fn write_direct(&mut self, contact: &DirectContact) {
        let Place { sheet, block, lane } = self.place(contact);
        match sheet {
            Sheet::Ones => direct_lanes::write(contact, (&mut self.ones.blocks(&(block..block + 1)), 0, lane)),
            Sheet::Fours => direct_lanes::write(contact, (&mut self.fours.blocks(&(block..block + 1)), 0, lane)),
        }
    }

    /// Adds what a contact does along the normal to its total of the step.
    pub(crate) fn add_to_total(&mut self, contact: &DirectContact) {
        let Place { sheet, block, lane } = self.place(contact);
        let total = match sheet {
            Sheet::Ones => &mut self.ones.blocks[block].start.total_impulse[lane],
            Sheet::Fours => &mut self.fours.blocks[block].start.total_impulse[lane],
        };
        *total += real(contact.normal_impulse());
    }

    /// Stores the impulses in the contacts.
    pub(crate) fn store_impulses(&mut self, contacts: &mut [ContactRecord]) {
        let Self { ones, fours, .. } = self;
        let (all_ones, all_fours) = (0..ones.blocks.len(), 0..fours.blocks.len());
        dispatch_in_blocks(&mut StoreImpulses { blocks: ones.blocks(&all_ones), contacts });
        dispatch_in_blocks(&mut StoreImpulses { blocks: fours.blocks(&all_fours), contacts });
    }
}

impl LaidOut {
    /// Whether these contacts are laid out.
    fn is_known(
        &self,
        (all, contacts): (&[ContactRecord], &[GroupContact]),
        bodies: &SolverBodies,
        extras: Extras,
    ) -> bool {
        let has_locks = self.has_locks || !bodies.locked.is_empty();
        let is_same = (self.first_non_dynamic, self.extras) == (bodies.first_non_dynamic(), extras);
        let now = contacts.iter().map(|contact| (*contact, has_more(all, contact)));
        !has_locks && is_same && now.eq(self.contacts.iter().copied())
    }

    fn set(&mut self, (all, contacts): (&[ContactRecord], &[GroupContact]), bodies: &SolverBodies, extras: Extras) {
        self.has_locks = !bodies.locked.is_empty();
        (self.first_non_dynamic, self.extras) = (bodies.first_non_dynamic(), extras);
        self.contacts.clear();
        self.contacts.extend(contacts.iter().map(|contact| (*contact, has_more(all, contact))));
    }
}

/// Whether a contact has more than one point.
fn has_more(all: &[ContactRecord], contact: &GroupContact) -> bool {
    all[contact.number as usize].count() > 1
}

impl<const P: usize, const C: usize> BlockSheet<P, C> {
    /// Sets which contacts are in a block, an existing one or the next.
    fn set(&mut self, index: usize, contacts: &[GroupContact], locked: &LockedBodies) {
        if self.blocks.len() == index {
            self.blocks.push(Block::empty());
        }
        let block = &mut self.blocks[index];
        block.count = contacts.len();
        block.contacts.iter_mut().zip(contacts).for_each(|(number, contact)| *number = contact.number);
        if !locked.is_empty() {
            self.locks.resize(self.locks.len().max(index + 1), BlockLocks::NONE);
            self.locks[index] = BlockLocks::of(contacts.iter().map(|contact| contact.rows), locked);
        }
    }

    /// Drops the blocks from `count` on, and makes room for extras.
    fn finish(&mut self, count: usize, extras: Extras, locked: &LockedBodies) {
        self.blocks.truncate(count);
        self.rolling.resize(if extras.rolls { count } else { 0 }, Rolling::NONE);
        self.bounces.resize(if extras.bounces { count } else { 0 }, Bounce::NONE);
        self.belts.resize(if extras.conveys { count } else { 0 }, Belt::NONE);
        self.locks.truncate(if locked.is_empty() { 0 } else { count });
    }

    fn make_room_for_lags(&mut self) {
        self.lags.clear();
        self.lags.resize(self.blocks.len(), [[0.0; BLOCK]; 3]);
    }

    /// Notes where each contact is.
    fn places(&self, sheet: Sheet, places: &mut [Place]) {
        for (index, block) in self.blocks.iter().enumerate() {
            for (lane, contact) in block.contacts[..block.count].iter().enumerate() {
                places[*contact as usize] = Place { sheet, block: index, lane };
            }
        }
    }

    /// The block of a contact, and its lane there.
    fn lane(&mut self, &Place { block, lane, .. }: &Place) -> RoundLane<'_, P, C> {
        RoundLane {
            block: &mut self.blocks[block],
            rolling: self.rolling.get_mut(block),
            line: self.lines.get_mut(block),
            lane,
        }
    }

    fn blocks(&mut self, range: &Range<usize>) -> Blocks<'_, P, C> {
        Blocks {
            blocks: &mut self.blocks[range.clone()],
            rolling: self.rolling.get_mut(range.clone()).unwrap_or_default(),
            lines: self.lines.get_mut(range.clone()).unwrap_or_default(),
            axes: self.axes.get(range.clone()).unwrap_or_default(),
            bounces: self.bounces.get_mut(range.clone()).unwrap_or_default(),
            belts: self.belts.get_mut(range.clone()).unwrap_or_default(),
            locks: self.locks.get(range.clone()).unwrap_or_default(),
            lags: self.lags.get_mut(range.clone()).unwrap_or_default(),
        }
    }
}

impl SolverStage<'_> {
    /// Pushes overlapping bodies apart, in substeps of `h` \[s\].
    pub(crate) fn solve(h: Real, impact_speed: Real) -> Self {
        let softness = [Softness::between_moving(h.into()), Softness::on_ground(h.into())];
        Self::Solve { softness, h, impact_speed }
    }

    fn run_on<const P: usize, const C: usize>(self, blocks: Blocks<'_, P, C>, bodies: StageBodies<'_>) {
        match self {
            Self::Prepare(contacts, poses) => run(Prepare::<P, C> { blocks, contacts, bodies, poses }),
            Self::Solve { softness, h, impact_speed } => {
                let softness = Some(softness[usize::from(bodies.motion.has_non_dynamic())]);
                run(Solve::<P, C> {
                    blocks,
                    bodies,
                    softness,
                    impact_speed,
                    inverse_h: 1.0 / h,
                    stores_warm_start: false,
                });
            }
            Self::Relax { h, impact_speed, stores_warm_start } => {
                run(Solve::<P, C> {
                    blocks,
                    bodies,
                    softness: None,
                    impact_speed,
                    inverse_h: 1.0 / h,
                    stores_warm_start,
                });
            }
            Self::Follow(h) => run(Follow::<P, C> { blocks, bodies, h }),
            Self::RecordApproachSpeed(h, moment) => {
                run(RecordApproachSpeed::<P, C> { blocks, bodies, inverse_h: 1.0 / h, moment });
            }
            Self::ApplyRestitution(threshold) => run(ApplyRestitution::<P, C> { blocks, bodies, threshold }),
        }
    }
}
