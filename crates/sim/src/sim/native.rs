//! Our robot as it runs on this machine: its ticks, and what stands for the chip's interrupts and timers.

use super::Sim;
use crate::board::{Board, micros};
use crate::error::SimError;
use crate::wire_fault::Wire;
use crate::wiring::Divider;
use rumbo_control::drive::DriveLayer;
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_control::{Fault, Inputs, OUTPUT_DELAY_US, Outputs, ServoAngle, TICK_US, Wheels};
use rumbo_plant::plant::Event;
use rumbo_robot::{Cell, Loops, Robot, RobotConfig, START_AT};
use rumbo_wire::{Ack, Command, FrameMessage, Refusal, ResetCause, Telemetry, ToRobot};
use std::sync::Arc;

/// The converter's reference, the chip's supply [V].
const CONVERTER_V: f64 = 5.0;
/// Session of the commands of a caller without a link.
pub(super) const SESSION: u8 = 0;

/// The EEPROM's bytes; what has never been written is missing at the end.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory(pub(super) Vec<u8>);

impl Memory {
    fn read(&self, address: u16) -> u8 {
        self.0.get(usize::from(address)).copied().unwrap_or(0xFF)
    }

    fn write(&mut self, cell: Cell) {
        let at = usize::from(cell.address);
        if self.0.len() <= at {
            self.0.resize(at + 1, 0xFF);
        }
        if let Some(byte) = self.0.get_mut(at) {
            *byte = cell.value;
        }
    }
}

/// The robot, and the outputs and conversions that are pending.
#[derive(Clone, Debug)]
pub(super) struct Native {
    robot: Robot,
    /// Its drive layer before the last tick.
    before: DriveLayer,
    /// It receives the commands sent to another robot.
    is_ghost: bool,
    pub(super) board: Board,
    /// Its battery's divider.
    pub(super) divider: Option<Divider>,
    /// The conversion that was begun at the last tick: of which input, and what it gives.
    converted: Option<(u8, u16)>,
    /// Its EEPROM.
    pub(super) memory: Memory,
    /// The network of mode 9.
    network: Arc<[u8]>,
    pub(super) next_tick_us: u64,
    /// Outputs and when they take effect.
    pub(super) pending: Option<(u64, Outputs)>,
    /// Its inputs, while they are recorded.
    pub(super) recorded: Option<Vec<Latched>>,
    /// Commands come from the caller; the link is silent.
    pub(super) is_unlinked: bool,
    /// Servo angle set by that caller instead of the mode.
    pub(super) aim: Option<ServoAngle>,
    /// The shares of the full PWM that the caller gives the wheels, in place of the mode.
    pub(super) duty: Option<Wheels<f32>>,
    /// How many of that caller's commands were acknowledged, wrapping.
    answered: u16,
}

/// What the robot is given at a tick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Latched {
    /// Bytes that it receives before the tick.
    pub received: Vec<u8>,
    /// What latched at the tick.
    pub inputs: Inputs,
}

