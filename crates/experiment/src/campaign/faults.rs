//! Sensors and wires that fail in the middle of a drive, many times over: contacts, their speed, and whether the robot
//! reported the cause.
//!
//! Each [`Failure`] is injected into each drive of [`DRIVES`] at each of its instants, once per seed. Contacts and
//! their speed are ground truth; the fault is the one sent over the link. A front sonar stuck at "nothing in range",
//! after a second in which nothing was in range, looks like free floor: those runs are a separate class
//! ([`Class::FreeFloor`]). With an image the chip fails too ([`ChipFailure`]).

use crate::files::{FileError, Library, Overrides, Setup};
use crate::run::{Run, prepare};
use rayon::prelude::*;
use rumbo_control::{Fault, SonarId};
use rumbo_emulator::devices::{Cause, Input};
use rumbo_plant::drivetrain::Side;
use rumbo_sim::Sim;
use rumbo_sim::sonar_fault::{SonarFault, TimedSonarFault};
use rumbo_sim::trace::Trace;
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};
use rumbo_wire::{EventKind, FromRobot};
use std::fmt;

/// Instants per drive.
pub const INSTANTS: usize = 5;
/// The drives, each with the instants at which something fails [s]: on the way, at a face, in a turn, between boxes.
pub const DRIVES: [(&str, [f64; INSTANTS]); 7] = [
    ("mode1", [0.8, 1.2, 1.6, 2.2, 5.7]),
    ("mode3", [1.0, 2.0, 5.0, 10.0, 20.0]),
    ("mode4-final", [1.0, 3.0, 7.8, 9.0, 15.0]),
    ("mode7", [1.5, 2.5, 4.0, 8.0, 12.0]),
    ("mode8-obstacles", [3.0, 4.5, 6.0, 8.0, 10.0]),
    ("mode8-lane", [1.5, 3.0, 5.0, 7.0, 10.0]),
    ("mode8-random", [2.0, 4.0, 6.0, 9.0, 14.0]),
];
/// A drive ends this long after the robot has reported a fault: it has rolled out [s].
const ROLLED_OUT_S: f64 = 3.0;
/// Or this long after it has reported its goal as reached or unreachable [s].
const ARRIVED_S: f64 = 1.0;
/// A front sonar with nothing in range for this long before it failed sees free floor [s].
const FREE_S: f64 = 1.0;
/// Fastest harmless contact [m/s].
pub const GENTLE_M_S: f64 = 0.1;
/// One run in this many may touch something.
pub const RUNS_PER_TOUCH: usize = 500;
/// One run in this many may touch something faster than [`GENTLE_M_S`]: what a sonar that has just fallen silent did not
/// show, or what stands beside a turn with an encoder that has just begun to lose most of its edges.
pub const RUNS_PER_HARD_TOUCH: usize = 5_000;
/// More friction than any motor has torque [N m].
const HELD_N_M: f64 = 2.0;

/// What fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// A sonar.
    Sonar(SonarId, SonarFault),
    /// A wire.
    Wire(Wire, WireFault),
    /// A wheel is held.
    Held(Side),
    /// The chip that the image runs on.
    Chip(ChipFailure),
}

/// What fails of the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChipFailure {
    /// The button is pressed, or the port of a serial adapter is opened.
    Reset,
    /// The supply dips.
    BrownOut,
    /// A tick hangs.
    Hang,
    /// The EEPROM holds nothing but zeros, and the chip is reset.
    Forgets,
}

/// Where a tick of our image can be stopped.
const IN_EACH_TICK: &str = "rumbo_inputs_latched";
/// A jump to itself.
const FOR_EVER: u16 = 0xCFFF;

impl ChipFailure {
    fn befall(self, sim: &mut Sim) {
        let Some(mega) = sim.mega_mut() else {
            return;
        };
        let place = mega.firmware().image().function_named(IN_EACH_TICK);
        let place = place.map(|function| function.address);
        let chip = mega.chip_mut();
        let reset = |cause| Input::Reset(cause);
        match self {
            Self::Reset => chip.input(chip.cycle(), reset(Cause::External)),
            Self::BrownOut => chip.input(chip.cycle(), reset(Cause::BrownOut)),
            Self::Hang => {
                if let Some(place) = place {
                    chip.cpu_mut().write_flash(place, FOR_EVER);
                }
            }
            Self::Forgets => {
                chip.devices_mut().eeprom_mut().fill(0);
                chip.input(chip.cycle(), reset(Cause::External));
            }
        }
    }
}

