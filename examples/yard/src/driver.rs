//! The driver: into the car, out of it, and what the keys do there.

use hecs::World;
use tumble::prelude::*;
use tumble_character::Character;
use tumble_vehicle::VehicleInput;

use crate::game::{Actions, Player, place};
use crate::yard::Yard;

/// From where the car can be entered \[m\].
pub(crate) const DOOR: Real = 3.0;
pub(crate) const PARKED: VehicleInput = VehicleInput { throttle: 0.0, brake: 0.0, hand_brake: 1.0, steering: 0.0 };

/// The hero is where the car is.
pub(crate) fn drive(world: &World, yard: &Yard, actions: &Actions) {
    let Ok(chassis) = world.entity(yard.car) else { return };
    let (Some(pose), Some(velocity)) = (chassis.get::<&Pose>(), chassis.get::<&Velocity>()) else { return };
    let speed = velocity.linear.dot(pose.orientation * Vec3::Z);
    let against = actions.ahead * speed < 0.0 && speed.abs() > 1.0;
    if let Some(mut input) = chassis.get::<&mut VehicleInput>() {
        input.throttle = if against { 0.0 } else { actions.ahead };
        input.brake = if against { 1.0 } else { 0.0 };
        input.hand_brake = if actions.jump { 1.0 } else { 0.0 };
        // Less at speed, as a driver would.
        input.steering = -actions.right / (1.0 + speed.abs() / 12.0);
    }
    if let Ok((seat, moves)) = world.query_one::<(&mut Pose, &mut Velocity)>(yard.hero).get() {
        (*seat, *moves) = (Pose::at(pose.position), Velocity::default());
    }
}

/// A hero in the car has no collider and is no character.
pub(crate) fn enter_or_leave(world: &mut World, simulation: &Simulation, yard: &Yard, player: &mut Player) {
    if player.driving {
        let Some(out) = beside_car(world, simulation, yard) else { return };
        let hero = (yard.character.at(out), PreviousPose(Pose::at(out)));
        player.driving = world.insert(yard.hero, hero.0).and_then(|()| world.insert_one(yard.hero, hero.1)).is_err();
        if let Ok(mut input) = world.get::<&mut VehicleInput>(yard.car) {
            *input = PARKED;
        }
    } else if place(world, yard.hero).distance(place(world, yard.car)) < DOOR {
        player.driving = world.remove::<(Character, Collider)>(yard.hero).is_ok();
    }
}

/// Room to stand beside the car.
fn beside_car(world: &World, simulation: &Simulation, yard: &Yard) -> Option<Vec3> {
    let car = *world.get::<&Pose>(yard.car).ok()?;
    let standing = yard.character.at(Vec3::ZERO).2;
    let (queries, filter) = (simulation.queries(world), QueryFilter::new().without(yard.car));
    [Vec3::X, Vec3::NEG_X, Vec3::NEG_Z, Vec3::Z].into_iter().find_map(|side| {
        let out = car.orientation * side * if side.x == 0.0 { 2.4 } else { 1.25 };
        let blocked = queries.is_blocked(&Ray::new(car.position, out).with_max_distance(out.length()), &filter);
        let below = queries.cast_ray(&Ray::new(car.position + out + Vec3::Y * 0.5, Vec3::NEG_Y), &filter)?;
        let sole = below.point + Vec3::Y * 0.02;
        let free = queries.overlapping(&standing, &Pose::at(sole), &QueryFilter::new()).is_empty();
        (free && !blocked).then_some(sole)
    })
}
