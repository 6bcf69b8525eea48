//! A snapshot as bytes. All numbers are little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `TUMBLE-S` |
//! | 4, 4 | version of the format; bytes of a number, 4 or 8 |
//! | 8, 8, 8 | how many moving, kinematic and fixed bodies |
//! | 8 | 1 with a clock, 0 without; the clock's five fields are then zero |
//! | 8, 8, 8, 8, 8 | steps; steps and time when the settings last changed; dt; frame time owed |
//! | 8, 8, 8, 8 | contacts: bodies that have any, with a `BodyId` and without; contacts; points |
//! | 8 | how many joints in passes |
//! | 8, 8 | how many breakable joints, with a `BodyId` and without |
//! | 8 a body | identities: of moving, kinematic and fixed bodies, each in ascending order |
//! | 7 numbers a body | position, orientation x y z w |
//! | 6 numbers a moving body | linear and angular momentum |
//! | 6 numbers a kinematic body | linear and angular velocity |
//! | 8 or 4 a body in contact | who it is: identities, then numbers of entities, each ascending |
//! | 3 numbers a body in contact | where its centre of mass was when the last step began |
//! | 8 a body in contact | inertia that the loads of its joints ask for, in double precision (1) |
//! | 1 number a body in contact | for how long it has been still, or -1 if it sleeps (1) |
//! | 16 and 15 numbers a contact | see (2) |
//! | 4 and 5 numbers a point | contact by contact (3) |
//! | 8 and 6 numbers a joint in passes | its impulses (4) |
//! | 8 a breakable joint | which it is: identities, then entities as bits, each ascending |
//! | 1 a breakable joint | 1 if it is broken, 0 if not |
//! | 8 | 64-bit FNV-1a of all before |
//!
//! (1) Bodies with such a load, with joints in passes, or that are still, are among them.
//!
//! (2) Two bodies, as indices of those in contact; which of the contacts of the two; number of
//! points, and 256 if the two touched before. Normal from the first to the second; impulse and
//! angular impulse of friction on the second; how steady its effective masses were, from 0 to 1;
//! which share of the gap is before its points; the margin; how often the substeps of its island
//! were halved; how fast they came together; impulse along the normal over the step. In the order
//! of both bodies, the lower index first, and which.
//!
//! (3) Which features meet; place, from the second body's centre of mass; separation; impulse along
//! the normal.
//!
//! (4) Two bodies, as indices of those in contact; impulse, and angular impulses about the locked
//! axes, of the last substep on the second. In the order of both bodies.

use crate::clock::Clock;
use crate::components::BodyKind;
use crate::components::{BodyId, Momentum, Pose, Velocity};
use crate::math::{Quat, Real, Vec3, dquat, real};
use crate::snapshot::contact_bytes;
use crate::snapshot::contact_bytes::{Counts, Written};
use crate::snapshot::error::SnapshotError;
use crate::snapshot::saved_joints::SavedJoints;
use crate::snapshot::state_hash::Fnv;
use crate::snapshot::{Segment, Snapshot, first_duplicate};

const MAGIC: [u8; 8] = *b"TUMBLE-S";
const HEADER: usize = 144;
/// Bytes of the clock, which is between the counts of bodies and those of contacts.
const CLOCK: usize = 48;
const CHECKSUM: usize = 8;
pub(crate) const NUMBER: usize = size_of::<Real>();
/// How far from one the length of an orientation may be: as far as [`RigidBody`](crate::RigidBody)
/// allows.
const UNIT_TOLERANCE: f64 = 1e-3;

impl Snapshot {
    /// The version of the format of [`to_bytes`](Self::to_bytes).
    pub const VERSION: u32 = 9;

