//! Benchmark scenes with joints: chains, pendulums, nets, a rope bridge, an arm with drives and
//! limits, a heap of ragdolls.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Axes, BodyId, Collider, ColliderError, Drive, Drives, Joint, JointError, Limit, Limits, Material, RigidBody, Shape,
};

/// Length of a link of a chain \[m\].
pub const LINK: Real = 0.1;

/// What connects the links of a chain or the planks of a bridge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// One ball joint in a chain, one at each rail of a bridge.
    Ball,
    /// Hinges about z.
    Hinge,
}

impl JointKind {
    fn connect(self, world: &mut World, [a, b]: [Entity; 2], at: Vec3) {
        let joint = match self {
            Self::Ball => Joint::ball(a, b).at_point(world, at),
            Self::Hinge => Joint::hinge(a, b).at(world, at, Vec3::Z),
        };
        world.spawn((made(joint),));
    }
}

/// A chain of this many links of 1 kg and 10 cm on a fixed body, let go from 45 degrees.
pub fn chain(links: usize, kind: JointKind) -> World {
    let mut world = World::new();
    hang(&mut world, 0, Vec3::ZERO, links, kind);
    world
}

/// Such chains of ten links with balls, each on a fixed body of its own.
pub fn pendulums(count: usize) -> World {
    const LINKS: usize = 10;
    let mut world = World::new();
    (0..count).for_each(|number| {
        let at = Vec3::Z * number as Real;
        hang(&mut world, number * (LINKS + 1), at, LINKS, JointKind::Ball);
    });
    world
}

/// Hangs links on a fixed body at a point of the world, in a straight line.
fn hang(world: &mut World, first_id: usize, at: Vec3, links: usize, kind: JointKind) {
    // An eighth of a turn about z.
    let orientation = Quat::from_xyzw(0.0, 0.0, 1.0, 1.0 + Real::sqrt(2.0)).normalize();
    let down = orientation * -Vec3::Y * LINK;
    let mut last = fixed(world, first_id, at);
    for i in 0..links {
        let link = RigidBody::new(Shape::cuboid([0.02, 0.05, 0.02])).without_collider().mass(1.0);
        let link = link.id(BodyId((first_id + 1 + i) as u64)).orientation(orientation);
        let link = spawn(world, link.position(at + down * (i as Real + 0.5)));
        kind.connect(world, [last, link], at + down * i as Real);
        last = link;
    }
}

/// A rope bridge of planks of 20 kg, 40 cm wide, on a sagging arc between two fixed bodies: two
/// balls or one hinge between neighbours.
pub fn bridge(planks: usize, kind: JointKind) -> World {
    const WIDTH: Real = 0.4;
    /// Angle by which one plank is turned against the one before \[rad\], nearly.
    const BEND: Real = 0.02;
    let mut world = World::new();
    let mut last = fixed(&mut world, 0, Vec3::ZERO);
    let mut at = Vec3::ZERO;
    for i in 0..planks {
        let turn = BEND * (i as Real - 0.5 * (planks as Real - 1.0));
        // Exact enough for an angle of half a radian at most, and the same on every machine.
        let half = 0.5 * turn;
        let orientation = Quat::from_xyzw(0.0, 0.0, half, 1.0).normalize();
        let along = orientation * Vec3::X * WIDTH;
        let plank =
            RigidBody::new(Shape::cuboid([0.2, 0.02, 0.5])).without_collider().mass(20.0).id(BodyId(i as u64 + 1));
        let plank = spawn(&mut world, plank.position(at + along * 0.5).orientation(orientation));
        join_planks(&mut world, [last, plank], at, kind);
        (at, last) = (at + along, plank);
    }
    let end = fixed(&mut world, planks + 1, at);
    join_planks(&mut world, [last, end], at, kind);
    world
}

fn join_planks(world: &mut World, bodies: [Entity; 2], at: Vec3, kind: JointKind) {
    let places = match kind {
        JointKind::Ball => &[-0.5, 0.5][..],
        JointKind::Hinge => &[0.0][..],
    };
    for z in places {
        kind.connect(world, bodies, at + Vec3::Z * *z);
    }
}

/// A horizontal arm of this many links of 1 kg and 10 cm on hinges about z and y, one after the
/// other, each with a drive to a position at 5 Hz and limits of a radian both ways.
pub fn arm(links: usize) -> World {
    let mut world = World::new();
    let mut last = fixed(&mut world, 0, Vec3::ZERO);
    for i in 0..links {
        let begin = Vec3::X * (i as Real * LINK);
        let link =
            RigidBody::new(Shape::cuboid([0.05, 0.02, 0.02])).without_collider().mass(1.0).id(BodyId(i as u64 + 1));
        let link = spawn(&mut world, link.position(begin + Vec3::X * (0.5 * LINK)));
        let axis = if i % 2 == 0 { Vec3::Z } else { Vec3::Y };
        let hinge = Joint::hinge(last, link).at(&world, begin, axis);
        let drive = Drive::position(Axes::ANGULAR_X, if i % 4 < 2 { 0.3 } else { -0.3 }).with_frequency(5.0, 1.0);
        let limits = Limits::along(Axes::ANGULAR_X, Limit::new(-1.0, 1.0));
        world.spawn((made(hinge), Drives::from(drive), limits));
        last = link;
    }
    world
}

