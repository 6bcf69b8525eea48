//! The record of a run: one line a body and step.

use std::io::{self, Write};

use hecs::World;
use tumble::math::Real;
use tumble::{BodyId, BodyOrder, Pose, Velocity};

use crate::Names;

/// The first line of a record.
pub const COLUMNS: [&str; 16] =
    ["step", "time", "body", "px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz"];

/// What is written of a body's state: the names that [`COLUMNS`] ends with.
pub const STATE_COLUMNS: [&str; 13] = {
    let [_step, _time, _body, state @ ..] = COLUMNS;
    state
};

/// The numbers of [`STATE_COLUMNS`]. A fixed body has no velocity, and zeros are written.
pub fn state_numbers(pose: &Pose, velocity: Option<&Velocity>) -> [Real; 13] {
    let velocity = velocity.copied().unwrap_or_default();
    let ([px, py, pz], [qx, qy, qz, qw]) = (pose.position.to_array(), pose.orientation.to_array());
    let ([vx, vy, vz], [wx, wy, wz]) = (velocity.linear.to_array(), velocity.angular.to_array());
    [px, py, pz, qx, qy, qz, qw, vx, vy, vz, wx, wy, wz]
}

/// Writes states as comma-separated values, one after the other in bounded memory.
///
/// SI units, world frame: the centre of mass, the orientation of the body's own frame (`x, y, z, w`, body to
/// world), the velocity of the centre of mass, the angular velocity. Numbers have the fewest
/// digits that read back to the same bits in the build's precision (`time` always in f64); what is
/// not finite is written `NaN`, `inf` or `-inf`.
///
/// ```
/// use tumble_scene::{Scene, TrajectoryWriter};
///
/// let scene = Scene::open("mujoco-box")?;
/// let mut world = hecs::World::new();
/// let names = scene.spawn(&mut world)?;
/// let mut text = Vec::new();
/// let mut writer = TrajectoryWriter::new(&mut text)?;
/// writer.record(0, 0.0, &world, &tumble::BodyOrder::of(&world), &names)?;
/// writer.finish()?;
/// assert_eq!(
///     String::from_utf8(text)?,
///     "step,time,body,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz\n\
///      0,0.0,box,0.0,0.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,1.0,2.0,3.0\n",
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct TrajectoryWriter<W: Write> {
    csv: csv::Writer<W>,
}

impl<W: Write> TrajectoryWriter<W> {
    /// Writes the first line.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn new(writer: W) -> io::Result<Self> {
        let mut csv = csv::Writer::from_writer(writer);
        csv.write_record(COLUMNS)?;
        Ok(Self { csv })
    }

    /// Writes one line for each body, in their order. `Velocity` must be that of the state: run
    /// [`update_derived`](tumble::update_derived) before.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn record(&mut self, step: u64, time: f64, world: &World, order: &BodyOrder, names: &Names) -> io::Result<()> {
        let (mut digits, mut shortest) = (itoa::Buffer::new(), zmij::Buffer::new());
        let (step, time) = (digits.format(step), shortest.format(time).to_owned());
        let states = world.view::<(&Pose, Option<&Velocity>, Option<&BodyId>)>();
        for (index, &entity) in order.entities().iter().enumerate() {
            let Some((pose, velocity, id)) = states.get(entity) else { continue };
            self.csv.write_field(step)?;
            self.csv.write_field(&time)?;
            self.csv.write_field(&*names.of(id.map_or(index as u64, |id| id.0)))?;
            self.numbers(&state_numbers(pose, velocity))?;
            self.csv.write_record(None::<&[u8]>)?;
        }
        Ok(())
    }

    /// Passes on what is buffered and gives the writer back.
    ///
    /// # Errors
    /// Whatever the writer says.
    pub fn finish(self) -> io::Result<W> {
        self.csv.into_inner().map_err(csv::IntoInnerError::into_error)
    }

    fn numbers(&mut self, numbers: &[Real]) -> io::Result<()> {
        let mut shortest = zmij::Buffer::new();
        for &number in numbers {
            self.csv.write_field(shortest.format(number))?;
        }
        Ok(())
    }
}
