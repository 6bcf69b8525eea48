//! Promise: the built-in scenes of bodies that touch do what their names say: what is to stand stands, what is to fall falls, and nothing goes through
//! the ground or a wall.
//!
//! Why: they are what is looked at first. Each test has in it what one would look for.
#![allow(clippy::unwrap_used, reason = "a scene that cannot be run is a failed test")]

use glam::DVec3;
use hecs::World;
use tumble::{BodyOrder, Pose, Simulation, Velocity};
use tumble_scene::{Names, Scene};

/// A scene that is being run, and its bodies by name.
struct Run {
    world: World,
    order: BodyOrder,
    names: Names,
    simulation: Simulation,
    steps: u64,
}

impl Run {
    fn of(name: &str, bodies: Option<u64>) -> Self {
        let scene = Scene::open_with(name, bodies, None).unwrap();
        let (simulation, steps) = (Simulation::new(scene.settings).unwrap(), scene.steps);
        let mut world = World::new();
        let names = scene.spawn(&mut world).unwrap();
        let order = BodyOrder::of(&world);
        Self { world, order, names, simulation, steps }
    }

    fn until(&mut self, seconds: f64) {
        while self.simulation.time() < seconds - 1e-9 {
            self.simulation.step(&mut self.world);
        }
    }

    fn to_the_end(&mut self) {
        (0..self.steps).for_each(|_| self.simulation.step(&mut self.world));
    }

    /// Those whose names begin so.
    fn called<'a>(&'a self, beginning: &'a str) -> impl Iterator<Item = hecs::Entity> + 'a {
        let named = move |index: &usize| self.names.of(*index as u64).starts_with(beginning);
        (0..self.order.len()).filter(named).map(|index| self.order.entities()[index])
    }

    fn places(&self, beginning: &str) -> Vec<DVec3> {
        let place = |entity| dvec3(self.world.get::<&Pose>(entity).unwrap().position);
        self.called(beginning).map(place).collect()
    }

    fn velocities(&self, beginning: &str) -> Vec<DVec3> {
        let velocity = |entity| dvec3(self.world.get::<&Velocity>(entity).unwrap().linear);
        self.called(beginning).map(velocity).collect()
    }

    /// The height of each body's own y axis.
    fn uprights(&self, beginning: &str) -> Vec<f64> {
        let upright =
            |entity| f64::from((self.world.get::<&Pose>(entity).unwrap().orientation * tumble::math::Vec3::Y).y);
        self.called(beginning).map(upright).collect()
    }
}

#[allow(clippy::useless_conversion, reason = "it is f64 already in one of the two builds")]
fn dvec3(vector: tumble::math::Vec3) -> DVec3 {
    DVec3::from_array(vector.to_array().map(f64::from))
}

fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

fn smallest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(f64::INFINITY, f64::min)
}

#[test]
#[cfg(any())]
fn explore() {
    let mut run = Run::of("pyramid", Some(385));
    let start = run.places("box");
    run.to_the_end();
    let moved: Vec<f64> = run.places("box").iter().zip(&start).map(|(a, b)| (*a - *b).length()).collect();
    eprintln!("pyramid moved {} speed {}", largest(moved), largest(run.velocities("box").iter().map(|v| v.length())));

    let mut run = Run::of("wall", None);
    let start = run.places("brick");
    run.until(0.9);
    let moved: Vec<f64> = run.places("brick").iter().zip(&start).map(|(a, b)| (*a - *b).length()).collect();
    eprintln!("wall before {} ball {:?}", largest(moved), run.places("ball"));
    run.to_the_end();
    let moved: Vec<f64> = run.places("brick").iter().zip(&start).map(|(a, b)| (*a - *b).length()).collect();
    eprintln!(
        "wall after {} of {} moved, lowest {} ball {:?}",
        moved.iter().filter(|m| **m > 0.3).count(),
        moved.len(),
        smallest(run.places("").iter().map(|p| p.y)),
        run.places("ball")
    );

    let mut run = Run::of("dominoes", None);
    for t in 0..15 {
        run.until(t as f64);
        let up = run.uprights("piece");
        eprintln!("dominoes {t} standing {} of {}", up.iter().filter(|u| **u > 0.7).count(), up.len());
    }

    let mut run = Run::of("cradle", None);
    for k in 0..40 {
        run.until(k as f64 * 0.1);
        let v: Vec<String> = run.velocities("ball").iter().map(|v| format!("{:.3}", v.x)).collect();
        let y: Vec<String> = run.places("ball").iter().map(|v| format!("{:.4}", v.y)).collect();
        eprintln!("cradle {k} {v:?} {y:?}");
    }

    let mut run = Run::of("drum", None);
    for k in 0..5 {
        run.until(k as f64 * 4.0);
        let p = run.places("body");
        eprintln!(
            "drum radius {} z {} panel {:?} mean {}",
            largest(p.iter().map(|p| (p.x).hypot(p.y - 3.0))),
            largest(p.iter().map(|p| p.z.abs())),
            run.places("panel-2"),
            p.iter().sum::<DVec3>() / p.len() as f64
        );
    }

    let mut run = Run::of("pile", Some(100));
    for k in 0..6 {
        run.until(k as f64 * 3.0);
        eprintln!(
            "pile lowest {} speed {}",
            smallest(run.places("body").iter().map(|p| p.y)),
            largest(run.velocities("body").iter().map(|v| v.length()))
        );
    }

    let mut run = Run::of("bowling", None);
    run.to_the_end();
    eprintln!("bowling {:?} lowest {}", run.uprights("pin"), smallest(run.places("").iter().map(|p| p.y)));

    let mut run = Run::of("spheres", Some(648));
    run.to_the_end();
    let p = run.places("ball");
    eprintln!(
        "spheres lowest {} widest {} speed {}",
        smallest(p.iter().map(|p| p.y)),
        largest(p.iter().map(|p| p.x.abs().max(p.z.abs()))),
        largest(run.velocities("ball").iter().map(|v| v.length()))
    );
}

#[test]
fn explore2() {
    let mut run = Run::of("cradle", None);
    for k in 0..80 { run.until(k as f64*0.1);
    let v: Vec<String> = run.velocities("ball").iter().map(|v| format!("{:.3}", v.x)).collect();
    let y: Vec<String> = run.places("ball").iter().map(|v| format!("{:.4}", v.y)).collect();
    eprintln!("cradle {k} {v:?} {y:?}"); }
}
