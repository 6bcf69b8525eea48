//! A link: its inertial and what it looks like.

use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::FRAC_1_SQRT_2;
use tumble::{Amount, InertiaTensor, Part, Shape};
use tumble_math::InertiaError;

use crate::checked::{note, positive};
use crate::error::FieldError;
use crate::inertia_repair::{InertiaRepairs, nearest_moments, repair_notice};

use crate::urdf::element::Element;
use crate::urdf::frame::Frame;

/// Of this part of the largest moment a tensor that was rounded to three digits may break the
/// triangle inequality.
const ROUNDED: f64 = 0.01;

/// Takes local y, along which our cylinders lie, to z, along which those of robots lie.
const Y_TO_Z: DQuat = DQuat::from_xyzw(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// What a link says of itself.
pub(crate) struct Link {
    pub(crate) name: String,
    pub(crate) line: usize,
    /// `None` without an inertial, and with an impossible one.
    pub(crate) inertial: Option<Inertial>,
    /// In the link's frame; `None` if no primitive says what it looks like.
    pub(crate) shape: Option<Shape>,
    pub(crate) problems: Vec<FieldError>,
}

/// Mass, centre of mass and inertia, in the link's frame.
pub(crate) struct Inertial {
    pub(crate) mass: f64,
    pub(crate) center_of_mass: DVec3,
    /// About the centre of mass, axes of the link.
    pub(crate) tensor: InertiaTensor,
}

/// What is in the links and is not read, or not as it stands there, for the notices.
#[derive(Default)]
pub(crate) struct LeftOut {
    /// What is to be done about impossible moments, and what was done.
    pub(crate) repairs: InertiaRepairs,
    pub(crate) repaired: Vec<String>,
    pub(crate) meshes: Vec<String>,
    pub(crate) shapes: Vec<String>,
}

impl Link {
    pub(crate) fn read(link: Element<'_>, left_out: &mut LeftOut) -> Self {
        let mut problems = Vec::new();
        let name = note(&mut problems, link.needed_attribute("name")).unwrap_or_default();
        let inertial = note(&mut problems, link.only("inertial")).flatten();
        Self {
            name: name.to_owned(),
            line: link.line(),
            inertial: inertial.and_then(|inertial| Inertial::read(inertial, name, left_out, &mut problems)),
            shape: shape(link, name, left_out),
            problems,
        }
    }
}

impl Inertial {
    /// Everything wrong is noted, not only the first thing.
    fn read(inertial: Element<'_>, name: &str, left_out: &mut LeftOut, problems: &mut Vec<FieldError>) -> Option<Self> {
        let mut found = Vec::new();
        let mass = note(&mut found, mass(inertial));
        let matrix = note(&mut found, inertial.needed("inertia")).and_then(|inertia| matrix(inertia, &mut found));
        let tensor = matrix.and_then(|(element, matrix)| note(&mut found, tensor(element, matrix, name, left_out)));
        let frame = note(&mut found, inertial.origin());
        let turned = tensor.zip(frame).and_then(|(tensor, frame)| note(&mut found, turned(inertial, tensor, frame)));
        problems.extend(found.into_iter().map(|problem| problem.inside("inertial")));
        Some(Self { mass: mass?, center_of_mass: frame?.position, tensor: turned? })
    }
}

fn mass(inertial: Element<'_>) -> Result<f64, FieldError> {
    let element = inertial.needed("mass")?;
    let value = || {
        let mass = element.number("value")?;
        positive("value", mass).map_err(|error| element.problem("value", error.problem))
    };
    value().map_err(|error: FieldError| error.inside("mass"))
}

/// The six elements of the matrix; all that are missing or no numbers are noted.
fn matrix<'a>(inertia: Element<'a>, problems: &mut Vec<FieldError>) -> Option<(Element<'a>, DMat3)> {
    let [xx, xy, xz, yy, yz, zz] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
        .map(|name| note(problems, inertia.number(name).map_err(|error| error.inside("inertia"))));
    let (x, y, z) = (DVec3::new(xx?, xy?, xz?), DVec3::new(xy?, yy?, yz?), DVec3::new(xz?, yz?, zz?));
    Some((inertia, DMat3::from_cols(x, y, z)))
}

