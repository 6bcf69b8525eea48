//! Joints that follow others.

use std::collections::HashMap;

use crate::bodies::imported_gear::ImportedGear;
use crate::checked::real;
use crate::error::FieldError;
use crate::urdf::element::Element;
use crate::urdf::joint::{Joint, Kind};

/// What `mimic` says: the value is `multiplier` times that of another joint, and `offset`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mimic {
    /// The name of the other joint.
    joint: String,
    /// A number, [m/rad] or [rad/m].
    multiplier: f64,
    /// \[m\] \[rad\]
    offset: f64,
    line: usize,
}

impl Mimic {
    pub(crate) fn read(joint: Element<'_>) -> Result<Option<Self>, FieldError> {
        let Some(mimic) = joint.only("mimic")? else { return Ok(None) };
        let number = |name, otherwise| mimic.attribute(name).map_or(Ok(otherwise), |_| mimic.number(name));
        let read = || {
            Ok(Some(Self {
                joint: mimic.needed_attribute("joint")?.to_owned(),
                multiplier: number("multiplier", 1.0)?,
                offset: number("offset", 0.0)?,
                line: mimic.line(),
            }))
        };
        read().map_err(|error: FieldError| error.inside("mimic"))
    }

    fn problem(&self, problem: impl std::fmt::Display) -> FieldError {
        FieldError::new("mimic.joint", format!("{problem}, at line {}", self.line))
    }
}

/// What is wrong with whom joints follow, with the index of the joint. The names are those of all
/// joints of the file, the impossible ones too.
pub(crate) fn problems<T>(joints: &[Joint], names: &HashMap<&str, T>) -> Vec<(usize, FieldError)> {
    let leaders = leaders(joints);
    let mut problems = Vec::new();
    for (index, mimic) in joints.iter().enumerate().filter_map(|(index, joint)| Some((index, joint.mimic.as_ref()?))) {
        if !names.contains_key(mimic.joint.as_str()) {
            problems.push((index, mimic.problem(format_args!("no joint is called {:?}", mimic.joint))));
        } else if leaders[index] == Some(index) {
            problems.push((index, mimic.problem("is the joint itself")));
        }
    }
    problems.extend(circles(&leaders).into_iter().filter_map(|index| {
        let mimic = joints.get(index)?.mimic.as_ref()?;
        Some((index, mimic.problem(format_args!("{:?} follows this joint by way of others", mimic.joint))))
    }));
    problems
}

/// Of each joint the index of the one that it follows.
fn leaders(joints: &[Joint]) -> Vec<Option<usize>> {
    let mut by_name: HashMap<&str, usize> = HashMap::with_capacity(joints.len());
    for (index, joint) in joints.iter().enumerate() {
        by_name.entry(&joint.name).or_insert(index);
    }
    joints.iter().map(|joint| by_name.get(joint.mimic.as_ref()?.joint.as_str()).copied()).collect()
}

/// One joint of each circle of two and more that follow each other.
fn circles(leaders: &[Option<usize>]) -> Vec<usize> {
    let mut reached_from = vec![usize::MAX; leaders.len()];
    let mut circles = Vec::new();
    for start in 0..leaders.len() {
        let mut at = Some(start);
        while let Some(index) = at.filter(|index| reached_from[*index] == usize::MAX) {
            reached_from[index] = start;
            at = leaders[index];
        }
        // Round to where this walk has been.
        circles.extend(at.filter(|index| reached_from[*index] == start && leaders[*index] != Some(*index)));
    }
    circles
}

/// The gears of joints that follow others, where these joints are in the assembly by their indices,
/// and the links, in order, to which those lead that follow nothing.
pub(crate) fn gears(joints: &[Joint], assembled: &[Option<usize>]) -> (Vec<ImportedGear>, Vec<usize>) {
    let leaders = leaders(joints);
    let with_one_axis = |index: usize| {
        let kind = joints.get(index)?.kind;
        let place = assembled.get(index).copied().flatten()?;
        matches!(kind, Kind::Revolute | Kind::Continuous | Kind::Prismatic).then_some(place)
    };
    let (mut gears, mut others) = (Vec::new(), Vec::new());
    for (index, joint) in joints.iter().enumerate() {
        let Some(Mimic { multiplier, offset, .. }) = joint.mimic else { continue };
        let ends = [leaders[index].and_then(with_one_axis), with_one_axis(index)];
        match ends {
            [Some(leader), Some(follower)] if real(multiplier) != 0.0 => {
                gears.push(ImportedGear { joints: [leader, follower], ratio: multiplier, offset });
            }
            _ => others.push(joint.child),
        }
    }
    others.sort_unstable();
    (gears, others)
}
