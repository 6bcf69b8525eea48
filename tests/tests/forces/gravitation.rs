//! Promise: bodies with a `GravityMass` attract each other as the sum over all pairs says, momentum
//! kept to rounding, nothing becomes NaN where bodies meet; an orbit in the field of a point or of
//! another body keeps energy, angular momentum and its ellipse for a thousand periods without
//! trend, and turns by an angle that is measured and falls with the square of the step.
//!
//! Why: a planet that spirals away is the mark of a bad integrator, and one whose ellipse shrinks
//! by a wrong sum looks the same. It fails if a pair is left out or counted twice where tiles are
//! filled up, if the kicks of a step do not have the same sources, or if the step loses its
//! symmetry in time.

use std::f64::consts::TAU;

use glam::DVec3;
use hecs::{Entity, World};
use tumble::Integrator::{self, MoserVeselov, SemiImplicitEuler};
use tumble::math::{Real, Vec3};
use tumble::{
    BodyOrder, GravityMass, Momentum, PointGravity, Pose, RigidBody, Rng, Shape, Simulation, Totals, Velocity,
};
use tumble_tests::{DOUBLE, EPSILON, by_precision, dvec3, run, seconds, weightless};

use crate::nets;
use nets::fit;

fn point(mass: f64, position: Vec3, velocity: Vec3) -> RigidBody {
    RigidBody::new(Shape::Point).mass(mass).position(position).linear_velocity(velocity)
}

fn spawn(world: &mut World, body: RigidBody, gravity: GravityMass) -> Entity {
    let entity = body.build().unwrap().spawn(world);
    world.insert_one(entity, gravity).unwrap();
    entity
}

fn totals(world: &World, simulation: &Simulation) -> Totals {
    Totals::of(world, simulation.settings(), &BodyOrder::of(world))
}

/// `count` bodies at rest within 10 m; of every seven one is a test particle, of every five one is
/// softened.
fn cloud(count: u64, seed: u64) -> World {
    let mut rng = Rng::new(seed);
    let mut world = World::new();
    for i in 0..count {
        let mass = rng.range(0.5, 2.0);
        let gravity = GravityMass {
            mu: if i % 7 == 3 { 0.0 } else { 10.0 * mass },
            softening: if i % 5 == 1 { 0.5 } else { 0.0 },
        };
        spawn(&mut world, point(mass.into(), rng.vector(-10.0, 10.0), Vec3::ZERO), gravity);
    }
    world
}

/// Place, kilograms, mu and softening of each.
fn sources(world: &World) -> Vec<(Entity, DVec3, f64, GravityMass)> {
    let mut query = world.query::<(Entity, &Pose, &tumble::Mass, &GravityMass)>();
    query.iter().map(|(entity, pose, mass, g)| (entity, dvec3(pose.position), mass.kilograms().into(), *g)).collect()
}

/// The acceleration that all give one, and the sum of its parts' sizes, in double precision.
fn direct(sources: &[(Entity, DVec3, f64, GravityMass)], body: usize) -> (DVec3, f64) {
    let (_, x, _, own) = sources[body];
    let (mut sum, mut sizes) = (DVec3::ZERO, 0.0);
    for (i, (_, y, _, g)) in sources.iter().enumerate() {
        if i != body {
            let softening = f64::from(own.softening).powi(2) + f64::from(g.softening).powi(2);
            let part = (*y - x) * f64::from(g.mu) / ((*y - x).length_squared() + softening).powf(1.5);
            sum += part;
            sizes += part.length();
        }
    }
    (sum, sizes)
}

/// Against the direct sum, with as many bodies as leave tiles of every width and parts of every
/// size to fill up.
#[test]
fn every_pair_attracts() {
    for count in (1..40).chain([63, 64, 65, 200, 1000]) {
        let mut world = cloud(count, count);
        let before = sources(&world);
        weightless(SemiImplicitEuler, 1.0 / 128.0).step(&mut world);
        for (i, &(entity, _, mass, _)) in before.iter().enumerate() {
            let (exact, sizes) = direct(&before, i);
            let found = dvec3(world.get::<&Momentum>(entity).unwrap().linear) / mass * 128.0;
            // The difference of places is rounded as these are, and the sum once a part: a walk at
            // random.
            let nearest = before.iter().enumerate().filter(|(j, _)| *j != i);
            let nearest = nearest.map(|(_, other)| other.1.distance(before[i].1)).fold(f64::INFINITY, f64::min);
            let allowed = EPSILON * sizes * (8.0 + 10.0 / nearest.max(0.5) + (count as f64).sqrt());
            assert!((found - exact).length() <= allowed, "{count}, {i}: {found} for {exact}");
        }
    }
}

