//! The blow of two bodies in one point: with restitution, and friction after it.
//!
//! Along the normal a blow takes the speed to that of the bounce, and then friction takes what is
//! left across it as far as its cone lets it: each by the mass that moves in its direction, so that
//! neither makes energy.

use tumble_math::lane::{Quat, Vec3};

use crate::collision::material::Surface;
use crate::collision::traveller::state_of;
use crate::components::{Momentum, Velocity};
use crate::integrators::derived::{Derived, derived};
use crate::integrators::state::State;
use crate::joints::axis_lock::AxisLock;
use crate::math::{Real, double, vec3};
use crate::storage::body_index::RowPlace;
use crate::storage::world_columns::{ArchetypeBodies, WorldColumns};

/// A body that is struck, or strikes.
pub(crate) struct Struck {
    pub(crate) place: RowPlace,
    /// From its centre of mass to the point \[m\].
    pub(crate) arm: Vec3<Real>,
    pub(crate) orientation: Quat<Real>,
    pub(crate) lock: AxisLock,
}

/// Of two bodies that came together.
pub(crate) struct Blow {
    /// Along the normal, before it [m/s].
    pub(crate) closing_speed: Real,
    /// Along the normal \[N s\].
    pub(crate) impulse: Real,
}

/// How a body moves and responds.
struct Responding {
    velocity: [Vec3<Real>; 2],
    /// Zero of a body that is not dynamic [1/kg].
    inverse_mass: Real,
    derived: Option<Derived<Real>>,
    lock: AxisLock,
    arm: Vec3<Real>,
    /// What it has received [N s] [N m s].
    impulse: [Vec3<Real>; 2],
}

/// Gives both bodies the impulses of a blow along the normal, from the first to the second, if they
/// come together; what comes faster than `threshold` [m/s] bounces. Returns the blow, if they do.
pub(crate) fn strike(
    columns: &mut WorldColumns<'_>,
    both: &[Struck; 2],
    normal: Vec3<Real>,
    surface: &Surface,
    threshold: Real,
) -> Option<Blow> {
    let [first, second] = both.each_ref().map(|it| Responding::of(columns, it));
    let (mut first, mut second) = (first?, second?);
    if normal.dot(second.velocity_at() - first.velocity_at()) >= 0.0 {
        // What spins away at this point while it comes nearer will meet it with another: in the
        // mean it is a ball.
        for it in [&mut first, &mut second].into_iter().filter(|it| it.derived.is_some()) {
            it.arm = Vec3::zero();
        }
    }
    let speed = normal.dot(second.velocity_at() - first.velocity_at());
    let response = first.response(normal) + second.response(normal);
    let comes_together = speed < 0.0 && response > 0.0 && response < Real::INFINITY;
    if !comes_together {
        return None;
    }
    let restitution = if -speed > threshold { surface.restitution } else { 0.0 };
    let pressed = -speed * (1.0 + restitution) / response;
    push(&mut first, &mut second, normal * pressed);
    let slip = second.velocity_at() - first.velocity_at();
    let slip = slip - normal * normal.dot(slip);
    let slip_speed = slip.dot(slip).sqrt();
    if slip_speed > 0.0 {
        let along = slip * (1.0 / slip_speed);
        let holds = slip_speed / (first.response(along) + second.response(along));
        let sticks = holds <= surface.static_friction * pressed;
        let rubbed = if sticks { holds } else { holds.min(surface.dynamic_friction * pressed) };
        push(&mut first, &mut second, along * -rubbed);
    }
    for (it, struck) in [first, second].iter().zip(both) {
        it.write(columns, struck);
    }
    Some(Blow { closing_speed: -speed, impulse: pressed })
}

/// Adds an impulse on the second, and the opposite one on the first.
fn push(first: &mut Responding, second: &mut Responding, impulse: Vec3<Real>) {
    first.add(impulse * -1.0);
    second.add(impulse);
}

impl Responding {
    fn of(columns: &WorldColumns<'_>, struck: &Struck) -> Option<Self> {
        let (zero, arm) = (Vec3::zero(), struck.arm);
        if let Some((constants, state)) = state_of(columns, struck.place) {
            let state = State { orientation: struck.orientation, ..state };
            let lock = struck.lock;
            let derived = lock.locked(&constants, &state, derived(&constants, &state));
            return Some(Self {
                velocity: [derived.linear, derived.angular],
                inverse_mass: 1.0 / constants.mass,
                derived: Some(derived),
                lock,
                arm,
                impulse: [zero; 2],
            });
        }
        let Velocity { linear, angular } = match columns.bodies(struck.place) {
            ArchetypeBodies::NonDynamic(columns) => columns.velocity(struck.place.row as usize),
            _ => return None,
        };
        let velocity = [linear.into(), angular.into()];
        Some(Self { velocity, inverse_mass: 0.0, derived: None, lock: struck.lock, arm, impulse: [zero; 2] })
    }

    fn velocity_at(&self) -> Vec3<Real> {
        self.velocity[0] + self.velocity[1].cross(self.arm)
    }

    /// By how much a unit impulse changes the speed along its direction [1/kg].
    fn response(&self, direction: Vec3<Real>) -> Real {
        let Some(derived) = &self.derived else { return 0.0 };
        let turning = self.arm.cross(direction);
        let moving = self.free(direction).dot(direction) * self.inverse_mass;
        moving + turning.dot(derived.apply_inverse_inertia(turning))
    }

    fn add(&mut self, impulse: Vec3<Real>) {
        if let Some(derived) = &self.derived {
            let turning = self.arm.cross(impulse);
            let linear = self.free(impulse);
            self.velocity[0] = self.velocity[0] + linear * self.inverse_mass;
            self.velocity[1] = self.velocity[1] + derived.apply_inverse_inertia(turning);
            self.impulse = [self.impulse[0] + linear, self.impulse[1] + turning];
        }
    }

    /// Of an impulse, what is along axes with free translation.
    fn free(&self, impulse: Vec3<Real>) -> Vec3<Real> {
        vec3(self.lock.along_free(double(impulse))).into()
    }

    fn write(&self, columns: &mut WorldColumns<'_>, struck: &Struck) {
        if let Some(columns) = columns.dynamic_mut(struck.place) {
            let Momentum { linear, angular } = &mut columns.momentum[struck.place.row as usize];
            *linear = (Vec3::from(*linear) + self.impulse[0]).into();
            *angular = (Vec3::from(*angular) + self.impulse[1]).into();
        }
    }
}
