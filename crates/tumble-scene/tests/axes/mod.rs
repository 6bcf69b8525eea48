//! The axes of joints by their names in scene files.

use tumble::Axes;

pub(crate) const AXES: [(&str, Axes); 6] = [
    ("linear_x", Axes::LINEAR_X),
    ("linear_y", Axes::LINEAR_Y),
    ("linear_z", Axes::LINEAR_Z),
    ("angular_x", Axes::ANGULAR_X),
    ("angular_y", Axes::ANGULAR_Y),
    ("angular_z", Axes::ANGULAR_Z),
];
