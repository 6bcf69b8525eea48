//! Lines for whatever renderer there is.

pub(crate) mod colliders;
pub(crate) mod contacts;
pub(crate) mod joint_limits;
pub(crate) mod joints;
pub(crate) mod outline;
pub(crate) mod rays;
pub(crate) mod springs;

use std::f64::consts::SQRT_2;

use glam::{DQuat, DVec3};
use hecs::{Entity, EntityRef, World};
use tumble_math::{Shape, equivalent_ellipsoid};

use crate::collision::collider::Collider;
use crate::components::{
    BodyId, CenterOfMass, Inertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity, Wrench,
};
use crate::debug_draw::colliders::outline_collider;
use crate::debug_draw::outline::outline;
use crate::forces::components::{ConstantWrench, Frame, Thruster};
use crate::math::{Real, Vec3, dquat, dvec3, vec3};

/// The interface to a renderer, through which [`DebugView`] draws bodies, axes, momenta, forces,
/// springs, joints and contacts.
///
/// A closure that draws lines is one, and whatever else implements it. Colours are red, green and
/// blue from 0 to 1, as displays take them (sRGB). No coordinate is ever infinite or not a number.
///
/// ```
/// use tumble::{DebugDraw, DebugView, math::Vec3};
///
/// /// Counts what it would have to draw.
/// #[derive(Default)]
/// struct Counter {
///     lines: usize,
///     texts: Vec<String>,
/// }
///
/// impl DebugDraw for Counter {
///     fn line(&mut self, _from: Vec3, _to: Vec3, _color: [f32; 3]) {
///         self.lines += 1;
///     }
///     fn text(&mut self, _at: Vec3, text: &str, _color: [f32; 3]) {
///         self.texts.push(text.to_owned());
///     }
/// }
///
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(1.0)).mass(2.0).id(BodyId(7)).build()?.spawn(&mut world);
/// let mut counter = Counter::default();
/// DebugView { ids: true, ..DebugView::default() }.draw(&world, &mut counter);
/// assert!(counter.lines > 0 && counter.texts == ["7"]);
/// # Ok::<(), tumble::BodyError>(())
/// ```
pub trait DebugDraw {
    /// Draws a line between two points of the world \[m\].
    fn line(&mut self, from: Vec3, to: Vec3, color: [f32; 3]);

    /// Writes a few letters at a point of the world \[m\]. Unless implemented, nothing is written.
    fn text(&mut self, at: Vec3, text: &str, color: [f32; 3]) {
        let _ = (at, text, color);
    }
}

impl<F: FnMut(Vec3, Vec3, [f32; 3])> DebugDraw for F {
    fn line(&mut self, from: Vec3, to: Vec3, color: [f32; 3]) {
        self(from, to, color);
    }
}

