//! The shortest way out for two convex shapes that overlap.
//!
//! G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", GDC
//! 2001: a polyhedron inside the difference of the shapes grows where its surface is nearest to the
//! origin, until it has the difference's own surface there.

use crate::common_normal::common_normal;
use crate::gjk::{Nearest, Simplex, nearest, on_triangle};
use crate::minkowski::{Difference, Reached};
use crate::support_map::{Vector, unit};
use crate::work;

/// Where two shapes overlap least: the unit normal from the first to the second, and the point of
/// the first that is deepest in the second.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Penetration {
    pub(crate) normal: Vector,
    pub(crate) on_first: Vector,
}

/// Polyhedra end by themselves after a few dozen points; round shapes are as round as can be told
/// after this many.
const MAX_MANIFOLD_POINTS: usize = 256;
/// Faces tested and sides compared, at most. A polyhedron of n points has 2 n faces, each of which
/// may be tested for every point.
const MAX_WORK: usize = 1 << 18;
/// What is not certain, of round shapes and where faces were so thin that rounding tore the
/// surface, is refined this often at most,
const MAX_REFINEMENTS: usize = 8;
/// from this number of axes of both shapes too,
const MAX_STARTS: usize = 4;
/// with the shapes moved apart by this part of what the difference reaches.
const GAP: f64 = 1e-4;
/// Part of what the difference reaches that a point must add to the polyhedron to be worth it. The
/// normal of round shapes is good to its square root.
const GAIN: f64 = 1e-11;
/// A common normal of round shapes is taken where nothing is shorter by more than this part of what
/// the difference reaches.
const NEAR: f64 = 1e-7;
/// Part of it that is flat.
const FLAT: f64 = 1e-12;

#[derive(Clone, Copy, Debug)]
struct Face {
    corners: [u32; 3],
    /// Unit vector outwards; zero of a face that is a line.
    normal: Vector,
    /// From the origin along the normal; infinite of a face that is a line.
    distance: f64,
}

struct Polyhedron {
    points: Vec<Reached>,
    faces: Vec<Face>,
    scale: f64,
    /// Faces tested and sides compared.
    work: usize,
}

/// `None` where the difference is flat, and where numbers are not finite. Whatever rounding does,
/// the shapes overlap along the normal by no less than is reported, and it is no longer than any
/// other way out that was tried.
pub(crate) fn penetration(shapes: &Difference<'_>, simplex: &Simplex) -> Option<Penetration> {
    let mut polyhedron = Polyhedron::around(shapes, simplex)?;
    let mut outline = Outline::default();
    let mut best: Option<(f64, Vector)> = None;
    let mut is_certain = true;
    let mut next_try = if shapes.has_round_core() { 0 } else { usize::MAX };
    for _ in 0..2 * MAX_MANIFOLD_POINTS {
        let Some((index, face)) = polyhedron.nearest() else { break };
        let least = best.map_or(f64::INFINITY, |(least, _)| least);
        if least - face.distance <= GAIN * polyhedron.scale {
            break;
        }
        let reached = shapes.support(face.normal);
        // This far the shapes overlap along the normal; the face is no further out than the least
        // overlap of all.
        let overlap = reached.point.dot(face.normal);
        if overlap < least {
            best = Some((overlap, face.normal));
        }
        if overlap - face.distance <= GAIN * polyhedron.scale {
            break;
        }
        let least = f64::min(least, overlap);
        let bound = face.distance + NEAR * polyhedron.scale;
        if is_certain && least <= bound && polyhedron.points.len() >= next_try {
            next_try = polyhedron.points.len() * 3 / 2;
            let corners = face.corners.map(|corner| polyhedron.points[corner as usize]);
            let found = common_normal(shapes, face.normal, corners.into_iter());
            if let Some(found) = found.filter(|found| -found.separation <= f64::min(bound, least)) {
                work::compared(polyhedron.work);
                return Some(Penetration { normal: found.normal, on_first: found.on_first });
            }
        }
        if polyhedron.points.len() >= MAX_MANIFOLD_POINTS || polyhedron.work > MAX_WORK {
            is_certain = false;
            break;
        }
        if !polyhedron.grow(index, reached, &mut outline) {
            // As far out as it is, and no further.
            polyhedron.faces[index].distance = f64::max(overlap, face.distance);
            is_certain = false;
        }
    }
    work::compared(polyhedron.work);
    let (overlap, normal) = best?;
    let found = Penetration { normal, on_first: polyhedron.foot(normal * overlap) };
    Some(if is_certain { found } else { shortest(shapes, found, overlap, polyhedron.scale) })
}

