//! Whether two shapes have a point in common.

use crate::aabb::Aabb;
use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::{difference, wide_placement};
use crate::gjk::{Nearest, nearest};
use crate::query::line::AXES;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector};
use crate::surface::Surface;

impl<R: Scalar> ColliderShape<R> {
    /// The first pair of parts of two shapes that have a point in common, as places in the lists of
    /// their compounds: zero of what is no compound. Meshes and height fields are surfaces: what is
    /// under one does not touch it, and two surfaces, or two half-spaces, are not compared.
    ///
    /// ```
    /// use tumble_collide::{ColliderShape, Isometry};
    /// use tumble_math::lane::Vec3;
    ///
    /// let (sphere, ground) =
    ///     (ColliderShape::Sphere { radius: 0.5_f32 }, ColliderShape::HalfSpace);
    /// let at = |y: f64| Isometry::at(Vec3::new(0.0, y, 0.0));
    /// assert_eq!(sphere.overlap(&at(0.4), &ground, &at(0.0)), Some([0, 0]));
    /// assert_eq!(sphere.overlap(&at(0.6), &ground, &at(0.0)), None);
    /// ```
    #[must_use]
    pub fn overlap(&self, at: &Isometry<f64>, other: &Self, other_at: &Isometry<f64>) -> Option<[u32; 2]> {
        if let Self::Compound(compound) = self {
            return (0..).zip(compound.parts()).find_map(|(number, (inner, part))| {
                let [_, second] = part.overlap(&at.then(&wide_placement(inner)), other, other_at)?;
                Some([number, second])
            });
        }
        if let Self::Compound(_) = other {
            let [second, first] = other.overlap(other_at, self, at)?;
            return Some([first, second]);
        }
        let is_met = match (self, other) {
            (Self::HalfSpace, _) => below(other, other_at, at),
            (_, Self::HalfSpace) => below(self, at, other_at),
            (Self::Mesh(mesh), _) => meets_surface(mesh.as_ref(), at, other, other_at),
            (_, Self::Mesh(mesh)) => meets_surface(mesh.as_ref(), other_at, self, at),
            (Self::HeightField(field), _) => meets_surface(field.as_ref(), at, other, other_at),
            (_, Self::HeightField(field)) => meets_surface(field.as_ref(), other_at, self, at),
            _ => {
                Convex::of(self).zip(Convex::of(other)).is_some_and(|(first, second)| meet(first, at, second, other_at))
            }
        };
        is_met.then_some([0, 0])
    }

    /// The height of its lowest point above a plane \[m\], of a convex shape or a surface.
    pub(crate) fn height_over(&self, at: &Isometry<f64>, plane: &Isometry<f64>) -> Option<f64> {
        let up = plane.orientation.rotate(Vector::new(0.0, 1.0, 0.0));
        let height = |point: Vector| up.dot(at.to_world(point) - plane.position);
        let of_points = |points: &[Vector]| points.iter().map(|point| height(*point)).reduce(f64::min);
        match self {
            Self::Mesh(mesh) => of_points(mesh.points()),
            Self::HeightField(field) => of_points(field.points()),
            _ => {
                let (convex, layer) = Convex::of(self)?;
                let lowest = convex.support(at.orientation.rotate_back(up * -1.0));
                Some(height(lowest) - layer)
            }
        }
    }
}

/// Whether any of a shape is in a half-space.
fn below<R: Scalar>(shape: &ColliderShape<R>, at: &Isometry<f64>, ground: &Isometry<f64>) -> bool {
    shape.height_over(at, ground).is_some_and(|height| height <= 0.0)
}

/// Whether two convex shapes with layers have a point in common.
fn meet(
    (first, layer): (Convex<'_>, f64),
    at: &Isometry<f64>,
    (second, other_layer): (Convex<'_>, f64),
    other_at: &Isometry<f64>,
) -> bool {
    let layers = layer + other_layer;
    difference(first, at, second, other_at).is_some_and(|shapes| match nearest(&shapes, layers) {
        Nearest::Far => false,
        Nearest::Apart { between, .. } => between.dot(between).sqrt() <= layers,
        Nearest::Overlap(_) => true,
    })
}

fn meets_surface<R: Scalar>(
    surface: &impl Surface,
    ground: &Isometry<f64>,
    shape: &ColliderShape<R>,
    at: &Isometry<f64>,
) -> bool {
    let Some(convex) = Convex::of(shape) else { return false };
    let local = Isometry {
        position: ground.to_local(at.position),
        orientation: ground.orientation.conjugate() * at.orientation,
    };
    let mut is_met = false;
    surface.near(&around(convex, &local), &mut |triangle| {
        is_met = is_met || meet((Convex::Triangle(surface.triangle(triangle)), 0.0), ground, convex, at);
    });
    is_met
}

/// The box along the axes that holds a convex shape with a layer.
pub(crate) fn around((convex, layer): (Convex<'_>, f64), at: &Isometry<f64>) -> Aabb<f64> {
    let reach = |axis: Vector| axis.dot(at.to_world(convex.support(at.orientation.rotate_back(axis)))) + layer;
    let [x, y, z] = AXES;
    let high = Vector::new(reach(x), reach(y), reach(z));
    let low = Vector::new(-reach(x * -1.0), -reach(y * -1.0), -reach(z * -1.0));
    Aabb { low, high }
}
