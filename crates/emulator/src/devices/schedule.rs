//! When something happens next, for each source of events.

/// What can happen by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Source {
    /// The caller's next input.
    Input,
    /// The timers.
    Timer0,
    Timer1,
    Timer2,
    Timer3,
    Timer4,
    Timer5,
}

impl Source {
    pub(crate) const ALL: [Source; 7] = [
        Source::Input,
        Source::Timer0,
        Source::Timer1,
        Source::Timer2,
        Source::Timer3,
        Source::Timer4,
        Source::Timer5,
    ];

    /// Timer number `index`.
    pub(crate) const fn timer(index: usize) -> Source {
        match index {
            0 => Source::Timer0,
            1 => Source::Timer1,
            2 => Source::Timer2,
            3 => Source::Timer3,
            4 => Source::Timer4,
            _ => Source::Timer5,
        }
    }
}

const COUNT: usize = Source::ALL.len();

/// The cycle of each source's next event.
#[derive(Clone, Debug)]
pub(crate) struct Schedule {
    due: [u64; COUNT],
    next: u64,
}

impl Default for Schedule {
    fn default() -> Self {
        Schedule {
            due: [u64::MAX; COUNT],
            next: u64::MAX,
        }
    }
}

impl Schedule {
    /// The source's next event is at `cycle`; `None` if it has none.
    pub(crate) fn set(&mut self, source: Source, cycle: Option<u64>) {
        self.due[source as usize] = cycle.unwrap_or(u64::MAX);
        self.next = self.due.iter().copied().fold(u64::MAX, u64::min);
    }

    /// The cycle of the next event of all.
    #[inline(always)]
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// The next event up to `cycle`, and its cycle. Of two at once the source that was declared first goes first.
    pub(crate) fn due(&self, cycle: u64) -> Option<(Source, u64)> {
        if self.next > cycle {
            return None;
        }
        Source::ALL
            .into_iter()
            .find(|source| self.due[*source as usize] == self.next)
            .map(|source| (source, self.next))
    }
}
