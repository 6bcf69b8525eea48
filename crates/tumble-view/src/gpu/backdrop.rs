//! The background pass: a vertical colour gradient or a plain colour.

use macroquad::miniquad::{
    Bindings, BufferLayout, Pipeline, PipelineParams, RenderingBackend, UniformType, UniformsSource, VertexAttribute,
    VertexFormat,
};

use super::quad::{INDICES, Quad, SQUARE};
use super::{Background, GpuError, shader};

const SHADER: [&str; 2] = [include_str!("../shaders/backdrop.vert"), include_str!("../shaders/backdrop.frag")];
const BELOW: [f32; 3] = [0.055, 0.065, 0.085];
const ABOVE: [f32; 3] = [0.150, 0.175, 0.220];
const PLAIN: [f32; 3] = [0.085, 0.100, 0.130];

/// The colours behind everything.
#[derive(Debug)]
pub(super) struct Backdrop {
    pipeline: Pipeline,
    bindings: Bindings,
}

#[repr(C)]
struct Uniforms {
    below: [f32; 3],
    above: [f32; 3],
}

impl Backdrop {
    pub(super) fn new(context: &mut dyn RenderingBackend) -> Result<Self, GpuError> {
        let uniforms = [("below", UniformType::Float3), ("above", UniformType::Float3)];
        let shader = shader(context, SHADER, &[], &uniforms)?;
        let Quad { corners, indices } = Quad::new(context, &SQUARE);
        let attributes = [VertexAttribute::new("corner", VertexFormat::Float2)];
        let pipeline = context.new_pipeline(&[BufferLayout::default()], &attributes, shader, PipelineParams::default());
        Ok(Self {
            pipeline,
            bindings: Bindings { vertex_buffers: vec![corners], index_buffer: indices, images: Vec::new() },
        })
    }

    pub(super) fn draw(&self, context: &mut dyn RenderingBackend, background: Background) {
        let uniforms = match background {
            Background::Gradient => Uniforms { below: BELOW, above: ABOVE },
            Background::Plain => Uniforms { below: PLAIN, above: PLAIN },
        };
        context.apply_pipeline(&self.pipeline);
        context.apply_bindings(&self.bindings);
        context.apply_uniforms(UniformsSource::table(&uniforms));
        context.draw(0, INDICES, 1);
    }
}
