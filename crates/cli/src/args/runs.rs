//! Options of the commands that run experiments and fit numbers: `run`, `experiments`, `identify`, `calibrate`.

use super::groups::{ImageArgs, OverwriteArgs, ParameterArgs, ProgramName, SeedArgs, SettingArgs};
use super::values::{at_rest, duration, line_ending, press, put, timed_text, usb_text};
use clap::{Args, ValueEnum};
use rumbo_experiment::files::TimedText;
use rumbo_wire::LineEnding;
use std::path::PathBuf;

/// Options of `rumbo run`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/run.txt"))]
pub(crate) struct RunArgs {
    /// Scenarios: names, or paths of files
    #[arg(required = true, value_name = "SCENARIO")]
    pub(crate) scenarios: Vec<String>,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Runs of each scenario, with consecutive seeds
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) runs: u32,
    #[command(flatten)]
    pub(crate) setting: SettingArgs,
    /// How long each run lasts, in s [default: the scenario's]
    #[arg(long, value_name = "S", value_parser = duration)]
    pub(crate) duration: Option<f64>,
    /// Program at the robot's pins: ours, or the report's with its schemes and gains (of parameters, only the plant's
    /// count for that one)
    #[arg(
        long,
        value_enum,
        value_name = "NAME",
        default_value_t,
        conflicts_with = "image"
    )]
    pub(crate) program: ProgramName,
    #[command(flatten)]
    pub(crate) image: ImageArgs,
    /// Line of text sent over the link at a time, e.g. 'REF 40@6'; \x05 in it is that byte; may be repeated
    #[arg(long = "command", value_name = "TEXT@SECONDS", value_parser = timed_text, conflicts_with = "program")]
    pub(crate) commands: Vec<TimedText>,
    /// Line of text typed on the board's USB port (Serial) at a time, e.g. 'go@2'; may be repeated
    #[arg(long, value_name = "TEXT@SECONDS", value_parser = usb_text, requires = "image")]
    pub(crate) usb: Vec<TimedText>,
    /// Button pressed at a time, switch or potentiometer put to a value from 0 to 1, or key of a remote control pressed,
    /// e.g. 'start@2', 'speed=0.7@3', 'remote=ok@4'; held 'start@2-3.5', 'remote=up@1-3'; may be repeated
    #[arg(long, value_name = "NAME@SECONDS", value_parser = press, requires = "image")]
    pub(crate) press: Vec<Vec<TimedText>>,
    /// Where a hand puts the robot at a time, x and y in m, heading in degrees, e.g. '0.2,0.1,90@3'; may be repeated
    #[arg(long, value_name = "X,Y,DEG@SECONDS", value_parser = put, allow_hyphen_values = true)]
    pub(crate) place: Vec<TimedText>,
    /// What is sent behind each of these lines, as in the Serial Monitor: none, for single letters, lf, cr or crlf
    #[arg(long, value_name = "ENDING", value_parser = line_ending, default_value = "lf")]
    pub(crate) line_ending: LineEnding,
    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
    /// Folder for the log, the result and the true signals of each run; made if need be
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// Leave no log behind
    #[arg(long, conflicts_with = "out")]
    pub(crate) no_record: bool,
    /// One JSON object per run on stdout
    #[arg(long)]
    pub(crate) json: bool,
    /// File for the firmware's cycles by function, for flame graphs; a summary goes to stderr. One run
    #[arg(long, value_name = "FILE", requires = "image")]
    pub(crate) profile: Option<PathBuf>,
    /// File for the board's pins over time, for a viewer of waveforms such as GTKWave. One run
    #[arg(long, value_name = "FILE", requires = "image")]
    pub(crate) vcd: Option<PathBuf>,
    /// Port on 127.0.0.1 where the run waits for avr-gdb; 0 takes any free one. One run
    #[arg(long, value_name = "PORT", requires = "image")]
    pub(crate) gdb: Option<u16>,
    /// Threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Options of `rumbo experiments`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/experiments.txt"))]
pub(crate) struct ExperimentsArgs {
    /// Folder for the report; made if need be
    #[arg(long, value_name = "DIR", default_value = "rumbo-report")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// Language of the report [default: that of the locale]
    #[arg(long, value_enum, value_name = "LANGUAGE")]
    pub(crate) language: Option<LanguageName>,
    /// These experiments only: names as in the report's links, e.g. mode1, or of scenarios
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub(crate) only: Vec<String>,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Folder with recorded runs of a real robot, shown beside ours: CSVs of the original program, logs of `rumbo connect`
    #[arg(long, value_name = "DIR")]
    pub(crate) real: Option<PathBuf>,
    /// Robot: name or path [default: the scenarios']
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    #[command(flatten)]
    pub(crate) image: ImageArgs,
    /// Also the log of each run, its true signals as CSV, and its metrics as JSON
    #[arg(long)]
    pub(crate) data: bool,
}

/// The languages of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LanguageName {
    /// English
    En,
    /// Spanish
    Es,
}

