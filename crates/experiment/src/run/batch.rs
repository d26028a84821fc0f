//! Many runs, on all cores.

use super::{RunResult, run};
use crate::files::{FileError, Setup};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};

/// Capacity of the result queue: a slow reader holds the runs back, so that their traces do not fill the memory.
const WAITING: usize = 16;

/// Runs all `jobs`, each a setup and a seed, on as many threads as the current pool has, and hands the results to `handle`
/// in the order of the jobs, each as soon as it and all before it are there.
///
/// # Errors
/// The first error, of a setup or of `handle`; no further run is begun.
pub fn run_all<E: From<FileError>>(
    jobs: &[(&Setup, u64)],
    handle: impl FnMut(&Setup, RunResult) -> Result<(), E>,
) -> Result<(), E> {
    run_all_on(rayon::current_num_threads(), jobs, handle)
}

/// The same on this many threads of its own, at least one: no pool is needed.
///
/// # Errors
/// As [`run_all`].
pub fn run_all_on<E: From<FileError>>(
    threads: usize,
    jobs: &[(&Setup, u64)],
    handle: impl FnMut(&Setup, RunResult) -> Result<(), E>,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let (done, results) = sync_channel(WAITING);
    // Separate threads: the caller may be one of the pool's, perhaps its only one, and waits for the results.
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            let (done, next) = (done.clone(), &next);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some((setup, seed)) = jobs.get(index) else {
                        return;
                    };
                    // The receiver is gone: an error has ended the batch.
                    if done.send((index, run(setup, *seed))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(done);
        in_order(jobs, results, handle)
    })
}

fn in_order<E: From<FileError>>(
    jobs: &[(&Setup, u64)],
    results: Receiver<(usize, Result<RunResult, FileError>)>,
    mut handle: impl FnMut(&Setup, RunResult) -> Result<(), E>,
) -> Result<(), E> {
    let mut early = BTreeMap::new();
    let mut left = jobs.iter().enumerate().peekable();
    for (index, result) in results {
        early.insert(index, result);
        while let Some((due, (setup, _))) = left.peek()
            && let Some(result) = early.remove(due)
        {
            handle(setup, result?)?;
            left.next();
        }
    }
    Ok(())
}
