//! The mechanisms of a world: which bodies hang together, from step to step.

use rayon::prelude::*;
use tumble_math::lane::Vec3;

use crate::collision::contact::ContactRecord;
use crate::collision::contact_set::ContactSet;
use crate::collision::islands::Islands;
use crate::collision::sleep_mask::SleepMask;
use crate::joint_solver::JointSolver;
use crate::joints::axes::Axes;
use crate::joints::axis_lock::AxisLock;
use crate::joints::joint_list::{JointList, ListedGear, ListedJoint};
use crate::joints::joint_load::JointLoad;
use crate::math::{Real, real, vec3};
use crate::range::{MAX_DISTANCE_OF_CONTACTS, MAX_SPEED, is_rotation, within};
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::solver::contact_work::ContactWorks;
use crate::solver::direct::direct_choice::DirectChoice;
use crate::solver::direct::direct_contacts::DirectContacts;
use crate::solver::joint_passes::pass_stages::JointPasses;
use crate::solver::mechanism::fours::{row, vector};
use crate::solver::mechanism::free_axis::free_axis_bits;
use crate::solver::mechanism::gear_rows::GearRows;
use crate::solver::mechanism::joint_anchor::anchor;
use crate::solver::mechanism::joint_rows::{Anchor, JointRows, length};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::MechanismSolver;
use crate::solver::mechanism::passed_joints::PassedJoints;
use crate::solver::solver_bodies::SolverBodies;
use crate::storage::body_index::{BodyIndex, Slot, by_new_slot};
use crate::storage::world_columns::{ArchetypeBodies, WorldColumns};
use crate::threads::InParts;

/// The joints of a world, and what is kept of them from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mechanisms {
    pub(crate) list: JointList,
    /// By slot: inertia that the load of the last substep asks for [kg m^2]. It is state.
    pub(crate) loads: Vec<f64>,
    /// The joints that act in this substep, as numbers in the list.
    pub(super) active: Vec<u32>,
    pub(super) mechanisms: Vec<Mechanism>,
    /// What the mechanisms were made for.
    structure: Vec<Link>,
    gear_structure: Vec<GearLink>,
    lock_structure: Vec<LockLink>,
    /// The gears that act, with numbers of active joints.
    gears: Vec<ListedGear>,
    /// By number in the list: impulse and angular impulse in this step [N s] [N m s].
    pub(super) done: Vec<[Vec3<f64>; 2]>,
    /// By number in the list.
    pub(super) values_and_speeds: Vec<[[f64; 6]; 2]>,
    islands: Islands,
    /// Which contacts are solved with joints.
    pub(super) choice: DirectChoice,
    /// By slot, whether a contact acts on the body.
    pub(super) is_touched: Vec<bool>,
    /// The joints that are solved in passes.
    pub(crate) passed: PassedJoints,
}

/// Bodies that hang together.
#[derive(Clone, Debug)]
pub(super) struct Mechanism {
    pub(super) solver: MechanismSolver,
    pub(super) slots: Vec<Slot>,
    /// In the order of the solver's, as numbers of active joints and, past these, of gears and of
    /// locks.
    joints: Vec<u32>,
    /// Those of its bodies that have locked axes. For each the solver has, past these bodies, one
    /// that does not move.
    locked: Vec<LockedEnd>,
    /// The contacts that are solved with the joints.
    pub(super) direct: DirectContacts,
    /// Whether all its numbers are finite.
    pub(super) is_sound: bool,
}

/// A body of a mechanism whose axes are locked: by rows between it and the ground.
#[derive(Clone, Copy, Debug)]
struct LockedEnd {
    /// Among those of the mechanism.
    body: usize,
    lock: AxisLock,
}

/// A joint as the structure of a mechanism depends on it: its bodies, which of them are dynamic,
/// its free axes, and along which of these anything acts.
type Link = ([Slot; 2], [bool; 2], Axes, u16);

