//! The velocity of a chassis at the end of a step, with all its springs and tyres at once.

use tumble::glam::{DMat3, DVec3};

use crate::rigid::Chassis;
use crate::settings::{AntiRollBar, Motor};
use crate::wheel_step::{Motion, Row, WheelStep};

/// How often the laws of springs and tyres are made straight at the most.
pub(crate) const ITERATIONS: usize = 8;

/// No more of them where the velocity changes by less than this part of that of a step of fall.
const SOLVED: f64 = 1e-6;

/// Equations of six velocities.
struct Equations {
    matrix: [[f64; 6]; 6],
    right: [f64; 6],
}

fn six(linear: DVec3, angular: DVec3) -> [f64; 6] {
    [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
}

impl Equations {
    /// Those of a body that only what acts on it beside the wheels moves.
    fn of(chassis: &Chassis, h: f64) -> Self {
        let mut matrix = [[0.0; 6]; 6];
        let inertia: DMat3 = chassis.inertia;
        for i in 0..3 {
            matrix[i][i] = chassis.mass;
            for j in 0..3 {
                matrix[3 + i][3 + j] = inertia.col(j)[i];
            }
        }
        let linear = chassis.body.linear * chassis.mass + chassis.force * h;
        let angular = inertia * chassis.body.angular + chassis.torque * h;
        Self { matrix, right: six(linear, angular) }
    }

    /// Adds a force along a row: `constant - slope speed of other`.
    fn add(&mut self, row: &Row, other: &Row, constant: f64, slope: f64, h: f64) {
        let (along, of) = (six(row.linear, row.angular), six(other.linear, other.angular));
        let constant = h * (constant + slope * other.ground);
        for (i, part) in along.iter().enumerate() {
            self.right[i] += part * constant;
            for (entry, speed) in self.matrix[i].iter_mut().zip(of) {
                *entry += h * slope * part * speed;
            }
        }
    }

    /// By elimination with the largest pivot; `None` where there is none, or numbers overflow.
    fn solve(mut self) -> Option<Motion> {
        for step in 0..6 {
            let size = |row: &usize| self.matrix[*row][step].abs();
            let pivot = (step..6).fold(step, |best, row| if size(&row) > size(&best) { row } else { best });
            self.matrix.swap(step, pivot);
            self.right.swap(step, pivot);
            let row = self.matrix[step];
            for below in step + 1..6 {
                let factor = self.matrix[below][step] / row[step];
                for (entry, above) in self.matrix[below].iter_mut().zip(row).skip(step) {
                    *entry -= factor * above;
                }
                self.right[below] -= factor * self.right[step];
            }
        }
        let mut found = [0.0; 6];
        for step in (0..6).rev() {
            let known: f64 = (step + 1..6).map(|i| self.matrix[step][i] * found[i]).sum();
            found[step] = (self.right[step] - known) / self.matrix[step][step];
        }
        let [x, y, z, a, b, c] = found;
        found
            .iter()
            .all(|it| it.is_finite())
            .then_some(Motion { linear: DVec3::new(x, y, z), angular: DVec3::new(a, b, c) })
    }
}

/// Springs of bars, between wheels that both stand on the ground or not.
fn bar_stiffness(wheels: &[WheelStep], bar: &AntiRollBar) -> (f64, bool) {
    let [a, b] = bar.wheels.map(|wheel| &wheels[wheel]);
    let stiffness = f64::from(bar.stiffness);
    let stands = |wheel: &WheelStep| wheel.footing.is_some() && wheel.suspension > 0.0;
    match (stands(a), stands(b)) {
        (true, true) => (stiffness, true),
        (is_a, _) => {
            // A wheel in the air is lifted by the bar against its own spring.
            let spring = f64::from(if is_a { b } else { a }.settings.suspension.stiffness);
            (stiffness * spring / (stiffness + spring), false)
        }
    }
}

/// Solves for the motion at the end of the step; the wheels then have its forces. `None` where the
/// numbers overflow.
pub(crate) fn solve(
    chassis: &Chassis,
    wheels: &mut [WheelStep],
    bars: &[AntiRollBar],
    motor: &Motor,
    (gravity, h): (f64, f64),
    iterations: usize,
) -> Option<Motion> {
    let mut motion = Motion::of(&chassis.body);
    // The radius of gyration turns angular velocities into velocities.
    let size = (chassis.inertia.x_axis.x.max(chassis.inertia.y_axis.y) / chassis.mass).sqrt();
    for wheel in wheels.iter_mut() {
        let speed = wheel.footing.map_or(0.0, |footing| -footing.normal.speed(&motion));
        wheel.suspension = wheel.spring(speed, 0.0, h).0;
    }
    for _ in 0..iterations {
        let mut equations = Equations::of(chassis, h);
        let springs = add_springs(&mut equations, wheels, bars, &motion, h);
        for wheel in wheels.iter_mut() {
            wheel.update_lines(&motion, motor, h, gravity);
            if let Some(footing) = &wheel.footing {
                for (row, line) in footing.tangents.iter().zip(wheel.lines) {
                    equations.add(row, row, line.offset, line.slope, h);
                }
            }
        }
        let before = motion;
        motion = equations.solve()?;
        take_springs(wheels, &springs, &motion);
        for wheel in wheels.iter_mut() {
            wheel.take_forces(&motion, motor, h);
        }
        let change = (motion.linear - before.linear).length() + (motion.angular - before.angular).length() * size;
        if change < SOLVED * (gravity * h + motion.linear.length() * 1e-3) {
            break;
        }
    }
    for wheel in wheels.iter_mut() {
        wheel.limit_forces(motor, h);
    }
    Some(motion)
}

/// The force of a wheel's suspension as a straight line of the speeds of all wheels.
#[derive(Clone, Default)]
struct SpringLine {
    constant: f64,
    /// Per speed of the other wheel of a bar.
    slopes: Vec<(usize, f64)>,
}

fn add_springs(
    equations: &mut Equations,
    wheels: &[WheelStep],
    bars: &[AntiRollBar],
    motion: &Motion,
    h: f64,
) -> Vec<SpringLine> {
    let mut lines = vec![SpringLine::default(); wheels.len()];
    let mut alone = vec![0.0; wheels.len()];
    let mut joined = Vec::new();
    for bar in bars {
        let (stiffness, is_joined) = bar_stiffness(wheels, bar);
        for (wheel, other) in [(bar.wheels[0], bar.wheels[1]), (bar.wheels[1], bar.wheels[0])] {
            alone[wheel] += stiffness;
            if is_joined {
                joined.push((wheel, other, stiffness));
            }
        }
    }
    for (index, wheel) in wheels.iter().enumerate() {
        let Some(footing) = &wheel.footing else { continue };
        let speed = -footing.normal.speed(motion);
        let (force, slope) = wheel.spring(speed, alone[index], h);
        let mut constant = force - slope * speed;
        let mut slopes = vec![(index, slope)];
        for (_, other, stiffness) in joined.iter().filter(|(wheel, ..)| *wheel == index) {
            if let Some(beside) = &wheels[*other].footing {
                constant -= stiffness * beside.compression;
                slopes.push((*other, -stiffness * h));
            }
        }
        let total: f64 = slopes.iter().map(|(other, slope)| -slope * speed_of(wheels, *other, motion)).sum();
        if slope == 0.0 || constant + total <= 0.0 {
            continue;
        }
        let given = h * slope * footing.normal.give;
        constant = (constant + given * footing.normal.before) / (1.0 + given);
        slopes.iter_mut().for_each(|(_, slope)| *slope /= 1.0 + given);
        equations.add(&footing.normal, &footing.normal, constant, 0.0, h);
        for (other, slope) in &slopes {
            if let Some(beside) = &wheels[*other].footing {
                equations.add(&footing.normal, &beside.normal, 0.0, *slope, h);
            }
        }
        lines[index] = SpringLine { constant, slopes };
    }
    lines
}

fn speed_of(wheels: &[WheelStep], wheel: usize, motion: &Motion) -> f64 {
    wheels[wheel].footing.map_or(0.0, |footing| footing.normal.speed(motion))
}

fn take_springs(wheels: &mut [WheelStep], lines: &[SpringLine], motion: &Motion) {
    let forces: Vec<f64> = lines
        .iter()
        .map(|line| {
            let sum: f64 = line.slopes.iter().map(|(other, slope)| slope * speed_of(wheels, *other, motion)).sum();
            (line.constant - sum).max(0.0)
        })
        .collect();
    for (wheel, force) in wheels.iter_mut().zip(forces) {
        wheel.suspension = force;
    }
}
