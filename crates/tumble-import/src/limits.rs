//! Sizes above which a file is refused, so that a slip of a finger does not fill a memory.

/// Largest file that is read \[bytes\].
pub const MAX_FILE_BYTES: u64 = 256 << 20;

/// Most parts of one compound.
pub const MAX_PARTS: usize = 100_000;

/// Most vertices of a mesh in a file, and most triangles.
pub const MAX_MESH: usize = 20_000_000;

/// Most points of a convex hull.
pub const MAX_HULL_POINTS: usize = 100_000;
