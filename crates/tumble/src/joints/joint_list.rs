//! The joints of a world, between slots.

use std::cmp::Ordering;

use hecs::{Archetype, Entity, World};

use crate::event_log::EventLog;
use crate::joints::breakable::Breakable;
use crate::joints::drives::Drive;
use crate::joints::gear::Gear;
use crate::joints::ignore_contacts::IgnoreContacts;
use crate::joints::joint::Joint;
use crate::joints::joint_event::JointEvent;
use crate::joints::joint_load::JointLoad;
use crate::joints::joint_marks::JointMark;
use crate::joints::joint_options::JointOptions;
use crate::math::Real;
use crate::storage::body_index::{BodyIndex, RowPlace, Slot};

/// A joint between slots.
#[derive(Clone, Debug)]
pub(crate) struct ListedJoint {
    pub(crate) slots: [Slot; 2],
    pub(crate) joint: Joint,
    entity: Entity,
    /// Where its components are.
    pub(crate) place: RowPlace,
    /// Whether it has a [`JointLoad`].
    pub(crate) has_load: bool,
    pub(crate) breakable: Option<Breakable>,
    /// Limits, drives and friction, where it has any.
    options: Option<u32>,
}

/// A gear between joints of the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ListedGear {
    /// Numbers in the list.
    pub(crate) joints: [u32; 2],
    /// Indices of their axes.
    pub(crate) axes: [usize; 2],
    pub(crate) ratio: f64,
    pub(crate) offset: f64,
    /// Of rotations that cannot go round, the middle of their range.
    pub(crate) middles: [Option<f64>; 2],
}

/// The joints of a world whose bodies are there, in the order of their slots.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointList {
    pub(crate) joints: Vec<ListedJoint>,
    /// Pairs of bodies that ignore each other, and their slots; memory.
    ignoring: Vec<[Entity; 2]>,
    ignored: Vec<[Slot; 2]>,
    /// Pairs of slots whose colliders do not touch, the lower first, in order.
    untouching: Vec<[Slot; 2]>,
    /// The same in the step before.
    untouching_before: Vec<[Slot; 2]>,
    /// Joints of which an end is gone, and those of the step before.
    endless: Vec<Entity>,
    endless_before: Vec<Entity>,
    /// Of the steps since they were forgotten.
    pub(crate) events: EventLog<JointEvent>,
    /// The gears of the world, and those between joints that are listed.
    all_gears: Vec<Gear>,
    pub(crate) gears: Vec<ListedGear>,
    /// By entity, the numbers of joints; memory.
    numbers: Vec<(Entity, u32)>,
    /// Memory: joints as they were found, and in which order they were listed last.
    found: Vec<ListedJoint>,
    order: Vec<u32>,
    /// Of the joints that have any, in the order in which they were found; more are memory.
    options: Vec<JointOptions>,
    /// Where the [`JointLoad`]s of joints are that are left out.
    pub(crate) idle_loads: Vec<RowPlace>,
}

/// The entities that joints of a world connect.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointEnds {
    /// By number of the entity.
    is_end: Vec<bool>,
}

impl JointEnds {
    pub(crate) fn find(&mut self, world: &World) {
        let is_end = &mut self.is_end;
        is_end.clear();
        for archetype in world.archetypes() {
            let Some(joints) = archetype.get::<&Joint>() else { continue };
            for end in joints.iter().flat_map(|joint| joint.bodies).filter(|end| world.contains(*end)) {
                let number = end.id() as usize;
                is_end.resize(is_end.len().max(number + 1), false);
                is_end[number] = true;
            }
        }
    }

    /// Whether an entity of an archetype is among them.
    pub(crate) fn connect_any_of(&self, archetype: &Archetype) -> bool {
        let is_end = |id: &u32| self.is_end.get(*id as usize).is_some_and(|is_end| *is_end);
        !self.is_end.is_empty() && archetype.ids().iter().any(is_end)
    }
}

