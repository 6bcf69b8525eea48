//! Promise: queries say what the world is now: the same as asking each body by itself, whatever was
//! spawned, moved, changed or despawned since they were last asked, in whatever order and archetype
//! bodies are, on any number of threads.
//!
//! Why: an answer about where things were a step ago lets shots pass through what was just put in
//! their way. It fails if a change is overlooked, a body is left out by the tree, or of two equally
//! near the one is found that was spawned first.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{PartHit, PointHit, Queries, QueryFilter, QueryIndex, Ray, RayHit, ShapeHit};
use tumble_tests::touching::collider;
use tumble_tests::{Draw, cases, dvec3, quat, real, vec3};

const ALL: QueryFilter<'static> = QueryFilter::ALL;
const EVERYWHERE: [Vec3; 2] = [Vec3::NEG_INFINITY, Vec3::INFINITY];

fn solid(draw: &mut Draw) -> Shape {
    let [a, b, c] = [(); 3].map(|()| draw.log_between(0.02, 3.0));
    match draw.between(0.0, 7.0) as u32 {
        0 => Shape::sphere(a),
        1 => Shape::cuboid([a, b, c]),
        2 => Shape::Capsule { radius: a, half_height: b },
        3 => Shape::Cylinder { radius: a, half_height: b },
        4 => Shape::Cone { radius: a, half_height: b },
        5 => Shape::ellipsoid([a, b, c]),
        _ => Shape::tapered_capsule(a, b, c),
    }
}

/// Any collider but a half-space, at times away from its body.
fn any_collider(draw: &mut Draw) -> Collider {
    let made = match draw.between(0.0, 10.0) as u32 {
        0 => {
            let heights: Vec<f64> = (0..20).map(|_| draw.between(0.0, 1.0)).collect();
            Collider::height_field(&heights, 5, [0.7, 0.6]).unwrap()
        }
        1 => {
            let corners = [(); 6].map(|()| draw.vector(2.0));
            Collider::mesh(corners, &[[0, 1, 2], [2, 3, 4], [1, 4, 5]]).unwrap()
        }
        2 => Collider::convex_hull([(); 9].map(|()| draw.vector(1.5))).unwrap(),
        3 => {
            let parts = [(); 3].map(|()| {
                let place = Pose { position: vec3(draw.vector(2.0)), orientation: quat(draw.orientation()) };
                let groups = if draw.often(0.5) { (1, !0) } else { (2, !0) };
                collider(&solid(draw)).with_offset(place).unwrap().with_groups(groups.0, groups.1)
            });
            Collider::compound(parts).unwrap()
        }
        _ => collider(&solid(draw)),
    };
    let made = if draw.often(0.3) { made.with_groups(1 << (draw.between(0.0, 3.0) as u32), !0) } else { made };
    if draw.often(0.3) {
        let place = Pose { position: vec3(draw.vector(1.0)), orientation: quat(draw.orientation()) };
        return made.with_offset(place).unwrap();
    }
    made
}

/// A component that changes nothing but the archetype.
struct Marked;

/// Spawns a body of any kind with a collider.
fn spawn_any(world: &mut World, draw: &mut Draw, id: Option<u64>, spread: f64) -> Entity {
    let mut body = RigidBody::new(Shape::sphere(0.5)).mass(1.0);
    body = match draw.between(0.0, 4.0) as u32 {
        0 => body.fixed(),
        1 => body.kinematic(),
        2 => body.center_of_mass(draw.vector(0.5)),
        _ => body,
    };
    body = body.position(vec3(draw.vector(spread))).orientation(quat(draw.orientation()));
    if let Some(id) = id {
        body = body.id(BodyId(id));
    }
    let entity = body.build().unwrap().spawn_with(world, (any_collider(draw),));
    if draw.often(0.2) {
        world.insert_one(entity, Marked).unwrap();
    }
    entity
}

/// What is asked, always in the same way.
#[derive(Clone, Debug)]
struct Questions {
    rays: Vec<Ray>,
    points: Vec<Vec3>,
    shapes: Vec<(Collider, Pose, Vec3)>,
}

