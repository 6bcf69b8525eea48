//! The hero's hand: it shoots balls, and pulls what it points at.

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble_character::CharacterState;

use crate::game::{Actions, Player, direction, head_height, place};
use crate::yard::{Look, YELLOW, Yard};

const BALL: Real = 0.15; // [m]
const BALL_SPEED: Real = 24.0; // [m/s]
const MAX_BALLS: u64 = 60;
/// How far the hand reaches \[m\].
const REACH: Real = 12.0;

/// What was shot, by its number.
pub(crate) struct Ball(u64);

/// What the hand holds: the joint, the body, where on it, and how far away \[m\].
#[derive(Clone, Copy)]
pub(crate) struct Grip {
    pub(crate) joint: Entity,
    pub(crate) body: Entity,
    pub(crate) local: Vec3,
    reach: Real,
}

/// Where the hero looks from, shoots and holds: beside its head, but not through a wall.
pub(crate) fn shoulder(queries: &Queries<'_>, yard: &Yard, head: Vec3, yaw: Real) -> Vec3 {
    let side = Quat::from_rotation_y(yaw) * Vec3::X;
    head + side * room(queries, yard, &Ray::new(head, side).with_max_distance(0.75))
}

/// How far a ball gets along a ray.
fn room(queries: &Queries<'_>, yard: &Yard, ray: &Ray) -> Real {
    let hit = queries.cast_ray(ray, &QueryFilter::new().without(yard.hero));
    (hit.map_or(ray.max_distance, |hit| hit.distance) - 0.2).max(0.0)
}

/// From where, and which way.
fn aim(world: &World, queries: &Queries<'_>, yard: &Yard, actions: &Actions) -> (Vec3, Vec3) {
    let crouches = world.get::<&CharacterState>(yard.hero).is_ok_and(|state| state.is_crouching);
    let head = place(world, yard.hero) + Vec3::Y * head_height(crouches);
    (shoulder(queries, yard, head, actions.yaw), direction(actions.yaw, actions.pitch))
}

/// A ball leaves as far ahead of the shoulder as there is room, and the oldest goes.
pub(crate) fn shoot(world: &mut World, simulation: &Simulation, yard: &Yard, player: &mut Player) {
    let queries = simulation.queries(world);
    let (from, way) = aim(world, &queries, yard, &player.last);
    let from = from + way * room(&queries, yard, &Ray::new(from, way).with_max_distance(0.7));
    drop(queries);
    let ball = RigidBody::new(Shape::sphere(BALL)).mass(5.0).position(from).linear_velocity(way * BALL_SPEED);
    let ball = ball.material(Material::default().with_restitution(0.3)).interpolated();
    let Ok(ball) = ball.id(BodyId(yard.next_id + player.shots)).build() else { return };
    ball.spawn_with(world, (Ball(player.shots), Look::of(&Shape::sphere(BALL), YELLOW)));
    player.shots += 1;
    let is_spent = |ball: &Ball| ball.0 + MAX_BALLS < player.shots;
    let spent = world.query::<(Entity, &Ball)>().iter().find(|(_, ball)| is_spent(ball)).map(|(it, _)| it);
    if let Some(ball) = spent {
        if player.grip.is_some_and(|grip| grip.body == ball) {
            release(world, player);
        }
        // It was found a moment ago.
        let _ = world.despawn(ball);
    }
}

/// The hand goes to where the hero looks; what it holds is on a spring to it.
pub(crate) fn pull(world: &mut World, simulation: &Simulation, yard: &Yard, player: &mut Player, begins: bool) {
    let queries = simulation.queries(world);
    let (from, way) = aim(world, &queries, yard, &player.last);
    let ray = Ray::new(from, way).with_max_distance(REACH);
    let hit = queries.cast_ray(&ray, &QueryFilter::new().without(yard.hero));
    drop(queries);
    // Who stands on what it holds would lift itself.
    let ground = world.get::<&CharacterState>(yard.hero).ok().and_then(|state| state.ground_entity);
    if player.grip.is_some_and(|grip| !player.last.grab || ground == Some(grip.body)) {
        release(world, player);
    }
    if begins && let Some(hit) = hit.filter(|hit| ground != Some(hit.entity)) {
        player.grip = take(world, yard, &hit);
    }
    let Ok((hand, velocity)) = world.query_one_mut::<(&Pose, &mut Velocity)>(yard.hand) else { return };
    velocity.linear = player.grip.map_or(Vec3::ZERO, |grip| {
        let way = from + way * grip.reach - hand.position;
        (way / simulation.settings().dt).clamp_length_max(15.0)
    });
}

/// A joint from the hand to a point of a body that moves.
fn take(world: &mut World, yard: &Yard, hit: &RayHit) -> Option<Grip> {
    let body = world.query_one_mut::<(&Pose, &Momentum)>(hit.entity).ok()?;
    let local = body.0.inverse_transform_point(hit.point);
    world.get::<&mut Pose>(yard.hand).ok()?.position = hit.point;
    let joint = Joint::free(yard.hand, hit.entity).with_frames(Pose::default(), Pose::at(local));
    let spring = Drive::position(Axes::LINEAR, 0.0).with_frequency(2.0, 1.0).with_max_force(600.0);
    let calm = Drive::velocity(Axes::ANGULAR, 0.0).with_acceleration(0.0, 3.0);
    let joint = world.spawn((joint, Drives(vec![spring, calm])));
    Some(Grip { joint, body: hit.entity, local, reach: hit.distance })
}

pub(crate) fn release(world: &mut World, player: &mut Player) {
    if let Some(grip) = player.grip.take() {
        // The joint is there as long as the grip is.
        let _ = world.despawn(grip.joint);
    }
}