/// A gear in the same way: numbers of active joints, and their axes.
type GearLink = ([u32; 2], [usize; 2]);

/// A body with locked axes, in the same way.
type LockLink = (Slot, Axes);

impl Mechanisms {
    /// Forgets all joints and loads.
    pub(crate) fn forget(&mut self) {
        self.list.clear();
        self.loads.clear();
        self.passed.held.clear();
    }

    /// The bodies of the joints that can act, by slot.
    pub(crate) fn pairs<'a>(
        &'a self,
        body_index: &'a BodyIndex,
        columns: &'a WorldColumns<'_>,
        sleepers: &'a SleepMask,
    ) -> impl Iterator<Item = [Slot; 2]> + 'a {
        // All bodies of a mechanism sleep, or none.
        let acts = move |slot: &Slot| !sleepers.has(*slot) && is_in_range(body_index, columns, *slot);
        self.list.pairs().filter(move |slots| slots.iter().all(acts))
    }

    /// Gives the loads the slots that their bodies have now; `slots` are these by slot before.
    pub(crate) fn renumber(&mut self, slots: &[Slot], count: usize) {
        self.loads = by_new_slot(std::mem::take(&mut self.loads), slots, count, 0.0);
        self.passed.held.renumber(slots);
    }

    /// To be called before the first substep of every step.
    pub(crate) fn begin_step(&mut self) {
        self.done.clear();
        self.done.resize(self.list.joints.len(), [Vec3::zero(); 2]);
        self.values_and_speeds.clear();
        self.values_and_speeds.resize(self.list.joints.len(), [[0.0; 6]; 2]);
        self.mechanisms.iter_mut().for_each(|mechanism| mechanism.solver.parts = 0);
    }

    /// Finds the mechanisms of the joints whose bodies are in range: gathered into rows, of which
    /// they read the state, and their drives in the middle of the step \[s\]. Which of them are
    /// touched follows from the contacts. Joints in passes are added to these.
    pub(crate) fn gather(
        &mut self,
        (constrained, contacts): (&ConstrainedBodies, &ContactSet),
        body_index: &BodyIndex,
        columns: &WorldColumns<'_>,
        bodies: &SolverBodies,
        (solver, passes): (JointSolver, &mut JointPasses),
        middle: f64,
    ) {
        if self.list.is_empty() {
            self.loads.clear();
            self.mechanisms.clear();
            self.passed.clear();
            self.structure.clear();
            self.gear_structure.clear();
            self.lock_structure.clear();
            return;
        }
        self.loads.resize(body_index.len(), 0.0);
        let Self { list, active, .. } = self;
        active.clear();
        let acts = |joint: &ListedJoint| {
            joint.slots.into_iter().all(|slot| constrained.contains(slot) && is_in_range(body_index, columns, slot))
        };
        let moves = |slot: &Slot| constrained.row(*slot).is_some_and(|row| bodies.is_dynamic(row));
        let numbered = (0..).zip(&list.joints);
        active.extend(
            numbered.filter(|(_, joint)| joint.slots.iter().any(moves) && acts(joint)).map(|(number, _)| number),
        );
        let links = active.iter().map(|number| {
            let joint = &list.joints[*number as usize];
            let free = joint.joint.free;
            let bits = free_axis_bits(list.options(joint), free);
            (joint.slots, joint.slots.each_ref().map(moves), free, bits)
        });
        let is_active = |number: u32| active.binary_search(&number).ok().map(|place| place as u32);
        self.gears.clear();
        self.gears.extend(list.gears.iter().filter_map(|gear| {
            let [first, second] = gear.joints.map(is_active);
            Some(ListedGear { joints: [first?, second?], ..*gear })
        }));
        let gear_links = self.gears.iter().map(|gear| (gear.joints, gear.axes));
        let locked = constrained.jointed_locks().filter(|(_, row, _)| bodies.is_dynamic(*row));
        let lock_links = locked.map(|(slot, _, lock)| (slot, lock.0));
        let is_same = gear_links.clone().eq(self.gear_structure.iter().copied())
            && lock_links.clone().eq(self.lock_structure.iter().copied());
        if !(is_same && self.passed.solver == solver && links.clone().eq(self.structure.iter().copied())) {
            self.passed.solver = solver;
            self.structure = links.collect();
            self.gear_structure = gear_links.collect();
            self.lock_structure = lock_links.collect();
            self.arrange(body_index.len());
        }
        self.note_touched((constrained, contacts), bodies);
        self.add_passed(constrained, body_index, columns, bodies, passes);
        self.read(constrained, body_index, columns, bodies, middle);
    }

    /// Notes on which bodies contacts act.
    fn note_touched(&mut self, (constrained, contacts): (&ConstrainedBodies, &ContactSet), bodies: &SolverBodies) {
        let moves = |slot: &Slot| constrained.row(*slot).is_some_and(|row| bodies.is_dynamic(row));
        self.is_touched.clear();
        self.is_touched.resize(self.loads.len(), false);
        for slot in contacts.records.iter().flat_map(|contact| contact.slots).filter(moves) {
            self.is_touched[slot.index()] = true;
        }
    }

    /// Locks axes of bodies that have joints: by rows of their mechanisms, which are gathered, or
    /// where no joint acts, as of any body.
    pub(crate) fn lock(&self, constrained: &ConstrainedBodies, bodies: &mut SolverBodies) {
        let of_mechanism = |it: &Mechanism| it.locked.iter().map(|end| it.slots[end.body]).collect::<Vec<_>>();
        let mut held: Vec<Slot> = self.mechanisms.iter().flat_map(of_mechanism).collect();
        held.sort_unstable();
        let is_held = |slot: Slot| held.binary_search(&slot).is_ok();
        let locks = |by_rows: bool| {
            let locks = constrained.jointed_locks().filter(move |(slot, ..)| is_held(*slot) == by_rows);
            locks.map(|(_, row, lock)| (row, lock))
        };
        bodies.lock_in_mechanisms(locks(true));
        bodies.lock(locks(false));
    }

    /// Reads the bodies of mechanisms, where their joints act, and which are touched.
    fn read(
        &mut self,
        constrained: &ConstrainedBodies,
        body_index: &BodyIndex,
        columns: &WorldColumns<'_>,
        bodies: &SolverBodies,
        middle: f64,
    ) {
        let Self { list, loads, mechanisms, active, is_touched, gears, .. } = self;
        for mechanism in mechanisms {
            mechanism.solver.is_touched = mechanism.slots.iter().any(|slot| is_touched[slot.index()]);
            mechanism.solver.bodies.clear();
            for slot in &mechanism.slots {
                let Some(row) = constrained.row(*slot) else { continue };
                mechanism.solver.bodies.push(MechanismBody::read(bodies, row, loads[slot.index()]));
            }
            mechanism.read_locks();
            for (rows, number) in mechanism.solver.joints.iter_mut().zip(&mechanism.joints) {
                if let Some(of_gear) = &mut rows.gear {
                    let gear = &gears[*number as usize - active.len()];
                    of_gear.take_numbers(gear);
                    for (rows, number) in of_gear.joints.iter_mut().zip(gear.joints) {
                        let listed = &list.joints[active[number as usize] as usize];
                        rows.anchors = [0, 1].map(|end| anchor(listed, end, body_index, columns));
                    }
                    continue;
                }
                let Some(number) = active.get(*number as usize) else { continue };
                let listed = &list.joints[*number as usize];
                rows.anchors = [0, 1].map(|end| anchor(listed, end, body_index, columns));
                list.options(listed).into_iter().for_each(|options| rows.take_options(options, middle));
            }
        }
        // Bodies without joints have none; those that sleep keep what they fell asleep with.
        let awake = loads.iter_mut().enumerate().filter(|(slot, _)| !constrained.sleepers.has(Slot(*slot as u32)));
        awake.for_each(|(_, load)| *load = 0.0);
    }

    /// By slot, which bodies impulses move; and joints and gears in the order of their
    /// mechanisms, of which one body stands for each.
    fn joints_by_root(&mut self, slots: usize) -> (Vec<bool>, Vec<(Slot, u32)>) {
        let Self { structure, islands, gears, .. } = self;
        let mut dynamic = vec![false; slots];
        for (of_link, moves, ..) in &*structure {
            (0..2).for_each(|end| dynamic[of_link[end].index()] = moves[end]);
        }
        let moving = |number: u32| {
            let [a, b] = structure[number as usize].0;
            if dynamic[a.index()] { a } else { b }
        };
        let geared = gears.iter().map(|gear| gear.joints.map(moving));
        let pairs = structure.iter().map(|(slots, ..)| *slots).chain(geared);
        islands.join(slots, pairs, |slot| dynamic[slot.index()]);
        let of_gears = gears.iter().map(|gear| gear.joints[0]);
        let mut by_root: Vec<(Slot, u32)> = Vec::new();
        for (number, joint) in (0..).zip((0..structure.len() as u32).chain(of_gears)) {
            by_root.push((islands.root(moving(joint)), number));
        }
        by_root.sort_unstable();
        (dynamic, by_root)
    }

    /// Makes mechanisms of the structure.
    fn arrange(&mut self, slots: usize) {
        let (dynamic, by_root) = self.joints_by_root(slots);
        let Self { structure, lock_structure, mechanisms, list, active, gears, passed, .. } = self;
        mechanisms.clear();
        passed.numbers.clear();
        passed.mechanisms.clear();
        for links in by_root.chunk_by(|a, b| a.0 == b.0) {
            let of_links = links.iter().filter_map(|(_, number)| structure.get(*number as usize));
            let mut of_it: Vec<Slot> = of_links.flat_map(|link| link.0).collect();
            of_it.sort_unstable();
            of_it.dedup();
            let rows_of = |number: u32| {
                let (slots, _, free, _) = structure[number as usize];
                let bodies = slots.map(|slot| of_it.binary_search(&slot).unwrap_or(0));
                let options = list.options(&list.joints[active[number as usize] as usize]);
                (bodies, free, options)
            };
            let plain = |(bodies, free, _)| JointRows::new(bodies, [Anchor::CENTER; 2], free, None);
            let mut numbers: Vec<_> = links.iter().map(|(_, number)| *number).collect();
            let mut joints: Vec<_> = links
                .iter()
                .map(|(_, number)| match (*number as usize).checked_sub(structure.len()) {
                    Some(gear) => {
                        let joints = gears[gear].joints.map(|number| plain(rows_of(number)));
                        JointRows::of_gear(GearRows::new(joints, &gears[gear]))
                    }
                    None => {
                        let (bodies, free, options) = rows_of(*number);
                        JointRows::new(bodies, [Anchor::CENTER; 2], free, options)
                    }
                })
                .collect();
            let mut moves: Vec<_> = of_it.iter().map(|slot| dynamic[slot.index()]).collect();
            let mut locked = Vec::new();
            for (number, (slot, axes)) in (0..).zip(&*lock_structure) {
                let Ok(body) = of_it.binary_search(slot) else { continue };
                numbers.push((structure.len() + gears.len()) as u32 + number);
                joints.push(JointRows::new([moves.len(), body], [Anchor::CENTER; 2], axes.others(), None));
                moves.push(false);
                locked.push(LockedEnd { body, lock: AxisLock(*axes) });
            }
            let Some((mut solver, order)) = passed.direct(&joints, &moves, locked.is_empty()) else {
                passed.numbers.extend(&numbers);
                passed.mechanisms.push(of_it);
                continue;
            };
            solver.ground(locked.iter().map(|it| it.lock));
            let joints = order.iter().map(|place| numbers[*place as usize]).collect();
            mechanisms.push(Mechanism::new(solver, of_it, joints, locked));
        }
        passed.numbers.sort_unstable();
    }

    /// Advances the mechanisms that nothing touches by substeps of `h` \[s\].
    pub(crate) fn advance_untouched(&mut self, substeps: u32, h: Real) {
        let untouched = |mechanism: &&mut Mechanism| !mechanism.solver.is_touched;
        let advance = |mechanism: &mut Mechanism| {
            mechanism.is_sound = mechanism.solver.advance(substeps, f64::from(h));
        };
        self.mechanisms.par_iter_mut().by_at_least(1).filter(untouched).for_each(advance);
    }

    /// In how many parts mechanisms that nothing touches have been solved in this step.
    pub(crate) fn parts(&self) -> u64 {
        self.mechanisms.iter().map(|mechanism| u64::from(mechanism.solver.parts)).sum()
    }

    /// How many dynamic bodies belong to mechanisms that have been advanced already.
    pub(crate) fn advanced(&self) -> usize {
        let advanced = self.mechanisms.iter().filter(|mechanism| !mechanism.solver.is_touched && mechanism.is_sound);
        advanced.flat_map(|mechanism| &mechanism.solver.bodies).filter(|body| body.is_moved()).count()
    }

    /// Whether any contact acts on a mechanism.
    pub(crate) fn are_touched(&self) -> bool {
        self.mechanisms.iter().any(|mechanism| mechanism.solver.is_touched)
    }

    /// Takes back the halvings of contacts in islands with mechanisms, which have the substeps of
    /// the settings.
    pub(crate) fn keep_whole(
        &mut self,
        contacts: &[ContactRecord],
        constrained: &ConstrainedBodies,
        bodies: &SolverBodies,
        halvings: &mut [u8],
    ) {
        if halvings.iter().all(|times| *times == 0) {
            return;
        }
        let Self { list, mechanisms, islands, loads, passed, active, .. } = self;
        let moves = |slot: Slot| constrained.row(slot).is_some_and(|row| bodies.is_dynamic(row));
        let pairs = contacts.iter().map(|contact| contact.slots).chain(list.pairs());
        islands.join(loads.len(), pairs, moves);
        let mut has_joints = vec![false; loads.len()];
        let in_passes = passed.numbers.iter().flat_map(|number| list.joints[active[*number as usize] as usize].slots);
        let direct = mechanisms.iter().flat_map(|mechanism| mechanism.slots.iter().copied());
        for slot in direct.chain(in_passes).filter(|slot| moves(*slot)) {
            has_joints[islands.root(slot).index()] = true;
        }
        for (contact, times) in contacts.iter().zip(halvings) {
            let [a, b] = contact.slots;
            let moving = if moves(a) { a } else { b };
            if has_joints[islands.root(moving).index()] {
                *times = 0;
            }
        }
    }

    /// Notes the loads, what joints have done, and how they stand, and writes the bodies of
    /// mechanisms that nothing touches to their rows.
    pub(crate) fn write(&mut self, bodies: &mut SolverBodies, works: &mut ContactWorks) {
        let are_touched = self.are_touched();
        if are_touched {
            works.after_substep(bodies);
            works.before_joints(bodies);
        }
        let Self { list, mechanisms, loads, active, done, values_and_speeds, .. } = self;
        for Mechanism { solver, slots, joints, locked, is_sound, .. } in mechanisms {
            if !*is_sound {
                // Its bodies have moved as if they had no joints.
                slots.iter().for_each(|slot| loads[slot.index()] = 0.0);
                solver.forget_impulses();
                continue;
            }
            for (slot, body) in slots.iter().zip(&mut solver.bodies) {
                loads[slot.index()] = body.load();
                if solver.is_touched {
                    body.write_own_momentum(bodies);
                } else {
                    body.write(bodies);
                    works.leave_to_joints(body.row, body.damping_work());
                }
            }
            locked.iter().for_each(|it| solver.bodies[it.body].hold(it.lock, bodies));
            for ((rows, done_here), number) in solver.joints.iter().zip(&mut solver.done).zip(&*joints) {
                let Some(number) = active.get(*number as usize) else { continue };
                let number = *number as usize;
                let [impulse, angular] = std::mem::take(done_here).map(|row| vector(&row));
                done[number] = [done[number][0] + impulse, done[number][1] + angular];
                if list.joints[number].has_load {
                    values_and_speeds[number] = rows.values_and_speeds(&solver.bodies);
                }
            }
        }
        if are_touched {
            works.after_joints(bodies);
        }
    }

    /// Marks the joints that broke in a step of `dt` \[s\]; returns whether there are any.
    pub(crate) fn mark_broken(&mut self, dt: Real) -> bool {
        let mut is_any = false;
        for (joint, done) in self.list.joints.iter_mut().zip(&self.done) {
            if let Some(breakable) = &mut joint.breakable {
                let [force, torque] = done.map(|sum| real(length(sum) / f64::from(dt)));
                breakable.is_broken = force > breakable.max_force || torque > breakable.max_torque;
                is_any |= breakable.is_broken;
            }
        }
        is_any
    }

    /// The load of each joint that has a [`JointLoad`], and where that is, over a step of `dt`
    /// \[s\].
    pub(crate) fn joint_loads(&self, dt: Real) -> impl Iterator<Item = (&ListedJoint, JointLoad)> + '_ {
        let with_load = self.list.joints.iter().enumerate().filter(|(_, joint)| joint.has_load);
        with_load.map(move |(number, joint)| {
            let [force, torque] = self.done[number].map(|sum| vec3(glam::DVec3::from(sum) / f64::from(dt)));
            let [values, speeds] = self.values_and_speeds[number].map(|numbers| numbers.map(real));
            (joint, JointLoad { force, torque, values, speeds })
        })
    }
}

