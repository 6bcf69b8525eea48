//! Binary glTF 2.0, written while the run goes on.
//!
//! An animation in glTF is one array of times and, for each body, one array of translations and one
//! of rotations, each in one piece. The number of frames is known before the first step, so every
//! array has its place from the start, and frames are kept back until there are enough to write a
//! piece of each. The numbers of frames that are there already, which viewers read, stand
//! together at the beginning of the file, in fields of fixed width, and are rewritten at every
//! checkpoint.

pub(crate) mod bodies;
pub(crate) mod document;
pub(crate) mod geometry;
pub(crate) mod layout;
pub(crate) mod sample;

use std::io::{self, BufWriter, Seek, SeekFrom, Write};

use tumble::Pose;
use tumble_import::Appearance;

use crate::trajectory::error::TrajectoryError;
use crate::trajectory::frame::Frame;
pub(crate) use crate::trajectory::glb::bodies::Bodies;
use crate::trajectory::glb::layout::Layout;
pub(crate) use crate::trajectory::glb::sample::{Sample, single};

/// Frames that are kept back take at most that much, but for one of more bodies \[bytes\].
const PENDING_BYTES: u64 = 16 << 20;

/// What is to be known of a run before its first step, to record it as an animation.
///
/// ```
/// use std::io::Cursor;
/// use tumble_record::{Animation, Frame, TrajectoryWriter};
/// use tumble_scene::Scene;
///
/// let scene = Scene::open("mujoco-box")?;
/// let animation = Animation::of(&scene, 100, 1)?;
/// let mut world = hecs::World::new();
/// let names = scene.spawn(&mut world)?;
/// let mut writer = TrajectoryWriter::glb(Cursor::new(Vec::new()), animation);
/// let order = tumble::BodyOrder::of(&world);
/// writer.record(&Frame { step: 0, time: 0.0, world: &world, order: &order, names: &names })?;
/// assert_eq!(writer.finish()?.into_inner()[..4], *b"glTF");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Animation {
    /// Name of the scene.
    pub scene: String,
    /// What the bodies look like in their own frames, by [`BodyId`](tumble::BodyId). A body that
    /// has none here is drawn as a point.
    pub appearance: Vec<Appearance>,
    /// Time step \[s\].
    pub dt: f64,
    /// Steps from one frame to the next.
    pub every: u64,
    /// The most frames that will be recorded. For all of them the file has room from the start.
    pub frames: u64,
}

impl Animation {
    /// Of `steps` steps of a scene, of which every `every`-th is recorded, and the state before the
    /// first.
    ///
    /// # Errors
    /// As [`Scene::appearance`](tumble_scene::Scene::appearance).
    #[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
    pub fn of(scene: &tumble_scene::Scene, steps: u64, every: u64) -> Result<Self, tumble_scene::SceneError> {
        Ok(Self {
            scene: scene.name.clone().unwrap_or_else(|| scene.origin.clone()),
            appearance: scene.appearance()?,
            dt: f64::from(scene.settings.dt),
            every,
            frames: (steps / every.max(1)).saturating_add(1),
        })
    }
}

#[derive(Debug)]
pub(crate) struct GlbRecord<W> {
    writer: W,
    animation: Animation,
    /// From the first frame on.
    opened: Option<Opened>,
}

#[derive(Debug)]
struct Opened {
    bodies: Bodies,
    layout: Layout,
    /// Frames that are in the file.
    written: u64,
    /// Of the frames that are kept back, of increasing times.
    times: Vec<f32>,
    /// Of the moving bodies in those frames, frame by frame.
    pending: Vec<Sample>,
    /// Of the last frame in the file.
    last_time: f32,
}

impl<W: Write + Seek> GlbRecord<W> {
    pub(crate) fn new(writer: W, animation: Animation) -> Self {
        Self { writer, animation, opened: None }
    }

    pub(crate) fn record(&mut self, frame: &Frame<'_>) -> Result<(), TrajectoryError> {
        let opened = match &mut self.opened {
            Some(opened) => opened,
            None => {
                let opened = Opened::begin(&mut self.writer, &self.animation, frame)?;
                self.animation.appearance = Vec::new();
                self.opened.insert(opened)
            }
        };
        opened.push(frame)?;
        if opened.is_full() {
            opened.write_pending(&mut self.writer)?;
        }
        Ok(())
    }

    pub(crate) fn checkpoint(&mut self) -> io::Result<()> {
        if let Some(opened) = &mut self.opened {
            opened.write_pending(&mut self.writer)?;
            opened.write_counts(&mut self.writer)?;
        }
        self.writer.flush()
    }