impl fmt::Display for ChipFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reset => "chip: reset",
            Self::BrownOut => "chip: brown-out",
            Self::Hang => "chip: a tick that hangs",
            Self::Forgets => "chip: EEPROM of zeros, and a reset",
        })
    }
}

impl Failure {
    /// Every failure of the campaign; those of the chip are for images.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let encoder = [
            WireFault::Low,
            WireFault::High,
            WireFault::Losing(0.1),
            WireFault::Losing(0.5),
            WireFault::Losing(0.6),
            WireFault::Losing(0.7),
            WireFault::Losing(0.8),
            WireFault::Losing(0.9),
            WireFault::Losing(0.95),
            WireFault::Losing(0.98),
            WireFault::Noisy(20.0),
            WireFault::Noisy(200.0),
            WireFault::Noisy(2_000.0),
        ];
        let echo = [
            WireFault::Low,
            WireFault::High,
            WireFault::Losing(0.3),
            WireFault::Noisy(200.0),
            WireFault::Noisy(2_000.0),
        ];
        let sonar = [
            SonarFault::Cut,
            SonarFault::Stuck,
            SonarFault::Clear,
            SonarFault::Spiking(0.1),
            SonarFault::Spiking(0.3),
            SonarFault::Spiking(0.5),
            SonarFault::Spiking(0.7),
            SonarFault::Spiking(0.9),
            SonarFault::Spiking(1.0),
        ];
        let wheels = [Side::Left, Side::Right].into_iter().flat_map(|side| {
            let wires = encoder.map(|fault| Self::Wire(Wire::Encoder(side), fault));
            wires.into_iter().chain([Self::Held(side)])
        });
        let sonars = SonarId::ALL.into_iter().rev().flat_map(|id| {
            let wires = echo.map(|fault| Self::Wire(Wire::Echo(id), fault));
            sonar
                .map(|fault| Self::Sonar(id, fault))
                .into_iter()
                .chain(wires)
        });
        let chip = [
            ChipFailure::Reset,
            ChipFailure::BrownOut,
            ChipFailure::Hang,
            ChipFailure::Forgets,
        ];
        let chip = chip.into_iter().map(Self::Chip);
        wheels.chain(sonars).chain(chip).collect()
    }

    /// Whether the robot carries what fails.
    fn befalls(self, setup: &Setup) -> bool {
        let mounted = |id: SonarId| match id {
            SonarId::Left => setup.rig.left.is_some(),
            SonarId::Right => setup.rig.right.is_some(),
            SonarId::Front => setup.rig.front.is_some(),
        };
        match self {
            Self::Sonar(id, _) | Self::Wire(Wire::Echo(id), _) => mounted(id),
            Self::Wire(Wire::Encoder(_), _) | Self::Held(_) => true,
            Self::Chip(_) => setup.firmware.is_some(),
        }
    }

    /// The same drive, with this failure.
    fn put_into(self, setup: &mut Setup, at_s: f64) {
        let scenario = &mut setup.scenario;
        scenario.sonar_faults.clear();
        scenario.wire_faults.clear();
        match self {
            Self::Sonar(sonar, fault) => {
                scenario
                    .sonar_faults
                    .push(TimedSonarFault { at_s, sonar, fault });
            }
            Self::Wire(wire, fault) => {
                scenario
                    .wire_faults
                    .push(TimedWireFault { at_s, wire, fault });
            }
            Self::Chip(_) | Self::Held(_) => {}
        }
    }

    /// What the scenario does not do: it befalls the drive now.
    fn befall(self, sim: &mut Sim) {
        match self {
            Self::Chip(failure) => failure.befall(sim),
            Self::Held(side) => sim.hold(side, HELD_N_M),
            Self::Sonar(..) | Self::Wire(..) => {}
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sonar = |id: &SonarId| match id {
            SonarId::Left => "left sonar",
            SonarId::Right => "right sonar",
            SonarId::Front => "front sonar",
        };
        let percent = |share: &f64| (100.0 * share).round();
        match self {
            Self::Sonar(id, SonarFault::Cut) => write!(f, "{}: cut", sonar(id)),
            Self::Sonar(id, SonarFault::Stuck) => write!(f, "{}: last answer for ever", sonar(id)),
            Self::Sonar(id, SonarFault::Clear) => {
                write!(f, "{}: nothing in reach for ever", sonar(id))
            }
            Self::Sonar(id, SonarFault::Spiking(share)) => {
                write!(f, "{}: {} % random", sonar(id), percent(share))
            }
            Self::Wire(wire, fault) => {
                match wire {
                    Wire::Encoder(Side::Left) => f.write_str("left encoder: ")?,
                    Wire::Encoder(Side::Right) => f.write_str("right encoder: ")?,
                    Wire::Echo(id) => write!(f, "{}, echo line: ", sonar(id))?,
                }
                match fault {
                    WireFault::Low => f.write_str("low"),
                    WireFault::High => f.write_str("high"),
                    WireFault::Losing(share) => write!(f, "loses {} %", percent(share)),
                    WireFault::Noisy(rate_hz) => write!(f, "{rate_hz} pulses/s of noise"),
                }
            }
            Self::Held(Side::Left) => f.write_str("left wheel: held"),
            Self::Held(Side::Right) => f.write_str("right wheel: held"),
            Self::Chip(failure) => failure.fmt(f),
        }
    }
}

