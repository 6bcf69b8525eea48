//! Promise: a tree of boxes shows every box that a ray meets, that is near a point and that meets a
//! box, whatever came, moved and went since, and none that is not there.
//!
//! Why: what the tree leaves out no query finds.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod shapes_at_random;

use shapes_at_random::{Random, Vector, length};
use tumble_collide::{Aabb, ColliderShape, Isometry, QueryTree, Ray, TreeBox};
use tumble_math::lane::Vec3;

/// A tree, and the boxes that it should have.
struct Known {
    tree: QueryTree<f32>,
    boxes: Vec<Option<Aabb<f64>>>,
    /// Everything is within it \[m\].
    world: f64,
}

/// Objects that come, move and go: a tree shows every box that is met, and none that is not.
#[test]
fn a_tree_finds_what_trying_all_boxes_finds() {
    for case in 0..40 {
        let mut random = Random::new(case);
        let count = 1 + random.below(400);
        let world = random.log_between(1.0, 1e4);
        let mut known = Known { tree: QueryTree::default(), boxes: vec![None; count], world };
        for round in 0..6 {
            for object in 0..count {
                if round == 0 || !random.often(0.7) {
                    known.set(object, &mut random);
                }
            }
            known.tree.refit();
            for _ in 0..50 {
                let ray = known.ray(&mut random);
                let half = if random.often(0.5) { Vec3::zero() } else { Vec3::splat(world * 0.01) };
                known.check_ray(&ray, half);
                known.check_box(ray.origin());
                known.check_point(ray.origin());
            }
        }
    }
}

impl Known {
    /// Has an object come, move or go.
    fn set(&mut self, object: usize, random: &mut Random) {
        let half = self.world * random.log_between(1e-4, 0.1);
        let half = Vec3::new(half, half * random.unit(), half * random.unit());
        let wide = |v: Vec3<f32>| Vec3::new(v.x.into(), v.y.into(), v.z.into());
        let aabb = Aabb::about(narrow(random.vector(self.world)), narrow(half));
        let to = match random.below(10) {
            0 => TreeBox::Nowhere,
            1 => TreeBox::Endless,
            2 => TreeBox::Bounded(Aabb::about(Vec3::splat(f32::NAN), Vec3::splat(1.0))),
            _ => TreeBox::Bounded(aabb),
        };
        self.boxes[object] = match to {
            TreeBox::Bounded(aabb) if aabb.low.x.is_finite() => {
                Some(Aabb { low: wide(aabb.low), high: wide(aabb.high) })
            }
            _ => None,
        };
        self.tree.set(object as u32, to);
        assert_eq!(self.tree.endless().contains(&(object as u32)), to == TreeBox::Endless);
    }

    fn ray(&self, random: &mut Random) -> Ray {
        let (origin, mut direction) = (random.vector(self.world), random.direction());
        if random.often(0.2) {
            direction = Vec3::new(0.0, 0.0, if random.often(0.5) { 1.0 } else { -1.0 });
        }
        let max = if random.often(0.5) { f64::INFINITY } else { self.world * random.unit() };
        Ray::new(origin, direction, max).unwrap()
    }

    /// Boxes grown by `half` that a ray meets are shown, before it enters them.
    fn check_ray(&self, ray: &Ray, half: Vector) {
        let grown = |aabb: &Aabb<f64>, by: Vector| Aabb { low: aabb.low - by, high: aabb.high + by };
        let mut shown = Vec::new();
        self.tree.along_ray(ray, half, &mut |object, enter| {
            shown.push((object, f64::from(enter)));
            ray.max_distance()
        });
        for (object, aabb) in self.boxes.iter().enumerate() {
            let met = aabb.as_ref().and_then(|aabb| enters(&grown(aabb, half), ray));
            let found = shown.iter().find(|(other, _)| *other == object as u32);
            if let Some(met) = met {
                let (_, enter) = found.unwrap_or_else(|| panic!("{object} is not shown"));
                assert!(*enter <= met * (1.0 + 1e-9), "{enter} {met}");
            } else if let Some((_, enter)) = found {
                // By rounding only.
                let nearly = half + Vec3::splat(1e-5 * self.world);
                let nearly = aabb.as_ref().and_then(|aabb| enters(&grown(aabb, nearly), ray));
                assert!(nearly.is_some(), "{object} is shown at {enter}");
            }
        }
    }

    fn check_box(&self, middle: Vector) {
        let region = Aabb::about(narrow(middle), Vec3::splat(self.world as f32 * 0.2));
        let mut met = Vec::new();
        self.tree.meeting(&region, &mut |object| met.push(object));
        met.sort_unstable();
        let is_met = |object: &u32| self.tree.aabb(*object).is_some_and(|aabb| aabb.meets(&region));
        assert_eq!(met, (0..self.boxes.len() as u32).filter(is_met).collect::<Vec<_>>());
    }

    fn check_point(&self, point: Vector) {
        let (mut near, most) = (Vec::new(), self.world * 0.2);
        self.tree.around(point, most, &mut |object, square| {
            near.push(object);
            assert!(f64::from(square) <= 1.001 * most * most);
            most
        });
        for (object, aabb) in self.boxes.iter().enumerate() {
            let distance = aabb.as_ref().map_or(f64::INFINITY, |aabb| apart(aabb, point));
            assert!(distance > most || near.contains(&(object as u32)), "{object} at {distance}");
        }
    }
}

fn narrow(v: Vector) -> Vec3<f32> {
    Vec3::new(v.x as f32, v.y as f32, v.z as f32)
}

/// How far a point is from a box.
fn apart(aabb: &Aabb<f64>, point: Vector) -> f64 {
    let out = |low: f64, high: f64, at: f64| (low - at).max(at - high).max(0.0);
    length(Vec3::new(
        out(aabb.low.x, aabb.high.x, point.x),
        out(aabb.low.y, aabb.high.y, point.y),
        out(aabb.low.z, aabb.high.z, point.z),
    ))
}

/// Where a ray enters a box, by the closed form of the box as a shape.
fn enters(aabb: &Aabb<f64>, ray: &Ray) -> Option<f64> {
    let cuboid = ColliderShape::Cuboid { half_extents: (aabb.high - aabb.low) * 0.5 };
    cuboid.cast_ray(&Isometry::at((aabb.low + aabb.high) * 0.5), ray).map(|hit| hit.distance)
}
