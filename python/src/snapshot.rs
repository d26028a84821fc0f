//! Robots as they were at one moment, to go back to and to pickle.

use crate::setup::Setup;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rumbo_experiment::batch::Batch;

/// Robots as they were at one moment.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Snapshot {
    pub(crate) setup: Py<Setup>,
    pub(crate) callers: Vec<bool>,
    pub(crate) robots: Batch,
}

/// What defines a snapshot: its setup, which robots of a world the caller drives, seeds, and what was done to each robot.
type Parts<'py> = (
    Py<Setup>,
    Vec<bool>,
    Vec<u64>,
    Vec<Vec<Bound<'py, PyBytes>>>,
);

#[pymethods]
impl Snapshot {
    fn __len__(&self) -> usize {
        self.robots.robots().count()
    }

    /// What makes it again, anywhere, by [`crate::batch::Batch::new`].
    fn parts<'py>(&self, py: Python<'py>) -> Parts<'py> {
        let lives = self.robots.lives().into_iter();
        let (seeds, histories) = lives
            .map(|(seed, histories)| {
                let histories = histories.iter();
                let histories = histories.map(|history| PyBytes::new(py, history));
                (seed, histories.collect())
            })
            .unzip();
        (
            self.setup.clone_ref(py),
            self.callers.clone(),
            seeds,
            histories,
        )
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }
}

impl Snapshot {
    /// Whether a batch of so many robots, these of each world driven by the caller, can be put back to it.
    pub(crate) fn check(&self, callers: &[bool], robots: usize) -> PyResult<()> {
        let count = |callers: &[bool], robots: usize| match callers.len() {
            1 => format!("{robots} robots"),
            several => format!("{robots} robots, {several} in a world,"),
        };
        let (theirs, own) = (count(&self.callers, self.__len__()), count(callers, robots));
        match theirs == own {
            true => Ok(()),
            false => Err(PyValueError::new_err(format!(
                "a snapshot of {theirs} does not fit a batch of {own}"
            ))),
        }
    }
}
