//! Prints warnings and faults on the terminal in which the station was started.
//!
//! A terminal can be stopped (Ctrl-S), and a pipe that nobody reads fills up: so a separate thread prints, and drops
//! what does not fit its queue. The session never waits for it.

use rumbo_log::{Level, LoggedEvent};
use std::sync::mpsc::{SyncSender, sync_channel};

/// Longest queue of lines.
const QUEUE: usize = 64;

/// Prints a line for people, without terminal control sequences.
pub type Print = fn(&str);

/// The queue of lines to print.
#[derive(Debug)]
pub(crate) struct Echo {
    lines: SyncSender<String>,
    /// Whose events they are, if there are several robots.
    robot: String,
}

impl Echo {
    /// Starts the thread; `None` if the system has none.
    pub(crate) fn start(print: Print) -> Option<Self> {
        let (lines, waiting) = sync_channel::<String>(QUEUE);
        let thread = std::thread::Builder::new().name("echo".into());
        let thread = thread.spawn(move || waiting.iter().for_each(|line| print(&line)));
        let robot = String::new();
        thread.ok().map(|_| Self { lines, robot })
    }

    /// The same for the events of one of several robots.
    pub(crate) fn of(&self, robot: String) -> Self {
        let lines = self.lines.clone();
        Self { lines, robot }
    }

    /// Prints a warning or a fault.
    pub(crate) fn event(&self, event: &LoggedEvent) {
        if matches!(event.level, Level::Warning | Level::Fault) {
            let LoggedEvent { t_s, level, text } = event;
            let mut line = format!("{t_s:.2} s {}: {text}", level.name());
            if !self.robot.is_empty() {
                line = format!("{}: {line}", self.robot);
            }
            // A dropped line is on the page and in the log.
            let _ = self.lines.try_send(line);
        }
    }
}
