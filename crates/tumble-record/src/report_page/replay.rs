//! What is shown of a run, collected while it goes on.

use tumble_import::Appearance;
use tumble_scene::{Scene, SceneError};

use crate::report_page::choice::choose;
use crate::report_page::figures::{count, figure, rounded};
use crate::report_page::frames::Frames;
use crate::report_page::joints::Joints;
use crate::report_page::surfaces::Surfaces;
use crate::trajectory::frame::Frame;
use crate::trajectory::glb::bodies::Bodies;
use crate::trajectory::glb::sample::double;

/// Of more bodies there would be too few frames.
const MAX_BODIES: usize = 10_000;
/// Meshes and frames together, before a third is added to write them as text \[bytes\].
const BYTES: u64 = 9 << 20;
/// Of these, what meshes may have \[bytes\].
const MESH_BYTES: u64 = 4 << 20;

/// The motion of a scene's bodies, thinned out to what a page can show, in memory that does not
/// grow with the run.
///
/// Of more than ten thousand bodies ten thousand are kept. Frames are kept at every k-th step, with
/// k doubled whenever they are too many. [`left_out`](Self::left_out) says what is missing.
///
/// ```
/// use tumble_record::{Frame, Replay};
/// use tumble_scene::Scene;
///
/// let scene = Scene::stress(12_000, 0)?;
/// let mut simulation = tumble::Simulation::new(scene.settings)?;
/// let mut replay = Replay::of(&scene)?;
/// let mut world = hecs::World::new();
/// let names = scene.spawn(&mut world)?;
/// let order = tumble::BodyOrder::of(&world);
/// replay.record(&Frame { step: 0, time: 0.0, world: &world, order: &order, names: &names });
/// simulation.step(&mut world);
/// replay.finish(&Frame {
///     step: 1,
///     time: simulation.time(),
///     world: &world,
///     order: &order,
///     names: &names,
/// });
/// assert!(replay.left_out()[0].contains("of the 12\u{202f}000 bodies are shown"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Replay {
    title: String,
    description: Option<String>,
    notices: Vec<String>,
    /// The axis that points up: 0, 1 or 2.
    up: usize,
    bodies: usize,
    chosen: Vec<usize>,
    /// Of those that are chosen; empty from the first frame on.
    appearance: Vec<Appearance>,
    shown: Option<Shown>,
}

/// From the first frame on.
#[derive(Debug)]
pub(crate) struct Shown {
    pub(crate) bodies: Bodies,
    pub(crate) surfaces: Surfaces,
    pub(crate) frames: Frames,
    pub(crate) joints: Joints,
}

impl Replay {
    /// Of a scene that is about to be run.
    ///
    /// # Errors
    /// As [`Scene::appearance`].
    pub fn of(scene: &Scene) -> Result<Self, SceneError> {
        let chosen = choose(scene.body_count(), MAX_BODIES, |index| !scene.is_free(index));
        let gravity = scene.settings.gravity.to_array().map(|part| double(part).abs());
        let along = |axis: usize| gravity.get(axis).copied().unwrap_or_default();
        Ok(Self {
            title: scene.name.clone().unwrap_or_else(|| scene.origin.clone()),
            description: scene.description.clone(),
            notices: scene.notices.clone(),
            up: [0, 2].into_iter().fold(1, |up, axis| if along(axis) > along(up) { axis } else { up }),
            bodies: scene.body_count(),
            appearance: scene.appearance_of(&chosen)?,
            chosen,
            shown: None,
        })
    }

    /// Steps from one frame to the next; it may double with every frame.
    #[must_use]
    pub fn every(&self) -> u64 {
        self.shown.as_ref().map_or(1, |shown| shown.frames.every())
    }

    /// Keeps the state of the bodies that are shown, if it is a step's turn.
    pub fn record(&mut self, frame: &Frame<'_>) {
        let Shown { bodies, frames, joints, .. } = self.shown(frame);
        frames.record(frame, bodies);
        joints.record(frame);
    }

    /// Keeps the state at the end of the run.
    pub fn finish(&mut self, frame: &Frame<'_>) {
        let Shown { bodies, frames, joints, .. } = self.shown(frame);
        frames.record_last(frame, bodies);
        joints.record(frame);
    }

    /// What the replay does not show, and how it makes up for it: sentences.
    #[must_use]
    pub fn left_out(&self) -> Vec<String> {
        let Some(Shown { bodies, surfaces, frames, joints }) = &self.shown else { return Vec::new() };
        let mut said = Vec::new();
        let shown = bodies.all().len();
        if shown < self.bodies {
            let [shown, all] = [shown, self.bodies].map(|bodies| count(bodies as u64));
            said.push(format!(
                "{shown} of the {all} bodies are shown, spread evenly over them; the figures below are of all."
            ));
        } else {
            said.push("All bodies are shown.".to_owned());
        }
        if joints.shown.len() < joints.all {
            let [shown, all] = [joints.shown.len(), joints.all].map(|joints| count(joints as u64));
            said.push(format!("{shown} of the {all} joints are shown."));
        }
        let boxed = bodies.all().iter().filter(|body| Self::is_boxed(surfaces, bodies, body.look)).count();
        if boxed > 0 {
            said.push(format!("The meshes of {} have too many triangles and are shown as boxes.", count(boxed as u64)));
        }
        if let (Some(last), [_, _, ..]) = (frames.steps.last(), frames.steps.as_slice()) {
            let kept = count(frames.steps.len() as u64);
            let apart = frames.times.iter().take(2).fold(0.0, |before, time| time - before);
            said.push(match frames.every() {
                1 => format!("Every step is a frame, {kept} with the start."),
                every => format!(
                    "{kept} frames of {} steps are kept, one every {} steps ({} s); poses between them are interpolated, \
                     so half a turn and more in that time is not seen as it was.",
                    count(*last),
                    count(every),
                    figure(rounded(apart)),
                ),
            });
        }
        said
    }

    fn is_boxed(surfaces: &Surfaces, bodies: &Bodies, look: usize) -> bool {
        bodies.appearance.get(look).is_some_and(|look| surfaces.is_boxed(look.surface))
    }

    /// What there is to show, made of the first frame.
    fn shown(&mut self, frame: &Frame<'_>) -> &mut Shown {
        self.shown.get_or_insert_with(|| {
            let appearance = std::mem::take(&mut self.appearance);
            let bodies = Bodies::chosen(frame, |id| {
                let id = usize::try_from(id).ok()?;
                appearance.get(self.chosen.binary_search(&id).ok()?)
            });
            let surfaces = Surfaces::within(MESH_BYTES, &bodies);
            let left = BYTES.saturating_sub(surfaces.bytes);
            let frames = Frames::new(bodies.all().len(), usize::try_from(left).unwrap_or(usize::MAX));
            let joints = Joints::of(frame, &bodies);
            Shown { bodies, surfaces, frames, joints }
        })
    }

    pub(crate) fn parts(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    pub(crate) fn description(&self) -> Option<&str> {
        self.description.as_deref()
    }

    pub(crate) fn notices(&self) -> &[String] {
        &self.notices
    }

    pub(crate) fn up(&self) -> usize {
        self.up
    }
}
