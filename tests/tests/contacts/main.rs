//! Bodies that touch, and questions about where they are.

mod contact_batch;
mod contact_bounds;
mod contact_events;
mod contact_friction;
mod contact_hooks;
mod contact_laws;
mod contact_ledger;
mod contact_parts;
mod contact_reading;
mod contact_shapes;
mod contact_snapshots;
mod contact_stacks;
mod contacts;
mod crowds;
mod despawned;
mod finer_substeps;
mod flat_bodies;
mod ghosts;
mod held_by_friction;
mod hits;
mod kept_layout;
mod oblique_bounce;
#[path = "../shared/pile/mod.rs"]
mod pile;
mod queries;
mod rolling_energy;
mod sensors;
mod settling;
mod shots;
mod simbenchmark;
mod sleep;
mod sleep_changes;
mod sleep_repeats;
mod thin_bodies;
mod tiles;
mod towers;
