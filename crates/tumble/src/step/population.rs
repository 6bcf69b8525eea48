//! What is in a world, as far as it decides how a step is taken.

use std::any::TypeId;
use std::sync::OnceLock;

use hecs::World;

use crate::collision::collider::Collider;
use crate::collision::pipeline::CollisionPipeline;
use crate::components::{Momentum, Velocity};
use crate::forces::pairwise::{GravityMass, Spring};
use crate::forces::registry::ForceLaws;
use crate::joints::joint::Joint;
use crate::joints::locked_axes::LockedAxes;
use crate::storage::type_marks::TypeMarks;
use crate::threads::{BODY, BODY_UNDER_LAWS, Effort};

/// Mutual gravity of two bodies.
const ATTRACTION: f64 = 0.002;
const SPRING: f64 = 0.2;
/// A joint, over four substeps.
const JOINT: f64 = 4.0;
/// A contact, from finding it to the last of four substeps.
const CONTACT: f64 = 0.6;
/// Added for a pair of shapes without lanes of their own.
const PAIR_OF_OTHERS: f64 = 3.0;

/// The mark of force components.
const LAW: u8 = 1;
/// The mark of what couples bodies.
const COUPLES: u8 = 2;

/// How many entities of each kind there are.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Population {
    under_laws: f64,
    lawless: f64,
    attracting: f64,
    springs: f64,
    joints: f64,
    colliders: f64,
    locked: f64,
    /// Whether there are bodies that a caller's velocity moves.
    pub(crate) has_kinematic: bool,
}

impl Population {
    pub(crate) fn of(world: &World, laws: &ForceLaws) -> Self {
        let mut this = Self::default();
        for archetype in world.archetypes().filter(|archetype| !archetype.is_empty()) {
            let (count, marks) = (f64::from(archetype.len()), marks().on(archetype));
            let entities = if !laws.is_empty() || marks & LAW != 0 { &mut this.under_laws } else { &mut this.lawless };
            *entities += count;
            this.has_kinematic |= !archetype.has::<Momentum>() && archetype.has::<Velocity>();
            if marks & COUPLES == 0 {
                continue;
            }
            this.attracting += if archetype.has::<GravityMass>() { count } else { 0.0 };
            this.springs += if archetype.has::<Spring>() { count } else { 0.0 };
            this.joints += if archetype.has::<Joint>() { count } else { 0.0 };
            this.colliders += if archetype.has::<Collider>() { count } else { 0.0 };
            this.locked += if archetype.has::<LockedAxes>() { count } else { 0.0 };
        }
        this
    }

    /// Whether laws may act on any of them.
    pub(crate) fn are_under_laws(&self) -> bool {
        self.under_laws > 0.0
    }

    /// Whether bodies may act on each other, or are constrained.
    pub(crate) fn interacts(&self) -> bool {
        self.couplings() + self.locked > 0.0
    }

    /// What acts between bodies.
    fn couplings(&self) -> f64 {
        self.attracting + self.springs + self.joints + self.colliders
    }

    /// How much work steps are, if contacts were these after the last. Of bodies that act on each
    /// other it is that of one step, for they wait for each other in every one.
    pub(crate) fn effort(&self, collision: Option<&CollisionPipeline>, steps: u32) -> Effort {
        let bodies = self.lawless * BODY + self.under_laws * BODY_UNDER_LAWS;
        if self.couplings() == 0.0 {
            return Effort::of_microseconds(bodies * f64::from(steps));
        }
        // Before the first step the number of contacts is unknown.
        let (known, of_others) = collision.map_or((0, 0), CollisionPipeline::counts);
        let contacts = CONTACT * self.colliders.max(known as f64) + PAIR_OF_OTHERS * of_others as f64;
        let between = ATTRACTION * self.attracting * self.attracting + SPRING * self.springs + JOINT * self.joints;
        Effort::of_microseconds(bodies + between + contacts)
    }
}

/// The marks of all component types that matter here.
fn marks() -> &'static TypeMarks {
    static MARKS: OnceLock<TypeMarks> = OnceLock::new();
    MARKS.get_or_init(|| {
        let couple = [
            TypeId::of::<Spring>(),
            TypeId::of::<GravityMass>(),
            TypeId::of::<Collider>(),
            TypeId::of::<Joint>(),
            TypeId::of::<LockedAxes>(),
        ];
        let laws = ForceLaws::component_types().map(|id| (id, LAW));
        TypeMarks::of(laws.chain(couple.map(|id| (id, COUPLES))))
    })
}

#[cfg(test)]
mod tests {
    use hecs::{DynamicBundle, Entity};

    use super::*;
    use crate::components::Pose;
    use crate::forces::components::{Drag, Thruster};
    use crate::forces::force_law::{BodyState, ForceLaw};
    use crate::joints::axes::Axes;

    /// Whether an entity with these components and another that moves interact, are under laws, and
    /// whether one of them is kinematic.
    fn found(laws: &ForceLaws, components: impl DynamicBundle) -> [bool; 3] {
        let mut world = World::new();
        world.spawn((Pose::default(), Momentum::default(), Velocity::default()));
        // An archetype of which nothing is left counts for nothing.
        let gone = world.spawn((Pose::default(), Velocity::default(), GravityMass::new(1.0)));
        world.despawn(gone).unwrap();
        world.spawn(components);
        let population = Population::of(&world, laws);
        [population.interacts(), population.are_under_laws(), population.has_kinematic]
    }

    #[test]
    fn each_kind_is_found() {
        let own = ForceLaws::default();
        let pair = [Entity::DANGLING; 2];
        let spring = Spring::between(pair[0], pair[1]);
        let moving = || (Pose::default(), Momentum::default(), Velocity::default());
        assert_eq!(found(&own, moving()), [false; 3]);
        assert_eq!(found(&own, (Pose::default(),)), [false; 3]);
        assert_eq!(found(&own, (Pose::default(), Velocity::default())), [false, false, true]);
        assert_eq!(found(&own, (Collider::half_space(), Pose::default())), [true, false, false]);
        assert_eq!(found(&own, (Joint::ball(pair[0], pair[1]),)), [true, false, false]);
        assert_eq!(found(&own, (LockedAxes(Axes::LINEAR), Momentum::default())), [true, false, false]);
        assert!(found(&own, (spring,))[0] && found(&own, (GravityMass::new(1.0),))[0]);
        assert_eq!(found(&own, (Drag::isotropic(1.0), Momentum::default())), [false, true, false]);
        assert_eq!(found(&own, (Thruster::default(), Momentum::default())), [false, true, false]);
    }

    /// Does nothing.
    struct Idle;

    impl ForceLaw for Idle {
        fn wrench(&self, _: &BodyState<'_>) -> crate::components::Wrench {
            crate::components::Wrench::default()
        }
    }

    #[test]
    fn laws_that_were_added_act_on_all() {
        let mut laws = ForceLaws::default();
        laws.add_global(Idle);
        assert_eq!(found(&laws, (Pose::default(), Momentum::default())), [false, true, false]);
    }
}
