//! How far a shape gets on its way until its core touches another shape.

use tumble_math::lane::Lane;

use crate::aabb::Aabb;
use crate::cast::{Gap, Moving, furthest_from_origin, starts};
use crate::collider_shape::{ColliderShape, Isometry};
use crate::course::Course;
use crate::frustum::Frustum;
use crate::query::line::Line;
use crate::query::overlap::around;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector};
use crate::surface::Surface;

/// A way is followed in at most this number of advances; beyond, it is not known to be free.
const MAX_ADVANCES: usize = 64;
/// Parts of the half thickness that are taken away for a core. Where a larger one touches from the
/// beginning a smaller one counts.
const LESS: [f64; 3] = [0.5, 0.75, 0.9];
/// Part of the half thickness that stays free between a core and what it would touch.
const CLEARANCE: f64 = 1e-2;
/// What turns by more in the interval \[rad\] may have gone around, whatever it is in front of in
/// the end.
const MAX_TURN: f64 = 1.0;

/// What is left of a convex shape, its layer, and where it is in the shape.
struct Core<'a> {
    convex: Convex<'a>,
    layer: f64,
    at: Isometry<f64>,
    /// What stays free around it \[m\].
    clearance: f64,
    /// Whether it may touch what it is in front of again in the end.
    may_touch: bool,
}

/// Where the core of a shape touches another on its way.
///
/// The core is what is left of a shape where part of its half thickness is taken away all around:
/// half of it, and where such a core touches from the beginning, more. As long as a core touches
/// nothing, its shape is on the side that it came from.
///
/// ```
/// use tumble_collide::{ColliderShape, Course, Isometry, Passage};
/// use tumble_math::lane::Vec3;
///
/// let (zero, sphere) = (Vec3::<f64>::zero(), ColliderShape::Sphere { radius: 0.5 });
/// let wall = ColliderShape::Cuboid { half_extents: Vec3::new(0.0005, 2.0, 2.0) };
/// let stays = Course::new(&Isometry::at(zero), zero, zero, zero);
/// let at = Vec3::new(-5.25, 0.0, 0.0);
/// let shot = Course::new(&Isometry::at(at), at, Vec3::new(10.0, 0.0, 0.0), zero);
/// // After five metres of ten a quarter of its diameter is in the wall.
/// let ends = Passage::find([&wall, &sphere], [&stays, &shot]).unwrap();
/// assert!((ends.until - 0.5).abs() < 2e-3 && ends.normal.x == -1.0);
/// assert!((ends.point.x + 0.0005).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Up to when the way is free, as a part of the interval.
    pub until: f64,
    /// From the first to the second then; unit vector, world frame.
    pub normal: Vector,
    /// Of the first, what would be touched then \[m\], world frame.
    pub point: Vector,
    /// By how much the core is nearer then than its clearance, a hundredth of the half thickness
    /// \[m\].
    pub too_near: f64,
}

impl Passage {
    /// How far the core of the second of two shapes gets on its course until it would touch the
    /// first; `None` where it never does, and where it does from the beginning. Of compounds this
    /// is to be asked part by part: as they are they are not met. Nor does what is no convex shape
    /// meet anything as the second. A surface is met from outside.
    ///
    /// Shapes that approach each other again and again never touch: what is left between them is
    /// halved at the most.
    #[must_use]
    pub fn find<R: Scalar>(shapes: [&ColliderShape<R>; 2], courses: [&Course; 2]) -> Option<Self> {
        first_of_cores(shapes, courses, false)
    }

    /// The same, of a core that is not in front again at the end of what it touches on its way. The
    /// course of what turns about a point of contact is a chord of its way, which dips below it.
    ///
    /// ```
    /// use tumble_collide::{ColliderShape, Course, Isometry, Passage};
    /// use tumble_math::lane::Vec3;
    ///
    /// let (zero, half) = (Vec3::<f64>::zero(), Vec3::new(1.0, 0.001, 0.2));
    /// let shapes = [&ColliderShape::HalfSpace, &ColliderShape::Cuboid { half_extents: half }];
    /// let stays = Course::new(&Isometry::at(zero), zero, zero, zero);
    /// // A plank that rises about its end, by half a radian; and one that turns into the ground.
    /// let at = Vec3::new(1.0, 0.001, 0.0);
    /// let rises = Vec3::new(0.5_f64.cos() - 1.0, 0.5_f64.sin(), 0.0);
    /// let turn = Vec3::new(0.0, 0.0, 0.5);
    /// let [rises, turns] = [rises, zero].map(|way| Course::new(&Isometry::at(at), at, way, turn));
    /// assert!(Passage::find(shapes, [&stays, &rises]).is_some());
    /// assert_eq!(Passage::find_crossing(shapes, [&stays, &rises]), None);
    /// assert!(Passage::find_crossing(shapes, [&stays, &turns]).is_some());
    /// ```
    #[must_use]
    pub fn find_crossing<R: Scalar>(shapes: [&ColliderShape<R>; 2], courses: [&Course; 2]) -> Option<Self> {
        let turn: f64 = courses.map(|course| course.angular().dot(course.angular()).sqrt()).iter().sum();
        first_of_cores(shapes, courses, turn < MAX_TURN)
    }
}

