//! Joints: who hangs on whom, and where the links are while no joint is moved.

use std::collections::HashMap;

use crate::error::FieldError;
use crate::terminal::one_line;

use crate::urdf::element::Element;
use crate::urdf::frame::Frame;
use crate::urdf::joint::Joint;
use crate::urdf::link::Link;
use crate::urdf::mimic;

/// The joints between known links, and where these are while no joint is moved.
pub(crate) struct Tree {
    pub(crate) joints: Vec<Joint>,
    /// Of each link the joint that leads to it.
    pub(crate) leads_to: Vec<Option<usize>>,
    /// The links that a root leads to, each after its parent.
    pub(crate) order: Vec<usize>,
    /// Where each link is, in the frame of the root.
    pub(crate) frames: Vec<Frame>,
}

impl Tree {
    /// Reads the joints. What is wrong with them is noted with the links they belong to; links that
    /// no chain of joints leads to stay where the root is.
    pub(crate) fn read(robot: Element<'_>, links: &mut [Link]) -> Self {
        let joints = joints(robot, links);
        let mut leads_to: Vec<Option<usize>> = vec![None; links.len()];
        let mut leave_from: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
        for (index, joint) in joints.iter().enumerate() {
            let earlier = leads_to.get(joint.child).copied().flatten().and_then(|earlier| joints.get(earlier));
            if let Some(earlier) = earlier {
                let problem = format!("leads here, and joint {:?} does too: a link has one parent", earlier.name);
                complain(links, joint.child, field(&joint.name), problem);
                continue;
            }
            leads_to[joint.child] = Some(index);
            leave_from[joint.parent].push(index);
        }
        let roots: Vec<usize> = (0..links.len()).filter(|link| leads_to[*link].is_none()).collect();
        let mut placed: Vec<Option<Frame>> = vec![None; links.len()];
        let (mut reached, mut order) = (roots.clone(), Vec::with_capacity(links.len()));
        for root in &roots {
            placed[*root] = Some(Frame::IDENTITY);
        }
        // Each link is reached once, for one joint leads to it.
        while let Some(parent) = reached.pop() {
            order.push(parent);
            for joint in leave_from[parent].iter().filter_map(|joint| joints.get(*joint)) {
                placed[joint.child] = placed[parent].map(|frame| frame.then(joint.origin));
                reached.push(joint.child);
            }
        }
        complain_of_roots(links, &roots);
        for (link, _) in placed.iter().enumerate().filter(|(_, frame)| frame.is_none()) {
            let problem = "the joints that lead here come from no root, they go round in a circle";
            complain(links, link, "joint".to_owned(), problem.into());
        }
        let frames = placed.into_iter().map(|frame| frame.unwrap_or(Frame::IDENTITY)).collect();
        Self { joints, leads_to, order, frames }
    }

    /// The joint that leads to a link.
    pub(crate) fn joint_to(&self, link: usize) -> Option<&Joint> {
        self.leads_to.get(link).copied().flatten().and_then(|joint| self.joints.get(joint))
    }
}

fn complain_of_roots(links: &mut [Link], roots: &[usize]) {
    let Some((first, others)) = roots.split_first() else { return };
    // Links may lack a name; then that is a problem of its own.
    let first = links.get(*first).map(|link| link.name.clone()).unwrap_or_default();
    for root in others {
        complain(links, *root, "joint".to_owned(), format!("none leads here, nor to {first:?}: a robot has one root"));
    }
}

/// The joints between known links. The others are noted.
fn joints(robot: Element<'_>, links: &mut [Link]) -> Vec<Joint> {
    let mut by_name: HashMap<String, usize> = HashMap::with_capacity(links.len());
    for (index, link) in links.iter().enumerate() {
        by_name.entry(link.name.clone()).or_insert(index);
    }
    let mut seen: HashMap<&str, usize> = HashMap::new();
    let mut joints = Vec::new();
    for element in robot.all("joint") {
        let mut problems = Vec::new();
        let name = element.attribute("name").unwrap_or_default();
        let earlier = seen.insert(name, element.line());
        let (joint, bears) = Joint::read(element, &by_name, &mut problems);
        if let Some(line) = earlier {
            problems.push(element.problem("name", format_args!("is also that of the joint at line {line}")));
        }
        for problem in problems {
            complain(links, bears, format!("{}.{}", field(name), problem.field), problem.problem);
        }
        joints.extend(joint);
    }
    for (index, problem) in mimic::problems(&joints, &seen) {
        let Joint { name, child, .. } = &joints[index];
        complain(links, *child, format!("{}.{}", field(name), problem.field), problem.problem);
    }
    joints
}

fn field(joint: &str) -> String {
    one_line(&format!("joint {joint:?}"))
}

fn complain(links: &mut [Link], link: usize, field: String, problem: String) {
    if let Some(link) = links.get_mut(link) {
        link.problems.push(FieldError::new(field, problem));
    }
}
