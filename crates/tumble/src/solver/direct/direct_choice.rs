//! Which contacts are solved with the joints of a mechanism.
//!
//! Contacts of its bodies with what is not dynamic come first, then free bodies join it with
//! theirs: an impulse that a light body of it takes from a heavy free one, or through a light one
//! to the ground, is answered by all of them. The most loaded come first, as far as a budget goes.
//! A mechanism with more rows than that on the ground, or with more on other mechanisms than on the
//! ground, is in a heap: all its contacts are in passes. So are those of one that lies on many rows
//! under loads that passes carry. So are those of two of its own bodies: where joints keep what
//! overlaps from parting, the impulses that would part it have no bound, and in passes they are
//! those of the two bodies alone. And so are all contacts of a mechanism that kinematic bodies and
//! the ground press together, or that a hand presses against something: these contradict each
//! other.

use std::ops::Range;

use tumble_math::lane::Vec3;

use crate::collision::contact::ContactRecord;
use crate::math::{Real, double};
use crate::solver::direct::contact_problem::ContactShape;
use crate::solver::direct::direct_contacts::PUSHED;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::solver::substeps::GroupContact;

/// The most rows of a mechanism's direct contacts: their problem is dense.
const MAX_ROWS: usize = 64;
/// As few rows are direct whatever they carry.
const FEW_ROWS: usize = 24;
/// What comes nearer by less than this part of how fast it moves presses nothing together.
const PRESSES: f64 = 0.01;
/// What overlaps on opposite sides by more than this part of a body's least radius of gyration is
/// jammed: the impulses of direct contacts would be 1e4 times those that push it out.
const JAMMED: f64 = 1e-4;
/// How far the load of a body that lies presses it in passes, at most, of its least radius of
/// gyration.
const MAX_SAG: f64 = 0.1;

/// To which mechanism a body belongs: by its joints, with its number there, or because it has
/// joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Owner {
    pub(crate) mechanism: u32,
    pub(crate) body: Option<u32>,
}

impl Owner {
    /// In the place of a mechanism: of bodies whose joints are in passes.
    const IN_PASSES: u32 = u32::MAX;
}

/// Which contacts of a group have been chosen; its memory is kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct DirectChoice {
    /// By the solver's row.
    owners: Vec<Option<Owner>>,
    /// By row of a dynamic body where its contacts begin, and where the last ones end.
    begins: Vec<u32>,
    contacts_of: Vec<u32>,
    is_direct: Vec<bool>,
    /// The same by the number among all contacts.
    is_number_direct: Vec<bool>,
    /// Contacts of a mechanism of which it is open whether they are chosen.
    waiting: Vec<u32>,
    /// Those that are, as places in the group, in its order.
    pub(crate) chosen: Vec<u32>,
    /// Free bodies that have joined the mechanism.
    joined: Vec<SolverRow>,
}

/// What is not dynamic, where a body touches it.
#[derive(Clone, Copy)]
struct Obstacle {
    row: SolverRow,
    /// Unit vector away from it.
    normal: Vec3<f64>,
    /// Of its surface \[m/s\].
    velocity: Vec3<f64>,
    /// Of the body's least radius of gyration, negative where they are apart.
    overlap: f64,
}

impl Obstacle {
    /// Whether it comes nearer to what holds the body beyond, at this velocity.
    fn approaches(&self, velocity: Vec3<f64>) -> bool {
        let fast = self.velocity.dot(self.velocity).sqrt() + velocity.dot(velocity).sqrt();
        self.normal.dot(self.velocity - velocity) > PRESSES * fast
    }
}

/// The contacts of a group, and the bodies between which they are.
#[derive(Clone, Copy)]
pub(crate) struct Candidates<'a> {
    pub(crate) records: &'a [ContactRecord],
    pub(crate) contacts: &'a [GroupContact],
    pub(crate) bodies: &'a SolverBodies,
    /// The substep \[s\].
    pub(crate) h: f64,
}

impl<'a> Candidates<'a> {
    fn record(self, place: u32) -> &'a ContactRecord {
        &self.records[self.contacts[place as usize].number as usize]
    }

    /// The dynamic bodies of a contact.
    fn moving(self, place: u32) -> impl Iterator<Item = SolverRow> {
        let Self { contacts, bodies, .. } = self;
        contacts[place as usize].rows.into_iter().filter(move |row| bodies.is_dynamic(*row))
    }

    /// Along the normal, in the substep before \[N s\].
    fn load(self, place: u32) -> Real {
        self.record(place).normal_impulses.at_points.iter().sum()
    }

    /// What is not dynamic at a contact, if anything is not.
    fn obstacle(self, place: u32) -> Option<Obstacle> {
        let Self { contacts, bodies, .. } = self;
        let [row, to] = contacts[place as usize].rows;
        if bodies.is_dynamic(row) || !bodies.is_dynamic(to) {
            return None;
        }
        let (record, motion) = (self.record(place), &bodies.motion[row.index()]);
        let [linear, angular, normal, arm] =
            [motion.momentum, motion.angular_momentum, record.geometry.normal, bodies.center(to) - bodies.center(row)]
                .map(|v| Vec3::from(double(v)));
        let least = (0..record.count()).map(|j| record.separation(j)).fold(Real::MAX, Real::min);
        let radius = bodies.least_radius(to);
        let overlap = if radius > 0.0 { -f64::from(least) / radius } else { 0.0 };
        Some(Obstacle { row, normal, velocity: linear + angular.cross(arm), overlap })
    }

    /// How many rows a contact takes at most.
    fn rows(self, place: u32) -> usize {
        let record = self.record(place);
        let (points, rolling) = (record.count(), f64::from(record.geometry.rolling_resistance));
        let radius = if points > 1 { 1.0 } else { 0.0 };
        ContactShape { points, radius, rolling, ..ContactShape::default() }.rows()
    }
}

