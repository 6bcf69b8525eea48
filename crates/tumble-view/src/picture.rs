//! Pictures that are not seen in the window.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use macroquad::camera::{Camera2D, set_camera, set_default_camera};
use macroquad::math::Rect;
use macroquad::texture::{RenderTarget, RenderTargetParams, render_target_ex};
use tumble_record::PendingFile;

use crate::failure::Failure;
use crate::gpu::{Background, Gpu, Renderer};
use crate::options::Size;
use crate::overlay::Writer;
use crate::viewport::{Canvas, Viewport};

/// Every point of a picture is the mean of this many pixels in either direction, so that edges are
/// smooth with any driver.
const FINER: u32 = 2;

/// Red, green and blue, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Image {
    pub(crate) size: Size,
    pub(crate) bytes: Vec<u8>,
}

/// Draws pictures of one size.
#[derive(Debug)]
pub(crate) struct Easel {
    target: RenderTarget,
    size: Size,
    background: Background,
}

impl Easel {
    pub(crate) fn new(size: Size, background: Background) -> Self {
        let params = RenderTargetParams { sample_count: 1, depth: true };
        Self { target: render_target_ex(FINER * size.width, FINER * size.height, params), size, background }
    }

    pub(crate) fn draw(
        &self,
        viewport: &mut Viewport,
        (gpu, renderer, writer): (&mut Gpu, &mut Renderer, &Writer),
        status: String,
    ) -> Image {
        let size = self.size.points();
        let canvas =
            Canvas { pass: Some(self.target.render_pass.raw_miniquad_id()), size, background: self.background };
        let overlay = viewport.draw(gpu, renderer, &canvas, status);
        let points = Rect::new(0.0, 0.0, size.x as f32, size.y as f32);
        set_camera(&Camera2D { render_target: Some(self.target.clone()), ..Camera2D::from_display_rect(points) });
        writer.draw(&overlay, size, FINER as f32);
        set_default_camera();
        let pixels = self.target.texture.get_texture_data();
        Image { size: self.size, bytes: averaged(&pixels.bytes, self.size) }
    }
}

/// The picture of which the card's pixels, with opacity and from the bottom row up, are the finer
/// one.
fn averaged(finer: &[u8], size: Size) -> Vec<u8> {
    let [width, height, finer_by] = [size.width, size.height, FINER].map(|edge| edge as usize);
    let row_bytes = 4 * finer_by * width;
    let mut bytes = Vec::with_capacity(3 * width * height);
    for rows in finer.chunks_exact(finer_by * row_bytes).rev() {
        for x in 0..width {
            for part in 0..3 {
                let row = |row: &[u8]| -> u32 {
                    let pixels = row.chunks_exact(4).skip(finer_by * x).take(finer_by);
                    pixels.filter_map(|pixel| pixel.get(part)).map(|&byte| u32::from(byte)).sum()
                };
                let sum: u32 = rows.chunks_exact(row_bytes).map(row).sum();
                bytes.push(((sum + FINER * FINER / 2) / (FINER * FINER)) as u8);
            }
        }
    }
    bytes
}

/// A file that is open before there is anything to write, so that one that cannot be written costs
/// no run.
#[derive(Debug)]
pub(crate) struct Output {
    path: PathBuf,
    pending: PendingFile,
}

impl Output {
    pub(crate) fn create(path: PathBuf) -> Result<Self, Failure> {
        match PendingFile::create(&path) {
            Ok(pending) => Ok(Self { path, pending }),
            Err(error) => Err(Failure::Input(format!("{}: cannot be written: {error}", path.display()))),
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file whole, or names it in the failure.
    pub(crate) fn write(mut self, bytes: &[u8]) -> Result<(), Failure> {
        let written = self.pending.write_all(bytes).and_then(|()| self.pending.finish());
        written.map_err(|error| Failure::writing(&self.path, &error))
    }
}

/// Writes a .png file.
pub(crate) fn write_png(file: Output, image: &Image) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.size.width, image.size.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Best);
    encoder.set_adaptive_filter(png::AdaptiveFilterType::Adaptive);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(&image.bytes)?;
        writer.finish()
    });
    written.map_err(|error| Failure::writing(file.path(), &error))?;
    file.write(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_averaged_and_the_picture_is_upright() {
        let size = Size { width: 1, height: 2 };
        // Rows from the bottom: the lower point is black, the upper one red in half of its pixels.
        let (black, red) = ([0, 0, 0, 255_u8], [200, 0, 8, 255_u8]);
        let finer = [black, black, black, black, red, black, black, red].concat();
        assert_eq!(averaged(&finer, size), [100, 0, 4, 0, 0, 0]);
    }
}
