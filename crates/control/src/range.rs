//! Ranges from echoes: what a sonar's answer means, and a filter that knows how far the robot rolled in between.
//! Theory: docs/theory/sonar.md.
//!
//! echo -> distance, *clear* or *faulty* -> median of three -> gate on the innovation -> two states: the distance, and the rate at
//! which odometry misjudges its change (slip, a wheel's radius, the speed of sound).

use crate::math::{abs, clamp, from_u32, max, min};
use crate::types::{AgedRange, Echo, Micros, Range, TICK_S};

/// Shortest distance an HC-SR04 can measure [m]; less is impossible.
pub const MIN_RANGE_M: f32 = 0.02;
/// Reach used [m].
pub const REACH_M: f32 = 2.5;
/// Innovation that is always believed [m], plus [`GATE_SHARE`] of the distance.
const GATE_M: f32 = 0.02;
/// Share of the distance that the gate adds.
const GATE_SHARE: f32 = 0.03;
/// Refused readings that agree with each other and in the end are believed: the world has changed.
const GIVE_IN: u8 = 5;
/// Impossible answers in a row that make the sonar faulty.
const FAULTY_AFTER: u8 = 3;
/// Answers without an echo in a row that make the road clear.
const CLEAR_AFTER: u8 = 3;
/// Answers in a row that are the same to the microsecond: echoes of a sonar on the move differ by some, so it is stuck.
const STUCK_AFTER: u8 = 8;
/// Way in which they must have come [m].
const STUCK_WAY_M: f32 = 0.03;
/// The same answer so often is enough when the robot has come this much nearer meanwhile by its encoders [m].
const STUCK_SOON: (u8, f32) = (3, 0.04);
/// Gain on the distance at close range, where readings err by a millimetre.
const GAIN_NEAR: f32 = 0.45;
/// Gain on the distance at 1 m and beyond, where they err by centimetres.
const GAIN_FAR: f32 = 0.15;
/// Gain on the rate [1/s].
const GAIN_RATE: f32 = 0.4;
/// Largest rate that odometry's misjudgement explains [m/s].
const RATE_LIMIT_M_S: f32 = 0.03;

/// What one answer means: distance [m] for a sound of `sound_m_s`, clear or faulty.
pub fn range_from_echo(echo: Echo, sound_m_s: f32) -> Range {
    match echo {
        Echo::Clear => Range::Clear,
        Echo::Silent => Range::Faulty,
        Echo::Pulse(us) => {
            let range_m = 0.5 * sound_m_s * (from_u32(us) * 1e-6);
            if range_m < 0.9 * MIN_RANGE_M {
                Range::Faulty
            } else if range_m > REACH_M {
                Range::Clear
            } else {
                Range::Valid(range_m)
            }
        }
    }
}

/// Memory of one sonar's filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeFilter {
    /// The last three distances, moved along with the robot.
    recent_m: [f32; 3],
    count: u8,
    distance_m: f32,
    rate_m_s: f32,
    refused: u8,
    clear: u8,
    faulty: u8,
    /// The last distance answered, as it was, how often it came again, and the way of the sonar since it first came: on the floor, and
    /// towards what it sees.
    last_m: f32,
    repeated: u8,
    way_m: f32,
    closer_m: f32,
    range: Range,
    updated: Micros,
    ever: bool,
}

impl RangeFilter {
    /// Moves the estimate along: the robot came `closer_m` nearer since the last tick.
    pub fn predict(&mut self, closer_m: f32) {
        for recent in &mut self.recent_m {
            *recent -= closer_m;
        }
        self.closer_m = clamp(self.closer_m + closer_m, -1.0, 1.0);
        if let Range::Valid(_) = self.range {
            self.distance_m = max(self.distance_m - closer_m + self.rate_m_s * TICK_S, 0.0);
            self.range = Range::Valid(self.distance_m);
        }
    }

    /// The sonar has moved so far over the floor since the last tick, in whichever direction.
    pub fn moved(&mut self, way_m: f32) {
        self.way_m = min(self.way_m + way_m, 2.0 * STUCK_WAY_M);
    }

    /// Whether the same distance has come so often, although the sonar moved, that it is stuck.
    fn is_stuck(&mut self, range_m: f32) -> bool {
        if range_m == self.last_m {
            self.repeated = self.repeated.saturating_add(1);
        } else {
            (self.last_m, self.repeated, self.way_m, self.closer_m) = (range_m, 0, 0.0, 0.0);
        }
        let (soon, closer_m) = STUCK_SOON;
        (self.repeated >= STUCK_AFTER && self.way_m >= STUCK_WAY_M)
            || (self.repeated >= soon && abs(self.closer_m) >= closer_m)
    }

