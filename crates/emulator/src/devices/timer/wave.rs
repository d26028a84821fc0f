//! The counter and its waveform modes: what happens at which tick (2549Q, sections 16.7, 17.9 and 20.7).
//!
//! Everything happens at the tick that *leaves* a value: a compare match sets its flag and acts on its pin when the
//! counter goes on from the compare value, an overflow when it goes on from its end. So a segment of counting is
//! quiet up to the next value of interest, and is stepped over at once.

use crate::model::timer::{CAPTURE, CHANNELS, MATCH, OVERFLOW};
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
    pub(crate) const fn new(wide: bool, channels: usize) -> Wave {
        Wave {
            mode: if wide { Mode::wide(0) } else { Mode::narrow(0) },
            max: if wide { 0xFFFF } else { 0xFF },
            channels,
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

    /// The counter goes on by `ticks`, all but the last of them quiet; returns whether the last left a value of
    /// interest.
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
                self.load_compare();
                self.set_at_bottom();
            }
            Kind::PhaseCorrect | Kind::PhaseFrequencyCorrect if self.down => {
                self.flags |= OVERFLOW;
                if self.mode.kind == Kind::PhaseFrequencyCorrect {
                    self.load_compare();
                }
                self.down = false;
                self.count = u16::from(self.top() > 0);
            }
            Kind::PhaseCorrect | Kind::PhaseFrequencyCorrect => {
                if self.mode.kind == Kind::PhaseCorrect {
                    self.load_compare();
                }
                self.down = true;
                self.count = self.count.saturating_sub(1);
            }
        }
    }

    /// Loads the buffered compare values.
    fn load_compare(&mut self) {
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
mod tests;
