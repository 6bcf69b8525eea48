//! Promise: the skater's spin grows as its moment of inertia falls, and the axis of a ball with a
//! weight on it goes round the angular momentum at the rate of free precession, that of any weight
//! on any ball.
//!
//! Why: they are the two experiments of docs/spinning.md, and their figures stand there. It fails
//! if springs give a system a torque, if a compound's moments or centre are off, or if free
//! rotation leaves its cone.
#![cfg_attr(feature = "f64", allow(clippy::useless_conversion, reason = "Real is f64 in this build, f32 in the other"))]

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::Real;
use tumble::{BodyOrder, Momentum, Pose, Rng, Simulation, Totals, Velocity};
use tumble_scene::Scene;

use crate::precision::SINGLE;

struct Run {
    world: World,
    simulation: Simulation,
    order: BodyOrder,
    steps: u64,
}

impl Run {
    fn of(scene: Scene) -> Self {
        let (steps, simulation) = (scene.steps, Simulation::new(scene.settings).unwrap());
        let mut world = World::new();
        scene.spawn(&mut world).unwrap();
        let order = BodyOrder::of(&world);
        Self { world, simulation, order, steps }
    }

    fn body(&self, index: usize) -> Entity {
        self.order.entities()[index]
    }

    fn step(&mut self, steps: u32) {
        self.simulation.step_many(&mut self.world, steps);
    }

    fn totals(&self) -> Totals {
        Totals::of(&self.world, self.simulation.settings(), &self.order)
    }

    /// The body's y axis in the world.
    fn axis(&self, index: usize) -> DVec3 {
        let [x, y, z, w] = self.world.get::<&Pose>(self.body(index)).unwrap().orientation.to_array().map(f64::from);
        DQuat::from_xyzw(x, y, z, w).normalize() * DVec3::Y
    }

    fn momentum(&self, index: usize) -> DVec3 {
        DVec3::from_array(self.world.get::<&Momentum>(self.body(index)).unwrap().angular.to_array().map(f64::from))
    }
}

#[test]
fn the_skater_spins_faster() {
    let mut run = Run::of(Scene::open("skater").unwrap());
    let start = run.totals();
    let steps = run.steps as u32;
    let (trunk, hand) = (run.body(0), run.body(1));
    run.step(steps);
    let end = run.totals();
    // A rounding a step at the most.
    let rounding = f64::from(Real::EPSILON) * f64::from(steps);
    assert!((end.angular_momentum - start.angular_momentum).length() <= rounding * start.angular_momentum.length());
    assert!((start.angular_momentum - DVec3::Y * 21.1275).length() <= 1e-4);
    // 2 k (r - 0.2) = m w^2 r and L = (I + 2 m r^2) w, for r.
    let spin = |r: f64| 21.1275 / (0.5625 + 8.0 * r * r);
    let (mut low, mut high) = (0.2, 0.9);
    for _ in 0..60 {
        let r = 0.5 * (low + high);
        if 450.0 * (r - 0.2) > 4.0 * spin(r).powi(2) * r { high = r } else { low = r }
    }
    let at = |entity| DVec3::from_array(run.world.get::<&Pose>(entity).unwrap().position.to_array().map(f64::from));
    let w = f64::from(run.world.get::<&Velocity>(trunk).unwrap().angular.y);
    let r = (at(hand) - at(trunk)).length();
    println!("r {r} of {low}, w {w} of {}, kinetic {} to {}", spin(low), start.kinetic(), end.kinetic());
    // A circle in kicks and chords of 0.04 rad is 2e-4 of itself off.
    assert!((r / low - 1.0).abs() < 1e-3 && (w / spin(low) - 1.0).abs() < 1e-3);
    // What the spin gained, and the dampers took, the springs gave.
    assert!((start.kinetic() - 31.69).abs() < 0.01 && (end.kinetic() - 86.84).abs() < 0.3);
    assert!(end.energy() < start.energy());
}

/// How far the axis of a ball with a weight is from where free precession has it at most, in a run
/// \[rad\].
fn worst_of_precession(mut run: Run, index: usize, transverse: f64) -> f64 {
    let (axis, momentum, dt) = (run.axis(index), run.momentum(index), f64::from(run.simulation.settings().dt));
    let mut worst: f64 = 0.0;
    for step in 1..=run.steps {
        run.step(1);
        let angle = momentum.length() / transverse * dt * step as f64;
        let exact = DQuat::from_axis_angle(momentum.normalize(), angle % TAU) * axis;
        worst = worst.max(exact.cross(run.axis(index)).length());
    }
    worst
}

#[test]
fn the_weighted_sphere_wobbles_and_the_even_one_does_not() {
    let mut run = Run::of(Scene::open("weighted-sphere").unwrap());
    let momentum = run.momentum(1);
    assert!((momentum.length() - 2.58778).abs() < 1e-5 && (TAU * 0.604 / momentum.length() - 1.4665).abs() < 1e-4);
    run.step(1);
    let spin = |run: &Run| run.world.get::<&Velocity>(run.body(0)).unwrap().angular;
    let before = spin(&run);
    run.step(500);
    // Its momentum stands to the bit; what comes of it turns with roundings.
    assert!((spin(&run) - before).length() < 1e-5);
    let worst = worst_of_precession(Run::of(Scene::open("weighted-sphere").unwrap()), 1, 0.604);
    println!("the axis is within {worst:e} rad");
    assert!(worst < if SINGLE { 3e-5 } else { 1e-6 });
}

/// Any weight anywhere on any ball, spinning at up to a third of a radian a step.
#[test]
fn any_weight_makes_the_axis_go_round_at_its_rate() {
    let mut rng = Rng::new(19);
    for _ in 0..40 {
        let mut between = |low: f64, high: f64| low + (high - low) * rng.unit();
        let (ball, radius, weight, small) =
            (between(0.1, 10.0), between(0.05, 2.0), between(0.01, 10.0), between(0.005, 0.05));
        let out = between(0.2, 1.0) * radius;
        let spin = [between(-10.0, 10.0), between(-20.0, 20.0), between(-10.0, 10.0)];
        let text = format!(
            r#"{{ "gravity": [0, 0, 0], "dt": 0.01, "steps": 200, "bodies": [ {{ "angular_velocity": {spin:?}, "shape": {{ "compound": {{ "parts": [
                {{ "shape": {{ "sphere": {{ "radius": {radius} }} }}, "mass": {ball} }},
                {{ "shape": {{ "sphere": {{ "radius": {small} }} }}, "mass": {weight}, "position": [0, {out}, 0] }} ] }} }} }} ] }}"#
        );
        let reduced = ball * weight / (ball + weight);
        let transverse = 0.4 * (ball * radius * radius + weight * small * small) + reduced * out * out;
        let worst = worst_of_precession(Run::of(Scene::from_json(&text, "ball.json").unwrap()), 0, transverse);
        // Two hundred roundings of a turn of up to 50 rad; and the sixth power of a third, by its
        // small factor, for two seconds.
        assert!(worst < if SINGLE { 2e-4 } else { 5e-5 }, "{worst:e}: {text}");
    }
}