    /// The snapshot as bytes for a file or a peer: 152 bytes and 60 a body in single precision, 112
    /// in double, with up to 180 or 328 a contact, 32 or 48 a body that has any, that joints
    /// load or that is still, 32 or 56 a joint in passes, and 9 a breakable joint. Bodies are in
    /// the order of their [`BodyId`]s, so the same state gives the same bytes, whatever the order
    /// they were spawned in.
    ///
    /// With the cargo feature `serde` a snapshot is serialised as these bytes.
    ///
    /// ```
    /// # use tumble::Snapshot;
    /// # let world = hecs::World::new();
    /// let bytes = Snapshot::capture(&world)?.to_bytes();
    /// assert_eq!(bytes.len(), 152);
    /// assert!(Snapshot::from_bytes(&bytes)?.is_empty());
    /// # Ok::<(), tumble::SnapshotError>(())
    /// ```
    pub fn to_bytes(&self) -> Vec<u8> {
        let contacts = Written::new(&self.contacts);
        let of_contacts = contacts.counts.length() as usize;
        let of_joints = SavedJoints::length(self.joints.counts()) as usize;
        let of_bodies = self.len() * (8 + 13 * NUMBER);
        let mut bytes = Vec::with_capacity(HEADER + of_bodies + of_contacts + of_joints + CHECKSUM);
        self.write_header(&mut bytes);
        contacts.write_counts(&mut bytes);
        bytes.extend(self.joints.counts().into_iter().flat_map(u64::to_le_bytes));
        let rows: Vec<usize> = BodyKind::ALL.into_iter().flat_map(|kind| self.rows_by_id(self.rows(kind))).collect();
        for &row in &rows {
            bytes.extend(self.ids[row].0.to_le_bytes());
        }
        for part in [0..7, 7..13] {
            for &row in &rows {
                let numbers = self.numbers(row).skip(part.start).take(part.len());
                numbers.for_each(|number| bytes.extend(number.to_le_bytes()));
            }
        }
        contacts.write(&mut bytes);
        self.joints.write_bytes(&mut bytes);
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
    }

    fn write_header(&self, bytes: &mut Vec<u8>) {
        bytes.extend(MAGIC);
        bytes.extend(Self::VERSION.to_le_bytes());
        bytes.extend((NUMBER as u32).to_le_bytes());
        for kind in BodyKind::ALL {
            bytes.extend((self.rows(kind).len() as u64).to_le_bytes());
        }
        let fields = self.clock.map_or([0; 6], |clock| {
            let (steps, time) = clock.since;
            [1, clock.steps, steps, time.to_bits(), f64::from(clock.dt).to_bits(), clock.owed.to_bits()]
        });
        bytes.extend(fields.into_iter().flat_map(u64::to_le_bytes));
    }

    /// The snapshot that [`to_bytes`](Self::to_bytes) has written.
    ///
    /// # Errors
    /// [`SnapshotError`] where the bytes are not a snapshot, of another version or precision, cut
    /// short or damaged, or hold numbers that are not finite, an orientation far from unit length,
    /// or contacts that no step leaves. [`to_bytes`](Self::to_bytes) does not look, so what a world
    /// that has gone wrong was written as is refused here.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SnapshotError> {
        let header = Header::read(bytes)?;
        let mut rest = Reader { rest: &bytes[HEADER..bytes.len() - CHECKSUM], found: bytes.len() };
        let bodies = header.counts.iter().sum();
        let ids = rest.many(bodies, |rest| rest.u64().map(BodyId))?;
        let poses = rest.many(bodies, Reader::pose)?;
        let momenta = rest.many(header.counts[0], Reader::momentum)?;
        let velocities = rest.many(header.counts[1], Reader::velocity)?;
        let contacts = contact_bytes::read(&mut rest, &header.contacts)?;
        let joints = SavedJoints::read(&mut rest, header.joints)?;
        let (segments, clock) = (Vec::new(), header.clock);
        let mut snapshot = Self { ids, poses, momenta, velocities, segments, clock, contacts, joints };
        for kind in BodyKind::ALL {
            let rows = snapshot.rows(kind);
            snapshot.segments.push(Segment { archetype: usize::MAX, start: rows.start, len: rows.len() });
        }
        snapshot.check()?;
        Ok(snapshot)
    }

    /// Whether a world can have this state.
    fn check(&self) -> Result<(), SnapshotError> {
        if let Some(id) = first_duplicate(&self.ids) {
            return Err(SnapshotError::Duplicate { id });
        }
        for (row, &id) in self.ids.iter().enumerate() {
            if !self.numbers(row).all(Real::is_finite) {
                return Err(SnapshotError::NotFinite { id });
            }
            let length = dquat(self.poses[row].orientation).length();
            if (length - 1.0).abs() > UNIT_TOLERANCE {
                return Err(SnapshotError::NotUnit { id, length });
            }
        }
        Ok(())
    }
}

fn checksum(bytes: &[u8]) -> u64 {
    let mut hash = Fnv::default();
    hash.add_bytes(bytes);
    hash.value()
}

/// The head of the file, before the bodies.
struct Header {
    /// Moving, kinematic and fixed bodies.
    counts: [usize; 3],
    clock: Option<Clock>,
    contacts: Counts,
    /// Breakable joints by [`BodyId`], and by entity.
    joints: [u64; 2],
}

