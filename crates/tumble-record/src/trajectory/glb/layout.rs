//! Byte layout of the binary glTF file: headers, document, geometry, times and animation tracks.

use std::io::{self, Seek, SeekFrom, Write};

use crate::trajectory::glb::bodies::Bodies;

/// What lies where in the file: header, document, and one buffer that holds vertices, indices,
/// times and tracks, in this order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// Number of frames there is room for.
    pub(crate) frames: u64,
    /// Of the first frame \[s\].
    pub(crate) first_time: f32,
    /// Bodies that have tracks.
    pub(crate) moving: u64,
    pub(crate) vertex_bytes: u64,
    pub(crate) index_bytes: u64,
    /// Of the document with the spaces behind it; known once it is written.
    pub(crate) json_bytes: u64,
}

impl Layout {
    /// All lengths in the format are 32 bits.
    pub(crate) const MAX_BYTES: u64 = u32::MAX as u64;
    pub(crate) const TIME: u64 = size_of::<f32>() as u64;
    pub(crate) const TRANSLATION: u64 = size_of::<[f32; 3]>() as u64;
    pub(crate) const ROTATION: u64 = size_of::<[f32; 4]>() as u64;
    /// Magic, version and length of the file; length and kind of a chunk.
    const FILE_HEADER: u64 = 12;
    const CHUNK_HEADER: u64 = 8;
    /// Where the document begins.
    pub(crate) const DOCUMENT_AT: u64 = Self::FILE_HEADER + Self::CHUNK_HEADER;

    pub(crate) fn new(bodies: &Bodies, frames: u64, first_time: f32) -> Self {
        Self {
            frames,
            first_time,
            moving: bodies.moving_count(),
            vertex_bytes: bodies.geometry.vertex_bytes(),
            index_bytes: bodies.geometry.index_bytes(),
            json_bytes: 0,
        }
    }

    /// Where the times begin, from the beginning of the buffer.
    pub(crate) fn times(&self) -> u64 {
        self.vertex_bytes + self.index_bytes
    }

    pub(crate) fn time_bytes(&self) -> u64 {
        if self.moving > 0 { self.frames.saturating_mul(Self::TIME) } else { 0 }
    }

    /// Where the tracks begin, from the beginning of the buffer.
    pub(crate) fn tracks(&self) -> u64 {
        self.times().saturating_add(self.time_bytes())
    }

    pub(crate) fn track_bytes(&self) -> u64 {
        self.frames.saturating_mul(self.moving).saturating_mul(Self::TRANSLATION + Self::ROTATION)
    }

    /// Where the translations and the rotations of a moving body begin, from the beginning of the
    /// tracks.
    pub(crate) fn track(&self, body: u64) -> [u64; 2] {
        let translations = body * self.frames * (Self::TRANSLATION + Self::ROTATION);
        [translations, translations + self.frames * Self::TRANSLATION]
    }

    pub(crate) fn buffer_bytes(&self) -> u64 {
        self.tracks().saturating_add(self.track_bytes())
    }

    pub(crate) fn file_bytes(&self) -> u64 {
        let buffer = if self.buffer_bytes() > 0 { Self::CHUNK_HEADER + self.buffer_bytes() } else { 0 };
        Self::DOCUMENT_AT + self.json_bytes + buffer
    }

    /// Where the buffer begins in the file.
    fn buffer_at(&self) -> u64 {
        Self::DOCUMENT_AT + self.json_bytes + Self::CHUNK_HEADER
    }

    pub(crate) fn time_at(&self, frame: u64) -> u64 {
        self.buffer_at() + self.times() + frame * Self::TIME
    }

    pub(crate) fn translation_at(&self, body: u64, frame: u64) -> u64 {
        let [translations, _] = self.track(body);
        self.buffer_at() + self.tracks() + translations + frame * Self::TRANSLATION
    }

    pub(crate) fn rotation_at(&self, body: u64, frame: u64) -> u64 {
        let [_, rotations] = self.track(body);
        self.buffer_at() + self.tracks() + rotations + frame * Self::ROTATION
    }

    /// Writes the headers around the document and leaves the writer at the beginning of the buffer.
    pub(crate) fn write_headers(&self, writer: &mut (impl Write + Seek)) -> io::Result<()> {
        // No more than MAX_BYTES, which has been checked.
        let [file, json, buffer] = [self.file_bytes(), self.json_bytes, self.buffer_bytes()].map(|bytes| bytes as u32);
        writer.seek(SeekFrom::Start(0))?;
        writer.write_all(b"glTF")?;
        writer.write_all(&2_u32.to_le_bytes())?;
        writer.write_all(&file.to_le_bytes())?;
        writer.write_all(&json.to_le_bytes())?;
        writer.write_all(b"JSON")?;
        writer.seek(SeekFrom::Start(Self::DOCUMENT_AT + self.json_bytes))?;
        if buffer > 0 {
            writer.write_all(&buffer.to_le_bytes())?;
            writer.write_all(b"BIN\0")?;
        }
        Ok(())
    }
}
