//! The forces of a body, with every number checked and every default filled in.

use glam::DVec3;
use hecs::{Entity, EntityBuilder};
use serde::{Serialize, Serializer};
use tumble::math::{Real, Vec3};
use tumble::{
    AngularVelocityServo, Buoyancy, ConstantWrench, Damping, Drag, Frame, GravityMass, GravityScale, Hull, Magnus,
    PointGravity, Spring, SpringToPoint, Thruster, Wind,
};

use tumble_import::checked::{real, real_vector};

/// A force on a body of a scene, as `tumble inspect` lists it: written as JSON it is what the scene
/// file could have said.
///
/// Points of a body are in its own frame, as in scene files; the components that come of it have
/// them from the centre of mass.
///
/// ```
/// use tumble_scene::{Audit, Force};
///
/// let text =
///     r#"{ "bodies": [ { "mass": 1, "forces": [ { "magnus": { "coefficient": 0.5 } } ] } ] }"#;
/// let audit = Audit::from_json(text, "ball.json")?;
/// assert_eq!(audit.bodies[0].forces, [Force::Magnus { coefficient: 0.5 }]);
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Force {
    /// See [`tumble::Damping`].
    Damping {
        /// Rate at which linear momentum decays [1/s].
        linear: f64,
        /// Rate at which angular momentum decays [1/s].
        angular: f64,
    },
    /// See [`tumble::GravityScale`].
    GravityScale(f64),
    /// See [`tumble::Drag`].
    Drag {
        /// Along the body's axes [kg/m].
        linear: [f64; 3],
        /// About the body's axes [kg m^2].
        angular: [f64; 3],
    },
    /// See [`tumble::Wind`]; [m/s].
    Wind([f64; 3]),
    /// See [`tumble::Magnus`].
    Magnus {
        /// \[kg\]
        coefficient: f64,
    },
    /// A nozzle; all of a body are one [`tumble::Thruster`].
    Thruster {
        /// At full throttle, along the body's axes \[N\].
        force: [f64; 3],
        /// Where it acts \[m\].
        point: [f64; 3],
        /// How far it is open.
        throttle: f64,
    },
    /// See [`tumble::ConstantWrench`].
    ConstantWrench {
        /// Through the centre of mass \[N\].
        force: [f64; 3],
        /// About the centre of mass [N m].
        torque: [f64; 3],
        /// Which axes both are given along.
        #[serde(serialize_with = "frame_name")]
        frame: Frame,
    },
    /// See [`tumble::SpringToPoint`].
    SpringToPoint {
        /// Point of the world \[m\].
        anchor: [f64; 3],
        /// Point of the body \[m\].
        attachment: [f64; 3],
        /// \[m\]
        rest_length: f64,
        /// [N/m]
        stiffness: f64,
        /// [N s/m]
        damping: f64,
    },
    /// See [`tumble::Spring`].
    Spring {
        /// Name of the other body.
        to: String,
        /// Point of the body \[m\].
        attachment: [f64; 3],
        /// Point of the other body, in its frame \[m\].
        attachment_to: [f64; 3],
        /// \[m\]
        rest_length: f64,
        /// [N/m]
        stiffness: f64,
        /// [N s/m]
        damping: f64,
    },
    /// See [`tumble::PointGravity`].
    PointGravity {
        /// Point of the world \[m\].
        center: [f64; 3],
        /// [m^3/s^2]
        mu: f64,
        /// \[m\]
        softening: f64,
    },
    /// See [`tumble::GravityMass`].
    GravityMass {
        /// [m^3/s^2]
        mu: f64,
        /// \[m\]
        softening: f64,
    },
    /// See [`tumble::Buoyancy`].
    Buoyancy {
        /// Of the water [kg/m^3].
        density: f64,
        /// Height of the surface \[m\].
        level: f64,
        /// What floats.
        hull: HullShape,
        /// Centre of the hull \[m\].
        center: [f64; 3],
    },
    /// See [`tumble::AngularVelocityServo`].
    AngularVelocityServo {
        /// Wanted angular velocity [rad/s].
        target: [f64; 3],
        /// Which axes it is given along.
        #[serde(serialize_with = "frame_name")]
        frame: Frame,
        /// The most torque [N m]; `None` for no limit.
        max_torque: Option<f64>,
    },
}

/// The shape of a hull that floats.
///
/// ```
/// use tumble_scene::{Audit, Force, HullShape};
///
/// let text = r#"{ "bodies": [ { "mass": 1, "forces": [ { "buoyancy": { "hull": { "sphere": {
///     "radius": 0.5 } } } } ] } ] }"#;
/// let audit = Audit::from_json(text, "buoy.json")?;
/// assert!(matches!(
///     audit.bodies[0].forces[0],
///     Force::Buoyancy { hull: HullShape::Sphere { radius: 0.5 }, .. }
/// ));
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum HullShape {
    /// A ball.
    Sphere {
        /// \[m\]
        radius: f64,
    },
    /// A box along the body's axes.
    Cuboid {
        /// Half its lengths \[m\].
        half_extents: [f64; 3],
    },
}

