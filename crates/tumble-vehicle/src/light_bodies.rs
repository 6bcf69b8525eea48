//! Bodies under a wheel that are too light to be given its load. Such a body carries only where
//! it lies on what can, and what it lies on gets the load. Elsewhere the wheel goes through it.

use tumble::glam::DVec3;
use tumble::hecs::{Entity, World};
use tumble::{Queries, QueryFilter, Ray};

use crate::precision::{real, vec3};
use crate::probe::{Ground, Hub};
use crate::rigid::{Chassis, Rigid};
use crate::state::WheelState;
use crate::vehicle::Vehicle;

/// Light bodies that a wheel goes through at the most; below them it finds what is not dynamic.
const MAX_THROUGH: usize = 4;

/// Bodies on each other through which a load goes to what carries it.
const MAX_STACKED: usize = 3;

/// Gap between a light body and what carries it, over the radius of the wheel.
const GAP: f64 = 0.05;

/// How high a light body carries the wheel, over what it lies on and over where the wheel was, over
/// its radius. Wheels do not roll over what is higher.
const CLIMB: f64 = 0.35;

/// The load goes on where both surfaces lean against each other by less: the cosine of 50 degrees.
/// A body of common friction is drawn in there, and is pushed off beyond.
const FLAT: f64 = 0.64;

/// What finds the ground under the wheels of a chassis.
pub(crate) struct Finder<'a> {
    pub(crate) world: &'a World,
    pub(crate) queries: &'a Queries<'a>,
    pub(crate) vehicle: &'a Vehicle,
    pub(crate) chassis: &'a Chassis,
    pub(crate) filter: QueryFilter<'a>,
    pub(crate) gravity: f64,
    pub(crate) dt: f64,
}

/// A light body that a wheel goes through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Passed {
    pub(crate) entity: Entity,
    pub(crate) point: DVec3,
    pub(crate) normal: DVec3,
}

impl Finder<'_> {
    /// What a wheel stands on, and what it goes through on the way there.
    pub(crate) fn find(&self, wheel: usize, hub: &Hub, before: Option<&WheelState>) -> (Option<Ground>, Vec<Passed>) {
        // A wheel that comes down within the step is stopped in it.
        let falls = -self.chassis.body.at_point(hub.position).dot(hub.up);
        let ahead = (falls * self.dt).max(0.0);
        let highest = before.map_or(f64::INFINITY, |it| it.reach.max(0.0) + ahead + CLIMB * hub.radius);
        let (mut through, mut passed) = (Vec::new(), Vec::new());
        while through.len() < MAX_THROUGH {
            let filter = self.filter.without_all(&through);
            let found = hub.find_ground((self.vehicle, wheel), &self.chassis.axes, ahead, self.queries, &filter);
            let Some(ground) = found else { return (None, passed) };
            if !self.is_light(ground.entity, ground.point, ground.normal, hub.radius) {
                return (Some(ground), passed);
            }
            let bearer = self.bearer(&ground, hub.radius, &through).filter(|_| ground.compression <= highest);
            if let Some(bearer) = bearer {
                return (Some(Ground { bearer, ..ground }), passed);
            }
            if ground.compression > 0.0 {
                passed.push(Passed { entity: ground.entity, point: ground.point, normal: ground.normal });
            }
            through.push(ground.entity);
        }
        let filter = self.filter.without_dynamic();
        (hub.find_ground((self.vehicle, wheel), &self.chassis.axes, ahead, self.queries, &filter), passed)
    }

    /// Whether what the wheel carries at rest would bring the body within a step to the speed of a
    /// fall by the radius of the wheel.
    fn is_light(&self, entity: Entity, point: DVec3, normal: DVec3, radius: f64) -> bool {
        let Some(body) = Rigid::of(self.world, entity).filter(Rigid::is_dynamic) else { return false };
        let carried = self.chassis.mass * self.gravity / self.vehicle.settings().wheels.len().max(1) as f64;
        carried * self.dt * body.give(point, normal) > (2.0 * self.gravity * radius).sqrt()
    }

    /// What carries the load on a light body: what is right below it, through other light ones.
    fn bearer(&self, ground: &Ground, radius: f64, through: &[Entity]) -> Option<Entity> {
        let (mut body, mut point, mut normal) = (ground.entity, ground.point, ground.normal);
        let mut above = through.to_vec();
        for _ in 0..MAX_STACKED {
            above.push(body);
            let reach = 2.0 * radius;
            let down = Ray::new(vec3(point), vec3(-normal)).with_max_distance(real(reach));
            let below = self.queries.cast_ray(&down, &self.filter.without_all(&above))?;
            let only = |entity: Entity| entity == body;
            let up = Ray::new(vec3(point - normal * reach), vec3(normal)).with_max_distance(real(reach));
            let underside = self.queries.cast_ray(&up, &QueryFilter::new().matching(&only))?;
            let gap = f64::from(below.distance) - (reach - f64::from(underside.distance));
            let of_below = tumble::math::dvec3(below.normal);
            let (even, distance) = (of_below.dot(normal), f64::from(below.distance));
            if gap > GAP * radius || even < FLAT || distance * even > CLIMB * radius {
                return None;
            }
            (body, point, normal) = (below.entity, tumble::math::dvec3(below.point), of_below);
            if !self.is_light(body, point, normal, radius) {
                return Some(body);
            }
        }
        None
    }

    /// The impulse on a light body that a wheel goes through: as much as has it go along with the
    /// wheel, as in a collision without a bounce. It can only take energy.
    pub(crate) fn impulse_on(&self, passed: &Passed, hub: &Hub, wheels: f64) -> Option<DVec3> {
        let body = Rigid::of(self.world, passed.entity)?;
        let of_chassis = self.chassis.body.at_point(passed.point);
        // Along the suspension the wheel goes with the ground.
        let of_wheel = of_chassis - hub.up * of_chassis.dot(hub.up);
        let closing = (body.at_point(passed.point) - of_wheel).dot(passed.normal);
        let give = body.give(passed.point, passed.normal) + self.chassis.body.give(passed.point, passed.normal);
        (closing > 0.0).then(|| passed.normal * (-closing / (give * wheels)))
    }
}
