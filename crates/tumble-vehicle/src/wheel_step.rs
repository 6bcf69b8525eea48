//! One wheel in a step: the laws of spring, tyre and axle as straight lines of the velocities that
//! the step ends with. See `docs/vehicles.md` for the equations.

use tumble::glam::DVec3;

use crate::drive_torque::TorqueLine;
use crate::rigid::Rigid;
use crate::settings::{Motor, Wheel};
use crate::slip_curve::Rubber;

/// A direction in which the ground acts on the chassis: its row of the Jacobian.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// Of force and torque about the centre of mass.
    pub(crate) linear: DVec3,
    pub(crate) angular: DVec3,
    /// Velocity of the ground along it [m/s].
    pub(crate) ground: f64,
    /// How much the ground gives way, velocity per impulse [1/kg].
    pub(crate) give: f64,
    /// Force on the ground in the last step \[N\].
    pub(crate) before: f64,
}

impl Row {
    pub(crate) fn new(direction: DVec3, point: DVec3, center: DVec3) -> Self {
        let angular = (point - center).cross(direction);
        Self { linear: direction, angular, ground: 0.0, give: 0.0, before: 0.0 }
    }

    /// Velocity of the chassis over the ground along it [m/s].
    pub(crate) fn speed(&self, velocity: &Motion) -> f64 {
        self.linear.dot(velocity.linear) + self.angular.dot(velocity.angular) - self.ground
    }
}

/// Linear and angular velocity of the chassis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) linear: DVec3,
    pub(crate) angular: DVec3,
}

impl Motion {
    pub(crate) fn of(body: &Rigid) -> Self {
        Self { linear: body.linear, angular: body.angular }
    }
}

/// Force as a straight line of the speed along a row: `offset - slope speed`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ForceLine {
    pub(crate) offset: f64,
    pub(crate) slope: f64,
}

/// Where a wheel stands, in three directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footing {
    /// Along the suspension, over the normal's part of it.
    pub(crate) normal: Row,
    /// Along and across the wheel.
    pub(crate) tangents: [Row; 2],
    /// The normal and both tangents along the suspension.
    pub(crate) lean: [f64; 3],
    /// Of the spring at the start of the step \[m\].
    pub(crate) compression: f64,
    /// How much further the suspension is compressed than its spring \[m\].
    pub(crate) slack: f64,
}

/// What a step finds out about a wheel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WheelStep {
    pub(crate) settings: Wheel,
    pub(crate) rubber: Rubber,
    pub(crate) footing: Option<Footing>,
    /// At the start of the step.
    pub(crate) spin: f64,
    pub(crate) shear: [f64; 2],
    /// Of hub or rim, the larger [m/s].
    pub(crate) speed: f64,
    /// The friction of its slip over the greatest.
    pub(crate) sliding: f64,
    /// Share of the motor, throttle, and torque of the brakes [N m].
    pub(crate) share: f64,
    pub(crate) throttle: f64,
    pub(crate) brake: f64,
    /// Forces at the end of the step, as far as it is solved \[N\].
    pub(crate) suspension: f64,
    pub(crate) forces: [f64; 2],
    pub(crate) end_spin: f64,
    pub(crate) lines: [ForceLine; 2],
}

impl WheelStep {
    /// Force along the normal \[N\].
    pub(crate) fn load(&self) -> f64 {
        self.footing.as_ref().map_or(0.0, |footing| {
            let [normal, along, across] = footing.lean;
            ((self.suspension - self.forces[0] * along - self.forces[1] * across) / normal).max(0.0)
        })
    }

    /// Torque of brakes, tyre and motor that only ever stops the wheel [N m].
    fn drag(&self, motor: &Motor, load: f64) -> f64 {
        let coasting = if self.throttle == 0.0 { self.share * f64::from(motor.drag) } else { 0.0 };
        self.brake + coasting + self.rubber.rolling * load * f64::from(self.settings.radius)
    }

