//! The window: what keys and mouse do.

use std::time::Duration;

use macroquad::input::{
    KeyCode, MouseButton, is_key_down, is_key_pressed, is_mouse_button_down, is_mouse_button_pressed,
    is_mouse_button_released, mouse_position, mouse_wheel,
};
use macroquad::time::get_frame_time;
use macroquad::window::{next_frame, screen_height, screen_width};
use tumble::PhaseTimes;
use tumble::glam::DVec2;

use crate::clock::Instant;
use crate::failure::Failure;
use crate::framing::{PITCH, YAW};
use crate::gallery::Gallery;
use crate::gpu::{Background, Gpu, Renderer};
use crate::layers::{LAYERS, Layer};
use crate::options::Options;
use crate::overlay::Writer;
use crate::page::{self, Page};
use crate::readout;
use crate::sliders::{Grip, Panel};
use crate::tuning::Change;
use crate::viewport::{Canvas, Follow, Viewport};

/// The longest that a frame may take to simulate; what it then lacks is not made up for.
const BUDGET: Duration = Duration::from_millis(12);
/// Figures that change more often cannot be read.
const BOOKS: Duration = Duration::from_millis(100);
/// A frame counts for at most this long \[s\]: a window that was dragged does not jump.
const LONGEST_FRAME: f64 = 0.1;
/// Turning of the camera \[rad/point\], and its way with each notch of the wheel.
const TURN: f64 = 0.007;
const NOTCH: f64 = 0.12;
/// A press that moves farther is a drag \[points\].
const CLICK: f64 = 4.0;

/// How long a notice stays that is not about the scene's file.
const NOTICE: Duration = Duration::from_secs(4);

/// What the user has done so far.
#[derive(Debug)]
struct Controls {
    paused: bool,
    /// Simulated seconds to a second at speed 1.
    pace: f64,
    keeps_up: bool,
    mouse: DVec2,
    pressed_at: Option<DVec2>,
    /// Where the sliders are in the last picture, and what is held of them.
    panel: Option<Panel>,
    grip: Option<Grip>,
    /// When the notice goes, if it does.
    notice_until: Option<Instant>,
}

/// Shows the stage until the window is closed.
pub(crate) async fn show(
    mut viewport: Viewport,
    (mut gpu, mut renderer, writer): (Gpu, Renderer, Writer),
    pace: f64,
    options: Options,
) -> Result<(), Failure> {
    let mut controls = Controls::new(options.paused, pace);
    let (mut gallery, mut page) = (Gallery::of(options), Page::begin());
    prepare(&mut viewport);
    let mut last: Option<(PhaseTimes, Duration)> = None;
    loop {
        let size = DVec2::new(f64::from(screen_width()), f64::from(screen_height())).max(DVec2::ONE);
        let frame = f64::from(get_frame_time());
        if let Some((steps, drawing)) = last.take() {
            viewport.times.push(Duration::try_from_secs_f64(frame).unwrap_or_default(), &steps, drawing);
        }
        if is_key_pressed(KeyCode::Q) && !page::IS_THERE {
            return Ok(());
        }
        if let Some(other) = controls.other_scene((&mut gallery, &mut page), &mut viewport) {
            viewport = other;
            prepare(&mut viewport);
            renderer.replace_bodies(&mut gpu, &viewport.playback.bodies);
        }
        // A browser has no clock for the phases of a step.
        let is_timed = viewport.layers.has(Layer::Times) && cfg!(not(target_family = "wasm"));
        viewport.playback.times = is_timed.then(PhaseTimes::default);
        controls.keys(&mut viewport, size)?;
        controls.settings(&mut viewport);
        controls.mouse(&mut viewport, size);
        if !controls.paused {
            let seconds = frame.min(LONGEST_FRAME) * controls.factor(&viewport);
            controls.keeps_up = viewport.playback.advance(seconds, BUDGET);
        }
        let drawing = Instant::now();
        let canvas = Canvas { pass: None, size, background: Background::Gradient };
        let status = controls.status(&viewport);
        let overlay = viewport.draw(&mut gpu, &mut renderer, &canvas, status);
        writer.draw(&overlay, size, 1.0);
        controls.panel = overlay.panel(size);
        last = viewport.playback.times.take().map(|steps| (steps, drawing.elapsed()));
        next_frame().await;
    }
}

/// In a window, time goes back too, and figures are to be read.
fn prepare(viewport: &mut Viewport) {
    viewport.books_every = BOOKS;
    viewport.playback.keep_past();
}

impl Controls {
    fn new(paused: bool, pace: f64) -> Self {
        Self {
            paused,
            pace,
            keeps_up: true,
            mouse: DVec2::ZERO,
            pressed_at: None,
            panel: None,
            grip: None,
            notice_until: None,
        }
    }

