//! Stub for the reference engine in builds without Rapier.

use hecs::World;
use tumble::Settings;

use crate::{Places, RunStatus};

/// No other engine was built.
pub(crate) enum Peer {}

impl Peer {
    pub(crate) fn new(_: &World, _: &Settings) -> RunStatus<Option<Self>> {
        Ok(None)
    }

    pub(crate) fn step(&mut self) {
        match *self {}
    }

    pub(crate) fn places(&self) -> Places {
        match *self {}
    }
}
