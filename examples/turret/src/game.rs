//! The game without its window: drones fall towards a turret, which shoots at those that it sees.

use hecs::{Entity, World};
use tumble::batch::Rng;
use tumble::prelude::*;

/// Speed of a bullet \[m/s\]: ten metres a step, through drones that are half a metre thick.
const MUZZLE_SPEED: Real = 600.0;
/// Time between two shots \[s\].
const RELOAD: f64 = 0.25;
/// Time between two drones \[s\].
const ARRIVAL: f64 = 0.8;
/// How far the turret sees \[m\].
const SIGHT: Real = 80.0;
/// Where its eye is \[m\].
pub(crate) const EYE: Vec3 = Vec3::new(0.0, 2.0, 0.0);

/// What falls towards the turret, and whether it was hit.
pub(crate) struct Drone {
    pub(crate) is_hit: bool,
}

/// What the turret shoots, and the step in which it did.
pub(crate) struct Bullet(u64);

pub(crate) struct Game {
    pub(crate) world: World,
    pub(crate) simulation: Simulation,
    rng: Rng,
    turret: Entity,
    goal: Entity,
    next_shot: f64,
    next_drone: f64,
    /// The last look: the ray, and what it met.
    pub(crate) look: Option<(Ray, RayHit)>,
    pub(crate) hits: u32,
    /// Drones that came through to the ring around the turret.
    pub(crate) landed: u32,
}

impl Game {
    pub(crate) fn new(seed: u64) -> Result<Self, Box<dyn std::error::Error>> {
        let mut world = World::new();
        spawn_ground(&mut world);
        let turret = RigidBody::new(Shape::cylinder(0.4, 0.75)).fixed().position(Vec3::Y * 0.75);
        let turret = turret.build()?.spawn(&mut world);
        // A ring that nothing bumps into: it counts what gets there.
        let goal = RigidBody::new(Shape::cylinder(4.0, 0.5)).fixed().sensor().position(Vec3::Y * 0.5);
        let goal = goal.build()?.spawn(&mut world);
        // Pillars to hide behind.
        let pillar = RigidBody::new(Shape::cuboid([0.8, 6.0, 0.8])).fixed();
        for i in 0..6_u8 {
            let angle = Real::from(i) * std::f64::consts::FRAC_PI_3 as Real;
            let place = Vec3::new(angle.cos() * 12.0, 6.0, angle.sin() * 12.0);
            pillar.clone().position(place).build()?.spawn(&mut world);
        }
        let simulation = Simulation::new(Settings::default())?;
        let rng = Rng::new(seed);
        let (next_shot, next_drone, look) = (0.0, 0.0, None);
        Ok(Self { world, simulation, rng, turret, goal, next_shot, next_drone, look, hits: 0, landed: 0 })
    }

    /// Goes on by a frame; returns how far the picture is between two steps.
    pub(crate) fn advance(&mut self, seconds: f64) -> Result<Real, Box<dyn std::error::Error>> {
        let time = self.simulation.time();
        if time >= self.next_drone {
            self.next_drone = time + ARRIVAL;
            self.spawn_drone()?;
        }
        if time >= self.next_shot
            && let Some(aim) = self.aim()
        {
            self.next_shot = time + RELOAD;
            self.shoot(aim)?;
        }
        let alpha = self.simulation.advance(&mut self.world, seconds);
        self.count()?;
        Ok(alpha)
    }

    fn spawn_drone(&mut self) -> Result<(), Box<dyn std::error::Error>> {
        let angle = self.rng.range(-3.0, 3.0);
        let far = self.rng.range(18.0, 30.0);
        let place = Vec3::new(angle.cos() * far, self.rng.range(8.0, 16.0), angle.sin() * far);
        // It falls slowly, and drifts to the middle.
        let drone = RigidBody::new(Shape::cuboid([0.5, 0.25, 0.5]))
            .mass(8.0)
            .position(place)
            .gravity_scale(0.05)
            .interpolated();
        let drift = (EYE - place) * 0.12;
        let drone = drone.linear_velocity(Vec3::new(drift.x, 0.0, drift.z)).build()?;
        drone.spawn_with(&mut self.world, (Drone { is_hit: false },));
        Ok(())
    }

