//! Does the steps of a test.

use super::{Act, Port, Pulses, Suite, Test, TestStep};
use crate::batch::{DrivenBy, Pulse, Robot, TRUE};
use crate::files::{FileError, MetricBounds, Setup, TimedText, takes, unknown};
use rumbo_emulator::devices::ports::Pin;
use rumbo_sim::mega::firmware::Firmware;
use rumbo_sim::mega::{CONSOLES, ON_PINS, PARTS};
use std::sync::Arc;

/// Ticks of 10 ms in a second: what waits looks at each.
const TICKS_PER_S: f64 = 100.0;
/// Of a port's output so much is shown [characters].
const SHOWN: usize = 300;

/// What came of a test.
pub struct TestVerdict {
    /// How long it took, in simulated time [s].
    pub took_s: f64,
    /// The step that failed, if one did, and the robot as it was then.
    pub broken: Option<(Broken, Box<Robot>)>,
}

/// A step that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// Its number in the test, from 1.
    pub number: usize,
    /// Its line in the file.
    pub line: usize,
    /// What came instead.
    pub why: String,
}

impl Suite {
    /// Whether the robot has the pins, ports and parts of all steps.
    pub(super) fn fits(&self, setup: &Setup) -> Result<(), FileError> {
        let Some(firmware) = setup.firmware.as_deref() else {
            return Err(FileError::Setting(format!(
                "{}: no board is emulated in scenario {}; choose one with a single robot",
                self.path, self.scenario
            )));
        };
        let steps = self.tests.iter().flat_map(|test| &test.steps);
        for TestStep { line, act } in steps {
            let missing = match act {
                Act::Apply(pin, _) | Act::Level(pin, ..) | Act::Judge(Pulses { pin, .. }) => {
                    let known: Vec<&str> = firmware.found().collect();
                    let none = firmware.find(pin).is_none();
                    none.then(|| unknown("pin", pin, known))
                }
                Act::Press(lines) => {
                    let line = lines.first().and_then(|line| line.text.split_once('='));
                    let (name, value) = line.unwrap_or_default();
                    let worked = firmware.parts().iter().filter(|part| part.kind.is_worked());
                    let known: Vec<&str> = worked.map(|part| part.name.as_str()).collect();
                    let part = firmware.parts().iter().find(|part| part.name == name);
                    match part.filter(|part| part.kind.is_worked()) {
                        Some(part) => takes(part, value).err().map(FileError::Setting),
                        None => Some(unknown("part", name, known)),
                    }
                }
                Act::Truth(name, ..) => {
                    let others = firmware.other_sonars().iter();
                    let others: Vec<String> =
                        others.map(|sonar| format!("range_{sonar}_m")).collect();
                    let known = TRUE.into_iter().chain(others.iter().map(String::as_str));
                    let is_known = known.clone().any(|own| own == name);
                    (!is_known).then(|| unknown("truth", name, known))
                }
                Act::Expect(Port::Link, ..) | Act::Send(Port::Link, _)
                    if firmware.link_usart().is_none() =>
                {
                    let what = "the wiring has no Bluetooth module: name link_rx and link_tx in it";
                    Some(FileError::Setting(what.to_owned()))
                }
                _ => None,
            };
            if let Some(error) = missing {
                return Err(FileError::Setting(format!("{}:{line}: {error}", self.path)));
            }
        }
        Ok(())
    }
}

impl Test {
    /// Does the steps with a robot of a setup of its suite, from its start; `recorded` for its log.
    ///
    /// # Errors
    /// The setup's values do not fit together.
    pub fn drive(&self, setup: &Arc<Setup>, recorded: bool) -> Result<TestVerdict, FileError> {
        let mut robot = Robot::new(setup, DrivenBy::Scenario, self.seed)?;
        if recorded {
            robot.record()?;
        }
        robot.probe();
        let mut under = Under {
            robot,
            read: [0; CONSOLES as usize],
        };
        let mut broken = None;
        for (number, TestStep { line, act }) in (1..).zip(&self.steps) {
            if let Err(why) = under.step(act) {
                let line = *line;
                broken = Some(Broken { number, line, why });
                break;
            }
        }
        Ok(TestVerdict {
            took_s: under.now_s(),
            broken: broken.map(|broken| (broken, Box::new(under.robot))),
        })
    }
}

/// The program under test.
struct Under {
    robot: Robot,
    /// How much of each port's output the steps have read.
    read: [usize; CONSOLES as usize],
}

impl Under {
    /// Does a step, or says what came instead.
    fn step(&mut self, act: &Act) -> Result<(), String> {
        match act {
            Act::Expect(port, text, within_s) => self.expect(*port, text, *within_s),
            Act::Send(port, bytes) => {
                let port = match port {
                    Port::Usart(number) => *number,
                    // The module sends them, wherever it is.
                    Port::Link => ON_PINS,
                };
                self.robot.type_in(port, bytes);
                Ok(())
            }
            Act::Press(lines) => {
                let begin_s = self.now_s();
                for TimedText { at_s, text, .. } in lines {
                    self.pass(begin_s + at_s - self.now_s())?;
                    self.robot.type_in(PARTS, format!("{text}\n").as_bytes());
                }
                Ok(())
            }
            Act::Apply(pin, volts) => {
                if let Some(number) = self.firmware().and_then(|firmware| firmware.find(pin)) {
                    self.robot.apply(number, *volts);
                }
                Ok(())
            }
            Act::Level(name, high, within_s) => {
                let (pin, from_s) = (self.pin(name)?, self.now_s());
                let level = if *high { "high" } else { "low" };
                self.wait(
                    *within_s,
                    |robot| {
                        let probe = robot.probed();
                        probe.is_some_and(|probe| {
                            probe.is_high(pin) == *high
                                || probe.edges(pin, from_s).any(|(_, rose)| rose == *high)
                        })
                    },
                    |_| format!("pin {name} did not become {level}"),
                )
            }
            Act::Judge(judged) => self.judge(judged),
            Act::Truth(name, bounds, within_s) => {
                let value = |robot: &Robot| robot.true_value(name).unwrap_or(f64::NAN);
                self.wait(
                    *within_s,
                    |robot| bounds.admit(value(robot)),
                    |robot| format!("{name} is {:.4}, not {bounds}", value(robot)),
                )
            }
            Act::Run(s) => self.pass(*s),
        }
    }

