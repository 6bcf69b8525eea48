//! The simulation: settings, force laws, time keeping and fixed-step frame advance.

use hecs::{Component, World};

use crate::clock::Clock;
use crate::collision::contact_events::ContactEvent;
use crate::collision::contact_hook::{ContactHook, ContactProposal};
use crate::collision::sensors::SensorEvent;
use crate::forces::force_law::ForceLaw;
use crate::forces::registry::ForceLaws;
use crate::forces::simd_force_law::SimdForceLaw;
use crate::joints::joint_event::JointEvent;
use crate::math::Real;
use crate::queries::query_cache::QueryCache;
use crate::queries::world_queries::Queries;
use crate::settings::{Settings, SettingsError};
use crate::step::interacting::InteractingWorld;
use crate::step::interactions::Interactions;
use crate::step::phase_times::PhaseTimes;
use crate::step::population::Population;
use crate::step::steps_under_laws;

/// Steps a world with validated settings and keeps the time.
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let brick = RigidBody::new(Shape::cuboid([0.1, 0.05, 0.03]))
///     .mass(2.0)
///     .angular_velocity(Vec3::new(0.1, 5.0, 0.1))
///     .build()?
///     .spawn(&mut world);
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// for _ in 0..60 {
///     simulation.step(&mut world);
/// }
/// let pose = world.get::<&Pose>(brick)?;
/// assert!((pose.position.y + 0.5 * 9.81).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("PhysicsWorld", "PhysicsPipeline", "ccd", "bullet", "continuous collision detection", "sleeping"))]
#[derive(Clone, Debug)]
pub struct Simulation {
    settings: Settings,
    laws: ForceLaws,
    /// Springs, mutual gravity and contacts of the last step; none until there are any.
    pub(crate) interactions: Option<Box<Interactions>>,
    /// Contact events of the last call, of the steps taken one by one before its last.
    pub(crate) events: Vec<ContactEvent>,
    /// The same of joints.
    pub(crate) joint_events: Vec<JointEvent>,
    /// The same of sensors.
    pub(crate) sensor_events: Vec<SensorEvent>,
    /// Whether the last call took a step.
    pub(crate) has_stepped: bool,
    steps: u64,
    /// Steps and time \[s\] when the settings were last changed; from there on time is a multiple
    /// of the step.
    since: (u64, f64),
    /// Frame time that no step has covered yet \[s\], in [0, dt).
    owed: f64,
    queries: QueryCache,
    #[cfg(feature = "tracing")]
    mistakes: crate::step::mistakes::Mistakes,
}

/// Callbacks before and after every step of
/// [`advance_with_hooks`](Simulation::advance_with_hooks).
///
/// ```
/// # use tumble::{Simulation, StepHooks, hecs::World};
/// #[derive(Default)]
/// struct Counter(u64);
///
/// impl StepHooks for Counter {
///     fn after_step(&mut self, _: &mut World, simulation: &Simulation) {
///         self.0 = simulation.steps();
///     }
/// }
/// ```
pub trait StepHooks {
    /// With the world and the simulation as the last step left them: the place to add the forces of
    /// the next.
    fn before_step(&mut self, _world: &mut World, _simulation: &Simulation) {}

    /// With the world and the simulation as the step left them:
    /// [`contact_events`](Simulation::contact_events) gives those of this step.
    fn after_step(&mut self, _world: &mut World, _simulation: &Simulation) {}
}

/// Calls a closure before every step.
struct BeforeStep<F>(F);

impl<F: FnMut(&mut World, &Simulation)> StepHooks for BeforeStep<F> {
    fn before_step(&mut self, world: &mut World, simulation: &Simulation) {
        (self.0)(world, simulation);
    }
}

impl Simulation {
    /// The most steps that one [`advance`](Self::advance) takes; the time beyond is dropped, so
    /// that a slow frame is not followed by slower ones.
    pub const MAX_STEPS_PER_FRAME: u32 = 8;