/// The same where the difference is flat: along a normal, or near it where that is shorter.
pub(crate) fn penetration_of_flat(shapes: &Difference<'_>, normal: Vector) -> Penetration {
    let along = Penetration { normal, on_first: shapes.first.support(normal) };
    refined(shapes, along, -shapes.separation(normal), scale_of(shapes)).1
}

/// How far the difference reaches.
fn scale_of(shapes: &Difference<'_>) -> f64 {
    let square = AXES.iter().fold(0.0, |square, axis| {
        let both = [shapes.support(*axis).point, shapes.support(*axis * -1.0).point];
        both.iter().fold(square, |square, point| f64::max(square, point.dot(*point)))
    });
    square.sqrt()
}

/// The shortest way out of those near a given one and near the axes of both shapes.
fn shortest(shapes: &Difference<'_>, found: Penetration, overlap: f64, scale: f64) -> Penetration {
    work::uncertain();
    let mut best = refined(shapes, found, overlap, scale);
    let both_ways = |axis: &Vector| [*axis, *axis * -1.0];
    let axes = AXES.iter().chain(&shapes.axes).flat_map(both_ways);
    let mut starts: Vec<(f64, Vector)> = axes.map(|axis| (-shapes.separation(axis), axis)).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (overlap, normal) in starts.into_iter().take(MAX_STARTS) {
        let start = Penetration { normal, on_first: shapes.first.support(normal) };
        let next = refined(shapes, start, overlap, scale);
        if next.0 < best.0 - GAIN * scale {
            best = next;
        }
    }
    best.1
}

/// Moved apart along a way out, shapes are nearest to each other along one that is as short or
/// shorter.
fn refined(shapes: &Difference<'_>, mut found: Penetration, mut overlap: f64, scale: f64) -> (f64, Penetration) {
    for _ in 0..MAX_REFINEMENTS {
        let position = shapes.position + found.normal * (overlap + GAP * scale);
        let Nearest::Apart { between, on_first } = nearest(&Difference { position, ..*shapes }, f64::INFINITY) else {
            break;
        };
        let normal = unit(between);
        let next = -shapes.separation(normal);
        let is_better = next < overlap - GAIN * scale;
        if !is_better {
            break;
        }
        (found, overlap) = (Penetration { normal, on_first }, next);
    }
    (overlap, found)
}

/// The sides around some faces, and for each point where the one that starts there ends.
#[derive(Default)]
struct Outline {
    sides: Vec<[u32; 2]>,
    next: Vec<Option<u32>>,
}

impl Outline {
    /// Whether the sides go once around: one starts where another ends, and none is left over.
    fn is_closed(&mut self, points: usize) -> bool {
        self.next.clear();
        self.next.resize(points, None);
        for &[from, to] in &self.sides {
            match self.next.get_mut(from as usize) {
                Some(next @ None) => *next = Some(to),
                _ => return false,
            }
        }
        let Some(&[start, mut at]) = self.sides.first() else { return false };
        let mut count = 1;
        while at != start && count <= self.sides.len() {
            let Some(next) = self.next.get(at as usize).copied().flatten() else { return false };
            at = next;
            count += 1;
        }
        at == start && count == self.sides.len() && count > 2
    }
}

