//! Visual geometry of bodies, and the colours they are drawn in.

use std::sync::Arc;

use tumble::{Collider, Shape, TriangleMesh};

/// What a body looks like, in its own frame.
///
/// ```
/// use tumble_scene::{Appearance, Scene};
///
/// let scene = Scene::from_json(r#"{ "bodies": [ { "shape": { "sphere": { "radius": 0.5 } }, "mass": 2 } ] }"#, "ball.json")?;
/// assert_eq!(scene.appearance()?, [Appearance::Shape(tumble::Shape::sphere(0.5))]);
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Appearance {
    /// As its shape.
    Shape(Shape),
    /// As a surface that need not bound anything, such as ground.
    Mesh(Arc<TriangleMesh>),
    /// As infinite ground: the plane y = 0, seen from above it.
    HalfSpace,
    /// As ground of heights over a grid.
    HeightField(Arc<Heights>),
}

/// Ground of heights: what is touched and what is seen of it.
///
/// ```
/// use tumble_scene::{Appearance, Scene};
///
/// let text = r#"{ "bodies": [ { "shape": { "height_field": { "heights": [[0, 1, 0], [0, 2, 0]] } }, "fixed": true } ] }"#;
/// let scene = Scene::from_json(text, "ridge.json")?;
/// let [Appearance::HeightField(ridge)] = &scene.appearance()?[..] else { return Ok(()) };
/// assert_eq!(ridge.triangles().triangles().len(), 4);
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    collider: Collider,
    triangles: TriangleMesh,
}

impl Heights {
    pub(crate) fn new(collider: Collider, triangles: TriangleMesh) -> Self {
        Self { collider, triangles }
    }

    /// What is touched of it, with the default surface.
    #[must_use]
    pub fn collider(&self) -> &Collider {
        &self.collider
    }

    /// What is seen of it, in the body's frame: anticlockwise from above.
    #[must_use]
    pub fn triangles(&self) -> &TriangleMesh {
        &self.triangles
    }
}

/// Colours that look different to most eyes, after Okabe and Ito, as red, green, blue in linear
/// light, taken by bodies that forces move in turn. Their number has no factor in common with the
/// kinds of a scene that repeats every two, four or eight.
pub const BODY_COLORS: [[f32; 3]; 7] = [
    [0.791, 0.347, 0.0],
    [0.093, 0.456, 0.815],
    [0.0, 0.342, 0.171],
    [0.871, 0.776, 0.054],
    [0.0, 0.168, 0.445],
    [0.665, 0.112, 0.0],
    [0.604, 0.191, 0.386],
];

/// The colour of what forces do not move, in linear light.
pub const FIXED_COLOR: [f32; 3] = [0.3, 0.3, 0.3];

/// The colour of infinite ground, in linear light.
pub const GROUND_COLOR: [f32; 3] = [0.075, 0.08, 0.095];
