//! `rumbo identify --drive`: a short drive that shows a robot's parameters, part by part, each begun by a person.
//!
//! The robot stops at Ctrl-C, at a fault, when its telemetry stays away, when something is near ahead, and when it leaves
//! its place. A movement ends early where most of the free floor is behind the robot.

#[cfg(test)]
mod tests;

use super::session::Driven;
use crate::failure::Failure;
use crate::interrupt;
use crate::output;
use rumbo_control::mode::{ModeId, Movement, MovementLevel};
use rumbo_experiment::files::Overrides;
use rumbo_identify::plan::{PlanPart, PlanStep, plan};
use rumbo_identify::{BATTERY, IN_THE_AIR, ON_THE_FLOOR};
use rumbo_lab::SimulatedRobot;
use rumbo_log::{Choice, Row};
use rumbo_plant::params::Params;
use rumbo_session::Target;
use rumbo_station::port::Port;
use rumbo_wire::Command;
use std::io::BufRead;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// The name of a simulated robot in place of a port.
pub(crate) const LAB: &str = "lab";
/// A robot at a port answers within this time [us].
const ANSWER_US: u64 = 5_000_000;
/// Telemetry comes every 40 ms: without any for this long the robot is stopped [us].
const SILENT_US: u64 = 500_000;
/// A robot that was switched ON or OFF reports it within this time [us].
const ON_US: u64 = 2_500_000;
/// A person takes so long to move the robot, in which its friction forgets how fast the wheels were [us].
const MOVED_US: u64 = 15_000_000;
/// Going forward, the robot is stopped for good when something is nearer ahead than this [m]: on the free floor that is
/// asked for nothing is.
const AHEAD_M: f64 = 0.25;
/// Movements end this far from where the part began, unless they lead back [m].
const FREE_M: f64 = 0.55;
/// There the robot is stopped for good [m].
const ASTRAY_M: f64 = 1.2;

/// What a drive needs besides the robot.
pub(crate) struct Drive<'a> {
    /// The folder for its log.
    pub(crate) folder: &'a Path,
    /// The idle battery's voltage, if a person measured it [V].
    pub(crate) battery_v: Option<f64>,
}

/// The recorded drive.
pub(crate) struct Driving {
    pub(crate) path: PathBuf,
    /// The parameters of a simulated robot.
    pub(crate) truth: Option<Params>,
}

/// Drives a simulated robot: no person is asked.
pub(crate) fn in_lab(drive: &Drive<'_>, robot: &str, seed: u64) -> Result<Driving, Failure> {
    let choice = Choice {
        scenario: "free".into(),
        world: Some("open".into()),
        rig: None,
        seed,
    };
    let overrides = Overrides {
        robot: Some(robot.to_owned()),
        ..Overrides::default()
    };
    let robot = SimulatedRobot::new(overrides, choice)?;
    let truth = robot.params();
    let battery_v = drive.battery_v.unwrap_or(truth.battery.open_circuit_v);
    let mut driven = Driven::begin(robot, drive.folder)?;
    let asked = Arc::new(AtomicBool::new(false));
    let done = all_parts(&mut driven, battery_v.into(), &asked, |driven, part| {
        driven.robot().lift(!part.on_floor);
        let until_us = driven.now_us() + MOVED_US;
        while driven.now_us() < until_us {
            pass(driven, &asked)?;
        }
        Ok(())
    });
    let path = end(driven, done)?;
    Ok(Driving {
        path,
        truth: Some(truth),
    })
}

/// Drives the robot at a port.
pub(crate) fn at_port(drive: &Drive<'_>, address: &str, baud: u32) -> Result<Driving, Failure> {
    let port = Port::open(address, baud).map_err(Failure::input)?;
    let mut driven = Driven::begin(port, drive.folder)?;
    let asked = interrupt::asked();
    let lines = lines();
    let done = all_parts(&mut driven, drive.battery_v, &asked, |driven, part| {
        // An Enter pressed before this question is no answer to it: the robot may be in somebody's hand.
        while lines.try_recv().is_ok() {}
        output::remark(&format!(
            "{}, {:.0} s: {}; then press Enter. Ctrl-C stops the robot at any time.",
            part.name,
            part.seconds(),
            part.instruction
        ))?;
        wait_for_enter(driven, &lines, &asked)
    });
    let path = end(driven, done)?;
    Ok(Driving { path, truth: None })
}

