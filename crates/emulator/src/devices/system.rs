//! Registers of the chip as a whole: sleep, reset causes, MCU control, the three that are a program's own, and those
//! of what a Mega does not have, memory and debugger outside (2549Q, sections 9, 11, 12, 13.4, 14.2 and 27).

use super::Cause;
use crate::registers::{GPIOR0, GPIOR1, GPIOR2, MCUCR, MCUSR, OCDR, SMCR, XMCRA, XMCRB};

/// External memory enable in XMCRA.
const SRE: u8 = 0x80;
/// Sleep enable in SMCR.
const SE: u8 = 1;
/// Pull-up disable in MCUCR.
const PUD: u8 = 0x10;
/// Vectors in the boot section, and the permission to change that, in MCUCR.
const IVSEL: u8 = 2;
const IVCE: u8 = 1;
/// Cycles for which IVCE permits.
const IVCE_CYCLES: u64 = 4;

/// State of the registers.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    general: [u8; 3],
    sleep_control: u8,
    /// MCUSR.
    reset_causes: u8,
    control: u8,
    control_open_until: u64,
    /// OCDR, XMCRA and XMCRB.
    debug: u8,
    external_memory: [u8; 2],
}

/// What sleeps (table 11-2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sleep {
    /// The CPU.
    Idle,
    /// The clock of most peripherals too.
    QuietForAnalog,
    /// All clocks, and the crystal.
    PowerDown,
    /// The same, but for timer 2 if it has a clock of its own.
    PowerSave,
    /// As power-down, but the crystal keeps running.
    Standby,
    /// As power-save, but the crystal keeps running.
    ExtendedStandby,
}

/// The flag of MCUSR that records a reset.
const fn flag(cause: Cause) -> u8 {
    match cause {
        Cause::PowerOn => 1,
        Cause::External => 2,
        Cause::BrownOut => 4,
        Cause::Watchdog => 8,
    }
}

impl System {
    /// After a reset: the causes add up until a program clears them, or the supply was off.
    pub(super) fn after_reset(&self, cause: Cause) -> System {
        let before = if cause == Cause::PowerOn {
            0
        } else {
            self.reset_causes
        };
        System {
            reset_causes: before | flag(cause),
            ..System::default()
        }
    }

    pub(super) fn read(&self, address: u16) -> u8 {
        match address {
            GPIOR0 => self.general[0],
            GPIOR1 => self.general[1],
            GPIOR2 => self.general[2],
            SMCR => self.sleep_control,
            MCUSR => self.reset_causes,
            MCUCR => self.control,
            OCDR => self.debug,
            XMCRA => self.external_memory[0],
            XMCRB => self.external_memory[1],
            _ => 0,
        }
    }

    /// Writes a register; `kept` are the bits of MCUCR that hold what is written.
    pub(super) fn write(&mut self, address: u16, value: u8, kept: u8, cycle: u64) {
        match address {
            GPIOR0 => self.general[0] = value,
            GPIOR1 => self.general[1] = value,
            GPIOR2 => self.general[2] = value,
            SMCR => self.sleep_control = value & 0x0F,
            // Flags of the reset: a zero clears, a one leaves.
            MCUSR => self.reset_causes &= value,
            MCUCR => self.write_control(value, kept, cycle),
            OCDR => self.debug = value,
            XMCRA => self.external_memory[0] = value,
            XMCRB => self.external_memory[1] = value & 0x87,
            _ => {}
        }
    }

    /// IVSEL changes only within four cycles after IVCE was written.
    fn write_control(&mut self, value: u8, kept: u8, cycle: u64) {
        let select = if cycle <= self.control_open_until && value & IVCE == 0 {
            value & IVSEL
        } else {
            self.control & IVSEL
        };
        if value & IVCE != 0 {
            self.control_open_until = cycle + IVCE_CYCLES;
        }
        self.control = value & kept | select;
    }

    /// A reset by the watchdog keeps it on.
    pub(super) fn watchdog_held(&self) -> bool {
        self.reset_causes & flag(Cause::Watchdog) != 0
    }

    /// External memory is enabled: ports A and C are its bus.
    pub(super) fn external_memory(&self) -> bool {
        self.external_memory[0] & SRE != 0
    }

    pub(super) fn pull_ups_disabled(&self) -> bool {
        self.control & PUD != 0
    }

    pub(super) fn sleep_mode(&self) -> Sleep {
        match self.sleep_control >> 1 & 7 {
            1 => Sleep::QuietForAnalog,
            2 => Sleep::PowerDown,
            3 => Sleep::PowerSave,
            6 => Sleep::Standby,
            7 => Sleep::ExtendedStandby,
            // 4 and 5 are reserved.
            _ => Sleep::Idle,
        }
    }

    pub(super) fn sleep_enabled(&self) -> bool {
        self.sleep_control & SE != 0
    }

    /// The interrupt vectors are in the boot section.
    pub(super) fn vectors_in_boot(&self) -> bool {
        self.control & IVSEL != 0
    }
}
