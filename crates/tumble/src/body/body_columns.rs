//! Column writers for spawning batches of bodies, generated from one list of components.

use hecs::{BatchWriter, ColumnBatchBuilder, ColumnBatchType};

use crate::body::bundle::Body;
use crate::collision::collider::Collider;
use crate::components::{
    BodyId, CenterOfMass, Damping, GravityScale, Inertia, InverseInertia, Mass, Momentum, Pose, PreviousPose,
    PrincipalAxes, Velocity, Wrench,
};

/// Declares `BodyColumns`, writers of the columns that a body may have, and what goes over the same
/// list.
macro_rules! body_columns {
    ($($field:ident: $Component:ty),+) => {
        /// The columns of a batch of entities, being filled with bodies. A column that the batch
        /// has not is left out.
        pub(crate) struct BodyColumns<'b> {
            $($field: Option<BatchWriter<'b, $Component>>,)+
        }

        impl<'b> BodyColumns<'b> {
            /// # Panics
            /// Where another writer of one of the columns is alive.
            pub(crate) fn of(batch: &'b ColumnBatchBuilder) -> Self {
                Self { $($field: batch.writer(),)+ }
            }

            /// Writes the next row; what there is no room for is dropped.
            #[inline]
            pub(crate) fn push(&mut self, body: &Body) {
                $(if let (Some(column), Some(component)) = (&mut self.$field, Option::<&$Component>::from(&body.$field)) {
                    column.push(component.clone()).ok();
                })+
            }
        }

        impl Body {
            /// Adds the types of the body's components to those of a batch of entities, beside the
            /// caller's own; [`insert_copies_into`](Self::insert_copies_into) fills their columns.
            pub fn insert_types_into(&self, types: &mut ColumnBatchType) {
                $(if Option::<&$Component>::from(&self.$field).is_some() {
                    types.add::<$Component>();
                })+
            }

            /// Which components it has, a bit for each.
            pub(crate) fn kind(&self) -> u32 {
                let mut kind = 0;
                $(kind = kind << 1 | u32::from(Option::<&$Component>::from(&self.$field).is_some());)+
                kind
            }
        }
    };
}

body_columns! {
    pose: Pose,
    momentum: Momentum,
    mass: Mass,
    inertia: Inertia,
    axes: PrincipalAxes,
    center_of_mass: CenterOfMass,
    wrench: Wrench,
    velocity: Velocity,
    inverse_inertia: InverseInertia,
    gravity_scale: GravityScale,
    damping: Damping,
    previous_pose: PreviousPose,
    id: BodyId,
    collider: Collider
}
