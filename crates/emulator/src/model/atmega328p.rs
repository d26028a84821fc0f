//! The ATmega328P of an Arduino Uno or Nano (DS40002061B, sections 1, 12.4, 26 and 35).

use super::Fuses;
use super::map::owners;
use super::timer::{TimerInstance, narrow, wide_of_two};
use super::usart::UsartInstance;
use super::{Analog, Model, PinChange, Vectors, pin, pins_of};
use crate::registers;

/// The ATmega328P of an Arduino Uno or Nano.
pub static ATMEGA328P: Model = Model {
    name: "atmega328p",
    boards: "Arduino Uno or Nano",
    architecture: 5,
    signature: [0x1E, 0x95, 0x0F],
    flash_words: 0x4000,
    sram_start: 0x100,
    ram_end: 0x8FF,
    eeprom_bytes: 0x400,
    page_words: 64,
    boot_words: 2048,
    no_read_while_write: 0x3800,
    // Crystal, boot section of 512 bytes with the reset in it.
    fuses: Fuses {
        low: 0xFF,
        high: 0xDE,
        extended: 0xFD,
        lock: 0xCF,
    },
    vectors: &VECTORS,
    numbers: Vectors {
        pin_change: 3,
        watchdog: 6,
        spi: 17,
        converted: 21,
        eeprom_ready: 22,
        compared: 23,
        twi: 24,
        programmed: 25,
    },
    owners: owners(&PORTS, TIMERS.len(), USARTS.len(), &ABSENT),
    ports: PORTS,
    timers: &TIMERS,
    usarts: &USARTS,
    external: (&[pin('D', 2), pin('D', 3)], 0),
    pin_changes: &[
        change('B', 0, 0xFF),
        change('C', 1, 0x7F),
        change('D', 2, 0xFF),
    ],
    spi: [pin('B', 2), pin('B', 5), pin('B', 3), pin('B', 4)],
    twi: [pin('C', 5), pin('C', 4)],
    analog: Analog {
        pins: analog_pins(),
        internal_v: [1.1, 1.1],
        differential: false,
    },
    shared_output: None,
    // PUD; the two bits that switch the brown-out detector off in sleep read as 0.
    control_bits: 0x10,
};

/// Only B, C and D; PC6 is the reset on an Uno.
const PORTS: [u8; 11] = [0, 0xFF, 0x7F, 0xFF, 0, 0, 0, 0, 0, 0, 0];

/// Registers that only the larger chip has, besides those of its other ports, timers and USARTs.
const ABSENT: [u16; 8] = [
    registers::PRR1,
    registers::EICRB,
    registers::DIDR2,
    registers::OCDR,
    registers::XMCRA,
    registers::XMCRB,
    registers::OCR1CL,
    registers::OCR1CL + 1,
];

const fn change(letter: char, group: usize, pins: u8) -> PinChange {
    PinChange {
        port: pin(letter, 0).port(),
        pins,
        group,
        shift: 0,
    }
}

const fn analog_pins() -> [Option<super::Pin>; 19] {
    let on_port = pins_of::<6>('C');
    let mut pins = [None; 19];
    let mut channel = 0;
    while channel < on_port.len() {
        pins[channel] = on_port[channel];
        channel += 1;
    }
    pins[17] = Some(pin('D', 6));
    pins[18] = Some(pin('D', 7));
    pins
}

static TIMERS: [TimerInstance; 3] = [
    narrow(0, 14, [pin('D', 6), pin('D', 5)]).with(pin('D', 4), None),
    wide_of_two(1, 10, [pin('B', 1), pin('B', 2)]).with(pin('D', 5), Some(pin('B', 0))),
    narrow(2, 7, [pin('B', 3), pin('D', 3)]),
];

static USARTS: [UsartInstance; 1] = [UsartInstance::new(
    0,
    18,
    [pin('D', 0), pin('D', 1), pin('D', 4)],
)];

static VECTORS: [&str; 26] = [
    "RESET",
    "INT0",
    "INT1",
    "PCINT0",
    "PCINT1",
    "PCINT2",
    "WDT",
    "TIMER2_COMPA",
    "TIMER2_COMPB",
    "TIMER2_OVF",
    "TIMER1_CAPT",
    "TIMER1_COMPA",
    "TIMER1_COMPB",
    "TIMER1_OVF",
    "TIMER0_COMPA",
    "TIMER0_COMPB",
    "TIMER0_OVF",
    "SPI_STC",
    "USART_RX",
    "USART_UDRE",
    "USART_TX",
    "ADC",
    "EE_READY",
    "ANALOG_COMP",
    "TWI",
    "SPM_READY",
];
