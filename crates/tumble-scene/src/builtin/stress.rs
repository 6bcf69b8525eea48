//! The generated scene: as many different tumbling bodies as wanted, from a seed.

use glam::{DQuat, DVec3};
use tumble::math::Vec3;
use tumble::{Amount, Axes, BodyError, BodyId, Part, RigidBody, Rng, Shape};
use tumble_import::Appearance;
use tumble_import::checked::{real_quaternion, real_vector};

use crate::bodies::scene_body::SceneBody;

/// Bodies of the stress scene unless another number is given.
pub(crate) const DEFAULT_BODIES: usize = 10_000;

/// What is to be seen in it.
pub(crate) const ABOUT: &str = "Mixed tumbling shapes from a seed, falling together.";

/// Steps of the stress scene.
pub(crate) const STEPS: u64 = 600;

/// Distance between the places of a cubic grid \[m\]; the largest body has a radius under 0.7 m.
const SPACING: f64 = 2.0;

/// Makes body after body.
///
/// The numbers come from [`Rng`], which gives the same ones everywhere. From its bits to the bodies
/// there is only `+ - * /` and `sqrt` in f64, so one seed gives the same bits everywhere. The first
/// bodies do not depend on how many follow, except for their places: the grid is as wide as it must
/// be.
pub(crate) struct StressBodies {
    rng: Rng,
    next: usize,
    count: usize,
    side: usize,
}

impl StressBodies {
    pub(crate) fn new(count: usize, seed: u64) -> Self {
        let side = (1..).find(|side: &usize| side.pow(3) >= count).unwrap_or(1);
        Self { rng: Rng::new(seed), next: 0, count, side }
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.rng.unit()
    }

    fn vector(&mut self, largest: f64) -> DVec3 {
        let mut component = || self.between(-largest, largest);
        DVec3::new(component(), component(), component())
    }

    /// Uniform over all rotations: a point of the four-dimensional ball, pushed out to its surface.
    fn orientation(&mut self) -> DQuat {
        loop {
            let [x, y, z, w] = std::array::from_fn(|_| self.between(-1.0, 1.0));
            let square = x * x + y * y + z * z + w * w;
            if (0.01..=1.0).contains(&square) {
                let length = square.sqrt();
                return DQuat::from_xyzw(x / length, y / length, z / length, w / length);
            }
        }
    }

    fn shape(&mut self, index: usize) -> Shape {
        let mut length = || self.between(0.1, 0.3);
        match index % 8 {
            0 => Shape::cuboid(DVec3::new(length(), length(), length())),
            1 => Shape::cylinder(length(), length()),
            2 => Shape::capsule(length(), length()),
            3 => Shape::cone(length(), length()),
            4 => Shape::ellipsoid(DVec3::new(length(), length(), length())),
            5 => Shape::sphere(length()),
            6 => Shape::hollow_sphere(length()),
            _ => self.weight_on_a_sphere(),
        }
    }

    fn weight_on_a_sphere(&mut self) -> Shape {
        let radius = self.between(0.1, 0.3);
        let [x, y, z, w] = self.orientation().to_array();
        // The image of the x axis under the rotation, in plain arithmetic.
        let direction = DVec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w));
        let weight = Part::new(Shape::sphere(0.25 * radius), Amount::Density(8000.0));
        Shape::compound([Part::new(Shape::sphere(radius), Amount::Density(1000.0)), weight.at(direction * radius)])
    }

    fn place(&self, index: usize) -> DVec3 {
        let side = self.side;
        let cell = [index % side, index / side % side, index / (side * side)];
        let [x, y, z] = cell.map(|cell| SPACING * (cell as f64 - 0.5 * (side as f64 - 1.0)));
        DVec3::new(x, y, z)
    }

    fn body(&mut self, index: usize) -> Result<SceneBody, BodyError> {
        let shape = self.shape(index);
        let density = self.between(500.0, 3000.0);
        let body = RigidBody::new(shape.clone()).without_collider();
        let body = match shape {
            Shape::Compound(_) => body,
            // A shell has no volume; this is its mass in a skin of a hundredth of its radius.
            Shape::HollowSphere { radius } => body.mass(0.01 * 12.0 * density * radius * radius * radius),
            _ => body.density(density),
        };
        let orientation = self.orientation();
        let body = body
            .id(BodyId(index as u64))
            .position(real_vector(self.place(index)))
            .orientation(real_quaternion(orientation))
            .linear_velocity(self.velocity(2.0))
            .angular_velocity(self.velocity(10.0))
            .build()?;
        Ok(SceneBody {
            body,
            appearance: Appearance::Shape(shape),
            forces: Vec::new(),
            springs_to: Vec::new(),
            collider: None,
            locked_axes: Axes::NONE,
            pieces: Vec::new(),
        })
    }

    fn velocity(&mut self, largest: f64) -> Vec3 {
        real_vector(self.vector(largest))
    }
}

impl Iterator for StressBodies {
    type Item = Result<SceneBody, BodyError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.next == self.count {
            return None;
        }
        let index = self.next;
        self.next += 1;
        Some(self.body(index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_body_can_be_built_and_none_overlap_in_the_grid() {
        let bodies = StressBodies::new(1000, 7);
        assert_eq!(bodies.side, 10);
        let mut places: Vec<_> = (0..1000).map(|index| bodies.place(index).to_array().map(|x| x as i64)).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 1000);
        assert!(bodies.into_iter().all(|body| body.is_ok()));
    }
}
