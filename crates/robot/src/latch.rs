//! The sensor latch: turns the interrupts' stamps into the inputs of a tick, natively and on the chip.
//!
//! ```text
//! encoder: edge -> stamp  -> EdgeCounter: count, last edge, time of a motor turn
//! sonar:   ping, rise, fall -> EchoLine: stamps -> EchoLatch: a pulse, clear or silent, once
//! ```
//!
//! An interrupt only leaves the stamp of its timer; all else is done at the tick, in the robot's microseconds.

use rumbo_control::{Echo, Edges, Micros, OUTPUT_DELAY_US, SonarId};

/// Edges of a motor turn.
const POLES: usize = 8;
/// The echo line must have risen by this time after the ping, or the sonar is silent [us].
const RISE_US: u32 = 5_000;
/// An echo line still high after this time means that nothing is within range [us]: 2.51 m. That is known two ticks
/// after its ping.
const REACH_US: u32 = 14_600;

/// Counts of the chip's timer per microsecond.
pub const COUNTS_PER_US: u32 = 2;
/// A stamp this many counts ahead of the tick, 4 ms, is later than it, since a ping leaves with the outputs; any other
/// is earlier.
const AHEAD_COUNTS: u16 = (OUTPUT_DELAY_US * COUNTS_PER_US) as u16 / 3 * 4;

/// A reading of the chip's timer [0.5 us].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamp(pub u16);

impl Stamp {
    /// Time from `earlier` to `self` [0.5 us], right below 32.768 ms.
    fn since(self, earlier: Stamp) -> u16 {
        self.0.wrapping_sub(earlier.0)
    }

    /// Whether it is later than this tick.
    pub fn is_after(self, tick: Stamp) -> bool {
        (1..=AHEAD_COUNTS).contains(&self.since(tick))
    }

    /// The same in the robot's time, where the tick is at `now`.
    pub fn micros(self, tick: Stamp, now: Micros) -> Micros {
        let us = |counts: u16| u32::from(counts) / COUNTS_PER_US;
        if self.is_after(tick) {
            now.after(us(self.since(tick)))
        } else {
            Micros(now.0.wrapping_sub(us(tick.since(self))))
        }
    }
}

/// Counts and times of one encoder's edges.
#[derive(Clone, Copy, Debug, Default)]
pub struct EdgeCounter {
    edges: Edges,
    /// The last edge of each pole.
    poles: [Micros; POLES],
    /// How many of them are known.
    known: u8,
}

impl EdgeCounter {
    /// An edge.
    pub fn edge(&mut self, at: Micros) {
        self.edges.count = self.edges.count.wrapping_add(1);
        if let Some(pole) = self.poles.get_mut(usize::from(self.edges.count) % POLES) {
            if usize::from(self.known) < POLES {
                self.known += 1;
            } else {
                self.edges.turn_us = at.since(*pole);
            }
            *pole = at;
        }
        self.edges.last = at;
    }

    /// Edges whose stamps are lost.
    pub fn unstamped(&mut self, edges: u8) {
        self.edges.count = self.edges.count.wrapping_add(u16::from(edges));
        self.known = 0;
        self.edges.turn_us = 0;
    }

    /// The robot's view of them.
    pub fn edges(&self) -> Edges {
        self.edges
    }
}

/// The echo line of a sonar, with the stamps that its interrupts have left since the last ping.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EchoLine<T> {
    /// No ping has left yet.
    #[default]
    Idle,
    /// A ping has left.
    Pinged(T),
    /// The line has risen.
    Risen(T),
    /// It has risen and fallen.
    Fallen(T, T),
}

impl<T: Copy> EchoLine<T> {
    /// An edge, which leads to this level. After a ping the first rise counts, and the fall after it.
    #[inline(always)]
    pub fn edge(&mut self, high: bool, at: T) {
        match *self {
            EchoLine::Pinged(_) if high => *self = EchoLine::Risen(at),
            EchoLine::Risen(rise) if !high => *self = EchoLine::Fallen(rise, at),
            _ => {}
        }
    }

    /// The same line with converted stamps.
    pub fn map<U>(self, stamp: impl Fn(T) -> U) -> EchoLine<U> {
        match self {
            EchoLine::Idle => EchoLine::Idle,
            EchoLine::Pinged(at) => EchoLine::Pinged(stamp(at)),
            EchoLine::Risen(at) => EchoLine::Risen(stamp(at)),
            EchoLine::Fallen(rise, fall) => EchoLine::Fallen(stamp(rise), stamp(fall)),
        }
    }
}

impl EchoLine<Micros> {
    /// The sonar's answer, if it is decided by now.
    fn echo(self, now: Micros) -> Option<Echo> {
        match self {
            EchoLine::Fallen(rise, fall) => Some(Echo::Pulse(fall.since(rise))),
            EchoLine::Risen(at) if passed(at, now, REACH_US) => Some(Echo::Clear),
            EchoLine::Pinged(at) if passed(at, now, RISE_US) => Some(Echo::Silent),
            EchoLine::Idle | EchoLine::Pinged(_) | EchoLine::Risen(_) => None,
        }
    }
}

/// Whether this much time lies between `from` and `now`; `from` may be after the tick.
fn passed(from: Micros, now: Micros, us: u32) -> bool {
    let since_us = now.since(from);
    since_us >= us && since_us < u32::MAX / 2
}

