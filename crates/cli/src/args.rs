//! The command line: subcommands, options, and the examples that each `--help` shows.

use crate::failure::Failure;
use clap::{Args, Parser, Subcommand, ValueEnum};
use rumbo_scenario::files::TimedText;
use std::path::PathBuf;

/// Rumbo: the lab of a small robot. Without a subcommand, `lab`.
#[derive(Debug, Parser)]
#[command(
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
    #[command(flatten)]
    pub(crate) lab: LabArgs,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Drive a simulated robot from a dashboard in the browser
    Lab(LabArgs),
    /// Drive a real robot from the same dashboard, over a serial port or TCP
    Connect(ConnectArgs),
    /// Write the image to an Arduino Mega
    Flash(FlashArgs),
    /// Run scenarios as fast as the machine can and judge their metrics
    Run(RunArgs),
    /// Run every experiment of the report and write it: one page with all figures
    Experiments(ExperimentsArgs),
    /// Find the plant's parameters from recorded runs
    Identify(IdentifyArgs),
    /// Let the robot calibrate itself: dead zones, feedforward, wheels, base
    Calibrate(CalibrateArgs),
    /// Check a CSV of the original program and convert it to a log (MCAP)
    Import(ImportArgs),
    /// Show a log in the dashboard: play, pause, step, scrub
    Replay(ReplayArgs),
    /// Write a log as CSV, SVG or PNG
    Export(ExportArgs),
    /// Metrics of several logs side by side, with their differences
    Compare(CompareArgs),
    /// Run a recorded simulation again and compare it bit for bit
    Rerun(RerunArgs),
    /// List modes, scenarios, worlds, rigs, robots and parameters
    List(ListArgs),
}

/// Where the dashboard is served.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ServeArgs {
    /// Port of the dashboard; 0 takes any free one
    #[arg(long, value_name = "N", default_value_t = rumbo_station::DEFAULT_PORT)]
    pub(crate) port: u16,
    /// Serve the dashboard to the network too, at this address of this computer; prints an address that opens once and one for viewers.
    /// Not encrypted (docs/security.md)
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) listen: Option<std::net::IpAddr>,
}

/// The live bridge.
#[cfg(feature = "foxglove")]
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct BridgeArgs {
    /// Show the session to Foxglove or Lichtblick too, on this port of 127.0.0.1; read-only
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8765")]
    pub(crate) foxglove: Option<u16>,
}

impl ServeArgs {
    /// The address and port.
    pub(crate) fn at(self) -> rumbo_station::ServeAt {
        let here = rumbo_station::ServeAt::here(self.port);
        rumbo_station::ServeAt {
            address: self.listen.unwrap_or(here.address),
            ..here
        }
    }
}

/// Options of `rumbo lab`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  rumbo lab
  rumbo lab --scenario mode5 --speed 4
  rumbo lab --scenario mode1 --rig final --world room
  rumbo lab --scenario mode1 --firmware my_sketch.elf --wiring final
  rumbo lab --scenario mode5 --firmware my_sketch.elf --gdb 1234
  rumbo lab --port 9000 --no-browser
  rumbo lab --listen 192.168.1.7
  rumbo lab --pty")]
