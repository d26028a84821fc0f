//! The command line: subcommands, options, and the examples that each `--help` shows. Each file here is one group of subcommands.

mod asked;
mod groups;
mod live;
mod logs;
mod runs;
mod studies;
mod values;

pub(crate) use asked::Answers;
pub(crate) use groups::{OverwriteArgs, ServeArgs, board};
pub(crate) use live::{ConnectArgs, DebugArgs, FlashArgs, LabArgs};
pub(crate) use logs::{
    CompareArgs, ExplainArgs, ExportArgs, Format, ImportArgs, PruneArgs, ReplayArgs, RerunArgs,
};
pub(crate) use runs::{
    CalibrateArgs, CheckArgs, ExperimentsArgs, GradeArgs, IdentifyArgs, LanguageName, RunArgs,
};

pub(crate) use studies::{SweepArgs, TuneArgs};
pub(crate) use values::{driver_named, driver_names, drivers, pin, sensor};

use crate::failure::Failure;
use clap::error::{ContextKind, ContextValue};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use rumbo_sim::boards::Board;
use rumbo_sim::drivers::Driver;
use std::path::PathBuf;

/// Rumbo: the lab of a small robot. Without a subcommand, `lab`.
#[derive(Debug, Parser)]
#[command(
    name = "rumbo",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  rumbo                       a simulated robot and its dashboard in the browser
  rumbo run mode1 mode5       experiments without a window, with their metrics
  rumbo list                  what there is to choose from"
)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// Options of `lab`.
    #[command(flatten, next_help_heading = "Options of `lab`")]
    pub(crate) lab: LabArgs,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Drive a simulated robot from a dashboard in the browser, which also edits, runs and debugs its sketch
    Lab(LabArgs),
    /// Drive a real robot from the same dashboard, over a serial port or TCP
    Connect(ConnectArgs),
    /// Write the firmware to an Arduino Mega
    Flash(FlashArgs),
    /// Run scenarios as fast as the machine can and judge their metrics
    Run(RunArgs),
    /// Debug a sketch or an image in an editor, forwards and backwards, while robot and world stand still
    Debug(DebugArgs),
    /// Run a scenario with many values of its parameters: a table, and a page with plots
    Sweep(SweepArgs),
    /// Compare variants of a scenario pair by pair, or logs side by side
    Compare(CompareArgs),
    /// Find values of control parameters that serve an aim on many robots, and check them on others
    Tune(TuneArgs),
    /// Run every experiment of the report and write it: one page with all figures
    Experiments(ExperimentsArgs),
    /// Try the claims of a file about a sketch: what its ports say, its pins do, its robot does
    Check(CheckArgs),
    /// Grade a class: compile each hand-in in a sandbox, drive it with every seed, write pages and marks
    Grade(GradeArgs),
    /// Find the plant's parameters from recorded runs
    Identify(IdentifyArgs),
    /// Let the robot calibrate itself: dead zones, feedforward, wheels, base
    Calibrate(CalibrateArgs),
    /// Check a CSV of the original program and convert it to a log (MCAP)
    Import(ImportArgs),
    /// Show a log in the dashboard: play, pause, step, scrub; or the page of a sweep
    Replay(ReplayArgs),
    /// Write a log as CSV or SVG
    Export(ExportArgs),
    /// Say what explains a stretch of a log: what friction, sonars, wheels, link and limits did
    Explain(ExplainArgs),
    /// Make a policy of a learned network: integers that the robot evaluates in mode 9
    ExportPolicy(ExportPolicyArgs),
    /// Run a recorded simulation again and compare it bit for bit
    Rerun(RerunArgs),
    /// Remove old logs of sessions and runs
    Prune(PruneArgs),
    /// Begin a sketch that drives to a wall, or the file of a robot of your own
    New(NewArgs),
    /// List modes, scenarios, worlds, rigs, robots, sketches and parameters; ports and logs of this computer
    List(ListArgs),
    /// Print a script with which a shell completes the words of `rumbo`
    Completions(CompletionsArgs),
    /// Write the manual pages, for packages
    #[command(hide = true)]
    Manual(ManualArgs),
}

/// Options of `rumbo export-policy`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo export-policy goal.json --out goal.toml
  rumbo run mode9-random --policy goal.toml       drive by it
  rumbo flash /dev/ttyACM0 --policy goal.toml     put it on the robot

The network is JSON: activation, \"clip\", which is all that the robot does; inputs, each {\"of\": column, \"centre\": number, \"scale\": number}, and layers, each {\"weights\": [[...]], \"biases\": [...]}, a list
of weights for each neuron; neurons are clipped to -1..1, the last layer is left wheel, right wheel, servo. examples/python/ppo.py writes one, docs/python.md
says more. Weights become 8-bit integers.")]
pub(crate) struct ExportPolicyArgs {
    /// The network, JSON
    #[arg(value_name = "NETWORK.json")]
    pub(crate) network: PathBuf,
    /// The policy to write [default: the same name with .toml, in the current folder]
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) out: Option<PathBuf>,
    /// One line that says what it does
    #[arg(long, value_name = "TEXT", default_value = "A learned policy")]
    pub(crate) title: String,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
}

