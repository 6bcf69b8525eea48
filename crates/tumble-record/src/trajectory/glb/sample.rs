//! Animation samples: the translation and rotation of a body's frame in single precision.

use glam::{DQuat, DVec3};
use tumble::Pose;
use tumble::math::Real;

/// Where the frame of a body is in one frame of the animation, as glTF has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    /// The origin of the body's frame, which is where its mesh is drawn \[m\].
    pub(crate) translation: [f32; 3],
    /// Unit quaternion `x, y, z, w`.
    pub(crate) rotation: [f32; 4],
}

impl Sample {
    /// Of a body whose centre of mass lies at `center` in its frame \[m\]; nothing of a pose that
    /// is not finite.
    ///
    /// Of the two quaternions of a rotation it is the one nearer to that of the sample before, for
    /// viewers interpolate between the two as they are.
    pub(crate) fn of(pose: &Pose, center: DVec3, before: Option<&Self>) -> Option<Self> {
        let orientation = DQuat::from_array(pose.orientation.to_array().map(double));
        let position = DVec3::from_array(pose.position.to_array().map(double));
        let unit = orientation * orientation.length_recip();
        let origin = position - unit * center;
        if !(origin.is_finite() && unit.is_finite()) {
            return None;
        }
        let rotation = unit.to_array().map(single);
        let along = before.map_or(1.0, |before| dot(before.rotation, rotation));
        let rotation = if along < 0.0 { rotation.map(|part| -part) } else { rotation };
        Some(Self { translation: origin.to_array().map(single), rotation })
    }
}

#[allow(clippy::useless_conversion, reason = "it is f64 already in one of the two builds")]
pub(crate) fn double(number: Real) -> f64 {
    f64::from(number)
}

/// In single precision; what is beyond it at its end.
pub(crate) fn single(number: f64) -> f32 {
    (number as f32).clamp(f32::MIN, f32::MAX)
}

fn dot(a: [f32; 4], b: [f32; 4]) -> f32 {
    a.into_iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use tumble::math::{Quat, Real, Vec3};

    use super::*;

    #[test]
    fn the_origin_is_off_the_centre_by_the_turned_offset() {
        let pose = Pose { position: Vec3::new(1.0, 2.0, 3.0), orientation: Quat::from_xyzw(0.0, 0.0, 0.6, 0.8) };
        let sample = Sample::of(&pose, DVec3::X, None).unwrap();
        // The turn about z by 2 atan(3/4) takes x to (0.28, 0.96, 0); single precision rounds at
        // 6e-8 of 2.
        for (got, expected) in sample.translation.into_iter().zip([0.72, 1.04, 3.0]) {
            assert!((got - expected).abs() < 3e-7, "{got} {expected}");
        }
    }

    #[test]
    fn rotations_take_the_shortest_way_and_are_of_unit_length() {
        let pose = |orientation| Pose { orientation, position: Vec3::ZERO };
        let first = Sample::of(&pose(Quat::from_xyzw(0.0, 0.0, 0.6, 0.8)), DVec3::ZERO, None).unwrap();
        let other = Sample::of(&pose(Quat::from_xyzw(0.0, 0.0, -1.2, -1.6)), DVec3::ZERO, Some(&first)).unwrap();
        assert_eq!(first, other);
        assert!((dot(other.rotation, other.rotation) - 1.0).abs() < 2e-7);
    }

    #[test]
    fn what_is_nowhere_has_no_sample_and_what_is_far_has_one() {
        let nan = Pose { position: Vec3::new(0.0, Real::NAN, 0.0), ..Pose::default() };
        assert_eq!(Sample::of(&nan, DVec3::ZERO, None), None);
        let none = Pose { orientation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Pose::default() };
        assert_eq!(Sample::of(&none, DVec3::ZERO, None), None);
        assert_eq!([1e300, -1e300].map(single), [f32::MAX, f32::MIN]);
    }
}
