//! Promise: a tree of boxes shows every box that a ray meets, that is near a point and that meets a
//! box, whatever came, moved and went since, and none that is not there.
//!
//! Why: what the tree leaves out no query finds.

#[allow(dead_code, reason = "shapes are for other tests")]
mod shapes_at_random;

use shapes_at_random::{Random, Vector, length};
use tumble_collide::{Aabb, ColliderShape, Isometry, QueryTree, Ray, TreeBox};
use tumble_math::lane::Vec3;

/// Objects that come, move and go: a tree shows every box that is met, and none that is not.
#[test]
fn a_tree_finds_what_trying_all_boxes_finds() {
    for case in 0..40 {
        let mut random = Random::new(case);
        let mut tree = QueryTree::<f32>::default();
        let count = 1 + random.below(400);
        let mut boxes: Vec<Option<Aabb<f64>>> = vec![None; count];
        let world = random.log_between(1.0, 1e4);
        for round in 0..6 {
            for (object, slot) in boxes.iter_mut().enumerate() {
                if round > 0 && random.often(0.7) {
                    continue;
                }
                let half = world * random.log_between(1e-4, 0.1);
                let half = Vec3::new(half, half * random.unit(), half * random.unit());
                let narrow = |v: Vector| Vec3::new(v.x as f32, v.y as f32, v.z as f32);
                let wide = |v: Vec3<f32>| Vec3::new(v.x.into(), v.y.into(), v.z.into());
                let aabb = Aabb::about(narrow(random.vector(world)), narrow(half));
                let to = match random.below(10) {
                    0 => TreeBox::Nowhere,
                    1 => TreeBox::Endless,
                    2 => TreeBox::Bounded(Aabb::about(Vec3::splat(f32::NAN), Vec3::splat(1.0))),
                    _ => TreeBox::Bounded(aabb),
                };
                *slot = match to {
                    TreeBox::Bounded(aabb) if aabb.low.x.is_finite() => {
                        Some(Aabb { low: wide(aabb.low), high: wide(aabb.high) })
                    }
                    _ => None,
                };
                tree.set(object as u32, to);
                assert_eq!(tree.endless().contains(&(object as u32)), to == TreeBox::Endless);
            }
            tree.refit();
            for _ in 0..50 {
                let origin = random.vector(world);
                let mut direction = random.direction();
                if random.often(0.2) {
                    direction = Vec3::new(0.0, 0.0, if random.often(0.5) { 1.0 } else { -1.0 });
                }
                let max = if random.often(0.5) { f64::INFINITY } else { world * random.unit() };
                let ray = Ray::new(origin, direction, max).unwrap();
                let half = if random.often(0.5) { Vec3::zero() } else { Vec3::splat(world * 0.01) };
                let grown = |aabb: &Aabb<f64>| Aabb { low: aabb.low - half, high: aabb.high + half };
                let mut shown = Vec::new();
                tree.along_ray(&ray, half, &mut |object, enter| {
                    shown.push((object, f64::from(enter)));
                    max
                });
                for (object, aabb) in boxes.iter().enumerate() {
                    let met = aabb.as_ref().and_then(|aabb| enters(&grown(aabb), &ray));
                    let found = shown.iter().find(|(other, _)| *other == object as u32);
                    if let Some(met) = met {
                        let (_, enter) = found.unwrap_or_else(|| panic!("case {case}: {object} is not shown"));
                        assert!(*enter <= met * (1.0 + 1e-9), "case {case}: {enter} {met}");
                    } else if let Some((_, enter)) = found {
                        // By rounding only.
                        let aabb = boxes[object].as_ref().map(|aabb| Aabb {
                            low: aabb.low - half - Vec3::splat(1e-5 * world),
                            high: aabb.high + half + Vec3::splat(1e-5 * world),
                        });
                        assert!(
                            aabb.and_then(|aabb| enters(&aabb, &ray)).is_some(),
                            "case {case}: {object} is shown at {enter}"
                        );
                    }
                }
                let region = Aabb::about(
                    Vec3::new(origin.x as f32, origin.y as f32, origin.z as f32),
                    Vec3::splat(world as f32 * 0.2),
                );
                let mut met = Vec::new();
                tree.meeting(&region, &mut |object| met.push(object));
                met.sort_unstable();
                let expected: Vec<u32> = (0..count as u32)
                    .filter(|object| tree.aabb(*object).is_some_and(|aabb| aabb.meets(&region)))
                    .collect();
                assert_eq!(met, expected, "case {case}");
                let mut near = Vec::new();
                let most = world * 0.2;
                tree.around(origin, most, &mut |object, square| {
                    near.push(object);
                    assert!(f64::from(square) <= 1.001 * most * most);
                    most
                });
                for (object, aabb) in boxes.iter().enumerate() {
                    let distance = aabb.as_ref().map_or(f64::INFINITY, |aabb| apart(aabb, origin));
                    assert!(distance > most || near.contains(&(object as u32)), "case {case}: {object} at {distance}");
                }
            }
        }
    }
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
