//! Which links are one body: those that fixed joints connect, and those that have no inertial.

use crate::urdf::frame::Frame;
use crate::urdf::joint::Kind;
use crate::urdf::link::Link;
use crate::urdf::tree::Tree;

/// The name of a root that does not move.
const WORLD: &str = "world";

/// Links that are one body, by the index of the one that gives it name and frame.
pub(crate) struct Welds {
    /// Of each link the one that gives its body name and frame.
    pub(crate) heads: Vec<usize>,
    /// Where each link is in the frame of its body.
    pub(crate) within: Vec<Frame>,
    /// Links without an inertial of their own or by a weld, whose joint is not fixed but held.
    pub(crate) held: Vec<usize>,
    /// The head of the root's body, if that does not move.
    pub(crate) fixed: Option<usize>,
}

impl Welds {
    /// Of a tree in which nothing is wrong: it has one root, and its joints lead to all links.
    pub(crate) fn of(links: &[Link], tree: &Tree) -> Self {
        let has_inertial = |link: usize| links.get(link).is_some_and(|link| link.inertial.is_some());
        // The links at the top of what fixed joints connect, and which of these have a mass.
        let mut tops: Vec<usize> = (0..links.len()).collect();
        let mut is_heavy = vec![false; links.len()];
        for &link in &tree.order {
            if let Some(joint) = tree.joint_to(link).filter(|joint| joint.kind == Kind::Fixed) {
                tops[link] = tops[joint.parent];
            }
            is_heavy[tops[link]] |= has_inertial(link);
        }
        let mut held = Vec::new();
        let mut within = vec![Frame::IDENTITY; links.len()];
        let mut heads: Vec<usize> = (0..links.len()).collect();
        for &link in &tree.order {
            let Some(joint) = tree.joint_to(link) else { continue };
            let is_fixed = joint.kind == Kind::Fixed;
            if is_fixed || !is_heavy[link] {
                heads[link] = heads[joint.parent];
                within[link] = within[joint.parent].then(joint.origin);
                if !is_fixed {
                    held.push(link);
                }
            }
        }
        held.sort_unstable();
        let root = tree.order.first().copied().unwrap_or(0);
        let is_world = links.get(root).is_some_and(|link| link.name == WORLD);
        let is_fixed = is_world || !(0..links.len()).any(|link| heads[link] == root && has_inertial(link));
        let mut welds = Self { heads, within, held, fixed: is_fixed.then_some(root) };
        welds.give_heads_an_inertial(&has_inertial);
        welds
    }

    /// Of bodies that move, a link with an inertial is the head: the top one or the first that is
    /// welded to it.
    fn give_heads_an_inertial(&mut self, has_inertial: &impl Fn(usize) -> bool) {
        let mut better: Vec<Option<usize>> = vec![None; self.heads.len()];
        for link in (0..self.heads.len()).filter(|link| has_inertial(*link)) {
            let top = self.heads[link];
            if Some(top) != self.fixed && !has_inertial(top) {
                better[top].get_or_insert(link);
            }
        }
        let from_head: Vec<Option<Frame>> = better
            .iter()
            .map(|head| head.and_then(|head| self.within.get(head)).map(|frame| frame.inverse()))
            .collect();
        for (link, head) in self.heads.iter_mut().enumerate() {
            let top = *head;
            if let (Some(better), Some(inverse)) = (better[top], from_head[top]) {
                *head = better;
                self.within[link] = if link == better { Frame::IDENTITY } else { inverse.then(self.within[link]) };
            }
        }
    }

    /// The links of the body with this head, in the order of the file but for the head, which is
    /// the first.
    pub(crate) fn links_by_head(&self) -> Vec<Vec<usize>> {
        let mut links: Vec<Vec<usize>> = (0..self.heads.len()).map(|_| Vec::new()).collect();
        for (link, &head) in self.heads.iter().enumerate() {
            if link == head {
                links[head].insert(0, link);
            } else {
                links[head].push(link);
            }
        }
        links
    }
}
