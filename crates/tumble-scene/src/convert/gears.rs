//! Gears of a scene from their models.

use std::collections::HashMap;

use hecs::Entity;
use tumble::{Axes, Gear};
use tumble_import::checked::real;
use tumble_import::{FieldError, shortest};

use crate::alike::find;
use crate::bodies::scene_joint::SceneJoint;
use crate::bodies::scene_joints::{SceneGear, SceneJoints};
use crate::convert::joints::joints;
use crate::model::gear_model::GearModel;
use crate::model::joint_options_model::AxisModel;
use crate::model::scene_model::SceneModel;
use crate::values::axes::named_axes;
use crate::values::checked::number;

/// The joints of a scene between bodies of these names, in the order of the names, and the gears
/// between the joints.
pub(crate) fn joints_and_gears(model: &SceneModel, names: &[String]) -> Result<SceneJoints, FieldError> {
    let joints = joints(&model.joints, names)?;
    let gears = if model.gears.is_empty() { Vec::new() } else { gears(&model.gears, &joints)? };
    Ok(SceneJoints { joints, gears })
}

/// Joints by name: the index of the only one, or none where several have the name.
type ByName<'a> = HashMap<&'a str, Option<usize>>;

fn gears(models: &[GearModel], joints: &[SceneJoint]) -> Result<Vec<SceneGear>, FieldError> {
    let mut by_name = ByName::with_capacity(joints.len());
    for (index, joint) in joints.iter().enumerate() {
        if let Some(name) = &joint.name {
            by_name.entry(name).and_modify(|it| *it = None).or_insert(Some(index));
        }
    }
    let mut tied = HashMap::with_capacity(models.len());
    let mut gears = Vec::with_capacity(models.len());
    for (index, model) in models.iter().enumerate() {
        let inside = |error: FieldError| error.inside(&format!("gears[{index}]"));
        let (gear, mut ends) = gear(model, joints, &by_name).map_err(inside)?;
        ends.sort_unstable();
        if let Some(earlier) = tied.insert(ends, index) {
            return Err(inside(FieldError::new("joints", format!("gears[{earlier}] ties the same axes"))));
        }
        gears.push(gear);
    }
    Ok(gears)
}

/// A gear, and which axis of which joint it has at either end.
fn gear(
    model: &GearModel,
    joints: &[SceneJoint],
    by_name: &ByName<'_>,
) -> Result<(SceneGear, [(usize, usize); 2]), FieldError> {
    let Some(names) = &model.joints else {
        return Err(FieldError::new("joints", "is missing: give the names of two joints"));
    };
    let of_joints = [index(&names.0[0], by_name)?, index(&names.0[1], by_name)?];
    if of_joints[0] == of_joints[1] {
        return Err(FieldError::new("joints", "names one joint twice"));
    }
    let mut axes = [Axes::NONE; 2];
    let mut ends = [(0, 0); 2];
    for end in 0..2 {
        let free = joints.get(of_joints[end]).map_or(Axes::NONE, SceneJoint::free);
        let given = model.axes.as_ref().map(|axes| axes.0[end]);
        let place = axis(&names.0[end], free, given)?;
        axes[end] = given.map_or(Axes::NONE, Axes::from);
        ends[end] = (of_joints[end], place);
    }
    let Some(ratio) = model.ratio else {
        return Err(FieldError::new("ratio", "is missing: give how much the second value changes with the first"));
    };
    let (ratio, given) = (real(number("ratio", ratio)?), ratio);
    if ratio == 0.0 {
        return Err(FieldError::new("ratio", format!("must not be zero, as {} is", shortest(given))));
    }
    let offset = real(number("offset", model.offset.unwrap_or(0.0))?);
    let gear = Gear { axes, offset, ..Gear::new(Entity::DANGLING, Entity::DANGLING, ratio) };
    Ok((SceneGear { joints: of_joints, gear }, ends))
}

fn index(name: &str, by_name: &ByName<'_>) -> Result<usize, FieldError> {
    let found = find("joint", name, by_name)
        .and_then(|index| index.ok_or_else(|| format!("several joints are called {name:?}")));
    found.map_err(|problem| FieldError::new("joints", problem))
}

/// The index of the axis of a joint with these free axes: the one that is given, or the first,
/// rotations before translations.
fn axis(joint: &str, free: Axes, given: Option<AxisModel>) -> Result<usize, FieldError> {
    let is_free = |axis: &usize| free.contains(Axes::EACH[*axis]);
    let place = match given {
        None => {
            let none = || FieldError::new("joints", format!("{joint:?} locks all axes"));
            [3, 4, 5, 0, 1, 2].into_iter().find(is_free).ok_or_else(none)?
        }
        Some(given) => {
            let these = Axes::from(given);
            let mut named = named_axes().enumerate().filter(|(_, (_, axis))| these.contains(*axis));
            let (Some((place, (name, _))), None) = (named.next(), named.next()) else {
                return Err(FieldError::new("axes", "linear and angular are three axes each: give one"));
            };
            if !is_free(&place) {
                return Err(FieldError::new("axes", format!("{joint:?} locks {name}")));
            }
            place
        }
    };
    if place >= 3 && free.contains(Axes::ANGULAR) {
        let field = if given.is_some() { "axes" } else { "joints" };
        let problem = format!("{joint:?} has three free rotations, which have no angles of their own");
        return Err(FieldError::new(field, problem));
    }
    Ok(place)
}
