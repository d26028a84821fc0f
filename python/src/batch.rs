//! Robots stepped from Python: one for `rumbo.Sim`, many for `rumbo.Batch` and the environments, each alone in its world
//! or with the others of its scenario.

use crate::arrays::{MOST_DUTY, MOST_SPEED, check_actions, checked, rows};
use crate::guard::{detached, exception, making, pool, threads};
use crate::setup::Setup;
use crate::snapshot::Snapshot;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2, ToPyArray};
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use rumbo_control::mode::ModeId;
use rumbo_control::{ServoAngle, Wheels};
use rumbo_experiment::batch::{Batch as Robots, DrivenBy, OBSERVED, Robot, TRUE};
use rumbo_experiment::files::FileError;
use rumbo_lab::run_log::RunSource;
use rumbo_log::LogKind;
use rumbo_plant::world::World;
use rumbo_session::headless::record_run;
use rumbo_wire::Command;
use std::io::Cursor;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Between two looks for Ctrl-C: at most a second of simulated time, and no more ticks of all robots together than a core
/// simulates in some 0.1 s.
const STRIDE_TICKS: usize = 100;
const STRIDE_OF_ALL: usize = 100_000;
/// How many of our native robots an emulated one weighs.
const EMULATED: usize = 50;

/// Robots of one setup.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Batch {
    setup: Py<Setup>,
    robots: Mutex<Robots>,
    /// Of each robot of a world, whether the caller drives it.
    callers: Vec<bool>,
    worlds: usize,
    threads: usize,
}

#[pymethods]
impl Batch {
    /// The robots of each seed, at their start, or after the acts of their histories; those of `callers` are driven by the
    /// caller. `progress` is called with the share that is made.
    #[new]
    #[pyo3(signature = (setup, seeds, *, callers, threads, histories=None, progress=None))]
    fn new(
        py: Python<'_>,
        setup: Py<Setup>,
        seeds: Vec<u64>,
        callers: Vec<bool>,
        threads: Option<i64>,
        histories: Option<Vec<Vec<PyBackedBytes>>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let threads = self::threads(threads)?;
        let histories = histories.unwrap_or_default();
        let histories = histories
            .iter()
            .map(|of_world| of_world.iter().map(|history| history.to_vec()).collect());
        let histories = histories.chain(std::iter::repeat(Vec::new()));
        let lives: Vec<_> = seeds.into_iter().zip(histories).collect();
        let drivers = callers.iter().map(|caller| match caller {
            true => DrivenBy::Caller,
            false => DrivenBy::Scenario,
        });
        let drivers: Vec<_> = drivers.collect();
        let files = &setup.get().files;
        let robots = making(
            py,
            (lives.len() > 1).then_some(threads),
            lives.len() * callers.len(),
            progress.as_ref(),
            |made| Robots::of_lives(files, drivers, &lives, made),
        )?;
        Ok(Self {
            setup,
            robots: Mutex::new(robots),
            callers,
            worlds: lives.len(),
            threads,
        })
    }

