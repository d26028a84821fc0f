//! A recording in place of the lab: its replay, and the board that the page reads of.

use rumbo_log::Log;
use rumbo_session::{Board, Order, Replay};
use std::io::Cursor;
use std::path::Path;

/// Largest file of a recording \[bytes\]: with its signals in memory it is some times as large.
const LARGEST: usize = 100 << 20;

/// A log that is shown in place of the lab.
#[derive(Debug)]
pub struct Showing {
    replay: Replay,
    pub(crate) board: Board,
}

impl Showing {
    /// The log in the bytes of a file of this name, paused at its beginning.
    ///
    /// # Errors
    /// What is wrong with it, as `rumbo replay` says it.
    pub fn new(file: &str, bytes: Vec<u8>) -> Result<Self, String> {
        if bytes.len() > LARGEST {
            return Err(format!(
                "{file}: not opened, a recording has at most {} MB here; `rumbo replay` shows it on a computer",
                LARGEST >> 20
            ));
        }
        let read = Log::read_replay(Cursor::new(bytes)).map_err(|error| error.to_string());
        let read = read.and_then(|log| log.why_empty().map_or(Ok(log), Err));
        let log = read.map_err(|why| format!("{file}: {why}"))?;
        let name = Path::new(file).file_stem().unwrap_or(file.as_ref());
        let name = name.to_string_lossy().into_owned();
        Ok(Self {
            replay: Replay::new(name, log, 0.0, None),
            board: Board::default(),
        })
    }

    /// Executes orders and plays on: the wall clock is \[us\], the time of day \[ms since 1970\].
    pub(crate) fn advance(&mut self, orders: &[Order], wall_us: u64, day_ms: f64) {
        orders.iter().for_each(|order| self.replay.obey(order));
        self.replay.wall_passed(wall_us);
        self.replay.update();
        for event in self.replay.take_events() {
            self.board.take(&event, day_ms);
        }
    }
}
