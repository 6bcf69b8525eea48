//! The columns of a world's bodies, borrowed once for all steps that are taken at a time.
//!
//! To borrow a dozen columns takes as long as to step a body or two. Bodies that act on each other
//! are gone through half a dozen times a step, so in a world of ten of them it would take longer
//! than all the rest.

use std::cell::RefCell;
use std::ops::Range;

use hecs::{Archetype, ArchetypeColumn, ArchetypeColumnMut, World};

use crate::components::{GravityScale, Inertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity};
use crate::integrators::kinematic::move_a_substep;
use crate::math::Real;
use crate::storage::body_index::RowPlace;
use crate::storage::chunk::{Chunk, Columns, for_each_part};

/// The columns of all bodies of a world.
pub(crate) struct WorldColumns<'w> {
    /// By the index that they have in the world.
    archetypes: Vec<ArchetypeColumns<'w>>,
}

struct ArchetypeColumns<'w> {
    archetype: &'w Archetype,
    /// The marks that the caller gave when it borrowed the columns.
    is_marked: bool,
    bodies: ArchetypeBodies<'w>,
}

/// The columns of one archetype.
#[allow(clippy::large_enum_variant, reason = "there are a few of them, and boxes would be allocated in every call")]
pub(crate) enum ArchetypeBodies<'w> {
    /// Of dynamic bodies.
    Dynamic(Columns<'w>),
    /// Of fixed and kinematic bodies.
    NonDynamic(NonDynamicColumns<'w>),
    /// Of no bodies.
    None,
}

/// The columns of fixed and kinematic bodies.
pub(crate) struct NonDynamicColumns<'w> {
    pub(crate) pose: ArchetypeColumnMut<'w, Pose>,
    velocity: Option<ArchetypeColumn<'w, Velocity>>,
    previous_pose: Option<ArchetypeColumnMut<'w, PreviousPose>>,
    is_kinematic: bool,
}

/// Momenta, masses and, of what turns, inertia.
pub(crate) type MomentumView<'a> = (&'a [Momentum], &'a [Mass], Option<&'a [Inertia]>);

/// The columns that collision detection reads of one archetype.
#[derive(Clone, Copy)]
pub(crate) struct PoseView<'a> {
    pub(crate) pose: &'a [Pose],
    /// Of dynamic bodies.
    pub(crate) dynamic: Option<MomentumView<'a>>,
    pub(crate) velocity: Option<&'a [Velocity]>,
    /// Of dynamic bodies, where they are not the body's.
    pub(crate) axes: Option<&'a [PrincipalAxes]>,
    pub(crate) gravity_scale: Option<&'a [GravityScale]>,
}

impl<'a> PoseView<'a> {
    pub(crate) fn rows(self, rows: Range<usize>) -> Self {
        Self {
            pose: &self.pose[rows.clone()],
            dynamic: self.dynamic.map(|(momenta, masses, inertia)| {
                (&momenta[rows.clone()], &masses[rows.clone()], inertia.map(|inertia| &inertia[rows.clone()]))
            }),
            velocity: self.velocity.map(|velocities| &velocities[rows.clone()]),
            axes: self.axes.map(|axes| &axes[rows.clone()]),
            gravity_scale: self.gravity_scale.map(|scales| &scales[rows]),
        }
    }
}

thread_local! {
    /// Memory of columns that were given back, for the next. hecs keeps borrowed columns to one
    /// thread, so it is not a simulation's, which goes from thread to thread.
    static SPARE: RefCell<Vec<Vec<ArchetypeColumns<'static>>>> = const { RefCell::new(Vec::new()) };
}

impl<'w> WorldColumns<'w> {
    /// Borrows the columns of all bodies of a world, and marks some archetypes for
    /// [`for_each_archetype`](Self::for_each_archetype).
    pub(crate) fn of(world: &'w World, mark: impl Fn(&Archetype) -> bool) -> Self {
        let spare = SPARE.try_with(|spares| spares.borrow_mut().pop()).ok().flatten();
        let mut archetypes = emptied(spare.unwrap_or_default());
        archetypes.extend(world.archetypes().map(|archetype| ArchetypeColumns {
            archetype,
            is_marked: mark(archetype),
            bodies: ArchetypeBodies::of(archetype),
        }));
        Self { archetypes }
    }

