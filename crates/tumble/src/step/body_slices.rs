//! Stepping of bodies held in plain slices, without a world.

use crate::components::{
    Damping, GravityScale, Inertia, InverseInertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity, Wrench,
};
use crate::forces::registry::Laws;
use crate::settings::Settings;
use crate::step::systems::step_chunk;
use crate::storage::chunk::{Chunk, for_each_part};

/// Bodies outside any world: plain slices, one per component, with body `i` at index `i` of each.
///
/// The step does the same to them as to the columns of a [`hecs::World`], with the same bits. For
/// those who keep bodies in another ECS or in arrays of their own; force laws and the ledger need a
/// world.
///
/// ```
/// use tumble::math::Vec3;
/// use tumble::{BodySlices, Inertia, Mass, Momentum, Pose, Settings, Wrench};
/// let mut poses = vec![Pose::default(); 100];
/// let mut momenta =
///     vec![Momentum { angular: Vec3::new(0.1, 2.0, 0.0), ..Momentum::default() }; 100];
/// let mut wrenches = vec![Wrench::default(); 100];
/// let masses = vec![Mass::new(2.0)?; 100];
/// let inertias = vec![Inertia::new(Vec3::new(1.0, 2.0, 2.5))?; 100];
///
/// let mut bodies = BodySlices::new(&mut poses, &mut momenta, &mut wrenches, &masses);
/// bodies.inertia = Some(&inertias);
/// bodies.step(&Settings::default())?;
/// assert!(poses[99].position.y < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct BodySlices<'a> {
    /// State.
    pub pose: &'a mut [Pose],
    /// State.
    pub momentum: &'a mut [Momentum],
    /// Input; zeroed by the step.
    pub wrench: &'a mut [Wrench],
    /// Constant.
    pub mass: &'a [Mass],
    /// Constant; without it the bodies are points that do not turn.
    pub inertia: Option<&'a [Inertia]>,
    /// Constant; without it the body frames are principal.
    pub axes: Option<&'a [PrincipalAxes]>,
    /// How gravity acts; without it, on all alike.
    pub gravity_scale: Option<&'a [GravityScale]>,
    /// Decay of the momenta; without it there is none.
    pub damping: Option<&'a [Damping]>,
    /// Derived, where wanted.
    pub velocity: Option<&'a mut [Velocity]>,
    /// Derived, where wanted.
    pub inverse_inertia: Option<&'a mut [InverseInertia]>,
    /// The poses before the last step, where wanted.
    pub previous_pose: Option<&'a mut [PreviousPose]>,
}

/// A slice that has not as many rows as there are bodies.
///
/// ```
/// # use tumble::{BodySlices, Momentum, Pose, Settings, LengthMismatch, Wrench};
/// let (mut pose, mut momentum, mut wrench) =
///     ([Pose::default()], [Momentum::default()], [Wrench::default()]);
/// let error = BodySlices::new(&mut pose, &mut momentum, &mut wrench, &[])
///     .step(&Settings::default())
///     .unwrap_err();
/// assert_eq!(error, LengthMismatch { column: "mass", rows: 0, bodies: 1 });
/// ```
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("{column} has {rows} rows, and there are {bodies} poses")]
pub struct LengthMismatch {
    /// The component.
    pub column: &'static str,
    /// Its length.
    pub rows: usize,
    /// The length of the poses.
    pub bodies: usize,
}

tumble_math::debug_as_display!(LengthMismatch);

impl<'a> BodySlices<'a> {
    /// What every body has; the other components are set on the result.
    pub fn new(pose: &'a mut [Pose], momentum: &'a mut [Momentum], wrench: &'a mut [Wrench], mass: &'a [Mass]) -> Self {
        Self {
            pose,
            momentum,
            wrench,
            mass,
            inertia: None,
            axes: None,
            gravity_scale: None,
            damping: None,
            velocity: None,
            inverse_inertia: None,
            previous_pose: None,
        }
    }

    /// Advances every body by `settings.dt`; see [`step`](crate::step()).
    ///
    /// # Errors
    /// [`LengthMismatch`], and nothing is changed.
    pub fn step(&mut self, settings: &Settings) -> Result<(), LengthMismatch> {
        self.step_many(settings, 1)
    }

    /// Several [`step`](Self::step)s, with the same bits.
    ///
    /// # Errors
    /// [`LengthMismatch`], and nothing is changed.
    pub fn step_many(&mut self, settings: &Settings, count: u32) -> Result<(), LengthMismatch> {
        self.check()?;
        if count > 0 {
            let chunk = Chunk {
                first_row: 0,
                pose: self.pose,
                momentum: self.momentum,
                wrench: self.wrench,
                mass: self.mass,
                velocity: self.velocity.as_deref_mut(),
                inverse_inertia: self.inverse_inertia.as_deref_mut(),
                previous_pose: self.previous_pose.as_deref_mut(),
                work: None,
                inertia: self.inertia,
                axes: self.axes,
                gravity_scale: self.gravity_scale,
                damping: self.damping,
                wind: None,
            };
            for_each_part(chunk, &|bodies: &mut Chunk<'_>| {
                step_chunk(bodies, Laws::default(), settings, count, &|_| 0.0);
            });
        }
        Ok(())
    }

    fn check(&self) -> Result<(), LengthMismatch> {
        fn rows<T>(column: Option<&[T]>) -> Option<usize> {
            column.map(<[T]>::len)
        }
        let columns = [
            ("momentum", Some(self.momentum.len())),
            ("wrench", Some(self.wrench.len())),
            ("mass", Some(self.mass.len())),
            ("inertia", rows(self.inertia)),
            ("axes", rows(self.axes)),
            ("gravity_scale", rows(self.gravity_scale)),
            ("damping", rows(self.damping)),
            ("velocity", rows(self.velocity.as_deref())),
            ("inverse_inertia", rows(self.inverse_inertia.as_deref())),
            ("previous_pose", rows(self.previous_pose.as_deref())),
        ];
        let bodies = self.pose.len();
        match columns.into_iter().find_map(|(column, rows)| Some((column, rows.filter(|rows| *rows != bodies)?))) {
            Some((column, rows)) => Err(LengthMismatch { column, rows, bodies }),
            None => Ok(()),
        }
    }
}
