//! What a program is to do, as claims that a machine checks: `rumbo check tests.toml`.
//!
//! Each test begins with the board just switched on, in its robot and world, and does one step after the other; the first that
//! fails ends it. [`Suite::parse`] reads the file, [`Suite::drive`] does a test.
//!
//! ```toml
//! sketch = "."                  # a folder beside this file; or firmware = "image.hex"
//! scenario = "free"             # may be missing, as robot, world and wiring
//! [[test]]
//! name = "answers a letter with a pulse"
//! seed = 1
//! [[test.step]]
//! expect = "ready"              # waits; port = "usb" where it is missing, else "link" or a USART's number
//! within_s = 1
//! [[test.step]]
//! send = "P"                    # line_ending = "none", "cr", "crlf"
//! [[test.step]]
//! pin = 7                       # or "A0", "left_enable", a part's name
//! over_s = 0.5                  # judges what it does in this time
//! pulses = { min = 1, max = 1 }
//! width_us = { min = 499, max = 513 }
//! ```
//!
//! | keys | does |
//! |---|---|
//! | `expect = "text"`, `within_s`, `port` | waits until the port has sent it, in what no step has read yet; `"displays"` show it |
//! | `send = "text"`, `line_ending`, `port` | types a line |
//! | `press = "start"`, `to` | presses a part of the robot's file, or puts it to a value |
//! | `pin`, `apply_v = 2.5` or `release = true` | connects a pin from outside, or takes that away |
//! | `pin`, `high = true`, `within_s` | waits for a level |
//! | `pin`, `over_s`, with `pulses`, `width_us`, `period_us`, `duty` | judges pulses: their number, widths and distances, the share high |
//! | `truth = "x_m"`, `min`, `max`, `within_s` | waits until what is true of the robot is within these |
//! | `run_s = 2` | lets time pass |

mod read;
mod steps;

use crate::files::{FileError, Library, MetricBounds, Overrides, Setup, TimedText};
use std::path::PathBuf;
pub use steps::{Broken, TestVerdict};

/// What the program is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TestProgram {
    /// A sketch that is to be compiled: its path beside the file, or an example's name.
    Sketch(String),
    /// An image.
    Image(PathBuf),
}

/// The tests of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Suite {
    /// The path of its file.
    pub path: String,
    /// The program.
    pub program: TestProgram,
    /// What it drives in.
    pub scenario: String,
    /// What of the scenario is replaced.
    pub overrides: Overrides,
    /// The tests.
    pub tests: Vec<Test>,
}

/// A test.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// What it claims.
    pub name: String,
    /// Draws the robot and its noise.
    pub seed: u64,
    /// In order.
    pub steps: Vec<TestStep>,
}

/// A step of a test, with its line in the file.
#[derive(Clone, Debug, PartialEq)]
pub struct TestStep {
    /// Where it is.
    pub line: usize,
    act: Act,
}

/// A serial port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Port {
    /// A USART, as a terminal at its pins has it.
    Usart(u8),
    /// The Bluetooth module, wherever the wiring has it.
    Link,
}

#[derive(Clone, Debug, PartialEq)]
enum Act {
    Expect(Port, String, f64),
    Send(Port, Vec<u8>),
    /// Lines to the parts of a robot, by the time from the step's begin.
    Press(Vec<TimedText>),
    Apply(String, Option<f64>),
    Level(String, bool, f64),
    Judge(Pulses),
    Truth(String, MetricBounds, f64),
    Run(f64),
}

/// What the pulses of a pin are to be like.
#[derive(Clone, Debug, Default, PartialEq)]
struct Pulses {
    pin: String,
    over_s: f64,
    count: Option<MetricBounds>,
    width_us: Option<MetricBounds>,
    period_us: Option<MetricBounds>,
    duty: Option<MetricBounds>,
}

impl Suite {
    /// What is driven, with the image of its program.
    ///
    /// # Errors
    /// What is wrong with scenario, robot or image; a step's pin or part that the robot has not.
    pub fn setup(&self, image: PathBuf) -> Result<Setup, FileError> {
        let overrides = Overrides {
            firmware: Some(image),
            ..self.overrides.clone()
        };
        let library = Library::new().beside(&self.path);
        let setup = library.setup(&self.scenario, &overrides)?;
        self.fits(&setup)?;
        Ok(setup)
    }
}
