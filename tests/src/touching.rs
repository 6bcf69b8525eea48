//! Bodies that touch, as tests of contacts need them.

use hecs::{Entity, World};
use tumble::math::{Quat, Vec3};
use tumble::prelude::*;
use tumble::{Collider, Material};

use crate::comparison::{real, vec3};
use crate::draw::Draw;

/// A body with a collider.
pub fn spawn(world: &mut World, body: RigidBody, collider: Collider) -> Entity {
    body.build().expect("a possible body").spawn_with(world, (collider,))
}

/// Infinite ground below the origin, turned about it.
pub fn ground(world: &mut World, material: Material, orientation: Quat) -> Entity {
    spawn(
        world,
        RigidBody::new(Shape::Point).fixed().orientation(orientation),
        surfaced(Collider::half_space(), material),
    )
}

/// A fixed cube with its top at height zero below the origin, by half its edges \[m\].
pub fn cube_below(world: &mut World, half: f64, material: Material) {
    fixed_box(world, [half; 3], (vec3([0.0, -half, 0.0].into()), Quat::IDENTITY), material);
}

/// A fixed box with half its edges \[m\], its middle and how it is turned.
pub fn fixed_box(world: &mut World, half: [f64; 3], (middle, turned): (Vec3, Quat), material: Material) {
    let body = RigidBody::new(Shape::Point).fixed().position(middle).orientation(turned);
    spawn(world, body, surfaced(collider(&Shape::cuboid(half)), material));
}

/// Infinite ground or, as often, such a cube; returns whether it is the ground.
pub fn ground_or_cube(draw: &mut Draw, world: &mut World, half: f64, material: Material) -> bool {
    let is_ground = draw.often(0.5);
    if is_ground {
        ground(world, material, Quat::IDENTITY);
    } else {
        cube_below(world, half, material);
    }
    is_ground
}

/// A collider of a material.
pub fn surfaced(collider: Collider, material: Material) -> Collider {
    collider.with_material(material).expect("a possible material")
}

/// A body of a mass \[kg\] over ground of its material: how high its centre is \[m\], and how fast
/// it falls [m/s].
pub fn fall_to_ground(world: &mut World, shape: &Shape, material: Material, mass: f64, fall: [f64; 2]) -> Entity {
    ground(world, material, Quat::IDENTITY);
    let [height, speed] = fall.map(real);
    let body = RigidBody::new(shape.clone()).mass(mass).position(Vec3::Y * height);
    spawn(world, body.linear_velocity(Vec3::Y * -speed), surfaced(collider(shape), material))
}

/// Six walls around a cube of two metres about the origin, of half a thickness \[m\].
pub fn closed_box(world: &mut World, half_thickness: f64, material: Material) {
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let (mut extents, mut place) = ([1.0 + 2.0 * half_thickness; 3], [0.0; 3]);
            (extents[axis], place[axis]) = (half_thickness, sign * (1.0 + half_thickness));
            let shape = Shape::cuboid(extents);
            let wall = RigidBody::new(shape.clone()).fixed().position(vec3(place.into()));
            spawn(world, wall, surfaced(collider(&shape), material));
        }
    }
}

/// The collider that a shape has.
pub fn collider(shape: &Shape) -> Collider {
    Collider::new(shape).expect("a shape that can be touched")
}

/// A prism about y with a regular face of this number of sides, by its radius and half its height
/// \[m\].
pub fn prism(sides: u32, radius: f64, half: f64) -> Collider {
    let corner = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i / 2) / f64::from(sides)).sin_cos();
        glam::DVec3::new(radius * cos, if i.is_multiple_of(2) { half } else { -half }, radius * sin)
    };
    Collider::convex_hull((0..2 * sides).map(corner)).expect("a prism with three sides or more")
}

/// Height of the centre of mass of a frustum over its base, as a part of its height, by the radius
/// of its top over that of the base.
pub fn frustum_center(top: f64) -> f64 {
    (1.0 + 2.0 * top + 3.0 * top * top) / (4.0 * (1.0 + top + top * top))
}

/// With half the length of its edges \[m\].
pub fn cube(half: f64) -> Shape {
    Shape::cuboid([half, half, half])
}

/// Where a body is.
pub fn pose(world: &World, entity: Entity) -> Pose {
    *world.get::<&Pose>(entity).expect("a body")
}

/// How a body moves.
pub fn velocity(world: &World, entity: Entity) -> Velocity {
    *world.get::<&Velocity>(entity).expect("a body")
}
