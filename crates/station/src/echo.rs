//! Warnings and faults on the terminal in which the station was started, for those who look there.
//!
//! A terminal can be stopped (Ctrl-S), and a pipe that nobody reads fills up: so a thread of its own prints, and what
//! it cannot print in time is left out. The session never waits for it.

use rumbo_log::{Level, LoggedEvent};
use std::sync::mpsc::{SyncSender, sync_channel};

/// Lines that wait for the terminal.
const WAITING: usize = 64;

/// Prints a line for people, such that nothing in it commands the terminal.
pub type Print = fn(&str);

/// The way to the terminal.
#[derive(Clone, Debug)]
pub(crate) struct Echo(SyncSender<String>);

impl Echo {
    /// Begins to print; `None` if the system gives no thread.
    pub(crate) fn start(print: Print) -> Option<Self> {
        let (lines, waiting) = sync_channel::<String>(WAITING);
        let thread = std::thread::Builder::new().name("echo".into());
        let thread = thread.spawn(move || waiting.iter().for_each(|line| print(&line)));
        thread.ok().map(|_| Self(lines))
    }

    /// Prints what went wrong.
    pub(crate) fn event(&self, event: &LoggedEvent) {
        if matches!(event.level, Level::Warning | Level::Fault) {
            let LoggedEvent { t_s, level, text } = event;
            let line = format!("{t_s:.2} s {}: {text}", level.name());
            // One that does not fit is on the page and in the log.
            let _ = self.0.try_send(line);
        }
    }
}
