use tumble_math::lane::Vec3;

use super::body::{Relative, SolverBody};
use super::constraint::Constraint;
use super::material::Surface;
use crate::math::Real;

/// What resists sliding, twisting and rolling in the middle of a contact. Impulses are those of a substep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    /// Coefficients of friction: what it takes to begin to slide, and what sliding meets.
    static_friction: Real,
    dynamic_friction: Real,
    /// Resistance to rolling, as a length \[m\].
    rolling: Real,
    /// Radius at which friction acts against a twist \[m\].
    radius: Real,
    /// Inverse of the 2x2 matrix that takes an impulse in the tangent plane to a velocity: `xx, xy, yy` \[kg\].
    mass: [Real; 3],
    /// The same of angular impulses about the tangents [kg m^2].
    rolling_mass: [Real; 3],
    /// Angular impulse about the normal that takes out a twist of one rad/s.
    twisting_mass: Real,
    /// Impulse along the tangents \[N s\].
    pub(super) sliding: [Real; 2],
    /// Angular impulse about the normal [N m s].
    pub(super) twist: Real,
    /// Angular impulse about the tangents [N m s].
    pub(super) roll: [Real; 2],
}

/// Mean distance from the middle of a square under even pressure, over that of its corners: 0.3826 and 0.7071 of the side.
const FACE: Real = 0.541;

impl Friction {
    pub(super) const NONE: Self = Self {
        static_friction: 0.0,
        dynamic_friction: 0.0,
        rolling: 0.0,
        radius: 0.0,
        mass: [0.0; 3],
        rolling_mass: [0.0; 3],
        twisting_mass: 0.0,
        sliding: [0.0; 2],
        twist: 0.0,
        roll: [0.0; 2],
    };

    pub(super) fn new(contact: &Constraint, [first, second]: [&SolverBody; 2], surface: &Surface) -> Self {
        let mass = |of: &dyn Fn(Vec3<Real>, Vec3<Real>) -> Real| {
            let [s, t] = contact.tangents;
            inverse([of(s, s), of(s, t), of(t, t)])
        };
        let turning = |s: Vec3<Real>, t: Vec3<Real>| t.dot(first.response(s)) + t.dot(second.response(s));
        let sliding = |s: Vec3<Real>, t: Vec3<Real>| {
            let of = |body: &SolverBody, arm: Vec3<Real>| arm.cross(t).dot(body.response(arm.cross(s)));
            (first.inverse_mass + second.inverse_mass) * s.dot(t)
                + of(first, contact.arms[0])
                + of(second, contact.arms[1])
        };
        let about_normal = turning(contact.normal, contact.normal);
        let distances = contact.rows().iter().map(|row| (row.a * row.a + row.b * row.b).sqrt());
        let points = contact.rows().len();
        let mean = distances.fold(0.0, |sum, distance| sum + distance) / points.max(1) as Real;
        Self {
            static_friction: surface.static_friction,
            dynamic_friction: surface.dynamic_friction,
            rolling: surface.rolling_friction,
            radius: if points > 2 { mean * FACE } else { mean },
            mass: mass(&sliding),
            rolling_mass: mass(&turning),
            twisting_mass: if about_normal > 0.0 { 1.0 / about_normal } else { 0.0 },
            ..Self::NONE
        }
    }

    /// The same that has done nothing yet.
    pub(super) fn released(self) -> Self {
        Self { sliding: [0.0; 2], twist: 0.0, roll: [0.0; 2], ..self }
    }

    /// The impulse in the tangent plane, world frame.
    pub(super) fn linear(&self, contact: &Constraint) -> Vec3<Real> {
        contact.tangents[0] * self.sliding[0] + contact.tangents[1] * self.sliding[1]
    }

    /// The angular impulse, world frame.
    pub(super) fn turning(&self, contact: &Constraint) -> Vec3<Real> {
        contact.normal * self.twist + contact.tangents[0] * self.roll[0] + contact.tangents[1] * self.roll[1]
    }

    /// Takes out what relative motion friction can; returns by how much the impulse and the angular impulse changed.
    ///
    /// Sliding and twisting share what there is: the impulse `f` and the angular impulse `t` are within
    /// `|f|^2 + (t/radius)^2 <= (mu N)^2`, the ellipsoid that approximates the limit surface of a patch (S. Goyal, A. Ruina, J. Papadopoulos, 1991).
    pub(super) fn solve(&mut self, contact: &Constraint, motion: &Relative, normal: Real) -> (Vec3<Real>, Vec3<Real>) {
        let before = *self;
        let along = |v: Vec3<Real>| [contact.tangents[0].dot(v), contact.tangents[1].dot(v)];
        let [du, dv] = product(self.mass, along(motion.linear));
        let (u, v) = (self.sliding[0] - du, self.sliding[1] - dv);
        let twist =
            if self.radius > 0.0 { self.twist - self.twisting_mass * contact.normal.dot(motion.angular) } else { 0.0 };
        let reach = if self.radius > 0.0 { twist / self.radius } else { 0.0 };
        let wanted = (u * u + v * v + reach * reach).sqrt();
        let scale = if wanted > self.static_friction * normal { self.dynamic_friction * normal / wanted } else { 1.0 };
        self.sliding = [u * scale, v * scale];
        self.twist = twist * scale;

        if self.rolling > 0.0 {
            let [du, dv] = product(self.rolling_mass, along(motion.angular));
            let (u, v) = (self.roll[0] - du, self.roll[1] - dv);
            let (wanted, limit) = ((u * u + v * v).sqrt(), self.rolling * normal);
            let scale = if wanted > limit { limit / wanted } else { 1.0 };
            self.roll = [u * scale, v * scale];
        }
        (self.linear(contact) - before.linear(contact), self.turning(contact) - before.turning(contact))
    }
}

/// Inverse of a symmetric 2x2 matrix `xx, xy, yy`; zero where there is none.
fn inverse([a, b, c]: [Real; 3]) -> [Real; 3] {
    let determinant = a * c - b * b;
    if determinant > 0.0 {
        let scale = 1.0 / determinant;
        [c * scale, -b * scale, a * scale]
    } else {
        [0.0; 3]
    }
}

fn product([a, b, c]: [Real; 3], [x, y]: [Real; 2]) -> [Real; 2] {
    [a * x + b * y, b * x + c * y]
}
