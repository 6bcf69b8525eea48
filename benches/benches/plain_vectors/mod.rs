//! The yardstick: a step of bodies that are nothing but `Vec`s of numbers, written by hand for this
//! one purpose.

use hecs::World;
use pulp::{Arch, Simd, WithSimd};
use tumble::math::{Real, Vec3};
use tumble::{Inertia, Mass, Momentum, Pose};

use crate::lanes::{Lanes, registers};

/// The widest register has 16 numbers; columns are filled up to whole ones with copies of the last
/// body.
const WIDEST: usize = 16;

/// Bodies without an ECS, without options and without checks, each number of theirs in a column of
/// its own: the state, wrenches, and the derived quantities that the engine writes too.
pub(crate) struct PlainVectors {
    bodies: usize,
    position: [Vec<Real>; 3],
    /// x, y, z, w.
    orientation: [Vec<Real>; 4],
    linear: [Vec<Real>; 3],
    angular: [Vec<Real>; 3],
    force: [Vec<Real>; 3],
    torque: [Vec<Real>; 3],
    mass: Vec<Real>,
    inverse_moments: [Vec<Real>; 3],
    velocity: [Vec<Real>; 3],
    angular_velocity: [Vec<Real>; 3],
    /// xx, yy, zz, yz, zx, xy of the inverse inertia in the world.
    inverse_inertia: [Vec<Real>; 6],
}

/// Where a body is, and what follows from that.
pub(crate) struct RunStatus {
    pub(crate) position: [Real; 3],
    /// x, y, z, w.
    pub(crate) orientation: [Real; 4],
    pub(crate) velocity: [Real; 3],
    pub(crate) angular_velocity: [Real; 3],
    /// xx, yy, zz, yz, zx, xy.
    pub(crate) inverse_inertia: [Real; 6],
}

fn zeros<const N: usize>(rows: usize) -> [Vec<Real>; N] {
    std::array::from_fn(|_| vec![0.0; rows])
}

impl PlainVectors {
    /// The boxes of a world, in the order of its one archetype.
    pub(crate) fn of(world: &mut World) -> Self {
        let bodies = world.len() as usize;
        let rows = bodies.next_multiple_of(WIDEST);
        let mut plain = Self {
            bodies,
            position: zeros(rows),
            orientation: zeros(rows),
            linear: zeros(rows),
            angular: zeros(rows),
            force: zeros(rows),
            torque: zeros(rows),
            mass: vec![0.0; rows],
            inverse_moments: zeros(rows),
            velocity: zeros(rows),
            angular_velocity: zeros(rows),
            inverse_inertia: zeros(rows),
        };
        let mut last = 0;
        for (i, body) in world.query_mut::<(&Pose, &Momentum, &Mass, &Inertia)>().into_iter().enumerate() {
            plain.set(i, body);
            last = i;
        }
        plain.fill_up(last);
        plain
    }

    fn set(&mut self, i: usize, (pose, momentum, mass, inertia): (&Pose, &Momentum, &Mass, &Inertia)) {
        let set = |columns: &mut [Vec<Real>; 3], v: Vec3| (0..3).for_each(|k| columns[k][i] = v[k]);
        set(&mut self.position, pose.position);
        set(&mut self.linear, momentum.linear);
        set(&mut self.angular, momentum.angular);
        set(&mut self.inverse_moments, inertia.inverse_moments());
        self.mass[i] = mass.kilograms();
        self.orientation.iter_mut().zip(pose.orientation.to_array()).for_each(|(column, x)| column[i] = x);
    }

    fn fill_up(&mut self, last: usize) {
        let vectors = [&mut self.position, &mut self.linear, &mut self.angular, &mut self.inverse_moments];
        let columns = vectors.into_iter().flatten().chain(&mut self.orientation).chain([&mut self.mass]);
        for column in columns {
            let value = column[last];
            column[last + 1..].fill(value);
        }
    }

    /// What a step leaves, body after body.
    pub(crate) fn outcomes(&self) -> impl Iterator<Item = RunStatus> {
        (0..self.bodies).map(|i| RunStatus {
            position: self.position.each_ref().map(|column| column[i]),
            orientation: self.orientation.each_ref().map(|column| column[i]),
            velocity: self.velocity.each_ref().map(|column| column[i]),
            angular_velocity: self.angular_velocity.each_ref().map(|column| column[i]),
            inverse_inertia: self.inverse_inertia.each_ref().map(|column| column[i]),
        })
    }

    /// One step of semi-implicit Euler,
    /// `P += F dt, L += tau dt, x += P/M dt, q += 1/2 w q dt, q/|q|`, under gravity and the
    /// wrenches, which it empties; then velocities and inverse inertias.
    pub(crate) fn step(&mut self, dt: Real, gravity: Vec3) {
        Arch::new().dispatch(Step { bodies: self, dt, gravity });
    }
}

struct Step<'a> {
    bodies: &'a mut PlainVectors,
    dt: Real,
    gravity: Vec3,
}

