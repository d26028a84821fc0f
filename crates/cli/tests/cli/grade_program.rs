//! What a program does inside counts as the emulator saw it: sketches whose text shows nothing of it are caught.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::grade::{bench, results};
use crate::support::{folder, program, stderr};
use std::fs;
use std::path::Path;

#[test]
fn what_a_text_hides_the_emulator_sees() {
    let Some(bench) = bench("program") else {
        return;
    };
    let given = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs/inside");
    let read = |name: &str| fs::read_to_string(given.join(name)).unwrap();
    let assignment = read("assignment.toml");
    fs::write(bench.join("assignment.toml"), &assignment).unwrap();
    fs::write(bench.join("scenario.toml"), read("scenario.toml")).unwrap();
    let sketches: toml::Table = read("sketches.toml").parse().unwrap();
    for (name, sketch) in &sketches {
        let folder = bench.join("in").join(name);
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("a.ino"), sketch["text"].as_str().unwrap()).unwrap();
    }
    let mut command = program();
    command.current_dir(&bench);
    command.args(["grade", "assignment.toml", "in", "--language", "en"]);
    command.args(["--out", "out"]);
    command.env("RUMBO_CACHE", folder().join("sketches"));
    let output = command.output().unwrap();
    assert!(output.status.code() != Some(2), "{}", stderr(&output));
    let results = results(&bench.join("out"));
    for (name, sketch) in &sketches {
        let loses = sketch["loses"].as_array().unwrap().iter();
        let loses: Vec<&str> = loses.map(|title| title.as_str().unwrap()).collect();
        let lines = results[name]["tests"].as_array().unwrap();
        let lost = lines.iter().filter(|line| line["status"] == "failed");
        let lost: Vec<&str> = lost.map(|line| line["name"].as_str().unwrap()).collect();
        assert_eq!(lost, loses, "{name}: {:#}", results[name]);
        let first = lines
            .iter()
            .find(|line| line["name"].as_str() == loses.first().copied());
        let said = first.map_or("", |line| line["output"].as_str().unwrap());
        assert!(
            said.contains(sketch["said"].as_str().unwrap()),
            "{name}: {said}"
        );
    }
    let page = fs::read_to_string(bench.join("out/students/own.html")).unwrap();
    assert!(
        page.contains("It waits ") && page.contains("Compare millis()"),
        "{page}"
    );

    fs::write(
        bench.join("assignment.toml"),
        assignment.replace("heap_calls", "heap_cals"),
    )
    .unwrap();
    let said = stderr(&command.output().unwrap());
    assert!(
        said.contains("no such metric of a program; did you mean `program.heap_calls`"),
        "{said}"
    );
}
