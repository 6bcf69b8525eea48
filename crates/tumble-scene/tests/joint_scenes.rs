//! Promise: the built-in scenes of joints do what their titles say. The crane's rope is as long as
//! it was; the arm's servos give way by torque over stiffness; the gyroscope goes round at the
//! torque over its spin; the hands of the clock keep their ratios; the hall turns below Foucault's
//! pendulum by the sine of the latitude; the bridge and the figure come to rest; and energy comes
//! of motors alone.
//!
//! Why: they are what the documentation shows joints with, and the first thing that people try. A
//! drive with a wrong sign, a limit that is overrun or a joint that makes energy would show here.
#![allow(clippy::useless_conversion, reason = "Real is f64 in one of the two builds")]

use std::collections::HashMap;

use glam::{DMat3, DQuat, DVec3};
use hecs::{Entity, World};
use tumble::{Axes, Drives, Gain, Joint, JointLoad, Ledger, Limits, Momentum, Pose, Simulation, Velocity};
use tumble_scene::Scene;

use crate::precision::by_precision;

struct Run {
    world: World,
    simulation: Simulation,
    ledger: Ledger,
    steps: u64,
    bodies: HashMap<String, Entity>,
    /// In the order of the file.
    joints: Vec<Entity>,
    /// What the joints did along their free axes \[J\].
    work: f64,
    /// How fast the ends of each joint part, and turn against each other \[m/s\] \[rad/s\].
    speeds: Vec<[DVec3; 2]>,
}

/// The most of a run with contacts.
struct Falling {
    /// Of the energy from step to step \[J\].
    rise: f64,
    /// \[m\]
    gap: f64,
    /// Of limits \[m\] \[rad\].
    overrun: f64,
    /// Speed in the end [m/s].
    fastest: f64,
}

fn double(vector: tumble::math::Vec3) -> DVec3 {
    DVec3::from_array(vector.to_array().map(f64::from))
}

/// An angle brought to -pi to pi.
fn wrapped(angle: f64) -> f64 {
    angle - std::f64::consts::TAU * (angle / std::f64::consts::TAU).round()
}

fn turn(rotation: tumble::math::Quat) -> DQuat {
    DQuat::from_array(rotation.to_array().map(f64::from)).normalize()
}

impl Run {
    fn of(name: &str) -> Self {
        Self::with_divided_steps(name, 1)
    }

    /// With steps of the scene's over a number.
    fn with_divided_steps(name: &str, divided: u16) -> Self {
        let scene = Scene::open(name).unwrap();
        let (steps, settings) = (scene.steps, scene.settings);
        let settings = settings.with_dt(settings.dt / tumble::math::Real::from(divided));
        let mut world = World::new();
        let count = scene.body_count();
        let names = scene.spawn(&mut world).unwrap();
        let by_id: HashMap<u64, Entity> =
            world.query::<(Entity, &tumble::BodyId)>().iter().map(|(entity, id)| (id.0, entity)).collect();
        let bodies = (0..count).map(|index| (names.of(index as u64).into_owned(), by_id[&(index as u64)])).collect();
        let mut joints: Vec<Entity> = world.query::<(Entity, &Joint)>().iter().map(|(entity, _)| entity).collect();
        joints.sort_unstable_by_key(|joint| joint.id());
        let simulation = Simulation::new(settings).unwrap();
        let ledger = Ledger::attach(&mut world, &simulation);
        let mut run = Self { world, simulation, ledger, steps, bodies, joints, work: 0.0, speeds: Vec::new() };
        run.speeds = run.joint_speeds();
        run
    }

    fn seconds(&self) -> f64 {
        self.simulation.time()
    }

    fn step(&mut self) {
        let begin = self.seconds();
        self.simulation.step(&mut self.world);
        let seconds = self.seconds() - begin;
        let now = self.joint_speeds();
        for ((joint, before), after) in self.joints.iter().zip(&self.speeds).zip(&now) {
            let load = *self.world.get::<&JointLoad>(*joint).unwrap();
            let [apart, turning] = [0, 1].map(|kind| (before[kind] + after[kind]) * 0.5);
            self.work += seconds * (double(load.force).dot(apart) + double(load.torque).dot(turning));
        }
        self.speeds = now;
    }

