use std::sync::Arc;

use tumble::{Shape, TriangleMesh};

/// What a body looks like, in its own frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Looks {
    /// As its shape.
    Shape(Shape),
    /// As a surface that need not bound anything, such as ground.
    Mesh(Arc<TriangleMesh>),
}
