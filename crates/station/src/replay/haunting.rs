//! The ghost of a log, started again in the middle: it lives from the beginning up to there, is put where the robot stood, and goes on. That takes
//! a while for a long log, and is done a little at a time: what is not known yet is not shown, and nothing waits.

use rumbo_log::{Log, MapPose, Row, compose};
use rumbo_session::{Ghost, Standing};
use std::time::{Duration, Instant};

/// Time spent on the ghost at once.
const SLICE: Duration = Duration::from_millis(12);
/// It lives on by so much between two looks at the time \[us\].
const STEP_US: u64 = 500_000;

/// Whose pose it is, among the signals.
const GHOST: &str = "ghost_";
const UNKNOWN: MapPose = MapPose {
    x_m: f64::NAN,
    y_m: f64::NAN,
    heading_rad: f64::NAN,
};

/// A ghost on its way.
struct Work {
    /// Where it is put, and when \[us\]; taken when it is there.
    put: Option<(u64, Standing)>,
    lived_us: u64,
    /// The first row whose ghost is not known yet.
    next_row: usize,
}

/// A log's ghost, and how far it is.
pub(super) struct Haunting {
    ghost: Box<dyn Ghost>,
    work: Option<Work>,
}

impl Haunting {
    pub(super) fn new(ghost: Box<dyn Ghost>) -> Self {
        Self { ghost, work: None }
    }

    /// Something is left to do.
    pub(super) fn at_work(&self) -> bool {
        self.work.is_some()
    }

    /// The rows before this one lack their ghost.
    pub(super) fn is_behind(&self, row: usize) -> bool {
        self.work.as_ref().is_some_and(|work| work.next_row < row)
    }

    /// The ghost begins again beside the robot of this row; what later rows know of it is over.
    pub(super) fn restart(&mut self, log: &mut Log, row: usize) -> Result<(), String> {
        let until = (row + 1).min(log.rows.len());
        let (before, later) = log.rows.split_at_mut(until);
        let Some(last) = before.last() else {
            return Err("the log has no signals".into());
        };
        let standing = standing(last).ok_or("the robot did not tell its pose then")?;
        self.ghost.begin()?;
        for row in later {
            row.set_pose(GHOST, UNKNOWN);
        }
        self.work = Some(Work {
            put: Some((to_us(last.t_ms), standing)),
            lived_us: 0,
            next_row: row,
        });
        Ok(())
    }

    /// Goes on for a while.
    pub(super) fn work(&mut self, log: &mut Log) -> Result<(), String> {
        let until = Instant::now() + SLICE;
        while let Some(work) = &mut self.work
            && Instant::now() < until
        {
            if let Some((at_us, standing)) = work.put {
                work.lived_us = (work.lived_us + STEP_US).min(at_us);
                self.ghost.live(work.lived_us)?;
                if work.lived_us == at_us {
                    self.ghost.place(standing);
                    work.put = None;
                }
                continue;
            }
            match log.rows.get_mut(work.next_row) {
                Some(row) => {
                    let at = self.ghost.live(to_us(row.t_ms))?;
                    row.set_pose(GHOST, at);
                    work.next_row += 1;
                }
                None => self.work = None,
            }
        }
        Ok(())
    }

    /// The ghost cannot go on.
    pub(super) fn give_up(&mut self) {
        self.work = None;
    }
}

fn to_us(t_ms: i64) -> u64 {
    u64::try_from(t_ms).unwrap_or(0) * 1_000
}

/// Where the robot stood: as it was where that is known, else as it believed.
fn standing(row: &Row) -> Option<Standing> {
    let told = row.pose("")?;
    let origin = row.pose("origin_").unwrap_or_default();
    Some(Standing {
        at: row.pose("true_").unwrap_or_else(|| compose(origin, told)),
        told,
    })
}
