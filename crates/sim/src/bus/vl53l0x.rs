//! A VL53L0X: it sends light and measures how long that takes to come back (ST, DS11555). ST publishes no register map: the
//! registers are as the libraries use them that ST (STSW-IMG005) and Pololu publish.
//!
//! | what | is | source |
//! |---|---|---|
//! | field | 25° wide, in [`sight`] | data sheet |
//! | noise | 4 % of the range in 33 ms, less with the root of the time | data sheet, white, indoors |
//! | scale | up to 3 %, drawn by the seed | data sheet, offset |
//! | reach | 1.2 m at a limit of 0.25 million counts a second, further at a lower one; 8190 beyond | data sheet, default mode |
//! | time | what its steps take by their registers | the libraries' sums |
//!
//! A measurement shows the world at its end. Sunlight, colour and cover glass do not count; its output GPIO1 and thresholds
//! are not modelled.

pub(crate) mod sight;
mod timing;

use crate::source;
use rumbo_plant::noise::Noise;
use sight::Sight;

/// Noise sources of a sensor.
const SOURCES: u32 = 2;
/// The step of the noise that draws the scale; measurements have their time.
const SCALE: u64 = u64::MAX;
/// Standard deviation of a reading, as a share of the range, in a measurement of [`NOISY_US`].
const NOISE: f64 = 0.04;
const NOISY_US: f64 = 33_000.0;
/// The scale's error, three standard deviations.
const SCALES: f64 = 0.03;
/// Nearest range \[mm\].
const NEAREST: f64 = 30.0;
/// What it gives where nothing comes back \[mm\].
const NOTHING: u16 = 8190;
/// Cycles of the board's crystal in a microsecond.
const US: u64 = 16;
/// From XSHUT, or a reset, to the first answer (data sheet, 1.2 ms) \[cycles\].
const BOOT: u64 = 1_200 * US;

const ADDRESS: u8 = 0x29;
/// Its registers lie in pages, of which libraries use four.
const PAGES: usize = 8;
const PAGE: u8 = 0xFF;
const MEASURING: usize = 0;
const CORE: usize = 1;
const MEMORY: usize = 7;
// Page 0.
const START: u8 = 0x00;
const SEQUENCE: u8 = 0x01;
const PERIOD: u8 = 0x04;
const FORMAT: u8 = 0x09;
const INTERRUPT_CONFIG: u8 = 0x0A;
const INTERRUPT_CLEAR: u8 = 0x0B;
const INTERRUPT_STATUS: u8 = 0x13;
const RESULT: u8 = 0x14;
const OFFSET: u8 = 0x28;
const RATE_LIMIT: u8 = 0x44;
const OWN_ADDRESS: u8 = 0x8A;
const REFERENCE: u8 = 0xB0;
const RESET: u8 = 0xBF;
const OSCILLATOR: u8 = 0xF8;
// Page 1: a variable that libraries keep and give back to start, and counts a second of the reference diodes.
const STOP: u8 = 0x91;
const REFERENCE_RATE: u8 = 0xB6;
// Page 7: a word of its memory that is asked for, the word, and the strobe.
const WORD: u8 = 0x90;
const WORD_ASKED: u8 = 0x94;
const STROBE: u8 = 0x83;
/// Counts of its oscillator in a millisecond.
const OSCILLATIONS: u16 = 640;
/// Steps of [`SEQUENCE`] that measure a range.
const RANGING: u8 = 0xC0;
const NEW_SAMPLE: u8 = 4;
/// In the status of a result: the range is complete; its phase is not valid, as without an echo.
const COMPLETE: u8 = 11 << 3;
const NO_PHASE: u8 = 6 << 3;
/// A millionth of the counts of light \[1/s\], in counts of a register.
const RATE: f64 = 128.0;
/// Of each reference diode, so that five give what libraries look for, 20 million; and the diodes that see a target, in 1/256.
const DIODE_RATE: u16 = 4 * 128;
const DIODES: u16 = 6 * 256;
const AMBIENT: u16 = 2;
/// Who it says it is.
const PRODUCT: &[u8; 16] = b"VL53L0CXV0DH/1$1";

/// A measurement that is under way.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// It ends in this cycle.
    due: u64,
    /// The next one begins so many cycles after this one began, or at its end; not at all.
    again: Option<u64>,
}

/// What a measurement sees at its end.
#[derive(Clone, Copy, Debug, Default)]
struct Reading {
    /// \[mm\]; nothing where too little light comes back.
    range: Option<f64>,
    /// Millions of counts a second.
    rate: f64,
}

/// The sensor.
#[derive(Clone, Debug)]
pub(crate) struct Vl53l0x {
    source: u32,
    registers: [[u8; 256]; PAGES],
    page: usize,
    pointer: u8,
    /// The next byte written is the number of a register.
    begins: bool,
    /// XSHUT, or its reset, holds it.
    held: bool,
    /// It answers from this cycle on.
    awake: u64,
    run: Option<Run>,
    reading: Reading,
    /// What it gave last \[m\]: not a number without a measurement, infinite without an echo.
    shown_m: f64,
    thresholds: bool,
}

