//! A yard to play in: walk, climb, ride, drive, shoot, pull, open. A game prototype to copy from.
//!
//! - `yard.rs` spawns the level: bodies and joints of tumble with components of our own;
//! - `game.rs`, with `hand.rs` and `driver.rs`, is the game without a window: systems before each
//!   fixed step, restart by snapshot;
//! - `camera.rs` and `draw.rs` look between two steps, and change nothing;
//! - `pilot.rs` plays by itself, for pictures and for `tests.rs`.
//!
//! `cargo run --release -p yard`; the keys are on the screen.

#![cfg_attr(
    feature = "f64",
    allow(
        clippy::unnecessary_cast,
        clippy::useless_conversion,
        reason = "Real is f64 in this build, f32 in the other"
    )
)]

mod camera;
mod draw;
mod driver;
mod game;
mod hand;
mod pilot;
#[cfg(test)]
mod tests;
mod yard;

use std::error::Error;

use macroquad::prelude as mq;
use tumble::prelude::*;

use camera::Camera;
use game::{Actions, Game};
use pilot::Pilot;

const HELP: &str = "\
A yard to play in; the window has the keys.

Usage: yard [OPTIONS]

Options:
      --autopilot     It plays by itself
      --frames NAME   The same, as NAME-0000.png and so on, fifteen a second
  -h, --help          Print this";
/// Steps from one of these to the next.
const FRAME: u64 = 4;

#[macroquad::main(window)]
async fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => play(false, None).await,
        ["--autopilot"] => play(true, None).await,
        ["--frames", name] => play(true, Some(name)).await,
        _ => {
            println!("{HELP}");
            Ok(())
        }
    }
}

fn window() -> mq::Conf {
    mq::Conf {
        window_title: "tumble: yard".to_owned(),
        window_width: 1280,
        window_height: 720,
        sample_count: 4,
        ..Default::default()
    }
}

async fn play(autopilot: bool, frames: Option<&str>) -> Result<(), Box<dyn Error>> {
    let (mut game, mut camera, mut pilot) = (Game::new()?, Camera::default(), Pilot::tour());
    let (mut has_mouse, mut pictures) = (!autopilot, 0);
    take_mouse(has_mouse);
    while !mq::is_key_pressed(mq::KeyCode::Escape) && (frames.is_none() || !pilot.is_done()) {
        if mq::is_key_pressed(mq::KeyCode::R) {
            game.restart()?;
            (camera, pilot) = (Camera::default(), Pilot::tour());
        }
        if mq::is_key_pressed(mq::KeyCode::Tab) {
            has_mouse = !has_mouse;
            take_mouse(has_mouse);
        }
        camera.turn(has_mouse);
        let dt = f64::from(game.simulation.settings().dt);
        let seconds = if frames.is_some() { dt } else { f64::from(mq::get_frame_time()) };
        let actions = if autopilot { pilot.fly(&game) } else { keyboard(&camera) };
        (camera.yaw, camera.pitch) = (actions.yaw, actions.pitch);
        let alpha = game.update(seconds, &actions);
        let view = camera.follow(&game, alpha, seconds as Real);
        if frames.is_some() && !game.simulation.steps().is_multiple_of(FRAME) {
            continue;
        }
        draw::draw_world(&game, alpha, &view, camera.yaw);
        draw::draw_text(&game);
        if let Some(name) = frames {
            draw::save_picture(&format!("{name}-{pictures:04}.png"));
            pictures += 1;
        }
        mq::next_frame().await;
    }
    Ok(())
}

fn take_mouse(takes: bool) {
    mq::set_cursor_grab(takes);
    mq::show_mouse(!takes);
}

/// What the keys and the mouse ask for.
fn keyboard(camera: &Camera) -> Actions {
    use mq::KeyCode::{A, C, D, E, LeftShift, S, Space, T, W};
    // A key may go down and up within a frame.
    let key = |key| mq::is_key_down(key) || mq::is_key_pressed(key);
    let button = |button| mq::is_mouse_button_down(button) || mq::is_mouse_button_pressed(button);
    let axis = |more, less| Real::from(i8::from(mq::is_key_down(more)) - i8::from(mq::is_key_down(less)));
    Actions {
        ahead: axis(W, S),
        right: axis(D, A),
        yaw: camera.yaw,
        pitch: camera.pitch,
        run: mq::is_key_down(LeftShift),
        jump: key(Space),
        crouch: mq::is_key_down(C),
        slow: mq::is_key_down(T),
        grab: button(mq::MouseButton::Right),
        shoot: button(mq::MouseButton::Left),
        use_car: key(E),
    }
}
