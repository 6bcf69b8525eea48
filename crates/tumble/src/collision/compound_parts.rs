//! Colliders made of several, each with a surface and groups of its own.

use std::sync::Arc;

use tumble_collide::{Compound, Isometry};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider::{Collider, Groups};
use crate::collision::collider_error::ColliderError;
use crate::collision::collider_shape::{ColliderShape, checked};
use crate::collision::material::Material;
use crate::components::Pose;
use crate::math::{Real, Vec3 as WorldVec3, dquat, dvec3, real};

/// The surface and groups of a part.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PartSurface {
    /// Of the numbers of the shape's parts, the first after those of this one.
    pub(crate) end: u32,
    pub(crate) material: Material,
    pub(crate) groups: Groups,
    pub(crate) is_sensor: bool,
}

impl Collider {
    /// Several colliders fixed to each other, of one body: each at the [place](Self::with_offset)
    /// that it has, with the material and the groups that it has.
    ///
    /// Where two bodies meet, the material and the groups are those of the two parts.
    /// [`with_material`](Self::with_material) and [`with_groups`](Self::with_groups) on the whole
    /// give all parts the same, [`with_offset`](Self::with_offset) moves it as a whole. Surfaces
    /// and half-spaces may be among the parts, as ground.
    ///
    /// ```
    /// use tumble::{Collider, Material, Pose, Shape, math::Vec3};
    ///
    /// // A sledge: runners of steel, and a box of wood that snow, group 2, does not touch.
    /// let runners = Collider::new(&Shape::cuboid([0.3, 0.05, 1.0]))?
    ///     .with_material(Material::new(0.02, 0.0))?;
    /// let load = Collider::new(&Shape::cuboid([0.3, 0.2, 0.6]))?
    ///     .with_groups(1, !2)
    ///     .with_offset(Pose::at(Vec3::Y * 0.25))?;
    /// let sledge = Collider::compound([runners, load])?;
    /// assert_eq!(
    ///     sledge.materials().map(|it| it.dynamic_friction).collect::<Vec<_>>(),
    ///     [0.02, 0.5]
    /// );
    /// # Ok::<(), tumble::ColliderError>(())
    /// ```
    ///
    /// # Errors
    /// [`ColliderError::Shape`] for no parts, and [`ColliderError::Size`] if one reaches too far.
    pub fn compound(parts: impl IntoIterator<Item = Self>) -> Result<Self, ColliderError> {
        let (mut shapes, mut surfaces) = (Vec::new(), Vec::new());
        let mut first = 0_u32;
        for part in parts {
            let own = |end| PartSurface {
                end,
                material: *part.material(),
                groups: part.filter_groups(),
                is_sensor: part.is_sensor(),
            };
            match part.surfaces() {
                [] => surfaces.push(own(first.saturating_add(part.geometry().parts()))),
                inner => surfaces.extend(
                    inner.iter().map(|inner| PartSurface { end: first.saturating_add(inner.end), ..inner.clone() }),
                ),
            }
            first = first.saturating_add(part.geometry().parts());
            let at = part.place().unwrap_or(Isometry::at(tumble_math::lane::Vec3::zero()));
            shapes.push((at, part.geometry().clone()));
        }
        let Some(PartSurface { material, groups, .. }) = surfaces.first().cloned() else {
            return Err(ColliderError::Shape { shape: "compound of nothing" });
        };
        let geometry = checked(ColliderShape::Compound(Arc::new(Compound::new(shapes))))?;
        // Whoever asks for the groups of the whole asks whether any part may touch.
        let groups = surfaces.iter().fold(groups, |all, part| all.with(part.groups));
        Ok(Self::of_parts(geometry, material, groups, surfaces.into()))
    }

    /// The surfaces of its parts, in their order, where they have their own; or its one.
    pub fn materials(&self) -> impl Iterator<Item = &Material> {
        let whole = self.surfaces().is_empty().then_some(self.material());
        whole.into_iter().chain(self.surfaces().iter().map(|part| &part.material))
    }

    /// [Membership and filter](Self::groups) of its parts, in the same order as their
    /// [materials](Self::materials); or its one pair.
    ///
    /// ```
    /// # use tumble::{Collider, Shape};
    /// let ball = || Collider::new(&Shape::sphere(0.5));
    /// let pair = Collider::compound([ball()?.with_groups(1, 2), ball()?.with_groups(4, !0)])?;
    /// assert_eq!(pair.groups_of_parts().collect::<Vec<_>>(), [(1, 2), (4, !0)]);
    /// # Ok::<(), tumble::ColliderError>(())
    /// ```
    pub fn groups_of_parts(&self) -> impl Iterator<Item = (u32, u32)> {
        let whole = self.surfaces().is_empty().then_some(self.groups());
        whole.into_iter().chain(self.surfaces().iter().map(|part| part.groups.bits()))
    }