pub(crate) struct LabArgs {
    /// Scenario that the robot starts in: name or path
    #[arg(long, value_name = "NAME", default_value = "mode1")]
    pub(crate) scenario: String,
    /// Robot instead of the scenario's own: name or path
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// World instead of the scenario's own: name or path
    #[arg(long, value_name = "NAME")]
    pub(crate) world: Option<String>,
    /// Rig instead of the scenario's own: where the sonars sit
    #[arg(long, value_name = "NAME")]
    pub(crate) rig: Option<String>,
    /// Program image for the Mega, ELF or Intel HEX, run on an emulated one in the robot (docs/emulator.md)
    #[arg(long, value_name = "IMAGE")]
    pub(crate) firmware: Option<PathBuf>,
    /// Wiring of that Mega, of the robot file [default: the report's for the experiment; `final` for our own image]
    #[arg(long, value_name = "NAME", requires = "firmware")]
    pub(crate) wiring: Option<String>,
    /// Port on 127.0.0.1 where avr-gdb may come and go; 0 takes any free one. Robot and world stand while it holds the program
    #[arg(long, value_name = "PORT", requires = "firmware")]
    pub(crate) gdb: Option<u16>,
    #[command(flatten)]
    pub(crate) serve: ServeArgs,
    #[cfg(feature = "foxglove")]
    #[command(flatten)]
    pub(crate) bridge: BridgeArgs,
    /// Do not open the browser
    #[arg(long)]
    pub(crate) no_browser: bool,
    /// Seconds of simulation per second; 0 starts paused
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    pub(crate) speed: f64,
    /// Seed of everything random
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder for the log of each run; made if need be [default: rumbo/logs in the user's data folder]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Offer the robot as a serial port to other programs, without a dashboard; prints the port's name
    #[cfg(unix)]
    #[arg(long, conflicts_with_all = ["port", "listen", "no_browser", "out"])]
    pub(crate) pty: bool,
}

/// Options of `rumbo connect`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  rumbo connect /dev/ttyACM0
  rumbo connect /dev/rfcomm0 --baud 9600
  rumbo connect COM5
  rumbo connect tcp:192.168.1.7:2000 --no-browser

`rumbo list ports` shows the serial ports of this computer. Connecting arms nothing. Should the port go, the robot stops by itself; it is
found again when the port is back.")]
pub(crate) struct ConnectArgs {
    /// Serial port by its name, or tcp:host:port
    #[arg(value_name = "PORT")]
    pub(crate) address: String,
    /// Show a simulated robot in this scenario that gets the same commands: put the robot where it begins
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) ghost: Option<String>,
    /// Speed of the serial port; the robot's is 9600
    #[arg(long, value_name = "N", default_value_t = rumbo_station::port::DEFAULT_BAUD, value_parser = clap::value_parser!(u32).range(300..=2_000_000))]
    pub(crate) baud: u32,
    #[command(flatten)]
    pub(crate) serve: ServeArgs,
    #[cfg(feature = "foxglove")]
    #[command(flatten)]
    pub(crate) bridge: BridgeArgs,
    /// Do not open the browser
    #[arg(long)]
    pub(crate) no_browser: bool,
    /// Folder for the log; made if need be [default: rumbo/logs in the user's data folder]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Options of `rumbo flash`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  rumbo flash /dev/ttyACM0
  rumbo flash COM5 --image my_sketch.hex
  rumbo flash /dev/ttyACM0 --print

The board is asked for its signature before anything is written. Parameters saved on the robot stay. Needs avrdude; `rumbo list ports` shows the
serial ports of this computer. Before the first run: docs/wiring.md.")]
pub(crate) struct FlashArgs {
    /// Serial port of the Mega's USB cable
    #[arg(value_name = "PORT")]
    pub(crate) port: String,
    /// Image to write, Intel HEX or ELF [default: the one that `cargo xtask firmware` built, target/firmware/rumbo.hex]
    #[arg(long, value_name = "FILE")]
    pub(crate) image: Option<PathBuf>,
    /// Print the commands instead of running them
    #[arg(long)]
    pub(crate) print: bool,
}

/// Options of `rumbo run`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo run mode1
  rumbo run mode5 --runs 20 --json
  rumbo run mode5 --runs 20 --program original
  rumbo run mode1 --rig final --world room
  rumbo run mode5 --firmware my_sketch.elf --command 'REF 40@20'
  rumbo run mode5 --firmware my_sketch.elf --profile cycles.folded --vcd pins.vcd
  rumbo run mode5 --firmware my_sketch.elf --gdb 1234   # then: avr-gdb my_sketch.elf -ex 'target remote :1234'
  rumbo run mode1 --seed 7 --param battery.open_circuit_v=6.9 --out out/mode1")]
pub(crate) struct RunArgs {
    /// Scenarios: names, or paths of files
    #[arg(required = true, value_name = "SCENARIO")]
    pub(crate) scenarios: Vec<String>,
    /// Seed of the first run; each further run takes the next
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Runs of each scenario, each with a seed of its own
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) runs: u32,
    /// Robot instead of the scenario's own: name or path
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// World instead of the scenario's own: name or path
    #[arg(long, value_name = "NAME")]
    pub(crate) world: Option<String>,
    /// Rig instead of the scenario's own
    #[arg(long, value_name = "NAME")]
    pub(crate) rig: Option<String>,
    /// Program at the robot's pins: ours, or the report's with its schemes and gains (of parameters, only the plant's
    /// count for that one)
    #[arg(long, value_enum, value_name = "NAME", default_value_t)]
    pub(crate) program: ProgramName,
    /// Program image for the Mega, ELF or Intel HEX, run on an emulated one in the robot (docs/emulator.md)
    #[arg(long, value_name = "IMAGE", conflicts_with = "program")]
    pub(crate) firmware: Option<PathBuf>,
    /// Wiring of that Mega, of the robot file [default: the report's for the experiment; `final` for our own image]
    #[arg(long, value_name = "NAME", requires = "firmware")]
    pub(crate) wiring: Option<String>,
    /// Line of text sent over the link at a time, e.g. 'REF 40@6'; may be repeated
    #[arg(long = "command", value_name = "TEXT@SECONDS", value_parser = timed_text, conflicts_with = "program")]
    pub(crate) commands: Vec<TimedText>,
    /// Parameter of the control core or the plant (`rumbo list`); may be repeated
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = parameter)]
    pub(crate) params: Vec<(String, f64)>,
    /// Folder for the log, the result and the true signals of each run; made if need be
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// One JSON object per run on stdout
    #[arg(long)]
    pub(crate) json: bool,
    /// File for the firmware's cycles by function, for flame graphs; what it comes to goes to stderr. One run
    #[arg(long, value_name = "FILE", requires = "firmware")]
    pub(crate) profile: Option<PathBuf>,
    /// File for the Mega's pins over time, for a viewer of waveforms such as GTKWave. One run
    #[arg(long, value_name = "FILE", requires = "firmware")]
    pub(crate) vcd: Option<PathBuf>,
    /// Port on 127.0.0.1 where the run waits for avr-gdb; 0 takes any free one. One run
    #[arg(long, value_name = "PORT", requires = "firmware")]
    pub(crate) gdb: Option<u16>,
    /// Threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// The programs that can drive the simulated robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgramName {
    /// Ours
    #[default]
    Rumbo,
    /// The report's, as a baseline
    Original,
}

