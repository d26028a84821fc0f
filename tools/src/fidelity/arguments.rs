//! What the command line asks for.

use rumbo_experiment::files::FileError;
use std::path::PathBuf;

/// Robots drawn.
const SEEDS: u64 = 200;

pub(crate) struct Arguments {
    /// Folder of the recorded runs.
    pub(crate) recordings: PathBuf,
    pub(crate) seeds: u64,
    pub(crate) robot: String,
    /// Numbers of the plant that differ from the robot file's.
    pub(crate) parameters: Vec<(String, f64)>,
    only: Vec<String>,
    /// Write table and drawing into the docs.
    pub(crate) write: bool,
}

impl Arguments {
    pub(crate) fn read() -> Result<Self, FileError> {
        let wrong = |what: &str| FileError::Setting(what.to_owned());
        let recordings = std::env::var_os("RUMBO_DATA").ok_or_else(|| {
            wrong("RUMBO_DATA is not set; set it to the folder of the recorded runs (mode1_stop_at_wall.csv and others)")
        })?;
        let mut asked = Self {
            recordings: recordings.into(),
            seeds: SEEDS,
            robot: "memoria".to_owned(),
            parameters: Vec::new(),
            only: Vec::new(),
            write: false,
        };
        let mut args = crate::arguments();
        while let Some(option) = args.next() {
            let mut value = || {
                args.next()
                    .ok_or_else(|| wrong(&format!("{option} needs a value")))
            };
            match option.as_str() {
                "--seeds" => {
                    let seeds = value()?.parse().ok().filter(|seeds| *seeds > 0);
                    asked.seeds = seeds.ok_or_else(|| wrong("--seeds: give a number from 1 on"))?;
                }
                "--robot" => asked.robot = value()?,
                "--only" => asked.only.push(value()?),
                "--write" => asked.write = true,
                "--param" => {
                    let text = value()?;
                    let pair = text
                        .split_once('=')
                        .and_then(|(key, value)| Some((key.to_owned(), value.parse().ok()?)));
                    let pair = pair.ok_or_else(|| wrong("--param: give KEY=VALUE of the plant"))?;
                    asked.parameters.push(pair);
                }
                _ => {
                    return Err(wrong(&format!(
                        "unknown option {option}; allowed: --seeds, --robot, --param, --only, --write"
                    )));
                }
            }
        }
        Ok(asked)
    }

    pub(crate) fn wants(&self, scenario: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|name| name == scenario)
    }
}
