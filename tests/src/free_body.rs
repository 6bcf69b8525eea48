//! Exact solutions of bodies on which no torque acts, from the files in `data/free_body`.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use serde_json::Value;
use tumble::{InertiaTensor, RigidBody, Shape};

use crate::references::{number, parse, quaternion, real_vec3, vector};

/// A body that turns freely, with its exact motion at some times.
///
/// At time zero its frame, which is principal, is that of the world.
#[derive(Clone, Debug)]
pub struct FreeBody {
    /// What it is called.
    pub name: &'static str,
    /// Principal moments [kg m^2].
    pub moments: DVec3,
    /// Angular velocity at time zero [rad/s].
    pub angular_velocity: DVec3,
    /// Rotational energy \[J\].
    pub energy: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// How its centre of mass moves, where the source says.
    pub translation: Option<Translation>,
    /// Its elliptic functions, where it has three different moments.
    pub elliptic: Option<Elliptic>,
    /// The exact rotation.
    pub samples: Vec<Sample>,
}

/// A throw: the centre of mass at time zero, and gravity.
#[derive(Clone, Copy, Debug)]
pub struct Translation {
    /// Position \[m\].
    pub position: DVec3,
    /// Velocity [m/s].
    pub linear_velocity: DVec3,
    /// Acceleration of gravity [m/s^2].
    pub gravity: DVec3,
}

/// Parameters of the Jacobi elliptic functions that the angular velocity is made of.
#[derive(Clone, Copy, Debug)]
pub struct Elliptic {
    /// The parameter `m`, the square of the modulus; one on the separatrix.
    pub parameter: f64,
    /// The frequency `lambda` [1/s].
    pub frequency: f64,
    /// Time from one reversal of the spin about the middle axis to the next \[s\].
    pub flip_interval: f64,
}

/// The exact rotation at one time.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Time \[s\].
    pub time: f64,
    /// Body frame to world.
    pub orientation: DQuat,
    /// In the body frame [rad/s].
    pub angular_velocity_body: DVec3,
}

impl FreeBody {
    /// The top of van Zon and Schofield: spins near its middle axis and flips every 1.17 s.
    pub fn van_zon_top() -> Self {
        Self::read("van_zon_top", include_str!("../data/free_body/van_zon_top.json"))
    }

    /// Drake's axisymmetric cylinder, thrown.
    pub fn drake_cylinder() -> Self {
        Self::read("drake_cylinder", include_str!("../data/free_body/drake_cylinder.json"))
    }

    /// The T-handle of Dzhanibekov: all but on the separatrix, flips every 1.43 s.
    pub fn t_handle() -> Self {
        Self::read("t_handle", include_str!("../data/free_body/t_handle.json"))
    }

    /// The box of MuJoCo's tests of its integrators.
    pub fn mujoco_box() -> Self {
        Self::read("mujoco_box", include_str!("../data/free_body/mujoco_box.json"))
    }

    /// The box of the Gazebo benchmark, thrown.
    pub fn gazebo_boxes() -> Self {
        Self::read("gazebo_boxes", include_str!("../data/free_body/gazebo_boxes.json"))
    }

    fn read(name: &'static str, text: &str) -> Self {
        let file = parse(text);
        let sample = |value: &Value| {
            let q = &value["orientation"];
            Sample {
                time: number(&value["time"]),
                orientation: quaternion(q),
                angular_velocity_body: vector(&value["angular_velocity"]),
            }
        };
        Self {
            name,
            moments: vector(&file["moments"]),
            angular_velocity: vector(&file["angular_velocity"]),
            energy: number(&file["energy"]),
            mass: number(&file["mass"]),
            translation: file.get("translation").map(|t| Translation {
                position: vector(&t["position"]),
                linear_velocity: vector(&t["linear_velocity"]),
                gravity: vector(&t["gravity"]),
            }),
            elliptic: file.get("elliptic").map(|e| Elliptic {
                parameter: number(&e["m"]),
                frequency: number(&e["lambda"]),
                flip_interval: number(&e["flip_interval"]),
            }),
            samples: file["samples"].as_array().expect("a list").iter().map(sample).collect(),
        }
    }

    /// The exact rotation at a time that the file has.
    pub fn at(&self, time: f64) -> &Sample {
        self.samples.iter().find(|sample| sample.time == time).expect("a time in the file")
    }

    /// The body at time zero, to be built. Where the source throws it, it is thrown.
    pub fn rigid_body(&self) -> RigidBody {
        let inertia = InertiaTensor::from_principal(self.moments, DQuat::IDENTITY).expect("possible moments");
        let thrown = self.translation.map_or((DVec3::ZERO, DVec3::ZERO), |t| (t.position, t.linear_velocity));
        RigidBody::new(Shape::Point)
            .mass(self.mass)
            .inertia(inertia)
            .position(real_vec3(thrown.0))
            .linear_velocity(real_vec3(thrown.1))
            .angular_velocity(real_vec3(self.angular_velocity))
    }

    /// Spawns the body at time zero.
    pub fn spawn(&self, world: &mut World) -> Entity {
        self.rigid_body().build().expect("a possible body").spawn(world)
    }
}
