//! Rumbo on the Arduino Mega: the same robot as everywhere, between the pins of an ATmega2560.
//!
//! A tick of timer 1 wakes the loop: what latched becomes [`rumbo_control::Inputs`], one [`Robot::tick`] makes
//! [`rumbo_control::Outputs`] of it, and those wait for the timer to write them 3 ms after the tick. Bytes come and go
//! through rings. Nothing in the loop waits for anything but the next tick.
#![no_std]
#![no_main]
#![feature(abi_avr_interrupt, asm_experimental_arch)]
#![deny(unsafe_op_in_unsafe_fn)]

mod hal;
#[allow(
    dead_code,
    reason = "the whole table; some pins are the hardware's own"
)]
mod pins;

use hal::{
    adc, eeprom, encoder::Encoders, link, network, outputs, power, record, sonar::Listener, tick,
};
use rumbo_control::{Inputs, TICK_US};
use rumbo_robot::{Cell, Robot, RobotConfig, START_AT};

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

#[avr_device::entry]
fn main() -> ! {
    let reset = power::reset_cause();
    power::start_watchdog();
    hal::start();
    let start = eeprom::read(START_AT).wrapping_add(1);
    let mut robot = Robot::new(RobotConfig {
        image: hal::image_hash(),
        reset,
        start,
    });
    robot.recall(eeprom::read);
    robot.learn(network::read);
    // It is there before the first byte of this start has left.
    eeprom::write(Cell {
        address: START_AT,
        value: start,
    });
    record::robot(&robot);
    run(&mut robot)
}

/// Tick after tick.
fn run(robot: &mut Robot) -> ! {
    let mut encoders = Encoders::default();
    let mut listener = Listener::default();
    let mut inputs = Inputs::default();
    let mut tick = tick::ticks();
    hal::enable_interrupts();
    loop {
        power::sleep_after(tick);
        power::feed_watchdog();
        // A tick that was missed still counts.
        let (last, stamp) = tick::last_tick();
        let passed = last.wrapping_sub(tick);
        tick = last;
        inputs.now = inputs.now.after(u32::from(passed) * TICK_US);
        inputs.encoders = encoders.read(stamp, inputs.now);
        inputs.echo = listener.read(stamp, inputs.now);
        inputs.battery_v = robot
            .battery_input()
            .and_then(adc::sample)
            .map(|counts| robot.battery_v(counts));
        while let Some(byte) = link::receive() {
            robot.receive(byte);
        }
        record::inputs(&mut inputs);
        let out = robot.tick(&inputs);
        outputs::leave(&out, tick);
        record::outputs(&out);
        if let Some(sonar) = out.ping {
            listener.asked(sonar);
        }
        robot.report();
        robot.decide(network::read);
        if eeprom::is_ready()
            && let Some(cell) = robot.store()
        {
            eeprom::write(cell);
        }
        while link::has_room() {
            match robot.transmit() {
                Some(byte) => link::send(byte),
                None => break,
            }
        }
    }
}
