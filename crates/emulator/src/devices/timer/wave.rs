//! The counter and its waveform modes: what happens at which tick (DS40002549, sections 16.7, 17.9 and 20.7).
//!
//! Everything happens at the tick that *leaves* a value: a compare match sets its flag and acts on its pin when the
//! counter goes on from the compare value, an overflow when it goes on from its end. So a segment of counting is
//! quiet up to the next value of interest, and is stepped over at once.

/// Channels of a timer; the 8-bit ones have two.
pub(crate) const CHANNELS: usize = 3;

/// How the counter runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Up to the top, or to the end where that is lower than the counter, and from 0 again.
    Count,
    /// The same, with outputs set at the bottom and compare values taken over there.
    Fast,
    /// Up and down; compare values are taken over at the top.
    PhaseCorrect,
    /// Up and down; compare values are taken over at the bottom.
    PhaseFrequencyCorrect,
}

/// What the top is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Top {
    /// This value.
    Fixed(u16),
    /// The compare register of channel A.
    CompareA,
    /// The capture register.
    Capture,
}

/// A waveform mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Mode {
    pub(crate) kind: Kind,
    pub(crate) top: Top,
    /// Channel A toggles on a match where its pin's mode is 1, although it is PWM.
    pub(crate) toggles_a: bool,
}

impl Mode {
    /// From WGM of an 8-bit timer.
    pub(crate) const fn narrow(wgm: u8) -> Mode {
        let (kind, top) = match wgm & 7 {
            1 => (Kind::PhaseCorrect, Top::Fixed(0xFF)),
            2 => (Kind::Count, Top::CompareA),
            3 => (Kind::Fast, Top::Fixed(0xFF)),
            5 => (Kind::PhaseCorrect, Top::CompareA),
            7 => (Kind::Fast, Top::CompareA),
            // 4 and 6 are reserved.
            _ => (Kind::Count, Top::Fixed(0xFF)),
        };
        Mode {
            kind,
            top,
            toggles_a: matches!(wgm & 7, 5 | 7),
        }
    }

    /// From WGM of a 16-bit timer.
    pub(crate) const fn wide(wgm: u8) -> Mode {
        let (kind, top) = match wgm & 15 {
            1 => (Kind::PhaseCorrect, Top::Fixed(0x00FF)),
            2 => (Kind::PhaseCorrect, Top::Fixed(0x01FF)),
            3 => (Kind::PhaseCorrect, Top::Fixed(0x03FF)),
            4 => (Kind::Count, Top::CompareA),
            5 => (Kind::Fast, Top::Fixed(0x00FF)),
            6 => (Kind::Fast, Top::Fixed(0x01FF)),
            7 => (Kind::Fast, Top::Fixed(0x03FF)),
            8 => (Kind::PhaseFrequencyCorrect, Top::Capture),
            9 => (Kind::PhaseFrequencyCorrect, Top::CompareA),
            10 => (Kind::PhaseCorrect, Top::Capture),
            11 => (Kind::PhaseCorrect, Top::CompareA),
            12 => (Kind::Count, Top::Capture),
            14 => (Kind::Fast, Top::Capture),
            15 => (Kind::Fast, Top::CompareA),
            // 13 is reserved.
            _ => (Kind::Count, Top::Fixed(0xFFFF)),
        };
        Mode {
            kind,
            top,
            toggles_a: matches!(wgm & 15, 9 | 11 | 14 | 15),
        }
    }

    /// Outputs are modulated: compare values are buffered, and a forced compare does nothing.
    pub(crate) const fn is_pwm(self) -> bool {
        !matches!(self.kind, Kind::Count)
    }

    const fn turns(self) -> bool {
        matches!(self.kind, Kind::PhaseCorrect | Kind::PhaseFrequencyCorrect)
    }
}

/// The flags as in TIFR.
pub(crate) const OVERFLOW: u8 = 0x01;
pub(crate) const MATCH: [u8; CHANNELS] = [0x02, 0x04, 0x08];
pub(crate) const CAPTURE: u8 = 0x20;

