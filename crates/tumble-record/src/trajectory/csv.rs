//! The CSV trajectory writer: one row per body and frame.

use std::io::{self, Write};

use crate::csv_cell::csv_cell;
use crate::trajectory::frame::Frame;
use crate::trajectory::{COLUMNS, state_numbers};

/// One line for each body and frame.
#[derive(Debug)]
pub(crate) struct CsvRecord<W: Write> {
    csv: csv::Writer<W>,
}

impl<W: Write> CsvRecord<W> {
    pub(crate) fn new(writer: W) -> io::Result<Self> {
        let mut csv = csv::Writer::from_writer(writer);
        csv.write_record(COLUMNS)?;
        Ok(Self { csv })
    }

    pub(crate) fn record(&mut self, frame: &Frame<'_>) -> io::Result<()> {
        let (mut digits, mut shortest) = (itoa::Buffer::new(), zmij::Buffer::new());
        let (step, time) = (digits.format(frame.step), shortest.format(frame.time).to_owned());
        frame.for_each(|id, pose, velocity| {
            self.csv.write_field(step)?;
            self.csv.write_field(&time)?;
            self.csv.write_field(&*csv_cell(&frame.names.of(id)))?;
            let mut shortest = zmij::Buffer::new();
            for number in state_numbers(pose, velocity) {
                self.csv.write_field(shortest.format(number))?;
            }
            self.csv.write_record(None::<&[u8]>)?;
            Ok(())
        })
    }

    pub(crate) fn checkpoint(&mut self) -> io::Result<()> {
        self.csv.flush()
    }

    pub(crate) fn finish(self) -> io::Result<W> {
        self.csv.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}
