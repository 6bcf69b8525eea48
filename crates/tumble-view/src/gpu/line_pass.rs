//! The line pass: lines as viewer-facing strips, and marks that show through bodies when hidden.

use macroquad::miniquad::{
    Bindings, BufferId, Comparison, Pipeline, PipelineParams, RenderingBackend, UniformType, UniformsSource,
    VertexAttribute, VertexFormat,
};

use super::instances::Instances;
use super::quad::{INDICES, Quad, blended};
use super::{GpuError, Picture, shader};
use crate::camera::View;
use crate::convert::single3;
use crate::lines::Line;

const SHADER: [&str; 2] = [include_str!("../shaders/line.vert"), include_str!("../shaders/line.frag")];
/// How much is seen of a mark that is inside of a body or behind one.
const THROUGH: f32 = 0.45;
/// Lines begin at this part of the camera's distance, a little behind where everything else does.
const NEAR: f32 = 0.021;

/// A line on the graphics card, as a strip that faces the viewer. Lengths are in units of the view,
/// widths in points.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct LineInstance {
    start: [f32; 3],
    end: [f32; 3],
    start_color: [f32; 4],
    end_color: [f32; 4],
    width: f32,
}

#[repr(C)]
struct Uniforms {
    projection: [f32; 16],
    viewport: [f32; 2],
    near: f32,
    fade: f32,
}

/// All lines in two calls.
#[derive(Debug)]
pub(super) struct LinePass {
    /// Hidden by surfaces, and on top of them.
    hidden: Pipeline,
    on_top: Pipeline,
    strip: Quad,
    scenery: Instances,
    marks: Instances,
}

impl LinePass {
    pub(super) fn new(context: &mut dyn RenderingBackend) -> Result<Self, GpuError> {
        let uniforms = [
            ("projection", UniformType::Mat4),
            ("viewport", UniformType::Float2),
            ("near", UniformType::Float1),
            ("fade", UniformType::Float1),
        ];
        let shader = shader(context, SHADER, &[], &uniforms)?;
        let buffers = Instances::layout();
        let attributes = [
            VertexAttribute::with_buffer("corner", VertexFormat::Float2, 0),
            VertexAttribute::with_buffer("start", VertexFormat::Float3, 1),
            VertexAttribute::with_buffer("end", VertexFormat::Float3, 1),
            VertexAttribute::with_buffer("start_color", VertexFormat::Float4, 1),
            VertexAttribute::with_buffer("end_color", VertexFormat::Float4, 1),
            VertexAttribute::with_buffer("width", VertexFormat::Float1, 1),
        ];
        let on_top = blended();
        let hidden = PipelineParams { depth_test: Comparison::LessOrEqual, depth_write: true, ..on_top };
        Ok(Self {
            hidden: context.new_pipeline(&buffers, &attributes, shader, hidden),
            on_top: context.new_pipeline(&buffers, &attributes, shader, on_top),
            strip: Quad::new(context, &[[0.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, 1.0]]),
            scenery: Instances::default(),
            marks: Instances::default(),
        })
    }

    pub(super) fn draw(&mut self, context: &mut dyn RenderingBackend, picture: &Picture<'_>) {
        let scenery = instances(picture.view, picture.scenery);
        let marks = instances(picture.view, picture.marks);
        let (hidden, on_top) = (self.hidden, self.on_top);
        if !scenery.is_empty() {
            let buffer = self.scenery.write(context, &scenery);
            self.draw_with(context, picture.view, hidden, 1.0, (buffer, scenery.len()));
        }
        if !marks.is_empty() {
            let buffer = self.marks.write(context, &marks);
            self.draw_with(context, picture.view, on_top, THROUGH, (buffer, marks.len()));
            self.draw_with(context, picture.view, hidden, 1.0, (buffer, marks.len()));
        }
    }

    fn draw_with(
        &self,
        context: &mut dyn RenderingBackend,
        view: &View,
        pipeline: Pipeline,
        fade: f32,
        (buffer, count): (BufferId, usize),
    ) {
        let uniforms = Uniforms {
            projection: view.matrix.as_mat4().to_cols_array(),
            viewport: view.size.as_vec2().to_array(),
            near: NEAR,
            fade,
        };
        context.apply_pipeline(&pipeline);
        context.apply_bindings(&Bindings {
            vertex_buffers: vec![self.strip.corners, buffer],
            index_buffer: self.strip.indices,
            images: Vec::new(),
        });
        context.apply_uniforms(UniformsSource::table(&uniforms));
        context.draw(0, INDICES, i32::try_from(count).unwrap_or(i32::MAX));
    }
}

fn instances(view: &View, lines: &[Line]) -> Vec<LineInstance> {
    let instance = |line: &Line| LineInstance {
        start: single3(view.relative(line.from)),
        end: single3(view.relative(line.to)),
        start_color: line.from_color,
        end_color: line.to_color,
        width: line.width,
    };
    lines.iter().map(instance).collect()
}
