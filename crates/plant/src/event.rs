//! What the plant reports while time passes, and the queue that puts it in order.

use crate::drivetrain::Side;
use crate::encoder::Channel;
use crate::sonar::SonarId;

/// What the robot's pins, or an observer, would see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// An edge of a wheel's encoder.
    Edge {
        /// Which wheel.
        wheel: Side,
        /// Which of its outputs.
        channel: Channel,
        /// When.
        at_us: u64,
        /// Level after it.
        level: bool,
    },
    /// An echo line goes high: the burst leaves.
    EchoRise {
        /// Which sonar.
        sonar: SonarId,
        /// When.
        at_us: u64,
    },
    /// An echo line goes low: an echo, or the time-out.
    EchoFall {
        /// Which sonar.
        sonar: SonarId,
        /// When.
        at_us: u64,
    },
    /// The body touches an obstacle it was clear of.
    Contact {
        /// When, to the step.
        at_us: u64,
        /// Index in [`World::obstacles`](crate::world::World::obstacles), followed by
        /// [`World::bodies`](crate::world::World::bodies).
        obstacle: usize,
        /// Closing speed of the point that touched, relative to the surface that it met.
        speed_m_s: f64,
    },
}

impl Event {
    /// When it happens.
    #[must_use]
    pub const fn at_us(&self) -> u64 {
        match *self {
            Self::Edge { at_us, .. }
            | Self::EchoRise { at_us, .. }
            | Self::EchoFall { at_us, .. }
            | Self::Contact { at_us, .. } => at_us,
        }
    }
}

/// Events of one step, sorted by time; those of the same microsecond keep their order.
pub(crate) struct Queue {
    events: [Event; Self::ROOM],
    used: usize,
}

impl Default for Queue {
    fn default() -> Self {
        let nothing = Event::EchoRise {
            sonar: SonarId::Left,
            at_us: 0,
        };
        Self {
            events: [nothing; Self::ROOM],
            used: 0,
        }
    }
}

impl Queue {
    /// The robot gives up to four edges per wheel in a step, and two per sonar. If a stranger one gives more, the
    /// first ones leave early: none is lost.
    const ROOM: usize = 24;

    pub(crate) fn put(&mut self, event: Event, events: &mut impl FnMut(Event)) {
        if self.used == Self::ROOM {
            self.flush(events);
        }
        let mut at = self.used;
        while at > 0 && self.events[at - 1].at_us() > event.at_us() {
            self.events[at] = self.events[at - 1];
            at -= 1;
        }
        self.events[at] = event;
        self.used += 1;
    }

    pub(crate) fn flush(&mut self, events: &mut impl FnMut(Event)) {
        for &event in &self.events[..self.used] {
            events(event);
        }
        self.used = 0;
    }
}