impl Native {
    /// A robot with what its EEPROM holds, then these parameters, later ones in place of earlier ones; beside its program
    /// lies this network.
    pub(super) fn new<'a>(
        mut memory: Memory,
        network: Arc<[u8]>,
        parameters: impl IntoIterator<Item = &'a (ParamId, f32)>,
    ) -> Result<Self, SimError> {
        // As the firmware counts its starts.
        let start = memory.read(START_AT).wrapping_add(1);
        memory.write(Cell {
            address: START_AT,
            value: start,
        });
        let mut robot = Robot::new(RobotConfig {
            image: 0,
            reset: ResetCause::PowerOn,
            start,
        });
        robot.recall(|address| memory.read(address));
        robot.learn(|at| byte(&network, at));
        for (id, value) in parameters {
            set_param(&mut robot, *id, *value)?;
        }
        Ok(Self {
            robot,
            before: DriveLayer::default(),
            is_ghost: false,
            board: Board::default(),
            divider: None,
            converted: None,
            memory,
            network,
            next_tick_us: 0,
            pending: None,
            recorded: None,
            is_unlinked: false,
            aim: None,
            duty: None,
            answered: 0,
        })
    }

    /// Sets the estimated pose.
    pub(super) fn set_pose(&mut self, pose: rumbo_control::Pose) {
        self.robot.set_pose(pose);
    }

    pub(super) fn be_ghost(&mut self) {
        self.is_ghost = true;
    }

    /// When it next does something, at most `until_us`.
    pub(super) fn next_us(&self, until_us: u64) -> u64 {
        let next_us = self.next_tick_us.min(until_us);
        match self.pending {
            Some((at_us, _)) => next_us.min(at_us),
            None => next_us,
        }
    }

    /// Applies a command that did not come over the link.
    pub(super) fn order(&mut self, command: &Command) -> Result<f32, Refusal> {
        self.robot.order(command)
    }

    /// Acknowledges the last such command, and numbers it.
    pub(super) fn answer(&mut self, result: Result<f32, Refusal>) -> u16 {
        self.answered = self.answered.wrapping_add(1);
        self.robot.acknowledge(Ack {
            session: SESSION,
            number: self.answered,
            result,
        });
        self.answered
    }

    /// All bytes that are queued for the link.
    pub(super) fn said(&mut self) -> Vec<u8> {
        std::iter::from_fn(|| self.robot.transmit()).collect()
    }

    /// Makes it send HELLO; bytes queued before are dropped.
    pub(super) fn greet(&mut self) {
        self.said();
        let hello = ToRobot::Hello.frame(0);
        let bytes = hello.bytes().iter();
        bytes.for_each(|byte| self.robot.receive(*byte));
    }

    pub(super) fn knowledge(&self) -> Telemetry {
        self.robot.knowledge()
    }

    pub(super) fn loops(&self) -> Loops {
        self.robot.loops(&self.before)
    }

    pub(super) fn fault(&self) -> Option<Fault> {
        self.robot.fault()
    }

    pub(super) fn mode_state(&self) -> Option<(ModeId, u8)> {
        self.robot.mode_state()
    }
}

impl Native {
    /// The battery's voltage as the chip's converter finds it: begun at a tick, read at the next one.
    fn convert(&mut self, battery_v: impl Fn() -> f64) -> Option<f32> {
        let input = self.robot.battery_input()?;
        let volts = match self.divider {
            Some(divider) if divider.input == input => battery_v() / divider.ratio,
            _ => 0.0,
        };
        let counts = (volts / CONVERTER_V * 1_024.0).clamp(0.0, 1_023.0) as u16;
        let last = self.converted.replace((input, counts))?;
        (last.0 == input).then(|| self.robot.battery_v(last.1))
    }
}

/// A byte beside the program, erased where there is nothing.
fn byte(network: &[u8], at: u16) -> u8 {
    network.get(usize::from(at)).copied().unwrap_or(0xFF)
}

fn set_param(robot: &mut Robot, id: ParamId, value: f32) -> Result<(), SimError> {
    robot
        .set_param(id as u8, value)
        .map(|_| ())
        .map_err(|refusal| SimError::Parameter { id, value, refusal })
}

impl Sim {
    /// Advances robot and plant to this time [us].
    pub(super) fn advance_native(&mut self, native: &mut Native, until_us: u64) {
        while !self.act_native(native, until_us) {
            self.sense(native, native.next_us(until_us));
        }
    }

    /// Lets the robot do what is due now; true if this is the time to advance to.
    pub(super) fn act_native(&mut self, native: &mut Native, until_us: u64) -> bool {
        let now_us = self.now_us();
        if let Some((at_us, outputs)) = native.pending
            && at_us == now_us
        {
            native.pending = None;
            self.apply(native, &outputs);
        }
        if native.next_tick_us == now_us && now_us < until_us {
            self.tick(native);
        }
        now_us == until_us
    }

