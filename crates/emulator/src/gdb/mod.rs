//! GDB's remote protocol: `avr-gdb` breaks, steps and reads variables of a program on the chip.
//!
//! The crate `gdbstub` implements the protocol; this module adds the AVR ([`arch`]) and what its requests mean for the
//! chip (`target`). Time passes on the chip and around it only while the program runs: a [`Machine`] owns the chip and
//! advances the rest of the world with it.
//!
//! Source: GDB's manual, appendix "Remote Serial Protocol"; the places of the memories are the toolchain's (see `image`).

pub mod arch;
mod session;
mod target;

use crate::chip::Chip;
use crate::cpu::Stopped;
use gdbstub::stub::{DisconnectReason, GdbStub};
pub use session::{GdbSession, Progress};
use std::io;
use std::net::TcpStream;
use target::{Events, GdbTarget};

/// A chip with all that is connected to it.
pub trait Machine {
    /// The chip.
    fn chip(&self) -> &Chip;

    /// The chip, to change it while it stands.
    fn chip_mut(&mut self) -> &mut Chip;

    /// Runs for some milliseconds of the chip's time, or until the program stops, together with what is connected.
    fn go(&mut self) -> Stopped;

    /// Runs one instruction, even at a breakpoint, together with what is connected.
    fn step(&mut self) -> Stopped;

    /// The run is over: nothing can continue.
    fn is_over(&self) -> bool {
        false
    }
}

/// A chip with its world. A clone is a snapshot, which continues bit for bit the same.
pub trait DebuggedWorld: Machine + Clone {
    /// From now on halts at this cycle of the crystal, if any.
    fn halt_at(&mut self, cycle: Option<u64>);

    /// Runs like [`Machine::go`], at most to this cycle.
    fn go_to(&mut self, cycle: u64) -> Stopped {
        self.halt_at(Some(cycle));
        let stopped = self.go();
        self.halt_at(None);
        stopped
    }

    /// Simulated time [us].
    fn now_us(&self) -> u64;

    /// What the program has sent since the last call, each with the number of its stream: 0 is the USB port.
    fn take_output(&mut self) -> Vec<(u8, Vec<u8>)>;

    /// Sends bytes to the USB port.
    fn type_in(&mut self, bytes: &[u8]);

    /// The board's pins that are named, and their levels.
    fn pins(&self) -> Vec<(String, bool)>;
}

/// A chip with nothing connected to it.
impl Machine for Chip {
    fn chip(&self) -> &Chip {
        self
    }

    fn chip_mut(&mut self) -> &mut Chip {
        self
    }

    fn go(&mut self) -> Stopped {
        let stopped = self.run_until(Chip::cycle(self) + MILLISECOND);
        self.take_outputs();
        stopped
    }

    fn step(&mut self) -> Stopped {
        let stopped = Chip::step(self);
        self.take_outputs();
        stopped
    }
}

/// Owned or borrowed access to a machine.
impl<M: Machine> Machine for &mut M {
    fn chip(&self) -> &Chip {
        (**self).chip()
    }

    fn chip_mut(&mut self) -> &mut Chip {
        (**self).chip_mut()
    }

    fn go(&mut self) -> Stopped {
        (**self).go()
    }

    fn step(&mut self) -> Stopped {
        (**self).step()
    }

    fn is_over(&self) -> bool {
        (**self).is_over()
    }
}

/// In cycles of a crystal of 16 MHz.
const MILLISECOND: u64 = 16_000;

/// How a debugging session ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Farewell {
    /// The debugger detached; the program continues without it.
    Detached,
    /// It ended the program, or the program ended itself.
    Ended,
}

/// Serves a debugger until it leaves. The program is halted at first.
///
/// # Errors
/// The connection broke, or the debugger broke the protocol.
pub fn serve<M: Machine>(machine: &mut M, connection: TcpStream) -> io::Result<Farewell> {
    let mut debugger = GdbTarget::new(machine);
    let stub = GdbStub::new(connection);
    let reason = stub
        .run_blocking::<Events<&mut M>>(&mut debugger)
        .map_err(|error| io::Error::other(format!("debugger: {error}")))?;
    debugger.clear();
    Ok(match reason {
        DisconnectReason::Disconnect => Farewell::Detached,
        _ => Farewell::Ended,
    })
}
