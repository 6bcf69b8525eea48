//! Ten minutes of two free bodies at 60 steps a second, beside what eight other engines make of
//! them.

use tumble::Integrator;
use tumble_tests::references::Tumbler;

use crate::line;

/// The tables. The other engines' rows are quoted from `tests/data/peers/w2.json`.
pub(crate) fn tables() -> String {
    let mut text = String::new();
    for body in [Tumbler::t_handle(), Tumbler::polhode()] {
        let (i, w) = (body.moments, body.angular_velocity);
        line(&mut text, format_args!("I = {i}, w = {w}, 600 s at dt = 1/60; {} flips are right", body.flips));
        line(
            &mut text,
            format_args!(
                "{:>36} {:>12} {:>10} {:>6} {:>22}",
                "engine", "energy", "|L|", "flips", "attitude 10 s [deg]"
            ),
        );
        for integrator in Integrator::ALL {
            let run = body.run(integrator, 1.0 / 60.0, 36_000);
            let name = format!("tumble {}, {integrator}", tumble::math::PRECISION);
            let momentum = if run.momentum_kept { "to the bit" } else { "lost" };
            let attitude = run.attitude_after(10.0);
            line(
                &mut text,
                format_args!("{name:>36} {:>12.2e} {momentum:>10} {:>6} {attitude:>22.2e}", run.energy, run.flips),
            );
        }
        for peer in &body.peers {
            line(
                &mut text,
                format_args!(
                    "{:>36} {:>12.2e} {:>10.1e} {:>6} {:>22.2e}",
                    peer.engine, peer.energy, peer.momentum, peer.flips, peer.attitude
                ),
            );
        }
        line(&mut text, format_args!(""));
    }
    text
}