    /// Goes through all steps.
    fn falls(&mut self) -> Falling {
        let (mut gap, mut overrun, mut rise, mut last) = (0.0_f64, 0.0_f64, f64::NEG_INFINITY, self.start());
        for _ in 0..self.steps {
            self.step();
            let energy = self.record();
            rise = rise.max(energy - last);
            last = energy;
            gap = gap.max(self.largest_gap());
            overrun = overrun.max(self.largest_overrun());
        }
        let fastest = self.bodies.values().map(|body| self.velocity(*body)[0].length()).fold(0.0, f64::max);
        println!("gap {gap:e} overrun {overrun:e} rise {rise:e} of {} fastest {fastest:e}", self.start());
        Falling { rise, gap, overrun, fastest }
    }

    fn record(&mut self) -> f64 {
        self.ledger.record(&self.world, &self.simulation).energy()
    }

    fn start(&self) -> f64 {
        self.ledger.entries()[0].energy()
    }

    /// What springs of joints took up since the start \[J\].
    fn stored(&self) -> f64 {
        let [first, .., last] = self.ledger.entries() else { return 0.0 };
        last.totals.force_potential - first.totals.force_potential
    }

    fn pose(&self, body: Entity) -> (DVec3, DQuat) {
        let pose = *self.world.get::<&Pose>(body).unwrap();
        (double(pose.position), turn(pose.orientation))
    }

    fn body(&self, name: &str) -> Entity {
        self.bodies[name]
    }

    fn place(&self, name: &str) -> DVec3 {
        self.pose(self.body(name)).0
    }

    fn velocity(&self, body: Entity) -> [DVec3; 2] {
        let velocity = self.world.get::<&Velocity>(body).map_or(Velocity::default(), |velocity| *velocity);
        [double(velocity.linear), double(velocity.angular)]
    }

    fn joint(&self, index: usize) -> Joint {
        *self.world.get::<&Joint>(self.joints[index]).unwrap()
    }

    fn load(&self, index: usize) -> JointLoad {
        *self.world.get::<&JointLoad>(self.joints[index]).unwrap()
    }

    /// The points of the two frames, and how they are turned, in the world.
    fn frames(&self, joint: &Joint) -> [(DVec3, DQuat); 2] {
        [0, 1].map(|end| {
            let (position, orientation) = self.pose(joint.bodies[end]);
            let frame = joint.frames[end];
            (position + orientation * double(frame.position), orientation * turn(frame.orientation))
        })
    }

    /// Both bodies are pushed at the second one's anchor.
    fn joint_speeds(&self) -> Vec<[DVec3; 2]> {
        let speeds = |index: usize| {
            let joint = self.joint(index);
            let anchor = self.frames(&joint)[1].0;
            let [[v, w], [u, x]] = joint.bodies.map(|body| {
                let [linear, angular] = self.velocity(body);
                [linear + angular.cross(anchor - self.pose(body).0), angular]
            });
            [u - v, x - w]
        };
        (0..self.joints.len()).map(speeds).collect()
    }

    /// How far locked axes of translation are from where they should be \[m\].
    fn largest_gap(&self) -> f64 {
        let gap = |index: usize| {
            let joint = self.joint(index);
            let [(a, turned), (b, _)] = self.frames(&joint);
            let apart = turned.conjugate() * (b - a);
            let axes = [Axes::LINEAR_X, Axes::LINEAR_Y, Axes::LINEAR_Z].map(|axis| joint.free.contains(axis));
            apart
                .to_array()
                .into_iter()
                .zip(axes)
                .filter(|(_, free)| !free)
                .map(|(gap, _)| gap.abs())
                .fold(0.0, f64::max)
        };
        (0..self.joints.len()).map(gap).fold(0.0, f64::max)
    }

