//! The water pass: level surfaces through which one sees, in front of all that is behind them.

use macroquad::miniquad::{
    Bindings, BlendFactor, BlendState, BlendValue, BufferId, BufferLayout, BufferSource, BufferType, BufferUsage,
    Comparison, Equation, Pipeline, PipelineParams, RenderingBackend, UniformType, UniformsSource, VertexAttribute,
    VertexFormat,
};
use tumble::glam::DVec3;

use super::{GpuError, Picture, shader};
use crate::convert::single3;

const SHADER: [&str; 2] = [include_str!("../shaders/water.vert"), include_str!("../shaders/water.frag")];

/// A surface of water, of which a part is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Water {
    /// Middle of the part \[m\].
    pub(crate) middle: DVec3,
    /// Up, of unit length.
    pub(crate) normal: DVec3,
    /// How far the part is seen \[m\].
    pub(crate) radius: f64,
}

#[repr(C)]
struct Uniforms {
    projection: [f32; 16],
    middle: [f32; 3],
    along: [f32; 3],
    across: [f32; 3],
}

/// Each surface in a call.
#[derive(Debug)]
pub(super) struct WaterPass {
    pipeline: Pipeline,
    corners: BufferId,
    indices: BufferId,
}

impl WaterPass {
    pub(super) fn new(context: &mut dyn RenderingBackend) -> Result<Self, GpuError> {
        let uniforms = [
            ("projection", UniformType::Mat4),
            ("middle", UniformType::Float3),
            ("along", UniformType::Float3),
            ("across", UniformType::Float3),
        ];
        let shader = shader(context, SHADER, &uniforms)?;
        let over = BlendState::new(
            Equation::Add,
            BlendFactor::Value(BlendValue::SourceAlpha),
            BlendFactor::OneMinusValue(BlendValue::SourceAlpha),
        );
        // The picture itself stays opaque.
        let opaque = BlendState::new(Equation::Add, BlendFactor::Zero, BlendFactor::One);
        let params = PipelineParams {
            depth_test: Comparison::LessOrEqual,
            color_blend: Some(over),
            alpha_blend: Some(opaque),
            ..PipelineParams::default()
        };
        let attributes = [VertexAttribute::new("corner", VertexFormat::Float2)];
        let corners: [[f32; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let indices: [u16; 6] = [0, 1, 2, 0, 2, 3];
        Ok(Self {
            pipeline: context.new_pipeline(&[BufferLayout::default()], &attributes, shader, params),
            corners: context.new_buffer(
                BufferType::VertexBuffer,
                BufferUsage::Immutable,
                BufferSource::slice(&corners),
            ),
            indices: context.new_buffer(BufferType::IndexBuffer, BufferUsage::Immutable, BufferSource::slice(&indices)),
        })
    }

    pub(super) fn draw(&self, context: &mut dyn RenderingBackend, picture: &Picture<'_>) {
        let view = picture.view;
        for water in picture.water {
            let along = water.normal.any_orthonormal_vector();
            let across = water.normal.cross(along);
            let far = water.radius / view.unit;
            context.apply_pipeline(&self.pipeline);
            context.apply_bindings(&Bindings {
                vertex_buffers: vec![self.corners],
                index_buffer: self.indices,
                images: Vec::new(),
            });
            context.apply_uniforms(UniformsSource::table(&Uniforms {
                projection: view.matrix.as_mat4().to_cols_array(),
                middle: single3(view.relative(water.middle)),
                along: single3(along * far),
                across: single3(across * far),
            }));
            context.draw(0, 6, 1);
        }
    }
}
