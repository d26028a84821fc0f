//! The way from Python into the simulator and back: errors, Python's lock, threads, forks, faults of our own.

use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use rayon::ThreadPool;
use rumbo_experiment::batch::Made;
use rumbo_experiment::files::FileError;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// More threads than any machine has use for.
const MOST_THREADS: usize = 1_024;

/// The pools of this process by their number of threads, and the process that began them.
static POOLS: Mutex<(u32, BTreeMap<usize, Arc<ThreadPool>>)> = Mutex::new((0, BTreeMap::new()));

/// The Python exception of an error in a file or a setting.
pub(crate) fn exception(error: &FileError) -> PyErr {
    match error {
        FileError::Unreadable {
            path,
            reason,
            code,
            wanted,
        } => unreadable(
            *code,
            format!("cannot be read ({reason}); give {wanted}"),
            path,
        ),
        FileError::Unknown { .. } | FileError::Invalid(_) | FileError::Setting(_) => {
            PyValueError::new_err(error.to_string())
        }
    }
}

/// That of a file which the system does not give: `FileNotFoundError`, `PermissionError` and so on by the system's number.
pub(crate) fn unreadable(code: Option<i32>, what: String, path: &str) -> PyErr {
    match code {
        Some(code) => PyOSError::new_err((code, what, path.to_owned())),
        None => PyOSError::new_err(format!("{path}: {what}")),
    }
}

/// The number of threads asked for; all cores by default.
pub(crate) fn threads(asked: Option<i64>) -> PyResult<usize> {
    let Some(asked) = asked else {
        return Ok(std::thread::available_parallelism().map_or(1, usize::from));
    };
    usize::try_from(asked)
        .ok()
        .filter(|asked| (1..=MOST_THREADS).contains(asked))
        .ok_or_else(|| {
            PyValueError::new_err(format!(
                "threads = {asked}: must be 1 to {MOST_THREADS}; leave it out for one on each core"
            ))
        })
}

/// The pool with this many threads. The threads of a pool do not survive a fork: a child that waited for them would
/// hang.
pub(crate) fn pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let (owner, pools) = &mut *pools;
    if pools.is_empty() {
        *owner = std::process::id();
    } else if *owner != std::process::id() {
        return Err(PyRuntimeError::new_err(
            "this process is a fork of one that had used Rumbo's threads, which a fork loses; begin worker processes by \
             multiprocessing.get_context(\"spawn\")",
        ));
    }
    if let Some(pool) = pools.get(&threads) {
        return Ok(pool.clone());
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| PyRuntimeError::new_err(format!("threads = {threads}: {error}")))?;
    let pool = Arc::new(pool);
    pools.insert(threads, pool.clone());
    Ok(pool)
}

/// How often Ctrl-C is looked for.
const LOOK: Duration = Duration::from_millis(100);

/// Makes robots on this many threads, of which `count` are to be made, and looks for Ctrl-C meanwhile; without threads here,
/// where a fork of this process has none. `progress` is called with the share that is made.
pub(crate) fn making<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    count: usize,
    progress: Option<&Py<PyAny>>,
    make: impl FnOnce(Made<'_>) -> Result<T, FileError> + Send,
) -> PyResult<T> {
    let Some(threads) = threads else {
        let interrupted = Mutex::new(None);
        let ended = detached(py, || {
            make(&|| {
                call(None, 0.0).map_err(|error| {
                    *interrupted.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                    FileError::Setting("interrupted".to_owned())
                })
            })
        })?;
        let interrupted = interrupted.into_inner();
        return match interrupted.unwrap_or_else(PoisonError::into_inner) {
            Some(error) => Err(error),
            None => ended.map_err(|error| exception(&error)),
        };
    };
    let ended = watched(py, &*pool(threads)?, progress, |shares, stop| {
        let made = AtomicUsize::new(0);
        make(&|| {
            let made = made.fetch_add(1, Ordering::Relaxed) + 1;
            if made.is_multiple_of(count.div_ceil(100)) {
                // An error: nobody listens any more, and `stop` is set.
                let _ = shares.send(made as f64 / count as f64);
            }
            match stop.load(Ordering::Relaxed) {
                true => Err(FileError::Setting("interrupted".to_owned())),
                false => Ok(()),
            }
        })
    })?;
    ended.map_err(|error| exception(&error))
}

/// Does work that takes long on the threads of `pool`, and looks for Ctrl-C meanwhile, which only Python's main thread
/// sees. The work sends the share of it that is done, which `progress` is called with, and ends soon after the flag is
/// set; then what it returns is of no use.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&Sender<f64>, &AtomicBool) -> T + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    detached(py, || {
        let (shares, arriving) = channel();
        std::thread::scope(|scope| {
            let stop = &stop;
            let working = scope.spawn(move || pool.install(|| work(&shares, stop)));
            let ended = loop {
                let looked = match arriving.recv_timeout(LOOK) {
                    Ok(share) => call(progress, share),
                    Err(RecvTimeoutError::Timeout) => call(None, 0.0),
                    Err(RecvTimeoutError::Disconnected) => break Ok(()),
                };
                if looked.is_err() {
                    stop.store(true, Ordering::Relaxed);
                    break looked;
                }
            };
            let done = working.join().unwrap_or_else(|panic| resume_unwind(panic));
            ended.map(|()| done)
        })
    })?
}

/// Looks for Ctrl-C, and says how much is done: a number of runs, or a share.
pub(crate) fn call(
    progress: Option<&Py<PyAny>>,
    done: impl for<'py> IntoPyObject<'py>,
) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        match progress {
            Some(progress) => progress.call1(py, (done,)).map(|_| ()),
            None => Ok(()),
        }
    })
}

/// Does the work without Python's lock. A panic, which is a fault of ours, becomes a `RuntimeError`.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work)))
        .map_err(|panic| {
            let what = panic
                .downcast_ref::<&str>()
                .map(|text| (*text).to_owned())
                .or_else(|| panic.downcast_ref::<String>().cloned())
                .unwrap_or_default();
            PyRuntimeError::new_err(format!("a fault of Rumbo itself, please report it: {what}"))
        })
}
