//! A scene that is being run, at a pace that people can follow.

use std::time::Duration;

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    BodyOrder, Collider, PhaseTimes, Pose, PreviousPose, QueryFilter, Rollback, Simulation, Snapshot, Totals, Velocity,
};
use tumble_record::{Kept, MomentumScale};
use tumble_scene::Scene;

use crate::balls::Balls;
use crate::bodies::{Bodies, Placed};
use crate::camera::Ray;
use crate::clock::Instant;
use crate::convert::real;
use crate::failure::Failure;
use crate::pick::ExactHit;
use crate::trails::Trails;

/// Scenes of this length are shown in real time \[s\]; others take [`WATCHED`].
const REAL_TIME: std::ops::RangeInclusive<f64> = 0.5..=120.0;
const WATCHED: f64 = 30.0;
/// A frame is this close to a step when it is at the step, in steps.
const AT_STEP: f64 = 1e-6;
/// The most steps to go back, and the bytes for them: some of a body with its contacts.
const MAX_BACK: usize = 600;
const BACK_BYTES: usize = 256 << 20;
const BYTES_OF_A_BODY: usize = 1024;

/// The world of a scene, its time, and how it began.
pub(crate) struct Playback {
    pub(crate) world: World,
    pub(crate) simulation: Simulation,
    pub(crate) order: BodyOrder,
    pub(crate) bodies: Bodies,
    pub(crate) trails: Trails,
    /// Energy and momentum at the start, or when someone interfered last.
    pub(crate) start: Totals,
    pub(crate) scale: MomentumScale,
    pub(crate) kept: Kept,
    /// How far the picture is from the step before to the last one.
    alpha: Real,
    steps: u64,
    beginning: Snapshot,
    /// Simulated time that no step has covered yet \[s\].
    owed: f64,
    /// The steps that can be taken back, where any can.
    past: Option<Rollback>,
    /// What is measured of the steps, where it is.
    pub(crate) times: Option<PhaseTimes>,
    pub(crate) balls: Balls,
    /// Whether the course is another than the scene's, for someone interfered.
    interfered: bool,
    /// Whether settings have been changed, which a restart keeps.
    pub(crate) settings_changed: bool,
}

impl Playback {
    pub(crate) fn of(scene: Scene) -> Result<Self, Failure> {
        let simulation = Simulation::new(scene.settings).map_err(|error| Failure::Input(error.to_string()))?;
        let (appearance, steps) = (scene.appearance()?, scene.steps);
        let mut world = World::new();
        let names = scene.spawn(&mut world)?;
        remember_poses(&mut world);
        let order = BodyOrder::of(&world);
        let bodies = Bodies::of(&world, &order, &names, &appearance);
        let start = Totals::of(&world, simulation.settings(), &order);
        let scale = MomentumScale::of(&world, &order);
        let kept = Kept::of(&world, simulation.settings());
        let beginning = simulation.snapshot(&world).map_err(|error| Failure::Input(error.to_string()))?;
        let trails = Trails::new(moving(&bodies), steps);
        let balls = Balls::new(&world, &bodies);
        Ok(Self {
            world,
            simulation,
            order,
            bodies,
            trails,
            start,
            scale,
            kept,
            alpha: 1.0,
            steps,
            beginning,
            owed: 0.0,
            past: None,
            times: None,
            balls,
            interfered: false,
            settings_changed: false,
        })
    }

    pub(crate) fn dt(&self) -> f64 {
        f64::from(self.simulation.settings().dt)
    }

    /// The moment that is shown \[s\].
    pub(crate) fn time(&self) -> f64 {
        (self.simulation.time() - (1.0 - f64::from(self.alpha)) * self.dt()).max(0.0)
    }

    /// How far the picture is from the step before to the last one.
    pub(crate) fn alpha(&self) -> Real {
        self.alpha
    }

