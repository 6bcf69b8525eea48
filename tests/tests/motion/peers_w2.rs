//! Promise: of the engines that were measured on two free bodies over ten minutes, none keeps
//! energy, angular momentum or attitude better than `MoserVeselov` does in the same precision, and
//! none at all in double precision. The same holds of the count of flips, but for the handle in
//! single precision, where rounding decides it (`long_run.rs`).
//!
//! Why: it is the claim of the README. It fails when the figures quoted there are no longer ours.
//!
//! The others' figures are in `data/peers/w2.json`;
//! `cargo run --release --example integrators -- --peers` prints the table.

use tumble::Integrator::MoserVeselov;
use tumble_tests::references::{Tumbler, Tumbling};
use tumble_tests::{DOUBLE, by_precision};

fn ours(body: &Tumbler) -> Tumbling {
    body.run(MoserVeselov, 1.0 / 60.0, 36_000)
}

/// Eleven rows of eight engines. The figures of single precision are compared with those of
/// single-precision engines.
#[test]
fn no_engine_does_better() {
    for body in [Tumbler::t_handle(), Tumbler::polhode()] {
        let run = ours(&body);
        println!(
            "{}: energy {:.1e}, {} flips, {:.1e} degrees",
            body.name,
            run.energy,
            run.flips,
            run.attitude_after(10.0)
        );
        assert!(run.momentum_kept, "{}", body.name);
        assert_eq!(body.peers.len(), 11, "{}", body.name);
        for peer in body.peers.iter().filter(|peer| DOUBLE || !peer.engine.contains("f64")) {
            assert!(run.energy.abs() < peer.energy.abs(), "{}: {} has {:e}", body.name, peer.engine, peer.energy);
            assert!(peer.momentum != 0.0, "{}: {} keeps |L|", body.name, peer.engine);
            let attitude = run.attitude_after(10.0);
            assert!(attitude < peer.attitude, "{}: {} has {:e}", body.name, peer.engine, peer.attitude);
            let missed = |flips: u32| flips.abs_diff(body.flips);
            // Bullet loses 97 % of the energy and has the right count by accident; the count of the
            // handle in single precision depends on rounding here too (`long_run.rs`).
            let is_luck = peer.energy < -0.9 || (!DOUBLE && body.name == "thandle");
            assert!(is_luck || missed(run.flips) <= missed(peer.flips), "{}: {} flips", peer.engine, peer.flips);
        }
    }
}

/// The map itself, without the error of the method: energy to rounding. Over 36 000 steps a
/// rounding of `EPSILON` each adds up to `190 EPSILON` at random, 4e-14 and 2.3e-5.
#[test]
fn energy_is_kept_to_rounding() {
    for body in [Tumbler::t_handle(), Tumbler::polhode()] {
        let run = ours(&body);
        assert!(run.energy.abs() <= by_precision(2.3e-5, 4.2e-14), "{}: {:e}", body.name, run.energy);
    }
}
