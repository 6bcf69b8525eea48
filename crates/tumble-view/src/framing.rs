//! What the camera looks at to begin with, and the grid below it.

use tumble::Totals;
use tumble::glam::{DVec2, DVec3};

use crate::bodies::{Bodies, DrawnBody, Placed};
use crate::camera::{Camera, Up, View};
use crate::lines::Line;

/// The camera stands so far around the upright axis and above the horizon \[rad\].
pub(crate) const YAW: f64 = 0.7;
pub(crate) const PITCH: f64 = 0.36;
/// Of more bodies than this, a few may stray so far that the others would be small: these are left
/// out of the frame.
const CROWD: usize = 20;
const OF_A_CROWD: f64 = 0.85;
const HARDLY_FARTHER: f64 = 1.5;
/// Around what is in the frame there is this much room.
const ROOM: f64 = 1.2;
/// Half the size of the smallest body that is seen well \[points\]: of a few bodies, and of a
/// crowd.
const SMALLEST: [f64; 2] = [5.0, 1.0];

/// Ground is level if its normal has this cosine with the axis that points up; and the grid is
/// drawn so far above it, in radii of the frame.
const LEVEL: f64 = 1.0 - 1e-9;
const ABOVE_GROUND: f64 = 1e-3;

/// Lines of the grid on either side of its middle, and into how many pieces each is cut, so that it
/// can fade.
const GRID_LINES: i32 = 24;
const GRID_COLOR: [f32; 3] = [0.62, 0.68, 0.78];

/// The axis that points up: against gravity; without it, along the angular momentum of several
/// bodies, which orbit around it.
pub(crate) fn up(gravity: DVec3, bodies: usize, totals: &Totals) -> Up {
    let around = if bodies > 1 { Up::along(totals.angular_momentum) } else { None };
    Up::along(gravity).or(around).unwrap_or(Up::Y)
}

/// A ball that holds the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// \[m\]
    pub(crate) middle: DVec3,
    pub(crate) radius: f64,
}

impl Frame {
    /// Around the bodies that move, or all where none does: ground may be far larger than what
    /// happens on it.
    pub(crate) fn of(bodies: &Bodies, places: &[Placed]) -> Self {
        let any_moves = bodies.all.iter().any(|body| body.moves);
        let is_seen = |body: &DrawnBody| !body.endless && (body.moves || !any_moves);
        let seen = || bodies.all.iter().zip(places).filter(|(body, _)| is_seen(body));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (body, placed) in seen() {
            low = low.min(placed.center - body.reach);
            high = high.max(placed.center + body.reach);
        }
        let middle = 0.5 * (low + high);
        if !middle.is_finite() {
            return Self { middle: DVec3::ZERO, radius: 1.0 };
        }
        let away = |(body, placed): (&DrawnBody, &Placed)| (placed.center - middle).length() + body.reach;
        let mut distances: Vec<f64> = seen().map(away).collect();
        distances.sort_by(f64::total_cmp);
        let share = if distances.len() > CROWD { OF_A_CROWD } else { 1.0 };
        let last = (share * (distances.len().saturating_sub(1)) as f64).ceil() as usize;
        let of_most = distances.get(last).copied().unwrap_or_default();
        // A kinematic body does not stray, and what is hardly farther away has not strayed.
        let told = seen().filter(|(body, _)| body.moves && body.mass == 0.0).map(away).fold(of_most, f64::max);
        let all = distances.last().copied().filter(|all| *all <= HARDLY_FARTHER * of_most).unwrap_or_default();
        let radius = of_most.max(told).max(all);
        Self { middle, radius: if radius > 0.0 && radius.is_finite() { radius } else { 1.0 } }
    }

    /// A camera that sees it all.
    pub(crate) fn camera(&self, up: Up, size: DVec2) -> Camera {
        let distance = Camera::distance_for(ROOM * self.radius, size);
        Camera { up, yaw: YAW, pitch: PITCH, distance, target: self.middle }
    }
}

/// By what a body is enlarged to be seen at all: planets beside their orbits.
pub(crate) fn enlargement(view: &View, center: DVec3, reach: f64, bodies: usize) -> f64 {
    let smallest = if bodies > 10 * CROWD { SMALLEST[1] } else { SMALLEST[0] };
    (smallest * view.metres_per_point(center) / reach.max(f64::MIN_POSITIVE)).max(1.0)
}

/// A horizontal grid below the bodies, its lines a round number of metres apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    /// \[m\]
    pub(crate) spacing: f64,
    /// Of the grid, along the axis that points up \[m\].
    pub(crate) height: f64,
}

impl Grid {
    /// Below what is in a frame now. Where the bodies go down there is another grid below, a few
    /// lines' distance each.
    pub(crate) fn below(frame: &Frame, start: &Frame, up: Up) -> Self {
        let spacing = round_below(frame.radius / 3.0);
        let bottom = |frame: &Frame| frame.middle.dot(up.axis()) - 1.05 * frame.radius;
        // The first lies just below the start, so that nothing moves it but what goes through it.
        let (first, apart) = (bottom(start), 10.0 * spacing);
        let below = ((first - bottom(frame)) / apart).ceil().max(0.0);
        Self { spacing, height: first - below * apart }
    }

