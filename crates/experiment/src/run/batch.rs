//! Many runs, on all cores.

use super::{RunResult, run, run_together};
use crate::files::{FileError, Setup};
use rumbo_plant::lanes::LANES;
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
/// there. Where there are enough for all threads, single robots go in groups, in the lanes of vector registers.
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
    let one = |index: usize| {
        let (setup, seed) = job(index)?;
        run(&setup, seed)
    };
    // Of few groups one thread would have one more than another for too long; an image does not share its steps.
    let many = count >= 4 * LANES * threads.max(1);
    let size = match many && job(0).is_ok_and(|(setup, _)| setup.firmware.is_none()) {
        true => LANES,
        false => 1,
    };
    let work = |group: usize| {
        let indices = (group * size..count).take(size);
        let jobs = || {
            indices
                .clone()
                .map(&job)
                .collect::<Result<Vec<_>, _>>()
                .ok()
        };
        let results = match (size > 1).then(jobs).flatten() {
            Some(jobs) => run_together(&jobs),
            None => indices.clone().map(one).collect(),
        };
        let results = indices.zip(results);
        let results = results.map(|(index, result)| result.map(|result| of(index, result)));
        results.collect::<Vec<Result<T, FileError>>>()
    };
    let (groups, waiting) = (count.div_ceil(size), WAITING / size);
    in_order_holding(waiting, threads, groups, work, |group, results| {
        let results = (group * size..).zip(results);
        results
            .into_iter()
            .try_for_each(|(index, result)| handle(index, result?))
    })
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
    handle: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    in_order_holding(WAITING, threads, count, work, handle)
}

/// The same with so much room for results that wait.
fn in_order_holding<T: Send, E>(
    waiting: usize,
    threads: usize,
    count: usize,
    work: impl Fn(usize) -> T + Sync,
    mut handle: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let next = AtomicUsize::new(0);
    let (done, results) = sync_channel(waiting);
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
