//! The bytes that accessors read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;

use crate::error::FieldError;
use crate::gltf::document::{Accessor, Buffer, BufferView, Document};
use crate::gltf::triangles::{MAX_TRIANGLES, OF_COLLIDERS};
use crate::limits::MAX_FILE_BYTES;
use crate::named_files::{Reading, beside};

/// The buffers of a document, each read when it is first needed.
pub(crate) struct Buffers<'a> {
    document: &'a Document,
    /// Where files that a buffer names are looked for; nowhere for a document that came without a
    /// path.
    directory: Option<&'a Path>,
    /// What a `.glb` brings along.
    binary: Option<&'a [u8]>,
    reading: &'a mut Reading,
    read: Vec<Option<Arc<Vec<u8>>>>,
    /// How much may still be read or decoded for this document \[bytes\].
    room: u64,
}

/// The numbers of an accessor, as they lie in its buffer.
struct Elements {
    bytes: Arc<Vec<u8>>,
    start: usize,
    stride: usize,
    count: usize,
}

impl Elements {
    /// The bytes of one element from its first on. Bounds were checked when the elements were
    /// found.
    fn element(&self, index: usize) -> &[u8] {
        self.bytes.get(self.start + index * self.stride..).unwrap_or_default()
    }
}

impl<'a> Buffers<'a> {
    pub(crate) fn new(
        document: &'a Document,
        directory: Option<&'a Path>,
        binary: Option<&'a [u8]>,
        reading: &'a mut Reading,
    ) -> Self {
        Self { document, directory, binary, reading, read: vec![None; document.buffers.len()], room: MAX_FILE_BYTES }
    }

    /// The positions that an accessor holds, at most `most` of them.
    pub(crate) fn positions(&mut self, index: usize, most: usize) -> Result<Vec<DVec3>, FieldError> {
        let accessor = self.accessor(index, "VEC3", most)?;
        let component = Component3::of(accessor).map_err(|problem| field(index, "componentType", problem))?;
        let elements = self.elements(index, accessor, 3 * component.size())?;
        Ok((0..elements.count).map(|at| component.vector(elements.element(at))).collect())
    }

    /// The indices that an accessor holds, at most `most` of them.
    pub(crate) fn indices(&mut self, index: usize, most: usize) -> Result<Vec<u32>, FieldError> {
        let accessor = self.accessor(index, "SCALAR", most)?;
        let size = match accessor.component_type {
            5121 => 1,
            5123 => 2,
            5125 => 4,
            other => return Err(field(index, "componentType", format!("{other} is no type of indices"))),
        };
        let elements = self.elements(index, accessor, size)?;
        Ok((0..elements.count).map(|at| unsigned(elements.element(at), size)).collect())
    }