/// Which properties of the bodies of a world are drawn: those that are not `None` or `false`.
///
/// Vectors are arrows from the centre of mass, as long as the figure times the length given here.
///
/// ```
/// use tumble::{DebugView, prelude::*};
///
/// let mut world = hecs::World::new();
/// let shape = Shape::cuboid([0.5, 0.5, 0.5]);
/// let body = RigidBody::new(shape.clone())
///     .mass(1.0)
///     .angular_velocity(Vec3::Y)
///     .build()?
///     .spawn(&mut world);
/// // An entity that carries its shape is outlined by it; others by the box that turns as they do.
/// world.insert_one(body, shape)?;
///
/// // Your renderer's way to draw a line.
/// let mut lines = Vec::new();
/// let view = DebugView { angular_velocity: Some(0.25), ..DebugView::default() };
/// view.draw(&world, &mut |from, to, color| lines.push((from, to, color)));
///
/// // The edges of a cube, three axes and the angular velocity, a quarter of a metre for one rad/s.
/// assert!(lines.len() >= 12 + 3 + 1);
/// assert!(
///     lines.iter().any(|(from, to, color)| *color == DebugView::ANGULAR_VELOCITY
///         && *to - *from == Vec3::Y * 0.25)
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("gizmos", "debug render", "wireframe"))]
#[derive(Clone, Debug, PartialEq)]
pub struct DebugView {
    /// Edges of the [`Shape`] that an entity carries. A body without one is shown as the box that
    /// has its mass and moments of inertia.
    pub outlines: bool,
    /// The ellipsoid that has the mass and moments of inertia of the body.
    pub ellipsoids: bool,
    /// The principal axes of inertia of moving bodies, and the axes of others, in red, green and
    /// blue: their length \[m\].
    pub axes: Option<Real>,
    /// Linear momentum: metres for 1 kg m/s.
    pub momentum: Option<Real>,
    /// Angular momentum: metres for 1 kg m^2/s.
    pub angular_momentum: Option<Real>,
    /// Angular velocity: metres for 1 rad/s.
    pub angular_velocity: Option<Real>,
    /// What the body's [`Wrench`], [`ConstantWrench`] and [`Thruster`] push with, each an arrow:
    /// metres for 1 N, and for the torque metres for 1 N m. Springs are lines between their ends,
    /// as with [`springs`](Self::springs). The step leaves a [`Wrench`] at zero; look before it, or
    /// between [`accumulate_forces`](crate::accumulate_forces) and [`integrate`](crate::integrate),
    /// to see what was asked for.
    pub forces: Option<Real>,
    /// A line between the ends of each [`Spring`](crate::Spring), and of each
    /// [`SpringToPoint`](crate::SpringToPoint) from the body to its anchor. One of which a body is
    /// gone is not drawn. Where [`forces`](Self::forces) are shown too, it has their colour.
    pub springs: bool,
    /// Of each [`Joint`](crate::Joint) lines from the centres of mass to its point, and the axes of
    /// the first frame along or about which it is free, in red, green and blue: their length \[m\].
    ///
    /// Of its [`Limits`](crate::Limits), arcs with a hand for rotations and a cone with its axis,
    /// with that length as their radius; a line with a stroke across at each bound for
    /// translations, and one between the points for a distance. What is at a bound or past it has a
    /// colour of its own. A broken joint is not drawn.
    pub joints: Option<Real>,
    /// The force of each joint that has a [`JointLoad`](crate::JointLoad) on its second body, as an
    /// arrow: metres for 1 N.
    pub joint_forces: Option<Real>,
    /// Edges of each [`Collider`] at its place: what others bump into, which need not be what is
    /// seen. A half-space has none. [Sensors](Collider::sensor) have a colour of their own.
    pub colliders: bool,
    /// A cross at each point where bodies touch, in the plane between them: its width \[m\].
    /// [`draw_contacts`](Self::draw_contacts) draws it.
    pub contacts: Option<Real>,
    /// The contact force at each point, as an arrow along the normal: metres for 1 N.
    /// [`draw_contacts`](Self::draw_contacts) draws it.
    pub contact_forces: Option<Real>,
    /// The number of the [`BodyId`] of those that have one, as text.
    pub ids: bool,
    /// How far between its last two steps a body with a [`PreviousPose`] is shown: what
    /// [`Simulation::advance`](crate::Simulation::advance) returned; 1 is the last one.
    pub alpha: Real,
}

impl Default for DebugView {
    /// Outlines, and axes of half a metre.
    fn default() -> Self {
        Self { outlines: true, axes: Some(0.5), ..Self::nothing() }
    }
}

impl DebugView {
    /// Colour of outlines of dynamic bodies.
    pub const DYNAMIC: [f32; 3] = [0.92, 0.92, 0.94];
    /// Colour of outlines of kinematic bodies.
    pub const KINEMATIC: [f32; 3] = [0.55, 0.75, 0.95];
    /// Colour of outlines of bodies that do not move.
    pub const FIXED: [f32; 3] = [0.55, 0.56, 0.60];
    /// Colour of ellipsoids of inertia.
    pub const ELLIPSOID: [f32; 3] = [0.60, 0.50, 0.85];
    /// Colours of the first, second and third axis.
    pub const AXES: [[f32; 3]; 3] = [[0.94, 0.33, 0.31], [0.40, 0.80, 0.36], [0.33, 0.55, 0.96]];
    /// Colour of linear momentum.
    pub const MOMENTUM: [f32; 3] = [0.98, 0.84, 0.30];
    /// Colour of angular momentum.
    pub const ANGULAR_MOMENTUM: [f32; 3] = [0.90, 0.40, 0.85];
    /// Colour of angular velocity.
    pub const ANGULAR_VELOCITY: [f32; 3] = [0.35, 0.85, 0.85];
    /// Colour of forces, and of springs where forces are shown.
    pub const FORCE: [f32; 3] = [0.98, 0.58, 0.24];
    /// Colour of torques.
    pub const TORQUE: [f32; 3] = [0.85, 0.42, 0.18];
    /// Colour of springs where forces are not shown.
    pub const SPRING: [f32; 3] = [0.76, 0.78, 0.80];
    /// Colour of joints, but for their free axes.
    pub const JOINT: [f32; 3] = [0.62, 0.66, 0.74];
    /// Colour of limits of joints.
    pub const LIMIT: [f32; 3] = [0.90, 0.82, 0.45];
    /// Colour of limits of joints that are reached.
    pub const LIMIT_REACHED: [f32; 3] = [0.98, 0.36, 0.30];
    /// Colour of colliders.
    pub const COLLIDER: [f32; 3] = [0.30, 0.90, 0.62];
    /// Colour of colliders that are sensors.
    pub const SENSOR: [f32; 3] = [0.96, 0.62, 0.80];
    /// Colour of rays up to what they meet, and of those that meet nothing.
    pub const RAY: [[f32; 3]; 2] = [[0.99, 0.93, 0.45], [0.60, 0.62, 0.55]];
    /// Colour of contacts: of where bodies touch, and of what pushes there.
    pub const CONTACT: [f32; 3] = [0.72, 0.98, 0.25];

