//! A contact of a mechanism's bodies, in double precision.

use tumble_collide::MAX_MANIFOLD_POINTS;
use tumble_math::lane::Vec3;

use crate::solver::direct::contact_problem::ContactShape;
use crate::solver::mechanism::mechanism_solver::SIGNS;

/// The most rows of a contact: four points, two tangents, a twist, two axes of rolling.
pub(crate) const MAX_CONTACT_ROWS: usize = MAX_MANIFOLD_POINTS + 5;

/// An impulse \[N s\] on a body of a mechanism or beside it, and an angular one about its centre of
/// mass [N m s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    pub(crate) body: usize,
    pub(crate) linear: Vec3<f64>,
    pub(crate) torque: Vec3<f64>,
}

/// A contact as it stands, and what it has done in this substep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectContact {
    /// Its number among all.
    pub(crate) number: u32,
    /// Its bodies, among those of the mechanism and then those that are beside it.
    pub(crate) ends: [usize; 2],
    /// How many of the points are there.
    pub(crate) points: usize,
    pub(crate) normal: Vec3<f64>,
    pub(crate) tangents: [Vec3<f64>; 2],
    /// From both centres of mass to the middle \[m\].
    pub(crate) arms: [Vec3<f64>; 2],
    /// From the middle to each point, along the tangents \[m\].
    pub(crate) offsets: [[f64; 2]; MAX_MANIFOLD_POINTS],
    pub(crate) separations: [f64; MAX_MANIFOLD_POINTS],
    pub(crate) friction: [f64; 2],
    pub(crate) radius: f64,
    pub(crate) rolling: f64,
    pub(crate) restitution: f64,
    /// The velocity of the second body against the first, in the middle, at which nothing slides;
    /// and how much of it there is along the normal too \[m/s\].
    pub(crate) slip_reference: Vec3<f64>,
    pub(crate) lag: Vec3<f64>,
    /// What is left of an overlap's push where effective masses have changed, from 0 to 1.
    pub(crate) steady: f64,
    /// Whether it is that of a ball, which is left to the next substep while it is apart.
    pub(crate) is_of_ball: bool,
    pub(crate) slides: bool,
    /// How fast the points came until they met in this substep \[m/s\].
    pub(crate) met: [f64; MAX_MANIFOLD_POINTS],
    /// The fastest that they came in this step before the contact held them \[m/s\].
    pub(crate) approach: [f64; MAX_MANIFOLD_POINTS],
    /// Energy that its points have taken from the bodies in this step \[J\].
    pub(crate) absorbed: f64,
    /// Impulses of this substep, row by row.
    pub(crate) impulses: [f64; MAX_CONTACT_ROWS],
}

impl DirectContact {
    pub(crate) fn new(number: u32, ends: [usize; 2]) -> Self {
        let zero = Vec3::zero();
        Self {
            number,
            ends,
            points: 0,
            normal: zero,
            tangents: [zero; 2],
            arms: [zero; 2],
            offsets: [[0.0; 2]; MAX_MANIFOLD_POINTS],
            separations: [0.0; MAX_MANIFOLD_POINTS],
            friction: [0.0; 2],
            radius: 0.0,
            rolling: 0.0,
            restitution: 0.0,
            slip_reference: zero,
            lag: zero,
            steady: 1.0,
            is_of_ball: false,
            slides: false,
            met: [0.0; MAX_MANIFOLD_POINTS],
            approach: [0.0; MAX_MANIFOLD_POINTS],
            absorbed: 0.0,
            impulses: [0.0; MAX_CONTACT_ROWS],
        }
    }

    /// Its rows in a problem, from one on.
    pub(crate) fn shape(&self, first: usize) -> ContactShape {
        let Self { points, friction, radius, rolling, slides, .. } = *self;
        ContactShape { first, points, friction, radius, rolling, slides, inverse: [[0.0; 3]; 3] }
    }

    /// How many rows it has.
    pub(crate) fn rows(&self) -> usize {
        self.shape(0).rows()
    }

    /// Along what a row pushes the second body in the middle, and about what it turns it besides.
    pub(crate) fn row(&self, row: usize) -> [Vec3<f64>; 2] {
        let ([first, second], zero) = (self.tangents, Vec3::zero());
        match self.offsets[..self.points].get(row) {
            Some([a, b]) => [self.normal, first * *b - second * *a],
            None => match row - self.points + if self.radius > 0.0 || row < self.points + 2 { 0 } else { 1 } {
                0 => [first, zero],
                1 => [second, zero],
                2 => [zero, self.normal],
                3 => [zero, first],
                _ => [zero, second],
            },
        }
    }

    /// The impulse and the angular impulse on the second body of impulses along the rows.
    pub(crate) fn impulse(&self, along: &[f64]) -> [Vec3<f64>; 2] {
        along.iter().enumerate().fold([Vec3::zero(); 2], |[linear, angular], (row, amount)| {
            let [push, turn] = self.row(row);
            [linear + push * *amount, angular + turn * *amount]
        })
    }

    /// The speeds of its rows by linear and angular velocities of bodies.
    pub(crate) fn speeds(&self, velocities: impl Fn(usize) -> [Vec3<f64>; 2]) -> [f64; MAX_CONTACT_ROWS] {
        let [[first, turn_of_first], [second, turn_of_second]] = self.ends.map(velocities);
        let at_first = first + turn_of_first.cross(self.arms[0]);
        let apart = second + turn_of_second.cross(self.arms[1]) - at_first;
        let turn = turn_of_second - turn_of_first;
        let mut speeds = [0.0; MAX_CONTACT_ROWS];
        for (row, speed) in speeds.iter_mut().enumerate().take(self.rows()) {
            let [push, about] = self.row(row);
            *speed = push.dot(apart) + about.dot(turn);
        }
        speeds
    }

    /// What an impulse and an angular one in the middle are to each of its bodies.
    pub(crate) fn pushes(&self, [linear, angular]: [Vec3<f64>; 2]) -> [Push; 2] {
        [0, 1].map(|end| {
            let torque = self.arms[end].cross(linear) + angular;
            Push { body: self.ends[end], linear: linear * SIGNS[end], torque: torque * SIGNS[end] }
        })
    }

    /// The sum of the impulses at the points.
    pub(crate) fn normal_impulse(&self) -> f64 {
        self.impulses[..self.points].iter().sum()
    }

    /// The work of impulses on one of its bodies that moves like this meanwhile \[J\].
    pub(crate) fn work_on(&self, end: usize, along: &[f64], [linear, angular]: [Vec3<f64>; 2]) -> f64 {
        let push = self.pushes(self.impulse(along))[end];
        push.linear.dot(linear) + push.torque.dot(angular)
    }
}
