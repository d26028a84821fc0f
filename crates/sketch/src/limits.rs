//! How much a compilation may take.

use std::time::Duration;

/// Limits of a compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// For all of a sketch.
    pub time: Duration,
    /// Address space of each process, and memory of all together [MB].
    pub memory_mb: u64,
    /// Processes and their threads, at a time.
    pub processes: usize,
    /// Of each file it writes [MB].
    pub file_mb: u64,
    /// Of what it prints [bytes].
    pub output: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            time: Duration::from_secs(180),
            memory_mb: 1024,
            // The linker's deepest chain is of ten.
            processes: 40,
            file_mb: 32,
            output: 256 << 10,
        }
    }
}
