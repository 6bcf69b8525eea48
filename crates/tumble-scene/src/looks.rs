use std::sync::Arc;

use tumble::{Shape, TriangleMesh};

/// What a body looks like, in its own frame.
///
/// ```
/// use tumble_scene::{Looks, Scene};
///
/// let scene = Scene::from_json(r#"{ "bodies": [ { "shape": { "sphere": { "radius": 0.5 } }, "mass": 2 } ] }"#, "ball.json")?;
/// assert_eq!(scene.looks()?, [Looks::Shape(tumble::Shape::sphere(0.5))]);
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Looks {
    /// As its shape.
    Shape(Shape),
    /// As a surface that need not bound anything, such as ground.
    Mesh(Arc<TriangleMesh>),
}
