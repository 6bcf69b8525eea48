//! How the two craft are to each other, and when the latches catch.

use hecs::{Entity, World};
use tumble::prelude::*;

use crate::{DockingPort, Fuel, Player, Target};

/// Port to port \[m\].
pub(crate) const CAPTURE_DISTANCE: Real = 0.25;
/// Of one port past the other [m/s].
pub(crate) const MAX_SPEED: Real = 0.3;
/// Between the axes \[rad\]: ten degrees.
pub(crate) const MAX_MISALIGNMENT: Real = 0.1745;
/// Of one craft against the other [rad/s].
pub(crate) const MAX_SPIN: Real = 0.08;

/// One of the two craft as both pilots see it.
#[derive(Clone, Copy)]
pub(crate) struct Craft {
    pub(crate) entity: Entity,
    pub(crate) pose: Pose,
    pub(crate) velocity: Velocity,
    pub(crate) port: DockingPort,
}

impl Craft {
    /// The one with this mark; none once they are docked.
    pub(crate) fn of<Mark: hecs::Component>(world: &World) -> Option<Self> {
        let mut query = world.query::<(Entity, &Pose, &Velocity, &DockingPort)>().with::<&Mark>();
        query.iter().next().map(|(entity, pose, velocity, port)| Self {
            entity,
            pose: *pose,
            velocity: *velocity,
            port: *port,
        })
    }

    pub(crate) fn port_point(&self) -> Vec3 {
        self.pose.transform_point(self.port.point)
    }

    pub(crate) fn port_axis(&self) -> Vec3 {
        self.pose.orientation * self.port.axis
    }
}

/// How the two ports are to each other.
pub(crate) struct Approach {
    /// From the ship's port to the satellite's, in the world \[m\].
    pub(crate) gap: Vec3,
    /// Velocity of the ship's port past the satellite, as someone on the satellite sees it [m/s].
    pub(crate) drift: Vec3,
    /// Angle between the axes, zero where they face each other \[rad\].
    pub(crate) misalignment: Real,
    /// Of one against the other [rad/s].
    pub(crate) spin: Real,
}

impl Approach {
    pub(crate) fn of(ship: &Craft, target: &Craft) -> Self {
        let here = ship.port_point();
        let of_satellite = target.velocity.at_point(here, target.pose.position);
        Self {
            gap: target.port_point() - here,
            drift: ship.velocity.at_point(here, ship.pose.position) - of_satellite,
            misalignment: ship.port_axis().angle_between(-target.port_axis()),
            spin: (ship.velocity.angular - target.velocity.angular).length(),
        }
    }

    /// What the latches have against it, once the ports are close enough to catch.
    pub(crate) fn verdict(&self) -> Option<Result<(), &'static str>> {
        (self.gap.length() < CAPTURE_DISTANCE).then_some(match self {
            Self { drift, .. } if drift.length() > MAX_SPEED => Err("too fast"),
            Self { misalignment, .. } if *misalignment > MAX_MISALIGNMENT => Err("not aligned"),
            Self { spin, .. } if *spin > MAX_SPIN => Err("spinning against it"),
            _ => Ok(()),
        })
    }
}

/// How a flight stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    Flying,
    Missed(String),
    OutOfFuel,
    Lost,
    Docked,
}

/// How it stands now. A miss is reported until the ports are clear of each other.
pub(crate) fn judge(world: &World, before: &Outcome) -> Outcome {
    let (Some(ship), Some(target)) = (Craft::of::<Player>(world), Craft::of::<Target>(world)) else {
        return before.clone();
    };
    let approach = Approach::of(&ship, &target);
    let dry = world.get::<&Fuel>(ship.entity).is_ok_and(|fuel| fuel.0 <= 0.0);
    match (approach.verdict(), approach.gap.length()) {
        (Some(Ok(())), _) => Outcome::Docked,
        (Some(Err(reason)), _) => Outcome::Missed(reason.to_owned()),
        (None, distance) if distance > 80.0 => Outcome::Lost,
        _ if dry => Outcome::OutOfFuel,
        (None, distance) if distance > 2.0 => Outcome::Flying,
        _ => before.clone(),
    }
}
