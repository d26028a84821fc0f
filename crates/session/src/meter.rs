//! The link's load: bytes per second over the last two seconds.

/// Length of one bucket \[us\].
const BUCKET_US: u64 = 250_000;
/// Buckets in the window.
const BUCKETS: usize = 8;

/// Counts bytes of one direction.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter {
    buckets: [u64; BUCKETS],
    /// The bucket being filled, counted from time 0.
    current: u64,
    started_us: Option<u64>,
}

impl Meter {
    /// `count` went by at `now_us`.
    pub(crate) fn add(&mut self, count: usize, now_us: u64) {
        self.started_us.get_or_insert(now_us);
        self.turn_to(now_us);
        self.buckets[self.current as usize % BUCKETS] += count as u64;
    }

    /// Rate over the window, or since the first count when that is shorter [1/s].
    pub(crate) fn per_second(&mut self, now_us: u64) -> f64 {
        self.turn_to(now_us);
        let window_start_us = (self.current + 1).saturating_sub(BUCKETS as u64) * BUCKET_US;
        let from_us = window_start_us.max(self.started_us.unwrap_or(now_us));
        let span_us = now_us.saturating_sub(from_us).max(BUCKET_US);
        self.buckets.iter().sum::<u64>() as f64 * 1e6 / span_us as f64
    }

    /// Empties the buckets that have expired.
    fn turn_to(&mut self, now_us: u64) {
        let bucket = now_us / BUCKET_US;
        let passed = bucket.saturating_sub(self.current).min(BUCKETS as u64);
        for later in 1..=passed {
            self.buckets[(self.current + later) as usize % BUCKETS] = 0;
        }
        if passed == BUCKETS as u64 {
            self.buckets = [0; BUCKETS];
        }
        self.current = self.current.max(bucket);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_stream_is_measured_and_silence_falls_to_zero() {
        let mut meter = Meter::default();
        for millisecond in 0..5_000u64 {
            meter.add(1, millisecond * 1_000);
        }
        let rate = meter.per_second(5_000_000);
        assert!((rate - 1_000.0).abs() < 20.0, "{rate}");
        assert_eq!(meter.per_second(8_000_000), 0.0);
    }

    #[test]
    fn the_first_bytes_are_no_burst() {
        let mut meter = Meter::default();
        meter.add(30, 1_000);
        assert_eq!(meter.per_second(2_000), 120.0);
        meter.add(30, 501_000);
        assert_eq!(meter.per_second(501_000), 120.0);
    }
}
