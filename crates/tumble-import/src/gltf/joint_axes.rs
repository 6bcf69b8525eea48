//! From the limits and drives of a joint to the axes that it leaves free and what acts along them.

use std::f64::consts::PI;

use glam::DQuat;
use tumble::{Axes, Cone, Drive, Drives, Gain, Limit, Limits};

use crate::bodies::imported_joint::angles;
use crate::checked::real;
use crate::gltf::{Joint, JointDrive, JointLimit};

/// What a joint's description comes to.
#[derive(Debug)]
pub(crate) struct JointAxes {
    pub(crate) free: Axes,
    pub(crate) limits: Limits,
    pub(crate) drives: Drives,
    /// The rotation from the frame that these axes are of to that of the file: one that exchanges
    /// axes, where a cone is not about x.
    pub(crate) turned: DQuat,
    /// What of the description the engine has nothing for.
    pub(crate) left_out: Vec<&'static str>,
}

/// Limits of several axes together.
#[derive(Clone, Copy)]
struct Together {
    /// Which, by index.
    axes: [bool; 3],
    bounds: [f64; 2],
    gain: Gain,
}

/// What has been read of a description.
#[derive(Default)]
struct Reading {
    locked: [bool; 6],
    limits: [Option<Limit>; 6],
    distances: Vec<Together>,
    cones: Vec<Together>,
    left_out: Vec<&'static str>,
}

impl JointAxes {
    pub(crate) fn of(joint: &Joint) -> Self {
        let mut reading = Reading::default();
        for limit in &joint.limits {
            reading.take_limit(limit);
        }
        let distance = reading.distance();
        let cone = reading.cone();
        let is_ball = (3..6).all(|axis| !reading.locked[axis]);
        let limited = (0..3).find(|axis| is_ball && reading.limits[3 + axis].is_some());
        // The engine's cone and twist are about x: its y and z are the next axes, in a circle.
        let first = cone.map_or(limited.unwrap_or(0), |(axis, _)| axis);
        let turned = [[0.0, 0.0, 0.0, 1.0], [0.5, 0.5, 0.5, 0.5], [-0.5, -0.5, -0.5, 0.5]][first];
        let place = |axis: usize| if axis < 3 { (axis + 3 - first) % 3 } else { 3 + (axis - first) % 3 };
        let mut free = Axes::NONE;
        let mut limits = Limits { distance, cone: cone.map(|(_, cone)| cone), ..Limits::default() };
        for axis in (0..6).filter(|axis| !reading.locked[*axis]) {
            free = free | Axes::EACH[place(axis)];
            if is_ball && place(axis) > 3 && reading.limits[axis].is_some() {
                reading.left_out.push("a limit about one of three free rotations, beside the twist");
                continue;
            }
            let limit = reading.limits[axis];
            limits.axes[place(axis)] = limit.filter(|limit| axis < 3 || bounds_an_angle(limit));
            if limit.is_some() && limits.axes[place(axis)].is_none() {
                reading.left_out.push("a limit that bounds no angle");
            }
        }
        let mut drives = Drives::default();
        for drive in &joint.drives {
            match reading.drive(drive, place) {
                Ok(drive) => drives.0.extend(drive),
                Err(unknown) => reading.left_out.push(unknown),
            }
        }
        Self { free, limits, drives, turned: DQuat::from_array(turned), left_out: reading.left_out }
    }
}

impl Reading {
    fn take_limit(&mut self, limit: &JointLimit) {
        let is_linear = limit.angular_axes.is_empty();
        let (axes, offset) = if is_linear { (&limit.linear_axes, 0) } else { (&limit.angular_axes, 3) };
        let gain = limit.stiffness.map_or(Gain::Rigid, |stiffness| Gain::Stiffness {
            stiffness: real(stiffness),
            damping: real(limit.damping),
        });
        let bounds = [limit.min.unwrap_or(f64::NEG_INFINITY), limit.max.unwrap_or(f64::INFINITY)];
        let of_axis = |axis: &u8| offset + usize::from(*axis).min(2);
        if let [axis] = axes.as_slice() {
            let axis = of_axis(axis);
            if bounds == [0.0; 2] && gain == Gain::Rigid {
                self.locked[axis] = true;
            } else {
                self.limit(axis, bounds, gain);
            }
            return;
        }
        // Distances, and angles of several axes together, are never negative.
        let bounds = [bounds[0].max(0.0), bounds[1]];
        if bounds[1] < 0.0 {
            self.left_out.push("a negative max of several axes together");
        } else if bounds[1] == 0.0 {
            for axis in axes.iter().map(of_axis) {
                match gain {
                    Gain::Rigid => self.locked[axis] = true,
                    _ => self.limit(axis, [0.0; 2], gain),
                }
            }
        } else if is_linear {
            self.distances.push(Together { axes: which(axes), bounds, gain });
        } else if axes.len() == 2 {
            self.cones.push(Together { axes: which(axes), bounds, gain });
        } else if bounds[0] > 0.0 || bounds[1] < PI {
            self.left_out.push("a limit of the angle of all rotations together");
        }
    }

