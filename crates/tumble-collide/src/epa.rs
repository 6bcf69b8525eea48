//! The shortest way out for two convex shapes that overlap.
//!
//! G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", GDC 2001: a polyhedron inside the difference of the shapes grows
//! where its surface is nearest to the origin, until it has the difference's own surface there.

use crate::convex::Vector;
use crate::gjk::{Simplex, on_triangle};
use crate::minkowski::{Difference, Reached};

/// Where two shapes overlap least: the unit normal from the first to the second, and the point of the first that is deepest in the second.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Penetration {
    pub(crate) normal: Vector,
    pub(crate) on_first: Vector,
}

/// Polyhedra end by themselves after a few dozen points; round shapes are as round as can be told after this many.
const MOST_POINTS: usize = 256;
/// Part of what the difference reaches that a point must add to the polyhedron to be worth it. The normal of round shapes is good to its square root.
const GAIN: f64 = 1e-11;
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
}

/// `None` where the difference is flat, and where numbers are not finite.
pub(crate) fn penetration(shapes: &Difference<'_>, simplex: &Simplex) -> Option<Penetration> {
    let mut polyhedron = Polyhedron::around(shapes, simplex)?;
    let mut outline = Vec::new();
    let mut best: Option<(f64, Vector)> = None;
    while let Some(face) = polyhedron.nearest() {
        let reached = shapes.support(face.normal);
        // This far the shapes overlap along the normal; the face is no further out than the least overlap of all.
        let overlap = reached.point.dot(face.normal);
        if best.is_none_or(|(least, _)| overlap < least) {
            best = Some((overlap, face.normal));
        }
        if overlap - face.distance <= GAIN * polyhedron.scale || polyhedron.points.len() >= MOST_POINTS {
            break;
        }
        polyhedron.grow(reached, &mut outline);
    }
    best.map(|(overlap, normal)| Penetration { normal, on_first: polyhedron.foot(normal * overlap) })
}

impl Polyhedron {
    /// A tetrahedron that has the simplex's corners.
    fn around(shapes: &Difference<'_>, simplex: &Simplex) -> Option<Self> {
        let mut points: Vec<Reached> = simplex.corners().collect();
        let scale = AXES.iter().fold(0.0, |scale, axis| {
            let both = [shapes.support(*axis).point, shapes.support(*axis * -1.0).point];
            both.iter().fold(scale, |scale, point| f64::max(scale, point.dot(*point)))
        });
        let scale = scale.sqrt();
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
        let mut this = Self { points, faces: Vec::new(), scale };
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

    fn nearest(&self) -> Option<Face> {
        let mut best: Option<&Face> = None;
        for face in self.faces.iter().filter(|face| face.distance < f64::INFINITY) {
            if best.is_none_or(|best| face.distance < best.distance) {
                best = Some(face);
            }
        }
        best.copied()
    }

    /// The point of the first shape at the place of the surface that is nearest to a given one. Where the difference is flat, several faces have the distance of the
    /// nearest, and one of them has the place.
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

    /// Takes away the faces that a point outside sees, and joins their outline with it.
    fn grow(&mut self, reached: Reached, outline: &mut Vec<[u32; 2]>) {
        outline.clear();
        let least = 0.5 * GAIN * self.scale;
        let mut kept = 0;
        for index in 0..self.faces.len() {
            let face = self.faces[index];
            if self.above(&face, reached.point) <= least {
                self.faces[kept] = face;
                kept += 1;
                continue;
            }
            let [a, b, c] = face.corners;
            for [from, to] in [[a, b], [b, c], [c, a]] {
                // A side that two of them have is inside.
                match outline.iter().position(|side| *side == [to, from]) {
                    Some(place) => drop(outline.swap_remove(place)),
                    None => outline.push([from, to]),
                }
            }
        }
        self.faces.truncate(kept);
        let point = self.points.len() as u32;
        self.points.push(reached);
        for &[from, to] in outline.iter() {
            self.add([from, to, point]);
        }
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
