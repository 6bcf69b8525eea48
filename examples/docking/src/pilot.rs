//! A pilot for `--autopilot` and the tests. It sees what a player sees and has a player's keys,
//! each of them down or not.

use hecs::World;
use tumble::prelude::*;

use crate::approach::{Approach, Craft};
use crate::{Assist, Controls, Player, Target, key};

/// Where to wait on the port's axis until the ship is well in line \[m\], from port to port.
const GATE: Real = 5.0;
/// How far from the satellite's middle to go round it \[m\].
const DETOUR: Real = 9.0;

/// The keys to press now. Nothing is remembered from step to step, so a flight depends on the state
/// of the bodies alone.
pub(crate) fn fly(world: &World) -> Controls {
    let (Some(ship), Some(target)) = (Craft::of::<Player>(world), Craft::of::<Target>(world)) else {
        return Controls::default();
    };
    let to_body = ship.pose.orientation.conjugate();
    let error = to_body * (wanted_velocity(&ship, &target) - ship.velocity.linear);
    let turn = to_body * wanted_turn(&ship, &target);
    Controls {
        push: error.map(|v| key(v, 0.03)),
        turn: turn.map(|angle| key(angle, 0.03)),
        brake: false,
        assist: Assist::Match,
    }
}

/// The rotation that is still missing until the ports face each other \[rad\], with the wheels' lag
/// taken off.
fn wanted_turn(ship: &Craft, target: &Craft) -> Vec3 {
    let missing = Quat::from_rotation_arc(ship.port_axis(), -target.port_axis()).to_scaled_axis();
    missing - (ship.velocity.angular - target.velocity.angular) * 0.15
}

/// Close by, the velocity is one past the turning satellite; far off, where turning with it would
/// be a race, past a standing one.
fn wanted_velocity(ship: &Craft, target: &Craft) -> Vec3 {
    let center = target.pose.position;
    let arm = ship.pose.position - center;
    let near = ((16.0 - arm.length()) / 6.0).clamp(0.0, 1.0);
    let carried = target.velocity.linear + target.velocity.angular.cross(arm) * near;
    carried + wanted_drift(ship, target, arm)
}

fn wanted_drift(ship: &Craft, target: &Craft, arm: Vec3) -> Vec3 {
    let axis = target.port_axis();
    let approach = Approach::of(ship, target);
    let along = -approach.gap.dot(axis);
    let aside = -approach.gap - axis * along;
    let facing = approach.misalignment < 0.12;
    if along > -0.5 && aside.length() < 0.08 + 0.12 * along.max(0.0) && facing {
        // In the cone: straight in, slower and slower.
        return -axis * (0.12 * along).clamp(0.12, 0.5) - aside * 0.5;
    }
    if along < 3.0 && arm.normalize().dot(axis) < 0.8 {
        // Beside or behind it: round it, at a distance.
        let outwards = arm.normalize();
        let onwards = (axis - outwards * axis.dot(outwards)).normalize_or(outwards.any_orthonormal_vector());
        return onwards * 0.7 + outwards * ((DETOUR - arm.length()) * 0.3).clamp(-0.7, 0.7);
    }
    let to_gate = approach.gap + axis * GATE;
    to_gate.clamp_length_max(6.0) * 0.25
}