impl DirectChoice {
    /// Begins with no owners and no chosen contacts.
    pub(crate) fn begin(&mut self, of: Candidates<'_>) {
        let Self { owners, begins, contacts_of, is_direct, is_number_direct, .. } = self;
        owners.clear();
        owners.resize(of.bodies.len(), None);
        is_direct.clear();
        is_direct.resize(of.contacts.len(), false);
        is_number_direct.clear();
        is_number_direct.resize(of.records.len(), false);
        // Counts, then where each ends, from which filling in goes back to where it begins.
        begins.clear();
        begins.resize(of.bodies.first_non_dynamic() + 1, 0);
        let places = 0..of.contacts.len() as u32;
        places.clone().flat_map(|place| of.moving(place)).for_each(|row| begins[row.index()] += 1);
        let mut sum = 0;
        for begin in &mut *begins {
            sum += *begin;
            *begin = sum;
        }
        contacts_of.clear();
        contacts_of.resize(sum as usize, 0);
        for place in places.rev() {
            for row in of.moving(place) {
                let begin = &mut begins[row.index()];
                *begin -= 1;
                contacts_of[*begin as usize] = place;
            }
        }
    }

    /// Notes the rows of bodies whose joints are in passes: their contacts are as well.
    pub(crate) fn own_passed(&mut self, rows: impl Iterator<Item = SolverRow>) {
        let owner = Owner { mechanism: Owner::IN_PASSES, body: None };
        rows.for_each(|row| self.owners[row.index()] = Some(owner));
    }

    /// Notes the bodies of a mechanism that impulses move.
    pub(crate) fn own(&mut self, mechanism: u32, bodies: &[MechanismBody]) {
        for (body, of_body) in (0..).zip(bodies).filter(|(_, of_body)| of_body.is_moved()) {
            self.owners[of_body.row.index()] = Some(Owner { mechanism, body: Some(body) });
        }
    }

    pub(crate) fn owner(&self, row: SolverRow) -> Option<Owner> {
        self.owners[row.index()]
    }

    /// Whether the contact at a place of the group has been chosen.
    pub(crate) fn is_direct(&self, place: usize) -> bool {
        self.is_direct[place]
    }

    /// Whether the contact with this number among all has been chosen.
    pub(crate) fn is_number_direct(&self, number: u32) -> bool {
        self.is_number_direct[number as usize]
    }

    /// Chooses the contacts of a mechanism with these bodies.
    pub(crate) fn choose(&mut self, of: Candidates<'_>, mechanism: u32, bodies: &[MechanismBody]) {
        self.waiting.clear();
        self.chosen.clear();
        self.joined.clear();
        bodies.iter().filter(|body| body.is_moved()).for_each(|body| self.wait_for(body.row));
        self.waiting.sort_unstable();
        self.waiting.dedup();
        if self.is_in_heap(of, mechanism) || self.lies(of, mechanism, bodies) {
            return;
        }
        let mut left = MAX_ROWS;
        // What has all its bodies in the mechanism, then the next body that joins it.
        loop {
            self.waiting.sort_unstable_by(|a, b| of.load(*b).total_cmp(&of.load(*a)).then(a.cmp(b)));
            self.waiting.dedup();
            let mut waiting = std::mem::take(&mut self.waiting);
            waiting.retain(|place| match self.lacks(of, *place, mechanism) {
                Lack::Nothing => {
                    self.take(of, *place, &mut left);
                    false
                }
                Lack::Body(_) => true,
                Lack::Other => false,
            });
            self.waiting = waiting;
            if self.are_pressed(of, bodies) {
                self.give_back(of);
                return;
            }
            // The most loaded is the next.
            let next = self.waiting.first().filter(|place| of.rows(**place) <= left);
            let Some(Lack::Body(row)) = next.map(|place| self.lacks(of, *place, mechanism)) else { break };
            self.owners[row.index()] = Some(Owner { mechanism, body: None });
            self.joined.push(row);
            self.wait_for(row);
        }
        self.chosen.sort_unstable();
    }

