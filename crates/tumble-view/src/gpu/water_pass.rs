//! The water pass: level surfaces through which one sees, in front of all that is behind them.

use macroquad::miniquad::{
    Bindings, BufferLayout, Comparison, Pipeline, PipelineParams, RenderingBackend, UniformType, UniformsSource,
    VertexAttribute, VertexFormat,
};
use tumble::glam::DVec3;

use super::quad::{INDICES, Quad, SQUARE, blended};
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
    square: Quad,
}

impl WaterPass {
    pub(super) fn new(context: &mut dyn RenderingBackend) -> Result<Self, GpuError> {
        let uniforms = [
            ("projection", UniformType::Mat4),
            ("middle", UniformType::Float3),
            ("along", UniformType::Float3),
            ("across", UniformType::Float3),
        ];
        let shader = shader(context, SHADER, &[], &uniforms)?;
        let params = PipelineParams { depth_test: Comparison::LessOrEqual, ..blended() };
        let attributes = [VertexAttribute::new("corner", VertexFormat::Float2)];
        Ok(Self {
            pipeline: context.new_pipeline(&[BufferLayout::default()], &attributes, shader, params),
            square: Quad::new(context, &SQUARE),
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
                vertex_buffers: vec![self.square.corners],
                index_buffer: self.square.indices,
                images: Vec::new(),
            });
            context.apply_uniforms(UniformsSource::table(&Uniforms {
                projection: view.matrix.as_mat4().to_cols_array(),
                middle: single3(view.relative(water.middle)),
                along: single3(along * far),
                across: single3(across * far),
            }));
            context.draw(0, INDICES, 1);
        }
    }
}
