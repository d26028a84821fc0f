//! Options of the commands for logs: `import`, `replay`, `export`, `compare`, `rerun`, `prune`.

use super::groups::{OverwriteArgs, SeedArgs, ServeArgs};
use super::runs::LanguageName;
use super::values::{percent, speed};
use crate::column_names::names;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Options of `rumbo import`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/import.txt").replace("{names}", &names()))]
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
#[command(after_help = include_str!("../../help/replay.txt"))]
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
#[command(after_help = include_str!("../../help/export.txt"))]
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
#[command(after_help = include_str!("../../help/explain.txt"))]
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
#[command(after_help = include_str!("../../help/compare.txt"))]
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
#[command(after_help = include_str!("../../help/rerun.txt"))]
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
#[command(after_help = include_str!("../../help/prune.txt"))]
pub(crate) struct PruneArgs {
    /// Keep the logs of the last N days
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=36_500))]
    pub(crate) keep_days: u32,
    /// Only list what would be removed
    #[arg(long)]
    pub(crate) dry_run: bool,
}
