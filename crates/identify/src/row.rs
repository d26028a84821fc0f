//! One row of a recorded run.

/// Longest run: the simulation is kept for each millisecond.
pub(crate) const LONGEST_MS: usize = 3_600_000;

/// One row of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LogRow {
    /// Time since the log's start, ms.
    pub at_ms: usize,
    /// Applied duty of the left and right wheel, -1 to 1; 0 is released.
    pub duty: [f64; 2],
    /// Reference of the wheels' speeds, rad/s; zero in modes without.
    pub reference_rad_s: [f64; 2],
    /// Measured speed of the left and right wheel, rad/s; zero in modes without.
    pub speed_rad_s: [f64; 2],
    /// Measured distances, columns `left_cm` and `right_cm`, m; zero in modes without.
    pub range_m: [f64; 2],
    /// Over what time the speeds of the left and right wheel were measured.
    pub window: [Window; 2],
    /// Whether the left and right wheel have too few edges for a speed, near a standstill.
    pub edgeless: [bool; 2],
}

/// The time over which a speed was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    /// Its end since the log's start, ms.
    pub end_ms: usize,
    /// Its length, ms.
    pub length_ms: usize,
}

impl LogRow {
    /// When the measurement of its speeds was complete, ms.
    #[must_use]
    pub fn measured_ms(&self) -> usize {
        self.window[0].end_ms.max(self.window[1].end_ms)
    }

    /// Whether the wheels are asked to go against each other.
    #[must_use]
    pub fn is_turning(&self) -> bool {
        self.reference_rad_s[0] * self.reference_rad_s[1] < 0.0
    }

    /// Mean of both distances, m.
    #[must_use]
    pub fn mean_m(&self) -> f64 {
        0.5 * (self.range_m[0] + self.range_m[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_are_measured_when_the_later_wheel_s_are() {
        let ends = |end_ms| Window {
            end_ms,
            length_ms: 40,
        };
        for window in [[ends(80), ends(95)], [ends(95), ends(80)]] {
            let row = LogRow {
                at_ms: 100,
                window,
                ..LogRow::default()
            };
            assert_eq!(row.measured_ms(), 95);
        }
    }
}
