//! How much further the contacts of jointed bodies are looked for.
//!
//! A corner that strikes turns the whole mechanism within the step, and the opposite corner comes
//! down with up to twice the velocity of before: its point has to be among the contacts by then.

use crate::collision::collider_state::{Activity, ColliderState};
use crate::collision::pipeline::CollisionPipeline;
use crate::joints::joint_list::JointList;
use crate::math::Real;

/// A turn looks no further than this one \[rad\].
const MAX_TURN: Real = 1.0;

impl CollisionPipeline {
    /// Has jointed bodies that are awake reach as far as their corners may come in the step.
    pub(crate) fn widen_jointed(&mut self, joints: &JointList) {
        let states = &mut self.collider_states;
        for slot in joints.joints.iter().flat_map(|joint| joint.slots) {
            let i = slot.index();
            if states.activity[i] != Activity::Awake {
                continue;
            }
            let state = &mut states.states[i];
            let more = wanted(state) - state.reach;
            if more > 0.0 && more.is_finite() {
                state.reach += more;
                states.lanes.set_reach(i, state.reach);
                for proxies in [&mut states.proxies, &mut states.sensed_proxies] {
                    if let Some(aabb) = proxies.get_mut(i).and_then(|proxy| proxy.aabb.as_mut()) {
                        *aabb = aabb.grown(more);
                    }
                }
            }
        }
    }
}

/// How far a body is to reach, the same however often it is asked.
fn wanted(state: &ColliderState) -> Real {
    let [way, drop, turn] = [state.motion.way, state.motion.drop, state.motion.turn].map(|it| it.dot(it).sqrt());
    state.margin + 2.0 * way + drop + turn.min(MAX_TURN) * state.motion.radius
}
