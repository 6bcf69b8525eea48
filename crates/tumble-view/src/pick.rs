//! Which body is under the mouse.

use tumble::glam::{DQuat, DVec3};

use crate::camera::Ray;

/// A box around a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// Middle, in the world \[m\].
    pub(crate) center: DVec3,
    /// Turns the box's axes into the world.
    pub(crate) rotation: DQuat,
    /// \[m\]
    pub(crate) half_extents: DVec3,
}

impl Bounds {
    /// How far along a ray the box begins \[m\]; zero for a ray that begins inside. `None` where
    /// the ray misses it, or the box is nowhere.
    ///
    /// The ray is inside of the box between the last of the entries through its three pairs of
    /// faces and the first of the exits (T. Kay, J. Kajiya, Ray Tracing Complex Scenes, SIGGRAPH
    /// 1986).
    pub(crate) fn hit(&self, ray: &Ray) -> Option<f64> {
        // Comparisons with NaN would let it pass between all faces.
        if !self.center.is_finite() || !self.rotation.is_finite() {
            return None;
        }
        let turned = self.rotation.inverse();
        let origin = turned * (ray.origin - self.center);
        let direction = turned * ray.direction;
        let (mut entry, mut exit) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (from, along, half) = (origin[axis], direction[axis], self.half_extents[axis]);
            if along == 0.0 {
                if from.abs() > half {
                    return None;
                }
                continue;
            }
            let [a, b] = [(-half - from) / along, (half - from) / along];
            entry = entry.max(a.min(b));
            exit = exit.min(a.max(b));
        }
        (entry <= exit).then_some(entry)
    }
}

/// How far along a ray a body is met \[m\], if it is; `None` where only its box is known.
pub(crate) type ExactHit = Option<Option<f64>>;

/// The index of the body that a ray meets first, and how far along \[m\]; those whose box is missed
/// are not met.
pub(crate) fn first_hit(
    ray: &Ray,
    bounds: impl Iterator<Item = Bounds>,
    exact: impl Fn(usize) -> ExactHit,
) -> Option<(usize, f64)> {
    let hits = bounds.enumerate().filter_map(|(index, bounds)| {
        let of_box = bounds.hit(ray)?;
        Some((exact(index).unwrap_or(Some(of_box))?, index))
    });
    hits.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(distance, index)| (index, distance))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(center: DVec3) -> Bounds {
        Bounds { center, rotation: DQuat::IDENTITY, half_extents: DVec3::new(1.0, 2.0, 3.0) }
    }

    fn along_x(y: f64) -> Ray {
        Ray { origin: DVec3::new(-10.0, y, 0.0), direction: DVec3::X }
    }

    #[test]
    fn a_ray_meets_the_face_that_is_nearest() {
        assert_eq!(block(DVec3::ZERO).hit(&along_x(1.9)), Some(9.0));
        assert_eq!(block(DVec3::ZERO).hit(&along_x(2.1)), None);
        // Behind the origin of the ray.
        assert_eq!(block(DVec3::X * -20.0).hit(&along_x(0.0)), None);
        assert_eq!(block(DVec3::X * -10.0).hit(&along_x(0.0)), Some(0.0));
    }

    #[test]
    fn boxes_turn() {
        let turned = Bounds { rotation: DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2), ..block(DVec3::ZERO) };
        let entry = turned.hit(&along_x(0.9)).unwrap();
        // What was 2 along y is along x now.
        assert!((entry - 8.0).abs() < 1e-12, "{entry}");
        assert_eq!(turned.hit(&along_x(1.1)), None);
    }

    #[test]
    fn a_body_that_is_nowhere_is_not_hit() {
        let lost = [
            block(DVec3::NAN),
            block(DVec3::Z * f64::INFINITY),
            Bounds { rotation: DQuat::from_xyzw(f64::NAN, 0.0, 0.0, 1.0), ..block(DVec3::ZERO) },
        ];
        assert!(lost.iter().all(|bounds| bounds.hit(&along_x(0.0)).is_none()));
        // Nor is it in the way of one that is there.
        let all = lost.into_iter().chain([block(DVec3::ZERO)]);
        assert_eq!(first_hit(&along_x(0.0), all, |_| None), Some((3, 9.0)));
    }

    #[test]
    fn the_first_of_several_is_picked() {
        let row = [5.0, -3.0, 1.0].map(|x| block(DVec3::X * x));
        assert_eq!(first_hit(&along_x(0.0), row.into_iter(), |_| None), Some((1, 6.0)));
        assert_eq!(first_hit(&along_x(9.0), row.into_iter(), |_| None), None);
        // Where shapes are known they count: the ray passes the second, and the first is behind the
        // third.
        let exact = |index| [Some(Some(30.0)), Some(None), None][index];
        assert_eq!(first_hit(&along_x(0.0), row.into_iter(), exact), Some((2, 10.0)));
    }
}
