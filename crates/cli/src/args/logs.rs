//! Options of the commands for logs: `import`, `replay`, `export`, `compare`, `rerun`, `prune`.

use super::groups::{OverwriteArgs, SeedArgs, ServeArgs};
use super::runs::LanguageName;
use super::values::{percent, speed};
use crate::column_names::names;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Options of `rumbo import`.
#[derive(Args, Debug)]
#[command(after_help = format!("\
Examples:
  rumbo import runs/mode5.csv
  rumbo import terminal.txt
  rumbo import mine.csv               shows its columns and the command that imports them
  rumbo import mine.csv --columns t_ms=millis,left_rpm=speedL,right_rpm=speedR,left_pwm=pwmL,right_pwm=pwmR
  rumbo import counts.csv --columns t_ms=t_ms,left_turn=count_l/748,right_turn=count_r/748
  rumbo import plotter.txt --columns auto,dt_ms=20
  rumbo import bag_0.mcap             a bag of ROS 2, .mcap or .db3: its types say what is what

Tables of other programs: CSV with any names, rows of the Serial Plotter (name:value) and what the Serial Monitor copied, exports of
TelemetryViewer and PlotJuggler. NAME=COLUMN says what a column is, with its unit; COLUMN*2 and COLUMN/748 scale it, #2 is the second
column, and auto takes what is certain without being said. left_turn, left_rad and left_deg are how far a wheel has turned. Columns that
are not named are kept as numbers. The names: {}

The original program's CSV begins with the names of its columns; as a spreadsheet has saved it (semicolons, decimal commas, quoted cells,
UTF-16) it is taken too, as any table is:
  modes 1 to 4  dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b
  modes 5, 6    dt_ms,speed_a_rpm,speed_b_rpm,reference_rpm,mode,pwm_a,pwm_b
  mode 7        dt_ms,speed_a_rpm,speed_b_rpm,reference_a_rpm,reference_b_rpm,x_m,y_m,heading_deg,pwm_a,pwm_b
  mode 8        dt_ms,reference_a_rpm,reference_b_rpm,heading_reference_deg,goal_x_m,goal_y_m,x_m,y_m,heading_deg,state,right_cm,
                left_cm,front_cm
A capture of a terminal has rows of telemetry and the commands typed, a line each. Damaged lines are skipped and listed, as long as more of them
are sound.", names()))]
pub(crate) struct ImportArgs {
    /// Table, capture of a terminal, bag or log of another program
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// What the columns of another program's table are; may be repeated
    #[arg(long, value_name = "NAME=COLUMN,...", value_delimiter = ',')]
    pub(crate) columns: Vec<String>,
    /// The log to write [default: the same name with .mcap, in the current folder; -rumbo.mcap where it has that]
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
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
  rumbo replay out/mode1-7.mcap --port 0 --no-browser
  rumbo replay rumbo-sweep            the page of a sweep: a click on a run replays it")]
pub(crate) struct ReplayArgs {
    /// The log, or the folder of a sweep
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// Show a simulated robot that receives the same commands, in this scenario [default: the log's]
    #[arg(long, value_name = "SCENARIO", num_args = 0..=1)]
    pub(crate) ghost: Option<Option<String>>,
    #[command(flatten)]
    pub(crate) serve: ServeArgs,
    /// Seconds of the log per second; 0 starts paused
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = speed)]
    pub(crate) speed: f64,
}

/// Options of `rumbo export`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo export out/mode1-7.mcap
  rumbo export out/mode1-7.mcap --format svg --out figures
  rumbo export out/mode1-7.mcap --format svg --signals range_front_m,left_pwm --from 2 --to 5
  rumbo export out/mode8-goals-1.mcap --ros2bag

CSV: one row per telemetry frame, time and units in the names of the columns; empty where a value is not known, inf where a sonar
hears nothing within its reach; events in a second file.")]
pub(crate) struct ExportArgs {
    /// The log
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// What to write; may be repeated [default: csv and svg]
    #[arg(long = "format", value_enum, value_name = "FORMAT")]
    pub(crate) formats: Vec<Format>,
    /// Signals of the figure instead of the usual ones, with commas between them; each unit gets a panel
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) signals: Vec<String>,
    /// Only from this time on, in seconds; not of a bag
    #[arg(long = "from", value_name = "S", conflicts_with = "ros2bag")]
    pub(crate) from_s: Option<f64>,
    /// Only up to this time, in seconds; not of a bag
    #[arg(long = "to", value_name = "S", conflicts_with = "ros2bag")]
    pub(crate) to_s: Option<f64>,
    /// A bag of ROS 2 instead, or besides: odometry, transforms, sonars, map, joints, battery, diagnostics, events
    #[arg(long)]
    pub(crate) ros2bag: bool,
    /// The sonars as one LaserScan in the bag, too
    #[arg(long, requires = "ros2bag")]
    pub(crate) scan: bool,
    /// Folder for the files; made if need be [default: the current one]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
}

