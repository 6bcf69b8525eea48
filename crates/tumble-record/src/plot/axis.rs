//! What is common to the two axes of a plot.

/// How the values of an axis are laid out.
///
/// ```
/// use tumble_record::{Plot, Scale, SeriesStyle};
/// let plot = Plot::new("Errors").y_axis("error", Scale::Log).series(
///     "runs",
///     SeriesStyle::Dots,
///     [(1.0, 1e-3), (2.0, 1e-6)],
/// );
/// # assert!(plot.to_svg().contains("error"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// In proportion.
    Linear,
    /// By their logarithm; values that are not positive are left out.
    Log,
}

/// An axis: its range, in its scale, and where on the picture it begins and ends.
pub(crate) struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
    begin: f64,
    end: f64,
}

impl Axis {
    pub(crate) fn new(scale: Scale, values: impl Iterator<Item = f64>, begin: f64, end: f64) -> Self {
        let scaled = values.map(|value| in_scale(scale, value)).filter(|value| value.is_finite());
        let (low, high) = scaled.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
        let size = low.abs().max(high.abs());
        // Halves, so that the widest range there is does not overflow; a range below rounding is
        // drawn as a constant.
        let half = 0.5 * high - 0.5 * low;
        let pad = match (half > 1e-12 * size && half > 1e-290, size > 1e-290) {
            (true, _) => 0.08 * half,
            (false, true) => 0.1 * size,
            (false, false) => 1.0,
        };
        // Two decades at least, so that two powers of ten are on a logarithmic axis.
        let pad = if scale == Scale::Log && half < 1.0 { 1.0 - half } else { pad };
        Self { scale, low: (low - pad).max(f64::MIN), high: (high + pad).min(f64::MAX), begin, end }
    }

    /// The values at its two ends, in its scale.
    pub(crate) fn range(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Where on the picture a value is; not finite where it has no place.
    pub(crate) fn place(&self, value: f64) -> f64 {
        self.place_scaled(in_scale(self.scale, value))
    }

    fn place_scaled(&self, value: f64) -> f64 {
        let part = (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low);
        self.begin + (self.end - self.begin) * part
    }

    /// Round values from end to end: where they are, and their labels.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let half = 0.5 * self.high - 0.5 * self.low;
        let rough = half / 3.0;
        let power = 10.0_f64.powf(rough.log10().floor());
        let round = [1.0, 2.0, 5.0].map(|m| m * power).into_iter().rfind(|step| *step <= rough);
        let step = if self.scale == Scale::Log { (half / 4.0).ceil() } else { round.unwrap_or(rough) };
        let size = self.low.abs().max(self.high.abs());
        let label = |value| match self.scale {
            Scale::Linear => number(value, step, size),
            Scale::Log => format!("10{}", superscript(value)),
        };
        multiples(self.low, self.high, step).into_iter().map(|value| (self.place_scaled(value), label(value))).collect()
    }
}

/// The multiples of a step from low to high.
fn multiples(low: f64, high: f64, step: f64) -> Vec<f64> {
    let first = (low / step).ceil();
    (0..32).map(|i| (first + f64::from(i)) * step).take_while(|value| *value <= high).collect()
}

fn in_scale(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Log if value > 0.0 => value.log10(),
        Scale::Log => f64::NAN,
    }
}

/// A tick's label: as many digits as tell it from its neighbours; all of one axis have the same
/// power of ten.
fn number(value: f64, step: f64, size: f64) -> String {
    let plain = (1e-3..1e5).contains(&size);
    let power = if plain { 0.0 } else { size.log10().floor() };
    let decimals = (power - step.log10().floor()).max(0.0) as usize;
    let digits = format!("{:.decimals$}", value / 10.0_f64.powf(power)).replace('-', "\u{2212}");
    match (value == 0.0, plain) {
        (true, _) => "0".to_owned(),
        (false, true) => digits,
        (false, false) => format!("{digits}\u{b7}10{}", superscript(power)),
    }
}

fn superscript(power: f64) -> String {
    let raised = |c| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => char::from_u32(0x2070 + (digit as u32 - '0' as u32)).unwrap_or(digit),
    };
    format!("{power:.0}").replace("-0", "0").chars().map(raised).collect()
}