/// The sum of products of the components.
macro_rules! dot {
    ($a:expr, $b:expr) => {
        $a[0] * $b[0] + $a[1] * $b[1] + $a[2] * $b[2]
    };
}

// No closure computes with registers: it would be compiled without the instruction set, and called
// for each operation.
impl WithSimd for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { bodies: b, dt, gravity } = self;
        let (h, zero, one) = (Lanes::splat(simd, dt), Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let g = [Lanes::splat(simd, gravity.x), Lanes::splat(simd, gravity.y), Lanes::splat(simd, gravity.z)];
        let rows = registers::<S>(&mut b.mass).len();
        macro_rules! columns {
            ($($name:ident),+) => {
                $(let $name = &mut b.$name.each_mut().map(|column| &mut registers::<S>(column)[..rows]);)+
            };
        }
        columns!(position, orientation, linear, angular, force, torque, inverse_moments);
        columns!(velocity, angular_velocity, inverse_inertia);
        let mass = &registers::<S>(&mut b.mass)[..rows];
        for i in 0..rows {
            macro_rules! load {
                ($columns:ident, $($k:literal)+) => {
                    [$(Lanes::load(simd, &$columns[$k][i])),+]
                };
            }
            macro_rules! store {
                ($columns:ident, $values:expr) => {
                    for (column, value) in $columns.iter_mut().zip($values) {
                        value.store(&mut column[i]);
                    }
                };
            }
            let m = Lanes::load(simd, &mass[i]);
            let mut x = load!(position, 0 1 2);
            let (mut p, mut l) = (load!(linear, 0 1 2), load!(angular, 0 1 2));
            let (f, t, inverse) = (load!(force, 0 1 2), load!(torque, 0 1 2), load!(inverse_moments, 0 1 2));
            let per_mass = one / m;
            for k in 0..3 {
                p[k] = p[k] + (f[k] + m * g[k]) * h;
                l[k] = l[k] + t[k] * h;
                x[k] = x[k] + p[k] * per_mass * h;
            }
            let q = load!(orientation, 0 1 2 3);
            let q = turn(q, angular_rate(&axes(q, one), inverse, l), h, one);
            let turned = axes(q, one);
            store!(position, x);
            store!(orientation, q);
            store!(linear, p);
            store!(angular, l);
            store!(force, [zero; 3]);
            store!(torque, [zero; 3]);
            store!(velocity, scaled(p, per_mass));
            store!(angular_velocity, angular_rate(&turned, inverse, l));
            store!(inverse_inertia, world_tensor(&turned, inverse));
        }
    }
}

/// The columns of the rotation matrix of a unit quaternion.
#[inline(always)]
fn axes<S: Simd>([x, y, z, w]: [Lanes<S>; 4], one: Lanes<S>) -> [[Lanes<S>; 3]; 3] {
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (xx, yy, zz, xy, yz, zx) = (x * x2, y * y2, z * z2, x * y2, y * z2, z * x2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    [[one - (yy + zz), xy + wz, zx - wy], [xy - wz, one - (xx + zz), yz + wx], [zx + wy, yz - wx, one - (xx + yy)]]
}

#[inline(always)]
fn scaled<S: Simd>([x, y, z]: [Lanes<S>; 3], factor: Lanes<S>) -> [Lanes<S>; 3] {
    [x * factor, y * factor, z * factor]
}

/// `w = R I^-1 R^T L`.
#[inline(always)]
fn angular_rate<S: Simd>([a, b, c]: &[[Lanes<S>; 3]; 3], inverse: [Lanes<S>; 3], l: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let (u, v, w) = (dot!(a, l) * inverse[0], dot!(b, l) * inverse[1], dot!(c, l) * inverse[2]);
    [a[0] * u + b[0] * v + c[0] * w, a[1] * u + b[1] * v + c[1] * w, a[2] * u + b[2] * v + c[2] * w]
}

/// `q + 1/2 w q h`, made unit.
#[inline(always)]
fn turn<S: Simd>([x, y, z, w]: [Lanes<S>; 4], rate: [Lanes<S>; 3], h: Lanes<S>, one: Lanes<S>) -> [Lanes<S>; 4] {
    let [a, b, c] = scaled(rate, h / (one + one));
    let q = [
        x + (a * w + b * z - c * y),
        y + (b * w + c * x - a * z),
        z + (c * w + a * y - b * x),
        w - (a * x + b * y + c * z),
    ];
    let scale = one / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    [q[0] * scale, q[1] * scale, q[2] * scale, q[3] * scale]
}

/// `R I^-1 R^T`: xx, yy, zz, yz, zx, xy.
#[inline(always)]
fn world_tensor<S: Simd>([a, b, c]: &[[Lanes<S>; 3]; 3], inverse: [Lanes<S>; 3]) -> [Lanes<S>; 6] {
    macro_rules! entry {
        ($i:literal $j:literal) => {
            a[$i] * a[$j] * inverse[0] + b[$i] * b[$j] * inverse[1] + c[$i] * c[$j] * inverse[2]
        };
    }
    [entry!(0 0), entry!(1 1), entry!(2 2), entry!(1 2), entry!(2 0), entry!(0 1)]
}