    /// Spring and damper at a speed of compression [m/s]: the force, and its slope in that speed.
    /// `others` is what the bar does to a wheel in the air \[N/m\].
    pub(crate) fn spring(&self, speed: f64, bar: f64, h: f64) -> (f64, f64) {
        let Some(footing) = &self.footing else { return (0.0, 0.0) };
        let it = &self.settings.suspension;
        let start = footing.compression;
        let end = start + h * speed;
        if end <= 0.0 {
            return (0.0, 0.0);
        }
        // A wheel that lands within the step is damped from there on.
        let part = if start < 0.0 { end / (end - start) } else { 1.0 };
        let stiffness = f64::from(it.stiffness) + bar;
        let mut damping = f64::from(if speed > 0.0 { it.compression_damping } else { it.rebound_damping });
        let beyond = end - (f64::from(it.travel) - footing.slack).max(0.0);
        let bump = f64::from(it.bump_stiffness);
        let (mut force, mut slope) = (stiffness * end, stiffness * h);
        if beyond > 0.0 {
            force += bump * beyond;
            slope += bump * h;
            if speed > 0.0 {
                damping *= 1.0 + (bump / f64::from(it.stiffness)).sqrt();
            }
        }
        force += damping * part * speed;
        slope += damping * part;
        if force > 0.0 { (force, slope) } else { (0.0, 0.0) }
    }

    /// The shear at the end of the step, and that with its damping, per speed over the ground.
    fn shear_lines(&self, direction: usize, rolled: f64, h: f64, damping: f64) -> [(f64, f64); 2] {
        let before = self.shear[direction];
        let keep = 1.0 / (1.0 + rolled);
        let end = (before * keep, h * keep);
        let rate = damping / h;
        [end, (end.0 * (1.0 + rate) - before * rate, end.1 * (1.0 + rate))]
    }

    /// Finds out how fast the wheel goes at the start of the step. Its end is not known as well: a
    /// force that is not in the wrench would have a wheel at rest roll on.
    pub(crate) fn begin(&mut self, motion: &Motion, gravity: f64) {
        let Some(footing) = &self.footing else { return };
        let [along, across] = footing.tangents.map(|row| row.speed(motion));
        let rim = self.spin * f64::from(self.settings.radius);
        self.speed = (along * along + across * across).sqrt().max(rim.abs());
        let slip = [along - rim, across].map(|it| it / (self.speed + self.still_speed(gravity)));
        self.sliding = self.rubber.sliding(self.rubber.part(slip));
    }

    /// How far the tread runs through the contact in a step, over the relaxation length, and the
    /// time of damping \[s\].
    fn tread(&self, h: f64, gravity: f64) -> (f64, f64) {
        let length = self.rubber.length;
        // Of all loads on all tyres: the frequency of the mass on its tyres at rest.
        let stiffness = self.rubber.stiffness[0].max(self.rubber.stiffness[1]);
        let still = 1.4 * (length / (stiffness * gravity.max(1e-3))).sqrt();
        (h * self.speed / length, still * length / (length + self.speed * still))
    }

    /// Shears the tyre by what the last step ended with other than was thought, through forces that
    /// were not known, as of contacts, and ground that was moved.
    pub(crate) fn catch_up(&mut self, thought: [f64; 2], motion: &Motion, h: f64, gravity: f64) {
        let Some(footing) = &self.footing else { return };
        let (rolled, _) = self.tread(h, gravity);
        let shear = [0, 1].map(|i| {
            let missed = footing.tangents[i].speed(motion) - thought[i];
            self.shear[i] - missed * h / (1.0 + rolled)
        });
        self.shear = self.rubber.limited(shear);
    }

    /// Below this a wheel stands: speeds scale with the root of gravity and radius [m/s].
    pub(crate) fn still_speed(&self, gravity: f64) -> f64 {
        0.01 * (gravity * f64::from(self.settings.radius)).sqrt() + 1e-9
    }

    /// Makes the lines of the tyre at a motion of the chassis.
    pub(crate) fn update_lines(&mut self, motion: &Motion, motor: &Motor, h: f64, gravity: f64) {
        let Some(footing) = self.footing else { return };
        let load = self.load();
        let radius = f64::from(self.settings.radius);
        let (rolled, damping) = self.tread(h, gravity);
        let speeds = footing.tangents.map(|row| row.speed(motion));
        let over_ground = [speeds[0] - self.end_spin * radius, speeds[1]];
        let lines = [0, 1].map(|i| self.shear_lines(i, rolled, h, damping)[1]);
        let strain = [0, 1].map(|i| (lines[i].0 - lines[i].1 * over_ground[i]) / self.rubber.length);
        let part = self.rubber.part(strain);
        let force = self.rubber.sticking(part).min(self.sliding);
        let secant = if part > 1e-9 { force / part } else { 1.0 };
        let made = [0, 1].map(|i| {
            let stiffness = load * self.rubber.stiffness[i] / self.rubber.length * secant;
            let (offset, slope) = (lines[i].0 * stiffness, lines[i].1 * stiffness);
            let given = h * slope * footing.tangents[i].give;
            let offset = offset + given * footing.tangents[i].before;
            ForceLine { offset: offset / (1.0 + given), slope: slope / (1.0 + given) }
        });
        self.lines = made;
        self.lines[0] = self.with_axle(self.lines[0], speeds[0], motor, load, h);
    }