impl Questions {
    fn draw(draw: &mut Draw, spread: f64) -> Self {
        let rays = (0..12)
            .map(|_| {
                let (from, to) = (vec3(draw.vector(1.5 * spread)), vec3(draw.vector(spread)));
                if draw.often(0.5) { Ray::between(from, to) } else { Ray::new(from, to - from) }
            })
            .collect();
        let points = (0..6).map(|_| vec3(draw.vector(spread))).collect();
        let shapes = (0..6).map(|_| {
            let at = Pose { position: vec3(draw.vector(spread)), orientation: quat(draw.orientation()) };
            (collider(&solid(draw)), at, vec3(draw.vector(spread)))
        });
        Self { rays, points, shapes: shapes.collect() }
    }

    fn answers(&self, queries: &Queries<'_>, filter: &QueryFilter<'_>) -> Answers {
        Answers {
            rays: self.rays.iter().map(|ray| queries.cast_ray(ray, filter)).collect(),
            through: self.rays.iter().map(|ray| queries.cast_ray_through(ray, filter)).collect(),
            blocked: self.rays.iter().map(|ray| queries.is_blocked(ray, filter)).collect(),
            nearest: self.points.iter().map(|point| queries.nearest(*point, 3.0, filter)).collect(),
            containing: self.points.iter().map(|point| queries.containing(*point, filter)).collect(),
            casts: self.shapes.iter().map(|(shape, at, way)| queries.cast_shape(shape, at, *way, filter)).collect(),
            overlaps: self.shapes.iter().map(|(shape, at, _)| queries.overlapping(shape, at, filter)).collect(),
            boxes: (self.points.iter().map(|at| [*at - Vec3::ONE, *at + Vec3::ONE]).chain([EVERYWHERE]))
                .map(|[low, high]| queries.in_box(low, high, filter))
                .collect(),
        }
    }
}

#[derive(Debug, PartialEq)]
struct Answers {
    rays: Vec<Option<RayHit>>,
    through: Vec<Vec<RayHit>>,
    blocked: Vec<bool>,
    nearest: Vec<Option<PointHit>>,
    containing: Vec<Vec<PartHit>>,
    casts: Vec<Option<ShapeHit>>,
    overlaps: Vec<Vec<PartHit>>,
    boxes: Vec<Vec<Entity>>,
}

/// One body of a world, by itself in another, with the entity that it has in the first.
fn alone(world: &World, entity: Entity) -> World {
    let mut other = World::new();
    let (pose, shape) = (*world.get::<&Pose>(entity).unwrap(), (*world.get::<&Collider>(entity).unwrap()).clone());
    other.spawn_at(entity, (pose, shape));
    if let Ok(center) = world.get::<&CenterOfMass>(entity) {
        other.insert_one(entity, *center).unwrap();
    }
    if let Ok(id) = world.get::<&BodyId>(entity) {
        other.insert_one(entity, *id).unwrap();
    }
    if world.satisfies::<&Momentum>(entity) {
        other.insert_one(entity, Momentum::default()).unwrap();
    } else if world.satisfies::<&Velocity>(entity) {
        other.insert_one(entity, Velocity::default()).unwrap();
    }
    other
}

/// The answers to a ray are those of each body by itself, in order; returns how many bodies it
/// meets.
fn rays_agree(together: &Answers, each: &[Answers], i: usize, rank: impl Fn(Entity) -> usize) -> usize {
    let first = each.iter().filter_map(|it| it.rays[i]).reduce(|a, b| if b.distance < a.distance { b } else { a });
    assert_eq!(together.rays[i], first);
    let mut all: Vec<RayHit> = each.iter().flat_map(|it| it.through[i].clone()).collect();
    all.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(rank(a.entity).cmp(&rank(b.entity))));
    assert_eq!(together.through[i].len(), all.len());
    assert!(together.through[i].iter().zip(&all).all(|(a, b)| a.distance == b.distance));
    assert_eq!(together.through[i].first().map(|hit| hit.distance), first.map(|hit| hit.distance));
    assert_eq!(together.blocked[i], first.is_some());
    all.len()
}

