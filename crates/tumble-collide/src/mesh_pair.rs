//! A surface of triangles against a convex shape, so that what slides over it does not stumble over
//! edges that are none.
//!
//! A triangle holds with its own normal what is over it. Over a side or a corner it holds only what
//! lies in the Voronoi region of that side or corner: in directions from which nothing else of the
//! surface is nearer. Where the surface is flat or hollow there are none.

use std::collections::HashMap;

use crate::aabb::Aabb;
use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::{Approach, FACE_LEAD, approach, difference, manifold_of, wide_placement, with_faces_first};
use crate::face_clipping::{AS_NEAR, FaceClipping, ON_THE_SIDE, as_near, is_corner_of_second};
use crate::gjk::on_triangle;
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::manifold_reduction::{keep_nearest, reduce};
use crate::minkowski::Difference;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, narrow, unit};
use crate::surface::Surface;
use crate::work;

/// Overlaps of no more than this part of the margin need no second look: the way out is the
/// triangle's own.
const SHALLOW: f64 = 0.05;
/// How far a direction may be outside of a Voronoi region, for rounding, as a sine.
const OUTSIDE: f64 = 1e-3;
/// Cosine of directions that are the same to a face and to an edge of it: within a thousandth of a
/// radian.
const SAME: f64 = 1.0 - 5e-7;
/// A direction is turned out of the way of one side at a corner after the other, this
/// number of times around.
const TURNS: usize = 4;
/// Most triangles at a corner that are tested against what lies over it.
const MAX_ASKED: usize = 64;
/// Most normals of faces of one part that are compared with that of an edge.
const MAX_NORMALS: usize = 16;
/// Of more points than this the near ones are found in a grid.
const FEW: usize = 64;
/// Weight of a corner in a point that is beside it.
const BESIDE: f64 = 1e-6;
/// Points nearer to each other than this \[m\], squared, are one.
const ONE_POINT: f64 = 1e-12;

/// A point of contact with a triangle, before those that belong together are collected.
#[derive(Clone, Copy, Debug)]
struct Hit {
    part: u32,
    normal: Vector,
    point: ContactPoint<f64>,
    carried: f64,
    /// Flat pieces that make this needless if they hold in the same direction.
    beside: Option<[u32; 3]>,
}

/// A side or a corner of a triangle.
#[derive(Clone, Copy, Debug)]
struct Place {
    part: u32,
    /// Flat pieces there.
    beside: [u32; 3],
    /// The side, twice, or both sides of the corner.
    sides: [usize; 2],
    corner: usize,
}

/// A convex shape over a surface, seen from the surface.
struct Over<'a, S> {
    surface: &'a S,
    shape: Convex<'a>,
    at: Isometry<f64>,
    layer: f64,
    margin: f64,
    /// The margin, or the size of the shape if that is less: what counts as small.
    small: f64,
    hits: Vec<Hit>,
    /// Where no other triangle holds: how far the shape is over the plane of the one that is left
    /// the soonest, and its points there.
    spare: Option<(f64, Vec<Hit>)>,
    /// Corners of many sides, by their parts, and how many triangles asked what lies over them.
    asked: HashMap<u32, usize>,
}

/// Shows the manifolds of a surface and a convex shape, from the former to the latter, each with
/// the number of the part of the surface it belongs to.
pub(crate) fn surface_and_convex<R: Scalar>(
    surface: &impl Surface,
    surface_at: &Isometry<R>,
    shape: &ColliderShape<R>,
    at: &Isometry<R>,
    margin: R,
    visit: &mut dyn FnMut(u32, &Manifold<R>),
) {
    let Some((shape, layer)) = Convex::of(shape) else { return };
    if !surface_at.is_somewhere() || !at.is_somewhere() {
        return;
    }
    let (ground, body) = (wide_placement(surface_at), wide_placement(at));
    let orientation = (ground.orientation.conjugate() * body.orientation).normalize();
    let at = Isometry { position: ground.to_local(body.position), orientation };
    let mut over = Over {
        surface,
        shape,
        at,
        layer,
        margin: margin.into(),
        small: margin.into(),
        hits: Vec::new(),
        spare: None,
        asked: HashMap::new(),
    };
    over.find();
    if let (true, Some((_, spare))) = (over.hits.is_empty(), over.spare.take()) {
        over.hits = spare;
    }
    over.collect(&mut |part, manifold| {
        let manifold =
            manifold.seen(|point| surface_at.to_world(narrow(point)), |v| surface_at.orientation.rotate(narrow(v)));
        visit(part, &manifold);
    });
}

