//! A camera that turns about what it looks at, and where things are in its picture.

use tumble::glam::{DMat4, DVec2, DVec3, DVec4};

/// From the lower to the upper edge of the picture \[rad\].
const FIELD_OF_VIEW: f64 = 0.62;
/// Clearance of the poles, where the picture would turn over \[rad\].
const POLE: f64 = 0.02;
/// How near and how far the camera may be, in parts of the distance from which all is seen.
pub(crate) const DISTANCES: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
/// The nearest that is drawn, as a part of the camera's distance.
const NEAR: f64 = 0.02;
/// The farthest that is drawn is at least and at most this many distances away; beyond, 24 bits of
/// depth no longer tell things apart.
const FAR: [f64; 2] = [40.0, 4000.0];

/// The axis that points up in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Up {
    X,
    Y,
    Z,
}

impl Up {
    pub(crate) fn axis(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }

    /// The axes of the horizon, so that up, first and second turn the same way round as x, y and z.
    pub(crate) fn horizon(self) -> [DVec3; 2] {
        match self {
            Self::X => [DVec3::Y, DVec3::Z],
            Self::Y => [DVec3::Z, DVec3::X],
            Self::Z => [DVec3::X, DVec3::Y],
        }
    }

    /// The axis along which a vector is longest.
    pub(crate) fn along(vector: DVec3) -> Option<Self> {
        let longest = vector.abs().max_element();
        if longest <= 0.0 || !longest.is_finite() {
            return None;
        }
        let size = vector.abs();
        Some(match () {
            () if size.y >= longest => Self::Y,
            () if size.z >= longest => Self::Z,
            () => Self::X,
        })
    }
}

/// Where the camera stands. Angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Camera {
    pub(crate) up: Up,
    /// About the axis that points up, from the first axis of the horizon.
    pub(crate) yaw: f64,
    /// Above the horizon.
    pub(crate) pitch: f64,
    /// From the target \[m\].
    pub(crate) distance: f64,
    /// What is in the middle of the picture \[m\].
    pub(crate) target: DVec3,
}

impl Camera {
    /// The distance from which a ball of this radius just fits into a picture of this size.
    pub(crate) fn distance_for(radius: f64, size: DVec2) -> f64 {
        let narrow = (size.x / size.y).clamp(0.05, 1.0);
        radius / ((0.5 * FIELD_OF_VIEW).sin() * narrow)
    }

    pub(crate) fn turn(&mut self, yaw: f64, pitch: f64) {
        let limit = std::f64::consts::FRAC_PI_2 - POLE;
        self.yaw = (self.yaw + yaw).rem_euclid(std::f64::consts::TAU);
        self.pitch = (self.pitch + pitch).clamp(-limit, limit);
    }

    /// Where the camera is seen from the target.
    fn towards(&self) -> DVec3 {
        let [first, second] = self.up.horizon();
        self.up.axis() * self.pitch.sin() + (first * self.yaw.cos() + second * self.yaw.sin()) * self.pitch.cos()
    }

    /// What the camera sees in a picture of this size in points; things may be up to `extent` from
    /// the target \[m\].
    pub(crate) fn view(&self, size: DVec2, extent: f64) -> View {
        let [first, second] = self.up.horizon();
        let towards = self.towards();
        let right = second * self.yaw.cos() - first * self.yaw.sin();
        let above = towards.cross(right);
        let focal = 1.0 / (0.5 * FIELD_OF_VIEW).tan();
        let wide = focal * size.y / size.x;
        let far = (1.0 + 2.0 * extent / self.distance).clamp(FAR[0], FAR[1]);
        let depth = (far + NEAR) / (NEAR - far);
        let shift = 2.0 * far * NEAR / (NEAR - far);
        // Columns, by rows of what they are made of: clip = (wide x, focal y, depth (z - 1) +
        // shift, 1 - z), in units of the distance.
        let matrix = DMat4::from_cols(
            DVec4::new(wide * right.x, focal * above.x, depth * towards.x, -towards.x),
            DVec4::new(wide * right.y, focal * above.y, depth * towards.y, -towards.y),
            DVec4::new(wide * right.z, focal * above.z, depth * towards.z, -towards.z),
            DVec4::new(0.0, 0.0, shift - depth, 1.0),
        );
        View { target: self.target, unit: self.distance, matrix, right, above, towards, size }
    }
}

/// What a camera sees. The graphics card gets everything relative to the target and in units of the
/// distance, so that single precision does for molecules and planets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    pub(crate) target: DVec3,
    /// Metres to a unit.
    pub(crate) unit: f64,
    /// From units about the target to clip coordinates.
    pub(crate) matrix: DMat4,
    pub(crate) right: DVec3,
    pub(crate) above: DVec3,
    pub(crate) towards: DVec3,
    /// Of the picture, in points.
    pub(crate) size: DVec2,
}