/// Options of `rumbo explain`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo explain out/mode1-7.mcap
  rumbo explain out/mode1-7.mcap --from 2 --to 5 --json

Each line says what the log shows; without ground truth, of a real robot, fewer causes can be found.")]
pub(crate) struct ExplainArgs {
    /// The log
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// From this time on, in seconds [default: the beginning]
    #[arg(long = "from", value_name = "S")]
    pub(crate) from_s: Option<f64>,
    /// Up to this time, in seconds [default: the end]
    #[arg(long = "to", value_name = "S")]
    pub(crate) to_s: Option<f64>,
    /// As JSON on stdout
    #[arg(long)]
    pub(crate) json: bool,
}

/// What a log can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Signals and events as tables
    Csv,
    /// Figures as vector graphics
    Svg,
}

/// Options of `rumbo compare`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo compare out/mode1-7.mcap out/mode1-8.mcap
  rumbo compare before/mode1-7.mcap after/mode1-7.mcap --tolerance 5
  rumbo compare a.mcap b.mcap c.mcap --out overlaid.svg --json
  rumbo compare mode1 --with front_kp=5 --with front_kp=8 --runs 200
  rumbo compare mode5 --with program=rumbo --with program=baseline --out page.html
  rumbo compare mode7 --with waypoint_tracker=pure_pursuit,pursuit_lookahead_m=0.2
  rumbo compare mode1 --with sketch=mine --with sketch=example:wall

Logs: with --tolerance, exit status 1 if a metric of a later log differs from the first one's by more, or a run fails where
the first passed.

A scenario with --with: every variant is run with the same seeds, so that each pair of runs is of one robot with itself. A
variant is NAME=VALUE with parameters of the control core or the plant, or robot, world, rig, program, firmware, sketch or wiring;
several with commas between them. Differences are from the first variant; with one --with from the scenario as it is.
Shown: medians, the mean difference with its 95 % interval (Student's t of the pairs), the effect (the mean over the standard
deviation of the differences), and the share of seeds in which it is better.")]
pub(crate) struct CompareArgs {
    /// Logs, or with --with a scenario; differences are from the first
    #[arg(required = true, value_name = "LOG")]
    pub(crate) logs: Vec<PathBuf>,
    /// Variant of the scenario; may be repeated
    #[arg(long = "with", value_name = "NAME=VALUE", conflicts_with = "tolerance")]
    pub(crate) variants: Vec<String>,
    /// Runs of each variant, with consecutive seeds
    #[arg(long, value_name = "N", default_value_t = 50, requires = "variants", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub(crate) runs: u32,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Largest allowed difference of a metric, in percent of the first log's value
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub(crate) tolerance: Option<f64>,
    /// Figure with all logs overlaid (SVG); of variants a page with box plots (HTML)
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// The result as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Language of the page [default: that of the locale]
    #[arg(long, value_enum, value_name = "LANGUAGE", requires = "variants")]
    pub(crate) language: Option<LanguageName>,
    /// Threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "N", requires = "variants", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Options of `rumbo rerun`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo rerun out/mode1-7.mcap
  rumbo rerun out/mode1-7.mcap --json

Exit status 0 if the run is the same, 1 if it differs.")]
pub(crate) struct RerunArgs {
    /// Log of a simulated run: of `rumbo run`, `rumbo lab` or `rumbo calibrate`
    #[arg(value_name = "LOG")]
    pub(crate) log: PathBuf,
    /// The result as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `rumbo prune`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo prune --keep-days 30 --dry-run
  rumbo prune --keep-days 30

Removes logs from the folder that `rumbo list logs` shows, by the time when they were written last. Logs in folders of
--out stay, and so does what is no log of Rumbo. Nothing is ever removed without this command.")]
pub(crate) struct PruneArgs {
    /// Keep the logs of the last N days
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=36_500))]
    pub(crate) keep_days: u32,
    /// Only list what would be removed
    #[arg(long)]
    pub(crate) dry_run: bool,
}
