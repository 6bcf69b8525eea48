//! Geometry of colliders of any source.

use glam::DVec3;

/// The geometry of a collider or a trigger in the frame of its node, before the node's scale. Axes
/// of revolution lie along y.
///
/// ```
/// use tumble_import::gltf::{Geometry, Physics};
///
/// let physics = Physics::from_json(
///     r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "extensions": { "KHR_physics_rigid_bodies": { "collider": { "geometry": { "shape": 0 } }
///     } } } ],
/// "extensions": { "KHR_implicit_shapes": { "shapes": [ { "type": "sphere", "sphere": {
///     "radius": 0.5 } } ] } } }"#,
///     "scene.gltf",
/// )?;
/// let collider = physics.nodes[0].collider.as_ref();
/// assert_eq!(
///     collider.and_then(|collider| collider.geometry),
///     Some(Geometry::Sphere { radius: 0.5 })
/// );
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Geometry {
    /// A block.
    Box {
        /// Lengths of the edges \[m\].
        size: DVec3,
    },
    /// A ball.
    Sphere {
        /// Radius \[m\].
        radius: f64,
    },
    /// The hull of two balls.
    Capsule {
        /// Distance of the balls' centres \[m\].
        height: f64,
        /// Radius of the ball below \[m\].
        radius_bottom: f64,
        /// Radius of the ball above \[m\].
        radius_top: f64,
    },
    /// The hull of two discs; a cone where one of them is a point.
    Cylinder {
        /// Distance of the discs \[m\].
        height: f64,
        /// Radius of the disc below \[m\].
        radius_bottom: f64,
        /// Radius of the disc above \[m\].
        radius_top: f64,
    },
    /// The plane y = 0, facing up.
    Plane {
        /// Length along x \[m\]; infinite if absent.
        size_x: Option<f64>,
        /// Length along z \[m\]; infinite if absent.
        size_z: Option<f64>,
        /// Whether it faces down, too.
        double_sided: bool,
    },
    /// Triangles.
    Mesh {
        /// Where they are.
        source: MeshSource,
        /// Whether their convex hull is meant.
        convex_hull: bool,
    },
}

/// Where the triangles of a mesh collider are.
///
/// ```
/// use tumble_import::gltf::{Geometry, MeshSource};
///
/// let hull_of_the_third_mesh = Geometry::Mesh { source: MeshSource::Mesh(2), convex_hull: true };
/// # assert_ne!(hull_of_the_third_mesh, Geometry::Sphere { radius: 1.0 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshSource {
    /// The meshes of this node and of those below it, in its frame.
    Node(usize),
    /// This mesh.
    Mesh(usize),
}
