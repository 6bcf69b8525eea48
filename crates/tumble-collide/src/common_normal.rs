//! The common normal of two shapes near a direction, by Newton's method: what is left of a search
//! among points of round shapes, which comes nearer by a part of the rest with each point.
//!
//! A surface is made of patches that are smooth as functions of their normal. Where two patches of
//! a shape reach equally far, normals lie on a circle; where three do, there is one.

use crate::frustum::Frustum;
use crate::gjk::on_triangle;
use crate::minkowski::{Difference, Reached};
use crate::segments::in_box;
use crate::support_map::{Convex, Vector, unit};
use crate::underside::axes_across;

/// Where two shapes have a normal in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CommonNormal {
    /// Unit vector from the first to the second.
    pub(crate) normal: Vector,
    /// Along the normal \[m\]; negative where they overlap.
    pub(crate) separation: f64,
    /// Of the first, the point that is nearest to the second.
    pub(crate) on_first: Vector,
}

/// Newton's method doubles the digits with each step.
const MAX_STEPS: usize = 6;
/// Further than this \[rad\] the surfaces are not what they are at the beginning.
const MAX_TURN: f64 = 0.3;
/// Nearest points are beside the normal by no more than this part of how far the second shape's
/// origin and the first shape's surface are from the origin of the first.
const BESIDE: f64 = 2e-12;
/// Of the square of a unit vector.
const ROUNDING: f64 = 1e-12;
/// A normal that was one a moment ago is of two patches where its cosine is off their circle by no
/// more than this.
const RING_WIDTH: f64 = 0.02;
/// Axes of circles, and lines, are parallel where the square of the sine between them is no more.
const PARALLEL: f64 = 1e-16;

/// A piece of a surface that has one point for each normal.
#[derive(Clone, Copy, Debug)]
enum Patch {
    Corner(Vector),
    Ball {
        center: Vector,
        radius: f64,
    },
    /// About y.
    Rim {
        radius: f64,
        height: f64,
    },
    Ellipsoid(Vector),
}

/// Normals that have this cosine with a unit vector.
#[derive(Clone, Copy, Debug)]
struct Ring {
    axis: Vector,
    cosine: f64,
}

/// The patches of a shape that reach furthest in a direction.
#[derive(Clone, Copy, Debug)]
enum Side {
    One(Patch),
    Two([Patch; 2], Ring),
}

impl Patch {
    fn support(&self, d: Vector) -> Vector {
        match *self {
            Self::Corner(point) => point,
            Self::Ball { center, radius } => center + d * radius,
            Self::Rim { radius, height } => {
                let around = (d.x * d.x + d.z * d.z).sqrt();
                let part = if around > 0.0 { radius / around } else { 0.0 };
                Vector::new(d.x * part, height, d.z * part)
            }
            Self::Ellipsoid(radii) => Convex::Ellipsoid { radii }.support(d),
        }
    }

    /// How the support point moves along `b` when a unit normal turns along `a`, both tangents.
    fn curvature(&self, d: Vector, a: Vector, b: Vector) -> f64 {
        match *self {
            Self::Corner(_) => 0.0,
            Self::Ball { radius, .. } => radius * a.dot(b),
            Self::Rim { radius, .. } => {
                let square = d.x * d.x + d.z * d.z;
                let across = Vector::new(-d.z, 0.0, d.x);
                if square > 0.0 { radius * across.dot(a) * across.dot(b) / (square * square.sqrt()) } else { 0.0 }
            }
            Self::Ellipsoid(radii) => {
                let [scaled, a, b] = [d, a, b].map(|v| radii.scale(v));
                let square = scaled.dot(scaled);
                (a.dot(b) - scaled.dot(a) * scaled.dot(b) / square) / square.sqrt()
            }
        }
    }
}

