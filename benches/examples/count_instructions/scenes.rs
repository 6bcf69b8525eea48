//! The scenes whose instructions are counted, and how they are stepped.

use hecs::World;
use tumble::math::Vec3;
use tumble::{Batch, Ledger, QueryFilter, Settings, Simulation, Trial, simd_name};
use tumble_benches::{
    HillBodies, HillGround, JointKind, arm, attracting_points, chain, eight_boxes, falling_balls, hills,
    net_of_springs, pyramid, ragdolls, rays_through_boxes, scattered_boxes, tumbling_boxes,
};

use crate::Failure;

/// Of free bodies: whole tiles, in whole chunks.
pub(crate) const BODIES: u32 = 4096;
/// Where bodies act on each other: a name, how many they are, and after how many steps counting
/// begins.
pub(crate) const COUPLED: [(&str, u32, u32); 17] = [
    ("springs", 1024, 5),
    ("attraction", 256, 5),
    ("pyramid", 204, 5),
    ("balls", 1000, 90),
    ("worlds", WORLDS * 8, 60),
    ("chain", JOINTS * SUBSTEPS, 5),
    ("hinges", JOINTS * SUBSTEPS, 5),
    ("arms", ARMS * HINGES * SUBSTEPS, 30),
    ("rays", RAYS, 1),
    ("unmoved", UNMOVED, 1),
    ("hill-boxes", ON_HILLS, 40),
    ("hill-balls", ON_HILLS, 40),
    ("hill-capsules", ON_HILLS, 40),
    ("mesh-hills", ON_HILLS, 40),
    ("ragdolls", RAGDOLLS * 23, 30),
    ("ledger", 512, 5),
    (ONE_BODY, ONE_BODY_STEPS, 5),
];
/// Bodies on hills: of a height field, or all kinds on a mesh.
const ON_HILLS: u32 = 64;
/// Rays of a hundred metres among ten thousand boxes.
const RAYS: u32 = 256;
/// Bodies of which queries find out that none has moved.
const UNMOVED: u32 = 10_000;
/// A world of one free body, and how many of its steps count as one: a single one would be little
/// beside what else the program does.
const ONE_BODY: &str = "one-body";
const ONE_BODY_STEPS: u32 = 1000;
/// Of 23 capsules.
const RAGDOLLS: u32 = 2;
/// In a chain.
const JOINTS: u32 = 100;
/// Arms in a batch, and the joints of each.
const ARMS: u32 = 16;
const HINGES: u32 = 7;
/// In a step: with joints, what is counted is per joint and substep.
const SUBSTEPS: u32 = 4;
/// Of eight boxes.
const WORLDS: u32 = 16;
/// Steps of free bodies before counting begins.
pub(crate) const SHORT: u32 = 5;

/// Steps a scene in a pool of this many threads, of which this is one, and says with which vector
/// code.
pub(crate) fn step(scene: &str, steps: u32, threads: usize) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).use_current_thread().build()?;
    pool.install(|| match scene {
        "worlds" => step_worlds(WORLDS, steps, |index| eight_boxes(index.into())),
        "arms" => step_worlds(ARMS, steps, |_| arm(HINGES as usize)),
        "rays" | "unmoved" => ask(scene == "rays", steps),
        _ => step_world(scene, steps),
    })?;
    println!("{}", simd_name());
    Ok(())
}

fn step_world(scene: &str, steps: u32) -> Result<(), Failure> {
    let settings = Settings::default();
    let count = COUPLED.iter().find(|(name, ..)| *name == scene).map_or(BODIES, |(_, count, _)| *count);
    let (mut world, settings) = match scene {
        "springs" => (net_of_springs(count.isqrt() as usize), settings),
        "attraction" => (attracting_points(count as usize), settings.with_gravity(Vec3::ZERO).with_dt(1e-3)),
        "pyramid" => (pyramid(8), settings),
        "large-pyramid" => (pyramid(20), settings),
        "balls" => (falling_balls(count as usize), settings),
        "chain" => (chain(JOINTS as usize, JointKind::Ball), settings.with_contact_substeps(SUBSTEPS)),
        "hinges" => (chain(JOINTS as usize, JointKind::Hinge), settings.with_contact_substeps(SUBSTEPS)),
        "hill-boxes" => (hills(count as usize, HillBodies::Boxes, HillGround::HeightField), settings),
        "hill-balls" => (hills(count as usize, HillBodies::Balls, HillGround::HeightField), settings),
        "hill-capsules" => (hills(count as usize, HillBodies::Capsules, HillGround::HeightField), settings),
        "mesh-hills" => (hills(count as usize, HillBodies::Mixed, HillGround::Mesh), settings),
        "ragdolls" => (ragdolls(RAGDOLLS as usize), settings),
        "heap" => (ragdolls(160), settings),
        "ledger" => (tumbling_boxes(count as usize), settings),
        ONE_BODY => (tumbling_boxes(1), settings),
        integrator => (tumbling_boxes(count as usize), settings.with_integrator(integrator.parse()?)),
    };
    let mut simulation = Simulation::new(settings)?;
    if scene == "ledger" {
        Ledger::attach(&mut world, &simulation);
    }
    let times = if scene == ONE_BODY { ONE_BODY_STEPS } else { 1 };
    (0..steps * times).for_each(|_| simulation.step(&mut world));
    Ok(())
}

fn step_worlds(count: u32, steps: u32, world: impl Fn(u32) -> World) -> Result<(), Failure> {
    let made = |index: u32| Trial::new(Settings::default().with_contact_substeps(SUBSTEPS), world(index));
    (0..count).map(made).collect::<Result<Batch, _>>()?.step_many(steps);
    Ok(())
}

/// Brings queries up to date, and casts rays in them or not.
fn ask(is_cast: bool, times: u32) -> Result<(), Failure> {
    let simulation = Simulation::new(Settings::default())?;
    let world = scattered_boxes(UNMOVED as usize);
    let rays = rays_through_boxes(RAYS as usize);
    let mut queries = simulation.queries(&world);
    for _ in 0..times {
        if is_cast {
            std::hint::black_box(queries.cast_rays(&rays, &QueryFilter::ALL));
        } else {
            queries = simulation.queries(&world);
        }
    }
    Ok(())
}
