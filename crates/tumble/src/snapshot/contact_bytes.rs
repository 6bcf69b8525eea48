//! The contacts of a snapshot as bytes; see [`bytes`](crate::snapshot::bytes) for the format.

use crate::collision::body_key::BodyKey;
use crate::collision::saved_contacts::{SavedContact, SavedContacts, SavedPoint};
use crate::collision::sleep::ASLEEP;
use crate::components::BodyId;
use crate::joints::held_impulses::{HeldImpulse, MAX_ROWS};
use crate::math::Real;
use crate::snapshot::bytes::{NUMBER, Reader};
use crate::snapshot::error::ContactDefect;
use crate::snapshot::error::SnapshotError;
use crate::storage::body_index::Slot;

/// How far from one the length of a normal may be.
const UNIT_TOLERANCE: Real = 1e-3;
/// The most inertia that the load of joints asks for [kg m^2].
const MAX_LOAD: f64 = 1e300;
/// The longest that a body has been still \[s\].
const MAX_STILL: Real = 1e9;
/// The bit beside the number of points that says whether the bodies touched before.
const TOUCHED: u32 = 1 << 8;

/// How many there are of what a file has of contacts.
#[derive(Clone, Copy, Default)]
pub(crate) struct Counts {
    /// Bodies by [`BodyId`], and by entity.
    body_keys: [u64; 2],
    contacts: u64,
    points: u64,
    /// Joints in passes.
    held: u64,
}

impl Counts {
    fn of(body_keys: &[BodyKey], contacts: &[SavedContact], held: &[HeldImpulse]) -> Self {
        let ids = body_keys.iter().filter(|key| matches!(key, BodyKey::Id(_))).count();
        let points = contacts.iter().map(|contact| contact.count).sum::<usize>();
        Self {
            body_keys: [ids as u64, (body_keys.len() - ids) as u64],
            contacts: contacts.len() as u64,
            points: points as u64,
            held: held.len() as u64,
        }
    }

    pub(crate) fn read(reader: &mut Reader<'_>) -> Result<Self, SnapshotError> {
        let body_keys = [reader.u64()?, reader.u64()?];
        Ok(Self { body_keys, contacts: reader.u64()?, points: reader.u64()?, held: reader.u64()? })
    }

    /// How many bytes they take; `u64::MAX` where it is more.
    pub(crate) fn length(&self) -> u64 {
        let number = NUMBER as u64;
        let [ids, entities] = self.body_keys;
        let parts = [
            ids.saturating_mul(16 + 4 * number),
            entities.saturating_mul(12 + 4 * number),
            self.contacts.saturating_mul(16 + SavedContact::NUMBERS as u64 * number),
            self.points.saturating_mul(4 + SavedPoint::NUMBERS as u64 * number),
            self.held.saturating_mul(8 + MAX_ROWS as u64 * number),
        ];
        parts.into_iter().fold(0, u64::saturating_add)
    }
}

/// Contacts on their way into a file.
pub(crate) struct Written<'a> {
    saved: &'a SavedContacts,
    contacts: Vec<SavedContact>,
    pub(crate) counts: Counts,
}

impl<'a> Written<'a> {
    pub(crate) fn new(saved: &'a SavedContacts) -> Self {
        let contacts = saved.contacts();
        let counts = Counts::of(saved.body_keys(), &contacts, &saved.held);
        Self { saved, contacts, counts }
    }

    pub(crate) fn write_counts(&self, bytes: &mut Vec<u8>) {
        let Counts { body_keys: [ids, entities], contacts, points, held } = self.counts;
        bytes.extend([ids, entities, contacts, points, held].into_iter().flat_map(u64::to_le_bytes));
    }

    pub(crate) fn write(&self, bytes: &mut Vec<u8>) {
        for key in self.saved.body_keys() {
            match key {
                BodyKey::Id(id) => bytes.extend(id.0.to_le_bytes()),
                BodyKey::Entity(entity) => bytes.extend(entity.to_le_bytes()),
            }
        }
        bytes.extend(self.saved.centers().iter().flatten().flat_map(|number| number.to_le_bytes()));
        bytes.extend(self.saved.loads().iter().flat_map(|load| load.to_le_bytes()));
        bytes.extend(self.saved.still().iter().flat_map(|time| time.to_le_bytes()));
        for contact in &self.contacts {
            let [first, second] = contact.bodies;
            let points = contact.count as u32 | if contact.touched { TOUCHED } else { 0 };
            bytes.extend([first, second, contact.part, points].into_iter().flat_map(u32::to_le_bytes));
            bytes.extend(contact.numbers().into_iter().flat_map(Real::to_le_bytes));
        }
        for point in self.contacts.iter().flat_map(|contact| &contact.points[..contact.count]) {
            bytes.extend(point.feature.to_le_bytes());
            bytes.extend(point.numbers().into_iter().flat_map(Real::to_le_bytes));
        }
        for held in &self.saved.held {
            bytes.extend(held.slots.into_iter().flat_map(|slot| slot.0.to_le_bytes()));
            bytes.extend(held.impulses.into_iter().flat_map(Real::to_le_bytes));
        }
    }
}

