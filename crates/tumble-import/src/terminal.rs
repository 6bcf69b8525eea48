//! Text and numbers of files as a terminal may have them.

use std::fmt::Write as _;

/// Longest piece of a file's own text that a message repeats \[characters\].
const MAX_QUOTE: usize = 200;

/// The text as one line for a terminal: names come from files, and may have anything in them.
///
/// What a terminal would obey is escaped, and so is what hides or reorders the letters around it:
/// control characters (C0, DEL, C1), line and paragraph separators, marks of direction, invisible
/// letters but the two joiners, and tags.
///
/// ```
/// assert_eq!(tumble_import::printable("a\u{1b}[31mb\n"), "a\\u{1b}[31mb\\n");
/// assert_eq!(tumble_import::printable("Łódź 東京 🦀"), "Łódź 東京 🦀");
/// ```
#[must_use]
pub fn printable(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut line, letter| {
        match letter {
            '\n' => line.push_str("\\n"),
            '\r' => line.push_str("\\r"),
            '\t' => line.push_str("\\t"),
            letter if is_obeyed(letter) => line.extend(letter.escape_unicode()),
            letter => line.push(letter),
        }
        line
    })
}

/// As [`printable`], of a text of several lines, whose ends stay.
///
/// ```
/// assert_eq!(tumble_import::printable_lines("a\u{9b}\nb\n"), "a\\u{9b}\nb\n");
/// ```
#[must_use]
pub fn printable_lines(text: &str) -> String {
    text.split('\n').map(printable).collect::<Vec<_>>().join("\n")
}

/// A JSON document that means the same, with none of the characters in it that [`printable`]
/// escapes.
///
/// ```
/// assert_eq!(tumble_import::printable_json("[\"a\u{9b}\"]\n"), "[\"a\\u009b\"]\n");
/// ```
#[must_use]
pub fn printable_json(json: &str) -> String {
    // JSON has such characters in strings only, but for white space.
    json.chars().fold(String::with_capacity(json.len()), |mut text, letter| {
        if is_obeyed(letter) && !letter.is_ascii_whitespace() {
            for unit in letter.encode_utf16(&mut [0; 2]) {
                // Writing to a string cannot fail.
                let _ = write!(text, "\\u{unit:04x}");
            }
        } else {
            text.push(letter);
        }
        text
    })
}

/// The text without control characters, cut to a length a terminal can show.
///
/// ```
/// assert_eq!(tumble_import::one_line("a\nb"), "a\\nb");
/// ```
#[must_use]
pub fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len().min(4 * MAX_QUOTE));
    // Messages list the keys that are allowed, so they get more room than a quoted value.
    for (count, character) in text.chars().enumerate() {
        if count == 4 * MAX_QUOTE {
            line.push_str("...");
            break;
        }
        line.push(character);
    }
    printable(&line)
}

/// A number as people write it: 1e300 rather than three hundred zeros.
///
/// ```
/// assert_eq!(tumble_import::shortest(1e300), "1e300");
/// assert_eq!(tumble_import::shortest(0.25), "0.25");
/// ```
#[must_use]
pub fn shortest(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude == 0.0 || (1e-5..1e10).contains(&magnitude) { value.to_string() } else { format!("{value:e}") }
}

/// A name, cut to a length a message can hold.
pub(crate) fn quoted(name: &str) -> String {
    name.chars().take(MAX_QUOTE).collect()
}

/// Whether a terminal would do something else than show it. U+200C and U+200D are parts of words
/// and of pictures.
fn is_obeyed(letter: char) -> bool {
    letter.is_control()
        || matches!(letter,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_obeyed_is_left_and_all_else_stays() {
        for letter in '\0'..=char::MAX {
            let text = letter.to_string();
            let shown = printable(&text);
            assert!(!shown.chars().any(is_obeyed), "{letter:?}");
            assert_eq!(shown == text, !is_obeyed(letter), "{letter:?}");
            if letter.is_control() {
                assert_ne!(shown, text);
            }
            let json = serde_json::to_string(&text).unwrap();
            assert!(!printable_json(&json).chars().any(is_obeyed), "{letter:?}");
            assert_eq!(serde_json::from_str::<String>(&printable_json(&json)).unwrap(), text, "{letter:?}");
        }
    }
}
