//! Recent ground truth: telemetry arrives later than its time.

use rumbo_log::Truth;
use std::collections::VecDeque;

/// Ground truth of the last second.
#[derive(Debug, Default)]
pub(crate) struct TruthLog {
    entries: VecDeque<(i64, Truth)>,
}

/// Length of the log \[ms\].
const LOG_MS: i64 = 1_000;

impl TruthLog {
    /// Notes the ground truth at `t_ms`.
    pub(crate) fn push(&mut self, t_ms: i64, truth: Truth) {
        self.entries.push_back((t_ms, truth));
        while self
            .entries
            .front()
            .is_some_and(|(oldest_ms, _)| *oldest_ms < t_ms - LOG_MS)
        {
            self.entries.pop_front();
        }
    }

    /// The last entry at or before `t_ms`, or the oldest.
    pub(crate) fn at(&self, t_ms: i64) -> Option<Truth> {
        let after = self
            .entries
            .partition_point(|(noted_ms, _)| *noted_ms <= t_ms);
        self.entries
            .get(after.saturating_sub(1))
            .map(|(_, truth)| *truth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_of_a_past_instant_is_found() {
        let mut log = TruthLog::default();
        for t_ms in (0..3_000).step_by(5) {
            log.push(
                t_ms,
                Truth {
                    battery_v: t_ms as f64,
                    ..Truth::default()
                },
            );
        }
        assert_eq!(log.at(2_460).unwrap().battery_v, 2_460.0);
        assert!(log.entries.len() <= 202);
    }
}
