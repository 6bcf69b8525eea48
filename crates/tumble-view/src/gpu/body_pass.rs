//! The body pass: surfaces in the light of the sun, where nothing shades them.

use macroquad::miniquad::{
    Comparison, Pipeline, PipelineParams, RenderingBackend, TextureId, UniformType, UniformsSource,
};

use super::meshes::{Drawn, Meshes};
use super::quad::blended;
use super::{GpuError, Picture, shader};
use crate::convert::single3;
use crate::sunlight::{MAP_SIZE, ShadowFrame};

const SHADER: [&str; 2] = [include_str!("../shaders/body.vert"), include_str!("../shaders/body.frag")];
/// Tangent of the angle at which the radius of the sun is seen. It is larger than in the sky, so
/// that edges of shadows are soft also near what casts them.
const SUN_RADIUS: f64 = 0.04;
/// Surfaces nearer to each other than this, about a pixel, do not shade each other, in units of the
/// view: depths of 16 bits, which pictures have, cannot tell them apart.
const SLACK: f64 = 1.5e-3;

#[repr(C)]
struct Uniforms {
    projection: [f32; 16],
    to_map: [f32; 16],
    sun: [f32; 3],
    across: [f32; 3],
    above: [f32; 3],
    sky: [f32; 3],
    towards: [f32; 3],
    texel: f32,
    steepness: f32,
    softness: f32,
    slack: f32,
}

/// How bodies are drawn.
#[derive(Debug)]
pub(super) struct BodyPass {
    pipeline: Pipeline,
}

impl BodyPass {
    pub(super) fn new(context: &mut dyn RenderingBackend) -> Result<Self, GpuError> {
        let uniforms = [
            ("projection", UniformType::Mat4),
            ("to_map", UniformType::Mat4),
            ("sun", UniformType::Float3),
            ("across", UniformType::Float3),
            ("above", UniformType::Float3),
            ("sky", UniformType::Float3),
            ("towards", UniformType::Float3),
            ("texel", UniformType::Float1),
            ("steepness", UniformType::Float1),
            ("softness", UniformType::Float1),
            ("slack", UniformType::Float1),
        ];
        let shader = shader(context, SHADER, &["shadows"], &uniforms)?;
        let (buffers, attributes) = Meshes::layout();
        let params = PipelineParams { depth_test: Comparison::LessOrEqual, depth_write: true, ..blended() };
        Ok(Self { pipeline: context.new_pipeline(&buffers, &attributes, shader, params) })
    }

    pub(super) fn draw(
        &self,
        context: &mut dyn RenderingBackend,
        picture: &Picture<'_>,
        meshes: &Meshes,
        shadows: TextureId,
    ) {
        let view = picture.view;
        let frame = picture.shadows.unwrap_or_else(|| ShadowFrame::nowhere(picture.sun));
        let uniforms = Uniforms {
            projection: view.matrix.as_mat4().to_cols_array(),
            to_map: frame.matrix.as_mat4().to_cols_array(),
            sun: single3(frame.sun.towards),
            across: single3(frame.sun.across),
            above: single3(frame.sun.above),
            sky: picture.up,
            towards: single3(view.towards),
            texel: 1.0 / MAP_SIZE as f32,
            steepness: (1.0 / frame.depth) as f32,
            softness: (SUN_RADIUS * frame.depth) as f32,
            slack: (SLACK * frame.unit) as f32,
        };
        context.apply_pipeline(&self.pipeline);
        context.apply_uniforms(UniformsSource::table(&uniforms));
        meshes.draw(context, Drawn::All, &[shadows]);
    }
}
