//! The receiver: samples of the line, the majority of three for each bit, and a buffer of two characters behind the shift
//! register (2549Q, section 22.7).
//!
//! Samples are not events: between two edges of the line they are all alike, so they are taken together when an edge, the
//! end of a frame or an access comes.

use super::format::Format;
use super::rate::Rate;

/// A character received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Received {
    pub(super) data: u16,
    pub(super) frame_error: bool,
    pub(super) parity_error: bool,
    /// One or more characters before it were lost.
    pub(super) overrun: bool,
}

/// What the receiver is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// It waits for the line to fall; `high` once a sample of it was.
    Idle { high: bool },
    /// A frame whose first low sample was at `first`.
    Frame { first: u64 },
}

/// The receiver.
#[derive(Clone, Debug)]
pub(super) struct Receiver {
    phase: Phase,
    level: bool,
    /// Everything before this cycle is sampled.
    sampled: u64,
    /// Of the frame: bits decided, with the start bit; their levels without it; samples of the bit at hand, and those high.
    decided: u32,
    bits: u32,
    voted: usize,
    high_votes: u32,
    buffer: [Received; 2],
    filled: usize,
    /// A character that stays in the shift register because the buffer is full.
    waiting: Option<Received>,
    lost: bool,
}

impl Default for Receiver {
    fn default() -> Receiver {
        Receiver {
            phase: Phase::Idle { high: false },
            level: true,
            sampled: 0,
            decided: 0,
            bits: 0,
            voted: 0,
            high_votes: 0,
            buffer: [Received::default(); 2],
            filled: 0,
            waiting: None,
            lost: false,
        }
    }
}

impl Receiver {
    /// Starts listening to a line with this level.
    pub(super) fn start(level: bool, cycle: u64) -> Receiver {
        Receiver {
            level,
            sampled: cycle,
            ..Receiver::default()
        }
    }

    /// Gives up the frame at hand: the clock has changed under it.
    pub(super) fn give_up(&mut self, cycle: u64) {
        self.phase = Phase::Idle { high: self.level };
        self.decided = 0;
        self.sampled = self.sampled.max(cycle);
    }

    /// Its clock stood for some cycles; the line has this level now.
    pub(super) fn delay(&mut self, cycles: u64, level: bool) {
        self.sampled += cycles;
        self.level = level;
        if let Phase::Frame { first } = &mut self.phase {
            *first += cycles;
        }
    }

    /// The character that is read next.
    pub(super) fn first(&self) -> Option<Received> {
        (self.filled > 0).then_some(self.buffer[0])
    }

    /// Takes it; an empty buffer gives what was in it last.
    pub(super) fn take(&mut self) -> Received {
        let taken = self.buffer[0];
        if self.filled > 0 {
            self.filled -= 1;
            self.buffer[0] = self.buffer[1];
            if let Some(waiting) = self.waiting.take() {
                self.put(waiting);
            }
        }
        taken
    }

    /// Samples a bit at the clock of a synchronous mode: a low one begins a frame.
    pub(super) fn clock_bit(
        &mut self,
        level: bool,
        format: Format,
        accept: impl Fn(u16, bool) -> bool,
    ) {
        self.level = level;
        if matches!(self.phase, Phase::Idle { .. }) {
            if level {
                return;
            }
            self.begin(0);
        }
        self.vote(format, 1, accept);
    }

    /// A bit of a byte without a frame.
    pub(super) fn clock_bare_bit(&mut self, level: bool, format: Format) {
        if self.decided == 0 {
            self.bits = 0;
        }
        self.bits |= u32::from(level) << self.decided;
        self.decided += 1;
        if self.decided == 8 {
            self.decided = 0;
            self.lost |= self.waiting.take().is_some();
            self.put(Received {
                data: u16::from(format.in_order(self.bits as u8)),
                ..Received::default()
            });
        }
    }

    fn put(&mut self, mut received: Received) {
        match self.buffer.get_mut(self.filled) {
            Some(place) => {
                received.overrun = std::mem::take(&mut self.lost);
                *place = received;
                self.filled += 1;
            }
            None => self.waiting = Some(received),
        }
    }

    /// The cycle in which the frame at hand is complete.
    pub(super) fn next(&self, format: Format, rate: Rate) -> Option<u64> {
        match self.phase {
            Phase::Idle { .. } => None,
            Phase::Frame { first } => {
                let end = sample(first, format.received(), rate.votes().len() - 1, rate);
                // A frame that begins while the clock is still coming up waits for it.
                Some(end.max(self.sampled))
            }
        }
    }

    /// The line takes a level at `cycle`.
    pub(super) fn change(
        &mut self,
        level: bool,
        cycle: u64,
        format: Format,
        rate: Rate,
        accept: impl Fn(u16, bool) -> bool,
    ) {
        self.sample_before(cycle, format, rate, accept);
        self.level = level;
        // The tick that begins a frame is the only one to be looked up before the next edge: it schedules the frame's end.
        if let (Phase::Idle { high: true }, false) = (self.phase, level) {
            let first = rate.next_tick(cycle);
            self.begin(first);
        }
    }

    fn begin(&mut self, first: u64) {
        self.phase = Phase::Frame { first };
        self.decided = 0;
        self.bits = 0;
        self.voted = 0;
        self.high_votes = 0;
    }

    /// Takes all samples before `cycle`; `accept` decides from data and stop bit whether the character is for this
    /// receiver.
    pub(super) fn sample_before(
        &mut self,
        cycle: u64,
        format: Format,
        rate: Rate,
        accept: impl Fn(u16, bool) -> bool,
    ) {
        while self.sampled < cycle {
            match self.phase {
                Phase::Idle { .. } => {
                    if rate.next_tick(self.sampled) < cycle {
                        self.phase = Phase::Idle { high: self.level };
                    }
                    self.sampled = cycle;
                }
                Phase::Frame { first } if first >= self.sampled && self.level && first < cycle => {
                    // High again before any sample saw it low.
                    self.phase = Phase::Idle { high: true };
                }
                Phase::Frame { first } => {
                    let next = sample(first, self.decided, self.voted, rate);
                    if next >= cycle {
                        self.sampled = cycle;
                        return;
                    }
                    self.sampled = next + 1;
                    self.vote(format, rate.votes().len(), &accept);
                }
            }
        }
    }

    /// One of the samples that decide about a bit.
    fn vote(&mut self, format: Format, votes: usize, accept: impl Fn(u16, bool) -> bool) {
        self.high_votes += u32::from(self.level);
        self.voted += 1;
        if self.voted < votes {
            return;
        }
        let high = 2 * self.high_votes as usize > votes;
        self.voted = 0;
        self.high_votes = 0;
        if self.decided == 0 {
            if high {
                // A spike, no start bit.
                self.phase = Phase::Idle { high: self.level };
                return;
            }
            self.lost |= self.waiting.take().is_some();
        } else {
            self.bits |= u32::from(high) << (self.decided - 1);
        }
        self.decided += 1;
        if self.decided > format.received() {
            self.phase = Phase::Idle { high: self.level };
            let (data, parity_error, stop) = format.take_apart(self.bits);
            if accept(data, stop) {
                self.put(Received {
                    data,
                    frame_error: !stop,
                    parity_error,
                    overrun: false,
                });
            }
        }
    }
}

/// The cycle of a sample of a bit: bit 0 is the start bit.
fn sample(first: u64, bit: u32, vote: usize, rate: Rate) -> u64 {
    let offset = rate.votes().get(vote).copied().unwrap_or_default();
    first + (u64::from(bit) * rate.per_bit + offset) * rate.tick
}
