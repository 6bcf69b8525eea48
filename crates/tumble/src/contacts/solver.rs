use std::ops::Range;

use super::block::{Block, Bounce, Rolling};
use super::colouring::{Colour, Colouring};
use super::contact::Contact;
use super::passes::{Blocks, NoteApproach, Rebound, Rows, Solve, WarmStart};
use super::prepare::{Keep, Prepare};
use super::soft::Softness;
use super::solver_bodies::SolverBodies;
use crate::math::Real;
use crate::simd::{BLOCK, dispatch_in_blocks};

/// The contacts of a step, coloured and laid out in blocks.
#[derive(Clone, Default)]
pub(super) struct Solver {
    colouring: Colouring,
    /// Contacts by colour and number of points.
    order: Vec<u32>,
    ones: Sheet<1, 0>,
    fours: Sheet<4, 6>,
    stages: Vec<Stage>,
}

/// Blocks of contacts of up to `P` points, and what only some have: for all blocks, or for none.
#[derive(Clone)]
struct Sheet<const P: usize, const C: usize> {
    blocks: Vec<Block<P, C>>,
    rolling: Vec<Rolling>,
    bounces: Vec<Bounce<P>>,
}

impl<const P: usize, const C: usize> Default for Sheet<P, C> {
    fn default() -> Self {
        Self { blocks: Vec::new(), rolling: Vec::new(), bounces: Vec::new() }
    }
}

/// Blocks that can be worked on in any order: one colour's.
#[derive(Clone, Debug)]
struct Stage {
    grounded: bool,
    ones: Range<usize>,
    fours: Range<usize>,
}

/// What is done to all contacts.
#[derive(Clone, Copy)]
pub(super) enum Pass {
    WarmStart,
    /// Pushes overlapping bodies apart, in substeps of so many seconds.
    Biased(Real),
    /// Takes out again the velocity that this gave, and adds friction.
    Relax(Real),
    NoteApproach,
    /// Lets bodies bounce that came together faster than so many metres a second.
    Rebound(Real),
}

/// Colours of each kind, and one more for contacts that are worked on by themselves.
const COLOURS: usize = Colour::ALONE as usize + 1;

impl Solver {
    /// Lays out contacts between rows of bodies.
    pub(super) fn lay_out(&mut self, contacts: &[Contact], rows: impl Fn(&Contact) -> [u32; 2], bodies: &SolverBodies) {
        self.colouring.colour(contacts.iter().map(&rows), bodies.first_unmoved());
        let kind = |index: usize| {
            let Colour { grounded, index: colour } = self.colouring.colours[index];
            // Those that are by themselves come first in either half, and count as of many points.
            let alone = colour == Colour::ALONE;
            let place = if alone { 0 } else { colour as usize + 1 };
            (usize::from(grounded) * COLOURS + place) * 2 + usize::from(alone || contacts[index].count() > 1)
        };
        let mut ends = [0; 4 * COLOURS];
        (0..contacts.len()).for_each(|index| ends[kind(index)] += 1);
        let mut sum = 0;
        for end in &mut ends {
            (*end, sum) = (sum, sum + *end);
        }
        self.order.clear();
        self.order.resize(contacts.len(), 0);
        for index in 0..contacts.len() {
            let place = &mut ends[kind(index)];
            self.order[*place] = index as u32;
            *place += 1;
        }
        let Self { order, ones, fours, stages, .. } = self;
        stages.clear();
        let (mut begin, mut one, mut four) = (0, 0, 0);
        for (index, kinds) in ends.chunks_exact(2).enumerate() {
            let [with_one, with_more] = [&order[begin..kinds[0]], &order[kinds[0]..kinds[1]]];
            begin = kinds[1];
            let grounded = index >= COLOURS;
            if index % COLOURS == 0 {
                for alone in with_more.chunks(1) {
                    let fours = fours.add(&mut four, alone, contacts, &rows, bodies.nobody());
                    stages.push(Stage { grounded, ones: one..one, fours });
                }
            } else if !(with_one.is_empty() && with_more.is_empty()) {
                let ones = ones.add(&mut one, with_one, contacts, &rows, bodies.nobody());
                let fours = fours.add(&mut four, with_more, contacts, &rows, bodies.nobody());
                stages.push(Stage { grounded, ones, fours });
            }
        }
        let (rolls, bounces) = (contacts.iter().any(Contact::rolls), contacts.iter().any(Contact::bounces));
        ones.finish(one, rolls, bounces);
        fours.finish(four, rolls, bounces);
    }

