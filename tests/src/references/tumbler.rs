//! Reference cases of free rotation, with the results of other engines.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use serde_json::Value;
use tumble::math::Real;
use tumble::{Inertia, InertiaTensor, Integrator, Momentum, Pose, RigidBody, Shape};

use super::json::{double_quat, number, parse, quaternion, real_vec3, vector};
use crate::comparison::{attitude_error, dquat, dvec3};
use crate::simulation::weightless;

/// A free body that eight other engines were run on, for 600 s at 60 steps a second.
#[derive(Clone, Debug)]
pub struct Tumbler {
    /// What it is called.
    pub name: String,
    /// Principal moments [kg m^2].
    pub moments: DVec3,
    /// Angular velocity at time zero, when its frame is that of the world [rad/s].
    pub angular_velocity: DVec3,
    /// How often its middle axis turns over in 600 s.
    pub flips: u32,
    /// Exact orientations at some times \[s\].
    pub attitudes: Vec<(f64, DQuat)>,
    /// What the others made of it.
    pub peers: Vec<PeerRow>,
}

/// One engine's figures.
#[derive(Clone, Debug)]
pub struct PeerRow {
    /// Engine and how it was set.
    pub engine: String,
    /// Largest relative error of energy over 600 s, with its sign.
    pub energy: f64,
    /// Largest relative error of the length of angular momentum over 600 s, with its sign.
    pub momentum: f64,
    /// Flips in 600 s.
    pub flips: u32,
    /// Attitude error after 10 s \[degrees\].
    pub attitude: f64,
}

/// What a run of ours made of it.
#[derive(Clone, Debug, Default)]
pub struct Tumbling {
    /// Largest relative error of energy, with its sign.
    pub energy: f64,
    /// Whether the angular momentum in the world is that of the start, to the bit, after every
    /// step.
    pub momentum_kept: bool,
    /// Largest difference of the length of the orientation from one.
    pub unit: f64,
    /// Flips.
    pub flips: u32,
    /// Flips that the energy of each step calls for: time over the half period that belongs to it.
    pub flips_by_energy: f64,
    /// Attitude errors \[rad\] at the times of [`Tumbler::attitudes`] that the run came to.
    pub attitudes: Vec<(f64, f64)>,
}

impl Tumbler {
    /// I = (1, 2, 3), all but on its middle axis at 5 rad/s.
    pub fn t_handle() -> Self {
        Self::read("thandle")
    }

    /// I = (1, 1.5, 2), far from any axis.
    pub fn polhode() -> Self {
        Self::read("polhode")
    }

    #[allow(clippy::expect_used, reason = "the files are part of this package")]
    fn read(name: &str) -> Self {
        let file = parse(include_str!("../../data/peers/w2.json"));
        let case = &file["cases"][name];
        let list = |value: &Value| value.as_array().expect("a list").clone();
        Self {
            name: name.to_owned(),
            moments: vector(&case["moments"]),
            angular_velocity: vector(&case["angular_velocity"]),
            flips: number(&case["flips"]) as u32,
            attitudes: list(&case["attitudes"])
                .iter()
                .map(|row| (number(&row["time"]), quaternion(&row["orientation"])))
                .collect(),
            peers: list(&case["peers"]).iter().map(PeerRow::read).collect(),
        }
    }

    /// Spawns it as it is at time zero.
    #[allow(clippy::expect_used, reason = "the bodies in the files are possible")]
    pub fn spawn(&self, world: &mut World) -> Entity {
        let inertia = InertiaTensor::from_principal(self.moments, DQuat::IDENTITY).expect("possible moments");
        let body = RigidBody::new(Shape::Point).mass(1.0).inertia(inertia);
        body.angular_velocity(real_vec3(self.angular_velocity)).build().expect("a possible body").spawn(world)
    }

