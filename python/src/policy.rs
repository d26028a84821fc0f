//! Policies as the robot evaluates them.

use crate::arrays::{has_rows, rows};
use crate::guard::exception;
use crate::setup::library;
use crate::study::refuse;
use numpy::{PyReadonlyArray2, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rumbo_control::policy::{OBSERVED, OUTPUTS, decide};
use rumbo_experiment::files::{Kind, PolicyFile};
use rumbo_experiment::quantise::{Floats, quantise as to_integers};

/// A policy in integers.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Policy {
    file: PolicyFile,
}

/// A network in floats, as JSON, made into a policy file of this title: its text.
#[pyfunction]
pub(crate) fn quantise(network: &str, title: &str) -> PyResult<String> {
    let floats: Floats = serde_json::from_str(network).map_err(refuse)?;
    Ok(to_integers(&floats, title).map_err(refuse)?.text)
}

#[pymethods]
impl Policy {
    /// `held` are files given as text, as for a setup.
    #[new]
    fn new(name: &str, held: Vec<(String, String, String)>) -> PyResult<Self> {
        let file = library(held)?.policy(name);
        Ok(Self {
            file: file.map_err(|error| exception(&error))?,
        })
    }

    /// Its title.
    #[getter]
    fn title(&self) -> &str {
        &self.file.title
    }

    /// The arguments that make it anywhere.
    fn arguments(&self) -> (&str, Vec<(&str, &str, &str)>) {
        let PolicyFile { name, text, .. } = &self.file;
        (name, vec![(Kind::Policy.word(), name, text)])
    }

    /// Its layers, in words.
    #[getter]
    fn shape(&self) -> String {
        self.file.shape.to_string()
    }

    /// Writes the outputs for each row of observations.
    fn decide(
        &self,
        observations: PyReadonlyArray2<'_, f32>,
        mut outputs: PyReadwriteArray2<'_, i8>,
    ) -> PyResult<()> {
        let count = observations.shape().first().copied().unwrap_or_default();
        has_rows("observations", observations.shape(), count, OBSERVED.len())?;
        if !observations.is_c_contiguous() {
            return Err(PyValueError::new_err("observations must be C-contiguous"));
        }
        let (shape, bytes) = (&self.file.shape, &self.file.bytes);
        let read = |at: u16| bytes.get(usize::from(at)).copied().unwrap_or_default();
        let outputs = rows("outputs", &mut outputs, count, OUTPUTS)?;
        let (seen, made) = (
            observations.as_slice()?.as_chunks().0,
            outputs.as_chunks_mut().0,
        );
        for (seen, made) in seen.iter().zip(made) {
            *made = decide(shape, read, seen);
        }
        Ok(())
    }
}