/// A square net of balls half a metre apart, this many to a side, each joined to its neighbours
/// half-way; it hangs on its first row, which is fixed, and is let go from where it lies flat.
pub fn net(side: usize) -> World {
    const APART: Real = 0.5;
    let mut world = World::new();
    let place = |row: usize, column: usize| Vec3::new(column as Real, 0.0, row as Real) * APART;
    let mut balls: Vec<Entity> = Vec::with_capacity(side * side);
    for number in 0..side * side {
        let (row, column) = (number / side, number % side);
        let at = place(row, column);
        balls.push(if row == 0 {
            fixed(&mut world, number, at)
        } else {
            let ball = RigidBody::new(Shape::sphere(0.1)).without_collider().mass(1.0).id(BodyId(number as u64));
            spawn(&mut world, ball.position(at))
        });
        let before = [(row > 0).then(|| (row - 1, column)), (column > 0).then(|| (row, column - 1))];
        for (other_row, other_column) in before.into_iter().flatten() {
            let middle = (at + place(other_row, other_column)) * 0.5;
            JointKind::Ball.connect(&mut world, [balls[other_row * side + other_column], balls[number]], middle);
        }
    }
    world
}

/// Of the capsules that ragdolls consist of, along y: half the height of the cylinder and the
/// radius \[m\]; and their friction.
pub(crate) const BONE: [Real; 2] = [0.1, 0.06];
pub(crate) const BONE_FRICTION: Real = 0.6;

/// Ragdolls of 23 capsules of 3 kg on ball joints without limits, which lie in the air in sixteen
/// towers, four abreast, and fall on the ground in a heap.
pub fn ragdolls(count: usize) -> World {
    let mut world = World::new();
    touching(&mut world, RigidBody::new(Shape::Point).fixed().id(BodyId(0)), Ok(Collider::half_space()));
    for number in 0..count {
        let (layer, tower) = (number / TOWERS, number % TOWERS);
        let beside = Vec3::new((tower % 4) as Real * 1.2, 0.0, (tower / 4) as Real * 2.0);
        // Each layer is pushed aside a little, or towers would stand.
        let aside = Vec3::new((layer % 3) as Real * 0.15, 0.5 + layer as Real * 0.4, (layer % 2) as Real * 0.1);
        ragdoll(&mut world, 1 + number * BONES, beside + aside);
    }
    world
}

const TOWERS: usize = 16;
const BONES: usize = 23;

/// Spawns a body with a collider of the bones' friction.
#[allow(clippy::expect_used, reason = "the bodies and colliders made here are possible")]
fn touching(world: &mut World, body: RigidBody, collider: Result<Collider, ColliderError>) -> Entity {
    let material = Material::new(BONE_FRICTION, 0.0);
    let collider = collider.and_then(|it| it.with_material(material)).expect("a possible collider");
    body.build().expect("a possible body").spawn_with(world, (collider,))
}

/// One ragdoll on its back, its bones along z: a spine of seven, and from it two arms and two legs
/// of four.
fn ragdoll(world: &mut World, first_id: usize, at: Vec3) {
    let length = 2.0 * (BONE[0] + BONE[1]);
    // A quarter of a turn about x.
    let along = Quat::from_xyzw(1.0, 0.0, 0.0, 1.0).normalize();
    let shape = Shape::capsule(BONE[1], BONE[0]);
    let mut bones: Vec<(Entity, Vec3)> = Vec::with_capacity(BONES);
    let mut add = |world: &mut World, at: Vec3, parent: Option<usize>| {
        let body = RigidBody::new(shape.clone()).mass(3.0).position(at).orientation(along);
        let bone = touching(world, body.id(BodyId((first_id + bones.len()) as u64)), Collider::new(&shape));
        if let Some((other, place)) = parent.map(|parent| bones[parent]) {
            JointKind::Ball.connect(world, [other, bone], (at + place) * 0.5);
        }
        bones.push((bone, at));
        bones.len() - 1
    };
    let mut last = None;
    for i in 0..7 {
        last = Some(add(world, at + Vec3::Z * (i as Real * length), last));
    }
    // Legs go on from the first bone, arms back from the sixth.
    for (parent, from, step) in [(0, 0.0, -length), (5, 5.0 * length, -length)] {
        for side in [-1.0, 1.0] {
            let mut last = Some(parent);
            for i in 0..4 {
                let aside = Vec3::X * (side * (0.13 + 0.04 * i as Real));
                let down = Vec3::Z * (from + step * (i as Real + 0.5));
                last = Some(add(world, at + aside + down, last));
            }
        }
    }
}

fn fixed(world: &mut World, id: usize, at: Vec3) -> Entity {
    spawn(world, RigidBody::new(Shape::Point).fixed().position(at).id(BodyId(id as u64)))
}

#[allow(clippy::expect_used, reason = "the bodies made above are possible")]
fn spawn(world: &mut World, body: RigidBody) -> Entity {
    body.build().expect("a possible body").spawn(world)
}

#[allow(clippy::expect_used, reason = "the joints made above are between bodies of the world")]
fn made(joint: Result<Joint, JointError>) -> Joint {
    joint.expect("a possible joint")
}