/// Where the first core that is free at the beginning touches.
fn first_of_cores<R: Scalar>(
    shapes: [&ColliderShape<R>; 2],
    courses: [&Course; 2],
    may_touch: bool,
) -> Option<Passage> {
    let ends = LESS.iter().map(|less| of_core((*less, may_touch), shapes, courses));
    ends.into_iter().find_map(|end| match end {
        End::Touched => None,
        End::Free => Some(None),
        End::At(passage) => Some(Some(passage)),
    })?
}

/// How the way of a core ends.
#[derive(Clone, Copy)]
enum End {
    /// It touches from the beginning.
    Touched,
    Free,
    At(Passage),
}

impl End {
    /// What comes first of two.
    fn first(self, other: Self) -> Self {
        match (self, other) {
            (Self::Touched, _) | (_, Self::Touched) => Self::Touched,
            (Self::At(a), Self::At(b)) if b.until < a.until => other,
            (Self::At(_), _) => self,
            (Self::Free, _) => other,
        }
    }

    fn until(self) -> f64 {
        match self {
            Self::Touched => 0.0,
            Self::Free => 1.0,
            Self::At(passage) => passage.until,
        }
    }
}

fn of_core<R: Scalar>(
    (less, may_touch): (f64, bool),
    [first, second]: [&ColliderShape<R>; 2],
    courses: [&Course; 2],
) -> End {
    let Some(core) = Core::of(second, less, may_touch) else { return End::Free };
    let course = courses[1].of_part(&core.at);
    let courses = [courses[0], &course];
    let radius = course.off_center() + core.reach();
    match first {
        ColliderShape::Mesh(mesh) => end_at_surface(mesh.as_ref(), &core, courses, radius),
        ColliderShape::HeightField(field) => end_at_surface(field.as_ref(), &core, courses, radius),
        ColliderShape::HalfSpace => end_at_plane(&core, courses, radius),
        _ => {
            let Some((convex, layer)) = Convex::of(first) else { return End::Free };
            let reach: f64 = first.reach().map_or(0.0, Into::into);
            let radii = [courses[0].off_center() + (reach - layer).max(0.0), radius];
            let shapes = [convex, core.convex];
            let layers = layer + core.layer;
            let moving = Moving::of_cores(shapes, layers, courses, (radii, starts(courses)));
            end_at_shape(&moving, &core, layer)
        }
    }
}

impl<'a> Core<'a> {
    /// Without this part of the half thickness.
    fn of<R: Scalar>(shape: &'a ColliderShape<R>, less: f64, may_touch: bool) -> Option<Self> {
        let half_thickness: f64 = shape.ccd_thickness().into();
        let less = less * half_thickness;
        let (mut convex, mut layer) = Convex::of(shape)?;
        let mut at = Isometry::at(Vector::zero());
        let smaller = |v: Vector| v - Vector::splat(less);
        match convex {
            Convex::Point | Convex::Segment { .. } => layer -= less,
            Convex::Cuboid { half } => convex = Convex::Cuboid { half: smaller(half) },
            Convex::Ellipsoid { radii } => convex = Convex::Ellipsoid { radii: smaller(radii) },
            Convex::Tapered { radii, half_height } => {
                convex = Convex::Tapered { radii: radii.map(|radius| radius - less), half_height };
            }
            Convex::Frustum(frustum) => {
                let (core, height) = smaller_frustum(frustum, less);
                convex = Convex::Frustum(core);
                at.position.y = height;
            }
            Convex::Hull(hull) => {
                let aabb = around((convex, 0.0), &at);
                let half = (aabb.high - aabb.low) * 0.5;
                let factor = |half: f64| Lane::max(1.0 - less / half, 0.0);
                convex = Convex::SmallerHull(hull, Vector::new(factor(half.x), factor(half.y), factor(half.z)));
            }
            Convex::SmallerHull(..) | Convex::Triangle(_) => {}
        }
        (half_thickness > 0.0).then_some(Self { convex, layer, at, clearance: CLEARANCE * half_thickness, may_touch })
    }

