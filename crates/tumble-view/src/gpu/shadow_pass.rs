//! The shadow pass: how far from the sun the first surface is, as a picture from there.

use macroquad::miniquad::{
    Comparison, CullFace, FilterMode, PassAction, Pipeline, PipelineParams, RenderPass, RenderingBackend,
    TextureFormat, TextureId, TextureParams, UniformType, UniformsSource,
};

use super::meshes::{Drawn, Meshes};
use super::{GpuError, shader};
use crate::sunlight::{MAP_SIZE, ShadowFrame};

const SHADER: [&str; 2] = [include_str!("../shaders/shadow.vert"), include_str!("../shaders/shadow.frag")];

#[repr(C)]
struct Uniforms {
    to_map: [f32; 16],
}

/// The shadow map.
#[derive(Debug)]
pub(super) struct ShadowPass {
    pipeline: Pipeline,
    pass: RenderPass,
    pub(super) map: TextureId,
}

impl ShadowPass {
    pub(super) fn new(context: &mut dyn RenderingBackend) -> Result<Self, GpuError> {
        let shader = shader(context, SHADER, &[], &[("to_map", UniformType::Mat4)])?;
        let (buffers, attributes) = Meshes::layout();
        let params = PipelineParams {
            depth_test: Comparison::LessOrEqual,
            depth_write: true,
            // Of a closed surface the side towards the sun shades all that the other side does.
            cull_face: CullFace::Back,
            color_write: (false, false, false, false),
            ..PipelineParams::default()
        };
        let pipeline = context.new_pipeline(&buffers, &attributes, shader, params);
        // OpenGL 3 takes no pass without colours; depths are not to be mixed.
        let [colors, map] = [TextureFormat::RGBA8, TextureFormat::Depth].map(|format| {
            let filter = FilterMode::Nearest;
            let params = TextureParams {
                format,
                width: MAP_SIZE,
                height: MAP_SIZE,
                min_filter: filter,
                mag_filter: filter,
                ..TextureParams::default()
            };
            context.new_render_texture(params)
        });
        Ok(Self { pipeline, pass: context.new_render_pass(colors, Some(map)), map })
    }

    pub(super) fn draw(&self, context: &mut dyn RenderingBackend, frame: &ShadowFrame, meshes: &Meshes) {
        context.begin_pass(Some(self.pass), PassAction::Clear { color: None, depth: Some(1.0), stencil: None });
        context.apply_pipeline(&self.pipeline);
        context.apply_uniforms(UniformsSource::table(&Uniforms { to_map: frame.matrix.as_mat4().to_cols_array() }));
        meshes.draw(context, Drawn::CastingShadows, &[]);
        context.end_render_pass();
    }
}
