//! A surface of triangles against a convex shape, so that what slides over it does not stumble over
//! edges that are none.
//!
//! A triangle holds with its own normal what is over it. Over a side or a corner it holds only what
//! lies in the Voronoi region of that side or corner: in directions from which nothing else of the
//! surface is nearer. Where the surface is flat or hollow there are none.

use std::cell::Cell;
use std::collections::HashMap;

use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::{Approach, FACE_LEAD, difference, manifold_of, wide_placement, with_faces_first};
use crate::face_clipping::{AS_NEAR, FaceClipping, ON_THE_SIDE, is_corner_of_second};
use crate::feature::{Feature, MAX_CORNERS, Near};
use crate::gjk::on_triangle;
use crate::manifold::{ContactPoint, Manifold};
use crate::manifold_reduction::pressed;
use crate::minkowski::Difference;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, narrow, unit};
use crate::surface::{Surface, normal_of};
use crate::surface_hits::{Hit, Hits};
use crate::surface_piece::{FEWEST, SMALL, around, axis, face, small_piece};
use crate::triangle_approach::{is_beside, triangle_approach};
use crate::work;

/// Overlaps of no more than this part of the margin need no second look: the way out is the
/// triangle's own.
const SHALLOW: f64 = 0.05;
/// How far a direction may be outside of a Voronoi region, for rounding, as a sine.
const OUTSIDE: f64 = 1e-3;
/// A direction is turned out of the way of one side at a corner after the other, this
/// number of times around.
const TURNS: usize = 4;
/// Most triangles at a corner that are tested against what lies over it.
const MAX_ASKED: usize = 64;
/// Weight of a corner in a point that is beside it.
const BESIDE: f64 = 1e-6;

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

/// Memory that the next pair overwrites.
#[derive(Default)]
struct Scratch {
    near: Vec<u32>,
    hits: Hits,
    /// Points where no other triangle holds.
    spare: Vec<Hit>,
    /// Corners of many sides, by their parts, and how many triangles asked what lies over them.
    asked: HashMap<u32, usize>,
}

thread_local! {
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

/// A convex shape over a surface, seen from the surface.
struct Over<'a, S> {
    surface: &'a S,
    /// The shape and where it is, with nothing in the place of a triangle.
    shape: Difference<'a>,
    layer: f64,
    margin: f64,
    /// The margin, or the size of the shape if that is less: what counts as small.
    small: f64,
    /// How far the shape is over the plane of the triangle that is left the soonest, of those that
    /// hold where no other does.
    spare: Option<f64>,
    memory: Box<Scratch>,
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
    let here = Isometry::at(Vector::zero());
    let Some(shape) = difference(Convex::Point, &here, shape, &at) else { return };
    let margin = margin.into();
    let memory = SCRATCH.take().unwrap_or_default();
    let mut over = Over { surface, shape, layer, margin, small: margin, spare: None, memory };
    over.find();
    let middle = over.shape.place(over.shape.second.middle());
    let Scratch { hits, spare, .. } = &mut *over.memory;
    if hits.list.is_empty() && over.spare.is_some() {
        std::mem::swap(&mut hits.list, spare);
    }
    hits.collect(margin, middle, &mut |part, manifold| {
        let manifold =
            manifold.seen(|point| surface_at.to_world(narrow(point)), |v| surface_at.orientation.rotate(narrow(v)));
        visit(part, &manifold);
    });
    SCRATCH.set(Some(over.memory));
}

/// How many numbers for parts a surface needs.
pub(crate) fn parts(surface: &impl Surface, points: usize) -> u32 {
    surface.patches().count() + 3 * surface.count() + points as u32
}

