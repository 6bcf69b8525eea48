//! Rows along free axes of a joint: where it stands along them.

use tumble_math::lane::{Quat, Vec3};

use crate::joints::axes::Axes;
use crate::joints::joint_options::JointOptions;
use crate::solver::mechanism::joint_rows::{Stance, length};
use crate::solver::mechanism::rotations::Rotations;

/// Along which a row acts that is not locked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FreeAxis {
    /// Along an axis of the first frame.
    Translation(usize),
    /// About an axis of the joint.
    Rotation(usize),
    /// About the x axis, of a joint with three free rotations.
    Twist,
    /// Along the line between the origins, as far as it is free.
    Distance,
    /// Of the second frame's x axis out of a cone with these tangents of half the half angles.
    Cone([f64; 2]),
}

/// A direction in which both bodies are pushed, and where the joint stands along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction {
    /// Not a number where it has none: a twist of what is bent back by half a turn.
    pub(crate) value: f64,
    pub(crate) linear: Vec3<f64>,
    pub(crate) angular: Vec3<f64>,
}

/// One more than the cosine of how far an axis is bent back, below which there is no twist about
/// it: near half a turn a small motion is a large twist.
const MIN_FALL: f64 = 0.2;
/// The same below which there is no way out of a cone.
const MIN_FALL_IN_CONE: f64 = 1e-4;
/// Steps to the nearest point of an ellipse, at most; two or three are usual.
const MAX_STEPS_TO_NEAREST: u32 = 40;

/// The rows that a joint with these options has along its free axes, in order: by kind and axis.
pub(crate) fn free_axes(options: &JointOptions, free: Axes) -> impl Iterator<Item = FreeAxis> + '_ {
    let is_ball = free.contains(Axes::ANGULAR);
    let has_row = move |axis: &usize| {
        let is_limited = options.limits.axes[*axis].is_some() && !(is_ball && *axis >= 3);
        let is_driven = options.drives.iter().any(|drive| drive.axes.has(*axis));
        free.has(*axis) && (is_limited || is_driven || options.friction.max[*axis] > 0.0)
    };
    let translations = (0..3).filter(has_row).map(FreeAxis::Translation);
    let rotations = (3..6).filter(has_row).map(|axis| FreeAxis::Rotation(axis - 3));
    let twist = options.limits.axes[3].filter(|_| is_ball).map(|_| FreeAxis::Twist);
    let distance = options.limits.distance.map(|_| FreeAxis::Distance);
    let cone =
        options.limits.cone.map(|cone| FreeAxis::Cone(cone.half_angles.map(|angle| tangent_of_half(angle.into()))));
    translations.chain(rotations).chain(twist).chain(distance).chain(cone)
}

/// A bit for each row that there is.
pub(crate) fn free_axis_bits(options: Option<&JointOptions>, free: Axes) -> u16 {
    let axes = options.into_iter().flat_map(|options| free_axes(options, free));
    axes.fold(0, |bits, axis| {
        bits | 1
            << match axis {
                FreeAxis::Translation(axis) => axis,
                FreeAxis::Rotation(axis) => 3 + axis,
                FreeAxis::Twist => 6,
                FreeAxis::Distance => 7,
                FreeAxis::Cone(_) => 8,
            }
    })
}

impl FreeAxis {
    /// Whether it is a length.
    pub(crate) fn is_linear(self) -> bool {
        matches!(self, Self::Translation(_) | Self::Distance)
    }

    /// Whether it is a rotation of which the value is not an angle.
    pub(crate) fn is_cone(self) -> bool {
        matches!(self, Self::Cone(_))
    }

    /// Whether its values are those of the limits alone.
    pub(crate) fn is_of_limit(self) -> bool {
        matches!(self, Self::Twist | Self::Distance | Self::Cone(_))
    }

