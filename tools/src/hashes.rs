//! The hashes of headless runs, as the tests compare them with those of a browser: every scenario with these seeds, those
//! in files among them, and one run of `mode5` by each image. Prints one JSON object: names of scenarios and paths of files
//! to their hashes.
//!
//! `hashes SEEDS [IMAGE | SCENARIO.toml]...`

use rumbo_experiment::files::{Kind, Library, Overrides};
use rumbo_lab::run_hash;
use serde_json::{Map, json};
use std::process::ExitCode;

pub(crate) fn main() -> ExitCode {
    match hashes(crate::arguments()) {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("hashes: {error}");
            ExitCode::FAILURE
        }
    }
}

fn hashes(mut arguments: impl Iterator<Item = String>) -> Result<String, String> {
    let seeds = arguments.next().and_then(|count| count.parse::<u64>().ok());
    let seeds = seeds.ok_or("the first argument is the number of seeds")?;
    let mut found = Map::new();
    let (files, images): (Vec<_>, Vec<_>) = arguments.partition(|path| path.ends_with(".toml"));
    for scenario in Library::new().list(Kind::Scenario).into_iter().chain(files) {
        let hashes = (1..=seeds).map(|seed| run(&scenario, seed, None));
        let hashes = hashes.collect::<Result<Vec<_>, _>>()?;
        found.insert(scenario, json!(hashes));
    }
    for path in images {
        let image = std::fs::read(&path).map_err(|error| format!("{path}: {error}"))?;
        // Each run names it as the browser does.
        let hash = run("mode5", 1, Some(("image", &image)))?;
        found.insert(path, json!([hash]));
    }
    Ok(json!(found).to_string())
}

fn run(scenario: &str, seed: u64, image: Option<(&str, &[u8])>) -> Result<String, String> {
    let setup = Library::new().setup(scenario, &Overrides::default());
    let hash = setup.and_then(|setup| run_hash(setup, seed, image));
    hash.map(|hash| format!("{hash:016x}"))
        .map_err(|error| error.to_string())
}