    /// A view of nothing, to begin with: `DebugView { forces: Some(0.1), ..DebugView::nothing() }`.
    pub fn nothing() -> Self {
        Self {
            outlines: false,
            ellipsoids: false,
            axes: None,
            momentum: None,
            angular_momentum: None,
            angular_velocity: None,
            forces: None,
            springs: false,
            joints: None,
            joint_forces: None,
            colliders: false,
            contacts: None,
            contact_forces: None,
            ids: false,
            alpha: 1.0,
        }
    }

    /// Draws every entity that has a [`Pose`], every [`Spring`](crate::Spring) if springs or forces
    /// are shown, and every [`Joint`](crate::Joint) if joints or their forces are.
    pub fn draw(&self, world: &World, target: &mut dyn DebugDraw) {
        for entity in world.iter() {
            self.draw_entity(entity, target);
            self.draw_spring(world, entity, target);
            self.draw_joint(world, entity, target);
        }
    }

    /// Draws one body. One that is not in the world, or has no [`Pose`], is not seen.
    pub fn draw_body(&self, world: &World, body: Entity, target: &mut dyn DebugDraw) {
        if let Ok(entity) = world.entity(body) {
            self.draw_entity(entity, target);
        }
    }

    fn draw_entity(&self, entity: EntityRef<'_>, target: &mut dyn DebugDraw) {
        let Some(pose) = self.pose(entity) else { return };
        let mut pen = Pen { target };
        if self.outlines {
            draw_outline(entity, &pose, &mut pen);
        }
        if let (true, Some(collider)) = (self.colliders, entity.get::<&Collider>()) {
            outline_collider(&collider, body_frame(entity, &pose), &mut |from, to, is_sensor| {
                pen.line(from, to, if is_sensor { Self::SENSOR } else { Self::COLLIDER });
            });
        }
        let principal = principal_frame(entity, &pose);
        let ellipsoid = self.ellipsoids.then(|| equivalent_radii(entity)).flatten();
        if let Some(radii) = ellipsoid {
            outline(&Shape::Ellipsoid { radii }, dvec3(pose.position), principal, &mut |from, to| {
                pen.line(from, to, Self::ELLIPSOID);
            });
        }
        if let Some(length) = self.axes {
            for (axis, color) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(Self::AXES) {
                pen.line(dvec3(pose.position), dvec3(pose.position) + principal * axis * f64::from(length), color);
            }
        }
        self.draw_arrows(entity, &pose, &mut pen);
        self.draw_spring_to_point(entity, &pose, &mut pen);
        if let (true, Some(id)) = (self.ids, entity.get::<&BodyId>()) {
            pen.text(pose.position, &id.0.to_string(), Self::DYNAMIC);
        }
    }