/// Which requirement applies to a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The robot can detect the failure.
    Knowable,
    /// The sonar's last second and its false answer are both "nothing in range".
    FreeFloor,
}

/// How a robot reports that something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// By a fault.
    Fault(Fault),
    /// By reporting a restart of its program.
    Restart,
}

/// The outcome of one drive.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Index into [`DRIVES`].
    pub drive: usize,
    /// Its seed.
    pub seed: u64,
    /// When it failed [s].
    pub at_s: f64,
    /// What failed.
    pub failure: Failure,
    /// The requirement that applies.
    pub class: Class,
    /// When something was first touched after the failure [s], and the fastest touch of the run [m/s].
    pub touch: Option<(f64, f64)>,
    /// When the robot reported the failure, and how.
    pub named: Option<(f64, Named)>,
}

impl Drive {
    /// A contact faster than [`GENTLE_M_S`].
    #[must_use]
    pub fn touched_hard(&self) -> bool {
        self.touch.is_some_and(|(_, m_s)| m_s > GENTLE_M_S)
    }
}

/// Summary of the drives in which the robot could detect the failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// How many there were.
    pub runs: usize,
    /// In how many something was touched.
    pub touches: usize,
    /// Of these, faster than [`GENTLE_M_S`].
    pub hard: usize,
}

impl Verdict {
    /// Of these drives, without those of [`Class::FreeFloor`].
    #[must_use]
    pub fn of(drives: &[Drive]) -> Self {
        let knowable = drives.iter().filter(|drive| drive.class == Class::Knowable);
        let touches: Vec<&Drive> = knowable.clone().filter(|run| run.touch.is_some()).collect();
        let count = |of: &dyn Fn(&Drive) -> bool| touches.iter().filter(|run| of(run)).count();
        Self {
            runs: knowable.count(),
            touches: touches.len(),
            hard: count(&Drive::touched_hard),
        }
    }

    /// How many touches are allowed.
    #[must_use]
    pub fn allowed(&self) -> usize {
        self.runs / RUNS_PER_TOUCH
    }

    /// How many of them may be fast.
    #[must_use]
    pub fn allowed_hard(&self) -> usize {
        self.runs.div_ceil(RUNS_PER_HARD_TOUCH)
    }

    /// Whether no more happened than is allowed.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.touches <= self.allowed() && self.hard <= self.allowed_hard()
    }
}

