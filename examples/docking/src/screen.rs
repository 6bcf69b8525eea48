//! The picture: solids with lit faces, sky, instruments. Poses come from `main.rs`; `seen` is the
//! one place where numbers of tumble become macroquad's, which has a glam of its own.

use std::error::Error;

use hecs::World;
use macroquad::prelude as mq;
use tumble::math::Mat4;
use tumble::prelude::*;

use crate::approach::{Approach, CAPTURE_DISTANCE, Craft, MAX_MISALIGNMENT, MAX_SPEED, MAX_SPIN, Outcome};
use crate::models::Look;
use crate::{Assist, Fuel, Game, LEVELS, Nozzle, Player, TANK, Target};

const SUN: mq::Vec3 = mq::vec3(0.1, -0.78, 0.618);
const PLANET: mq::Vec3 = mq::vec3(-1500.0, -500.0, -1000.0);
const MOON: mq::Vec3 = mq::vec3(800.0, 1300.0, -560.0);
/// Solids of revolution about y, as radius and height from end to end; four sides of the first make
/// a cube.
const CUBE: [(f32, f32); 4] =
    [(0.0, -1.0), (std::f32::consts::SQRT_2, -1.0), (std::f32::consts::SQRT_2, 1.0), (0.0, 1.0)];

/// Numbers of either precision as macroquad wants them.
fn seen<const N: usize>(numbers: [impl Into<f64>; N]) -> [f32; N] {
    numbers.map(|number| number.into() as f32)
}

fn lit(color: mq::Color, normal: mq::Vec3) -> mq::Color {
    let (sun, glow) = (normal.dot(SUN).max(0.0), normal.dot(PLANET.normalize()).max(0.0));
    let light = mq::vec3(0.23, 0.24, 0.28) + mq::vec3(0.95, 0.92, 0.86) * sun + mq::vec3(0.22, 0.16, 0.1) * glow;
    let shade = color.to_vec().truncate() * light;
    mq::Color::new(shade.x, shade.y, shade.z, color.a)
}

/// Draws a profile turned about y. `paint` gets where a corner is, on the solid, and which way its
/// face looks, in the world.
fn draw_revolved(profile: &[(f32, f32)], sides: u16, place: mq::Mat4, paint: impl Fn(mq::Vec3, mq::Vec3) -> mq::Color) {
    let mut mesh = mq::Mesh { vertices: Vec::new(), indices: Vec::new(), texture: None };
    let (smooth, middle) = (profile.len() > 8, place.transform_point3(mq::Vec3::ZERO));
    let corner = |(radius, height): (f32, f32), side: u16| {
        let (sin, cos) = ((f32::from(side) + 0.5) / f32::from(sides) * std::f32::consts::TAU).sin_cos();
        mq::vec3(radius * cos, height, radius * sin)
    };
    for (low, high) in profile.iter().zip(&profile[1..]) {
        for side in 0..sides {
            let corners =
                [(low, side), (low, side + 1), (high, side + 1), (high, side)].map(|(ring, i)| corner(*ring, i));
            let [a, b, c, d] = corners.map(|corner| place.transform_point3(corner));
            let across = (c - a).cross(d - b).normalize_or_zero();
            let flat = across * across.dot(a + c - middle * 2.0).signum();
            let first = mesh.vertices.len() as u16;
            mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
            for (corner, at) in corners.into_iter().zip([a, b, c, d]) {
                let normal = if smooth { (at - middle).normalize_or_zero() } else { flat };
                mesh.vertices.push(mq::Vertex::new2(at, mq::Vec2::ZERO, paint(corner, normal)));
            }
        }
    }
    mq::draw_mesh(&mesh);
}

pub(crate) fn draw_look(look: &Look, body: Mat4) {
    let (profile, sides, size) = match look.shape {
        Shape::Cuboid { half_extents } => (CUBE, 4, half_extents.to_array()),
        Shape::Cylinder { radius, half_height } => (round(1.0, 1.0), 20, [radius, half_height, radius]),
        Shape::Frustum { radius_bottom, radius_top, half_height } => {
            (round(radius_bottom, radius_top), 20, [1.0, half_height, 1.0])
        }
        _ => return,
    };
    let place = mq::Mat4::from_cols_array(&seen((body * look.pose.to_mat4()).to_cols_array()));
    let place = place * mq::Mat4::from_scale(mq::Vec3::from(seen(size)));
    draw_revolved(&profile, sides, place, |_, normal| lit(look.color, normal));
}

fn round(bottom: f64, top: f64) -> [(f32, f32); 4] {
    [(0.0, -1.0), (bottom as f32, -1.0), (top as f32, 1.0), (0.0, 1.0)]
}