/// Options of `rumbo experiments`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo experiments
  rumbo experiments --language es --out informe
  rumbo experiments --only mode1 mode5 --seed 7
  rumbo experiments --real runs
  rumbo experiments --firmware my_sketch.elf

Writes DIR/report.html: no part of it comes from elsewhere, and it prints well. The same version, seed and files give the same bytes. Exit
status 1 if an experiment misses a limit.")]
pub(crate) struct ExperimentsArgs {
    /// Folder for the report; made if need be
    #[arg(long, value_name = "DIR", default_value = "rumbo-report")]
    pub(crate) out: PathBuf,
    /// Language of the report [default: that of the locale]
    #[arg(long, value_enum, value_name = "LANGUAGE")]
    pub(crate) language: Option<LanguageName>,
    /// These experiments only: names as in the report's links, e.g. mode1, or of scenarios
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub(crate) only: Vec<String>,
    /// Seed of all runs
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Folder with CSVs of recorded runs (the original program's), shown beside ours
    #[arg(long, value_name = "DIR")]
    pub(crate) real: Option<PathBuf>,
    /// Robot instead of the scenarios' own: name or path
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// Program image for the Mega, ELF or Intel HEX, run on an emulated one in the robot (docs/emulator.md)
    #[arg(long, value_name = "IMAGE")]
    pub(crate) firmware: Option<PathBuf>,
    /// Wiring of that Mega, of the robot file [default: the report's for each experiment; `final` for our own image]
    #[arg(long, value_name = "NAME", requires = "firmware")]
    pub(crate) wiring: Option<String>,
    /// Also the true signals of each run as CSV, and its metrics as JSON
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

/// Options of `rumbo identify`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo identify runs/mode5.csv runs/mode7.csv --robot my_robot.toml
  rumbo identify runs/mode5.csv --check memoria --json --plots out

Whole run: the recorded duty replayed, from the first row to the last. 0.5 s ahead: from the state that the rows
up to then tell (wheel speeds, the floor's resistance), no later speed used. Of each run only the battery's
voltage and the floor's friction are fitted with --check. Without it a fit takes some two minutes.")]
pub(crate) struct IdentifyArgs {
    /// Recorded runs: CSV of the original program, or logs made of them by `rumbo import`
    #[arg(required = true, value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
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
    /// The result as JSON on stdout
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for plots of measured against simulated, SVG and PNG; made if need be
    #[arg(long, value_name = "DIR")]
    pub(crate) plots: Option<PathBuf>,
}

/// Options of `rumbo calibrate`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo calibrate
  rumbo calibrate --seed 7 --json
  rumbo calibrate --seed 7 --out my_robot.toml

The robot stands 0.3 to 0.5 m beside a wall, along it, on its final rig, with 2.5 m free ahead. It drives along the wall to and fro,
turns on the spot, and is done in less than three minutes.")]
pub(crate) struct CalibrateArgs {
    /// Robot: name or path
    #[arg(long, value_name = "NAME", default_value = "memoria")]
    pub(crate) robot: String,
    /// Rig instead of `final`; it must have a sonar ahead and one on each side
    #[arg(long, value_name = "NAME")]
    pub(crate) rig: Option<String>,
    /// World instead of the one made for it; the robot starts at x = -1.1, y = -0.45 m there, along x
    #[arg(long, value_name = "NAME")]
    pub(crate) world: Option<String>,
    /// Seed that draws the robot and everything random
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Parameter of the control core or the plant (`rumbo list`); may be repeated
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = parameter)]
    pub(crate) params: Vec<(String, f64)>,
    /// Robot file whose [parameters] table is rewritten; a new file starts as a copy of the robot's
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) out: Option<PathBuf>,
    /// The result as JSON on stdout
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `rumbo import`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo import runs/mode5.csv
  rumbo import runs/mode5.csv --out logs/mode5.mcap --json
  rumbo import terminal.txt

A CSV begins with the names of its columns. A capture of a terminal has rows of telemetry and the commands typed, a line each.")]
pub(crate) struct ImportArgs {
    /// CSV of the original program
    #[arg(value_name = "FILE.csv")]
    pub(crate) file: PathBuf,
    /// The log to write [default: the same name with .mcap, in the current folder]
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) out: Option<PathBuf>,
    /// The summary as JSON on stdout
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `rumbo replay`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo replay out/mode1-7.mcap
  rumbo replay out/mode1-7.mcap --speed 4
  rumbo replay robot.mcap --ghost mode1
  rumbo replay out/mode1-7.mcap --port 0 --no-browser")]
pub(crate) struct ReplayArgs {
    /// The log
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// Show a simulated robot that gets the same commands, in this scenario [default: the log's]
    #[arg(long, value_name = "SCENARIO", num_args = 0..=1)]
    pub(crate) ghost: Option<Option<String>>,
    #[command(flatten)]
    pub(crate) serve: ServeArgs,
    /// Do not open the browser
    #[arg(long)]
    pub(crate) no_browser: bool,
    /// Seconds of the log per second; 0 starts paused
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    pub(crate) speed: f64,
}

/// Options of `rumbo export`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo export out/mode1-7.mcap
  rumbo export out/mode1-7.mcap --format png --out figures

CSV: one row per telemetry frame, time and units in the names of the columns; empty where a value is not known, inf where a sonar
hears nothing within its reach; events in a second file.")]
pub(crate) struct ExportArgs {
    /// The log
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// What to write; may be repeated [default: csv and svg]
    #[arg(long = "format", value_enum, value_name = "FORMAT")]
    pub(crate) formats: Vec<Format>,
    /// Folder for the files; made if need be [default: the current one]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// What a log can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Signals and events as tables
    Csv,
    /// Figures as vector graphics
    Svg,
    /// Figures as an image
    Png,
}

/// Options of `rumbo compare`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo compare out/mode1-7.mcap out/mode1-8.mcap
  rumbo compare before/mode1-7.mcap after/mode1-7.mcap --tolerance 5
  rumbo compare a.mcap b.mcap c.mcap --out overlaid.svg --json

With --tolerance, exit status 1 if a metric of a later log differs from the first one's by more, or a run fails where the first
passed.")]
pub(crate) struct CompareArgs {
    /// The logs; differences are from the first
    #[arg(required = true, num_args = 2.., value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
    /// Largest allowed difference of a metric, in percent of the first log's value
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub(crate) tolerance: Option<f64>,
    /// Figure with all runs over each other
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) out: Option<PathBuf>,
    /// The result as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `rumbo rerun`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo rerun out/mode1-7.mcap
  rumbo rerun out/mode1-7.mcap --json

Exit status 0 if the run is the same, 1 if it differs.")]
pub(crate) struct RerunArgs {
    /// Log of a simulated run: of `rumbo run --out` or `rumbo lab`
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// The result as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `rumbo list`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo list
  rumbo list modes
  rumbo list parameters
  rumbo list logs
  rumbo list scenarios --json")]
pub(crate) struct ListArgs {
    /// One topic only
    pub(crate) topic: Option<Topic>,
    /// As one JSON object
    #[arg(long)]
    pub(crate) json: bool,
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
    /// Serial ports of this computer
    Ports,
    /// Recorded runs of `rumbo lab`, newest last
    Logs,
}

/// Shows help and version; turns a wrong argument into one line.
pub(crate) fn explain(error: &clap::Error) -> Result<(), Failure> {
    if !error.use_stderr() {
        return Ok(error.print()?);
    }
    let text = error.to_string();
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let told: Vec<&str> = lines
        .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"))
        .collect();
    let told = told.join("; ").replace(":; ", ": ");
    Err(Failure::Input(format!(
        "{}; see `rumbo --help`",
        told.trim_start_matches("error: ")
    )))
}

fn speed(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(speed) if (0.0..=100.0).contains(&speed) => Ok(speed),
        _ => Err("must be a number within 0..100".into()),
    }
}

fn timed_text(text: &str) -> Result<TimedText, String> {
    let wrong = || "write it as TEXT@SECONDS, e.g. 'REF 40@6'".to_owned();
    let (line, at_s) = text.rsplit_once('@').ok_or_else(wrong)?;
    let at_s: f64 = at_s.trim().parse().map_err(|_| wrong())?;
    if !at_s.is_finite() || at_s < 0.0 {
        return Err("the time must be 0 or more seconds".into());
    }
    if line.is_empty() || !line.bytes().all(|byte| (b' '..=b'~').contains(&byte)) {
        return Err("the text must be one line of ASCII".into());
    }
    Ok(TimedText {
        at_s,
        text: line.to_owned(),
    })
}

fn percent(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(percent) if (0.0..=1000.0).contains(&percent) => Ok(percent),
        _ => Err("must be a number within 0..1000".into()),
    }
}