    /// Takes an answer of the sonar.
    pub fn take(&mut self, reading: Range, now: Micros) {
        match reading {
            Range::Faulty => {
                self.faulty = self.faulty.saturating_add(1);
                if self.faulty >= FAULTY_AFTER {
                    self.declare(Range::Faulty, now);
                }
            }
            Range::Clear => {
                self.clear = self.clear.saturating_add(1);
                if self.clear >= CLEAR_AFTER {
                    self.declare(Range::Clear, now);
                }
            }
            Range::Valid(range_m) => {
                if self.is_stuck(range_m) {
                    self.declare(Range::Faulty, now);
                    return;
                }
                self.clear = 0;
                self.faulty = 0;
                self.take_distance(range_m, now);
            }
        }
    }

    /// The range and its age.
    pub fn range(&self, now: Micros) -> AgedRange {
        if !self.ever {
            return AgedRange::default();
        }
        AgedRange {
            range: self.range,
            age_s: from_u32(now.since(self.updated)) * 1e-6,
        }
    }

    /// Keeps the age from wrapping with the clock: an age beyond half an hour stays there. To be called at every tick.
    pub fn hold_age(&mut self, now: Micros) {
        const OLDEST_US: u32 = 1_800_000_000;
        if now.since(self.updated) > OLDEST_US {
            self.updated = Micros(now.0.wrapping_sub(OLDEST_US));
        }
    }

    fn declare(&mut self, range: Range, now: Micros) {
        self.range = range;
        self.updated = now;
        self.ever = true;
        self.count = 0;
        self.refused = 0;
        self.rate_m_s = 0.0;
    }

    fn take_distance(&mut self, range_m: f32, now: Micros) {
        let [_, b, c] = self.recent_m;
        self.recent_m = [b, c, range_m];
        if self.count < 3 {
            self.count += 1;
        }
        if self.count < 3 {
            return;
        }
        let middle_m = max(median(self.recent_m), 0.0);
        let Range::Valid(_) = self.range else {
            self.declare(Range::Valid(middle_m), now);
            self.count = 3;
            self.distance_m = middle_m;
            return;
        };
        let innovation_m = middle_m - self.distance_m;
        let gate_m = GATE_M + GATE_SHARE * self.distance_m;
        if abs(innovation_m) > gate_m {
            self.refused += 1;
            if self.refused >= GIVE_IN && spread(self.recent_m) < 2.0 * gate_m {
                self.declare(Range::Valid(middle_m), now);
                self.count = 3;
                self.distance_m = middle_m;
            }
            return;
        }
        self.refused = 0;
        let far = clamp((self.distance_m - 0.4) / 0.6, 0.0, 1.0);
        let gain = GAIN_NEAR + (GAIN_FAR - GAIN_NEAR) * far;
        self.distance_m = max(self.distance_m + gain * innovation_m, 0.0);
        let rate = self.rate_m_s + gain * GAIN_RATE * innovation_m;
        self.rate_m_s = clamp(rate, -RATE_LIMIT_M_S, RATE_LIMIT_M_S);
        self.range = Range::Valid(self.distance_m);
        self.updated = now;
    }
}

fn median([a, b, c]: [f32; 3]) -> f32 {
    max(min(a, b), min(max(a, b), c))
}

