//! The two ways a glTF document lies in a file: as JSON text, or as chunks of a `.glb`.

use std::borrow::Cow;

/// What a file holds.
#[derive(Debug)]
pub(crate) struct Container<'a> {
    pub(crate) json: Cow<'a, str>,
    /// The buffer that a `.glb` brings along.
    pub(crate) binary: Option<&'a [u8]>,
}

const MAGIC: &[u8; 4] = b"glTF";
const JSON: &[u8; 4] = b"JSON";
const BINARY: &[u8; 4] = b"BIN\0";

/// Takes a file's bytes apart. The first bytes say which of the two it is, not its name.
///
/// A `.glb` shorter than its header says is refused; bytes after what the header counts are passed
/// over, as viewers do.
pub(crate) fn open(bytes: &[u8]) -> Result<Container<'_>, String> {
    if !bytes.starts_with(MAGIC) {
        return Ok(Container { json: text(bytes)?, binary: None });
    }
    let version = number(bytes, 4)?;
    if version != 2 {
        return Err(format!("is version {version} of binary glTF, only 2 can be read"));
    }
    let length = number(bytes, 8)?;
    let Some(mut rest) = bytes.get(12..length) else {
        return Err(format!("its header says {length} bytes, it has {}", bytes.len()));
    };
    let (mut json, mut binary) = (None, None);
    while !rest.is_empty() {
        let length = number(rest, 0)?;
        let kind = rest.get(4..8).unwrap_or_default();
        let Some(content) = length.checked_add(8).and_then(|end| rest.get(8..end)) else {
            return Err(format!("a chunk says {length} bytes, more than the file has"));
        };
        match (kind, json.is_none()) {
            (kind, true) if kind == JSON => json = Some(text(content)?),
            (_, true) => return Err("its first chunk is not JSON".to_owned()),
            (kind, false) if kind == BINARY && binary.is_none() => binary = Some(content),
            // Chunks of other kinds are to be ignored.
            _ => {}
        }
        rest = rest.get(8 + length..).unwrap_or_default();
    }
    Ok(Container { json: json.ok_or("has no JSON chunk")?, binary })
}

fn text(bytes: &[u8]) -> Result<Cow<'_, str>, String> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| format!("is not UTF-8 text (bad byte at offset {})", error.valid_up_to()))?;
    Ok(Cow::Borrowed(text.strip_prefix('\u{feff}').unwrap_or(text)))
}

/// The little-endian number at this place.
fn number(bytes: &[u8], at: usize) -> Result<usize, String> {
    let four = bytes.get(at..at + 4).and_then(|four| <[u8; 4]>::try_from(four).ok());
    four.and_then(|four| usize::try_from(u32::from_le_bytes(four)).ok())
        .ok_or_else(|| "breaks off in a header".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
        [&(content.len() as u32).to_le_bytes()[..], kind, content].concat()
    }

    fn glb(chunks: &[Vec<u8>]) -> Vec<u8> {
        let body = chunks.concat();
        [&b"glTF\x02\0\0\0"[..], &(body.len() as u32 + 12).to_le_bytes(), &body].concat()
    }

    #[test]
    fn both_forms_are_taken_apart() {
        let open_text = open(b"\xef\xbb\xbf{}").unwrap();
        assert_eq!((open_text.json.as_ref(), open_text.binary), ("{}", None));
        let mut bytes = glb(&[chunk(JSON, b"{}  "), chunk(b"xtra", b"1234"), chunk(BINARY, b"abcd")]);
        bytes.extend(b"what a killed writer left behind");
        let both = open(&bytes).unwrap();
        assert_eq!((both.json.as_ref(), both.binary), ("{}  ", Some(&b"abcd"[..])));
    }

    #[test]
    fn broken_files_say_how() {
        let whole = glb(&[chunk(JSON, b"{}  ")]);
        for (bytes, part) in [
            (&whole[..15], "header says 24 bytes, it has 15"),
            (&b"glTF\x01\0\0\0\x0c\0\0\0"[..], "version 1"),
            (&glb(&[])[..], "no JSON chunk"),
            (&glb(&[chunk(BINARY, b"")])[..], "first chunk is not JSON"),
            (&glb(&[vec![255, 255, 255, 255, b'J', b'S', b'O', b'N']])[..], "more than the file has"),
            (&glb(&[vec![1, 2]])[..], "breaks off"),
            (&b"\xff"[..], "offset 0"),
        ] {
            let problem = open(bytes).unwrap_err();
            assert!(problem.contains(part), "{problem}");
        }
    }
}
