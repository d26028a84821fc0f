//! The registers of a timer, and GTCCR, which is all timers'.
//!
//! Counter and capture register are 16 bits behind an 8-bit bus: reading the low byte latches the high one, and writing the low byte
//! takes the high one along (section 17.3). Compare registers are latched for writing only.

use super::wave::{Mode, Top};
use super::{AS2, Clock, Timer};
use crate::devices::Core;
use crate::io::{Access, Counter};
use crate::model::timer::{ASYNCHRONOUS, CAPTURE, CHANNELS, OVERFLOW, TimerRegister as Register};

/// In GTCCR: hold, and the prescalers' resets.
const TSM: u8 = 0x80;
const PSRASY: u8 = 0x02;
const PSRSYNC: u8 = 0x01;
/// ASSR: an external clock, and what waits for an edge of it.
const EXCLK: u8 = 0x40;
const UPDATES: u8 = 0x1F;

impl Timer {
    /// The cycle before which a register reads the same unless an event comes first, and a read changes nothing.
    pub(crate) fn steady_until(&self, core: &Core, address: u16) -> u64 {
        match (self.place.register(address), self.clock) {
            (Some(Register::Flags), Clock::Divided(divisor)) => {
                let prescaler = self.prescaler(core);
                let tick = prescaler.ticks(divisor, self.computed_to) + self.wave.quiet_ticks(0xFF);
                prescaler.reset + tick * divisor
            }
            (Some(Register::Count | Register::Capture | Register::CaptureHigh), _) => 0,
            _ => u64::MAX,
        }
    }

    /// The counter at an address, if it is there.
    pub(crate) fn counter(&self, core: &Core, address: u16) -> Option<Counter> {
        let prescaler = self.prescaler(core);
        let divisor = match self.clock {
            Clock::Divided(divisor) if !prescaler.held && !self.stopped => Some(divisor),
            _ => None,
        };
        let is_count = self.place.register(address) == Some(Register::Count);
        is_count.then_some(Counter {
            count: self.wave.count,
            cycle: self.computed_to.saturating_sub(prescaler.reset),
            offset: prescaler.reset,
            divisor,
            is_down: self.wave.down,
            ticks: self.wave.quiet_ticks(0),
            is_wide: self.place.wide,
        })
    }

    pub(crate) fn read(&mut self, core: &mut Core, address: u16, at: Access) -> u8 {
        self.catch_up(core, at.cycle);
        let Some(register) = self.place.register(address) else {
            return 0;
        };
        let [low, high] = match register {
            Register::Count => self.wave.count,
            Register::Capture => self.wave.capture,
            Register::Compare(channel) => self.wave.buffered[channel],
            Register::CountHigh | Register::CaptureHigh => return self.latch,
            Register::CompareHigh(channel) => self.wave.buffered[channel] >> 8,
            Register::ControlA => u16::from(self.control[0]),
            Register::ControlB => u16::from(self.control[1]),
            // The force bits read as zero.
            Register::ControlC => 0,
            Register::Flags => u16::from(self.wave.flags),
            Register::Enabled => u16::from(self.enabled),
            Register::Asynchronous => u16::from(self.asynchronous),
        }
        .to_le_bytes();
        if matches!(register, Register::Count | Register::Capture) {
            self.latch = high;
        }
        low
    }