impl Polyhedron {
    /// A tetrahedron that has the simplex's corners.
    fn around(shapes: &Difference<'_>, simplex: &Simplex) -> Option<Self> {
        let mut points: Vec<Reached> = simplex.corners().collect();
        let scale = scale_of(shapes);
        if !scale.is_finite() {
            return None;
        }
        while points.len() < 4 {
            points.push(one_more(shapes, &points, FLAT.sqrt() * scale)?);
        }
        let p = |index: usize| points[index].point;
        let volume = (p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0));
        if volume > 0.0 {
            points.swap(1, 2);
        }
        let mut this = Self { points, faces: Vec::new(), scale, work: 0 };
        [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]].into_iter().for_each(|corners| this.add(corners));
        Some(this)
    }

    fn add(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|corner| self.points[corner as usize].point);
        let normal = (b - a).cross(c - a);
        let length = normal.dot(normal).sqrt();
        let face = if length > FLAT * FLAT * self.scale * self.scale {
            let normal = normal * (1.0 / length);
            Face { corners, normal, distance: normal.dot(a) }
        } else {
            Face { corners, normal: Vector::zero(), distance: f64::INFINITY }
        };
        self.faces.push(face);
    }

    fn nearest(&mut self) -> Option<(usize, Face)> {
        self.work += self.faces.len();
        let mut best: Option<(usize, &Face)> = None;
        for (index, face) in self.faces.iter().enumerate().filter(|(_, face)| face.distance < f64::INFINITY) {
            if best.is_none_or(|(_, best)| face.distance < best.distance) {
                best = Some((index, face));
            }
        }
        best.map(|(index, face)| (index, *face))
    }

    /// The point of the first shape at the place of the surface that is nearest to a given one.
    /// Where the difference is flat, several faces have the distance of the nearest, and one of
    /// them has the place.
    fn foot(&self, place: Vector) -> Vector {
        let mut best: Option<(f64, Vector)> = None;
        for face in &self.faces {
            let corners = face.corners.map(|corner| self.points[corner as usize]);
            let weights = on_triangle(corners.map(|corner| corner.point - place));
            let sum = |of: fn(&Reached) -> Vector| {
                corners.iter().zip(weights).fold(Vector::zero(), |sum, (corner, weight)| sum + of(corner) * weight)
            };
            let apart = sum(|corner| corner.point) - place;
            let square = apart.dot(apart);
            if best.is_none_or(|(least, _)| square < least) {
                best = Some((square, sum(|corner| corner.on_first)));
            }
        }
        best.map_or(place, |(_, on_first)| on_first)
    }

    fn above(&self, face: &Face, point: Vector) -> f64 {
        face.normal.dot(point - self.points[face.corners[0] as usize].point)
    }

    /// Takes away the faces that a point outside sees, that of the index among them, and joins
    /// their outline with it. `false`, and all stays as it is, where the outline does not go once
    /// around: faces too thin to have a normal are not seen as they should be.
    fn grow(&mut self, index: usize, reached: Reached, outline: &mut Outline) -> bool {
        outline.sides.clear();
        let least = 0.5 * GAIN * self.scale;
        self.work += self.faces.len();
        for face in &self.faces {
            if self.above(face, reached.point) <= least {
                continue;
            }
            let [a, b, c] = face.corners;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                self.work += outline.sides.len();
                // A side that two of them have is inside.
                match outline.sides.iter().position(|side| *side == [to, from]) {
                    Some(place) => drop(outline.sides.swap_remove(place)),
                    None => outline.sides.push([from, to]),
                }
            }
            if self.work > MAX_WORK {
                return false;
            }
        }
        let is_seen = self.faces.get(index).is_some_and(|face| self.above(face, reached.point) > least);
        if !is_seen || !outline.is_closed(self.points.len()) {
            return false;
        }
        let mut faces = std::mem::take(&mut self.faces);
        faces.retain(|face| self.above(face, reached.point) <= least);
        self.faces = faces;
        let point = self.points.len() as u32;
        self.points.push(reached);
        for &[from, to] in &outline.sides {
            self.add([from, to, point]);
        }
        true
    }
}

const AXES: [Vector; 3] =
    [Vector { x: 1.0, y: 0.0, z: 0.0 }, Vector { x: 0.0, y: 1.0, z: 0.0 }, Vector { x: 0.0, y: 0.0, z: 1.0 }];

/// A point of the difference that is not on the point, the line or the plane of those there are.
fn one_more(shapes: &Difference<'_>, points: &[Reached], least: f64) -> Option<Reached> {
    let first = points.first()?.point;
    let off = |reached: &Reached| {
        let apart = reached.point - first;
        match points {
            [_] => apart.dot(apart).sqrt(),
            [_, b] => {
                let along = b.point - first;
                let across = along.cross(apart);
                across.dot(across).sqrt() / along.dot(along).sqrt()
            }
            [_, b, c, ..] => {
                let normal = (b.point - first).cross(c.point - first);
                (normal.dot(apart) / normal.dot(normal).sqrt()).abs()
            }
            [] => 0.0,
        }
    };
    let directions: Vec<Vector> = match points {
        [_, b, c, ..] => {
            let normal = (b.point - first).cross(c.point - first);
            vec![normal, normal * -1.0]
        }
        [_, b] => {
            let along = b.point - first;
            AXES.iter().flat_map(|axis| [along.cross(*axis), along.cross(*axis) * -1.0]).collect()
        }
        _ => AXES.iter().flat_map(|axis| [*axis, *axis * -1.0]).collect(),
    };
    let mut best: Option<(f64, Reached)> = None;
    for direction in directions.into_iter().filter(|direction| direction.dot(*direction) > 0.0) {
        let reached = shapes.support(direction);
        let far = off(&reached);
        if far > least && best.is_none_or(|(most, _)| far > most) {
            best = Some((far, reached));
        }
    }
    best.map(|(_, reached)| reached)
}
