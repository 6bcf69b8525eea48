//! What one world and many have in common: arrays with or without an axis of worlds.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use tumble::math::{Real, Vec3};
use tumble::{Frame, Trial};

use crate::actions::Load;
use crate::arrays::{filled, finite, index_of, numbers, text};
use crate::error::Failure;
use crate::joints::{self, DriveQuantity, JointQuantity};
use crate::selection::select;
use crate::state::{self, Given, Layout, Property, Quantity};
use crate::threads::in_pool;

/// Worlds of one layout. Arrays have the axes `axes` before those of bodies and numbers.
pub(crate) struct Worlds<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) trials: Vec<&'a mut Trial>,
    /// The number of worlds, or nothing for a single one.
    pub(crate) axes: Vec<usize>,
}

/// An argument that may be left out.
pub(crate) type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

impl Worlds<'_> {
    fn shape(&self, rest: &[usize]) -> Vec<usize> {
        self.axes.iter().chain(rest).copied().collect()
    }

    /// Fills an array with some numbers of each world.
    fn read<'py>(
        self,
        py: Python<'py>,
        rest: &[usize],
        out: Option<Bound<'py, PyAny>>,
        one: impl Fn(&mut Trial, &mut [Real]) + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        let numbers: usize = rest.iter().product();
        let shape = self.shape(rest);
        let mut trials = self.trials;
        filled(py, out, &shape, |to| match trials.as_mut_slice() {
            _ if numbers == 0 => Ok(()),
            [trial] => {
                one(trial, to);
                Ok(())
            }
            more => in_pool(py, || {
                let parts = more.par_iter_mut().zip(to.par_chunks_mut(numbers)).with_min_len(8);
                parts.for_each(|(trial, to)| one(trial, to));
            }),
        })
    }

    pub(crate) fn read_state<'py>(
        self,
        py: Python<'py>,
        quantity: Quantity,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let rest = [self.layout.bodies(), quantity.width()];
        self.read(py, &rest, out, |trial, to| state::read(&mut trial.world, quantity, to))
    }

    pub(crate) fn read_property<'py>(self, py: Python<'py>, property: Property) -> PyResult<Bound<'py, PyAny>> {
        let layout = self.layout;
        let rest = [layout.bodies(), property.width()];
        let rest = if property.width() == 1 { &rest[..1] } else { &rest[..] };
        self.read(py, rest, None, |trial, to| state::read_properties(&trial.world, layout, property, to))
    }

    /// Which bodies sleep.
    pub(crate) fn read_asleep<'py>(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let entities = &self.layout.entities;
        let of_world = |trial: &&mut Trial| {
            let simulation = &trial.simulation;
            entities.iter().map(|&body| simulation.is_asleep(body)).collect::<Vec<_>>()
        };
        let asleep = self.trials.iter().flat_map(of_world).collect();
        Ok(PyArray1::from_vec(py, asleep).reshape(self.shape(&[entities.len()]))?.into_any())
    }

    pub(crate) fn read_joints<'py>(self, py: Python<'py>, quantity: JointQuantity) -> PyResult<Bound<'py, PyAny>> {
        let layout = self.layout;
        let rest = [layout.joints.len(), quantity.width()];
        self.read(py, &rest, None, |trial, to| joints::read(&trial.world, &layout.joints, quantity, to))
    }

    pub(crate) fn read_drives<'py>(self, py: Python<'py>, quantity: DriveQuantity) -> PyResult<Bound<'py, PyAny>> {
        let layout = self.layout;
        let rest = [layout.drives.len()];
        self.read(py, &rest, None, |trial, to| joints::read_drives(&trial.world, layout, quantity, to))
    }

    /// Sets quantities of the chosen bodies, all or nothing.
    pub(crate) fn set_state(
        mut self,
        bodies: Argument<'_, '_>,
        quantities: &[(Quantity, Argument<'_, '_>)],
    ) -> PyResult<()> {
        let bodies = select(bodies, "bodies", self.layout.bodies(), Some(&self.layout.names))?;
        let mut given = vec![Given::default(); self.trials.len() * bodies.len()];
        for &(quantity, value) in quantities {
            let Some(value) = value else { continue };
            let shape = self.shape(&[bodies.len(), quantity.width()]);
            let numbers = finite(value, quantity.name(), &shape)?;
            for (at, (given, numbers)) in given.iter_mut().zip(numbers.chunks(quantity.width())).enumerate() {
                let outer = shape.get(..shape.len() - 1).unwrap_or_default();
                given.take(quantity, numbers).map_err(|problem| {
                    let index = text(&index_of(at, outer));
                    Failure::argument(quantity.name(), format!("index {index}: {problem}"))
                })?;
            }
        }
        Ok(state::give(&mut self.trials, self.layout, &bodies, &given)?)
    }

    /// Forces and torques of the chosen bodies.
    fn loads(
        &self,
        bodies: &[usize],
        forces: Argument<'_, '_>,
        torques: Argument<'_, '_>,
        points: Argument<'_, '_>,
    ) -> PyResult<Vec<Load>> {
        let mut loads = vec![Load::default(); self.trials.len() * bodies.len()];
        let shape = self.shape(&[bodies.len(), 3]);
        let vectors = |value: Argument<'_, '_>, field| -> PyResult<Option<Vec<Vec3>>> {
            let Some(value) = value else { return Ok(None) };
            let numbers = finite(value, field, &shape)?;
            Ok(Some(numbers.chunks(3).filter_map(|it| <[Real; 3]>::try_from(it).ok()).map(Vec3::from).collect()))
        };
        if points.is_some() && forces.is_none() {
            return Err(Failure::argument("points", "forces are needed, which act there").into());
        }
        let fill = |loads: &mut [Load], vectors: Option<Vec<Vec3>>, set: fn(&mut Load, Vec3)| {
            loads.iter_mut().zip(vectors.into_iter().flatten()).for_each(|(load, vector)| set(load, vector));
        };
        fill(&mut loads, vectors(forces, "forces")?, |load, force| load.force = Some(force));
        fill(&mut loads, vectors(torques, "torques")?, |load, torque| load.torque = Some(torque));
        fill(&mut loads, vectors(points, "points")?, |load, point| load.point = Some(point));
        match loads.iter().find_map(Load::fault) {
            Some((field, limit)) => Err(Failure::argument(field, format!("a component is beyond {limit:e}")).into()),
            None => Ok(loads),
        }
    }

    /// Calls `act` with each world, each chosen body and its load.
    fn apply(
        self,
        py: Python<'_>,
        bodies: &[usize],
        loads: &[Load],
        act: impl Fn(&mut Trial, hecs::Entity, Load) + Sync,
    ) -> PyResult<()> {
        let (layout, mut trials) = (self.layout, self.trials);
        let one = |trial: &mut Trial, loads: &[Load]| {
            for (&body, &load) in bodies.iter().zip(loads) {
                if let Some(&entity) = layout.entities.get(body) {
                    act(trial, entity, load);
                }
            }
        };
        match trials.as_mut_slice() {
            _ if bodies.is_empty() => Ok(()),
            [trial] => {
                one(trial, loads);
                Ok(())
            }
            more => in_pool(py, || {
                let loads = loads.par_chunks(bodies.len());
                more.par_iter_mut().zip(loads).with_min_len(8).for_each(|(trial, loads)| one(trial, loads));
            }),
        }
    }

    /// Forces of the next step.
    pub(crate) fn push(
        self,
        py: Python<'_>,
        bodies: Argument<'_, '_>,
        forces: Argument<'_, '_>,
        torques: Argument<'_, '_>,
        points: Argument<'_, '_>,
    ) -> PyResult<()> {
        let bodies = select(bodies, "bodies", self.layout.bodies(), Some(&self.layout.names))?;
        let loads = self.loads(&bodies, forces, torques, points)?;
        self.apply(py, &bodies, &loads, |trial, body, load| load.push(&mut trial.world, body))
    }

    /// Forces of all steps from now on.
    pub(crate) fn hold(
        self,
        py: Python<'_>,
        bodies: Argument<'_, '_>,
        forces: Argument<'_, '_>,
        torques: Argument<'_, '_>,
        frame: &str,
    ) -> PyResult<()> {
        let frame = match frame {
            "world" => Frame::World,
            "body" => Frame::Body,
            other => return Err(Failure::argument("frame", format!("world or body is needed, not {other:?}")).into()),
        };
        let bodies = select(bodies, "bodies", self.layout.bodies(), Some(&self.layout.names))?;
        let forced = bodies.iter().find(|&&body| self.layout.forced.get(body).copied().unwrap_or(false));
        if let Some(name) = forced.and_then(|&body| self.layout.names.get(body)) {
            let problem = format!("the scene gives {name:?} a constant force, which would be lost");
            return Err(Failure::argument("bodies", problem).into());
        }
        let loads = self.loads(&bodies, forces, torques, None)?;
        for (trial, loads) in self.trials.iter().zip(loads.chunks(bodies.len().max(1))) {
            for (&body, load) in bodies.iter().zip(loads) {
                let entity = self.layout.entities.get(body);
                if entity.is_some_and(|&entity| load.turns_held(&trial.world, entity, frame)) {
                    let name = self.layout.names.get(body).map_or("", String::as_str);
                    let problem = format!("the force of {name:?} is in the other frame: set forces and torques both");
                    return Err(Failure::argument("frame", problem).into());
                }
            }
        }
        self.apply(py, &bodies, &loads, |trial, body, load| load.hold(&mut trial.world, body, frame))
    }

    /// Targets of the chosen drives, all or nothing.
    pub(crate) fn set_drives(
        self,
        drives: Argument<'_, '_>,
        quantities: &[(DriveQuantity, Argument<'_, '_>)],
    ) -> PyResult<()> {
        let names = self.layout.drive_names();
        let chosen = select(drives, "drives", names.len(), Some(&names))?;
        let shape = self.shape(&[chosen.len()]);
        let mut given = Vec::new();
        for &(quantity, value) in quantities {
            let Some(value) = value else { continue };
            let numbers = numbers(value, quantity.name(), &shape)?;
            if let Some(problem) = quantity.fault(&numbers) {
                return Err(Failure::argument(quantity.name(), problem).into());
            }
            given.push((quantity, numbers));
        }
        if chosen.is_empty() {
            return Ok(());
        }
        for (quantity, numbers) in given {
            for (trial, numbers) in self.trials.iter().zip(numbers.chunks(chosen.len())) {
                joints::set_drives(&trial.world, self.layout, &chosen, quantity, numbers);
            }
        }
        Ok(())
    }
}
