//! Where nodes are: the transforms from a scene's root down.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::checked::{MAX_COMPONENT, unit_quaternion};
use crate::error::FieldError;
use crate::gltf::document::{Document, Node};

/// Relative size of what a decomposition may leave over: some roundings of f32, in which files are
/// written.
const SHEAR_TOLERANCE: f64 = 1e-5;

/// Most nodes above one another. A chain of bones or of a rope has hundreds.
const MAX_DEPTH: usize = 10_000;

/// A node's place in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) transform: DAffine3,
    pub(crate) rotation: DQuat,
    /// Along the node's axes; negative where it mirrors.
    pub(crate) scale: DVec3,
    /// Whether rotation and scale are not all of it: a turned node in an unevenly scaled one.
    pub(crate) sheared: bool,
}

/// The parents of all nodes, and the places of those that the scene holds.
#[derive(Debug)]
pub(crate) struct Tree {
    parents: Vec<Option<usize>>,
    /// `None` for a node that is not in the scene.
    pub(crate) places: Vec<Option<Place>>,
    /// The nodes of the scene, each after its parent.
    order: Vec<usize>,
}

impl Tree {
    /// Walks the scene that the document names, the first where it names none, and all roots of a
    /// document without scenes.
    pub(crate) fn of(document: &Document) -> Result<Self, FieldError> {
        let nodes = &document.nodes;
        let parents = parents(nodes)?;
        let (list, roots) = match (document.scene, document.scenes.first()) {
            (Some(index), _) => {
                let scene = document.scenes.get(index);
                let missing = || FieldError::new("scene", format!("there is no scenes[{index}]"));
                (format!("scenes[{index}]"), scene.ok_or_else(missing)?.nodes.clone())
            }
            (None, Some(scene)) => ("scenes[0]".to_owned(), scene.nodes.clone()),
            (None, None) => ("nodes".to_owned(), (0..nodes.len()).filter(|index| parents[*index].is_none()).collect()),
        };
        let mut places = vec![None; nodes.len()];
        let mut order = Vec::new();
        let mut open: Vec<(usize, usize, DAffine3, DQuat)> = Vec::new();
        for &root in roots.iter().rev() {
            match parents.get(root) {
                Some(None) => open.push((root, 0, DAffine3::IDENTITY, DQuat::IDENTITY)),
                Some(Some(parent)) => {
                    return Err(FieldError::new(list, format!("nodes[{root}] is a child of nodes[{parent}], no root")));
                }
                None => return Err(FieldError::new(list, format!("there is no nodes[{root}]"))),
            }
        }
        // Every node has one parent and the walk starts at nodes without, so it ends.
        while let Some((index, depth, above, turned)) = open.pop() {
            if depth == MAX_DEPTH {
                return Err(FieldError::exceeding(
                    format!("nodes[{index}]"),
                    "nodes above one another",
                    MAX_DEPTH as u64,
                ));
            }
            let (inner, turn) = local(&nodes[index], index)?;
            let (transform, rotation) = (above * inner, turned * turn);
            if !(transform.is_finite() && transform.translation.abs().max_element() <= MAX_COMPONENT) {
                return Err(FieldError::new(format!("nodes[{index}]"), "is not placed at finite coordinates"));
            }
            let place = Place::of(transform, rotation);
            order.push(index);
            open.extend(nodes[index].children.iter().rev().map(|child| (*child, depth + 1, transform, place.rotation)));
            places[index] = Some(place);
        }
        Ok(Self { parents, places, order })
    }

    /// For each node of the scene, what it has or else the nearest above it that has any.
    pub(crate) fn inherited<T: Copy>(&self, own: impl Fn(usize) -> Option<T>) -> Vec<Option<T>> {
        let mut found = vec![None; self.places.len()];
        for &index in &self.order {
            found[index] = own(index).or_else(|| found[self.parents[index]?]);
        }
        found
    }
}

