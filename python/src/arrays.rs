//! NumPy arrays in and out.

use numpy::{PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use tumble::math::{PRECISION, Real};

use crate::error::Failure;

/// Numbers of any real type, brought to the shape: where an axis is missing or has length 1, they
/// are repeated along it.
pub(crate) fn doubles(value: &Bound<'_, PyAny>, field: &str, shape: &[usize]) -> PyResult<Vec<f64>> {
    let numpy = value.py().import("numpy")?;
    let array = as_array(value, field)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u") {
        let dtype = array.getattr("dtype")?;
        return Err(Failure::type_of(field, format!("real numbers are needed, not dtype {dtype}")).into());
    }
    let found: Vec<usize> = array.getattr("shape")?.extract()?;
    let spread = numpy.call_method1("broadcast_to", (&array, shape.to_vec()));
    let Ok(spread) = spread else {
        return Err(Failure::argument(field, format!("shape {} is needed, not {}", text(shape), text(&found))).into());
    };
    let made = value.py().import("tumble._model")?.call_method1("doubles", (spread,))?;
    let made = made.cast::<PyArrayDyn<f64>>().map_err(PyErr::from)?;
    let busy = |_| Failure::argument(field, "another call writes to the array");
    Ok(made.try_readonly().map_err(busy)?.as_slice()?.to_vec())
}

fn as_array<'py>(value: &Bound<'py, PyAny>, field: &str) -> PyResult<Bound<'py, PyAny>> {
    let py = value.py();
    py.import("numpy")?.call_method1("asarray", (value,)).map_err(|error| {
        if error.is_instance_of::<PyValueError>(py) || error.is_instance_of::<PyTypeError>(py) {
            Failure::type_of(field, format!("is no array of numbers: {error}")).into()
        } else {
            error
        }
    })
}

/// The shape that an argument has as an array.
pub(crate) fn shape_of(value: &Bound<'_, PyAny>, field: &str) -> PyResult<Vec<usize>> {
    as_array(value, field)?.getattr("shape")?.extract()
}

/// As [`doubles`], in the precision of the simulation.
pub(crate) fn numbers(value: &Bound<'_, PyAny>, field: &str, shape: &[usize]) -> PyResult<Vec<Real>> {
    // By way of double precision: what is too large for single becomes infinite without a warning.
    Ok(doubles(value, field, shape)?.into_iter().map(real).collect())
}

#[cfg(not(feature = "f64"))]
pub(crate) fn real(number: f64) -> Real {
    number as Real
}

#[cfg(feature = "f64")]
pub(crate) fn real(number: f64) -> Real {
    number
}

/// As [`numbers`], all of which are finite.
pub(crate) fn finite(value: &Bound<'_, PyAny>, field: &str, shape: &[usize]) -> PyResult<Vec<Real>> {
    let numbers = numbers(value, field, shape)?;
    match numbers.iter().position(|number| !number.is_finite()) {
        Some(at) => {
            let index = text(&index_of(at, shape));
            Err(Failure::argument(field, format!("{} at index {index} is not finite", numbers[at])).into())
        }
        None => Ok(numbers),
    }
}

/// The index of an element, axis by axis.
pub(crate) fn index_of(mut at: usize, shape: &[usize]) -> Vec<usize> {
    let mut index: Vec<usize> = shape
        .iter()
        .rev()
        .map(|&length| {
            let here = at % length.max(1);
            at /= length.max(1);
            here
        })
        .collect();
    index.reverse();
    index
}

/// An array of its own, which takes the numbers over.
pub(crate) fn array<'py>(py: Python<'py>, numbers: Vec<Real>, shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    Ok(numpy::PyArray1::from_vec(py, numbers).reshape(shape.to_vec())?.into_any())
}

/// Fills the array that the caller brought, or one of its own; returns it.
pub(crate) fn filled<'py>(
    py: Python<'py>,
    out: Option<Bound<'py, PyAny>>,
    shape: &[usize],
    fill: impl FnOnce(&mut [Real]) -> PyResult<()>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(out) = out else {
        let mut numbers = vec![0.0; shape.iter().product()];
        fill(&mut numbers)?;
        return array(py, numbers, shape);
    };
    let untyped = out.cast::<PyUntypedArray>();
    let untyped = untyped.map_err(|_| Failure::type_of("out", "a NumPy array is needed"))?;
    let Ok(typed) = out.cast::<PyArrayDyn<Real>>() else {
        return Err(
            Failure::type_of("out", format!("dtype {} is needed, not {}", dtype_name(), untyped.dtype())).into()
        );
    };
    if typed.shape() != shape {
        let problem = format!("shape {} is needed, not {}", text(shape), text(typed.shape()));
        return Err(Failure::argument("out", problem).into());
    }
    let unusable = || Failure::argument("out", "a writeable, C-contiguous array is needed");
    if !untyped.is_c_contiguous() {
        return Err(unusable().into());
    }
    let mut writer: PyReadwriteArrayDyn<'_, Real> = typed.try_readwrite().map_err(|_| unusable())?;
    fill(writer.as_slice_mut().map_err(|_| unusable())?)?;
    drop(writer);
    Ok(out)
}

/// A shape or an index as Python writes it.
pub(crate) fn text(shape: &[usize]) -> String {
    let numbers: Vec<String> = shape.iter().map(usize::to_string).collect();
    match numbers.as_slice() {
        [one] => format!("({one},)"),
        more => format!("({})", more.join(", ")),
    }
}

fn dtype_name() -> &'static str {
    if PRECISION == "f32" { "float32" } else { "float64" }
}