/// All answers are made of those that each body gives by itself.
#[test]
fn all_bodies_together_are_each_by_itself() {
    let mut found = [0; 8];
    for case in 0..60 {
        let mut draw = Draw::new(2301, case);
        let mut world = World::new();
        let spread = draw.log_between(1.0, 30.0);
        let count = draw.between(1.0, 60.0) as u64;
        let bodies: Vec<Entity> = (0..count)
            .map(|_| {
                let id = draw.often(0.5).then(|| draw.between(0.0, 1e9) as u64);
                spawn_any(&mut world, &mut draw, id, spread)
            })
            .collect();
        let filter = match case % 4 {
            0 => QueryFilter::new().with_groups(!0, 1),
            1 => QueryFilter::new().without(bodies[0]).without_fixed(),
            2 => QueryFilter::new().without_all(&bodies[..bodies.len() / 2]).without_kinematic(),
            _ => QueryFilter::new(),
        };
        let order = tumble::BodyOrder::of(&world);
        let rank = |entity: Entity| order.entities().iter().position(|other| *other == entity).unwrap();
        let questions = Questions::draw(&mut draw, spread);
        let together = questions.answers(&Queries::of(&world), &filter);
        let each: Vec<Answers> = order
            .entities()
            .iter()
            .map(|entity| questions.answers(&Queries::of(&alone(&world, *entity)), &filter))
            .collect();
        for i in 0..questions.rays.len() {
            let all = rays_agree(&together, &each, i, rank);
            found[0] += usize::from(all > 0);
            found[1] += usize::from(all > 1);
        }
        for i in 0..questions.points.len() {
            let first =
                each.iter().filter_map(|it| it.nearest[i]).reduce(|a, b| if b.distance < a.distance { b } else { a });
            assert_eq!(together.nearest[i], first, "case {case}");
            let containing: Vec<PartHit> = each.iter().flat_map(|it| it.containing[i].clone()).collect();
            assert_eq!(together.containing[i], containing, "case {case}");
            let boxes: Vec<Entity> = each.iter().flat_map(|it| it.boxes[i].clone()).collect();
            assert_eq!(together.boxes[i], boxes, "case {case}");
            found[2] += usize::from(first.is_some());
            found[3] += containing.len();
            found[4] += boxes.len();
        }
        for i in 0..questions.shapes.len() {
            let first =
                each.iter().filter_map(|it| it.casts[i]).reduce(|a, b| if b.distance < a.distance { b } else { a });
            assert_eq!(together.casts[i], first, "case {case}");
            let overlaps: Vec<PartHit> = each.iter().flat_map(|it| it.overlaps[i].clone()).collect();
            assert_eq!(together.overlaps[i], overlaps, "case {case}");
            found[5] += usize::from(first.is_some());
            found[6] += overlaps.len();
        }
        found[7] += bodies.len();
    }
    // The class is drawn as meant: all kinds of answers are there.
    assert!(found.iter().all(|count| *count > 20), "{found:?}");
}

/// One of the changes, 5 to 12, that decide where a body is or who it is.
fn change(world: &mut World, body: Entity, event: u32, draw: &mut Draw) {
    match event {
        5 => world.get::<&mut Pose>(body).unwrap().position += vec3(draw.vector(2.0)),
        6 => world.get::<&mut Pose>(body).unwrap().orientation = quat(draw.orientation()),
        7 => *world.get::<&mut Collider>(body).unwrap() = any_collider(draw),
        8 => world.insert_one(body, CenterOfMass(vec3(draw.vector(0.3)))).unwrap(),
        9 => drop(world.remove_one::<CenterOfMass>(body)),
        10 => drop(world.remove_one::<Momentum>(body)),
        11 => drop(world.remove_one::<BodyId>(body)),
        _ => world.insert_one(body, BodyId(draw.between(0.0, 3.0) as u64)).unwrap(),
    }
}

