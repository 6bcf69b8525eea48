//! Joints of a scene from their models.

use std::collections::HashMap;

use glam::DVec3;
use hecs::Entity;
use tumble::Joint;
use tumble_import::FieldError;
use tumble_import::checked::{check_name, real_vector};

use crate::alike::find;
use crate::bodies::joint_options::JointOptions;
use crate::bodies::scene_joint::SceneJoint;
use crate::convert::joint_options;
use crate::model::joint_model::{JointModel, JointPlaceModel};
use crate::values::checked::finite_triple;
use crate::values::tuple::Triple;

/// How far from the origin a joint can be \[m\].
const MAX_DISTANCE: f64 = 1e9;

/// Makes a joint between two bodies.
type Constructor = fn(Entity, Entity) -> Joint;

/// The joints between bodies of these names, in the order of the names.
pub(crate) fn joints(models: &[JointModel], names: &[String]) -> Result<Vec<SceneJoint>, FieldError> {
    if models.is_empty() {
        return Ok(Vec::new());
    }
    let by_name: HashMap<&str, usize> = names.iter().enumerate().map(|(index, name)| (name.as_str(), index)).collect();
    let inside = |index: usize| move |error: FieldError| error.inside(&format!("joints[{index}]"));
    let body = |name: &str| find("body", name, &by_name);
    models.iter().enumerate().map(|(index, model)| joint(model, &body).map_err(inside(index))).collect()
}

/// A joint between bodies whose indices are found by their names, or what is wrong with a name.
pub(crate) fn joint(
    model: &JointModel,
    body: &dyn Fn(&str) -> Result<usize, String>,
) -> Result<SceneJoint, FieldError> {
    if let Some(name) = &model.name {
        check_name(name)?;
    }
    let Some(between) = &model.between else {
        return Err(FieldError::new("between", "is missing: give the names of two bodies"));
    };
    let body = |name: &String| body(name).map_err(|problem| FieldError::new("between", problem));
    let bodies = [body(&between.0[0])?, body(&between.0[1])?];
    if bodies[0] == bodies[1] {
        return Err(FieldError::new("between", "names one body twice"));
    }
    let (name, kind, place) = kind(model)?;
    let (at, to, axis) = place_of(name, place).map_err(|error| error.inside(name))?;
    let free = kind(Entity::DANGLING, Entity::DANGLING).free;
    let limits = model.limits.as_ref().map(|limits| joint_options::limits(limits, free));
    let friction = model.friction.as_ref().map(|friction| joint_options::friction(friction, free));
    let breakable = model.breaks.as_ref().map(|breaks| joint_options::breakable(breaks));
    let drives = (!model.drives.is_empty()).then(|| joint_options::drives(&model.drives, free));
    Ok(SceneJoint {
        name: model.name.clone(),
        bodies,
        kind,
        at: real_vector(at),
        to: to.map(real_vector),
        axis: real_vector(axis),
        contacts: model.contacts,
        options: JointOptions {
            limits: limits.transpose().map_err(|error| error.inside("limits"))?,
            drives: drives.transpose()?,
            friction: friction.transpose().map_err(|error| error.inside("friction"))?,
            breakable: breakable.transpose().map_err(|error| error.inside("break"))?,
        },
    })
}

/// The one kind that is given, with its name.
fn kind(model: &JointModel) -> Result<(&'static str, Constructor, &JointPlaceModel), FieldError> {
    let kinds: [(&str, Constructor, &Option<Box<JointPlaceModel>>); 8] = [
        ("ball", Joint::ball, &model.ball),
        ("hinge", Joint::hinge, &model.hinge),
        ("slider", Joint::slider, &model.slider),
        ("cylinder", Joint::cylinder, &model.cylinder),
        ("universal", Joint::universal, &model.universal),
        ("planar", Joint::planar, &model.planar),
        ("fixed", Joint::fixed, &model.fixed),
        ("free", Joint::free, &model.free),
    ];
    let mut given = kinds.into_iter().filter_map(|(name, kind, place)| Some((name, kind, place.as_deref()?)));
    match (given.next(), given.next()) {
        (Some(one), None) => Ok(one),
        (Some((first, ..)), Some((second, ..))) => {
            Err(FieldError::new(second, format!("{first} is given too: a joint is of one kind")))
        }
        (None, _) => {
            let names = kinds.map(|(name, ..)| name).join(", ");
            Err(FieldError::new("kind", format!("is missing: give one of {names}")))
        }
    }
}