impl Force {
    /// Adds the components of a body's forces to an entity. `center` is the centre of mass in the
    /// body's frame \[m\].
    ///
    /// Springs to other bodies are entities of their own: see [`spring`](Self::spring).
    pub(crate) fn insert_all(forces: &[Self], center: DVec3, entity: &mut EntityBuilder) {
        for force in forces {
            force.insert(center, entity);
        }
        if let Some(thruster) = thruster(forces, center) {
            entity.add(thruster);
        }
    }

    fn insert(&self, center: DVec3, entity: &mut EntityBuilder) {
        match *self {
            // Nozzles are summed up; a spring is not this body's alone.
            Self::Thruster { .. } | Self::Spring { .. } => entity,
            Self::Damping { linear, angular } => entity.add(Damping { linear: real(linear), angular: real(angular) }),
            Self::GravityScale(scale) => entity.add(GravityScale(real(scale))),
            Self::Drag { linear, angular } => entity.add(Drag { linear: vector(linear), angular: vector(angular) }),
            Self::Wind(velocity) => entity.add(Wind(vector(velocity))),
            Self::Magnus { coefficient } => entity.add(Magnus { coefficient: real(coefficient) }),
            Self::ConstantWrench { force, torque, frame } => {
                entity.add(ConstantWrench { force: vector(force), torque: vector(torque), frame })
            }
            Self::SpringToPoint { anchor, attachment, rest_length, stiffness, damping } => entity.add(SpringToPoint {
                anchor: vector(anchor),
                attachment: from_center(attachment, center),
                rest_length: real(rest_length),
                stiffness: real(stiffness),
                damping: real(damping),
            }),
            Self::PointGravity { center: point, mu, softening } => {
                entity.add(PointGravity { center: vector(point), mu: real(mu), softening: real(softening) })
            }
            Self::GravityMass { mu, softening } => entity.add(GravityMass { mu: real(mu), softening: real(softening) }),
            Self::Buoyancy { density, level, hull, center: of_hull } => entity.add(Buoyancy {
                density: real(density),
                level: real(level),
                hull: hull.component(),
                center: from_center(of_hull, center),
            }),
            Self::AngularVelocityServo { target, frame, max_torque } => entity.add(AngularVelocityServo {
                target: vector(target),
                frame,
                max_torque: max_torque.map_or(Real::INFINITY, real),
            }),
        };
    }

    /// The component of a spring between two bodies, whose centres of mass are at `centers` in
    /// their frames \[m\].
    pub(crate) fn spring(&self, bodies: [Entity; 2], centers: [DVec3; 2]) -> Option<Spring> {
        let Self::Spring { attachment, attachment_to, rest_length, stiffness, damping, .. } = *self else {
            return None;
        };
        Some(Spring {
            bodies,
            attachments: [from_center(attachment, centers[0]), from_center(attachment_to, centers[1])],
            rest_length: real(rest_length),
            stiffness: real(stiffness),
            damping: real(damping),
        })
    }
}

impl HullShape {
    fn component(self) -> Hull {
        match self {
            Self::Sphere { radius } => Hull::Sphere { radius: real(radius) },
            Self::Cuboid { half_extents } => Hull::Cuboid { half_extents: vector(half_extents) },
        }
    }
}

/// All nozzles as one component. A single one keeps its throttle; of several each throttle is in
/// its force.
fn thruster(forces: &[Force], center: DVec3) -> Option<Thruster> {
    let mut nozzles = forces.iter().filter_map(|force| match *force {
        Force::Thruster { force, point, throttle } => Some((force, from_center(point, center), throttle)),
        _ => None,
    });
    let (force, point, throttle) = nozzles.next()?;
    let scaled = |force: [f64; 3], throttle: f64| vector(force.map(|component| component * throttle));
    let mut rest = nozzles.peekable();
    if rest.peek().is_none() {
        return Some(Thruster { throttle: real(throttle), ..Thruster::new(vector(force), point) });
    }
    let first = Thruster::new(scaled(force, throttle), point);
    Some(rest.fold(first, |sum, (force, point, throttle)| sum.and(scaled(force, throttle), point)))
}

/// Whether the sums over all nozzles, with the valves as far open as they are, stay within the
/// engine's numbers.
pub(crate) fn thrust_is_finite(forces: &[Force]) -> bool {
    thruster(forces, DVec3::ZERO).is_none_or(|Thruster { force, torque, throttle }| {
        (force * throttle).is_finite() && (torque * throttle).is_finite()
    })
}

fn vector(components: [f64; 3]) -> Vec3 {
    real_vector(DVec3::from_array(components))
}

/// A point of the body's frame, from the centre of mass.
fn from_center(point: [f64; 3], center: DVec3) -> Vec3 {
    real_vector(DVec3::from_array(point) - center)
}

fn frame_name<S: Serializer>(frame: &Frame, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(match frame {
        Frame::World => "world",
        Frame::Body => "body",
    })
}