    /// Fills the blocks for bodies as they are.
    pub(super) fn prepare(&mut self, contacts: &[Contact], bodies: &SolverBodies, margin: Real) {
        let Self { ones, fours, stages, .. } = self;
        for stage in stages {
            let (ones, fours) = (ones.blocks(&stage.ones), fours.blocks(&stage.fours));
            if stage.grounded {
                dispatch_in_blocks(&mut Prepare::<1, 0, true> { blocks: ones, contacts, bodies, margin });
                dispatch_in_blocks(&mut Prepare::<4, 6, true> { blocks: fours, contacts, bodies, margin });
            } else {
                dispatch_in_blocks(&mut Prepare::<1, 0, false> { blocks: ones, contacts, bodies, margin });
                dispatch_in_blocks(&mut Prepare::<4, 6, false> { blocks: fours, contacts, bodies, margin });
            }
        }
    }

    /// Does to all contacts, colour by colour, what a pass does; those with what does not move have the last word.
    pub(super) fn run(&mut self, pass: Pass, bodies: &mut SolverBodies) {
        let Self { ones, fours, stages, .. } = self;
        for stage in stages {
            if stage.grounded {
                pass.run_on::<1, 0, true>(ones.blocks(&stage.ones), bodies);
                pass.run_on::<4, 6, true>(fours.blocks(&stage.fours), bodies);
            } else {
                pass.run_on::<1, 0, false>(ones.blocks(&stage.ones), bodies);
                pass.run_on::<4, 6, false>(fours.blocks(&stage.fours), bodies);
            }
        }
    }

    /// Whether any contact bounces.
    pub(super) fn bounces(&self) -> bool {
        !(self.ones.bounces.is_empty() && self.fours.bounces.is_empty())
    }

    /// Gives the impulses back to the contacts.
    pub(super) fn keep(&mut self, contacts: &mut [Contact]) {
        let Self { ones, fours, .. } = self;
        let (all_ones, all_fours) = (0..ones.blocks.len(), 0..fours.blocks.len());
        dispatch_in_blocks(&mut Keep { blocks: ones.blocks(&all_ones), contacts });
        dispatch_in_blocks(&mut Keep { blocks: fours.blocks(&all_fours), contacts });
    }
}

impl<const P: usize, const C: usize> Sheet<P, C> {
    /// Puts contacts in blocks from `next` on, which it moves past them; returns which blocks.
    fn add(
        &mut self,
        next: &mut usize,
        indices: &[u32],
        contacts: &[Contact],
        rows: &impl Fn(&Contact) -> [u32; 2],
        nobody: u32,
    ) -> Range<usize> {
        let begin = *next;
        for chunk in indices.chunks(BLOCK) {
            if self.blocks.len() == *next {
                self.blocks.push(Block::empty());
            }
            let block = &mut self.blocks[*next];
            *next += 1;
            block.rows = [[nobody; BLOCK]; 2];
            block.count = chunk.len();
            for (lane, index) in chunk.iter().enumerate() {
                block.contacts[lane] = *index;
                [block.rows[0][lane], block.rows[1][lane]] = rows(&contacts[*index as usize]);
            }
        }
        begin..*next
    }

    /// Drops the blocks from `count` on, and makes room for what only some contacts have.
    fn finish(&mut self, count: usize, rolls: bool, bounces: bool) {
        self.blocks.truncate(count);
        self.rolling.resize(if rolls { count } else { 0 }, Rolling::NONE);
        self.bounces.resize(if bounces { count } else { 0 }, Bounce::NONE);
    }

    fn blocks(&mut self, range: &Range<usize>) -> Blocks<'_, P, C> {
        Blocks {
            blocks: &mut self.blocks[range.clone()],
            rolling: self.rolling.get_mut(range.clone()).unwrap_or_default(),
            bounces: self.bounces.get_mut(range.clone()).unwrap_or_default(),
        }
    }
}

impl Pass {
    fn run_on<const P: usize, const C: usize, const GROUNDED: bool>(
        self,
        blocks: Blocks<'_, P, C>,
        bodies: &mut SolverBodies,
    ) {
        let SolverBodies { motion, response, moved, .. } = bodies;
        let rows = Rows { motion, response, moved };
        let softness = |h: Real| {
            if GROUNDED { Softness::on_ground(h.into()) } else { Softness::between_moving(h.into()) }
        };
        match self {
            Self::WarmStart => dispatch_in_blocks(&mut WarmStart::<P, C, GROUNDED> { blocks, rows }),
            Self::Biased(h) => {
                let (softness, inverse_h) = (softness(h), 1.0 / h);
                dispatch_in_blocks(&mut Solve::<P, C, GROUNDED, false> { blocks, rows, softness, inverse_h });
            }
            Self::Relax(h) => {
                let (softness, inverse_h) = (softness(h), 1.0 / h);
                dispatch_in_blocks(&mut Solve::<P, C, GROUNDED, true> { blocks, rows, softness, inverse_h });
            }
            Self::NoteApproach => dispatch_in_blocks(&mut NoteApproach::<P, C, GROUNDED> { blocks, rows }),
            Self::Rebound(threshold) => {
                dispatch_in_blocks(&mut Rebound::<P, C, GROUNDED> { blocks, rows, threshold });
            }
        }
    }
}
