//! What can be read of a joint: where its second frame is against its first, and how fast it moves.

use tumble_math::lane::Vec3;

use crate::solver::mechanism::free_axis::{Direction, FreeAxis, first_angle, relative_rotation, second_angle};
use crate::solver::mechanism::joint_rows::{JointRows, Stance};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::rotations::Rotations;

impl JointRows {
    /// Where it stands along a free axis.
    pub(crate) fn direction(&self, axis: FreeAxis, bodies: &[MechanismBody]) -> Direction {
        axis.direction(&self.stance(bodies), self.free, self.reference)
    }

    /// Where the second frame is against the first, along the axes of the first, and how fast it
    /// moves: translation \[m\], rotation vector \[rad\].
    pub(crate) fn values_and_speeds(&self, bodies: &[MechanismBody]) -> [[f64; 6]; 2] {
        let stance = self.stance(bodies);
        let Stance { gap, anchor_arms, axes: [axes, of_second], .. } = stance;
        let turn = match self.rotations {
            Rotations::AboutBoth(i, j) => {
                let q = relative_rotation(&stance);
                let mut angles = glam::DVec3::ZERO;
                (angles[i], angles[j]) = (first_angle(q, i, j), second_angle(q, i, j));
                angles[3 - i - j] = axes[i].dot(of_second[j]);
                angles
            }
            _ => tumble_math::to_scaled_axis(relative_rotation(&stance).into()),
        };
        let [a, b] = self.bodies.map(|body| &bodies[body]);
        let (turn_a, turn_b) = (a.angular_velocity(), b.angular_velocity());
        let apart = (b.linear_velocity() + turn_b.cross(anchor_arms[1]))
            - (a.linear_velocity() + turn_a.cross(anchor_arms[0] + gap));
        let turning = turn_b - turn_a;
        let along = |v: Vec3<f64>| axes.map(|axis| axis.dot(v));
        let ([x, y, z], [u, v, w], mut rates) = (along(gap), along(apart), along(turning));
        if let Rotations::AboutBoth(_, j) = self.rotations {
            rates[j] = of_second[j].dot(turning);
        }
        let [p, q, r] = rates;
        [[x, y, z, turn.x, turn.y, turn.z], [u, v, w, p, q, r]]
    }
}