fn after_reset() -> [[u8; 256]; PAGES] {
    let mut registers = [[0; 256]; PAGES];
    let own = &mut registers[MEASURING];
    let values: [(u8, &[u8]); 11] = [
        (SEQUENCE, &[0xFF]),
        (RATE_LIMIT, &[0, 32]),
        (timing::EARLY_STEPS, &[0x25]),
        (timing::PRE_PERIOD, &[6, 0, 0x99]),
        (timing::FINAL_PERIOD, &[4, 1, 0xFE]),
        (0x84, &[0x11]),
        (OWN_ADDRESS, &[ADDRESS]),
        (REFERENCE, &[0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x0F]),
        // Model, module and revision.
        (0xC0, &[0xEE, 0xAA, 0x10]),
        (RESET, &[1]),
        (OSCILLATOR, &OSCILLATIONS.to_be_bytes()),
    ];
    for (at, bytes) in values {
        own[usize::from(at)..][..bytes.len()].copy_from_slice(bytes);
    }
    registers[CORE][usize::from(STOP)] = 0x3C;
    // The oscillator, 9.44 MHz in 1/4096.
    registers[CORE][0x84..0x86].copy_from_slice(&38_666_u16.to_be_bytes());
    registers
}

impl Vl53l0x {
    /// The sensor of this number, as after power-on.
    pub(super) fn new(number: u32) -> Self {
        Self {
            source: source::DISTANCE + SOURCES * number,
            registers: after_reset(),
            page: 0,
            pointer: 0,
            begins: false,
            held: false,
            awake: 0,
            run: None,
            reading: Reading::default(),
            shown_m: f64::NAN,
            thresholds: false,
        }
    }

    /// The address that it answers at in this cycle.
    pub(super) fn address(&self, cycle: u64) -> Option<u8> {
        let awake = !self.held && cycle >= self.awake;
        awake.then(|| self.registers[MEASURING][usize::from(OWN_ADDRESS)] & 0x7F)
    }

    /// XSHUT has this level from a cycle on; low is a reset.
    pub(crate) fn shut(&mut self, cycle: u64, high: bool) {
        if self.held && high {
            self.awake = cycle + BOOT;
        }
        if !high {
            let source = self.source;
            *self = Self {
                source,
                thresholds: self.thresholds,
                ..Self::new(0)
            };
        }
        self.held = !high;
    }

    /// A transmission begins.
    pub(super) fn begin(&mut self) {
        self.begins = true;
    }

    pub(super) fn write(&mut self, byte: u8, cycle: u64) {
        self.advance(cycle);
        if std::mem::take(&mut self.begins) {
            self.pointer = byte;
            return;
        }
        let at = self.pointer;
        self.pointer = at.wrapping_add(1);
        if at == PAGE {
            self.page = usize::from(byte) % PAGES;
            return;
        }
        self.registers[self.page][usize::from(at)] = byte;
        match (self.page, at) {
            (MEASURING, START) => self.start(byte, cycle),
            (MEASURING, INTERRUPT_CONFIG) => self.thresholds |= (1..NEW_SAMPLE).contains(&byte),
            (MEASURING, INTERRUPT_CLEAR) if byte & 1 != 0 => {
                self.registers[MEASURING][usize::from(INTERRUPT_STATUS)] = 0;
            }
            (MEASURING, RESET) if byte & 1 == 0 => {
                self.registers = [[0; 256]; PAGES];
                self.registers[MEASURING][usize::from(OWN_ADDRESS)] = ADDRESS;
                self.run = None;
            }
            (MEASURING, RESET) => self.registers = after_reset(),
            // As libraries end measurements that go on.
            (CORE, STOP) if byte == 0 => self.run = None,
            (MEMORY, STROBE) if byte == 0 => self.recall(),
            _ => {}
        }
    }

    pub(super) fn read(&mut self, cycle: u64) -> u8 {
        self.advance(cycle);
        self.begins = false;
        let at = self.pointer;
        self.pointer = at.wrapping_add(1);
        self.registers[self.page][usize::from(at)]
    }

    /// A word of its memory comes where libraries read it.
    fn recall(&mut self) {
        let memory = &mut self.registers[MEMORY];
        let product = PRODUCT
            .iter()
            .fold(0_u128, |bits, letter| bits << 7 | u128::from(*letter))
            << (128 - 7 * PRODUCT.len());
        let asked = memory[usize::from(WORD_ASKED)];
        let word: u32 = match asked {
            0x02 => 1 << 24,
            0x24 => u32::MAX,
            0x25 => 0xFF0F_0000,
            // Five reference diodes, without an aperture.
            0x6B => 5 << 8,
            0x77..=0x7A => (product >> (32 * (0x7A - asked))) as u32,
            0x7B => 40 << 24,
            _ => 0,
        };
        memory[usize::from(WORD)..][..4].copy_from_slice(&word.to_be_bytes());
        memory[usize::from(STROBE)] = 1;
    }

