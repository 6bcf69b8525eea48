//! Numeric fields of a scene, by their path.

use tumble::Settings;
use tumble_import::FieldError;

use crate::alike::unknown;
use crate::convert;
use crate::fields::body_path::in_body;
use crate::fields::joint_path::in_joint;
use crate::limits::MAX_STEPS;
use crate::model::joint_model::JointModel;
use crate::model::scene_model::{BodyModel, SceneModel};
use crate::values::tuple::{Triple, Tuple};

/// Where a number stands: in the scene itself, or in one of its bodies or joints.
///
/// ```
/// use tumble_scene::{RunOverrides, SceneTemplate};
///
/// let scene = SceneTemplate::open("t-handle", RunOverrides::default())?;
/// let field = scene.field("bodies[0].angular_velocity.1")?;
/// assert!(field.same_place(&scene.field("bodies.0.angular_velocity[1]")?));
/// assert!(scene.field("steps")?.is_count());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPath {
    /// As it was written.
    text: String,
    owner: Owner,
    /// What follows the owner.
    segments: Vec<String>,
}

/// What a number is of: bodies and joints by their index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Owner {
    Scene,
    Body(usize),
    Joint(usize),
}

/// A number of the model.
enum Slot<'a> {
    Real(&'a mut f64),
    Count32(&'a mut u32),
    Count64(&'a mut u64),
}

const OF_A_SCENE: &str = "gravity.0 to gravity.2, dt, steps, substeps, contact_substeps, restitution_threshold, sleep.speed, sleep.time, bodies.INDEX_OR_NAME.FIELD and joints.INDEX_OR_NAME.FIELD";
const OF_A_BODY: &str = "mass, density, gravity_scale, position.I, orientation.I, orientation.angle, orientation.axis.I, linear_velocity.I, \
     angular_velocity.I, center_of_mass.I, inertia.principal.I, inertia.axes.I, inertia.tensor.I.J, shape.FIELD, collider.FIELD and forces.I.FIELD";

const OF_A_JOINT: &str = "KIND.at.I, KIND.to.I, KIND.axis.I, limits.AXIS.BOUND, limits.cone.half_angles.I, \
     drives.I.FIELD, drives.I.oscillation.FIELD, friction.AXIS, break.force and break.torque, of glTF and URDF also position";

impl FieldPath {
    /// Finds the body or joint that the path names. Whether it has the field is found out by
    /// [`set_in_scene`](Self::set_in_scene), [`set_in_body`](Self::set_in_body) and
    /// [`set_in_joint`](Self::set_in_joint).
    ///
    /// Bodies and joints go by their index or, if that is not a number, by their name, which may
    /// have dots in it.
    pub(crate) fn new(text: &str, model: &SceneModel) -> Result<Self, FieldError> {
        let bodies = || model.bodies.iter().enumerate().map(|(index, body)| (index, convert::name(body, index)));
        let joints = || model.joints.iter().enumerate().filter_map(|(index, joint)| Some((index, joint.name.clone()?)));
        let found = if is_of_list(text, "bodies") {
            find(text, ("bodies", "body"), model.bodies.len(), bodies())
                .map(|(index, after)| (Owner::Body(index), after))
        } else if is_of_list(text, "joints") {
            find(text, ("joints", "joint"), model.joints.len(), joints())
                .map(|(index, after)| (Owner::Joint(index), after))
        } else {
            Ok((Owner::Scene, segments(text)))
        };
        let brackets = || "brackets go around an index, as in gravity[1]".to_owned();
        let whole = found.and_then(|(owner, after)| Ok((owner, after.ok_or_else(brackets)?)));
        let (owner, segments) = whole.map_err(|problem| FieldError::new(text, problem))?;
        Ok(Self { text: text.to_owned(), owner, segments })
    }

    /// As it was written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it is the same number as another one, however they are written.
    #[must_use]
    pub fn same_place(&self, other: &Self) -> bool {
        self.owner == other.owner && self.canonical() == other.canonical()
    }

    /// Without the name of a shape, which may be left out, and with the lower index of a symmetric
    /// tensor's entry first.
    fn canonical(&self) -> Vec<&str> {
        const SHAPES: [&str; 10] = [
            "sphere",
            "hollow_sphere",
            "cuboid",
            "cylinder",
            "capsule",
            "cone",
            "ellipsoid",
            "compound",
            "half_space",
            "height_field",
        ];
        let mut segments = self.segments();
        segments.retain(|segment| !SHAPES.contains(segment));
        if let ["inertia", "tensor", indices @ ..] = segments.as_mut_slice() {
            indices.sort_unstable();
        }
        segments
    }

    /// What it is of.
    pub(crate) fn owner(&self) -> Owner {
        self.owner
    }

    /// The field's name, if it is one of the scene that has no parts.
    #[must_use]
    pub fn scene_field(&self) -> Option<&str> {
        match self.segments.as_slice() {
            [name] if self.owner == Owner::Scene => Some(name),
            _ => None,
        }
    }

    /// Whether the field counts something.
    #[must_use]
    pub fn is_count(&self) -> bool {
        self.owner == Owner::Scene
            && matches!(self.segments.first().map(String::as_str), Some("steps" | "substeps" | "contact_substeps"))
    }

    /// Sets a field of the scene itself.
    pub(crate) fn set_in_scene(&self, scene: &mut SceneModel, value: f64) -> Result<(), FieldError> {
        let segments = self.segments();
        let slot = match segments.as_slice() {
            ["gravity", axis] => component(scene.gravity.get_or_insert_with(default_gravity), axis).map(Slot::Real),
            ["dt"] => Some(Slot::Real(scene.dt.get_or_insert(0.0))),
            ["steps"] => Some(Slot::Count64(scene.steps.get_or_insert(0))),
            ["substeps"] => Some(Slot::Count32(scene.substeps.get_or_insert(0))),
            ["contact_substeps"] => Some(Slot::Count32(scene.contact_substeps.get_or_insert(0))),
            ["restitution_threshold"] => Some(Slot::Real(scene.restitution_threshold.get_or_insert(0.0))),
            ["sleep", field] => scene.sleep.get_or_insert_default().number(field).map(Slot::Real),
            _ => None,
        };
        slot.ok_or_else(|| self.unknown("the scene", OF_A_SCENE))?.set(value).map_err(|problem| self.error(problem))
    }

    /// Sets a field of a body, [the one](Self::owner) it is in.
    pub(crate) fn set_in_body(&self, body: &mut BodyModel, value: f64) -> Result<(), FieldError> {
        let segments = self.segments();
        let unknown = || {
            match segments.first() {
            Some(&part @ ("inertia" | "forces" | "shape" | "collider")) => self.error(format!(
                "the scene does not have this number, and {part} does not begin from a default: only what stands in the scene can vary"
            )),
            _ => self.unknown("the body", OF_A_BODY),
        }
        };
        *in_body(body, &segments).ok_or_else(unknown)? = value;
        if let ["inertia", "tensor", row, column] = segments.as_slice() {
            // The tensor is symmetric, so an entry off the diagonal is two.
            *in_body(body, &["inertia", "tensor", column, row]).ok_or_else(unknown)? = value;
        }
        Ok(())
    }

    /// Sets a field of a joint, [the one](Self::owner) it is in.
    pub(crate) fn set_in_joint(&self, joint: &mut JointModel, value: f64) -> Result<(), FieldError> {
        let unknown = || self.unknown("the joint as it stands in the scene", OF_A_JOINT);
        *in_joint(joint, &self.segments()).ok_or_else(unknown)? = value;
        Ok(())
    }

    /// What follows the owner.
    pub(crate) fn segments(&self) -> Vec<&str> {
        self.segments.iter().map(String::as_str).collect()
    }

    fn error(&self, problem: String) -> FieldError {
        FieldError::new(self.text.as_str(), problem)
    }

    fn unknown(&self, owner: &str, known: &str) -> FieldError {
        self.error(format!("{owner} has no such number; there may be {known}"))
    }
}

impl Slot<'_> {
    fn set(self, value: f64) -> Result<(), String> {
        let count = |most: u64| {
            if (0.0..=most as f64).contains(&value) && value.fract() == 0.0 {
                Ok(value as u64)
            } else {
                Err(format!("must be a whole number from 0 to {most}, not {}", tumble_import::shortest(value)))
            }
        };
        match self {
            Slot::Real(slot) => *slot = value,
            Slot::Count64(slot) => *slot = count(MAX_STEPS)?,
            Slot::Count32(slot) => *slot = count(u64::from(u32::MAX))? as u32,
        }
        Ok(())
    }
}

/// What a scene that does not say so has.
fn default_gravity() -> Triple {
    Tuple(crate::values::checked::double_vector(Settings::default().gravity))
}

/// Whether a path begins with the name of a list and one of its elements.
fn is_of_list(path: &str, list: &str) -> bool {
    path.strip_prefix(list).is_some_and(|rest| rest.starts_with(['.', '[']))
}

/// The index of the element of a list that a path leads to, by index or name, and the segments
/// after it; none where their brackets do not match.
fn find(
    path: &str,
    (list, one): (&str, &str),
    count: usize,
    names: impl Iterator<Item = (usize, String)>,
) -> Result<(usize, Option<Vec<String>>), String> {
    let rest = path.get(list.len()..).unwrap_or_default();
    let (is_after_dot, rest) = (rest.starts_with('.'), rest.get(1..).unwrap_or_default());
    let first = rest.split(['.', '[', ']']).next().unwrap_or_default();
    if let Some(index) = index(first) {
        // Without the list and the index.
        let after = segments(path).map(|segments| segments.into_iter().skip(2).collect());
        return if index < count {
            Ok((index, after))
        } else {
            Err(format!("there are {count} {list}, so none is {list}[{index}]"))
        };
    }
    // A name may be the beginning of another one, and may have dots and brackets itself.
    let names: Vec<(usize, String)> = names.filter(|_| is_after_dot).collect();
    let named: Vec<_> = names
        .iter()
        .filter_map(|(index, name)| Some((name.len(), index, rest.strip_prefix(name.as_str())?.strip_prefix('.')?)))
        .collect();
    let longest = named.iter().map(|(length, ..)| *length).max();
    let mut of_longest = named.iter().filter(|(length, ..)| Some(*length) == longest);
    match (of_longest.next(), of_longest.next()) {
        (Some((_, index, after)), None) => Ok((**index, segments(after))),
        (Some((length, ..)), Some(_)) => {
            let name = rest.get(..*length).unwrap_or_default();
            Err(format!("two {list} are called {name:?}: give an index"))
        }
        (None, _) if names.iter().any(|(_, name)| name == first) => {
            Err("after the name of a body or joint follow a dot and a field".to_owned())
        }
        (None, _) => Err(unknown(one, first, names.iter().map(|(_, name)| name))),
    }
}

pub(crate) fn element<'a, T>(list: &'a mut [T], index: &str) -> Option<&'a mut T> {
    list.get_mut(crate::fields::field_path::index(index)?)
}

