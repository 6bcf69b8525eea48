//! The bodies of worlds that were made of one scene: their states as numbers, in the order of the
//! scene.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    BodyId, BodyOrder, ConstantWrench, Inertia, Joint, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Trial,
    Velocity, VelocityError, set_angular_velocity, set_linear_velocity,
};
use tumble_scene::BodyNames;

use crate::error::Failure;

/// What all worlds of a scene have in common.
pub(crate) struct Layout {
    pub(crate) entities: Vec<Entity>,
    pub(crate) names: Vec<String>,
    pub(crate) joints: Vec<Entity>,
    pub(crate) joint_names: Vec<String>,
    /// Of each drive the index of its joint, and its own among those of the joint.
    pub(crate) drives: Vec<(usize, usize)>,
    /// Of each body whether the scene gives it a constant force.
    pub(crate) forced: Vec<bool>,
}

impl Layout {
    /// Of a world with the bodies of a scene, and nothing else.
    pub(crate) fn of(world: &World, names: &[String], joint_names: &[String]) -> Self {
        let entities = BodyOrder::of(world).entities().to_vec();
        let joints = joints(world);
        let drives_of = |(at, &joint): (usize, &Entity)| {
            let count = world.get::<&tumble::Drives>(joint).map_or(0, |drives| drives.0.len());
            (0..count).map(move |drive| (at, drive))
        };
        let drives = joints.iter().enumerate().flat_map(drives_of).collect();
        let forced = entities.iter().map(|&body| world.satisfies::<&ConstantWrench>(body)).collect();
        Self { entities, names: names.to_vec(), joints, joint_names: joint_names.to_vec(), drives, forced }
    }

    pub(crate) fn bodies(&self) -> usize {
        self.entities.len()
    }

    /// The name of a drive: of its joint, and its place there.
    pub(crate) fn drive_names(&self) -> Vec<String> {
        let name = |&(joint, drive): &(usize, usize)| Some(format!("{}.drives.{drive}", self.joint_names.get(joint)?));
        self.drives.iter().filter_map(name).collect()
    }
}

/// The joints of a world, in the order in which they were spawned.
fn joints(world: &World) -> Vec<Entity> {
    let mut joints: Vec<Entity> = world.query::<(Entity, &Joint)>().iter().map(|(entity, _)| entity).collect();
    joints.sort_unstable_by_key(|joint| joint.id());
    joints
}

/// What the bodies and joints of a world are called.
pub(crate) fn names(world: &World, names: &BodyNames) -> (Vec<String>, Vec<String>) {
    let name_of = |(index, joint): (usize, Entity)| {
        let named = names.joints().find(|(_, entity)| *entity == joint);
        named.map_or_else(|| format!("joint-{index}"), |(name, _)| name.to_owned())
    };
    let bodies = BodyOrder::of(world).len();
    let body_names = (0..bodies).map(|index| names.of(index as u64).into_owned()).collect();
    (body_names, joints(world).into_iter().enumerate().map(name_of).collect())
}

/// Numbers of a body's state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Quantity {
    Positions,
    Orientations,
    LinearVelocities,
    AngularVelocities,
    /// All of them, in this order.
    States,
}

impl Quantity {
    pub(crate) const EACH: [Self; 4] =
        [Self::Positions, Self::Orientations, Self::LinearVelocities, Self::AngularVelocities];

    /// Numbers of a body.
    pub(crate) fn width(self) -> usize {
        match self {
            Self::Orientations => 4,
            Self::States => 13,
            Self::Positions | Self::LinearVelocities | Self::AngularVelocities => 3,
        }
    }

    /// As it is called in Python.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Positions => "positions",
            Self::Orientations => "orientations",
            Self::LinearVelocities => "linear_velocities",
            Self::AngularVelocities => "angular_velocities",
            Self::States => "states",
        }
    }

    fn write(self, pose: &Pose, velocity: Velocity, to: &mut [Real]) {
        match self {
            Self::Positions => to.copy_from_slice(&pose.position.to_array()),
            Self::Orientations => to.copy_from_slice(&pose.orientation.to_array()),
            Self::LinearVelocities => to.copy_from_slice(&velocity.linear.to_array()),
            Self::AngularVelocities => to.copy_from_slice(&velocity.angular.to_array()),
            Self::States => {
                if let Some((position, rest)) = to.split_first_chunk_mut::<3>()
                    && let Some((orientation, rest)) = rest.split_first_chunk_mut::<4>()
                    && let Some((linear, angular)) = rest.split_first_chunk_mut::<3>()
                {
                    *position = pose.position.to_array();
                    *orientation = pose.orientation.to_array();
                    *linear = velocity.linear.to_array();
                    angular.copy_from_slice(&velocity.angular.to_array());
                }
            }
        }
    }
}