impl Side {
    /// Of a shape, the patches that points of it are on, where those are known to `rounding` \[m\];
    /// `None` where it has a face there.
    fn of(shape: &Convex<'_>, points: impl Iterator<Item = Vector>, rounding: f64) -> Option<Self> {
        match *shape {
            Convex::Point => Some(Self::One(Patch::Corner(Vector::zero()))),
            Convex::Ellipsoid { radii } => Some(Self::One(Patch::Ellipsoid(radii))),
            Convex::Tapered { radii, half_height } => {
                let (ends, ring) = tapered_patches(radii, half_height);
                let off = |point: Vector, end: &Patch| match *end {
                    Patch::Ball { center, radius } => ((point - center).dot(point - center).sqrt() - radius).abs(),
                    _ => 0.0,
                };
                Self::of_ends(ends, ring, points.map(|point| off(point, &ends[1]) < off(point, &ends[0])))
            }
            Convex::Frustum(frustum) => {
                let (ends, ring) = frustum_patches(frustum);
                Self::of_ends(ends, ring, points.map(|point| point.y > 0.0))
            }
            Convex::Segment { .. }
            | Convex::Cuboid { .. }
            | Convex::Hull(_)
            | Convex::SmallerHull(..)
            | Convex::Triangle(_) => Self::of_corners(points, rounding),
        }
    }

    /// The patches that a unit vector is normal to, nearly.
    fn near(shape: &Convex<'_>, d: Vector) -> Option<Self> {
        let is_across = |along: f64| along.abs() <= RING_WIDTH;
        let of_ends = |ends: [Patch; 2], ring: Ring| {
            let above = d.dot(ring.axis) - ring.cosine;
            if is_across(above) { Self::Two(ends, ring) } else { Self::One(ends[usize::from(above > 0.0)]) }
        };
        match *shape {
            Convex::Point => Some(Self::One(Patch::Corner(Vector::zero()))),
            Convex::Ellipsoid { radii } => Some(Self::One(Patch::Ellipsoid(radii))),
            Convex::Tapered { radii, half_height } => {
                let (ends, ring) = tapered_patches(radii, half_height);
                Some(of_ends(ends, ring))
            }
            Convex::Frustum(frustum) => {
                let (ends, ring) = frustum_patches(frustum);
                Some(of_ends(ends, ring))
            }
            Convex::Segment { .. } | Convex::Cuboid { .. } => {
                let corner = shape.support(d);
                let edges = [(d.x, corner.x), (d.y, corner.y), (d.z, corner.z)];
                let mut flat = (0..3).filter(|axis| edges[*axis].1 != 0.0 && is_across(edges[*axis].0));
                let (first, second) = (flat.next(), flat.next());
                let axis = |which: usize| [Vector::new(1.0, 0.0, 0.0), UP, Vector::new(0.0, 0.0, 1.0)][which];
                match (first, second) {
                    (None, _) => Some(Self::One(Patch::Corner(corner))),
                    (Some(which), None) => {
                        let other = corner - axis(which) * (2.0 * edges[which].1);
                        let ring = Ring { axis: axis(which), cosine: 0.0 };
                        Some(Self::Two([corner, other].map(Patch::Corner), ring))
                    }
                    _ => None,
                }
            }
            Convex::Hull(_) | Convex::SmallerHull(..) | Convex::Triangle(_) => {
                Some(Self::One(Patch::Corner(shape.support(d))))
            }
        }
    }

    fn of_ends(ends: [Patch; 2], ring: Ring, mut are_above: impl Iterator<Item = bool>) -> Option<Self> {
        let first = are_above.next()?;
        let is_one = are_above.all(|is_above| is_above == first);
        Some(if is_one { Self::One(ends[usize::from(first)]) } else { Self::Two(ends, ring) })
    }

    fn of_corners(mut points: impl Iterator<Item = Vector>, rounding: f64) -> Option<Self> {
        let are_one = |a: Vector, b: Vector| (a - b).dot(a - b) <= rounding * rounding;
        let first = points.next()?;
        let mut second = None;
        for point in points.filter(|point| !are_one(*point, first)) {
            match second {
                None => second = Some(point),
                Some(known) if are_one(known, point) => {}
                Some(_) => return None,
            }
        }
        let Some(second) = second else { return Some(Self::One(Patch::Corner(first))) };
        let ring = Ring { axis: unit(second - first), cosine: 0.0 };
        Some(Self::Two([first, second].map(Patch::Corner), ring))
    }

    fn first(&self) -> &Patch {
        match self {
            Self::One(patch) | Self::Two([patch, _], _) => patch,
        }
    }