/// Options of `rumbo grade`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/grade.txt"))]
pub(crate) struct GradeArgs {
    /// The assignment's file
    #[arg(value_name = "ASSIGNMENT.toml")]
    pub(crate) assignment: PathBuf,
    /// Folder or .zip with the hand-ins, or one hand-in
    #[arg(value_name = "FOLDER", required_unless_present_any = ["gradescope", "autograder"])]
    pub(crate) folder: Option<PathBuf>,
    /// Grade nothing; write the autograder to upload to Gradescope
    #[arg(long, value_name = "FILE.zip", conflicts_with_all = ["folder", "out", "trust", "threads"])]
    pub(crate) gradescope: Option<PathBuf>,
    /// The `rumbo` for Linux on x86-64 that it brings [default: this one]
    #[arg(long, value_name = "FILE", requires = "gradescope")]
    pub(crate) linux: Option<PathBuf>,
    /// Be that autograder: grade `submission` in DIR into `results/results.json`
    #[arg(long, value_name = "DIR", conflicts_with_all = ["folder", "gradescope", "out", "trust"])]
    pub(crate) autograder: Option<PathBuf>,
    /// Folder for pages and marks; made if need be
    #[arg(long, value_name = "DIR", default_value = "rumbo-marks")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// Language of the pages [default: that of the locale]
    #[arg(long, value_enum, value_name = "LANGUAGE")]
    pub(crate) language: Option<LanguageName>,
    /// Compile without the sandbox: every hand-in can then read your files. For sources that you know
    #[arg(long)]
    pub(crate) trust: bool,
    /// Threads [default: one per core]; the marks do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Options of `rumbo check`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/check.txt"))]
pub(crate) struct CheckArgs {
    /// The file of tests
    #[arg(value_name = "TESTS.toml")]
    pub(crate) file: PathBuf,
    /// Only the tests whose name has this in it; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Vec<String>,
    /// Write the results as JUnit XML
    #[arg(long, value_name = "FILE.xml")]
    pub(crate) junit: Option<PathBuf>,
    /// Folder for log and waveform of each failed test
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// Folder of Arduino libraries, which come before those of the Arduino IDE; may be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) libraries: Vec<PathBuf>,
    /// Threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Options of `rumbo identify`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/identify.txt"))]
pub(crate) struct IdentifyArgs {
    /// Recorded runs: logs of Rumbo (connect, lab, run), CSV of the original program, or logs made of it by `rumbo import`
    #[arg(required_unless_present = "drive", value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
    /// Drive the robot at this port for less than two minutes, part by part, and identify it from that; `lab` is a
    /// simulated one
    #[arg(long, value_name = "PORT", conflicts_with = "check")]
    pub(crate) drive: Option<String>,
    /// Robot file whose [plant] table is rewritten with what is found; a new file starts as a copy of the robot's
    #[arg(long, value_name = "FILE.toml", conflicts_with = "check")]
    pub(crate) write: Option<PathBuf>,
    /// Voltage of the battery with the wheels at rest, by a multimeter: the motors are known no better than it
    #[arg(
        long,
        value_name = "VOLTS",
        value_parser = at_rest,
        requires = "drive",
        conflicts_with = "check"
    )]
    pub(crate) battery: Option<f64>,
    /// Speed of the serial port; the robot's is 9600
    #[arg(long, value_name = "N", default_value_t = rumbo_session::DEFAULT_BAUD)]
    pub(crate) baud: u32,
    /// Folder for the log of the drive [default: that of sessions]
    #[arg(long, value_name = "DIR", requires = "drive", conflicts_with = "check")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Robot to start from; given by path, its table `plant` is rewritten and its comments are kept
    #[arg(
        long,
        value_name = "ROBOT",
        default_value = "memoria",
        conflicts_with = "check"
    )]
    pub(crate) robot: String,
    /// Evaluate this robot without fitting it
    #[arg(long, value_name = "ROBOT")]
    pub(crate) check: Option<String>,
    /// Fit it to all runs but one and evaluate that one, for each run in turn
    #[arg(long, conflicts_with_all = ["write", "drive"])]
    pub(crate) leave_one_out: bool,
    /// The result as JSON on stdout
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for plots of measured against simulated, SVG; made if need be
    #[arg(long, value_name = "DIR")]
    pub(crate) plots: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
}

/// Options of `rumbo calibrate`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/calibrate.txt"))]
pub(crate) struct CalibrateArgs {
    /// Robot: name or path
    #[arg(long, value_name = "NAME", default_value = "memoria")]
    pub(crate) robot: String,
    /// Sensor layout (rig) with a sonar ahead and one on each side [default: final]
    #[arg(long, value_name = "NAME")]
    pub(crate) rig: Option<String>,
    /// World [default: the one made for it]; the robot starts at x = -1.1, y = -0.45 m there, along x
    #[arg(long, value_name = "NAME")]
    pub(crate) world: Option<String>,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
    /// Robot file whose [parameters] table is rewritten: this robot's own, or one that was calibrated; a new file
    /// starts as a copy of the robot's
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// Leave no log behind
    #[arg(long)]
    pub(crate) no_record: bool,
    /// The result as JSON on stdout
    #[arg(long)]
    pub(crate) json: bool,
}
