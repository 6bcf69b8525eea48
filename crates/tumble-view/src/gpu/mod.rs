//! Drawing: each kind of thing with a pipeline of its own, instanced.

mod backdrop;
mod body_pass;
mod context;
mod instances;
mod line_pass;
mod meshes;
mod quad;
mod shadow_pass;
mod water_pass;

use macroquad::miniquad::{PassAction, RenderPass, RenderingBackend};

use crate::bodies::Bodies;
use crate::camera::View;
use crate::lines::Line;
use crate::sunlight::{ShadowFrame, Sun};

pub(crate) use context::Gpu;
pub(crate) use meshes::BodyInstance;
pub(crate) use water_pass::Water;

/// What is in a picture, but for text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Picture<'a> {
    pub(crate) view: &'a View,
    /// Towards the sky.
    pub(crate) up: [f32; 3],
    pub(crate) sun: Sun,
    /// The shadow map, if there are shadows.
    pub(crate) shadows: Option<ShadowFrame>,
    pub(crate) background: Background,
    /// Bodies by their surface.
    pub(crate) bodies: &'a [Vec<BodyInstance>],
    /// Behind and in front of surfaces as they are.
    pub(crate) scenery: &'a [Line],
    /// Seen through surfaces too, but fainter.
    pub(crate) marks: &'a [Line],
    pub(crate) water: &'a [Water],
}

/// What is behind everything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Background {
    Gradient,
    /// One colour, of which an animation has little to store.
    Plain,
}

/// Pipelines and meshes.
#[derive(Debug)]
pub(crate) struct Renderer {
    backdrop: backdrop::Backdrop,
    meshes: meshes::Meshes,
    shadows: shadow_pass::ShadowPass,
    bodies: body_pass::BodyPass,
    lines: line_pass::LinePass,
    water: water_pass::WaterPass,
}

/// Why nothing can be drawn.
#[derive(Debug, thiserror::Error)]
pub(crate) enum GpuError {
    /// One of the shaders.
    #[error("the graphics driver refuses a shader: {0}")]
    Shader(String),
    /// Many bodies in one call.
    #[error("the graphics driver cannot draw many of one mesh at once (OpenGL 3 or OpenGL ES 3 is needed)")]
    NoInstancing,
}

impl Renderer {
    pub(crate) fn new(gpu: &mut Gpu, bodies: &Bodies) -> Result<Self, GpuError> {
        gpu.with(|context| {
            if !context.info().features.instancing {
                return Err(GpuError::NoInstancing);
            }
            Ok(Self {
                backdrop: backdrop::Backdrop::new(context)?,
                meshes: meshes::Meshes::new(context, &bodies.surfaces),
                shadows: shadow_pass::ShadowPass::new(context)?,
                bodies: body_pass::BodyPass::new(context)?,
                lines: line_pass::LinePass::new(context)?,
                water: water_pass::WaterPass::new(context)?,
            })
        })
    }

    /// Goes on with the bodies of another scene.
    pub(crate) fn replace_bodies(&mut self, gpu: &mut Gpu, bodies: &Bodies) {
        gpu.with(|context| self.meshes.replace(context, &bodies.surfaces));
    }

    /// Draws into a render pass, or into the window.
    pub(crate) fn draw(&mut self, gpu: &mut Gpu, pass: Option<RenderPass>, picture: &Picture<'_>) {
        gpu.with(|context| {
            self.meshes.write(context, picture.bodies);
            if let Some(frame) = &picture.shadows {
                self.shadows.draw(context, frame, &self.meshes);
            }
            context.begin_pass(
                pass,
                PassAction::Clear { color: Some((0.0, 0.0, 0.0, 1.0)), depth: Some(1.0), stencil: None },
            );
            self.backdrop.draw(context, picture.background);
            self.bodies.draw(context, picture, &self.meshes, self.shadows.map);
            self.lines.draw(context, picture);
            self.water.draw(context, picture);
            context.end_render_pass();
        });
    }
}

/// A shader of ours.
fn shader(
    context: &mut dyn RenderingBackend,
    [vertex, fragment]: [&str; 2],
    images: &[&str],
    uniforms: &[(&str, macroquad::miniquad::UniformType)],
) -> Result<macroquad::miniquad::ShaderId, GpuError> {
    use macroquad::miniquad::{ShaderMeta, ShaderSource, UniformBlockLayout, UniformDesc};
    let uniforms = uniforms.iter().map(|&(name, kind)| UniformDesc::new(name, kind)).collect();
    let meta = ShaderMeta {
        images: images.iter().map(|&name| name.to_owned()).collect(),
        uniforms: UniformBlockLayout { uniforms },
    };
    let made = context.new_shader(ShaderSource::Glsl { vertex, fragment }, meta);
    made.map_err(|error| GpuError::Shader(error.to_string().replace('\n', " ")))
}