    fn ring(&self) -> Option<Ring> {
        match self {
            Self::One(_) => None,
            Self::Two(_, ring) => Some(*ring),
        }
    }
}

/// Both balls, and normals of the side between them.
fn tapered_patches([below, above]: [f64; 2], half_height: f64) -> ([Patch; 2], Ring) {
    let end = |y: f64, radius: f64| Patch::Ball { center: Vector::new(0.0, y, 0.0), radius };
    let ring = Ring { axis: UP, cosine: (below - above) / (2.0 * half_height) };
    ([end(-half_height, below), end(half_height, above)], ring)
}

/// Both rims, and normals of the side between them.
fn frustum_patches(Frustum { radii: [below, above], half_height }: Frustum) -> ([Patch; 2], Ring) {
    let rim = |height: f64, radius: f64| Patch::Rim { radius, height };
    let slope = (below - above) / (2.0 * half_height);
    let ring = Ring { axis: UP, cosine: slope / (1.0 + slope * slope).sqrt() };
    ([rim(-half_height, below), rim(half_height, above)], ring)
}

const UP: Vector = Vector { x: 0.0, y: 1.0, z: 0.0 };

/// Near a unit vector from the first to the second, of shapes whose difference has these points
/// there; `None` where none is found.
pub(crate) fn common_normal(
    shapes: &Difference<'_>,
    near: Vector,
    reached: impl Iterator<Item = Reached> + Clone,
) -> Option<CommonNormal> {
    let on_first = reached.clone().map(|reached| reached.on_first);
    let on_second = reached.map(|reached| shapes.turned_back(reached.on_first - reached.point - shapes.position));
    let search = Search::new(shapes, near);
    let rounding = search.tolerance;
    let sides = Side::of(&shapes.first, on_first, rounding).zip(Side::of(&shapes.second, on_second, rounding));
    search.find(sides, near)
}

/// Near a unit vector that was a common normal a moment ago; `None` where nothing is round.
pub(crate) fn common_normal_again(shapes: &Difference<'_>, near: Vector) -> Option<CommonNormal> {
    if !shapes.has_round_core() {
        return None;
    }
    let outwards = shapes.turned_back(near * -1.0);
    let sides = Side::near(&shapes.first, near).zip(Side::near(&shapes.second, outwards));
    Search::new(shapes, near).find(sides, near)
}

struct Search<'a> {
    shapes: &'a Difference<'a>,
    /// How far nearest points may be beside the normal \[m\].
    tolerance: f64,
}

impl<'a> Search<'a> {
    fn new(shapes: &'a Difference<'a>, near: Vector) -> Self {
        let size = shapes.position.dot(shapes.position).sqrt() + shapes.first.support(near).dot(near).abs();
        Self { shapes, tolerance: BESIDE * size }
    }

    fn find(&self, sides: Option<(Side, Side)>, near: Vector) -> Option<CommonNormal> {
        let curved = sides.and_then(|(a, b)| self.between([a, b], near));
        curved.or_else(|| self.on_face_of_first(near)).or_else(|| self.on_face_of_second(near))
    }

    fn between(&self, sides: [Side; 2], near: Vector) -> Option<CommonNormal> {
        let [a, b] = sides;
        let of_second = b.ring().map(|ring| Ring { axis: self.shapes.turn(ring.axis), cosine: -ring.cosine });
        match (a.ring(), of_second) {
            (None, None) => self.finish(sides, self.newton(sides, near)?),
            (Some(ring), None) | (None, Some(ring)) => self.finish(sides, self.around(sides, ring, near)?),
            (Some(ring), Some(other)) => match crossing([ring, other], near) {
                Some(normal) => self.finish(sides, normal),
                None => self.side_by_side(sides, [ring, other], near),
            },
        }
    }

    /// Lines that are parallel are nearest at an end of one of them.
    fn side_by_side(&self, [a, b]: [Side; 2], [ring, other]: [Ring; 2], near: Vector) -> Option<CommonNormal> {
        let (Side::Two(of_first, _), Side::Two(of_second, _)) = (a, b) else { return None };
        let with = |sides: [Side; 2], ring: Ring| self.finish(sides, self.around(sides, ring, near)?);
        let of_second = of_second.into_iter().find_map(|patch| with([a, Side::One(patch)], ring));
        of_second.or_else(|| of_first.into_iter().find_map(|patch| with([Side::One(patch), b], other)))
    }

