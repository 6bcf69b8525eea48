//! Boxes in boxes: finds those of many that meet one.

use tumble_math::lane::Vec3;

use crate::aabb::Aabb;
use crate::scalar::Scalar;
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
            aabb = enclosing(&aabb, &boxes[*index as usize]);
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

    /// The box that holds all.
    pub(crate) fn aabb(&self) -> Aabb<f64> {
        self.nodes.first().map_or(Aabb { low: Vector::zero(), high: Vector::zero() }, |node| node.aabb)
    }
}

/// The smallest box that holds both.
pub(crate) fn enclosing<R: Scalar>(a: &Aabb<R>, b: &Aabb<R>) -> Aabb<R> {
    let least = |a: Vec3<R>, b: Vec3<R>| Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z));
    let most = |a: Vec3<R>, b: Vec3<R>| Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z));
    Aabb { low: least(a.low, b.low), high: most(a.high, b.high) }
}