impl JointList {
    /// Takes over the joints of a world; those that are broken, whose bodies are not there, or one
    /// and the same, or whose frames are out of range are left out.
    ///
    /// Returns whether they keep the same pairs apart as before.
    pub(crate) fn find(&mut self, world: &World, body_index: &BodyIndex) -> bool {
        let Self { found, options, endless, endless_before, idle_loads, .. } = self;
        found.clear();
        idle_loads.clear();
        let mut with_options = 0;
        std::mem::swap(endless, endless_before);
        endless_before.sort_unstable();
        endless.clear();
        // Goes through archetypes and rows in the same order.
        let mut with_joint = world.query::<Entity>().with::<&Joint>();
        let mut entities = with_joint.iter();
        for (index, archetype) in world.archetypes().enumerate() {
            let Some(column) = archetype.get::<&Joint>() else { continue };
            let has_load = archetype.has::<JointLoad>();
            let breakables = archetype.get::<&Breakable>();
            for (row, (joint, entity)) in column.iter().zip(&mut entities).enumerate() {
                let breakable = breakables.as_deref().map(|breakables| breakables[row]);
                let place = RowPlace { archetype: index as u32, row: row as u32 };
                if breakable.is_some_and(|breakable| breakable.is_broken) || !joint.is_in_range() {
                    idle_loads.extend(has_load.then_some(place));
                    continue;
                }
                // The index knows bodies by the number of their entity, which another may have now.
                let slot = |body: Entity| world.contains(body).then(|| body_index.slot(body.id())).flatten();
                let ends = joint.bodies.map(slot);
                if ends.contains(&None) {
                    endless.push(entity);
                }
                if let [Some(a), Some(b)] = ends
                    && a != b
                {
                    let joint = *joint;
                    let number = JointOptions::are_in(archetype).then_some(with_options);
                    if number.is_some() {
                        options.resize_with(options.len().max(with_options as usize + 1), JointOptions::default);
                        options[with_options as usize].take_row(archetype, row, joint.free);
                        with_options += 1;
                    }
                    let slots = [a, b];
                    found.push(ListedJoint { slots, joint, entity, place, has_load, breakable, options: number });
                } else {
                    idle_loads.extend(has_load.then_some(place));
                }
            }
        }
        self.list_found();
        IgnoreContacts::list(world, &mut self.ignoring);
        let slots = |[a, b]: &[Entity; 2]| Some([body_index.slot(a.id())?, body_index.slot(b.id())?]);
        self.ignored.clear();
        self.ignored.extend(self.ignoring.iter().filter_map(slots));
        self.all_gears.clear();
        self.all_gears.extend(world.query::<&Gear>().iter().filter(|gear| gear.is_in_range()));
        self.find_gears();
        let Self { endless, endless_before, .. } = self;
        let gone = endless.iter().filter(|joint| endless_before.binary_search(joint).is_err());
        self.events.extend(gone.map(|joint| JointEvent::EndIsGone(*joint)));
        self.find_untouching()
    }

    /// Lists the joints that were found, in order.
    fn list_found(&mut self) {
        let Self { joints, found, order, options, .. } = self;
        // It seldom changes.
        let of_number = |number: &u32| &found[*number as usize];
        let is_sorted = |order: &[u32]| order.is_sorted_by(|a, b| of_number(a).cmp(of_number(b), options).is_le());
        if order.len() != found.len() {
            order.clear();
            order.extend(0..found.len() as u32);
        }
        if !is_sorted(order) {
            order.sort_unstable_by(|a, b| of_number(a).cmp(of_number(b), options).then(a.cmp(b)));
        }
        joints.clear();
        joints.extend(order.iter().map(|number| of_number(number).clone()));
    }

    /// Takes out what is broken; returns whether the others keep the same pairs apart as before.
    pub(crate) fn leave_out_broken(&mut self) -> bool {
        let Self { joints, events, idle_loads, .. } = self;
        let is_broken = |joint: &ListedJoint| joint.breakable.is_some_and(|breakable| breakable.is_broken);
        events.extend(joints.iter().filter(|joint| is_broken(joint)).map(|joint| JointEvent::Broke(joint.entity)));
        idle_loads.extend(joints.iter().filter(|joint| joint.has_load && is_broken(joint)).map(|joint| joint.place));
        joints.retain(|joint| !is_broken(joint));
        self.find_gears();
        self.find_untouching()
    }

    /// Lists the gears between joints that are listed, in the order of these.
    fn find_gears(&mut self) {
        let Self { joints, options, all_gears, gears, numbers, .. } = self;
        gears.clear();
        if all_gears.is_empty() {
            return;
        }
        numbers.clear();
        numbers.extend((0..).zip(&*joints).map(|(number, joint)| (joint.entity, number)));
        numbers.sort_unstable();
        let number = |joint: Entity| {
            let place = numbers.binary_search_by_key(&joint, |(entity, _)| *entity).ok()?;
            Some(numbers[place].1)
        };
        for gear in &*all_gears {
            let [Some(first), Some(second)] = gear.joints.map(number) else { continue };
            let axis = |end: usize, number: u32| gear.axis(end, joints[number as usize].joint.free);
            if let (Some(a), Some(b)) = (axis(0, first), axis(1, second))
                && first != second
            {
                let (ratio, offset) = (f64::from(gear.ratio), f64::from(gear.offset));
                let middles = [(first, a), (second, b)].map(|(number, axis)| {
                    let options = &options[joints[number as usize].options? as usize];
                    let [min, max] = options.limits.axes[axis].filter(|_| axis >= 3)?.bounds_of_angle()?;
                    Some(0.5 * (min + max))
                });
                gears.push(ListedGear { joints: [first, second], axes: [a, b], ratio, offset, middles });
            }
        }
        let key = |gear: &ListedGear| (gear.joints, gear.axes, gear.ratio.to_bits(), gear.offset.to_bits());
        gears.sort_unstable_by_key(key);
    }

