//! The ghost of a log, restarted in the middle: it is advanced from the beginning up to there, moved to the robot's
//! pose, and continues. That takes a while for a long log and is done in steps: what is not known yet is not shown,
//! and nothing blocks.

use crate::error::TargetError;
use crate::target::{Ghost, Standing};
use rumbo_log::{Log, Row, compose};

/// On its way to where it is put, a step advances it by this much \[us\].
const STEP_US: u64 = 500_000;

/// A restart in progress.
struct Work {
    /// When \[us\] and where to put it; taken once done.
    put: Option<(u64, Standing)>,
    reached_us: u64,
    /// The first row whose ghost is not known yet.
    next_row: usize,
}

/// A log's ghost and its progress.
pub(super) struct GhostReplay {
    ghost: Box<dyn Ghost>,
    work: Option<Work>,
}

impl GhostReplay {
    pub(super) fn new(ghost: Box<dyn Ghost>) -> Self {
        Self { ghost, work: None }
    }

    /// Whether there is work left.
    pub(super) fn at_work(&self) -> bool {
        self.work.is_some()
    }

    /// Whether rows before this one still lack their ghost.
    pub(super) fn is_behind(&self, row: usize) -> bool {
        self.work.as_ref().is_some_and(|work| work.next_row < row)
    }

    /// Restarts the ghost at the robot's pose in this row; its poses in later rows are discarded.
    pub(super) fn restart(&mut self, log: &mut Log, row: usize) -> Result<(), TargetError> {
        let until = (row + 1).min(log.rows.len());
        let (before, later) = log.rows.split_at_mut(until);
        let Some(last) = before.last() else {
            return Err(TargetError::NoSignals);
        };
        let standing = standing(last).ok_or(TargetError::NoPose)?;
        self.ghost.begin()?;
        for row in later {
            row.set_ghost(None);
        }
        self.work = Some(Work {
            put: Some((to_us(last.t_ms), standing)),
            reached_us: 0,
            next_row: row,
        });
        Ok(())
    }

    /// Works one step further.
    pub(super) fn work(&mut self, log: &mut Log) -> Result<(), TargetError> {
        let Some(work) = &mut self.work else {
            return Ok(());
        };
        if let Some((at_us, standing)) = work.put {
            work.reached_us = (work.reached_us + STEP_US).min(at_us);
            self.ghost.advance_to(work.reached_us)?;
            if work.reached_us == at_us {
                self.ghost.place(standing);
                work.put = None;
            }
            return Ok(());
        }
        match log.rows.get_mut(work.next_row) {
            Some(row) => {
                let at = self.ghost.advance_to(to_us(row.t_ms))?;
                row.set_ghost(Some(&at));
                work.next_row += 1;
            }
            None => self.work = None,
        }
        Ok(())
    }

    /// Stops after an error.
    pub(super) fn give_up(&mut self) {
        self.work = None;
    }
}

fn to_us(t_ms: i64) -> u64 {
    u64::try_from(t_ms).unwrap_or(0) * 1_000
}

/// The robot's pose: ground truth where it is known, else its estimate.
fn standing(row: &Row) -> Option<Standing> {
    let estimated = row.pose("")?;
    let origin = row.pose("origin_").unwrap_or_default();
    Some(Standing {
        at: row
            .pose("true_")
            .unwrap_or_else(|| compose(origin, estimated)),
        estimated,
    })
}