    fn expect(&mut self, port: Port, text: &str, within_s: f64) -> Result<(), String> {
        let number = match port {
            Port::Usart(number) => number,
            Port::Link => {
                let firmware = self.firmware();
                firmware.and_then(Firmware::link_usart).unwrap_or(ON_PINS)
            }
        };
        let read = self.read[usize::from(number)];
        let unread = |robot: &Robot| {
            let said = robot.probed().map_or(&[][..], |probe| probe.said(number));
            said.get(read..).unwrap_or_default().to_vec()
        };
        let found = |bytes: &[u8]| {
            let mut windows = bytes.windows(text.len().max(1));
            windows.position(|window| window == text.as_bytes())
        };
        let name = match port {
            Port::Link => "the Bluetooth module".to_owned(),
            Port::Usart(0) => "Serial (USB)".to_owned(),
            Port::Usart(PARTS) => "what the displays show".to_owned(),
            Port::Usart(number) => format!("Serial{number}"),
        };
        self.wait(
            within_s,
            |robot| found(&unread(robot)).is_some(),
            |robot| {
                let said = String::from_utf8_lossy(&unread(robot)).replace('\r', "");
                let skipped = said.chars().count().saturating_sub(SHOWN);
                let last: String = said.chars().skip(skipped).collect();
                match said.is_empty() {
                    true => format!("{name} did not send {text:?}, but nothing"),
                    false => format!("{name} did not send {text:?}, but {last:?}"),
                }
            },
        )?;
        let begin = found(&unread(&self.robot)).unwrap_or_default();
        self.read[usize::from(number)] += begin + text.len();
        Ok(())
    }

    fn judge(&mut self, judged: &Pulses) -> Result<(), String> {
        let (pin, from_s) = (self.pin(&judged.pin)?, self.now_s());
        self.pass(judged.over_s)?;
        let Some(probe) = self.robot.probed() else {
            return Ok(());
        };
        let pulses = probe.pulses(pin, from_s);
        let named = |what: &str| format!("pin {}: {what}", judged.pin);
        within(judged.count, &named("pulses"), [pulses.len() as f64])?;
        let widths = pulses.iter().map(|pulse| pulse.width_us);
        within(judged.width_us, &named("width_us"), widths)?;
        let pairs = pulses.windows(2).filter_map(|pair| match pair {
            [Pulse { at_s: one, .. }, Pulse { at_s: next, .. }] => Some(1e6 * (next - one)),
            _ => None,
        });
        within(judged.period_us, &named("period_us"), pairs)?;
        let share = probe.share_high(pin, from_s);
        within(judged.duty, &named("duty"), [share])
    }

    /// Lets time pass, unless the program ends.
    fn pass(&mut self, s: f64) -> Result<(), String> {
        self.robot.advance((s * TICKS_PER_S).round() as u32);
        self.robot.ended().map_or(Ok(()), Err)
    }

    /// Waits for something, tick by tick.
    fn wait(
        &mut self,
        within_s: f64,
        come: impl Fn(&Robot) -> bool,
        missing: impl Fn(&Robot) -> String,
    ) -> Result<(), String> {
        let ticks = (within_s * TICKS_PER_S).round() as u32;
        for tick in 0..=ticks {
            if come(&self.robot) {
                return Ok(());
            }
            if let Some(end) = self.robot.ended() {
                return Err(format!("{}; {end}", missing(&self.robot)));
            }
            if tick < ticks {
                self.robot.advance(1);
            }
        }
        let why = missing(&self.robot);
        Err(match ticks {
            0 => why,
            _ => format!("{why} within {within_s} s"),
        })
    }

    fn now_s(&self) -> f64 {
        1e-6 * self.robot.sim().now_us() as f64
    }

    fn firmware(&self) -> Option<&Firmware> {
        self.robot.sim().mega().map(|mega| mega.firmware())
    }

    fn pin(&self, name: &str) -> Result<Pin, String> {
        let firmware = self.firmware();
        let pin = firmware.and_then(|firmware| firmware.board().pin(firmware.find(name)?));
        pin.ok_or_else(|| format!("pin {name} is an analogue input only: it has no level"))
    }
}

/// Whether all values are within bounds, if there are any; the first that is not is named.
fn within(
    bounds: Option<MetricBounds>,
    what: &str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), String> {
    let Some(bounds) = bounds else {
        return Ok(());
    };
    let mut none = true;
    for value in values {
        none = false;
        if !bounds.admit(value) {
            return Err(format!("{what} is {value:.4}, not {bounds}"));
        }
    }
    match none {
        true => Err(format!("{what}: there are no pulses to measure")),
        false => Ok(()),
    }
}
