//! The body pass: instanced draw calls, one for each surface mesh.

use macroquad::miniquad::{
    Bindings, BufferId, BufferLayout, BufferSource, BufferType, BufferUsage, Comparison, Pipeline, PipelineParams,
    RenderingBackend, UniformType, UniformsSource, VertexAttribute, VertexFormat, VertexStep,
};
use tumble_import::Tessellation;
use tumble_record::SurfaceSet;

use super::instances::Instances;
use super::quad::blended;
use super::{GpuError, Picture, shader};
use crate::convert::single3;

const SHADER: [&str; 2] = [include_str!("../shaders/body.vert"), include_str!("../shaders/body.frag")];

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

#[repr(C)]
struct Uniforms {
    projection: [f32; 16],
    sun: [f32; 3],
    sky: [f32; 3],
    towards: [f32; 3],
}

/// Surfaces with all bodies that have them, in a call each.
#[derive(Debug)]
pub(super) struct BodyPass {
    pipeline: Pipeline,
    meshes: Vec<Mesh>,
}

#[derive(Debug)]
struct Mesh {
    vertices: BufferId,
    indices: BufferId,
    corners: i32,
    instances: Instances,
}

impl BodyPass {
    pub(super) fn new(context: &mut dyn RenderingBackend, surfaces: &SurfaceSet) -> Result<Self, GpuError> {
        let uniforms = [
            ("projection", UniformType::Mat4),
            ("sun", UniformType::Float3),
            ("sky", UniformType::Float3),
            ("towards", UniformType::Float3),
        ];
        let shader = shader(context, SHADER, &uniforms)?;
        let buffers =
            [BufferLayout::default(), BufferLayout { step_func: VertexStep::PerInstance, ..BufferLayout::default() }];
        let attributes = [
            VertexAttribute::with_buffer("corner", VertexFormat::Float3, 0),
            VertexAttribute::with_buffer("normal", VertexFormat::Float3, 0),
            VertexAttribute::with_buffer("place", VertexFormat::Float3, 1),
            VertexAttribute::with_buffer("turn", VertexFormat::Float4, 1),
            VertexAttribute::with_buffer("size", VertexFormat::Float3, 1),
            VertexAttribute::with_buffer("paint", VertexFormat::Float4, 1),
        ];
        let params = PipelineParams { depth_test: Comparison::LessOrEqual, depth_write: true, ..blended() };
        let pipeline = context.new_pipeline(&buffers, &attributes, shader, params);
        let meshes = surfaces.tessellations().map(|surface| Mesh::new(context, &surface)).collect();
        Ok(Self { pipeline, meshes })
    }

    /// Goes on with other surfaces, and gives up the memory of those before.
    pub(super) fn replace(&mut self, context: &mut dyn RenderingBackend, surfaces: &SurfaceSet) {
        for mesh in self.meshes.drain(..) {
            context.delete_buffer(mesh.vertices);
            context.delete_buffer(mesh.indices);
            mesh.instances.delete(context);
        }
        self.meshes = surfaces.tessellations().map(|surface| Mesh::new(context, &surface)).collect();
    }

    pub(super) fn draw(&mut self, context: &mut dyn RenderingBackend, picture: &Picture<'_>) {
        let view = picture.view;
        // The sun stands behind the viewer's left shoulder.
        let sun = (0.62 * view.towards - 0.42 * view.right + 0.66 * view.above).normalize();
        let uniforms = Uniforms {
            projection: view.matrix.as_mat4().to_cols_array(),
            sun: single3(sun),
            sky: picture.up,
            towards: single3(view.towards),
        };
        context.apply_pipeline(&self.pipeline);
        context.apply_uniforms(UniformsSource::table(&uniforms));
        // The last come first: ground, which fades into what is there already.
        for (mesh, instances) in self.meshes.iter_mut().zip(picture.bodies).rev() {
            if instances.is_empty() || mesh.corners == 0 {
                continue;
            }
            let buffer = mesh.instances.write(context, instances);
            context.apply_bindings(&Bindings {
                vertex_buffers: vec![mesh.vertices, buffer],
                index_buffer: mesh.indices,
                images: Vec::new(),
            });
            context.draw(0, mesh.corners, i32::try_from(instances.len()).unwrap_or(i32::MAX));
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
        }
    }
}