/// A half-line; its direction has unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl View {
    /// In units about the target.
    pub(crate) fn relative(&self, point: DVec3) -> DVec3 {
        (point - self.target) / self.unit
    }

    /// Where a point of the world is in the picture, from its upper left corner, in points; `None`
    /// for what is behind the camera.
    pub(crate) fn project(&self, point: DVec3) -> Option<DVec2> {
        let clip = self.matrix * self.relative(point).extend(1.0);
        if clip.w.is_nan() || clip.w < NEAR {
            return None;
        }
        Some(DVec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w) * self.size)
    }

    /// Metres to a point of the picture, where the given point of the world is.
    pub(crate) fn metres_per_point(&self, point: DVec3) -> f64 {
        let away = (1.0 - self.relative(point).dot(self.towards)).max(NEAR);
        2.0 * away * self.unit * (0.5 * FIELD_OF_VIEW).tan() / self.size.y
    }

    /// What is seen at a point of the picture.
    pub(crate) fn ray(&self, at: DVec2) -> Ray {
        let tangent = (0.5 * FIELD_OF_VIEW).tan();
        let across = (2.0 * at / self.size - 1.0) * tangent;
        let direction = self.right * across.x * self.size.x / self.size.y - self.above * across.y - self.towards;
        Ray { origin: self.target + self.towards * self.unit, direction: direction.normalize() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

    fn camera(up: Up) -> Camera {
        Camera { up, yaw: 0.7, pitch: 0.4, distance: 5.0, target: DVec3::new(10.0, -20.0, 30.0) }
    }

    #[test]
    fn the_target_is_in_the_middle_and_up_is_up() {
        for up in [Up::X, Up::Y, Up::Z] {
            let camera = camera(up);
            let view = camera.view(SIZE, 10.0);
            let middle = view.project(camera.target).unwrap();
            assert!((middle - 0.5 * SIZE).length() < 1e-9, "{middle}");
            let above = view.project(camera.target + 0.1 * up.axis()).unwrap();
            assert!(above.y < middle.y - 1.0 && (above.x - middle.x).abs() < 1e-9, "{above}");
            // From above, the horizon's axes turn anticlockwise.
            let [first, second] = up.horizon();
            assert_eq!(first.cross(second), up.axis());
        }
    }

    #[test]
    fn a_ray_goes_through_what_is_projected() {
        let camera = camera(Up::Z);
        let view = camera.view(SIZE, 10.0);
        for point in [DVec3::new(10.5, -19.0, 30.2), DVec3::new(9.0, -21.0, 29.5), DVec3::new(10.0, -20.0, 31.0)] {
            let ray = view.ray(view.project(point).unwrap());
            let to_point = point - ray.origin;
            let off = (to_point - ray.direction * to_point.dot(ray.direction)).length();
            // A few roundings of lengths up to 40.
            assert!(off < 1e-12, "{off}");
            assert!(to_point.dot(ray.direction) > 0.0);
        }
    }

    #[test]
    fn sizes_in_the_picture_are_those_of_the_world() {
        let camera = camera(Up::Y);
        let view = camera.view(SIZE, 10.0);
        let metres = view.metres_per_point(camera.target);
        let [from, to] = [0.0, 1e-3].map(|by| view.project(camera.target + view.right * by).unwrap());
        assert!(((to - from).length() * metres / 1e-3 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_ball_just_fits() {
        for size in [SIZE, DVec2::new(300.0, 300.0)] {
            let camera = Camera { distance: Camera::distance_for(2.0, size), ..camera(Up::Y) };
            let view = camera.view(size, 2.0);
            // A ball is seen under the angle whose sine is its radius over the distance: its edge
            // is on the edge of the picture.
            let sine = 2.0 / camera.distance;
            let edge = camera.target + 2.0 * (view.towards * sine + view.above * (1.0 - sine * sine).sqrt());
            assert!(view.project(edge).unwrap().y.abs() < 1e-9 * size.y, "{:?}", view.project(edge));
        }
    }

    #[test]
    fn what_is_behind_is_not_seen() {
        let camera = camera(Up::Y);
        let view = camera.view(SIZE, 10.0);
        assert_eq!(view.project(camera.target + 2.0 * camera.distance * view.towards), None);
        assert_eq!(view.project(DVec3::NAN), None);
    }

    #[test]
    fn the_camera_does_not_turn_over() {
        let mut camera = camera(Up::Y);
        camera.turn(100.0, 100.0);
        assert!(camera.pitch < std::f64::consts::FRAC_PI_2 && (0.0..std::f64::consts::TAU).contains(&camera.yaw));
        assert_eq!(Up::along(DVec3::new(0.0, 0.0, -9.81)), Some(Up::Z));
        assert_eq!(Up::along(DVec3::ZERO), None);
    }
}