    /// The archetypes of bodies by index, and whether these are dynamic.
    pub(crate) fn kinds(&self) -> impl Iterator<Item = (usize, bool)> + '_ {
        self.archetypes.iter().enumerate().filter_map(|(index, of_archetype)| match of_archetype.bodies {
            ArchetypeBodies::Dynamic(_) => Some((index, true)),
            ArchetypeBodies::NonDynamic(_) => Some((index, false)),
            ArchetypeBodies::None => None,
        })
    }

    /// The columns of the archetype of a place.
    pub(crate) fn bodies(&self, place: RowPlace) -> &ArchetypeBodies<'w> {
        &self.archetypes[place.archetype as usize].bodies
    }

    /// The archetype of a place.
    pub(crate) fn archetype(&self, place: RowPlace) -> &Archetype {
        self.archetypes[place.archetype as usize].archetype
    }

    /// The columns of the archetype of a place, if its bodies are dynamic.
    pub(crate) fn dynamic_mut(&mut self, place: RowPlace) -> Option<&mut Columns<'w>> {
        match &mut self.archetypes[place.archetype as usize].bodies {
            ArchetypeBodies::Dynamic(columns) => Some(columns),
            ArchetypeBodies::NonDynamic(_) | ArchetypeBodies::None => None,
        }
    }

    /// The columns to be read, by archetype.
    pub(crate) fn pose_views(&self) -> impl Iterator<Item = (usize, PoseView<'_>)> {
        self.archetypes.iter().enumerate().filter_map(|(index, of_archetype)| {
            let pose_views = match &of_archetype.bodies {
                ArchetypeBodies::Dynamic(columns) => {
                    let dynamic = Some((&*columns.momentum, &*columns.mass, columns.inertia.as_deref()));
                    PoseView {
                        pose: &columns.pose,
                        dynamic,
                        velocity: columns.velocity.as_deref(),
                        axes: columns.axes.as_deref(),
                        gravity_scale: columns.gravity_scale.as_deref(),
                    }
                }
                ArchetypeBodies::NonDynamic(columns) => {
                    let velocity = columns.velocity.as_deref();
                    PoseView { pose: &columns.pose, dynamic: None, velocity, axes: None, gravity_scale: None }
                }
                ArchetypeBodies::None => return None,
            };
            Some((index, pose_views))
        })
    }

    /// Calls `system` once for every chunk of moving bodies, with the index of their archetype, in
    /// parallel.
    pub(crate) fn for_each_chunk(&mut self, system: impl Fn(usize, &mut Chunk<'_>) + Sync) {
        for (index, of_archetype) in self.archetypes.iter_mut().enumerate() {
            if let ArchetypeBodies::Dynamic(columns) = &mut of_archetype.bodies {
                for_each_part(columns.chunk(), &|part: &mut Chunk<'_>| system(index, part));
            }
        }
    }

    /// Calls `then` for each archetype of moving bodies, one after the other, with its index,
    /// whether it was marked, and its columns.
    pub(crate) fn for_each_archetype(&mut self, mut then: impl FnMut(usize, (&Archetype, bool), &mut Columns<'w>)) {
        for (index, ArchetypeColumns { archetype, is_marked, bodies }) in self.archetypes.iter_mut().enumerate() {
            if let ArchetypeBodies::Dynamic(columns) = bodies {
                then(index, (archetype, *is_marked), columns);
            }
        }
    }

    /// Moves the kinematic bodies for one of the equal parts, `h` \[s\], of a step; the previous
    /// pose is that before the first.
    pub(crate) fn move_kinematic_bodies(&mut self, h: Real, substep: u32) {
        for of_archetype in &mut self.archetypes {
            match &mut of_archetype.bodies {
                ArchetypeBodies::NonDynamic(bodies) if bodies.is_kinematic => bodies.move_a_substep(h, substep),
                _ => {}
            }
        }
    }
}

/// The memory of what is no longer borrowed: collected in place.
fn emptied<'b>(mut columns: Vec<ArchetypeColumns<'_>>) -> Vec<ArchetypeColumns<'b>> {
    columns.clear();
    columns.into_iter().map_while(|_| None).collect()
}

impl Drop for WorldColumns<'_> {
    fn drop(&mut self) {
        let spare = emptied(std::mem::take(&mut self.archetypes));
        // A thread that ends keeps no memory.
        let _ = SPARE.try_with(|spares| spares.borrow_mut().push(spare));
    }
}

impl<'w> ArchetypeBodies<'w> {
    fn of(archetype: &'w Archetype) -> Self {
        if archetype.is_empty() {
            return Self::None;
        }
        if let Some(columns) = Columns::borrow(archetype) {
            return Self::Dynamic(columns);
        }
        let Some(pose) = archetype.get::<&mut Pose>() else { return Self::None };
        let velocity = archetype.get::<&Velocity>();
        let is_kinematic = velocity.is_some() && !archetype.has::<Momentum>();
        Self::NonDynamic(NonDynamicColumns {
            pose,
            velocity,
            previous_pose: archetype.get::<&mut PreviousPose>(),
            is_kinematic,
        })
    }
}

impl NonDynamicColumns<'_> {
    /// How the body of a row moves if it is kinematic.
    pub(crate) fn velocity(&self, row: usize) -> Velocity {
        self.velocity.as_deref().map_or(Velocity::default(), |velocities| velocities[row])
    }

    fn move_a_substep(&mut self, h: Real, substep: u32) {
        for row in 0..self.pose.len() {
            let velocity = self.velocity(row);
            let previous = self.previous_pose.as_deref_mut().map(|previous| &mut previous[row]);
            move_a_substep(&mut self.pose[row], &velocity, previous, (h, substep));
        }
    }
}
