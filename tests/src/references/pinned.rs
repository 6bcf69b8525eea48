//! Reference cases of bodies with a fixed point under gravity: tops and pendulums.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use serde_json::Value;
use tumble::math::{Real, Vec3};
use tumble::{
    BodyState, ForceLaw, InertiaTensor, Integrator, Pose, RigidBody, Settings, Shape, Simulation, Velocity, Wrench,
};

use super::json::{number, parse, quaternion, real_quat, real_vec3, vector};
use crate::comparison::{dquat, dvec3};

/// A body that turns about a fixed point under gravity.
///
/// For the engine it is a free body whose inertia is that about the fixed point: then the equation
/// of its rotation is that of the pinned body, with gravity's torque as a [`PinnedGravity`]. Its
/// centre of mass stays where it is and plays no part.
#[derive(Clone, Debug)]
pub struct Pinned {
    /// The body's part of the file.
    pub file: Value,
    /// Principal moments about the fixed point, along the body's axes [kg m^2].
    pub inertia: DVec3,
    /// The centre of mass, from the fixed point along the body's axes \[m\].
    pub center: DVec3,
    /// Weight \[N\].
    pub weight: f64,
    /// At time zero, body to world.
    pub orientation: DQuat,
    /// At time zero, along the body's axes [rad/s].
    pub angular_velocity: DVec3,
}

/// Gravity's torque about the fixed point, `r x m g`, along -z.
#[derive(Clone, Copy, Debug)]
pub struct PinnedGravity {
    /// The centre of mass, from the fixed point along the body's axes \[m\].
    pub center: Vec3,
    /// Weight \[N\].
    pub weight: Real,
}

impl ForceLaw for PinnedGravity {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: Vec3::ZERO, torque: state.to_world(self.center).cross(Vec3::NEG_Z * self.weight) }
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }

    fn potential(&self, state: &BodyState<'_>) -> f64 {
        f64::from(self.weight) * dvec3(state.to_world(self.center)).z
    }
}

/// A pinned body while it is simulated.
pub struct PinnedRun {
    /// Holds the body.
    pub world: World,
    /// Steps it.
    pub simulation: Simulation,
    body: Entity,
}

impl Pinned {
    /// One of `heavy_top`, `lagrange_top`, `pendulum_10` and `pendulum_90`.
    pub fn read(name: &str) -> Self {
        let file = parse(include_str!("../../data/tops/tops.json"))[name].clone();
        Self {
            inertia: vector(&file["inertia"]),
            center: vector(&file["center"]),
            weight: number(&file["mass"]) * number(&file["gravity"]),
            orientation: quaternion(&file["orientation"]),
            angular_velocity: vector(&file["angular_velocity"]),
            file,
        }
    }

    /// The body at time zero, about to be simulated.
    #[allow(clippy::expect_used, reason = "the bodies in the file are possible")]
    #[cfg_attr(feature = "f64", allow(clippy::unnecessary_cast, reason = "the cast is one in the other precision"))]
    pub fn start(&self, integrator: Integrator, dt: Real) -> PinnedRun {
        let mut world = World::new();
        let inertia = InertiaTensor::from_principal(self.inertia, DQuat::IDENTITY).expect("possible moments");
        let body = RigidBody::new(Shape::Point).mass(1.0).inertia(inertia).orientation(real_quat(self.orientation));
        let body = body.angular_velocity(real_vec3(self.orientation * self.angular_velocity));
        let body = body.build().expect("a possible body").spawn(&mut world);
        let law = PinnedGravity { center: real_vec3(self.center), weight: self.weight as Real };
        world.insert_one(body, law).expect("the body is there");
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(dt).with_integrator(integrator);
        let mut simulation = Simulation::new(settings).expect("possible settings");
        simulation.add_law::<PinnedGravity>();
        PinnedRun { world, simulation, body }
    }
}

impl PinnedRun {
    /// Steps on to a time \[s\].
    pub fn run_to(&mut self, time: f64) {
        let half = 0.5 * f64::from(self.simulation.settings().dt);
        while self.simulation.time() + half < time {
            self.simulation.step(&mut self.world);
        }
    }

    /// Body to world.
    #[allow(clippy::expect_used, reason = "the body is there")]
    pub fn orientation(&self) -> DQuat {
        dquat(self.world.get::<&Pose>(self.body).expect("a body").orientation)
    }

    /// In the world frame [rad/s].
    #[allow(clippy::expect_used, reason = "the body is there")]
    pub fn angular_velocity(&self) -> DVec3 {
        dvec3(self.world.get::<&Velocity>(self.body).expect("a body").angular)
    }
}
