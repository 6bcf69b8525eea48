//! Many boxes, to be asked which a ray meets, which are near a point and which meet a box.

use crate::aabb::Aabb;
use crate::broad_phase::aabb8::{Aabb8, LANES, LaneRay};
use crate::broad_phase::bvh::Bvh8;
use crate::broad_phase::bvh_build::NONE;
use crate::query::ray::Ray;
use crate::scalar::Scalar;
use crate::support_map::{Vector, narrow};

/// The boxes of many objects, to be asked which of them a ray meets, which are near a point and
/// which meet a box.
///
/// Objects have numbers, and may get other boxes at any time; after that [`refit`](Self::refit) is
/// to be called.
///
/// ```
/// use tumble_collide::{Aabb, QueryTree, Ray, TreeBox};
/// use tumble_math::lane::Vec3;
///
/// let mut tree = QueryTree::default();
/// for object in 0..100 {
///     let center = Vec3::new(3.0 * object as f32, 0.0, 0.0);
///     tree.set(object, TreeBox::Bounded(Aabb::about(center, Vec3::splat(0.5))));
/// }
/// tree.refit();
/// let ray = Ray::new(Vec3::new(10.0, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), f64::INFINITY).unwrap();
/// let mut first = None;
/// tree.along_ray(&ray, Vec3::zero(), &mut |object, enter| {
///     first.get_or_insert((object, enter));
///     0.0 // nothing further away
/// });
/// assert_eq!(first.map(|(object, _)| object), Some(4));
/// ```
#[derive(Clone, Debug, Default)]
pub struct QueryTree<R> {
    /// By object; empty ones where there is none.
    boxes: Vec<Aabb<R>>,
    places: Vec<Place>,
    tree: Bvh8<R>,
    /// Objects that came after the tree was made, eight by eight.
    recent: Vec<Aabb8<R>>,
    recent_objects: Vec<u32>,
    /// Those without an end.
    endless: Vec<u32>,
    is_changed: bool,
    max_looseness: R,
}

/// What a [`QueryTree`] knows of an object.
///
/// ```
/// use tumble_collide::{QueryTree, TreeBox};
///
/// let mut tree = QueryTree::<f32>::default();
/// tree.set(0, TreeBox::Endless);
/// assert_eq!(tree.endless(), [0]);
/// tree.set(0, TreeBox::Nowhere);
/// assert!(tree.endless().is_empty());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TreeBox<R> {
    /// It is nowhere: no query finds it.
    Nowhere,
    /// It has no end: no box says where it is.
    Endless,
    /// It is in this box, world frame. One that is not finite is nowhere.
    Bounded(Aabb<R>),
}

/// Where an object's box is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Nowhere,
    Tree(u32),
    Recent(u32),
}

/// The tree is made again when there are more objects outside it than this, ...
const MAX_RECENT: usize = 64;
/// ... or its leaves have become longer than when it was made by this factor.
const MAX_LOOSENESS: f64 = 1.3;

impl<R: Scalar> QueryTree<R> {
    /// Gives an object another box, and may be a new number.
    pub fn set(&mut self, object: u32, to: TreeBox<R>) {
        let index = object as usize;
        if index >= self.places.len() {
            self.places.resize(index + 1, Place::Nowhere);
            self.boxes.resize(index + 1, Aabb::empty());
        }
        let aabb = match to {
            TreeBox::Bounded(aabb) if aabb.is_finite() => Some(aabb),
            _ => None,
        };
        self.boxes[index] = aabb.unwrap_or_else(Aabb::empty);
        let place = self.endless.binary_search(&object);
        match (to == TreeBox::Endless, place) {
            (true, Err(place)) => self.endless.insert(place, object),
            (false, Ok(place)) => {
                self.endless.remove(place);
            }
            _ => {}
        }
        match self.places[index] {
            Place::Tree(place) => {
                self.tree.set(place as usize, &self.boxes[index]);
                self.is_changed = true;
            }
            Place::Recent(place) => {
                self.recent[place as usize / LANES].set(place as usize % LANES, &self.boxes[index]);
            }
            Place::Nowhere if aabb.is_some() => self.add_recent(object),
            Place::Nowhere => {}
        }
    }

    fn add_recent(&mut self, object: u32) {
        let place = self.recent_objects.len();
        if place.is_multiple_of(LANES) {
            self.recent.push(Aabb8::empty());
        }
        self.recent_objects.push(object);
        self.recent[place / LANES].set(place % LANES, &self.boxes[object as usize]);
        self.places[object as usize] = Place::Recent(place as u32);
    }

