//! Joints: who hangs on whom, and where the links are while no joint is moved.

use std::collections::HashMap;

use crate::checked::note;
use crate::error::FieldError;
use crate::terminal::one_line;

use crate::urdf::element::Element;
use crate::urdf::frame::Frame;
use crate::urdf::link::Link;

const KINDS: [&str; 6] = ["fixed", "revolute", "continuous", "prismatic", "planar", "floating"];

/// A joint between links that both exist, by their index.
struct Joint {
    name: String,
    parent: usize,
    child: usize,
    origin: Frame,
}

/// Joints by kind, for the notices.
pub(crate) type JointNames = Vec<(&'static str, Vec<String>)>;

/// Where each link is, in the frame of the root. What is wrong with joints is noted with the links
/// they belong to; links that no chain of joints leads to stay where the root is.
pub(crate) fn place(robot: Element<'_>, links: &mut [Link]) -> (Vec<Frame>, JointNames) {
    let mut names: JointNames = KINDS.iter().map(|kind| (*kind, Vec::new())).collect();
    let joints = joints(robot, links, &mut names);
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
    let mut reached = roots.clone();
    for root in &roots {
        placed[*root] = Some(Frame::IDENTITY);
    }
    // Each link is reached once, for one joint leads to it.
    while let Some(parent) = reached.pop() {
        for joint in leave_from[parent].iter().filter_map(|joint| joints.get(*joint)) {
            placed[joint.child] = placed[parent].map(|frame| frame.then(joint.origin));
            reached.push(joint.child);
        }
    }
    complain_of_roots(links, &roots);
    for (link, _) in placed.iter().enumerate().filter(|(_, frame)| frame.is_none()) {
        complain(
            links,
            link,
            "joint".to_owned(),
            "the joints that lead here come from no root, they go round in a circle".into(),
        );
    }
    (placed.into_iter().map(|frame| frame.unwrap_or(Frame::IDENTITY)).collect(), names)
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
fn joints(robot: Element<'_>, links: &mut [Link], names: &mut JointNames) -> Vec<Joint> {
    let mut by_name: HashMap<String, usize> = HashMap::with_capacity(links.len());
    for (index, link) in links.iter().enumerate() {
        by_name.entry(link.name.clone()).or_insert(index);
    }
    let mut seen: HashMap<&str, usize> = HashMap::new();
    let mut joints = Vec::new();
    for element in robot.all("joint") {
        let mut problems = Vec::new();
        let name = note(&mut problems, element.needed_attribute("name")).unwrap_or_default();
        if let Some(line) = seen.insert(name, element.line()) {
            problems.push(element.problem("name", format_args!("is also that of the joint at line {line}")));
        }
        if let Some(kind) = note(&mut problems, kind(element)) {
            names.iter_mut().filter(|(known, _)| *known == kind).for_each(|(_, names)| names.push(name.to_owned()));
        }
        let ends = ["parent", "child"].map(|end| note(&mut problems, link_at(element, end, &by_name)));
        let origin = note(&mut problems, element.origin());
        // The child is what a bad joint leaves in the wrong place.
        let at = ends[1].or(ends[0]).unwrap_or(0);
        for problem in problems {
            complain(links, at, format!("{}.{}", field(name), problem.field), problem.problem);
        }
        if let ([Some(parent), Some(child)], Some(origin)) = (ends, origin) {
            joints.push(Joint { name: name.to_owned(), parent, child, origin });
        }
    }
    joints
}

fn kind(joint: Element<'_>) -> Result<&'static str, FieldError> {
    let kind = joint.needed_attribute("type")?;
    let known = KINDS.into_iter().find(|known| *known == kind);
    known.ok_or_else(|| joint.problem("type", format_args!("{kind:?} is none of {}", KINDS.join(", "))))
}

/// The index of the link at one end of a joint.
fn link_at(joint: Element<'_>, end: &'static str, by_name: &HashMap<String, usize>) -> Result<usize, FieldError> {
    let element = joint.needed(end)?;
    let name = element.needed_attribute("link").map_err(|error| error.inside(end))?;
    let unknown = || element.problem(end, format_args!("no link is called {name:?}"));
    by_name.get(name).copied().ok_or_else(unknown)
}

fn field(joint: &str) -> String {
    one_line(&format!("joint {joint:?}"))
}

fn complain(links: &mut [Link], link: usize, field: String, problem: String) {
    if let Some(link) = links.get_mut(link) {
        link.problems.push(FieldError::new(field, problem));
    }
}