/// What a robot that is like another one has from it.
const OF_NEW_ROBOTS: [&str; 5] = ["board", "driver", "pins", "parts", "sensors"];

/// Options of `rumbo new`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo new sketch my_sketch
  rumbo run mode1 --sketch my_sketch              drive it
  rumbo new sketch my_line --like line            begin with an example
  rumbo new sketch small --board uno
  rumbo run mode1 --robot uno --sketch small      the robot with an Arduino Uno
  rumbo new robot my_car --board uno --driver l298n-jumpers --pins left_forward=5,left_backward=6,right_forward=9,right_backward=10
  rumbo new robot my_car --board nano --driver drv8833 --pins left_forward=3,left_backward=5,right_forward=6,right_backward=9,line_left=A0,line_right=A1
  rumbo new robot my_car --like kit_elegoo_v3
  rumbo run free --robot my_car.toml --sketch my_sketch")]
pub(crate) struct NewArgs {
    /// What to begin
    #[arg(value_enum)]
    pub(crate) what: NewKind,
    /// Folder of the sketch to make, which has the same name, as the Arduino IDE wants it; or file of the robot
    #[arg(value_name = "NAME")]
    pub(crate) folder: PathBuf,
    /// Board: mega, uno or nano; a sketch's is a mega where it is left out
    #[arg(long, value_name = "BOARD", value_parser = values::board)]
    pub(crate) board: Option<&'static Board>,
    /// Driver of the robot's motors: l298n, l298n-jumpers, l293d, motor-shield, tb6612, motor-shield-v2, drv8833, dir-pwm, continuous-servos and others
    #[arg(long, value_name = "DRIVER", value_parser = values::driver_named)]
    pub(crate) driver: Option<(&'static Driver, bool)>,
    /// Pins of the robot's signals, e.g. left_forward=7,servo=9,front_echo=A1; line sensors from left to right, by names of yours,
    /// as line_left=2,line_right=A1; of all of them line_dark=low, line_rc=true (QTR-RC), line_pitch_m=0.0095, line_light_v=0.2,
    /// line_dark_v=4.8; so infrared ones for obstacles, obstacle_left=3, of all of them obstacle_seen=high, obstacle_reach_m=0.3;
    /// sharp_front=A0, of all of them sharp_model=gp2y0a02; light sensors light_left=A0,light_right=A1, of all of them
    /// light_bright=low, light_resistor_kohm=4.7, light_rated_kohm=14, or light_switch_lux=50, which are modules;
    /// maxsonar_front=7, or A0, of all of them maxsonar_rx=4; those named back or rear are behind, as obstacle_back_left; sonars
    /// have names of yours, rear_trigger=4,rear_echo=5; servo_ahead=35 and servo_reversed=true say how a servo is mounted,
    /// link_baud=38400 is the rate of a Bluetooth module; battery=A0,battery_ratio=4 a divider for the battery's voltage
    #[arg(long, value_name = "SIGNAL=PIN", value_delimiter = ',', value_parser = values::pin)]
    pub(crate) pins: Vec<(String, String)>,
    #[command(flatten)]
    pub(crate) answers: Answers,
    /// Where sensors sit, x and y in m, and look, in degrees: left=0.08:0.07:90,right=-0.02:0.07:90 are two sonars on the left
    /// side, line_rear=-0.05:0 is a line sensor behind the wheels, obstacle_rear=-0.1:0:180 looks back
    #[arg(long, alias = "sonars", value_name = "SENSOR=X:Y:DEG", value_delimiter = ',', value_parser = values::sensor)]
    pub(crate) sensors: Vec<(String, [f64; 3])>,
    /// Parts of the robot at a pin or an address, e.g. start=button:8,go=button:9:5v,remote=infrared:2,screen=ssd1306:0x3c;
    /// tof=vl53l0x:0x29:7 has its XSHUT on pin 7, text=hd44780:12:11:5:4:3:2 is on the pins of LiquidCrystal(rs, e, d4 to d7)
    #[arg(long, value_name = "NAME=KIND:PLACE", value_delimiter = ',', value_parser = values::part)]
    pub(crate) parts: Vec<[String; 3]>,
    /// Begin with the file of this robot (`rumbo list robots`), or with this example (`rumbo list sketches`)
    #[arg(long, value_name = "ROBOT", conflicts_with_all = OF_NEW_ROBOTS)]
    pub(crate) like: Option<String>,
}

/// What can be begun.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum NewKind {
    /// An Arduino sketch
    Sketch,
    /// A robot file; what no option says is asked for at a terminal
    Robot,
}

