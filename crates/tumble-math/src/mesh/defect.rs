//! What can be wrong with a mesh, and what can be done about it.

use std::fmt;

/// One kind of thing that is wrong with a mesh, with how often.
///
/// Those with a [`repair`](Self::repair) are mended by
/// [`TriangleMesh::repaired`](crate::TriangleMesh::repaired), those that
/// [are harmless](Self::is_harmless) change no volume and do not keep a mesh from being
/// [solid](crate::TriangleMesh::solid); the others leave open what is inside, and nothing but the
/// author of the mesh can tell.
///
/// ```
/// use tumble_math::MeshDefect;
/// let hole = MeshDefect::OpenEdges { edges: 3 };
/// assert_eq!((hole.to_string().as_str(), hole.repair()), ("3 open edges", None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshDefect {
    /// Triangles with two corners at the same place. Nothing is lost with them.
    DegenerateTriangles {
        /// How many.
        triangles: usize,
    },
    /// Triangles whose three corners are different but on one line, within rounding. They hold the
    /// mesh together where a vertex of one neighbour lies on the edge of another, and so are kept.
    CollinearTriangles {
        /// How many.
        triangles: usize,
    },
    /// Triangles with the same three corners as another one, whichever way round.
    DuplicateTriangles {
        /// How many are superfluous.
        triangles: usize,
    },
    /// Edges with one triangle, all of which are closed by welding vertices that are nearly at the
    /// same place.
    Cracks {
        /// How many such edges.
        edges: usize,
        /// How many vertices are to be welded to a neighbour.
        vertices: usize,
    },
    /// Edges with only one triangle: the surface has a hole.
    OpenEdges {
        /// How many.
        edges: usize,
    },
    /// Edges with more than two triangles: sheets that meet in a line.
    OverfullEdges {
        /// How many.
        edges: usize,
    },
    /// Edges along which their two triangles run the same way: one of them shows its back.
    ReversedEdges {
        /// How many.
        edges: usize,
    },
    /// Parts that have one side only, like a Klein bottle.
    OneSidedParts {
        /// How many.
        parts: usize,
    },
    /// Closed parts without volume, within rounding.
    FlatParts {
        /// How many.
        parts: usize,
    },
    /// Parts wound consistently but the wrong way: a solid inwards, or a cavity outwards.
    InsideOutParts {
        /// How many.
        parts: usize,
    },
    /// Too many parts lie over one another: which is inside which was not found out within
    /// [`TriangleMesh::MAX_CROSSINGS`](crate::TriangleMesh::MAX_CROSSINGS).
    TooManyCrossings,
}

impl MeshDefect {
    /// What [`TriangleMesh::repaired`](crate::TriangleMesh::repaired) does about it, if anything
    /// can be done.
    #[must_use]
    pub fn repair(&self) -> Option<MeshRepair> {
        match *self {
            Self::DegenerateTriangles { triangles } => Some(MeshRepair::DropDegenerate { triangles }),
            Self::DuplicateTriangles { triangles } => Some(MeshRepair::DropDuplicates { triangles }),
            Self::Cracks { vertices, .. } => Some(MeshRepair::WeldNear { vertices }),
            Self::ReversedEdges { edges } => Some(MeshRepair::FlipTriangles { edges }),
            Self::InsideOutParts { parts } => Some(MeshRepair::FlipParts { parts }),
            _ => None,
        }
    }

    /// Whether it changes neither volume nor inertia, so that
    /// [`TriangleMesh::solid`](crate::TriangleMesh::solid) passes over it.
    #[must_use]
    pub fn is_harmless(&self) -> bool {
        matches!(self, Self::DegenerateTriangles { .. } | Self::CollinearTriangles { .. })
    }

    /// Whether it keeps the mesh from being a solid even after repairs.
    #[must_use]
    pub fn is_fatal(&self) -> bool {
        !self.is_harmless() && self.repair().is_none()
    }
}

impl fmt::Display for MeshDefect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DegenerateTriangles { triangles } => {
                write!(f, "{} with two corners at one place", counted(triangles, "triangle"))
            }
            Self::CollinearTriangles { triangles } => {
                write!(f, "{} with all corners on one line", counted(triangles, "triangle"))
            }
            Self::DuplicateTriangles { triangles } => write!(f, "{}", counted(triangles, "duplicate triangle")),
            Self::Cracks { edges, vertices } => {
                let edges = counted(edges, "open edge");
                write!(f, "{edges} at cracks, which close if {} welded", are(vertices, "near-duplicate vertex"))
            }
            Self::OpenEdges { edges } => write!(f, "{}", counted(edges, "open edge")),
            Self::OverfullEdges { edges } => write!(f, "{} with more than two triangles", counted(edges, "edge")),
            Self::ReversedEdges { edges } => write!(f, "{} between triangles wound oppositely", counted(edges, "edge")),
            Self::OneSidedParts { parts } => write!(f, "{} with one side only", counted(parts, "part")),
            Self::FlatParts { parts } => write!(f, "{} without volume", counted(parts, "part")),
            Self::InsideOutParts { parts } => write!(f, "{} inside out", counted(parts, "part")),
            Self::TooManyCrossings => write!(f, "too many parts over one another to find out which is inside which"),
        }
    }
}

/// One kind of repair of a mesh, with how often.
///
/// ```
/// use tumble_math::{MeshDefect, MeshRepair};
/// let repair = MeshDefect::InsideOutParts { parts: 1 }.repair();
/// assert_eq!(repair, Some(MeshRepair::FlipParts { parts: 1 }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshRepair {
    /// Triangles with two corners at the same place are left out.
    DropDegenerate {
        /// How many.
        triangles: usize,
    },
    /// Of triangles with the same corners the first is kept.
    DropDuplicates {
        /// How many go.
        triangles: usize,
    },
    /// Vertices nearly at the same place are made one.
    WeldNear {
        /// How many go.
        vertices: usize,
    },
    /// Triangles are turned round until neighbours agree.
    FlipTriangles {
        /// Across how many edges they disagreed.
        edges: usize,
    },
    /// Whole parts are turned round: solids outwards, cavities inwards.
    FlipParts {
        /// How many.
        parts: usize,
    },
}

impl fmt::Display for MeshRepair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DropDegenerate { triangles } => {
                write!(f, "{} with two corners at one place left out", counted(triangles, "triangle"))
            }
            Self::DropDuplicates { triangles } => write!(f, "{} left out", counted(triangles, "duplicate triangle")),
            Self::WeldNear { vertices } => write!(f, "{} welded", counted(vertices, "near-duplicate vertex")),
            Self::FlipTriangles { edges } => {
                write!(f, "triangles turned round until they agreed across {}", counted(edges, "edge"))
            }
            Self::FlipParts { parts } => write!(f, "{} turned outside out", counted(parts, "part")),
        }
    }
}

/// `1 part`, `2 parts`, `2 vertices`.
fn counted(count: usize, noun: &str) -> String {
    match (count, noun.strip_suffix("vertex")) {
        (1, _) => format!("1 {noun}"),
        (_, Some(stem)) => format!("{count} {stem}vertices"),
        (_, None) => format!("{count} {noun}s"),
    }
}

/// `1 part is`, `2 parts are`.
fn are(count: usize, noun: &str) -> String {
    format!("{} {}", counted(count, noun), if count == 1 { "is" } else { "are" })
}
