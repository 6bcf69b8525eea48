//! Promise: the built-in scenes of forces keep what their forces keep: the solar system energy,
//! both momenta and its years; the raft energy and what momentum water cannot change; the
//! satellite's energy changes by what its nozzles and its wheel did; and on a windy day everything
//! ends as wind, weight and cords have it.
//!
//! Why: they are what the documentation shows forces with. A force with a wrong sign, a potential
//! that does not belong to it, or work that is booked twice, would show here and in no picture.

use std::f64::consts::TAU;

use glam::DVec3;
use hecs::World;
use tumble::{BodyId, Ledger, LedgerEntry, Momentum, Pose, Simulation, Totals};
use tumble_scene::Scene;

use crate::precision::by_precision;

struct Run {
    world: World,
    simulation: Simulation,
    ledger: Ledger,
}

impl Run {
    fn of(name: &str, substeps: Option<u32>) -> (Self, u64) {
        let scene = Scene::open(name).unwrap();
        let (steps, settings) = (scene.steps, scene.settings);
        let settings = settings.with_substeps(substeps.unwrap_or(settings.substeps));
        let mut world = World::new();
        scene.spawn(&mut world).unwrap();
        let simulation = Simulation::new(settings).unwrap();
        let ledger = Ledger::attach(&mut world, &simulation);
        (Self { world, simulation, ledger }, steps)
    }

    fn step(&mut self) {
        self.simulation.step(&mut self.world);
    }

    fn record(&mut self) -> LedgerEntry {
        self.ledger.record(&self.world, &self.simulation)
    }

    fn start(&self) -> LedgerEntry {
        self.ledger.entries()[0]
    }

    /// The largest departure of a number from its start.
    fn largest_change(&self, number: impl Fn(&LedgerEntry) -> f64) -> f64 {
        let start = number(&self.start());
        self.ledger.entries().iter().map(|entry| (number(entry) - start).abs()).fold(0.0, f64::max)
    }

    /// The same of a vector.
    fn largest_change_of(&self, vector: impl Fn(&Totals) -> DVec3) -> f64 {
        let start = vector(&self.start().totals);
        self.ledger.entries().iter().map(|entry| (vector(&entry.totals) - start).length()).fold(0.0, f64::max)
    }

    /// In the order of the scene.
    fn positions(&self) -> Vec<DVec3> {
        let mut bodies: Vec<(u64, DVec3)> =
            self.world.query::<(&BodyId, &Pose)>().iter().map(|(id, pose)| (id.0, double(pose.position))).collect();
        bodies.sort_unstable_by_key(|(id, _)| *id);
        bodies.into_iter().map(|(_, position)| position).collect()
    }
}

#[allow(clippy::useless_conversion, reason = "Real is f64 in one of the two builds")]
fn double(vector: tumble::math::Vec3) -> DVec3 {
    DVec3::from_array(vector.to_array().map(f64::from))
}

/// Works as the ledger has them, by name of the component.
fn work(entry: &LedgerEntry, component: &str) -> f64 {
    entry.work.of(component).unwrap()
}

/// Rounding in single precision: a kick rounds a momentum by 3e-8 of it on average, and there are
/// 35 000 of them, which make 190 times that where they go either way. The planets count most that
/// have most.
#[test]
fn the_solar_system_keeps_energy_and_momenta() {
    let (mut run, steps) = Run::of("solar-system", None);
    let magnitudes = run.world.query::<&Momentum>().iter().map(|p| double(p.linear).length()).sum::<f64>();
    for _ in 0..steps {
        run.step();
        run.record();
    }
    let start = run.start().totals;
    // In double precision it is the scheme's own: Mercury, which has 0.2 % of the energy, goes up
    // and down by (n h)^2/50 of its own every year; n h is 0.018.
    let energy = run.largest_change(LedgerEntry::energy) / start.energy().abs();
    assert!(energy < by_precision(2e-5, 2.5e-7), "{energy:e}");
    let linear = run.largest_change_of(|totals| totals.linear_momentum) / magnitudes;
    assert!(linear < by_precision(1e-5, 4e-14), "{linear:e}");
    let angular = run.largest_change_of(|totals| totals.angular_momentum) / start.angular_momentum.length();
    assert!(angular < by_precision(1e-5, 4e-14), "{angular:e}");
}

