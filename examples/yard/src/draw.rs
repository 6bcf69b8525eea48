//! Drawing: shapes with light and shadow, and the text over them.

use macroquad::prelude as mq;
use tumble::prelude::*;
use tumble_character::CharacterState;
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

/// Points and normals, and which three make a triangle.
type Surface = (Vec<(Vec3, Vec3)>, Vec<u16>);

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
        look.0.iter().for_each(|piece| draw_shape(&piece.shape, &(origin * piece.pose), piece.color));
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

/// A shape by the light of the sun, and its shadow on the ground.
fn draw_shape(shape: &Shape, pose: &Pose, [r, g, b]: [f32; 3]) {
    let surface = surface(shape);
    let lit = |_: Vec3, normal: Vec3| {
        let light = (pose.orientation * normal).dot(SUN);
        let sky = (pose.orientation * normal).y;
        let shade = screen(Vec3::splat(0.66 + 0.32 * light.max(0.0) + 0.10 * sky)).x;
        mq::Color::new(r * shade, g * shade, b * shade, 1.0)
    };
    draw_surface(&surface, lit, |point| pose.transform_point(point));
    draw_surface(
        &surface,
        |_, _| SHADOW,
        |point| {
            let at = pose.transform_point(point);
            (at - SUN * (at.y.max(0.0) / SUN.y)).with_y(0.012)
        },
    );
}

fn draw_surface((points, triangles): &Surface, color: impl Fn(Vec3, Vec3) -> mq::Color, to: impl Fn(Vec3) -> Vec3) {
    let vertex =
        |(point, normal): &(Vec3, Vec3)| mq::Vertex::new2(screen(to(*point)), mq::Vec2::ZERO, color(*point, *normal));
    let vertices = points.iter().map(vertex).collect();
    mq::draw_mesh(&mq::Mesh { vertices, indices: triangles.clone(), texture: None });
}

/// Points of what the yard is made of: boxes, and what is round about y.
fn surface(shape: &Shape) -> Surface {
    match *shape {
        Shape::Cuboid { half_extents } => cuboid(Vec3::from_array(half_extents.to_array().map(|it| it as Real))),
        Shape::Sphere { radius } => round(radius as Real, 0.0),
        Shape::Capsule { radius, half_height } => round(radius as Real, half_height as Real),
        Shape::Cylinder { radius, half_height } => {
            let (r, h) = (radius as Real, half_height as Real);
            turned(&[
                [0.0, h, 0.0, 1.0],
                [r, h, 0.0, 1.0],
                [r, h, 1.0, 0.0],
                [r, -h, 1.0, 0.0],
                [r, -h, 0.0, -1.0],
                [0.0, -h, 0.0, -1.0],
            ])
        }
        _ => Surface::default(),
    }
}

fn cuboid(half: Vec3) -> Surface {
    let mut surface = Surface::default();
    for (i, axis) in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate() {
        let [a, b] = [[Vec3::Y, Vec3::Z], [Vec3::Z, Vec3::X], [Vec3::X, Vec3::Y]][i];
        for normal in [axis, -axis] {
            let first = surface.0.len() as u16;
            surface.0.extend([-a - b, a - b, a + b, b - a].map(|corner| ((normal + corner) * half, normal)));
            surface.1.extend([0, 1, 2, 0, 2, 3].map(|it| first + it));
        }
    }
    surface
}

/// A ball, or a capsule where its halves are apart.
fn round(radius: Real, half: Real) -> Surface {
    let ring = |i: u8| {
        let (sin, cos) = (Real::from(i) * (std::f64::consts::PI / 13.0) as Real).sin_cos();
        [radius * sin, radius * cos + if i < 7 { half } else { -half }, sin, cos]
    };
    turned(&std::array::from_fn::<_, 14, _>(|i| ring(i as u8)))
}

/// A line of radius, height and normal that is turned about y.
fn turned(profile: &[[Real; 4]]) -> Surface {
    const AROUND: u16 = 24;
    let mut surface = Surface::default();
    for [radius, height, out, up] in profile {
        for i in 0..AROUND {
            let (sin, cos) = (Real::from(i) * (std::f64::consts::TAU / 24.0) as Real).sin_cos();
            surface.0.push((Vec3::new(radius * cos, *height, radius * sin), Vec3::new(out * cos, *up, out * sin)));
        }
    }
    for ring in 1..profile.len() as u16 {
        for i in 0..AROUND {
            let [a, b] = [i, (i + 1) % AROUND].map(|it| ring * AROUND + it);
            surface.1.extend([a, b, a - AROUND, b, b - AROUND, a - AROUND]);
        }
    }
    surface
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
