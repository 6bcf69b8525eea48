//! What forces cost: boxes that carry one kind of force component each, under every integrator;
//! springs between bodies; gravity among all of them.
//!
//! `cargo bench --bench forces`. The first group is to be read against its own `none`: a step
//! without forces. `law` is a force law of the caller's that is evaluated body by body, the same
//! spring as `lane law`, which is evaluated for many at once. How near gravity among bodies comes
//! to what the machine can do is printed by `cargo bench --bench roofline`.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::{Entity, World};
use tumble::lane::Lane;
use tumble::prelude::*;
use tumble::{SimdBody, SimdForceLaw, SimdWrench};
use tumble_benches::{OnDemand, attracting_points, label, net_of_springs, pools, tumbling_boxes};

const BODIES: usize = 10_000;

/// A spring to the origin.
#[derive(Clone, Copy)]
struct Tether(Real);

/// The same law, written for one body at a time.
struct OneByOne(Tether);

impl ForceLaw for OneByOne {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: state.position * -self.0.0, torque: Vec3::ZERO }
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }
}

impl SimdForceLaw<1> for Tether {
    fn numbers(&self) -> [Real; 1] {
        [self.0]
    }

    #[inline(always)]
    fn wrench<L: Lane>([stiffness]: [L; 1], body: &SimdBody<L>) -> SimdWrench<L> {
        SimdWrench::force(body.position * -stiffness)
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }
}

/// Gives a body what a bench is about.
type Equip = fn(&mut World, Entity) -> Result<(), hecs::NoSuchEntity>;

const KINDS: [(&str, Equip); 14] = [
    ("none", |_, _| Ok(())),
    ("law", |world, body| world.insert_one(body, OneByOne(Tether(0.1)))),
    ("lane law", |world, body| world.insert_one(body, Tether(0.1))),
    ("GravityScale", |world, body| world.insert_one(body, GravityScale(0.5))),
    ("Damping", |world, body| world.insert_one(body, Damping { linear: 0.1, angular: 0.1 })),
    ("Drag", |world, body| world.insert_one(body, Drag::isotropic(0.1))),
    ("Magnus", |world, body| world.insert_one(body, Magnus { coefficient: 0.1 })),
    ("Thruster", |world, body| world.insert_one(body, Thruster::new(Vec3::X, Vec3::Y))),
    ("ConstantWrench", |world, body| world.insert_one(body, ConstantWrench { force: Vec3::X, ..Default::default() })),
    ("SpringToPoint", |world, body| {
        world.insert_one(body, SpringToPoint { attachment: Vec3::Y, stiffness: 10.0, ..Default::default() })
    }),
    ("SpringToPoint, damped", |world, body| {
        let spring = SpringToPoint { attachment: Vec3::Y, stiffness: 10.0, damping: 0.1, ..Default::default() };
        world.insert_one(body, spring)
    }),
    ("PointGravity", |world, body| world.insert_one(body, PointGravity { mu: 1.0, ..Default::default() })),
    ("Buoyancy", |world, body| world.insert_one(body, Buoyancy::new(Hull::Cuboid { half_extents: Vec3::ONE }))),
    ("AngularVelocityServo", |world, body| {
        world.insert_one(body, AngularVelocityServo { target: Vec3::X, frame: Frame::World, max_torque: 1.0 })
    }),
];

fn components(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("force components");
    group.throughput(Throughput::Elements(BODIES as u64));
    let pools = pools();
    for (kind, equip) in KINDS {
        for integrator in Integrator::ALL {
            // Gone back to before every bench: bodies that Euler's method has spun up take longer.
            let mut world = OnDemand::new(|| equipped_boxes(equip));
            let Ok(mut simulation) = Simulation::new(Settings::default().with_integrator(integrator)) else { return };
            simulation.add_law::<OneByOne>();
            simulation.add_simd_law::<Tether, 1>();
            for pool in &pools {
                group.bench_function(BenchmarkId::new(kind, format!("{integrator}/{}", label(pool))), |bencher| {
                    let world = world.get();
                    pool.install(|| bencher.iter(|| simulation.step(world)));
                });
            }
        }
    }
}

/// Boxes that all carry the same.
fn equipped_boxes(equip: Equip) -> World {
    let mut world = tumbling_boxes(BODIES);
    let boxes: Vec<Entity> = world.iter().map(|entity| entity.entity()).collect();
    for body in boxes {
        assert!(equip(&mut world, body).is_ok());
    }
    world
}

/// A net of square meshes, of points: two springs a body.
fn springs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("springs in a net");
    let pools = pools();
    for side in [10_usize, 32, 100] {
        let mut world = OnDemand::new(|| net_of_springs(side));
        let Ok(mut simulation) = Simulation::new(Settings::default()) else { return };
        group.throughput(Throughput::Elements((2 * side * (side - 1)) as u64));
        for pool in &pools {
            group.bench_function(BenchmarkId::new(label(pool), side * side), |bencher| {
                let world = world.get();
                pool.install(|| bencher.iter(|| simulation.step(world)));
            });
        }
    }
}

/// A cloud in which every body pulls at every other; an element is the pull of one body on one.
fn gravity(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("gravity among bodies");
    group.sample_size(10);
    let pools = pools();
    for count in [16_usize, 256, 1024, 4096] {
        let mut world = OnDemand::new(|| attracting_points(count));
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(1e-3);
        let Ok(mut simulation) = Simulation::new(settings) else { return };
        group.throughput(Throughput::Elements((count * count) as u64));
        for pool in &pools {
            group.bench_function(BenchmarkId::new(label(pool), count), |bencher| {
                let world = world.get();
                pool.install(|| bencher.iter(|| simulation.step(world)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = components, springs, gravity
}
criterion_main!(benches);