    /// The point of the difference where the first patches of both sides have a normal.
    fn reached(&self, [a, b]: &[Side; 2], normal: Vector) -> Vector {
        let outwards = self.shapes.turned_back(normal * -1.0);
        a.first().support(normal) - self.shapes.place(b.first().support(outwards))
    }

    /// How it moves along `to` when the normal turns along `from`.
    fn curvature(&self, [a, b]: &[Side; 2], normal: Vector, [from, to]: [Vector; 2]) -> f64 {
        let [outwards, own_from, own_to] = [normal * -1.0, from, to].map(|v| self.shapes.turned_back(v));
        a.first().curvature(normal, from, to) + b.first().curvature(outwards, own_from, own_to)
    }

    /// Of two patches.
    fn newton(&self, sides: [Side; 2], mut normal: Vector) -> Option<Vector> {
        for _ in 0..MAX_STEPS {
            let reached = self.reached(&sides, normal);
            let separation = -reached.dot(normal);
            let beside = reached + normal * separation;
            let [u, v] = axes_across(normal);
            let uu = self.curvature(&sides, normal, [u, u]) + separation;
            let uv = self.curvature(&sides, normal, [u, v]);
            let vv = self.curvature(&sides, normal, [v, v]) + separation;
            let determinant = uu * vv - uv * uv;
            // Anything else is not the least of what is near.
            let is_least = uu > 0.0 && determinant > 0.0;
            if !is_least {
                return None;
            }
            let (along_u, along_v) = (beside.dot(u), beside.dot(v));
            let turn = (u * (uv * along_v - vv * along_u) + v * (uv * along_u - uu * along_v)) * (1.0 / determinant);
            if beside.dot(beside) <= 0.25 * self.tolerance * self.tolerance {
                return Some(normal);
            }
            let is_near = turn.dot(turn) <= MAX_TURN * MAX_TURN;
            if !is_near {
                return None;
            }
            normal = unit(normal + turn);
        }
        None
    }

    /// Of patches of which one shape has two, with normals on a circle.
    fn around(&self, sides: [Side; 2], Ring { axis, cosine }: Ring, near: Vector) -> Option<Vector> {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let mut out = unit(near - axis * axis.dot(near));
        for _ in 0..MAX_STEPS {
            let (normal, along) = (axis * cosine + out * sine, axis.cross(out));
            let reached = self.reached(&sides, normal);
            let bend = self.curvature(&sides, normal, [along, along]) * sine - reached.dot(out);
            let beside = reached.dot(along);
            let is_least = bend > 0.0;
            if !is_least {
                return None;
            }
            if beside.abs() <= 0.5 * self.tolerance {
                return Some(normal);
            }
            let turn = -beside / bend;
            let is_near = turn.abs() <= MAX_TURN;
            if !is_near {
                return None;
            }
            out = unit(out + along * turn);
        }
        None
    }

    /// Where the nearest points of patches that have a normal in common are one beside the other,
    /// and nothing reaches further.
    fn finish(&self, sides: [Side; 2], normal: Vector) -> Option<CommonNormal> {
        let outwards = self.shapes.turned_back(normal * -1.0);
        let ends = |side: &Side, d: Vector| match side {
            Side::One(patch) => [patch.support(d); 2],
            Side::Two(patches, _) => patches.map(|patch| patch.support(d)),
        };
        let [first, other] = ends(&sides[0], normal);
        let [second, beyond] = ends(&sides[1], outwards).map(|point| self.shapes.place(point));
        let [along, across] = [other - first, second - beyond];
        let flat = |v: Vector| v - normal * normal.dot(v);
        let start = flat(first - second);
        let [part, part_of_second] = parts(start, [flat(along), flat(across)]);
        let on_first = first + along * part;
        self.checked(normal, on_first, second - across * part_of_second)
    }

