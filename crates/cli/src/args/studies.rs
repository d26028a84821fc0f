//! Options of the commands that run one scenario many times to learn about its parameters: `sweep`.

use super::groups::{ImageArgs, OverwriteArgs, ParameterArgs, SeedArgs, SettingArgs};
use super::runs::{LanguageName, ProgramName};
use clap::Args;
use rumbo_experiment::sweep::Axis;
use std::path::PathBuf;

/// Options of `rumbo sweep`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  rumbo sweep mode1 front_kp=1:20:10
  rumbo sweep mode1 front_kp=1:20:10 battery.open_circuit_v=6.8,7.4,8.2 --runs 50
  rumbo sweep mode5 kv=0.01:0.1:log ki=0:1 --sobol 200 --by rms_rad_s
  rumbo sweep mode1 front_kp=1:20:10 --resume
  rumbo replay rumbo-sweep            the page, its best and worst runs one click away

An axis is NAME=FROM:TO:COUNT (even steps, both ends included; FROM:TO:COUNT:log for even steps of the logarithm) or
NAME=VALUE,VALUE; with --random or --sobol, NAME=FROM:TO. Every point is run with the same seeds.

In DIR: index.html (curves, heat maps, parallel coordinates, best and worst points), runs.csv and runs.parquet (a row for each
run), logs of the best and the worst runs, and runs.jsonl, to which every run is added as it is done: --resume goes on from
there after Ctrl-C, a full disk or a power cut.

Exit status 0: done; 2: wrong input; 130: Ctrl-C.")]
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
    /// Metric by which points are ranked; of several steps or goals the worst counts [default: a time with a limit]
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