/// Options of `rumbo list`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo list
  rumbo list modes
  rumbo list parameters
  rumbo list logs
  rumbo list scenarios --json
  rumbo list robots kit_elegoo_v3     its file")]
pub(crate) struct ListArgs {
    /// One topic only
    pub(crate) topic: Option<Topic>,
    /// Of robots, worlds, scenarios and policies: print the file of this one
    #[arg(value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// As one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `rumbo completions`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo completions bash        > ~/.local/share/bash-completion/completions/rumbo
  rumbo completions fish        > ~/.config/fish/completions/rumbo.fish
  rumbo completions zsh         > ~/.zfunc/_rumbo, with ~/.zfunc in fpath
  rumbo completions powershell  >> $PROFILE")]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}

/// Options of `rumbo manual`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo manual ~/.local/share/man/man1            then: man rumbo-run")]
pub(crate) struct ManualArgs {
    /// Folder for them
    #[arg(value_name = "FOLDER")]
    pub(crate) folder: PathBuf,
}

/// What can be listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Topic {
    /// Experiments
    Scenarios,
    /// Walls and boxes
    Worlds,
    /// Robots and their rigs
    Robots,
    /// Learned networks for mode `policy`
    Policies,
    /// Where the sonars of a robot can sit
    Rigs,
    /// What the robot can do: states, reference and its range
    Modes,
    /// Basic movements of mode `manual`
    Movements,
    /// Parameters of the control core
    Parameters,
    /// Numbers of the plant
    Plant,
    /// Example sketches, for `--sketch example:NAME`
    Sketches,
    /// Serial ports of this computer
    Ports,
    /// Recorded sessions and runs, newest last
    Logs,
}

/// Shows help and version; turns a wrong argument into one line.
pub(crate) fn explain(error: &clap::Error) -> Result<(), Failure> {
    if !error.use_stderr() {
        return Ok(error.print()?);
    }
    if let Some(remedy) = elsewhere(error) {
        return Err(Failure::Input(remedy));
    }
    let text = error.to_string();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let message: Vec<&str> = lines
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"))
        // An option that does not exist is no value.
        .filter(|line| !line.starts_with("tip: to pass"))
        .collect();
    let message = in_words(message.join("; ").replace(":; ", ": "));
    Err(Failure::Input(format!(
        "{}; see `{} --help`",
        message.trim_start_matches("error: "),
        command_asked()
    )))
}

/// Where what a word asks for is, if it is in another program.
fn elsewhere(error: &clap::Error) -> Option<String> {
    let word = error.get(ContextKind::InvalidSubcommand)?;
    (*word == ContextValue::String("ros".to_owned())).then(|| {
        "ros: the node of ROS 2 is a program of its own, beside `rumbo lab` or `rumbo connect`; rumbo-ros, in the archive for Linux and the Debian package, else by `cargo install --path ros` in a checkout (docs/ros2.md)".to_owned()
    })
}

impl Cli {
    /// The words that the process was started with.
    pub(crate) fn of_process() -> Result<Self, clap::Error> {
        let matches = with_negatives(Self::command()).try_get_matches()?;
        Self::from_arg_matches(&matches)
    }
}

/// The command, with `-1` as the value of any option before it: what is wrong with the value is then said.
fn with_negatives(command: clap::Command) -> clap::Command {
    command
        .mut_args(|arg| {
            let takes = arg.get_long().is_some() && arg.get_action().takes_values();
            arg.allow_negative_numbers(takes)
        })
        .mut_subcommands(with_negatives)
}

/// What the parser of numbers and addresses says of a value, as people say it.
fn in_words(message: String) -> String {
    const WORDS: [(&str, &str); 4] = [
        (
            "invalid float literal",
            "must be a number, with a point before decimals, e.g. 1.5",
        ),
        (
            "invalid digit found in string",
            "must be a whole number from 0 on",
        ),
        ("number too large to fit in target type", "is too large"),
        (
            "invalid IP address syntax",
            "must be an IP address of this computer, e.g. 192.168.1.7",
        ),
    ];
    let range = message
        .rsplit_once(" is not in ")
        .and_then(|(value, range)| {
            let (least, most) = range.split_once("..=")?;
            let (before, _) = value.rsplit_once(' ')?;
            Some(format!(
                "{before} must be a whole number within {least}..{most}"
            ))
        });
    range.unwrap_or_else(|| {
        WORDS
            .iter()
            .fold(message, |message, (from, to)| message.replace(from, to))
    })
}

/// The command whose help to suggest.
fn command_asked() -> String {
    let first = std::env::args_os().nth(1).unwrap_or_default();
    let command = Cli::command();
    let mut known = command.get_subcommands().map(clap::Command::get_name);
    match known.find(|name| *name == first) {
        Some(name) => format!("rumbo {name}"),
        None => "rumbo".into(),
    }
}

#[cfg(test)]
mod tests;
