//! The robots of a scenario with several, in one world, stepped from Python: for `rumbo.Fleet` and the parallel environments.

use crate::batch::{MOST_SPEED, beyond, checked, corners, hold, in_strides, rows, stride};
use crate::guard::{call, detached, exception};
use crate::setup::Setup;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use rumbo_control::mode::ModeId;
use rumbo_control::{ServoAngle, Wheels};
use rumbo_experiment::batch::{Driver, OBSERVED, TRUE, Team};
use rumbo_experiment::files::FileError;
use rumbo_wire::Command;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Robots in one world.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Fleet {
    setup: Py<Setup>,
    team: Mutex<Team>,
    names: Vec<String>,
    callers: Vec<String>,
}

/// What defines robots in one world: their setup, their seed, who is driven by the caller, and what was done to them.
type Parts<'py> = (Py<Setup>, u64, Vec<String>, Bound<'py, PyBytes>);

#[pymethods]
impl Fleet {
    /// The robots of a seed; those of `callers`, by their names, are driven by the caller, the others by the scenario. They
    /// are at their start, or after the acts of their history.
    #[new]
    #[pyo3(signature = (setup, seed, *, callers, history=None))]
    fn new(
        py: Python<'_>,
        setup: Py<Setup>,
        seed: u64,
        callers: Vec<String>,
        history: Option<PyBackedBytes>,
    ) -> PyResult<Self> {
        let files = &setup.get().files;
        let robots = &files.fleet;
        if robots.is_empty() {
            return Err(PyValueError::new_err(format!(
                "scenario {}: has one robot; give a scenario with [[fleet]], or take rumbo.Sim",
                files.scenario.name
            )));
        }
        let names: Vec<String> = robots
            .iter()
            .map(|robot| robot.scenario.name.clone())
            .collect();
        if let Some(unknown) = callers.iter().find(|caller| !names.contains(caller)) {
            return Err(PyValueError::new_err(format!(
                "no robot {unknown:?}: the scenario has {}",
                names.join(", ")
            )));
        }
        let driver = |index: usize| match names.get(index).is_some_and(|own| callers.contains(own))
        {
            true => Driver::Caller,
            false => Driver::Scenario,
        };
        let interrupted = Mutex::new(None);
        let made = || {
            call(None, 0.0).map_err(|error| {
                *interrupted.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                FileError::Setting("interrupted".to_owned())
            })
        };
        let team = detached(py, || {
            let mut team = Team::made(files, driver, seed, &made)?;
            team.relive(history.as_deref().unwrap_or_default())?;
            Ok(team)
        })?;
        let interrupted = interrupted.into_inner();
        if let Some(error) = interrupted.unwrap_or_else(PoisonError::into_inner) {
            return Err(error);
        }
        Ok(Self {
            team: Mutex::new(team.map_err(|error: FileError| exception(&error))?),
            setup,
            names,
            callers,
        })
    }

    /// What makes them again, anywhere, by [`Fleet::new`].
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let team = self.lock()?;
        Ok((
            self.setup.clone_ref(py),
            team.seed(),
            self.callers.clone(),
            PyBytes::new(py, &team.history()),
        ))
    }

    /// Others that go on by themselves from here.
    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self {
            setup: self.setup.clone_ref(py),
            team: Mutex::new(self.lock()?.clone()),
            names: self.names.clone(),
            callers: self.callers.clone(),
        })
    }

    /// Advances all by this many control ticks.
    fn advance(&self, py: Python<'_>, ticks: u32) -> PyResult<()> {
        let mut held = self.lock()?;
        let team = &mut *held;
        let stride = stride(self.names.len());
        in_strides(py, ticks, stride, |now| detached(py, || team.advance(now)))
    }

    /// Writes what each robot's program knows, and ground truth: a row for each robot.
    fn observe(
        &self,
        mut known: PyReadwriteArray2<'_, f32>,
        mut truth: PyReadwriteArray2<'_, f64>,
    ) -> PyResult<()> {
        let known = rows("known", &mut known, self.names.len(), OBSERVED.len())?;
        let truth = rows("truth", &mut truth, self.names.len(), TRUE.len())?;
        self.lock()?.observe(known, truth);
        Ok(())
    }

    /// Gives each robot that the caller drives its row of `actions`, and advances all by this many control ticks. Robots of
    /// which `active` is false are disarmed.
    fn drive(
        &self,
        py: Python<'_>,
        actions: PyReadonlyArray2<'_, f32>,
        active: PyReadonlyArray1<'_, bool>,
        ticks: u32,
    ) -> PyResult<()> {
        let (actions, active) = checked(&actions, &active, self.names.len(), MOST_SPEED)?;
        {
            let mut team = self.lock()?;
            let rows = actions.iter().zip(active);
            for (index, ([left, right, servo_rad], active)) in rows.enumerate() {
                let (left, right) = (*left, *right);
                if *active {
                    team.drive(index, Wheels { left, right }, ServoAngle(*servo_rad));
                } else {
                    // One that is disarmed stays so.
                    let _ = team.command(index, &Command::Disarm);
                    team.aim(index, None);
                }
            }
        }
        self.advance(py, ticks)
    }

    /// Selects the mode of wheel speeds for the robots that the caller drives, arms them, and lets all of them go on for
    /// this many ticks.
    fn begin(&self, py: Python<'_>, ticks: u32) -> PyResult<()> {
        for index in 0..self.names.len() {
            let mut team = self.lock()?;
            for command in [Command::Mode(ModeId::WheelSpeed), Command::Arm] {
                // A robot at its start obeys; one of the scenario does not, and need not.
                let _ = team.command(index, &command);
            }
        }
        self.advance(py, ticks)
    }

    /// Corners of each obstacle that stands in the world [m].
    fn obstacles(&self) -> PyResult<Vec<Vec<[f64; 2]>>> {
        Ok(self.lock()?.world(0).map(corners).unwrap_or_default())
    }

    /// The fault that one robot has latched, in words.
    fn fault(&self, index: usize) -> PyResult<Option<&'static str>> {
        if index >= self.names.len() {
            return Err(beyond(index, self.names.len()));
        }
        Ok(self.lock()?.fault(index))
    }
}

impl Fleet {
    fn lock(&self) -> PyResult<MutexGuard<'_, Team>> {
        hold(&self.team)
    }
}