/// Drives with everything that fails, on all cores.
///
/// `seeds` are those of each drive; `keep` chooses among drives by name and among failures. On an image if `overrides` name one.
///
/// # Errors
/// A setup that does not fit together, or a robot that cannot be calibrated.
pub fn drive_all(
    overrides: &Overrides,
    seeds: std::ops::Range<u64>,
    instants: usize,
    keep: impl Fn(&str, Failure) -> bool + Sync,
) -> Result<Vec<Drive>, FileError> {
    let library = Library::new();
    let setups = DRIVES.map(|(name, _)| library.setup(name, overrides));
    let mut jobs = Vec::new();
    for (drive, setup) in setups.into_iter().enumerate() {
        let setup = setup?;
        jobs.extend(seeds.clone().map(|seed| (drive, setup.clone(), seed)));
    }
    let drives: Result<Vec<Vec<Drive>>, FileError> = jobs
        .into_par_iter()
        .map(|(drive, setup, seed)| {
            let (name, instants_s) = DRIVES[drive];
            let failures: Vec<_> = Failure::all()
                .into_iter()
                .filter(|failure| failure.befalls(&setup) && keep(name, *failure))
                .collect();
            if failures.is_empty() {
                return Ok(Vec::new());
            }
            let mut own = prepare(&setup, seed)?.into_owned();
            let mut done = Vec::new();
            for at_s in instants_s.into_iter().take(instants) {
                for failure in &failures {
                    failure.put_into(&mut own, at_s);
                    done.push(one(&own, (drive, seed), at_s, *failure)?);
                }
            }
            Ok(done)
        })
        .collect();
    Ok(drives?.into_iter().flatten().collect())
}

/// One drive, until the robot has rolled out, has arrived, or the time is over.
fn one(
    setup: &Setup,
    (drive, seed): (usize, u64),
    at_s: f64,
    failure: Failure,
) -> Result<Drive, FileError> {
    let mut run = Run::new(setup, [setup], seed)?;
    let mut named = None;
    let mut end_s = f64::INFINITY;
    let mut read = 0;
    let mut pending = Some(failure);
    while !run.is_over() && run.sim().now_us() as f64 * 1e-6 < end_s {
        if run.sim().now_us() as f64 * 1e-6 >= at_s
            && let Some(failure) = pending.take()
        {
            failure.befall(run.sim());
            // A hung robot sends nothing.
            if matches!(failure, Failure::Chip(_)) {
                end_s = at_s + ROLLED_OUT_S;
            }
        }
        run.advance();
        let received = run.received();
        for message in received.get(read..).unwrap_or_default() {
            let kind = match message.what {
                FromRobot::Event(event) => event.kind,
                FromRobot::Hello(_) if message.t_s > at_s && named.is_none() => {
                    named = Some((message.t_s, Named::Restart));
                    continue;
                }
                _ => continue,
            };
            match kind {
                EventKind::Faulted(fault) if named.is_none() => {
                    named = Some((message.t_s, Named::Fault(fault)));
                    end_s = message.t_s + ROLLED_OUT_S;
                }
                EventKind::Reached | EventKind::Unreachable | EventKind::GaveUp { .. }
                    if message.t_s > at_s =>
                {
                    end_s = end_s.min(message.t_s + ARRIVED_S);
                }
                _ => {}
            }
        }
        read = received.len();
    }
    let trace = run.trace();
    let touch_s = trace
        .samples
        .iter()
        .find(|sample| sample.touching && sample.t_s >= at_s);
    let class = class(trace, at_s, failure);
    let touch = touch_s.map(|sample| sample.t_s);
    Ok(Drive {
        drive,
        seed,
        at_s,
        failure,
        class,
        touch: touch.map(|touch_s| (touch_s, run.sim().worst_contact_m_s())),
        named,
    })
}

fn class(trace: &Trace, at_s: f64, failure: Failure) -> Class {
    let silent = matches!(
        failure,
        Failure::Sonar(SonarId::Front, SonarFault::Clear | SonarFault::Stuck)
    );
    let before = trace.between(at_s - FREE_S, at_s);
    let [_, _, front] = SonarId::ALL.map(|id| id as usize);
    let free = before
        .iter()
        .all(|sample| sample.range_m[front].is_infinite());
    if silent && free {
        Class::FreeFloor
    } else {
        Class::Knowable
    }
}