    /// How far along a ray a body is met where it is shown, by its collider if it has one.
    pub(crate) fn hit(&self, index: usize, shown: &Placed, ray: &Ray) -> ExactHit {
        let body = &self.bodies.all[index];
        let entity = body.entity;
        self.world.get::<&Collider>(entity).ok()?;
        // It is shown between two steps, and is where the last left it.
        let now = body.placed(&*self.world.get::<&Pose>(entity).ok()?);
        let turn = now.rotation * shown.rotation.inverse();
        let origin = now.origin + turn * (ray.origin - shown.origin);
        let [origin, direction] = [origin, turn * ray.direction].map(|it| Vec3::from_array(it.to_array().map(real)));
        let only_it = |it: Entity| it == entity;
        let queries = self.simulation.queries(&self.world);
        let filter = QueryFilter::new().with_sensors().matching(&only_it);
        Some(queries.cast_ray(&tumble::Ray::new(origin, direction), &filter).map(|hit| f64::from(hit.distance)))
    }

    /// Where the bodies are at the moment that is shown.
    pub(crate) fn place(&self) -> Vec<Placed> {
        self.bodies.place(&self.world, self.alpha)
    }

    /// Goes back to the beginning, with the settings as they are now.
    pub(crate) fn restart(&mut self) -> Result<(), Failure> {
        let restored = self.simulation.restore(&self.beginning, &mut self.world);
        let shot = restored.map_err(|error| Failure::Running(error.to_string()))?;
        tumble::update_derived(&mut self.world);
        self.trails = Trails::new(moving(&self.bodies), self.steps);
        if self.past.is_some() {
            self.keep_past();
        }
        self.come_to_rest(&shot);
        self.interfered = false;
        Ok(())
    }

    /// From now on steps can be taken back: the last 600, or as many as fit into 256 MB by an
    /// estimate of what a body takes.
    pub(crate) fn keep_past(&mut self) {
        let fitting = BACK_BYTES / (BYTES_OF_A_BODY * self.bodies.all.len().max(1));
        self.past = Some(Rollback::new(fitting.clamp(1, MAX_BACK)));
    }

    /// Takes the last step back; whether it was kept.
    pub(crate) fn step_back(&mut self) -> bool {
        let (Some(past), Some(step)) = (&mut self.past, self.simulation.steps().checked_sub(1)) else { return false };
        let Ok(shot) = past.rewind_to_step(step, &mut self.world, &mut self.simulation) else { return false };
        self.trails.take_back(step);
        self.come_to_rest(&shot);
        true
    }

    /// Shows the state that was put back, without the balls that were shot since.
    fn come_to_rest(&mut self, shot: &[Entity]) {
        for (pose, previous) in self.world.query_mut::<(&Pose, &mut PreviousPose)>() {
            previous.0 = *pose;
        }
        self.remove_balls(shot);
        if self.interfered {
            self.begin_books();
        }
        (self.alpha, self.owed) = (1.0, 0.0);
    }

    /// Reckons drift from here on: someone has interfered.
    pub(crate) fn begin_books(&mut self) {
        self.interfered = true;
        self.order = BodyOrder::of(&self.world);
        self.start = self.totals();
        self.scale = MomentumScale::of(&self.world, &self.order);
        self.kept = Kept::of(&self.world, self.simulation.settings());
    }

    /// Takes one step and shows what came of it.
    pub(crate) fn step(&mut self) {
        self.take_step();
        self.alpha = 1.0;
    }

    fn take_step(&mut self) {
        self.trails.before_step(self.simulation.steps(), &self.world);
        // Every body has an identity; if one could not be saved, there would be no way back.
        if self.past.as_mut().is_some_and(|past| past.save(&self.world, &self.simulation).is_err()) {
            self.past = None;
        }
        match &self.times {
            Some(times) => self.simulation.step_timed(&mut self.world, times),
            None => self.simulation.step(&mut self.world),
        }
    }

