//! A buffer on the graphics card for what is new in every picture.

use macroquad::miniquad::{
    BufferId, BufferLayout, BufferSource, BufferType, BufferUsage, RenderingBackend, VertexStep,
};

/// A vertex buffer that grows.
#[derive(Debug, Default)]
pub(super) struct Instances {
    buffer: Option<(BufferId, usize)>,
}

impl Instances {
    /// The layout of a buffer of vertices and one of these.
    pub(super) fn layout() -> [BufferLayout; 2] {
        [BufferLayout::default(), BufferLayout { step_func: VertexStep::PerInstance, ..BufferLayout::default() }]
    }

    /// The buffer with these instances at its beginning.
    pub(super) fn write<T>(&mut self, context: &mut dyn RenderingBackend, instances: &[T]) -> BufferId {
        let buffer = match self.buffer {
            Some((buffer, room)) if room >= instances.len() => buffer,
            outgrown => {
                if let Some((buffer, _)) = outgrown {
                    context.delete_buffer(buffer);
                }
                let room = instances.len().next_power_of_two();
                let empty = BufferSource::empty::<T>(room);
                let buffer = context.new_buffer(BufferType::VertexBuffer, BufferUsage::Stream, empty);
                self.buffer = Some((buffer, room));
                buffer
            }
        };
        context.buffer_update(buffer, BufferSource::slice(instances));
        buffer
    }

    pub(super) fn delete(self, context: &mut dyn RenderingBackend) {
        if let Some((buffer, _)) = self.buffer {
            context.delete_buffer(buffer);
        }
    }
}
