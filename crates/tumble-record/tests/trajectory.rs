//! A record read back has the bits that were written, whatever the names and numbers.
//!
//! A trajectory that has lost a digit cannot be compared to the bit with another run. It would fail
//! if numbers were printed with a fixed number of digits, or a name with a comma broke a line.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]

use std::io::Cursor;

use hecs::World;
use tumble::math::Real;
use tumble::{BodyOrder, Pose, Velocity};
use tumble_record::{COLUMNS, Frame, TrajectoryWriter};
use tumble_scene::Scene;

fn recorded(scene: Scene, poke: impl Fn(&mut World)) -> (World, Vec<csv::StringRecord>) {
    let mut world = World::new();
    let names = scene.spawn(&mut world).unwrap();
    poke(&mut world);
    let mut writer = TrajectoryWriter::csv(Cursor::new(Vec::new())).unwrap();
    let order = BodyOrder::of(&world);
    writer.record(&Frame { step: 7, time: 0.1, world: &world, order: &order, names: &names }).unwrap();
    let bytes = writer.finish().unwrap().into_inner();
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    assert_eq!(reader.headers().unwrap(), &COLUMNS[..]);
    (world, reader.records().map(Result::unwrap).collect())
}

fn numbers(record: &csv::StringRecord) -> Vec<Real> {
    record.iter().skip(3).map(|field| field.parse().unwrap()).collect()
}

#[test]
fn every_number_reads_back_to_the_same_bits() {
    let (world, records) = recorded(Scene::stress(300, 5).unwrap(), |_| {});
    let order = BodyOrder::of(&world);
    assert_eq!(records.len(), 300);
    for (record, &entity) in records.iter().zip(order.entities()) {
        let (pose, velocity) = (*world.get::<&Pose>(entity).unwrap(), *world.get::<&Velocity>(entity).unwrap());
        let expected = [pose.position.to_array(), velocity.linear.to_array(), velocity.angular.to_array()];
        let [position, linear, angular] = expected;
        let orientation = pose.orientation.to_array();
        let expected: Vec<Real> = position.into_iter().chain(orientation).chain(linear).chain(angular).collect();
        let bits = |numbers: &[Real]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&numbers(record)), bits(&expected));
        assert_eq!((&record[0], &record[1]), ("7", "0.1"));
    }
}

#[test]
fn extreme_numbers_are_short_and_exact() {
    let extremes = [Real::MAX, Real::MIN_POSITIVE, -0.0];
    let (_, records) = recorded(Scene::stress(1, 0).unwrap(), |world| {
        for pose in world.query_mut::<&mut Pose>() {
            pose.position = tumble::math::Vec3::from_array(extremes);
        }
    });
    let read = numbers(&records[0]);
    assert_eq!(read[..3].iter().map(|x| x.to_bits()).collect::<Vec<_>>(), extremes.map(Real::to_bits));
    assert!(records[0].iter().all(|field| field.len() <= 25));
}

#[test]
fn what_is_not_finite_can_be_read_too() {
    let (_, records) = recorded(Scene::stress(1, 0).unwrap(), |world| {
        for pose in world.query_mut::<&mut Pose>() {
            pose.position = tumble::math::Vec3::new(Real::NAN, Real::INFINITY, Real::NEG_INFINITY);
        }
    });
    let read = numbers(&records[0]);
    assert!(read[0].is_nan() && read[1] == Real::INFINITY && read[2] == Real::NEG_INFINITY);
}

#[test]
fn names_may_hold_commas_and_quotes() {
    let text =
        r#"{ "bodies": [ { "name": "a, \"b\"", "mass": 1 }, { "mass": 1 }, { "name": "floor", "fixed": true } ] }"#;
    let (_, records) = recorded(Scene::from_json(text, "names.json").unwrap(), |_| {});
    let names: Vec<&str> = records.iter().map(|record| &record[2]).collect();
    assert_eq!(names, ["a, \"b\"", "body-1", "floor"]);
    // A fixed body stands still.
    assert!(numbers(&records[2])[7..].iter().all(|number| *number == 0.0));
}