/// Where a joint of a kind is \[m\], where that of its second body if elsewhere, and along which
/// axis its frames are.
fn place_of(kind: &str, place: &JointPlaceModel) -> Result<(DVec3, Option<DVec3>, DVec3), FieldError> {
    let Some(at) = &place.at else {
        return Err(FieldError::new("at", "is missing: give a point of the world"));
    };
    let at = point("at", at)?;
    let to = place.to.as_ref().map(|to| point("to", to)).transpose()?;
    if to.is_some() && kind != "free" {
        return Err(FieldError::new("to", "is for free joints: others hold both bodies at one point"));
    }
    let needs_axis = !matches!(kind, "ball" | "fixed" | "free");
    let axis = match &place.axis {
        Some(axis) => finite_triple("axis", axis)?,
        None if needs_axis => return Err(FieldError::new("axis", "is missing: give a direction")),
        None => DVec3::X,
    };
    // Scaled first, since a square may overflow or vanish.
    match (axis / axis.abs().max_element()).try_normalize() {
        Some(axis) => Ok((at, to, axis)),
        None => Err(FieldError::new("axis", "is zero: give a direction")),
    }
}

/// A point of the world \[m\].
fn point(field: &str, point: &Triple) -> Result<DVec3, FieldError> {
    let point = finite_triple(field, point)?;
    if point.abs().max_element() > MAX_DISTANCE {
        return Err(FieldError::new(field, format!("is further than {MAX_DISTANCE:e} m from the origin")));
    }
    Ok(point)
}

#[cfg(test)]
mod tests {
    use crate::Scene;

    fn scene(joint: &str) -> Result<hecs::World, String> {
        let body = |name: &str, x: f64| {
            format!(
                r#"{{ "name": "{name}", "shape": {{ "sphere": {{ "radius": 0.1 }} }}, "mass": 1, "position": [{x}, 0, 0] }}"#
            )
        };
        let text = format!(r#"{{ "bodies": [ {}, {} ], "joints": [ {joint} ] }}"#, body("a", 0.0), body("b", 1.0));
        let mut world = hecs::World::new();
        let scene = Scene::from_json(&text, "scene.json").map_err(|error| error.to_string())?;
        scene.spawn(&mut world).map_err(|error| error.to_string())?;
        Ok(world)
    }

    #[test]
    fn every_kind_is_spawned_between_its_bodies() {
        for kind in ["ball", "hinge", "slider", "cylinder", "universal", "planar", "fixed", "free"] {
            let text = format!(r#"{{ "between": ["a", "b"], "{kind}": {{ "at": [0.5, 0, 0], "axis": [0, 0, 2] }} }}"#);
            let world = scene(&text).unwrap();
            let mut joints = world.query::<&tumble::Joint>();
            let joint = joints.iter().next().unwrap();
            assert_eq!(joint.frames.map(|frame| frame.position.x), [0.5, -0.5], "{kind}");
            assert!(!joint.contacts_enabled);
        }
    }

    #[test]
    fn what_is_wrong_with_a_joint_is_named() {
        for (joint, problem) in [
            (r#"{ "ball": { "at": [0, 0, 0] } }"#, "joints[0].between: is missing"),
            (r#"{ "between": ["a", "c"], "ball": { "at": [0, 0, 0] } }"#, "no body is called \"c\""),
            (r#"{ "between": ["a", "a"], "ball": { "at": [0, 0, 0] } }"#, "names one body twice"),
            (r#"{ "between": ["a", "b"] }"#, "joints[0].kind: is missing: give one of ball, hinge"),
            (r#"{ "between": ["a", "b"], "ball": {}, "hinge": {} }"#, "joints[0].hinge: ball is given too"),
            (r#"{ "between": ["a", "b"], "hinge": { "at": [0, 0, 0] } }"#, "joints[0].hinge.axis: is missing"),
            (r#"{ "between": ["a", "b"], "hinge": { "axis": [0, 0, 1] } }"#, "joints[0].hinge.at: is missing"),
            (r#"{ "between": ["a", "b"], "hinge": { "at": [0, 0, 0], "axis": [0, 0, 0] } }"#, "is zero"),
            (r#"{ "between": ["a", "b"], "ball": { "at": [1e10, 0, 0] } }"#, "further than 1e9 m"),
            (
                r#"{ "between": ["a", "b"], "ball": { "at": [0, 0, 0], "to": [1, 0, 0] } }"#,
                "joints[0].ball.to: is for free",
            ),
        ] {
            let error = scene(joint).err().unwrap();
            assert!(error.contains(problem), "{error}");
        }
    }
}
