//! Sleep: which bodies are left out of the steps, since when the others are still, and the contacts
//! of those that sleep.
//!
//! Whether a body wakes follows from the world as it is when a step begins, so nothing has to be
//! called where it is changed. What comes near a sleeping body fast wakes it within the step,
//! before contacts are solved.

use hecs::EntityRef;

use crate::collision::collider_state::ColliderState;
use crate::collision::contact::ContactRecord;
use crate::collision::islands::Islands;
use crate::collision::sleep_mask::SleepMask;
use crate::components::{GravityScale, Mass, Momentum, Pose, Velocity};
use crate::joints::axes::Axes;
use crate::math::Real;
use crate::settings::{Settings, Sleep};
use crate::storage::body_index::{Slot, by_new_slot};

/// The bodies of a world that sleep, kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sleepers {
    /// By slot; empty where the settings have no sleep.
    pub(crate) rests: Vec<Rest>,
    pub(crate) asleep: SleepMask,
    /// Contacts of sleeping bodies with each other and with what is not dynamic, by key.
    pub(crate) contacts: Vec<ContactRecord>,
    /// Those that the last step was taken with.
    pub(crate) settings: Option<Settings>,
    /// To be woken when the next step begins.
    pub(crate) disturbed: Vec<Slot>,
    /// Bodies of which the collider is another than in the last step.
    pub(crate) changed: Vec<Slot>,
    /// Whether bodies were put back since the last step.
    pub(crate) are_restored: bool,
    /// By number of the entity, the locked axes of bodies in the last step.
    pub(crate) locks: Vec<(u32, Axes)>,
    /// Bodies that move by themselves or were moved since the last step, and what was changed of
    /// them or is new; of dynamic ones those that were not.
    pub(crate) movers: Vec<Slot>,
    islands: Islands,
    /// Pairs of bodies with joints, which hang together beside contacts; memory, as what follows.
    pub(crate) links: Vec<[Slot; 2]>,
    pub(crate) awake: AwakeBodies,
    stays_awake: Vec<bool>,
    is_held: Vec<bool>,
    pub(crate) tired: Vec<Slot>,
}

/// By slot: which bodies are dynamic and awake, and which of these move at all.
#[derive(Clone, Debug, Default)]
pub(crate) struct AwakeBodies {
    pub(crate) is_dynamic: Vec<bool>,
    pub(crate) moves: Vec<bool>,
}

impl AwakeBodies {
    /// None of this many.
    pub(crate) fn reset(&mut self, count: usize) {
        for list in [&mut self.is_dynamic, &mut self.moves] {
            list.clear();
            list.resize(count, false);
        }
    }
}

/// A body as it was at the end of the last step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rest {
    /// `None` where nothing is known of the body.
    pub(crate) pose: Option<Pose>,
    /// How far it reaches from its centre of mass \[m\].
    pub(crate) radius: Real,
    /// Mass by scale of gravity of a dynamic body \[kg\].
    pub(crate) weight: Real,
    /// The momentum of a body that is just still \[kg m/s\], and the speed of its points [m/s].
    pub(crate) least_momentum: Real,
    pub(crate) least_speed: Real,
    /// For how long it has been still \[s\].
    pub(crate) still: Real,
    pub(crate) is_dynamic: bool,
}

impl Rest {
    pub(crate) const UNKNOWN: Self = Self {
        pose: None,
        radius: 0.0,
        weight: 0.0,
        least_momentum: 0.0,
        least_speed: 0.0,
        still: 0.0,
        is_dynamic: false,
    };
}

/// In the place of the time for which a body has been still, if it sleeps.
pub(crate) const ASLEEP: Real = -1.0;

impl Sleepers {
    /// Whether bodies may sleep.
    pub(crate) fn are_on(&self) -> bool {
        self.settings.is_some_and(|it| it.sleep.is_some())
    }

    /// Gives bodies the slots that they have now; `slots` are these by slot before.
    pub(crate) fn renumber(&mut self, slots: &[Slot], count: usize) {
        let to = |slot: &Slot| slots.get(slot.index()).copied().filter(|now| *now != Slot::NONE);
        if !self.rests.is_empty() {
            self.rests = by_new_slot(std::mem::take(&mut self.rests), slots, count, Rest::UNKNOWN);
        }
        self.asleep.renumber(slots, count);
        self.disturbed = self.disturbed.iter().filter_map(to).collect();
        self.changed.clear();
    }

    /// Puts back who slept, and for how long others have been still: by slot, [`ASLEEP`] of those.
    pub(crate) fn put_back(&mut self, still: &[Real]) {
        self.forget();
        if still.iter().all(|still| *still == 0.0) {
            return;
        }
        self.are_restored = true;
        self.rests.extend(still.iter().map(|still| Rest { still: still.max(0.0), ..Rest::UNKNOWN }));
        self.asleep.set(still.iter().map(|still| *still == ASLEEP));
    }

