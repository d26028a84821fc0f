//! Wires between sensors and board that fail in the middle of a run: cut, shorted, loose, or picking up noise.

use crate::source;
use rumbo_control::SonarId;
use rumbo_plant::drivetrain::Side;
use rumbo_plant::encoder::Channel;
use rumbo_plant::noise::Noise;
use rumbo_plant::plant::Event;

/// Length of a pulse of noise [us].
const PULSE_US: u64 = 20;

/// A wire from a sensor to the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// From the Hall sensor of a wheel.
    Encoder(Side),
    /// From a sonar's echo pin.
    Echo(SonarId),
}

impl Wire {
    /// All of them, with the names of their signals in a wiring.
    pub const ALL: [(&'static str, Wire); 5] = [
        ("left_encoder", Wire::Encoder(Side::Left)),
        ("right_encoder", Wire::Encoder(Side::Right)),
        ("left_echo", Wire::Echo(SonarId::Left)),
        ("right_echo", Wire::Echo(SonarId::Right)),
        ("front_echo", Wire::Echo(SonarId::Front)),
    ];

    /// The wire that an event of the plant is an edge on, and its level from then on.
    pub(crate) fn of(event: &Event) -> Option<(Wire, bool)> {
        let echo = |sonar: rumbo_plant::sonar::SonarId| {
            SonarId::ALL.get(sonar.index()).copied().map(Wire::Echo)
        };
        match *event {
            Event::Edge {
                channel: Channel::B,
                ..
            } => None,
            Event::Edge { wheel, level, .. } => Some((Wire::Encoder(wheel), level)),
            Event::EchoRise { sonar, .. } => Some((echo(sonar)?, true)),
            Event::EchoFall { sonar, .. } => Some((echo(sonar)?, false)),
            Event::Contact { .. } => None,
        }
    }

    /// An edge on it.
    pub(crate) fn edge(self, at_us: u64, level: bool) -> Event {
        use rumbo_plant::sonar::SonarId as Plants;
        match (self, level) {
            (Wire::Encoder(wheel), level) => Event::Edge {
                wheel,
                channel: Channel::A,
                at_us,
                level,
            },
            (Wire::Echo(sonar), true) => Event::EchoRise {
                sonar: Plants::ALL[sonar as usize],
                at_us,
            },
            (Wire::Echo(sonar), false) => Event::EchoFall {
                sonar: Plants::ALL[sonar as usize],
                at_us,
            },
        }
    }

    fn source(self) -> u32 {
        let index = Wire::ALL.iter().position(|(_, wire)| *wire == self);
        source::WIRES + 2 * index.unwrap_or(0) as u32
    }
}

/// How a wire fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WireFault {
    /// It stays low: cut, or shorted to ground.
    Low,
    /// It stays high: shorted to the supply.
    High,
    /// This share of its edges does not arrive, 0 to 1.
    Losing(f64),
    /// So many short pulses a second arrive besides its edges [Hz].
    Noisy(f64),
}

/// One wire's fault and when it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedWireFault {
    /// Time since the start [s].
    pub at_s: f64,
    /// Which wire.
    pub wire: Wire,
    /// What happens to it.
    pub fault: WireFault,
}

impl TimedWireFault {
    fn begins_us(&self) -> u64 {
        (self.at_s * 1e6) as u64
    }
}

/// The faults of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct WireFaults {
    faults: Vec<TimedWireFault>,
    edges: u64,
}

impl WireFaults {
    pub(crate) fn add(&mut self, fault: TimedWireFault) {
        self.faults.push(fault);
    }

    /// Whether there are any.
    pub(crate) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    fn now(&self, wire: Wire, now_us: u64) -> Option<WireFault> {
        let mut begun = self.faults.iter().rev();
        begun
            .find(|timed| timed.wire == wire && timed.begins_us() <= now_us)
            .map(|timed| timed.fault)
    }