/// `a[1]` is another way to write `a.1`: messages about scenes do.
///
/// `None` where brackets do not match, or have something else than an index in them.
fn segments(path: &str) -> Option<Vec<String>> {
    let mut segments = Vec::new();
    for piece in path.split('.') {
        let (name, mut rest) = piece.split_at(piece.find('[').unwrap_or(piece.len()));
        if name.contains(']') || name.is_empty() && !rest.is_empty() {
            return None;
        }
        segments.push(name.to_owned());
        while let Some(after) = rest.strip_prefix('[') {
            let (number, after) = after.split_once(']')?;
            index(number)?;
            segments.push(number.to_owned());
            rest = after;
        }
        if !rest.is_empty() {
            return None;
        }
    }
    Some(segments)
}

/// Digits without a sign or a zero before them, so that an index is written in one way only.
fn index(text: &str) -> Option<usize> {
    let digits = text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|_| digits && (text == "0" || !text.starts_with('0')))
}

pub(crate) fn component<'a, const N: usize>(tuple: &'a mut Tuple<f64, N>, index: &str) -> Option<&'a mut f64> {
    element(&mut tuple.0, index)
}

pub(crate) fn from_zero<'a>(vector: &'a mut Option<Triple>, axis: &str) -> Option<&'a mut f64> {
    component(vector.get_or_insert(Tuple([0.0; 3])), axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::parse::{Format, parse};

    /// A scene in which every kind of field is there, as `field_paths` names them.
    const SCENE: &str = r#"{ "dt": 0.25, "bodies": [
        { "name": "a", "shape": { "compound": { "parts": [
            { "shape": { "sphere": { "radius": 1 } }, "mass": 1 },
            { "shape": { "cuboid": { "half_extents": [1, 2, 3] } }, "density": 4, "position": [7, 8, 9] } ] } },
          "forces": [ { "gravity_scale": 2 }, { "damping": { "linear": 0.5 } } ] },
        { "name": "a.b[1]", "shape": { "cone": { "radius": 1, "half_height": 2 } }, "mass": 1,
          "inertia": { "tensor": [[2, 0, 0], [0, 2, 0], [0, 0, 2]] } },
        { "shape": { "ellipsoid": { "radii": [1, 2, 3] } }, "density": 1, "center_of_mass": [0, 0, 0],
          "inertia": { "principal": [2, 2, 2] }, "collider": {}, "orientation": { "axis": [0, 0, 1], "angle": 1 } },
        { "shape": { "half_space": {} }, "fixed": true, "collider": { "static_friction": 1, "dynamic_friction": 1 } },
        { "shape": { "height_field": { "heights": [[0, 1], [2, 3]] } }, "fixed": true, "collider": {} } ],
        "joints": [ { "name": "j", "hinge": { "at": [0, 0, 0] } },
        { "name": "j.k", "hinge": { "at": [0, 0, 0] }, "drives": [ { "axes": ["angular_x"] } ] },
        { "free": { "at": [0, 0, 0] } }, { "name": "twin" }, { "name": "twin" } ] }"#;

    fn model() -> SceneModel {
        parse(SCENE, Format::Json, "scene").unwrap()
    }

    /// Sets the field to a value that stands nowhere else; how the model is printed then.
    fn set(path: &str) -> Result<String, FieldError> {
        let mut model = model();
        let path = FieldPath::new(path, &model)?;
        match path.owner() {
            Owner::Body(body) => path.set_in_body(&mut model.bodies[body], 4321.0)?,
            Owner::Joint(joint) => path.set_in_joint(&mut model.joints[joint], 4321.0)?,
            Owner::Scene => path.set_in_scene(&mut model, 4321.0)?,
        }
        Ok(format!("{model:?}"))
    }

    #[test]
    fn a_misspelt_name_is_answered_and_a_name_alone_is_no_field() {
        let error = |path: &str| set(path).unwrap_err().to_string();
        let misspelt = error("joints.twins.position");
        assert!(misspelt.contains("no joint is called \"twins\": did you mean \"twin\"?"), "{misspelt}");
        for path in ["bodies.a", "bodies.a[mass]"] {
            let alone = error(path);
            assert!(alone.contains("after the name of a body or joint follow a dot and a field"), "{alone}");
        }
    }

    #[test]
    fn every_number_of_a_scene_has_a_path() {
        let paths = "gravity.0 gravity.2 dt steps substeps bodies.0.mass bodies.a.density bodies.a.gravity_scale \
             bodies[2].position[1] bodies.0.linear_velocity.2 bodies.0.angular_velocity.0 bodies.0.orientation.3 \
             bodies.0.shape.compound.parts.0.shape.sphere.radius bodies.0.shape.parts[1].shape.half_extents[2] \
             bodies.0.shape.parts.0.mass bodies.0.shape.parts.1.density bodies.0.shape.parts.1.position.0 \
             bodies.0.shape.parts.0.orientation.1 bodies.0.forces.0.gravity_scale bodies.0.forces.1.damping.linear \
             bodies.0.forces.1.damping.angular bodies.a.b[1].shape.cone.radius bodies.1.shape.half_height \
             bodies.1.inertia.tensor.1.1 bodies.body-2.inertia.principal.0 bodies.2.inertia.axes.3 bodies.2.shape.radii.1 \
             bodies.2.center_of_mass.1 bodies.2.orientation.angle bodies.2.orientation.axis.1 bodies.1.orientation.angle contact_substeps restitution_threshold sleep.speed sleep.time bodies.2.collider.friction \
             bodies.2.collider.restitution bodies.2.collider.rolling_resistance bodies.3.collider.static_friction \
             bodies.3.collider.dynamic_friction bodies.3.collider.surface_velocity.2 bodies.3.shape.half_space.normal.0 bodies.3.shape.normal.2 \
             bodies.4.shape.height_field.heights.1.0 bodies.4.shape.heights[0][1] bodies.4.shape.spacing.1 \
             joints.j.hinge.at.1 joints[1].hinge.at[0] joints.j.k.drives[0].max_force joints.2.free.at.2 \
             joints.2.friction.linear_x joints.3.break.force";
        let mut seen = std::collections::BTreeSet::new();
        for path in paths.split_whitespace() {
            let text = set(path).unwrap();
            assert_eq!(text.matches("4321").count(), 1, "{path}: {text}");
            assert!(seen.insert(text), "{path} is the same number as another path");
        }
        // Both of a pair; a tensor that is not symmetric is none.
        assert_eq!(set("bodies.1.inertia.tensor.0.2").unwrap().matches("4321").count(), 2);
    }

    #[test]
    fn what_is_not_there_keeps_its_default() {
        assert_eq!(default_gravity().0.map(|g| (100.0 * g).round()), [0.0, -981.0, 0.0]);
        assert!(set("gravity.0").unwrap().contains("[4321.0, -9.81"));
        assert!(set("bodies.0.orientation.0").unwrap().contains("[4321.0, 0.0, 0.0, 1.0]"));
    }

    #[test]
    fn what_is_no_number_of_the_scene_is_named() {
        for bad in [
            "",
            "gravity",
            "gravity.3",
            "gravity.x",
            "mass",
            "name",
            "bodies",
            "bodies.0",
            "bodies.9.mass",
            "bodies.c.mass",
            "bodies.0.name",
            "bodies.0.mass.0",
            "bodies.0.shape.radius",
            "bodies.0.shape.parts.2.mass",
            "bodies.0.forces.0.damping.linear",
            "bodies.0.forces.2.gravity_scale",
            "bodies.1.shape.sphere.radius",
            "bodies.1.inertia.principal.0",
            "bodies.2.inertia.tensor.0.0",
            "bodies.2.orientation.0",
            "bodies.1.inertia.tensor.0.3",
            "bodies.-1.mass",
            "bodies.0.fixed",
            "bodies.00.mass",
            "gravity.+1",
            "gravity.01",
            "bodies.99999999999999999999999.mass",
            "dt]",
            "dt[",
            "[dt]",
            "gravity[1",
            "gravity1]",
            "gravity[[1]]",
            "gravity[1]x",
            "gravity.[1]",
            "gravity[]",
            "bodies[0.mass",
            "bodies.0].mass",
            "bodies..0.mass",
            "bodies.a.position[1",
            "bodies.a.collider.friction",
            "bodies.2.collider.static_friction",
            "bodies.3.collider.friction",
            "joints",
            "joints.0",
            "joints.0.name",
            "joints.5.hinge.at.0",
            "joints.l.hinge.at.0",
            "joints.j.ball.at.0",
            "joints[j].hinge.at.0",
            "joints[0.hinge.at.0",
            "joints.0.drives.0.velocity",
            "joints.2.limits.distance.max",
            "joints.twin.break.force",
        ] {
            let error = set(bad).unwrap_err();
            assert_eq!(error.field, bad, "{error}");
            assert!(!error.problem.is_empty());
        }
    }

    #[test]
    fn what_does_not_begin_from_a_default_is_said() {
        for path in ["bodies.0.inertia.tensor.0.0", "bodies.2.forces.0.gravity_scale"] {
            let problem = set(path).unwrap_err().problem;
            assert!(problem.contains("does not begin from a default"), "{path}: {problem}");
        }
        let path = |text| FieldPath::new(text, &model()).unwrap();
        assert_eq!(path("dt").scene_field(), Some("dt"));
        assert_eq!((path("gravity[1]").scene_field(), path("bodies.0.mass").scene_field()), (None, None));
    }

    #[test]
    fn one_place_is_known_by_all_its_names() {
        let same = |a, b| {
            let path = |text| FieldPath::new(text, &model()).unwrap();
            path(a).same_place(&path(b))
        };
        assert!(same("bodies.a.mass", "bodies[0].mass"));
        assert!(same("bodies.1.shape.cone.radius", "bodies.a.b[1].shape.radius"));
        assert!(same("bodies.1.inertia.tensor.0.2", "bodies.1.inertia.tensor.2.0"));
        assert!(!same("bodies.1.inertia.tensor.0.2", "bodies.1.inertia.tensor.1.2"));
        assert!(same("joints.j.k.hinge.at.0", "joints[1].hinge.at[0]"));
        assert!(!same("joints.0.hinge.at.0", "joints.1.hinge.at.0"));
        assert!(!same("bodies.0.mass", "bodies.1.mass") && !same("gravity.0", "gravity.1"));
    }

    #[test]
    fn counts_are_whole() {
        let mut model = model();
        let (steps, parts) = (FieldPath::new("steps", &model).unwrap(), FieldPath::new("substeps", &model).unwrap());
        assert!(steps.is_count() && parts.is_count());
        assert!(!FieldPath::new("dt", &model).unwrap().is_count());
        for bad in [0.5, -1.0, 1e300, f64::from(u32::MAX) + 1.0] {
            assert!(parts.set_in_scene(&mut model, bad).is_err(), "{bad}");
        }
        for bad in [0.5, -1.0, 1e300] {
            assert!(steps.set_in_scene(&mut model, bad).is_err(), "{bad}");
        }
        let problem = |path: &FieldPath, value| path.set_in_scene(&mut self::model(), value).unwrap_err().problem;
        assert!(problem(&steps, 1e18).starts_with("must be a whole number from 0 to 1000000000000, not "));
        assert!(problem(&parts, 1e18).starts_with("must be a whole number from 0 to 4294967295, not "));
        steps.set_in_scene(&mut model, 7e9).unwrap();
        assert_eq!(model.steps, Some(7_000_000_000));
    }
}
