//! Promise: a drive whose position oscillates moves its joint as the closed form of a driven
//! oscillator says, with its amplitude and phase; it goes by the time of the simulation, also after
//! a rewind and in a batch; its joint does not fall asleep.
//!
//! Why: legs walk by it. It fails if the target is taken at another time than the middle of a step,
//! with the wrong sign of the phase or without its speed, if the time is counted from where the
//! program began, or if slow targets leave a body asleep.

use std::f64::consts::TAU;

use crate::jointed::*;
use glam::DVec3;
use hecs::{Entity, World};
use tumble::math::Real;
use tumble::{Axes, Batch, Drive, JointLoad, Oscillation, Settings, SettingsError, Simulation, Sleep, Trial};
use tumble_tests::{Draw, cases, hash};

fn settings(dt: f64, substeps: u32) -> Settings {
    Settings::default().with_dt(dt as Real).with_contact_substeps(substeps).with_gravity(real(DVec3::ZERO))
}

fn angle(world: &World, joint: Entity) -> f64 {
    f64::from(world.get::<&JointLoad>(joint).unwrap().values[3])
}

/// A driven oscillator: `I x'' = k (p + A sin(wt + phase) - x) + c (w A cos(wt + phase) - x')`.
struct Driven {
    position: f64,
    amplitude: f64,
    hertz: f64,
    phase: f64,
    natural: f64,
    ratio: f64,
}

impl Driven {
    fn new(draw: &mut Draw) -> Self {
        Self {
            position: draw.between(-0.8, 0.8),
            amplitude: draw.between(0.05, 0.6),
            hertz: draw.log_between(0.1, 4.0),
            phase: draw.between(-9.0, 9.0),
            natural: TAU * draw.log_between(0.5, 5.0),
            ratio: draw.log_between(0.2, 2.0),
        }
    }

    fn drive(&self, moment: f64) -> Drive {
        let [stiffness, damping] = [moment * self.natural.powi(2), 2.0 * moment * self.natural * self.ratio];
        let [amplitude, hertz, phase] = [self.amplitude, self.hertz, self.phase].map(|it| it as Real);
        Drive::position(Axes::ANGULAR_X, self.position as Real)
            .with_stiffness(stiffness as Real, damping as Real)
            .with_oscillation(Oscillation { amplitude, hertz, phase })
    }

    /// Where it is once what it began with has died away.
    fn at(&self, time: f64) -> f64 {
        let r = TAU * self.hertz / self.natural;
        let [gain, lag] = {
            let (above, below) =
                (1.0 + (2.0 * self.ratio * r).powi(2), (1.0 - r * r).powi(2) + (2.0 * self.ratio * r).powi(2));
            let lag = (2.0 * self.ratio * r).atan2(1.0 - r * r) - (2.0 * self.ratio * r).atan();
            [(above / below).sqrt(), lag]
        };
        self.position + self.amplitude * gain * (TAU * self.hertz * time + self.phase - lag).sin()
    }
}

#[test]
fn a_joint_follows_as_a_driven_oscillator() {
    let mut worst = 0.0_f64;
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(0xe1, case);
        let (of_drive, mass, dt) =
            (Driven::new(&mut draw), draw.log_between(1e-2, 1e3), 1.0 / draw.log_between(30.0, 240.0));
        let mut world = World::new();
        let (_, joint) = driven_rod(&mut world, mass, vec![of_drive.drive(mass / 3.0)]);
        let mut simulation = Simulation::new(settings(dt, 1 + draw.between(0.0, 8.0) as u32)).unwrap();
        let slowest = of_drive.natural * of_drive.ratio.min(1.0 / of_drive.ratio).min(1.0) * 0.5;
        while simulation.time() < 12.0 / slowest {
            simulation.step(&mut world);
        }
        let mut off = 0.0_f64;
        let until = simulation.time() + 1.0 / of_drive.hertz;
        while simulation.time() < until {
            simulation.step(&mut world);
            off = off.max((angle(&world, joint) - of_drive.at(simulation.time())).abs());
        }
        // Second order in what the target turns in its period, and what the spring does, in a step.
        let turned = (TAU * of_drive.hertz).max(of_drive.natural * of_drive.ratio.max(1.0)) * dt;
        println!("case {case}: {off:e} rad of {}, {turned} rad a step", of_drive.amplitude);
        worst = worst.max(off / (of_drive.amplitude * turned * turned));
    }
    println!("{worst}");
    assert!(worst < 0.2, "{worst}");
}

/// What such a target turns in half a second is less than what still bodies may turn.
#[test]
fn slow_targets_keep_their_joint_awake() {
    let swing = Oscillation { amplitude: 0.5, hertz: 1e-3, phase: 0.0 };
    for is_rigid in [true, false] {
        let drive = Drive::position(Axes::ANGULAR_X, 0.0).with_oscillation(swing);
        let drive = if is_rigid { drive } else { drive.with_stiffness(1e4, 1e2) };
        let mut world = World::new();
        let (_, joint) = driven_rod(&mut world, 1.0, vec![drive]);
        let mut simulation = Simulation::new(settings(1.0 / 60.0, 4).with_sleep(Sleep::default())).unwrap();
        while simulation.time() < 20.0 {
            simulation.step(&mut world);
        }
        let target = 0.5 * (TAU * 1e-3 * simulation.time()).sin();
        assert!((angle(&world, joint) - target).abs() < 1e-4, "{} of {target}", angle(&world, joint));
    }
}

/// The time is the simulation's: a rewind repeats the bits, and each world of a batch goes by its
/// own.
#[test]
fn the_time_is_the_simulations() {
    let mut draw = Draw::new(0xe2, 0);
    let drives: Vec<Drive> = (0..3).map(|_| Driven::new(&mut draw).drive(1.0 / 3.0)).collect();
    let settings = settings(1.0 / 60.0, 4);
    let mut alone = Vec::new();
    for drive in &drives {
        let mut world = World::new();
        driven_rod(&mut world, 1.0, vec![*drive]);
        let mut simulation = Simulation::new(settings).unwrap();
        simulation.step_many(&mut world, 37);
        let there = simulation.snapshot(&world).unwrap();
        simulation.step_many(&mut world, 50);
        let first = hash(&world);
        simulation.restore(&there, &mut world).unwrap();
        (0..50).for_each(|_| simulation.step(&mut world));
        assert_eq!(hash(&world), first);
        alone.push(first);
    }
    let mut batch = Batch::from_seed(3, 0, |index, _| {
        let mut world = World::new();
        driven_rod(&mut world, 1.0, vec![drives[index]]);
        Ok::<_, SettingsError>(Trial { simulation: Simulation::new(settings)?, world })
    })
    .unwrap();
    batch.step_many(87);
    assert_eq!(batch.map(|_, trial| hash(&trial.world)), alone);
}
