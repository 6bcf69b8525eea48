//! What a joint has beside its frames: limits, drives and friction, as the step takes them over.

use std::cmp::Ordering;

use hecs::Archetype;

use crate::joints::axes::Axes;
use crate::joints::drives::{Drive, Drives};
use crate::joints::friction::JointFriction;
use crate::joints::gain::Gain;
use crate::joints::limits::Limits;
use crate::math::Real;

/// Limits, drives and friction of a joint, without what does nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointOptions {
    pub(crate) limits: Limits,
    pub(crate) friction: JointFriction,
    pub(crate) drives: Vec<Drive>,
}

impl JointOptions {
    /// Whether joints of an archetype have any.
    pub(crate) fn are_in(archetype: &Archetype) -> bool {
        archetype.has::<Limits>() || archetype.has::<JointFriction>() || archetype.has::<Drives>()
    }

    /// Takes over those of a row of an archetype of joints, of which these axes are free.
    pub(crate) fn take_row(&mut self, archetype: &Archetype, row: usize, free: Axes) {
        let limits = archetype.get::<&Limits>();
        let friction = archetype.get::<&JointFriction>();
        self.limits = limits.map_or_else(Limits::default, |limits| limits[row].within(free));
        let friction = friction.map(|friction| friction[row]).filter(JointFriction::is_in_range);
        self.friction = friction.unwrap_or_default().along_only(free);
        self.drives.clear();
        if let Some(drives) = archetype.get::<&Drives>() {
            self.drives.extend(drives[row].0.iter().filter(|drive| drive.is_in_range()));
        }
    }

    /// Equal only for options that do the same.
    pub(crate) fn cmp(a: Option<&Self>, b: Option<&Self>) -> Ordering {
        match (a, b) {
            (Some(a), Some(b)) => a.numbers().cmp(b.numbers()),
            _ => a.is_some().cmp(&b.is_some()),
        }
    }

    pub(crate) fn numbers(&self) -> impl Iterator<Item = u64> + '_ {
        let Limits { axes, distance, cone } = &self.limits;
        let of_limits = axes.iter().chain([distance]).flat_map(|limit| {
            let [a, b] = limit.map_or([Real::NAN; 2], |limit| [limit.min, limit.max]);
            let [kind, c, d] = limit.map_or([-1.0; 3], |limit| numbers_of(limit.gain));
            [a, b, kind, c, d]
        });
        let [a, b] = cone.map_or([0.0; 2], |cone| cone.half_angles);
        let [kind, c, d] = cone.map_or([-1.0; 3], |cone| numbers_of(cone.gain));
        let of_drives = self.drives.iter().flat_map(|drive| {
            let [kind, stiffness, damping] = numbers_of(drive.gain);
            let position = drive.position.unwrap_or(Real::NAN);
            let [amplitude, hertz, phase] =
                drive.oscillation.map_or([Real::NAN; 3], |it| [it.amplitude, it.hertz, it.phase]);
            let target = [Real::from(drive.axes.bits()), position, drive.velocity, amplitude, hertz, phase];
            target.into_iter().chain([kind, stiffness, damping, drive.max_force])
        });
        let all = of_limits.chain([a, b, kind, c, d]).chain(self.friction.max).chain(of_drives);
        all.map(|number| u64::from(number.to_bits()))
    }
}

fn numbers_of(gain: Gain) -> [Real; 3] {
    match gain {
        Gain::Rigid => [0.0; 3],
        Gain::Stiffness { stiffness, damping } => [1.0, stiffness, damping],
        Gain::Frequency { hertz, damping_ratio } => [2.0, hertz, damping_ratio],
        Gain::Acceleration { stiffness, damping } => [3.0, stiffness, damping],
    }
}
