//! Promise: a body with impossible numbers, in its state, what acts on it and its springs, spoils
//! nothing but itself: all others stay finite, and where they do not touch or pull it, keep the
//! bits that they have without it. What is out of range is refused where it is given, by name.
//!
//! Why: components are public, and one division by zero in a game must not take the whole world
//! along. It fails if a number that is none, or a square that overflows, gets from one body to
//! another through a contact, a spring or gravity.

use hecs::{Entity, World};
use proptest::prelude::*;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{BodyError, BodyOrder, ColliderError, InverseInertia, Rng, SettingsError, Work};
use tumble_tests::run;
use tumble_tests::touching::{collider, cube, ground, pose, spawn};

const BODIES: u64 = 24;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Poisoned {
    Position,
    Orientation,
    LinearMomentum,
    AngularMomentum,
    Force,
    Torque,
    GravityScale,
    LinearDamping,
    AngularDamping,
    // From here on what is not the state, nor what acts on it alone.
    KinematicVelocity,
    CenterOfMass,
    Derived,
    Softening,
    Mu,
    Stiffness,
    SpringDamping,
    RestLength,
    Attachment,
    SpringForce,
    Constant,
}

const ALL: [Poisoned; 20] = [
    Poisoned::Position,
    Poisoned::Orientation,
    Poisoned::LinearMomentum,
    Poisoned::AngularMomentum,
    Poisoned::Force,
    Poisoned::Torque,
    Poisoned::GravityScale,
    Poisoned::LinearDamping,
    Poisoned::AngularDamping,
    Poisoned::KinematicVelocity,
    Poisoned::CenterOfMass,
    Poisoned::Derived,
    Poisoned::Softening,
    Poisoned::Mu,
    Poisoned::Stiffness,
    Poisoned::SpringDamping,
    Poisoned::RestLength,
    Poisoned::Attachment,
    Poisoned::SpringForce,
    Poisoned::Constant,
];

/// No number, and numbers out of range; then such as are only odd.
const VALUES: [Real; 9] =
    [Real::NAN, Real::INFINITY, Real::NEG_INFINITY, Real::MAX, -1e30, 1e20, Real::MIN_POSITIVE, -1.0, 0.0];
const OUT_OF_RANGE: usize = 6;

/// What is the same with the poisoned body and without.
fn scene(seed: u64) -> (World, Vec<Entity>) {
    let mut rng = Rng::new(seed);
    let mut world = World::new();
    ground(&mut world, Material::new(0.5, 0.3), Quat::IDENTITY);
    let bodies: Vec<Entity> = (0..BODIES).map(|id| body(&mut world, &mut rng, id)).collect();
    if seed.is_multiple_of(3) {
        for pair in bodies.windows(2) {
            world.spawn((Spring::between(pair[0], pair[1]).with_stiffness(20.0).with_damping(0.5),));
        }
    }
    (world, bodies)
}

fn body(world: &mut World, rng: &mut Rng, id: u64) -> Entity {
    let shape = match rng.next_u64() % 4 {
        0 => Shape::sphere(0.2),
        1 => cube(0.15),
        2 => Shape::cylinder(0.15, 0.1),
        _ => Shape::capsule(0.1, 0.1),
    };
    let body = RigidBody::new(shape.clone()).without_collider().mass(1.0).id(BodyId(id)).orientation(rng.orientation());
    let body = body.position(Vec3::Y * 0.5 + rng.vector(-0.5, 0.5)).linear_velocity(rng.vector(-2.0, 2.0));
    let surface = Material::new(0.4, 0.5);
    spawn(world, body, collider(&shape).with_material(surface).unwrap())
}

