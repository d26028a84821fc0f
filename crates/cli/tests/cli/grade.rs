//! `rumbo grade`: the model solutions get full marks, mistakes lose points where they should, and nobody gains by harm.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use rumbo_sketch::Toolchain;
use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Output;
use support::{folder, program, stderr, stdout};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

pub(super) fn assignment(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/assignments");
    root.join(name).canonicalize().unwrap()
}

/// A fresh folder for hand-ins; `None` where compiler or sandbox are not installed.
pub(super) fn bench(name: &str) -> Option<PathBuf> {
    let found = Toolchain::find().and_then(|found| Sandbox::walled(&found, Limits::default()));
    if let Err(error) = found {
        assert!(std::env::var_os("CI").is_none(), "{error}");
        return None;
    }
    let bench = folder().join("grade").join(name);
    let _ = fs::remove_dir_all(&bench);
    fs::create_dir_all(bench.join("in")).unwrap();
    Some(bench)
}

fn hand_in(bench: &Path, name: &str, text: &str) {
    let folder = bench.join("in").join(name);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("sketch.ino"), text).unwrap();
}

fn grade(bench: &Path, name: &str, more: &[&str]) -> Output {
    let mut command = program();
    command.current_dir(bench).arg("grade");
    command.arg(assignment(name).join("assignment.toml"));
    command.args(["in", "--language", "en"]).args(more);
    command.env("RUMBO_CACHE", folder().join("sketches"));
    command.output().unwrap()
}

/// Gradescope's results of each hand-in.
pub(super) fn results(out: &Path) -> BTreeMap<String, Value> {
    let files = fs::read_dir(out.join("gradescope")).unwrap();
    files
        .map(|file| {
            let path = file.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let name = path.file_stem().unwrap().to_string_lossy().into_owned();
            (name, serde_json::from_str(&text).unwrap())
        })
        .collect()
}

/// All files of a folder, by name.
pub(super) fn bytes(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => {
                    let inner = path.strip_prefix(folder).unwrap().to_owned();
                    all.insert(inner, fs::read(&path).unwrap());
                }
            }
        }
    }
    all
}

/// The mistakes of an assignment: name, source, and what it loses points for.
fn mistakes(name: &str) -> Vec<(String, String, String)> {
    let folder = assignment(name);
    let model = fs::read_to_string(folder.join("model/model.ino")).unwrap();
    let text = fs::read_to_string(folder.join("bugs.toml")).unwrap();
    let file: toml::Table = text.parse().unwrap();
    let bugs = file["bug"].as_array().unwrap().iter();
    bugs.map(|bug| {
        let of = |key: &str| bug[key].as_str().unwrap().to_owned();
        assert_eq!(model.matches(&of("find")).count(), 1, "{}", of("name"));
        let source = model.replace(&of("find"), &of("replace"));
        (of("name"), source, of("loses"))
    })
    .collect()
}

/// Of the mistakes every so many is tried in the gate, all of them in the full check.
const SAMPLE: usize = 6;