    /// How far the joints are past their limits \[m\] \[rad\].
    fn largest_overrun(&self) -> f64 {
        let mut most = 0.0_f64;
        for (index, joint) in self.joints.iter().enumerate() {
            let Ok(limits) = self.world.get::<&Limits>(*joint).map(|limits| *limits) else { continue };
            let [(a, p), (b, q)] = self.frames(&self.joint(index));
            if let Some(limit) = limits.distance {
                most = most.max(a.distance(b) - f64::from(limit.max));
            }
            let relative = p.conjugate() * q;
            let relative = if relative.w < 0.0 { -relative } else { relative };
            if let Some(limit) = limits.axes[3].filter(|limit| limit.gain == Gain::Rigid) {
                let twist = 2.0 * relative.x.atan2(relative.w);
                most = most.max(twist - f64::from(limit.max)).max(f64::from(limit.min) - twist);
            }
            if let Some(cone) = limits.cone {
                let x = relative * DVec3::X;
                let [about_y, about_z] = cone.half_angles.map(|angle| (0.5 * f64::from(angle)).tan());
                let size = (x.y / about_z).hypot(x.z / about_y) / (1.0 + x.x);
                most = most.max((size - 1.0) * 2.0 * about_y.min(about_z).atan());
            }
        }
        most
    }
}

/// Positions of twenty metres are rounded to 2e-6 in single precision. What slewing and trolley did
/// is reckoned from the means of loads and speeds over a step, which is of second order.
#[test]
fn the_crane_lifts_a_thousand_times_its_hook_and_the_rope_does_not_stretch() {
    let mut run = Run::of("crane");
    let length = 9.6;
    // Of a pendulum of 11.5 m: twice 6.8 s.
    let (two_swings, mut out, mut pull, mut begin) = (816, 0.0, 0.0, 0.0);
    let (mut longest, mut least_pull, mut change, mut gap, mut swing) = (0.0_f64, f64::INFINITY, 0.0_f64, 0.0, 0.0_f64);
    for step in 0..run.steps {
        run.step();
        let energy = run.record();
        let [(from, _), (to, _)] = run.frames(&run.joint(2));
        longest = longest.max(from.distance(to) / length - 1.0);
        swing = swing.max((to - from).normalize().dot(DVec3::NEG_Y).acos());
        least_pull = least_pull.min(double(run.load(2).force).length());
        // What the trolley's spring gave is among the work of its joint.
        change = change.max((energy - run.stored() - run.start() - run.work).abs());
        gap = f64::max(gap, run.largest_gap());
        if step + two_swings + 1 == run.steps {
            begin = f64::from(run.load(1).values[0]);
        }
        if step + two_swings >= run.steps {
            let along = run.pose(run.body("boom")).1 * DVec3::X;
            out += f64::from(run.load(1).values[0]) / two_swings as f64;
            pull -= double(run.load(2).force).dot(along) / two_swings as f64;
        }
    }
    println!("stretch {longest:e} pull {least_pull} swing {swing} energy {change:e} of {} gap {gap:e}", run.work);
    assert!(longest < by_precision(1e-6, 1e-9), "{longest:e}");
    assert!(gap < by_precision(1e-4, 1e-8), "{gap:e}");
    // The rope was taut all the time, and the load swung.
    let weight = 5005.0 * 9.81;
    assert!(least_pull > 0.9 * weight && swing > 0.05, "{least_pull} {swing}");
    assert!(change < 2e-3 * run.work.abs(), "{change} of {}", run.work);
    let slewing = run.load(0).speeds[3];
    assert!((f64::from(slewing) - 0.12).abs() < 1e-5, "{slewing}");
    // On average the trolley is where its spring holds the rope's pull and its own w^2 r m, but for
    // what its damper holds. Its own momentum is 400 kg times a few cm/s, in 13.6 s.
    let speed = (f64::from(run.load(1).values[0]) - begin) * 60.0 / two_swings as f64;
    let held = 6.0 + (pull + 0.12 * 0.12 * (7.0 + out) * 400.0 - 32_000.0 * speed) / 8000.0;
    println!("pull {pull} N, speed {speed} m/s, at {out} m, expected {held} m");
    assert!(pull > 300.0 && (out - held).abs() < 3e-3, "{pull} {out} {held}");
}

/// The arm at the end of its run, and how far its energy was from what the servos did \[J\].
fn arm(divided: u16) -> (Run, f64) {
    let mut run = Run::with_divided_steps("arm", divided);
    let (mut change, mut overrun) = (0.0_f64, 0.0_f64);
    for _ in 0..run.steps * u64::from(divided) {
        run.step();
        let energy = run.record();
        change = change.max((energy - run.start() - run.work).abs());
        overrun = overrun.max(run.largest_overrun());
    }
    assert!(overrun < 1e-5, "{overrun:e}");
    (run, change)
}

