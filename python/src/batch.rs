//! Robots stepped from Python: one for `rumbo.Sim`, many for `rumbo.Batch` and the environments.

use crate::guard::{detached, exception, making, pool, threads};
use crate::setup::Setup;
use numpy::{
    PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray2, PyUntypedArrayMethods,
    ToPyArray,
};
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use rumbo_control::mode::{MAX_WHEEL_RAD_S, ModeId};
use rumbo_control::{ServoAngle, Wheels};
use rumbo_experiment::batch::{Batch as Robots, Driver, OBSERVED, Robot, TRUE};
use rumbo_experiment::files::FileError;
use rumbo_lab::run_log::Source;
use rumbo_log::Kind;
use rumbo_plant::world::World;
use rumbo_session::headless::record_run;
use rumbo_wire::Command;
use std::f32::consts::FRAC_PI_2;
use std::io::Cursor;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// Between two looks for Ctrl-C: at most a second of simulated time, and no more ticks of all robots together than a core
/// simulates in some 0.1 s.
const STRIDE_TICKS: usize = 100;
const STRIDE_OF_ALL: usize = 100_000;
/// How many of our native robots an emulated one weighs.
const EMULATED: usize = 50;
/// An action: wheel speeds, left and right [rad/s], and where the servo points [rad].
pub(crate) const ACTION: usize = 3;

/// Robots of one setup.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Batch {
    setup: Py<Setup>,
    robots: Mutex<Robots>,
    caller: bool,
    count: usize,
    threads: usize,
}

/// Robots as they were at one moment.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Snapshot {
    setup: Py<Setup>,
    caller: bool,
    robots: Robots,
}

/// What defines a snapshot: its setup, whether the caller drives, seeds, and what was done to each robot.
type Parts<'py> = (Py<Setup>, bool, Vec<u64>, Vec<Bound<'py, PyBytes>>);

#[pymethods]
impl Snapshot {
    fn __len__(&self) -> usize {
        self.robots.robots().len()
    }

    /// What makes it again, anywhere, by [`Batch::new`].
    fn parts<'py>(&self, py: Python<'py>) -> Parts<'py> {
        let lives = self.robots.lives().into_iter();
        let (seeds, histories) = lives
            .map(|(seed, history)| (seed, PyBytes::new(py, &history)))
            .unzip();
        (self.setup.clone_ref(py), self.caller, seeds, histories)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }
}

#[pymethods]
impl Batch {
    /// A robot for each seed, driven by its scenario or by the caller: at its start, or after the acts of its history.
    /// `progress` is called with the share that is made.
    #[new]
    #[pyo3(signature = (setup, seeds, *, caller, threads, histories=None, progress=None))]
    fn new(
        py: Python<'_>,
        setup: Py<Setup>,
        seeds: Vec<u64>,
        caller: bool,
        threads: Option<i64>,
        histories: Option<Vec<PyBackedBytes>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let threads = self::threads(threads)?;
        let histories = histories.unwrap_or_default();
        let histories = histories.iter().map(|history| history.to_vec());
        let histories = histories.chain(std::iter::repeat(Vec::new()));
        let lives: Vec<_> = seeds.into_iter().zip(histories).collect();
        let driver = match caller {
            true => Driver::Caller,
            false => Driver::Scenario,
        };
        let files = setup.get().files.clone();
        let robots = making(
            py,
            || pool(threads),
            lives.len(),
            progress.as_ref(),
            |made| Robots::of_lives(files, driver, &lives, made),
        )?;
        Ok(Self {
            setup,
            robots: Mutex::new(robots),
            caller,
            count: lives.len(),
            threads,
        })
    }

