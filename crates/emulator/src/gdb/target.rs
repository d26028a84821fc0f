//! What a debugger's requests mean for the chip.
//!
//! | address | memory |
//! |---|---|
//! | 0 to 0x3FFFF | flash |
//! | 0x800000 | data space: registers, peripherals, SRAM |
//! | 0x810000 | EEPROM |
//! | 0x840000 | signature |

use super::Machine;
use super::arch::{Avr, AvrRegisters};
use crate::cpu::Stopped;
use crate::observe::Watchpoint;
use crate::space::{DATA, Place};
use crate::status::Status;
use crate::verdict::Verdict;
use gdbstub::common::Signal;
use gdbstub::conn::{Connection, ConnectionExt};
use gdbstub::stub::SingleThreadStopReason;
use gdbstub::stub::run_blocking::{BlockingEventLoop, Event, WaitForStopReasonError};
use gdbstub::target::ext::base::BaseOps;
use gdbstub::target::ext::base::singlethread::{
    SingleThreadBase, SingleThreadRangeStepping, SingleThreadRangeSteppingOps, SingleThreadResume,
    SingleThreadResumeOps, SingleThreadSingleStep, SingleThreadSingleStepOps,
};
use gdbstub::target::ext::breakpoints::{
    Breakpoints, BreakpointsOps, HwBreakpoint, HwBreakpointOps, HwWatchpoint, HwWatchpointOps,
    SwBreakpoint, SwBreakpointOps, WatchKind,
};
use gdbstub::target::ext::monitor_cmd::{ConsoleOutput, MonitorCmd, MonitorCmdOps, outputln};
use gdbstub::target::ext::target_description_xml_override::{
    TargetDescriptionXmlOverride, TargetDescriptionXmlOverrideOps,
};
use gdbstub::target::{Target, TargetError, TargetResult};
use std::convert::Infallible;
use std::marker::PhantomData;
use std::net::TcpStream;
use std::ops::Range;

/// "Bad address", as GDB's protocol numbers it.
const EFAULT: u8 = 14;
/// Steps between two polls of the connection.
const STEPS: u32 = 10_000;

/// How the debugger wants the program to continue.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Motion {
    Continue,
    Step,
    /// Steps as long as the program counter [bytes] is in here.
    Within(Range<u32>),
}

/// A machine in the hands of a debugger.
pub(super) struct GdbTarget<M> {
    pub(super) machine: M,
    motion: Motion,
    /// It stands, perhaps at a breakpoint.
    stands: bool,
    breakpoints: Vec<u32>,
    watchpoints: Vec<Watchpoint>,
}

impl<M: Machine> GdbTarget<M> {
    pub(super) fn new(machine: M) -> Self {
        GdbTarget {
            machine,
            motion: Motion::Continue,
            stands: true,
            breakpoints: Vec::new(),
            watchpoints: Vec::new(),
        }
    }

    /// Removes what the debugger left behind.
    pub(super) fn clear(&mut self) {
        for word in std::mem::take(&mut self.breakpoints) {
            self.machine.chip_mut().cpu_mut().clear_breakpoint(word);
        }
        for watchpoint in std::mem::take(&mut self.watchpoints) {
            self.machine.chip_mut().observers_mut().unwatch(&watchpoint);
        }
    }

    fn set_off(&mut self, motion: Motion) {
        self.motion = motion;
        self.stands = true;
    }

    fn program_counter(&self) -> u32 {
        2 * self.machine.chip().cpu().program_counter()
    }

    /// Runs the program until it stops, or `interrupted` reports that the debugger has sent something.
    fn go(&mut self, mut interrupted: impl FnMut() -> bool) -> Option<SingleThreadStopReason<u32>> {
        let mut steps = 0;
        loop {
            if let Some(reason) = self.go_on() {
                return Some(reason);
            }
            steps += 1;
            if (self.motion == Motion::Continue || steps % STEPS == 0) && interrupted() {
                return None;
            }
        }
    }

    /// Runs the program for a while; returns why it stopped, if it did.
    pub(super) fn go_on(&mut self) -> Option<SingleThreadStopReason<u32>> {
        let stopped = if std::mem::take(&mut self.stands) {
            // Off a breakpoint at which it may stand.
            self.machine.step()
        } else {
            match &self.motion {
                Motion::Step if !self.machine.chip().cpu().is_sleeping() => {
                    return Some(SingleThreadStopReason::DoneStep);
                }
                Motion::Within(range) if !range.contains(&self.program_counter()) => {
                    return Some(SingleThreadStopReason::DoneStep);
                }
                Motion::Continue => self.machine.go(),
                Motion::Step | Motion::Within(_) => self.machine.step(),
            }
        };
        self.stop_reason(stopped).or_else(|| {
            self.machine
                .is_over()
                .then_some(SingleThreadStopReason::Exited(0))
        })
    }