#[test]
fn model_solutions_get_full_marks_and_mistakes_lose_points_on_their_line() {
    let every = if support::is_full() { 1 } else { SAMPLE };
    let (mut seen, mut missed, mut graded) = (0, Vec::new(), 0);
    for name in ["wall", "speed", "box", "line"] {
        let Some(bench) = bench(name) else {
            return;
        };
        let model = fs::read_to_string(assignment(name).join("model/model.ino")).unwrap();
        hand_in(&bench, "model", &model);
        let mistakes = mistakes(name);
        seen += mistakes.len();
        let mistakes: Vec<_> = mistakes.into_iter().step_by(every).collect();
        for (number, (_, source, _)) in mistakes.iter().enumerate() {
            hand_in(&bench, &format!("bug{number}"), source);
        }
        let output = grade(&bench, name, &["--out", "out"]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        let results = results(&bench.join("out"));
        let points = |hand_in: &str| results[hand_in]["score"].as_f64().unwrap();
        assert_eq!(points("model"), 10.0, "{name}: {}", results["model"]);
        for (number, (what, _, loses)) in mistakes.iter().enumerate() {
            let result = &results[&format!("bug{number}")];
            let mut lines = result["tests"].as_array().unwrap().iter();
            let line = lines.find(|line| line["extra_data"]["metric"] == *loses);
            let lost = line.is_some_and(|line| line["score"].as_f64() < line["max_score"].as_f64());
            graded += 1;
            if !lost {
                missed.push(format!("{name}, {what}: {result}"));
            }
        }
    }
    // Ten in a hundred may be missed: of a sample, none.
    assert!(
        seen >= 20 && 10 * missed.len() <= graded,
        "of {graded}: {missed:#?}"
    );
}

/// The assignment `wall` for the robot with an Arduino Uno, and its model: another pin, one serial port, and by the clock
/// what comes over Bluetooth on a Mega.
fn for_an_uno(bench: &Path) -> String {
    let read = |name: &str| fs::read_to_string(assignment("wall").join(name)).unwrap();
    let replaced = |text: String, changes: &[(&str, &str)]| {
        changes.iter().fold(text, |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        })
    };
    let file = replaced(
        read("assignment.toml"),
        &[
            ("board = \"mega\"", "board = \"uno\""),
            ("wiring = \"mode_1\"", "wiring = \"uno\""),
            // Another number of those and of these.
            ("public_seeds = [1, 2, 3]", "public_seeds = [1, 2]"),
            ("hidden_seeds = [4, 7, 12]", "hidden_seeds = [4]"),
        ],
    );
    fs::write(bench.join("assignment.toml"), file).unwrap();
    let scenario = replaced(
        read("scenario.toml"),
        &[("robot = \"memoria\"", "robot = \"uno\"")],
    );
    fs::write(bench.join("scenario.toml"), scenario).unwrap();
    replaced(
        read("model/model.ino"),
        &[
            ("BACKWARD[] = {2, 8}", "BACKWARD[] = {10, 8}"),
            ("Serial1", "Serial"),
            // Timer 0 makes a faster PWM than the Mega's pins have: the motors' dead zone is wider.
            ("DEAD_ZONE = 66", "DEAD_ZONE = 90"),
            (
                "  listen();\n",
                "  on = millis() > 500;\n  wantedCm = millis() < 5500 ? 30 : 50;\n",
            ),
        ],
    )
}

