//! What all pictures have in common.

use std::fmt::Write as _;

/// The beginning of a picture of this width and height: a title, which may be any text and stands
/// at this place, the style, what scripts read of its x axis, and the ground.
pub(crate) fn opening(
    [width, height]: [f64; 2],
    title: &str,
    [x, y]: [f64; 2],
    (style, x_axis): (&str, Option<&str>),
) -> String {
    let title = escaped(title);
    let data = x_axis.map_or(String::new(), |axis| format!(" data-x=\"{axis}\""));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\"{data} width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n\
         <title>{title}</title>\n<style>{style}</style>\n\
         <rect class=\"ground\" width=\"{width}\" height=\"{height}\" rx=\"6\"/>\n\
         <text class=\"title\" x=\"{x}\" y=\"{y}\">{title}</text>\n"
    )
}

/// Text as it may stand in XML: markup escaped, characters that XML does not have left out.
pub(crate) fn escaped(text: &str) -> String {
    let allowed = |c: &char| *c >= ' ' && !matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().filter(allowed).fold(String::new(), |mut text, c| {
        match c {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            other => text.push(other),
        }
        text
    })
}

pub(crate) fn put(svg: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = svg.write_fmt(text);
}
