//! A bounding volume hierarchy with eight children per node: refit, box queries and leaf pairs.

use super::aabb8::{Aabb8, LANES, Marks};
use super::bvh_build::{Item, NONE, arrange};
use super::pair_list::{Found, Pair};
use crate::aabb::Aabb;
use crate::scalar::Scalar;

/// Boxes in eights, the boxes of eights in eights, and so on up to one. It has no pointers: the
/// children of node `i` are the nodes from `8 i` on, one level below.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bvh8<R> {
    /// What is in each lane of each leaf.
    objects: Vec<[u32; LANES]>,
    /// From the leaves up to the root.
    levels: Vec<Vec<Aabb8<R>>>,
    items: Vec<Item<R>>,
}

/// More nodes than are ever put off, which are eight for each level of a tree of 2^32 objects; a
/// power of two, so that no place in it has to be checked.
const MAX_STACK: usize = 128;

impl<R: Scalar> Bvh8<R> {
    /// Makes a tree of some of the objects.
    pub(crate) fn build(&mut self, objects: impl Iterator<Item = u32>, boxes: &[Aabb<R>]) {
        arrange(objects, boxes, &mut self.items, &mut self.objects);
        let mut width = self.objects.len();
        let mut height = 0;
        while width > 0 {
            if self.levels.len() == height {
                self.levels.push(Vec::new());
            }
            self.levels[height].clear();
            self.levels[height].resize(width, Aabb8::empty());
            height += 1;
            width = if width == 1 { 0 } else { width.div_ceil(LANES) };
        }
        self.levels.truncate(height);
        for leaf in 0..self.leaves() {
            self.load(leaf, boxes);
        }
        self.refit();
    }

    pub(crate) fn leaves(&self) -> usize {
        self.objects.len()
    }

    /// The objects of a leaf; [`NONE`] where there is none.
    pub(crate) fn objects(&self, leaf: usize) -> &[u32; LANES] {
        &self.objects[leaf]
    }

    pub(super) fn leaf(&self, leaf: usize) -> &Aabb8<R> {
        &self.levels[0][leaf]
    }

    /// Takes over the boxes of a leaf's objects.
    pub(super) fn load(&mut self, leaf: usize, boxes: &[Aabb<R>]) {
        for (lane, object) in self.objects[leaf].iter().enumerate().filter(|(_, object)| **object != NONE) {
            self.levels[0][leaf].set(lane, &boxes[*object as usize]);
        }
    }

