//! What all peripherals share: interrupt requests, ports, the schedule of events, the stream of outputs.

use super::clock::Clock;
use super::interrupts::Interrupts;
use super::ports::{Change, Pin, Ports};
use super::prescaler::Prescaler;
use super::schedule::Schedule;
use super::signal::{Event, Level, Output};
use crate::io::Demand;
use crate::model::Model;
use std::collections::VecDeque;

/// What all peripherals share.
#[derive(Clone, Debug, Default)]
pub(crate) struct Core {
    pub(crate) model: &'static Model,
    pub(crate) interrupts: Interrupts,
    pub(crate) ports: Ports,
    pub(crate) schedule: Schedule,
    pub(crate) clock: Clock,
    pub(crate) outputs: Vec<Output>,
    /// The one that timers 0, 1, 3, 4 and 5 share, and timer 2's.
    pub(crate) prescalers: [Prescaler; 2],
    pub(super) changes: VecDeque<(Change, u64)>,
    /// Pins whose outputs pause the run, by their number.
    pub(super) watched: u128,
    pub(super) noticed: bool,
    /// The bytes of the two-wire bus pause the run.
    pub(super) bus_watched: bool,
    /// Levels since the last call, while they are recorded.
    pub(super) levels: Option<Vec<Level>>,
    /// The system clock has another divisor.
    pub(super) rescaled: bool,
    pub(super) demand: Option<Demand>,
    /// The flag that starts a conversion was raised in this cycle.
    pub(super) triggered: Option<u64>,
    /// The comparator takes the place of timer 1's capture pin with this output, or gives it back (`None`), from this cycle on.
    pub(super) captured: Option<(Option<bool>, u64)>,
    /// What OC0A and OC1C have for the pin they share.
    pub(super) shared: [Option<bool>; 2],
}

impl Core {
    pub(crate) fn new(model: &'static Model) -> Core {
        Core {
            model,
            ports: Ports::new(model),
            ..Core::default()
        }
    }

    /// Emits an event of the chip at its cycle.
    pub(crate) fn emit(&mut self, cycle: u64, event: Event) {
        if let Event::Pin(pin, _) | Event::Duty { pin, .. } = event {
            self.noticed |= self.watched >> pin.number() & 1 != 0;
        }
        self.noticed |= matches!(event, Event::TwoWire(_));
        let cycle = self.clock.time(cycle);
        self.outputs.push(Output { cycle, event });
    }

    /// The CPU stands for some cycles.
    pub(crate) fn stall(&mut self, cycles: u64) {
        match &mut self.demand {
            Some(Demand::Stall(already)) => *already += cycles,
            Some(Demand::Reset { .. }) => {}
            None => self.demand = Some(Demand::Stall(cycles)),
        }
    }

    /// Makes the CPU's loop return: a peripheral needs its attention.
    #[inline(always)]
    pub(super) fn is_wanted(&self) -> bool {
        self.noticed || self.rescaled || self.demand.is_some()
    }

    /// A timer's output drives its pin, or lets it go.
    pub(crate) fn drive_output(
        &mut self,
        timer: usize,
        pin: Pin,
        output: Option<bool>,
        cycle: u64,
    ) {
        if self.model.shared_output == Some(pin) {
            self.shared[timer % 2] = output;
            self.modulate(cycle);
        } else {
            let change = self.ports.override_output(pin, output, cycle);
            self.note(change, cycle);
        }
    }

    /// Where both drive it, the pin that OC0A and OC1C share has both, or either if PORTB7 is set (section 19).
    pub(super) fn modulate(&mut self, cycle: u64) {
        let Some(pin) = self.model.shared_output else {
            return;
        };
        let output = match self.shared {
            [Some(first), Some(second)] if self.ports.output(pin) => Some(first || second),
            [Some(first), Some(second)] => Some(first && second),
            [first, second] => first.or(second),
        };
        let change = self.ports.override_output(pin, output, cycle);
        self.note(change, cycle);
    }

    /// Records a change of a port; peripherals that watch pins are notified before the access ends.
    pub(crate) fn note(&mut self, change: Option<Change>, cycle: u64) {
        self.changes.extend(change.map(|change| (change, cycle)));
    }
}
