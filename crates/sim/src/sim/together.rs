//! Robots advanced together, their plants in the lanes of vector registers.

use super::native::Native;
use super::touches::Touches;
use super::{Controller, Sim};
use rumbo_plant::lanes::{LANES, Lanes};

impl Sim {
    /// Advances each of these by `for_us`, with the bits of [`Sim::advance`]. Our native robots with sound wires share the
    /// work where they stop at the same times; any others go one by one.
    pub fn advance_together(lanes: Lanes, mut sims: [&mut Self; LANES], for_us: u64) {
        let until_us = sims.each_ref().map(|sim| sim.now_us() + for_us);
        if !sims.iter().all(|sim| sim.shares_steps()) {
            for (sim, until_us) in sims.into_iter().zip(until_us) {
                sim.advance(until_us);
            }
            return;
        }
        let mut natives = sims.each_mut().map(|sim| sim.take_native());
        let mut all_there = false;
        while !all_there {
            let mut crew = sims.iter_mut().zip(natives.iter().flatten()).zip(until_us);
            let next = crew
                .next()
                .map(|((sim, native), until_us)| native.next_us(until_us) - sim.now_us());
            let Some(step_us) = next else { break };
            let alike = crew.all(|((sim, native), until_us)| {
                native.next_us(until_us) - sim.now_us() == step_us
            });
            if !alike {
                break;
            }
            sense_together(lanes, &mut sims, &mut natives, step_us);
            let crew = sims.iter_mut().zip(natives.iter_mut().flatten());
            for ((sim, native), until_us) in crew.zip(until_us) {
                all_there = sim.act_native(native, until_us);
            }
        }
        for ((sim, native), until_us) in sims.into_iter().zip(natives).zip(until_us) {
            sim.controller = native.map(Controller::Rumbo);
            if !all_there {
                sim.advance(until_us);
            }
        }
    }

    fn shares_steps(&self) -> bool {
        matches!(self.controller, Some(Controller::Rumbo(_))) && self.wire_faults.is_empty()
    }

    fn take_native(&mut self) -> Option<Box<Native>> {
        match self.controller.take() {
            Some(Controller::Rumbo(native)) => Some(native),
            other => {
                self.controller = other;
                None
            }
        }
    }
}

/// Advances all plants, and latches the edges that their wires bring to the boards.
fn sense_together(
    lanes: Lanes,
    sims: &mut [&mut Sim; LANES],
    natives: &mut [Option<Box<Native>>; LANES],
    step_us: u64,
) {
    let mut touches = [const { Touches(Vec::new()) }; LANES];
    let mut group = sims.each_mut().map(|sim| (&sim.plant, &mut sim.state));
    lanes.advance(&mut group, step_us, &mut |index, event| {
        touches[index].note(&event);
        if let Some(native) = &mut natives[index] {
            native.board.handle(event);
        }
    });
    for (sim, mut touches) in sims.iter_mut().zip(touches) {
        sim.touches.0.append(&mut touches.0);
        sim.watch_reverse();
    }
}