fn tensor(
    inertia: Element<'_>,
    matrix: DMat3,
    name: &str,
    left_out: &mut LeftOut,
) -> Result<InertiaTensor, FieldError> {
    let given = InertiaTensor::new(matrix);
    if let (Err(InertiaError::TriangleInequality { principal }), InertiaRepairs::Made) = (&given, left_out.repairs)
        && let Some((nearest, away)) = nearest_moments(*principal)
        && let Some(tensor) = nearest_tensor(matrix, *principal)
    {
        left_out.repaired.push(format!("link {name:?} {}", repair_notice(*principal, nearest, away)));
        return Ok(tensor);
    }
    given.map_err(|error| {
        let by = match error {
            InertiaError::TriangleInequality { principal } => {
                let repairable = left_out.repairs == InertiaRepairs::Refused && nearest_moments(principal).is_some();
                broken_by(principal) + if repairable { "; --repair takes the nearest possible" } else { "" }
            }
            _ => String::new(),
        };
        inertia.problem("inertia", format_args!("{error}{by}"))
    })
}

/// The tensor of the nearest possible moments in the axes that the matrix has.
fn nearest_tensor(matrix: DMat3, moments: DVec3) -> Option<InertiaTensor> {
    // With all moments larger by the excess it is one of a body, which has the same axes.
    let excess = 2.0 * moments.max_element() - moments.element_sum();
    let shifted = InertiaTensor::new(matrix + DMat3::from_diagonal(DVec3::splat(excess))).ok()?.principal();
    let (nearest, _) = nearest_moments(shifted.moments - excess)?;
    InertiaTensor::from_principal(nearest, shifted.axes).ok()
}

/// By how much ascending moments break the triangle inequality.
fn broken_by(moments: DVec3) -> String {
    let share = (moments.z - moments.y - moments.x) / moments.z;
    let why = if share < ROUNDED { ", as rounding to three digits does: give more digits" } else { "" };
    format!("; here by {share:.2e} of the largest{why}")
}

/// Into the axes of the link.
fn turned(inertial: Element<'_>, tensor: InertiaTensor, frame: Frame) -> Result<InertiaTensor, FieldError> {
    if frame.orientation == DQuat::IDENTITY {
        return Ok(tensor);
    }
    tensor.rotated(frame.orientation).map_err(|error| inertial.problem("inertia", error))
}

/// What the link looks like: its collision primitives or, if it has none, its visual ones.
fn shape(link: Element<'_>, name: &str, left_out: &mut LeftOut) -> Option<Shape> {
    let mut parts = Vec::new();
    for kind in ["collision", "visual"] {
        for element in link.all(kind) {
            match part(element) {
                Ok(Drawn::Primitive(part)) if parts.len() < crate::MAX_PARTS => parts.push(part),
                Ok(Drawn::Mesh(file)) => left_out.meshes.push(file.to_owned()),
                Ok(_) => {}
                Err(error) => left_out.shapes.push(format!("link {name:?}, {kind}.{error}")),
            }
        }
        if !parts.is_empty() {
            break;
        }
    }
    if parts.is_empty() { None } else { Some(Shape::compound(parts)) }
}

/// What a geometry is.
enum Drawn<'a> {
    Primitive(Part),
    Mesh(&'a str),
    Nothing,
}

fn part(element: Element<'_>) -> Result<Drawn<'_>, FieldError> {
    let frame = element.origin()?;
    let Some(geometry) = element.needed("geometry")?.children().next() else { return Ok(Drawn::Nothing) };
    let primitive = || {
        let half = |length: Result<f64, FieldError>| length.map(|length| 0.5 * length);
        Ok(match geometry.name() {
            "box" => {
                let size = geometry.triple("size")?.ok_or_else(|| geometry.problem("size", "is missing"))?;
                (Shape::cuboid(0.5 * DVec3::from_array(size)), DQuat::IDENTITY)
            }
            "sphere" => (Shape::sphere(geometry.number("radius")?), DQuat::IDENTITY),
            "cylinder" => (Shape::cylinder(geometry.number("radius")?, half(geometry.number("length"))?), Y_TO_Z),
            "capsule" => (Shape::capsule(geometry.number("radius")?, half(geometry.number("length"))?), Y_TO_Z),
            other => return Err(geometry.problem("", format_args!("{other:?} is not known"))),
        })
    };
    if geometry.name() == "mesh" {
        return Ok(Drawn::Mesh(geometry.attribute("filename").unwrap_or("(no name)")));
    }
    let (shape, axis) = primitive().map_err(|error: FieldError| error.inside(geometry.name()))?;
    // Its mass is the inertial's affair; lengths must be good all the same.
    shape.mass_properties(Amount::Mass(1.0)).map_err(|error| geometry.problem(geometry.name(), error))?;
    Ok(Drawn::Primitive(Part::new(shape, Amount::Density(1.0)).at(frame.position).turned(frame.orientation * axis)))
}
