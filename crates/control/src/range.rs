//! Ranges from echoes: decoding of a sonar's answer, and a filter that uses the distance rolled in between.
//! Theory: docs/theory/sonar.md.
//!
//! echo -> distance, *clear* or *faulty* -> median of three -> gate on the innovation -> two states: the distance, and
//! the error rate of odometry's prediction (slip, a wheel's radius, the speed of sound).

use crate::math::{abs, clamp, from_u32, max, min};
use crate::stuck::Stuck;
use crate::types::{AgedRange, Echo, Range, TICK_S};

/// Shortest distance an HC-SR04 can measure [m]; less is impossible.
pub const MIN_RANGE_M: f32 = 0.02;
/// Largest range used [m].
pub const REACH_M: f32 = 2.5;
/// Innovation that is always accepted [m], plus [`GATE_SHARE`] of the distance.
const GATE_M: f32 = 0.02;
/// Share of the distance that the gate adds.
const GATE_SHARE: f32 = 0.03;
/// Rejected readings that agree with each other, after which they are accepted: the world has changed.
const GIVE_IN: u8 = 5;
/// Impossible answers in a row that make the sonar faulty.
const FAULTY_AFTER: u8 = 3;
/// Answers without an echo in a row that make the range clear.
const CLEAR_AFTER: u8 = 3;
/// Edges of both wheels between two answers of a robot that moves: 2 mm of the original's wheels.
const MOVED_EDGES: u16 = 8;
/// Gain on the distance at close range, where readings err by a millimetre.
const GAIN_NEAR: f32 = 0.45;
/// Gain on the distance at 1 m and beyond, where they err by centimetres.
const GAIN_FAR: f32 = 0.15;
/// Gain on the rate [1/s].
const GAIN_RATE: f32 = 0.4;
/// Largest rate that odometry's error explains [m/s].
const RATE_LIMIT_M_S: f32 = 0.03;

/// Decodes an answer: distance [m] at a speed of sound of `sound_m_s`, clear or faulty.
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

/// State of one sonar's filter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeFilter {
    /// The last three distances, predicted to the last answer.
    recent_m: [f32; 3],
    count: u8,
    distance_m: f32,
    /// Error rate of odometry's prediction, per tick [m].
    rate_m: f32,
    /// How much nearer the sonar came, and edges of both wheels, since the last answer.
    closer_m: f32,
    edges: u16,
    refused: u8,
    clear: u8,
    faulty: u8,
    stuck: Stuck,
    /// The range and its age.
    aged: AgedRange,
}

impl RangeFilter {
    /// Predicts by one tick: the sonar came `closer_m` nearer to its target, with this many edges of both wheels.
    pub fn predict(&mut self, closer_m: f32, edges: u16) {
        self.edges = self.edges.saturating_add(edges);
        self.aged.age_ticks = self.aged.age_ticks.saturating_add(1);
        let change_m = if closer_m == 0.0 {
            self.rate_m
        } else {
            self.closer_m += closer_m;
            self.rate_m - closer_m
        };
        if let Range::Valid(range_m) = &mut self.aged.range
            && change_m != 0.0
        {
            self.distance_m = max(self.distance_m + change_m, 0.0);
            *range_m = self.distance_m;
        }
    }

    /// Predicts the stored distances to the present position.
    fn arrive(&mut self, closer_m: f32) {
        for recent in &mut self.recent_m {
            *recent -= closer_m;
        }
    }

    /// Updates with an answer of the sonar.
    pub fn update(&mut self, reading: Range) {
        let closer_m = core::mem::take(&mut self.closer_m);
        let moved = core::mem::take(&mut self.edges) >= MOVED_EDGES;
        self.arrive(closer_m);
        match reading {
            Range::Faulty => {
                self.faulty = self.faulty.saturating_add(1);
                if self.faulty >= FAULTY_AFTER {
                    self.declare(Range::Faulty);
                }
            }
            Range::Clear => {
                self.clear = self.clear.saturating_add(1);
                if self.clear >= CLEAR_AFTER {
                    self.declare(Range::Clear);
                }
            }
            Range::Valid(range_m) => {
                if self.stuck.ingest(range_m, moved, closer_m) {
                    self.declare(Range::Faulty);
                    return;
                }
                self.clear = 0;
                self.faulty = 0;
                self.update_distance(range_m);
            }
        }
    }

    /// The range and its age.
    pub fn range(&self) -> AgedRange {
        self.aged
    }

    fn declare(&mut self, range: Range) {
        self.aged = AgedRange::fresh(range);
        self.count = 0;
        self.refused = 0;
        self.rate_m = 0.0;
    }

    /// Resets the distance to `middle_m`.
    fn begin(&mut self, middle_m: f32) {
        self.declare(Range::Valid(middle_m));
        self.count = 3;
        self.distance_m = middle_m;
    }