    /// Whether chosen contacts, or one and a joint of the mechanism, press bodies together.
    fn are_pressed(&self, of: Candidates<'_>, bodies: &[MechanismBody]) -> bool {
        let obstacles = || self.chosen.iter().filter_map(|place| of.obstacle(*place));
        let held = || bodies.iter().filter(|body| !body.is_moved());
        obstacles().any(|it| {
            // What overlaps on one side only is not jammed, if it has room for being pushed out.
            let is_opposed = |other: Obstacle| {
                let is_jammed = it.overlap > JAMMED && other.overlap > -PUSHED * it.overlap;
                other.normal.dot(it.normal) < 0.0 && (is_jammed || other.row != it.row && it.approaches(other.velocity))
            };
            let is_held_by = |body: &MechanismBody| body.row != it.row && it.approaches(body.linear_velocity());
            obstacles().any(is_opposed) || held().any(is_held_by)
        })
    }

    /// Gives the chosen contacts and the bodies that joined back.
    fn give_back(&mut self, of: Candidates<'_>) {
        for place in self.chosen.drain(..) {
            self.is_direct[place as usize] = false;
            self.is_number_direct[of.contacts[place as usize].number as usize] = false;
        }
        self.joined.drain(..).for_each(|row| self.owners[row.index()] = None);
    }

    /// Whether a mechanism has more rows on the ground than the budget, or more on others.
    fn is_in_heap(&self, of: Candidates<'_>, mechanism: u32) -> bool {
        let (mut direct, mut others) = (0, 0);
        for place in &self.waiting {
            match self.lacks(of, *place, mechanism) {
                Lack::Nothing => direct += of.rows(*place),
                Lack::Other if self.is_between_mechanisms(of, *place) => others += of.rows(*place),
                Lack::Body(_) | Lack::Other => {}
            }
        }
        direct > MAX_ROWS || others > direct
    }

    /// Whether a mechanism lies on many rows, in which passes let none of its bodies sink by much.
    fn lies(&self, of: Candidates<'_>, mechanism: u32, bodies: &[MechanismBody]) -> bool {
        let mut rows = 0;
        for place in &self.waiting {
            match self.lacks(of, *place, mechanism) {
                Lack::Nothing => rows += of.rows(*place),
                Lack::Body(row) if self.sinks(of, row) => return false,
                Lack::Body(_) | Lack::Other => {}
            }
        }
        if rows <= FEW_ROWS {
            return false;
        }
        let (mut carrying, mut hanging) = (0.0, 0.0);
        for body in bodies.iter().filter(|body| body.is_moved()) {
            if self.sinks(of, body.row) {
                return false;
            }
            *if self.load_on(of, body.row) > 0.0 { &mut carrying } else { &mut hanging } += body.mass();
        }
        carrying >= hanging
    }

    /// Whether the load of a body would press it in noticeably, in passes.
    fn sinks(&self, of: Candidates<'_>, row: SolverRow) -> bool {
        let sag = self.load_on(of, row) * of.h / of.bodies.mass(row);
        sag > MAX_SAG * of.bodies.least_radius(row)
    }

    /// What the contacts of a body carry \[N s\].
    fn load_on(&self, of: Candidates<'_>, row: SolverRow) -> f64 {
        self.contacts_of[self.places(row)].iter().map(|place| f64::from(of.load(*place))).sum()
    }

    fn is_between_mechanisms(&self, of: Candidates<'_>, place: u32) -> bool {
        let [first, second] = of.contacts[place as usize].rows.map(|row| self.owner(row).map(|it| it.mechanism));
        first.is_some() && second.is_some() && first != second
    }

    /// Has the contacts of a body wait.
    fn wait_for(&mut self, row: SolverRow) {
        self.waiting.extend_from_slice(&self.contacts_of[self.places(row)]);
    }

    /// Where the contacts of a body are.
    fn places(&self, row: SolverRow) -> Range<usize> {
        self.begins[row.index()] as usize..self.begins[row.index() + 1] as usize
    }

    /// Chooses a contact if there is room for its rows.
    fn take(&mut self, of: Candidates<'_>, place: u32, left: &mut usize) {
        let rows = of.rows(place);
        if rows <= *left {
            *left -= rows;
            self.is_direct[place as usize] = true;
            self.is_number_direct[of.contacts[place as usize].number as usize] = true;
            self.chosen.push(place);
        }
    }

    /// What a contact lacks to be solved with a mechanism.
    fn lacks(&self, of: Candidates<'_>, place: u32, mechanism: u32) -> Lack {
        if of.record(place).is_of_meeting() || self.is_direct[place as usize] {
            return Lack::Other;
        }
        let (mut lack, mut jointed) = (Lack::Nothing, 0);
        for row in of.moving(place) {
            match self.owner(row) {
                Some(owner) if owner.mechanism == mechanism => jointed += usize::from(owner.body.is_some()),
                // Of another mechanism.
                Some(_) => return Lack::Other,
                None if of.bodies.locked.has(row) => return Lack::Other,
                None => lack = Lack::Body(row),
            }
        }
        if jointed < 2 { lack } else { Lack::Other }
    }
}

/// What a contact lacks to be solved with a mechanism.
#[derive(Clone, Copy)]
enum Lack {
    Nothing,
    /// That a free body joins.
    Body(SolverRow),
    /// It cannot be, or is already.
    Other,
}