/// How many numbers for parts a surface needs.
pub(crate) fn parts(surface: &impl Surface, points: usize) -> u32 {
    surface.patches().count() + 3 * surface.count() + points as u32
}

impl<S: Surface> Over<'_, S> {
    fn support(&self, d: Vector) -> Vector {
        self.at.to_world(self.shape.support(self.at.orientation.rotate_back(d)))
    }

    fn find(&mut self) {
        let reach = self.layer + self.margin;
        let far = |axis: Vector| axis.dot(self.support(axis)) + reach;
        let axes = [Vector::new(1.0, 0.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::new(0.0, 0.0, 1.0)];
        let [high, low] = [1.0, -1.0].map(|sign| axes.map(|axis| far(axis * sign) * sign));
        let corner = |[x, y, z]: [f64; 3]| Vector::new(x, y, z);
        let aabb = Aabb { low: corner(low), high: corner(high) };
        let size = aabb.high - aabb.low - Vector::splat(2.0 * self.margin);
        self.small = f64::min(self.margin, size.dot(size).sqrt());
        let mut near = Vec::new();
        self.surface.near(&aabb, &mut |triangle| near.push(triangle));
        near.sort_unstable();
        near.into_iter().for_each(|triangle| self.meet(triangle));
    }

    fn meet(&mut self, triangle: u32) {
        let corners = self.surface.triangle(triangle);
        let normal = self.surface.normal(triangle);
        let depth = normal.dot(self.support(normal * -1.0) - corners[0]) - self.layer;
        let middle = self.at.to_world(self.shape.middle());
        // What is behind, or nowhere, or a triangle without area.
        if !(depth <= self.margin && normal.dot(middle - corners[0]) > 0.0) {
            return;
        }
        let Some(shapes) = difference(Convex::Triangle(corners), &Isometry::at(Vector::zero()), self.shape, &self.at)
        else {
            return;
        };
        let over_face = self.over_face(triangle, &shapes, normal, depth);
        let least = over_face.iter().fold(f64::INFINITY, |least, hit| f64::min(least, hit.point.separation));
        let all_of_it = least <= depth + AS_NEAR * self.small;
        if !self.surface.patches().has_edge(triangle) || all_of_it && depth >= -SHALLOW * self.small {
            self.hits.extend(over_face);
            return;
        }
        match approach(&shapes, self.margin + self.layer) {
            Some(found) if found.between - self.layer <= depth + AS_NEAR * self.small && all_of_it => {
                self.hits.extend(over_face);
            }
            // What a side or a corner does not hold, a neighbour does.
            Some(found) => match self.place(triangle, &found) {
                Some(place) => self.over_edge(triangle, &place, &shapes, &found),
                None => self.beside_face(triangle, &shapes, &found, over_face),
            },
            None => {}
        }
    }

    /// Points over the triangle itself.
    fn over_face(&self, triangle: u32, shapes: &Difference<'_>, normal: Vector, depth: f64) -> Vec<Hit> {
        let face_clipping = FaceClipping { normal, separation: depth, layers: [0.0, self.layer], margin: self.margin };
        let below = shapes.second.feature(shapes.turned_back(normal * -1.0), self.margin);
        let below = below.seen(|point| shapes.place(point), |v| shapes.turn(v));
        let (mut points, carried) = face_clipping.shared(&shapes.first.feature(normal, self.margin), &below);
        let is_near = |point: &ContactPoint<f64>| point.separation <= depth + AS_NEAR * self.small;
        if !points.iter().any(is_near) {
            // The face that looks down most need not have the lowest corner.
            let lowest = self.support(normal * -1.0);
            if is_over(self.surface.triangle(triangle), normal, lowest) {
                let position = lowest - normal * (self.layer + 0.5 * depth);
                points.push(ContactPoint { position, separation: depth, feature: u32::MAX });
            }
        }
        points.into_iter().map(|point| self.face_hit(triangle, point, carried)).collect()
    }

    fn face_hit(&self, triangle: u32, mut point: ContactPoint<f64>, carried: f64) -> Hit {
        // What crosses a side of this triangle is not what crosses a side of another.
        if !is_corner_of_second(point.feature) {
            point.feature = point.feature.wrapping_add(triangle.wrapping_mul(0x9e37_79b1));
        }
        let (part, normal) = (self.surface.patches().of_triangle(triangle), self.surface.normal(triangle));
        Hit { part, normal, point, carried, beside: None }
    }

    /// Points over the triangle itself, where no side or corner holds and not all of the shape's
    /// nearest is over the triangle.
    fn beside_face(&mut self, triangle: u32, shapes: &Difference<'_>, found: &Approach, over_face: Vec<Hit>) {
        // Over the triangle's plane but beside the triangle nothing is nearer than the triangle
        // itself.
        let (overlaps, separation) = (found.between <= 0.0, found.between - self.layer);
        let before = self.hits.len();
        self.hits
            .extend(over_face.into_iter().filter(|hit| overlaps || hit.point.separation >= separation - FACE_LEAD));
        let is_near = |hit: &Hit| hit.point.separation <= separation + AS_NEAR * self.small;
        if overlaps && furthest(self.surface.triangle(triangle), found.normal) == [true; 3] {
            // The way out is the face's own as far as directions are certain, and what is deepest
            // is beside the face by no more than that.
            if !self.hits[before..].iter().any(is_near) {
                let position = found.on_first + self.surface.normal(triangle) * (0.5 * separation);
                let point = ContactPoint { position, separation, feature: u32::MAX };
                self.hits.push(self.face_hit(triangle, point, 0.5));
            }
        } else if self.hits.len() == before {
            self.keep_spare(triangle, shapes, found);
        }
    }

    /// Points over the side or the corner that an approach goes out from, if it may.
    fn over_edge(&mut self, triangle: u32, place: &Place, shapes: &Difference<'_>, found: &Approach) {
        let surface = self.surface;
        if place.sides[0] != place.sides[1] {
            // Each asks all sides at the corner, and of a corner that many triangles have each has
            // the same to say.
            let asked = self.asked.entry(place.part).or_default();
            *asked += 1;
            if *asked > MAX_ASKED {
                return;
            }
        }
        let settled = if self.layer > 0.0 { *found } else { with_faces_first(shapes, found) };
        // Where they overlap, what is shortest for a triangle alone may lie outside of the region:
        // then some direction at its border is nearly as short.
        let across = |side: usize| surface.across(triangle, side).map(|other| surface.normal(other));
        let borders = [Some(surface.normal(triangle)), across(place.sides[0]), across(place.sides[1])];
        let led_away = self.led_away(triangle, place, found.normal);
        let at_border = [Some(led_away)].into_iter().chain(borders).flatten().map(|normal| Approach {
            normal,
            between: shapes.separation(normal),
            ..*found
        });
        // A direction from a ball's centre is as good as can be.
        let lead = if self.layer > 0.0 { OUTSIDE * OUTSIDE } else { FACE_LEAD };
        let as_short = |approach: &Approach| approach.between >= found.between - lead;
        let mut ways = [settled, *found].into_iter().chain(at_border);
        let Some(way) = ways.find(|way| as_short(way) && self.leads_away(triangle, place, way.normal)) else {
            self.keep_spare(triangle, shapes, found);
            return;
        };
        let manifold = manifold_of(shapes, &way, [0.0, self.layer], self.margin);
        let (normal, carried) = (manifold.normal, manifold.carried);
        let hit = |point: &ContactPoint<f64>| Hit {
            part: place.part,
            normal,
            point: *point,
            carried,
            beside: Some(place.beside),
        };
        self.hits.extend(manifold.points().iter().map(hit));
    }

    /// Keeps a way out of a triangle whose own shortest way leads along the surface: that where it
    /// is short, or else through the face.
    fn keep_spare(&mut self, triangle: u32, shapes: &Difference<'_>, found: &Approach) {
        let is_shallow = found.between >= self.layer - SHALLOW * self.small;
        let normal = if is_shallow { found.normal } else { self.surface.normal(triangle) };
        let between = shapes.separation(normal);
        if found.between > 0.0 || self.spare.as_ref().is_some_and(|(most, _)| between <= *most) {
            return;
        }
        let manifold = manifold_of(shapes, &Approach { normal, between, ..*found }, [0.0, self.layer], self.margin);
        let part = self.surface.patches().of_triangle(triangle);
        let carried = manifold.carried;
        let hit = |point: &ContactPoint<f64>| Hit { part, normal, point: *point, carried, beside: None };
        self.spare = Some((between, manifold.points().iter().map(hit).collect()));
    }

    /// The side or corner that an approach goes out from, unless it goes out from the face or
    /// nothing sticks out there.
    fn place(&self, triangle: u32, found: &Approach) -> Option<Place> {
        let (surface, patches) = (self.surface, self.surface.patches());
        let across = |side| surface.across(triangle, side).map_or(u32::MAX, |other| patches.of_triangle(other));
        let own = patches.of_triangle(triangle);
        let corners = surface.triangle(triangle);
        let near = if found.between > 0.0 {
            on_triangle(corners.map(|corner| corner - found.on_first)).map(|weight| weight > BESIDE)
        } else {
            furthest(corners, found.normal)
        };
        let corner = near.iter().position(|near| *near)?;
        let sides = match near {
            [true, true, true] => return None,
            [true, true, false] => [0; 2],
            [false, true, true] => [1; 2],
            [true, false, true] => [2; 2],
            _ => [corner, (corner + 2) % 3],
        };
        let is_corner = sides[0] != sides[1];
        let is_sharp = if is_corner { patches.is_sharp(triangle, corner) } else { patches.is_edge(triangle, sides[0]) };
        if !is_sharp {
            return None;
        }
        let beside = [own, across(sides[0]), across(sides[1])];
        let part = patches.count()
            + if is_corner {
                3 * surface.count() + surface.corners(triangle)[corner]
            } else {
                self.side_number(triangle, sides[0])
            };
        Some(Place { part, beside, sides, corner })
    }

    /// The same from both triangles of a side.
    fn side_number(&self, triangle: u32, side: usize) -> u32 {
        let own = 3 * triangle + side as u32;
        let Some(other) = self.surface.across(triangle, side) else { return own };
        let back = (0..3).find(|back| self.surface.across(other, *back) == Some(triangle));
        back.map_or(own, |back| own.min(3 * other + back as u32))
    }

    /// Whether a direction out of a side or corner leads away from all of the surface there, to the
    /// outside.
    fn leads_away(&self, triangle: u32, place: &Place, out: Vector) -> bool {
        let [side, other] = place.sides;
        // Over a sharp edge it may look away from one of both faces.
        let looks_out = |normal: Vector| out.dot(normal) >= -OUTSIDE;
        let beyond =
            |side| self.surface.across(triangle, side).is_some_and(|next| looks_out(self.surface.normal(next)));
        let mut is_away = looks_out(self.surface.normal(triangle)) || beyond(side) || beyond(other);
        self.inwards(triangle, place, &mut |inwards| is_away &= out.dot(inwards) <= OUTSIDE);
        is_away
    }

    /// A direction out of a side or corner, turned until it leads away from all of the surface
    /// there, if that is not far.
    fn led_away(&self, triangle: u32, place: &Place, out: Vector) -> Vector {
        let mut led = out;
        for _ in 0..TURNS {
            self.inwards(triangle, place, &mut |inwards| {
                let along = led.dot(inwards);
                if along > 0.0 {
                    led = led - inwards * along;
                }
            });
        }
        unit(led)
    }

    /// Shows unit vectors from a side, along both triangles and across it, or from a corner along
    /// all sides.
    fn inwards(&self, triangle: u32, place: &Place, visit: &mut dyn FnMut(Vector)) {
        let corners = self.surface.triangle(triangle);
        let [side, other] = place.sides;
        if side != other {
            let corner = corners[place.corner];
            self.surface.corners_beside(self.surface.corners(triangle)[place.corner], &mut |end| {
                work::compared(1);
                visit(unit(self.surface.point(end) - corner));
            });
            return;
        }
        let (from, to) = (corners[side], corners[(side + 1) % 3]);
        let along = unit(to - from);
        for inside in [Some(corners[(side + 2) % 3]), self.surface.opposite(triangle, side)].into_iter().flatten() {
            let away = inside - from;
            visit(unit(away - along * along.dot(away)));
        }
    }

    /// Puts hits of a part together and shows the few that hold as all of them would.
    fn collect(&mut self, visit: &mut dyn FnMut(u32, &Manifold<f64>)) {
        let mut faces: Vec<(u32, Vector)> =
            self.hits.iter().filter(|hit| hit.beside.is_none()).map(|hit| (hit.part, hit.normal)).collect();
        faces.sort_by_key(|(part, _)| *part);
        faces.dedup();
        let is_held = |hit: &Hit| {
            hit.beside.is_some_and(|beside| {
                beside.into_iter().any(|part| {
                    let from = faces.partition_point(|(other, _)| *other < part);
                    let of_part = faces[from..].iter().take(MAX_NORMALS).take_while(|(other, _)| *other == part);
                    of_part.into_iter().any(|(_, normal)| {
                        work::compared(1);
                        normal.dot(hit.normal) > SAME
                    })
                })
            })
        };
        self.hits.retain(|hit| !is_held(hit));
        // Those of one part in the order of the triangles.
        self.hits.sort_by_key(|hit| hit.part);
        let mut points = Distinct::default();
        for hits in self.hits.chunk_by(|a, b| a.part == b.part) {
            points.clear();
            let (normal, mut carried) = (hits[0].normal, 0.0);
            for hit in hits {
                carried += hit.carried / hits.len() as f64;
                points.add(&hit.point);
            }
            let points = points.points.as_slice();
            let mut few = if points.is_empty() { Points::none() } else { reduce(points, normal, self.margin) };
            keep_nearest(&mut few, points, as_near(points, self.margin), normal);
            visit(hits[0].part, &Manifold::new(normal, carried, few));
        }
    }
}