/// Reads as many as are counted, which are known to be there, and checks that a step can have left
/// them.
pub(crate) fn read(reader: &mut Reader<'_>, counts: &Counts) -> Result<SavedContacts, SnapshotError> {
    let [ids, entities] = counts.body_keys.map(|count| count as usize);
    let mut body_keys = reader.many(ids, |reader| Ok(BodyKey::Id(BodyId(reader.u64()?))))?;
    body_keys.extend(reader.many(entities, |reader| Ok(BodyKey::Entity(reader.u32()?)))?);
    let centers = reader.many(body_keys.len(), Reader::numbers)?;
    let loads = reader.many(body_keys.len(), |reader| reader.u64().map(f64::from_bits))?;
    let still = reader.many(body_keys.len(), |reader| reader.numbers().map(|[time]| time))?;
    if let Some(pair) = body_keys.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(SnapshotError::ContactBody { body: pair + 1 });
    }
    if let Some(body) = centers.iter().position(|center| !center.iter().all(|number| number.is_finite())) {
        return Err(SnapshotError::ContactBody { body });
    }
    if let Some(body) = loads.iter().position(|load| !(0.0..=MAX_LOAD).contains(load)) {
        return Err(SnapshotError::JointLoad { body });
    }
    if let Some(body) = still.iter().position(|time| *time != ASLEEP && !(0.0..=MAX_STILL).contains(time)) {
        return Err(SnapshotError::Rest { body });
    }
    let mut contacts = reader.many(counts.contacts as usize, contact)?;
    if let Some(index) = contacts.iter().position(|contact| !(1..=contact.points.len()).contains(&contact.count)) {
        return Err(SnapshotError::Contact { contact: index, defect: ContactDefect::Points });
    }
    // One too many or too few is somewhere; where is unknown.
    if contacts.iter().map(|contact| contact.count as u64).sum::<u64>() != counts.points {
        let contact = contacts.len().saturating_sub(1);
        return Err(SnapshotError::Contact { contact, defect: ContactDefect::Points });
    }
    for contact in &mut contacts {
        for point in &mut contact.points[..contact.count] {
            *point = SavedPoint::new(reader.u32()?, reader.numbers()?);
        }
    }
    let mut before = None;
    for (index, contact) in contacts.iter().enumerate() {
        if let Some(defect) = defect(contact, before, body_keys.len()) {
            return Err(SnapshotError::Contact { contact: index, defect });
        }
        before = Some(contact);
    }
    let held = read_held(reader, counts.held as usize, body_keys.len())?;
    Ok(SavedContacts::new(body_keys, (centers, loads, still), &contacts, held))
}

/// Reads the impulses of joints in passes, in the order of their bodies, of this many bodies.
fn read_held(reader: &mut Reader<'_>, count: usize, bodies: usize) -> Result<Vec<HeldImpulse>, SnapshotError> {
    let one = |reader: &mut Reader<'_>| {
        let slots = [Slot(reader.u32()?), Slot(reader.u32()?)];
        Ok(HeldImpulse { slots, impulses: reader.numbers()? })
    };
    let held = reader.many(count, one)?;
    let is_sound = |held: &HeldImpulse| {
        let [first, second] = held.slots;
        first != second && first.max(second).index() < bodies && held.impulses.iter().all(|it| it.is_finite())
    };
    match held.iter().position(|held| !is_sound(held)) {
        Some(joint) => Err(SnapshotError::JointImpulse { joint }),
        None => match held.windows(2).position(|pair| pair[0].slots > pair[1].slots) {
            Some(pair) => Err(SnapshotError::JointImpulse { joint: pair + 1 }),
            None => Ok(held),
        },
    }
}

fn contact(reader: &mut Reader<'_>) -> Result<SavedContact, SnapshotError> {
    let (bodies, part, points) = ([reader.u32()?, reader.u32()?], reader.u32()?, reader.u32()?);
    let (touched, count) = (points & TOUCHED != 0, (points & !TOUCHED) as usize);
    Ok(SavedContact::new((bodies, part), touched, reader.numbers()?, count))
}

/// The defect, if any, of a contact that comes after another, with this many bodies.
fn defect(contact: &SavedContact, before: Option<&SavedContact>, bodies: usize) -> Option<ContactDefect> {
    let [first, second] = contact.bodies;
    let points = &contact.points[..contact.count];
    let numbers = || contact.numbers().into_iter().chain(points.iter().flat_map(SavedPoint::numbers));
    let length = contact.normal.dot(contact.normal).sqrt();
    if first == second || first.max(second) as usize >= bodies {
        Some(ContactDefect::Bodies)
    } else if before.is_some_and(|before| before.key() >= contact.key()) {
        Some(ContactDefect::Order)
    } else if !numbers().all(Real::is_finite) {
        Some(ContactDefect::NotFinite)
    } else if (length - 1.0).abs() > UNIT_TOLERANCE {
        Some(ContactDefect::Normal)
    } else if [contact.steady, contact.gap_share].iter().any(|part| !(0.0..=1.0).contains(part)) {
        Some(ContactDefect::Part)
    } else if !(0..=SavedContact::MAX_HALVINGS).any(|times| contact.halvings == Real::from(times)) {
        Some(ContactDefect::Halvings)
    } else if points.iter().any(|point| point.impulse < 0.0) {
        Some(ContactDefect::Pull)
    } else {
        None
    }
}