    pub(crate) fn write(&mut self, core: &mut Core, address: u16, value: u8, at: Access) {
        self.catch_up(core, at.cycle);
        let Some(register) = self.place.register(address) else {
            return;
        };
        if self.is_asynchronous()
            && let Some(busy) = register.busy()
        {
            // Without the clock's next edge it is not taken over.
            self.asynchronous |= busy;
            return;
        }
        let word = u16::from_le_bytes([value, if self.place.wide { self.latch } else { 0 }]);
        match register {
            Register::Count => {
                self.wave.count = word;
                // Also while it stands (section 17.7.2).
                self.wave.blocked = true;
            }
            // The capture register is writable only in a mode that uses it as the top.
            Register::Capture if self.wave.mode.top == Top::Capture => self.wave.capture = word,
            Register::Capture => {}
            Register::Compare(channel) => self.wave.set_compare(channel, word),
            Register::CountHigh | Register::CaptureHigh | Register::CompareHigh(_) => {
                self.latch = value;
            }
            Register::ControlA => self.set_control(0, value),
            Register::ControlB => self.set_control(1, value),
            Register::ControlC => self.force(value, [0x80, 0x40, 0x20]),
            Register::Flags => self.wave.flags &= !value,
            Register::Enabled => self.enabled = value & (OVERFLOW | 0x0E | CAPTURE),
            Register::Asynchronous => {
                self.asynchronous = value & (EXCLK | AS2) | self.asynchronous & UPDATES;
                if value & AS2 == 0 {
                    self.asynchronous &= !UPDATES;
                }
                self.set_clock();
            }
        }
        self.duty_due = true;
        self.show(core, at.cycle);
        self.reschedule(core);
    }

    fn set_control(&mut self, index: usize, value: u8) {
        self.control[index] = value;
        let [a, b, _] = self.control;
        let mode = if self.place.wide {
            Mode::wide(a & 3 | b >> 1 & 0x0C)
        } else {
            Mode::narrow(a & 3 | b >> 1 & 4)
        };
        if mode != self.wave.mode {
            self.wave.set_mode(mode);
        }
        self.wave.pin_mode = [a >> 6, a >> 4 & 3, a >> 2 & 3];
        self.wave.pin_mode[self.wave.channels..].fill(0);
        if !self.place.wide && index == 1 {
            self.control[1] &= 0x0F;
            self.force(value, [0x80, 0x40, 0]);
        }
        self.set_clock();
    }

    fn force(&mut self, value: u8, bits: [u8; CHANNELS]) {
        for (channel, bit) in bits.into_iter().enumerate() {
            if value & bit != 0 {
                self.wave.force(channel);
            }
        }
    }

    fn set_clock(&mut self) {
        const SYNCHRONOUS: [u64; 6] = [0, 1, 8, 64, 256, 1024];
        const OWN: [u64; 8] = [0, 1, 8, 32, 64, 128, 256, 1024];
        let select = usize::from(self.control[1] & 7);
        self.clock = match (self.place.number, select) {
            (_, 0) => Clock::Stopped,
            // The pins of timer 2's own crystal have none: it stands.
            (ASYNCHRONOUS, _) if self.is_asynchronous() => Clock::Stopped,
            (ASYNCHRONOUS, _) => Clock::Divided(OWN[select]),
            (_, 6 | 7) => Clock::Pin {
                rising: select == 7,
            },
            _ => Clock::Divided(SYNCHRONOUS[select]),
        };
    }
}

/// Writes GTCCR: resets the prescalers, or holds them at 0 as long as TSM is set.
pub(crate) fn write_general_control(timers: &mut [Timer], core: &mut Core, value: u8, cycle: u64) {
    for timer in timers.iter_mut() {
        timer.catch_up(core, cycle);
    }
    for (prescaler, bit) in core.prescalers.iter_mut().zip([PSRSYNC, PSRASY]) {
        if value & bit != 0 || prescaler.held {
            prescaler.reset = cycle;
        }
        prescaler.held = value & bit != 0 && value & TSM != 0;
    }
    for timer in timers {
        timer.reschedule(core);
    }
}

/// GTCCR as it reads: the reset bits clear themselves unless they are held.
pub(crate) fn read_general_control(core: &Core) -> u8 {
    let [synchronous, own] = core.prescalers.map(|prescaler| prescaler.held);
    let held = if synchronous || own { TSM } else { 0 };
    held | if synchronous { PSRSYNC } else { 0 } | if own { PSRASY } else { 0 }
}