    /// Adds a range of one axis.
    fn limit(&mut self, axis: usize, bounds: [f64; 2], gain: Gain) {
        let [has_min, has_max] = bounds.map(f64::is_finite);
        // A second limit may give the bound that is missing.
        let is_endless = axis >= 3 && has_min && has_max && angles(bounds[0], bounds[1]).is_none();
        if is_endless || !(has_min || has_max) {
            return;
        }
        let [min, max] = bounds.map(real);
        let both = match self.limits[axis] {
            None => Some(Limit { min, max, gain }),
            Some(earlier) if earlier.gain == gain && gain == Gain::Rigid => {
                Some(Limit { min: earlier.min.max(min), max: earlier.max.min(max), gain })
            }
            Some(_) => None,
        };
        match both.filter(|limit| limit.min <= limit.max) {
            Some(limit) => self.limits[axis] = Some(limit),
            None => self.left_out.push("a second limit of an axis"),
        }
    }

    /// The limit of the distance, which the engine has along all free translations.
    fn distance(&mut self) -> Option<Limit> {
        let free: Vec<usize> = (0..3).filter(|axis| !self.locked[*axis]).collect();
        let mut found: Option<Limit> = None;
        for Together { axes, bounds, gain } in std::mem::take(&mut self.distances) {
            if free.iter().any(|axis| !axes[*axis]) {
                self.left_out.push("a limit of the distance from a line along which it can move");
            } else if found.is_some() {
                self.left_out.push("a second limit of the distance");
            } else if !free.is_empty() {
                let [min, max] = bounds.map(real);
                found = Some(Limit { min, max, gain });
            }
        }
        found
    }

    /// The cone, with the axis that it is about. Where one of its rotations is locked it is a limit
    /// of the other.
    fn cone(&mut self) -> Option<(usize, Cone)> {
        let mut found: Option<(usize, Cone)> = None;
        for Together { axes, bounds: [min, max], gain } in std::mem::take(&mut self.cones) {
            if min > 0.0 {
                self.left_out.push("the min of a cone");
            }
            if max >= PI {
                continue;
            }
            let about = (0..3).find(|axis| !axes[*axis]).unwrap_or(0);
            let free: Vec<usize> = (0..3).filter(|axis| axes[*axis] && !self.locked[3 + axis]).collect();
            match free.as_slice() {
                [] => {}
                [axis] => self.limit(3 + axis, [-max, max], gain),
                _ if self.locked[3 + about] => self.left_out.push("a cone about an axis about which it cannot turn"),
                _ if found.is_some() => self.left_out.push("a second cone"),
                _ => found = Some((about, Cone { half_angles: [real(max); 2], gain })),
            }
        }
        found
    }

    /// A drive of a free axis, if it does anything; what is unknown about it is the error.
    fn drive(&self, drive: &JointDrive, place: impl Fn(usize) -> usize) -> Result<Option<Drive>, &'static str> {
        let offset = match drive.r#type.as_str() {
            "linear" => 0,
            "angular" => 3,
            _ => return Err("a drive of an unknown type"),
        };
        let axis = offset + usize::from(drive.axis).min(2);
        let position = drive.position_target.filter(|_| drive.stiffness > 0.0);
        let stiffness = real(position.map_or(0.0, |_| drive.stiffness));
        let damping = real(drive.damping);
        let gain = match drive.mode.as_str() {
            "force" => Gain::Stiffness { stiffness, damping },
            "acceleration" => Gain::Acceleration { stiffness, damping },
            _ => return Err("a drive of an unknown mode"),
        };
        if (stiffness, damping) == (0.0, 0.0) {
            return Ok(None);
        }
        if self.locked[axis] {
            return Err("a drive of a locked axis");
        }
        Ok(Some(Drive {
            axes: Axes::EACH[place(axis)],
            position: position.map(real),
            velocity: real(drive.velocity_target.unwrap_or(0.0)),
            gain,
            max_force: drive.max_force.map_or(tumble::math::Real::INFINITY, real),
            oscillation: None,
        }))
    }
}

/// Whether a limit of a rotation, with all that was read of it, does anything.
#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
fn bounds_an_angle(limit: &Limit) -> bool {
    angles(limit.min.into(), limit.max.into()).is_some()
}

fn which(axes: &[u8]) -> [bool; 3] {
    [0, 1, 2].map(|axis| axes.contains(&axis))
}
