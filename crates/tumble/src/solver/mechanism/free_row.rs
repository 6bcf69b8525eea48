//! What acts along a free axis of a joint: limits, a motor, friction and springs, as one law of
//! impulse by speed.

use crate::joints::drives::Drive;
use crate::joints::gain::Gain;
use crate::joints::limits::Limit;
use crate::solver::mechanism::free_axis::{FreeAxis, wrapped};
use crate::solver::mechanism::joint_rows::correction_speed;
use crate::solver::mechanism::row_spring::{RowSpring, Side};

/// The half of a substep for which impulses are sought: those with which bodies move on, or those
/// that set the velocities when they have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Before all others, what others did to velocities is taken out: nothing acts but what is
    /// locked.
    Begin,
    Positions,
    Velocities,
}

/// A rigid drive.
#[derive(Clone, Copy, Debug)]
struct Motor {
    position: Option<f64>,
    velocity: f64,
    max_force: f64,
}

/// What decides the speed along a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mode {
    /// A bound is met.
    AtLower,
    AtUpper,
    /// The motor has its speed.
    Driven,
    /// Friction keeps it from moving, and the motor gives all it has in this direction.
    Stuck(f64),
    /// Springs, and what gives all it has: the motor in the direction of the first sign, friction
    /// in that of the second.
    Loose(f64, f64),
}

/// A row along a free axis.
#[derive(Clone, Debug)]
pub(crate) struct FreeRow {
    pub(crate) axis: FreeAxis,
    pub(super) bounds: [f64; 2],
    motor: Option<Motor>,
    friction: f64,
    springs: Vec<RowSpring>,
    /// What it moves \[kg\] [kg m^2].
    mass: f64,
    /// Where it stands.
    pub(crate) value: f64,
    pub(crate) mode: Mode,
    /// That of the half before, where neither motor nor friction acts in the other half.
    kept_mode: Option<Mode>,
    /// Whether it was past a bound where the substep began: what brings it back is no speed to
    /// keep.
    pub(crate) is_corrected: bool,
    /// What is added to the row's diagonal, and to its speed.
    pub(crate) gamma: f64,
    pub(crate) bias: f64,
    /// Where nothing there depends on the speed: the impulse.
    pub(crate) constant: Option<f64>,
    /// Of that, what has been given.
    pub(crate) pushed: f64,
    /// How fast the bodies have it move, when its right side was set.
    pub(crate) speed: f64,
    /// How fast it moves by an impulse of friction that holds it [1/kg] [1/(kg m^2)].
    slip: f64,
    /// The impulses to be had from motor and friction in this phase.
    motor_impulse: f64,
    friction_impulse: f64,
    /// The speed that the motor wants in this phase, and the same within the bounds.
    motor_speed: f64,
    speed_in_bounds: f64,
}

/// The share of the speed of a row that friction beside a bound leaves it: enough for the bound to
/// come first where both push in nearly the same direction.
const SLIP_BESIDE_BOUND: f64 = 0.1;

impl FreeRow {
    pub(crate) fn new(axis: FreeAxis) -> Self {
        Self {
            axis,
            bounds: [-f64::INFINITY, f64::INFINITY],
            motor: None,
            friction: 0.0,
            springs: Vec::new(),
            mass: f64::INFINITY,
            value: 0.0,
            mode: Mode::Loose(0.0, 0.0),
            kept_mode: None,
            is_corrected: false,
            gamma: 0.0,
            bias: 0.0,
            constant: Some(0.0),
            pushed: 0.0,
            speed: 0.0,
            slip: 0.0,
            motor_impulse: 0.0,
            friction_impulse: 0.0,
            motor_speed: 0.0,
            speed_in_bounds: 0.0,
        }
    }

    /// Takes away all that acts along it.
    pub(crate) fn reset(&mut self, axis: FreeAxis) {
        let springs = std::mem::take(&mut self.springs);
        *self = Self { springs, ..Self::new(axis) };
        self.springs.clear();
    }

    pub(crate) fn add_limit(&mut self, limit: Limit) {
        let bounds = if self.axis.is_linear() { Some(limit.bounds()) } else { limit.bounds_of_angle() };
        bounds.into_iter().for_each(|bounds| self.add_bounds(bounds, limit.gain));
    }

