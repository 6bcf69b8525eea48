//! Promise: thin bodies stay together at joints far off their axes, whatever their size: a
//! substep in which they turn too fast for a solution is halved until there is one.
//!
//! Why: a rod of 1:50 that hangs at a point beside its axis turns about that axis faster than a
//! substep can follow, and a solver that takes the last of too few solutions tears it off and
//! gives it any energy. It fails if a substep is not halved, or if a half does not begin where the
//! whole did.

use crate::jointed::*;
use glam::DVec3;
use tumble::{Joint, RigidBody, Shape};
use tumble_tests::Draw;
use tumble_tests::references::real_quat;

#[test]
fn thin_rods_stay_together() {
    let (mut widest, mut energies) = (0.0_f64, Vec::new());
    for case in 0..150 {
        let mut draw = Draw::new(0xd0, case);
        let (length, aspect) = (draw.log_between(0.01, 100.0), draw.log_between(5.0, 200.0));
        let mut rig = Rig::new(ORIGIN, 1.0 / draw.between(60.0, 240.0), 4);
        let spin = draw.direction() * 3.0;
        let count = 2 + draw.between(0.0, 3.0) as usize;
        let shape = Shape::cuboid(DVec3::new(0.5, 0.5 / aspect, 0.5 / aspect) * length);
        let rods: Vec<_> = (0..count)
            .map(|number| {
                let at = DVec3::X * length * number as f64;
                let rod = RigidBody::new(shape.clone())
                    .without_collider()
                    .mass(draw.log_between(0.3, 3.0))
                    .position(real(at));
                let rod = rod.orientation(real_quat(draw.orientation()));
                rig.spawn(rod.linear_velocity(real(spin.cross(at))).angular_velocity(real(spin)))
            })
            .collect();
        for pair in rods.windows(2) {
            let middle = 0.5 * (rig.position(pair[0]) + rig.position(pair[1]));
            let at = middle + draw.direction() * draw.between(0.0, 1.0) * length;
            let joint = if draw.often(0.7) { Joint::ball(pair[0], pair[1]) } else { Joint::hinge(pair[0], pair[1]) };
            rig.join_at(joint, at, draw.direction());
        }
        let start = rig.energy();
        let mut most = 0.0_f64;
        for _ in 0..600 {
            rig.step();
            widest = widest.max(rig.largest_gap() / length);
            most = most.max(rig.energy() / start - 1.0);
        }
        println!("case {case}: 1:{aspect:.0}, {count} rods, gained {most:e}");
        energies.push(most);
    }
    energies.sort_by(f64::total_cmp);
    let (usual, worst) = (energies[energies.len() * 9 / 10], energies[energies.len() - 1]);
    println!("open by {widest:e} of a length; energy grows by {usual:e} at nine in ten, {worst:e} at most");
    assert!(widest < 1e-5, "{widest:e}");
    assert!(usual < 1e-5 && worst < 0.02, "{usual:e} {worst:e}");
}
