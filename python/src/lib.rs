//! What the Python module calls: verbs over arrays. The package around it gives names, options and errors.

mod ask;
mod given;
mod made;
mod work;

use meshwright::cli::within::{self, Call};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use given::GivenMesh;
use work::Hearing;

/// Runs a verb. Returns `(failure, products, report)`: `failure` and `report` are JSON or `None`.
#[pyfunction]
#[pyo3(signature = (arguments, meshes, threads=None, hear=None))]
fn run<'py>(
    py: Python<'py>,
    arguments: Vec<std::ffi::OsString>,
    meshes: Vec<GivenMesh<'py>>,
    threads: Option<usize>,
    hear: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyTuple>> {
    let mut named = Vec::with_capacity(meshes.len());
    for mesh in &meshes {
        match mesh.loaded() {
            Ok(loaded) => named.push((mesh.name.clone(), loaded)),
            Err(failure) => return (failure.to_string(), Vec::<Py<PyAny>>::new(), None::<String>).into_pyobject(py),
        }
    }
    drop(meshes);
    let answer = work::beside(py, Hearing { hear, threads }, move |progress| {
        within::call(Call { arguments, meshes: named, progress })
    })?;
    match answer {
        Ok(answer) => {
            let products: Vec<Bound<'py, PyAny>> =
                answer.products.into_iter().map(|product| made::product(py, product)).collect::<PyResult<_>>()?;
            (None::<String>, products, Some(answer.report.to_string())).into_pyobject(py)
        }
        Err(refusal) => {
            let failure = serde_json::to_string(&refusal.failure).unwrap_or_default();
            (failure, Vec::<Py<PyAny>>::new(), refusal.report.map(|report| report.to_string())).into_pyobject(py)
        }
    }
}

/// The flags of a verb, one dictionary each.
#[pyfunction]
fn flags<'py>(py: Python<'py>, verb: &str) -> PyResult<Option<Vec<Bound<'py, PyDict>>>> {
    let Some(flags) = within::flags(verb) else { return Ok(None) };
    let row = |flag: within::Flag| -> PyResult<Bound<'py, PyDict>> {
        let row = PyDict::new(py);
        row.set_item("name", flag.name)?;
        row.set_item("help", flag.help)?;
        row.set_item("value", flag.value)?;
        row.set_item("default", flag.default)?;
        row.set_item("choices", flag.choices)?;
        row.set_item("optional_value", flag.optional_value)?;
        row.set_item("required", flag.required)?;
        row.set_item("several", flag.several)?;
        Ok(row)
    };
    flags.into_iter().map(row).collect::<PyResult<Vec<_>>>().map(Some)
}

/// The module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<given::Texture>()?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(flags, module)?)?;
    module.add_function(wrap_pyfunction!(ask::read, module)?)?;
    module.add_function(wrap_pyfunction!(ask::write_grid, module)?)?;
    module.add_function(wrap_pyfunction!(ask::nearest, module)?)
}