    /// Adds a range, infinite where there is no bound.
    pub(crate) fn add_bounds(&mut self, bounds: [f64; 2], gain: Gain) {
        if gain == Gain::Rigid {
            self.bounds = bounds;
            return;
        }
        for (bound, side) in bounds.into_iter().zip([Side::Lower, Side::Upper]).filter(|(bound, _)| bound.is_finite()) {
            let middle = 0.5 * (bounds[0] + bounds[1]);
            let spring = RowSpring::new(gain, side, (Some(bound), 0.0), f64::INFINITY);
            self.springs.push(spring.of_range(middle));
        }
    }

    pub(crate) fn add_friction(&mut self, max: f64) {
        self.friction = max;
    }

    /// Adds a drive, of which the position is this far from where values count from.
    pub(crate) fn add_drive(&mut self, drive: &Drive, position: Option<f64>, velocity: f64) {
        let max_force = f64::from(drive.max_force);
        if drive.gain != Gain::Rigid {
            self.springs.push(RowSpring::new(drive.gain, Side::Both, (position, velocity), max_force));
        } else if self.motor.is_none() {
            self.motor = Some(Motor { position, velocity, max_force });
        }
    }

    /// Whether the mass that its springs move is by all joints.
    pub(crate) fn moves_with_all(&self) -> bool {
        !self.springs.is_empty() && !self.axis.is_of_limit()
    }

    /// Whether nothing along it can give energy.
    pub(crate) fn is_passive(&self) -> bool {
        self.motor.is_none() && self.springs.is_empty()
    }

    /// Has it held where it is if it is driven, to find the mass that others move.
    pub(crate) fn hold(&mut self) {
        let is_driven = self.motor.is_some() || self.moves_with_all();
        (self.gamma, self.constant) = (0.0, (!is_driven).then_some(0.0));
    }

    /// The energy in its springs where it stands at a value \[J\]; of a cone there is none, as its
    /// springs have no potential.
    pub(crate) fn potential(&self, value: f64) -> f64 {
        let of_spring = |spring: &RowSpring| spring.potential(value, !self.axis.is_linear());
        if self.axis.is_cone() { 0.0 } else { self.springs.iter().map(of_spring).sum() }
    }

    /// Takes the mass \[kg\] [kg m^2] that it moves; springs do not move what nothing moves.
    pub(crate) fn set_mass(&mut self, mass: f64) {
        self.mass = mass;
        if mass.is_infinite() {
            self.springs.clear();
        }
        self.springs.iter_mut().for_each(|spring| spring.set_mass(mass));
    }

    /// What is added to the diagonal of a row, the first of these: infinite where nothing along it
    /// depends on the speed, or there is none.
    #[inline(always)]
    pub(crate) fn softness_of_first(rows: &[Self]) -> f64 {
        rows.first().map_or(f64::INFINITY, Self::softness)
    }

    /// What is added to its diagonal: infinite where nothing along it depends on the speed.
    #[inline(always)]
    pub(crate) fn softness(&self) -> f64 {
        if self.constant.is_some() { f64::INFINITY } else { self.gamma }
    }

    /// What its speed is to change by, of which this takes the error out.
    pub(crate) fn right_side(&self, correction: f64) -> f64 {
        if self.constant.is_some() { 0.0 } else { -(self.speed + correction) - self.bias }
    }

    /// What is left of its law by the speed that it has after an impulse.
    pub(crate) fn remaining(&self, impulse: f64) -> f64 {
        if self.constant.is_some() { 0.0 } else { -(self.speed + self.bias + self.gamma * impulse) }
    }

    /// What it moves as far as that is known \[kg\] [kg m^2].
    pub(crate) fn mass(&self) -> f64 {
        self.mass
    }

