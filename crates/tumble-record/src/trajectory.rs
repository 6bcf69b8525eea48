//! The record of a run: the states of all bodies at some of its steps.

pub(crate) mod csv;
pub(crate) mod error;
pub(crate) mod format;
pub(crate) mod frame;
pub(crate) mod glb;
pub(crate) mod pace;
#[cfg(feature = "parquet")]
pub(crate) mod parquet;

use std::io::{self, Seek, Write};

use tumble::math::Real;
use tumble::{Pose, Velocity};

pub(crate) use crate::trajectory::frame::Frame;
use crate::trajectory::pace::Pace;

pub(crate) use crate::trajectory::error::TrajectoryError;
pub(crate) use crate::trajectory::glb::Animation;

/// The columns of a record.
pub const COLUMNS: [&str; 16] =
    ["step", "time", "body", "px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz"];

/// What is written of a body's state: the names that [`COLUMNS`] ends with.
pub const STATE_COLUMNS: [&str; 13] = {
    let [_step, _time, _body, state @ ..] = COLUMNS;
    state
};

/// The numbers of [`STATE_COLUMNS`]. A fixed body has no velocity, and zeros are written.
///
/// ```
/// use tumble::{Pose, Velocity, math::Vec3};
/// use tumble_record::state_numbers;
///
/// let numbers = state_numbers(
///     &Pose::default(),
///     Some(&Velocity { linear: Vec3::X * 3.0, angular: Vec3::ZERO }),
/// );
/// assert_eq!((numbers[6], numbers[7]), (1.0, 3.0)); // qw and vx
/// ```
pub fn state_numbers(pose: &Pose, velocity: Option<&Velocity>) -> [Real; 13] {
    let velocity = velocity.copied().unwrap_or_default();
    let ([px, py, pz], [qx, qy, qz, qw]) = (pose.position.to_array(), pose.orientation.to_array());
    let ([vx, vy, vz], [wx, wy, wz]) = (velocity.linear.to_array(), velocity.angular.to_array());
    [px, py, pz, qx, qy, qz, qw, vx, vy, vz, wx, wy, wz]
}

/// Writes states, one frame after the other, in memory that does not grow with their number.
///
/// What has been written is readable at every [`checkpoint`](Self::checkpoint), which comes by
/// itself about once a second, so a program that is killed leaves what it recorded until then.
/// Formats, columns and units are described in the guide to trajectories.
///
/// As comma-separated values, numbers have the fewest digits that read back to the same bits in the
/// build's precision (`time` always in f64); what is not finite is written `NaN`, `inf` or `-inf`.
///
/// ```
/// use std::io::Cursor;
/// use tumble_record::{Frame, TrajectoryWriter};
/// use tumble_scene::Scene;
///
/// let scene = Scene::open("mujoco-box")?;
/// let mut world = hecs::World::new();
/// let names = scene.spawn(&mut world)?;
/// let mut writer = TrajectoryWriter::csv(Cursor::new(Vec::new()))?;
/// let order = tumble::BodyOrder::of(&world);
/// writer.record(&Frame { step: 0, time: 0.0, world: &world, order: &order, names: &names })?;
/// assert_eq!(
///     String::from_utf8(writer.finish()?.into_inner())?,
///     "step,time,body,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz\n\
///      0,0.0,box,0.0,0.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,2.0,3.0\n",
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TrajectoryWriter<W: Write + Seek> {
    record: Record<W>,
    pace: Pace,
}

#[derive(Debug)]
enum Record<W: Write + Seek> {
    Csv(Box<csv::CsvRecord<W>>),
    #[cfg(feature = "parquet")]
    Parquet(Box<parquet::ParquetRecord<W>>),
    Glb(Box<glb::GlbRecord<W>>),
}

impl<W: Write + Seek> TrajectoryWriter<W> {
    /// Comma-separated values: writes the first line.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn csv(writer: W) -> io::Result<Self> {
        Ok(Self::of(Record::Csv(Box::new(csv::CsvRecord::new(writer)?))))
    }

    /// Apache Parquet, the columns those of [`COLUMNS`].
    ///
    /// # Errors
    /// Whatever the writer says.
    #[cfg(feature = "parquet")]
    pub fn parquet(writer: W) -> io::Result<Self> {
        Ok(Self::of(Record::Parquet(Box::new(parquet::ParquetRecord::new(writer)?))))
    }

    /// Binary glTF 2.0: the bodies as meshes, their motion as an animation. Nothing is written
    /// before the first frame, whose bodies are those of the file. The writer is to stand at the
    /// beginning of an empty file.
    pub fn glb(writer: W, animation: Animation) -> Self {
        Self::of(Record::Glb(Box::new(glb::GlbRecord::new(writer, animation))))
    }

    fn of(record: Record<W>) -> Self {
        Self { record, pace: Pace::default() }
    }

    /// Writes the state of each body, in their order.
    ///
    /// # Errors
    /// Whatever the writer says; with the first frame, [`TrajectoryError::TooLarge`].
    pub fn record(&mut self, frame: &Frame<'_>) -> Result<(), TrajectoryError> {
        match &mut self.record {
            Record::Csv(csv) => csv.record(frame)?,
            #[cfg(feature = "parquet")]
            Record::Parquet(parquet) => parquet.record(frame)?,
            Record::Glb(glb) => glb.record(frame)?,
        }
        Ok(self.keep_pace()?)
    }

    /// Makes a checkpoint if one is due. To be called now and then where long times pass between
    /// two frames.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn keep_pace(&mut self) -> io::Result<()> {
        let due = match &self.record {
            #[cfg(feature = "parquet")]
            Record::Parquet(parquet) if !parquet.is_worth_a_checkpoint() => false,
            _ => self.pace.is_due(),
        };
        if due { self.checkpoint() } else { Ok(()) }
    }

    /// Makes everything recorded until now readable, and passes it on.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn checkpoint(&mut self) -> io::Result<()> {
        self.pace.begin();
        match &mut self.record {
            Record::Csv(csv) => csv.checkpoint(),
            #[cfg(feature = "parquet")]
            Record::Parquet(parquet) => parquet.checkpoint(),
            Record::Glb(glb) => glb.checkpoint(),
        }?;
        self.pace.end();
        Ok(())
    }

    /// Writes what is left and gives the writer back.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn finish(self) -> io::Result<W> {
        match self.record {
            Record::Csv(csv) => csv.finish(),
            #[cfg(feature = "parquet")]
            Record::Parquet(parquet) => parquet.finish(),
            Record::Glb(glb) => glb.finish(),
        }
    }
}
