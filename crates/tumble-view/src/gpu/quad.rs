//! What several passes draw with: a quad of two triangles, and blending over what is there.

use macroquad::miniquad::{
    BlendFactor, BlendState, BlendValue, BufferId, BufferSource, BufferType, BufferUsage, Equation, PipelineParams,
    RenderingBackend,
};

/// Numbers of indices that a call draws.
pub(super) const INDICES: i32 = 6;
/// The corners of a square from -1 to 1.
pub(super) const SQUARE: [[f32; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// The buffers of a quad.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quad {
    pub(super) corners: BufferId,
    pub(super) indices: BufferId,
}

impl Quad {
    /// With these corners, in order around it.
    pub(super) fn new(context: &mut dyn RenderingBackend, corners: &[[f32; 2]; 4]) -> Self {
        let indices: [u16; INDICES as usize] = [0, 1, 2, 0, 2, 3];
        Self {
            corners: context.new_buffer(BufferType::VertexBuffer, BufferUsage::Immutable, BufferSource::slice(corners)),
            indices: context.new_buffer(BufferType::IndexBuffer, BufferUsage::Immutable, BufferSource::slice(&indices)),
        }
    }
}

/// Colours over what is there, by their opacity. The picture itself stays opaque.
pub(super) fn blended() -> PipelineParams {
    let over = BlendState::new(
        Equation::Add,
        BlendFactor::Value(BlendValue::SourceAlpha),
        BlendFactor::OneMinusValue(BlendValue::SourceAlpha),
    );
    let opaque = BlendState::new(Equation::Add, BlendFactor::Zero, BlendFactor::One);
    PipelineParams { color_blend: Some(over), alpha_blend: Some(opaque), ..PipelineParams::default() }
}
