//! Letters that can be written.

use std::ops::RangeInclusive;

/// Noto Sans Mono, cut down to [`WRITTEN`]; its licence lies beside it.
pub(crate) const FONT: &[u8] = include_bytes!("../assets/NotoSansMono-subset.ttf");

/// Stands for a letter that the font lacks, which would not be seen at all.
const MISSING: char = '□';

/// All that the font has: Latin with what most of Europe adds to it, Greek, Cyrillic, dashes and
/// quotes, and a few signs.
const WRITTEN: [RangeInclusive<char>; 15] = [
    ' '..='~',
    '\u{a1}'..='\u{ac}',
    '\u{ae}'..='\u{17f}',
    '\u{370}'..='\u{377}',
    '\u{37a}'..='\u{37f}',
    '\u{384}'..='\u{38a}',
    '\u{38c}'..='\u{38c}',
    '\u{38e}'..='\u{3a1}',
    '\u{3a3}'..='\u{3e1}',
    '\u{3f0}'..='\u{45f}',
    '\u{490}'..='\u{491}',
    '\u{2010}'..='\u{2026}',
    '€'..='€',
    '−'..='−',
    MISSING..=MISSING,
];

/// A text as it can be written: every other letter, also one that moves the pen, is a mark.
pub(crate) fn written(text: &str) -> String {
    let is_written = |letter: char| WRITTEN.iter().any(|range| range.contains(&letter));
    text.chars().map(|letter| if is_written(letter) { letter } else { MISSING }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number<const BYTES: usize>(at: usize) -> usize {
        FONT[at..at + BYTES].iter().fold(0, |number, &byte| number << 8 | usize::from(byte))
    }

    /// First and last letters of the font's segments, read from its `cmap` table in format 4 as the
    /// OpenType specification has it.
    fn segments() -> Vec<(usize, usize)> {
        let mut tables = (0..number::<2>(4)).map(|index| 12 + 16 * index);
        let cmap = number::<4>(tables.find(|&at| &FONT[at..at + 4] == b"cmap").unwrap() + 8);
        let table = cmap + number::<4>(cmap + 8);
        assert_eq!(number::<2>(table), 4, "the first encoding is of another format");
        let twice = number::<2>(table + 6);
        let ends = (table + 14..).step_by(2).take(twice / 2);
        ends.map(|end| (number::<2>(end + twice + 2), number::<2>(end))).filter(|&(_, last)| last < 0xffff).collect()
    }

    #[test]
    fn the_font_has_what_is_written_and_no_more() {
        let is_in_font = |letter: usize| segments().iter().any(|&(first, last)| (first..=last).contains(&letter));
        for letter in ' '..='\u{2fff}' {
            let is_kept = written(letter.encode_utf8(&mut [0; 4])) != "□" || letter == MISSING;
            assert_eq!(is_kept, is_in_font(letter as usize), "{letter:?}");
        }
        assert!(FONT.len() < 60_000);
    }

    #[test]
    fn what_cannot_be_written_is_marked() {
        assert_eq!(written("Zürich Łódź Αθήνα Київ"), "Zürich Łódź Αθήνα Київ");
        assert_eq!(written("東京 a\nb\u{308}"), "□□ a□b□");
        // What the window itself writes.
        let own = "kg m²/s × − … µ · ω ³";
        assert_eq!(written(own), own);
    }
}
