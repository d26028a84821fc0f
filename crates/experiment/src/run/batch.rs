//! Many runs, on all cores.

use super::{RunResult, run_unless};
use crate::files::{FileError, Setup};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Capacity of the result queue: a slow reader holds the runs back, so that their traces do not fill the memory.
const WAITING: usize = 16;
/// While there is no result, `go_on` is asked this often.
const ASKED: Duration = Duration::from_millis(50);

/// Runs all `jobs`, each a setup and a seed, on as many threads as the current pool has, and hands the results to `handle`
/// in the order of the jobs, each as soon as it and all before it are there.
///
/// # Errors
/// The first error, of a setup or of `handle`; no further run is begun.
pub fn run_all<E: From<FileError>>(
    jobs: &[(&Setup, u64)],
    handle: impl FnMut(&Setup, RunResult) -> Result<(), E>,
) -> Result<(), E> {
    run_all_on(rayon::current_num_threads(), jobs, || Ok(()), handle)
}

/// The same on this many threads of its own, at least one: no pool is needed. `go_on` is asked again and again while
/// there is nothing to handle.
///
/// # Errors
/// As [`run_all`], or that of `go_on`: runs that are not over are given up then.
pub fn run_all_on<E: From<FileError>>(
    threads: usize,
    jobs: &[(&Setup, u64)],
    go_on: impl Fn() -> Result<(), E>,
    mut handle: impl FnMut(&Setup, RunResult) -> Result<(), E>,
) -> Result<(), E> {
    let job = |index: usize| Ok((Cow::Borrowed(jobs[index].0), jobs[index].1));
    run_each(
        threads,
        jobs.len(),
        job,
        |_, result| result,
        go_on,
        |index, result| handle(jobs[index].0, result),
    )
}

/// Runs `count` jobs, each a setup and a seed, on this many threads of its own, at least one. `of` takes on these threads
/// what is wanted of each result; `handle` gets that in the order of the jobs, each as soon as it and all before it are
/// there, and `go_on` is asked while there is nothing to handle.
///
/// # Errors
/// The first error, of a setup, of `go_on` or of `handle`; no further run is begun, and those that are not over are
/// given up.
pub fn run_each<'a, T: Send, E: From<FileError>>(
    threads: usize,
    count: usize,
    job: impl Fn(usize) -> Result<(Cow<'a, Setup>, u64), FileError> + Sync,
    of: impl Fn(usize, RunResult) -> T + Sync,
    go_on: impl Fn() -> Result<(), E>,
    mut handle: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let work = |index: usize, over: &AtomicBool| {
        let (setup, seed) = job(index)?;
        let result = run_unless(&setup, seed, over)?;
        Ok(result.map(|result| of(index, result)))
    };
    // Without a result: given up, when nobody waits for it any more.
    in_order(threads, count, work, go_on, |index, result| match result? {
        Some(result) => handle(index, result),
        None => Ok(()),
    })
}

/// Does `work` for 0, 1 ... `count` - 1 on this many threads of its own, at least one, and hands the results to `handle`
/// in that order, each as soon as it and all before it are there. While there is none, `go_on` is asked. `work` is told
/// when it is over: nobody waits for its result then.
///
/// # Errors
/// The first error of `handle` or `go_on`; no further work is begun.
pub fn in_order<T: Send, E>(
    threads: usize,
    count: usize,
    work: impl Fn(usize, &AtomicBool) -> T + Sync,
    go_on: impl Fn() -> Result<(), E>,
    mut handle: impl FnMut(usize, T) -> Result<(), E>,
) -> Result<(), E> {
    let (next, over) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (done, results) = sync_channel(WAITING);
    // Separate threads: the caller may be one of the pool's, perhaps its only one, and waits for the results.
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1).min(count) {
            let (done, next, work, over) = (done.clone(), &next, &work, &over);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    // A receiver that is gone: an error has ended the batch.
                    if index >= count || done.send((index, work(index, over))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(done);
        let (mut early, mut due) = (BTreeMap::new(), 0);
        let mut take = || loop {
            match results.recv_timeout(ASKED) {
                Ok((index, result)) => drop(early.insert(index, result)),
                Err(RecvTimeoutError::Timeout) => go_on()?,
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            }
            while let Some(result) = early.remove(&due) {
                handle(due, result)?;
                due += 1;
            }
        };
        let ended = take();
        over.store(true, Ordering::Relaxed);
        // Nobody waits for room in it.
        drop(results);
        ended
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_waits_for_any_more_is_given_up() {
        let endless = |_: usize, over: &AtomicBool| {
            while !over.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
        };
        let ended = in_order(2, 100, endless, || Err("asked to end"), |_, ()| Ok(()));
        assert_eq!(ended, Err("asked to end"));
        // And so are runs, at any time: this one lasts for days.
        let mut setup = crate::files::Library::new()
            .setup("mode5", &crate::files::Overrides::default())
            .unwrap();
        setup.scenario.duration_s = 1e6;
        let ended = run_all_on(
            1,
            &[(&setup, 1)],
            || Err(FileError::Setting("asked to end".into())),
            |_, _| Ok(()),
        );
        assert!(ended.is_err_and(|error| error.to_string().contains("asked to end")));
    }
}
