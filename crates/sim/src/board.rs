//! The native stand-in for the Mega's interrupt routines: it leaves the stamps of edges and echoes for
//! [`rumbo_robot::latch`].

use rumbo_control::{Echo, Edges, Micros, SonarId, Wheels};
use rumbo_plant::drivetrain::Side;
use rumbo_plant::plant::Event;
use rumbo_robot::latch::{EchoLatch, EchoLine, EdgeCounter};

/// What the interrupts have latched.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Board {
    counters: Wheels<EdgeCounter>,
    /// By `SonarId` number.
    lines: [EchoLine<Micros>; 3],
    echoes: EchoLatch,
}

impl Board {
    /// An edge on one of the input pins.
    pub(crate) fn handle(&mut self, event: Event) {
        match event {
            Event::Edge { wheel, at_us, .. } => {
                let counter = match wheel {
                    Side::Left => &mut self.counters.left,
                    Side::Right => &mut self.counters.right,
                };
                counter.edge(micros(at_us));
            }
            Event::EchoRise { sonar, at_us } => self.echo_edge(sonar.index(), true, at_us),
            Event::EchoFall { sonar, at_us } => self.echo_edge(sonar.index(), false, at_us),
            Event::Contact { .. } => {}
        }
    }

    fn echo_edge(&mut self, sonar: usize, high: bool, at_us: u64) {
        self.lines[sonar].edge(high, micros(at_us));
    }

    /// A sonar has been triggered.
    pub(crate) fn pinged(&mut self, sonar: SonarId, at_us: u64) {
        self.lines[sonar as usize] = EchoLine::Pinged(micros(at_us));
        self.echoes.asked(sonar);
    }

    /// Both encoders, as they stand.
    pub(crate) fn encoders(&self) -> Wheels<Edges> {
        self.counters.map(|counter| counter.edges())
    }

    /// What became of a ping, once.
    pub(crate) fn echo(&mut self, now_us: u64) -> Option<(SonarId, Echo)> {
        let lines = &self.lines;
        self.echoes
            .read(micros(now_us), |sonar| lines[sonar as usize])
    }
}

/// Simulated time as the robot's wrapping clock shows it.
pub(crate) fn micros(us: u64) -> Micros {
    Micros((us & u64::from(u32::MAX)) as u32)
}
