//! The ATmega2560 of an Arduino Mega (2549Q, sections 1, 14.1, 29 and 33).

use super::Fuses;
use super::map::owners;
use super::timer::{TimerInstance, narrow, wide};
use super::usart::UsartInstance;
use super::{Analog, Model, PinChange, Vectors, pin, pins_of};

/// The ATmega2560 of an Arduino Mega.
pub static ATMEGA2560: Model = Model {
    name: "atmega2560",
    boards: "Arduino Mega or Mega 2560",
    architecture: 6,
    signature: [0x1E, 0x98, 0x01],
    flash_words: 0x2_0000,
    sram_start: 0x200,
    ram_end: 0x21FF,
    eeprom_bytes: 0x1000,
    page_words: 128,
    boot_words: 4096,
    no_read_while_write: 0x1_F000,
    // Crystal, boot section of 8 KB with the reset in it.
    fuses: Fuses {
        low: 0xFF,
        high: 0xD8,
        extended: 0xFD,
        lock: 0xCF,
    },
    vectors: &VECTORS,
    numbers: Vectors {
        pin_change: 9,
        watchdog: 12,
        spi: 24,
        compared: 28,
        converted: 29,
        eeprom_ready: 30,
        twi: 39,
        programmed: 40,
    },
    owners: owners(&PORTS, TIMERS.len(), USARTS.len(), &[]),
    ports: PORTS,
    timers: &TIMERS,
    usarts: &USARTS,
    external: (
        &[
            pin('D', 0),
            pin('D', 1),
            pin('D', 2),
            pin('D', 3),
            pin('E', 4),
            pin('E', 5),
            pin('E', 6),
            pin('E', 7),
        ],
        4,
    ),
    // PCINT8 is PE0, PCINT9 to 15 are PJ0 to PJ6.
    pin_changes: &[
        change('B', 0xFF, 0, 0),
        change('E', 0x01, 1, 0),
        change('J', 0x7F, 1, 1),
        change('K', 0xFF, 2, 0),
    ],
    spi: [pin('B', 0), pin('B', 1), pin('B', 2), pin('B', 3)],
    twi: [pin('D', 0), pin('D', 1)],
    analog: Analog {
        pins: analog_pins(),
        internal_v: [1.1, 2.56],
        differential: true,
    },
    shared_output: Some(pin('B', 7)),
    // JTD, PUD.
    control_bits: 0x90,
};

/// All but PG6 and PG7.
const PORTS: [u8; 11] = [
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x3F, 0xFF, 0xFF, 0xFF, 0xFF,
];

const fn change(letter: char, pins: u8, group: usize, shift: u8) -> PinChange {
    PinChange {
        port: pin(letter, 0).port(),
        pins,
        group,
        shift,
    }
}

const fn analog_pins() -> [Option<super::Pin>; 19] {
    let (low, high) = (pins_of::<8>('F'), pins_of::<8>('K'));
    let mut pins = [None; 19];
    let mut channel = 0;
    while channel < 8 {
        pins[channel] = low[channel];
        pins[channel + 8] = high[channel];
        channel += 1;
    }
    pins[17] = Some(pin('E', 2));
    pins[18] = Some(pin('E', 3));
    pins
}

static TIMERS: [TimerInstance; 6] = [
    narrow(0, 21, [pin('B', 7), pin('G', 5)]).with(pin('D', 7), None),
    wide(1, 16, [pin('B', 5), pin('B', 6), pin('B', 7)]).with(pin('D', 6), Some(pin('D', 4))),
    narrow(2, 13, [pin('B', 4), pin('H', 6)]),
    wide(3, 31, [pin('E', 3), pin('E', 4), pin('E', 5)]).with(pin('E', 6), Some(pin('E', 7))),
    wide(4, 41, [pin('H', 3), pin('H', 4), pin('H', 5)]).with(pin('H', 7), Some(pin('L', 0))),
    wide(5, 46, [pin('L', 3), pin('L', 4), pin('L', 5)]).with(pin('L', 2), Some(pin('L', 1))),
];

static USARTS: [UsartInstance; 4] = [
    UsartInstance::new(0, 25, [pin('E', 0), pin('E', 1), pin('E', 2)]),
    UsartInstance::new(1, 36, [pin('D', 2), pin('D', 3), pin('D', 5)]),
    UsartInstance::new(2, 51, [pin('H', 0), pin('H', 1), pin('H', 2)]),
    UsartInstance::new(3, 54, [pin('J', 0), pin('J', 1), pin('J', 2)]),
];

static VECTORS: [&str; 57] = [
    "RESET",
    "INT0",
    "INT1",
    "INT2",
    "INT3",
    "INT4",
    "INT5",
    "INT6",
    "INT7",
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
    "TIMER1_COMPC",
    "TIMER1_OVF",
    "TIMER0_COMPA",
    "TIMER0_COMPB",
    "TIMER0_OVF",
    "SPI_STC",
    "USART0_RX",
    "USART0_UDRE",
    "USART0_TX",
    "ANALOG_COMP",
    "ADC",
    "EE_READY",
    "TIMER3_CAPT",
    "TIMER3_COMPA",
    "TIMER3_COMPB",
    "TIMER3_COMPC",
    "TIMER3_OVF",
    "USART1_RX",
    "USART1_UDRE",
    "USART1_TX",
    "TWI",
    "SPM_READY",
    "TIMER4_CAPT",
    "TIMER4_COMPA",
    "TIMER4_COMPB",
    "TIMER4_COMPC",
    "TIMER4_OVF",
    "TIMER5_CAPT",
    "TIMER5_COMPA",
    "TIMER5_COMPB",
    "TIMER5_COMPC",
    "TIMER5_OVF",
    "USART2_RX",
    "USART2_UDRE",
    "USART2_TX",
    "USART3_RX",
    "USART3_UDRE",
    "USART3_TX",
];
