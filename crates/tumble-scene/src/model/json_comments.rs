//! Comments in JSON scenes, which the parser is not to see.

use std::borrow::Cow;

/// The text with a space for each byte of a `//` or `/* */` comment, so that lines and columns of
/// errors stay what they are.
///
/// # Errors
/// The line in which a comment begins that does not end.
pub(crate) fn without_comments(text: &str) -> Result<Cow<'_, str>, usize> {
    let bytes = text.as_bytes();
    let mut blanked = Vec::new();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let end = match (byte, bytes.get(at + 1)) {
            (b'"', _) => {
                at = end_of_string(bytes, at);
                continue;
            }
            (b'/', Some(b'/')) => end_of_line(bytes, at),
            (b'/', Some(b'*')) => end_of_block(bytes, at).ok_or_else(|| line_of(bytes, at))?,
            _ => {
                at += 1;
                continue;
            }
        };
        if blanked.is_empty() {
            blanked = bytes.to_vec();
        }
        blanked[at..end].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
        at = end;
    }
    // A comment ends where a letter does, so what is left is text.
    Ok(String::from_utf8(blanked).ok().filter(|blanked| !blanked.is_empty()).map_or(Cow::Borrowed(text), Cow::Owned))
}

/// Past the closing quote.
fn end_of_string(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while let Some(byte) = bytes.get(at) {
        match byte {
            b'"' => return at + 1,
            b'\\' => at += 2,
            _ => at += 1,
        }
    }
    bytes.len()
}

fn end_of_line(bytes: &[u8], start: usize) -> usize {
    bytes[start..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |length| start + length)
}

/// Past the closing mark.
fn end_of_block(bytes: &[u8], start: usize) -> Option<usize> {
    let inside = start + 2;
    bytes[inside..].windows(2).position(|pair| pair == b"*/").map(|length| inside + length + 2)
}

fn line_of(bytes: &[u8], at: usize) -> usize {
    1 + bytes[..at].iter().filter(|byte| **byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_become_spaces() {
        for (text, wanted) in [
            ("[1, // one\n2]", "[1,       \n2]"),
            ("[1, /* one\n and */ 2]", "[1,       \n        2]"),
            ("[1] // gr\u{fc}n", "[1]         "),
            ("/**/[/*/*/1]", "    [     1]"),
            ("[1]//", "[1]  "),
        ] {
            assert_eq!(without_comments(text).unwrap(), wanted);
        }
    }

    #[test]
    fn strings_and_what_has_no_comments_stay() {
        for text in ["", "[1, 2]", r#"["http://a", "/* b */", "\" // c"]"#, "[1 / 2]", r#"["open // "#, "\"\\"] {
            assert!(matches!(without_comments(text), Ok(Cow::Borrowed(same)) if same == text), "{text}");
        }
        assert_eq!(without_comments(r#"["//"] // c"#).unwrap(), r#"["//"]     "#);
    }

    #[test]
    fn a_comment_that_does_not_end_has_a_line() {
        assert_eq!(without_comments("[\n1,\n/* 2]"), Err(3));
        assert_eq!(without_comments("/*/"), Err(1));
    }
}
