//! Times and counts as people write them: fractions, units, exponents.

/// Units of time, with what a number of them is multiplied and divided by.
const UNITS: [(&str, f64, f64); 9] = [
    ("", 1.0, 1.0),
    ("s", 1.0, 1.0),
    ("ms", 1.0, 1e3),
    ("us", 1.0, 1e6),
    ("\u{b5}s", 1.0, 1e6),
    ("ns", 1.0, 1e9),
    ("min", 60.0, 1.0),
    ("h", 3600.0, 1.0),
    ("d", 86_400.0, 1.0),
];

/// Reads a time \[s\]: a number or a fraction of two, in seconds or with a unit (`ns`, `us`, `ms`,
/// `s`, `min`, `h`, `d`) behind it.
///
/// # Errors
/// A sentence on what may be written. Whether the time makes sense is not checked here.
///
/// ```
/// assert_eq!(tumble_scene::parse_seconds("1/60"), Ok(1.0 / 60.0));
/// assert_eq!(tumble_scene::parse_seconds("500ms"), Ok(0.5));
/// assert_eq!(tumble_scene::parse_seconds("2 min"), Ok(120.0));
/// assert!(tumble_scene::parse_seconds("soon").is_err());
/// ```
pub fn parse_seconds(text: &str) -> Result<f64, String> {
    let refusal =
        || "write seconds, as 0.01, 1e-3 or 1/60, or a unit with them, as 500ms, 2s, 5min, 1h or 1d".to_owned();
    let text = text.trim();
    let number = text.trim_end_matches(char::is_alphabetic);
    // The letter mu of Greek is typed for the micro sign.
    let unit = text[number.len()..].replace('\u{3bc}', "\u{b5}");
    let (_, times, over) = UNITS.into_iter().find(|(name, ..)| *name == unit).ok_or_else(refusal)?;
    let finite = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let value = match number.split_once('/') {
        Some((above, below)) => finite(above).zip(finite(below)).map(|(above, below)| above / below),
        None => finite(number),
    };
    value.map(|value| value * times / over).filter(|seconds| seconds.is_finite()).ok_or_else(refusal)
}

/// Reads a whole number: digits, with `_` between them if wanted, or with an exponent.
///
/// # Errors
/// A sentence on what may be written, or that it is too large a number.
///
/// ```
/// assert_eq!(tumble_scene::parse_count("1e6"), Ok(1_000_000));
/// assert_eq!(tumble_scene::parse_count("10_000"), Ok(10_000));
/// assert!(tumble_scene::parse_count("1.5").is_err());
/// ```
pub fn parse_count(text: &str) -> Result<u64, String> {
    // Up to here every whole number has a float of its own.
    const LARGEST: f64 = (1_u64 << 53) as f64;
    let digits = text.trim().replace('_', "");
    if let Ok(count) = digits.parse() {
        return Ok(count);
    }
    match digits.parse::<f64>() {
        Ok(count) if count.fract() == 0.0 && (0.0..=LARGEST).contains(&count) => Ok(count as u64),
        Ok(count) if count > LARGEST => Err("the number is too large".to_owned()),
        _ => Err("write a whole number, as 600, 10_000 or 1e6".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_fractions_and_units() {
        for (text, seconds) in [
            ("0.01", 0.01),
            ("1e-3", 0.001),
            ("1/60", 1.0 / 60.0),
            ("1 / 240", 1.0 / 240.0),
            ("1/60s", 1.0 / 60.0),
            ("2s", 2.0),
            ("2 s", 2.0),
            ("500ms", 0.5),
            ("10us", 1e-5),
            ("10\u{b5}s", 1e-5),
            ("10\u{3bc}s", 1e-5),
            ("3ns", 3e-9),
            ("2min", 120.0),
            ("1.5h", 5400.0),
            ("1d", 86_400.0),
            ("-1", -1.0),
        ] {
            assert_eq!(parse_seconds(text), Ok(seconds), "{text}");
        }
        for bad in ["", "s", "1/0", "0/0", "1/2/3", "nan", "inf", "1e999", "1 2", "2 parsecs", "1m", "0x10", "1/"] {
            let problem = parse_seconds(bad).unwrap_err();
            assert!(problem.contains("1/60") && problem.contains("500ms"), "{bad}: {problem}");
        }
    }

    #[test]
    fn counts_have_exponents_and_separators() {
        for (text, count) in
            [("0", 0), ("600", 600), ("1e6", 1_000_000), ("2.5e3", 2500), ("1E3", 1000), ("10_000", 10_000), ("7.0", 7)]
        {
            assert_eq!(parse_count(text), Ok(count), "{text}");
        }
        assert_eq!(parse_count(&u64::MAX.to_string()), Ok(u64::MAX));
        for bad in ["", "-1", "1.5", "1e-3", "nan", "many", "0x10"] {
            assert!(parse_count(bad).unwrap_err().contains("1e6"), "{bad}");
        }
        for large in ["1e300", "99999999999999999999", "inf"] {
            assert!(parse_count(large).unwrap_err().contains("too large"), "{large}");
        }
    }
}