    /// What ends at this moment with this gap.
    fn passage(&self, until: f64, gap: &Gap) -> Passage {
        let too_near = (self.clearance - gap.distance).max(0.0);
        Passage { until, normal: gap.normal, point: gap.on_first, too_near }
    }

    /// Whether it is in front of the plane in the end that it touched at a moment, which goes with
    /// the first; beyond the layer of that \[m\].
    fn is_in_front(&self, [first, second]: [&Course; 2], (until, gap): (f64, &Gap), layer: f64) -> bool {
        let [then, end] = [until, 1.0].map(|moment| first.at(moment));
        let turned = end.orientation * then.orientation.conjugate();
        let (normal, on_plane) = (turned.rotate(gap.normal), end.to_world(then.to_local(gap.on_first)));
        let body = second.at(1.0);
        let nearest = body.to_world(self.convex.support(body.orientation.rotate_back(normal * -1.0)));
        normal.dot(nearest - on_plane) > self.layer + layer
    }

    /// How far points inside the layer are from the origin at most \[m\].
    fn reach(&self) -> f64 {
        let here = Isometry::at(Vector::zero());
        let aabb = around((self.convex, 0.0), &here);
        let most = |low: f64, high: f64| Lane::max(high, -low);
        let corner =
            Vector::new(most(aabb.low.x, aabb.high.x), most(aabb.low.y, aabb.high.y), most(aabb.low.z, aabb.high.z));
        corner.dot(corner).sqrt()
    }
}

/// A frustum without a layer of even thickness, and at which height its middle is.
fn smaller_frustum(Frustum { radii: [below, above], half_height }: Frustum, less: f64) -> (Frustum, f64) {
    let slope = (above - below) / (2.0 * half_height);
    let (middle, across) = (0.5 * (below + above), less * (1.0 + slope * slope).sqrt());
    let radius = |y: f64| middle + slope * y - across;
    let (mut low, mut high) = (less - half_height, half_height - less);
    // Where the side ends in a tip.
    let tip = (across - middle) / slope;
    if radius(high) < 0.0 {
        high = tip.max(low);
    }
    if radius(low) < 0.0 {
        low = tip.min(high);
    }
    let radii = [radius(low).max(0.0), radius(high).max(0.0)];
    (Frustum { radii, half_height: 0.5 * (high - low) }, 0.5 * (high + low))
}

/// At a convex shape with a layer.
fn end_at_shape(moving: &Moving<'_>, core: &Core<'_>, layer: f64) -> End {
    if moving.are_balls_passed([true, true], core.clearance, 0.0) {
        return End::Free;
    }
    let Some(begin) = moving.gap(0.0) else { return End::Free };
    if begin.distance <= 0.0 {
        return End::Touched;
    }
    let least = core.clearance.min(0.5 * begin.distance);
    if begin.distance.is_nan() || moving.are_passed(least, 0.0) {
        return End::Free;
    }
    let rate = |now: f64, normal: Vector| moving.rate(moving.way(now), normal);
    let Some((until, gap)) = advance(begin, least, moving.courses, rate, |moment| moving.gap(moment)) else {
        return End::Free;
    };
    if core.may_touch && core.is_in_front(moving.courses, (until, &gap), layer) {
        return End::Free;
    }
    End::At(Passage { point: gap.on_first + gap.normal * layer, ..core.passage(until, &gap) })
}