/// Stops the robot, whatever came, and completes the log.
fn end<T: Target>(mut driven: Driven<T>, done: Result<(), Failure>) -> Result<PathBuf, Failure> {
    let path = driven.path();
    let stopped = driven.order(Command::Stop).and_then(|()| {
        let from_us = driven.now_us();
        // What it says of the stop comes late where the machine is busy.
        while driven.now_us() < from_us + SILENT_US
            || driven.now_us() < from_us + ON_US
                && !driven.signals(SILENT_US).as_ref().is_some_and(is_off)
        {
            driven.slice()?;
        }
        driven.finish()
    });
    match done {
        Ok(()) => stopped,
        Err(failure) => {
            output::note(&format!("what was driven is in {}", path.display()));
            Err(failure)
        }
    }
}

/// Waits until the robot answers in frames and takes orders.
fn answer<T: Target>(driven: &mut Driven<T>, asked: &AtomicBool) -> Result<(), Failure> {
    let until_us = driven.now_us() + ANSWER_US;
    while !driven.is_connected() || driven.signals(SILENT_US).is_none() {
        pass(driven, asked)?;
        if driven.now_us() >= until_us {
            return Err(Failure::Input(
                "the robot does not answer in frames; switch it on, and give it Rumbo's image (`rumbo flash`)".into(),
            ));
        }
    }
    Ok(())
}

fn all_parts<T: Target>(
    driven: &mut Driven<T>,
    battery_v: Option<f64>,
    asked: &AtomicBool,
    mut ready: impl FnMut(&mut Driven<T>, &PlanPart) -> Result<(), Failure>,
) -> Result<(), Failure> {
    answer(driven, asked)?;
    if let Some(volts) = battery_v {
        driven.note(format!("{BATTERY}{volts:.3}"))?;
    }
    for part in plan() {
        ready(driven, &part)?;
        let surface = if part.on_floor {
            ON_THE_FLOOR
        } else {
            IN_THE_AIR
        };
        driven.note(surface.into())?;
        drive_part(driven, &part, asked)?;
    }
    Ok(())
}

/// ON, the movements, OFF.
fn drive_part<T: Target>(
    driven: &mut Driven<T>,
    part: &PlanPart,
    asked: &AtomicBool,
) -> Result<(), Failure> {
    driven.take_trouble();
    driven.order(Command::Mode(ModeId::Manual))?;
    driven.order(command(PlanStep {
        movement: Movement::Stop,
        pwm: 0,
        seconds: 0.0,
    }))?;
    driven.order(Command::Arm)?;
    let is_on = |row: &Row| row.signal("armed") == Some(1.0) && row.signal("mode") == Some(0.0);
    wait(driven, asked, is_on, "the robot does not go ON")?;
    let from = position(driven.signals(SILENT_US).as_ref());
    for step in &part.steps {
        driven.order(command(*step))?;
        let until_us = driven.now_us() + (step.seconds * 1e6) as u64;
        while driven.now_us() < until_us {
            pass(driven, asked)?;
            if !supervise(driven, part, *step, from)? {
                break;
            }
        }
    }
    driven.order(command(PlanStep {
        movement: Movement::Stop,
        pwm: 0,
        seconds: 0.0,
    }))?;
    let until_us = driven.now_us() + SILENT_US;
    while driven.now_us() < until_us {
        pass(driven, asked)?;
    }
    driven.order(Command::Disarm)?;
    wait(driven, asked, is_off, "the robot does not go OFF")
}

fn is_off(row: &Row) -> bool {
    row.signal("armed") == Some(0.0)
}

/// Waits until the robot reports a state.
fn wait<T: Target>(
    driven: &mut Driven<T>,
    asked: &AtomicBool,
    reached: impl Fn(&Row) -> bool,
    otherwise: &str,
) -> Result<(), Failure> {
    let until_us = driven.now_us() + ON_US;
    while !driven.signals(SILENT_US).as_ref().is_some_and(&reached) {
        pass(driven, asked)?;
        if driven.now_us() >= until_us {
            return Err(refused(driven, otherwise));
        }
    }
    Ok(())
}