/// Test particles feel the others and are not felt; a body without the component neither attracts
/// nor is attracted; a fixed one attracts.
#[test]
fn who_attracts_whom() {
    let mut world = World::new();
    let sun = spawn(&mut world, RigidBody::new(Shape::sphere(1.0)).without_collider().fixed(), GravityMass::new(8.0));
    let probe = spawn(&mut world, point(3.0, Vec3::X * 2.0, Vec3::ZERO), GravityMass::new(0.0));
    let other = spawn(&mut world, point(1.0, Vec3::X * -2.0, Vec3::ZERO), GravityMass::new(0.0));
    let stranger = point(1.0, Vec3::Y, Vec3::ZERO).build().unwrap().spawn(&mut world);
    let drawn = spawn(
        &mut world,
        RigidBody::new(Shape::sphere(1.0)).without_collider().kinematic().position(Vec3::Y),
        GravityMass::new(0.0),
    );
    weightless(SemiImplicitEuler, 0.125).step(&mut world);
    let impulse = |body| world.get::<&Momentum>(body).unwrap().linear;
    assert_eq!(impulse(probe), Vec3::X * -(3.0 * 2.0 * 0.125));
    assert_eq!(impulse(other), Vec3::X * (2.0 * 0.125));
    assert_eq!(impulse(stranger), Vec3::ZERO);
    assert_eq!(world.get::<&Pose>(sun).unwrap().position, Vec3::ZERO);
    assert_eq!(world.get::<&Pose>(drawn).unwrap().position, Vec3::Y);
}

/// Where mu is in proportion to mass. Each kick rounds each momentum, at random.
#[test]
fn momentum_is_kept() {
    for integrator in Integrator::ALL {
        let mut rng = Rng::new(5);
        let mut world = World::new();
        for _ in 0..100 {
            let mass = rng.range(0.5, 2.0);
            let body = point(mass.into(), rng.vector(-5.0, 5.0), rng.vector(-1.0, 1.0));
            spawn(&mut world, body, GravityMass { mu: mass * 0.05, softening: 0.1 });
        }
        let mut simulation = weightless(integrator, 0.01);
        let start = totals(&world, &simulation);
        let scale: f64 = world.query::<&Momentum>().iter().map(|m| dvec3(m.linear).length()).sum();
        run(&mut simulation, &mut world, 500);
        let end = totals(&world, &simulation);
        let rounding = 1000.0_f64.sqrt() * EPSILON * scale;
        let linear = (end.linear_momentum - start.linear_momentum).length();
        let angular = (end.angular_momentum - start.angular_momentum).length();
        println!(
            "{integrator}: {linear:.1e}, {angular:.1e} of {scale:.1e}; energy {:.1e}",
            end.energy() / start.energy() - 1.0
        );
        assert!(linear <= rounding, "{integrator}: {linear:e} of {rounding:e}");
        // Ten metres away, and the place is rounded too.
        assert!(angular <= 20.0 * rounding, "{integrator}: {angular:e} of {rounding:e}");
    }
}

/// Bodies in one place do nothing to each other, with softening or without; with it, those that are
/// near do not either.
#[test]
fn bodies_that_meet_stay_finite() {
    for (softening, distances) in [(0.0, vec![0.0]), (0.1, vec![0.0, 1e-30, 1e-21, 1e-12, 1e-3])] {
        for distance in distances {
            let mut world = World::new();
            let place = |x: f64| Vec3::X * x as Real;
            for x in [0.0, distance, 0.0] {
                spawn(&mut world, point(1.0, place(x), Vec3::ZERO), GravityMass { mu: 1.0, softening });
            }
            let far = spawn(&mut world, point(1.0, place(4.0), Vec3::ZERO), GravityMass { mu: 1.0, softening });
            let mut simulation = weightless(MoserVeselov, 1e-3);
            simulation.step(&mut world);
            let finite = world.query::<&Momentum>().iter().all(|momentum| momentum.linear.is_finite());
            assert!(finite, "{softening}, {distance:e}");
            assert!(totals(&world, &simulation).energy().is_finite());
            // Three pull it from four metres.
            let pull = f64::from(world.get::<&Momentum>(far).unwrap().linear.x);
            assert!((pull / -(3.0 / 16.0 * 1e-3) - 1.0).abs() < 2e-3, "{softening}, {distance:e}: {pull:e}");
        }
    }
}

/// The force is minus the slope of the energy that `Totals::of` has: of all where mu is in
/// proportion to mass; of a test particle among them too.
#[test]
fn the_force_is_the_slope_of_the_energy() {
    for test_particles in [false, true] {
        force_is_slope(test_particles);
    }
}

