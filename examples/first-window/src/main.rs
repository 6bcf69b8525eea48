//! Boxes on springs in a window: the space bar hits them all at a corner, and D shows their axes
//! and angular velocities.

use macroquad::prelude as mq;
use tumble::DebugView;
use tumble::prelude::*;

/// What a box looks like: a component of the game's own, on the same entity as those of the body.
struct Block {
    half_extents: Vec3,
    color: mq::Color,
}

#[macroquad::main("tumble")]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = hecs::World::new();
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO))?;
    let half_extents = Vec3::new(0.5, 0.3, 0.1);
    for (i, color) in [mq::RED, mq::ORANGE, mq::GOLD, mq::GREEN, mq::SKYBLUE].into_iter().enumerate() {
        let place = Vec3::X * (i as Real - 2.0) * 1.5;
        let body = RigidBody::new(Shape::cuboid(half_extents)).mass(2.0).position(place).interpolated();
        // Spun about the middle axis, with a little beside it: it will turn over, again and again.
        let spin = Vec3::new(0.01, 2.0 + i as Real, 0.01);
        let body = body.angular_velocity(spin).build()?.spawn(&mut world);
        let spring = SpringToPoint { anchor: place, stiffness: 20.0, damping: 1.0, ..SpringToPoint::default() };
        world.insert(body, (spring, Block { half_extents, color }))?;
    }

    while !mq::is_key_pressed(mq::KeyCode::Escape) {
        if mq::is_key_pressed(mq::KeyCode::Space) {
            for (pose, momentum, block) in world.query_mut::<(&Pose, &mut Momentum, &Block)>() {
                let corner = pose.transform_point(block.half_extents);
                momentum.apply_impulse_at(Vec3::Y * 6.0, corner, pose.position);
            }
        }
        let alpha = simulation.advance(&mut world, f64::from(mq::get_frame_time()));

        mq::clear_background(mq::BLACK);
        let (position, target) = (mq::vec3(0.0, 2.0, 8.0), mq::Vec3::ZERO);
        mq::set_camera(&mq::Camera3D { position, target, up: mq::Vec3::Y, ..Default::default() });
        for (previous, pose, block) in world.query_mut::<(&PreviousPose, &Pose, &Block)>() {
            draw(&previous.0.interpolate(pose, alpha), block);
        }
        if mq::is_key_down(mq::KeyCode::D) {
            let view = DebugView { angular_velocity: Some(0.5), alpha, ..DebugView::default() };
            view.draw(&world, &mut |from: Vec3, to: Vec3, [r, g, b]: [f32; 3]| {
                mq::draw_line_3d(screen(from), screen(to), mq::Color::new(r, g, b, 1.0));
            });
        }
        mq::next_frame().await;
    }
    Ok(())
}

/// Draws the six faces of a box, each pair in a shade of its own.
fn draw(pose: &Pose, block: &Block) {
    let h = block.half_extents;
    let edges = [Vec3::X * h.x, Vec3::Y * h.y, Vec3::Z * h.z].map(|half_edge| pose.orientation * half_edge);
    for (i, shade) in [0.6, 1.0, 0.8].into_iter().enumerate() {
        let [along, a, b] = [edges[i], edges[(i + 1) % 3], edges[(i + 2) % 3]];
        let color = mq::Color::from_vec((block.color.to_vec() * shade).truncate().extend(1.0));
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
