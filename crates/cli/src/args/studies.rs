//! Options of the commands that run one scenario many times to learn about its parameters: `sweep`, `tune`.

use super::groups::{ImageArgs, OverwriteArgs, ParameterArgs, ProgramName, SeedArgs, SettingArgs};
use super::runs::LanguageName;
use clap::Args;
use rumbo_experiment::sweep::Axis;
use rumbo_experiment::tune::{Objective, Over};
use std::path::PathBuf;

/// Options of `rumbo sweep`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/sweep.txt"))]
pub(crate) struct SweepArgs {
    /// Scenario: name, or path of its file
    #[arg(value_name = "SCENARIO")]
    pub(crate) scenario: String,
    /// Parameters of the control core or the plant (`rumbo list`), each with the values that it takes
    #[arg(required = true, value_name = "NAME=VALUES")]
    pub(crate) axes: Vec<Axis>,
    /// Draw N points at random instead of a grid
    #[arg(long, value_name = "N", conflicts_with = "sobol", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) random: Option<u32>,
    /// Draw N points of a Sobol sequence, which fills the space more evenly
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) sobol: Option<u32>,
    /// Runs of each point, with consecutive seeds
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) runs: u32,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Metric by which points are ranked; of several steps or goals the worst counts [default: a time with a limit, else an error with one]
    #[arg(long, value_name = "METRIC")]
    pub(crate) by: Option<String>,
    #[command(flatten)]
    pub(crate) setting: SettingArgs,
    /// Program at the robot's pins: ours, or the report's
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
    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
    /// Folder for the results; made if need be
    #[arg(long, value_name = "DIR", default_value = "rumbo-sweep")]
    pub(crate) out: PathBuf,
    /// Go on with what DIR has of the same sweep
    #[arg(long, conflicts_with = "force")]
    pub(crate) resume: bool,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// Language of the page [default: that of the locale]
    #[arg(long, value_enum, value_name = "LANGUAGE")]
    pub(crate) language: Option<LanguageName>,
    /// Threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}

/// Options of `rumbo tune`.
#[derive(Args, Debug)]
#[command(after_help = include_str!("../../help/tune.txt"))]
pub(crate) struct TuneArgs {
    /// Scenario: name, or path of its file
    #[arg(value_name = "SCENARIO")]
    pub(crate) scenario: String,
    /// Metrics to make small, and limits, with commas between them
    #[arg(long = "for", value_name = "AIMS")]
    pub(crate) aims: Option<Objective>,
    /// Parameters of the control core, with commas between them
    #[arg(long, required = true, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) over: Vec<Over>,
    #[command(flatten)]
    pub(crate) seed: SeedArgs,
    /// Runs of the search, or some more; 2000 at least [default: 500,000 s of driving]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub(crate) runs: Option<u32>,
    /// Runs with seeds that the search has not seen
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub(crate) held_out: u32,
    #[command(flatten)]
    pub(crate) setting: SettingArgs,
    #[command(flatten)]
    pub(crate) parameters: ParameterArgs,
    /// Drive the first 20 unseen robots with this image of Rumbo's firmware on the emulated Mega too
    #[arg(long, value_name = "IMAGE")]
    pub(crate) image: Option<PathBuf>,
    /// Robot file whose [parameters] get the values: this robot's own, or one that was tuned; a new file starts as a copy
    /// of the robot's
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) overwrite: OverwriteArgs,
    /// The result as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Threads [default: one per core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
}