/// Whatever happens between two questions, a simulation answers as if it had never been asked.
#[test]
fn answers_are_never_stale() {
    for case in 0..u64::from(cases(20)) {
        let mut draw = Draw::new(2302, case);
        let (mut world, mut bodies) = (World::new(), Vec::new());
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        let mut index = QueryIndex::default();
        let spread = 8.0;
        for round in 0..40 {
            for _ in 0..draw.between(0.0, 4.0) as u32 {
                let event = draw.between(0.0, 13.0) as u32;
                if event < 3 || bodies.is_empty() {
                    let count = if draw.often(0.1) { 100 } else { 2 };
                    for _ in 0..count {
                        bodies.push(spawn_any(&mut world, &mut draw, None, spread));
                    }
                    continue;
                }
                let place = draw.between(0.0, bodies.len() as f64) as usize;
                let body = bodies[place];
                match event {
                    3 => world.despawn(bodies.swap_remove(place)).unwrap(),
                    4 => {
                        // Another entity of the same number, place and collider.
                        let (pose, shape) =
                            (*world.get::<&Pose>(body).unwrap(), (*world.get::<&Collider>(body).unwrap()).clone());
                        world.despawn(body).unwrap();
                        bodies[place] = world.spawn((pose, shape));
                    }
                    _ => change(&mut world, body, event, &mut draw),
                }
            }
            if round % 3 == 0 {
                simulation.step(&mut world);
            }
            let questions = Questions::draw(&mut draw, spread);
            let filter = if round % 2 == 0 { ALL } else { ALL.without_dynamic() };
            let expected = questions.answers(&Queries::of(&world), &filter);
            assert_eq!(questions.answers(&simulation.queries(&world), &filter), expected, "case {case}, round {round}");
            assert_eq!(questions.answers(&index.queries(&world), &filter), expected, "case {case}, round {round}");
        }
        // Another world, of which it knows nothing.
        let mut other = World::new();
        spawn_any(&mut other, &mut draw, None, 1.0);
        let questions = Questions::draw(&mut draw, 2.0);
        assert_eq!(questions.answers(&simulation.queries(&other), &ALL), questions.answers(&Queries::of(&other), &ALL));
    }
}

/// Bodies in other archetypes, spawned in another order: the same ids in every answer.
#[test]
fn answers_depend_on_no_order() {
    for case in 0..20 {
        let world_of = |order: &[u64], marked: bool| {
            let mut world = World::new();
            for id in order {
                let mut draw = Draw::new(case, *id);
                // Several in each place: which is first is said by the ids.
                let mut twin = Draw::new(case, id / 3);
                let entity = spawn_any(&mut world, &mut twin, Some(*id), 6.0);
                if marked && draw.often(0.5) {
                    world.insert_one(entity, 7_u64).unwrap();
                }
            }
            world
        };
        let order: Vec<u64> = (0..40).collect();
        let backward: Vec<u64> = order.iter().rev().copied().collect();
        let questions = Questions::draw(&mut Draw::new(2303, case), 6.0);
        let ids = |world: &World| {
            let id = |entity: Entity| world.get::<&BodyId>(entity).unwrap().0;
            let answers = questions.answers(&Queries::of(world), &ALL);
            let rays: Vec<_> = answers.rays.iter().map(|hit| hit.map(|hit| (id(hit.entity), hit.distance))).collect();
            let through: Vec<Vec<_>> =
                answers.through.iter().map(|all| all.iter().map(|hit| id(hit.entity)).collect()).collect();
            let nearest: Vec<_> =
                answers.nearest.iter().map(|hit| hit.map(|hit| (id(hit.entity), hit.point))).collect();
            let overlaps: Vec<Vec<_>> =
                answers.overlaps.iter().map(|all| all.iter().map(|hit| (id(hit.entity), hit.part)).collect()).collect();
            let casts: Vec<_> = answers.casts.iter().map(|hit| hit.map(|hit| (id(hit.entity), hit.distance))).collect();
            (rays, through, nearest, overlaps, casts)
        };
        let expected = ids(&world_of(&order, false));
        assert_eq!(ids(&world_of(&backward, false)), expected, "case {case}");
        assert_eq!(ids(&world_of(&backward, true)), expected, "case {case}");
        // Of three in one place the first is met.
        assert!(expected.0.iter().flatten().all(|(id, _)| id % 3 == 0), "case {case}");
    }
}

