//! A tower to throw balls at: space throws one, R begins again, and what is hit flashes.

use macroquad::prelude as mq;
use tumble::prelude::*;

/// Radius of a ball, and half the edge of a box \[m\].
const RADIUS: f32 = 0.25;
const HALF: Real = 0.24;

/// What a body looks like: a component of the game's own, on the same entity as those of the body.
struct Look {
    is_ball: bool,
    color: mq::Color,
    /// From 1 where it was just hit to 0.
    flash: f32,
}

#[macroquad::main("tumble")]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = tower()?;
    let mut simulation = Simulation::new(Settings::default())?;
    while !mq::is_key_pressed(mq::KeyCode::Escape) {
        if mq::is_key_pressed(mq::KeyCode::R) {
            (world, simulation) = (tower()?, Simulation::new(Settings::default())?);
        }
        if mq::is_key_pressed(mq::KeyCode::Space) {
            let ball = RigidBody::new(Shape::sphere(RADIUS)).mass(8.0).position(Vec3::new(0.0, 2.0, 8.0));
            let look = Look { is_ball: true, color: mq::ORANGE, flash: 0.0 };
            spawn(&mut world, ball.linear_velocity(Vec3::new(0.0, 1.0, -15.0)), look)?;
        }
        let alpha = simulation.advance(&mut world, f64::from(mq::get_frame_time()));
        for event in simulation.contact_events() {
            let ContactEvent::Begin(bodies, impact) = event else { continue };
            for body in bodies.into_iter().filter(|_| impact.speed > 1.0) {
                if let Ok(mut look) = world.get::<&mut Look>(body) {
                    look.flash = 1.0;
                }
            }
        }

        mq::clear_background(mq::BLACK);
        let (position, target) = (mq::vec3(4.0, 3.0, 9.0), mq::vec3(0.0, 1.2, 0.0));
        mq::set_camera(&mq::Camera3D { position, target, up: mq::Vec3::Y, ..Default::default() });
        mq::draw_grid(40, 1.0, mq::GRAY, mq::DARKGRAY);
        for (previous, pose, look) in world.query_mut::<(&PreviousPose, &Pose, &mut Look)>() {
            look.flash *= 0.9;
            draw(&previous.0.interpolate(pose, alpha), look);
        }
        mq::next_frame().await;
    }
    Ok(())
}

/// Ground, and three by five boxes on it.
fn tower() -> Result<hecs::World, Box<dyn std::error::Error>> {
    let mut world = hecs::World::new();
    spawn_ground(&mut world);
    let brick = RigidBody::new(Shape::cuboid(Vec3::splat(HALF))).mass(2.0);
    for i in 0..15_u8 {
        let [row, column] = [i / 3, i % 3].map(Real::from);
        let place = Vec3::new(0.5 * column - 0.5, HALF + 2.0 * HALF * row, 0.0);
        let color = [mq::RED, mq::GOLD, mq::GREEN, mq::SKYBLUE, mq::VIOLET][usize::from(i / 3)];
        spawn(&mut world, brick.clone().position(place), Look { is_ball: false, color, flash: 0.0 })?;
    }
    Ok(world)
}

/// Spawns a body that can be drawn between two steps.
fn spawn(world: &mut hecs::World, body: RigidBody, look: Look) -> Result<(), Box<dyn std::error::Error>> {
    body.interpolated().build()?.spawn_with(world, (look,));
    Ok(())
}

/// Draws a ball, or the six faces of a box, each pair in a shade of its own.
fn draw(pose: &Pose, look: &Look) {
    let flashed = look.color.to_vec().lerp(mq::WHITE.to_vec(), look.flash);
    if look.is_ball {
        return mq::draw_sphere(screen(pose.position), RADIUS, None, mq::Color::from_vec(flashed));
    }
    let edges = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| pose.orientation * axis * HALF);
    for (i, shade) in [0.6, 1.0, 0.8].into_iter().enumerate() {
        let [along, a, b] = [edges[i], edges[(i + 1) % 3], edges[(i + 2) % 3]];
        let color = mq::Color::from_vec((flashed * shade).truncate().extend(1.0));
        for side in [along, -along] {
            let corner = pose.position + side - a - b;
            mq::draw_affine_parallelogram(screen(corner), screen(a * 2.0), screen(b * 2.0), None, color);
        }
    }
}

/// A vector as macroquad takes it, which has a version of glam of its own.
fn screen(vector: impl Into<tumble::glam::DVec3>) -> mq::Vec3 {
    mq::Vec3::from(vector.into().as_vec3().to_array())
}