/// A flame from the nozzle, against its force: a cone that fades.
pub(crate) fn draw_plume(nozzle: &Nozzle, body: Mat4) {
    let length = 0.75;
    let turned = Quat::from_rotation_arc(Vec3::Y, -nozzle.force.normalize());
    let at = nozzle.point + turned * Vec3::Y * length;
    let place = body * Mat4::from_scale_rotation_translation(Vec3::new(0.2, length, 0.2), turned, at);
    let place = mq::Mat4::from_cols_array(&seen(place.to_cols_array()));
    draw_revolved(&[(0.15, -1.0), (1.0, 1.0)], 8, place, |at, _| mq::Color::new(0.75, 0.9, 1.0, 0.35 - 0.35 * at.y));
}

fn draw_planet(at: mq::Vec3, radius: f32, tint: mq::Vec3) {
    let arc = |i: u8| (f32::from(i) / 40.0 * std::f32::consts::PI).sin_cos();
    let profile: Vec<(f32, f32)> = (0..=40).map(arc).collect();
    let tilt = mq::Mat4::from_rotation_z(0.4) * mq::Mat4::from_rotation_x(1.2);
    let place = mq::Mat4::from_translation(at) * tilt * mq::Mat4::from_scale(mq::Vec3::splat(radius));
    draw_revolved(&profile, 64, place, |corner, normal| {
        let band = 0.75 + 0.12 * (corner.y * 19.0).sin() + 0.08 * (corner.y * 47.0 + 1.0).sin();
        lit(mq::Color::from_vec((tint * band).extend(1.0)), normal)
    });
}

fn on_screen(camera: &mq::Camera3D, at: mq::Vec3) -> Option<mq::Vec2> {
    let clip = mq::Camera::matrix(camera) * at.extend(1.0);
    let (x, y) = (clip.x / clip.w, clip.y / clip.w);
    (clip.w > 0.0).then(|| mq::vec2((0.5 + 0.5 * x) * mq::screen_width(), (0.5 - 0.5 * y) * mq::screen_height()))
}

/// The stars, the sun, and two planets behind everything.
pub(crate) fn draw_sky(stars: impl Iterator<Item = (Vec3, f32)>, camera: &mq::Camera3D) {
    mq::clear_background(mq::Color::from_hex(0x05070d));
    for (direction, brightness) in stars {
        if let Some(at) = on_screen(camera, camera.position + mq::Vec3::from(seen(direction.to_array())) * 1000.0) {
            let shade = 0.25 + 0.75 * brightness;
            mq::draw_circle(at.x, at.y, 0.8 + 1.4 * brightness, mq::Color::new(shade, shade, shade, 1.0));
        }
    }
    if let Some(at) = on_screen(camera, camera.position + SUN * 1000.0) {
        for (radius, alpha) in [(90.0, 0.04), (55.0, 0.08), (32.0, 0.2), (20.0, 1.0)] {
            mq::draw_circle(at.x, at.y, radius, mq::Color::new(1.0, 0.96, 0.86, alpha));
        }
    }
    mq::set_camera(camera);
    draw_planet(camera.position + PLANET, 480.0, mq::vec3(1.0, 0.83, 0.65));
    draw_planet(camera.position + MOON, 110.0, mq::vec3(0.55, 0.6, 0.68));
}

pub(crate) fn draw_trail(trail: &[Vec3]) {
    for (age, at) in trail.iter().rev().enumerate() {
        let color = mq::Color::new(0.5, 0.8, 1.0, 0.5 - 0.0025 * age as f32);
        mq::draw_cube(mq::Vec3::from(seen(at.to_array())), mq::Vec3::splat(0.05), None, color);
    }
}

/// Behind the ship and turning after it; once docked, round the pair, which tumbles before it.
pub(crate) struct Follow {
    turn: mq::Quat,
    distance: f32,
}

impl Default for Follow {
    fn default() -> Self {
        Self { turn: mq::Quat::IDENTITY, distance: 40.0 }
    }
}

