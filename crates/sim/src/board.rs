//! The native stand-in for the Mega's interrupt routines: latches edges and echoes between ticks.

use rumbo_control::{Echo, Edges, Micros, SonarId, Wheels};
use rumbo_plant::drivetrain::Side;
use rumbo_plant::plant::Event;

/// Edges per motor turn.
const POLES: usize = 8;
/// The echo line must have risen by this time after the trigger, or the sonar is silent [us].
const RISE_US: u64 = 5_000;
/// An echo line that is still high after this time has nothing within reach to say [us]: 2.65 m.
const REACH_US: u64 = 14_600;

/// One encoder's interrupt.
#[derive(Clone, Copy, Debug, Default)]
struct Counter {
    edges: Edges,
    poles: [Micros; POLES],
    seen: u8,
}

impl Counter {
    fn edge(&mut self, at: Micros) {
        self.edges.count = self.edges.count.wrapping_add(1);
        let pole = &mut self.poles[usize::from(self.edges.count) % POLES];
        if usize::from(self.seen) < POLES {
            self.seen += 1;
        } else {
            self.edges.turn_us = at.since(*pole);
        }
        *pole = at;
        self.edges.last = at;
    }
}

/// The ping that is waited for.
#[derive(Clone, Copy, Debug)]
struct Ping {
    sonar: SonarId,
    at_us: u64,
    rise_us: Option<u64>,
    width_us: Option<u64>,
}

/// What the interrupts have latched.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Board {
    counters: Wheels<Counter>,
    ping: Option<Ping>,
}

impl Board {
    /// An edge on one of the input pins.
    pub(crate) fn take(&mut self, event: Event) {
        match event {
            Event::Edge { wheel, at_us, .. } => {
                let counter = match wheel {
                    Side::Left => &mut self.counters.left,
                    Side::Right => &mut self.counters.right,
                };
                counter.edge(micros(at_us));
            }
            Event::EchoRise { sonar, at_us } => {
                if let Some(ping) = self.ping_of(sonar) {
                    ping.rise_us = Some(at_us);
                }
            }
            Event::EchoFall { sonar, at_us } => {
                if let Some(ping) = self.ping_of(sonar)
                    && let Some(rise_us) = ping.rise_us
                {
                    ping.width_us = Some(at_us - rise_us);
                }
            }
            Event::Contact { .. } => {}
        }
    }

    fn ping_of(&mut self, sonar: rumbo_plant::sonar::SonarId) -> Option<&mut Ping> {
        self.ping
            .as_mut()
            .filter(|ping| ping.sonar as usize == sonar.index())
    }

    /// A sonar has been triggered.
    pub(crate) fn pinged(&mut self, sonar: SonarId, at_us: u64) {
        self.ping = Some(Ping {
            sonar,
            at_us,
            rise_us: None,
            width_us: None,
        });
    }

    /// Both encoders, as they stand.
    pub(crate) fn encoders(&self) -> Wheels<Edges> {
        self.counters.map(|counter| counter.edges)
    }

    /// What became of the last ping, once.
    pub(crate) fn echo(&mut self, now_us: u64) -> Option<(SonarId, Echo)> {
        let ping = self.ping?;
        let echo = match (ping.width_us, ping.rise_us) {
            (Some(width_us), _) => Echo::Pulse(u32::try_from(width_us).unwrap_or(u32::MAX)),
            (None, Some(rise_us)) if now_us - rise_us >= REACH_US => Echo::Clear,
            (None, None) if now_us - ping.at_us >= RISE_US => Echo::Silent,
            (None, _) => return None,
        };
        self.ping = None;
        Some((ping.sonar, echo))
    }
}

/// Simulated time as the robot's wrapping clock shows it.
pub(crate) fn micros(us: u64) -> Micros {
    Micros((us & u64::from(u32::MAX)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(at_us: u64) -> Event {
        Event::Edge {
            wheel: Side::Left,
            at_us,
            level: true,
        }
    }

    #[test]
    fn the_time_of_a_motor_turn_spans_eight_edges() {
        let mut board = Board::default();
        for n in 0..9 {
            board.take(edge(1_000 + n * 700 + (n % 2) * 50));
        }
        let edges = board.encoders().left;
        assert_eq!(
            (edges.count, edges.last, edges.turn_us),
            (9, Micros(6_600), 5_600)
        );
        assert_eq!(board.encoders().right, Edges::default());
    }

    #[test]
    fn a_ping_is_answered_once_by_a_pulse_clear_or_silence() {
        use rumbo_plant::sonar::SonarId as Plants;
        let mut board = Board::default();
        board.pinged(SonarId::Front, 0);
        assert_eq!(board.echo(4_000), None);
        assert_eq!(board.echo(5_000), Some((SonarId::Front, Echo::Silent)));
        board.pinged(SonarId::Front, 10_000);
        board.take(Event::EchoRise {
            sonar: Plants::Front,
            at_us: 10_450,
        });
        board.take(Event::EchoFall {
            sonar: Plants::Left,
            at_us: 11_000,
        });
        assert_eq!(board.echo(20_000), None);
        assert_eq!(board.echo(26_000), Some((SonarId::Front, Echo::Clear)));
        board.pinged(SonarId::Left, 40_000);
        board.take(Event::EchoRise {
            sonar: Plants::Left,
            at_us: 40_450,
        });
        board.take(Event::EchoFall {
            sonar: Plants::Left,
            at_us: 43_450,
        });
        assert_eq!(
            board.echo(50_000),
            Some((SonarId::Left, Echo::Pulse(3_000)))
        );
        assert_eq!(board.echo(60_000), None);
    }
}