    /// Runs it and looks at it after every step.
    #[allow(clippy::expect_used, reason = "the settings and the body are possible")]
    pub fn run(&self, integrator: Integrator, dt: Real, steps: u64) -> Tumbling {
        let mut world = World::new();
        let entity = self.spawn(&mut world);
        let mut simulation = weightless(integrator, dt);
        let mut query = world.query_one::<(&Momentum, &Inertia)>(entity);
        let (momentum, inertia) = query.get().map(|(m, i)| (*m, *i)).expect("a body that turns");
        drop(query);
        let mut watch = Watch::new(dvec3(momentum.angular), dvec3(inertia.moments()));
        let mut marks = self.attitudes.iter().peekable();
        let mut result = Tumbling { momentum_kept: true, ..Tumbling::default() };
        for _ in 0..steps {
            simulation.step(&mut world);
            let (pose, now) = (world.get::<&Pose>(entity), world.get::<&Momentum>(entity));
            let (pose, now) = (*pose.expect("a body"), *now.expect("a body that moves"));
            result.momentum_kept &= now == momentum;
            watch.see(double_quat(pose.orientation), dvec3(now.angular), &mut result);
            result.flips_by_energy += f64::from(dt) / watch.half_period;
            if let Some((time, exact)) = marks.next_if(|mark| mark.0 <= simulation.time() + 0.5 * f64::from(dt)) {
                result.attitudes.push((*time, attitude_error(dquat(pose.orientation), *exact)));
            }
        }
        result
    }
}

impl Tumbling {
    /// Attitude error \[degrees\] after some seconds.
    pub fn attitude_after(&self, seconds: f64) -> f64 {
        self.attitudes.iter().find(|mark| mark.0 == seconds).map_or(f64::NAN, |mark| mark.1.to_degrees())
    }
}

impl PeerRow {
    fn read(row: &Value) -> Self {
        Self {
            engine: row["engine"].as_str().unwrap_or_default().to_owned(),
            energy: number(&row["energy"]),
            momentum: number(&row["momentum"]),
            flips: number(&row["flips"]) as u32,
            attitude: number(&row["attitude_10s_deg"]),
        }
    }
}

/// What is watched of a run.
struct Watch {
    moments: DVec3,
    energy: f64,
    /// Whether the middle axis was last seen along the angular momentum.
    upright: bool,
    /// Time \[s\] from one flip to the next at the present energy.
    half_period: f64,
}

impl Watch {
    fn new(momentum: DVec3, moments: DVec3) -> Self {
        Self { moments, energy: (momentum * momentum / moments).element_sum(), upright: true, half_period: f64::NAN }
    }

    /// The axis has flipped when it is a fifth past the middle, as in the runs of the other
    /// engines: so noise is not counted.
    fn see(&mut self, orientation: DQuat, momentum: DVec3, result: &mut Tumbling) {
        let length = orientation.length_squared().sqrt();
        let difference = (length - 1.0).abs();
        result.unit = if difference > result.unit || difference.is_nan() { difference } else { result.unit };
        let body = orientation.normalize().conjugate() * momentum;
        let double_energy = (body * body / self.moments).element_sum();
        self.half_period = half_period(self.moments, double_energy, momentum.length_squared());
        let energy = double_energy / self.energy - 1.0;
        if energy.abs() > result.energy.abs() || energy.is_nan() {
            result.energy = energy;
        }
        let along = body.y / momentum.length();
        if (self.upright && along < -0.2) || (!self.upright && along > 0.2) {
            self.upright = !self.upright;
            result.flips += 1;
        }
    }
}

/// Half the period of the middle component of the angular velocity, `2 K(m)/lambda` \[s\], from
/// twice the energy and the squared angular momentum (L. D. Landau, E. M. Lifshitz, "Mechanics",
/// section 37); moments in rising order.
fn half_period(moments: DVec3, double_energy: f64, squared: f64) -> f64 {
    let [i1, i2, i3] = moments.to_array();
    let (from_least, from_most) = (squared - double_energy * i1, double_energy * i3 - squared);
    let about_most = (i3 - i2) * from_least;
    let about_least = (i2 - i1) * from_most;
    // The complete elliptic integral by the arithmetic-geometric mean of 1 and sqrt(1 - m).
    let (mut a, mut g) = (1.0, (1.0 - about_least.min(about_most) / about_least.max(about_most)).sqrt());
    for _ in 0..8 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    std::f64::consts::PI / a / (about_least.max(about_most) / (i1 * i2 * i3)).sqrt()
}
