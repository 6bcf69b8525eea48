//! Models of bodies with colliders, in few words.

use crate::collider_model::ColliderModel;
use crate::force_model::ForceModel;
use crate::model::{BodyModel, SceneModel, ShapeModel, Tuple};

impl SceneModel {
    pub(super) fn of(steps: u64, bodies: Vec<BodyModel>) -> Self {
        Self { steps: Some(steps), bodies, ..Self::default() }
    }
}

impl BodyModel {
    /// A body with a collider of the default surface.
    pub(super) fn touching(shape: ShapeModel, position: [f64; 3]) -> Self {
        Self {
            shape: Some(shape),
            position: Some(Tuple(position)),
            collider: Some(ColliderModel::default()),
            ..Self::default()
        }
    }

    pub(super) fn cuboid(half_extents: [f64; 3], position: [f64; 3]) -> Self {
        Self::touching(ShapeModel::Cuboid { half_extents: Tuple(half_extents) }, position)
    }

    pub(super) fn sphere(radius: f64, position: [f64; 3]) -> Self {
        Self::touching(ShapeModel::Sphere { radius }, position)
    }

    /// Fixed infinite ground.
    pub(super) fn half_space(name: &str, normal: [f64; 3], position: [f64; 3]) -> Self {
        let shape = ShapeModel::HalfSpace { normal: Tuple(normal) };
        Self { fixed: true, ..Self::touching(shape, position) }.named(name)
    }

    pub(super) fn ground() -> Self {
        Self::half_space("ground", [0.0, 1.0, 0.0], [0.0; 3])
    }

    pub(super) fn named(self, name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), ..self }
    }

    pub(super) fn mass(self, mass: f64) -> Self {
        Self { mass: Some(mass), ..self }
    }

    pub(super) fn density(self, density: f64) -> Self {
        Self { density: Some(density), ..self }
    }

    pub(super) fn turned(self, [x, y, z, w]: [f64; 4]) -> Self {
        let length = (x * x + y * y + z * z + w * w).sqrt();
        Self { orientation: Some(Tuple([x / length, y / length, z / length, w / length])), ..self }
    }

    pub(super) fn moving(self, linear: [f64; 3], angular: [f64; 3]) -> Self {
        Self { linear_velocity: Some(Tuple(linear)), angular_velocity: Some(Tuple(angular)), ..self }
    }

    pub(super) fn surface(self, surface: ColliderModel) -> Self {
        Self { collider: Some(surface), ..self }
    }

    pub(super) fn pulled(self, forces: Vec<ForceModel>) -> Self {
        Self { forces, ..self }
    }
}

impl ColliderModel {
    pub(super) fn rough(friction: f64) -> Self {
        Self { friction: Some(friction), ..Self::default() }
    }

    /// Of a ball that is to come to rest somewhere.
    pub(super) fn rolling(self, length: f64) -> Self {
        Self { rolling_resistance: Some(length), ..self }
    }

    pub(super) fn bouncing(self, restitution: f64) -> Self {
        Self { restitution: Some(restitution), ..self }
    }
}
