//! Numbers as people read them, in HTML.

/// A count with a thin space before every three digits.
pub(crate) fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.char_indices() {
        // Four digits are read at once.
        if index > 0 && digits.len() > 4 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Six significant digits, without zeros at the end, and a power of ten where it is far from one.
pub(crate) fn figure(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return if number == 0.0 { "0".to_owned() } else { number.to_string() };
    }
    let scientific = format!("{number:.5e}");
    let (digits, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let power: i32 = exponent.parse().unwrap_or(0);
    let text = if (-4..6).contains(&power) {
        let decimals = usize::try_from(5 - power).unwrap_or(0);
        trimmed(&format!("{number:.decimals$}")).to_owned()
    } else {
        format!("{} × 10<sup>{}</sup>", trimmed(digits), exponent.replace('-', "−"))
    };
    text.replace('-', "−")
}

/// Three digits, for times and drifts, of which no one compares more.
pub(crate) fn rounded(number: f64) -> f64 {
    format!("{number:.2e}").parse().unwrap_or(number)
}

/// Without zeros after the point, and without the point if nothing else is there.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_six_digits() {
        let read = [
            (0.0, "0"),
            (1.0, "1"),
            (-2.5, "−2.5"),
            (1.0 / 60.0, "0.0166667"),
            (123_456.7, "123457"),
            (600.0, "600"),
            (32_123_456.0, "3.21235 × 10<sup>7</sup>"),
            (-1.5e-7, "−1.5 × 10<sup>−7</sup>"),
            (999_999.96, "1 × 10<sup>6</sup>"),
        ];
        for (number, text) in read {
            assert_eq!(figure(number), text);
        }
    }

    #[test]
    fn counts_have_groups_of_three() {
        let read = [(0, "0"), (1000, "1000"), (10_000, "10\u{202f}000"), (1_234_567, "1\u{202f}234\u{202f}567")];
        for (number, text) in read {
            assert_eq!(count(number), text);
        }
    }
}