/// Points at different places: of those that are one the first.
#[derive(Default)]
struct Distinct {
    points: Vec<ContactPoint<f64>>,
    /// Once there are many, the points in each cell of a grid as wide as those that are one are
    /// apart.
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Distinct {
    fn clear(&mut self) {
        self.points.clear();
        self.cells.clear();
    }

    fn add(&mut self, point: &ContactPoint<f64>) {
        let is_near = |other: &ContactPoint<f64>| {
            work::compared(1);
            let apart = other.position - point.position;
            apart.dot(apart) < ONE_POINT
        };
        let is_there = if self.points.len() < FEW {
            self.points.iter().any(is_near)
        } else {
            if self.cells.is_empty() {
                for (number, point) in (0..).zip(&self.points) {
                    self.cells.entry(cell(point)).or_default().push(number);
                }
            }
            let [x, y, z] = cell(point);
            let around = (0..27).map(|k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1]);
            let mut near = around.filter_map(|cell| self.cells.get(&cell)).flatten();
            near.any(|number| is_near(&self.points[*number as usize]))
        };
        if !is_there {
            if self.points.len() >= FEW {
                self.cells.entry(cell(point)).or_default().push(self.points.len() as u32);
            }
            self.points.push(*point);
        }
    }
}

fn cell(point: &ContactPoint<f64>) -> [i64; 3] {
    // Places further out than 2^61 of these cells share the last.
    let most = (1_i64 << 61) as f64;
    let p = point.position * (1.0 / ONE_POINT.sqrt());
    [p.x, p.y, p.z].map(|x| x.clamp(-most, most).floor() as i64)
}

/// Whether a point is over a triangle, seen along its normal, or over its sides.
fn is_over(corners: [Vector; 3], normal: Vector, point: Vector) -> bool {
    (0..3).all(|side| {
        let way = corners[(side + 1) % 3] - corners[side];
        normal.dot(way.cross(point - corners[side])) >= -ON_THE_SIDE * way.dot(way).sqrt()
    })
}

/// Which corners of a triangle are furthest in a direction. (Of an overlap, where it is deepest is
/// not as certain.)
fn furthest(corners: [Vector; 3], direction: Vector) -> [bool; 3] {
    let mut first = corners[0];
    for corner in corners {
        if direction.dot(corner - first) > 0.0 {
            first = corner;
        }
    }
    corners.map(|corner| {
        let apart = first - corner;
        direction.dot(apart) <= OUTSIDE * apart.dot(apart).sqrt()
    })
}
