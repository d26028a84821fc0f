//! What the CPU asks of everything that is not CPU.

/// When and where an access to a peripheral takes place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// The cycle in which the bus carries it.
    pub cycle: u64,
    /// Address of the instruction [words].
    pub program_counter: u32,
}

/// What the peripherals want of the CPU between two instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Demand {
    /// It stands for some cycles.
    Stall(u64),
    /// It was reset in this cycle, and starts over at an address.
    Reset {
        /// Where [words].
        program_counter: u32,
        /// When it starts.
        cycle: u64,
    },
}

/// A counter that counts in one go, as long as no event comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counter {
    /// What it read in a cycle.
    pub count: u16,
    /// That cycle, by a clock that begins elsewhere.
    pub cycle: u64,
    /// How far that clock is behind the CPU's.
    pub offset: u64,
    /// It counts every power of two of cycles; `None` if it stands.
    pub divisor: Option<u64>,
    /// It counts down.
    pub is_down: bool,
    /// Ticks from `cycle` on in which it does not turn back.
    pub ticks: u64,
    /// Its high byte is latched, to be read at the next address.
    pub is_wide: bool,
}

impl Counter {
    /// What it reads in a cycle to come; `None` if that is too far ahead.
    #[inline]
    #[must_use]
    pub fn at(&self, cycle: u64) -> Option<u16> {
        let ticks = match self.divisor {
            None => 0,
            Some(divisor) => {
                let shift = divisor.trailing_zeros();
                (cycle.checked_sub(self.offset)? >> shift).checked_sub(self.cycle >> shift)?
            }
        };
        match (ticks < self.ticks, self.is_down) {
            (false, _) => None,
            (_, false) => self.count.checked_add(ticks as u16),
            (_, true) => self.count.checked_sub(ticks as u16),
        }
    }
}

/// What SPM does to the flash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stored {
    /// Nothing, or nothing yet.
    Nothing,
    /// The page that begins at this word is erased.
    Erased(u32),
    /// The page that begins at this word is written: bits are cleared where these words have zeros.
    Written(u32, Box<[u16]>),
}

/// The peripherals as the CPU sees them. Addresses are those of the data space, 0x20 to 0x1FF, and beyond SRAM.
pub trait Io {
    /// Reads a register.
    fn read(&mut self, address: u16, at: Access) -> u8;

    /// The cycle before which reads from `cycle` on all give the same and change nothing, unless an event comes first
    /// ([`Io::deadline`]); 0: not even the next one.
    fn steady_until(&self, _: u16, _: u64) -> u64 {
        0
    }

    /// The counter at this address, which is never steady.
    fn counter(&self, _: u16) -> Option<Counter> {
        None
    }

    /// Writes a register.
    fn write(&mut self, address: u16, value: u8, at: Access);

    /// SBI or CBI: sets or clears the bit in `mask` and touches no other.
    fn write_bit(&mut self, address: u16, mask: u8, set: bool, at: Access);

    /// Lets time pass up to `cycle`.
    fn advance(&mut self, cycle: u64);

    /// The cycle at which [`Io::advance`] must be called at the latest; 0 if an interrupt is pending and
    /// `interrupts_enabled`, or the run is to pause.
    fn deadline(&self, interrupts_enabled: bool) -> u64;

    /// Whether something has happened for which the caller wants the run to pause; clears the flag.
    fn take_notice(&mut self) -> bool {
        false
    }

    /// What the peripherals demand of the CPU before it continues; clears the demand. Until then [`Io::deadline`] is 0.
    fn take_demand(&mut self) -> Option<Demand> {
        None
    }

    /// The pending and enabled interrupt of the highest priority.
    fn pending(&self) -> Option<u8>;

    /// The CPU enters this interrupt's routine.
    fn acknowledge(&mut self, vector: u8, cycle: u64);

    /// Where the interrupt vectors start [words]: 0, or the boot section.
    fn vector_base(&self) -> u32;

    /// SLEEP; returns whether sleeping is enabled.
    fn sleep(&mut self, cycle: u64) -> bool;

    /// The CPU wakes up; returns the cycles until its clock runs.
    fn wake(&mut self, _: u64) -> u64 {
        0
    }

    /// WDR.
    fn reset_watchdog(&mut self, cycle: u64);

    /// SPM at a byte address with r1:r0.
    fn store_program(&mut self, address: u32, value: u16, at: Access) -> Stored;

    /// LPM at a byte address, once a program has written SPMCSR: what it reads there if that is not the program.
    fn load_program(&mut self, _: u32, _: Access) -> Option<u8> {
        None
    }
}