    /// The line of the force along the wheel once the axle turns as that force, the motor and the
    /// brake let it.
    fn with_axle(&self, line: ForceLine, speed: f64, motor: &Motor, load: f64, h: f64) -> ForceLine {
        let (radius, inertia) = (f64::from(self.settings.radius), f64::from(self.settings.inertia));
        let torque = TorqueLine::at(motor, self.share, self.throttle, self.end_spin);
        let drag = self.drag(motor, load);
        let needed = inertia * self.spin / h + torque.at_rest - radius * (line.offset - line.slope * speed);
        if needed.abs() <= drag {
            return line;
        }
        let inertia_end = inertia + h * torque.slope;
        let free = (inertia * self.spin + h * (torque.at_rest - drag.copysign(needed))) / inertia_end;
        let coupled = 1.0 + line.slope * h * radius * radius / inertia_end;
        ForceLine { offset: (line.offset + line.slope * radius * free) / coupled, slope: line.slope / coupled }
    }

    /// Takes the forces of the lines at a motion, and the spin that they leave.
    pub(crate) fn take_forces(&mut self, motion: &Motion, motor: &Motor, h: f64) {
        if let Some(footing) = &self.footing {
            for i in 0..2 {
                self.forces[i] = self.lines[i].offset - self.lines[i].slope * footing.tangents[i].speed(motion);
            }
        }
        self.end_spin = self.spin_under(self.forces[0], motor, h);
    }

    /// No force beyond the friction ellipse of the load, which the forces change where the ground
    /// leans: `scale part = (suspension - scale pressed) / normal`.
    pub(crate) fn limit_forces(&mut self, motor: &Motor, h: f64) {
        if let Some(footing) = &self.footing {
            let [normal, along, across] = footing.lean;
            let parts = [0, 1].map(|i| self.forces[i] / self.rubber.friction[i]);
            let part = (parts[0] * parts[0] + parts[1] * parts[1]).sqrt();
            let needed = normal * part + self.forces[0] * along + self.forces[1] * across;
            if needed > self.suspension {
                self.forces = self.forces.map(|force| force * (self.suspension / needed));
            }
        }
        self.end_spin = self.spin_under(self.forces[0], motor, h);
    }

    /// The spin at the end of the step under a force along the wheel.
    fn spin_under(&self, force: f64, motor: &Motor, h: f64) -> f64 {
        let (radius, inertia) = (f64::from(self.settings.radius), f64::from(self.settings.inertia));
        let torque = TorqueLine::at(motor, self.share, self.throttle, self.end_spin);
        let drag = self.drag(motor, self.load());
        let needed = inertia * self.spin / h + torque.at_rest - radius * force;
        if needed.abs() <= drag {
            return 0.0;
        }
        h * (needed - drag.copysign(needed)) / (inertia + h * torque.slope)
    }

    /// The shear that the step leaves, as far as is known now: the next one corrects and limits it.
    pub(crate) fn end_shear(&self, motion: &Motion, h: f64, gravity: f64) -> [f64; 2] {
        let Some(footing) = &self.footing else { return [0.0; 2] };
        if self.load() <= 0.0 {
            return [0.0; 2];
        }
        let (rolled, damping) = self.tread(h, gravity);
        let radius = f64::from(self.settings.radius);
        let over_ground =
            [footing.tangents[0].speed(motion) - self.end_spin * radius, footing.tangents[1].speed(motion)];
        [0, 1].map(|i| {
            let (offset, slope) = self.shear_lines(i, rolled, h, damping)[0];
            offset - slope * over_ground[i]
        })
    }
}
