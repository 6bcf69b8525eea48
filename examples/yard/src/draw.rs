//! Drawing: shapes with light and shadow, and the text over them.

use macroquad::prelude as mq;
use tumble::glam::DVec3;
use tumble::prelude::*;
use tumble_character::CharacterState;
use tumble_import::Tessellation;
use tumble_vehicle::{Vehicle, VehicleState};

use crate::game::Game;
use crate::yard::{Look, YARD, YELLOW};

const SUN: Vec3 = Vec3::new(0.42, 0.82, 0.39);
const SHADOW: mq::Color = mq::Color::new(0.36, 0.42, 0.33, 1.0);
const SKY: mq::Color = mq::Color::new(0.66, 0.80, 0.92, 1.0);
const HERO: [f32; 3] = [0.16, 0.62, 0.56];
const DARK: [f32; 3] = [0.14, 0.16, 0.20];
const HELP: &str = "WASD move, shift run, space jump, C crouch, left click shoot, right click pull, \
                    E car, R restart, T slow, Tab mouse, Esc quit";

/// A vector as macroquad takes it, which has a version of glam of its own.
pub(crate) fn screen(vector: impl Into<tumble::glam::DVec3>) -> mq::Vec3 {
    mq::Vec3::from(vector.into().as_vec3().to_array())
}

/// Everything, between the last two steps; the hero looks the way `yaw` says.
pub(crate) fn draw_world(game: &Game, alpha: Real, camera: &mq::Camera3D, yaw: Real) {
    mq::clear_background(SKY);
    mq::set_camera(camera);
    draw_ground();
    let mut bodies = game.world.query::<(&Pose, Option<&PreviousPose>, Option<&CenterOfMass>, &Look)>();
    for (pose, previous, center, look) in bodies.iter() {
        let between = previous.map_or(*pose, |it| it.0.interpolate(pose, alpha));
        let origin = Pose { position: between.origin(center), ..between };
        look.0.iter().for_each(|piece| draw_surface(&piece.surface, &(origin * piece.pose), piece.color));
    }
    draw_wheels(game, alpha);
    if !game.player.driving {
        draw_hero(game, alpha, yaw);
    }
    mq::set_default_camera();
}

fn draw_wheels(game: &Game, alpha: Real) {
    let chassis = game.drawn(game.yard.car, alpha);
    let side = Pose::from_rotation(Quat::from_rotation_z(std::f64::consts::FRAC_PI_2 as Real));
    for (vehicle, state, center) in game.world.query::<(&Vehicle, &VehicleState, Option<&CenterOfMass>)>().iter() {
        for (i, wheel) in vehicle.settings().wheels.iter().enumerate() {
            let Some(pose) = vehicle.wheel_pose(i, state, &chassis, center) else { continue };
            let pose = pose * side;
            let half = f64::from(wheel.width) * 0.5;
            draw_shape(&Shape::cylinder(wheel.radius, half), &pose, [0.13; 3]);
            let spoke = [f64::from(wheel.radius) * 0.7, half * 1.1, 0.04];
            draw_shape(&Shape::cuboid(spoke), &pose, [0.75; 3]);
        }
    }
}

/// A capsule with a visor, and the rope from its hand.
fn draw_hero(game: &Game, alpha: Real, yaw: Real) {
    let crouches = game.world.get::<&CharacterState>(game.yard.hero).is_ok_and(|state| state.is_crouching);
    let half: Real = if crouches { 0.24 } else { 0.6 };
    let sole = game.drawn(game.yard.hero, alpha).position;
    let body = Pose { position: sole + Vec3::Y * (half + 0.3), orientation: Quat::from_rotation_y(yaw) };
    draw_shape(&Shape::capsule(0.29, half), &body, HERO);
    for (shape, at, color) in [
        (Shape::cuboid([0.2, 0.07, 0.12]), Vec3::new(0.0, half, -0.2), DARK), // visor
        (Shape::cylinder(0.3, 0.04), Vec3::Y * -0.1, DARK),
        (Shape::cuboid([0.17, 0.22, 0.1]), Vec3::new(0.0, half * 0.5, 0.3), YELLOW), // rucksack
    ] {
        draw_shape(&shape, &(body * Pose::at(at)), color);
    }
    if let Some(grip) = game.player.grip {
        let held = game.drawn(grip.body, alpha).transform_point(grip.local);
        let hand = body.transform_point(Vec3::new(0.3, 0.2, -0.2));
        let (middle, way) = ((hand + held) * 0.5, held - hand);
        let along = Quat::from_rotation_arc(Vec3::Y, way.normalize_or(Vec3::Y));
        let rope = Shape::cylinder(0.02, way.length() * 0.5);
        draw_shape(&rope, &Pose { position: middle, orientation: along }, YELLOW);
    }
}

