//! The native robot's inputs in a scenario, for replay on another one.

use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_control::{Edges, Inputs, Micros, TICK_US};
use rumbo_experiment::files::{FileError, Library, Overrides};
use rumbo_experiment::run::{prepare, run_by};
use rumbo_sim::Latched;
use rumbo_sim::wire_fault::TimedWireFault;
use rumbo_wire::{Command, FrameMessage, RobotTime, ToRobot};

/// Bytes that fit into a tick beside other traffic.
const BYTES_PER_TICK: usize = 40;

/// Ticks after which sonars that ping in turn, three, two or one of them, are back at the first.
const ROUND: u32 = 36;

/// A recorded run, with its parameters sent over the link before it begins.
pub(crate) struct Tape {
    pub(crate) mode: ModeId,
    parameters: Vec<u8>,
    run: Vec<Latched>,
}

impl Tape {
    /// Runs a scenario natively, with these faults and parameters.
    pub(crate) fn of(
        scenario: &str,
        seed: u64,
        faults: &[TimedWireFault],
        parameters: &[(ParamId, f32)],
    ) -> Tape {
        let library = Library::new();
        let mut setup = library.setup(scenario, &Overrides::default()).unwrap();
        setup.scenario.wire_faults = faults.to_vec();
        setup.scenario.parameters.extend(parameters);
        let mut run_of = Vec::new();
        run_by(&setup, seed, |run| {
            run.sim().record_inputs();
            while !run.is_over() {
                run.advance();
            }
            run_of = run.sim().take_inputs();
            Ok::<(), FileError>(())
        })
        .unwrap();
        let setup = setup.of_seed(seed).unwrap();
        let setup = prepare(&setup, seed).unwrap();
        let values = setup.control_parameters().unwrap();
        let commands = values
            .iter()
            .enumerate()
            .map(|(number, (id, value))| set(number, *id, *value));
        Tape {
            mode: setup.scenario.mode,
            parameters: commands.flatten().collect(),
            run: run_of,
        }
    }

    /// Ticks before the run; the sonars ping in turn, so whole rounds of them: else the answers came from others.
    fn before(&self) -> u32 {
        (self.parameters.len().div_ceil(BYTES_PER_TICK) as u32 + 1).next_multiple_of(ROUND)
    }

    /// Its number of ticks.
    pub(crate) fn ticks(&self) -> u32 {
        self.before() + self.run.len() as u32
    }

    fn latched(&self, tick: u32) -> Option<&Latched> {
        let index = tick.checked_sub(self.before() + 1)?;
        self.run.get(index as usize)
    }

    /// The latched inputs of a tick, the first one being 1.
    pub(crate) fn inputs(&self, tick: u32) -> Inputs {
        let before_us = (self.before() + 1) * TICK_US;
        let later = |at: Micros| at.after(before_us);
        let edges = |edges: Edges| Edges {
            last: later(edges.last),
            ..edges
        };
        match self.latched(tick) {
            None => Inputs {
                now: Micros(tick * TICK_US),
                ..Inputs::default()
            },
            Some(Latched { inputs, .. }) => {
                let mut inputs = *inputs;
                inputs.now = later(inputs.now);
                inputs.encoders.left = edges(inputs.encoders.left);
                inputs.encoders.right = edges(inputs.encoders.right);
                inputs
            }
        }
    }

    /// The bytes that are received after a tick and before the next one.
    pub(crate) fn bytes(&self, tick: u32) -> Vec<u8> {
        match self.latched(tick + 1) {
            Some(latched) => latched.received.clone(),
            None => {
                let from = (tick as usize - 1) * BYTES_PER_TICK;
                let parameters = self.parameters.iter().skip(from);
                parameters.take(BYTES_PER_TICK).copied().collect()
            }
        }
    }
}

fn set(number: usize, id: ParamId, value: f32) -> Vec<u8> {
    let command = ToRobot::Command {
        session: 200,
        number: number as u16 + 1,
        command: Command::SetParam {
            id: id as u8,
            value,
        },
        // They arrive long before they are too old.
        seen: RobotTime::default(),
    };
    command.frame(number as u8).bytes().to_vec()
}