/// How many days the planets take to come round once as the sun sees it, for as many of them as do
/// in the given days.
fn years(substeps: Option<u32>, days: u32) -> Vec<f64> {
    let (mut run, _) = Run::of("solar-system", substeps);
    run.ledger.detach(&mut run.world);
    let from_the_sun = |run: &Run| -> Vec<DVec3> {
        let positions = run.positions();
        positions[1..].iter().map(|position| *position - positions[0]).collect()
    };
    let mut before = from_the_sun(&run);
    let (mut turned, mut years) = ([0.0; 8], Vec::new());
    for day in 0..days {
        run.step();
        let now = from_the_sun(&run);
        for ((turned, before), now) in turned.iter_mut().zip(&before).zip(&now) {
            let angle = before.cross(*now).length().atan2(before.dot(*now));
            let left = TAU - *turned;
            if left > 0.0 && angle >= left {
                years.push(f64::from(day) + left / angle);
            }
            *turned += angle;
        }
        before = now;
    }
    years
}

/// Against the mean motions that come with the elements the scene was made from: 36525 days times
/// 360 degrees over the rate of mean longitude.
#[test]
fn the_planets_come_round_in_their_years() {
    let rates = [149_472.674_111_75, 58_517.815_387_29, 35_999.372_449_81, 19_140.302_684_99, 3_034.746_127_75];
    let check = |years: &[f64], rates: &[f64], tolerance: f64| {
        assert_eq!(years.len(), rates.len());
        for (days, rate) in years.iter().zip(rates) {
            let mean = 36_525.0 * 360.0 / rate;
            assert!((days / mean - 1.0).abs() < tolerance, "{days} days, {mean} on average");
        }
    };
    // The scheme makes a year longer by about (n h)^2/2: 1.6e-4 for Mercury. Venus and earth, and
    // Mars and Jupiter, change single years of each other by hours.
    let inner = years(None, 4383);
    check(&inner[..4], &rates[..4], 3e-4);
    // Saturn pulls Jupiter back and forth by a degree.
    check(&inner[4..], &rates[4..], 3e-3);
    // The same in steps of a whole day. The sun goes round the centre of mass at up to 16 m/s, and
    // elements are from the sun: 0.3 % of Neptune's velocity, and three times that of its year.
    let outer = years(Some(1), 61_000);
    check(&outer[5..], &[1_222.493_622_01, 428.482_027_85, 218.459_453_25], 0.01);
}

fn raft(substeps: u32) -> Run {
    let (mut run, steps) = Run::of("raft", Some(substeps));
    for _ in 0..steps {
        run.step();
        run.record();
    }
    run
}

#[test]
fn the_raft_keeps_its_energy_and_what_water_cannot_change() {
    let run = raft(4);
    let (start, end) = (run.start(), run.ledger.entries()[run.ledger.entries().len() - 1]);
    // The potential misses (w h)^2/12 of the energy of a spring that vibrates at w: 0.7 % for the
    // stiffest, at 0.3 rad a substep. Half of all energy comes to be in springs.
    let energy = run.largest_change(LedgerEntry::energy);
    assert!(energy < 0.003 * start.energy(), "{energy} J of {} J", start.energy());
    // With the square of the substep. The vibrations are chaotic, so one run has more of them than
    // the other, by a half or so.
    let ratio = energy / raft(16).largest_change(LedgerEntry::energy);
    assert!((10.0..24.0).contains(&ratio), "{ratio}");

    // Lift is vertical: horizontal momentum and vertical spin stay. Rounding: 12 bodies, 16 000
    // kicks of up to 500 kg m/s (half a unit: 1.5e-5, 3e-14) at random, 440 times that; arms 2.4 m.
    let horizontal = run.largest_change_of(|totals| totals.linear_momentum.with_y(0.0));
    assert!(horizontal < by_precision(7e-3, 1.3e-11), "{horizontal:e}");
    let spin = run.largest_change(|entry| entry.totals.angular_momentum.y);
    assert!(spin < by_precision(2e-2, 4e-11), "{spin:e}");

    // What water, springs and gravity did is the kinetic energy; velocities of 1 m/s times the same
    // rounding.
    let works = work(&end, "Buoyancy") + work(&end, "Spring") + end.work.gravity;
    assert!((works - end.kinetic()).abs() < by_precision(2e-2, 4e-11), "{works} {}", end.kinetic());
    // It floats: at rest 2.5 cm below the surface, and it fell from 15 cm above.
    assert!(run.positions().iter().all(|position| position.y.abs() < 0.4));
}