impl Follow {
    pub(crate) fn camera(&mut self, world: &World, alpha: Real, seconds: f32) -> mq::Camera3D {
        let flown = world
            .query::<(&Pose, &PreviousPose)>()
            .with::<&Player>()
            .iter()
            .next()
            .map(|(p, q)| q.0.interpolate(p, alpha));
        let pair = || world.query::<(&Pose, &PreviousPose)>().iter().next().map(|(p, q)| q.0.interpolate(p, alpha));
        let ease = 1.0 - (-4.0 * seconds).exp();
        let body = flown.or_else(pair).unwrap_or_default();
        let (distance, turn) = match flown {
            Some(ship) => (7.5, mq::Quat::from_array(seen(ship.orientation.to_array()))),
            None => (10.0, self.turn * mq::Quat::from_rotation_z(0.03)),
        };
        self.turn = self.turn.slerp(turn, ease).normalize();
        self.distance += (distance - self.distance) * ease * 0.3;
        let target = mq::Vec3::from(seen(body.position.to_array()));
        let (position, up) = (target + self.turn * mq::vec3(0.12, -1.0, 0.42) * self.distance, self.turn * mq::Vec3::Z);
        let ahead = if flown.is_some() { self.turn * mq::vec3(0.0, 2.5, 0.7) } else { mq::Vec3::ZERO };
        mq::Camera3D {
            position,
            target: target + ahead,
            up,
            fovy: 1.0,
            z_near: 0.1,
            z_far: 3000.0,
            ..Default::default()
        }
    }
}

const GOOD: mq::Color = mq::Color::new(0.45, 0.95, 0.6, 1.0);
const PLAIN: mq::Color = mq::Color::new(0.75, 0.82, 0.9, 1.0);
const BAD: mq::Color = mq::Color::new(1.0, 0.55, 0.35, 1.0);
const PANEL: mq::Color = mq::Color::new(0.02, 0.03, 0.05, 0.55);
const KEYS: [&str; 5] = [
    "W S A D Q E push   arrows Z C turn   X brake",
    "H hold attitude   M match the tumble   P autopilot",
    "1 2 3 level   N other start   Backspace again",
    "K keep this moment   L back to it   Escape quit",
    "Nose to the lit ring: slower than 0.3 m/s, within 10 degrees",
];

/// Instruments, the target's reticle, and what has come of it.
pub(crate) fn draw_instruments(game: &Game, assist: Assist, camera: &mq::Camera3D) {
    let (width, height) = (mq::screen_width(), mq::screen_height());
    let (name, _) = LEVELS.get(game.level).copied().unwrap_or_default();
    mq::draw_rectangle(8.0, 8.0, 270.0, 226.0, PANEL);
    mq::draw_rectangle(8.0, height - 116.0, 500.0, 108.0, PANEL);
    for (i, line) in KEYS.into_iter().enumerate() {
        mq::draw_text(line, 20.0, height - 20.0 * (5 - i) as f32, 18.0, mq::Color::new(0.5, 0.57, 0.66, 1.0));
    }
    let title = format!("{name}, start {}   {:.0} s", game.seed, game.simulation.time());
    mq::draw_text(&title, 20.0, 30.0, 22.0, PLAIN);
    let (message, color) = match &game.outcome {
        Outcome::Docked => ("DOCKED".to_owned(), GOOD),
        Outcome::Missed(reason) => (format!("MISSED: {reason}"), BAD),
        Outcome::OutOfFuel => ("OUT OF FUEL".to_owned(), BAD),
        Outcome::Lost => ("LOST: too far off".to_owned(), BAD),
        Outcome::Flying => (String::new(), PLAIN),
    };
    let size = mq::measure_text(&message, None, 56, 1.0);
    mq::draw_text(&message, (width - size.width) / 2.0, 90.0, 56.0, color);
    let (Some(ship), Some(target)) = (Craft::of::<Player>(&game.world), Craft::of::<Target>(&game.world)) else {
        draw_pair(&game.world);
        return;
    };
    let approach = Approach::of(&ship, &target);
    let (distance, speed) = (approach.gap.length(), approach.drift.length());
    let closing = approach.drift.dot(approach.gap.normalize_or_zero());
    let fuel = game.world.get::<&Fuel>(ship.entity).map_or(0.0, |fuel| fuel.0 / TANK.0);
    let warning = if distance < 4.0 { BAD } else { PLAIN };
    let lines = [
        (format!("distance   {distance:7.2} m"), distance < CAPTURE_DISTANCE),
        (format!("closing    {closing:7.2} m/s"), closing > 0.0 && closing < MAX_SPEED),
        (format!("drift      {speed:7.2} m/s"), speed < MAX_SPEED),
        (
            format!("misaligned {:7.1} deg", approach.misalignment.to_degrees()),
            approach.misalignment < MAX_MISALIGNMENT,
        ),
        (format!("spin       {:7.2} deg/s", approach.spin.to_degrees()), approach.spin < MAX_SPIN),
        (format!("tumble     {:7.2} deg/s", target.velocity.angular.length().to_degrees()), true),
        (format!("fuel       {:7.0} %", fuel * 100.0), fuel > 0.2),
        (["nozzles alone", "attitude held", "tumble matched"][assist as usize].to_owned(), assist != Assist::Off),
    ];
    for (i, (line, good)) in lines.iter().enumerate() {
        let color = if *good { GOOD } else { warning };
        mq::draw_text(line, 20.0, 62.0 + 22.0 * i as f32, 22.0, color);
    }
    draw_reticle(&ship, &target, &approach, camera);
}