impl Header {
    /// Reads it and checks that the rest is there and undamaged.
    fn read(bytes: &[u8]) -> Result<Self, SnapshotError> {
        let mut reader = Reader { rest: bytes, found: bytes.len() };
        if reader.take() != Ok(MAGIC) {
            return Err(SnapshotError::NotASnapshot);
        }
        let version = reader.take().map(u32::from_le_bytes)?;
        if version != Snapshot::VERSION {
            return Err(SnapshotError::Version { found: version, expected: Snapshot::VERSION });
        }
        let number = reader.take().map(u32::from_le_bytes)?;
        if number != NUMBER as u32 {
            return Err(SnapshotError::Precision { found: number });
        }
        let counts = [reader.u64()?, reader.u64()?, reader.u64()?];
        let mut past_clock = Reader { rest: reader.rest, found: reader.found };
        past_clock.take::<CLOCK>()?;
        let contacts = Counts::read(&mut past_clock)?;
        let joints = [past_clock.u64()?, past_clock.u64()?];
        let of_joints = SavedJoints::length(joints);
        let expected = expected_length(counts).saturating_add(contacts.length()).saturating_add(of_joints);
        let (body, sum) = match bytes.split_last_chunk::<CHECKSUM>() {
            Some(split) if bytes.len() as u64 == expected => split,
            _ => return Err(SnapshotError::Length { found: bytes.len(), expected }),
        };
        if checksum(body) != u64::from_le_bytes(*sum) {
            return Err(SnapshotError::Checksum);
        }
        // The bytes are there, so the counts fit into memory.
        Ok(Self { counts: counts.map(|count| count as usize), clock: reader.clock()?, contacts, joints })
    }
}

/// How long a snapshot of this many bodies is; `u64::MAX` where it is longer.
fn expected_length([moving, kinematic, fixed]: [u64; 3]) -> u64 {
    let number = NUMBER as u64;
    let of = |count: u64, numbers: u64| count.saturating_mul(8 + numbers * number);
    let bodies = of(moving, 13).saturating_add(of(kinematic, 13)).saturating_add(of(fixed, 7));
    bodies.saturating_add((HEADER + CHECKSUM) as u64)
}

/// Takes numbers from the front.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
    /// How many bytes the file has.
    found: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], SnapshotError> {
        let short = SnapshotError::Length { found: self.found, expected: (HEADER + CHECKSUM) as u64 };
        let (taken, rest) = self.rest.split_first_chunk().ok_or(short)?;
        self.rest = rest;
        Ok(*taken)
    }

    /// This many things, in no more memory than they take.
    pub(crate) fn many<T>(
        &mut self,
        count: usize,
        one: impl Fn(&mut Self) -> Result<T, SnapshotError>,
    ) -> Result<Vec<T>, SnapshotError> {
        let mut all = Vec::with_capacity(count);
        for _ in 0..count {
            all.push(one(self)?);
        }
        Ok(all)
    }

    pub(crate) fn u8(&mut self) -> Result<u8, SnapshotError> {
        self.take().map(|[byte]| byte)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, SnapshotError> {
        self.take().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, SnapshotError> {
        self.take().map(u64::from_le_bytes)
    }

    fn clock(&mut self) -> Result<Option<Clock>, SnapshotError> {
        let fields: [u64; 6] = [self.u64()?, self.u64()?, self.u64()?, self.u64()?, self.u64()?, self.u64()?];
        let [present, steps, since, time, dt, owed] = fields;
        if fields == [0; 6] {
            return Ok(None);
        }
        let (time, owed) = (f64::from_bits(time), f64::from_bits(owed));
        let clock = Clock { steps, since: (since, time), dt: real(f64::from_bits(dt)), owed };
        if present == 1 && clock.is_possible() { Ok(Some(clock)) } else { Err(SnapshotError::Clock) }
    }

    fn real(&mut self) -> Result<Real, SnapshotError> {
        self.take().map(Real::from_le_bytes)
    }

    pub(crate) fn numbers<const N: usize>(&mut self) -> Result<[Real; N], SnapshotError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.real()?;
        }
        Ok(numbers)
    }

    fn vector(&mut self) -> Result<Vec3, SnapshotError> {
        Ok(Vec3::new(self.real()?, self.real()?, self.real()?))
    }

    fn pose(&mut self) -> Result<Pose, SnapshotError> {
        let position = self.vector()?;
        let orientation = Quat::from_xyzw(self.real()?, self.real()?, self.real()?, self.real()?);
        Ok(Pose { position, orientation })
    }

    fn momentum(&mut self) -> Result<Momentum, SnapshotError> {
        Ok(Momentum { linear: self.vector()?, angular: self.vector()? })
    }

    fn velocity(&mut self) -> Result<Velocity, SnapshotError> {
        Ok(Velocity { linear: self.vector()?, angular: self.vector()? })
    }
}