    /// One that goes on by itself from here.
    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self {
            setup: self.setup.clone_ref(py),
            robots: Mutex::new(self.lock()?.clone()),
            callers: self.callers.clone(),
            worlds: self.worlds,
            threads: self.threads,
        })
    }

    /// Its number of threads.
    #[getter]
    fn threads(&self) -> usize {
        self.threads
    }

    /// Which robots of a world the caller drives.
    #[getter]
    fn callers(&self) -> Vec<bool> {
        self.callers.clone()
    }

    /// What is simulated.
    #[getter]
    fn setup(&self, py: Python<'_>) -> Py<Setup> {
        self.setup.clone_ref(py)
    }

    fn __len__(&self) -> usize {
        self.worlds * self.callers.len()
    }

    /// The robots' seeds.
    fn seeds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let seeds: Vec<u64> = self.lock()?.robots().map(Robot::seed).collect();
        Ok(seeds.to_pyarray(py))
    }

    /// Advances every robot by this many control ticks.
    fn advance(&self, py: Python<'_>, ticks: u32) -> PyResult<()> {
        let mut held = self.lock()?;
        let robots = &mut *held;
        in_strides(py, ticks, self.stride(), |now| {
            self.on_threads(py, || robots.advance(now))
        })
    }

    /// Writes what each robot's program knows, and ground truth: a row for each robot.
    fn observe(
        &self,
        py: Python<'_>,
        known: PyReadwriteArray2<'_, f32>,
        truth: PyReadwriteArray2<'_, f64>,
    ) -> PyResult<()> {
        self.step(py, known, truth, 0, |_, _, _| false)
    }

    /// Gives each robot that the caller drives its row of `actions`, of wheel speeds or of shares of the full PWM, advances
    /// all by this many control ticks and writes their rows. Robots of which `active` is false are disarmed; a world where
    /// it is false for all that the caller drives stands still in time.
    #[pyo3(signature = (actions, active, ticks, known, truth, *, pwm=false))]
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    fn drive(
        &self,
        py: Python<'_>,
        actions: PyReadonlyArray2<'_, f32>,
        active: PyReadonlyArray1<'_, bool>,
        ticks: u32,
        known: PyReadwriteArray2<'_, f32>,
        truth: PyReadwriteArray2<'_, f64>,
        pwm: bool,
    ) -> PyResult<()> {
        let most = match pwm {
            true => MOST_DUTY,
            false => MOST_SPEED,
        };
        let (actions, active) = checked(&actions, &active, self.__len__(), most)?;
        self.step(py, known, truth, ticks, |first, robots, begins| {
            let mut driven = self.callers.iter().zip(&active[first..]);
            if !driven.any(|(caller, active)| *caller && *active) {
                return false;
            }
            let rows = actions[first..].iter().zip(&active[first..]);
            for (robot, (action, active)) in robots.iter_mut().zip(rows).filter(|_| begins) {
                let [left, right, servo_rad] = *action;
                let (wheels, servo) = (Wheels { left, right }, ServoAngle(servo_rad));
                match (active, pwm) {
                    (true, true) => robot.drive_duty(wheels, servo),
                    (true, false) => robot.drive(wheels, servo),
                    (false, _) => {
                        // One that is disarmed stays so, and one of the scenario does not obey.
                        let _ = robot.command(&Command::Disarm);
                        robot.aim(None);
                    }
                }
            }
            true
        })
    }

    /// Selects the mode of wheel speeds for these robots, arms them, and lets their worlds go on for this many ticks.
    fn begin(&self, py: Python<'_>, indices: Vec<usize>, ticks: u32) -> PyResult<()> {
        let mut held = self.lock()?;
        let robots = &mut *held;
        let count = self.__len__();
        let mut chosen = vec![false; count];
        for index in indices {
            let chosen = chosen.get_mut(index);
            *chosen.ok_or_else(|| beyond(index, count))? = true;
        }
        let mut begins = true;
        in_strides(py, ticks, self.stride(), |now| {
            self.on_threads(py, || {
                robots.for_each(|first, group| {
                    let robots = group.robots_mut().iter_mut().zip(&chosen[first..]);
                    let chosen: Vec<_> = robots.filter(|(_, chosen)| **chosen).collect();
                    if chosen.is_empty() {
                        return;
                    }
                    for (robot, _) in chosen.into_iter().filter(|_| begins) {
                        for command in [Command::Mode(ModeId::WheelSpeed), Command::Arm] {
                            // A robot at its start obeys; one of the scenario does not, and need not.
                            let _ = robot.command(&command);
                        }
                    }
                    group.advance(now);
                });
            })?;
            begins = false;
            Ok(())
        })
    }

    /// Puts new robots of these seeds in place of those of the worlds of these numbers.
    fn renew(&self, py: Python<'_>, indices: Vec<usize>, seeds: Vec<u64>) -> PyResult<()> {
        if let Some(index) = indices.iter().find(|index| **index >= self.worlds) {
            return Err(beyond(*index, self.worlds));
        }
        let mut held = self.lock()?;
        let robots = &mut *held;
        let pairs: Vec<_> = indices.into_iter().zip(seeds).collect();
        let threads = (pairs.len() > 1).then_some(self.threads);
        let count = pairs.len() * self.callers.len();
        making(py, threads, count, None, |made| robots.renew(&pairs, made))
    }

    /// Applies a command in the words of a scenario to one robot.
    fn instruct(&self, index: usize, text: &str) -> PyResult<()> {
        self.with(index, |robot| robot.instruct(text))?
            .map_err(|error: FileError| exception(&error))
    }

    /// Points the servo of one robot; `None` leaves it to the mode.
    fn aim(&self, index: usize, servo_rad: Option<f32>) -> PyResult<()> {
        if let Some(servo_rad) = servo_rad {
            check_actions(&[[0.0, 0.0, servo_rad]], MOST_SPEED)?;
        }
        self.with(index, |robot| robot.aim(servo_rad.map(ServoAngle)))
    }

    /// Records one robot from now on.
    fn record(&self, index: usize) -> PyResult<()> {
        self.with(index, Robot::record)?
            .map_err(|error| exception(&error))
    }

    /// The log of one robot: the bytes of its file.
    fn log<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyBytes>> {
        let held = self.lock()?;
        let robot = held.robots().nth(index);
        let robot = robot.ok_or_else(|| beyond(index, self.__len__()))?;
        let Setup {
            files,
            library,
            overrides,
            ..
        } = self.setup.get();
        let source = RunSource {
            kind: LogKind::Episode,
            library,
            overrides,
        };
        let written = detached(py, || {
            let robots = files.robots();
            source.episode(&robots[index % robots.len()], robot, |manifest, run| {
                record_run(Cursor::new(Vec::new()), manifest, run)
            })
        })?;
        let log = written.map_err(|error| exception(&error))?.ok_or_else(|| {
            PyValueError::new_err(format!(
                "nothing is recorded of robot {index}: record() it, then step it"
            ))
        })?;
        let log = log.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, log.get_ref()))
    }

    /// Corners of each obstacle in the world of one robot [m].
    fn obstacles(&self, index: usize) -> PyResult<Vec<Vec<[f64; 2]>>> {
        self.with(index, |robot| corners(robot.world()))
    }

    /// The fault that one robot has latched, in words.
    fn fault(&self, index: usize) -> PyResult<Option<&'static str>> {
        self.with(index, |robot| {
            robot.sim().fault().map(|fault| fault.explanation())
        })
    }

    /// The robots as they are now.
    fn snapshot(&self, py: Python<'_>) -> PyResult<Snapshot> {
        Ok(Snapshot {
            setup: self.setup.clone_ref(py),
            callers: self.callers.clone(),
            robots: self.lock()?.clone(),
        })
    }

    /// Puts the robots back to a snapshot of a batch of the same size.
    fn restore(&self, snapshot: &Snapshot) -> PyResult<()> {
        snapshot.check(&self.callers, self.__len__())?;
        *self.lock()? = snapshot.robots.clone();
        Ok(())
    }
}

