//! A debugging session served in turns, by a caller with other work in between.

use super::Machine;
use super::target::GdbTarget;
use gdbstub::common::Signal;
use gdbstub::conn::ConnectionExt;
use gdbstub::stub::state_machine::GdbStubStateMachine;
use gdbstub::stub::{GdbStub, SingleThreadStopReason};
use std::io;
use std::net::TcpStream;

/// What a turn was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// The program is halted, and the debugger has nothing more to send.
    Stands,
    /// The program went on for a while.
    Ran,
    /// The debugger is gone; what it left behind is removed.
    Gone,
}

type State<M> = GdbStubStateMachine<'static, GdbTarget<M>, TcpStream>;

/// A machine with a debugger at it.
pub struct GdbSession<M: Machine + 'static> {
    debugger: GdbTarget<M>,
    /// `None` once the debugger is gone.
    state: Option<State<M>>,
}

impl<M: Machine> GdbSession<M> {
    /// Halts the program until the debugger resumes it.
    ///
    /// # Errors
    /// The connection broke.
    pub fn new(machine: M, connection: TcpStream) -> io::Result<GdbSession<M>> {
        let mut debugger = GdbTarget::new(machine);
        let state = GdbStub::new(connection)
            .run_state_machine(&mut debugger)
            .map_err(|error| io::Error::other(format!("debugger: {error}")))?;
        Ok(GdbSession {
            debugger,
            state: Some(state),
        })
    }

    /// The machine, to change it between two turns.
    pub fn machine_mut(&mut self) -> &mut M {
        &mut self.debugger.machine
    }

    /// Answers what the debugger has asked, and lets the program go on for a while if it may.
    pub fn turn(&mut self) -> Progress {
        while let Some(state) = self.state.take() {
            let next = match state {
                GdbStubStateMachine::Idle(mut stub) => match next_byte(stub.borrow_conn()) {
                    Ok(None) => {
                        self.state = Some(stub.into());
                        return Progress::Stands;
                    }
                    Ok(Some(byte)) => stub.incoming_data(&mut self.debugger, byte).ok(),
                    Err(_) => None,
                },
                GdbStubStateMachine::Running(mut stub) => match next_byte(stub.borrow_conn()) {
                    Ok(None) => match self.debugger.go_on() {
                        Some(reason) => stub.report_stop(&mut self.debugger, reason).ok(),
                        None => {
                            self.state = Some(stub.into());
                            return Progress::Ran;
                        }
                    },
                    Ok(Some(byte)) => stub.incoming_data(&mut self.debugger, byte).ok(),
                    Err(_) => None,
                },
                GdbStubStateMachine::CtrlCInterrupt(stub) => {
                    let reason = SingleThreadStopReason::Signal(Signal::SIGINT);
                    stub.interrupt_handled(&mut self.debugger, Some(reason))
                        .ok()
                }
                GdbStubStateMachine::Disconnected(_) => None,
            };
            self.state = next;
        }
        self.debugger.clear();
        Progress::Gone
    }
}

/// The next byte from the debugger, if it has come.
fn next_byte(connection: &mut TcpStream) -> io::Result<Option<u8>> {
    match ConnectionExt::peek(connection)? {
        None => Ok(None),
        Some(_) => ConnectionExt::read(connection).map(Some),
    }
}
