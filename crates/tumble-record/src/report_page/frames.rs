//! States of the shown bodies at some of the steps, in bounded memory.

use tumble::Pose;

use crate::trajectory::frame::Frame;
use crate::trajectory::glb::bodies::Bodies;
use crate::trajectory::glb::sample::Sample;

/// No more frames than anyone sees, even of few bodies.
pub(crate) const MAX_FRAMES: usize = 1200;
/// Of more bodies than this, positions are written in 16 bits over the way of each.
pub(crate) const MAX_EXACT: usize = 1000;

/// What a pose takes on the page, with its orientation in 16-bit integers \[bytes\].
pub(crate) fn sample_bytes(bodies: usize) -> usize {
    let position = if bodies > MAX_EXACT { size_of::<[u16; 3]>() } else { size_of::<[f32; 3]>() };
    position + size_of::<[i16; 4]>()
}

/// Poses at every k-th step. When there are too many, every other one is dropped, and k is twice
/// what it was.
#[derive(Debug)]
pub(crate) struct Frames {
    most: usize,
    every: u64,
    bodies: usize,
    pub(crate) steps: Vec<u64>,
    /// \[s\]
    pub(crate) times: Vec<f64>,
    /// Of the bodies' frames, frame by frame \[m\].
    pub(crate) positions: Vec<f32>,
    /// Quaternions `x, y, z, w`, a unit being 32767.
    pub(crate) rotations: Vec<i16>,
}

impl Frames {
    /// For a number of bodies, whose frames may take a number of bytes.
    pub(crate) fn new(bodies: usize, bytes: usize) -> Self {
        let most = (bytes / (sample_bytes(bodies) * bodies.max(1))).clamp(2, MAX_FRAMES);
        let (steps, times, positions, rotations) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { most, every: 1, bodies, steps, times, positions, rotations }
    }

    /// Steps from one frame to the next.
    pub(crate) fn every(&self) -> u64 {
        self.every
    }

    /// Adds a frame if its step's turn has come.
    pub(crate) fn record(&mut self, frame: &Frame<'_>, bodies: &mut Bodies) {
        if !frame.step.is_multiple_of(self.every) {
            return;
        }
        if self.times.len() >= self.most {
            self.drop_half();
        }
        if frame.step.is_multiple_of(self.every) {
            self.push(frame, bodies);
        }
    }

    /// Adds the frame at the end of the run, in the place of the last one if there is no room.
    pub(crate) fn record_last(&mut self, frame: &Frame<'_>, bodies: &mut Bodies) {
        if self.steps.last().is_some_and(|&last| last >= frame.step) {
            return;
        }
        if self.times.len() >= self.most {
            self.truncate(self.most - 1);
        }
        self.push(frame, bodies);
    }

    /// The lowest position of a body in any frame and how far it gets from there, in each
    /// direction \[m\].
    pub(crate) fn way(&self, body: usize) -> [[f32; 3]; 2] {
        let places = self.positions.chunks_exact(3).skip(body).step_by(self.bodies.max(1));
        let nothing = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let (low, high) = places.fold(nothing, |(mut low, mut high), place| {
            for ((low, high), part) in low.iter_mut().zip(&mut high).zip(place) {
                (*low, *high) = (low.min(*part), high.max(*part));
            }
            (low, high)
        });
        let mut size = high;
        for (size, low) in size.iter_mut().zip(low) {
            *size = (*size - low).min(f32::MAX);
        }
        [low, size]
    }

    fn push(&mut self, frame: &Frame<'_>, bodies: &mut Bodies) {
        self.steps.push(frame.step);
        self.times.push(frame.time);
        let poses = frame.world.view::<&Pose>();
        for body in bodies.all_mut() {
            // What is no longer there, or nowhere, stays where it was.
            if let Some(sample) = poses.get(body.entity).and_then(|pose| Sample::of(pose, body.center, None)) {
                body.sample = sample;
            }
            self.positions.extend(body.sample.translation);
            self.rotations.extend(body.sample.rotation.map(|part| (part * f32::from(i16::MAX)).round() as i16));
        }
    }

    fn drop_half(&mut self) {
        self.every = self.every.saturating_mul(2);
        let kept: Vec<usize> =
            (0..self.steps.len()).filter(|&at| self.steps.get(at).is_some_and(|step| step % self.every == 0)).collect();
        for (to, &from) in kept.iter().enumerate() {
            self.steps.swap(to, from);
            self.times.swap(to, from);
            self.positions.copy_within(3 * self.bodies * from..3 * self.bodies * (from + 1), 3 * self.bodies * to);
            self.rotations.copy_within(4 * self.bodies * from..4 * self.bodies * (from + 1), 4 * self.bodies * to);
        }
        self.truncate(kept.len());
    }

    fn truncate(&mut self, frames: usize) {
        self.steps.truncate(frames);
        self.times.truncate(frames);
        self.positions.truncate(3 * self.bodies * frames);
        self.rotations.truncate(4 * self.bodies * frames);
    }
}
