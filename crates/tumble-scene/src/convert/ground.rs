//! Ground: half-spaces and height fields, shapes that have no mass.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use tumble::{Collider, ColliderError, HeightFieldError, MeshError, TriangleMesh};
use tumble_import::checked::note;
use tumble_import::{Appearance, FieldError, Heights, shortest};

use crate::convert::orientation::rotation;
use crate::limits::MAX_HEIGHTS;
use crate::model::scene_model::{BodyModel, Rows, ShapeModel};
use crate::values::checked::finite_triple;
use crate::values::tuple::{Triple, Tuple};

/// A normal shorter than this has no direction to speak of.
const SHORTEST_NORMAL: f64 = 1e-9;

/// What a body looks like whose shape is ground without a mistake. Notes what cannot be said of
/// such a body.
pub(crate) fn appearance(model: &BodyModel, problems: &mut Vec<FieldError>) -> Option<Appearance> {
    let shape = model.shape.as_ref().filter(|shape| shape.is_ground())?;
    let (appearance, immovable) = match shape {
        ShapeModel::HeightField { heights, spacing } => {
            let heights = note(problems, height_field(heights, spacing));
            let problem = "has no mass and cannot be pushed: the body is to be fixed or kinematic";
            let appearance = heights.map(|heights| Appearance::HeightField(Arc::new(heights)));
            (appearance, (!(model.fixed || model.kinematic)).then_some(problem))
        }
        _ => {
            let problem = "has no end and cannot move: the body is to be fixed";
            (Some(Appearance::HalfSpace), (!model.fixed).then_some(problem))
        }
    };
    let name = shape.name();
    problems.extend(immovable.map(|problem| FieldError::new(format!("shape.{name}"), problem)));
    let given = [
        ("mass", model.mass.is_some()),
        ("density", model.density.is_some()),
        ("inertia", model.inertia.is_some()),
        ("center_of_mass", model.center_of_mass.is_some()),
    ];
    for (field, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
        problems.push(FieldError::new(field, format!("belongs to a body with a volume, and the shape is a {name}")));
    }
    appearance
}

fn height_field(heights: &Rows, spacing: &Tuple<f64, 2>) -> Result<Heights, FieldError> {
    let error =
        |field: &str, problem: &dyn std::fmt::Display| FieldError::new(format!("shape.height_field.{field}"), problem);
    let (rows, columns) = (&heights.0, heights.0.first().map_or(0, |row| row.0.len()));
    if let Some((index, row)) = rows.iter().enumerate().find(|(_, row)| row.0.len() != columns) {
        let problem = format_args!("has {} heights, and the first row {columns}", row.0.len());
        return Err(error(&format!("heights[{index}]"), &problem));
    }
    if rows.len() * columns > MAX_HEIGHTS {
        return Err(error("heights", &format_args!("are {}, more than {MAX_HEIGHTS}", rows.len() * columns)));
    }
    let flat: Vec<f64> = rows.iter().flat_map(|row| row.0.iter().copied()).collect();
    let collider = Collider::height_field(flat, columns, spacing.0).map_err(|problem| match problem {
        ColliderError::HeightField(HeightFieldError::Height { index, value }) => {
            let (row, column) = (index / columns, index % columns);
            let value = shortest(value);
            error(&format!("heights[{row}][{column}]"), &format_args!("must be from -1e6 to 1e6 m, not {value}"))
        }
        ColliderError::HeightField(HeightFieldError::Rows { .. }) => {
            error("heights", &"must be at least two rows of at least two")
        }
        problem => error("spacing", &problem),
    })?;
    let triangles = triangles(heights, spacing).map_err(|problem| error("heights", &problem))?;
    Ok(Heights::new(collider, triangles))
}

/// The triangles of rows of the same length, as the engine has them.
fn triangles(heights: &Rows, spacing: &Tuple<f64, 2>) -> Result<TriangleMesh, MeshError> {
    let (rows, columns) = (heights.0.len(), heights.0.first().map_or(0, |row| row.0.len()));
    let middle = |count: usize| 0.5 * (count as f64 - 1.0);
    let mut corners = Vec::new();
    for (r, row) in heights.0.iter().enumerate() {
        let z = (r as f64 - middle(rows)) * spacing.0[1];
        let corner = |(c, height): (usize, &f64)| DVec3::new((c as f64 - middle(columns)) * spacing.0[0], *height, z);
        corners.extend(row.0.iter().enumerate().map(corner));
    }
    let mut triangles = Vec::new();
    for row in 1..rows {
        for column in 1..columns {
            let far = row * columns + column;
            let [near, right, below] = [far - columns - 1, far - columns, far - 1].map(|corner| corner as u32);
            triangles.extend([[near, far as u32, right], [near, below, far as u32]]);
        }
    }
    TriangleMesh::new(corners, triangles)
}

/// The rotation from the body's frame to the world, if the model has any. The frame of a half-space
/// has y along the normal.
pub(crate) fn orientation(model: &BodyModel) -> Result<Option<DQuat>, FieldError> {
    let given = model.orientation.as_ref().map(rotation).transpose()?;
    let Some(ShapeModel::HalfSpace { normal }) = &model.shape else { return Ok(given) };
    let turn = from_y_to(normal).map_err(|error| error.inside("shape.half_space"))?;
    Ok(Some(given.map_or(turn, |given| (given * turn).normalize())))
}

/// The shortest rotation that takes the y axis to a direction of any length.
fn from_y_to(normal: &Triple) -> Result<DQuat, FieldError> {
    let vector = finite_triple("normal", normal)?;
    let length = vector.length();
    if length < SHORTEST_NORMAL {
        return Err(FieldError::new("normal", format!("has no direction: its length is {}", shortest(length))));
    }
    let DVec3 { x, y, z } = vector / length;
    // Twice the angle's half: 1 + cos, and the axis times sin. Near the opposite, where both
    // vanish, any axis across will do.
    let rotation = DQuat::from_xyzw(z, 0.0, -x, 1.0 + y);
    Ok(if y > -1.0 + 1e-12 { rotation.normalize() } else { DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::tuple::Tuple;

    #[test]
    fn normals_become_orientations() {
        assert_eq!(from_y_to(&Tuple([0.0, 7.0, 0.0])).unwrap(), DQuat::IDENTITY);
        for normal in [[0.0, -1.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.3, -0.5, 0.2], [1e-5, -1.0, 0.0]] {
            let turned = from_y_to(&Tuple(normal)).unwrap() * DVec3::Y;
            let off = turned - DVec3::from_array(normal).normalize();
            // A few roundings; nearly opposite 1 + y has lost six digits.
            assert!(off.length() < 1e-10, "{normal:?}: {turned}");
        }
        for none in [[0.0; 3], [f64::NAN, 1.0, 0.0], [0.0, f64::INFINITY, 0.0]] {
            assert_eq!(from_y_to(&Tuple(none)).unwrap_err().field, "normal", "{none:?}");
        }
    }
}
