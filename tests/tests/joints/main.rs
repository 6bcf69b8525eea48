//! Joints and mechanisms.

mod direct_contacts;
mod joint_chains;
mod joint_closed_forms;
mod joint_drawing;
mod joint_drives;
mod joint_edges;
mod joint_events;
mod joint_gear_runs;
mod joint_gears;
mod joint_limits;
mod joint_long_runs;
mod joint_loops;
mod joint_misfits;
mod joint_options;
mod joint_oscillations;
mod joint_passes;
mod joint_potentials;
mod joint_references;
mod joint_rest;
mod joint_snapshots;
mod joint_squeezer;
mod joint_thin_bodies;
mod joint_universal;
mod jointed;
mod joints;
mod joints_under_load;
mod joints_with_contacts;
mod locked_joints;
mod lying_figures;
#[path = "../shared/mechanisms/mod.rs"]
mod mechanisms;
mod pressed_mechanisms;
mod scraping_bodies;
