//! Promise: a plot is well-formed XML whatever its labels and numbers are, shows every point that
//! its axes can show, and stays small.
//!
//! Why: plots are made from runs that may have gone wrong, and a picture that no viewer opens hides
//! just that. It fails if a label is not escaped, if a NaN or an overflow gets into a path, or if
//! an axis of a constant or a huge range has no ticks.

#![allow(clippy::unwrap_used, reason = "a test without what it tests is to fail")]

use roxmltree::Document;
use tumble_record::{Plot, Scale, SeriesStyle};

/// Numbers of all paths and circles, after checking that the picture is well-formed and that all of
/// them are on it.
fn numbers(svg: &str) -> Vec<f64> {
    let document = Document::parse(svg).unwrap();
    let mut found = Vec::new();
    for node in document.descendants() {
        for name in ["d", "cx", "cy", "x", "y"] {
            let text = node.attribute(name).unwrap_or_default();
            for word in text.split(|c: char| "MLHV ".contains(c)).filter(|word| !word.is_empty()) {
                let number: f64 = word.parse().unwrap();
                assert!((0.0..=760.0).contains(&number), "{number} in {text:?}");
                found.push(number);
            }
        }
    }
    found
}

fn lines(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).unwrap();
    let is_line =
        |node: &roxmltree::Node<'_, '_>| node.attribute("class").is_some_and(|class| class.starts_with("line"));
    document.descendants().filter(is_line).filter_map(|node| node.attribute("d").map(str::to_owned)).collect()
}

fn labels(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).unwrap();
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.map(|node| node.text().unwrap_or_default().to_owned()).collect()
}

fn plot(scale: Scale, points: &[(f64, f64)]) -> String {
    let plot = Plot::new("title").x_axis("x", scale).y_axis("y", scale);
    plot.series("", SeriesStyle::Dots, points.iter().copied()).to_svg()
}

#[test]
fn labels_are_escaped() {
    let nasty = "a < b && c > \"d\" 'e' </svg>\u{0}\u{1b}\u{ffff} \u{2202}H";
    let svg = Plot::new(nasty)
        .x_axis(nasty, Scale::Linear)
        .y_axis(nasty, Scale::Log)
        .series(nasty, SeriesStyle::Line, [(1.0, 1.0)])
        .to_svg();
    numbers(&svg);
    let shown = "a < b && c > \"d\" 'e' </svg> \u{2202}H";
    // Title, two axes and the legend.
    assert_eq!(labels(&svg).iter().filter(|label| *label == shown).count(), 4, "{svg}");
}

#[test]
fn nothing_to_show_is_still_a_picture() {
    let nan = f64::NAN;
    for points in
        [&[][..], &[(nan, nan)], &[(1.0, nan), (nan, 1.0)], &[(f64::INFINITY, f64::NEG_INFINITY)], &[(1.0, -1.0)]]
    {
        for scale in [Scale::Linear, Scale::Log] {
            let svg = plot(scale, points);
            numbers(&svg);
            if !(scale == Scale::Linear && points == [(1.0, -1.0)]) {
                assert!(lines(&svg).is_empty(), "{points:?}: {svg}");
            }
            assert!(labels(&svg).len() >= 3 + 4, "{points:?}: no ticks");
        }
    }
    numbers(&Plot::new("").to_svg());
}

#[test]
fn what_cannot_be_shown_interrupts_the_line() {
    let gap = [(1.0, 1.0), (2.0, 2.0), (3.0, f64::NAN), (4.0, 4.0), (5.0, f64::INFINITY), (6.0, 5.0), (7.0, 6.0)];
    let line = lines(&plot(Scale::Linear, &gap)).concat();
    assert_eq!((line.matches('M').count(), line.matches('L').count()), (3, 2), "{line}");
    let line = lines(&plot(Scale::Log, &[(1.0, 1.0), (2.0, 0.0), (3.0, 1e3), (4.0, 1e4)])).concat();
    assert_eq!((line.matches('M').count(), line.matches('L').count()), (2, 1), "{line}");
}

