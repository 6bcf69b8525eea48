//! Models of bodies with colliders, in few words.

use crate::model::collider_model::ColliderModel;
use crate::model::force_model::ForceModel;
use crate::model::orientation_model::OrientationModel;
use crate::model::scene_model::{BodyModel, SceneModel, ShapeModel};
use crate::values::tuple::Tuple;

impl SceneModel {
    pub(crate) fn of(steps: u64, bodies: Vec<BodyModel>) -> Self {
        Self { steps: Some(steps), bodies, ..Self::default() }
    }
}

impl BodyModel {
    /// A body with a collider of the default surface.
    pub(crate) fn touching(shape: ShapeModel, position: [f64; 3]) -> Self {
        Self {
            shape: Some(shape),
            position: Some(Tuple(position)),
            collider: Some(ColliderModel::default()),
            ..Self::default()
        }
    }

    pub(crate) fn cuboid(half_extents: [f64; 3], position: [f64; 3]) -> Self {
        Self::touching(ShapeModel::Cuboid { half_extents: Tuple(half_extents) }, position)
    }

    pub(crate) fn sphere(radius: f64, position: [f64; 3]) -> Self {
        Self::touching(ShapeModel::Sphere { radius }, position)
    }

    /// Fixed infinite ground.
    pub(crate) fn half_space(name: &str, normal: [f64; 3], position: [f64; 3]) -> Self {
        let shape = ShapeModel::HalfSpace { normal: Tuple(normal) };
        Self { fixed: true, ..Self::touching(shape, position) }.named(name)
    }

    pub(crate) fn ground() -> Self {
        Self::half_space("ground", [0.0, 1.0, 0.0], [0.0; 3])
    }

    pub(crate) fn named(self, name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), ..self }
    }

    pub(crate) fn mass(self, mass: f64) -> Self {
        Self { mass: Some(mass), ..self }
    }

    pub(crate) fn density(self, density: f64) -> Self {
        Self { density: Some(density), ..self }
    }

    pub(crate) fn turned(self, [x, y, z, w]: [f64; 4]) -> Self {
        let length = (x * x + y * y + z * z + w * w).sqrt();
        let unit = Tuple([x / length, y / length, z / length, w / length]);
        Self { orientation: Some(OrientationModel::Quaternion(unit)), ..self }
    }

    pub(crate) fn moving(self, linear: [f64; 3], angular: [f64; 3]) -> Self {
        Self { linear_velocity: Some(Tuple(linear)), angular_velocity: Some(Tuple(angular)), ..self }
    }

    pub(crate) fn surface(self, surface: ColliderModel) -> Self {
        Self { collider: Some(surface), ..self }
    }

    pub(crate) fn pulled(self, forces: Vec<ForceModel>) -> Self {
        Self { forces, ..self }
    }
}

impl ColliderModel {
    pub(crate) fn rough(friction: f64) -> Self {
        Self { friction: Some(friction), ..Self::default() }
    }

    /// Of a ball that is to come to rest somewhere.
    pub(crate) fn rolling(self, length: f64) -> Self {
        Self { rolling_resistance: Some(length), ..self }
    }

    pub(crate) fn bouncing(self, restitution: f64) -> Self {
        Self { restitution: Some(restitution), ..self }
    }
}
