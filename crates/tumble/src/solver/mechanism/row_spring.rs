//! Springs and dampers along a free axis of a joint.

use crate::joints::gain::Gain;
use crate::solver::mechanism::free_axis::wrapped;

/// Which way a spring pushes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Both,
    /// Up from a lower bound.
    Lower,
    /// Down from an upper bound.
    Upper,
}

/// A spring and a damper: a drive that gives way, or a soft bound. Its impulse is linear in the
/// speed that the row gets, within a range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowSpring {
    gain: Gain,
    side: Side,
    /// Where it is at rest, if anywhere; and the speed that its damper wants.
    position: Option<f64>,
    /// The middle of the range of a soft bound: angles count from there.
    middle: Option<f64>,
    velocity: f64,
    max_force: f64,
    stiffness: f64,
    damping: f64,
    /// The mass that it moves \[kg\] [kg m^2].
    mass: f64,
    error: f64,
    /// The share of its impulse that is given before bodies move on, times the substep \[s\].
    time: f64,
    /// The same after they moved, over that.
    after: f64,
    gamma: f64,
    bias: f64,
    range: [f64; 2],
    state: SpringState,
    /// What it gives in this half of the substep.
    impulse: f64,
}

/// Where a spring is on its law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SpringState {
    Linear,
    /// At its least or greatest impulse.
    Low,
    High,
}

impl RowSpring {
    pub(crate) fn new(gain: Gain, side: Side, (position, velocity): (Option<f64>, f64), max_force: f64) -> Self {
        Self {
            gain,
            side,
            position,
            middle: None,
            velocity,
            max_force,
            stiffness: 0.0,
            damping: 0.0,
            mass: f64::INFINITY,
            error: 0.0,
            time: 0.0,
            after: 0.0,
            gamma: f64::INFINITY,
            bias: 0.0,
            range: [0.0; 2],
            state: SpringState::Low,
            impulse: 0.0,
        }
    }

    /// Takes the mass that it moves.
    pub(crate) fn set_mass(&mut self, mass: f64) {
        self.mass = mass;
        let [stiffness, damping] = match self.gain {
            Gain::Rigid => [0.0; 2],
            Gain::Stiffness { stiffness, damping } => [stiffness, damping].map(f64::from),
            Gain::Acceleration { stiffness, damping } => [stiffness, damping].map(|rate| f64::from(rate) * mass),
            Gain::Frequency { hertz, damping_ratio } => {
                let rate = f64::from(hertz) * std::f64::consts::TAU;
                [rate * rate * mass, 2.0 * f64::from(damping_ratio) * rate * mass]
            }
        };
        self.stiffness = if self.position.is_some() { stiffness } else { 0.0 };
        self.damping = damping;
    }

    /// The same for a bound of a range with this middle.
    pub(crate) fn of_range(self, middle: f64) -> Self {
        Self { middle: Some(middle).filter(|middle| middle.is_finite()), ..self }
    }

    /// How far a row is from where the spring is at rest.
    pub(crate) fn error(&self, value: f64, is_angle: bool) -> f64 {
        let Some(position) = self.position else { return 0.0 };
        match self.middle.filter(|_| is_angle) {
            Some(middle) => wrapped(value - middle) + (middle - position),
            None if is_angle && self.side == Side::Both => wrapped(value - position),
            None => value - position,
        }
    }

    /// The energy in it where its row stands at a value \[J\]: of a stiffness, which does not
    /// change with the mass that it moves.
    pub(crate) fn potential(&self, value: f64, is_angle: bool) -> f64 {
        let (Gain::Stiffness { stiffness, .. }, Some(_)) = (self.gain, self.position) else { return 0.0 };
        let error = self.error(value, is_angle);
        let stretch = match self.side {
            Side::Both => error.abs(),
            Side::Lower => (-error).max(0.0),
            Side::Upper => error.max(0.0),
        };
        let force = f64::from(stiffness) * stretch;
        if force > self.max_force {
            // Further on it pulls with the greatest force.
            self.max_force * (stretch - 0.5 * self.max_force / f64::from(stiffness))
        } else {
            0.5 * force * stretch
        }
    }

    /// Prepares for a substep of `h` \[s\], of which forces have at least the share `before` before
    /// bodies move on; in the first of a step with the speed that the row has.
    ///
    /// With half before and half after, by the error in the middle, it is the midpoint rule and
    /// keeps energy. What swings or slows down by more than that in a substep has more before.
    pub(crate) fn prepare(&mut self, (h, before): (f64, f64), error: f64, first_speed: Option<f64>) {
        let (k, c) = (self.stiffness, self.damping);
        self.error = error;
        let turns = h * (k / self.mass).sqrt();
        let slows = h * c / self.mass;
        let share = [turns, slows].iter().fold(before, |share, rate| share.max(1.0 - 1.0 / rate.max(1.0)));
        self.time = share * h;
        self.after = (1.0 - share) / share;
        let stiff = if error.is_nan() { 0.0 } else { c + k * self.time };
        self.gamma = 1.0 / (self.time * stiff);
        self.bias = self.gamma * self.time * (k * error - c * self.velocity);
        let most = self.time * self.max_force;
        self.range = match self.side {
            Side::Both => [-most, most],
            Side::Lower => [0.0, most],
            Side::Upper => [-most, 0.0],
        };
        if let Some(speed) = first_speed {
            self.state = SpringState::Linear;
            self.settle(speed);
        }
    }

    /// What it gives at a speed, and where on its law that is.
    fn at(&self, speed: f64) -> (f64, SpringState) {
        let [low, high] = self.range;
        let next = self.error + self.time * speed;
        let is_off = self.gamma.is_infinite()
            || (self.side == Side::Lower && next >= 0.0)
            || (self.side == Side::Upper && next <= 0.0);
        let linear = -(speed + self.bias) / self.gamma;
        if is_off {
            if self.side == Side::Upper { (0.0, SpringState::High) } else { (0.0, SpringState::Low) }
        } else if linear <= low {
            (low, SpringState::Low)
        } else if linear >= high {
            (high, SpringState::High)
        } else {
            (linear, SpringState::Linear)
        }
    }

    pub(crate) fn impulse_at(&self, speed: f64) -> f64 {
        self.at(speed).0
    }

    /// Takes the speed that a solution gives; returns whether it was another part of its law.
    pub(crate) fn settle(&mut self, speed: f64) -> bool {
        let (impulse, state) = self.at(speed);
        self.impulse = impulse;
        std::mem::replace(&mut self.state, state) != state
    }

    /// Its compliance and the bias of the speed where it is linear.
    pub(crate) fn line(&self) -> Option<[f64; 2]> {
        (self.state == SpringState::Linear && self.gamma.is_finite()).then_some([self.gamma, self.bias])
    }

    /// What it gives where it is not.
    pub(crate) fn constant(&self) -> f64 {
        self.impulse
    }

    /// Leaves what it gives after bodies have moved on.
    pub(crate) fn turn_to_velocities(&mut self) {
        self.impulse *= self.after;
    }
}
