//! The sun, and the part of the world of which its shadow map is made.

use tumble::glam::{DMat4, DVec3, DVec4};

use crate::camera::{Up, View};

/// Towards the sun from the first picture: up, towards the viewer, and to the right. It stands
/// behind the viewer's left shoulder, and stays there in the world when the camera turns.
const FROM_START: [f64; 3] = [0.74, 0.28, -0.61];
/// Width and height of the shadow map \[texels\].
pub(crate) const MAP_SIZE: u32 = 2048;
/// The map reaches this far from the camera's target at most, in units of the view: a little more
/// than the picture is wide. A larger one would be coarser.
const MAX_REACH: f64 = 1.2;
/// Room at the edges of the map for soft edges of shadows.
const MARGIN: f64 = 1.04;
/// The least and the greatest ratio of the depth of the map to its width.
const DEPTHS: [f64; 2] = [2.0, 6.0];

/// The direction of the light, which is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sun {
    /// Unit vectors: to where the light comes from, and two at right angles to it and each other.
    pub(crate) towards: DVec3,
    pub(crate) across: DVec3,
    pub(crate) above: DVec3,
}

impl Sun {
    /// For a camera that begins with a yaw \[rad\].
    pub(crate) fn new(up: Up, yaw: f64) -> Self {
        let [first, second] = up.horizon();
        let [rising, near, aside] = FROM_START;
        let viewer = first * yaw.cos() + second * yaw.sin();
        let right = second * yaw.cos() - first * yaw.sin();
        let towards = (up.axis() * rising + viewer * near + right * aside).normalize();
        let across = up.axis().cross(towards).normalize();
        Self { towards, across, above: towards.cross(across) }
    }
}

/// What the shadow map shows: a box along the sun's light around the bodies that cast shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShadowFrame {
    pub(crate) sun: Sun,
    /// From units of the view about its target to clip coordinates of the map.
    pub(crate) matrix: DMat4,
    /// Half the depth of the box in parts of half its width.
    pub(crate) depth: f64,
    /// A unit of the view in parts of the whole depth of the box.
    pub(crate) unit: f64,
}

impl ShadowFrame {
    /// Every point is beside the map, so that nothing is shaded.
    pub(crate) fn nowhere(sun: Sun) -> Self {
        let matrix = DMat4::from_cols(DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::new(2.0, 0.0, 0.0, 1.0));
        Self { sun, matrix, depth: 1.0, unit: 0.0 }
    }

    /// For balls around bodies, by their middle and radius \[m\].
    pub(crate) fn new(sun: Sun, view: &View, balls: impl Iterator<Item = (DVec3, f64)>) -> Self {
        let axes = [sun.across, sun.above, -sun.towards];
        let along = |point: DVec3| DVec3::from_array(axes.map(|axis| axis.dot(point)));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (middle, radius) in balls.filter(|(middle, radius)| middle.is_finite() && radius.is_finite()) {
            low = low.min(along(middle) - radius);
            high = high.max(along(middle) + radius);
        }
        // Around the target only, if the bodies are farther apart than what is seen.
        let (target, seen) = (along(view.target), DVec3::new(MAX_REACH, MAX_REACH, f64::INFINITY) * view.unit);
        let (low, high) = (low.clamp(target - seen, target + seen), high.clamp(target - seen, target + seen));
        let (middle, extents) = (0.5 * (low + high), 0.5 * (high - low));
        if !extents.is_finite() {
            return Self::nowhere(sun);
        }
        // Steps in size and place leave the shadows' edges where they are from picture to picture.
        let wide = (MARGIN * extents.x.max(extents.y)).max(1e-3 * view.unit);
        let half = 2.0_f64.powf((4.0 * wide.log2()).ceil() / 4.0);
        let texel = 2.0 * half / f64::from(MAP_SIZE);
        let depth = (extents.z / half).clamp(DEPTHS[0], DEPTHS[1]);
        let off = target - (middle / texel).round() * texel;
        let scale = DVec3::new(1.0, 1.0, 1.0 / depth) / half;
        let row = |axis: usize| (axes[axis] * view.unit).extend(off[axis]) * scale[axis];
        let matrix = DMat4::from_cols(row(0), row(1), row(2), DVec4::W).transpose();
        Self { sun, matrix, depth, unit: 0.5 * view.unit * scale.z }
    }
}

#[cfg(test)]
mod tests {
    use tumble::glam::DVec2;

    use super::*;
    use crate::camera::Camera;