    /// Another scene, where one was asked for or its file has changed. One that cannot be opened is
    /// reported, and the scene that is shown goes on.
    fn other_scene(&mut self, (gallery, page): (&mut Gallery, &mut Page), viewport: &mut Viewport) -> Option<Viewport> {
        let turned = pressed([(KeyCode::PageUp, Change::Less), (KeyCode::PageDown, Change::More)]);
        let opened = match (page.chosen_scene(), turned) {
            (Some(builtin), _) => gallery.show(builtin),
            (None, Some(change)) => gallery.turn(change),
            (None, None) if gallery.has_changed(Instant::now()) => gallery.open().map(|(mut new, pace)| {
                new.keep_view_of(viewport);
                (new, pace)
            }),
            (None, None) => return None,
        };
        match opened {
            Ok((mut new, pace)) => {
                self.pace = pace;
                new.tuning.keep_speed(&viewport.tuning);
                Some(new)
            }
            Err(failure) => {
                viewport.notice = Some(failure.to_string());
                self.notice_until = None;
                None
            }
        }
    }

    /// Shows what went wrong for a while.
    fn notice(&mut self, viewport: &mut Viewport, text: String) {
        viewport.notice = Some(text);
        self.notice_until = Some(Instant::now() + NOTICE);
    }

    fn settings(&mut self, viewport: &mut Viewport) {
        if self.notice_until.is_some_and(|until| until <= Instant::now()) {
            viewport.notice = None;
            self.notice_until = None;
        }
        let chosen = pressed([(KeyCode::Up, Change::Less), (KeyCode::Down, Change::More)]);
        let turned = pressed([(KeyCode::Left, Change::Less), (KeyCode::Right, Change::More)]);
        if chosen.is_none() && turned.is_none() {
            return;
        }
        // Who cannot see them does not change them yet.
        if !viewport.layers.has(Layer::Settings) {
            viewport.layers.toggle(Layer::Settings);
            return;
        }
        if let Some(change) = chosen {
            viewport.tuning.choose(change);
        }
        if let Some(change) = turned
            && let Err(error) = viewport.tune(change)
        {
            self.notice(viewport, error);
        }
    }

    /// Simulated seconds to a second.
    fn factor(&self, viewport: &Viewport) -> f64 {
        self.pace * viewport.tuning.speed()
    }

    fn status(&self, viewport: &Viewport) -> String {
        let speed = status(viewport.playback.time(), self.factor(viewport), self.pace);
        let note = match (self.paused, self.keeps_up) {
            (true, _) => "   paused",
            (false, false) => "   as fast as it goes",
            (false, true) => "",
        };
        format!("{speed}{note}")
    }

    fn keys(&mut self, viewport: &mut Viewport, size: DVec2) -> Result<(), Failure> {
        for info in &LAYERS {
            if is_key_pressed(info.key) {
                viewport.layers.toggle(info.layer);
            }
        }
        if is_key_pressed(KeyCode::Space) {
            self.paused = !self.paused;
        }
        if is_key_pressed(KeyCode::Period) {
            self.paused = true;
            viewport.playback.step();
        }
        if is_key_pressed(KeyCode::Comma) {
            self.paused = true;
            if !viewport.step_back() {
                self.notice(viewport, "No step before this one is kept.".to_owned());
            }
        }
        if is_key_pressed(KeyCode::O)
            && let Err(error) = viewport.shoot(self.mouse, size, self.factor(viewport))
        {
            self.notice(viewport, format!("No ball can be shot: {error}"));
        }
        Self::move_in_time(viewport)?;
        Self::pick_keys(viewport);
        view_keys(viewport, size);
        Ok(())
    }

    fn move_in_time(viewport: &mut Viewport) -> Result<(), Failure> {
        let faster = [KeyCode::Equal, KeyCode::KpAdd].map(|key| (key, Change::More));
        let slower = [KeyCode::Minus, KeyCode::KpSubtract].map(|key| (key, Change::Less));
        for change in [pressed(faster), pressed(slower)].into_iter().flatten() {
            viewport.tuning.turn_speed(change);
        }
        if is_key_pressed(KeyCode::R) {
            viewport.restart()?;
        }
        Ok(())
    }

    fn pick_keys(viewport: &mut Viewport) {
        if is_key_pressed(KeyCode::Tab) {
            let bodies = viewport.playback.bodies.all.len();
            let back = is_key_down(KeyCode::LeftShift) || is_key_down(KeyCode::RightShift);
            pick(viewport, next_body(viewport.picked, bodies, back));
        }
        if is_key_pressed(KeyCode::Escape) {
            pick(viewport, None);
        }
        if is_key_pressed(KeyCode::C) {
            let follow = match (viewport.follow, viewport.picked) {
                (Follow::All, Some(index)) => Follow::Body(index),
                (Follow::All, None) | (Follow::Body(_), _) => Follow::Nothing,
                (Follow::Nothing, _) => Follow::All,
            };
            viewport.set_follow(follow);
        }
    }

