//! What a world and a simulation hold, and what is done with it.

mod batch;
mod body_slices;
mod books_of_any_body;
mod debug_draw;
mod fixed_step;
mod impossible_bodies;
mod kinds_of_body;
mod ledger;
mod lifetimes;
mod mass_changes;
mod outside_solver;
mod own_schedule;
mod snapshot_files;
mod snapshots;
mod spawning;