/// The sonars with a pending answer: a late ping may be answered after the next one has left.
#[derive(Clone, Copy, Debug, Default)]
pub struct EchoLatch {
    waiting: [bool; 3],
}

impl EchoLatch {
    /// A ping has been requested.
    pub fn asked(&mut self, sonar: SonarId) {
        self.waiting[sonar as usize] = true;
    }

    /// An answer that is decided at the tick `now`, once.
    pub fn read(
        &mut self,
        now: Micros,
        line: impl Fn(SonarId) -> EchoLine<Micros>,
    ) -> Option<(SonarId, Echo)> {
        for &sonar in &SonarId::ALL {
            let waiting = &mut self.waiting[sonar as usize];
            if *waiting && let Some(echo) = line(sonar).echo(now) {
                *waiting = false;
                return Some((sonar, echo));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stamp_is_at_most_4_ms_after_its_tick_or_else_before_it() {
        let (tick, now) = (Stamp(65_000), Micros(1_000_000));
        let at = |counts: u16| Stamp(tick.0.wrapping_add(counts)).micros(tick, now).0;
        assert_eq!([at(0), at(1), at(8_000)], [1_000_000, 1_000_000, 1_004_000]);
        // The timer wraps between the two.
        assert_eq!([at(8_001), at(u16::MAX)], [971_233, 1_000_000]);
        assert!(Stamp(465).is_after(tick) && !tick.is_after(Stamp(465)));
    }

    #[test]
    fn the_time_of_a_motor_turn_spans_eight_edges() {
        let mut counter = EdgeCounter::default();
        for n in 0..9 {
            counter.edge(Micros(1_000 + n * 700 + (n % 2) * 50));
        }
        let expected = Edges {
            count: 9,
            last: Micros(6_600),
            turn_us: 5_600,
        };
        assert_eq!(counter.edges(), expected);
    }

    #[test]
    fn edges_without_stamps_count_and_the_time_of_a_turn_begins_again() {
        let mut counter = EdgeCounter::default();
        (0..20).for_each(|n| counter.edge(Micros(n * 700)));
        counter.unstamped(3);
        assert_eq!((counter.edges().count, counter.edges().turn_us), (23, 0));
        (0..8).for_each(|n| counter.edge(Micros(30_000 + n * 500)));
        assert_eq!(counter.edges().turn_us, 0);
        counter.edge(Micros(34_000));
        assert_eq!(
            (counter.edges().count, counter.edges().turn_us),
            (32, 4_000)
        );
    }

    /// The answer at `now_us` of a sonar that was pinged.
    fn answer(line: EchoLine<Micros>, now_us: u32) -> Option<Echo> {
        let mut latch = EchoLatch::default();
        latch.asked(SonarId::Front);
        let answer = latch.read(Micros(now_us), |_| line);
        if answer.is_some() {
            assert_eq!(latch.read(Micros(now_us), |_| line), None, "once");
        }
        answer.map(|(_, echo)| echo)
    }

    #[test]
    fn a_ping_is_answered_once_by_a_pulse_clear_or_silence() {
        // Across the wrap of the clock.
        let sent = Micros(u32::MAX - 1_000);
        let at = |us: u32| sent.after(us).0;
        let mut line = EchoLine::Pinged(sent);
        assert_eq!(answer(EchoLine::Idle, at(30_000)), None);
        assert_eq!(answer(line, at(4_999)), None);
        assert_eq!(answer(line, at(5_000)), Some(Echo::Silent));
        line.edge(true, sent.after(450));
        assert_eq!(answer(line, at(15_049)), None);
        assert_eq!(answer(line, at(15_050)), Some(Echo::Clear));
        line.edge(false, sent.after(3_450));
        assert_eq!(answer(line, at(7_000)), Some(Echo::Pulse(3_000)));
    }

    #[test]
    fn a_ping_that_leaves_after_the_tick_is_not_silent() {
        let line = EchoLine::Pinged(Micros(13_000));
        assert_eq!(answer(line, 10_000), None);
    }

    #[test]
    fn the_first_rise_after_a_ping_counts_and_the_fall_after_it() {
        let (mut line, mut idle) = (EchoLine::Pinged(0), EchoLine::Idle);
        for (high, at) in [
            (false, 1),
            (true, 2),
            (true, 3),
            (false, 5),
            (true, 8),
            (false, 9),
        ] {
            line.edge(high, at);
            idle.edge(high, at);
        }
        assert_eq!((line, idle), (EchoLine::Fallen(2, 5), EchoLine::Idle));
    }

    #[test]
    fn a_sonar_that_answers_late_does_so_beside_the_next_one() {
        let mut latch = EchoLatch::default();
        latch.asked(SonarId::Left);
        latch.asked(SonarId::Right);
        let lines = |sonar| match sonar {
            SonarId::Left => EchoLine::Risen(Micros(0)),
            _ => EchoLine::Fallen(Micros(1_000), Micros(2_000)),
        };
        let pulse = Some((SonarId::Right, Echo::Pulse(1_000)));
        assert_eq!(latch.read(Micros(10_000), lines), pulse);
        let clear = Some((SonarId::Left, Echo::Clear));
        assert_eq!(latch.read(Micros(20_000), lines), clear);
    }
}
