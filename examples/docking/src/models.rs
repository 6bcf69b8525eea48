//! What the craft are made of. The same parts give tumble the masses and macroquad the pictures.

use macroquad::prelude as mq;
use tumble::prelude::*;

use crate::{Nozzle, Nozzles};

/// All parts of a craft.
pub(crate) struct Looks(pub(crate) Vec<Look>);

/// A part of a craft: what tumble computes the inertia from, and what is drawn.
#[derive(Clone)]
pub(crate) struct Look {
    pub(crate) shape: Shape,
    pub(crate) kilograms: f64,
    pub(crate) pose: Pose,
    pub(crate) color: mq::Color,
}
pub(crate) fn shape_of(looks: &[Look]) -> Shape {
    let part = |look: &Look| Part::new(look.shape.clone(), Amount::Mass(look.kilograms)).at(look.pose.position);
    Shape::compound(looks.iter().map(part))
}

fn look(shape: Shape, kilograms: f64, at: [Real; 3], color: u32) -> Look {
    let pose = Pose { position: Vec3::from_array(at), ..Pose::default() };
    Look { shape, kilograms, pose, color: mq::Color::from_hex(color) }
}

pub(crate) fn satellite() -> Vec<Look> {
    let mut looks = vec![
        look(Shape::cuboid([0.6, 0.9, 0.6]), 300.0, [0.0; 3], 0xd9a441),
        look(Shape::cylinder(0.34, 0.12), 20.0, [0.0, 1.0, 0.0], 0xb8bcc4),
        look(Shape::cylinder(0.22, 0.01), 1.0, [0.0, 1.12, 0.0], 0x23262d),
        look(Shape::cuboid([4.0, 0.04, 0.04]), 10.0, [0.0; 3], 0x9aa0a8),
        look(Shape::frustum(0.55, 0.12, 0.15), 8.0, [0.0, -1.15, 0.0], 0xe8e8e8),
        look(Shape::cylinder(0.03, 0.3), 1.0, [0.0, -1.4, 0.0], 0xc0504d),
    ];
    for x in [-3.45, -2.375, -1.3, 1.3, 2.375, 3.45] {
        looks.push(look(Shape::cuboid([0.52, 0.8, 0.015]), 1.0, [x, 0.0, 0.0], 0xaab2c0));
        for y in [-0.52, 0.0, 0.52] {
            looks.push(look(Shape::cuboid([0.48, 0.24, 0.025]), 4.0, [x, y, 0.0], 0x23408e));
        }
    }
    looks
}

pub(crate) fn ship(nozzles: &Nozzles) -> Vec<Look> {
    let mut looks = vec![
        look(Shape::cylinder(0.6, 0.8), 240.0, [0.0, -0.1, 0.0], 0xdfe3e8),
        look(Shape::cylinder(0.615, 0.07), 2.0, [0.0, 0.45, 0.0], 0xd9622b),
        look(Shape::cylinder(0.615, 0.07), 2.0, [0.0, -0.65, 0.0], 0x3a4a63),
        look(Shape::frustum(0.6, 0.3, 0.3), 40.0, [0.0, 1.0, 0.0], 0xc5ccd6),
        look(Shape::cylinder(0.12, 0.18), 5.0, [0.0, 1.46, 0.0], 0x565c66),
        look(Shape::frustum(0.45, 0.2, 0.2), 20.0, [0.0, -1.1, 0.0], 0x6d7480),
        look(Shape::cylinder(0.36, 0.01), 1.0, [0.0, -1.3, 0.0], 0x3b2a22),
        look(Shape::cylinder(0.17, 0.01), 1.0, [0.0, -1.32, 0.0], 0xd9622b),
        look(Shape::cuboid([0.22, 0.12, 0.05]), 1.0, [0.0, 0.92, 0.5], 0x2a4a78),
    ];
    for x in [-0.74, 0.74] {
        looks.push(look(Shape::cylinder(0.17, 0.45), 35.0, [x, -0.2, 0.0], 0xaab2bd));
    }
    let pod = |nozzle: &Nozzle| look(Shape::cuboid([0.08; 3]), 2.0, nozzle.point.to_array(), 0x6a7280);
    looks.extend(nozzles.0.iter().step_by(3).map(pod));
    looks
}
