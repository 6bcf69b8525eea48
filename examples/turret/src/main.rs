//! A turret that aims by rays and shoots: the yellow line is the ray to what it sees.
//!
//! `cargo run --release -p turret`; left and right turn the camera, Escape ends it.

mod game;

use macroquad::prelude as mq;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;

use crate::game::{Bullet, Drone, EYE, Game};

const HELP: &str = "\
A turret aims by rays at drones and shoots; the yellow line is the ray to what it sees.

Usage: turret

Keys:
  left, right    Turn the camera
  Escape         Quit
";

fn main() {
    if let Some(word) = std::env::args().nth(1) {
        let is_help = ["-h", "--help"].contains(&word.as_str());
        if is_help {
            print!("{HELP}");
        } else {
            eprintln!("turret: {word}: there is no option but --help");
        }
        std::process::exit(if is_help { 0 } else { 2 });
    }
    macroquad::Window::new("turret", async {
        if let Err(error) = play().await {
            eprintln!("turret: {error}");
            std::process::exit(1);
        }
    });
}

async fn play() -> Result<(), Box<dyn std::error::Error>> {
    let mut game = Game::new(7)?;
    let mut angle: f32 = 0.6;
    while !mq::is_key_pressed(mq::KeyCode::Escape) {
        let seconds = mq::get_frame_time();
        let turn = |key: mq::KeyCode, by: f32| if mq::is_key_down(key) { by * seconds } else { 0.0 };
        angle += turn(mq::KeyCode::Right, 1.0) + turn(mq::KeyCode::Left, -1.0);
        let alpha = game.advance(f64::from(seconds))?;

        mq::clear_background(mq::Color::new(0.05, 0.06, 0.08, 1.0));
        let position = mq::vec3(angle.cos() * 34.0, 18.0, angle.sin() * 34.0);
        mq::set_camera(&mq::Camera3D { position, target: screen(EYE), up: mq::Vec3::Y, ..Default::default() });
        mq::draw_grid(60, 1.0, mq::DARKGRAY, mq::Color::new(0.14, 0.15, 0.17, 1.0));
        draw(&game, alpha);
        mq::set_default_camera();
        let score = format!("{} hit, {} came through", game.hits, game.landed);
        mq::draw_text(&score, 20.0, 36.0, 32.0, mq::WHITE);
        mq::next_frame().await;
    }
    Ok(())
}

/// Bodies as the engine's own lines, drones and bullets over them, and the last look of the turret.
fn draw(game: &Game, alpha: Real) {
    let mut line = |from: Vec3, to: Vec3, [r, g, b]: [f32; 3]| {
        mq::draw_line_3d(screen(from), screen(to), mq::Color::new(r, g, b, 1.0));
    };
    let view = DebugView { colliders: true, alpha, ..DebugView::nothing() };
    view.draw(&game.world, &mut line);
    if let Some((ray, hit)) = &game.look {
        DebugView::draw_ray(ray, Some(hit), &mut line);
    }
    for (pose, previous, drone) in game.world.query::<(&Pose, &PreviousPose, &Drone)>().iter() {
        let Pose { position, orientation } = previous.0.interpolate(pose, alpha);
        draw_box(position, orientation, if drone.is_hit { mq::MAROON } else { mq::ORANGE });
    }
    for (pose, previous, _) in game.world.query::<(&Pose, &PreviousPose, &Bullet)>().iter() {
        mq::draw_sphere(screen(previous.0.interpolate(pose, alpha).position), 0.15, None, mq::YELLOW);
    }
}

/// The faces of a drone.
fn draw_box(at: Vec3, turned: Quat, color: mq::Color) {
    let edges = [Vec3::X * 0.5, Vec3::Y * 0.25, Vec3::Z * 0.5].map(|half| turned * half);
    for (i, shade) in [0.6, 1.0, 0.8].into_iter().enumerate() {
        let [along, a, b] = [edges[i], edges[(i + 1) % 3], edges[(i + 2) % 3]];
        let color = mq::Color::new(color.r * shade, color.g * shade, color.b * shade, 1.0);
        for side in [along, -along] {
            mq::draw_affine_parallelogram(screen(at + side - a - b), screen(a * 2.0), screen(b * 2.0), None, color);
        }
    }
}

/// A vector as macroquad takes it, which has a version of glam of its own.
fn screen(vector: impl Into<tumble::glam::DVec3>) -> mq::Vec3 {
    mq::Vec3::from(vector.into().as_vec3().to_array())
}