    pub(crate) fn finish(mut self) -> io::Result<W> {
        self.checkpoint()?;
        Ok(self.writer)
    }
}

impl Opened {
    /// Writes all but the frames: the document, with none of them yet, and the meshes.
    fn begin(
        writer: &mut (impl Write + Seek),
        animation: &Animation,
        frame: &Frame<'_>,
    ) -> Result<Self, TrajectoryError> {
        let bodies = Bodies::of(frame, &animation.appearance);
        let mut layout = Layout::new(&bodies, animation.frames, single(frame.time));
        let too_large = |bytes| TrajectoryError::TooLarge { bodies: bodies.len(), frames: animation.frames, bytes };
        if layout.buffer_bytes() > Layout::MAX_BYTES {
            return Err(too_large(layout.buffer_bytes()));
        }
        let mut buffered = BufWriter::new(&mut *writer);
        layout.json_bytes = document::write(&mut buffered, animation, &bodies, &layout)?;
        if layout.file_bytes() > Layout::MAX_BYTES {
            return Err(too_large(layout.file_bytes()));
        }
        layout.write_headers(&mut buffered)?;
        bodies.geometry.write(&mut buffered)?;
        // The file has its full length from here on, as its header says; what is not yet written
        // takes no space on the disk.
        let last = layout.file_bytes() - 1;
        if buffered.stream_position()? < last {
            buffered.seek(SeekFrom::Start(last))?;
            buffered.write_all(&[0])?;
        }
        buffered.flush()?;
        drop(buffered);
        Ok(Self { bodies, layout, written: 0, times: Vec::new(), pending: Vec::new(), last_time: 0.0 })
    }

    fn push(&mut self, frame: &Frame<'_>) -> io::Result<()> {
        let recorded = self.written + self.times.len() as u64;
        let time = single(frame.time);
        let last = self.times.last().copied().or((self.written > 0).then_some(self.last_time));
        // Times of an animation increase. Steps that f32 cannot tell apart are one frame.
        if last.is_some_and(|last| time <= last) || time.is_nan() {
            return Ok(());
        }
        if recorded >= self.layout.frames {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "more frames than were announced"));
        }
        self.times.push(time);
        let poses = frame.world.view::<&Pose>();
        for body in self.bodies.moving() {
            if let Some(sample) =
                poses.get(body.entity).and_then(|pose| Sample::of(pose, body.center, Some(&body.sample)))
            {
                body.sample = sample;
            }
            // What is no longer there, or nowhere, stays where it was.
            self.pending.push(body.sample);
        }
        Ok(())
    }

    fn is_full(&self) -> bool {
        (self.pending.len() * size_of::<Sample>() + self.times.len() * size_of::<f32>()) as u64 >= PENDING_BYTES
    }

    /// Writes the frames that were kept back, each array's piece to its place.
    fn write_pending(&mut self, writer: &mut (impl Write + Seek)) -> io::Result<()> {
        let (frames, moving) = (self.times.len(), self.layout.moving as usize);
        let Some(&last_time) = self.times.last() else { return Ok(()) };
        if moving > 0 {
            let mut bytes = Vec::with_capacity(frames * size_of::<[f32; 4]>());
            bytes.extend(self.times.iter().flat_map(|time| time.to_le_bytes()));
            writer.seek(SeekFrom::Start(self.layout.time_at(self.written)))?;
            writer.write_all(&bytes)?;
            for body in 0..moving {
                let samples = || self.pending.iter().skip(body).step_by(moving);
                bytes.clear();
                bytes.extend(samples().flat_map(|sample| sample.translation).flat_map(f32::to_le_bytes));
                writer.seek(SeekFrom::Start(self.layout.translation_at(body as u64, self.written)))?;
                writer.write_all(&bytes)?;
                bytes.clear();
                bytes.extend(samples().flat_map(|sample| sample.rotation).flat_map(f32::to_le_bytes));
                writer.seek(SeekFrom::Start(self.layout.rotation_at(body as u64, self.written)))?;
                writer.write_all(&bytes)?;
            }
        }
        self.written += frames as u64;
        self.last_time = last_time;
        self.times.clear();
        self.pending.clear();
        Ok(())
    }

    /// Says in the document how many frames there are. In one write, which a kill is least likely
    /// to cut.
    fn write_counts(&mut self, writer: &mut (impl Write + Seek)) -> io::Result<()> {
        writer.seek(SeekFrom::Start(document::ACCESSORS_AT))?;
        writer.write_all(&document::track_accessors(&self.layout, self.written, self.last_time))
    }
}