    /// Prepares for a phase of a substep of `h` \[s\], of which forces have the share `before`
    /// before bodies move on; in the first of a step with the speed that it has.
    pub(crate) fn prepare(&mut self, phase: Phase, (h, before): (f64, f64), first_speed: Option<f64>) {
        let share = match phase {
            Phase::Begin => 0.0,
            Phase::Positions => before,
            Phase::Velocities => 1.0 - before,
        };
        (self.motor_impulse, self.friction_impulse) = (0.0, impulse_of(self.friction, h * share));
        match phase {
            Phase::Begin => {}
            Phase::Positions => {
                let (value, is_angle) = (self.value, !self.axis.is_linear());
                for spring in &mut self.springs {
                    let error = spring.error(value, is_angle);
                    spring.prepare((h, before), error, first_speed);
                }
            }
            Phase::Velocities => self.springs.iter_mut().for_each(RowSpring::turn_to_velocities),
        }
        let within = [-self.past(self.value, false), -self.past(self.value, true)].map(|room| room.max(0.0) / h);
        if let Some(motor) = &self.motor {
            self.motor_impulse = impulse_of(motor.max_force, h * share);
            self.motor_speed = match (motor.position, phase) {
                (Some(_), Phase::Begin | Phase::Velocities) => 0.0,
                (Some(position), Phase::Positions) => {
                    let left = position - self.value;
                    let left = if self.axis.is_linear() { left } else { wrapped(left) };
                    let most = correction_speed(self.axis.is_linear());
                    (left / h).clamp(-most, most)
                }
                (None, _) => motor.velocity,
            };
            self.speed_in_bounds = self.motor_speed.clamp(-within[0], within[1]);
        }
        if phase == Phase::Positions {
            self.mode = self.kept_mode.take().unwrap_or(self.mode);
        }
        match (phase, first_speed) {
            (Phase::Begin, _) if self.is_held() => self.mode = Mode::AtLower,
            (Phase::Begin, _) => self.mode = Mode::Loose(0.0, 0.0),
            (Phase::Positions, Some(speed)) => self.mode = self.first_mode(speed, h),
            _ if self.value.is_nan() && self.is_at_bound() => self.mode = self.mode_without_bound(0.0),
            (Phase::Velocities, _) if share == 0.0 => {
                self.kept_mode = Some(self.mode);
                self.mode = if self.is_at_bound() { self.mode } else { self.mode_without_bound(0.0) };
            }
            _ => {}
        }
        self.pushed = 0.0;
        self.set_law(phase);
    }

    /// What is likely before any solution is known.
    fn first_mode(&self, speed: f64, h: f64) -> Mode {
        if self.is_held() || self.past(self.value, false) > h * speed {
            Mode::AtLower
        } else if self.past(self.value, true) > -h * speed {
            Mode::AtUpper
        } else if self.motor.is_none() && self.friction > 0.0 && self.mass * speed.abs() > self.friction_impulse {
            Mode::Loose(0.0, -speed.signum())
        } else {
            self.mode_without_bound(0.0)
        }
    }

    fn mode_without_bound(&self, speed: f64) -> Mode {
        if self.motor_impulse > 0.0 {
            Mode::Driven
        } else if self.friction_impulse > 0.0 {
            if speed == 0.0 { Mode::Stuck(0.0) } else { Mode::Loose(0.0, -speed.signum()) }
        } else {
            Mode::Loose(0.0, 0.0)
        }
    }

    /// Sets what the matrix and its right side need by the mode.
    pub(super) fn set_law(&mut self, phase: Phase) {
        (self.gamma, self.bias, self.constant) = (0.0, 0.0, None);
        match self.mode {
            Mode::AtLower | Mode::AtUpper => {}
            Mode::Stuck(_) => self.gamma = self.slip,
            Mode::Driven => self.bias = -self.speed_in_bounds,
            Mode::Loose(..) if phase == Phase::Begin => self.constant = Some(0.0),
            Mode::Loose(motor, friction) => {
                let mut constant = signed(motor, self.motor_impulse) + signed(friction, self.friction_impulse);
                let [mut slope, mut linear] = [0.0; 2];
                for spring in &self.springs {
                    match spring.line().filter(|_| phase == Phase::Positions) {
                        Some([gamma, bias]) => {
                            slope += 1.0 / gamma;
                            linear += bias / gamma;
                        }
                        None => constant += spring.constant(),
                    }
                }
                // Its inverse is finite.
                if slope > f64::MIN_POSITIVE {
                    self.gamma = 1.0 / slope;
                    self.bias = (linear - constant) * self.gamma;
                } else {
                    self.constant = Some(constant);
                }
            }
        }
    }

    /// Has friction hold it firmly, or as a damper beside a bound that shares its direction.
    /// Returns whether that changes what the matrix needs.
    pub(crate) fn set_slip(&mut self, is_beside_bound: bool, phase: Phase) -> bool {
        let slip = if is_beside_bound { SLIP_BESIDE_BOUND / self.mass } else { 0.0 };
        let is_changed = slip != self.slip && matches!(self.mode, Mode::Stuck(_));
        self.slip = slip;
        if is_changed {
            self.set_law(phase);
        }
        is_changed
    }

