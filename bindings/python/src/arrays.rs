//! Numbers from numpy arrays, and arrays from numbers.
//!
//! They go through bytes: the stable interface of Python 3.10 has no buffers, and one copy is little beside the evaluation.

use pyo3::{
    exceptions::PyValueError,
    prelude::*,
    types::{PyByteArray, PyBytes, PyTuple},
};

/// Numbers of an array, last axis fastest, and its shape.
pub struct Array {
    /// The numbers.
    pub values: Vec<f64>,
    /// The shape.
    pub shape: Vec<usize>,
}

/// What numpy makes an array of doubles of.
pub fn read(given: &Bound<'_, PyAny>) -> PyResult<Array> {
    let numpy = given.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (given, "float64"))?;
    let shape = array.getattr("shape")?.extract()?;
    // In order of the last axis first, whatever the array's own.
    let bytes = array.call_method0("tobytes")?.cast_into::<PyBytes>()?;
    let values = bytes.as_bytes().as_chunks().0.iter().map(|bytes| f64::from_ne_bytes(*bytes)).collect();
    Ok(Array { values, shape })
}

/// Arrays of one shape, by numpy's rules of broadcasting.
pub fn read_together<const N: usize>(given: [&Bound<'_, PyAny>; N]) -> PyResult<([Vec<f64>; N], Vec<usize>)> {
    let numpy = given[0].py().import("numpy")?;
    let arrays = numpy.call_method1("broadcast_arrays", PyTuple::new(given[0].py(), given)?)?;
    let mut shape = Vec::new();
    let mut all: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for (index, values) in all.iter_mut().enumerate() {
        let array = read(&arrays.get_item(index)?)?;
        (*values, shape) = (array.values, array.shape);
    }
    Ok((all, shape))
}

/// Pressures with one FREE after the other along the last axis; the shape without that axis.
pub fn read_pressures(given: &Bound<'_, PyAny>, frees: usize) -> PyResult<(Vec<f64>, Vec<usize>)> {
    let Array { values, mut shape } = read(given)?;
    match shape.pop() {
        Some(last) if last == frees => Ok((values, shape)),
        last => Err(PyValueError::new_err(format!(
            "the model has {frees} FREEs, so that the last axis of the pressures has {frees} entries; it has {}",
            last.map_or("none".to_owned(), |last| last.to_string())
        ))),
    }
}

fn from_bytes<'py>(
    py: Python<'py>,
    bytes: &[u8],
    kind: &str,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    let shape = PyTuple::new(py, shape)?;
    if bytes.is_empty() {
        return numpy.call_method1("empty", (shape, kind));
    }
    // Of a bytearray, so that the array can be written to.
    let flat = numpy.call_method1("frombuffer", (PyByteArray::new(py, bytes), kind))?;
    flat.call_method1("reshape", (shape,))
}

/// An array of doubles: `lead`, then `tail`.
pub fn doubles<'py>(
    py: Python<'py>,
    values: &[f64],
    lead: &[usize],
    tail: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_ne_bytes()).collect();
    from_bytes(py, &bytes, "float64", &[lead, tail].concat())
}

/// An array of small numbers.
pub fn bytes<'py>(py: Python<'py>, values: &[u8], shape: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    from_bytes(py, values, "uint8", shape)
}
