//! What a step costs: time, and the processor's time of the program and of all that it waited for.

use std::fmt;
use std::iter::Sum;
use std::time::{Duration, Instant};

/// Time, and the processor's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cost {
    pub(crate) time: Duration,
    /// User and system; zero where the system does not say.
    pub(crate) processor: Duration,
}

impl Cost {
    /// Reads what [`fmt::Display`] wrote; also returns what follows.
    pub(crate) fn parse(text: &str) -> Option<(Self, &str)> {
        let seconds = |text: &str| Duration::try_from_secs_f64(text.trim().parse().ok()?).ok();
        let (time, rest) = text.split_once(" s, processor")?;
        let (processor, rest) = rest.split_once(" s")?;
        let cost = Self {
            time: seconds(time)?,
            processor: seconds(processor)?,
        };
        Some((cost, rest))
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [time, processor] = [self.time, self.processor].map(|time| time.as_secs_f64());
        write!(f, "{time:>7.1} s, processor {processor:>7.1} s")
    }
}

impl Sum for Cost {
    fn sum<I: Iterator<Item = Self>>(costs: I) -> Self {
        costs.fold(Self::default(), |sum, one| Self {
            time: sum.time + one.time,
            processor: sum.processor + one.processor,
        })
    }
}

/// Measures the cost of what comes next.
pub(crate) struct Clock {
    start: Instant,
    processor: Duration,
}

impl Clock {
    pub(crate) fn start() -> Self {
        Self {
            start: Instant::now(),
            processor: processor(),
        }
    }

    pub(crate) fn stop(self) -> Cost {
        Cost {
            time: self.start.elapsed(),
            processor: processor().saturating_sub(self.processor),
        }
    }
}

/// The processor's time of this process and of its children that have ended, theirs included.
fn processor() -> Duration {
    let of_linux = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    ticks(&of_linux).map_or(Duration::ZERO, |ticks| Duration::from_millis(10 * ticks))
}

/// `utime`, `stime`, `cutime` and `cstime` of proc_pid_stat(5), in hundredths of a second, which Linux counts in on every
/// machine (`USER_HZ`).
fn ticks(stat: &str) -> Option<u64> {
    // The name before it may have blanks.
    let (_, fields) = stat.rsplit_once(") ")?;
    let times = fields.split(' ').skip(11).take(4);
    times.map(|field| field.parse::<u64>().ok()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn user_and_system_time_of_the_process_and_its_children_are_summed() {
        let stat = "7 (a b) c) S 1 7 7 0 -1 4194304 100 200 0 0 31 2 1000 400 20 0 1 0 5 6";
        assert_eq!(ticks(stat), Some(1433));
        assert_eq!(ticks(""), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_a_child_computes_is_counted() {
        let clock = Clock::start();
        let spin = "i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done";
        let done = std::process::Command::new("sh").args(["-c", spin]).status();
        assert!(done.unwrap().success());
        assert!(clock.stop().processor > Duration::from_millis(20));
    }

    #[test]
    fn a_cost_is_read_as_it_was_written() {
        let cost = Cost {
            time: Duration::from_millis(12_300),
            processor: Duration::from_millis(1_204_500),
        };
        let text = format!("{cost}  why");
        assert_eq!(Cost::parse(&text), Some((cost, "  why")));
    }
}