    /// Where a joint stands; of three free rotations against a rotation to go to, if there is one.
    pub(crate) fn direction(self, stance: &Stance, free: Axes, reference: Option<Quat<f64>>) -> Direction {
        let zero = Vec3::zero();
        let along = |value, linear| Direction { value, linear, angular: zero };
        let about = |value, angular| Direction { value, linear: zero, angular };
        let [a, b] = &stance.axes;
        match self {
            Self::Translation(axis) => along(stance.gap.dot(a[axis]), a[axis]),
            Self::Rotation(axis) => {
                let q = relative_rotation(stance);
                match Rotations::of(free) {
                    Rotations::AboutBoth(i, j) if axis == i => about(first_angle(q, i, j), a[i]),
                    Rotations::AboutBoth(i, j) => about(second_angle(q, i, j), b[j]),
                    Rotations::Free => match reference {
                        Some(reference) => {
                            let (value, [x, y, z]) = along_rotation_vector(q * reference.conjugate(), axis);
                            about(value, a[0] * x + a[1] * y + a[2] * z)
                        }
                        None => about(0.0, a[axis]),
                    },
                    Rotations::About(_) | Rotations::Locked => about(twist(q, axis), a[axis]),
                }
            }
            Self::Twist => {
                let fall = 1.0 + a[0].dot(b[0]);
                if fall < MIN_FALL {
                    return about(f64::NAN, a[0]);
                }
                about(twist(relative_rotation(stance), 0), (a[0] + b[0]) * (1.0 / fall))
            }
            Self::Distance => {
                let mut apart = zero;
                for axis in (0..3).filter(|axis| free.has(*axis)) {
                    apart = apart + a[axis] * a[axis].dot(stance.gap);
                }
                let distance = length(apart);
                let first_free = (0..3).find(|axis| free.has(*axis)).unwrap_or(0);
                along(distance, if distance > 0.0 { apart * (1.0 / distance) } else { a[first_free] })
            }
            Self::Cone(tangents) => {
                let (value, angular) = out_of_cone(a, b[0], tangents);
                about(value, angular)
            }
        }
    }
}

/// A component of the rotation vector, and its gradient: about what a rotation changes it.
///
/// Springs along these have a potential; along the axes themselves they would not.
fn along_rotation_vector(q: Quat<f64>, axis: usize) -> (f64, [f64; 3]) {
    let vector = tumble_math::to_scaled_axis(q.into());
    let angle = vector.length();
    let unit = glam::DVec3::AXES[axis];
    let sine = glam::DVec3::new(q.x, q.y, q.z).length();
    // (1 - x cot x) / (2 x)^2 at half the angle; 1/12 at none.
    let factor = if angle < 1e-4 { 1.0 / 12.0 } else { (1.0 - 0.5 * angle * q.w.abs() / sine) / (angle * angle) };
    let bent = vector.cross(unit);
    (vector[axis], (unit + bent * 0.5 + vector.cross(bent) * factor).to_array())
}

/// Of the second frame against the first; the nearer of both quaternions.
pub(crate) fn relative_rotation(stance: &Stance) -> Quat<f64> {
    the_short_way(stance.orientations[0].conjugate() * stance.orientations[1])
}

/// The same rotation by no more than half a turn.
pub(super) fn the_short_way(q: Quat<f64>) -> Quat<f64> {
    if q.w < 0.0 { Quat { x: -q.x, y: -q.y, z: -q.z, w: -q.w } } else { q }
}

/// The angle of a rotation about an axis, from -pi to pi.
pub(crate) fn twist(q: Quat<f64>, axis: usize) -> f64 {
    twice_angle_of([q.x, q.y, q.z][axis], q.w)
}

/// Of a rotation about axis `i` and then `j` of the body, the first angle.
pub(crate) fn first_angle(q: Quat<f64>, i: usize, j: usize) -> f64 {
    let (v, third, sign) = parts(q, i, j);
    let [here, there] = [v[i] * v[i] + q.w * q.w, v[j] * v[j] + third * third];
    if here >= there { twice_angle_of(v[i], q.w) } else { twice_angle_of(sign * third, v[j]) }
}

/// Of a rotation about axis `i` and then `j` of the body, the second angle.
pub(crate) fn second_angle(q: Quat<f64>, i: usize, j: usize) -> f64 {
    let (v, third, sign) = parts(q, i, j);
    let [here, there] = [v[j] * v[j] + q.w * q.w, v[i] * v[i] + third * third];
    if here >= there { twice_angle_of(v[j], q.w) } else { twice_angle_of(sign * third, v[i]) }
}

/// `2 atan2(y, x)`, from -pi to pi.
fn twice_angle_of(y: f64, x: f64) -> f64 {
    tumble_math::to_scaled_axis(glam::DQuat::from_xyzw(y, 0.0, 0.0, x)).x
}