/// At the plane of a half-space; `radius` is how far points of the core are from what it turns
/// about.
fn end_at_plane(core: &Core<'_>, courses: [&Course; 2], radius: f64) -> End {
    let gap = |moment: f64| {
        let [ground, body] = courses.map(|course| course.at(moment));
        let normal = ground.up();
        let lowest = body.to_world(core.convex.support(body.orientation.rotate_back(normal * -1.0)));
        let distance = normal.dot(lowest - ground.position) - core.layer;
        Some(Gap { distance, normal, on_first: lowest - normal * (distance + core.layer) })
    };
    let Some(begin) = gap(0.0).filter(|begin| !begin.distance.is_nan()) else { return End::Free };
    if begin.distance <= 0.0 {
        return End::Touched;
    }
    let [ground, body] = courses.map(|course| course.center_and_turn(0.0).0);
    let apart = body - ground;
    let way = courses[1].gone(1.0) - courses[0].gone(1.0);
    let [apart, far, of_ground, of_body] =
        [apart, way, courses[0].angular(), courses[1].angular()].map(|it| it.dot(it).sqrt());
    // A plane that turns comes nearer by how far from its body's centre the core is.
    let sweep = of_ground * (apart + far + bend(courses) + radius);
    let rate = |now: f64, normal: Vector| {
        let way = courses[1].linear(now) - courses[0].linear(now);
        if sweep > 0.0 {
            return sweep + of_body * radius + way.dot(way).sqrt();
        }
        courses[1].turning_rate(&core.convex, radius, normal) - way.dot(normal)
    };
    let least = core.clearance.min(0.5 * begin.distance);
    let Some((until, touched)) = advance(begin, least, courses, rate, gap) else { return End::Free };
    if core.may_touch && gap(1.0).is_some_and(|gap| gap.distance > 0.0) {
        return End::Free;
    }
    End::At(core.passage(until, &touched))
}

/// Until when a way is free, and the gap then: as long as it is wider than `least` \[m\]. `None`
/// if all of it is.
fn advance(
    begin: Gap,
    least: f64,
    courses: [&Course; 2],
    rate: impl Fn(f64, Vector) -> f64,
    gap_at: impl Fn(f64) -> Option<Gap>,
) -> Option<(f64, Gap)> {
    let (mut now, mut gap) = (0.0, begin);
    for _ in 0..MAX_ADVANCES {
        if gap.distance <= least {
            break;
        }
        let end = courses.iter().flat_map(|course| course.turns()).filter(|end| *end > now);
        let end = end.fold(1.0, f64::min);
        let rate = rate(now, gap.normal);
        let passes = rate * (end - now) < gap.distance - least;
        let next = if passes { end } else { now + (gap.distance - 0.5 * least) / rate };
        if next >= 1.0 {
            return None;
        }
        let Some(there) = gap_at(next) else { break };
        (now, gap) = (next, there);
    }
    Some((now, gap))
}

/// At one of the triangles of a surface that the core is in front of.
fn end_at_surface(surface: &impl Surface, core: &Core<'_>, courses: [&Course; 2], radius: f64) -> End {
    let start @ [ground, body] = starts(courses);
    let middle = ground.to_local(body.to_world(core.convex.middle()));
    let mut end = End::Free;
    let mut ask = |triangle: u32| {
        let corners = surface.triangle(triangle);
        if surface.normal(triangle).dot(middle - corners[0]) > 0.0 {
            let radii = [courses[0].off_center() + furthest_from_origin(corners), radius];
            let shapes = [Convex::Triangle(corners), core.convex];
            let moving = Moving::of_cores(shapes, core.layer, courses, (radii, start));
            end = end.first(end_at_shape(&moving, core, 0.0));
        }
        end.until()
    };
    let way = courses[1].gone(1.0) - courses[0].gone(1.0);
    let length = way.dot(way).sqrt();
    let turns = courses[0].angular().dot(courses[0].angular()) > 0.0;
    let is_straight = courses.iter().all(|course| course.turns().count() == 1);
    let reach = radius + core.layer + core.clearance;
    let from = courses[1].of_center().at(0.0).position;
    if !turns && is_straight && length > 0.0 {
        let along = ground.orientation.rotate_back(way * (1.0 / length));
        let line = Line { point: ground.to_local(from), along };
        surface.along(&line, Vector::splat(reach), length, &mut |triangle| ask(triangle) * length);
        return end;
    }
    // Around where the body is, as the surface sees it, at the beginning and the end.
    let apart = body.position - ground.position;
    let angle = courses[0].angular();
    let swing = angle.dot(angle).sqrt() * (apart.dot(apart).sqrt() + length + courses[0].off_center());
    let half = Vector::splat(reach + swing + bend(courses));
    let boxes = [Vector::zero(), way].map(|gone| Aabb::about(ground.to_local(from + gone), half));
    surface.near(&boxes[0].union(&boxes[1]), &mut |triangle| {
        ask(triangle);
    });
    end
}

/// How far courses are off the straight line between their ends at most \[m\].
fn bend(courses: [&Course; 2]) -> f64 {
    let of = |course: &Course| {
        let end = course.gone(1.0);
        course.turns().fold(0.0, |most: f64, moment| {
            let off = course.gone(moment) - end * moment;
            most.max(off.dot(off).sqrt())
        })
    };
    of(courses[0]) + of(courses[1])
}
