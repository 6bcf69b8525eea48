//! Apache Parquet. Readers look for the description of a file at its end, so every checkpoint
//! writes a whole one, which those that follow leave behind in the middle of the file, where no
//! reader looks.
//!
//! At any moment the file is to end with a description. So the last one is first written again
//! where the end will be, then the new rows into the gap before it, and then the new description
//! after it. What a kill can cut is only the writing of a description.

use std::collections::HashMap;
use std::io::{self, Seek, SeekFrom, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::{FileMetaData, KeyValue, ParquetMetaData, ParquetMetaDataWriter};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type};
use tumble::math::{PRECISION, Real};

use crate::trajectory::frame::Frame;
use crate::trajectory::{COLUMNS, STATE_COLUMNS, state_numbers};

/// The type of the state's numbers in a file.
#[cfg(not(feature = "f64"))]
type RealType = parquet::data_type::FloatType;
#[cfg(feature = "f64")]
type RealType = DoubleType;

/// Rows of a group, which are held in memory: about five megabytes of them in single precision.
const GROUP_ROWS: usize = 1 << 16;

/// A description is written when what is new is this many times as much. It is written twice, so
/// all of them are at most an eighth of the file.
const DESCRIPTION_SHARE: usize = 16;

/// One row for each body and frame.
pub(crate) struct ParquetRecord<W> {
    writer: W,
    /// Holds what is not yet in the file; knows where in it that will be.
    file: SerializedFileWriter<Vec<u8>>,
    names: HashMap<u64, ByteArray>,
    rows: Rows,
    recorded: i64,
    /// What the file ends with.
    description: Vec<u8>,
    /// Of the file.
    length: u64,
}

/// The columns of a group.
#[derive(Default)]
struct Rows {
    steps: Vec<i64>,
    times: Vec<f64>,
    names: Vec<ByteArray>,
    states: [Vec<Real>; 13],
}

impl<W> std::fmt::Debug for ParquetRecord<W> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("ParquetRecord").field("recorded", &self.recorded).finish_non_exhaustive()
    }
}

impl<W: Write + Seek> ParquetRecord<W> {
    pub(crate) fn new(writer: W) -> io::Result<Self> {
        let schema = schema().map_err(failed)?;
        let file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties())).map_err(failed)?;
        let (names, rows) = (HashMap::new(), Rows::default());
        Ok(Self { writer, file, names, rows, recorded: 0, description: Vec::new(), length: 0 })
    }

    pub(crate) fn record(&mut self, frame: &Frame<'_>) -> io::Result<()> {
        frame.for_each(|id, pose, velocity| {
            let name = self.names.entry(id).or_insert_with(|| frame.names.of(id).as_bytes().to_vec().into());
            self.rows.names.push(name.clone());
            // The column is unsigned, which in the format is the same 64 bits.
            self.rows.steps.push(frame.step.cast_signed());
            self.rows.times.push(frame.time);
            for (column, number) in self.rows.states.iter_mut().zip(state_numbers(pose, velocity)) {
                column.push(number);
            }
            if self.rows.steps.len() < GROUP_ROWS {
                return Ok(());
            }
            self.write_group()?;
            // Or what is held would grow for as long as no checkpoint is due.
            if self.is_worth_a_checkpoint() { self.checkpoint() } else { Ok(()) }
        })
    }

    /// Whether enough is new for another description.
    pub(crate) fn is_worth_a_checkpoint(&self) -> bool {
        let rows = self.rows.steps.len() * (size_of::<[Real; 13]>() + size_of::<[f64; 2]>());
        let written = self.file.bytes_written() as u64 - self.length;
        written + rows as u64 >= (DESCRIPTION_SHARE * self.description.len()) as u64
    }

    pub(crate) fn checkpoint(&mut self) -> io::Result<()> {
        self.write_group()?;
        self.file.flush()?;
        let rows = std::mem::take(self.file.inner_mut());
        let after_rows = self.length + rows.len() as u64;
        let description = self.described().map_err(failed)?;
        let before = std::mem::replace(&mut self.description, description);
        self.writer.seek(SeekFrom::Start(after_rows))?;
        self.writer.write_all(&before)?;
        self.writer.flush()?;
        self.writer.seek(SeekFrom::Start(self.length))?;
        self.writer.write_all(&rows)?;
        self.writer.flush()?;
        self.writer.seek(SeekFrom::Start(after_rows + before.len() as u64))?;
        self.writer.write_all(&self.description)?;
        self.writer.flush()?;
        // What the file has, so that it knows where the next rows will be.
        self.file.write_all(&before)?;
        self.file.write_all(&self.description)?;
        self.file.flush()?;
        self.file.inner_mut().clear();
        self.length = self.file.bytes_written() as u64;
        Ok(())
    }

    pub(crate) fn finish(mut self) -> io::Result<W> {
        if self.description.is_empty() || !self.rows.steps.is_empty() || self.file.bytes_written() as u64 > self.length
        {
            self.checkpoint()?;
        }
        Ok(self.writer)
    }

    fn write_group(&mut self) -> io::Result<()> {
        write_group(&mut self.file, &mut self.rows, &mut self.recorded).map_err(failed)
    }

    /// What a file ends with whose last rows are those written until now.
    fn described(&self) -> Result<Vec<u8>, ParquetError> {
        let properties = self.file.properties();
        let metadata = FileMetaData::new(
            properties.writer_version().as_num(),
            self.recorded,
            Some(properties.created_by().to_owned()),
            properties.key_value_metadata().cloned(),
            Arc::new(self.file.schema_descr().clone()),
            None,
        );
        let metadata = ParquetMetaData::new(metadata, self.file.flushed_row_groups().to_vec());
        let mut bytes = Vec::new();
        ParquetMetaDataWriter::new(&mut bytes, &metadata).finish()?;
        Ok(bytes)
    }
}

