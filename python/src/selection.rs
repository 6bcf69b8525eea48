//! Which worlds or bodies a call is about.

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyByteArray, PyBytes, PyDict, PyFrozenSet, PySet, PyString};

use crate::error::Failure;

/// Indices in the order in which they are given: of `None` all; of one name or number that; of
/// booleans, one for each, those that are true; else of each name or number.
pub(crate) fn select(
    value: Option<&Bound<'_, PyAny>>,
    field: &str,
    count: usize,
    names: Option<&[String]>,
) -> PyResult<Vec<usize>> {
    let Some(value) = value.filter(|value| !value.is_none()) else { return Ok((0..count).collect()) };
    if let Ok(mask) = value.cast::<PyArrayDyn<bool>>() {
        if mask.ndim() != 1 {
            return Err(Failure::argument(field, format!("a mask has one axis, not {}", mask.ndim())).into());
        }
        let busy = |_| Failure::argument(field, "another call writes to the mask");
        let mask: Vec<bool> = mask.try_readonly().map_err(busy)?.as_array().iter().copied().collect();
        return masked(&mask, field, count);
    }
    if value.cast::<PyString>().is_ok() || (!is_boolean(value) && value.extract::<i64>().is_ok()) {
        return Ok(vec![one(value, field, count, names)?]);
    }
    let wrong = || Failure::type_of(field, "a name, a number, several of them, or a mask of booleans is needed");
    // A set has no order, in which rows of arrays could be.
    let is_bytes = value.cast::<PyBytes>().is_ok() || value.cast::<PyByteArray>().is_ok();
    if is_bytes || is_unordered(value) {
        return Err(wrong().into());
    }
    let items = value.try_iter().map_err(|_| wrong())?.collect::<PyResult<Vec<_>>>()?;
    if !items.is_empty() && items.iter().all(is_boolean) {
        let mask = items.iter().map(Bound::is_truthy).collect::<PyResult<Vec<_>>>()?;
        return masked(&mask, field, count);
    }
    let mut seen = vec![false; count];
    let mut chosen = Vec::with_capacity(items.len());
    for item in &items {
        let index = one(item, field, count, names)?;
        if let Some(seen) = seen.get_mut(index)
            && std::mem::replace(seen, true)
        {
            return Err(Failure::argument(field, format!("{item} is there twice")).into());
        }
        chosen.push(index);
    }
    Ok(chosen)
}

fn is_unordered(value: &Bound<'_, PyAny>) -> bool {
    value.cast::<PySet>().is_ok() || value.cast::<PyFrozenSet>().is_ok() || value.cast::<PyDict>().is_ok()
}

/// Whether it is a boolean of Python or of NumPy, which would pass for 0 or 1.
fn is_boolean(item: &Bound<'_, PyAny>) -> bool {
    let of_numpy = || item.get_type().name().is_ok_and(|name| name == "bool" || name == "bool_");
    item.cast::<PyBool>().is_ok() || of_numpy()
}

fn masked(mask: &[bool], field: &str, count: usize) -> PyResult<Vec<usize>> {
    if mask.len() != count {
        let problem = format!("a mask of {count} booleans is needed, not of {}", mask.len());
        return Err(Failure::argument(field, problem).into());
    }
    Ok(mask.iter().enumerate().filter(|(_, is_in)| **is_in).map(|(index, _)| index).collect())
}

fn one(item: &Bound<'_, PyAny>, field: &str, count: usize, names: Option<&[String]>) -> PyResult<usize> {
    if let (Ok(name), Some(names)) = (item.extract::<String>(), names) {
        let found = names.iter().position(|known| *known == name);
        return found.ok_or_else(|| Failure::argument(field, format!("the scene has no {name:?}")).into());
    }
    let index = item.extract::<i64>().ok().filter(|_| !is_boolean(item)).ok_or_else(|| {
        let kind = if names.is_some() { "a name or a number" } else { "a number" };
        Failure::type_of(field, format!("{kind} is needed, not {item}"))
    })?;
    let from_start = if index < 0 { index + count as i64 } else { index };
    let found = usize::try_from(from_start).ok().filter(|index| *index < count);
    found.ok_or_else(|| Failure::argument(field, format!("index {index} is out of range for {count}")).into())
}
