//! Triangle meshes: what is wrong with them, the solid they bound, its exact mass properties.
//!
//! A mesh is analysed in stages, a file each: vertices at one place (`coincidence`), the triangles
//! left over them (`surface`), their edges (`edges`), what hangs together (`parts`), what lies
//! within what (`nesting`). `audit` counts, `solid_mesh` repairs and refuses. `convex_hull` makes
//! meshes that need none of it.

mod audit;
mod connected_components;
mod convex_hull;
mod defect;
mod edges;
mod grid_point;
mod hull_error;
mod local_frame;
mod mesh_analysis;
mod mesh_error;
mod moments;
mod nesting;
mod ray_crossings;
mod solid_mesh;
mod surface;
mod triangle_mesh;
mod varying_density;
mod vertex_weld;

pub use audit::MeshAudit;
pub use convex_hull::convex_hull;
pub use defect::{MeshDefect, MeshRepair};
pub use hull_error::HullError;
pub use mesh_error::MeshError;
pub use solid_mesh::SolidMesh;
pub use triangle_mesh::TriangleMesh;