/// The counter with what its waveform depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave {
    pub(crate) mode: Mode,
    /// The largest count: 0xFF or 0xFFFF.
    pub(crate) max: u16,
    pub(crate) channels: usize,
    pub(crate) count: u16,
    pub(crate) down: bool,
    /// Compare values in force, and those written.
    pub(crate) compare: [u16; CHANNELS],
    pub(crate) buffered: [u16; CHANNELS],
    pub(crate) capture: u16,
    /// COM of each channel.
    pub(crate) pin_mode: [u8; CHANNELS],
    /// The output compare registers, that is the pins where they are connected.
    pub(crate) output: [bool; CHANNELS],
    pub(crate) flags: u8,
    /// The counter was written: the next tick brings no match.
    pub(crate) blocked: bool,
    /// Other compare values have come into force.
    pub(crate) updated: bool,
}

impl Wave {
    pub(crate) const fn new(wide: bool) -> Wave {
        Wave {
            mode: if wide { Mode::wide(0) } else { Mode::narrow(0) },
            max: if wide { 0xFFFF } else { 0xFF },
            channels: if wide { 3 } else { 2 },
            count: 0,
            down: false,
            compare: [0; CHANNELS],
            buffered: [0; CHANNELS],
            capture: 0,
            pin_mode: [0; CHANNELS],
            output: [false; CHANNELS],
            flags: 0,
            blocked: false,
            updated: false,
        }
    }

    pub(crate) const fn top(&self) -> u16 {
        match self.mode.top {
            Top::Fixed(top) => top,
            Top::CompareA => self.compare[0],
            Top::Capture => self.capture,
        }
    }

    /// Sets another mode; without PWM, compare values take effect at once.
    pub(crate) fn set_mode(&mut self, mode: Mode) {
        self.mode = mode;
        if !mode.turns() {
            self.down = false;
        }
        if !mode.is_pwm() {
            self.compare = self.buffered;
        }
    }

    /// Writes a compare value.
    pub(crate) fn set_compare(&mut self, channel: usize, value: u16) {
        self.buffered[channel] = value;
        if !self.mode.is_pwm() {
            self.compare[channel] = value;
        }
    }

    /// The channel's pin follows its output.
    pub(crate) fn is_connected(&self, channel: usize) -> bool {
        match self.pin_mode[channel] {
            0 => false,
            1 if self.mode.is_pwm() => channel == 0 && self.mode.toggles_a,
            _ => true,
        }
    }

    /// Where the present segment of counting ends.
    fn end(&self) -> u16 {
        let top = self.top();
        if self.down {
            0
        } else if self.count <= top {
            top
        } else {
            self.max
        }
    }

    /// Ticks up to and including the one that leaves the next value of interest: the end of the segment, or the compare value of a
    /// channel in `channels`.
    pub(crate) fn quiet_ticks(&self, channels: u8) -> u64 {
        let end = self.end();
        let distance = |value: u16| {
            if self.down {
                self.count.checked_sub(value)
            } else {
                value.checked_sub(self.count).filter(|_| value <= end)
            }
        };
        let mut nearest = self.count.abs_diff(end);
        for channel in 0..self.channels {
            if channels >> channel & 1 != 0
                && let Some(ticks) = distance(self.compare[channel])
            {
                nearest = nearest.min(ticks);
            }
        }
        u64::from(nearest) + 1
    }

    /// Ticks of a whole period.
    pub(crate) fn period(&self) -> u64 {
        let top = u64::from(self.top());
        if self.mode.turns() {
            (2 * top).max(1)
        } else {
            top + 1
        }
    }

    /// The counter goes on by `ticks`, all but the last of them quiet; says whether the last left a value of interest.
    pub(crate) fn tick(&mut self, ticks: u64) -> bool {
        let quiet = self.quiet_ticks(0xFF);
        if ticks < quiet {
            let ticks = ticks as u16;
            self.count = if self.down {
                self.count - ticks
            } else {
                self.count + ticks
            };
            self.blocked &= ticks == 0;
            return false;
        }
        // Up to the value, then the tick that leaves it.
        let ahead = (quiet - 1) as u16;
        self.count = if self.down {
            self.count - ahead
        } else {
            self.count + ahead
        };
        self.blocked &= ahead == 0;
        self.leave();
        self.blocked = false;
        true
    }