    fn mouse(&mut self, viewport: &mut Viewport, size: DVec2) {
        let (x, y) = mouse_position();
        let now = DVec2::new(f64::from(x), f64::from(y));
        let by = now - std::mem::replace(&mut self.mouse, now);
        if is_mouse_button_pressed(MouseButton::Left) {
            self.grip = self.panel.and_then(|panel| panel.press(now));
        }
        match self.grip {
            Some(grip) => self.slide(viewport, grip),
            None => self.left_button(viewport, (now, by), size),
        }
        if !is_mouse_button_down(MouseButton::Left) {
            self.grip = None;
        }
        if is_mouse_button_down(MouseButton::Right) || is_mouse_button_down(MouseButton::Middle) {
            viewport.pan(by, size);
        }
        // Some systems count notches, others points, of which a browser has a hundred to a notch.
        let unit = if page::IS_THERE { 0.01 } else { 1.0 };
        let notches = (unit * f64::from(mouse_wheel().1)).clamp(-3.0, 3.0);
        if notches != 0.0 {
            viewport.zoom((-NOTCH * notches).exp(), size);
        }
    }

    /// Moves the slider that is held to where the mouse is.
    fn slide(&mut self, viewport: &mut Viewport, grip: Grip) {
        if let (Grip::Slider(row), Some(panel)) = (grip, self.panel)
            && let Err(error) = viewport.slide(row, panel.place(self.mouse.x))
        {
            self.notice(viewport, error);
        }
    }

    /// Turns the camera, picks and grabs.
    fn left_button(&mut self, viewport: &mut Viewport, (now, by): (DVec2, DVec2), size: DVec2) {
        if is_mouse_button_pressed(MouseButton::Left) {
            self.pressed_at = Some(now);
            if is_key_down(KeyCode::LeftShift) || is_key_down(KeyCode::RightShift) {
                viewport.grab(now, size, self.factor(viewport));
            }
        } else if is_mouse_button_down(MouseButton::Left) && !viewport.holds() {
            viewport.camera.turn(-TURN * by.x, TURN * by.y);
        }
        if is_mouse_button_down(MouseButton::Left) {
            viewport.pull(now, size);
        } else {
            viewport.release();
        }
        // A quick click is pressed and released within one frame.
        if is_mouse_button_released(MouseButton::Left)
            && self.pressed_at.take().is_some_and(|at| at.distance(now) <= CLICK)
        {
            pick(viewport, viewport.body_at(now, size));
        }
    }
}

/// Views from fixed sides.
fn view_keys(viewport: &mut Viewport, size: DVec2) {
    let quarter = std::f64::consts::FRAC_PI_2;
    let views = [
        (KeyCode::Key0, (YAW, PITCH)),
        (KeyCode::Key1, (0.0, 0.0)),
        (KeyCode::Key2, (quarter, 0.0)),
        (KeyCode::Key3, (0.0, quarter)),
    ];
    for (key, (yaw, pitch)) in views {
        if is_key_pressed(key) {
            viewport.look_from(yaw, pitch, size);
        }
    }
}

/// What is meant by the key that is pressed.
fn pressed<const N: usize>(keys: [(KeyCode, Change); N]) -> Option<Change> {
    keys.into_iter().find(|(key, _)| is_key_pressed(*key)).map(|(_, change)| change)
}

/// Time and speed in words.
pub(crate) fn status(time: f64, factor: f64, pace: f64) -> String {
    let time = readout::time(time);
    if pace == 1.0 {
        format!("t = {time}   ×{factor}")
    } else {
        format!("t = {time}   {} a second", readout::time(factor))
    }
}

/// A camera that follows the picked body follows the next one that is picked.
fn pick(viewport: &mut Viewport, body: Option<usize>) {
    viewport.picked = body;
    match (viewport.follow, body) {
        (Follow::Body(_), Some(index)) => viewport.set_follow(Follow::Body(index)),
        (Follow::Body(_), None) => viewport.set_follow(Follow::Nothing),
        _ => {}
    }
}

fn next_body(picked: Option<usize>, bodies: usize, back: bool) -> Option<usize> {
    let last = bodies.checked_sub(1)?;
    Some(match (picked, back) {
        (None, false) => 0,
        (None, true) | (Some(0), true) => last,
        (Some(index), true) => index - 1,
        (Some(index), false) if index >= last => 0,
        (Some(index), false) => index + 1,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_are_picked_one_after_another() {
        assert_eq!(next_body(None, 3, false), Some(0));
        assert_eq!(next_body(Some(2), 3, false), Some(0));
        assert_eq!(next_body(Some(0), 3, true), Some(2));
        assert_eq!(next_body(Some(1), 3, true), Some(0));
        assert_eq!(next_body(None, 0, false), None);
    }

    #[test]
    fn time_and_speed_are_shown() {
        assert_eq!(status(1.5, 0.25, 1.0), "t = 1.500 s   ×0.25");
        assert_eq!(status(86400.0, 1e6, 1e6), "t = 24.00 hours   11.57 days a second");
    }
}