    fn accessor(&self, index: usize, kind: &str, most: usize) -> Result<&'a Accessor, FieldError> {
        let missing = || FieldError::new("", format!("there is no accessors[{index}]"));
        let accessor = self.document.accessors.get(index).ok_or_else(missing)?;
        if accessor.r#type != kind {
            Err(field(index, "type", format!("is {:?}, not {kind}", accessor.r#type)))
        } else if accessor.sparse.is_some() {
            Err(field(index, "sparse", "is given, and such accessors are not read"))
        } else if accessor.count > most {
            Err(FieldError::exceeding(format!("accessors[{index}].count"), OF_COLLIDERS, MAX_TRIANGLES as u64))
        } else {
            Ok(accessor)
        }
    }

    fn elements(&mut self, index: usize, accessor: &Accessor, size: usize) -> Result<Elements, FieldError> {
        let view_index =
            accessor.buffer_view.ok_or_else(|| field(index, "bufferView", "is missing: it has no data"))?;
        let missing = || field(index, "bufferView", format!("there is no bufferViews[{view_index}]"));
        let view = self.document.buffer_views.get(view_index).ok_or_else(missing)?;
        let in_view =
            |name: &str, problem: String| FieldError::new(format!("bufferViews[{view_index}].{name}"), problem);
        if let Some(compression) = view.extensions.keys().next() {
            return Err(in_view("extensions", format!("{compression} is not read")));
        }
        let stride = view.byte_stride.unwrap_or(size);
        if stride < size {
            return Err(in_view("byteStride", format!("{stride} is less than the {size} bytes of an element")));
        }
        let (bytes, length) = self.bytes(view)?;
        // All numbers are the file's, so every sum may overflow.
        let view_end = view.byte_offset.checked_add(view.byte_length).filter(|end| *end <= length);
        let Some(view_end) = view_end else {
            return Err(in_view("byteLength", format!("reaches beyond the {length} bytes of its buffer")));
        };
        let start = view.byte_offset.checked_add(accessor.byte_offset);
        let last = accessor.count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size));
        match start.zip(last).and_then(|(start, last)| Some((start, start.checked_add(last)?))) {
            Some((start, end)) if end <= view_end => Ok(Elements { bytes, start, stride, count: accessor.count }),
            _ => Err(field(
                index,
                "count",
                format!("{} elements reach beyond bufferViews[{view_index}]", accessor.count),
            )),
        }
    }

    /// The bytes of a view's buffer, of which as many count as the buffer is said to have.
    fn bytes(&mut self, view: &BufferView) -> Result<(Arc<Vec<u8>>, usize), FieldError> {
        let index = view.buffer;
        let missing = || FieldError::new("bufferViews", format!("there is no buffers[{index}]"));
        let buffer = self.document.buffers.get(index).ok_or_else(missing)?;
        let known = self.read.get(index).ok_or_else(missing)?.clone();
        let in_buffer = |error: FieldError| error.inside(&format!("buffers[{index}]"));
        let bytes = known.map_or_else(|| self.read_buffer(index, buffer).map_err(in_buffer), Ok)?;
        if buffer.byte_length > bytes.len() {
            let problem = format!("has {} bytes, its byteLength says {}", bytes.len(), buffer.byte_length);
            return Err(in_buffer(FieldError::new("", problem)));
        }
        if let Some(slot) = self.read.get_mut(index) {
            *slot = Some(bytes.clone());
        }
        Ok((bytes, buffer.byte_length))
    }

    fn read_buffer(&mut self, index: usize, buffer: &Buffer) -> Result<Arc<Vec<u8>>, FieldError> {
        let refused = |problem: &dyn std::fmt::Display| FieldError::new("", problem);
        let (bytes, new) = match (&buffer.uri, self.binary) {
            (None, Some(binary)) if index == 0 => (Arc::new(binary.to_vec()), binary.len()),
            (None, _) => return Err(refused(&"has no uri, and there is no binary chunk for it")),
            (Some(uri), _) => match data(uri).map_err(|problem| refused(&problem))? {
                Some(data) => {
                    let length = data.len();
                    (Arc::new(data), length)
                }
                None => {
                    let path = path(uri, self.directory).map_err(|problem| refused(&problem).of_document())?;
                    // What another buffer or another document has read of it is not read again.
                    let known = self.reading.has(&path);
                    let bytes = self.reading.buffer(&path).map_err(|error| refused(&error).of_document())?;
                    let new = if known { 0 } else { bytes.len() };
                    (bytes, new)
                }
            },
        };
        let full = || FieldError::exceeding("", "bytes in all buffers together", MAX_FILE_BYTES);
        self.room = self.room.checked_sub(new as u64).ok_or_else(full)?;
        Ok(bytes)
    }
}

fn field(index: usize, name: &str, problem: impl std::fmt::Display) -> FieldError {
    FieldError::new(format!("accessors[{index}].{name}"), problem)
}

/// What a URI has in itself; `None` if it names a file.
fn data(uri: &str) -> Result<Option<Vec<u8>>, String> {
    let Some(data) = uri.strip_prefix("data:") else { return Ok(None) };
    let (_, encoded) = data.split_once(";base64,").ok_or("has a data URI that is not base64")?;
    STANDARD.decode(encoded).map(Some).map_err(|error| format!("has a data URI that is not base64: {error}"))
}

/// The file that a URI names, beside the document.
fn path(uri: &str, directory: Option<&Path>) -> Result<PathBuf, String> {
    let directory = directory.ok_or("names a file, and there is no directory to look for it")?;
    beside(directory, &percent_decoded(uri).ok_or("has a uri with a bad escape")?)
}