/// Writes what rows there are as a group.
fn write_group(
    file: &mut SerializedFileWriter<Vec<u8>>,
    rows: &mut Rows,
    recorded: &mut i64,
) -> Result<(), ParquetError> {
    if rows.steps.is_empty() {
        return Ok(());
    }
    let mut group = file.next_row_group()?;
    write_column::<Int64Type>(&mut group, &rows.steps)?;
    write_column::<DoubleType>(&mut group, &rows.times)?;
    write_column::<ByteArrayType>(&mut group, &rows.names)?;
    for column in &rows.states {
        write_column::<RealType>(&mut group, column)?;
    }
    group.close()?;
    *recorded += rows.steps.len() as i64;
    rows.steps.clear();
    rows.times.clear();
    rows.names.clear();
    rows.states.iter_mut().for_each(Vec::clear);
    Ok(())
}

fn write_column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, Vec<u8>>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    column.typed::<T>().write_batch(values, None, None)?;
    column.close()
}

fn schema() -> Result<Type, ParquetError> {
    let column = |name: &str, physical, logical: Option<LogicalType>| {
        let column = Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED);
        column.with_logical_type(logical).build().map(Arc::new)
    };
    let [step, time, body, ..] = COLUMNS;
    let unsigned = LogicalType::integer(64, false);
    let mut columns = vec![
        column(step, PhysicalType::INT64, Some(unsigned))?,
        column(time, PhysicalType::DOUBLE, None)?,
        column(body, PhysicalType::BYTE_ARRAY, Some(LogicalType::String))?,
    ];
    for name in STATE_COLUMNS {
        columns.push(column(name, RealType::get_physical_type(), None)?);
    }
    Type::group_type_builder("state").with_fields(columns).build()
}

/// Step, time and name are the same in many rows, so each group lists those it has and counts how
/// often they follow each other; and their least and largest are noted, so that readers can skip
/// groups. Of the numbers of a state hardly two are equal.
fn properties() -> WriterProperties {
    let mut properties = WriterProperties::builder()
        .set_created_by(concat!("tumble ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_offset_index_disabled(true)
        .set_key_value_metadata(Some(metadata()));
    for name in COLUMNS.into_iter().take(COLUMNS.len() - STATE_COLUMNS.len()) {
        let column = ColumnPath::from(name);
        properties = properties
            .set_column_dictionary_enabled(column.clone(), true)
            .set_column_statistics_enabled(column, EnabledStatistics::Chunk);
    }
    for name in STATE_COLUMNS {
        properties =
            properties.set_column_encoding(ColumnPath::from(name), parquet::basic::Encoding::BYTE_STREAM_SPLIT);
    }
    properties.build()
}

fn metadata() -> Vec<KeyValue> {
    let entries = [
        ("source", "tumble"),
        ("version", env!("CARGO_PKG_VERSION")),
        ("precision", PRECISION),
        (
            "frame",
            "world; position and velocity of the centre of mass, orientation (x, y, z, w) from the body's frame to the world",
        ),
        ("units", "time s, position m, velocity m/s, angular velocity rad/s"),
    ];
    entries.map(|(key, value)| KeyValue::new(key.to_owned(), value.to_owned())).into()
}

fn failed(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
