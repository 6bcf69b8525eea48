//! Apache Parquet. Readers look for the description of a file at its end; so after every few groups of rows a whole description
//! is written, which the next group simply follows. Readers of the finished file never look at those in its middle.

use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::{FileMetaData, KeyValue, ParquetMetaData, ParquetMetaDataWriter};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type};
use tumble::math::{PRECISION, Real};

use super::frame::Frame;
use super::{COLUMNS, STATE_COLUMNS, state_numbers};

/// The type of the state's numbers in a file.
#[cfg(not(feature = "f64"))]
type RealType = parquet::data_type::FloatType;
#[cfg(feature = "f64")]
type RealType = DoubleType;

/// Rows of a group, which are held in memory: about five megabytes of them in single precision.
const GROUP_ROWS: usize = 1 << 16;

/// A description is written when there is so many times as much that is new. So all of them together are at most this part of
/// the file.
const DESCRIPTION_SHARE: u64 = 8;

/// One row for each body and frame.
pub(super) struct ParquetRecord<W: Write + Send> {
    file: SerializedFileWriter<W>,
    names: HashMap<u64, ByteArray>,
    rows: Rows,
    recorded: i64,
    /// Where the last description ends, and how long it is.
    described: u64,
    description: u64,
}

/// The columns of a group.
#[derive(Default)]
struct Rows {
    steps: Vec<i64>,
    times: Vec<f64>,
    names: Vec<ByteArray>,
    states: [Vec<Real>; 13],
}

impl<W: Write + Send> std::fmt::Debug for ParquetRecord<W> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("ParquetRecord").field("recorded", &self.recorded).finish_non_exhaustive()
    }
}

impl<W: Write + Send> ParquetRecord<W> {
    pub(super) fn new(writer: W) -> io::Result<Self> {
        let schema = schema().map_err(failed)?;
        let file = SerializedFileWriter::new(writer, Arc::new(schema), Arc::new(properties())).map_err(failed)?;
        Ok(Self { file, names: HashMap::new(), rows: Rows::default(), recorded: 0, described: 0, description: 0 })
    }

    pub(super) fn record(&mut self, frame: &Frame<'_>) -> io::Result<()> {
        frame.for_each(|id, pose, velocity| {
            let name = self.names.entry(id).or_insert_with(|| frame.names.of(id).as_bytes().to_vec().into());
            self.rows.names.push(name.clone());
            // The column is unsigned, which in the format is the same 64 bits.
            self.rows.steps.push(frame.step.cast_signed());
            self.rows.times.push(frame.time);
            for (column, number) in self.rows.states.iter_mut().zip(state_numbers(pose, velocity)) {
                column.push(number);
            }
            if self.rows.steps.len() >= GROUP_ROWS {
                write_group(&mut self.file, &mut self.rows, &mut self.recorded).map_err(failed)?;
            }
            Ok(())
        })
    }

    /// Whether enough is new for another description.
    pub(super) fn is_worth_a_checkpoint(&self) -> bool {
        let pending = self.rows.steps.len() * (size_of::<[Real; 13]>() + size_of::<[f64; 2]>());
        self.file.bytes_written() as u64 - self.described + pending as u64 >= DESCRIPTION_SHARE * self.description
    }

    pub(super) fn checkpoint(&mut self) -> io::Result<()> {
        write_group(&mut self.file, &mut self.rows, &mut self.recorded).map_err(failed)?;
        let description = self.description().map_err(failed)?;
        self.file.write_all(&description)?;
        self.description = description.len() as u64;
        self.described = self.file.bytes_written() as u64;
        self.file.flush()
    }

    pub(super) fn finish(mut self) -> io::Result<W> {
        write_group(&mut self.file, &mut self.rows, &mut self.recorded).map_err(failed)?;
        self.file.into_inner().map_err(failed)
    }

    /// What a file ends with whose last rows are those written until now.
    fn description(&self) -> Result<Vec<u8>, ParquetError> {
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
fn write_group<W: Write + Send>(
    file: &mut SerializedFileWriter<W>,
    rows: &mut Rows,
    recorded: &mut i64,
) -> Result<(), ParquetError> {
    if rows.steps.is_empty() {
        return Ok(());
    }
    let mut group = file.next_row_group()?;
    write_column::<Int64Type, W>(&mut group, &rows.steps)?;
    write_column::<DoubleType, W>(&mut group, &rows.times)?;
    write_column::<ByteArrayType, W>(&mut group, &rows.names)?;
    for column in &rows.states {
        write_column::<RealType, W>(&mut group, column)?;
    }
    group.close()?;
    *recorded += rows.steps.len() as i64;
    rows.steps.clear();
    rows.times.clear();
    rows.names.clear();
    rows.states.iter_mut().for_each(Vec::clear);
    Ok(())
}

fn write_column<T: DataType, W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
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

/// Step, time and name are the same in many rows, so each group lists those it has and counts how often they follow each other; and
/// their least and largest are noted, so that readers can skip groups. Of the numbers of a state hardly two are equal.
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
    match error {
        ParquetError::External(error) => match error.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(error) => io::Error::other(error),
        },
        error => io::Error::other(error),
    }
}
