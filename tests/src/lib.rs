//! What the tests share: exact solutions of free bodies, and how to compare with them.

mod comparison;
mod draw;
mod free_body;
pub mod meshes;
pub mod references;
mod simulation;
mod snapshot_bytes;
pub mod touching;

pub use comparison::{
    DOUBLE, EPSILON, attitude_error, by_precision, dquat, dvec3, energy_of, largest, quat, real, seconds, vec3,
};
pub use draw::{Draw, cases};
pub use free_body::{Elliptic, FreeBody, Sample, Translation};
pub use simulation::{Rise, hash, run, settings_at_random, simulation, weightless};
pub use snapshot_bytes::forged;

/// The snippets of the documents, run as doctests.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../../README.md")]
    struct Readme;

    #[doc = include_str!("../../crates/tumble-character/README.md")]
    struct ReadmeOfCharacter;

    #[doc = include_str!("../../crates/tumble-import/README.md")]
    struct ReadmeOfImport;

    #[doc = include_str!("../../crates/tumble-math/README.md")]
    struct ReadmeOfMath;

    #[doc = include_str!("../../crates/tumble-record/README.md")]
    struct ReadmeOfRecord;

    #[doc = include_str!("../../crates/tumble-scene/README.md")]
    struct ReadmeOfScene;

    #[doc = include_str!("../../crates/tumble-sweep/README.md")]
    struct ReadmeOfSweep;

    #[doc = include_str!("../../crates/tumble-vehicle/README.md")]
    struct ReadmeOfVehicle;

    #[doc = include_str!("../../docs/batch.md")]
    struct Batches;

    #[doc = include_str!("../../docs/characters.md")]
    struct Characters;

    #[doc = include_str!("../../docs/contacts.md")]
    struct Contacts;

    #[doc = include_str!("../../docs/embedding.md")]
    struct Embedding;

    #[doc = include_str!("../../docs/forces.md")]
    struct Forces;

    #[doc = include_str!("../../docs/from-rapier.md")]
    struct FromRapier;

    #[doc = include_str!("../../docs/joints.md")]
    struct Joints;

    #[doc = include_str!("../../docs/reproducible-runs.md")]
    struct ReproducibleRuns;

    #[doc = include_str!("../../docs/rollback.md")]
    struct Rollback;

    #[doc = include_str!("../../docs/schedule.md")]
    struct Schedule;

    #[doc = include_str!("../../docs/spinning.md")]
    struct Spinning;

    #[doc = include_str!("../../docs/vehicles.md")]
    struct Vehicles;
}
