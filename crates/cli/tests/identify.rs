//! `rumbo identify --drive`: simulated robots with known parameters are driven, recorded and identified.
//!
//! Two robots by default; `RUMBO_ROBOTS=100` for the campaign.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "support/mod.rs"]
mod support;

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Robots of a sample.
const SAMPLE: u64 = 2;
/// Share of the true values that lie inside their 95 % intervals.
const INSIDE: f64 = 0.90;
/// What any drive excites, and the widest interval of it, as the median of the robots.
const EXCITED: [&str; 2] = ["motor.back_emf_v_s", "wheels.right.strength"];
const WIDEST: f64 = 0.10;

fn identified(folder: &Path, seed: u64) -> Value {
    let seed = seed.to_string();
    let output = support::program()
        .args(["identify", "--drive", "lab", "--json", "--seed", &seed])
        .arg("--out")
        .arg(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "seed {seed}: {said}");
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_true_parameters_lie_within_their_intervals() {
    let robots = std::env::var("RUMBO_ROBOTS").map_or(SAMPLE, |robots| robots.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let mut of: BTreeMap<String, Vec<(bool, f64)>> = BTreeMap::new();
    for seed in 1..=robots {
        let found = identified(folder.path(), seed);
        for row in found["against_truth"].as_array().unwrap() {
            let number = |key: &str| row[key].as_f64().unwrap();
            let (value, within) = (number("value"), number("within"));
            let inside = (value - number("truth")).abs() <= within;
            let rows = of.entry(row["key"].as_str().unwrap().to_owned());
            rows.or_default().push((inside, within / value));
        }
    }
    let (mut inside, mut all) = (0, 0);
    for (key, rows) in &mut of {
        rows.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (count, median) = (
            rows.iter().filter(|row| row.0).count(),
            rows[rows.len() / 2].1,
        );
        println!(
            "{key:<38}{count:>4} of {:<4} +- {:.1} %",
            rows.len(),
            100.0 * median
        );
        (inside, all) = (inside + count, all + rows.len());
        if EXCITED.contains(&key.as_str()) {
            assert!(median <= WIDEST, "{key}: {median}");
        }
    }
    let share = f64::from(inside as u32) / f64::from(all as u32);
    println!("inside: {inside} of {all}");
    assert!(share >= INSIDE, "{share}");
}

#[test]
fn a_drive_is_an_ordinary_log_that_is_identified_again_and_written_into_a_robot_file() {
    let folder = tempfile::tempdir().unwrap();
    let first = identified(folder.path(), 3);
    let log = first["log"].as_str().unwrap();
    let file = folder.path().join("mine.toml");
    let output = support::program()
        .args(["identify", log, "--json", "--write"])
        .arg(&file)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let again: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(first["parameters"], again["parameters"]);
    assert!(
        std::fs::read_to_string(&file)
            .unwrap()
            .contains("# Identified by `rumbo identify`")
    );
}