fn force_is_slope(test_particles: bool) {
    let mut world = World::new();
    let mut rng = Rng::new(3);
    for i in 0..12 {
        let mass = rng.range(0.5, 2.0);
        let gravity = GravityMass { mu: if test_particles && i % 3 == 0 { 0.0 } else { 10.0 * mass }, softening: 0.3 };
        spawn(&mut world, point(mass.into(), rng.vector(-3.0, 3.0), Vec3::ZERO), gravity);
    }
    let simulation = weightless(SemiImplicitEuler, 0.125);
    let before = sources(&world);
    // One that attracts test particles has energy with them, and feels nothing.
    let wanted = |mu: Real| !test_particles || mu == 0.0;
    for (i, &(entity, place, mass, _)) in before.iter().enumerate().filter(|(_, body)| wanted(body.3.mu)) {
        let (acceleration, sizes) = direct(&before, i);
        let start = *world.get::<&Pose>(entity).unwrap();
        let energy_at = |pose: Pose| {
            *world.get::<&mut Pose>(entity).unwrap() = pose;
            totals(&world, &simulation).force_potential
        };
        let d = by_precision(1e-3, 1e-4);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let (there, back) = (nets::shifted(&start, axis * d), nets::shifted(&start, axis * -d));
            let slope = (energy_at(there) - energy_at(back)) / nets::shift(&back, &there).dot(axis);
            // The third derivative is 15 mu/r^4, here at half a metre and more, times d^2/6; the
            // sum is in double precision.
            let allowed = mass * sizes * (40.0 * d * d + by_precision(1e-4, 1e-9));
            assert!((slope + mass * acceleration.dot(axis)).abs() <= allowed, "{i} at {place}: {slope}");
        }
        energy_at(start);
    }
}

/// An ellipse about a point: semi-major axis 1, `mu = 1`, so a period is `2 pi`.
struct Orbit {
    world: World,
    planet: Entity,
    simulation: Simulation,
}

impl Orbit {
    fn new(eccentricity: f64, steps_a_period: u32) -> Self {
        let farthest = 1.0 + eccentricity;
        let slowest = ((1.0 - eccentricity) / farthest).sqrt();
        let mut world = World::new();
        let planet = point(1.0, Vec3::X * farthest as Real, Vec3::Y * slowest as Real);
        let planet = planet.build().unwrap().spawn(&mut world);
        world.insert_one(planet, PointGravity { mu: 1.0, ..PointGravity::default() }).unwrap();
        let simulation = weightless(MoserVeselov, (TAU / f64::from(steps_a_period)) as Real);
        Self { world, planet, simulation }
    }

    fn elements(&self) -> Elements {
        let position = dvec3(self.world.get::<&Pose>(self.planet).unwrap().position);
        Elements::of(position, dvec3(self.world.get::<&Velocity>(self.planet).unwrap().linear))
    }
}

/// What of an orbit stays.
#[derive(Clone, Copy)]
struct Elements {
    energy: f64,
    angular_momentum: f64,
    semi_major_axis: f64,
    eccentricity: f64,
    /// Direction of the pericentre \[rad\].
    pericentre: f64,
}

impl Elements {
    fn of(x: DVec3, v: DVec3) -> Self {
        let energy = 0.5 * v.length_squared() - 1.0 / x.length();
        let l = x.cross(v);
        let runge_lenz = v.cross(l) - x / x.length();
        Self {
            energy,
            angular_momentum: l.z,
            semi_major_axis: -0.5 / energy,
            eccentricity: runge_lenz.length(),
            // It begins in the apocentre on the x axis.
            pericentre: (-runge_lenz.y).atan2(-runge_lenz.x),
        }
    }
}

/// The angle by which the ellipse turns in a period \[rad\], by the line through the pericentre
/// over this many periods.
fn precession(steps_a_period: u32, periods: u32) -> f64 {
    let mut orbit = Orbit::new(0.6, steps_a_period);
    let (mut samples, mut turns, mut last) = (Vec::new(), 0.0, 0.0);
    for period in 0..=periods {
        let pericentre = orbit.elements().pericentre;
        turns += if pericentre - last > 0.5 * TAU {
            -TAU
        } else if pericentre - last < -0.5 * TAU {
            TAU
        } else {
            0.0
        };
        last = pericentre;
        samples.push((f64::from(period), pericentre + turns));
        orbit.simulation.step_many(&mut orbit.world, steps_a_period);
    }
    fit(&samples).slope
}