/// Closed form: a servo with a frequency has the stiffness that swings what hangs on it, as one
/// piece, at that frequency.
#[test]
fn the_servos_of_the_arm_give_way_by_torque_over_stiffness() {
    let (run, change) = arm(1);
    let links = ["turret", "upper-arm", "forearm", "wrist", "hand", "load"];
    for servo in 0..5 {
        let (anchor, turned) = run.frames(&run.joint(servo))[1];
        let axis = turned * DVec3::X;
        let (mut inertia, mut torque) = (0.0, 0.0);
        for link in &links[servo..] {
            let body = run.world.entity(run.body(link)).unwrap();
            let mass = f64::from(body.get::<&tumble::Mass>().unwrap().kilograms());
            let (place, orientation) = run.pose(run.body(link));
            let axes = body.get::<&tumble::PrincipalAxes>().map_or(DQuat::IDENTITY, |axes| turn(axes.0));
            let moments = double(body.get::<&tumble::Inertia>().unwrap().moments());
            let own = (orientation * axes).conjugate() * axis;
            let arm = place - anchor;
            inertia += mass * arm.reject_from_normalized(axis).length_squared() + (own * own).dot(moments);
            torque += axis.dot(arm.cross(DVec3::NEG_Y * 9.81 * mass));
        }
        let drive = run.world.get::<&Drives>(run.joints[servo]).unwrap().0[0];
        let Gain::Frequency { hertz, .. } = drive.gain else { panic!("a servo has a frequency") };
        let rate = std::f64::consts::TAU * f64::from(hertz);
        let load = run.load(servo);
        let sag = f64::from(load.values[3]) - f64::from(drive.position.unwrap());
        let expected = torque / (rate * rate * inertia);
        println!("servo {servo}: {sag} {expected}, {} rad/s", load.speeds[3]);
        // The stiffness is that of the pose when the step begins; what is left of the motion after
        // five seconds of at least two turns of phase each has gone by exp(-30).
        assert!((sag - expected).abs() < 3e-4 * expected.abs() + by_precision(2e-6, 1e-9), "{servo}: {sag} {expected}");
        assert!(f64::from(load.speeds[3]).abs() < 1e-4);
    }
    // What the servos did is what the energy changed by, to second order in the step.
    let (_, finer) = arm(4);
    println!("energy {change} J, in quarter steps {finer} J, of {} J", run.work);
    assert!(finer < change / 8.0, "{finer} {change}");
}

/// Closed form: torque over spin, `m g d/(I w)`, without nutation, for that is how it starts.
#[test]
fn the_gyroscope_goes_round_by_torque_over_spin() {
    let mut run = Run::of("gimbals");
    let rotor = run.world.entity(run.body("rotor")).unwrap();
    let moment = double(rotor.get::<&tumble::Inertia>().unwrap().moments()).max_element();
    let rate = 0.5 * 9.81 * 0.31 / (moment * 60.0);
    let (mut level, mut late, mut change, mut gap) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..run.steps {
        run.step();
        let energy = run.record();
        change = change.max((energy / run.start() - 1.0).abs());
        let axle = run.place("weight").normalize();
        level = level.max(axle.y.abs());
        let angle = rate * run.seconds();
        late = late.max(axle.with_y(0.0).normalize().distance(DVec3::new(angle.sin(), 0.0, angle.cos())));
        gap = gap.max(run.largest_gap());
    }
    println!("level {level:e} late {late:e} of {} energy {change:e} gap {gap:e}", rate * run.seconds());
    // Nearly one and a half turns. In both precisions it is the scheme that nods, by 1e-4 rad where
    // the rotor turns by a quarter of a radian in a substep.
    assert!(rate * run.seconds() > 8.9);
    assert!(level < 3e-4 && late < 3e-4, "{level:e} {late:e}");
    assert!(change < 5e-5 && gap < by_precision(1e-6, 1e-9), "{change:e} {gap:e}");
}