    /// Takes the steps that fall into a frame of a simulated length, within a time limit; whether
    /// there was time for them all.
    pub(crate) fn advance(&mut self, seconds: f64, budget: Duration) -> bool {
        let (started, dt) = (Instant::now(), self.dt());
        if seconds > 0.0 && seconds.is_finite() {
            self.owed += seconds;
        }
        let (mut taken, mut in_time) = (0, true);
        while self.owed >= dt {
            if taken > 0 && started.elapsed() > budget {
                self.owed %= dt;
                in_time = false;
                break;
            }
            self.take_step();
            self.owed -= dt;
            taken += 1;
        }
        // A quotient just below one may round up to it.
        self.alpha = real(self.owed / dt).min(1.0 - Real::EPSILON);
        in_time
    }

    /// Takes steps until this time, which may be between two of them \[s\]. Time does not go back.
    pub(crate) fn go_to(&mut self, time: f64) {
        let steps = time / self.dt();
        // A step of 0.01 s is a little less in single precision, and 100 of them a little less than
        // a second.
        let near = AT_STEP.max(steps * f64::from(Real::EPSILON));
        let whole = (steps - near).ceil().max(0.0);
        let missing = (whole as u64).saturating_sub(self.simulation.steps());
        self.step_many(missing);
        let behind = (whole - steps).clamp(0.0, 1.0);
        self.alpha = if behind <= near { 1.0 } else { real(1.0 - behind) };
    }

    fn step_many(&mut self, mut count: u64) {
        while count > 0 {
            let step = self.simulation.steps();
            self.trails.before_step(step, &self.world);
            let together = self.trails.steps_to_next(step).min(count);
            let together = u32::try_from(together).unwrap_or(u32::MAX);
            self.simulation.step_many(&mut self.world, together);
            count -= u64::from(together);
        }
    }

    /// Whether the course is the scene's own, as the program runs it.
    pub(crate) fn is_untouched(&self) -> bool {
        !(self.interfered || self.settings_changed)
    }

    /// Of the state that steps have reached.
    pub(crate) fn hash(&self) -> u64 {
        tumble::state_hash(&self.world, &self.order)
    }

    /// Energy and momentum now.
    pub(crate) fn totals(&self) -> Totals {
        Totals::of(&self.world, self.simulation.settings(), &self.order)
    }
}

/// Simulated seconds to a second, so that a scene can be watched.
pub(crate) fn pace(scene: &Scene) -> f64 {
    let length = scene.steps as f64 * f64::from(scene.settings.dt);
    if REAL_TIME.contains(&length) || length <= 0.0 { 1.0 } else { length / WATCHED }
}

/// What moves is drawn between steps, for which the step keeps the pose before.
fn remember_poses(world: &mut World) {
    let moving: Vec<(Entity, Pose)> =
        world.query_mut::<(Entity, &Pose, &Velocity)>().into_iter().map(|(entity, pose, _)| (entity, *pose)).collect();
    for (entity, pose) in moving {
        // The entity was found in this world a moment ago, so inserting cannot fail.
        let inserted = world.insert_one(entity, PreviousPose(pose));
        debug_assert!(inserted.is_ok());
    }
}