fn parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("write it as name=value, e.g. battery.open_circuit_v=6.9")?;
    let value: f64 = value
        .trim()
        .parse()
        .map_err(|_| format!("`{value}` is not a number"))?;
    if value.is_finite() {
        Ok((name.trim().to_owned(), value))
    } else {
        Err("the value must be finite".into())
    }
}

#[cfg(test)]
mod tests {
    use super::Cli;
    use clap::{CommandFactory, Parser};

    #[test]
    fn every_example_of_the_help_is_a_valid_command() {
        let mut command = Cli::command();
        let helps: Vec<String> = command
            .get_subcommands_mut()
            .map(|subcommand| subcommand.render_help().to_string())
            .chain([Cli::command().render_help().to_string()])
            .collect();
        let mut seen = 0;
        for help in helps {
            let (_, examples) = help.split_once("Examples:").unwrap();
            for example in examples
                .lines()
                .map(str::trim)
                .filter(|line| line.starts_with("rumbo"))
            {
                // A description may follow, set off by blanks.
                let line = example.split_once("  ").map_or(example, |(line, _)| line);
                // As a shell does: what is quoted is one word.
                let words = line.split('\'').enumerate();
                let words = words.flat_map(|(part, text)| match part % 2 {
                    0 => text.split_whitespace().collect(),
                    _ => vec![text],
                });
                Cli::try_parse_from(words).unwrap_or_else(|error| panic!("{line}: {error}"));
                seen += 1;
            }
        }
        assert!(seen > 10);
    }
}
