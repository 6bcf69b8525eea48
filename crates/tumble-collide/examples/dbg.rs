use tumble_collide::*;
use tumble_math::lane::*;
fn main() {
    let a = Geometry::Cylinder { radius: 0.5661741309545951, half_height: 0.1 };
    let at = Placement::at(Vec3::new(0.41635208763945686, 0.0, -0.9590932558526734));
    let b = Geometry::Cone { radius: 0.8049975532178375, half_height: 0.8686030154042051 };
    let bt = Placement {
        position: Vec3::new(0.9207189599294852, 0.6046414330540326, -0.3067010158698928),
        orientation: Quat { x: 0.7071067811865476, y: 0.0, z: 0.0, w: 0.7071067811865476 },
    };
    println!("{:#?}", collide(&a, &at, &b, &bt, 0.02));
}
