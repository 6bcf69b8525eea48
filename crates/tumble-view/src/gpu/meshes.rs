//! Surfaces on the graphics card, with all bodies that have them.

use macroquad::miniquad::{
    Bindings, BufferId, BufferLayout, BufferSource, BufferType, BufferUsage, RenderingBackend, TextureId,
    VertexAttribute, VertexFormat,
};
use tumble_import::Tessellation;
use tumble_record::SurfaceSet;

use super::instances::Instances;
use crate::convert::single3;

/// A body on the graphics card. Lengths are in units of the view.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct BodyInstance {
    pub(crate) place: [f32; 3],
    /// A quaternion: x, y, z, w.
    pub(crate) turn: [f32; 4],
    pub(crate) size: [f32; 3],
    /// Red, green, blue in linear light, and how much it is lit up; below zero, the distance at
    /// which it is no longer seen, with its sign.
    pub(crate) paint: [f32; 4],
}

#[repr(C)]
struct Vertex {
    corner: [f32; 3],
    normal: [f32; 3],
}

/// A surface, and the bodies of the picture that have it.
#[derive(Debug)]
struct Mesh {
    vertices: BufferId,
    indices: BufferId,
    corners: i32,
    instances: Instances,
    /// The bodies of the picture, if there are any to be seen.
    written: Option<Written>,
}

#[derive(Clone, Copy, Debug)]
struct Written {
    bodies: BufferId,
    count: i32,
    /// Infinite ground does not.
    casts_shadow: bool,
}

/// Which bodies are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawn {
    All,
    CastingShadows,
}

/// All surfaces of a scene.
#[derive(Debug)]
pub(super) struct Meshes(Vec<Mesh>);

impl Meshes {
    pub(super) fn new(context: &mut dyn RenderingBackend, surfaces: &SurfaceSet) -> Self {
        Self(surfaces.tessellations().map(|surface| Mesh::new(context, &surface)).collect())
    }

    /// The buffers and attributes of a pipeline that draws them.
    pub(super) fn layout() -> ([BufferLayout; 2], [VertexAttribute; 6]) {
        let attributes = [
            VertexAttribute::with_buffer("corner", VertexFormat::Float3, 0),
            VertexAttribute::with_buffer("normal", VertexFormat::Float3, 0),
            VertexAttribute::with_buffer("place", VertexFormat::Float3, 1),
            VertexAttribute::with_buffer("turn", VertexFormat::Float4, 1),
            VertexAttribute::with_buffer("size", VertexFormat::Float3, 1),
            VertexAttribute::with_buffer("paint", VertexFormat::Float4, 1),
        ];
        (Instances::layout(), attributes)
    }

    /// Goes on with other surfaces, and gives up the memory of those before.
    pub(super) fn replace(&mut self, context: &mut dyn RenderingBackend, surfaces: &SurfaceSet) {
        for mesh in self.0.drain(..) {
            context.delete_buffer(mesh.vertices);
            context.delete_buffer(mesh.indices);
            mesh.instances.delete(context);
        }
        *self = Self::new(context, surfaces);
    }

    /// Takes the bodies of a picture, by their surface.
    pub(super) fn write(&mut self, context: &mut dyn RenderingBackend, bodies: &[Vec<BodyInstance>]) {
        for (mesh, instances) in self.0.iter_mut().zip(bodies) {
            let count = i32::try_from(instances.len()).unwrap_or(i32::MAX);
            let is_seen = count > 0 && mesh.corners > 0;
            let casts_shadow = instances.first().is_some_and(|body| body.paint[3] >= 0.0);
            mesh.written =
                is_seen.then(|| Written { bodies: mesh.instances.write(context, instances), count, casts_shadow });
        }
    }

    /// Draws the bodies with the pipeline that is applied, in a call for each surface.
    pub(super) fn draw(&self, context: &mut dyn RenderingBackend, drawn: Drawn, images: &[TextureId]) {
        // The last come first: ground, which fades into what is there already.
        for mesh in self.0.iter().rev() {
            let written = mesh.written.filter(|written| drawn == Drawn::All || written.casts_shadow);
            let Some(Written { bodies, count, .. }) = written else { continue };
            context.apply_bindings(&Bindings {
                vertex_buffers: vec![mesh.vertices, bodies],
                index_buffer: mesh.indices,
                images: images.to_vec(),
            });
            context.draw(0, mesh.corners, count);
        }
    }
}

impl Mesh {
    fn new(context: &mut dyn RenderingBackend, surface: &Tessellation) -> Self {
        let vertex = |(&corner, &normal)| Vertex { corner: single3(corner), normal: single3(normal) };
        let vertices: Vec<Vertex> = surface.positions.iter().zip(&surface.normals).map(vertex).collect();
        let indices: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
        let corners = i32::try_from(indices.len()).unwrap_or(0);
        Self {
            vertices: context.new_buffer(
                BufferType::VertexBuffer,
                BufferUsage::Immutable,
                BufferSource::slice(&vertices),
            ),
            indices: context.new_buffer(BufferType::IndexBuffer, BufferUsage::Immutable, BufferSource::slice(&indices)),
            corners,
            instances: Instances::default(),
            written: None,
        }
    }
}