    /// To be called after boxes were set, before anything is asked.
    pub fn refit(&mut self) {
        if self.recent_objects.len() > MAX_RECENT {
            self.rebuild();
        } else if std::mem::take(&mut self.is_changed) {
            self.tree.refit();
            if self.tree.looseness() > self.max_looseness {
                self.rebuild();
            }
        }
    }

    fn rebuild(&mut self) {
        self.recent.clear();
        self.recent_objects.clear();
        self.is_changed = false;
        let boxes = &self.boxes;
        let there = (0..).zip(boxes).filter(|(_, aabb)| aabb.is_finite()).map(|(object, _)| object);
        self.tree.build(there, boxes);
        self.places.fill(Place::Nowhere);
        for leaf in 0..self.tree.leaves() {
            for (lane, object) in self.tree.objects(leaf).iter().enumerate().filter(|(_, object)| **object != NONE) {
                self.places[*object as usize] = Place::Tree((leaf * LANES + lane) as u32);
            }
        }
        self.max_looseness = self.tree.looseness() * R::splat(MAX_LOOSENESS);
    }

    /// The objects without an end, in order.
    #[must_use]
    pub fn endless(&self) -> &[u32] {
        &self.endless
    }

    /// The box of an object; `None` where it has none.
    #[must_use]
    pub fn aabb(&self, object: u32) -> Option<&Aabb<R>> {
        self.boxes.get(object as usize).filter(|aabb| aabb.is_finite())
    }

    /// Shows the objects whose boxes a ray meets, roughly in the order in which it does, with the
    /// distance \[m\] at which it enters the box, or less. `visit` returns up to which distance it
    /// is still asked for others. Those [without an end](Self::endless) are not shown.
    ///
    /// What is cast is a box that reaches `half` \[m\] from the ray to all sides.
    pub fn along_ray(&self, ray: &Ray, half: Vector, visit: &mut impl FnMut(u32, R) -> f64) {
        let lane_ray = LaneRay::new(ray.origin(), ray.direction(), half);
        let mut visit = |object: u32, enter: R| rounded_up(visit(object, enter));
        self.nearest_first(|aabb8, enter| aabb8.along(&lane_ray, enter), ray.max_distance(), &mut visit);
    }

    /// Shows the objects whose boxes are at most `most` \[m\] from a point, roughly nearest first,
    /// with the square of that distance, or less. `visit` returns up to which distance it is still
    /// asked for others. Those [without an end](Self::endless) are not shown.
    pub fn around(&self, point: Vector, most: f64, visit: &mut impl FnMut(u32, R) -> f64) {
        let lanes: tumble_math::lane::Vec3<R> = narrow(point);
        let lanes = [lanes.x, lanes.y, lanes.z];
        // What the point is moved by where it is rounded.
        let size = point.x.abs().max(point.y.abs()).max(point.z.abs());
        let more = 4.0 * R::ROUNDING * size;
        let square = |most: f64| (most + more) * (most + more);
        let mut visit = |object: u32, value: R| rounded_up(square(visit(object, value)));
        self.nearest_first(|aabb8, squares| aabb8.squared_distances(&lanes, squares), square(most), &mut visit);
    }

    fn nearest_first(
        &self,
        measure: impl Fn(&Aabb8<R>, &mut [R; LANES]),
        most: f64,
        visit: &mut impl FnMut(u32, R) -> R,
    ) {
        let (mut most, mut values) = (rounded_up(most), [R::splat(0.0); LANES]);
        for (aabb8, objects) in self.recent.iter().zip(self.recent_objects.chunks(LANES)) {
            measure(aabb8, &mut values);
            for (object, value) in objects.iter().zip(values) {
                if value <= most {
                    most = visit(*object, value);
                }
            }
        }
        self.tree.nearest_first(measure, most, visit);
    }

    /// Shows the objects whose boxes meet a box. Those [without an end](Self::endless) are not
    /// shown.
    pub fn meeting(&self, aabb: &Aabb<R>, visit: &mut impl FnMut(u32)) {
        let mut visit_met = |object: u32| {
            // An empty box would meet one without an end.
            if self.aabb(object).is_some_and(|it| it.meets(aabb)) {
                visit(object);
            }
        };
        self.recent_objects.iter().for_each(|object| visit_met(*object));
        self.tree.meeting(aabb, &mut visit_met);
    }
}

/// More than any distance, and its square.
const ANY: f64 = 1e38;

/// In this precision, no less, but a number.
fn rounded_up<R: Scalar>(value: f64) -> R {
    R::splat((value * (1.0 + 2.0 * R::ROUNDING)).min(ANY))
}