/// Closed form: the fly turns as fast as its drag holds the weight, `c w^2 = m g r/720`.
#[test]
fn the_hands_of_the_clock_keep_their_ratios() {
    let mut run = Run::of("clockwork");
    let [drum, minute, second, hour] = [1, 2, 4, 7];
    let mut turned = [0.0_f64; 8];
    let (mut slip, mut change, mut gap, mut braked, mut speed) = ([0.0_f64; 3], 0.0_f64, 0.0_f64, 0.0, 0.0);
    for _ in 0..run.steps {
        let begin = run.seconds();
        run.step();
        for (joint, turned) in turned.iter_mut().enumerate().skip(1) {
            *turned += wrapped(f64::from(run.load(joint).values[3]) - *turned);
        }
        // Clockwise, each as often as it should.
        let [hours, minutes] = [turned[hour] * 12.0 - turned[minute], turned[minute] * 60.0 - turned[second]];
        let fallen = f64::from(run.load(0).values[0]) + 0.08 * turned[drum];
        slip = [slip[0].max(hours.abs()), slip[1].max(minutes.abs()), slip[2].max(fallen.abs())];
        let before = std::mem::replace(&mut speed, run.velocity(run.body("fly"))[1].z);
        braked += 2.2e-6 * (run.seconds() - begin) * 0.5 * (before.powi(3) + speed.powi(3));
        let energy = run.record();
        change = change.max((energy - run.start() + braked).abs());
        gap = gap.max(run.largest_gap());
    }
    let expected = (5.0 * 9.81 * 0.08 / 720.0 / 2.2e-6_f64).sqrt();
    println!("slip {slip:?} braked {braked} J, energy {change:e} fly {speed} of {expected} gap {gap:e}");
    // More than a hundred turns of the second hand, and all three clockwise.
    assert!(turned[second] < -700.0 && turned[hour] < -1.0 && turned[drum] > 4.0, "{turned:?}");
    // Some roundings of an angle, 1.2e-7 in single precision, at the end of 12 and of 60 to one; of
    // the weight's place below the origin.
    let most = [by_precision(2e-5, 1e-9), by_precision(1e-4, 1e-9), by_precision(2e-6, 1e-10)];
    assert!(slip.iter().zip(most).all(|(slip, most)| *slip < most), "{slip:?}");
    assert!(gap < by_precision(1e-6, 1e-9), "{gap:e}");
    // What the fly took is of second order in the step while it comes to its speed. The places of
    // the hands' counterweights are rounded to 0.1 mm, of the second hand 2e-4 of its torque.
    assert!(change < 2e-4 * braked && (speed / expected - 1.0).abs() < 1e-4, "{change} {braked} {speed} {expected}");
}

/// Closed form: the plane of the swing stays, so in the hall it turns by `W sin(latitude) t`, from
/// x to z, which is clockwise as seen from above.
#[test]
fn the_hall_turns_below_the_pendulum() {
    let mut run = Run::of("foucault");
    run.ledger.detach(&mut run.world);
    let energy = |run: &Run| 9.81 * run.place("bob").y + 0.5 * run.velocity(run.body("bob"))[0].length_squared();
    let start = energy(&run);
    let rate = 7.292_115e-5 * 48.846_2_f64.to_radians().sin();
    let (mut change, mut gap, mut sums) = (0.0_f64, 0.0_f64, DMat3::ZERO);
    // Twenty seconds, which are a little more than a swing.
    let last = 400;
    for step in 0..run.steps {
        run.step();
        change = change.max((energy(&run) / start - 1.0).abs());
        gap = gap.max(run.largest_gap());
        if step + last >= run.steps {
            let (_, hall) = run.pose(run.body("hall"));
            let place = hall.conjugate() * run.place("bob").with_y(0.0);
            sums += DMat3::from_cols(place * place.x, place * place.y, place * place.z);
        }
    }
    // The direction of the longest axis of the points.
    let direction = 0.5 * (2.0 * sums.x_axis.z).atan2(sums.x_axis.x - sums.z_axis.z);
    let expected = rate * (run.seconds() - 10.0);
    println!("direction {direction} expected {expected} energy {change:e} gap {gap:e}");
    // An ellipse of these axes turns by itself by 7e-4 of that; half a swing is 4e-4 rad.
    assert!((direction - expected).abs() < 5e-4 + 1e-3 * expected, "{direction} {expected}");
    // Single precision rounds 67 m to 4e-6, and a swing rises by 6.7 cm. In double precision 5.9e-5
    // and 1.3e-8 m were measured, a few times the square of w h: 0.38 rad/s times 0.0125 s.
    assert!(change < by_precision(2e-3, 1e-4) && gap < by_precision(1e-4, 1e-7), "{change:e} {gap:e}");
}

