//! Many runs, on all cores.

use super::{RunResult, run};
use crate::files::{FileError, Setup};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::sync_channel;

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
    mut handle: impl FnMut(&Setup, RunResult) -> Result<(), E>,
) -> Result<(), E> {
    let job = |index: usize| Ok((Cow::Borrowed(jobs[index].0), jobs[index].1));
    run_each(
        threads,
        jobs.len(),
        job,
        |_, result| result,
        |index, result| handle(jobs[index].0, result),
    )
}

/// Runs `count` jobs, each a setup and a seed, on this many threads of its own, at least one. `of` takes on these threads
/// what is wanted of each result; `handle` gets that in the order of the jobs, each as soon as it and all before it are
/// there.
///
/// # Errors
/// The first error, of a setup or of `handle`; no further run is begun.
pub fn run_each<'a, T: Send, E: From<FileError>>(
    threads: usize,
    count: usize,
    job: impl Fn(usize) -> Result<(Cow<'a, Setup>, u64), FileError> + Sync,
    of: impl Fn(usize, RunResult) -> T + Sync,
    mut handle: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let work = |index: usize| {
        let (setup, seed) = job(index)?;
        run(&setup, seed).map(|result| of(index, result))
    };
    in_order(threads, count, work, |index, result| handle(index, result?))
}

/// Does `work` for 0, 1 ... `count` - 1 on this many threads of its own, at least one, and hands the results to `handle`
/// in that order, each as soon as it and all before it are there.
///
/// # Errors
/// The first error of `handle`; no further work is begun.
pub fn in_order<T: Send, E>(
    threads: usize,
    count: usize,
    work: impl Fn(usize) -> T + Sync,
    mut handle: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let (done, results) = sync_channel(WAITING);
    // Separate threads: the caller may be one of the pool's, perhaps its only one, and waits for the results.
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1).min(count) {
            let (done, next, work) = (done.clone(), &next, &work);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    // A receiver that is gone: an error has ended the batch.
                    if index >= count || done.send((index, work(index))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(done);
        let (mut early, mut due) = (BTreeMap::new(), 0);
        for (index, result) in results {
            early.insert(index, result);
            while let Some(result) = early.remove(&due) {
                handle(due, result)?;
                due += 1;
            }
        }
        Ok(())
    })
}
