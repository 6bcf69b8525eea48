//! Visual geometry of bodies.

use std::sync::Arc;

use tumble::{Collider, Shape, TriangleMesh};

/// What a body looks like, in its own frame.
///
/// ```
/// use tumble_import::{Appearance, Tessellation};
///
/// let ball = Appearance::Shape(tumble::Shape::sphere(0.5));
/// assert!(
///     Tessellation::of_appearance(&ball).positions.iter().all(|corner| corner.length() < 0.5001)
/// );
/// ```
#[derive(Clone, Debug, PartialEq)]
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
/// use tumble::{Collider, TriangleMesh};
/// use tumble_import::Heights;
///
/// let corners = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]].map(Into::into);
/// let slope = Heights::new(Collider::half_space(), TriangleMesh::new(corners, [[0, 1, 2]])?);
/// assert_eq!(slope.triangles().triangles().len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    collider: Collider,
    triangles: TriangleMesh,
}

impl Heights {
    /// What is touched of it, with the default surface, and what is seen of it, both in the body's
    /// frame.
    #[must_use]
    pub fn new(collider: Collider, triangles: TriangleMesh) -> Self {
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
