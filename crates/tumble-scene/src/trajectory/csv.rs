use std::io::{self, Write};

use super::frame::Frame;
use super::{COLUMNS, state_numbers};
use crate::csv_cell::csv_cell;

/// One line for each body and frame.
#[derive(Debug)]
pub(super) struct CsvRecord<W: Write> {
    csv: csv::Writer<W>,
}

impl<W: Write> CsvRecord<W> {
    pub(super) fn new(writer: W) -> io::Result<Self> {
        let mut csv = csv::Writer::from_writer(writer);
        csv.write_record(COLUMNS)?;
        Ok(Self { csv })
    }

    pub(super) fn record(&mut self, frame: &Frame<'_>) -> io::Result<()> {
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

    pub(super) fn checkpoint(&mut self) -> io::Result<()> {
        self.csv.flush()
    }

    pub(super) fn finish(self) -> io::Result<W> {
        self.csv.into_inner().map_err(csv::IntoInnerError::into_error)
    }
}