impl Batch {
    fn lock(&self) -> PyResult<MutexGuard<'_, Robots>> {
        hold(&self.robots)
    }

    pub(crate) fn with<T>(&self, index: usize, act: impl FnOnce(&mut Robot) -> T) -> PyResult<T> {
        let mut robots = self.lock()?;
        let robot = robots.robot_mut(index);
        robot.map(act).ok_or_else(|| beyond(index, self.__len__()))
    }

    fn step(
        &self,
        py: Python<'_>,
        mut known: PyReadwriteArray2<'_, f32>,
        mut truth: PyReadwriteArray2<'_, f64>,
        ticks: u32,
        act: impl Fn(usize, &mut [Robot], bool) -> bool + Sync + Send,
    ) -> PyResult<()> {
        let mut held = self.lock()?;
        let robots = &mut *held;
        let known = rows("known", &mut known, self.__len__(), OBSERVED.len())?;
        let truth = rows("truth", &mut truth, self.__len__(), TRUE.len())?;
        let mut begins = true;
        let mut advance = |now| {
            self.on_threads(py, || {
                robots.step(known, truth, now, |first, robots| {
                    act(first, robots, begins)
                });
            })?;
            begins = false;
            Ok(())
        };
        match ticks {
            0 => advance(0),
            _ => in_strides(py, ticks, self.stride(), advance),
        }
    }

    /// Between two looks for Ctrl-C [ticks].
    fn stride(&self) -> u32 {
        let weight = match self.setup.get().overrides.firmware {
            Some(_) => EMULATED,
            None => 1,
        };
        let weight = weight * self.__len__();
        (STRIDE_OF_ALL / weight.max(1)).clamp(1, STRIDE_TICKS) as u32
    }

    /// Does the work on a pool of its number of threads; for a single world on this one.
    fn on_threads<T: Send>(&self, py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
        if self.worlds <= 1 {
            return detached(py, work);
        }
        let pool = pool(self.threads)?;
        detached(py, || pool.install(work))
    }
}

/// Robots that only one thread steps at a time.
fn hold(robots: &Mutex<Robots>) -> PyResult<MutexGuard<'_, Robots>> {
    robots.try_lock().map_err(|error| {
        PyRuntimeError::new_err(match error {
            TryLockError::WouldBlock => {
                "another thread is stepping these robots; give each thread its own"
            }
            TryLockError::Poisoned(_) => "an earlier step of these robots failed; make new ones",
        })
    })
}

fn beyond(index: usize, count: usize) -> PyErr {
    PyIndexError::new_err(format!("robot {index}: there are {count}"))
}

/// Advances by this many ticks, with a look for Ctrl-C in between.
fn in_strides(
    py: Python<'_>,
    ticks: u32,
    stride: u32,
    mut advance: impl FnMut(u32) -> PyResult<()>,
) -> PyResult<()> {
    let mut left = ticks;
    while left > 0 {
        let now = left.min(stride);
        left -= now;
        advance(now)?;
        py.check_signals()?;
    }
    Ok(())
}

/// Corners of each obstacle that stands in a world [m].
fn corners(world: &World) -> Vec<Vec<[f64; 2]>> {
    let obstacles = world.obstacles().iter();
    obstacles
        .map(|obstacle| obstacle.corners().collect())
        .collect()
}
