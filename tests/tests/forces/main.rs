//! Forces, springs and laws.

mod body_forces;
mod buoyancy;
#[path = "../shared/coupled/mod.rs"]
mod coupled;
mod damping;
mod force_components;
mod force_laws;
mod force_ledger;
mod force_orders;
mod forces;
mod gravitation;
mod nets;
mod one_body;
mod outside_forces;
mod spring_energy;
mod spring_to_point;
mod springs;
mod strong_drag;
