//! A table has the bits of the comma-separated record, whole and at every checkpoint.
//!
//! Notebooks read tables and tests read lines; it would fail if the two disagreed about a bit, or
//! if a table that a killed program left could not be opened.
#![cfg(feature = "parquet")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]

use std::io::{Cursor, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex};

use hecs::World;
use parquet::basic::{LogicalType, Type as PhysicalType};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};
use tumble::math::{PRECISION, Real};
use tumble::{BodyOrder, Simulation};
use tumble_record::{COLUMNS, Frame, TrajectoryWriter};
use tumble_scene::Scene;

/// Records this many frames of 50 bodies both ways, with checkpoints after some; the table at the
/// last of them, or at the end if there are none, and the other record.
fn recorded(frames: u64, checkpoints: &[u64]) -> (bytes::Bytes, Vec<csv::StringRecord>) {
    let scene = Scene::stress(50, 1).unwrap();
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut world = World::new();
    let names = scene.spawn(&mut world).unwrap();
    let order = BodyOrder::of(&world);
    let mut table = Cursor::new(Vec::new());
    let mut parquet = TrajectoryWriter::parquet(&mut table).unwrap();
    let mut csv = TrajectoryWriter::csv(Cursor::new(Vec::new())).unwrap();
    for frame in 0..frames {
        let (step, time) = (simulation.steps(), simulation.time());
        parquet.record(&Frame { step, time, world: &world, order: &order, names: &names }).unwrap();
        csv.record(&Frame { step, time, world: &world, order: &order, names: &names }).unwrap();
        if checkpoints.contains(&frame) {
            parquet.checkpoint().unwrap();
        }
        simulation.step(&mut world);
    }
    if checkpoints.is_empty() {
        parquet.finish().unwrap();
    } else {
        drop(parquet);
    }
    let lines = csv.finish().unwrap().into_inner();
    let records = csv::Reader::from_reader(lines.as_slice()).records().map(Result::unwrap).collect();
    (table.into_inner().into(), records)
}

fn assert_row(row: &Row, record: &csv::StringRecord) {
    for ((name, field), text) in row.get_column_iter().zip(record) {
        let same = match field {
            Field::ULong(step) => text.parse() == Ok(*step),
            Field::Str(body) => body == text,
            Field::Double(number) => text.parse::<f64>().unwrap().to_bits() == number.to_bits(),
            Field::Float(number) => text.parse::<f32>().unwrap().to_bits() == number.to_bits(),
            _ => false,
        };
        assert!(same, "{name}: {field} is not {text}");
    }
    assert_eq!(row.len(), record.len());
}

#[test]
fn the_table_has_the_bits_of_the_lines() {
    // Over 65536 rows: two groups.
    let (table, records) = recorded(1400, &[]);
    let reader = SerializedFileReader::new(table).unwrap();
    let schema = reader.metadata().file_metadata().schema_descr();
    let columns = schema.columns();
    assert_eq!(columns.iter().map(|column| column.name()).collect::<Vec<_>>(), COLUMNS);
    let numbers = if size_of::<Real>() == 8 { PhysicalType::DOUBLE } else { PhysicalType::FLOAT };
    let types: Vec<PhysicalType> = columns.iter().map(|column| column.physical_type()).collect();
    assert_eq!(types[..3], [PhysicalType::INT64, PhysicalType::DOUBLE, PhysicalType::BYTE_ARRAY]);
    assert!(types[3..].iter().all(|kind| *kind == numbers));
    assert_eq!(columns[0].logical_type_ref(), Some(&LogicalType::integer(64, false)));
    // 1400 frames and what was recorded in the first second, which is one group more.
    assert!(reader.num_row_groups() >= 2);
    assert_eq!(reader.metadata().file_metadata().num_rows(), 70_000);
    for (row, record) in reader.get_row_iter(None).unwrap().zip(&records) {
        assert_row(&row.unwrap(), record);
    }
    let metadata = reader.metadata().file_metadata().key_value_metadata().unwrap();
    let value = |key: &str| metadata.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.as_deref());
    assert_eq!((value("source"), value("precision")), (Some("tumble"), Some(PRECISION)));
    assert!(value("units").unwrap().contains("m/s") && value("frame").unwrap().contains("world"));
}

#[test]
fn every_checkpoint_is_a_whole_table_of_what_there_is() {
    for last in [0, 1, 39] {
        let (table, records) = recorded(40, &[last / 2, last]);
        let reader = SerializedFileReader::new(table).unwrap();
        let rows: Vec<Row> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len() as u64, (last + 1) * 50);
        for (row, record) in rows.iter().zip(&records) {
            assert_row(row, record);
        }
    }
}

/// Keeps what the file is after every write.
#[derive(Default)]
struct Watched {
    file: Cursor<Vec<u8>>,
    states: Arc<Mutex<Vec<Vec<u8>>>>,
}

impl Write for Watched {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.states.lock().unwrap().push(self.file.get_ref().clone());
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Seek for Watched {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(to)
    }
}

#[test]
fn between_any_two_writes_the_file_is_a_table() {
    let (mut world, watched) = (World::new(), Watched::default());
    let states = watched.states.clone();
    let names = Scene::stress(20, 1).unwrap().spawn(&mut world).unwrap();
    let order = BodyOrder::of(&world);
    let mut writer = TrajectoryWriter::parquet(watched).unwrap();
    for step in 0..30 {
        writer.record(&Frame { step, time: 0.5, world: &world, order: &order, names: &names }).unwrap();
        if step % 5 == 0 {
            writer.checkpoint().unwrap();
        }
    }
    writer.finish().unwrap();
    let mut rows = Vec::new();
    // The first one of all has rows but no description yet.
    for state in states.lock().unwrap().drain(..).skip(1) {
        let reader = SerializedFileReader::new(bytes::Bytes::from(state)).unwrap();
        rows.push(reader.get_row_iter(None).unwrap().map(Result::unwrap).count());
    }
    assert!(rows.is_sorted() && rows[0] == 20, "{rows:?}");
    assert_eq!(rows.last(), Some(&600));
}

#[test]
fn no_frames_are_a_table_without_rows() {
    let table = TrajectoryWriter::parquet(Cursor::new(Vec::new())).unwrap().finish().unwrap().into_inner();
    let reader = SerializedFileReader::new(bytes::Bytes::from(table)).unwrap();
    assert_eq!(reader.metadata().file_metadata().num_rows(), 0);
}