#[test]
fn hand_ins_for_an_uno_are_compiled_and_driven_on_one() {
    let Some(bench) = bench("uno") else {
        return;
    };
    let model = for_an_uno(&bench);
    hand_in(&bench, "model", &model);
    hand_in(&bench, "lazy", "void setup() {}\nvoid loop() {}\n");
    hand_in(
        &bench,
        "mega",
        &model.replace("Serial.begin", "Serial1.begin"),
    );
    let mark = |more: &[&str]| {
        let mut command = program();
        command.current_dir(&bench);
        command.args(["grade", "assignment.toml", "in", "--language", "es"]);
        command.args(more);
        command.env("RUMBO_CACHE", folder().join("sketches"));
        command.output().unwrap()
    };
    let output = mark(&["--out", "out"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let results = results(&bench.join("out"));
    let points = |hand_in: &str| results[hand_in]["score"].as_f64().unwrap();
    assert!(points("model") > 8.5, "{}", results["model"]);
    assert_eq!(points("lazy"), 0.0);
    // What students read there is in their language, whole.
    let seeds = results["lazy"]["output"].as_str().unwrap();
    assert!(
        seeds.starts_with("Pruebas: 2 con semillas públicas y 1 con ocultas"),
        "{seeds}"
    );
    let lines = results["lazy"]["tests"].as_array().unwrap().iter();
    for line in lines.map(|line| line["output"].as_str().unwrap()) {
        assert!(
            line.contains(" puntos: ") && !line.contains("median run"),
            "{line}"
        );
    }
    // A Uno has one serial port.
    assert_eq!(points("mega"), 0.0);
    let said = results["mega"].to_string();
    assert!(said.contains("Serial1"), "{said}");

    // An assignment says the board of its robots or none.
    let file = fs::read_to_string(bench.join("assignment.toml")).unwrap();
    let wrong = file.replace("board = \"uno\"", "board = \"mega\"");
    fs::write(bench.join("assignment.toml"), wrong).unwrap();
    let output = mark(&[]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("board = mega: the robots of its scenarios have the board \"uno\""),
        "{said}"
    );
}

#[test]
fn hostile_hand_ins_gain_nothing_and_change_no_other_mark() {
    let Some(bench) = bench("hostile") else {
        return;
    };
    let model = fs::read_to_string(assignment("speed").join("model/model.ino")).unwrap();
    hand_in(&bench, "ana", &model);
    hand_in(&bench, "dora", &format!("{model}// the same program\n"));
    let alone = grade(&bench, "speed", &["--out", "alone"]);
    assert_eq!(alone.status.code(), Some(0), "{}", stderr(&alone));

    let rest = "\nvoid loop() { }\n";
    for (name, text) in [
        ("hang", "void setup() { cli(); for (;;); }"),
        ("crash", "void setup() { ((void (*)())0x1f000)(); }"),
        (
            "toggles",
            "void setup() { DDRE = 0xff; for (;;) PORTE ^= 0xff; }",
        ),
        (
            "resets",
            "#include <avr/wdt.h>\nvoid setup() { wdt_enable(WDTO_15MS); for (;;); }",
        ),
        (
            "lies",
            "void setup() { Serial1.begin(9600); for (;;) Serial1.println(\"50, 60.0, 60.0, 60.0, 5, 120, 120\"); }",
        ),
        ("reads", "#include \"/etc/passwd\"\nvoid setup() { }"),
        ("<b>&\"", "void setup() { }"),
        ("=1+1", "int f( {"),
    ] {
        hand_in(&bench, name, &format!("{text}{rest}"));
    }
    std::os::unix::fs::symlink("/etc", bench.join("in/linked")).unwrap();
    fs::create_dir(bench.join("in/empty")).unwrap();
    let first = grade(&bench, "speed", &["--out", "out", "--threads", "1"]);
    let second = grade(&bench, "speed", &["--out", "again"]);
    assert_eq!(first.status.code(), Some(1), "{}", stderr(&first));
    assert_eq!(stdout(&first).replace("out/", "again/"), stdout(&second));
    // On one thread and on all of them, to the byte.
    assert_eq!(bytes(&bench.join("out")), bytes(&bench.join("again")));
    let results = results(&bench.join("out"));
    for file in [
        "students/ana.html",
        "gradescope/ana.json",
        "students/dora.html",
    ] {
        let read = |folder: &str| fs::read(bench.join(folder).join(file)).unwrap();
        assert_eq!(read("alone"), read("out"), "{file}");
    }
    assert_eq!(results["ana"]["tests"], results["dora"]["tests"]);
    assert!(stderr(&first).contains("alike: ana and dora: 100 %"));
    assert_eq!(fs::read_dir(bench.join("out/similar")).unwrap().count(), 1);
    let pair = fs::read_to_string(bench.join("out/similar/pair1.html")).unwrap();
    assert!(
        pair.contains("<h2>ana</h2>") && pair.contains("This does not say who wrote from whom")
    );
    assert!(pair.contains("<mark>void loop() {") && !pair.contains("<mark>// the same program"));
    let class = fs::read_to_string(bench.join("out/index.html")).unwrap();
    assert!(class.contains("<a href=\"similar/pair1.html#class\">ana and dora: 100 %</a>"));
    for (name, result) in &results {
        if name != "ana" && name != "dora" {
            assert_eq!(result["score"], 0.0, "{name}: {result}");
        }
    }
    assert_eq!(results.len(), 11, "{:?}", results.keys());
    for (file, bytes) in bytes(&bench.join("out")) {
        let text = String::from_utf8(bytes).unwrap();
        assert!(!text.contains("root:"), "{file:?}");
        assert!(!text.contains(bench.to_str().unwrap()), "{file:?}");
        let is_markup = file.extension().is_some_and(|ending| ending != "csv");
        assert!(!(is_markup && text.contains("<b>&")), "{file:?}");
    }
    let csv = fs::read_to_string(bench.join("out/marks.csv")).unwrap();
    assert!(csv.contains("\"'=1+1\""), "{csv}");
    let junit = fs::read_to_string(bench.join("out/junit.xml")).unwrap();
    assert!(
        junit.contains("<testsuite name=\"&lt;b&gt;&amp;&quot;\" tests=\"6\" failures=\"6\">"),
        "{junit}"
    );
}

/// A zip archive.
fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn a_class_is_graded_as_a_course_hands_it_out() {
    let Some(bench) = bench("archives") else {
        return;
    };
    let model = fs::read(assignment("wall").join("model/model.ino")).unwrap();
    let own = zipped(&[
        ("wall/wall.ino", &model),
        ("__MACOSX/wall/._wall.ino", b"x"),
    ]);
    let class = zipped(&[
        ("Ana Paz_4711_assignsubmission_file/wall.ino", &model),
        ("bobsmith_LATE_4712_815_wall.zip", &own),
        ("bobsmith_4712_816_wall.zip", b"PK no archive"),
        (
            "carla_4713_817_wall.zip",
            &zipped(&[("../../wall.ino", &model)]),
        ),
        ("readme.txt", b"x"),
        ("../../dora.ino", &model),
    ]);
    fs::write(bench.join("class.zip"), class).unwrap();
    let mut command = program();
    command.current_dir(&bench).arg("grade");
    command.arg(assignment("wall").join("assignment.toml"));
    command.args(["class.zip", "--language", "en", "--out", "out"]);
    command.env("RUMBO_CACHE", folder().join("sketches"));
    let output = command.output().unwrap();
    let said = stdout(&output) + &stderr(&output);
    assert!(
        said.contains("not graded: ../../dora.ino, readme.txt; a hand-in is"),
        "{said}"
    );
    assert!(
        said.contains("alike: Ana Paz and bobsmith (2): 100 %"),
        "{said}"
    );
    let results = results(&bench.join("out"));
    let score = |name: &str| results[name]["score"].as_f64().unwrap();
    assert_eq!(
        [score("Ana_Paz"), score("bobsmith__2_"), score("bobsmith")],
        [10.0, 10.0, 0.0]
    );
    let text = |name: &str| results[name]["output"].as_str().unwrap().to_owned();
    assert!(text("Ana_Paz").starts_with("Runs: "), "{}", text("Ana_Paz"));
    assert!(text("bobsmith__2_").contains("handed in late, as its name says"));
    assert!(
        text("bobsmith").contains("no zip archive"),
        "{}",
        text("bobsmith")
    );
    assert!(
        text("carla").contains("`../../wall.ino` is left out"),
        "{}",
        text("carla")
    );
    assert!(!bench.join("dora.ino").exists() && !folder().join("dora.ino").exists());
}

#[test]
fn every_hand_in_has_files_of_its_own_and_what_is_none_is_named() {
    let bench = folder().join("grade/names");
    let _ = fs::remove_dir_all(&bench);
    fs::create_dir_all(bench.join("in")).unwrap();
    for name in [
        "a b.hex",
        "A_b.hex",
        "a_b-1.hex",
        "a_b.hex",
        "eva.txt",
        ".x",
        ".ana.hex",
    ] {
        fs::write(bench.join("in").join(name), "no image").unwrap();
    }
    fs::create_dir(bench.join("in/.git")).unwrap();
    let output = grade(&bench, "wall", &["--out", "out"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = stderr(&output);
    assert!(
        said.contains("note: not graded: eva.txt, .ana.hex, .git; a hand-in is"),
        "{said}"
    );
    let class = fs::read_to_string(bench.join("out/index.html")).unwrap();
    let results = results(&bench.join("out"));
    assert_eq!(results.len(), 4, "{:?}", results.keys());
    for file in results.keys() {
        // From the class a page leads back there.
        assert!(
            class.contains(&format!("students/{file}.html#class")),
            "{file}"
        );
        let page = fs::read_to_string(bench.join(format!("out/students/{file}.html")));
        assert!(
            page.unwrap()
                .contains("<p id=\"class\"><a href=\"../index.html\">")
        );
    }
}

#[test]
fn grading_again_removes_and_replaces_nothing_but_its_own() {
    let bench = folder().join("grade/again");
    let _ = fs::remove_dir_all(&bench);
    fs::create_dir_all(bench.join("in")).unwrap();
    for name in ["ana.hex", "eva.hex"] {
        fs::write(bench.join("in").join(name), "no image").unwrap();
    }
    let out = bench.join("out");
    let first = grade(&bench, "wall", &["--out", "out"]);
    assert_eq!(first.status.code(), Some(1), "{}", stderr(&first));
    let others = [
        "students/notes.txt",
        "students/mine.html",
        "students/mine/ana.html",
        "gradescope/mine.json",
        "gradescope/mine/a",
        "mine.csv",
    ];
    for name in others {
        fs::create_dir_all(out.join(name).parent().unwrap()).unwrap();
        fs::write(out.join(name), "mine").unwrap();
    }
    fs::write(
        bench.join("elsewhere.html"),
        fs::read(out.join("students/ana.html")).unwrap(),
    )
    .unwrap();
    std::os::unix::fs::symlink("../../elsewhere.html", out.join("students/linked.html")).unwrap();
    fs::remove_file(bench.join("in/eva.hex")).unwrap();
    let again = grade(&bench, "wall", &["--out", "out"]);
    assert_eq!(again.status.code(), Some(1), "{}", stderr(&again));
    for name in others {
        assert_eq!(
            fs::read_to_string(out.join(name)).unwrap(),
            "mine",
            "{name}"
        );
    }
    assert!(
        out.join("students/linked.html").is_symlink() && bench.join("elsewhere.html").is_file()
    );
    for (name, is_there) in [("ana", true), ("eva", false)] {
        for file in [
            format!("students/{name}.html"),
            format!("gradescope/{name}.json"),
        ] {
            assert_eq!(out.join(&file).is_file(), is_there, "{file}");
        }
    }

    // A file of somebody else's where one of ours belongs is told before anything runs.
    for name in [
        "students/ana.html",
        "gradescope/ana.json",
        "marks.csv",
        "junit.xml",
    ] {
        let own = fs::read(out.join(name)).unwrap();
        fs::write(out.join(name), "mine").unwrap();
        let refused = grade(&bench, "wall", &["--out", "out"]);
        assert_eq!(refused.status.code(), Some(2), "{name}");
        let said = stderr(&refused);
        assert!(said.contains(name) && said.contains("--force"), "{said}");
        assert_eq!(fs::read_to_string(out.join(name)).unwrap(), "mine");
        fs::write(out.join(name), own).unwrap();
    }
}

/// What `is_for_linux` looks at of a program.
fn program_for_linux() -> Vec<u8> {
    let mut program = b"\x7fELF\x02\x01".to_vec();
    program.resize(64, 0);
    program[18] = 62;
    program
}

#[test]
fn the_archive_for_gradescope_has_its_scripts_and_all_that_the_assignment_names() {
    let bench = folder().join("grade/archive");
    let _ = fs::remove_dir_all(&bench);
    fs::create_dir_all(&bench).unwrap();
    fs::write(bench.join("rumbo"), program_for_linux()).unwrap();
    fs::write(bench.join("rumbo.exe"), b"MZ").unwrap();
    let pack = |name: &Path, command: &str| {
        let mut pack = program();
        pack.current_dir(&bench).arg("grade").arg(name);
        pack.args(["--language", "es", "--gradescope", "autograder.zip"]);
        pack.args(["--linux", command]).output().unwrap()
    };
    let output = pack(&assignment("box").join("assignment.toml"), "rumbo");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let file = fs::File::open(bench.join("autograder.zip")).unwrap();
    let mut zip = zip::ZipArchive::new(file).unwrap();
    let mut modes = BTreeMap::new();
    for index in 0..zip.len() {
        let entry = zip.by_index(index).unwrap();
        let name = entry.name().unwrap().to_string();
        modes.insert(name, entry.unix_mode().unwrap() & 0o777);
    }
    for name in ["setup.sh", "run_autograder", "rumbo"] {
        assert_eq!(modes[name], 0o755, "{name}");
    }
    for name in ["assignment.toml", "scenario.toml", "world.toml"] {
        assert_eq!(modes[&format!("assignment/{name}")], 0o644, "{name}");
    }
    let mut script = String::new();
    let mut entry = zip.by_name("run_autograder").unwrap();
    std::io::Read::read_to_string(&mut entry, &mut script).unwrap();
    assert!(script.starts_with("#!/bin/sh\n") && script.contains("--language es\n"));

    // A program for another system, and a scenario that would not be in the archive.
    let output = pack(&assignment("box").join("assignment.toml"), "rumbo.exe");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("rumbo.exe: no program for Linux on x86-64"));
    let text = fs::read_to_string(assignment("wall").join("assignment.toml")).unwrap();
    fs::create_dir(bench.join("in")).unwrap();
    let outside = text.replace("\"scenario.toml\"", "\"../scenario.toml\"");
    fs::write(bench.join("in/outside.toml"), outside).unwrap();
    fs::copy(
        assignment("wall").join("scenario.toml"),
        bench.join("scenario.toml"),
    )
    .unwrap();
    fs::remove_file(bench.join("autograder.zip")).unwrap();
    let output = pack(Path::new("in/outside.toml"), "rumbo");
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("what the assignment names must be in its folder"),
        "{said}"
    );
    assert!(!bench.join("autograder.zip").exists());
}

#[test]
fn gradescope_s_container_gets_results_as_it_wants_them() {
    let Some(bench) = bench("container") else {
        return;
    };
    let text = fs::read_to_string(assignment("wall").join("assignment.toml")).unwrap();
    let text = text
        .replace(
            "public_seeds = [1, 2, 3]",
            "public_seeds = [1]\nvisibility = \"after_published\"",
        )
        .replace("hidden_seeds = [4, 7, 12]", "hidden_seeds = [4]")
        .replacen("[[criterion]]", "[[criterion]]\nvisibility = \"hidden\"", 1);
    fs::write(bench.join("assignment.toml"), &text).unwrap();
    fs::copy(
        assignment("wall").join("scenario.toml"),
        bench.join("scenario.toml"),
    )
    .unwrap();
    let model = fs::read(assignment("wall").join("model/model.ino")).unwrap();
    // Of any name, in a folder or not, with what it includes.
    fs::create_dir_all(bench.join("submission/src")).unwrap();
    fs::write(
        bench.join("submission/robot.ino"),
        [b"#include \"pins.h\"\n", &model[..]].concat(),
    )
    .unwrap();
    fs::write(bench.join("submission/pins.h"), "\n").unwrap();
    fs::create_dir(bench.join("results")).unwrap();
    let grade = || {
        let mut command = program();
        command
            .current_dir(&bench)
            .args(["grade", "assignment.toml"]);
        command.args(["--autograder", ".", "--language", "en"]);
        command.env("RUMBO_CACHE", folder().join("sketches"));
        command.output().unwrap()
    };
    let output = grade();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let read = || -> Value {
        let text = fs::read_to_string(bench.join("results/results.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let results = read();
    assert_eq!(results["score"], 10.0, "{results:#}");
    assert_eq!(results["stdout_visibility"], "hidden");
    assert!(
        results["output"]
            .as_str()
            .unwrap()
            .contains("1 with public seeds, 1 with hidden ones")
    );
    let tests = results["tests"].as_array().unwrap();
    let of = |key: &str| {
        tests
            .iter()
            .map(|test| test[key].clone())
            .collect::<Vec<_>>()
    };
    let seen = [
        "hidden",
        "after_published",
        "after_published",
        "after_published",
    ];
    assert_eq!(of("visibility"), seen);
    assert_eq!(of("max_score"), [3.0, 2.0, 2.0, 3.0]);
    assert_eq!(of("score"), of("max_score"));

    // What is no program is a result too.
    fs::remove_dir_all(bench.join("submission")).unwrap();
    fs::create_dir(bench.join("submission")).unwrap();
    assert_eq!(grade().status.code(), Some(0));
    let results = read();
    assert_eq!(results["score"], 0.0);
    assert!(
        results["output"]
            .as_str()
            .unwrap()
            .contains("no sketch here"),
        "{results:#}"
    );

    fs::write(
        bench.join("assignment.toml"),
        text.replace("\"hidden\"", "\"secret\""),
    )
    .unwrap();
    let said = stderr(&grade());
    assert!(
        said.contains(
            "visibility = secret: must be one of visible, after_due_date, after_published, hidden"
        ),
        "{said}"
    );
}

#[test]
fn a_wrong_assignment_is_said_with_lines_keys_and_near_names() {
    let bench = folder().join("grade/wrong");
    fs::create_dir_all(bench.join("in")).unwrap();
    let text = "title = \"T\"\nstatement = \"S\"\npontis = 5\n[[scenario]]\nscenario = \"mode1\"\npublic_seeds = [1]\n\
                [[criterion]]\ntitle = \"C\"\nmetric = \"step1.setling_s\"\npoints = 1\nfull = 2\nnone = 2\n\
                [[criterion]]\ntitle = \"D\"\nmetric = \"telemetry_hz\"\npoints = -1\nfull = 2\n";
    fs::write(bench.join("a.toml"), text).unwrap();
    let mut command = program();
    let output = command
        .current_dir(&bench)
        .args(["grade", "a.toml", "in"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    for expected in [
        "a.toml:3: pontis = 5: unknown key; did you mean",
        "a.toml:9: criterion[1].metric = step1.setling_s: no such metric in its scenario; did you mean",
        "step1.settling_s",
        "a.toml:7: [criterion[1]] full and none are the same",
        "a.toml:15: criterion[2].metric = telemetry_hz: is what the program says of itself",
        "a.toml:16: criterion[2].points = -1: must be within",
        "criterion[2].none is missing",
    ] {
        assert!(said.contains(expected), "{expected} in:\n{said}");
    }
}
