//! Robots in the Unified Robot Description Format (URDF, <http://wiki.ros.org/urdf/XML>): links
//! that have an inertial become bodies.

pub(crate) mod assembly;
pub(crate) mod element;
pub(crate) mod frame;
pub(crate) mod joint;
pub(crate) mod link;
pub(crate) mod mimic;
pub(crate) mod tree;
pub(crate) mod welds;

use std::collections::HashMap;
use std::path::Path;

use tumble::math::Vec3;

use crate::bodies::imported_body::ImportedBody;
use crate::bodies::imported_gear::ImportedGear;
use crate::bodies::imported_joint::{ImportedJoint, angles};
use crate::checked::check_name;
use crate::error::{FieldError, FileError, Place};
use crate::inertia_repair::InertiaRepairs;
use crate::read_file::read_limited;
use crate::terminal::one_line;

use crate::urdf::assembly::Assembly;
use crate::urdf::element::{Element, Lines};
use crate::urdf::joint::{Joint, Kind};
use crate::urdf::link::{LeftOut, Link};
use crate::urdf::tree::Tree;

/// Largest robot that is read \[bytes\]. The largest published ones have a hundredth of this; the
/// parser needs memory many times it.
const MAX_URDF_BYTES: u64 = 32 << 20;

/// Most names in one notice.
const MAX_NAMES: usize = 12;

/// A robot whose links and joints are read, the impossible ones too.
///
/// Links are at the poses they have while no joint is moved, in the frame of the root. Those that
/// fixed joints connect are one body, and so is a link without an inertial with its parent. The
/// root's body is fixed if the root is called `world` or there is no inertial in it. Where a link
/// has problems, all are listed one by one, and there are no joints.
///
/// ```
/// use tumble_import::{InertiaRepairs, Robot};
///
/// let text = r#"<robot name="brick"> <link name="base"> <inertial>
///     <mass value="2"/> <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/>
/// </inertial> </link> </robot>"#;
/// let robot = Robot::from_text(text, "brick.urdf", InertiaRepairs::Refused)?;
/// assert_eq!((robot.name.as_deref(), robot.links.len()), (Some("brick"), 1));
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Robot {
    /// What it is called, if it says so.
    pub name: Option<String>,
    /// Those that are bodies or have problems, in the order of the file.
    pub links: Vec<RobotLink>,
    /// What connects them, by their index; none where a link has problems.
    pub joints: Vec<ImportedJoint>,
    /// What ties joints that follow others (`mimic`) to these: the first is the one that is
    /// followed.
    pub gears: Vec<ImportedGear>,
    /// What is in the file and not in the bodies: a line each.
    pub notices: Vec<String>,
}

/// A link that is a body, or would be.
///
/// ```
/// use tumble_import::{InertiaRepairs, Robot};
///
/// let text = r#"<robot name="brick"> <link name="base"> <inertial>
///     <mass value="-2"/> <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/>
/// </inertial> </link> </robot>"#;
/// let robot = Robot::from_text(text, "brick.urdf", InertiaRepairs::Refused)?;
/// assert!(robot.links[0].body.is_err());
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct RobotLink {
    /// The link's name.
    pub name: String,
    /// The body, or everything that is wrong with it.
    pub body: Result<ImportedBody, Vec<FieldError>>,
}

impl Robot {
    /// Gravity \[m/s^2\]: robots have z up.
    pub const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

    /// Reads a `.urdf` file.
    ///
    /// # Errors
    /// [`FileError`] if it is not a robot at all.
    pub fn open(path: &Path, repairs: InertiaRepairs) -> Result<Self, FileError> {
        Self::from_text(&read_limited(path, MAX_URDF_BYTES)?, &path.to_string_lossy(), repairs)
    }

    /// As [`open`](Self::open), from text; `file` is what messages call it.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_text(text: &str, file: &str, repairs: InertiaRepairs) -> Result<Self, FileError> {
        // Editors on Windows put a byte-order mark in front.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let document = element::parse(text, file)?;
        let lines = Lines::of(text);
        let robot = Element::root(&document, &lines);
        let malformed = |problem: String| FileError::Malformed {
            file: one_line(file),
            place: Place::default(),
            problem: one_line(&problem),
        };
        if element::has_macros(&document) {
            return Err(malformed(element::EXPAND.to_owned()));
        }
        if robot.name() != "robot" {
            return Err(malformed(format!("the outermost element of a robot is <robot>, not <{}>", robot.name())));
        }
        let mut left_out = LeftOut { repairs, ..LeftOut::default() };
        let mut links: Vec<Link> = robot.all("link").map(|link| Link::read(link, &mut left_out)).collect();
        if links.is_empty() {
            return Err(malformed("the robot has no link".to_owned()));
        }
        check_names(&mut links);
        let tree = Tree::read(robot, &mut links);
        let is_sound = links.iter().all(|link| link.problems.is_empty());
        let assembly = is_sound.then(|| Assembly::of(&links, &tree));
        let mut notices = notices(&links, &tree, assembly.as_ref(), &left_out);
        notices.extend(left_out.repaired.iter().map(|repair| one_line(repair)));
        let name = robot.attribute("name").map(one_line);
        let (links, joints, gears) = match assembly {
            Some(assembly) => (assembly.links, assembly.joints, assembly.gears),
            None => (assembly::one_by_one(&links, &tree.frames), Vec::new(), Vec::new()),
        };
        Ok(Self { name, links, joints, gears, notices })
    }

    /// Bodies and their names, or the first problem.
    ///
    /// # Errors
    /// [`FileError::Link`].
    pub fn into_bodies(self, file: &str) -> Result<(Vec<ImportedBody>, Vec<String>), FileError> {
        let mut bodies = Vec::with_capacity(self.links.len());
        let mut names = Vec::with_capacity(self.links.len());
        for link in self.links {
            match link.body {
                Ok(body) => bodies.push(body),
                Err(problems) => {
                    let first = problems.into_iter().next();
                    let first = first.unwrap_or_else(|| FieldError::new("inertial", "is impossible"));
                    let (file, link) = (one_line(file), one_line(&link.name));
                    return Err(FileError::Link { file, link, field: one_line(&first.field), problem: first.problem });
                }
            }
            names.push(link.name);
        }
        Ok((bodies, names))
    }
}

