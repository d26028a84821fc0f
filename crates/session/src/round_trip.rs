//! The round trip of a command and the time-out that follows from it, after RFC 6298.

/// Time-out before a round trip was measured \[us\]: two telemetry frames and the command at 9600 baud, doubled.
pub(crate) const FIRST_TIMEOUT_US: u64 = 200_000;
/// Shortest time-out \[us\]: a telemetry frame at 9600 baud lasts 31 ms, and one may precede both command and answer.
const SHORTEST_TIMEOUT_US: u64 = 80_000;
/// Longest time-out \[us\].
pub(crate) const LONGEST_TIMEOUT_US: u64 = 1_000_000;

/// Round trip and its time-out.
#[derive(Debug, Default)]
pub(crate) struct RoundTrip {
    /// Smoothed round trip \[us\], `None` before the first.
    pub(crate) smoothed_us: Option<u64>,
    deviation_us: u64,
    /// The shortest so far \[us\].
    shortest_us: Option<u64>,
}

impl RoundTrip {
    /// A command was acknowledged after `sample_us`, and had been sent once.
    pub(crate) fn measured(&mut self, sample_us: u64) {
        let shortest_us = self.shortest_us.unwrap_or(u64::MAX);
        self.shortest_us = Some(shortest_us.min(sample_us));
        match self.smoothed_us {
            None => {
                self.smoothed_us = Some(sample_us);
                self.deviation_us = sample_us / 2;
            }
            Some(smoothed_us) => {
                self.deviation_us = (3 * self.deviation_us + smoothed_us.abs_diff(sample_us)) / 4;
                self.smoothed_us = Some((7 * smoothed_us + sample_us) / 8);
            }
        }
    }

    /// About the time that a frame needs at least in one direction \[us\]; 0 before it is known.
    pub(crate) fn way_us(&self) -> u64 {
        self.shortest_us.unwrap_or_default() / 2
    }

    /// Time after which a command without an answer is repeated \[us\].
    pub(crate) fn timeout_us(&self) -> u64 {
        let estimate_us = self.smoothed_us.map_or(FIRST_TIMEOUT_US, |smoothed| {
            smoothed + 4 * self.deviation_us
        });
        estimate_us.clamp(SHORTEST_TIMEOUT_US, LONGEST_TIMEOUT_US)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_timeout_follows_the_round_trip_within_its_limits() {
        let mut round_trip = RoundTrip::default();
        assert_eq!(round_trip.timeout_us(), FIRST_TIMEOUT_US);
        (0..50).for_each(|_| round_trip.measured(120_000));
        assert!((120_000..140_000).contains(&round_trip.timeout_us()));
        (0..50).for_each(|_| round_trip.measured(1_000));
        assert_eq!(round_trip.timeout_us(), SHORTEST_TIMEOUT_US);
        (0..50).for_each(|_| round_trip.measured(60_000_000));
        assert_eq!(round_trip.timeout_us(), LONGEST_TIMEOUT_US);
    }
}
