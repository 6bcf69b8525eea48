//! A yard to play in: walk, climb, ride, drive, throw, pull, open. A game prototype to copy from.
//!
//! - `yard.rs` spawns the level: bodies and joints of tumble with components of our own;
//! - `game.rs` is the game without a window: systems before each fixed step, restart by snapshot;
//! - `camera.rs` and `draw.rs` look between two steps, and change nothing;
//! - `pilot.rs` plays by itself, for pictures and for `tests.rs`.
//!
//! `cargo run --release -p yard`; the keys are on the screen.

mod camera;
mod draw;
mod game;
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
A yard to play in.

Usage: yard [OPTIONS]

Options:
      --autopilot       It plays by itself
      --frames NAME     Write NAME-0000.png and so on of what the autopilot does, and end with it
      --from SECONDS    When to begin with that [default: 0]
      --every STEPS     One picture in how many steps [default: 60]
  -h, --help            Print this

Keys: WASD, shift, space, C, mouse, E, R, T, Escape; as the window says.
";

#[derive(Default)]
struct Options {
    autopilot: bool,
    frames: Option<String>,
    from: f64,
    every: u64,
}

impl Options {
    fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self { every: 60, ..Self::default() };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            match word.as_str() {
                "--autopilot" => options.autopilot = true,
                "--frames" => options.frames = Some(value()?),
                "--from" => options.from = value()?.parse()?,
                "--every" => options.every = value()?.parse::<u64>()?.max(1),
                _ => return Err(format!("{word}: try --autopilot, --frames, --from, --every or --help").into()),
            }
        }
        Ok(options)
    }
}

fn main() {
    if std::env::args().skip(1).any(|word| ["-h", "--help"].contains(&word.as_str())) {
        return print!("{HELP}");
    }
    let options = Options::parse(std::env::args().skip(1)).unwrap_or_else(|error| {
        eprintln!("yard: {error}");
        std::process::exit(2)
    });
    let config = mq::Conf {
        window_title: "tumble: yard".to_owned(),
        window_width: 1280,
        window_height: 720,
        sample_count: 4,
        ..Default::default()
    };
    macroquad::Window::from_config(config, async {
        if let Err(error) = play(options).await {
            eprintln!("yard: {error}");
            std::process::exit(1);
        }
    });
}

async fn play(options: Options) -> Result<(), Box<dyn Error>> {
    let (mut game, mut camera, mut pilot) = (Game::new()?, Camera::default(), Pilot::tour());
    let records = options.frames.is_some();
    let mut grabbed = !options.autopilot && !records;
    mq::set_cursor_grab(grabbed);
    mq::show_mouse(!grabbed);
    let mut pictures = 0;
    while !mq::is_key_pressed(mq::KeyCode::Escape) {
        if mq::is_key_pressed(mq::KeyCode::R) {
            game.restart()?;
            (camera, pilot) = (Camera::default(), Pilot::tour());
        }
        if mq::is_key_pressed(mq::KeyCode::Tab) {
            grabbed = !grabbed;
            mq::set_cursor_grab(grabbed);
            mq::show_mouse(!grabbed);
        }
        camera.turn(grabbed);
        let dt = f64::from(game.simulation.settings().dt);
        let seconds = if records { dt } else { f64::from(mq::get_frame_time()) };
        let actions = if options.autopilot || records { pilot.fly(&game) } else { keyboard(&camera) };
        (camera.yaw, camera.pitch) = (actions.yaw, actions.pitch);
        let alpha = game.update(seconds, &actions);
        let view = camera.follow(&game, alpha, seconds as Real);
        let steps = game.simulation.steps();
        let shows = !records || (game.simulation.time() >= options.from && steps.is_multiple_of(options.every));
        if shows {
            draw::draw_world(&game, alpha, &view, camera.yaw);
            draw::draw_text(&game);
            if let Some(name) = &options.frames {
                draw::save_picture(&format!("{name}-{pictures:04}.png"));
                pictures += 1;
            }
            mq::next_frame().await;
        }
        if records && pilot.is_done() {
            break;
        }
    }
    Ok(())
}

/// What the keys and the mouse ask for.
fn keyboard(camera: &Camera) -> Actions {
    use mq::KeyCode::{A, C, D, E, LeftShift, S, Space, T, W};
    let axis = |more, less| Real::from(i8::from(mq::is_key_down(more)) - i8::from(mq::is_key_down(less)));
    Actions {
        ahead: axis(W, S),
        right: axis(D, A),
        yaw: camera.yaw,
        pitch: camera.pitch,
        run: mq::is_key_down(LeftShift),
        jump: mq::is_key_down(Space),
        crouch: mq::is_key_down(C),
        slow: mq::is_key_down(T),
        grab: mq::is_mouse_button_down(mq::MouseButton::Right),
        shoot: mq::is_mouse_button_down(mq::MouseButton::Left),
        use_car: mq::is_key_down(E),
    }
}