    /// Makes the nodes above the leaves as large as they have to be.
    pub(crate) fn refit(&mut self) {
        for height in 1..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(height);
            let children = &below[height - 1];
            for (node, children) in above[0].iter_mut().zip(children.chunks(LANES)) {
                for (lane, child) in children.iter().enumerate() {
                    node.set(lane, &child.union());
                }
            }
        }
    }

    /// How long the boxes of the leaves are in the mean, as a multiple of those of the objects in
    /// them: the larger, the more leaves meet.
    pub(crate) fn looseness(&self) -> R {
        let sides = |height: usize| {
            let nodes = self.levels.get(height).into_iter().flatten();
            nodes.fold(R::splat(0.0), |sum, aabb8| sum + aabb8.sides())
        };
        sides(1) / sides(0)
    }

    /// Adds the leaves, from leaf `from` on, whose boxes meet the other to `found`.
    pub(crate) fn find(&self, other: &Aabb<R>, from: usize, stack: &mut Vec<(u32, u32)>, found: &mut Vec<u32>) {
        let Some(root) = self.levels.len().checked_sub(1) else { return };
        if root == 0 {
            found.push(0);
            return;
        }
        let mut marks = Marks::default();
        let mut lanes = [0; LANES];
        stack.clear();
        stack.push((root as u32, 0));
        while let Some((height, node)) = stack.pop() {
            let below = height - 1;
            self.levels[height as usize][node as usize].meeting(other, &mut marks);
            let count = marks.select(&mut lanes, |lane| node * LANES as u32 + lane as u32);
            // The leaves below a child end where those of the next begin.
            let children = lanes[..count].iter().filter(|child| (**child as usize + 1) << (3 * below) > from);
            if below == 0 {
                found.extend(children);
            } else {
                stack.extend(children.map(|child| (below, *child)));
            }
        }
    }

    /// Shows the objects in the order of how near the boxes around them are, as `measure` has it of
    /// eight boxes, up to `most`, a number, which `visit` may lower: it returns the new one.
    pub(crate) fn nearest_first(
        &self,
        measure: impl Fn(&Aabb8<R>, &mut [R; LANES]),
        mut most: R,
        visit: &mut impl FnMut(u32, R) -> R,
    ) -> R {
        let Some(top) = self.levels.len().checked_sub(1) else { return most };
        let zero = R::splat(0.0);
        let mut stack = [(0_u32, 0_u32, zero); MAX_STACK];
        let (mut len, mut values) = (1, [zero; LANES]);
        stack[0] = (top as u32, 0, zero);
        while len > 0 {
            len -= 1;
            let (height, node, value) = stack[len % MAX_STACK];
            if value > most {
                continue;
            }
            measure(&self.levels[height as usize][node as usize], &mut values);
            // The children, furthest first, on top of what is put off.
            let begin = len;
            for (lane, value) in (0_u32..).zip(values) {
                if value <= most {
                    let mut place = len;
                    while place > begin && stack[(place - 1) % MAX_STACK].2 < value {
                        stack[place % MAX_STACK] = stack[(place - 1) % MAX_STACK];
                        place -= 1;
                    }
                    stack[place % MAX_STACK] = (height.wrapping_sub(1), node * LANES as u32 + lane, value);
                    len += 1;
                }
            }
            while height == 0 && len > begin {
                len -= 1;
                let (_, place, value) = stack[len % MAX_STACK];
                let object = self.objects[place as usize / LANES][place as usize % LANES];
                if value <= most && object != NONE {
                    most = visit(object, value);
                }
            }
        }
        most
    }

    /// Shows the objects in nodes of which a box is met: all whose box is met, and others.
    pub(crate) fn meeting(&self, aabb: &Aabb<R>, visit: &mut impl FnMut(u32)) {
        let Some(top) = self.levels.len().checked_sub(1) else { return };
        let mut stack = [(0_u32, 0_u32); MAX_STACK];
        let (mut len, mut marks, mut lanes) = (1, Marks::default(), [0; LANES]);
        stack[0] = (top as u32, 0);
        while len > 0 {
            len -= 1;
            let (height, node) = stack[len];
            self.levels[height as usize][node as usize].meeting(aabb, &mut marks);
            let count = marks.select(&mut lanes, |lane| node * LANES as u32 + lane as u32);
            for child in &lanes[..count] {
                if height == 0 {
                    let object = self.objects[*child as usize / LANES][*child as usize % LANES];
                    if object != NONE {
                        visit(object);
                    }
                } else {
                    stack[len] = (height - 1, *child);
                    len += 1;
                }
            }
        }
    }

    /// Gives the object at a place another box.
    pub(crate) fn set(&mut self, place: usize, aabb: &Aabb<R>) {
        self.levels[0][place / LANES].set(place % LANES, aabb);
    }

    /// Adds the pairs among the objects of a leaf whose boxes meet.
    pub(super) fn pairs_within(&self, leaf: usize, found: &mut Found) {
        let (aabb8, objects) = (self.leaf(leaf), self.objects(leaf));
        let mut marks = Marks::default();
        for lane in 1..LANES {
            aabb8.meeting_one_of(aabb8, lane, &mut marks);
            marks.keep_before(lane);
            found.add(&marks, |before| ordered(objects[before], objects[lane]));
        }
    }

    /// Adds the pairs of an object of a leaf, with the box `around` all of it, and one of another
    /// leaf, whose boxes meet.
    pub(super) fn pairs_between(
        &self,
        (leaf, around): (usize, &Aabb<R>),
        (bvh, other): (&Self, usize),
        found: &mut Found,
    ) {
        let (aabb8, objects) = (self.leaf(leaf), self.objects(leaf));
        let (others, other_objects) = (bvh.leaf(other), bvh.objects(other));
        let mut marks = Marks::default();
        let mut lanes = [0; LANES];
        others.meeting(around, &mut marks);
        let count = marks.select(&mut lanes, |lane| lane);
        for lane in &lanes[..count] {
            aabb8.meeting_one_of(others, *lane, &mut marks);
            found.add(&marks, |hit| ordered(objects[hit], other_objects[*lane]));
        }
    }
}

#[inline]
fn ordered(a: u32, b: u32) -> Pair {
    (a.min(b), a.max(b))
}

#[cfg(test)]
mod tests {
    use tumble_math::lane::Vec3;

    use super::*;

    fn cube(x: f64, y: f64, z: f64, half: f64) -> Aabb<f64> {
        Aabb::about(Vec3::new(x, y, z), Vec3::splat(half))
    }

    /// Of 16 x 16 x 16 cubes every leaf has eight that are a cube together.
    #[test]
    fn leaves_are_as_small_as_they_can_be() {
        let places = (0..4096_u32).map(|i| [i % 16, i / 16 % 16, i / 256].map(f64::from));
        let boxes: Vec<Aabb<f64>> = places.map(|[x, y, z]| cube(x, y, z, 0.25)).collect();
        let mut bvh = Bvh8::default();
        // Not in the order they are made in.
        bvh.build((0..4096).map(|i| i * 1025 % 4096), &boxes);
        assert_eq!(bvh.leaves(), 512);
        for leaf in 0..512 {
            let around = bvh.leaf(leaf).union();
            assert_eq!(around.high - around.low, Vec3::splat(1.5), "leaf {leaf}");
        }
        assert_eq!(bvh.looseness(), 1.5 / (8.0 * 0.5));
    }

    /// What is large is not in a leaf of small ones, and all are in some leaf, once.
    #[test]
    fn large_and_small_are_apart() {
        let mut boxes: Vec<Aabb<f64>> = (0..100).map(|i| cube(f64::from(i), 0.0, 0.0, 0.4)).collect();
        boxes[17] = cube(17.0, 0.0, 0.0, 40.0);
        boxes[60] = cube(60.0, 0.0, 0.0, 4000.0);
        let mut bvh = Bvh8::default();
        bvh.build(0..100, &boxes);
        let mut seen = Vec::new();
        for leaf in 0..bvh.leaves() {
            let objects = bvh.objects(leaf).iter().copied().filter(|object| *object != NONE);
            let large = objects.clone().filter(|object| [17, 60].contains(object)).count();
            assert!(large == 0 || objects.clone().count() == 1, "{:?}", bvh.objects(leaf));
            seen.extend(objects);
        }
        seen.sort_unstable();
        assert_eq!(seen, (0..100).collect::<Vec<u32>>());
    }
}