/// Many rays are each ray, on any number of threads and asked from several.
#[test]
fn many_rays_are_each_by_itself_on_any_number_of_threads() {
    let mut draw = Draw::new(2304, 0);
    let mut world = World::new();
    for id in 0..500 {
        spawn_any(&mut world, &mut draw, Some(id), 20.0);
    }
    let rays: Vec<Ray> = (0..3000).map(|_| Ray::new(vec3(draw.vector(30.0)), vec3(draw.direction()))).collect();
    let simulation = Simulation::new(Settings::default()).unwrap();
    let queries = simulation.queries(&world);
    let expected: Vec<Option<RayHit>> = rays.iter().map(|ray| queries.cast_ray(ray, &ALL)).collect();
    assert!(expected.iter().flatten().count() > 100);
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| queries.cast_rays(&rays, &ALL)), expected);
    }
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| assert_eq!(simulation.queries(&world).cast_rays(&rays, &ALL), expected));
        }
    });
}

/// A ball far from the origin is where its numbers say, to 1e-5 of its size, a hundred metres away.
#[test]
fn far_from_the_origin_answers_are_as_good() {
    for case in 0..2000 {
        let mut draw = Draw::new(2305, case);
        let radius = draw.log_between(0.01, 100.0);
        let far = draw.log_between(1.0, 1e5);
        let mut world = World::new();
        let place = vec3(draw.vector(far));
        let body =
            RigidBody::new(Shape::sphere(radius)).mass(1.0).position(place).orientation(quat(draw.orientation()));
        body.build().unwrap().spawn_with(&mut world, (collider(&Shape::sphere(radius)),));
        let origin = place + vec3(draw.direction() * 100.0 * radius);
        // Aimed near the edge.
        let (center, from) = (dvec3(place), dvec3(origin));
        let to_center = (center - from).normalize();
        let side = to_center.cross(draw.direction()).normalize();
        let off = radius * draw.between(0.9, 1.1);
        let ray = Ray::new(origin, vec3(center + side * off - from));
        // The closed form, of the numbers that the ball and the ray have.
        let radius = f64::from(real(radius));
        let direction = dvec3(ray.direction).normalize();
        let along = (center - from).dot(direction);
        let across = (center - from - direction * along).length();
        let hit = Queries::of(&world).cast_ray(&ray, &ALL);
        if (across - radius).abs() < 1e-9 * far.max(1.0) {
            continue;
        }
        assert_eq!(hit.is_some(), across < radius, "case {case}: {across} of {radius}");
        if let Some(hit) = hit {
            let expected = along - ((radius - across) * (radius + across)).sqrt();
            // Distances have the precision of the build.
            let rounding = f64::from(Real::EPSILON) * expected;
            assert!((f64::from(hit.distance) - expected).abs() <= 1e-7 * radius + rounding, "case {case}");
        }
    }
}