    fn word(&self, at: u8) -> u16 {
        let at = usize::from(at);
        let own = &self.registers[MEASURING];
        u16::from_be_bytes([own[at], own[at + 1]])
    }

    /// Starts a single measurement, or those that go on.
    fn start(&mut self, mode: u8, cycle: u64) {
        let period = u32::from(self.word(PERIOD)) << 16 | u32::from(self.word(PERIOD + 2));
        let period_ms = period / u32::from(self.word(OSCILLATOR).max(1));
        let again = match mode & 0x0F {
            0x00 => None,
            0x02 => Some(Some(0)),
            0x04 => Some(Some(u64::from(period_ms) * 1_000 * US)),
            _ => Some(None),
        };
        let due = cycle + self.takes();
        self.run = again.map(|again| Run { due, again });
        // It has begun.
        self.registers[MEASURING][usize::from(START)] &= !1;
    }

    /// Cycles of a measurement.
    fn takes(&self) -> u64 {
        (timing::duration_us(&self.registers[MEASURING]) * US as f64) as u64
    }

    /// Whether a measurement of the range ends in this time.
    pub(crate) fn ends_within(&mut self, cycle: u64, until: u64) -> bool {
        self.advance(cycle);
        let ranges = self.registers[MEASURING][usize::from(SEQUENCE)] & RANGING != 0;
        ranges && self.run.is_some_and(|run| run.due < until)
    }

    /// What the measurement sees that ends next.
    pub(crate) fn see(&mut self, sight: Sight, noise: &Noise) {
        let at_us = self.run.map_or(0, |run| run.due / US);
        let limit = f64::from(self.word(RATE_LIMIT)) / RATE;
        let scale = SCALES / 3.0 * noise.normal(self.source, SCALE).clamp(-3.0, 3.0);
        let time_us = timing::duration_us(&self.registers[MEASURING]);
        let deviation = NOISE * libm::sqrt(NOISY_US / time_us);
        let error = scale + deviation * noise.normal(self.source + 1, at_us);
        // A number of 12 bits with a sign, in quarters of a millimetre.
        let offset = f64::from((self.word(OFFSET) << 4) as i16) / 64.0;
        let range = sight.range_m * 1e3 * (1.0 + error) + offset;
        self.reading = Reading {
            range: (sight.rate >= limit && sight.rate > 0.0).then(|| range.max(NEAREST)),
            rate: sight.rate,
        };
    }

    /// Measurements that have ended by this cycle.
    fn advance(&mut self, cycle: u64) {
        while let Some(run) = self.run.filter(|run| run.due <= cycle) {
            self.publish();
            let takes = self.takes();
            self.run = run.again.map(|period| Run {
                due: run.due + takes.max(period),
                ..run
            });
        }
    }

    /// Puts a reading into the registers.
    fn publish(&mut self) {
        let own = &mut self.registers[MEASURING];
        own[usize::from(INTERRUPT_STATUS)] = own[usize::from(INTERRUPT_CONFIG)] & 7;
        if own[usize::from(SEQUENCE)] & RANGING == 0 {
            return;
        }
        let Reading { range, rate } = self.reading;
        self.shown_m = range.map_or(f64::INFINITY, |range| range * 1e-3);
        let range = range.map_or(NOTHING, |range| range.round() as u16);
        let fine = own[usize::from(FORMAT)] & 1 != 0;
        let status = if range == NOTHING { NO_PHASE } else { COMPLETE };
        let words = [
            u16::from(status | 1) << 8,
            DIODES,
            0,
            // A cast saturates.
            (rate * RATE) as u16,
            AMBIENT,
            if fine { range << 2 } else { range },
        ];
        let bytes = words.map(u16::to_be_bytes).concat();
        own[usize::from(RESULT)..][..bytes.len()].copy_from_slice(&bytes);
        let reference = &own[usize::from(REFERENCE)..][..6];
        let diodes: u32 = reference.iter().map(|byte| byte.count_ones()).sum();
        let bytes = (DIODE_RATE * diodes as u16).to_be_bytes();
        self.registers[CORE][usize::from(REFERENCE_RATE)..][..2].copy_from_slice(&bytes);
    }

    /// What it gave last \[m\]: not a number without a measurement, infinite without an echo.
    pub(crate) fn shown_m(&self) -> f64 {
        self.shown_m
    }

    /// What a program asked for that is not modelled.
    pub(super) fn oddity(&self) -> Option<&'static str> {
        self.thresholds.then_some(
            "thresholds of the VL53L0X are not modelled: it is ready with each measurement; compare what it measures instead",
        )
    }
}

#[cfg(test)]
mod tests;