/// The parent of each node; no node may have two, nor be below itself.
fn parents(nodes: &[Node]) -> Result<Vec<Option<usize>>, FieldError> {
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for (place, &child) in node.children.iter().enumerate() {
            let problem = match parents.get_mut(child) {
                None => format!("there is no nodes[{child}]"),
                Some(Some(other)) => format!("nodes[{child}] is a child of nodes[{other}] already"),
                Some(parent) => {
                    *parent = Some(index);
                    continue;
                }
            };
            return Err(FieldError::new(format!("nodes[{index}].children[{place}]"), problem));
        }
    }
    // With one parent each, what no root leads to goes round in a circle.
    let mut open: Vec<usize> = (0..nodes.len()).filter(|index| parents[*index].is_none()).collect();
    let mut reached = vec![false; nodes.len()];
    while let Some(index) = open.pop() {
        reached[index] = true;
        open.extend(&nodes[index].children);
    }
    match reached.iter().position(|reached| !reached) {
        Some(index) => Err(FieldError::new(format!("nodes[{index}].children"), "lead back to the node itself")),
        None => Ok(parents),
    }
}

/// A node's transform in its parent, and the rotation that is part of it.
pub(crate) fn local(node: &Node, index: usize) -> Result<(DAffine3, DQuat), FieldError> {
    let field = |name: &str, problem: String| FieldError::new(format!("nodes[{index}].{name}"), problem);
    if let Some(matrix) = node.matrix.as_deref() {
        // Columns.
        let [a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3, t0, t1, t2, t3] = *matrix;
        if [a3, b3, c3, t3] != [0.0, 0.0, 0.0, 1.0] {
            return Err(field("matrix", "has a last row other than 0 0 0 1".to_owned()));
        }
        let linear = DMat3::from_cols_array(&[a0, a1, a2, b0, b1, b2, c0, c1, c2]);
        let transform = DAffine3::from_mat3_translation(linear, DVec3::new(t0, t1, t2));
        return Ok((transform, decomposed(transform).rotation));
    }
    let rotation = match node.rotation {
        None => DQuat::IDENTITY,
        Some(rotation) => unit(rotation).map_err(|problem| field("rotation", problem))?,
    };
    let vector = |value: Option<[f64; 3]>, otherwise| value.map_or(otherwise, DVec3::from_array);
    let (scale, translation) = (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
    Ok((DAffine3::from_scale_rotation_translation(scale, rotation, translation), rotation))
}

/// A quaternion whose length is one, nearly.
pub(crate) fn unit(components: [f64; 4]) -> Result<DQuat, String> {
    unit_quaternion("", components).map_err(|error| error.problem)
}

impl Place {
    /// The rotation that the file has, if what is left without it is a scale along the node's axes.
    /// Otherwise, as below an uneven or mirroring scale, the one that leaves such a scale, if there
    /// is one.
    fn of(transform: DAffine3, rotation: DQuat) -> Self {
        let rest = DMat3::from_quat(rotation).transpose() * transform.matrix3;
        let scale = DVec3::new(rest.x_axis.x, rest.y_axis.y, rest.z_axis.z);
        let across = rest - DMat3::from_diagonal(scale);
        let largest = scale.abs().max_element();
        let beside = [across.x_axis, across.y_axis, across.z_axis].map(|column| column.abs().max_element());
        if beside.iter().all(|beside| *beside <= SHEAR_TOLERANCE * largest) {
            return Self { transform, rotation, scale, sheared: false };
        }
        decomposed(transform)
    }
}

/// Rotation and scale along the node's axes. A mirror is a negative scale of x, or of all three
/// where that needs no turn.
fn decomposed(transform: DAffine3) -> Place {
    let m = transform.matrix3;
    let lengths = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
    let largest = lengths.max_element();
    if largest == 0.0 {
        return Place { transform, rotation: DQuat::IDENTITY, scale: DVec3::ZERO, sheared: false };
    }
    let mut axes = orthonormal(m, lengths, largest);
    let mut scale = lengths;
    if axes.determinant() < 0.0 {
        // Any axis can carry the mirror. The one that leaves the smallest turn is the one that was
        // written.
        let mirrored =
            [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0), DVec3::new(1.0, 1.0, -1.0), DVec3::NEG_ONE];
        let trace = |signs: DVec3| signs.dot(DVec3::new(axes.x_axis.x, axes.y_axis.y, axes.z_axis.z));
        let signs =
            mirrored.into_iter().fold(mirrored[0], |best, signs| if trace(signs) > trace(best) { signs } else { best });
        axes = DMat3::from_cols(axes.x_axis * signs.x, axes.y_axis * signs.y, axes.z_axis * signs.z);
        scale *= signs;
    }
    let rotation = DQuat::from_mat3(&axes).normalize();
    let rest = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale) - m;
    let error = [rest.x_axis, rest.y_axis, rest.z_axis].map(|column| column.abs().max_element());
    let sheared = !error.iter().all(|error| *error <= SHEAR_TOLERANCE * largest);
    Place { transform, rotation, scale, sheared }
}