    fn view(target: DVec3, distance: f64) -> View {
        Camera { up: Up::Y, yaw: 0.7, pitch: 0.4, distance, target }.view(DVec2::new(1280.0, 720.0), 10.0)
    }

    fn on_map(frame: &ShadowFrame, view: &View, point: DVec3) -> DVec3 {
        frame.matrix.project_point3(view.relative(point))
    }

    #[test]
    fn the_sun_stands_behind_the_left_shoulder() {
        for up in [Up::X, Up::Y, Up::Z] {
            for yaw in [0.0, 0.7, 4.0] {
                let sun = Sun::new(up, yaw);
                let camera = Camera { up, yaw, pitch: 0.3, distance: 1.0, target: DVec3::ZERO };
                let view = camera.view(DVec2::ONE, 1.0);
                let seen = [view.towards, view.above, -view.right].map(|axis| axis.dot(sun.towards));
                assert!(seen.iter().all(|part| *part > 0.3), "{up:?} {yaw} {seen:?}");
                assert!((sun.across.cross(sun.above) - sun.towards).length() < 1e-12);
            }
        }
    }

    #[test]
    fn what_is_seen_is_on_the_map_and_what_shades_is_before_what_is_shaded() {
        let target = DVec3::new(30.0, -2.0, 7.0);
        let sun = Sun::new(Up::Y, 0.7);
        // From where all is seen, and from nearby.
        for (distance, reach) in [(20.0, 5.0), (2.0, 5.0)] {
            let view = view(target, distance);
            let frame = ShadowFrame::new(sun, &view, [(target, reach)].into_iter());
            for direction in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
                let point = target + direction * reach.min(distance);
                let above = point + 0.1 * reach * sun.towards;
                let [here, there] = [point, above].map(|at| on_map(&frame, &view, at));
                assert!(here.abs().max_element() < 1.0, "{here}");
                assert!((here - there).truncate().length() < 1e-12 && there.z < here.z - 1e-3, "{here} {there}");
            }
        }
    }

    #[test]
    fn the_map_is_no_larger_than_needed() {
        let (sun, view) = (Sun::new(Up::Y, 0.7), view(DVec3::ZERO, 20.0));
        let width = |balls: &[(DVec3, f64)]| {
            let frame = ShadowFrame::new(sun, &view, balls.iter().copied());
            2.0 * view.unit / frame.matrix.transform_vector3(sun.across).x
        };
        let (one, far) = ((DVec3::new(9.0, 1.0, -3.0), 0.5), (DVec3::X * 1e6, 0.5));
        let steps = 1.0..2.0_f64.powf(0.25) + 1e-9;
        assert!(steps.contains(&(width(&[one]) / (MARGIN * 1.0))), "{}", width(&[one]));
        let seen = 2.0 * MAX_REACH * view.unit;
        assert!((0.5..1.3).contains(&(width(&[one, far, (DVec3::X * -1e6, 1.0)]) / seen)));
        assert_eq!(width(&[one, (DVec3::NAN, 1.0)]), width(&[one]), "what is nowhere casts no shadow");
    }

    /// Or edges of shadows would flicker where the camera follows something.
    #[test]
    fn texels_stay_where_they_are_when_the_camera_moves() {
        let sun = Sun::new(Up::Y, 0.7);
        let texel_of = |target: DVec3, distance: f64| {
            let view = view(target, distance);
            let frame = ShadowFrame::new(sun, &view, [(target, 4.9)].into_iter());
            let at = on_map(&frame, &view, DVec3::new(1.0, 2.0, 3.0));
            0.5 * f64::from(MAP_SIZE) * at.truncate()
        };
        let before = texel_of(DVec3::ZERO, 20.0);
        for (target, distance) in [(DVec3::new(0.123, 0.456, -0.3), 20.0), (DVec3::new(1.2, -0.7, 0.1), 23.0)] {
            let by = texel_of(target, distance) - before;
            assert!((by - by.round()).length() < 1e-6 && by.length() > 1.0, "{by}");
        }
    }

    #[test]
    fn there_is_a_frame_without_bodies_too() {
        let (sun, view) = (Sun::new(Up::Y, 0.0), view(DVec3::ZERO, 20.0));
        let balls: [&[(DVec3, f64)]; 4] =
            [&[], &[(DVec3::NAN, 1.0)], &[(DVec3::ZERO, 0.0)], &[(DVec3::splat(1e300), 1.0)]];
        for balls in balls {
            let frame = ShadowFrame::new(sun, &view, balls.iter().copied());
            assert!(frame.matrix.is_finite(), "{balls:?}");
        }
    }
}