/// Writes a quantity of all bodies of a world, body after body.
pub(crate) fn read(world: &mut World, quantity: Quantity, to: &mut [Real]) {
    let width = quantity.width();
    for (id, pose, velocity) in world.query_mut::<(&BodyId, &Pose, Option<&Velocity>)>() {
        let place = usize::try_from(id.0).ok().and_then(|index| {
            let begin = index.checked_mul(width)?;
            to.get_mut(begin..begin + width)
        });
        if let Some(place) = place {
            quantity.write(pose, velocity.copied().unwrap_or_default(), place);
        }
    }
}

/// What does not change with the motion.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Property {
    Masses,
    Inertias,
    PrincipalAxes,
}

impl Property {
    /// Numbers of a body.
    pub(crate) fn width(self) -> usize {
        match self {
            Self::Masses => 1,
            Self::Inertias => 3,
            Self::PrincipalAxes => 4,
        }
    }
}

/// Writes a property of all bodies of a world, body after body; infinite where no force moves it.
pub(crate) fn read_properties(world: &World, layout: &Layout, property: Property, to: &mut [Real]) {
    for (&body, place) in layout.entities.iter().zip(to.chunks_mut(property.width())) {
        let is_dynamic = world.satisfies::<&Momentum>(body);
        match property {
            Property::Masses => {
                place.fill(world.get::<&Mass>(body).map_or(Real::INFINITY, |mass| mass.kilograms()));
            }
            Property::Inertias => match world.get::<&Inertia>(body) {
                Ok(inertia) => place.copy_from_slice(&inertia.moments().to_array()),
                Err(_) => place.fill(if is_dynamic { 0.0 } else { Real::INFINITY }),
            },
            Property::PrincipalAxes => {
                let axes = world.get::<&PrincipalAxes>(body).map_or(Quat::IDENTITY, |axes| axes.0);
                place.copy_from_slice(&axes.to_array());
            }
        }
    }
}

/// What a body is given; what is `None` stays.
#[derive(Clone, Copy, Default)]
pub(crate) struct Given {
    pub(crate) position: Option<Vec3>,
    pub(crate) orientation: Option<Quat>,
    pub(crate) linear: Option<Vec3>,
    pub(crate) angular: Option<Vec3>,
}

/// Largest coordinate of a position \[m\], as in scene files.
pub(crate) const MAX_POSITION: Real = 1e15;
/// How far from 1 the length of a quaternion may be, as in scene files.
const LENGTH_TOLERANCE: Real = 1e-3;
/// Largest component of a velocity \[m/s\] \[rad/s\], as in scene files.
const MAX_SPEED: Real = 1e9;

impl Given {
    /// Reads the numbers of a quantity.
    pub(crate) fn take(&mut self, quantity: Quantity, numbers: &[Real]) -> Result<(), String> {
        let vector = |numbers: &[Real]| <[Real; 3]>::try_from(numbers).map(Vec3::from).unwrap_or_default();
        match quantity {
            Quantity::Positions => self.position = Some(position(vector(numbers))?),
            Quantity::Orientations => {
                let numbers = <[Real; 4]>::try_from(numbers).unwrap_or_default();
                self.orientation = Some(orientation(Quat::from_array(numbers))?);
            }
            Quantity::LinearVelocities => self.linear = Some(speed(vector(numbers))?),
            Quantity::AngularVelocities => self.angular = Some(speed(vector(numbers))?),
            Quantity::States => {
                let mut rest = numbers;
                for part in Quantity::EACH {
                    let (here, after) = rest.split_at_checked(part.width()).unwrap_or((rest, &[]));
                    self.take(part, here)?;
                    rest = after;
                }
            }
        }
        Ok(())
    }