    fn find_untouching(&mut self) -> bool {
        let Self { joints, ignored, untouching, untouching_before, .. } = self;
        std::mem::swap(untouching, untouching_before);
        untouching.clear();
        let apart = joints.iter().filter(|it| !it.joint.contacts_enabled).map(|it| it.slots);
        untouching.extend(apart.chain(ignored.iter().copied()).map(|[a, b]| [a.min(b), a.max(b)]));
        untouching.sort_unstable();
        untouching.dedup();
        let same = untouching == untouching_before;
        // The next step takes it in place of the other.
        untouching_before.reserve_exact(untouching.capacity().saturating_sub(untouching_before.len()));
        same
    }

    /// The pairs of bodies that are kept apart in this step and were not in the last, or the
    /// other way round.
    pub(crate) fn changed_pairs(&self) -> impl Iterator<Item = [Slot; 2]> + '_ {
        let Self { untouching: now, untouching_before: before, .. } = self;
        let others = |of: &'_ Vec<[Slot; 2]>, known: &'_ Vec<[Slot; 2]>| {
            of.iter().copied().filter(|pair| known.binary_search(pair).is_err()).collect::<Vec<_>>()
        };
        others(now, before).into_iter().chain(others(before, now))
    }

    /// Limits, drives and friction of a joint, if it has any.
    pub(crate) fn options(&self, joint: &ListedJoint) -> Option<&JointOptions> {
        joint.options.map(|number| &self.options[number as usize])
    }

    /// The bodies of those with a drive that oscillates.
    pub(crate) fn oscillating(&self) -> impl Iterator<Item = [Slot; 2]> + '_ {
        let oscillates = |joint: &&ListedJoint| {
            self.options(joint).is_some_and(|options| options.drives.iter().any(Drive::oscillates))
        };
        self.joints.iter().filter(oscillates).map(|joint| joint.slots)
    }

    /// The bodies of each.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = [Slot; 2]> + '_ {
        self.joints.iter().map(|joint| joint.slots)
    }

    /// Pairs of bodies that hang together: by joints, and by gears between joints.
    pub(crate) fn links(&self) -> impl Iterator<Item = [Slot; 2]> + '_ {
        let of_gears = self.gears.iter().flat_map(|gear| {
            let [a, b] = gear.joints.map(|number| self.joints[number as usize].slots);
            [[a[0], b[0]], [a[0], b[1]], [a[1], b[0]], [a[1], b[1]]]
        });
        self.pairs().chain(of_gears)
    }

    /// Adds a mark for each joint: a number of all that it is and has.
    pub(crate) fn add_marks(&self, marks: &mut Vec<JointMark>) {
        marks.extend(self.joints.iter().map(|joint| {
            let breakable = joint.breakable.map_or([Real::NAN; 2], |it| [it.max_force, it.max_torque]);
            let bits = [u64::from(joint.joint.free.bits()), u64::from(joint.joint.contacts_enabled)];
            let mut mark = JointMark::new(joint.entity, joint.joint.bodies);
            mark.add(joint.frame_bits().into_iter().chain(bits).chain(breakable.map(|it| u64::from(it.to_bits()))));
            self.options(joint).into_iter().for_each(|options| mark.add(options.numbers()));
            mark
        }));
        for gear in &self.gears {
            let numbers = [gear.axes[0] as u64, gear.axes[1] as u64, gear.ratio.to_bits(), gear.offset.to_bits()];
            gear.joints.iter().for_each(|joint| marks[*joint as usize].add(numbers.into_iter()));
        }
    }

    pub(crate) fn clear(&mut self) {
        self.joints.clear();
        self.gears.clear();
        self.ignored.clear();
        self.untouching.clear();
        self.idle_loads.clear();
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }

    /// Whether a joint keeps the colliders of two bodies from touching, or they ignore each other.
    pub(crate) fn keeps_apart(&self, [a, b]: [Slot; 2]) -> bool {
        !self.untouching.is_empty() && self.untouching.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }
}

impl ListedJoint {
    /// The numbers of both frames.
    fn frame_bits(&self) -> [u64; 14] {
        let mut numbers = [0; 14];
        let of_frames = self.joint.frames.iter().flat_map(|frame| {
            let (p, q) = (frame.position, frame.orientation);
            [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
        });
        numbers.iter_mut().zip(of_frames).for_each(|(bits, number)| *bits = u64::from(number.to_bits()));
        numbers
    }

    /// Equal only for joints that do the same.
    fn cmp(&self, other: &Self, options: &[JointOptions]) -> Ordering {
        let by_slots = self.slots.cmp(&other.slots);
        by_slots
            .then_with(|| self.joint.free.bits().cmp(&other.joint.free.bits()))
            .then_with(|| self.frame_bits().cmp(&other.frame_bits()))
            .then_with(|| {
                let [a, b] = [self, other].map(|joint| joint.options.map(|number| &options[number as usize]));
                JointOptions::cmp(a, b)
            })
            .then_with(|| {
                let bits = |it: Breakable| [it.max_force, it.max_torque].map(Real::to_bits);
                self.breakable.map(bits).cmp(&other.breakable.map(bits))
            })
    }
}