/// A single point and a constant stand in the middle of the picture, with round numbers around
/// them.
#[test]
fn constants_and_single_points_have_a_range() {
    for value in [0.0, 1.0, -3.5, 1e-12, 1e9, 5e-324, 1e300] {
        for points in [vec![(value, value)], vec![(0.0, value), (1.0, value), (2.0, value * (1.0 + 1e-15))]] {
            let svg = plot(Scale::Linear, &points);
            numbers(&svg);
            assert_eq!(lines(&svg).len(), 1);
            let ticks = labels(&svg).len() - 3;
            assert!((6..=26).contains(&ticks), "{value}: {ticks} ticks");
        }
    }
}

#[test]
fn ranges_of_any_size_fit() {
    let ends = [f64::MIN, -1e300, -1.0, 0.0, 5e-324, 1e-300, 1.0, 1e300, f64::MAX];
    for low in ends {
        for high in ends {
            for scale in [Scale::Linear, Scale::Log] {
                let svg = plot(scale, &[(low, high), (high, low), (0.5 * low + 0.5 * high, 1.0)]);
                numbers(&svg);
                let ticks = labels(&svg).len() - 3;
                assert!((4..=30).contains(&ticks), "{low:e}..{high:e} {scale:?}: {ticks} ticks");
                assert!(labels(&svg).iter().all(|label| label.chars().count() < 16), "{:?}", labels(&svg));
            }
        }
    }
}

/// Four points fit into each half pixel of the 650 columns at most; the extremes of a million
/// points are drawn.
#[test]
fn a_million_points_stay_a_small_picture() {
    let noisy = (0..1_000_000).map(|i| (f64::from(i), if i == 500_000 { 9.0 } else { f64::from(i).sin() }));
    let svg = Plot::new("").series("", SeriesStyle::Line, noisy).to_svg();
    assert!(svg.len() < 120_000, "{} bytes", svg.len());
    let highest = lines(&svg).concat();
    let highest =
        highest.split(['M', 'L']).filter_map(|pair| pair.split(' ').nth(1)).filter_map(|y| y.parse::<f64>().ok());
    let highest = highest.fold(f64::INFINITY, f64::min);
    // The padding is four per cent of the 316 pixels of height.
    assert!(highest < 48.0 + 0.05 * 316.0, "the spike is at {highest}");
}

#[test]
fn points_are_where_the_axes_say() {
    // Padded by 4 %, the range of 100 ticks is 108 wide; the frame is from 92 to 742 and from 364
    // up to 48.
    let svg = plot(Scale::Linear, &[(0.0, 0.0), (100.0, 50.0)]);
    let line = lines(&svg).concat();
    let part = 4.0 / 108.0;
    let expected = [92.0 + 650.0 * part, 364.0 - 316.0 * part, 742.0 - 650.0 * part, 48.0 + 316.0 * part];
    let found: Vec<f64> = line.split(['M', 'L', ' ']).filter_map(|word| word.parse().ok()).collect();
    // Written with two decimals.
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 0.005), "{found:?} not {expected:?}");
    assert!(["0", "20", "40", "60", "80", "100"].iter().all(|tick| labels(&svg).iter().any(|label| label == tick)));
    let svg = plot(Scale::Log, &[(1e-6, 1.0), (1e3, 100.0)]);
    for tick in ["10\u{207b}\u{2076}", "10\u{2070}", "10\u{b2}"] {
        assert!(labels(&svg).iter().any(|label| label == tick), "{tick} is not in {:?}", labels(&svg));
    }
}

/// The density of a cloud is what it shows: points above each other are not thinned, and no line
/// joins them.
#[test]
fn a_cloud_has_all_its_points_and_no_line() {
    let points = (0..500).map(|i| (f64::from(i % 2), f64::from(i)));
    let svg = Plot::new("title").series("", SeriesStyle::Cloud, points).to_svg();
    numbers(&svg);
    assert_eq!((svg.matches("<circle").count(), lines(&svg).len()), (500, 0));
}