/// Pairs that are in contact after a step are those that overlap, to rounding and margins.
#[test]
fn what_a_step_says_to_touch_is_what_overlaps() {
    let mut world = World::new();
    let mut draw = Draw::new(2306, 0);
    RigidBody::new(Shape::Point).fixed().build().unwrap().spawn_with(&mut world, (Collider::half_space(),));
    for i in 0..60 {
        let shape = solid(&mut draw);
        let place =
            Vec3::new(real(draw.between(-2.0, 2.0)), real(3.0 + 0.5 * f64::from(i)), real(draw.between(-2.0, 2.0)));
        let body = RigidBody::new(shape.clone()).density(1000.0).position(place).orientation(quat(draw.orientation()));
        body.build().unwrap().spawn_with(&mut world, (collider(&shape),));
    }
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    let mut deep = 0;
    for _ in 0..4 {
        simulation.step(&mut world);
        // Poses of now, and contacts of now: a step with no time to speak of.
        let mut probe = Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(1e-6)).unwrap();
        let queries = simulation.queries(&world);
        let overlaps = |a: Entity, b: Entity| {
            let (shape, mut frame) = ((*world.get::<&Collider>(a).unwrap()).clone(), *world.get::<&Pose>(a).unwrap());
            if let Ok(center) = world.get::<&CenterOfMass>(a) {
                frame.position -= frame.orientation * center.0;
            }
            queries.overlapping(&shape, &frame, &ALL).iter().any(|hit| hit.entity == b)
        };
        let mut after = World::new();
        for (entity, pose, shape) in world.query::<(Entity, &Pose, &Collider)>().iter() {
            after.spawn_at(entity, (*pose, shape.clone()));
        }
        for (entity, mass) in world.query::<(Entity, &Mass)>().iter() {
            after.insert(entity, (Momentum::default(), *mass, Velocity::default(), Wrench::default())).unwrap();
        }
        for (entity, center) in world.query::<(Entity, &CenterOfMass)>().iter() {
            after.insert_one(entity, *center).unwrap();
        }
        probe.step(&mut after);
        for contact in probe.contacts() {
            let least = contact.points().iter().map(|point| point.separation).fold(Real::INFINITY, Real::min);
            let [a, b] = contact.bodies;
            if least < -1e-4 {
                deep += 1;
                assert!(overlaps(a, b), "{a:?} and {b:?} are {least} m deep");
            } else if least > 1e-4 {
                assert!(!overlaps(a, b), "{a:?} and {b:?} are {least} m apart");
            }
        }
    }
    assert!(deep > 5, "{deep}");
}

/// Numbers that are none find nothing, and nothing panics.
#[test]
fn impossible_numbers_find_nothing() {
    let mut world = World::new();
    let ball = RigidBody::new(Shape::sphere(1.0)).mass(1.0).build().unwrap();
    let body = ball.spawn_with(&mut world, (collider(&Shape::sphere(1.0)),));
    let queries = Queries::of(&world);
    for bad in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY] {
        assert_eq!(queries.cast_ray(&Ray::new(Vec3::X * bad, Vec3::X), &ALL), None);
        assert_eq!(queries.cast_ray(&Ray::new(Vec3::ZERO, Vec3::splat(bad)), &ALL), None);
        assert_eq!(queries.nearest(Vec3::Y * bad, 1e9, &ALL), None);
        assert!(queries.containing(Vec3::Y * bad, &ALL).is_empty());
        let nowhere = Pose { position: Vec3::Z * bad, ..Pose::default() };
        assert!(queries.overlapping(&collider(&Shape::sphere(1.0)), &nowhere, &ALL).is_empty());
        assert_eq!(queries.cast_shape(&collider(&Shape::sphere(1.0)), &nowhere, Vec3::X, &ALL), None);
        assert_eq!(queries.cast_shape(&collider(&Shape::sphere(1.0)), &Pose::default(), Vec3::X * bad, &ALL), None);
    }
    assert_eq!(queries.cast_ray(&Ray::new(Vec3::ZERO, Vec3::ZERO), &ALL), None);
    assert_eq!(queries.cast_ray(&Ray::new(Vec3::X * 5.0, Vec3::X).with_max_distance(Real::NAN), &ALL), None);
    assert_eq!(queries.nearest(Vec3::X * 3.0, Real::NAN, &ALL), None);
    assert!(queries.in_box(Vec3::splat(Real::NAN), Vec3::ONE, &ALL).is_empty());
    let overlap = Pose { orientation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Pose::default() };
    assert!(queries.overlapping(&collider(&Shape::sphere(1.0)), &overlap, &ALL).is_empty());
    drop(queries);
    for broken in [Vec3::splat(Real::NAN), Vec3::X * 1e12] {
        world.get::<&mut Pose>(body).unwrap().position = broken;
        let queries = Queries::of(&world);
        assert_eq!(queries.cast_ray(&Ray::new(Vec3::X * 5.0, -Vec3::X), &ALL), None);
        assert_eq!(queries.nearest(Vec3::ZERO, Real::INFINITY, &ALL), None);
    }
}