/// Puts a value into a component of a body.
fn poison(world: &mut World, victim: Entity, others: &[Entity], what: Poisoned, value: Real, axis: usize) {
    let mut vector = Vec3::ZERO;
    vector[axis] = value;
    let spring = Spring::between(victim, others[0]).with_stiffness(10.0).with_damping(1.0);
    match what {
        Poisoned::Position => world.get::<&mut Pose>(victim).unwrap().position[axis] = value,
        Poisoned::Orientation => {
            let mut turned = world.get::<&Pose>(victim).unwrap().orientation.to_array();
            turned[axis] = value;
            world.get::<&mut Pose>(victim).unwrap().orientation = Quat::from_array(turned);
        }
        Poisoned::LinearMomentum => world.get::<&mut Momentum>(victim).unwrap().linear[axis] = value,
        Poisoned::AngularMomentum => world.get::<&mut Momentum>(victim).unwrap().angular[axis] = value,
        Poisoned::Force => world.get::<&mut Wrench>(victim).unwrap().force = vector,
        Poisoned::Torque => world.get::<&mut Wrench>(victim).unwrap().torque = vector,
        Poisoned::GravityScale => world.insert_one(victim, tumble::GravityScale(value)).unwrap(),
        Poisoned::LinearDamping => world.insert_one(victim, Damping { linear: value, angular: 0.1 }).unwrap(),
        Poisoned::AngularDamping => world.insert_one(victim, Damping { linear: 0.1, angular: value }).unwrap(),
        Poisoned::KinematicVelocity => {
            world.remove_one::<Momentum>(victim).unwrap();
            world.get::<&mut Velocity>(victim).unwrap().linear = vector;
            world.get::<&mut Velocity>(victim).unwrap().angular = vector;
        }
        Poisoned::CenterOfMass => world.insert_one(victim, tumble::CenterOfMass(vector)).unwrap(),
        Poisoned::Derived => {
            world.get::<&mut Velocity>(victim).unwrap().linear = vector;
            let _ = world.get::<&mut InverseInertia>(victim).map(|mut it| it.diagonal = vector);
        }
        Poisoned::Softening => {
            others.iter().for_each(|other| world.insert_one(*other, GravityMass::new(0.1)).unwrap());
            world.insert_one(victim, GravityMass { mu: 0.1, softening: value }).unwrap();
        }
        Poisoned::Mu => {
            others.iter().for_each(|other| world.insert_one(*other, GravityMass::new(0.1)).unwrap());
            world.insert_one(victim, GravityMass { mu: value, softening: 0.0 }).unwrap();
        }
        Poisoned::Stiffness => drop(world.spawn((spring.with_stiffness(value),))),
        Poisoned::SpringDamping => drop(world.spawn((spring.with_damping(value),))),
        Poisoned::RestLength => drop(world.spawn((spring.with_rest_length(value),))),
        Poisoned::Attachment => drop(world.spawn((spring.attached_at(vector, vector),))),
        Poisoned::SpringForce => {
            world.spawn((spring,));
            world.get::<&mut Momentum>(victim).unwrap().linear[axis] = value;
        }
        Poisoned::Constant => {
            world.insert_one(victim, ConstantWrench { force: vector, ..ConstantWrench::default() }).unwrap();
        }
    }
}

/// All that a body is.
fn state(world: &World, entity: Entity) -> (Pose, Momentum, Velocity) {
    let momentum = *world.get::<&Momentum>(entity).unwrap();
    (pose(world, entity), momentum, *world.get::<&Velocity>(entity).unwrap())
}

fn is_finite((pose, momentum, velocity): &(Pose, Momentum, Velocity)) -> bool {
    let vectors = [pose.position, momentum.linear, momentum.angular, velocity.linear, velocity.angular];
    vectors.iter().all(|it| it.is_finite()) && pose.orientation.is_finite()
}

