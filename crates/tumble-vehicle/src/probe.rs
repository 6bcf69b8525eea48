//! Where a wheel meets the ground.

use tumble::glam::{DMat3, DQuat, DVec3};
use tumble::hecs::Entity;
use tumble::math::dvec3;
use tumble::{Pose, Queries, QueryFilter, Ray};

use crate::precision::{quat, real, vec3};
use crate::rigid::Chassis;
use crate::settings::Probe;
use crate::vehicle::{Vehicle, about_y};

/// The steepest ground against the suspension that carries a wheel: the cosine of 70 degrees.
const STEEPEST: f64 = 0.342;

/// Ground under a wheel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    pub(crate) entity: Entity,
    /// Who gets the load: it, or what it lies on.
    pub(crate) bearer: Entity,
    pub(crate) point: DVec3,
    pub(crate) normal: DVec3,
    /// Of the suspension \[m\]; negative by the gap to ground that the wheel may meet in the step.
    pub(crate) compression: f64,
}

/// A wheel before it is known where the ground is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hub {
    /// The centre of the wheel where it hangs free \[m\].
    pub(crate) position: DVec3,
    pub(crate) up: DVec3,
    /// Along the axle to the left.
    pub(crate) axle: DVec3,
    pub(crate) radius: f64,
    pub(crate) travel: f64,
    /// Angle of steering \[rad\].
    pub(crate) angle: f64,
}

impl Hub {
    pub(crate) fn of(vehicle: &Vehicle, wheel: usize, chassis: &Chassis, steering: f64) -> Self {
        let settings = &vehicle.settings().wheels[wheel];
        let angle = vehicle.angle_of_wheel(wheel, steering);
        let from_center = dvec3(settings.position) - chassis.center_of_mass;
        let axle = DVec3::new(libm::cos(angle), 0.0, -libm::sin(angle));
        Self {
            position: chassis.body.position + chassis.axes * from_center,
            up: chassis.axes.y_axis,
            axle: chassis.axes * axle,
            radius: settings.radius.into(),
            travel: settings.suspension.travel.into(),
            angle,
        }
    }

    /// What the wheel stands on, or may come to stand on within `ahead` \[m\].
    pub(crate) fn find_ground(
        &self,
        (vehicle, wheel): (&Vehicle, usize),
        axes: &DMat3,
        ahead: f64,
        queries: &Queries<'_>,
        filter: &QueryFilter<'_>,
    ) -> Option<Ground> {
        let found = vehicle.probe(wheel).and_then(|shape| {
            // The axis of a cylinder is y; that of a wheel is x.
            let upright = DQuat::from_xyzw(0.0, 0.0, -std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2);
            let orientation = DQuat::from_mat3(axes) * about_y(self.angle) * upright;
            let from = self.position + self.up * (self.travel + 0.5 * self.radius);
            let pose = Pose { position: vec3(from), orientation: quat(orientation.normalize()) };
            let way = self.travel + 0.5 * self.radius + ahead;
            let hit = queries.cast_shape(shape, &pose, vec3(self.up * -way), filter)?;
            let normal = dvec3(hit.normal).normalize_or_zero();
            let in_plane = (normal - self.axle * normal.dot(self.axle)).normalize_or_zero();
            let distance = f64::from(hit.distance) + self.sunk(vehicle.settings().probe, normal);
            let center = from - self.up * distance;
            let compression = self.travel + 0.5 * self.radius - distance;
            self.ground(hit.entity, center - in_plane * self.radius, normal, compression)
        });
        // Beside a wall the shape meets the wall first.
        found.or_else(|| {
            let above = self.travel + self.radius;
            let from = self.position + self.up * above;
            let ray = Ray::new(vec3(from), vec3(-self.up)).with_max_distance(real(above + self.radius + ahead));
            let hit = queries.cast_ray(&ray, filter)?;
            let distance = f64::from(hit.distance);
            let compression = above + self.radius - distance;
            self.ground(hit.entity, from - self.up * distance, dvec3(hit.normal).normalize_or_zero(), compression)
        })
    }

    /// How much further than a sphere the wheel in it goes: it ends in its plane, not beside it.
    fn sunk(&self, probe: Probe, normal: DVec3) -> f64 {
        if probe != Probe::Sphere {
            return 0.0;
        }
        let beside = normal.dot(self.axle);
        let in_plane = (1.0 - beside * beside).max(0.0).sqrt();
        self.radius * (1.0 - in_plane) / normal.dot(self.up).max(STEEPEST)
    }

    fn ground(&self, entity: Entity, point: DVec3, normal: DVec3, compression: f64) -> Option<Ground> {
        let carries = normal.dot(self.up) >= STEEPEST;
        carries.then_some(Ground { entity, bearer: entity, point, normal, compression })
    }
}
