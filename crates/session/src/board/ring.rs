//! What the board is made of: rings with running numbers, and values with a version.

use std::collections::VecDeque;

/// A ring whose entries keep their running number.
#[derive(Debug)]
pub(super) struct Ring<T> {
    entries: VecDeque<T>,
    /// Number of the next entry.
    next: u64,
    kept: usize,
}

impl<T: Clone> Ring<T> {
    pub(super) fn new(kept: usize) -> Self {
        Self {
            entries: VecDeque::new(),
            next: 0,
            kept,
        }
    }

    pub(super) fn push(&mut self, entry: T) {
        if self.entries.len() == self.kept {
            self.entries.pop_front();
        }
        self.entries.push_back(entry);
        self.next += 1;
    }

    pub(super) fn clear(&mut self) {
        self.entries.clear();
    }

    /// The entries from `cursor` on and how many before them are gone; moves the cursor behind them.
    pub(super) fn read(&self, cursor: &mut u64) -> (Vec<T>, u64) {
        let first = self.next - self.entries.len() as u64;
        let gone = first.saturating_sub(*cursor);
        let skip = cursor.saturating_sub(first) as usize;
        *cursor = self.next;
        (self.entries.iter().skip(skip).cloned().collect(), gone)
    }
}

/// A value and how often it changed.
#[derive(Debug, Default)]
pub(super) struct Versioned<T> {
    value: T,
    version: u64,
}

impl<T: PartialEq> Versioned<T> {
    /// Whether the value is a new one.
    pub(super) fn set(&mut self, value: T) -> bool {
        let new = self.version == 0 || self.value != value;
        if new {
            self.value = value;
            self.version += 1;
        }
        new
    }
}

impl<T> Versioned<T> {
    pub(super) fn value(&self) -> &T {
        &self.value
    }
}

impl<T: Clone> Versioned<T> {
    /// The value, if it is newer than the one `seen`, which moves on.
    pub(super) fn newer(&self, seen: &mut u64) -> Option<T> {
        (self.version != *seen).then(|| {
            *seen = self.version;
            self.value.clone()
        })
    }
}