/// After some steps; a body is poisoned after a few of them, if any is.
fn end(seed: u64, poisoned: Option<(Poisoned, Real, u32)>) -> Vec<(Pose, Momentum, Velocity)> {
    let (mut world, bodies) = scene(seed);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    if let Some((what, value, before)) = poisoned {
        let victim = body(&mut world, &mut Rng::new(seed ^ 9), BODIES);
        run(&mut simulation, &mut world, before);
        poison(&mut world, victim, &bodies, what, value, seed as usize % 3);
        run(&mut simulation, &mut world, 40 - before);
    } else {
        run(&mut simulation, &mut world, 40);
    }
    bodies.into_iter().map(|body| state(&world, body)).collect()
}

/// A component of a body with one number of it poisoned, or all of a vector; what is not poisoned
/// is as a game would have it.
type Component = (&'static str, fn(&mut World, Entity, Bad));

#[derive(Clone, Copy, Debug)]
struct Bad {
    value: Real,
    /// Which number of those that the component has, counted around.
    which: usize,
}

impl Bad {
    fn vector(self, else_of: Vec3) -> Vec3 {
        let mut vector = else_of;
        match self.which % 4 {
            3 => vector = Vec3::splat(self.value),
            axis => vector[axis] = self.value,
        }
        vector
    }

    fn quat(self) -> Quat {
        let mut numbers = Quat::IDENTITY.to_array();
        numbers[self.which % 4] = self.value;
        Quat::from_array(numbers)
    }

    /// The first of two, three, ... numbers or the next ones.
    fn number<const N: usize>(self, else_of: [Real; N]) -> [Real; N] {
        let mut numbers = else_of;
        numbers[self.which % N] = self.value;
        numbers
    }
}

fn put<C: hecs::Component>(world: &mut World, victim: Entity, component: C) {
    world.insert_one(victim, component).unwrap();
}

/// Of which some are tried.
const HUGE: [Real; 8] =
    [Real::INFINITY, Real::NEG_INFINITY, Real::MAX, -Real::MAX, 1e30, -1e20, Real::MIN_POSITIVE, 0.0];

/// All components with public numbers, and all laws.
const COMPONENTS: &[Component] = &[
    ("Pose", |world, victim, bad| {
        let pose = *world.get::<&Pose>(victim).unwrap();
        let poisoned = match bad.which % 2 {
            0 => Pose { position: bad.vector(pose.position), ..pose },
            _ => Pose { orientation: bad.quat(), ..pose },
        };
        put(world, victim, poisoned);
    }),
    ("PreviousPose", |world, victim, bad| {
        put(world, victim, PreviousPose(Pose { position: bad.vector(Vec3::ZERO), orientation: bad.quat() }));
    }),
    ("Momentum", |world, victim, bad| {
        let Momentum { linear, angular } = *world.get::<&Momentum>(victim).unwrap();
        let poisoned = match bad.which % 2 {
            0 => Momentum { linear: bad.vector(linear), angular },
            _ => Momentum { linear, angular: bad.vector(angular) },
        };
        put(world, victim, poisoned);
    }),
    ("Velocity", |world, victim, bad| {
        put(world, victim, Velocity { linear: bad.vector(Vec3::ZERO), angular: bad.vector(Vec3::ZERO) });
    }),
    ("InverseInertia", |world, victim, bad| {
        let [diagonal, off_diagonal] = [bad.vector(Vec3::ONE), bad.vector(Vec3::ZERO)];
        put(world, victim, InverseInertia { diagonal, off_diagonal });
    }),
    ("PrincipalAxes", |world, victim, bad| put(world, victim, PrincipalAxes(bad.quat()))),
    ("CenterOfMass", |world, victim, bad| put(world, victim, CenterOfMass(bad.vector(Vec3::ZERO)))),
    ("Wrench", |world, victim, bad| {
        let [force, torque] = match bad.which % 2 {
            0 => [bad.vector(Vec3::X), Vec3::ZERO],
            _ => [Vec3::ZERO, bad.vector(Vec3::X)],
        };
        put(world, victim, Wrench { force, torque });
    }),
    ("Damping", |world, victim, bad| {
        let [linear, angular] = bad.number([0.1, 0.1]);
        put(world, victim, Damping { linear, angular });
    }),
    ("GravityScale", |world, victim, bad| put(world, victim, GravityScale(bad.value))),
    ("Work", |world, victim, bad| {
        put(world, victim, Work { gravity: f64::from(bad.value), contacts: f64::from(bad.value), ..Work::default() });
    }),
    ("Wind", |world, victim, bad| {
        put(world, victim, Drag { linear: Vec3::ONE, angular: Vec3::ZERO });
        put(world, victim, Wind(bad.vector(Vec3::ZERO)));
    }),
    ("Drag", |world, victim, bad| {
        let [linear, angular] = match bad.which % 2 {
            0 => [bad.vector(Vec3::ONE), Vec3::ZERO],
            _ => [Vec3::ZERO, bad.vector(Vec3::ONE)],
        };
        put(world, victim, Drag { linear, angular });
    }),
    ("Magnus", |world, victim, bad| put(world, victim, Magnus { coefficient: bad.value })),
    ("Thruster", |world, victim, bad| {
        let [throttle] = if bad.which % 3 == 2 { bad.number([1.0]) } else { [1.0] };
        let force = if bad.which.is_multiple_of(3) { bad.vector(Vec3::X) } else { Vec3::X };
        let torque = if bad.which % 3 == 1 { bad.vector(Vec3::X) } else { Vec3::ZERO };
        put(world, victim, Thruster { force, torque, throttle });
    }),
    ("ConstantWrench", |world, victim, bad| {
        let frame = if bad.which.is_multiple_of(2) { Frame::World } else { Frame::Body };
        put(world, victim, ConstantWrench { force: Vec3::ZERO, torque: bad.vector(Vec3::ZERO), frame });
        if bad.which >= 4 {
            put(world, victim, ConstantWrench { force: bad.vector(Vec3::ZERO), torque: Vec3::ZERO, frame });
        }
    }),
    ("SpringToPoint", |world, victim, bad| {
        let [rest_length, stiffness, damping] = bad.number([0.1, 10.0, 0.5]);
        let anchor = if bad.which == 3 { bad.vector(Vec3::Y) } else { Vec3::Y };
        let attachment = if bad.which == 4 { bad.vector(Vec3::ZERO) } else { Vec3::ZERO };
        put(world, victim, SpringToPoint { anchor, attachment, rest_length, stiffness, damping });
    }),
    ("PointGravity", |world, victim, bad| {
        let [mu, softening] = bad.number([0.1, 0.1]);
        let center = if bad.which > 4 { bad.vector(Vec3::ZERO) } else { Vec3::ZERO };
        put(world, victim, PointGravity { center, mu, softening });
    }),
    ("Buoyancy", |world, victim, bad| {
        let [density, level, radius] = bad.number([1000.0, 1.0, 0.2]);
        let center = if bad.which == 5 { bad.vector(Vec3::ZERO) } else { Vec3::ZERO };
        put(world, victim, Buoyancy { density, level, hull: Hull::Sphere { radius }, center });
    }),
    ("AngularVelocityServo", |world, victim, bad| {
        let [max_torque] = if bad.which.is_multiple_of(2) { bad.number([1.0]) } else { [1.0] };
        let target = if bad.which % 2 == 1 { bad.vector(Vec3::Y) } else { Vec3::Y };
        put(world, victim, AngularVelocityServo { target, frame: Frame::World, max_torque });
    }),
    ("GravityMass", |world, victim, bad| {
        let [mu, softening] = bad.number([0.1, 0.1]);
        put(world, victim, GravityMass { mu, softening });
    }),
    ("Spring", |world, victim, bad| {
        let other = BodyOrder::of(world).entities()[0];
        let [rest_length, stiffness, damping] = bad.number([0.1, 10.0, 0.5]);
        let attachment = if bad.which > 4 { bad.vector(Vec3::ZERO) } else { Vec3::ZERO };
        let spring = Spring::between(victim, other)
            .with_rest_length(rest_length)
            .with_stiffness(stiffness)
            .with_damping(damping);
        world.spawn((spring.attached_at(attachment, Vec3::ZERO),));
    }),
];

/// The others after some steps in which a body among them, or as far off, has components with bad
/// numbers from the start.
fn end_with(seed: u64, far: Real, poison: impl FnOnce(&mut World, Entity)) -> Vec<(Pose, Momentum, Velocity)> {
    let (mut world, bodies) = scene(seed);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let victim = body(&mut world, &mut Rng::new(seed ^ 9), BODIES);
    world.get::<&mut Pose>(victim).unwrap().position += Vec3::X * far;
    poison(&mut world, victim);
    run(&mut simulation, &mut world, 30);
    bodies.into_iter().map(|body| state(&world, body)).collect()
}

/// Every law of the engine is among them.
#[test]
fn no_component_is_left_out() {
    let names: Vec<&str> = COMPONENTS.iter().map(|(name, _)| *name).collect();
    for law in tumble::ForceLaws::COMPONENTS {
        assert!(names.contains(&law), "{law}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    /// What is no number in a body that touches nobody changes no bit of anybody. In one that lies
    /// among others it either counts for nothing, and they go on as beside a healthy body, or takes
    /// its body out of the world; what laws make of their other numbers is left aside.
    #[test]
    fn no_number_of_any_component_reaches_others(
        seed in any::<u64>(), which in 0_usize..12, values in prop::sample::subsequence(HUGE.to_vec(), 2),
    ) {
        let without = end_with(seed, 0.0, |world, victim| world.despawn(victim).unwrap());
        let healthy = end_with(seed, 0.0, |_, _| {});
        for (name, poison) in COMPONENTS {
            let with = |far, value| end_with(seed, far, |world, victim| poison(world, victim, Bad { value, which }));
            let is_law = tumble::ForceLaws::COMPONENTS.contains(name) || ["Damping", "Wind"].contains(name);
            // Springs draw their body to the others by what their other numbers say, and so may a
            // law with an infinite number.
            let is_spring = name.starts_with("Spring");
            prop_assert!(is_spring || with(200.0, Real::NAN) == without, "{} NaN, far away", name);
            prop_assert!(is_law || with(200.0, Real::INFINITY) == without, "{} inf, far away", name);
            let others = with(0.0, Real::NAN);
            prop_assert!(others.iter().all(is_finite), "{} NaN", name);
            prop_assert!(is_law || others == without || others == healthy, "{} NaN has touched others", name);
            for value in values.clone() {
                prop_assert!(with(0.0, value).iter().all(is_finite), "{} {}", name, value);
            }
        }
    }

    /// Several at once, among them such as need each other.
    #[test]
    fn nor_do_several(seed in any::<u64>(), bad in prop::collection::vec((0..COMPONENTS.len(), 0..VALUES.len(), 0_usize..12), 2..5)) {
        let others = end_with(seed, 0.0, |world, victim| {
            for (component, value, which) in &bad {
                COMPONENTS[*component].1(world, victim, Bad { value: VALUES[*value], which: *which });
            }
        });
        let names: Vec<_> = bad.iter().map(|(component, value, _)| (COMPONENTS[*component].0, VALUES[*value])).collect();
        prop_assert!(others.iter().all(is_finite), "{:?}", names);
    }
}

// Each case is hundreds of runs.
proptest! {
    #![proptest_config(ProptestConfig::with_cases(1))]

    #[test]
    fn others_do_not_notice(seed in any::<u64>(), before in 0_u32..20) {
        let without = end(seed, None);
        for what in ALL {
            for (index, value) in VALUES.into_iter().enumerate() {
                for before in [0, before] {
                    let others = end(seed, Some((what, value, before)));
                    prop_assert!(others.iter().all(is_finite), "{:?} {} after {}", what, value, before);
                    // What pushes on a body alone is out of range where its mass is about one.
                    // Damping is not among it: it is clamped.
                    let apart = ALL[..7].contains(&what) && index < OUT_OF_RANGE && before == 0;
                    // A step makes a unit quaternion of what has a direction, and then the body is
                    // as others.
                    let healed = what == Poisoned::Orientation && !value.is_nan();
                    if apart && !healed {
                        prop_assert!(others == without, "{:?} {} has touched others", what, value);
                    }
                }
            }
        }
    }
}

/// Masses and moments at the ends of what can be given.
#[test]
fn extreme_bodies_touch_nothing_that_they_could_spoil() {
    for seed in 0..6 {
        for exponent in [-37, -30, -20, -10, 10, 20, 30, 37] {
            for of_moments in [false, true] {
                let (mut world, bodies) = scene(seed);
                let amount = 10_f64.powi(exponent);
                let shape = cube(0.2);
                let start = RigidBody::new(shape.clone()).without_collider().position(Vec3::Y * 0.6);
                let start = if of_moments {
                    let moments = tumble::InertiaTensor::from_principal([amount; 3], Default::default()).unwrap();
                    start.mass(1.0).inertia(moments)
                } else {
                    start.mass(amount)
                };
                // Some are refused, in single precision.
                let Ok(body) = start.build() else { continue };
                body.spawn_with(&mut world, (collider(&shape),));
                let mut simulation = Simulation::new(Settings::default()).unwrap();
                run(&mut simulation, &mut world, 40);
                let finite = bodies.iter().all(|body| is_finite(&state(&world, *body)));
                assert!(finite, "1e{exponent}, of moments: {of_moments}");
            }
        }
    }
}

#[test]
fn what_is_out_of_range_is_refused_by_name() {
    let settings = Settings::default();
    for dt in [1e-30, 0.99e-9, 1.01e9, 1e30, Real::NAN] {
        assert!(matches!(settings.with_dt(dt).validate(), Err(SettingsError::Step(_))), "{dt}");
    }
    assert!(matches!(settings.with_dt(1e-8).with_substeps(100).validate(), Err(SettingsError::Step(_))));
    for gravity in [3e38, -1.01e9, Real::INFINITY] {
        let gravity = settings.with_gravity(Vec3::X * gravity);
        assert!(matches!(gravity.validate(), Err(SettingsError::Gravity(_))));
    }
    for dt in [1e-9, 1e9] {
        let at_the_edge = settings.with_dt(dt).with_contact_substeps(1).with_gravity(Vec3::splat(1e9));
        assert!(at_the_edge.validate().is_ok(), "{dt}");
    }
    let body = || RigidBody::new(Shape::sphere(1.0)).without_collider().mass(1.0);
    let refused = [
        (body().position(Vec3::X * 1.01e15), "position"),
        (body().linear_velocity(Vec3::Y * -1e20), "linear_velocity"),
        (body().angular_velocity(Vec3::Z * 1.01e9), "angular_velocity"),
    ];
    for (body, field) in refused {
        let error = body.build().unwrap_err();
        assert!(matches!(error, BodyError::TooLarge { .. }), "{error}");
        assert_eq!(error.field(), field);
    }
    for size in [1e-10, 1e10, 1e30] {
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|point| point * size as Real);
        let hull = tumble::Collider::convex_hull(points);
        assert!(matches!(hull, Err(ColliderError::Size { .. })), "{hull:?}");
        let error = tumble::Collider::new(&Shape::sphere(size)).unwrap_err();
        assert_eq!(error, ColliderError::Size { field: "radius", value: size });
    }
    let far = Pose { position: Vec3::X * 1.01e9, ..Pose::default() };
    let offset = tumble::Collider::half_space().with_offset(far);
    assert!(matches!(offset, Err(ColliderError::Offset { .. })));
}