#[test]
fn the_satellite_stops_and_rises_by_the_works_of_wheel_and_nozzles() {
    let (mut run, steps) = Run::of("satellite", None);
    let spin = |run: &Run| run.world.query::<&Momentum>().iter().map(|p| double(p.angular).length()).sum::<f64>();
    let at_first = spin(&run);
    // At its limit the wheel takes 0.2 N m s a second of the spin, which is 80.8 N m s: it stops in
    // the 405th second.
    for second in 1..=steps {
        run.step();
        run.record();
        let left = at_first - 0.2 * second as f64;
        if left > 0.2 {
            // Single precision rounds the same 0.1 N m s twice a second by up to 4e-6, and to the
            // same side while the spin is of the same size.
            assert!((spin(&run) - left).abs() < by_precision(3e-3, 1e-11), "{second} s: {} {left}", spin(&run));
        } else if left < -0.2 {
            // What is less than the limit goes at once.
            assert!(spin(&run) < 1e-9, "{second} s: {}", spin(&run));
        }
    }
    let end = run.ledger.entries()[run.ledger.entries().len() - 1];
    assert!((404.0..405.0).contains(&(at_first / 0.2)), "{at_first}");

    let start = run.start();
    // The wheel did the work on the rotation, the nozzles that on the orbit. Single precision
    // rounds 4 J by 1e-7, 7200 times; in double the scheme is left, which turns by 0.05 rad a step.
    for entry in run.ledger.entries() {
        let change = |of: fn(&LedgerEntry) -> f64| of(entry) - of(&start);
        let turning = change(|entry| entry.totals.rotational_kinetic) - work(entry, "AngularVelocityServo");
        assert!(turning.abs() < by_precision(1e-4, 1e-12), "{turning:e}");
        let orbit =
            change(|entry| entry.totals.linear_kinetic + entry.totals.force_potential) - work(entry, "Thruster");
        assert!(orbit.abs() < by_precision(1e-4, 1e-8), "{orbit:e}");
    }
    // Newton's second law, for the 3190 s in which the push of 20 mN has one direction: 0.053 m/s,
    // as much as the orbit has.
    assert!(work(&end, "Thruster") > 2.0, "{end:?}");
}

/// One after the other in the scene: two balls, a balloon, a lantern and a rocket.
#[test]
fn a_windy_day_ends_as_wind_weight_and_cords_have_it() {
    let (mut run, steps) = Run::of("windy-day", None);
    for _ in 0..steps {
        run.step();
    }
    let end = run.record();
    let start = run.start();
    let forces = ["Drag", "Magnus", "ConstantWrench", "SpringToPoint"].map(|name| work(&end, name));
    let works = forces.iter().sum::<f64>() + end.work.gravity + end.work.damping;
    let change = end.kinetic() - start.kinetic();
    assert!((works - change).abs() < 1e-4 * start.kinetic(), "{works} {change}");

    let [plain, curled, _, lantern, _] = run.positions()[..] else { panic!("five bodies") };
    let velocities: Vec<tumble::Velocity> = {
        let mut bodies: Vec<_> =
            run.world.query::<(&BodyId, &tumble::Velocity)>().iter().map(|(id, it)| (id.0, *it)).collect();
        bodies.sort_unstable_by_key(|(id, _)| *id);
        bodies.into_iter().map(|(_, velocity)| velocity).collect()
    };
    // A spin down and a flight along x push along z, and what has curled flies less far.
    assert!(curled.z - 2.0 > plain.z + 10.0 && curled.x < plain.x - 5.0, "{curled} {plain}");
    // The air carries the balloon, which rises as fast as its drag lets four tenths of its weight
    // lift it.
    let risen = double(velocities[2].linear) - DVec3::new(0.0, (0.4 * 0.01 * 9.81 / 0.02_f64).sqrt(), -3.0);
    assert!(risen.length() < 1e-3, "{risen}");
    // The lantern hangs along the cord, which is along the sum of weight and wind.
    let pull = DVec3::new(0.0, -1.5 * 9.81, -0.05 * 9.0);
    let hangs = DVec3::new(-2.0, 4.0, 0.0) + pull.normalize() * (1.0 + pull.length() / 200.0 + 0.2);
    assert!(lantern.distance(hangs) < 1e-3, "{lantern} {hangs}");
    // The rocket rolls towards the rate at which damping takes away what its fins give.
    let moment = 0.5 * 2.0 * 0.06 * 0.06;
    let roll = 0.02 / (moment * 0.5) * (1.0 - (-0.5 * 6.0_f64).exp());
    assert!((double(velocities[4].angular).y / roll - 1.0).abs() < 0.01, "{:?} {roll}", velocities[4]);
}
