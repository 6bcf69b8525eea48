//! How long frames take, and what takes it.

use std::collections::VecDeque;
use std::time::Duration;

use tumble::PhaseTimes;

/// Frames in the graph.
pub(crate) const FRAMES: usize = 120;
/// Frames that a mean is of.
const MEAN: usize = 30;

/// What a frame is divided into, with its colour.
pub(crate) const PARTS: [(&str, [f32; 3]); 6] = [
    ("contacts", [0.94, 0.45, 0.35]),
    ("pairs", [0.93, 0.72, 0.30]),
    ("forces", [0.55, 0.78, 0.36]),
    ("motion", [0.35, 0.70, 0.85]),
    ("drawing", [0.62, 0.55, 0.86]),
    ("rest", [0.34, 0.38, 0.45]),
];

/// Milliseconds of each part of a frame.
pub(crate) type FrameTime = [f32; PARTS.len()];

/// The last frames, oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrameTimes {
    frames: VecDeque<FrameTime>,
}

impl FrameTimes {
    /// A frame of a length, with the times of its steps, and of drawing. Steps without interactions
    /// are measured on each thread, and may add up to more than the frame.
    pub(crate) fn push(&mut self, frame: Duration, steps: &PhaseTimes, drawing: Duration) {
        let motion = steps.integrate() + steps.update_derived();
        let parts = [steps.contacts(), steps.pairs(), steps.accumulate_forces(), motion, drawing];
        let rest = frame.saturating_sub(parts.iter().sum());
        let [contacts, pairs, forces, motion, drawing] = parts.map(milliseconds);
        if self.frames.len() >= FRAMES {
            self.frames.pop_front();
        }
        self.frames.push_back([contacts, pairs, forces, motion, drawing, milliseconds(rest)]);
    }

    pub(crate) fn frames(&self) -> impl ExactSizeIterator<Item = &FrameTime> {
        self.frames.iter()
    }

    /// Of the last frames \[ms\].
    pub(crate) fn mean(&self) -> FrameTime {
        let last = || self.frames.iter().rev().take(MEAN);
        let count = last().count().max(1) as f32;
        std::array::from_fn(|part| last().map(|frame| frame[part]).sum::<f32>() / count)
    }
}

fn milliseconds(duration: Duration) -> f32 {
    duration.as_secs_f32() * 1e3
}

#[cfg(test)]
mod tests {
    use tumble_scene::Scene;

    use super::*;
    use crate::playback::Playback;

    #[test]
    fn a_frame_is_the_sum_of_its_parts() {
        let mut playback = Playback::of(Scene::open("pyramid").unwrap()).unwrap();
        let steps = PhaseTimes::default();
        playback.simulation.step_timed(&mut playback.world, &steps);
        let mut times = FrameTimes::default();
        times.push(Duration::from_secs(100), &steps, Duration::from_millis(7));
        let frame = times.mean();
        assert!((frame.iter().sum::<f32>() - 1e5).abs() < 0.1, "{frame:?}");
        assert!(frame[0] > 0.0 && (frame[4] - 7.0).abs() < 1e-3 && frame[5] > 0.0, "{frame:?}");
        // Steps that took longer than the frame leave no rest.
        times.push(Duration::ZERO, &steps, Duration::ZERO);
        assert_eq!(times.frames().last().map(|frame| frame[5]), Some(0.0));
    }

    #[test]
    fn old_frames_are_forgotten() {
        let mut times = FrameTimes::default();
        for frame in 0..FRAMES as u64 + 10 {
            times.push(Duration::from_millis(frame), &PhaseTimes::default(), Duration::ZERO);
        }
        assert_eq!(times.frames().len(), FRAMES);
        let last = FRAMES as f32 + 9.0;
        assert!((times.mean()[5] - (last - 14.5)).abs() < 1e-3, "{:?}", times.mean());
        assert_eq!(FrameTimes::default().mean(), [0.0; PARTS.len()]);
    }
}