    /// The tick that leaves the present value.
    fn leave(&mut self) {
        let top = self.top();
        let at_end = self.count == self.end();
        for (channel, flag) in MATCH.into_iter().enumerate().take(self.channels) {
            if self.compare[channel] == self.count && !self.blocked {
                self.flags |= flag;
                // At the turning points the way that follows counts.
                let falling = self.down != (at_end && self.mode.turns());
                self.act(channel, falling);
            }
        }
        if !at_end {
            self.count = if self.down {
                self.count - 1
            } else {
                self.count + 1
            };
            return;
        }
        let at_top = !self.down && self.count == top;
        if at_top && self.mode.top == Top::Capture {
            self.flags |= CAPTURE;
        }
        match self.mode.kind {
            Kind::Count => {
                if self.count == self.max {
                    self.flags |= OVERFLOW;
                }
                self.count = 0;
            }
            Kind::Fast => {
                self.flags |= OVERFLOW;
                self.count = 0;
                self.take_over();
                self.set_at_bottom();
            }
            Kind::PhaseCorrect | Kind::PhaseFrequencyCorrect if self.down => {
                self.flags |= OVERFLOW;
                if self.mode.kind == Kind::PhaseFrequencyCorrect {
                    self.take_over();
                }
                self.down = false;
                self.count = u16::from(self.top() > 0);
            }
            Kind::PhaseCorrect | Kind::PhaseFrequencyCorrect => {
                if self.mode.kind == Kind::PhaseCorrect {
                    self.take_over();
                }
                self.down = true;
                self.count = self.count.saturating_sub(1);
            }
        }
    }

    /// The compare values that were written come into force.
    fn take_over(&mut self) {
        self.updated |= self.compare != self.buffered;
        self.compare = self.buffered;
    }

    /// A match acts on its channel's output; `falling` where the counter counts down.
    fn act(&mut self, channel: usize, falling: bool) {
        let output = &mut self.output[channel];
        match (self.pin_mode[channel], self.mode.turns()) {
            (0, _) => {}
            (1, _) => *output = !*output,
            (2, false) => *output = false,
            (3, false) => *output = true,
            (2, true) => *output = falling,
            (_, _) => *output = !falling,
        }
    }

    /// Fast PWM sets or clears its outputs when the counter starts over.
    fn set_at_bottom(&mut self) {
        for channel in 0..self.channels {
            match self.pin_mode[channel] {
                2 => self.output[channel] = true,
                3 => self.output[channel] = false,
                _ => {}
            }
        }
    }