fn check_names(links: &mut [Link]) {
    let mut first: HashMap<String, usize> = HashMap::with_capacity(links.len());
    for link in links {
        // A name that is missing has been complained of.
        if link.name.is_empty() && !link.problems.is_empty() {
            continue;
        }
        if let Err(problem) = check_name(&link.name) {
            link.problems.push(problem);
        }
        if let Some(line) = first.insert(link.name.clone(), link.line) {
            let problem = format!("is also that of the link at line {line}, at line {}", link.line);
            link.problems.push(FieldError::new("name", problem));
        }
    }
}

/// What is in the file and not in the simulation, or otherwise than the file has it.
fn notices(links: &[Link], tree: &Tree, assembly: Option<&Assembly>, left_out: &LeftOut) -> Vec<String> {
    let mut notices = Vec::new();
    let mut list = |names: &[String], noun: &str, what: &str| {
        if !names.is_empty() {
            notices.push(format!("{} {what}: {}", counted(names.len(), noun), listed(names)));
        }
    };
    let joints = |wanted: &dyn Fn(&Joint) -> bool| -> Vec<String> {
        tree.joints.iter().filter(|joint| wanted(joint)).map(|joint| joint.name.clone()).collect()
    };
    let is_held =
        |joint: &Joint| assembly.is_some_and(|assembly| assembly.welds.held.binary_search(&joint.child).is_ok());
    let without: Vec<String> = links
        .iter()
        .enumerate()
        .filter(|(index, link)| link.inertial.is_none() && link.problems.is_empty() && !is_part(*index, assembly))
        .map(|(_, link)| link.name.clone())
        .collect();
    list(&joints(&is_held), "joint", "to what has no inertial, held as if fixed");
    let not_geared =
        |joint: &Joint| assembly.is_some_and(|assembly| assembly.not_geared.binary_search(&joint.child).is_ok());
    list(
        &joints(&|joint| not_geared(joint) && !is_held(joint)),
        "joint",
        "with mimic that ties nothing, not simulated",
    );
    let turns = |joint: &Joint| joint.kind == Kind::Revolute && !is_held(joint);
    list(
        &joints(&|joint| turns(joint) && joint.limit.is_none()),
        "revolute joint",
        "without limit, taken for continuous",
    );
    let is_endless = |joint: &Joint| joint.limit.is_some_and(|limit| angles(limit.lower, limit.upper).is_none());
    list(
        &joints(&|joint| turns(joint) && is_endless(joint)),
        "revolute joint",
        "with a range of a turn or more, which bounds nothing",
    );
    let slides = |joint: &Joint| joint.kind == Kind::Prismatic && joint.limit.is_none() && !is_held(joint);
    list(&joints(&slides), "prismatic joint", "without limit");
    let has_dynamics = |joint: &Joint| (joint.damping, joint.friction) != (0.0, 0.0);
    let is_wide = |joint: &Joint| matches!(joint.kind, Kind::Planar | Kind::Floating);
    list(
        &joints(&|joint| is_wide(joint) && has_dynamics(joint)),
        "joint",
        "with several axes, whose dynamics is not simulated",
    );
    list(&without, "link", "without inertial, not simulated");
    list(&left_out.meshes, "mesh file", "not read, for appearance only");
    list(&left_out.shapes, "geometry", "not understood, for appearance only");
    notices
}

/// Whether a link is a body or a part of one.
fn is_part(link: usize, assembly: Option<&Assembly>) -> bool {
    assembly.is_some_and(|assembly| assembly.is_body[link])
}

fn counted(count: usize, noun: &str) -> String {
    match (count, noun) {
        (1, _) => format!("1 {noun}"),
        (_, "geometry") => format!("{count} geometries"),
        _ => format!("{count} {noun}s"),
    }
}

/// The first names, and how many more there are.
fn listed(names: &[String]) -> String {
    let first: Vec<String> = names.iter().take(MAX_NAMES).map(|name| one_line(name)).collect();
    match names.len().saturating_sub(MAX_NAMES) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}
