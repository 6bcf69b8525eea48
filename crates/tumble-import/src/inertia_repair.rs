//! Repair of imported principal moments that violate the triangle inequality.

use glam::DVec3;

/// What is done about moments of inertia that no body has, because one is larger than the other two
/// together.
///
/// ```
/// use tumble_import::gltf::GltfBodies;
/// use tumble_import::InertiaRepairs;
///
/// let wheel = r#"{ "mass": 1, "inertiaDiagonal": [0.1, 0.1, 0.4] }"#;
/// let text = format!(r#"{{ "asset": {{ "version": "2.0" }}, "nodes": [ {{ "name": "wheel",
///     "extensions": {{ "KHR_physics_rigid_bodies": {{ "motion": {wheel} }} }} }} ] }}"#);
/// let read = |repairs| GltfBodies::from_bytes(text.as_bytes(), None, "wheel.gltf", repairs);
/// assert!(read(InertiaRepairs::Refused)?.bodies[0].body.is_err());
/// assert!(read(InertiaRepairs::Made)?.bodies[0].body.is_ok());
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InertiaRepairs {
    /// They are an error.
    #[default]
    Refused,
    /// The nearest that a body can have are taken, and a notice says so.
    Made,
}

/// The nearest principal moments that a body can have, and how far they are away in parts of the
/// largest.
///
/// Nearest by the sum of squares, which in the same axes is nearest of all tensors too: the
/// projection on the plane on which the largest is the sum of the others, a plate. `None` where
/// that is not what is wrong with them.
pub(crate) fn nearest_moments(moments: DVec3) -> Option<(DVec3, f64)> {
    let excess = 2.0 * moments.max_element() - moments.element_sum();
    if !(moments.is_finite() && moments.min_element() > 0.0 && excess > 0.0) {
        return None;
    }
    let step = |moment: f64| if moment == moments.max_element() { -excess / 3.0 } else { excess / 3.0 };
    let nearest = moments + DVec3::from_array(moments.to_array().map(step));
    Some((nearest, (nearest - moments).length() / moments.max_element()))
}

/// What is reported about a repair.
pub(crate) fn repair_notice(from: DVec3, to: DVec3, away: f64) -> String {
    let [a, b, c] = from.to_array();
    let [x, y, z] = to.to_array();
    format!(
        "has moments of inertia {a}, {b}, {c} that no body has, repaired to the nearest possible {x:.6}, {y:.6}, {z:.6}, {:.1} % of the largest away",
        100.0 * away
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn of_the_published_wheel() {
        let (nearest, away) = nearest_moments(DVec3::new(0.1, 0.1, 0.4)).unwrap();
        // A third of the excess of 0.2 each; the square root of 3 times that is the distance.
        assert!((nearest - DVec3::new(1.0, 1.0, 2.0) / 6.0).length() < 1e-15);
        assert!((away - 0.2 / 3.0 * 3.0_f64.sqrt() / 0.4).abs() < 1e-15);
        assert_eq!(nearest_moments(DVec3::new(1.0, 2.0, 3.0)), None);
        assert_eq!(nearest_moments(DVec3::new(-1.0, 2.0, 9.0)), None);
        assert_eq!(nearest_moments(DVec3::new(1.0, f64::INFINITY, 9.0)), None);
    }

    proptest! {
        /// It is possible, and no possible one is nearer: not any plate, nor any other.
        #[test]
        fn nothing_possible_is_nearer(
            small in prop::array::uniform2(1e-3_f64..1.0), more in 1e-6_f64..10.0, place in 0_usize..3,
            other in prop::array::uniform3(1e-3_f64..10.0),
        ) {
            let mut moments = [small[0], small[1], small[0] + small[1] + more];
            moments.rotate_right(place);
            let moments = DVec3::from_array(moments);
            let (nearest, away) = nearest_moments(moments).unwrap();
            // A few roundings of the largest.
            let rounding = 1e-14 * moments.max_element();
            prop_assert!(2.0 * nearest.max_element() <= nearest.element_sum() + rounding);
            prop_assert!(nearest.min_element() > 0.0);
            prop_assert!(((nearest - moments).length() - away * moments.max_element()).abs() < rounding);
            let other = DVec3::from_array(other);
            if 2.0 * other.max_element() <= other.element_sum() {
                prop_assert!((other - moments).length() >= (nearest - moments).length() - rounding);
            }
        }
    }
}