    /// The same on ground, given by a place and the normal, if any of it is level.
    pub(crate) fn on_ground(self, frame: &Frame, up: Up, grounds: &[(DVec3, DVec3)]) -> Self {
        let level = grounds.iter().find(|(_, normal)| normal.dot(up.axis()) > LEVEL);
        level.map_or(self, |(place, _)| Self { height: place.dot(up.axis()) + ABOVE_GROUND * frame.radius, ..self })
    }

    /// Lines around the place above which the frame is, fading with the distance from there.
    pub(crate) fn lines(&self, frame: &Frame, up: Up) -> Vec<Line> {
        let [first, second] = up.horizon();
        let center = [first, second].map(|axis| (frame.middle.dot(axis) / self.spacing).round());
        let half = f64::from(GRID_LINES);
        let point = |[a, b]: [f64; 2]| {
            up.axis() * self.height + (first * (center[0] + a) + second * (center[1] + b)) * self.spacing
        };
        let color = |place: [f64; 2], is_tenth: bool| {
            let far = (place[0].hypot(place[1]) / half).min(1.0);
            let strength = if is_tenth { 0.36 } else { 0.17 };
            let [red, green, blue] = GRID_COLOR;
            [red, green, blue, strength * (1.0 - far * far) as f32]
        };
        let mut lines = Vec::new();
        for across in -GRID_LINES..=GRID_LINES {
            for turned in [false, true] {
                let number = center[usize::from(turned)] + f64::from(across);
                let is_tenth = number.rem_euclid(10.0) < 0.5;
                let place = |along: i32| {
                    let place = [f64::from(across), f64::from(along)];
                    if turned { [place[1], place[0]] } else { place }
                };
                for along in -GRID_LINES..GRID_LINES {
                    let [from, to] = [place(along), place(along + 1)];
                    let [from_color, to_color] = [from, to].map(|place| color(place, is_tenth));
                    if from_color[3] > 0.0 || to_color[3] > 0.0 {
                        lines.push(Line { from: point(from), to: point(to), from_color, to_color, width: 1.0 });
                    }
                }
            }
        }
        lines
    }
}

/// The largest of 1, 2, 5, 10, 20 .. that is not above a number.
fn round_below(number: f64) -> f64 {
    let power = 10.0_f64.powf(number.log10().floor());
    [5.0, 2.0].into_iter().find(|step| step * power <= number).unwrap_or(1.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_is_against_gravity_or_around_the_orbits() {
        let totals = Totals { angular_momentum: DVec3::new(1.0, -2.0, 30.0), ..Totals::default() };
        assert_eq!(up(DVec3::new(0.0, 0.0, -9.81), 1, &totals), Up::Z);
        assert_eq!(up(DVec3::ZERO, 9, &totals), Up::Z);
        // One that tumbles about its axis does not orbit.
        assert_eq!(up(DVec3::ZERO, 1, &totals), Up::Y);
    }

    #[test]
    fn spacing_is_round() {
        for (number, expected) in [(1.0, 1.0), (4.9, 2.0), (0.07, 0.05), (9.99e11, 5e11)] {
            assert!((round_below(number) / expected - 1.0).abs() < 1e-12, "{number}: {}", round_below(number));
        }
    }

    #[test]
    fn the_grid_is_below_also_of_what_falls() {
        let start = Frame { middle: DVec3::new(3.0, 5.0, 0.0), radius: 2.0 };
        let first = Grid::below(&start, &start, Up::Y);
        assert_eq!(first.spacing, 0.5);
        assert!((first.height - 2.9).abs() < 1e-12);
        for fallen in [1.0, 17.0, 490.0] {
            let frame = Frame { middle: start.middle - DVec3::Y * fallen, radius: 2.0 };
            let grid = Grid::below(&frame, &start, Up::Y);
            let clearance = frame.middle.y - frame.radius - grid.height;
            // Below, but not by more than the distance between two of them.
            assert!((0.0..=5.2).contains(&clearance), "{clearance}");
        }
    }

    #[test]
    fn grid_lines_lie_in_the_plane_at_round_places() {
        let frame = Frame { middle: DVec3::new(0.3, 100.0, -0.2), radius: 2.0 };
        let grid = Grid { spacing: 0.5, height: -1.0 };
        let lines = grid.lines(&frame, Up::Y);
        assert!(lines.len() > 2000, "{}", lines.len());
        for line in &lines {
            assert_eq!((line.from.y, line.to.y), (-1.0, -1.0));
            let is_round = |x: f64| (x / 0.5 - (x / 0.5).round()).abs() < 1e-9;
            assert!([line.from.x, line.from.z, line.to.x, line.to.z].into_iter().all(is_round), "{line:?}");
        }
    }
}