    /// What to report to the debugger about a stop, if it was one.
    fn stop_reason(&self, stopped: Stopped) -> Option<SingleThreadStopReason<u32>> {
        match stopped {
            Stopped::Reached | Stopped::Output => None,
            Stopped::Breakpoint => Some(SingleThreadStopReason::SwBreak(())),
            Stopped::Watched {
                address,
                watchpoint,
            } => Some(SingleThreadStopReason::Watch {
                tid: (),
                kind: match (watchpoint.reads, watchpoint.writes) {
                    (true, true) => WatchKind::ReadWrite,
                    (true, false) => WatchKind::Read,
                    (false, _) => WatchKind::Write,
                },
                addr: DATA + u32::from(address),
            }),
            Stopped::Ended(Verdict::StackOverflow { .. }) => {
                Some(SingleThreadStopReason::Signal(Signal::SIGSEGV))
            }
            Stopped::Ended(_) => Some(SingleThreadStopReason::Signal(Signal::SIGILL)),
        }
    }
}

impl<M: Machine> Target for GdbTarget<M> {
    type Arch = Avr;
    type Error = Infallible;

    fn base_ops(&mut self) -> BaseOps<'_, Avr, Infallible> {
        BaseOps::SingleThread(self)
    }

    fn support_target_description_xml_override(
        &mut self,
    ) -> Option<TargetDescriptionXmlOverrideOps<'_, Self>> {
        Some(self)
    }

    fn support_breakpoints(&mut self) -> Option<BreakpointsOps<'_, Self>> {
        Some(self)
    }

    fn support_monitor_cmd(&mut self) -> Option<MonitorCmdOps<'_, Self>> {
        Some(self)
    }
}

impl<M: Machine> TargetDescriptionXmlOverride for GdbTarget<M> {
    fn target_description_xml(
        &self,
        annex: &[u8],
        offset: u64,
        length: usize,
        buf: &mut [u8],
    ) -> TargetResult<usize, Self> {
        if annex != b"target.xml" {
            return Err(TargetError::NonFatal);
        }
        let architecture = self.machine.chip().model().architecture;
        let xml = format!(
            r#"<target version="1.0"><architecture>avr:{architecture}</architecture></target>"#
        );
        let rest = xml.as_bytes().get(offset as usize..).unwrap_or_default();
        let bytes = rest.len().min(length).min(buf.len());
        buf[..bytes].copy_from_slice(&rest[..bytes]);
        Ok(bytes)
    }
}

impl<M: Machine> SingleThreadBase for GdbTarget<M> {
    fn read_registers(&mut self, registers: &mut AvrRegisters) -> TargetResult<(), Self> {
        let cpu = self.machine.chip().cpu();
        *registers = AvrRegisters {
            general: *cpu.registers(),
            status: cpu.status().bits(),
            stack_pointer: cpu.stack_pointer(),
            program_counter: self.program_counter(),
        };
        Ok(())
    }

    fn write_registers(&mut self, registers: &AvrRegisters) -> TargetResult<(), Self> {
        let cpu = self.machine.chip_mut().cpu_mut();
        *cpu.registers_mut() = registers.general;
        cpu.set_status(Status::from_bits(registers.status));
        cpu.set_stack_pointer(registers.stack_pointer);
        cpu.set_program_counter(registers.program_counter / 2);
        Ok(())
    }

    fn read_addrs(&mut self, start: u32, data: &mut [u8]) -> TargetResult<usize, Self> {
        let mut read = 0;
        for (place, address) in data.iter_mut().zip(start..) {
            let Some(byte) = self.machine.chip().read_space(address) else {
                break;
            };
            *place = byte;
            read += 1;
        }
        if read == 0 {
            return Err(TargetError::Errno(EFAULT));
        }
        Ok(read)
    }

    fn write_addrs(&mut self, start: u32, data: &[u8]) -> TargetResult<(), Self> {
        for (byte, address) in data.iter().zip(start..) {
            if !self.machine.chip_mut().write_space(address, *byte) {
                return Err(TargetError::Errno(EFAULT));
            }
        }
        Ok(())
    }

    fn support_resume(&mut self) -> Option<SingleThreadResumeOps<'_, Self>> {
        Some(self)
    }
}

impl<M: Machine> SingleThreadResume for GdbTarget<M> {
    fn resume(&mut self, _: Option<Signal>) -> Result<(), Infallible> {
        self.set_off(Motion::Continue);
        Ok(())
    }

    fn support_single_step(&mut self) -> Option<SingleThreadSingleStepOps<'_, Self>> {
        Some(self)
    }

    fn support_range_step(&mut self) -> Option<SingleThreadRangeSteppingOps<'_, Self>> {
        Some(self)
    }
}

impl<M: Machine> SingleThreadSingleStep for GdbTarget<M> {
    fn step(&mut self, _: Option<Signal>) -> Result<(), Infallible> {
        self.set_off(Motion::Step);
        Ok(())
    }
}

impl<M: Machine> SingleThreadRangeStepping for GdbTarget<M> {
    fn resume_range_step(&mut self, start: u32, end: u32) -> Result<(), Infallible> {
        self.set_off(Motion::Within(start..end));
        Ok(())
    }
}