#[test]
fn boxes_come_to_rest_on_the_bridge() {
    let mut run = Run::of("rope-bridge");
    let Falling { rise, gap, fastest, .. } = run.falls();
    for (name, half) in [("crate", 0.25), ("chest", 0.2), ("parcel", 0.2)] {
        let place = run.place(name);
        // On the plank below it, of half a thickness of 2.5 cm, which is hardly inclined.
        let planks = (0..16).map(|number| run.place(&format!("plank-{number}")));
        let below = planks.min_by(|a, b| (a.x - place.x).abs().total_cmp(&(b.x - place.x).abs())).unwrap();
        println!("{name} {place} {below}");
        assert!((place.y - below.y - half - 0.025).abs() < 0.05, "{name} {place} {below}");
    }
    assert!(fastest < 1e-2, "{fastest}");
    // A thousandth of what the boxes lose in falling by 8 cm. Contacts and joints are solved
    // alternately, which leaves gaps of a tenth of a millimetre here.
    assert!(rise < 1e-3 * 58.0 * 9.81 * 0.08 && gap < 5e-4, "{rise:e} {gap:e}");
}

/// Contacts and joints are solved alternately, so gaps are larger here than where nothing touches.
#[test]
fn the_figure_falls_and_lies_within_its_limits() {
    let mut run = Run::of("ragdoll");
    let Falling { rise, gap, overrun, fastest } = run.falls();
    let highest = run.bodies.keys().map(|name| run.place(name).y).fold(0.0, f64::max);
    assert!(gap < 2e-3 && overrun < 1e-3, "{gap:e} {overrun:e}");
    assert!(rise < 1e-3 * run.start(), "{rise:e}");
    assert!(fastest < 1e-2 && highest < 0.6, "{fastest} {highest}");
}

/// A heap of mechanisms: contacts between them are in passes, and where one falls on another limits
/// are overrun, which depends on how it falls: by less than 0.15 rad in the median.
#[test]
fn figures_fall_on_each_other_and_come_to_rest() {
    let mut overruns = Vec::new();
    for slower in 0..5_u8 {
        let mut run = Run::of("ragdolls");
        for momentum in run.world.query_mut::<&mut Momentum>() {
            momentum.linear *= 1.0 - 0.03 * tumble::math::Real::from(slower);
        }
        let Falling { rise, gap, overrun, fastest } = run.falls();
        let heights = run.bodies.keys().filter(|name| *name != "ground").map(|name| run.place(name).y);
        let [lowest, highest] = heights.fold([f64::INFINITY, 0.0], |[low, high], y| [low.min(y), high.max(y)]);
        assert!(gap < 2e-3, "{gap:e}");
        assert!(rise < 1e-3 * run.start(), "{rise:e}");
        assert!(fastest < 5e-2 && lowest > 0.02 && highest < 1.2, "{fastest} {lowest} {highest}");
        overruns.push(overrun);
    }
    overruns.sort_by(f64::total_cmp);
    assert!(overruns[2] < 0.01 && overruns[4] < 0.1, "{overruns:?}");
}

#[test]
fn the_robot_lands_on_its_light_feet_and_stands() {
    let mut run = Run::of("robot");
    let Falling { rise, gap, fastest, .. } = run.falls();
    assert!(gap < 2e-3, "{gap:e}");
    assert!(rise < 1e-3 * run.start(), "{rise:e}");
    assert!(fastest < 1e-3, "{fastest:e}");
    for foot in ["left-foot", "right-foot"] {
        let height = run.place(foot).y;
        assert!((height - 0.02).abs() < 1e-4, "{foot}: {height}");
    }
    assert!(run.place("trunk").y > 1.1);
}