    /// Why the body cannot have it, if that is so.
    pub(crate) fn check(&self, world: &World, body: Entity) -> Result<(), (&'static str, String)> {
        let moves = world.satisfies::<&Velocity>(body) || world.satisfies::<&Momentum>(body);
        let turns = !world.satisfies::<&Momentum>(body) || world.satisfies::<&Inertia>(body);
        let is_some = |velocity: Option<Vec3>| velocity.is_some_and(|velocity| velocity != Vec3::ZERO);
        if !moves && is_some(self.linear) {
            return Err(("linear_velocities", "is fixed, and has no velocity but 0".to_owned()));
        }
        if !moves && is_some(self.angular) {
            return Err(("angular_velocities", "is fixed, and has no velocity but 0".to_owned()));
        }
        let mass = world.get::<&Mass>(body).map_or(0.0, |mass| mass.kilograms());
        let (linear, angular) = self.velocities(world, body);
        if linear.is_some_and(|linear| speed(linear).is_err() || !(linear * mass).is_finite()) {
            return Err(("linear_velocities", "would be beyond 1e9 m/s, or have no finite momentum".to_owned()));
        }
        let moment = world.get::<&Inertia>(body).map_or(0.0, |inertia| inertia.moments().max_element());
        if angular.is_some_and(|angular| speed(angular).is_err() || !(angular.length() * moment).is_finite()) {
            return Err(("angular_velocities", "would be beyond 1e9 rad/s, or have no finite momentum".to_owned()));
        }
        if !turns && is_some(self.angular) {
            return Err(("angular_velocities", "is a point mass, which does not turn".to_owned()));
        }
        Ok(())
    }

    /// The velocities to be set: a body that is turned keeps those that it has.
    fn velocities(&self, world: &World, body: Entity) -> (Option<Vec3>, Option<Vec3>) {
        let before = world.get::<&Velocity>(body).map(|velocity| *velocity).ok();
        let kept = before.filter(|_| self.orientation.is_some());
        (self.linear, self.angular.or(kept.map(|velocity| velocity.angular)))
    }

    /// Gives it to the body. A body that is turned keeps its velocities.
    pub(crate) fn give(&self, world: &mut World, body: Entity) -> Result<(), VelocityError> {
        let (linear, angular) = self.velocities(world, body);
        if let Ok(mut pose) = world.get::<&mut Pose>(body) {
            pose.position = self.position.unwrap_or(pose.position);
            pose.orientation = self.orientation.unwrap_or(pose.orientation);
        }
        // What is drawn between two steps does not come from where the body was.
        if let (Ok(pose), Ok(mut previous)) = (world.get::<&Pose>(body), world.get::<&mut PreviousPose>(body))
            && (self.position.is_some() || self.orientation.is_some())
        {
            previous.0 = *pose;
        }
        if !world.satisfies::<&Velocity>(body) {
            return Ok(());
        }
        linear.map_or(Ok(()), |linear| set_linear_velocity(world, body, linear))?;
        angular.map_or(Ok(()), |angular| set_angular_velocity(world, body, angular))
    }
}

fn position(position: Vec3) -> Result<Vec3, String> {
    if position.abs().max_element() <= MAX_POSITION {
        Ok(position)
    } else {
        Err(format!("{position} has a coordinate beyond {MAX_POSITION:e} m"))
    }
}

fn orientation(orientation: Quat) -> Result<Quat, String> {
    if (orientation.length() - 1.0).abs() <= LENGTH_TOLERANCE {
        Ok(if orientation.is_normalized() { orientation } else { orientation.normalize() })
    } else {
        Err(format!("{orientation} is no unit quaternion x, y, z, w"))
    }
}

fn speed(velocity: Vec3) -> Result<Vec3, String> {
    if velocity.abs().max_element() <= MAX_SPEED {
        Ok(velocity)
    } else {
        Err(format!("{velocity} has a component beyond {MAX_SPEED:e}"))
    }
}

/// Gives bodies of worlds what was read for them, or nothing to any of them.
pub(crate) fn give(
    trials: &mut [&mut Trial],
    layout: &Layout,
    bodies: &[usize],
    given: &[Given],
) -> Result<(), Failure> {
    let entity = |body: usize| layout.entities.get(body).copied();
    let rows = given.chunks(bodies.len().max(1));
    for (trial, row) in trials.iter().zip(rows.clone()) {
        for (&body, given) in bodies.iter().zip(row) {
            let Some(entity) = entity(body) else { continue };
            given.check(&trial.world, entity).map_err(|(field, problem)| {
                Failure::argument(
                    field,
                    format!("body {:?} {problem}", layout.names.get(body).map_or("", String::as_str)),
                )
            })?;
        }
    }
    for (trial, row) in trials.iter_mut().zip(rows) {
        for (&body, given) in bodies.iter().zip(row) {
            let Some(entity) = entity(body) else { continue };
            let of_body = |error: VelocityError| Failure::argument("velocities", error.to_string());
            given.give(&mut trial.world, entity).map_err(of_body)?;
        }
    }
    Ok(())
}