    /// A simulation at time zero.
    ///
    /// # Errors
    /// [`SettingsError`] where the settings are ones that nothing can be simulated with.
    pub fn new(settings: Settings) -> Result<Self, SettingsError> {
        settings.validate()?;
        Ok(Self {
            settings,
            laws: ForceLaws::default(),
            interactions: None,
            events: Vec::new(),
            joint_events: Vec::new(),
            sensor_events: Vec::new(),
            has_stepped: false,
            steps: 0,
            since: (0, 0.0),
            owed: 0.0,
            queries: QueryCache::default(),
            #[cfg(feature = "tracing")]
            mistakes: crate::step::mistakes::Mistakes::default(),
        })
    }

    /// The settings of the simulation.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Goes on with other settings; time and state stay.
    ///
    /// # Errors
    /// [`SettingsError`], and the old settings stay.
    pub fn set_settings(&mut self, settings: Settings) -> Result<(), SettingsError> {
        settings.validate()?;
        self.since = (self.steps, self.time());
        self.settings = settings;
        Ok(())
    }

    /// Questions about the bodies of a world as they are now: what rays meet, what is near a point,
    /// what a shape overlaps or is stopped by.
    ///
    /// The simulation keeps what is made for that, by which the next time costs a comparison for
    /// each body, and more for those that have moved. It may be called from any thread.
    ///
    /// # Panics
    /// Like every query of hecs, while the caller holds a mutable reference to poses, colliders,
    /// centres of mass or ids.
    ///
    /// ```
    /// use tumble::{Collider, QueryFilter, Ray, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// let collider = Collider::new(&Shape::sphere(0.5))?;
    /// let ball = RigidBody::new(Shape::sphere(0.5))
    ///     .mass(1.0)
    ///     .build()?
    ///     .spawn_with(&mut world, (collider,));
    ///
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step_many(&mut world, 60);
    /// let down = Ray::new(Vec3::ZERO, -Vec3::Y);
    /// let hit = simulation.queries(&world).cast_ray(&down, &QueryFilter::new()).unwrap();
    /// assert_eq!(hit.entity, ball);
    /// assert!((hit.distance - (0.5 * 9.81 - 0.5)).abs() < 1e-3); // it has fallen for a second
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias("raycast", "shapecast"))]
    pub fn queries<'a>(&self, world: &'a World) -> Queries<'a> {
        self.queries.of(world)
    }

    /// Makes a [`ForceLaw`] known that is a component of the bodies it acts on.
    pub fn add_law<L: ForceLaw + Component>(&mut self) {
        self.laws.add::<L>();
    }

    /// Adds a [`ForceLaw`] that acts on every moving body.
    pub fn add_global_law<L: ForceLaw>(&mut self, law: L) {
        self.laws.add_global(law);
    }

    /// Makes a [`SimdForceLaw`] known that is a component of the bodies it acts on. The force
    /// components of this crate need not be added.
    pub fn add_simd_law<L: SimdForceLaw<N> + Component, const N: usize>(&mut self) {
        self.laws.add_simd_law::<L, N>();
    }

    /// Adds a [`SimdForceLaw`] that acts on every moving body: one of the caller's own, or a force
    /// component of this crate.
    pub fn add_global_simd_law<L: SimdForceLaw<N>, const N: usize>(&mut self, law: L) {
        self.laws.add_global_simd_law::<L, N>(law);
    }

    /// The force laws that were added.
    pub fn laws(&self) -> &ForceLaws {
        &self.laws
    }

    /// How many steps have been taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Simulated time \[s\].
    pub fn time(&self) -> f64 {
        self.clock().time()
    }

    /// Where the simulation stands in time: what a run is continued from, beside the state of the
    /// bodies.
    pub fn clock(&self) -> Clock {
        Clock { steps: self.steps, since: self.since, dt: self.settings.dt, owed: self.owed }
    }

    /// Goes on from where this or another simulation stood. With another step than that had, time
    /// goes on from there in steps of its own.
    pub fn set_clock(&mut self, clock: Clock) {
        self.steps = clock.steps;
        self.owed = clock.owed;
        self.since = if clock.dt == self.settings.dt { clock.since } else { (clock.steps, clock.time()) };
    }

    /// Advances the world by one step of `settings.dt`; see [`step`](crate::step()).
    #[doc(alias("update", "tick"))]
    pub fn step(&mut self, world: &mut World) {
        self.step_many(world, 1);
    }

    /// Advances the world by `count` steps, with the same bits as `count` calls of
    /// [`step`](Self::step).
    ///
    /// For when nothing is read or changed in between: bodies that nothing couples stay in
    /// registers from the first step to the last. [`contact_events`](Self::contact_events) then
    /// gives those of all the steps.
    pub fn step_many(&mut self, world: &mut World, count: u32) {
        self.advance_by(world, count, None);
    }

    /// [`step`](Self::step), adding to `times` how long each system took. The systems run one after
    /// the other on each chunk of bodies then, which takes longer than a step that no one times.
    pub fn step_timed(&mut self, world: &mut World, times: &PhaseTimes) {
        self.advance_by(world, 1, Some(times));
    }

    fn advance_by(&mut self, world: &mut World, count: u32, times: Option<&PhaseTimes>) {
        self.forget_events();
        self.has_stepped = count > 0;
        if count > 0 {
            #[cfg(feature = "tracing")]
            self.mistakes.warn(world);
            let mut interactions = self.interactions.take();
            steps_under_laws(world, &self.settings, &self.laws, &mut interactions, count, self.clock(), times);
            self.interactions = interactions;
            self.count_steps(count);
            #[cfg(feature = "tracing")]
            self.mistakes.remember(world);
        }
    }

    /// Has a function see every contact before it is solved: it may change what friction and
    /// restitution do there, and refuse it. See [`ContactProposal`].
    ///
    /// It is called in every substep of the settings, from any thread and in no order, with bodies
    /// that touch or may in the next; so that runs can be repeated, it should depend on nothing but
    /// what it gets and what only changes between steps. It replaces the one before it. It is no
    /// state: snapshots do not hold it, and a [`restore`](Self::restore) leaves it. A
    /// [`Batch`](crate::Batch) steps worlds with hooks one by one.
    pub fn set_contact_hook(&mut self, hook: impl Fn(&mut ContactProposal) + Send + Sync + 'static) {
        self.interactions.get_or_insert_default().contact_hook = Some(ContactHook::new(hook));
    }

    /// Takes the hook away again.
    pub fn clear_contact_hook(&mut self) {
        if let Some(interactions) = &mut self.interactions {
            interactions.contact_hook = None;
        }
    }

    /// Whether contacts are shown to a hook.
    pub(crate) fn has_contact_hook(&self) -> bool {
        self.interactions.as_ref().is_some_and(|interactions| interactions.contact_hook.is_some())
    }

    /// The world with its interactions, if bodies act on each other in it.
    pub(crate) fn interacting<'a>(&'a mut self, world: &'a mut World) -> Option<InteractingWorld<'a>> {
        if !Population::of(world, &self.laws).interacts() {
            return None;
        }
        self.forget_events();
        self.has_stepped = true;
        let clock = self.clock();
        let interactions = self.interactions.get_or_insert_default();
        Some(InteractingWorld::new(world, &self.settings, &self.laws, interactions, clock))
    }

    /// The same in the course of a step, as far as it is known what acts between which bodies.
    pub(crate) fn interacting_as_known<'a>(&'a mut self, world: &'a World) -> InteractingWorld<'a> {
        let clock = self.clock();
        let interactions = self.interactions.get_or_insert_default();
        InteractingWorld::of_known(world, &self.settings, &self.laws, interactions, clock)
    }

    /// Counts steps that were taken by other means than [`step_many`](Self::step_many).
    pub(crate) fn count_steps(&mut self, count: u32) {
        self.steps += u64::from(count);
    }

    /// Takes as many whole steps as fit into the frame time that has passed, and keeps the rest for
    /// the next frame.
    ///
    /// Returns `alpha`, how far the frame is from the last step to the next, in
    /// [0, 1). Bodies with a [`PreviousPose`](crate::PreviousPose) are drawn at
    /// `previous.0.interpolate(&pose, alpha)`: smooth at any frame rate, one step late. A frame
    /// time that is not positive and finite counts as none. A frame of one step is
    /// `f64::from(settings.dt)`: in `f32` a `dt` of `1.0 / 60.0` is a little longer than that in
    /// `f64`, so that the first of such frames has no step.
    ///
    /// A frame has no step, or several: a [`Wrench`](crate::Wrench) added once a frame acts in the
    /// first of them only, and where there is none it waits and the next comes on top of it. Forces
    /// belong into [`advance_with`](Self::advance_with), or into a [`ForceLaw`].
    ///
    /// ```
    /// # use tumble::{Settings, Simulation};
    /// # let mut world = hecs::World::new();
    /// let mut simulation = Simulation::new(Settings::default().with_dt(0.01))?;
    /// let alpha = simulation.advance(&mut world, 0.025);
    /// assert_eq!(simulation.steps(), 2);
    /// assert!((alpha - 0.5).abs() < 1e-4);
    /// # Ok::<(), tumble::SettingsError>(())
    /// ```
    #[doc(alias("fixed timestep", "accumulator"))]
    pub fn advance(&mut self, world: &mut World, frame_seconds: f64) -> Real {
        self.advance_with(world, frame_seconds, |_, _| ())
    }

    /// [`advance`](Self::advance), calling `before_step` before every step with the world and the
    /// simulation as the last step left it: the place to add the forces of that step.
    ///
    /// [`contact_events`](Self::contact_events) gives there what began and ended to touch in the
    /// last step alone, whatever frame it was taken in: who reads it there in every step misses
    /// nothing and gets nothing twice. After the call it gives the events of all steps that the
    /// frame has taken.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// # let mut world = hecs::World::new();
    /// # let body = RigidBody::new(Shape::Point).mass(1.0).build()?.spawn(&mut world);
    /// let mut simulation =
    ///     Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(0.01))?;
    /// simulation.advance_with(&mut world, 0.055, |world, _| {
    ///     for wrench in world.query_mut::<&mut Wrench>() {
    ///         wrench.add_force(Vec3::X * 2.0);
    ///     }
    /// });
    /// // Five steps, a hundredth of a second each.
    /// assert!((world.get::<&Momentum>(body)?.linear.x - 0.1).abs() < 1e-6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn advance_with(
        &mut self,
        world: &mut World,
        frame_seconds: f64,
        before_step: impl FnMut(&mut World, &Self),
    ) -> Real {
        self.advance_with_hooks(world, frame_seconds, &mut BeforeStep(before_step))
    }

    /// [`advance`](Self::advance), calling `hooks` before and after every step.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// # use tumble::StepHooks;
    /// # let mut world = hecs::World::new();
    /// # let body = RigidBody::new(Shape::Point).mass(1.0).build()?.spawn(&mut world);
    /// #[derive(Default)]
    /// struct Game {
    ///     heights: Vec<Real>,
    /// }
    ///
    /// impl StepHooks for Game {
    ///     fn after_step(&mut self, world: &mut hecs::World, _: &Simulation) {
    ///         self.heights
    ///             .extend(world.query_mut::<&Pose>().into_iter().map(|pose| pose.position.y));
    ///     }
    /// }
    ///
    /// let (mut game, mut simulation) =
    ///     (Game::default(), Simulation::new(Settings::default().with_dt(0.01))?);
    /// simulation.advance_with_hooks(&mut world, 0.035, &mut game);
    /// assert_eq!(game.heights.len(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn advance_with_hooks(&mut self, world: &mut World, frame_seconds: f64, hooks: &mut impl StepHooks) -> Real {
        let dt = f64::from(self.settings.dt);
        if frame_seconds > 0.0 && frame_seconds.is_finite() {
            self.owed += frame_seconds;
        }
        let mut taken = 0;
        let mut events = std::mem::take(&mut self.events);
        let mut joint_events = std::mem::take(&mut self.joint_events);
        let mut sensor_events = std::mem::take(&mut self.sensor_events);
        events.clear();
        joint_events.clear();
        sensor_events.clear();
        while self.owed >= dt && taken < Self::MAX_STEPS_PER_FRAME {
            self.forget_earlier_events();
            self.has_stepped = true;
            hooks.before_step(world, self);
            if taken > 0 {
                events.extend(self.contact_events());
                joint_events.extend(self.joint_events());
                sensor_events.extend(self.sensor_events());
            }
            self.step(world);
            hooks.after_step(world, self);
            self.owed -= dt;
            taken += 1;
        }
        (self.events, self.joint_events, self.sensor_events) = (events, joint_events, sensor_events);
        self.has_stepped = taken > 0;
        if self.owed >= dt {
            self.owed %= dt;
        }
        // A quotient just below one may round up to it.
        crate::math::real(self.owed / dt).min(1.0 - Real::EPSILON)
    }
}