    /// A forced compare: acts on the pin without a flag; nothing in PWM modes.
    pub(crate) fn force(&mut self, channel: usize) {
        if !self.mode.is_pwm() {
            self.act(channel, false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(wide: bool, wgm: u8, compare: [u16; 3], capture: u16) -> Wave {
        let mut wave = Wave::new(wide);
        wave.set_mode(if wide {
            Mode::wide(wgm)
        } else {
            Mode::narrow(wgm)
        });
        wave.compare = compare;
        wave.buffered = compare;
        wave.capture = capture;
        wave
    }

    /// The ticks at which `flag` is raised in `ticks` ticks; it is cleared each time.
    fn raised(wave: &mut Wave, flag: u8, ticks: u64) -> Vec<u64> {
        let mut times = Vec::new();
        for tick in 1..=ticks {
            wave.tick(1);
            if wave.flags & flag != 0 {
                times.push(tick);
            }
            wave.flags = 0;
        }
        times
    }

    #[test]
    fn periods_are_those_of_the_tables() {
        for (wide, wgm, compare, capture, flag, period) in [
            (false, 0, 0, 0, OVERFLOW, 256),
            (false, 1, 0, 0, OVERFLOW, 510),
            (false, 2, 99, 0, MATCH[0], 100),
            (false, 3, 0, 0, OVERFLOW, 256),
            (false, 5, 99, 0, OVERFLOW, 198),
            (false, 7, 99, 0, OVERFLOW, 100),
            (true, 1, 0, 0, OVERFLOW, 510),
            (true, 2, 0, 0, OVERFLOW, 1022),
            (true, 3, 0, 0, OVERFLOW, 2046),
            (true, 4, 499, 0, MATCH[0], 500),
            (true, 5, 0, 0, OVERFLOW, 256),
            (true, 6, 0, 0, OVERFLOW, 512),
            (true, 7, 0, 0, OVERFLOW, 1024),
            (true, 8, 0, 300, OVERFLOW, 600),
            (true, 9, 300, 0, OVERFLOW, 600),
            (true, 10, 0, 300, OVERFLOW, 600),
            (true, 11, 300, 0, OVERFLOW, 600),
            (true, 12, 0, 300, CAPTURE, 301),
            (true, 14, 0, 300, OVERFLOW, 301),
            (true, 15, 300, 0, OVERFLOW, 301),
        ] {
            let mut wave = wave(wide, wgm, [compare, 0, 0], capture);
            let times = raised(&mut wave, flag, 4 * period);
            assert!(times.len() >= 3, "mode {wgm} of {wide}: {times:?}");
            let steps: Vec<_> = times.windows(2).map(|two| two[1] - two[0]).collect();
            assert!(
                steps.iter().all(|step| *step == period),
                "mode {wgm}: {steps:?}"
            );
            assert_eq!(wave.period(), period, "mode {wgm}");
        }
    }

    #[test]
    fn one_stride_is_the_same_as_many_single_ticks() {
        for wgm in [0, 1, 3, 4, 8, 9, 11, 12, 14, 15] {
            for stride in [1u64, 7, 100, 1_000] {
                let start = wave(true, wgm, [700, 250, 251], 900);
                let (mut once, mut singly) = (start, start);
                once.pin_mode = [2, 3, 1];
                singly.pin_mode = [2, 3, 1];
                for _ in 0..50 {
                    let mut left = stride;
                    while left > 0 {
                        let step = once.quiet_ticks(0xFF).min(left);
                        once.tick(step);
                        left -= step;
                    }
                    (0..stride).for_each(|_| {
                        singly.tick(1);
                    });
                    assert_eq!(once.count, singly.count, "mode {wgm}");
                    assert_eq!((once.flags, once.output), (singly.flags, singly.output));
                }
            }
        }
    }

    /// Ticks per period for which channel B's output is high.
    fn high(wgm: u8, pin_mode: u8, compare: u16) -> u64 {
        let mut wave = wave(true, wgm, [0, compare, 0], 1000);
        wave.pin_mode[1] = pin_mode;
        let period = wave.period();
        (0..2 * period).for_each(|_| {
            wave.tick(1);
        });
        let high = |wave: &mut Wave| {
            wave.tick(1);
            u64::from(wave.output[1])
        };
        (0..period).map(|_| high(&mut wave)).sum()
    }

    #[test]
    fn pulses_are_as_wide_as_the_datasheet_says() {
        // Fast: OCR + 1 of TOP + 1; a spike of one tick at the bottom, all high at the top.
        assert_eq!(
            [high(14, 2, 0), high(14, 2, 250), high(14, 2, 1000)],
            [1, 251, 1001]
        );
        assert_eq!(high(14, 3, 250), 1001 - 251);
        // Phase correct: 2 OCR of 2 TOP; all low at the bottom, all high at the top.
        assert_eq!(
            [high(10, 2, 0), high(10, 2, 250), high(10, 2, 1000)],
            [0, 500, 2000]
        );
        assert_eq!(high(8, 3, 250), 2000 - 500);
    }

    #[test]
    fn a_new_compare_value_waits_for_top_or_bottom() {
        for (wgm, taken_at) in [(14, 0), (10, 999), (8, 1)] {
            let mut wave = wave(true, wgm, [0, 10, 0], 1000);
            (0..500).for_each(|_| {
                wave.tick(1);
            });
            wave.set_compare(1, 20);
            while wave.compare[1] == 10 {
                wave.tick(1);
            }
            assert_eq!(wave.count, taken_at, "mode {wgm}");
        }
        let mut wave = wave(true, 4, [1000, 10, 0], 0);
        wave.set_compare(1, 20);
        assert_eq!(wave.compare[1], 20, "without PWM at once");
    }

    #[test]
    fn a_written_counter_misses_the_match_of_the_next_tick() {
        let mut wave = wave(true, 4, [1000, 10, 0], 0);
        wave.count = 10;
        wave.blocked = true;
        wave.tick(1);
        assert_eq!(wave.flags & MATCH[1], 0);
        wave.count = 9;
        wave.blocked = true;
        wave.tick(2);
        wave.tick(1);
        assert_eq!(wave.flags & MATCH[1], MATCH[1]);
    }
}