/// Whether the step may go on; an error where the robot must not.
fn supervise<T: Target>(
    driven: &mut Driven<T>,
    part: &PlanPart,
    step: PlanStep,
    from: Option<[f64; 2]>,
) -> Result<bool, Failure> {
    let Some(row) = driven.signals(SILENT_US) else {
        return Err(Failure::Input(
            "the robot's telemetry stays away: it was stopped; check the link".into(),
        ));
    };
    if row.signal("faulted") == Some(1.0) || row.signal("armed") != Some(1.0) {
        return Err(refused(driven, "the robot has stopped by itself"));
    }
    if !part.on_floor {
        return Ok(true);
    }
    let forward = matches!(
        step.movement,
        Movement::Forward | Movement::ArcLeft | Movement::ArcRight
    );
    let near_m = row
        .signal("range_front_m")
        .filter(|range_m| *range_m < AHEAD_M);
    if let (true, Some(near_m)) = (forward, near_m) {
        return Err(Failure::Input(format!(
            "something is {near_m:.2} m ahead of the robot: it was stopped; clear the floor and begin again"
        )));
    }
    let away_m = |[x_m, y_m]: [f64; 2], [from_x_m, from_y_m]: [f64; 2]| {
        (x_m - from_x_m).hypot(y_m - from_y_m)
    };
    let (Some(from), Some(at)) = (from, position(Some(&row))) else {
        return Ok(true);
    };
    if away_m(at, from) > ASTRAY_M {
        return Err(Failure::Input(format!(
            "the robot has gone {:.1} m from where it began: it was stopped; put it back and begin again",
            away_m(at, from)
        )));
    }
    let outward = leads(step.movement, &row, at, from);
    Ok(!(outward && away_m(at, from) > FREE_M))
}

/// Whether a movement leads away from where the part began.
fn leads(movement: Movement, row: &Row, at: [f64; 2], from: [f64; 2]) -> bool {
    let sign = match movement {
        Movement::Forward => 1.0,
        Movement::Backward => -1.0,
        _ => return false,
    };
    let heading_rad = row.signal("heading_rad").unwrap_or_default();
    let along = (at[0] - from[0]) * heading_rad.cos() + (at[1] - from[1]) * heading_rad.sin();
    sign * along > 0.0
}

fn position(row: Option<&Row>) -> Option<[f64; 2]> {
    let row = row?;
    Some([row.signal("x_m")?, row.signal("y_m")?])
}

fn command(step: PlanStep) -> Command {
    Command::Move {
        movement: step.movement,
        level: MovementLevel::Duty(f32::from(step.pwm) / 255.0),
    }
}

fn refused<T: Target>(driven: &mut Driven<T>, what: &str) -> Failure {
    let why = driven.take_trouble();
    Failure::Input(match why {
        Some(why) => format!("{what}: {why}"),
        None => format!("{what}; look at it in `rumbo connect`"),
    })
}

/// One slice of time, unless Ctrl-C was pressed.
fn pass<T: Target>(driven: &mut Driven<T>, asked: &AtomicBool) -> Result<(), Failure> {
    if asked.load(Ordering::Relaxed) {
        return Err(Failure::Interrupted);
    }
    driven.slice()
}

/// The lines of the standard input, read beside the session.
fn lines() -> Receiver<()> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        let mut read = std::io::stdin().lock().lines();
        while let Some(Ok(_)) = read.next() {
            if sender.send(()).is_err() {
                return;
            }
        }
    });
    lines
}

fn wait_for_enter<T: Target>(
    driven: &mut Driven<T>,
    lines: &Receiver<()>,
    asked: &AtomicBool,
) -> Result<(), Failure> {
    loop {
        match lines.try_recv() {
            Ok(()) => return Ok(()),
            Err(TryRecvError::Empty) => pass(driven, asked)?,
            Err(TryRecvError::Disconnected) => {
                return Err(Failure::Input(
                    "nobody can press Enter: the standard input is closed; start it in a terminal"
                        .into(),
                ));
            }
        }
    }
}