    /// Whether an edge at the sensor arrives at the board.
    pub(crate) fn passes(&mut self, noise: &Noise, wire: Wire, at_us: u64) -> bool {
        match self.now(wire, at_us) {
            None | Some(WireFault::Noisy(_)) => true,
            Some(WireFault::Low | WireFault::High) => false,
            Some(WireFault::Losing(share)) => {
                self.edges += 1;
                !noise.chance(wire.source(), self.edges, share)
            }
        }
    }

    /// The wires that get stuck in `[from_us, to_us)`, and at which level.
    pub(crate) fn stuck(
        &self,
        from_us: u64,
        to_us: u64,
    ) -> impl Iterator<Item = (u64, Wire, bool)> {
        self.faults.iter().filter_map(move |timed| {
            let at_us = timed.begins_us();
            let level = match timed.fault {
                WireFault::Low => false,
                WireFault::High => true,
                WireFault::Losing(_) | WireFault::Noisy(_) => return None,
            };
            (from_us..to_us)
                .contains(&at_us)
                .then_some((at_us, timed.wire, level))
        })
    }

    /// The pulses of noise in a millisecond that begins at `from_us`: when each begins and ends.
    pub(crate) fn pulses(&self, noise: &Noise, from_us: u64) -> Vec<(u64, u64, Wire)> {
        let mut pulses = Vec::new();
        for timed in &self.faults {
            let Some(WireFault::Noisy(rate_hz)) = self.now(timed.wire, from_us) else {
                continue;
            };
            let source = timed.wire.source();
            let count = rate_hz * 1e-3;
            let more = noise.chance(source, from_us, count.fract());
            let count = count as u64 + u64::from(more);
            for n in 0..count {
                let room_us = 1_000 / count;
                let free_us = room_us.saturating_sub(2 * PULSE_US) as f64;
                let within_us = noise.uniform(source + 1, from_us + n) * free_us;
                let at_us = from_us + n * room_us + within_us as u64;
                pulses.push((at_us, at_us + PULSE_US, timed.wire));
            }
        }
        pulses
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(fault: WireFault) -> WireFaults {
        let mut faults = WireFaults::default();
        faults.add(TimedWireFault {
            at_s: 1.0,
            wire: Wire::Encoder(Side::Left),
            fault,
        });
        faults
    }

    /// Of 1,000 edges on this wire a millisecond apart, those that arrive.
    fn arrived(fault: WireFault, wire: Wire) -> Vec<u64> {
        let (mut faults, noise) = (with(fault), Noise::new(1, 0));
        let times = (500..1_500).map(|ms| ms * 1_000);
        times
            .filter(|at_us| faults.passes(&noise, wire, *at_us))
            .collect()
    }

    #[test]
    fn a_stuck_wire_passes_no_edge_from_its_time_on_and_the_others_all() {
        let left = Wire::Encoder(Side::Left);
        assert_eq!(arrived(WireFault::Low, left).len(), 500);
        assert_eq!(arrived(WireFault::High, left).last(), Some(&999_000));
        assert_eq!(
            arrived(WireFault::High, Wire::Echo(SonarId::Left)).len(),
            1_000
        );
        let stuck: Vec<_> = with(WireFault::High).stuck(0, 2_000_000).collect();
        assert_eq!(stuck, [(1_000_000, left, true)]);
    }

    #[test]
    fn a_loose_wire_loses_its_share_of_edges() {
        let arrived = arrived(WireFault::Losing(0.4), Wire::Encoder(Side::Left));
        assert!(
            (270..330).contains(&(arrived.len() - 500)),
            "{}",
            arrived.len()
        );
    }

    #[test]
    fn noise_comes_at_its_rate_in_pulses_that_do_not_overlap() {
        let (faults, noise) = (with(WireFault::Noisy(2_500.0)), Noise::new(1, 0));
        let pulses: Vec<_> = (500..1_500u64)
            .flat_map(|ms| faults.pulses(&noise, ms * 1_000))
            .collect();
        assert!((1_150..1_350).contains(&pulses.len()), "{}", pulses.len());
        assert!(pulses.iter().all(|(begin, ..)| *begin >= 1_000_000));
        assert!(pulses.windows(2).all(|two| two[0].1 < two[1].0));
    }
}
