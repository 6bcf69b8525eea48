//! The picture of a sweep, drawn from its file.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use tumble_record::{PendingFile, Plot, Scale, SeriesStyle, csv_cell};
use tumble_sweep::{SweepFileError, SweepReader};

use crate::ending::check_ending;
use crate::failure::Failure;
use crate::replacing::{Guard, Kind};
use crate::sweep::options::PlotOptions;

/// Points of a picture: more cannot be told apart, and a picture of all worlds would have no
/// bounds.
const MAX_POINTS: u64 = 5000;

/// Characters that the picture has room for: it is 650 by 316 pixels between its axes' ends, and a
/// character about 7 wide, 8.5 in the title.
const LONGEST_TITLE: usize = 76;
const LONGEST_X: usize = 90;
const LONGEST_Y: usize = 44;

/// A picture that is to be drawn when the file is whole; tried before, so that what cannot be
/// written is known early.
pub(crate) struct SweepPlot {
    path: PathBuf,
    axes: [(String, usize); 2],
}

impl SweepPlot {
    /// `None` where none is asked for.
    pub(crate) fn open(
        options: &PlotOptions,
        columns: &[String],
        inputs: Vec<PathBuf>,
    ) -> Result<Option<Self>, Failure> {
        let Some(path) = options.plot.clone() else { return Ok(None) };
        check_ending(&path, "a plot", "svg")?;
        Guard { inputs, force: options.force }.check(&path, Kind::Picture)?;
        // What follows the world is the first field that varies; where nothing does, it is the
        // outcome.
        let first = columns.get(1).filter(|column| *column != "outcome").map_or("world", String::as_str);
        let column = |option: &str, name: &str| match columns
            .iter()
            .position(|column| column == name || *column == csv_cell(name))
        {
            Some(_) if ["outcome", "hash"].contains(&name) => {
                Err(Failure::Input(format!("{option} {name:?}: is no number and cannot be drawn")))
            }
            Some(at) => Ok((name.to_owned(), at)),
            None => Err(Failure::Input(format!(
                "{option} {name:?}: there is no such column; there are {}",
                columns.join(", ")
            ))),
        };
        let x = column("--x", options.x.as_deref().unwrap_or(first))?;
        let y = column("--y", options.y.as_deref().unwrap_or("energy_drift"))?;
        // Not kept open: a sweep that is killed would leave it behind.
        drop(PendingFile::create(&path).map_err(|error| Failure::opening(&path, &error))?);
        Ok(Some(Self { path, axes: [x, y] }))
    }

    /// Draws what is in the file, at most 5000 worlds at equal distances.
    pub(crate) fn draw(self, from: &Path, scene: &str) -> Result<(), Failure> {
        let points = self.points(from).map_err(|error| Failure::Running(error.to_string()))?;
        let [(x, _), (y, _)] = &self.axes;
        let scale = if y == "energy_drift" { Scale::Log } else { Scale::Linear };
        let plot = Plot::new(shortened(&format!("Sweep of {scene}"), LONGEST_TITLE))
            .x_axis(shortened(x, LONGEST_X), Scale::Linear)
            .y_axis(shortened(y, LONGEST_Y), scale)
            .series("", SeriesStyle::Cloud, points);
        let written = PendingFile::create(&self.path).and_then(|mut file| {
            file.write_all(plot.to_svg().as_bytes())?;
            file.finish()
        });
        written.map_err(|error| Failure::writing(&self.path, &error))
    }

    fn points(&self, from: &Path) -> Result<Vec<(f64, f64)>, SweepFileError> {
        let mut reader = SweepReader::open(from)?;
        let worlds = reader.worlds();
        let stride = (worlds.end - worlds.start).div_ceil(MAX_POINTS).max(1);
        let [(_, x), (_, y)] = self.axes;
        let mut points = Vec::new();
        loop {
            let world = reader.next_world();
            let Some(row) = reader.next_row()? else { break };
            if (world - worlds.start).is_multiple_of(stride) {
                let row = String::from_utf8_lossy(row);
                // A world that did not come to its end has nothing in its columns, and no place in
                // the picture.
                let field = |at: usize| row.trim_end().split(',').nth(at).and_then(|field| field.parse::<f64>().ok());
                points.extend(field(x).zip(field(y)));
            }
        }
        // From left to right, so that points on one spot are drawn once.
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Ok(points)
    }
}

/// Without its middle where it is too long, for both ends say what it is.
fn shortened(label: &str, most: usize) -> String {
    let length = label.chars().count();
    if length <= most {
        return label.to_owned();
    }
    let (front, back) = (most / 2, most - most / 2 - 1);
    label.chars().take(front).chain(['…']).chain(label.chars().skip(length - back)).collect()
}