fn moving(bodies: &Bodies) -> Vec<Entity> {
    bodies.all.iter().filter(|body| body.moves).map(|body| body.entity).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use tumble::glam::DVec3;

    use super::*;

    pub(crate) fn open(scene: &str) -> Playback {
        Playback::of(Scene::open(scene).unwrap()).unwrap()
    }

    #[test]
    fn scenes_are_watched_in_half_a_minute_or_in_real_time() {
        assert_eq!(pace(&Scene::open("t-handle").unwrap()), 1.0);
        // Twelve years and a day in steps of a day.
        assert_eq!(pace(&Scene::open("solar-system").unwrap()), 4383.0 * 86_400.0 / 30.0);
    }

    /// Frames of any length take the steps that a run takes, with the same bits.
    #[test]
    fn what_is_seen_is_what_a_run_does() {
        let mut seen = open("raft");
        // Frames of two steps and a half, and one that is longer than what `Simulation::advance`
        // would take at once.
        for _ in 0..8 {
            assert!(seen.advance(0.025, Duration::MAX));
        }
        assert!(seen.advance(0.5, Duration::MAX));
        seen.go_to(1.0);
        let mut run = open("raft");
        run.go_to(1.0);
        assert_eq!((seen.simulation.steps(), run.simulation.steps()), (100, 100));
        assert_eq!(seen.hash(), run.hash());
    }

    #[test]
    fn a_moment_between_steps_is_shown_between_them() {
        let mut playback = open("satellite");
        let x_at = |playback: &mut Playback, time: f64| {
            playback.go_to(time);
            // A rounding of single precision, of steps of a second.
            assert!((playback.time() - time).abs() < 1e-6, "{}", playback.time());
            playback.place()[0].center
        };
        let places: Vec<DVec3> = [10.0, 10.25, 11.0].into_iter().map(|time| x_at(&mut playback, time)).collect();
        let expected = places[0].lerp(places[2], 0.25);
        // Positions of 1750 m have roundings of 1e-4 m in single precision.
        assert!((places[1] - expected).length() < 3e-4, "{places:?}");
        assert_eq!(playback.simulation.steps(), 11);
    }

    #[test]
    fn a_restart_is_the_beginning() {
        for scene in ["raft", "t-handle", "solar-system", "pyramid"] {
            let mut playback = open(scene);
            let (beginning, place) = (playback.hash(), playback.place()[0].center);
            for _ in 0..10 {
                playback.step();
            }
            let after = playback.hash();
            assert_ne!(after, beginning);
            playback.restart().unwrap();
            assert_eq!((playback.hash(), playback.place()[0].center), (beginning, place), "{scene}");
            assert_eq!((playback.simulation.steps(), playback.time()), (0, 0.0));
            for _ in 0..10 {
                playback.step();
            }
            assert_eq!(playback.hash(), after, "{scene}");
        }
    }

    #[test]
    fn a_step_is_taken_back_to_the_bit() {
        let mut playback = open("raft");
        assert!(!playback.step_back(), "nothing is kept yet");
        playback.keep_past();
        let hashes: Vec<u64> = (0..20)
            .map(|_| {
                playback.step();
                playback.hash()
            })
            .collect();
        for before in hashes.iter().rev().skip(1) {
            assert!(playback.step_back());
            assert_eq!(playback.hash(), *before);
        }
        assert!(playback.step_back() && !playback.step_back(), "before the first step there is none");
        playback.step();
        assert_eq!(playback.hash(), hashes[0]);
    }

    #[test]
    fn the_past_is_bounded() {
        let mut playback = open("satellite");
        playback.keep_past();
        (0..MAX_BACK + 10).for_each(|_| playback.step());
        assert_eq!((0..2 * MAX_BACK).take_while(|_| playback.step_back()).count(), MAX_BACK);
        assert_eq!(playback.simulation.steps(), 10);
    }

    #[test]
    fn steps_that_are_measured_have_the_same_bits() {
        let run = |times: Option<PhaseTimes>| {
            let mut playback = open("raft");
            playback.times = times;
            assert!(playback.advance(0.205, Duration::MAX));
            playback.hash()
        };
        assert_eq!(run(None), run(Some(PhaseTimes::default())));
    }

    /// A frame that is too long is left off, so that the next is not longer still.
    #[test]
    fn there_is_an_end_to_a_frame() {
        let mut playback = open("raft");
        // Each is over after one step, the least that can be taken.
        for frame in 1..=5 {
            assert!(!playback.advance(1e9, Duration::ZERO));
            assert_eq!(playback.simulation.steps(), frame);
        }
        assert!(playback.advance(3.0 * playback.dt(), Duration::MAX));
        // A rounding may leave the last step to the next frame.
        assert!((7..=8).contains(&playback.simulation.steps()), "{}", playback.simulation.steps());
    }
}