/// `%20` and the like, as URIs have them.
fn percent_decoded(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let digits = part.get(..2).filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()))?;
        bytes.push(u8::from_str_radix(digits, 16).ok()?);
        bytes.extend(part.get(2..)?.as_bytes());
    }
    String::from_utf8(bytes).ok()
}

/// How a component of a position is written: as f32, or as whole numbers where
/// KHR_mesh_quantization is used.
#[derive(Clone, Copy)]
enum Component3 {
    Float,
    Whole { size: usize, signed: bool, normalized: bool },
}

impl Component3 {
    fn of(accessor: &Accessor) -> Result<Self, String> {
        let normalized = accessor.normalized;
        match accessor.component_type {
            5126 => Ok(Self::Float),
            5120 => Ok(Self::Whole { size: 1, signed: true, normalized }),
            5121 => Ok(Self::Whole { size: 1, signed: false, normalized }),
            5122 => Ok(Self::Whole { size: 2, signed: true, normalized }),
            5123 => Ok(Self::Whole { size: 2, signed: false, normalized }),
            other => Err(format!("{other} is no type of positions")),
        }
    }

    fn size(self) -> usize {
        match self {
            Self::Float => 4,
            Self::Whole { size, .. } => size,
        }
    }

    fn vector(self, bytes: &[u8]) -> DVec3 {
        let component = |index: usize| {
            let size = self.size();
            let raw = unsigned(bytes.get(index * size..).unwrap_or_default(), size);
            match self {
                Self::Float => f64::from(f32::from_bits(raw)),
                Self::Whole { signed, normalized, .. } => {
                    let bits = 8 * size as u32;
                    let value =
                        if signed { f64::from((raw << (32 - bits)) as i32 >> (32 - bits)) } else { f64::from(raw) };
                    let largest = f64::from((1_u32 << (bits - u32::from(signed))) - 1);
                    if normalized { (value / largest).max(-1.0) } else { value }
                }
            }
        };
        DVec3::new(component(0), component(1), component(2))
    }
}

/// A little-endian number of up to four bytes.
fn unsigned(bytes: &[u8], size: usize) -> u32 {
    bytes.iter().take(size).rev().fold(0, |number, byte| number << 8 | u32::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_are_read() {
        assert_eq!(percent_decoded("a%20b%C3%BC.bin").as_deref(), Some("a bü.bin"));
        assert_eq!(percent_decoded("plain").as_deref(), Some("plain"));
        for bad in ["%", "%2", "%zz", "%ff", "%+1"] {
            assert_eq!(percent_decoded(bad), None, "{bad}");
        }
    }

    #[test]
    fn nothing_is_read_from_elsewhere() {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("a b.bin"), b"abc").unwrap();
        assert!(path("a%20b.bin", Some(directory.path())).is_ok_and(|path| path.ends_with("a b.bin")));
        assert_eq!(data("data:application/octet-stream;base64,YWJj"), Ok(Some(b"abc".to_vec())));
        for bad in ["../x.bin", "/etc/hostname", "file:///etc/hostname", "http://example.org/x.bin", "%2e%2e/x.bin"] {
            let problem = path(bad, Some(directory.path())).unwrap_err();
            assert!(problem.contains("not a path below"), "{bad}: {problem}");
        }
        assert!(path("missing.bin", Some(directory.path())).unwrap_err().contains("cannot be read"));
        assert!(path("x.bin", None).unwrap_err().contains("no directory"));
        assert!(data("data:,x").is_err() && data("data:;base64,?").is_err());
    }

    #[test]
    fn quantised_components_are_those_of_the_specification() {
        let signed = Component3::Whole { size: 2, signed: true, normalized: true };
        let bytes = [32767_i16, -32768, 0].map(i16::to_le_bytes).concat();
        assert_eq!(signed.vector(&bytes), DVec3::new(1.0, -1.0, 0.0));
        let unsigned = Component3::Whole { size: 1, signed: false, normalized: true };
        assert_eq!(unsigned.vector(&[255, 0, 51]), DVec3::new(1.0, 0.0, 0.2));
        let plain = Component3::Whole { size: 1, signed: true, normalized: false };
        assert_eq!(plain.vector(&[0x80, 0x7f, 0xff]), DVec3::new(-128.0, 127.0, -1.0));
    }
}
