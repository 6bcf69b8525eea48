//! Figures in words: the books of the scene, and one body.

use tumble::glam::DVec3;
use tumble::{Inertia, Mass, Momentum, Pose, Totals, Velocity};
use tumble_record::{Kept, MomentumScale, energy_scale};

use crate::bodies::DrawnBody;
use crate::convert::dvec3;
use crate::playback::Playback;

/// A line of a panel: what it is, and its figure with the unit.
pub(crate) type Row = (String, String);

/// A number in a column: six characters at least, four digits that count.
pub(crate) fn figure(value: f64) -> String {
    let size = value.abs();
    // Signs have a column of their own.
    let sign = if value < 0.0 { '-' } else { ' ' };
    if size == 0.0 {
        " 0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        // What is rounded up to the next power of ten has its decimals.
        let decimals = (3.0 - (1.00005 * size).log10().floor()).clamp(0.0, 6.0) as usize;
        format!("{sign}{size:.decimals$}")
    } else {
        format!("{sign}{size:.3e}")
    }
}

/// Three numbers. What is rounding beside the others is zero.
fn triple(vector: DVec3) -> String {
    let nothing = 1e-7 * vector.abs().max_element();
    vector.to_array().map(|part| format!("{:<11}", figure(if part.abs() <= nothing { 0.0 } else { part }))).concat()
}

/// A time \[s\] in words, in units that people have a feeling for.
pub(crate) fn time(seconds: f64) -> String {
    let units = [(31_557_600.0, "years"), (86_400.0, "days"), (3600.0, "hours")];
    match units.into_iter().find(|(unit, _)| seconds.abs() >= 2.0 * unit) {
        Some((unit, name)) => format!("{} {name}", figure(seconds / unit).trim_start()),
        // Always as many letters, so that they stand still while time passes.
        None if (0.1..7200.0).contains(&seconds) || seconds == 0.0 => format!("{seconds:.3} s"),
        None => format!("{} s", figure(seconds).trim_start()),
    }
}

/// Energy and momentum now, and how far they are from the start, by the scales of a run's summary:
/// a drift of what nothing changes, which is an error, or a change.
/// A body whose state is not finite is in none of the sums; here is its name.
pub(crate) fn ledger(
    start: &Totals,
    (scale, kept): (MomentumScale, Kept),
    now: &Totals,
    lost: Option<&str>,
) -> Vec<Row> {
    let row = |name: &str, figure: String| (name.to_owned(), figure);
    let exchanged = (now.all_potential() - start.all_potential()).abs();
    let name = |is_kept: bool| if is_kept { "  drift" } else { "  change" };
    let mut rows = vec![
        row("kinetic", format!("{} J", figure(now.kinetic()))),
        row("potential", format!("{} J", figure(now.all_potential()))),
        row("energy", format!("{} J", figure(now.energy()))),
        row(name(kept.energy), drift(now.energy() - start.energy(), energy_scale(start, exchanged))),
        row("momentum", format!("{} kg m/s", figure(now.linear_momentum.length()))),
        row(name(kept.momentum), drift((now.linear_momentum - start.linear_momentum).length(), scale.linear)),
        row("ang. mom.", format!("{} kg m²/s", figure(now.angular_momentum.length()))),
        row(name(kept.momentum), drift((now.angular_momentum - start.angular_momentum).length(), scale.angular)),
    ];
    if let Some(name) = lost {
        rows.push((format!("not finite: {name}"), String::new()));
    }
    rows
}

/// A difference as a part of a scale.
fn drift(difference: f64, scale: f64) -> String {
    if difference == 0.0 {
        " 0".to_owned()
    } else if scale > 0.0 {
        format!("{:+.1e}", difference / scale)
    } else {
        " from 0".to_owned()
    }
}

/// All about a body.
pub(crate) fn body(playback: &Playback, body: &DrawnBody) -> Vec<Row> {
    let mut rows = vec![(body.name.clone(), String::new())];
    let Ok(entity) = playback.world.entity(body.entity) else { return rows };
    let mut row = |name: &str, figure: String, unit: &str| rows.push((name.to_owned(), format!("{figure} {unit}")));
    if let Some(mass) = entity.get::<&Mass>() {
        row("mass", figure(f64::from(mass.kilograms())), "kg");
    }
    if let Some(inertia) = entity.get::<&Inertia>() {
        row("moments", triple(dvec3(inertia.moments())), "kg m²");
    }
    if let Some(pose) = entity.get::<&Pose>() {
        row("position", triple(dvec3(pose.position)), "m");
    }
    if let Some(velocity) = entity.get::<&Velocity>() {
        row("velocity", triple(dvec3(velocity.linear)), "m/s");
        row("ang. vel.", triple(dvec3(velocity.angular)), "rad/s");
    }
    if let Some(momentum) = entity.get::<&Momentum>() {
        row("momentum", triple(dvec3(momentum.linear)), "kg m/s");
        row("ang. mom.", triple(dvec3(momentum.angular)), "kg m²/s");
    }
    let totals = Totals::of_body(entity, playback.simulation.settings());
    if entity.has::<Momentum>() && totals.non_finite.is_none() {
        row("kinetic", figure(totals.linear_kinetic), "J");
        row("  of rotation", figure(totals.rotational_kinetic), "J");
    }
    rows
}

