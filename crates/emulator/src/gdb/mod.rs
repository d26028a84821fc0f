//! GDB's remote protocol: `avr-gdb` breaks, steps and reads variables of a program on the chip.
//!
//! The crate `gdbstub` speaks the protocol; here is what it does not know: the AVR ([`arch`]) and what its requests mean for
//! the chip (`target`). Time passes on the chip, and for all around it, only while the program runs: [`Machine`] is whoever
//! has the chip, and moves the rest of the world along with it.
//!
//! Source: GDB's manual, appendix "Remote Serial Protocol"; the places of the memories are the toolchain's (see `image`).

pub mod arch;
mod session;
mod target;

use crate::chip::Chip;
use crate::cpu::Stopped;
use gdbstub::stub::{DisconnectReason, GdbStub};
pub use session::{Progress, Session};
use std::io;
use std::net::TcpStream;
use target::{Debugger, Events};

/// A chip with all that is connected to it.
pub trait Machine {
    /// The chip.
    fn chip(&self) -> &Chip;

    /// The chip, to change it while it stands.
    fn chip_mut(&mut self) -> &mut Chip;

    /// Goes on for some milliseconds of the chip's time, or until the program stops; what is connected goes along.
    fn go(&mut self) -> Stopped;

    /// One instruction, also where a breakpoint stands; what is connected goes along.
    fn step(&mut self) -> Stopped;

    /// The run is over: there is nothing to go on with.
    fn is_over(&self) -> bool {
        false
    }
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

/// Whoever has a machine for a while.
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

/// How a debugger's visit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Farewell {
    /// It left; the program goes on without it.
    Detached,
    /// It ended the program, or the program ended itself.
    Ended,
}

/// Serves a debugger until it leaves. The program stands at the beginning.
///
/// # Errors
/// The connection broke, or the debugger broke the protocol.
pub fn serve<M: Machine>(machine: &mut M, connection: TcpStream) -> io::Result<Farewell> {
    let mut debugger = Debugger::new(machine);
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
