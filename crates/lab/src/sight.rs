//! What a session sees of a simulation.

use rumbo_control::Wheels;
use rumbo_control::mode::ModeId;
use rumbo_log::{MapPose, ReadingSource, Truth};
use rumbo_session::{Abilities, PARTS_CONSOLE, Shown};
use rumbo_sim::mega::firmware::LinkLanguage;
use rumbo_sim::mega::{CONSOLES, PARTS};
use rumbo_sim::{READING_US, Sim, loop_signals};

const _: () = assert!(PARTS == PARTS_CONSOLE);

/// What can be done with the only robot of a world, in this mode at first.
pub(crate) fn abilities(sim: &Sim, mode: ModeId) -> Abilities {
    let firmware = sim.mega().map(|mega| mega.firmware());
    let text = firmware.is_some_and(|firmware| firmware.language() == LinkLanguage::Text);
    Abilities {
        pace: true,
        reset: true,
        clock: true,
        port: false,
        typing: true,
        cut_off: text,
        // An image with our frames gets its parameters before its run begins, unseen.
        play: text || firmware.is_none(),
        text: text.then_some(mode),
    }
}

/// Ground truth.
pub(crate) fn truth(sim: &Sim) -> Truth {
    let truth = sim.truth();
    let [left, right] = truth.wheel_rad_s;
    let [left_m, right_m, front_m, ..] = truth.range_m;
    Truth {
        pose: MapPose {
            x_m: truth.pose.x_m,
            y_m: truth.pose.y_m,
            heading_rad: truth.pose.heading_rad,
        },
        wheel_rad_s: Wheels { left, right },
        range_m: [left_m, right_m, front_m],
        servo_rad: truth.servo_rad,
        contact: truth.touching,
        battery_v: truth.battery_v,
    }
}

/// Whether a reading of the instruments is due, which `due_us` \[us\] says; if so, the next one is later.
pub(crate) fn reading_due(sim: &Sim, due_us: &mut u64) -> bool {
    let now_us = sim.now_us();
    let due = now_us >= *due_us;
    if due {
        *due_us = now_us + READING_US;
    }
    due
}

/// What instruments at an emulated chip show, or the terms of our program's control loops.
pub(crate) fn shown(sim: &mut Sim) -> Option<Shown> {
    match sim.loops() {
        Some(loops) => Some((ReadingSource::Loops, loop_signals(&loops))),
        None if sim.mega().is_some() => Some((ReadingSource::Truth, sim.read_instruments())),
        None => None,
    }
}

/// What the USARTs of an emulated chip have sent since the last call, with their numbers.
pub(crate) fn consoles(sim: &mut Sim) -> Vec<(u8, Vec<u8>)> {
    let Some(mega) = sim.mega_mut() else {
        return Vec::new();
    };
    let said = (0..CONSOLES).map(|usart| (usart, mega.take_console(usart)));
    said.filter(|(_, bytes)| !bytes.is_empty()).collect()
}
