//! Many jobs on many threads, their results handled one by one in the order of the jobs.

use crate::failure::Failure;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Runs `job` for 0..`count` on `threads` threads and gives each result to `handle` on this one, in order, whatever
/// order they end in. An error of `handle` ends the work: jobs under way are finished, no others are begun.
pub(crate) fn in_order<T: Send>(
    count: usize,
    threads: usize,
    job: impl Fn(usize) -> T + Sync,
    mut handle: impl FnMut(usize, T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let next = AtomicUsize::new(0);
    let (sender, results) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..threads.clamp(1, count.max(1)) {
            let (sender, next, job) = (sender.clone(), &next, &job);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count || sender.send((index, job(index))).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let (mut early, mut due) = (BTreeMap::new(), 0);
        // Consumed by value: when an error ends the loop, the channel closes and the threads stop.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_jobs_for_any_number_of_threads() {
        for threads in [1, 2, 7] {
            let mut seen = Vec::new();
            // The first jobs take longest.
            let job =
                |index: usize| (0..(50 - index) * 1000).fold(index, |sum, step| sum ^ step ^ step);
            in_order(50, threads, job, |index, result| {
                seen.push((index, result));
                Ok(())
            })
            .unwrap();
            assert_eq!(
                seen,
                (0..50).map(|index| (index, index)).collect::<Vec<_>>()
            );
        }
    }

    #[test]
    fn an_error_begins_no_further_jobs() {
        let begun = AtomicUsize::new(0);
        let job = |_| begun.fetch_add(1, Ordering::Relaxed);
        let outcome = in_order(usize::MAX, 2, job, |_, _| Err(Failure::ReaderGone));
        assert!(matches!(outcome, Err(Failure::ReaderGone)));
    }
}