/// The vector part, that about the third axis, and the sign of `i x j` along it.
fn parts(q: Quat<f64>, i: usize, j: usize) -> ([f64; 3], f64, f64) {
    let v = [q.x, q.y, q.z];
    (v, v[3 - i - j], if (i + 1) % 3 == j { 1.0 } else { -1.0 })
}

/// An angle brought to -pi to pi.
pub(crate) fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::TAU;
    // Most need no turn, and rounding is a call of a function.
    if angle.abs() < 3.0 { angle } else { angle - TAU * (angle / TAU).round() }
}

/// How far an axis is out of an elliptic cone about the first of three axes \[rad\], and about what
/// it turns further out. The tangents are those of half the half angles about the second and third.
///
/// Projected from the opposite pole the cone is an ellipse, and angles are kept.
fn out_of_cone(a: &[Vec3<f64>; 3], b: Vec3<f64>, [about_y, about_z]: [f64; 2]) -> (f64, Vec3<f64>) {
    let fall = 1.0 + a[0].dot(b);
    if fall < MIN_FALL_IN_CONE {
        return (f64::NAN, a[1]);
    }
    let t = [a[1].dot(b) / fall, a[2].dot(b) / fall];
    // A rotation about y moves x along z.
    let (distance, out) = out_of_ellipse(t, [about_z, about_y]);
    let mut angular = Vec3::zero();
    for axis in 0..2 {
        angular = angular + (b.cross(a[1 + axis]) - b.cross(a[0]) * t[axis]) * out[axis];
    }
    (distance * fall, angular)
}

/// How far a point is out of an ellipse with these half axes, negative inside, and the way out.
///
/// D. Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid", 2013.
fn out_of_ellipse(point: [f64; 2], half_axes: [f64; 2]) -> (f64, [f64; 2]) {
    let long = usize::from(half_axes[1] > half_axes[0]);
    let [major, minor] = [half_axes[long], half_axes[1 - long]];
    let [x, y] = [point[long].abs(), point[1 - long].abs()];
    let scaled = [x / major, y / minor];
    let is_out = scaled[0] * scaled[0] + scaled[1] * scaled[1] > 1.0;
    let nearest = if y > 1e-9 * minor {
        let ratio = (major / minor) * (major / minor);
        let s = parameter_of_nearest(ratio, scaled);
        [ratio * x / (s + ratio), y / (s + 1.0)]
    } else if major * x < major * major - minor * minor {
        let along = x * major / (major * major - minor * minor);
        [major * along, minor * (1.0 - along * along).max(0.0).sqrt()]
    } else {
        [major, 0.0]
    };
    let [dx, dy] = [x - nearest[0], y - nearest[1]];
    let distance = (dx * dx + dy * dy).sqrt();
    let normal = [nearest[0] / (major * major), nearest[1] / (minor * minor)];
    let size = (normal[0] * normal[0] + normal[1] * normal[1]).sqrt();
    let mut out = [0.0; 2];
    out[long] = (normal[0] / size).copysign(point[long]);
    out[1 - long] = (normal[1] / size).copysign(point[1 - long]);
    (if is_out { distance } else { -distance }, out)
}

/// The root of `(ratio z_0 / (s + ratio))^2 + (z_1 / (s + 1))^2 = 1`, by Newton's method: it falls
/// and is convex, so steps from below end at the root without going past it.
fn parameter_of_nearest(ratio: f64, z: [f64; 2]) -> f64 {
    let n = ratio * z[0];
    // At each of these one term is one.
    let mut s = (z[1] - 1.0).max(n - ratio);
    for _ in 0..MAX_STEPS_TO_NEAREST {
        let [a, b] = [n / (s + ratio), z[1] / (s + 1.0)];
        let step = 0.5 * (a * a + b * b - 1.0) / (a * a / (s + ratio) + b * b / (s + 1.0));
        if s + step > s {
            s += step;
        } else {
            break;
        }
    }
    s
}

/// `tan(angle / 2)` of an angle between 0 and pi.
fn tangent_of_half(angle: f64) -> f64 {
    let q = tumble_math::rotate_exactly(Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }, Vec3::new(angle, 0.0, 0.0), 1.0);
    q.x / q.w
}
