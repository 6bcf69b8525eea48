//! How far a joint lets its bodies go.

use std::f64::consts::{PI, TAU};

use crate::joints::axes::Axes;
use crate::joints::gain::Gain;
use crate::math::Real;

/// How far a joint lets its bodies go: a component of the entity of a [`Joint`](crate::Joint).
///
/// Limits act on its free axes; one of a locked axis does nothing.
///
/// ```
/// use tumble::{Axes, Joint, JointLoad, Limit, Limits, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let frame = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let hatch = RigidBody::new(Shape::cuboid([0.4, 0.02, 0.3])).mass(8.0).position(Vec3::X * 0.4);
/// let hatch = hatch.build()?.spawn(&mut world);
/// let hinge = Joint::hinge(frame, hatch).at(&world, Vec3::ZERO, Vec3::Z)?;
/// let limits = Limits::along(Axes::ANGULAR_X, Limit::new(-0.5, 1.0));
/// let hinge = world.spawn((hinge, limits, JointLoad::default()));
///
/// Simulation::new(Settings::default())?.step_many(&mut world, 120);
/// // It fell open as far as it could.
/// assert!((world.get::<&JointLoad>(hinge)?.values[3] + 0.5).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "joint limits")]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Limits {
    /// Of each axis alone, in the order of [`JointLoad::values`](crate::JointLoad::values):
    /// translations \[m\], then rotations \[rad\]. Of three free rotations only that about x, the
    /// twist, can be limited alone; the others have a cone.
    pub axes: [Option<Limit>; 6],
    /// Of the distance between the origins, along the free translations \[m\].
    pub distance: Option<Limit>,
    /// Of the angle between the x axes of both frames, where all rotations are free.
    pub cone: Option<Cone>,
}

impl Limits {
    /// The same range along or about each of these axes, one by one.
    pub fn along(axes: Axes, limit: Limit) -> Self {
        Self::default().and_along(axes, limit)
    }

    /// A rope: the origins are at most this far apart \[m\]. It wants a joint with all axes free,
    /// [`Joint::free`](crate::Joint::free).
    #[doc(alias("rope joint", "distance joint", "tether"))]
    pub fn rope(length: Real) -> Self {
        Self { distance: Some(Limit::new(0.0, length)), ..Self::default() }
    }

    /// A rod: the origins are this far apart \[m\]. It wants a joint with all axes free.
    #[doc(alias = "distance joint")]
    pub fn rod(length: Real) -> Self {
        Self { distance: Some(Limit::new(length, length)), ..Self::default() }
    }

    /// A cone: the x axes of both frames are within this angle \[rad\] of each other.
    #[doc(alias = "swing limit")]
    pub fn cone(half_angle: Real) -> Self {
        Self { cone: Some(Cone { half_angles: [half_angle; 2], gain: Gain::Rigid }), ..Self::default() }
    }

    /// The same with a range along or about each of these axes.
    #[must_use]
    pub fn and_along(mut self, axes: Axes, limit: Limit) -> Self {
        (0..6).filter(|axis| axes.has(*axis)).for_each(|axis| self.axes[axis] = Some(limit));
        self
    }

    /// Those that do something where these axes are free, and whose numbers can be reckoned with.
    pub(crate) fn within(&self, free: Axes) -> Self {
        let axes = std::array::from_fn(|axis| self.axes[axis].filter(|limit| free.has(axis) && limit.is_in_range()));
        let mut axes: [Option<Limit>; 6] = axes;
        if free.contains(Axes::ANGULAR) {
            (axes[4], axes[5]) = (None, None);
        }
        let can_move = (0..3).any(|axis| free.has(axis));
        let distance = self.distance.filter(|limit| can_move && limit.is_in_range() && limit.max >= 0.0);
        // No distance is less than zero: what comes there goes through.
        let least = |limit: Limit| if limit.min > 0.0 { limit.min } else { Real::NEG_INFINITY };
        let distance = distance.map(|limit| Limit { min: least(limit), ..limit });
        let cone = self.cone.filter(|cone| free.contains(Axes::ANGULAR) && cone.is_in_range());
        Self { axes, distance, cone }
    }
}

/// A range that a joint stays in.
///
/// ```
/// use tumble::Limit;
///
/// let bumper = Limit::new(0.0, 0.4).with_stiffness(1e4, 200.0);
/// assert!(bumper.min < bumper.max);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// \[m\] \[rad\]; no bound if it is minus infinity, but of a rotation with a greatest angle,
    /// which is then from -pi. A range of a rotation of a whole turn bounds nothing.
    pub min: Real,
    /// Not less than `min`; no bound if it is infinite, but of a rotation with a least angle.
    pub max: Real,
    /// How hard it is.
    pub gain: Gain,
}

impl Limit {
    /// A hard limit.
    pub const fn new(min: Real, max: Real) -> Self {
        Self { min, max, gain: Gain::Rigid }
    }

    /// The same as a spring and a damper beyond the range.
    #[must_use]
    pub const fn with_stiffness(self, stiffness: Real, damping: Real) -> Self {
        Self { gain: Gain::Stiffness { stiffness, damping }, ..self }
    }

    /// The same as a spring and a damper of a frequency \[Hz\] beyond the range.
    #[must_use]
    pub const fn with_frequency(self, hertz: Real, damping_ratio: Real) -> Self {
        Self { gain: Gain::Frequency { hertz, damping_ratio }, ..self }
    }

    /// Both bounds, infinite where there is none.
    pub(crate) fn bounds(&self) -> [f64; 2] {
        [self.min.into(), self.max.into()]
    }

    /// The same of an angle: both are finite, and they are less than a turn apart, or there are
    /// none.
    pub(crate) fn bounds_of_angle(&self) -> Option<[f64; 2]> {
        let [min, max] = self.bounds();
        // A bound alone needs another, as angles go round.
        let bounds = match [min.is_finite(), max.is_finite()] {
            [true, false] => [min, min.max(PI)],
            [false, true] => [max.min(-PI), max],
            _ => [min, max],
        };
        let is_reached = (min <= PI || max.is_finite()) && (max >= -PI || min.is_finite());
        Some(bounds).filter(|[min, max]| is_reached && max - min < TAU)
    }

    /// Whether its numbers can be reckoned with.
    pub(crate) fn is_in_range(&self) -> bool {
        self.min <= self.max && self.gain.is_in_range()
    }
}

/// A cone that the x axis of a joint's second frame stays in, round or elliptic.
///
/// ```
/// use tumble::{Cone, Gain};
///
/// // A shoulder goes further to the side than to the back.
/// let shoulder = Cone { half_angles: [1.2, 0.7], gain: Gain::Rigid };
/// assert!(shoulder.half_angles[0] > shoulder.half_angles[1]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// The greatest rotation about y and about z of the first frame \[rad\], more than 0 and less
    /// than pi.
    pub half_angles: [Real; 2],
    /// How hard it is.
    pub gain: Gain,
}

impl Cone {
    /// Whether its numbers can be reckoned with.
    pub(crate) fn is_in_range(&self) -> bool {
        self.half_angles.iter().all(|angle| *angle > 0.0 && *angle < PI as Real) && self.gain.is_in_range()
    }
}