    /// Takes bodies that were put back for as they are in the world now.
    pub(crate) fn take_baseline<'a>(&mut self, body: impl Fn(Slot) -> Option<EntityRef<'a>>) {
        for (slot, rest) in (0..).map(Slot).zip(&mut self.rests) {
            let Some(body) = body(slot) else { continue };
            let scale = body.get::<&GravityScale>().map_or(1.0, |scale| scale.0);
            rest.pose = body.get::<&Pose>().map(|pose| *pose);
            rest.weight = body.get::<&Mass>().map_or(0.0, |mass| mass.kilograms() * scale);
            rest.is_dynamic = body.has::<Momentum>();
        }
    }

    /// Has all that sleep wake when the next step begins, and none of the others be still yet.
    pub(crate) fn disturb_all(&mut self) {
        let Self { asleep, disturbed, rests, .. } = self;
        disturbed.extend(asleep.slots());
        rests.iter_mut().for_each(|rest| rest.still = 0.0);
    }

    /// For how long a body has been still \[s\], or [`ASLEEP`].
    pub(crate) fn still(&self, slot: Slot) -> Real {
        if self.asleep.has(slot) { ASLEEP } else { self.rests.get(slot.index()).map_or(0.0, |rest| rest.still) }
    }

    /// None sleeps any more, and nothing is known; their contacts are with the others again.
    pub(crate) fn end(&mut self, contacts: &mut Vec<ContactRecord>) {
        move_contacts(&mut self.contacts, contacts, |_| true);
        self.forget();
    }

    /// None sleeps any more, and nothing is known.
    pub(crate) fn forget(&mut self) {
        self.rests.clear();
        self.asleep.clear();
        self.contacts.clear();
        self.settings = None;
        self.are_restored = false;
        self.disturbed.clear();
        self.changed.clear();
        self.locks.clear();
    }

    /// Wakes bodies, and all that sleep and hang together with them; their contacts come to the
    /// others. Returns those that slept, in order.
    pub(crate) fn wake(&mut self, disturbed: &[Slot], contacts: &mut Vec<ContactRecord>) -> Vec<Slot> {
        let Self { asleep, islands, contacts: of_sleepers, rests, links, .. } = self;
        if !disturbed.iter().any(|slot| asleep.has(*slot)) {
            return Vec::new();
        }
        let pairs = of_sleepers.iter().map(|contact| contact.slots).chain(links.iter().copied());
        islands.join(rests.len(), pairs, |slot| asleep.has(slot));
        let mut wakes = vec![false; rests.len()];
        for slot in disturbed.iter().filter(|slot| asleep.has(**slot)) {
            wakes[islands.root(*slot).index()] = true;
        }
        let woken: Vec<Slot> = asleep.slots().filter(|slot| wakes[islands.root(*slot).index()]).collect();
        asleep.remove_all(&woken);
        woken.iter().for_each(|slot| rests[slot.index()].still = 0.0);
        move_contacts(of_sleepers, contacts, |contact| !contact.slots.iter().any(|slot| asleep.has(*slot)));
        woken
    }

    /// Takes the contacts of which no body is awake: of sleeping bodies with each other and with
    /// those that are not dynamic.
    pub(crate) fn take_contacts(&mut self, contacts: &mut Vec<ContactRecord>) {
        let Self { asleep, awake, contacts: of_sleepers, .. } = self;
        if asleep.is_empty() {
            return;
        }
        move_contacts(contacts, of_sleepers, |contact| {
            let is_any_asleep = contact.slots.iter().any(|slot| asleep.has(*slot));
            is_any_asleep && !contact.slots.iter().any(|slot| awake.is_dynamic[slot.index()])
        });
    }

    /// Lists the bodies of islands of which all have been still for long enough, and that something
    /// holds or that neither move nor would fall, in order.
    pub(crate) fn find_tired(&mut self, contacts: &[ContactRecord], sleep: &Sleep, has_gravity: bool) {
        let Self { islands, rests, awake, stays_awake, is_held, tired, links, .. } = self;
        let is_awake = |slot: Slot| awake.is_dynamic[slot.index()];
        let pairs = contacts.iter().map(|contact| contact.slots).chain(links.iter().copied());
        islands.join(rests.len(), pairs, is_awake);
        for list in [&mut *stays_awake, &mut *is_held] {
            list.clear();
            list.resize(rests.len(), false);
        }
        let touching = contacts.iter().filter(|contact| contact.touches()).map(|contact| contact.slots);
        for [a, b] in touching.chain(links.iter().copied()) {
            for (slot, other) in [(a, b), (b, a)] {
                if is_awake(slot) && !is_awake(other) {
                    is_held[islands.root(slot).index()] = true;
                }
            }
        }
        let all = || (0..rests.len() as u32).map(Slot).filter(|slot| is_awake(*slot));
        for slot in all() {
            let root = islands.root(slot).index();
            let may_fall = has_gravity && rests[slot.index()].weight != 0.0;
            let drifts = (awake.moves[slot.index()] || may_fall) && !is_held[root];
            stays_awake[root] |= rests[slot.index()].still < sleep.time || drifts;
        }
        tired.clear();
        tired.extend(all().filter(|slot| !stays_awake[islands.root(*slot).index()]));
    }

    /// Adds the sleeping bodies that contacts disturb: a body in contact with them comes or slides
    /// faster than they may move.
    pub(crate) fn struck(
        &self,
        contacts: &[ContactRecord],
        states: &[ColliderState],
        ahead: Real,
        struck: &mut Vec<Slot>,
    ) {
        for contact in contacts {
            let Some(sleeper) = contact.slots.into_iter().find(|slot| self.asleep.has(*slot)) else { continue };
            let least = self.rests[sleeper.index()].least_speed;
            if contact.fastest_approach(contact.slots.map(|slot| &states[slot.index()]), ahead) > least {
                struck.push(sleeper);
            }
        }
    }
}

/// Moves contacts to another list, which is in order of their keys then.
fn move_contacts(from: &mut Vec<ContactRecord>, to: &mut Vec<ContactRecord>, goes: impl Fn(&ContactRecord) -> bool) {
    let before = to.len();
    to.extend(from.extract_if(.., |contact| goes(contact)));
    if to.len() > before {
        to.sort_by_key(ContactRecord::key);
    }
}

/// Whether a body that is not dynamic moves by itself.
pub(crate) fn moves(velocity: Option<&Velocity>) -> bool {
    velocity.is_some_and(|velocity| *velocity != Velocity::default())
}
