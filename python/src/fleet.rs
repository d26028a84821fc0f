//! The robots of a scenario with several, in one world, stepped from Python: for `rumbo.Fleet` and the parallel environments.

use crate::batch::{beyond, checked, corners, hold, in_strides, rows};
use crate::guard::{detached, exception};
use crate::setup::Setup;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rumbo_control::mode::ModeId;
use rumbo_control::{ServoAngle, Wheels};
use rumbo_experiment::batch::{Driver, OBSERVED, TRUE, Team};
use rumbo_wire::Command;
use std::sync::{Mutex, MutexGuard};

/// Robots in one world.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Fleet {
    team: Mutex<Team>,
    names: Vec<String>,
}

#[pymethods]
impl Fleet {
    /// The robots of a seed; those of `callers`, by their names, are driven by the caller, the others by the scenario.
    #[new]
    #[pyo3(signature = (setup, seed, *, callers))]
    fn new(py: Python<'_>, setup: &Setup, seed: u64, callers: Vec<String>) -> PyResult<Self> {
        let robots = &setup.files.fleet;
        if robots.is_empty() {
            return Err(PyValueError::new_err(format!(
                "scenario {}: has one robot; give a scenario with [[fleet]], or take rumbo.Sim",
                setup.files.scenario.name
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
        let team = detached(py, || Team::new(&setup.files, driver, seed))?;
        Ok(Self {
            team: Mutex::new(team.map_err(|error| exception(&error))?),
            names,
        })
    }

    /// Advances all by this many control ticks.
    fn advance(&self, py: Python<'_>, ticks: u32) -> PyResult<()> {
        let mut held = self.lock()?;
        let team = &mut *held;
        in_strides(py, ticks, |now| detached(py, || team.advance(now)))
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
        let (actions, active) = checked(&actions, &active, self.names.len())?;
        {
            let mut team = self.lock()?;
            let rows = actions.iter().zip(active);
            for (index, ([left, right, servo_rad], active)) in rows.enumerate() {
                let (left, right) = (*left, *right);
                let command = match active {
                    true => Command::WheelReference(Wheels { left, right }),
                    false => Command::Disarm,
                };
                // In range: only a robot of another mode refuses it, and that one drives by its mode.
                let _ = team.command(index, &command);
                team.aim(index, active.then_some(ServoAngle(*servo_rad)));
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