    /// Corrects the mode by a solution: the `speed` that the row gets, and its impulse. Returns
    /// whether the solution has to be found again.
    pub(crate) fn settle(&mut self, phase: Phase, h: f64, speed: f64, impulse: f64) -> bool {
        let is_position = phase == Phase::Positions;
        let of_spring = |spring: &RowSpring| if is_position { spring.impulse_at(speed) } else { spring.constant() };
        let rest = impulse - self.springs.iter().map(of_spring).sum::<f64>();
        let mode = match self.mode {
            Mode::AtLower | Mode::AtUpper if self.is_held() || (self.is_corrected && !is_position) => self.mode,
            Mode::AtLower if rest < self.others(speed)[0] => self.mode_without_bound(0.0),
            Mode::AtUpper if rest > self.others(speed)[1] => self.mode_without_bound(0.0),
            Mode::AtLower | Mode::AtUpper => self.mode,
            Mode::Driven => self.driven_mode(speed, rest),
            Mode::Stuck(motor) => {
                let of_friction = rest - signed(motor, self.motor_impulse);
                let slides = of_friction.abs() > self.friction_impulse;
                if slides { Mode::Loose(motor, of_friction.signum()) } else { self.mode }
            }
            Mode::Loose(motor, friction) => self.loose_mode(phase, h, speed, (motor, friction)),
        };
        let mut is_changed = mode != self.mode;
        self.mode = mode;
        if is_position {
            let matters = matches!(mode, Mode::Loose(..));
            for spring in &mut self.springs {
                is_changed |= spring.settle(speed) && matters;
            }
        }
        if is_changed {
            self.set_law(phase);
        }
        is_changed
    }

    /// What motor and friction can give at a speed, from least to most.
    fn others(&self, speed: f64) -> [f64; 2] {
        let of_friction = if speed == 0.0 { [-1.0, 1.0] } else { [-speed.signum(); 2] };
        let wish = if self.motor.is_some() { self.motor_speed - speed } else { 0.0 };
        let of_motor = if wish == 0.0 { [-1.0, 1.0] } else { [wish.signum(); 2] };
        [0, 1].map(|end| signed(of_friction[end], self.friction_impulse) + signed(of_motor[end], self.motor_impulse))
    }

    /// A motor that has its speed by an impulse for it and friction.
    fn driven_mode(&self, speed: f64, impulse: f64) -> Mode {
        if self.friction_impulse.is_infinite() {
            return Mode::Stuck(impulse.signum());
        }
        let of_motor = impulse - signed(-speed, self.friction_impulse);
        if of_motor.abs() <= self.motor_impulse {
            return Mode::Driven;
        }
        let sign = of_motor.signum();
        if speed != 0.0 {
            Mode::Loose(sign, -speed.signum())
        } else if self.friction > 0.0 {
            Mode::Stuck(sign)
        } else {
            Mode::Loose(sign, 0.0)
        }
    }

    fn loose_mode(&self, phase: Phase, h: f64, speed: f64, (motor, friction): (f64, f64)) -> Mode {
        if phase == Phase::Positions {
            if self.past(self.value, false) > h * speed {
                return Mode::AtLower;
            }
            if self.past(self.value, true) > -h * speed {
                return Mode::AtUpper;
            }
        }
        if motor != 0.0 && (speed - self.speed_in_bounds) * motor > 0.0 {
            return Mode::Driven;
        }
        if self.friction_impulse > 0.0 && speed * friction > 0.0 {
            return Mode::Stuck(motor);
        }
        Mode::Loose(motor, friction)
    }

    /// Notes what springs give at the speed that there is.
    pub(crate) fn note_springs(&mut self) {
        let speed = self.speed;
        self.springs.iter_mut().for_each(|spring| {
            spring.settle(speed);
        });
    }
}

/// What a greatest force gives in a time \[s\]; an infinite one has no end in none either.
fn impulse_of(max_force: f64, time: f64) -> f64 {
    if max_force.is_finite() { max_force * time } else { max_force }
}

/// A greatest impulse with a sign, none for zero.
fn signed(sign: f64, most: f64) -> f64 {
    if sign == 0.0 { 0.0 } else { sign.signum() * most }
}