/// Twice the steps, a quarter of the precession: to the next term, which is some (2 pi * 4/250)^2,
/// a per cent, of it; in single precision to what roundings turn the ellipse by too.
#[test]
fn the_ellipse_turns_by_the_square_of_the_step() {
    let found = [250, 500, 1000].map(|steps| precession(steps, 20));
    println!("precession at 250, 500, 1000 steps a period, e = 0.6: {found:.6?} rad a period");
    let ratios = [found[0] / found[1], found[1] / found[2]];
    println!("ratios {ratios:.4?}");
    for (ratio, tolerance) in ratios.into_iter().zip([0.02, by_precision(0.04, 0.005)]) {
        assert!((ratio / 4.0 - 1.0).abs() <= tolerance, "{ratio}");
    }
}

/// An ellipse of eccentricity 0.6 for a thousand periods of 500 steps: taken every 487 steps, so at
/// all phases, energy and angular momentum have no trend, and the ellipse keeps its size
/// and shape. In single precision roundings walk, as far as `EPSILON` times the root of half a
/// million steps.
#[test]
fn an_ellipse_is_kept_for_a_thousand_periods() {
    let mut orbit = Orbit::new(0.6, 500);
    let start = orbit.elements();
    let mut elements = Vec::new();
    for _ in 0..1000 * 500 / 487 {
        orbit.simulation.step_many(&mut orbit.world, 487);
        elements.push((orbit.simulation.time(), orbit.elements()));
    }
    let time = orbit.simulation.time();
    let walk = 4.0 * 5e5_f64.sqrt() * EPSILON;
    type Element = fn(&Elements) -> f64;
    let kept: [(&str, Element, f64); 4] = [
        ("energy", |e| e.energy, 5e-3),
        ("angular momentum", |e| e.angular_momentum, 1e-9),
        ("semi-major axis", |e| e.semi_major_axis, 5e-3),
        ("eccentricity", |e| e.eccentricity, 5e-3),
    ];
    for (name, element, spread) in kept {
        let line = fit(&elements.iter().map(|(time, e)| (*time, element(e))).collect::<Vec<_>>());
        let over_run = line.slope * time / line.mean;
        let error = line.error * time / line.mean.abs();
        println!(
            "{name}: {:.9} from {:.9}, spread {:.1e}, over the run {over_run:.1e} +- {error:.1e}",
            line.mean,
            element(&start),
            line.spread
        );
        // Angular momentum is kept to rounding, and so has no spread to see a trend against.
        let rounding = if DOUBLE && name != "angular momentum" { 0.0 } else { walk };
        assert!(over_run.abs() <= 3.0 * error + rounding, "{name}: {over_run:e} +- {error:e}");
        // What comes and goes with the phase is (w dt)^2 with the w of the pericentre, 8 rad/s:
        // 1e-2 of it there and less elsewhere.
        assert!(line.spread <= (spread + walk) * line.mean.abs(), "{name}: {:e}", line.spread);
    }
}

/// The same of two bodies that attract each other, a million steps: energy without trend, momentum
/// too.
#[test]
fn two_bodies_keep_their_energy() {
    let mut world = World::new();
    // 3 and 1 kg, G = 1/4, so that together mu = 1; relative to each other the ellipse of
    // eccentricity 0.5.
    let (far, slow) = (1.5, (0.5_f64 / 1.5).sqrt());
    for (mass, share) in [(3.0, -0.25), (1.0, 0.75)] {
        let body = point(mass, Vec3::X * (far * share) as Real, Vec3::Y * (slow * share) as Real);
        spawn(&mut world, body, GravityMass::new((0.25 * mass) as Real));
    }
    let mut simulation = weightless(MoserVeselov, (TAU / 300.0) as Real);
    let mut samples = Vec::new();
    let start = totals(&world, &simulation);
    for _ in 0..1003 {
        simulation.step_many(&mut world, 997);
        samples.push((simulation.time(), totals(&world, &simulation).energy()));
    }
    let line = fit(&samples);
    let time = simulation.time();
    let (over_run, error) = (line.slope * time / line.mean, line.error * time / line.mean.abs());
    println!("energy {:.6} J, spread {:.1e}, over the run {over_run:.1e} +- {error:.1e}", line.mean, line.spread);
    let rounding = if DOUBLE { 0.0 } else { 4.0 * 1e6_f64.sqrt() * EPSILON };
    assert!(over_run.abs() <= 3.0 * error + rounding, "{over_run:e} +- {error:e}");
    let end = totals(&world, &simulation);
    assert!((end.linear_momentum - start.linear_momentum).length() <= 4.0 * 1e6_f64.sqrt() * EPSILON);
    let turned = (end.angular_momentum - start.angular_momentum).length() / start.angular_momentum.length();
    assert!(turned <= 4.0 * 1e6_f64.sqrt() * EPSILON, "{turned:e}");
    assert!(seconds(simulation.settings().dt) > 0.0);
}