    fn update_distance(&mut self, range_m: f32) {
        let [_, b, c] = self.recent_m;
        self.recent_m = [b, c, range_m];
        if self.count < 3 {
            self.count += 1;
        }
        if self.count < 3 {
            return;
        }
        let middle_m = max(median(self.recent_m), 0.0);
        let Range::Valid(_) = self.aged.range else {
            self.begin(middle_m);
            return;
        };
        let innovation_m = middle_m - self.distance_m;
        let gate_m = GATE_M + GATE_SHARE * self.distance_m;
        if abs(innovation_m) > gate_m {
            self.refused = self.refused.saturating_add(1);
            if self.refused >= GIVE_IN && spread(self.recent_m) < 2.0 * gate_m {
                self.begin(middle_m);
            }
            return;
        }
        self.refused = 0;
        let far = clamp((self.distance_m - 0.4) * (1.0 / 0.6), 0.0, 1.0);
        let gain = GAIN_NEAR + (GAIN_FAR - GAIN_NEAR) * far;
        self.distance_m = max(self.distance_m + gain * innovation_m, 0.0);
        let rate_m = self.rate_m + gain * (GAIN_RATE * TICK_S) * innovation_m;
        self.rate_m = clamp(rate_m, -RATE_LIMIT_M_S * TICK_S, RATE_LIMIT_M_S * TICK_S);
        self.aged = AgedRange::fresh(Range::Valid(self.distance_m));
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

    fn fed(readings: &[Range]) -> RangeFilter {
        let mut filter = RangeFilter::default();
        for reading in readings {
            filter.update(*reading);
        }
        filter
    }

    fn distance(filter: &RangeFilter) -> f32 {
        match filter.range().range {
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
        let mut filter = fed(&[Range::Valid(0.5); 10]);
        filter.update(Range::Valid(0.05));
        assert!((distance(&filter) - 0.5).abs() < 1e-4);
    }

    #[test]
    fn a_lost_echo_is_not_a_short_range_and_three_are_a_clear_road() {
        let mut filter = fed(&[Range::Valid(0.5); 10]);
        filter.update(Range::Clear);
        assert!((distance(&filter) - 0.5).abs() < 1e-4);
        filter.update(Range::Clear);
        filter.update(Range::Clear);
        assert_eq!(filter.range().range, Range::Clear);
    }

    #[test]
    fn a_silent_line_becomes_faulty_and_a_good_one_recovers() {
        let mut filter = fed(&[
            Range::Valid(0.5),
            Range::Valid(0.5),
            Range::Valid(0.5),
            Range::Faulty,
            Range::Faulty,
        ]);
        assert!(matches!(filter.range().range, Range::Valid(_)));
        filter.update(Range::Faulty);
        assert_eq!(filter.range().range, Range::Faulty);
        for _ in 0..3 {
            filter.update(Range::Valid(0.8));
        }
        assert!((distance(&filter) - 0.8).abs() < 1e-6);
    }

    #[test]
    fn the_same_answer_for_ever_is_a_stuck_sonar_if_the_robot_moves_and_a_wall_if_it_stands() {
        let mut filter = fed(&[Range::Valid(0.5); 30]);
        assert!((distance(&filter) - 0.5).abs() < 1e-6);
        for _ in 0..14 {
            filter.predict(0.0, 40);
            filter.update(Range::Valid(0.5));
        }
        assert_eq!(filter.range().range, Range::Faulty);
        for step in 0..20u8 {
            filter.predict(0.0, 40);
            filter.update(Range::Valid(0.5 + 4e-4 * f32::from(step)));
        }
        assert!((distance(&filter) - 0.5).abs() < 0.01);
    }

    #[test]
    fn the_same_answer_while_the_wall_comes_nearer_is_a_stuck_sonar_at_once() {
        let mut filter = fed(&[Range::Valid(1.5), Range::Valid(1.5), Range::Valid(1.0)]);
        for _ in 0..3 {
            filter.predict(0.02, 40);
            filter.update(Range::Valid(1.0));
        }
        assert_eq!(filter.range().range, Range::Faulty);
    }

    #[test]
    fn a_world_that_changed_is_believed_in_the_end() {
        let mut filter = fed(&[Range::Valid(0.5); 10]);
        for _ in 0..7 {
            filter.update(Range::Valid(1.4));
        }
        assert!((distance(&filter) - 1.4).abs() < 0.01);
    }

    #[test]
    fn the_estimate_has_no_lag_while_the_robot_drives() {
        let (mut filter, mut truth) = (RangeFilter::default(), 1.5f32);
        for tick in 1..250u32 {
            truth -= 0.4 * TICK_S;
            filter.predict(0.4 * TICK_S, 0);
            if tick % 6 == 0 {
                filter.update(Range::Valid(truth));
            }
            if tick > 30 {
                assert!((distance(&filter) - truth).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn nothing_read_yet_is_faulty_and_infinitely_old() {
        assert_eq!(RangeFilter::default().range(), AgedRange::default());
    }

    #[test]
    fn an_old_reading_stays_old_however_long_it_is() {
        let mut filter = fed(&[Range::Valid(0.5); 3]);
        for _ in 0..70_000 {
            filter.predict(0.0, 0);
        }
        assert!(filter.range().is_older(600.0));
    }

    proptest! {
        #[test]
        fn any_stream_of_answers_leaves_a_finite_distance(answers in prop::collection::vec((0u8..4, any::<u32>(), -0.1f32..0.1), 1..200)) {
            let mut filter = RangeFilter::default();
            for (kind, us, closer_m) in answers {
                let echo = match kind { 0 => Echo::Clear, 1 => Echo::Silent, 2 => Echo::Pulse(us), _ => Echo::Pulse(us % 20_000) };
                filter.predict(closer_m, 3);
                filter.update(range_from_echo(echo, 343.0));
                if let Range::Valid(range_m) = filter.range().range {
                    prop_assert!(range_m.is_finite() && range_m >= 0.0);
                }
            }
        }
    }
}