    /// Of the point of one shape that is furthest out, over a face of the other.
    fn on_face_of_first(&self, near: Vector) -> Option<CommonNormal> {
        let normal = self.shapes.first.face_normal(near)?;
        let on_second = self.shapes.second_support(normal * -1.0);
        self.checked(normal, on_face(&self.shapes.first, normal, on_second)?, on_second)
    }

    fn on_face_of_second(&self, near: Vector) -> Option<CommonNormal> {
        let outwards = self.shapes.second.face_normal(self.shapes.turned_back(near * -1.0))?;
        let normal = self.shapes.turn(outwards) * -1.0;
        let on_first = self.shapes.first.support(normal);
        let own = self.shapes.turned_back(on_first - self.shapes.position);
        self.checked(normal, on_first, self.shapes.place(on_face(&self.shapes.second, outwards, own)?))
    }

    /// Points of both that are one beside the other along a normal that nothing is beyond.
    fn checked(&self, normal: Vector, on_first: Vector, on_second: Vector) -> Option<CommonNormal> {
        let apart = on_second - on_first;
        let along = apart.dot(normal);
        let beside = apart - normal * along;
        let separation = self.shapes.separation(normal);
        let is_unit = (normal.dot(normal) - 1.0).abs() <= ROUNDING;
        let is_common =
            beside.dot(beside) <= self.tolerance * self.tolerance && (along - separation).abs() <= self.tolerance;
        (is_unit && is_common).then_some(CommonNormal { normal, separation, on_first })
    }
}

/// Where two circles of normals cross, near a unit vector; `None` where they are parallel or have
/// no point in common.
fn crossing([a, b]: [Ring; 2], near: Vector) -> Option<Vector> {
    let across = a.axis.cross(b.axis);
    let (square, cosine) = (across.dot(across), a.axis.dot(b.axis));
    if square <= PARALLEL {
        return None;
    }
    let [along_a, along_b] = [(a.cosine - b.cosine * cosine) / square, (b.cosine - a.cosine * cosine) / square];
    let within = a.axis * along_a + b.axis * along_b;
    let rest = (1.0 - within.dot(within)) / square;
    let sign = if across.dot(near) < 0.0 { -1.0 } else { 1.0 };
    (rest >= 0.0).then(|| unit(within + across * (sign * rest.sqrt())))
}

/// The parts of two vectors that take a third nearest to zero, each from 0 to 1.
fn parts(start: Vector, [a, b]: [Vector; 2]) -> [f64; 2] {
    let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
    let (sa, sb) = (start.dot(a), start.dot(b));
    let determinant = aa * bb - ab * ab;
    let part = |along: f64, square: f64| if square > 0.0 { (-along / square).clamp(0.0, 1.0) } else { 0.0 };
    if determinant > PARALLEL * aa * bb {
        [part(sa * bb - sb * ab, determinant), part(sb * aa - sa * ab, determinant)]
    } else if aa > 0.0 {
        [part(sa, aa), 0.0]
    } else {
        [0.0, part(sb, bb)]
    }
}

/// The point of a face with this normal that is nearest to another, in the shape's frame.
fn on_face(shape: &Convex<'_>, normal: Vector, point: Vector) -> Option<Vector> {
    match *shape {
        Convex::Cuboid { half } => {
            let top = half.scale(normal);
            let flat = Vector::new(1.0, 1.0, 1.0) - normal.scale(normal);
            Some(top + in_box(point, half).scale(flat))
        }
        Convex::Frustum(frustum) => {
            let radius = frustum.radii[usize::from(normal.y > 0.0)];
            let around = (point.x * point.x + point.z * point.z).sqrt();
            let part = if around > radius { radius / around } else { 1.0 };
            Some(Vector::new(point.x * part, frustum.half_height * normal.y, point.z * part))
        }
        Convex::Triangle([a, b, c]) => {
            let corners = [a, b, c];
            let weights = on_triangle(corners.map(|corner| corner - point));
            Some(corners.iter().zip(weights).fold(Vector::zero(), |sum, (corner, weight)| sum + *corner * weight))
        }
        Convex::Hull(hull) => hull.on_face(normal, point),
        Convex::Point
        | Convex::Segment { .. }
        | Convex::Ellipsoid { .. }
        | Convex::Tapered { .. }
        | Convex::SmallerHull(..) => None,
    }
}