    /// One that goes on by itself from here.
    fn __deepcopy__(&self, py: Python<'_>, _memo: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self {
            setup: self.setup.clone_ref(py),
            robots: Mutex::new(self.lock()?.clone()),
            caller: self.caller,
            count: self.count,
            threads: self.threads,
        })
    }

    /// Its number of threads.
    #[getter]
    fn threads(&self) -> usize {
        self.threads
    }

    /// Who commands the robots.
    #[getter]
    fn caller(&self) -> bool {
        self.caller
    }

    /// What is simulated.
    #[getter]
    fn setup(&self, py: Python<'_>) -> Py<Setup> {
        self.setup.clone_ref(py)
    }

    fn __len__(&self) -> usize {
        self.count
    }

    /// The robots' seeds.
    fn seeds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let seeds: Vec<u64> = self.lock()?.robots().iter().map(Robot::seed).collect();
        Ok(seeds.to_pyarray(py))
    }

    /// Advances every robot by this many control ticks.
    fn advance(&self, py: Python<'_>, ticks: u32) -> PyResult<()> {
        let mut held = self.lock()?;
        let robots = &mut *held;
        in_strides(py, ticks, self.stride(), |now| {
            on_threads(py, self.count, self.threads, || robots.advance(now))
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

    /// Gives each robot its row of `actions`, of wheel speeds or of shares of the full PWM, advances it by this many control
    /// ticks and writes its rows. Robots of which `active` is false stand still in time.
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
        let (actions, active) = checked(&actions, &active, self.count, most)?;
        self.step(py, known, truth, ticks, |index, robot, begins| {
            if active.get(index) != Some(&true) {
                return false;
            }
            if let (true, Some([left, right, servo_rad])) = (begins, actions.get(index)) {
                let (left, right) = (*left, *right);
                let (wheels, servo) = (Wheels { left, right }, ServoAngle(*servo_rad));
                match pwm {
                    true => robot.drive_duty(wheels, servo),
                    false => robot.drive(wheels, servo),
                }
            }
            true
        })
    }

    /// Selects the mode of wheel speeds for these robots, arms them, and lets them stand for this many ticks.
    fn begin(&self, py: Python<'_>, indices: Vec<usize>, ticks: u32) -> PyResult<()> {
        let mut held = self.lock()?;
        let robots = &mut *held;
        let mut chosen = vec![false; self.count];
        for index in indices {
            let chosen = chosen.get_mut(index);
            *chosen.ok_or_else(|| beyond(index, self.count))? = true;
        }
        let mut begins = true;
        in_strides(py, ticks, self.stride(), |now| {
            on_threads(py, self.count, self.threads, || {
                robots.for_each(|index, robot| {
                    if chosen.get(index) != Some(&true) {
                        return;
                    }
                    if begins {
                        for command in [Command::Mode(ModeId::WheelSpeed), Command::Arm] {
                            // A robot at its start obeys.
                            let _ = robot.command(&command);
                        }
                    }
                    robot.advance(now);
                });
            })?;
            begins = false;
            Ok(())
        })
    }

    /// Puts new robots of these seeds in place of those of these numbers.
    fn renew(&self, py: Python<'_>, indices: Vec<usize>, seeds: Vec<u64>) -> PyResult<()> {
        if let Some(index) = indices.iter().find(|index| **index >= self.count) {
            return Err(beyond(*index, self.count));
        }
        let mut held = self.lock()?;
        let robots = &mut *held;
        let pairs: Vec<_> = indices.into_iter().zip(seeds).collect();
        let pool = || pool(self.threads);
        making(py, pool, pairs.len(), None, |made| {
            robots.renew(&pairs, made)
        })
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
        let robot = held.robots().get(index);
        let robot = robot.ok_or_else(|| beyond(index, self.count))?;
        let Setup {
            files,
            library,
            overrides,
            ..
        } = self.setup.get();
        let source = Source {
            kind: Kind::Episode,
            library,
            overrides,
        };
        let written = detached(py, || {
            source.episode(files, robot, |manifest, run| {
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
            caller: self.caller,
            robots: self.lock()?.clone(),
        })
    }

    /// Puts the robots back to a snapshot of a batch of the same size.
    fn restore(&self, snapshot: &Snapshot) -> PyResult<()> {
        let count = snapshot.robots.robots().len();
        if count != self.count {
            return Err(PyValueError::new_err(format!(
                "a snapshot of {count} robots does not fit a batch of {}",
                self.count
            )));
        }
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
        let robot = robots.robots_mut().get_mut(index);
        robot.map(act).ok_or_else(|| beyond(index, self.count))
    }

    fn step(
        &self,
        py: Python<'_>,
        mut known: PyReadwriteArray2<'_, f32>,
        mut truth: PyReadwriteArray2<'_, f64>,
        ticks: u32,
        act: impl Fn(usize, &mut Robot, bool) -> bool + Sync + Send,
    ) -> PyResult<()> {
        let mut held = self.lock()?;
        let robots = &mut *held;
        let known = rows("known", &mut known, self.count, OBSERVED.len())?;
        let truth = rows("truth", &mut truth, self.count, TRUE.len())?;
        let mut begins = true;
        let mut advance = |now| {
            on_threads(py, self.count, self.threads, || {
                robots.step(known, truth, now, |index, robot| act(index, robot, begins));
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
        stride(weight * self.count)
    }
}

/// Between two looks for Ctrl-C [ticks], with so many robots of ours.
pub(crate) fn stride(robots: usize) -> u32 {
    (STRIDE_OF_ALL / robots.max(1)).clamp(1, STRIDE_TICKS) as u32
}

/// Robots that only one thread steps at a time.
pub(crate) fn hold<T>(robots: &Mutex<T>) -> PyResult<MutexGuard<'_, T>> {
    robots.try_lock().map_err(|error| {
        PyRuntimeError::new_err(match error {
            TryLockError::WouldBlock => {
                "another thread is stepping these robots; give each thread its own"
            }
            TryLockError::Poisoned(_) => "an earlier step of these robots failed; make new ones",
        })
    })
}

pub(crate) fn beyond(index: usize, count: usize) -> PyErr {
    PyIndexError::new_err(format!("robot {index}: there are {count}"))
}

/// Advances by this many ticks, with a look for Ctrl-C in between.
pub(crate) fn in_strides(
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

/// An action for each of so many robots, and whether it is given to it.
pub(crate) fn checked<'a>(
    actions: &'a PyReadonlyArray2<'_, f32>,
    active: &'a PyReadonlyArray1<'_, bool>,
    count: usize,
    most: (&str, f32, &str),
) -> PyResult<(&'a [[f32; ACTION]], &'a [bool])> {
    has_rows("actions", actions.shape(), count, ACTION)?;
    if !actions.is_c_contiguous() || active.len() != count {
        return Err(PyValueError::new_err(
            "actions must be C-contiguous, and active must have a value for each robot",
        ));
    }
    let actions = actions.as_slice()?.as_chunks().0;
    check_actions(actions, most)?;
    Ok((actions, active.as_slice()?))
}

/// Does the work on a pool of this many threads; for a single robot on this one.
fn on_threads<T: Send>(
    py: Python<'_>,
    robots: usize,
    threads: usize,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    if robots <= 1 {
        return detached(py, work);
    }
    let pool = pool(threads)?;
    detached(py, || pool.install(work))
}

/// Corners of each obstacle that stands in a world [m].
pub(crate) fn corners(world: &World) -> Vec<Vec<[f64; 2]>> {
    let obstacles = world.obstacles().iter();
    obstacles
        .map(|obstacle| obstacle.corners().collect())
        .collect()
}

/// The array's numbers, row by row, if it has this shape.
pub(crate) fn rows<'a, T: numpy::Element>(
    name: &str,
    array: &'a mut PyReadwriteArray2<'_, T>,
    rows: usize,
    columns: usize,
) -> PyResult<&'a mut [T]> {
    has_rows(name, array.shape(), rows, columns)?;
    // A slice of an array in Fortran's order would be transposed.
    if !array.is_c_contiguous() {
        return Err(PyValueError::new_err(format!(
            "{name} must be C-contiguous"
        )));
    }
    Ok(array.as_slice_mut()?)
}

pub(crate) fn has_rows(name: &str, shape: &[usize], rows: usize, columns: usize) -> PyResult<()> {
    if shape == [rows, columns] {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} has the shape {shape:?}: must be [{rows}, {columns}]"
    )))
}

/// What wheels are given: what it is, the most of it either way, and its unit.
pub(crate) const MOST_SPEED: (&str, f32, &str) = ("wheel speed", MAX_WHEEL_RAD_S, "rad/s");
const MOST_DUTY: (&str, f32, &str) = ("wheel's share of the PWM", 1.0, "of the full one");

/// Every number is one that the robot takes.
fn check_actions(actions: &[[f32; ACTION]], of_wheel: (&str, f32, &str)) -> PyResult<()> {
    let limits = [of_wheel, of_wheel, ("servo angle", FRAC_PI_2, "rad")];
    let sides = ["left ", "right ", ""];
    for (index, action) in actions.iter().enumerate() {
        let columns = action.iter().zip(limits).zip(sides);
        for (column, ((value, (what, most, unit)), side)) in columns.enumerate() {
            if value.is_nan() || value.abs() > most {
                return Err(PyValueError::new_err(format!(
                    "action[{index}, {column}] = {value}: {side}{what} must be within {most:.4} {unit} of zero"
                )));
            }
        }
    }
    Ok(())
}