#[cfg(test)]
mod tests {
    use tumble_scene::Scene;

    use super::*;

    const KEEPS_ENERGY: Kept = Kept { energy: true, momentum: false };

    #[test]
    fn figures_have_four_digits() {
        let cases = [
            (0.0, " 0"),
            (1.0, " 1.000"),
            (-12.3456, "-12.35"),
            (99999.4, " 99999"),
            (0.99999, " 1.000"),
            (0.001234, " 0.001234"),
        ];
        for (value, text) in cases {
            assert_eq!(figure(value), text);
        }
        assert_eq!((figure(1.23456e9), figure(-1.23e-7)), (" 1.235e9".to_owned(), "-1.230e-7".to_owned()));
    }

    #[test]
    fn rounding_beside_large_numbers_is_zero() {
        assert_eq!(triple(DVec3::new(1.0, 1e-9, -2.0)), " 1.000      0         -2.000     ");
    }

    #[test]
    fn the_books_say_what_has_changed() {
        let start = Totals { linear_kinetic: 2.0, linear_momentum: DVec3::X, ..Totals::default() };
        let now = Totals { linear_kinetic: 2.5, linear_momentum: DVec3::X * 1.5, ..Totals::default() };
        let rows = ledger(&start, (MomentumScale { linear: 1.0, angular: 0.0 }, KEEPS_ENERGY), &now, None);
        assert_eq!(rows.len(), 8);
        assert_eq!(rows[2].1, " 2.500 J");
        assert_eq!((rows[3].0.as_str(), rows[5].0.as_str()), ("  drift", "  change"));
        assert_eq!((rows[3].1.as_str(), rows[5].1.as_str(), rows[7].1.as_str()), ("+2.5e-1", "+5.0e-1", " 0"));
    }

    /// Momenta of equal size in opposite directions have a sum of nothing, by which a rounding
    /// would be no small part.
    #[test]
    fn momenta_that_cancel_have_a_scale() {
        let playback = Playback::of(Scene::open("solar-system").unwrap()).unwrap();
        let (start, scale) = (playback.start, playback.scale);
        // The sun moves so that the common centre of mass does not: in single precision a rounding
        // of its momentum is left.
        assert!(start.linear_momentum.length() < 1e-5 * scale.linear, "{start:?} {scale:?}");
        let pair = MomentumScale { linear: 2.0, angular: 4.0 };
        let now = Totals { linear_momentum: DVec3::X * 1e-6, angular_momentum: DVec3::Y * 1e-6, ..Totals::default() };
        let rows = ledger(&Totals::default(), (pair, KEEPS_ENERGY), &now, None);
        assert_eq!((rows[5].1.as_str(), rows[7].1.as_str()), ("+5.0e-7", "+2.5e-7"));
    }

    #[test]
    fn a_lost_body_is_named() {
        let now = Totals::default();
        let rows = ledger(&now, (MomentumScale::default(), KEEPS_ENERGY), &now, Some("mars"));
        assert_eq!(rows.last().unwrap().0, "not finite: mars");
    }

    /// A block of 1 kg and 0.2 x 0.4 x 0.6 m with (1, 2, 3) rad/s: the sum of I w^2/2 over its
    /// axes.
    #[test]
    fn a_body_tells_its_energy() {
        let playback = Playback::of(Scene::open("mujoco-box").unwrap()).unwrap();
        let drawn = &playback.bodies.all[0];
        let totals = Totals::of_body(playback.world.entity(drawn.entity).unwrap(), playback.simulation.settings());
        let (linear, rotational) = (totals.linear_kinetic, totals.rotational_kinetic);
        let [x, y, z] = [0.04 + 0.09, 0.01 + 0.09, 0.01 + 0.04].map(|squares: f64| squares / 3.0);
        let expected = 0.5 * (x + 4.0 * y + 9.0 * z);
        // Momenta and moments in single precision, each with a rounding or two of 6e-8.
        assert!((linear, (rotational / expected - 1.0).abs() < 3e-7) == (0.0, true), "{rotational} {expected}");
        let rows = body(&playback, drawn);
        assert_eq!((rows[0].0.as_str(), rows[1].1.as_str()), ("box", " 1.000 kg"));
        assert_eq!(rows.last().unwrap().0, "  of rotation");
    }
}
