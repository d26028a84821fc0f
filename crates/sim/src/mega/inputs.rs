//! The edges that the plant announces, scheduled for the chip.
//!
//! The plant looks ahead and announces the edges of encoders and echoes; each goes into the chip's queue shortly before
//! its cycle. When the chip acts in between, the plant follows for good, in a different step than in its look-ahead:
//! [`Mega::correct`] matches each edge found then with the announced one and corrects the differences.

use super::echo::of_core;
use super::{Faults, Mega};
use crate::wire_fault::Wire;
use rumbo_emulator::devices::Input;
use rumbo_emulator::devices::ports::Pin;
use rumbo_plant::drivetrain::Side;
use rumbo_plant::plant::Event;
use rumbo_plant::sonar::SonarId;
use std::collections::VecDeque;

/// An edge that the plant announces.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Edge {
    /// By the number of its line among [`Wires::encoders`](super::Wires::encoders).
    Encoder(usize, bool),
    Echo(SonarId, bool),
}

/// What the plant has announced in its present look-ahead.
#[derive(Clone, Debug, Default)]
pub(super) struct Announced {
    /// Edges to come, and when [us].
    expected: VecDeque<(u64, Edge)>,
    /// Those that the chip has been given since.
    given: Vec<Edge>,
}

impl Mega {
    /// The plant starts a new look-ahead: edges already given to the chip have happened, the others are withdrawn.
    pub(crate) fn look_ahead(&mut self) {
        self.announced.expected.clear();
        self.announced.given.clear();
    }

    /// An edge that comes unless the chip acts before.
    pub(crate) fn expect(&mut self, event: Event) {
        let edge = edge_of(event);
        self.announced
            .expected
            .extend(edge.map(|edge| (event.at_us(), edge)));
    }

    /// An edge that the plant actually produced: corrects the announcement where it differs.
    pub(crate) fn correct(&mut self, event: Event, faults: &mut Faults<'_>) {
        let Some(edge) = edge_of(event) else { return };
        // In order: where a line has changed twice meanwhile, its present level tells nothing about the first edge.
        if let Some(at) = self.announced.given.iter().position(|given| *given == edge) {
            self.announced.given.remove(at);
            return;
        }
        let known = match edge {
            Edge::Encoder(index, level) => self.encoders[index] == level,
            Edge::Echo(sonar, level) => self.echoes.level(sonar) == level,
        };
        if !known {
            self.deliver(event.at_us(), edge, faults);
        }
    }

    /// The cycle of the next known input.
    pub(super) fn next_input(&self) -> Option<u64> {
        let expected = self.announced.expected.front().map(|(at_us, _)| *at_us);
        let forced = self.echoes.next_forced_us();
        let next = expected.into_iter().chain(forced);
        let next = next.map(|at_us| self.cycle_of(at_us));
        next.chain(self.next_fall()).min()
    }

    /// Puts the edges up to a cycle into the chip's queue.
    pub(super) fn deliver_up_to(&mut self, cycle: u64, faults: &mut Faults<'_>) {
        self.fall_up_to(cycle);
        while self.next_input().is_some_and(|next| next <= cycle) {
            let forced = self.echoes.next_forced_us();
            match self.announced.expected.front().copied() {
                Some((at_us, edge)) if forced.is_none_or(|forced| at_us <= forced) => {
                    self.announced.expected.pop_front();
                    self.announced.given.push(edge);
                    self.deliver(at_us, edge, faults);
                }
                _ => {
                    if let Some((at_us, sonar)) = self.echoes.take_forced() {
                        let pin = self.wires().echoes[sonar.index()];
                        self.put(self.cycle_of(at_us), pin, false);
                    }
                }
            }
        }
    }

    fn deliver(&mut self, at_us: u64, edge: Edge, faults: &mut Faults<'_>) {
        let (wire, level) = match edge {
            Edge::Encoder(index, level) => {
                self.encoders[index] = level;
                let Some(side) = [Side::Left, Side::Right].get(index) else {
                    // No fault befalls an output B.
                    let pin = self.wires().encoders[index];
                    return self.put(self.cycle_of(at_us), pin, level);
                };
                (Wire::Encoder(*side), level)
            }
            Edge::Echo(sonar, level) => {
                if !self.echoes.edge(sonar, level, at_us, faults) {
                    return;
                }
                let Some(own) = of_core(sonar) else {
                    let pin = self.wires().echoes[sonar.index()];
                    return self.put(self.cycle_of(at_us), pin, level);
                };
                (Wire::Echo(own), level)
            }
        };
        if faults.wires.passes(faults.noise, wire, at_us) {
            self.put(self.cycle_of(at_us), self.pin_of(wire), level);
        }
    }

    fn pin_of(&self, wire: Wire) -> Option<Pin> {
        match wire {
            Wire::Encoder(side) => self.wires().encoders[side.index()],
            Wire::Echo(sonar) => self.wires().echoes[sonar as usize],
        }
    }

    /// What befalls the wires until then, from now on: they get stuck, or pick up noise.
    pub(crate) fn disturb(&mut self, from_us: u64, to_us: u64, faults: &mut Faults<'_>) {
        for (at_us, wire, level) in faults.wires.stuck(from_us, to_us) {
            self.put(self.cycle_of(at_us), self.pin_of(wire), level);
        }
        for (begin_us, end_us, wire) in faults.wires.pulses(faults.noise, from_us) {
            let level = match wire {
                Wire::Encoder(side) => self.encoders[side.index()],
                Wire::Echo(sonar) => self.echoes.level(SonarId::ALL[sonar as usize]),
            };
            for (at_us, level) in [(begin_us, !level), (end_us, level)] {
                self.put(self.cycle_of(at_us), self.pin_of(wire), level);
            }
        }
    }

    pub(super) fn put(&mut self, cycle: u64, pin: Option<Pin>, level: bool) {
        if let Some(pin) = pin {
            self.meters.set(cycle, pin, level);
            self.chip.input(cycle, Input::Pin(pin, Some(level)));
        }
    }
}

fn edge_of(event: Event) -> Option<Edge> {
    match event {
        Event::Edge {
            wheel,
            channel,
            level,
            ..
        } => Some(Edge::Encoder(wheel.index() + 2 * channel as usize, level)),
        Event::EchoRise { sonar, .. } => Some(Edge::Echo(sonar, true)),
        Event::EchoFall { sonar, .. } => Some(Edge::Echo(sonar, false)),
        Event::Contact { .. } => None,
    }
}
