//! Boxes in boxes: finds those of many that meet one.

use tumble_math::lane::Vec3;

use crate::aabb::Aabb;
use crate::query::line::Line;
use crate::support_map::Vector;

/// A tree of boxes in the order in which it is walked through.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bvh {
    nodes: Vec<Node>,
    /// Numbers of the boxes, leaf by leaf.
    order: Vec<u32>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    aabb: Aabb<f64>,
    /// The node to go on with where this one is not met.
    skip: u32,
    /// Of a leaf, its part of the order; empty otherwise.
    leaf: [u32; 2],
}

/// Boxes in a leaf.
const LEAF: usize = 4;
/// More nodes than are ever put off: one for each level of a tree of 2^32 boxes, and its sibling.
const MAX_STACK: usize = 64;

impl Bvh {
    pub(crate) fn new(boxes: &[Aabb<f64>]) -> Self {
        let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
        let mut this = Self { nodes: Vec::new(), order: Vec::new() };
        if !order.is_empty() {
            this.add(boxes, &mut order, 0);
        }
        this.order = order;
        this
    }

    /// Adds the tree of some boxes, the first of which has this place in the order.
    fn add(&mut self, boxes: &[Aabb<f64>], order: &mut [u32], first: u32) {
        let mut aabb = boxes[order[0] as usize];
        for index in order.iter() {
            aabb = aabb.union(&boxes[*index as usize]);
        }
        let place = self.nodes.len();
        self.nodes.push(Node { aabb, skip: 0, leaf: [first, first] });
        if order.len() <= LEAF {
            self.nodes[place].leaf[1] = first + order.len() as u32;
        } else {
            let extent = aabb.high - aabb.low;
            let middle = |index: u32| {
                let sum = boxes[index as usize].low + boxes[index as usize].high;
                if extent.x >= extent.y && extent.x >= extent.z {
                    sum.x
                } else if extent.y >= extent.z {
                    sum.y
                } else {
                    sum.z
                }
            };
            let half = order.len() / 2;
            order.select_nth_unstable_by(half, |a, b| middle(*a).total_cmp(&middle(*b)).then(a.cmp(b)));
            let (before, after) = order.split_at_mut(half);
            self.add(boxes, before, first);
            self.add(boxes, after, first + half as u32);
        }
        self.nodes[place].skip = self.nodes.len() as u32;
    }

    /// Shows the numbers of all boxes that may meet one.
    pub(crate) fn near(&self, aabb: &Aabb<f64>, visit: &mut dyn FnMut(u32)) {
        let mut place = 0;
        while let Some(node) = self.nodes.get(place) {
            if node.aabb.meets(aabb) {
                place += 1;
                let [from, to] = node.leaf;
                self.order[from as usize..to as usize].iter().for_each(|index| visit(*index));
            } else {
                place = node.skip as usize;
            }
        }
    }

    /// Shows the numbers of all boxes that a box may meet that reaches `half` \[m\] from a line and
    /// is moved along it, from its point on and up to the distance `most` \[m\], which `visit` may
    /// shorten: it returns the new one. Nearer ones come earlier.
    pub(crate) fn along(&self, line: &Line, half: Vector, mut most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        let slabs = Slabs::of(line, half);
        let mut stack = [(0_u32, 0.0_f64); MAX_STACK];
        let mut len = 0;
        let push = |place: u32, stack: &mut [(u32, f64); MAX_STACK], len: &mut usize, most: f64| {
            let enter = self.nodes.get(place as usize).and_then(|node| slabs.enter(&node.aabb));
            if let Some(enter) = enter.filter(|enter| *enter <= most) {
                stack[*len] = (place, enter);
                *len += 1;
            }
        };
        push(0, &mut stack, &mut len, most);
        while len > 0 {
            len -= 1;
            let (place, enter) = stack[len];
            if enter > most {
                continue;
            }
            let node = &self.nodes[place as usize];
            let [from, to] = node.leaf;
            if from < to {
                self.order[from as usize..to as usize].iter().for_each(|index| most = visit(*index));
                continue;
            }
            let before = len;
            push(self.nodes[place as usize + 1].skip, &mut stack, &mut len, most);
            push(place + 1, &mut stack, &mut len, most);
            if len == before + 2 && stack[before].1 < stack[before + 1].1 {
                stack.swap(before, before + 1);
            }
        }
    }

    /// The same of boxes that are nearer to a point than `most` \[m\].
    pub(crate) fn around(&self, point: Vector, mut most: f64, visit: &mut dyn FnMut(u32) -> f64) {
        let mut place = 0;
        while let Some(node) = self.nodes.get(place) {
            if node.aabb.distance(point) <= most {
                place += 1;
                let [from, to] = node.leaf;
                self.order[from as usize..to as usize].iter().for_each(|index| most = visit(*index));
            } else {
                place = node.skip as usize;
            }
        }
    }

    /// The box that holds all.
    pub(crate) fn aabb(&self) -> Aabb<f64> {
        self.nodes.first().map_or(Aabb { low: Vector::zero(), high: Vector::zero() }, |node| node.aabb)
    }
}

/// What a line is compared with boxes by.
struct Slabs {
    point: [f64; 3],
    half: [f64; 3],
    along: [f64; 3],
    inverse: [f64; 3],
}

/// Four roundings and a bit more: what is met at the edge of a box is met.
const ROUNDED: f64 = 4.0 * f64::EPSILON;

impl Slabs {
    fn of(line: &Line, half: Vector) -> Self {
        let Vec3 { x, y, z } = line.along;
        Self { point: numbers(line.point), half: numbers(half), along: [x, y, z], inverse: [1.0 / x, 1.0 / y, 1.0 / z] }
    }

    /// How far along the line a box begins, or zero if it is inside.
    fn enter(&self, aabb: &Aabb<f64>) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        let bounds = numbers(aabb.low).into_iter().zip(numbers(aabb.high));
        for (axis, (low, high)) in bounds.enumerate() {
            let (point, half) = (self.point[axis], self.half[axis]);
            let (low, high) = (low - half, high + half);
            if self.along[axis] == 0.0 {
                if point < low || point > high {
                    return None;
                }
                continue;
            }
            let (near, far) = if self.along[axis] > 0.0 { (low, high) } else { (high, low) };
            enter = enter.max((near - point) * self.inverse[axis]);
            leave = leave.min((far - point) * self.inverse[axis]);
        }
        (enter * (1.0 - ROUNDED) <= leave * (1.0 + ROUNDED)).then_some(enter * (1.0 - ROUNDED))
    }
}

fn numbers(v: Vector) -> [f64; 3] {
    [v.x, v.y, v.z]
}
