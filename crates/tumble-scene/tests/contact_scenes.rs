//! Promise: the built-in scenes of bodies that touch do what their names say: what is to stand
//! stands, what is to fall falls, and nothing goes through the ground or a wall.
//!
//! Why: they are what people open first. Each test asserts what one would look for.

use std::f64::consts::TAU;

use glam::DVec3;
use hecs::World;
use tumble::{BodyOrder, Pose, Simulation, Velocity};
use tumble_scene::{BodyNames, Scene};

/// A scene that is being run, and its bodies by name.
struct Run {
    world: World,
    order: BodyOrder,
    names: BodyNames,
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

    fn finish(&mut self) {
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
        let upright = |entity| dvec3(self.world.get::<&Pose>(entity).unwrap().orientation * tumble::math::Vec3::Y).y;
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

/// How far each has moved from where it was \[m\].
fn moved(from: &[DVec3], to: &[DVec3]) -> Vec<f64> {
    from.iter().zip(to).map(|(from, to)| (*to - *from).length()).collect()
}

/// Ten seconds; the peers' pyramids of these boxes sink by 12 to 15 mm at base 20, and this is half
/// as high.
#[test]
fn a_pyramid_stands() {
    let mut run = Run::of("pyramid", Some(385));
    let start = run.places("box");
    run.finish();
    let farthest = largest(moved(&start, &run.places("box")));
    let fastest = largest(run.velocities("box").iter().map(|velocity| velocity.length()));
    assert!(start.len() == 385 && farthest < 7e-3 && fastest < 1e-3, "{farthest} {fastest}");
}

/// The whole one begins as the peers have it: layer k is (20 - k)^2 boxes with centres at height
/// k + 0.5.
#[test]
fn the_pyramid_is_that_of_the_benchmark() {
    let run = Run::of("pyramid", None);
    let places = run.places("box");
    for layer in 0..20_usize {
        let height = 0.5 + layer as f64;
        let count = places.iter().filter(|place| (place.y - height).abs() < 1e-6).count();
        assert_eq!(count, (20 - layer).pow(2), "layer {layer}");
    }
    assert!((largest(places.iter().map(|place| place.x)) - 9.5 * 1.1).abs() < 1e-6);
}

#[test]
fn a_wall_stands_until_it_is_struck() {
    let mut run = Run::of("wall", None);
    let start = run.places("brick");
    run.until(0.45);
    // Contacts are springs of 30 Hz: k layers press the next one in by 2 k g/w^2, so the top of 16
    // sinks by the sum for 1 to 15, and by 16 g/w^2 on the ground, with 60 Hz.
    let sag = (2.0 * 120.0 * 9.81) / (TAU * 30.0).powi(2) + 16.0 * 9.81 / (TAU * 60.0).powi(2);
    for (from, to) in start.iter().zip(run.places("brick")) {
        let by = to - *from;
        assert!((-sag..1e-3).contains(&by.y) && by.x.hypot(by.z) < 0.02, "{from} by {by}");
    }
    run.finish();
    let places = run.places("brick");
    // The ball leaves a hole, and what lies beside it stands: columns that buckle would bring the
    // whole wall down.
    let (ball, strike) = (0.4, 0.6 * 3.2);
    let moved = moved(&start, &places);
    let is_in_the_way = |from: &DVec3| from.x.hypot(from.y - strike) < ball;
    let in_the_way = start.iter().zip(&moved).filter(|(from, _)| is_in_the_way(from));
    assert!(in_the_way.clone().count() > 5 && in_the_way.clone().all(|(_, by)| *by > 0.2), "bricks in its way stay");
    let fallen = moved.iter().filter(|by| **by > 0.2).count();
    assert!((30..110).contains(&fallen), "{fallen} of {}", start.len());
    assert!(smallest(places.iter().map(|place| place.y)) > 0.0, "a brick is under ground");
    assert!(run.places("ball")[0].z > 1.0, "the ball has gone through");
}

#[test]
fn dominoes_fall_one_after_the_other() {
    let mut run = Run::of("dominoes", None);
    let mut fell_at = vec![f64::NAN; run.uprights("piece").len()];
    for tenth in 1..150 {
        let time = 0.1 * f64::from(tenth);
        run.until(time);
        for (upright, fell_at) in run.uprights("piece").into_iter().zip(&mut fell_at) {
            if upright < 0.8 && fell_at.is_nan() {
                *fell_at = time;
            }
        }
    }
    assert!(fell_at.iter().all(|time| time.is_finite()), "{fell_at:?}");
    assert!(fell_at.windows(2).all(|pair| pair[0] <= pair[1]), "{fell_at:?}");
    // They lean on each other and none has been thrown away.
    assert!(largest(run.uprights("piece")) < 0.6);
    assert!(largest(run.velocities("piece").iter().map(|velocity| velocity.length())) < 0.05);
}

/// The first ball comes down by 0.2 m, so with the speed sqrt(2 g 0.2); equal masses and
/// restitution 1 exchange velocities, so the last one leaves with that and rises as high, and the
/// others stay. A pendulum of 1 m that swings to 37 degrees takes 2.057 s, a quarter of which is
/// 0.514 s.
#[test]
fn the_last_ball_of_the_cradle_leaves_with_the_speed_of_the_first() {
    let mut run = Run::of("cradle", None);
    let speed = (2.0 * 9.81 * 0.2_f64).sqrt();
    let (mut fastest, mut highest, mut others) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut energies = Vec::new();
    for hundredth in 1..150 {
        run.until(0.01 * f64::from(hundredth));
        let (velocities, places) = (run.velocities("ball"), run.places("ball"));
        energies
            .push(velocities.iter().zip(&places).map(|(v, at)| 0.5 * v.length_squared() + 9.81 * at.y).sum::<f64>());
        if (60..145).contains(&hundredth) {
            fastest = fastest.max(velocities[4].length());
            highest = highest.max(places[4].y);
            // Along the row: wires that are relieved of a swing swing up and down themselves, a
            // little.
            others = others.max(largest(velocities[..4].iter().map(|velocity| velocity.x.abs())));
        }
    }
    // The gaps and the wires' stretch take a little.
    assert!((0.93..1.001).contains(&(fastest / speed)), "{fastest} of {speed}");
    assert!((0.19..0.2005).contains(&highest), "{highest}");
    assert!(others < 0.02 * speed, "{others}");
    // What is in the wires is not counted: half a millimetre of stretch, by which they hold against
    // gravity and the swing.
    let (least, most) = (smallest(energies.iter().copied()), largest(energies.iter().copied()));
    assert!(most < 1.962 * 1.005 && least > 1.962 * 0.98, "{least} {most}");
}

/// What is in the drum stays in it, is lifted on the side that goes up, and is not at rest.
#[test]
fn the_drum_tumbles_what_is_in_it() {
    let mut run = Run::of("drum", None);
    let corner = 2.5 / (std::f64::consts::PI / 8.0).cos();
    let mut lifted = Vec::new();
    for second in 4..20 {
        run.until(f64::from(second));
        let places = run.places("body");
        let farthest = largest(places.iter().map(|place| place.x.hypot(place.y - 3.0)));
        assert!(farthest < corner, "{farthest} after {second} s");
        assert!(largest(places.iter().map(|place| place.z.abs())) < 1.0, "after {second} s");
        lifted.push(places.iter().map(|place| place.x).sum::<f64>() / places.len() as f64);
    }
    assert!(smallest(lifted.iter().copied()) > 0.3, "{lifted:?}");
    let fastest = largest(run.velocities("body").iter().map(|velocity| velocity.length()));
    assert!(fastest > 1.0, "{fastest}");
    // After 20 s panels are where the turn has brought them: each about the axis of all.
    let axis = run.places("panel");
    assert!(axis.iter().all(|place| (*place - DVec3::new(0.0, 3.0, 0.0)).length() < 1e-5), "{axis:?}");
}

#[test]
fn a_pile_comes_to_rest_on_the_ground() {
    let mut run = Run::of("pile", Some(150));
    run.until(12.0);
    let places = run.places("body");
    // The thinnest planks are 0.05 m thick, half of it.
    assert!(smallest(places.iter().map(|place| place.y)) > 0.045);
    // It is a heap: some lie on others.
    assert!(largest(places.iter().map(|place| place.y)) > 0.5);
    // Not at rest to the digit, for balls creep; but nothing is as fast as what has fallen by a
    // tenth of a millimetre.
    let fastest = largest(run.velocities("body").iter().map(|velocity| velocity.length()));
    assert!(fastest < (2.0 * 9.81 * 1e-4_f64).sqrt(), "{fastest}");
}

/// Hills are 0.9 m high: half of what falls on them is in hollows then, and nothing has gone
/// through.
#[test]
fn what_falls_on_hills_gathers_in_hollows() {
    let mut run = Run::of("hills", None);
    run.finish();
    let places = run.places("body");
    assert!(largest(places.iter().map(|place| place.x.abs().max(place.z.abs()))) < 6.0, "nothing rolls over the rim");
    assert!(smallest(places.iter().map(|place| place.y)) > 0.05);
    let low = places.iter().filter(|place| place.y < 0.45).count();
    assert!(2 * low > places.len(), "{low} of {}", places.len());
}

#[test]
fn the_pins_fall() {
    let mut run = Run::of("bowling", None);
    run.until(0.25);
    assert!(smallest(run.uprights("pin")) > 0.9999, "they stand until the ball comes");
    run.finish();
    let fallen = run.uprights("pin").iter().filter(|upright| **upright < 0.7).count();
    assert!(fallen >= 8, "{fallen}");
    assert!(smallest(run.places("pin").iter().map(|place| place.y)) > 0.04);
}

/// The largest overlap of balls that peers show at this size of a step is 0.03 m.
#[test]
fn spheres_fill_the_box() {
    let mut run = Run::of("spheres", Some(972));
    run.finish();
    let places = run.places("ball");
    assert!(smallest(places.iter().map(|place| place.y)) > 0.47);
    assert!(largest(places.iter().map(|place| place.x.abs().max(place.z.abs()))) < 9.53);
    let mut nearest = f64::INFINITY;
    for (index, one) in places.iter().enumerate() {
        nearest = places[..index].iter().map(|other| (*one - *other).length()).fold(nearest, f64::min);
    }
    assert!(nearest > 0.97, "{nearest}");
    assert!(largest(run.velocities("ball").iter().map(|velocity| velocity.length())) < 0.2);
}

/// When a body came into a sensor, or left it \[s\].
struct Crossing {
    sensor: String,
    body: String,
    begins: bool,
    time: f64,
}

impl Run {
    fn crossings(&self) -> Vec<Crossing> {
        let name = |entity| self.names.of(self.order.entities().iter().position(|it| *it == entity).unwrap() as u64);
        let crossing = |event: tumble::SensorEvent| {
            let [sensor, body] = [event.sensor, event.body].map(|it| name(it).into_owned());
            Crossing { sensor, body, begins: event.begins, time: self.simulation.time() }
        };
        self.simulation.sensor_events().map(crossing).collect()
    }
}

#[test]
fn the_firing_range_holds_its_shots_and_counts_its_parcels() {
    let mut run = Run::of("firing-range", None);
    let mut crossings = Vec::new();
    let start = run.places("figure")[0];
    for step in 1..=run.steps {
        run.simulation.step(&mut run.world);
        crossings.extend(run.crossings());
        let shot = run.places("shot")[0];
        assert!(shot.x > -8.5 && shot.x < 6.0 && shot.y > 0.04, "the shot is at {shot} after step {step}");
        if step == 2 {
            // One is back from the sheet, the other is past its edge as if that were not there.
            let [back, on] = ["shot", "miss"].map(|name| run.velocities(name)[0]);
            assert!((back.x + 120.0).abs() < 1.2, "{back}");
            assert!((on - DVec3::new(600.0, -9.81 / 30.0, 0.0)).length() < 1e-3, "{on}");
        }
        assert!(smallest(run.uprights("figure")) > 1.0 - 1e-6, "the figure tips in step {step}");
    }
    assert!(run.places("figure")[0].x < start.x - 0.1, "the figure was not pushed");
    let of = |sensor: &str, body: &str| -> Vec<(bool, f64)> {
        let both = crossings.iter().filter(|it| it.sensor == sensor && it.body == body);
        both.map(|it| (it.begins, it.time)).collect()
    };
    // Through the curtain and back in two steps, in and out each time.
    assert_eq!(of("curtain", "shot").iter().take(4).map(|it| it.0).collect::<Vec<_>>(), [true, false, true, false]);
    assert_eq!(of("curtain", "miss").iter().map(|it| it.0).collect::<Vec<_>>(), [true, false]);
    // Friction brings a parcel to 1 m/s in 1 / (0.6 g), and half of that time is lost.
    let late = 0.5 / (0.6 * 9.81);
    for (parcel, (from, half)) in [(1.0, 0.2), (0.0, 0.15), (-1.0, 0.2), (-2.0, 0.25)].into_iter().enumerate() {
        let passage = of("light-barrier", &format!("parcel-{parcel}"));
        let expected = [(true, 1.99 - from - half + late), (false, 2.01 - from + half + late)];
        assert_eq!(passage.len(), 2, "parcel {parcel}");
        for (found, expected) in passage.iter().zip(expected) {
            assert!(
                found.0 == expected.0 && (found.1 - expected.1).abs() < 0.03,
                "parcel {parcel}: {found:?}, {expected:?}"
            );
        }
    }
}
