//! Robots in the Unified Robot Description Format (URDF, <http://wiki.ros.org/urdf/XML>): links
//! that have an inertial become bodies.

pub(crate) mod element;
pub(crate) mod frame;
pub(crate) mod link;
pub(crate) mod tree;

use std::collections::HashMap;
use std::path::Path;

use tumble::math::Vec3;
use tumble::{Amount, BodyId, Part, RigidBody, Shape};

use crate::bodies::appearance::Appearance;
use crate::bodies::imported_body::ImportedBody;
use crate::checked::{check_name, real_quaternion, real_vector};
use crate::error::{FieldError, FileError, Place};
use crate::inertia_repair::InertiaRepairs;
use crate::read_file::read_limited;
use crate::terminal::one_line;

use crate::urdf::element::{Element, Lines};
use crate::urdf::frame::Frame;
use crate::urdf::link::{Inertial, LeftOut, Link};
use crate::urdf::tree::JointNames;

/// Largest robot that is read \[bytes\]. The largest published ones have a hundredth of this; the
/// parser needs memory many times it.
const MAX_URDF_BYTES: u64 = 32 << 20;

/// Most names in one notice.
const MAX_NAMES: usize = 12;

/// A robot whose links are read, the impossible ones too.
///
/// Links with an inertial are free bodies at the poses they have while no joint is moved, in the
/// frame of the root. Joints are not simulated; the notices name them.
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
        let (frames, joints) = tree::place(robot, &mut links);
        let mut notices = notices(&links, &joints, &left_out);
        notices.extend(left_out.repaired.iter().map(|repair| one_line(repair)));
        let name = robot.attribute("name").map(one_line);
        Ok(Self { name, links: bodies(links, &frames), notices })
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

fn bodies(links: Vec<Link>, frames: &[Frame]) -> Vec<RobotLink> {
    let mut found = Vec::with_capacity(links.len());
    for (mut link, frame) in links.into_iter().zip(frames) {
        let body = link.inertial.take().map(|inertial| body(&inertial, link.shape.take(), frame, found.len() as u64));
        let body = match body {
            _ if !link.problems.is_empty() => Err(link.problems),
            Some(Err(problem)) => Err(vec![problem]),
            Some(Ok(body)) => Ok(body),
            None => continue,
        };
        found.push(RobotLink { name: link.name, body });
    }
    found
}

/// A body whose frame is the link's. What it looks like has no part in its mass properties.
fn body(inertial: &Inertial, shape: Option<Shape>, frame: &Frame, index: u64) -> Result<ImportedBody, FieldError> {
    let body = RigidBody::new(Shape::Point)
        .mass(inertial.mass)
        .center_of_mass(inertial.center_of_mass)
        .inertia(inertial.tensor)
        .position(real_vector(frame.position))
        .orientation(real_quaternion(frame.orientation))
        .id(BodyId(index));
    let body = body.build().map_err(|error| FieldError::new("inertial", error))?;
    let point = || Shape::compound([Part::new(Shape::Point, Amount::Mass(inertial.mass)).at(inertial.center_of_mass)]);
    Ok(ImportedBody {
        body,
        appearance: Appearance::Shape(shape.unwrap_or_else(point)),
        collider: None,
        pieces: Vec::new(),
    })
}

/// What is in the file and not in the simulation.
fn notices(links: &[Link], joints: &JointNames, left_out: &LeftOut) -> Vec<String> {
    let mut notices = Vec::new();
    for (kind, names) in joints {
        if !names.is_empty() {
            let joints = counted(names.len(), &format!("{kind} joint"));
            notices.push(format!("{joints} not simulated, the links move freely: {}", listed(names)));
        }
    }
    let without: Vec<String> = links
        .iter()
        .filter(|link| link.inertial.is_none() && link.problems.is_empty())
        .map(|link| link.name.clone())
        .collect();
    if !without.is_empty() {
        notices.push(format!(
            "{} without inertial, not simulated: {}",
            counted(without.len(), "link"),
            listed(&without)
        ));
    }
    if !left_out.meshes.is_empty() {
        let meshes = counted(left_out.meshes.len(), "mesh file");
        notices.push(format!("{meshes} not read, for appearance only: {}", listed(&left_out.meshes)));
    }
    if !left_out.shapes.is_empty() {
        let shapes = counted(left_out.shapes.len(), "geometry");
        notices.push(format!("{shapes} not understood, for appearance only: {}", listed(&left_out.shapes)));
    }
    notices
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