    /// The direction to the nearest drone that nothing hides.
    fn aim(&mut self) -> Option<Vec3> {
        let drones: Vec<(Entity, Vec3)> = self
            .world
            .query::<(Entity, &Pose, &Drone)>()
            .iter()
            .filter(|(_, _, drone)| !drone.is_hit)
            .map(|(entity, pose, _)| (entity, pose.position))
            .collect();
        let queries = self.simulation.queries(&self.world);
        let is_no_bullet = |entity: Entity| !self.world.satisfies::<&Bullet>(entity);
        let filter = QueryFilter::new().without(self.turret).matching(&is_no_bullet);
        let seen = drones.into_iter().filter_map(|(drone, place)| {
            let ray = Ray::new(EYE, place - EYE).with_max_distance(SIGHT);
            let hit = queries.cast_ray(&ray, &filter)?;
            (hit.entity == drone).then_some((ray, hit))
        });
        let nearest = seen.min_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance));
        self.look = nearest;
        nearest.map(|(ray, _)| ray.direction.normalize_or_zero())
    }

    fn shoot(&mut self, direction: Vec3) -> Result<(), Box<dyn std::error::Error>> {
        let surface = Material::default().with_friction(0.3).with_restitution(0.4);
        let bullet = RigidBody::new(Shape::sphere(0.05)).mass(0.05).material(surface).position(EYE).interpolated();
        let bullet = bullet.linear_velocity(direction * MUZZLE_SPEED).build()?;
        bullet.spawn_with(&mut self.world, (Bullet(self.simulation.steps()),));
        Ok(())
    }

    /// Takes note of hits and of drones that came through, and removes what is spent.
    fn count(&mut self) -> Result<(), Box<dyn std::error::Error>> {
        let mut hit = Vec::new();
        for event in self.simulation.contact_events() {
            if let ContactEvent::Begin(bodies, impact) = event
                && impact.speed > 50.0
            {
                hit.extend(bodies);
            }
        }
        for entity in hit {
            // A drone that was hit has no lift any more.
            if let Ok(mut drone) = self.world.get::<&mut Drone>(entity)
                && !std::mem::replace(&mut drone.is_hit, true)
            {
                self.hits += 1;
            }
            if self.world.satisfies::<&Drone>(entity) {
                self.world.insert_one(entity, GravityScale(1.0))?;
            }
        }
        let arrived: Vec<Entity> = self
            .simulation
            .sensor_events()
            .filter(|event| event.begins && event.sensor == self.goal)
            .filter(|event| self.world.get::<&Drone>(event.body).is_ok_and(|drone| !drone.is_hit))
            .map(|event| event.body)
            .collect();
        for drone in arrived {
            self.landed += 1;
            self.world.despawn(drone)?;
        }
        let now = self.simulation.steps();
        let spent = |bullet: &Bullet| now > bullet.0 + 120;
        let spent: Vec<Entity> =
            self.world.query::<(Entity, &Bullet)>().iter().filter(|(_, it)| spent(it)).map(|(it, _)| it).collect();
        spent.into_iter().try_for_each(|bullet| self.world.despawn(bullet))?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute of the game: the turret sees drones, hits most, and none of its bullets is lost in
    /// a drone or in the ground.
    #[test]
    fn the_turret_hits_what_it_sees() {
        let mut game = Game::new(7).unwrap();
        for _ in 0..3600 {
            game.advance(1.0 / 60.0).unwrap();
            let lowest =
                game.world.query::<(&Pose, &Bullet)>().iter().map(|(pose, _)| pose.position.y).fold(1.0, Real::min);
            assert!(lowest > 0.0, "{lowest}");
        }
        assert!(game.hits > 40 && game.landed < 20, "{} hits, {} landed", game.hits, game.landed);
        // No drone was hit but by a bullet that came from where it was seen: pillars stop the
        // others.
        assert!(game.look.is_some_and(|(_, hit)| game.world.satisfies::<&Drone>(hit.entity)) || game.look.is_none());
    }

    /// What hides behind a pillar is not aimed at.
    #[test]
    fn pillars_hide() {
        let mut game = Game::new(1).unwrap();
        let behind = RigidBody::new(Shape::cuboid([0.5, 0.25, 0.5]))
            .mass(8.0)
            .position(Vec3::new(16.0, 2.0, 0.0))
            .build()
            .unwrap();
        let drone = behind.spawn_with(&mut game.world, (Drone { is_hit: false },));
        assert!(game.aim().is_none());
        game.world.get::<&mut Pose>(drone).unwrap().position.z = 8.0;
        assert!(game.aim().is_some_and(|aim| aim.x > 0.8 && aim.z > 0.3));
    }
}