/// Once they are docked: what stays as it is, and what does not.
fn draw_pair(world: &World) {
    for (momentum, velocity) in world.query::<(&Momentum, &Velocity)>().iter() {
        let lines = [
            format!("spin       {:7.2} deg/s", velocity.angular.length().to_degrees()),
            format!("angular    {:7.2} kg m2/s", momentum.angular.length()),
            format!("linear     {:7.2} kg m/s", momentum.linear.length()),
        ];
        for (i, line) in lines.iter().enumerate() {
            mq::draw_text(line, 20.0, 62.0 + 22.0 * i as f32, 22.0, GOOD);
        }
    }
}

/// Over the picture: where the port is, or which way to turn to see it. In the middle: a cross
/// where its axis passes the ship's nose, to be flown to, and a ring that is the way it looks, to
/// be turned to; the line is the drift.
fn draw_reticle(ship: &Craft, target: &Craft, approach: &Approach, camera: &mq::Camera3D) {
    let (width, height) = (mq::screen_width(), mq::screen_height());
    let to_ship = ship.pose.orientation.conjugate();
    let at = mq::Vec3::from(seen(target.port_point().to_array()));
    let good = approach.misalignment < MAX_MISALIGNMENT;
    let visible = |at: &mq::Vec2| at.cmpge(mq::Vec2::ZERO).all() && at.cmple(mq::vec2(width, height)).all();
    if let Some(at) = on_screen(camera, at).filter(visible) {
        mq::draw_circle_lines(at.x, at.y, 22.0, 1.5, if good { GOOD } else { BAD });
    } else {
        let [right, _, up] = seen((to_ship * approach.gap).to_array());
        let way = mq::vec2(right, -up).normalize_or(mq::Vec2::X);
        let (at, wide) = (mq::vec2(width, height) / 2.0 + way * 0.4 * height, way.perp() * 9.0);
        mq::draw_triangle(at + way * 22.0, at + wide, at - wide, BAD);
    }
    let (x, y, radius) = (width - 130.0, height - 130.0, 105.0);
    mq::draw_circle(x, y, radius, PANEL);
    mq::draw_circle_lines(x, y, radius, 1.5, PLAIN);
    mq::draw_circle_lines(x, y, radius * 0.17, 1.0, mq::Color::new(0.4, 0.47, 0.56, 1.0));
    // Far off the dial is short of room: it is linear near the middle only.
    let on_dial = |v: Vec3, full: f32| {
        let [right, _, up] = seen((to_ship * v).to_array());
        let flat = mq::vec2(right, -up) / full;
        mq::vec2(x, y) + flat / (1.0 + flat.length()) * radius
    };
    let axis = target.port_axis();
    let aside = approach.gap - axis * approach.gap.dot(axis);
    let cross = on_dial(aside, 1.5);
    for (dx, dy) in [(9.0, 0.0), (0.0, 9.0)] {
        mq::draw_line(cross.x - dx, cross.y - dy, cross.x + dx, cross.y + dy, 2.0, PLAIN);
    }
    // Looking away it is at the rim, or it would be in the middle from behind too.
    let facing = if ship.port_axis().dot(axis) < 0.0 { -axis } else { -axis * 20.0 };
    let ring = on_dial(facing, 0.8);
    mq::draw_circle_lines(ring.x, ring.y, 7.0, 2.0, if good { GOOD } else { BAD });
    let drift = on_dial(approach.drift, 0.6);
    mq::draw_line(x, y, drift.x, drift.y, 2.0, mq::Color::new(1.0, 0.85, 0.4, 1.0));
}

/// Writes what has been drawn as a PNG.
pub(crate) fn save_picture(file: &str) -> Result<(), Box<dyn Error>> {
    // macroquad panics instead; what is there already stays until there is a picture.
    std::fs::OpenOptions::new().append(true).create(true).open(file).map_err(|error| format!("{file}: {error}"))?;
    mq::set_default_camera(); // Nothing is drawn before the camera changes.
    let mut picture = mq::get_screen_data();
    picture.bytes.iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = u8::MAX);
    picture.export_png(file);
    Ok(())
}

pub(crate) fn window() -> macroquad::conf::Conf {
    let miniquad_conf = mq::Conf {
        window_title: "tumble: docking".to_owned(),
        window_width: 1280,
        window_height: 720,
        sample_count: 4,
        ..Default::default()
    };
    // The planet is one mesh.
    macroquad::conf::Conf {
        miniquad_conf,
        draw_call_vertex_capacity: 20_000,
        draw_call_index_capacity: 40_000,
        ..Default::default()
    }
}
