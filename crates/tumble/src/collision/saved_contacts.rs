//! Contacts apart from the world that they were found in.

use tumble_collide::MAX_MANIFOLD_POINTS;
use tumble_math::lane::Vec3;

use crate::collision::body_key::BodyKey;
use crate::collision::contact::{ContactRecord, MAX_HALVINGS};
use crate::collision::contact_rows::WorldFriction;
use crate::joints::held_impulses::HeldImpulse;
use crate::math::Real;
use crate::storage::body_index::Slot;

/// Contacts, and loads and impulses of joints, as the last step left them, between
/// bodies by their keys: what a step begins with beside the bodies, and what is reported of
/// contacts.
///
/// Forces, materials and colors are recomputed in every step.
#[derive(Clone, Debug, Default)]
pub(crate) struct SavedContacts {
    /// Of the bodies that have contacts or loads, or are still, in order, no two the same.
    pub(crate) body_keys: Vec<BodyKey>,
    /// Where their centres of mass were when the step began \[m\], one for each key.
    pub(crate) centers: Vec<[Real; 3]>,
    /// How much inertia the loads of joints ask for, one for each key [kg m^2].
    pub(crate) loads: Vec<f64>,
    /// For how long they have been still \[s\], one for each key; of those that sleep
    /// [`ASLEEP`](crate::collision::sleep::ASLEEP).
    pub(crate) still: Vec<Real>,
    /// Whose slots are places among the keys.
    pub(crate) contacts: Vec<ContactRecord>,
    /// The same of joints in passes.
    pub(crate) held: Vec<HeldImpulse>,
    /// By slot, the place among the keys.
    pub(crate) places: Vec<Slot>,
}

/// A contact as a file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SavedContact {
    /// The bodies, as places among the keys.
    pub(crate) bodies: [u32; 2],
    /// Which of the contacts of the two.
    pub(crate) part: u32,
    /// Whether they touched before this step.
    pub(crate) touched: bool,
    /// From the first body to the second.
    pub(crate) normal: Vec3<Real>,
    /// Impulse \[N s\] and angular impulse [N m s] of friction.
    pub(crate) friction: [Vec3<Real>; 2],
    /// As [`NormalImpulses`](crate::collision::contact_rows::NormalImpulses) has them.
    pub(crate) steady: Real,
    pub(crate) gap_share: Real,
    /// As [`WorldFriction`] has them.
    pub(crate) margin: Real,
    pub(crate) halvings: Real,
    /// How fast they came together, and the impulse along the normal over the step \[m/s\] \[N s\].
    pub(crate) closing_speed: Real,
    pub(crate) impulse_of_step: Real,
    /// The second body's centre of mass from the first's where they met later in the step \[m\].
    pub(crate) met_apart: Vec3<Real>,
    pub(crate) points: [SavedPoint; MAX_MANIFOLD_POINTS],
    /// How many points there are.
    pub(crate) count: usize,
}

/// A point of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SavedPoint {
    /// Which features of the shapes meet.
    pub(crate) feature: u32,
    /// From the second body's centre of mass \[m\].
    pub(crate) position: Vec3<Real>,
    /// \[m\].
    pub(crate) separation: Real,
    /// Along the normal \[N s\].
    pub(crate) impulse: Real,
}

impl SavedPoint {
    /// How many numbers a point has in a file.
    pub(crate) const NUMBERS: usize = 5;
    pub(crate) const NONE: Self =
        Self { feature: 0, position: Vec3 { x: 0.0, y: 0.0, z: 0.0 }, separation: 0.0, impulse: 0.0 };

    /// In the order of a file.
    pub(crate) fn numbers(&self) -> [Real; Self::NUMBERS] {
        let Vec3 { x, y, z } = self.position;
        [x, y, z, self.separation, self.impulse]
    }

    pub(crate) fn new(feature: u32, [x, y, z, separation, impulse]: [Real; Self::NUMBERS]) -> Self {
        Self { feature, position: Vec3::new(x, y, z), separation, impulse }
    }
}

impl SavedContact {
    /// How many numbers a contact has in a file, but for its points.
    pub(crate) const NUMBERS: usize = 18;
    pub(crate) const MAX_HALVINGS: u8 = MAX_HALVINGS;

    /// In the order of a file.
    pub(crate) fn numbers(&self) -> [Real; Self::NUMBERS] {
        let Self { normal: n, friction: [p, l], steady, gap_share, margin, halvings, .. } = *self;
        let (speed, impulse, a) = (self.closing_speed, self.impulse_of_step, self.met_apart);
        [
            n.x, n.y, n.z, p.x, p.y, p.z, l.x, l.y, l.z, steady, gap_share, margin, halvings, speed, impulse, a.x, a.y,
            a.z,
        ]
    }