    /// Whether each of its parts is a [sensor](Self::sensor), in the same order as their
    /// [materials](Self::materials); or whether it is.
    ///
    /// ```
    /// # use tumble::{Collider, Shape};
    /// let ball = || Collider::new(&Shape::sphere(0.5));
    /// let guard = Collider::compound([ball()?, ball()?.sensor()])?;
    /// assert_eq!(guard.sensors_of_parts().collect::<Vec<_>>(), [false, true]);
    /// # Ok::<(), tumble::ColliderError>(())
    /// ```
    pub fn sensors_of_parts(&self) -> impl Iterator<Item = bool> {
        let whole = self.surfaces().is_empty().then_some(self.is_sensor());
        whole.into_iter().chain(self.surfaces().iter().map(|part| part.is_sensor))
    }

    /// The part of a number, as its geometry has it, if parts have surfaces of their own.
    pub(crate) fn surface_of(&self, number: u32) -> Option<&PartSurface> {
        let parts = self.surfaces();
        parts.get(parts.partition_point(|part| part.end <= number)).or(parts.last())
    }

    /// The groups of the part of a number, and whether it is a sensor.
    fn role_of(&self, number: u32) -> (Groups, bool) {
        self.surface_of(number).map_or((self.filter_groups(), self.is_sensor()), |part| (part.groups, part.is_sensor))
    }

    /// The groups of a part, by its place in the list of parts of its geometry, and whether it is a
    /// sensor.
    pub(crate) fn role_of_part(&self, place: u32) -> (Groups, bool) {
        self.role_of(self.number_of_part(place))
    }

    /// The first of the numbers that a part has, by its place in the list of parts.
    pub(crate) fn number_of_part(&self, place: u32) -> u32 {
        match self.geometry() {
            ColliderShape::Compound(compound) => compound.number_of(place as usize),
            _ => 0,
        }
    }

    /// Where it is in the world on a body of this pose, whose centre of mass is at `offset` \[m\]
    /// in the frame of the body.
    pub(crate) fn placed_at(&self, pose: &Pose, offset: WorldVec3) -> Isometry<f64> {
        let orientation = Quat::<f64>::from(dquat(pose.orientation)).normalize();
        let center = Vec3::<f64>::from(dvec3(pose.position));
        let body = Isometry { position: center - orientation.rotate(dvec3(offset).into()), orientation };
        self.place().map_or(body, |inner| body.then(&wide(&inner)))
    }

    /// Shows the parts of a collider placed in the world: which, its groups, whether it is a
    /// sensor, its shape and where it is.
    pub(crate) fn for_each_part(
        &self,
        at: &Isometry<f64>,
        mut visit: impl FnMut(u32, (Groups, bool), &ColliderShape, &Isometry<f64>),
    ) {
        let ColliderShape::Compound(compound) = self.geometry() else {
            return visit(0, (self.filter_groups(), self.is_sensor()), self.geometry(), at);
        };
        for (place, (inner, shape)) in compound.parts().iter().enumerate() {
            visit(place as u32, self.role_of_part(place as u32), shape, &at.then(&wide(inner)));
        }
    }

    /// Whether parts of two colliders push each other, by the number that their geometries give the
    /// pair.
    pub(crate) fn parts_touch(&self, other: &Self, pair: u32) -> bool {
        if self.surfaces().is_empty() && other.surfaces().is_empty() {
            return true;
        }
        let [mine, its] = numbers(pair, other.geometry().parts());
        let [(groups, is_sensor), (its_groups, is_other_sensor)] = [self.role_of(mine), other.role_of(its)];
        !is_sensor && !is_other_sensor && groups.touch(its_groups)
    }
}

/// The numbers of two parts from that of the pair, where the second shape has `of_second`.
pub(crate) fn numbers(pair: u32, of_second: u32) -> [u32; 2] {
    let of_second = of_second.max(1);
    [pair / of_second, pair % of_second]
}

/// A place in double precision.
pub(crate) fn wide(at: &Isometry<Real>) -> Isometry<f64> {
    let [position, vector] = [at.position, at.orientation.vector()].map(|it| dvec3(it.into()).into());
    Isometry { position, orientation: Quat::from_parts(at.orientation.w.into(), vector).normalize() }
}

/// A place in the precision of the build.
pub(crate) fn narrow(at: &Isometry<f64>) -> Isometry<Real> {
    let vector = |v: Vec3<f64>| Vec3::new(real(v.x), real(v.y), real(v.z));
    let orientation = Quat::from_parts(real(at.orientation.w), vector(at.orientation.vector()));
    Isometry { position: vector(at.position), orientation }
}