impl Mechanism {
    fn new(solver: MechanismSolver, slots: Vec<Slot>, joints: Vec<u32>, locked: Vec<LockedEnd>) -> Self {
        let direct = DirectContacts::default();
        Self { solver, slots, joints, locked, direct, is_sound: true }
    }

    /// Has the rows of locked axes begin where the bodies are, along the axes of the world.
    fn read_locks(&mut self) {
        let Self { solver, slots, locked, .. } = self;
        for LockedEnd { body, .. } in &*locked {
            let ground = MechanismBody::ground_at(&solver.bodies[*body]);
            solver.bodies.push(ground);
        }
        for rows in solver.joints.iter_mut().filter(|rows| rows.bodies[0] >= slots.len()) {
            let orientation = solver.bodies[rows.bodies[1]].orientation().conjugate();
            rows.anchors = [Anchor::CENTER, Anchor { orientation: row(orientation), ..Anchor::CENTER }];
        }
    }
}

/// Whether a body can have joints, but for what forces do to a dynamic one.
fn is_in_range(body_index: &BodyIndex, columns: &WorldColumns<'_>, slot: Slot) -> bool {
    let place = body_index.place(slot);
    let row = place.row as usize;
    match columns.bodies(place) {
        ArchetypeBodies::Dynamic(_) => true,
        ArchetypeBodies::NonDynamic(columns) => {
            let (pose, velocity) = (columns.pose[row], columns.velocity(row));
            within(pose.position.into(), MAX_DISTANCE_OF_CONTACTS)
                && is_rotation(pose.orientation.into())
                && [velocity.linear, velocity.angular].into_iter().all(|it| within(it.into(), MAX_SPEED))
        }
        ArchetypeBodies::None => false,
    }
}
