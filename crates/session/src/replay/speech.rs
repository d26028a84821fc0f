//! Text in a log, from the USARTs of an emulated chip or a robot that speaks text, shown as the playhead passes it.

use crate::console::{ConsoleText, LINK_CONSOLE, readable};
use crate::event::Event;
use rumbo_log::Log;
use std::collections::BTreeMap;

/// The text, and how much of it the pages have.
#[derive(Debug)]
pub(super) struct Speech {
    /// Time \[ms\], USART and bytes, in order.
    said: Vec<(f64, u8, Vec<u8>)>,
    /// The first entry that the pages do not have.
    next: usize,
}

impl Speech {
    /// The text in the log; for an emulated chip, that of its USARTs.
    pub(super) fn of(log: &Log) -> Self {
        let from_chip = log.said.iter().filter(|said| !said.to_chip);
        let mut said: Vec<_> = from_chip
            .map(|said| (said.t_us as f64 / 1e3, said.usart, said.bytes.clone()))
            .collect();
        if log.said.is_empty() && log.speaks_text() {
            let from_robot = log.link.iter().filter(|burst| !burst.to_robot);
            said.extend(from_robot.map(|burst| {
                let t_ms = burst.t_us as f64 / 1e3;
                (t_ms, LINK_CONSOLE, burst.bytes.clone())
            }));
        }
        said.sort_by(|one, other| one.0.total_cmp(&other.0));
        Self { said, next: 0 }
    }

    /// Whether there is any.
    pub(super) fn speaks(&self) -> bool {
        !self.said.is_empty()
    }

    fn after(&self, t_ms: f64) -> usize {
        self.said.partition_point(|(at_ms, ..)| *at_ms <= t_ms)
    }

    /// The playhead was moved: the pages, now empty, have none of the text after this time.
    pub(super) fn seek(&mut self, from_ms: f64) {
        self.next = self.after(from_ms);
    }

    /// The playhead has advanced to this time: the text up to there.
    pub(super) fn advance(&mut self, to_ms: f64) -> impl Iterator<Item = Event> {
        let end = self.after(to_ms).max(self.next);
        let mut by_usart: BTreeMap<u8, Vec<u8>> = BTreeMap::new();
        for (_, usart, bytes) in self.said.get(self.next..end).unwrap_or_default() {
            by_usart.entry(*usart).or_default().extend(bytes);
        }
        self.next = end;
        by_usart.into_iter().map(|(usart, bytes)| {
            let text = readable(&bytes);
            Event::Console(ConsoleText { usart, text })
        })
    }
}
