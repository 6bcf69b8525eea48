//! Promise: bodies in plain slices get the bits of bodies in a world, on any number of threads, and
//! slices that do not fit together are refused by name.
//!
//! Why: who has an ECS of their own steps slices, and is promised the same results. It fails if a
//! column is read from the wrong row, or a component counts in one place only.

use hecs::World;
use tumble::math::{Quat, Real};
use tumble::{
    BodyOrder, BodySlices, Damping, GravityScale, Inertia, Integrator, InverseInertia, LengthMismatch, Mass, Momentum,
    Pose, PreviousPose, PrincipalAxes, Settings, Simulation, Velocity, Wrench,
};
use tumble_benches::{pool, tumbling_boxes};
use tumble_tests::run;

/// A column of a world whose bodies are all of one kind.
fn column<T: hecs::Component + Copy>(world: &mut World) -> Vec<T> {
    world.query_mut::<&T>().into_iter().copied().collect()
}

/// Boxes with every component there is.
fn boxes_with_everything(count: usize) -> World {
    let mut world = tumbling_boxes(count);
    let axes = PrincipalAxes(Quat::from_xyzw(0.5, -0.5, 0.5, 0.5));
    for (i, body) in BodyOrder::of(&world).entities().iter().enumerate() {
        let i = i as Real;
        let damping = Damping { linear: 0.1 + 0.001 * i, angular: 0.3 };
        world.insert(*body, (axes, GravityScale(1.0 - 0.01 * i), damping, PreviousPose(Pose::default()))).unwrap();
    }
    world
}

/// Bodies in plain slices get the bits of bodies in a world, on any number of threads, with all
/// components and in worlds of any size.
#[test]
fn slices_are_as_good_as_a_world() {
    for (integrator, count) in Integrator::ALL.into_iter().flat_map(|i| [1, 3, 7, 13, 40, 5000].map(|count| (i, count)))
    {
        let world = &mut boxes_with_everything(count);
        let (mut poses, mut momenta, mut wrenches) = (column(world), column(world), column(world));
        let (masses, inertias, axes): (Vec<_>, Vec<Inertia>, Vec<PrincipalAxes>) =
            (column(world), column(world), column(world));
        let (scales, dampings): (Vec<GravityScale>, Vec<Damping>) = (column(world), column(world));
        let mut velocities = vec![Velocity::default(); count];
        let mut tensors = vec![InverseInertia::default(); count];
        let mut before = vec![PreviousPose(Pose::default()); count];

        let mut bodies = BodySlices::new(&mut poses, &mut momenta, &mut wrenches, &masses);
        bodies.inertia = Some(&inertias);
        bodies.axes = Some(&axes);
        bodies.gravity_scale = Some(&scales);
        bodies.damping = Some(&dampings);
        bodies.velocity = Some(&mut velocities);
        bodies.inverse_inertia = Some(&mut tensors);
        bodies.previous_pose = Some(&mut before);
        let settings = Settings::default().with_dt(1.0 / 128.0).with_integrator(integrator);
        pool(2).install(|| {
            bodies.step(&settings).unwrap();
            bodies.step_many(&settings, 9).unwrap();
        });
        run(&mut Simulation::new(settings).unwrap(), world, 10);
        assert_eq!((poses, momenta, wrenches), (column(world), column(world), column(world)), "{integrator}, {count}");
        assert_eq!(
            (velocities, tensors, before),
            (column(world), column(world), column(world)),
            "{integrator}, {count}"
        );
    }
}

/// Slices of different lengths are refused by name, and nothing is moved.
#[test]
fn unequal_slices_are_refused() {
    let (mut poses, mut momenta, mut wrenches) =
        ([Pose::default(); 3], [Momentum::default(); 3], [Wrench::default(); 3]);
    let masses = [Mass::new(1.0).unwrap(); 3];
    let mut bodies = BodySlices::new(&mut poses, &mut momenta, &mut wrenches, &masses);
    bodies.damping = Some(&[]);
    let error = bodies.step(&Settings::default()).unwrap_err();
    assert_eq!(error, LengthMismatch { column: "damping", rows: 0, bodies: 3 });
    assert_eq!(error.to_string(), "damping has 0 rows, and there are 3 poses");
    assert_eq!(poses, [Pose::default(); 3]);
}
