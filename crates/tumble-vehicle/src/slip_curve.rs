//! The slip curve of a tyre, and how far it can shear.

use crate::settings::Tyre;

/// Numbers of a tyre as the step takes them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rubber {
    /// Greatest force over load, along and across.
    pub(crate) friction: [f64; 2],
    /// Force over load per slip, along and across.
    pub(crate) stiffness: [f64; 2],
    pub(crate) length: f64,
    pub(crate) rolling: f64,
    shape: f64,
    /// Where the curve has its peak.
    peak: f64,
}

impl Rubber {
    pub(crate) fn of(tyre: &Tyre) -> Self {
        let shape = f64::from(tyre.shape);
        // At a shape of 1 the curve rises for ever: 0.99 of it is the peak.
        let peak = if shape > 1.0 { shape * libm::tan(std::f64::consts::FRAC_PI_2 / shape) } else { f64::INFINITY };
        Self {
            friction: [tyre.longitudinal_friction.into(), tyre.lateral_friction.into()],
            stiffness: [tyre.longitudinal_stiffness.into(), tyre.lateral_stiffness.into()],
            length: tyre.relaxation_length.into(),
            rolling: tyre.rolling_resistance.into(),
            shape,
            peak: peak.min(7.0),
        }
    }

    /// The force over its greatest value at a slip over that at which the straight line of little
    /// slip would reach it: `sin(C atan(e / C))`, of slope one at zero.
    pub(crate) fn curve(&self, slip: f64) -> f64 {
        libm::sin(self.shape * libm::atan(slip / self.shape))
    }

    /// The force while it slides at such a slip, over the greatest.
    pub(crate) fn sliding(&self, slip: f64) -> f64 {
        if slip > self.peak { self.curve(slip) } else { 1.0 }
    }

    /// The force of a shear, over the greatest: the rising part of the curve.
    pub(crate) fn sticking(&self, shear: f64) -> f64 {
        if shear > self.peak { 1.0 } else { self.curve(shear) }
    }

    /// A shear or slip as a part of that at which the straight line reaches the greatest force.
    pub(crate) fn part(&self, slip: [f64; 2]) -> f64 {
        let [along, across] = [0, 1].map(|i| self.stiffness[i] * slip[i] / self.friction[i]);
        (along * along + across * across).sqrt()
    }

    /// No more shear than the greatest force makes: what slides on does not wind it up.
    pub(crate) fn limited(&self, shear: [f64; 2]) -> [f64; 2] {
        let part = self.part(shear.map(|it| it / self.length));
        let scale = if part > self.peak { self.peak / part } else { 1.0 };
        shear.map(|it| it * scale)
    }
}