impl<S: Surface> Over<'_, S> {
    fn find(&mut self) {
        let Scratch { near, hits, asked, .. } = &mut *self.memory;
        near.clear();
        hits.list.clear();
        asked.clear();
        let aabb = around(&self.shape, self.layer + self.margin);
        let size = aabb.high - aabb.low - Vector::splat(2.0 * self.margin);
        self.small = f64::min(self.margin, size.dot(size).sqrt());
        self.surface.near(&aabb, &mut |triangle| near.push(triangle));
        near.sort_unstable();
        let middle = self.shape.place(self.shape.second.middle());
        for index in 0..self.memory.near.len() {
            self.meet(self.memory.near[index], middle);
        }
    }

    /// Finds how a triangle holds the shape, whose middle is given.
    fn meet(&mut self, triangle: u32, middle: Vector) {
        let corners = self.surface.triangle(triangle);
        let normal = normal_of(&corners);
        let lowest = self.shape.second_support(normal * -1.0);
        let depth = normal.dot(lowest - corners[0]) - self.layer;
        // What is behind, or nowhere, or a triangle without area.
        if !(depth <= self.margin && normal.dot(middle - corners[0]) > 0.0) {
            return;
        }
        if is_beside(&self.shape, &corners, normal, self.margin + self.layer) {
            return;
        }
        let is_ball_over = matches!(self.shape.second, Convex::Point) && is_over(corners, normal, lowest);
        if is_ball_over {
            let position = lowest - normal * (self.layer + 0.5 * depth);
            self.hold(triangle, normal, ContactPoint { position, separation: depth, feature: 0 }, 1.0);
            return;
        }
        let shapes = Difference { first: Convex::Triangle(corners), ..self.shape };
        let before = self.memory.hits.list.len();
        let least = self.hold_over_face(triangle, &shapes, normal, (lowest, depth));
        let all_of_it = least <= depth + AS_NEAR * self.small;
        let has_edge = self.surface.patches().has_edge(triangle);
        // Over the plane nothing of the triangle is nearer than the plane.
        let is_over = depth + self.layer > 0.0 || depth >= -SHALLOW * self.small;
        if !has_edge || all_of_it && is_over {
            return;
        }
        match triangle_approach(&shapes, normal, self.margin + self.layer) {
            Some(found) if found.between - self.layer <= depth + AS_NEAR * self.small && all_of_it => {}
            // What a side or a corner does not hold, a neighbour does.
            Some(found) => match self.place(triangle, &found) {
                Some(place) => {
                    self.memory.hits.list.truncate(before);
                    self.over_edge(triangle, &place, &shapes, &found);
                }
                None => self.beside_face(triangle, &shapes, &found, before),
            },
            None => self.memory.hits.list.truncate(before),
        }
    }

    /// Adds points over the triangle itself; returns the least of their separations. Of the shape's
    /// inside the lowest point is given, and how far the shape is over the plane.
    fn hold_over_face(&mut self, triangle: u32, shapes: &Difference<'_>, normal: Vector, lowest: (Vector, f64)) -> f64 {
        let down = shapes.turned_back(normal * -1.0);
        if let Convex::Segment { half_height } = shapes.second {
            return self.hold_piece::<2, FEWEST>(triangle, shapes, &axis(half_height), normal, lowest);
        }
        match small_piece(&shapes.second, down) {
            Some(piece) => self.hold_piece::<4, SMALL>(triangle, shapes, &piece, normal, lowest),
            None => {
                let piece = shapes.second.feature(down, Near::at(lowest.1, self.margin));
                self.hold_piece::<MAX_CORNERS, { 2 * MAX_CORNERS }>(triangle, shapes, &piece, normal, lowest)
            }
        }
    }

    /// Adds points over the triangle of the shape's piece of `N` corners that looks at it, of which
    /// up to `M` are left.
    fn hold_piece<const N: usize, const M: usize>(
        &mut self,
        triangle: u32,
        shapes: &Difference<'_>,
        piece: &Feature<f64, N>,
        normal: Vector,
        (lowest, depth): (Vector, f64),
    ) -> f64 {
        let Convex::Triangle(corners) = shapes.first else { return f64::INFINITY };
        let below = piece.seen(|point| shapes.place(point), |v| shapes.turn(v));
        let face_clipping = FaceClipping { normal, separation: depth, layers: [0.0, self.layer], margin: self.margin };
        let (points, carried) = face_clipping.shared::<3, N, M>(&face(&corners, normal, normal), &below);
        let mut least = f64::INFINITY;
        for point in points.items() {
            least = f64::min(least, point.separation);
            self.hold(triangle, normal, *point, carried);
        }
        let near = depth + AS_NEAR * self.small;
        if least > near && is_over(corners, normal, lowest) {
            // The face that looks down most need not have the lowest corner.
            if least > near + pressed(depth, self.margin) {
                let position = lowest - normal * (self.layer + 0.5 * depth);
                self.hold(triangle, normal, ContactPoint { position, separation: depth, feature: u32::MAX }, carried);
            }
            least = depth;
        }
        least
    }

    /// Adds a point over the triangle itself.
    fn hold(&mut self, triangle: u32, normal: Vector, mut point: ContactPoint<f64>, carried: f64) {
        // What crosses a side of this triangle is not what crosses a side of another.
        if !is_corner_of_second(point.feature) {
            point.feature = point.feature.wrapping_add(triangle.wrapping_mul(0x9e37_79b1));
        }
        let part = self.surface.patches().of_triangle(triangle);
        self.memory.hits.list.push(Hit { part, normal, point, carried, beside: None });
    }

    /// Leaves of the points over the triangle itself, from `before` on, those that hold where no
    /// side or corner does and not all of the shape's nearest is over the triangle.
    fn beside_face(&mut self, triangle: u32, shapes: &Difference<'_>, found: &Approach, before: usize) {
        // Over the triangle's plane but beside the triangle nothing is nearer than the triangle
        // itself.
        let (overlaps, separation) = (found.between <= 0.0, found.between - self.layer);
        let list = &mut self.memory.hits.list;
        let mut end = before;
        for index in before..list.len() {
            if overlaps || list[index].point.separation >= separation - FACE_LEAD {
                list.swap(index, end);
                end += 1;
            }
        }
        list.truncate(end);
        let near = separation + AS_NEAR * self.small + pressed(separation, self.margin);
        let is_near = |hit: &Hit| hit.point.separation <= near;
        if overlaps && furthest(self.surface.triangle(triangle), found.normal) == [true; 3] {
            // The way out is the face's own as far as directions are certain, and what is deepest
            // is beside the face by no more than that.
            if !list[before..].iter().any(is_near) {
                let normal = self.surface.normal(triangle);
                let position = found.on_first + normal * (0.5 * separation);
                self.hold(triangle, normal, ContactPoint { position, separation, feature: u32::MAX }, 0.5);
            }
        } else if list.len() == before {
            self.keep_spare(triangle, shapes, found);
        }
    }

    /// Points over the side or the corner that an approach goes out from, if it may.
    fn over_edge(&mut self, triangle: u32, place: &Place, shapes: &Difference<'_>, found: &Approach) {
        if place.sides[0] != place.sides[1] {
            // Each asks all sides at the corner, and of a corner that many triangles have each has
            // the same to say.
            let asked = self.memory.asked.entry(place.part).or_default();
            *asked += 1;
            if *asked > MAX_ASKED {
                return;
            }
        }
        let Some(way) = self.way_out(triangle, place, shapes, found) else {
            self.keep_spare(triangle, shapes, found);
            return;
        };
        let manifold = self.manifold(shapes, &way);
        let (normal, carried) = (manifold.normal, manifold.carried);
        let hit = |point: &ContactPoint<f64>| Hit {
            part: place.part,
            normal,
            point: *point,
            carried,
            beside: Some(place.beside),
        };
        self.memory.hits.list.extend(manifold.points().iter().map(hit));
    }

    /// The way out over a side or a corner, if one as short as an approach leads away from all of
    /// the surface there.
    fn way_out(&self, triangle: u32, place: &Place, shapes: &Difference<'_>, found: &Approach) -> Option<Approach> {
        // A direction from a ball's centre is as good as can be.
        let lead = if self.layer > 0.0 { OUTSIDE * OUTSIDE } else { FACE_LEAD };
        let holds =
            |way: &Approach| way.between >= found.between - lead && self.leads_away(triangle, place, way.normal);
        let settled = if self.layer > 0.0 { *found } else { with_faces_first(shapes, found) };
        if holds(&settled) {
            return Some(settled);
        }
        if self.layer > 0.0 && found.between > 0.0 {
            return None;
        }
        if holds(found) {
            return Some(*found);
        }
        // Where they overlap, what is shortest for a triangle alone may lie outside of the region:
        // then some direction at its border is nearly as short.
        let at = |normal: Vector| Approach { normal, between: shapes.separation(normal), ..*found };
        let led_away = at(self.led_away(triangle, place, found.normal));
        if holds(&led_away) {
            return Some(led_away);
        }
        let across = |side: usize| self.surface.across(triangle, side);
        let borders = [Some(triangle), across(place.sides[0]), across(place.sides[1])];
        let mut ways = borders.into_iter().flatten().map(|other| at(self.surface.normal(other)));
        ways.find(holds)
    }

    /// Keeps a way out of a triangle whose own shortest way leads along the surface: that where it
    /// is short, or else through the face.
    fn keep_spare(&mut self, triangle: u32, shapes: &Difference<'_>, found: &Approach) {
        if found.between > 0.0 {
            return;
        }
        let is_shallow = found.between >= self.layer - SHALLOW * self.small;
        let normal = if is_shallow { found.normal } else { self.surface.normal(triangle) };
        let between = shapes.separation(normal);
        if self.spare.is_some_and(|most| between <= most) {
            return;
        }
        let manifold = self.manifold(shapes, &Approach { normal, between, ..*found });
        let part = self.surface.patches().of_triangle(triangle);
        let carried = manifold.carried;
        let hit = |point: &ContactPoint<f64>| Hit { part, normal, point: *point, carried, beside: None };
        self.spare = Some(between);
        self.memory.spare.clear();
        self.memory.spare.extend(manifold.points().iter().map(hit));
    }

    /// As [`manifold_of`].
    fn manifold(&self, shapes: &Difference<'_>, way: &Approach) -> Manifold<f64> {
        let Approach { normal, between, lead, on_first } = *way;
        let (separation, layers, margin) = (between - self.layer, [0.0, self.layer], self.margin);
        let piece = small_piece(&shapes.second, shapes.turned_back(normal * -1.0));
        let (Convex::Triangle(corners), Some(piece)) = (shapes.first, piece) else {
            return manifold_of(shapes, way, layers, margin);
        };
        let below = piece.seen(|point| shapes.place(point), |v| shapes.turn(v));
        let middles = [shapes.place(shapes.second.middle()); 2];
        let face_clipping = FaceClipping { normal, separation, layers, margin };
        let nearest = on_first + normal * (0.5 * separation);
        let face = face(&corners, normal_of(&corners), normal);
        face_clipping.manifold_of::<3, 4, SMALL>(&face, &below, nearest, lead, middles)
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
