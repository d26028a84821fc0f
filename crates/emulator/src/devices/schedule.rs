//! When something happens next, for each source of events.

/// What can happen by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// The caller's next input.
    Input,
    /// A timer, 0 to 5.
    Timer(usize),
    /// A USART, 0 to 3, with the line that leads to it.
    Usart(usize),
    /// The end of a write to the EEPROM.
    Eeprom,
    /// The watchdog's end.
    Watchdog,
    /// A conversion's sample or end.
    Analog,
    /// A page of flash is erased or written.
    Programming,
    /// A transfer is through.
    Spi,
    /// A condition or a byte is through.
    Twi,
}

/// Slots of the timers and of the USARTs.
const TIMERS: usize = 1;
const USARTS: usize = TIMERS + 6;
const EEPROM: usize = USARTS + 4;
const WATCHDOG: usize = EEPROM + 1;
const ANALOG: usize = WATCHDOG + 1;
const PROGRAMMING: usize = ANALOG + 1;
const SPI: usize = PROGRAMMING + 1;
const TWI: usize = SPI + 1;
const COUNT: usize = TWI + 1;

impl Source {
    const fn slot(self) -> usize {
        match self {
            Source::Input => 0,
            Source::Timer(index) => TIMERS + index % 6,
            Source::Usart(index) => USARTS + index % 4,
            Source::Eeprom => EEPROM,
            Source::Watchdog => WATCHDOG,
            Source::Analog => ANALOG,
            Source::Programming => PROGRAMMING,
            Source::Spi => SPI,
            Source::Twi => TWI,
        }
    }

    const fn of_slot(slot: usize) -> Source {
        match slot {
            0 => Source::Input,
            TIMERS..USARTS => Source::Timer(slot - TIMERS),
            USARTS..EEPROM => Source::Usart(slot - USARTS),
            EEPROM => Source::Eeprom,
            WATCHDOG => Source::Watchdog,
            ANALOG => Source::Analog,
            PROGRAMMING => Source::Programming,
            SPI => Source::Spi,
            _ => Source::Twi,
        }
    }
}

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
        let cycle = cycle.unwrap_or(u64::MAX);
        let before = std::mem::replace(&mut self.due[source.slot()], cycle);
        if cycle < self.next {
            self.next = cycle;
        } else if before == self.next {
            self.next = self.due.iter().copied().fold(u64::MAX, u64::min);
        }
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
        let slot = self.due.iter().position(|due| *due == self.next)?;
        Some((Source::of_slot(slot), self.next))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_earliest_goes_first_and_the_first_declared_of_two_at_once() {
        let mut schedule = Schedule::default();
        assert_eq!(schedule.due(u64::MAX - 1), None);
        for (source, cycle) in [
            (Source::Usart(3), 50),
            (Source::Timer(5), 50),
            (Source::Input, 60),
        ] {
            schedule.set(source, Some(cycle));
        }
        assert_eq!(schedule.due(49), None);
        assert_eq!(schedule.due(50), Some((Source::Timer(5), 50)));
        schedule.set(Source::Timer(5), Some(70));
        assert_eq!(schedule.due(70), Some((Source::Usart(3), 50)));
        schedule.set(Source::Usart(3), None);
        assert_eq!(schedule.due(70), Some((Source::Input, 60)));
    }
}