/// Tiles, and what lies beyond the walls.
fn draw_ground() {
    let tile = |x: f32, z: f32, size: f32, height: f32, [r, g, b]: [f32; 3]| {
        let (x_edge, z_edge) = (mq::Vec3::X * size, mq::Vec3::Z * size);
        mq::draw_affine_parallelogram(mq::vec3(x, height, z), x_edge, z_edge, None, mq::Color::new(r, g, b, 1.0));
    };
    tile(-250.0, -250.0, 500.0, -0.05, [0.50, 0.58, 0.46]);
    let count = (YARD / 2.0) as i16;
    for i in -count..count {
        for j in -count..count {
            let color = if (i + j) % 2 == 0 { [0.55, 0.61, 0.50] } else { [0.58, 0.64, 0.53] };
            tile(f32::from(i) * 2.0, f32::from(j) * 2.0, 2.0, 0.0, color);
        }
    }
}

fn draw_shape(shape: &Shape, pose: &Pose, color: [f32; 3]) {
    draw_surface(&Tessellation::of(shape), pose, color);
}

/// A surface by the light of the sun, and its shadow on the ground.
fn draw_surface(surface: &Tessellation, pose: &Pose, [r, g, b]: [f32; 3]) {
    let lit = |normal: Vec3| {
        let normal = pose.orientation * normal;
        let shade = screen(Vec3::splat(0.66 + 0.32 * normal.dot(SUN).max(0.0) + 0.10 * normal.y)).x;
        mq::Color::new(r * shade, g * shade, b * shade, 1.0)
    };
    draw_triangles(surface, lit, |point| pose.transform_point(point));
    let to_shadow = |point| {
        let at = pose.transform_point(point);
        (at - SUN * (at.y.max(0.0) / SUN.y)).with_y(0.012)
    };
    draw_triangles(surface, |_| SHADOW, to_shadow);
}

fn draw_triangles(surface: &Tessellation, color: impl Fn(Vec3) -> mq::Color, to: impl Fn(Vec3) -> Vec3) {
    let vertex = |(point, normal): (&DVec3, &DVec3)| {
        let [point, normal] = [point, normal].map(|vector| Vec3::from_array(vector.to_array().map(|it| it as Real)));
        mq::Vertex::new2(screen(to(point)), mq::Vec2::ZERO, color(normal))
    };
    let vertices = surface.positions.iter().zip(&surface.normals).map(vertex).collect();
    let indices = surface.triangles.iter().flatten().map(|index| *index as u16).collect();
    mq::draw_mesh(&mq::Mesh { vertices, indices, texture: None });
}

/// The keys, a cross in the middle, and what is to be done here.
pub(crate) fn draw_text(game: &Game) {
    let (width, height) = (mq::screen_width(), mq::screen_height());
    mq::draw_rectangle(0.0, height - 30.0, width, 30.0, mq::Color::new(0.0, 0.0, 0.0, 0.45));
    mq::draw_text(HELP, 14.0, height - 9.0, 20.0, mq::WHITE);
    if game.player.driving {
        let speed = game.world.get::<&Velocity>(game.yard.car).map_or(0.0, |it| it.linear.length());
        mq::draw_text(format!("{:.0} km/h", speed * 3.6), 14.0, 34.0, 32.0, mq::WHITE);
        return;
    }
    let color = if game.player.grip.is_some() { mq::ORANGE } else { mq::WHITE };
    mq::draw_circle_lines(width * 0.5, height * 0.5, 5.0, 2.0, color);
    if game.is_at_car() {
        mq::draw_text("E: drive", width * 0.5 + 14.0, height * 0.5 + 30.0, 28.0, mq::WHITE);
    }
}

/// Writes what has been drawn as a PNG.
pub(crate) fn save_picture(file: &str) {
    mq::set_default_camera(); // Nothing is drawn before the camera changes.
    let mut picture = mq::get_screen_data();
    picture.bytes.iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = u8::MAX);
    picture.export_png(file);
}
