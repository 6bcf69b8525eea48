//! Animations as .gif files.

use std::borrow::Cow;

use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use crate::failure::Failure;
use crate::options::Size;
use crate::palette::{Histogram, Palette};
use crate::picture::{Image, Output};

/// The number that means: as before. The others are colours.
const AS_BEFORE: u8 = 255;
/// Units of a delay in a second.
const HUNDREDTHS: u32 = 100;

/// Writes pictures of one size, at a fixed rate, with one palette for all of them, and of each only
/// what has changed.
pub(crate) fn write_gif(file: Output, images: &[Image], fps: u16) -> Result<(), Failure> {
    let Some(first) = images.first() else { return Ok(()) };
    let mut histogram = Histogram::new();
    for image in images {
        histogram.add(&image.bytes);
    }
    let palette = histogram.palette(AS_BEFORE);
    let mut bytes = Vec::new();
    encode(&mut bytes, images, first.size, &palette, fps).map_err(|error| Failure::writing(file.path(), &error))?;
    file.write(&bytes)
}

fn encode(bytes: &mut Vec<u8>, images: &[Image], size: Size, palette: &Palette, fps: u16) -> Result<(), EncodingError> {
    let [width, height] = [size.width, size.height].map(|edge| edge as u16);
    let mut encoder = Encoder::new(bytes, width, height, &palette.colors.concat())?;
    encoder.set_repeat(Repeat::Infinite)?;
    let mut before: Option<Vec<u8>> = None;
    for (number, image) in (0..).zip(images) {
        let indices = palette.indices(&image.bytes);
        let mut frame = changed(before.as_deref(), &indices, size);
        frame.delay = (end(number + 1, fps) - end(number, fps)) as u16;
        encoder.write_frame(&frame)?;
        before = Some(indices);
    }
    Ok(())
}

/// When the picture before this one ends, in hundredths of a second: rounded from the start, so
/// that roundings do not add up.
fn end(number: u32, fps: u16) -> u32 {
    (number * HUNDREDTHS + u32::from(fps) / 2) / u32::from(fps)
}

/// The rectangle in which a picture differs from the one before.
fn changed(before: Option<&[u8]>, now: &[u8], size: Size) -> Frame<'static> {
    let width = size.width as usize;
    let differs = |at: usize| before.is_none_or(|before| before.get(at) != now.get(at));
    let (mut left, mut right, mut top, mut bottom) = (usize::MAX, 0, usize::MAX, 0);
    for at in (0..now.len()).filter(|&at| differs(at)) {
        let (x, y) = (at % width, at / width);
        (left, right, top, bottom) = (left.min(x), right.max(x), top.min(y), bottom.max(y));
    }
    if left == usize::MAX {
        // A frame is never empty.
        (left, right, top, bottom) = (0, 0, 0, 0);
    }
    let pixel = |at: usize| if differs(at) { now.get(at).copied().unwrap_or(0) } else { AS_BEFORE };
    let rows = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * width + x));
    Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        dispose: DisposalMethod::Keep,
        transparent: Some(AS_BEFORE),
        buffer: Cow::Owned(rows.map(pixel).collect()),
        ..Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_add_up_to_the_time() {
        for fps in [7, 20, 30, 50] {
            let delays: Vec<u32> =
                (0..u32::from(fps) * 3).map(|number| end(number + 1, fps) - end(number, fps)).collect();
            assert_eq!(delays.iter().sum::<u32>(), 300);
            assert!(delays.iter().max().unwrap() - delays.iter().min().unwrap() <= 1);
        }
    }

    #[test]
    fn only_what_changes_is_stored() {
        let size = Size { width: 4, height: 3 };
        let before = [0; 12];
        let mut now = before;
        (now[5], now[10]) = (1, 2);
        let frame = changed(Some(&before), &now, size);
        assert_eq!((frame.left, frame.top, frame.width, frame.height), (1, 1, 2, 2));
        assert_eq!(frame.buffer.as_ref(), [1, AS_BEFORE, AS_BEFORE, 2]);
        let nothing = changed(Some(&now), &now, size);
        assert_eq!((nothing.width, nothing.height, nothing.buffer.as_ref()), (1, 1, [AS_BEFORE].as_slice()));
        assert_eq!(changed(None, &now, size).buffer.as_ref(), now);
    }

    #[test]
    fn a_decoder_finds_the_pictures() {
        let size = Size { width: 3, height: 2 };
        let image = |color: [u8; 3]| Image { size, bytes: [[0; 3], color, [0; 3], [0; 3], [255; 3], color].concat() };
        let images = [image([200, 0, 0]), image([0, 0, 200])];
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("two.gif");
        write_gif(Output::create(file.clone()).unwrap(), &images, 20).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(std::fs::File::open(&file).unwrap()).unwrap();
        let first = decoder.read_next_frame().unwrap().unwrap();
        assert_eq!((first.delay, first.width, first.height), (5, 3, 2));
        assert_eq!(first.buffer[4..8], [200, 0, 0, 255]);
        let second = decoder.read_next_frame().unwrap().unwrap();
        assert_eq!((second.left, second.top, second.width, second.height), (1, 0, 2, 2));
        // Blue, as before, as before, blue.
        assert_eq!((&second.buffer[0..4], second.buffer[7], second.buffer[11]), ([0, 0, 200, 255].as_slice(), 0, 0));
        assert!(decoder.read_next_frame().unwrap().is_none());
    }
}