    /// Of this many points, which are to be set.
    pub(crate) fn new(
        (bodies, part): ([u32; 2], u32),
        touched: bool,
        numbers: [Real; Self::NUMBERS],
        count: usize,
    ) -> Self {
        let [nx, ny, nz, px, py, pz, lx, ly, lz, rest @ ..] = numbers;
        let [steady, gap_share, margin, halvings, closing_speed, impulse_of_step, ax, ay, az] = rest;
        Self {
            bodies,
            part,
            touched,
            normal: Vec3::new(nx, ny, nz),
            friction: [Vec3::new(px, py, pz), Vec3::new(lx, ly, lz)],
            steady,
            gap_share,
            margin,
            halvings,
            closing_speed,
            impulse_of_step,
            met_apart: Vec3::new(ax, ay, az),
            points: [SavedPoint::NONE; MAX_MANIFOLD_POINTS],
            count,
        }
    }

    /// The sort key of the contacts of a file.
    pub(crate) fn key(&self) -> (u32, u32, u32) {
        let [a, b] = self.bodies;
        (a.min(b), a.max(b), self.part)
    }
}

impl SavedContacts {
    pub(crate) fn clear(&mut self) {
        self.body_keys.clear();
        self.centers.clear();
        self.loads.clear();
        self.still.clear();
        self.contacts.clear();
        self.held.clear();
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.body_keys.is_empty()
    }

    pub(crate) fn body_keys(&self) -> &[BodyKey] {
        &self.body_keys
    }

    pub(crate) fn centers(&self) -> &[[Real; 3]] {
        &self.centers
    }

    pub(crate) fn loads(&self) -> &[f64] {
        &self.loads
    }

    pub(crate) fn still(&self) -> &[Real] {
        &self.still
    }

    /// The contacts in the order of their keys.
    pub(crate) fn contacts(&self) -> Vec<SavedContact> {
        let mut contacts: Vec<_> = self.contacts.iter().map(ContactRecord::saved).collect();
        contacts.sort_by_key(SavedContact::key);
        contacts
    }

    /// From a file: one centre, load and time for each key, and contacts and joints between those.
    pub(crate) fn new(
        body_keys: Vec<BodyKey>,
        (centers, loads, still): (Vec<[Real; 3]>, Vec<f64>, Vec<Real>),
        contacts: &[SavedContact],
        held: Vec<HeldImpulse>,
    ) -> Self {
        Self {
            body_keys,
            centers,
            loads,
            still,
            contacts: contacts.iter().map(ContactRecord::of_saved).collect(),
            held,
            places: Vec::new(),
        }
    }

    /// Bytes of memory that its buffers hold.
    pub(crate) fn memory(&self) -> usize {
        self.body_keys.capacity() * size_of::<BodyKey>()
            + self.centers.capacity() * size_of::<[Real; 3]>()
            + self.loads.capacity() * size_of::<f64>()
            + self.still.capacity() * size_of::<Real>()
            + self.contacts.capacity() * size_of::<ContactRecord>()
            + self.held.capacity() * size_of::<HeldImpulse>()
            + self.places.capacity() * size_of::<Slot>()
    }
}

impl ContactRecord {
    /// The part that the next step and reports depend on; the rest is recomputed.
    fn saved(&self) -> SavedContact {
        let mut points = [SavedPoint::NONE; MAX_MANIFOLD_POINTS];
        for (j, point) in points.iter_mut().enumerate().take(self.count()) {
            *point = SavedPoint {
                feature: self.features[j],
                position: self.place(j),
                separation: self.separation(j),
                impulse: self.normal_impulses.at_points[j],
            };
        }
        SavedContact {
            bodies: self.slots.map(|slot| slot.0),
            part: self.part,
            touched: self.touched,
            normal: self.geometry.normal,
            friction: [self.friction.linear, self.friction.angular],
            steady: self.normal_impulses.steady,
            gap_share: self.normal_impulses.gap_share,
            margin: self.margin(),
            halvings: Real::from(self.halvings()),
            closing_speed: self.closing_speed,
            impulse_of_step: self.impulse_of_step(),
            met_apart: self.meeting.apart,
            points,
            count: self.count(),
        }
    }

    fn of_saved(saved: &SavedContact) -> Self {
        let mut contact =
            Self { slots: saved.bodies.map(Slot), part: saved.part, touched: saved.touched, ..Self::NONE };
        let SavedContact { friction: [linear, angular], steady, gap_share, margin, halvings, .. } = *saved;
        (contact.geometry.normal, contact.geometry.count) = (saved.normal, saved.count as Real);
        (contact.normal_impulses.steady, contact.normal_impulses.gap_share) = (steady, gap_share);
        contact.friction = WorldFriction { linear, angular, margin, halvings };
        contact.meeting.apart = saved.met_apart;
        (contact.closing_speed, contact.total_impulse) = (saved.closing_speed, saved.impulse_of_step);
        for (j, point) in saved.points.iter().enumerate().take(saved.count) {
            let pair = &mut contact.points[j / 2];
            (pair.positions[j % 2], pair.separations[j % 2]) = (point.position, point.separation);
            contact.normal_impulses.at_points[j] = point.impulse;
            contact.features[j] = point.feature;
        }
        contact
    }
}