impl<M: Machine> Breakpoints for GdbTarget<M> {
    fn support_sw_breakpoint(&mut self) -> Option<SwBreakpointOps<'_, Self>> {
        Some(self)
    }

    fn support_hw_breakpoint(&mut self) -> Option<HwBreakpointOps<'_, Self>> {
        Some(self)
    }

    fn support_hw_watchpoint(&mut self) -> Option<HwWatchpointOps<'_, Self>> {
        Some(self)
    }
}

impl<M: Machine> SwBreakpoint for GdbTarget<M> {
    fn add_sw_breakpoint(&mut self, address: u32, _: usize) -> TargetResult<bool, Self> {
        if !matches!(self.machine.chip().place(address), Some(Place::Flash(_))) {
            return Ok(false);
        }
        let word = address / 2;
        self.breakpoints.push(word);
        self.machine.chip_mut().cpu_mut().set_breakpoint(word);
        Ok(true)
    }

    fn remove_sw_breakpoint(&mut self, address: u32, _: usize) -> TargetResult<bool, Self> {
        let word = address / 2;
        let known = self.breakpoints.contains(&word);
        self.breakpoints.retain(|other| *other != word);
        self.machine.chip_mut().cpu_mut().clear_breakpoint(word);
        Ok(known)
    }
}

impl<M: Machine> HwBreakpoint for GdbTarget<M> {
    fn add_hw_breakpoint(&mut self, address: u32, kind: usize) -> TargetResult<bool, Self> {
        self.add_sw_breakpoint(address, kind)
    }

    fn remove_hw_breakpoint(&mut self, address: u32, kind: usize) -> TargetResult<bool, Self> {
        self.remove_sw_breakpoint(address, kind)
    }
}

impl<M: Machine> GdbTarget<M> {
    /// Data addresses that are watched; `None` if they are not in the data space.
    fn watchpoint(&self, address: u32, length: u32, kind: WatchKind) -> Option<Watchpoint> {
        let Place::Data(start) = self.machine.chip().place(address)? else {
            return None;
        };
        let behind = usize::from(self.machine.chip().model().ram_end) + 1;
        let end = start.saturating_add(length as usize).min(behind);
        Some(Watchpoint {
            addresses: start as u16..end as u16,
            reads: kind != WatchKind::Write,
            writes: kind != WatchKind::Read,
        })
    }
}

impl<M: Machine> HwWatchpoint for GdbTarget<M> {
    fn add_hw_watchpoint(
        &mut self,
        address: u32,
        length: u32,
        kind: WatchKind,
    ) -> TargetResult<bool, Self> {
        let Some(watchpoint) = self.watchpoint(address, length, kind) else {
            return Ok(false);
        };
        self.watchpoints.push(watchpoint.clone());
        self.machine.chip_mut().observers_mut().watch(watchpoint);
        Ok(true)
    }

    fn remove_hw_watchpoint(
        &mut self,
        address: u32,
        length: u32,
        kind: WatchKind,
    ) -> TargetResult<bool, Self> {
        let Some(watchpoint) = self.watchpoint(address, length, kind) else {
            return Ok(false);
        };
        self.watchpoints.retain(|other| *other != watchpoint);
        Ok(self.machine.chip_mut().observers_mut().unwatch(&watchpoint))
    }
}

impl<M: Machine> MonitorCmd for GdbTarget<M> {
    fn handle_monitor_cmd(
        &mut self,
        command: &[u8],
        mut out: ConsoleOutput<'_>,
    ) -> Result<(), Infallible> {
        let cpu = self.machine.chip().cpu();
        match command.trim_ascii() {
            b"cycle" => outputln!(out, "{}", cpu.cycle()),
            b"verdict" => match cpu.verdict() {
                Some(verdict) => outputln!(out, "{verdict}"),
                None => outputln!(out, "the program can go on"),
            },
            _ => outputln!(
                out,
                "cycle    cycles since power-on\nverdict  why the program cannot go on"
            ),
        }
        Ok(())
    }
}

/// How the protocol's loop gets at the program and the connection.
pub(super) struct Events<M>(PhantomData<M>);

impl<M: Machine> BlockingEventLoop for Events<M> {
    type Target = GdbTarget<M>;
    type Connection = TcpStream;
    type StopReason = SingleThreadStopReason<u32>;

    fn wait_for_stop_reason(
        debugger: &mut GdbTarget<M>,
        connection: &mut TcpStream,
    ) -> Result<
        Event<Self::StopReason>,
        WaitForStopReasonError<Infallible, <TcpStream as Connection>::Error>,
    > {
        let reason = debugger.go(|| !matches!(ConnectionExt::peek(connection), Ok(None)));
        match reason {
            Some(reason) => Ok(Event::TargetStopped(reason)),
            None => ConnectionExt::read(connection)
                .map(Event::IncomingData)
                .map_err(WaitForStopReasonError::Connection),
        }
    }

    fn on_interrupt(_: &mut GdbTarget<M>) -> Result<Option<Self::StopReason>, Infallible> {
        Ok(Some(SingleThreadStopReason::Signal(Signal::SIGINT)))
    }
}
