//! The typed errors of snapshots, and the defects of stored contacts.

use crate::components::BodyId;
use crate::components::BodyKind;
use crate::math::PRECISION;

/// Why a snapshot cannot be taken, read or restored. Whatever it is, the world is as it was.
///
/// ```
/// use tumble::{Snapshot, SnapshotError};
/// assert_eq!(
///     Snapshot::from_bytes(b"a picture, by mistake").unwrap_err(),
///     SnapshotError::NotASnapshot
/// );
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SnapshotError {
    /// Bodies that a step moves have no [`BodyId`], so nothing could say later which they were.
    #[error("{bodies} bodies that a step moves have no BodyId")]
    Unidentified {
        /// How many.
        bodies: usize,
    },
    /// Two bodies of the world, or of the file, have the same [`BodyId`].
    #[error("two bodies have the same BodyId {}", .id.0)]
    Duplicate {
        /// The smallest such identity.
        id: BodyId,
    },
    /// Two breakable joints of the world have the same [`BodyId`].
    #[error("two breakable joints have the same BodyId {}", .id.0)]
    DuplicateJoint {
        /// The smallest such identity.
        id: BodyId,
    },
    /// Bodies of the snapshot are not in the world. They were despawned since, or never spawned in
    /// this one: spawn them, with these identities, and restore again.
    #[error("{} bodies of the snapshot are not in the world, the first is BodyId {}", .ids.len(), .ids.first().map_or(0, |id| id.0))]
    Missing {
        /// All of them, in order.
        ids: Vec<BodyId>,
    },
    /// A body is of another kind than when the snapshot was taken, so it lacks a component that the
    /// snapshot would write.
    #[error("BodyId {} was {was} when the snapshot was taken and is {is} now", .id.0)]
    Changed {
        /// The body.
        id: BodyId,
        /// Its kind in the snapshot.
        was: BodyKind,
        /// Its kind in the world.
        is: BodyKind,
    },
    /// The bytes do not begin as those of a snapshot do.
    #[error("this is not a snapshot")]
    NotASnapshot,
    /// The bytes are of another version of the format.
    #[error("this is a snapshot of version {found}, {expected} is read here")]
    Version {
        /// The version of the file.
        found: u32,
        /// The version that this build reads and writes.
        expected: u32,
    },
    /// The snapshot was taken in the other precision, so no run could continue from it to the bit.
    #[error("this snapshot has numbers of {found} bytes, but this build simulates in {PRECISION}")]
    Precision {
        /// Bytes that a number of the file takes.
        found: u32,
    },
    /// There are more or fewer bytes than the number of bodies takes: the file was cut short, or
    /// something was added.
    #[error("a snapshot of this many bodies takes {expected} bytes, these are {found}")]
    Length {
        /// How many bytes there are.
        found: usize,
        /// How many there should be; `u64::MAX` where it is beyond that.
        expected: u64,
    },
    /// The checksum is another: the file is damaged.
    #[error("the checksum does not fit: the snapshot is damaged")]
    Checksum,
    /// The time, the number of steps or the owed frame time is one that no simulation has.
    #[error("no simulation has the clock of this snapshot")]
    Clock,
    /// A number of a body is infinite or not a number.
    #[error("the state of BodyId {} is not finite", .id.0)]
    NotFinite {
        /// The first such body.
        id: BodyId,
    },
    /// The orientation of a body is further than 1e-3 from unit length, which is what
    /// [`RigidBody`](crate::RigidBody) allows and far more than a step leaves.
    #[error("the orientation of BodyId {} has the length {length}", .id.0)]
    NotUnit {
        /// The first such body.
        id: BodyId,
        /// Length of the quaternion.
        length: f64,
    },
    /// One of the bodies in contact is not named after the one before, or is nowhere.
    #[error("body {body} of those in contact is out of order, named twice or nowhere")]
    ContactBody {
        /// Which, counted from zero.
        body: usize,
    },
    /// The inertia that joints ask for of a body is negative or not finite.
    #[error("the load of joints on body {body} of those in contact is negative or not finite")]
    JointLoad {
        /// Which, counted from zero.
        body: usize,
    },
    /// The impulses of a joint in passes are not finite, between bodies that are not there, or out
    /// of order.
    #[error("joint {joint} of those in passes has impulses that no step leaves, or is out of order")]
    JointImpulse {
        /// Which, counted from zero.
        joint: usize,
    },
    /// The time for which a body has been still is neither from 0 to 1e9 seconds nor that of one
    /// that sleeps.
    #[error("the time at rest of body {body} of those in contact is neither from 0 to 1e9 s nor -1")]
    Rest {
        /// Which, counted from zero.
        body: usize,
    },
    /// One of the breakable joints is not named after the one before, or neither broken nor whole.
    #[error("breakable joint {joint} is out of order, named twice, or neither broken nor whole")]
    Joint {
        /// Which, counted from zero.
        joint: usize,
    },
    /// A contact is one that no step leaves.
    #[error("contact {contact} {defect}")]
    Contact {
        /// Which, counted from zero.
        contact: usize,
        /// What is wrong with it.
        defect: ContactDefect,
    },
}

tumble_math::debug_as_display!(SnapshotError);

/// Why a contact of a file cannot be one.
///
/// ```
/// use tumble::{ContactDefect, SnapshotError};
///
/// let error = SnapshotError::Contact { contact: 3, defect: ContactDefect::Pull };
/// assert_eq!(error.to_string(), "contact 3 has an impulse that pulls");
/// ```
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactDefect {
    /// A part of the whole is not from 0 to 1.
    #[error("a part of the whole is not from 0 to 1")]
    Part,
    /// How often substeps are halved is not one of 0 to 6.
    #[error("has substeps halved by no whole number from 0 to 6")]
    Halvings,
    /// It is between a body and itself, or bodies that are not there.
    #[error("is not between two of the bodies in contact")]
    Bodies,
    /// It has the bodies of the one before, or comes before it.
    #[error("is not after the one before it")]
    Order,
    /// It has no points, more than four or, all together, others than are there.
    #[error("has an impossible number of points")]
    Points,
    /// A number is infinite or not a number.
    #[error("is not finite")]
    NotFinite,
    /// The normal is further than 1e-3 from unit length.
    #[error("has a normal that is not of unit length")]
    Normal,
    /// Contacts push.
    #[error("has an impulse that pulls")]
    Pull,
}

tumble_math::debug_as_display!(ContactDefect);