    fn draw_arrows(&self, entity: EntityRef<'_>, pose: &Pose, pen: &mut Pen<'_>) {
        let mut arrow = |vector: Vec3, scale: Option<Real>, color| {
            if let Some(scale) = scale {
                pen.arrow(pose.position, vector * scale, color);
            }
        };
        if let Some(momentum) = entity.get::<&Momentum>() {
            arrow(momentum.linear, self.momentum, Self::MOMENTUM);
            arrow(momentum.angular, self.angular_momentum, Self::ANGULAR_MOMENTUM);
        }
        if let Some(velocity) = entity.get::<&Velocity>() {
            arrow(velocity.angular, self.angular_velocity, Self::ANGULAR_VELOCITY);
        }
        let mut wrench = |force, torque| {
            arrow(force, self.forces, Self::FORCE);
            arrow(torque, self.forces, Self::TORQUE);
        };
        if let Some(once) = entity.get::<&Wrench>() {
            wrench(once.force, once.torque);
        }
        if let Some(constant) = entity.get::<&ConstantWrench>() {
            match constant.frame {
                Frame::World => wrench(constant.force, constant.torque),
                Frame::Body => wrench(pose.orientation * constant.force, pose.orientation * constant.torque),
            }
        }
        if let Some(thruster) = entity.get::<&Thruster>() {
            let to_world = |vector: Vec3| pose.orientation * (vector * thruster.throttle);
            wrench(to_world(thruster.force), to_world(thruster.torque));
        }
    }

    fn pose(&self, entity: EntityRef<'_>) -> Option<Pose> {
        let pose = *entity.get::<&Pose>()?;
        let previous = entity.get::<&PreviousPose>();
        Some(previous.map_or(pose, |previous| previous.0.interpolate(&pose, self.alpha)))
    }
}

/// Draws what can be drawn.
pub(crate) struct Pen<'t> {
    target: &'t mut dyn DebugDraw,
}

impl Pen<'_> {
    fn line(&mut self, from: DVec3, to: DVec3, color: [f32; 3]) {
        let (from, to) = (vec3(from), vec3(to));
        if from.is_finite() && to.is_finite() {
            self.target.line(from, to, color);
        }
    }

    fn text(&mut self, at: Vec3, text: &str, color: [f32; 3]) {
        if at.is_finite() {
            self.target.text(at, text, color);
        }
    }

    /// A line with a head of four strokes, a tenth as long. A vector of no length is not drawn.
    fn arrow(&mut self, tail: Vec3, vector: Vec3, color: [f32; 3]) {
        let (tail, vector) = (dvec3(tail), dvec3(vector));
        let Some(direction) = vector.try_normalize() else { return };
        let tip = tail + vector;
        self.line(tail, tip, color);
        let (side, other) = direction.any_orthonormal_pair();
        for stroke in [side + other, side - other, -side - other, other - side] {
            let back = stroke / (3.0 * SQRT_2) - direction;
            self.line(tip, tip + back * (0.1 * vector.length()), color);
        }
    }
}

fn draw_outline(entity: EntityRef<'_>, pose: &Pose, pen: &mut Pen<'_>) {
    let color = match (entity.has::<Momentum>(), entity.has::<Velocity>()) {
        (true, _) => DebugView::DYNAMIC,
        (false, true) => DebugView::KINEMATIC,
        (false, false) => DebugView::FIXED,
    };
    let mut draw = |from, to| pen.line(from, to, color);
    if let Some(shape) = entity.get::<&Shape>() {
        let frame = body_frame(entity, pose);
        outline(&shape, dvec3(frame.position), dquat(frame.orientation), &mut draw);
    } else if let Some(radii) = equivalent_radii(entity) {
        // A box's moments are m/3 (b^2 + c^2), those of an ellipsoid m/5 (b^2 + c^2).
        let half_extents = radii * (3.0_f64 / 5.0).sqrt();
        outline(&Shape::Cuboid { half_extents }, dvec3(pose.position), principal_frame(entity, pose), &mut draw);
    }
}

/// Where the frame is in which a body's own shape is given.
fn body_frame(entity: EntityRef<'_>, pose: &Pose) -> Pose {
    Pose { position: pose.origin(entity.get::<&CenterOfMass>().as_deref()), ..*pose }
}

/// From principal axes to the world; of a body without inertia, from its own axes.
fn principal_frame(entity: EntityRef<'_>, pose: &Pose) -> DQuat {
    let axes = entity.get::<&PrincipalAxes>().map_or(DQuat::IDENTITY, |axes| dquat(axes.0));
    dquat(pose.orientation) * axes
}

/// Semi-axes \[m\], along the principal axes, of the homogeneous ellipsoid with the mass and
/// moments of a body.
fn equivalent_radii(entity: EntityRef<'_>) -> Option<DVec3> {
    let mass = f64::from(entity.get::<&Mass>()?.kilograms());
    Some(equivalent_ellipsoid(mass, dvec3(entity.get::<&Inertia>()?.moments())))
}