fn spread([a, b, c]: [f32; 3]) -> f32 {
    max(max(a, b), c) - min(min(a, b), c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fed(readings: &[Range]) -> (RangeFilter, Micros) {
        let (mut filter, mut now) = (RangeFilter::default(), Micros(0));
        for reading in readings {
            now = now.after(60_000);
            filter.take(*reading, now);
        }
        (filter, now)
    }

    fn distance(filter: &RangeFilter, now: Micros) -> f32 {
        match filter.range(now).range {
            Range::Valid(range_m) => range_m,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_pulse_of_5831_us_is_a_metre_at_20_degrees() {
        match range_from_echo(Echo::Pulse(5_831), 343.0) {
            Range::Valid(range_m) => assert!((range_m - 1.0).abs() < 1e-4),
            other => panic!("{other:?}"),
        }
        assert_eq!(range_from_echo(Echo::Pulse(38_000), 343.0), Range::Clear);
        assert_eq!(range_from_echo(Echo::Pulse(3), 343.0), Range::Faulty);
        assert_eq!(range_from_echo(Echo::Silent, 343.0), Range::Faulty);
    }

    #[test]
    fn a_single_spike_does_not_move_the_estimate() {
        let (mut filter, now) = fed(&[Range::Valid(0.5); 10]);
        filter.take(Range::Valid(0.05), now.after(60_000));
        assert!((distance(&filter, now) - 0.5).abs() < 1e-4);
    }

    #[test]
    fn a_lost_echo_is_not_a_short_range_and_three_are_a_clear_road() {
        let (mut filter, now) = fed(&[Range::Valid(0.5); 10]);
        filter.take(Range::Clear, now.after(60_000));
        assert!((distance(&filter, now) - 0.5).abs() < 1e-4);
        filter.take(Range::Clear, now.after(120_000));
        filter.take(Range::Clear, now.after(180_000));
        assert_eq!(filter.range(now.after(180_000)).range, Range::Clear);
    }

    #[test]
    fn a_silent_line_becomes_faulty_and_a_good_one_recovers() {
        let (mut filter, now) = fed(&[
            Range::Valid(0.5),
            Range::Valid(0.5),
            Range::Valid(0.5),
            Range::Faulty,
            Range::Faulty,
        ]);
        assert!(matches!(filter.range(now).range, Range::Valid(_)));
        filter.take(Range::Faulty, now);
        assert_eq!(filter.range(now).range, Range::Faulty);
        for _ in 0..3 {
            filter.take(Range::Valid(0.8), now);
        }
        assert!((distance(&filter, now) - 0.8).abs() < 1e-6);
    }

    #[test]
    fn the_same_answer_for_ever_is_a_stuck_sonar_if_the_robot_moves_and_a_wall_if_it_stands() {
        let (mut filter, mut now) = fed(&[Range::Valid(0.5); 30]);
        assert!((distance(&filter, now) - 0.5).abs() < 1e-6);
        for _ in 0..=STUCK_AFTER {
            filter.moved(0.01);
            now = now.after(60_000);
            filter.take(Range::Valid(0.5), now);
        }
        assert_eq!(filter.range(now).range, Range::Faulty);
        for step in 0..20u8 {
            filter.moved(0.01);
            now = now.after(60_000);
            filter.take(Range::Valid(0.5 + 2e-4 * f32::from(step)), now);
        }
        assert!((distance(&filter, now) - 0.5).abs() < 0.01);
    }

    #[test]
    fn the_same_answer_while_the_wall_comes_nearer_is_a_stuck_sonar_at_once() {
        let (mut filter, mut now) = fed(&[Range::Valid(1.5), Range::Valid(1.5), Range::Valid(1.0)]);
        for _ in 0..3 {
            filter.predict(0.02);
            now = now.after(60_000);
            filter.take(Range::Valid(1.0), now);
        }
        assert_eq!(filter.range(now).range, Range::Faulty);
    }

    #[test]
    fn a_world_that_changed_is_believed_in_the_end() {
        let (mut filter, mut now) = fed(&[Range::Valid(0.5); 10]);
        for _ in 0..7 {
            now = now.after(60_000);
            filter.take(Range::Valid(1.4), now);
        }
        assert!((distance(&filter, now) - 1.4).abs() < 0.01);
    }

    #[test]
    fn the_estimate_has_no_lag_while_the_robot_drives() {
        let (mut filter, mut now, mut truth) = (RangeFilter::default(), Micros(0), 1.5f32);
        for tick in 1..250u32 {
            now = now.after(10_000);
            truth -= 0.4 * TICK_S;
            filter.predict(0.4 * TICK_S);
            if tick % 6 == 0 {
                filter.take(Range::Valid(truth), now);
            }
            if tick > 30 {
                assert!((distance(&filter, now) - truth).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn nothing_read_yet_is_faulty_and_infinitely_old() {
        assert_eq!(
            RangeFilter::default().range(Micros(5)),
            AgedRange::default()
        );
    }

    #[test]
    fn an_old_reading_stays_old_when_the_clock_wraps() {
        let (mut filter, mut now) = fed(&[Range::Valid(0.5); 3]);
        for _ in 0..4 {
            now = now.after(1_700_000_000);
            filter.hold_age(now);
            assert!(filter.range(now).age_s > 1_000.0);
        }
    }

    proptest! {
        #[test]
        fn any_stream_of_answers_leaves_a_finite_distance(answers in prop::collection::vec((0u8..4, any::<u32>(), -0.1f32..0.1), 1..200)) {
            let mut filter = RangeFilter::default();
            for (kind, us, closer_m) in answers {
                let echo = match kind { 0 => Echo::Clear, 1 => Echo::Silent, 2 => Echo::Pulse(us), _ => Echo::Pulse(us % 20_000) };
                filter.predict(closer_m);
                filter.take(range_from_echo(echo, 343.0), Micros(us));
                if let Range::Valid(range_m) = filter.range(Micros(us)).range {
                    prop_assert!(range_m.is_finite() && range_m >= 0.0);
                }
            }
        }
    }
}
