//! What a program did with each motor, and for one that it never drove, what was missing at the driver's inputs.

use super::Mega;
use super::pins::INPUTS;
use crate::drivers::Direction;
use rumbo_plant::drivetrain::Bridge;

/// The wheels for people.
const SIDES: [&str; 2] = ["left", "right"];
/// Driven against each other for this long without a pause to speak of, they turn the robot on the spot [cycles].
const TURNING_CYCLES: u64 = 1_000_000 * super::CYCLES_PER_US;

/// How the motors were driven.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Driven {
    /// Which way each is driven now: 1 forward, -1 backward.
    ways: [i8; 2],
    since: u64,
    /// Whether each was ever driven.
    ever: [bool; 2],
    /// For how long both were driven the same way, and against each other [cycles].
    together: u64,
    against: u64,
}

impl Driven {
    /// A motor is driven so from this cycle on.
    pub(super) fn set(&mut self, cycle: u64, wheel: usize, bridge: Bridge) {
        self.pass(cycle);
        self.ways[wheel] = match bridge {
            Bridge::Forward(_) => 1,
            Bridge::Backward(_) => -1,
            Bridge::Released | Bridge::Brake(_) => 0,
        };
        self.ever[wheel] |= self.ways[wheel] != 0;
    }

    fn pass(&mut self, cycle: u64) {
        let passed = cycle.saturating_sub(self.since);
        match self.ways[0] * self.ways[1] {
            1 => self.together += passed,
            -1 => self.against += passed,
            _ => {}
        }
        self.since = cycle;
    }

    /// Whether the robot did nothing but turn on the spot.
    fn turned(mut self, cycle: u64) -> bool {
        self.pass(cycle);
        self.against > TURNING_CYCLES && self.against > 20 * self.together
    }
}

impl Mega {
    /// Whether no motor was ever driven.
    pub(super) fn is_idle(&self) -> bool {
        self.driven_ways.ever == [false; 2]
    }

    /// What is odd about the motors, a line each.
    pub(super) fn of_wheels(&self) -> Vec<String> {
        let mut odd = Vec::new();
        for (wheel, side) in SIDES.into_iter().enumerate() {
            if let (false, Some(why)) = (self.driven_ways.ever[wheel], self.why_still(wheel)) {
                odd.push(format!("it never drove the {side} motor: {why}"));
            }
            if let (true, Some(what)) = (self.driven_ways.ever[wheel], self.only_switched(wheel)) {
                odd.push(what);
            }
        }
        if self.driven_ways.turned(self.chip.cycle()) {
            odd.push(format!(
                "it drove the wheels against each other all the time; if it was to drive straight, exchange forward and backward of the wheel that turns the wrong way, in the wiring {} or at the motor",
                self.firmware.wiring()
            ));
        }
        odd
    }

    /// What was missing at the inputs of a motor that is wired.
    fn why_still(&self, wheel: usize) -> Option<String> {
        let inputs = self.wires().bridges[wheel];
        let lines = &self.bridges[wheel].lines;
        if !inputs.iter().any(|input| input.pin().is_some()) {
            return None;
        }
        let called = |input: usize| {
            let signal = match input {
                3 => INPUTS[3].to_owned(),
                _ => format!("{}_{}", SIDES[wheel], INPUTS[input]),
            };
            match (self.firmware.pin_of(&signal), self.firmware.motors()[wheel]) {
                (Some(pin), _) => format!("{signal} (pin {pin})"),
                (None, Some(motor)) => format!("{signal} of M{}", motor.number),
                (None, None) => signal,
            }
        };
        let low = |input: usize| !lines[input].been_high();
        let direction = self.wires().driver.direction;
        let two = direction != Direction::One;
        Some(if direction == Direction::Pulse {
            let wired = if inputs[1].pin().is_some() { 1 } else { 2 };
            format!(
                "{} had no pulse that turns it, shorter or longer than 1.5 ms",
                called(wired)
            )
        } else if low(3) {
            format!("{} was never high, and the driver slept", called(3))
        } else if low(0) {
            let held = match inputs[0].pin() {
                Some(_) if self.wires().driver.shield.is_none() => {
                    ", unless a jumper holds it: then write \"high\" in the wiring"
                }
                _ => "",
            };
            format!("{} was never high{held}", called(0))
        } else if two && low(1) && low(2) {
            format!("{} and {} were never high", called(1), called(2))
        } else {
            format!(
                "{} and {} never differed while it was enabled",
                called(1),
                called(2)
            )
        })
    }

    /// That the pin of a motor's speed has no PWM, where it was only switched.
    fn only_switched(&self, wheel: usize) -> Option<String> {
        let (inputs, lines) = (self.wires().bridges[wheel], &self.bridges[wheel].lines);
        // A program that knows no analogWrite() wants none.
        let mut functions = self.firmware.image().functions().iter();
        let wants = functions.any(|function| function.name.starts_with("analogWrite"));
        let servo = self.wires().driver.direction == Direction::Pulse;
        if !wants || servo || lines.iter().any(|line| line.been_modulated()) {
            return None;
        }
        let speed = match inputs[0].pin() {
            Some(_) => &INPUTS[..1],
            None => &INPUTS[1..3],
        };
        let board = self.firmware.board();
        let signals = speed
            .iter()
            .map(|input| format!("{}_{input}", SIDES[wheel]));
        let mut pins = signals.filter_map(|signal| {
            let pin = self.firmware.number_of(&signal)?;
            (!board.pwm.contains(&pin)).then(|| (signal, board.shown(pin)))
        });
        let (signal, pin) = pins.next()?;
        let with: Vec<String> = board.pwm.iter().map(u8::to_string).collect();
        Some(format!(
            "{signal} is on pin {pin}, which has no PWM on the {}: analogWrite() there only switches; PWM is on {}",
            board.title,
            with.join(", ")
        ))
    }
}