    /// Advances the plant to this time, and latches the edges that its wires bring to the board.
    fn sense(&mut self, native: &mut Native, until_us: u64) {
        if self.wire_faults.is_empty() {
            self.advance_plant(until_us, &mut |event| native.board.handle(event));
            return;
        }
        let from_us = self.now_us();
        let mut events = Vec::new();
        self.advance_plant(until_us, &mut |event| events.push(event));
        let (faults, noise) = (&mut self.wire_faults, &self.noise);
        events.retain(|event| {
            let edge = Wire::of(event);
            edge.is_none_or(|(wire, _)| faults.passes(noise, wire, event.at_us()))
        });
        let milliseconds = from_us.div_ceil(1_000)..until_us.div_ceil(1_000);
        for (begin_us, end_us, wire) in milliseconds.flat_map(|ms| faults.pulses(noise, ms * 1_000))
        {
            // An echo line that is disturbed while it rests is a short pulse; the board takes the first one.
            events.push(wire.edge(begin_us, true));
            events.push(wire.edge(end_us, false));
        }
        events.sort_by_key(Event::at_us);
        for event in events {
            native.board.handle(event);
        }
    }

    /// Hands the robot the bytes that have come; gives those that are recorded.
    fn take_uplink(&mut self, native: &mut Native, now_us: u64) -> Vec<u8> {
        let mut received = Vec::new();
        if native.is_unlinked {
            native.robot.stay_alive();
        }
        while let Some((_, byte)) = self.uplink.pop(now_us) {
            if native.is_ghost {
                native.robot.receive_as_ghost(byte);
            } else {
                native.robot.receive(byte);
            }
            if native.recorded.is_some() {
                received.push(byte);
            }
        }
        received
    }

    fn tick(&mut self, native: &mut Native) {
        let now_us = self.now_us();
        let received = self.take_uplink(native, now_us);
        let echo = native
            .board
            .echo(now_us)
            .map(|answer| self.sonar_faults.answer(&self.noise, answer, now_us));
        let battery_v = native.convert(|| self.plant.battery_v(&self.state));
        let inputs = Inputs {
            now: micros(now_us),
            encoders: native.board.encoders(),
            echo,
            battery_v,
        };
        native.before = *native.robot.drive_layer();
        if let Some(duty) = native.duty {
            native.robot.request_duty(duty);
        }
        let outputs = native.robot.tick_aiming(&inputs, native.aim);
        if let Some(recorded) = &mut native.recorded {
            recorded.push(Latched { received, inputs });
        }
        if native.is_unlinked && !self.is_tapped() {
            native.robot.think();
        } else {
            native.robot.report();
        }
        native.robot.decide(|at| byte(&native.network, at));
        // A byte takes 3.4 ms: the one before is written.
        if let Some(cell) = native.robot.store() {
            native.memory.write(cell);
        }
        native.pending = Some((now_us + u64::from(OUTPUT_DELAY_US), outputs));
        native.next_tick_us += u64::from(TICK_US);
        if native.is_unlinked {
            if self.is_tapped() {
                self.overhear(native);
            }
            return;
        }
        // The transmit interrupt hands a byte to the line whenever the line is free.
        let waiting = std::iter::from_fn(|| native.robot.transmit());
        self.downlink
            .send_before(now_us, native.next_tick_us, waiting);
    }

    /// Passes the bytes of a robot without a link to the tap. Cold: most robots have no tap.
    #[cold]
    fn overhear(&mut self, native: &mut Native) {
        self.note(false, &native.said());
    }

    fn apply(&mut self, native: &mut Native, outputs: &Outputs) {
        self.set_bridges(outputs.drive);
        self.plant
            .set_servo(&mut self.state, f64::from(outputs.servo.0));
        if let Some(sonar) = outputs.ping {
            self.trigger(sonar);
            native.board.pinged(sonar, self.state.now_us());
        }
    }
}
