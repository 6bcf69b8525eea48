//! A joint: what it connects, and what it says of its axis.

use std::collections::HashMap;

use glam::{DQuat, DVec3};

use crate::checked::note;
use crate::error::FieldError;
use crate::urdf::element::Element;
use crate::urdf::frame::Frame;
use crate::urdf::mimic::Mimic;

/// What a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
    Planar,
    Floating,
}

impl Kind {
    const NAMES: [(&'static str, Self); 6] = [
        ("fixed", Self::Fixed),
        ("revolute", Self::Revolute),
        ("continuous", Self::Continuous),
        ("prismatic", Self::Prismatic),
        ("planar", Self::Planar),
        ("floating", Self::Floating),
    ];

    fn read(joint: Element<'_>) -> Result<Self, FieldError> {
        let kind = joint.needed_attribute("type")?;
        let known = Self::NAMES.into_iter().find(|(name, _)| *name == kind);
        known.map(|(_, kind)| kind).ok_or_else(|| {
            let names = Self::NAMES.map(|(name, _)| name).join(", ");
            joint.problem("type", format_args!("{kind:?} is none of {names}"))
        })
    }

    /// Whether it has an axis.
    fn has_axis(self) -> bool {
        !matches!(self, Self::Fixed | Self::Floating)
    }
}

/// A joint between links that both exist, by their index.
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) parent: usize,
    pub(crate) child: usize,
    /// The joint's frame, which is the child's, in that of the parent.
    pub(crate) origin: Frame,
    /// The rotation that takes x to the axis, in the joint's frame.
    pub(crate) to_axis: DQuat,
    /// `None` without a `limit`.
    pub(crate) limit: Option<Range>,
    /// \[N s/m\] [N m s/rad]
    pub(crate) damping: f64,
    /// \[N\] [N m]
    pub(crate) friction: f64,
    /// What it follows.
    pub(crate) mimic: Option<Mimic>,
}

/// What `limit` says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Range {
    /// \[m\] \[rad\]
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// \[N\] [N m]
    pub(crate) effort: Option<f64>,
    /// [m/s] [rad/s]
    pub(crate) velocity: Option<f64>,
}

impl Joint {
    /// Reads a joint; what is wrong with it is noted, and the index of the link that has to bear
    /// it.
    pub(crate) fn read(
        element: Element<'_>,
        by_name: &HashMap<String, usize>,
        problems: &mut Vec<FieldError>,
    ) -> (Option<Self>, usize) {
        let name = note(problems, element.needed_attribute("name")).unwrap_or_default();
        let kind = note(problems, Kind::read(element));
        let [parent, child] = ["parent", "child"].map(|end| note(problems, link_at(element, end, by_name)));
        let origin = note(problems, element.origin());
        let to_axis = match kind {
            Some(kind) if kind.has_axis() => note(problems, axis(element)),
            _ => Some(DQuat::IDENTITY),
        };
        let limit = note(problems, Range::read(element)).flatten();
        let dynamics = note(problems, dynamics(element));
        let mimic = note(problems, Mimic::read(element)).flatten();
        // The child is what a bad joint leaves in the wrong place.
        let bears = child.or(parent).unwrap_or(0);
        let [damping, friction] = dynamics.unwrap_or_default();
        let read = || {
            Some(Self {
                name: name.to_owned(),
                kind: kind.unwrap_or(Kind::Fixed),
                parent: parent?,
                child: child?,
                origin: origin?,
                to_axis: to_axis.unwrap_or(DQuat::IDENTITY),
                limit,
                damping,
                friction,
                mimic,
            })
        };
        (read(), bears)
    }
}

impl Range {
    fn read(joint: Element<'_>) -> Result<Option<Self>, FieldError> {
        let Some(limit) = joint.only("limit")? else { return Ok(None) };
        let read = || {
            // Bounds that are not given are zero, by the format.
            let number = |name| limit.attribute(name).map(|_| limit.number(name)).transpose();
            let [lower, upper] = [number("lower")?.unwrap_or(0.0), number("upper")?.unwrap_or(0.0)];
            if lower > upper {
                return Err(limit.problem("lower", format_args!("is {lower}, more than the upper one, {upper}")));
            }
            Ok(Some(Self { lower, upper, effort: number("effort")?, velocity: number("velocity")? }))
        };
        read().map_err(|error: FieldError| error.inside("limit"))
    }
}

/// Damping and friction, zero if they are not given.
fn dynamics(joint: Element<'_>) -> Result<[f64; 2], FieldError> {
    let Some(dynamics) = joint.only("dynamics")? else { return Ok([0.0; 2]) };
    let number = |name| match dynamics.attribute(name).map(|_| dynamics.number(name)).transpose()? {
        Some(value) if value < 0.0 => Err(dynamics.problem(name, format_args!("must not be negative, as {value} is"))),
        value => Ok(value.unwrap_or(0.0)),
    };
    let read = || Ok([number("damping")?, number("friction")?]);
    read().map_err(|error: FieldError| error.inside("dynamics"))
}

/// The rotation that takes x to the axis; x itself, if none is given.
fn axis(joint: Element<'_>) -> Result<DQuat, FieldError> {
    let Some(element) = joint.only("axis")? else { return Ok(DQuat::IDENTITY) };
    let read = || {
        let axis = element.triple("xyz")?.map_or(DVec3::X, DVec3::from_array);
        // Scaled first, since a square may overflow or vanish.
        let scaled = (axis / axis.abs().max_element()).try_normalize();
        scaled.map(from_x_to).ok_or_else(|| element.problem("xyz", "is zero: give a direction"))
    };
    read().map_err(|error: FieldError| error.inside("axis"))
}

/// The shortest rotation that takes x to a direction.
fn from_x_to(direction: DVec3) -> DQuat {
    // Half a turn takes it to -x about any axis across; of a sine glam would make that.
    if direction.x <= -1.0 + 2.0 * f64::EPSILON {
        return DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0);
    }
    DQuat::from_rotation_arc(DVec3::X, direction)
}

/// The index of the link at one end of a joint.
fn link_at(joint: Element<'_>, end: &'static str, by_name: &HashMap<String, usize>) -> Result<usize, FieldError> {
    let element = joint.needed(end)?;
    let name = element.needed_attribute("link").map_err(|error| error.inside(end))?;
    let unknown = || element.problem(end, format_args!("no link is called {name:?}"));
    by_name.get(name).copied().ok_or_else(unknown)
}