/// The directions of the columns, made orthogonal from the longest on. A column without length is
/// made of the others.
fn orthonormal(m: DMat3, lengths: DVec3, largest: f64) -> DMat3 {
    let columns = [m.x_axis, m.y_axis, m.z_axis];
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| lengths[*b].total_cmp(&lengths[*a]));
    let [first, second, third] = order;
    let mut axes = [DVec3::ZERO; 3];
    axes[first] = columns[first].normalize();
    let across = columns[second] - axes[first] * axes[first].dot(columns[second]);
    axes[second] =
        if across.length() > 1e-12 * largest { across.normalize() } else { axes[first].any_orthonormal_vector() };
    // Cyclic order of the three decides the sign of what completes them to a right-handed frame.
    let even = (second + 3 - first) % 3 == 1;
    let right = if even { axes[first].cross(axes[second]) } else { axes[second].cross(axes[first]) };
    axes[third] = if columns[third].dot(right) < 0.0 { -right } else { right };
    DMat3::from_cols(axes[0], axes[1], axes[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(rotation: DQuat, scale: DVec3) {
        let place = decomposed(DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::ZERO));
        assert!(!place.sheared, "{place:?}");
        let back = DMat3::from_quat(place.rotation) * DMat3::from_diagonal(place.scale);
        let m = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
        assert!(back.abs_diff_eq(m, 1e-14 * scale.abs().max_element()), "{back} {m}");
        assert!((place.scale.abs() - scale.abs()).abs().max_element() <= 1e-14 * scale.abs().max_element());
    }

    #[test]
    fn rotation_and_scale_come_back() {
        let turn = DQuat::from_xyzw(0.1, -0.7, 0.3, 0.6).normalize();
        for scale in [
            DVec3::ONE,
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::new(0.3, -2.0, 3.0),
            DVec3::NEG_ONE,
            DVec3::new(1e-6, 1.0, 1e6),
        ] {
            check(turn, scale);
            check(DQuat::IDENTITY, scale);
        }
        // Flat and thin ones have no direction of their own; what is left is theirs.
        check(turn, DVec3::new(0.0, 1.0, 2.0));
        check(turn, DVec3::new(0.0, 0.0, 2.0));
        check(turn, DVec3::ZERO);
    }

    #[test]
    fn a_written_mirror_is_kept_as_written() {
        let place = decomposed(DAffine3::from_scale(DVec3::new(1.0, -2.0, 3.0)));
        assert_eq!((place.rotation, place.scale), (DQuat::IDENTITY, DVec3::new(1.0, -2.0, 3.0)));
    }

    /// What the file says outright is not found again from the product, which has other factors
    /// too: an even number of mirrors is a half turn.
    #[test]
    fn rotation_and_scale_are_those_of_the_file() {
        let half = DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0);
        let turn = DQuat::from_xyzw(0.1, -0.7, 0.3, 0.6).normalize();
        for (rotation, scale) in [
            (DQuat::IDENTITY, DVec3::new(-1.0, -1.0, 1.0)),
            (half, DVec3::new(-1.0, 1.0, 1.0)),
            (turn, DVec3::new(-2.0, 1.0, -3.0)),
            (turn, DVec3::NEG_ONE),
            (turn, DVec3::new(0.0, 1.0, 1.0)),
        ] {
            let place = Place::of(DAffine3::from_scale_rotation_translation(scale, rotation, DVec3::ONE), rotation);
            assert_eq!((place.rotation, place.sheared), (rotation, false));
            assert!((place.scale - scale).abs().max_element() <= 4.0 * f64::EPSILON * 3.0, "{}", place.scale);
        }
    }

    #[test]
    fn a_turned_child_of_an_uneven_parent_is_sheared() {
        let parent = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
        let quarter = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let eighth = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_4);
        assert!(!decomposed(parent * quarter).sheared);
        assert!(decomposed(parent * eighth).sheared);
    }
}
