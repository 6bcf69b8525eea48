//! What a sweep sees in its worlds beside their ends, and what it draws them from.
//!
//! It would fail if a largest value missed a step, if a world went on past its condition, if a list
//! lost a value, or if fields of one draw had two.

use crate::support::Place;

/// A ball that is thrown up at 3 m/s from 1 m above the ground, on which it comes to rest.
const BALL: &str = r#"{ "dt": 0.001, "steps": 3000, "bodies": [
    { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": {} },
    { "name": "ball", "shape": { "sphere": { "radius": 0.5 } }, "mass": 1, "collider": {},
      "position": [0, 1.5, 0], "linear_velocity": [0, 3, 0] },
    { "name": "other", "shape": { "sphere": { "radius": 0.5 } }, "mass": 1, "position": [9, 1.5, 0] } ] }"#;

fn rows(place: &Place, options: &[&str]) -> Vec<csv::StringRecord> {
    place.write("ball.json", BALL);
    drop(std::fs::remove_file(place.path("out.csv")));
    place.succeed(&[&["sweep", "ball.json", "--out", "out.csv", "--body", "ball"][..], options].concat());
    let text = place.read("out.csv");
    let (_, table) = text.split_once('\n').unwrap();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let header = reader.headers().unwrap().clone();
    [header].into_iter().chain(reader.records().map(Result::unwrap)).collect()
}

fn column(rows: &[csv::StringRecord], name: &str) -> Vec<f64> {
    let at = rows[0].iter().position(|column| column == name).unwrap();
    rows[1..].iter().map(|row| row[at].parse().unwrap_or(f64::NAN)).collect()
}

/// It rises by v²/2g and falls on the ground at (v + sqrt(v² + 2gh))/g.
#[test]
fn heights_and_times_are_those_of_a_throw() {
    let place = Place::new();
    let observe = [
        "--observe",
        "max(ball.py)",
        "--observe",
        "min(ball.py)",
        "--observe",
        "first_contact(ball)",
        "--observe",
        "first_contact(other)",
    ];
    let vary = ["--vary", "bodies.ball.linear_velocity.1=list(3,1)"];
    let rows = rows(&place, &[&observe[..], &vary].concat());
    for (world, speed) in [3.0_f64, 1.0].into_iter().enumerate() {
        let g = 9.81;
        let (top, time) = (1.5 + speed * speed / (2.0 * g), (speed + (speed * speed + 2.0 * g).sqrt()) / g);
        assert!((column(&rows, "max(ball.py)")[world] - top).abs() < 1e-3, "{rows:?}");
        // In the step in which they meet.
        assert!((column(&rows, "first_contact(ball)")[world] - time).abs() < 0.02, "{time}: {rows:?}");
        assert!((column(&rows, "min(ball.py)")[world] - 0.5).abs() < 0.02, "{rows:?}");
        assert!(column(&rows, "first_contact(other)")[world].is_nan(), "{rows:?}");
    }
}

/// A row in which nothing touched is a row: the sweep goes on behind it, and can be drawn.
#[test]
fn a_sweep_without_a_contact_goes_on() {
    let place = Place::new();
    let vary = ["--observe", "first_contact(other)", "--vary", "bodies.ball.linear_velocity.1=list(3,1,2)"];
    let whole = rows(&place, &vary);
    let text = place.read("out.csv");
    let two_rows: String = text.split_inclusive('\n').take(4).collect();
    place.write("out.csv", &two_rows);
    place.succeed(&[&["sweep", "ball.json", "--out", "out.csv", "--body", "ball"][..], &vary].concat());
    assert_eq!(place.read("out.csv"), text);
    assert_eq!(whole[1].iter().next_back(), Some(""), "{whole:?}");
}

#[test]
fn a_condition_ends_a_world() {
    let place = Place::new();
    let vary = ["--vary", "bodies.ball.linear_velocity.1=list(3)"];
    for (until, low, high) in [("ball.py<1", 0.5, 0.9), ("first_contact", 0.7, 0.9), ("ball.vy<0", 0.3, 0.32)] {
        let rows = rows(&place, &[&["--until", until][..], &vary].concat());
        let (time, steps) = (column(&rows, "time")[0], column(&rows, "steps_taken")[0]);
        assert!((low..high).contains(&time) && (steps - 1000.0 * time).abs() < 0.5, "{until}: {rows:?}");
    }
    // Watching changes no bit.
    let plain = rows(&place, &vary);
    let watched = rows(&place, &[&["--observe", "max(ball.vy)", "--until", "ball.py>99"][..], &vary].concat());
    let at = plain[0].iter().position(|column| column == "hash").unwrap();
    assert_eq!(plain[1][at], watched[1][at]);
}

#[test]
fn fields_of_one_draw_have_one_value() {
    let place = Place::new();
    let vary =
        ["--vary", "bodies.ball.position.0,bodies.other.position.0*-2=choice(1,2,4)", "--worlds", "30", "--steps", "0"];
    let rows = rows(&place, &vary);
    let (one, two) = (column(&rows, "bodies.ball.position.0"), column(&rows, "bodies.other.position.0"));
    assert!(one.iter().zip(&two).all(|(one, two)| *two == -2.0 * one));
    assert!([1.0, 2.0, 4.0].iter().all(|value| one.contains(value)) && one.len() == 30);
    let turned = ["--vary", "bodies.ball.orientation.angle=grid(0,3,4)", "--steps", "0"];
    let rows = self::rows(&place, &turned);
    for (angle, half) in column(&rows, "ball.qy").into_iter().zip([0.0_f64, 0.5, 1.0, 1.5]) {
        assert!((angle - half.sin()).abs() < 1e-6, "{rows:?}");
    }
}

#[test]
fn what_cannot_be_watched_is_refused() {
    let place = Place::new();
    place.write("ball.json", BALL);
    for (option, text, wanted) in [
        ("--observe", "max(bal.py)", "the scene has no body \"bal\""),
        ("--observe", "max(ball.height)", "one of px, py, pz"),
        ("--observe", "mean(ball.py)", "is none of max(BODY.COLUMN)"),
        ("--until", "ball.py=1", "is none of BODY.COLUMN<NUMBER"),
        ("--vary", "bodies.ball.position.0,bodies.ball.position.0=1..2", "is varied twice"),
        ("--vary", "bodies.ball.mass=some(1)", "choice(A,B,..), grid(LO,HI,N) and list(A,B,..)"),
    ] {
        place.refused(&["sweep", "ball.json", "--worlds", "1", "--out", "out.csv", option, text], wanted);
    }
}
