//! A link that drives: the orders in it, each given at its time, and whether the run is the one that was shared.

use crate::drive::{self, MOST};
use crate::start::Start;
use rumbo_log::Level;
use rumbo_session::{Order, WorldAct, WorldOrder};
use std::collections::VecDeque;

/// The orders of a link that are not given yet.
pub(crate) struct Following {
    waiting: VecDeque<(u64, Order)>,
    /// Until then the run was driven \[us\].
    pub(crate) until_us: u64,
    /// Of the run until then; `None`: not all of it is in the link.
    hash: Option<String>,
    /// What to say about it.
    pub(crate) notes: Vec<(Level, String)>,
}

impl Following {
    /// What a link gives, if anything.
    ///
    /// # Errors
    /// Why its commands are left out.
    pub(crate) fn of(start: &Start) -> Result<Option<Self>, String> {
        let Some(text) = &start.drive else {
            return Ok(None);
        };
        let (waiting, count) = drive::from_text(text)
            .map_err(|why| format!("the link's commands are left out: {why}"))?;
        let last_us = waiting.back().map_or(0, |(t_us, _)| *t_us);
        let whole = count <= MOST;
        let until_us = start.until_s.filter(|_| whole).map_or(last_us, |until_s| {
            ((until_s * 1e6).round() as u64).max(last_us)
        });
        let mut notes = Vec::new();
        if !whole {
            notes.push((
                Level::Warning,
                format!(
                    "the link has {count} changes of commands, and {MOST} are the most: only the first ones are repeated"
                ),
            ));
        }
        notes.push((
            Level::Info,
            format!(
                "the link repeats a run driven by hand until {:.2} s (changes of commands: {}); an order given here ends that",
                until_us as f64 / 1e6,
                waiting.len()
            ),
        ));
        Ok(Some(Self {
            waiting,
            until_us,
            hash: start.hash.clone().filter(|_| whole),
            notes,
        }))
    }

    /// The next order that is due at this time of the target \[us\].
    pub(crate) fn next(&mut self, target_us: u64) -> Option<Order> {
        let due = self
            .waiting
            .front()
            .is_some_and(|(t_us, _)| *t_us <= target_us);
        let next = self.waiting.pop_front_if(|_| due)?;
        Some(next.1)
    }

    /// Its end, of a run with this hash.
    pub(crate) fn verdict(self, hash: Option<String>) -> (Level, String) {
        let until_s = self.until_us as f64 / 1e6;
        match (self.hash, hash) {
            (Some(shared), Some(here)) if shared == here => (
                Level::Good,
                format!("until {until_s:.2} s this is the run of the link, bit for bit"),
            ),
            (Some(_), Some(_)) => (
                Level::Warning,
                "this is not the run of the link: that one is of another version, or the link was changed"
                    .into(),
            ),
            _ => (
                Level::Info,
                format!("the link drives no further than {until_s:.2} s"),
            ),
        }
    }
}

/// Whether an order ends what a link repeats.
pub(crate) fn is_by_hand(order: &Order) -> bool {
    !matches!(
        order,
        Order::Speed(_)
            | Order::TakeControl
            | Order::ReleaseControl
            | Order::RestartGhost
            | Order::Profile(_)
            | Order::Sketch(..)
            | Order::World(WorldOrder {
                act: WorldAct::Show | WorldAct::Check,
                ..
            })
            | Order::Seek(_)
            | Order::Step(_)
    )
}
