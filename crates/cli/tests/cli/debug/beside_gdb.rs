//! Our debugger and avr-gdb at the same stops of the same run: the same functions, lines and values.
//!
//! What is left out is where gdb is wrong or silent, and ours is not: behind an interrupt (GCC's tables forget a push),
//! static constructors, values that only a call tells (`<optimized out>`), and variables that the compiler made.

use super::{DEEPEST, Editor, kinds};
use crate::support::{folder, is_full, program};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// avr-gdb by its machine interface, at a run of its own.
struct Gdb {
    run: Child,
    gdb: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    token: u32,
}

impl Gdb {
    fn at(image: &Path, scenario: &str) -> Option<Gdb> {
        let mut command = program();
        command
            .args(["run", scenario, "--no-record", "--gdb", "0", "--firmware"])
            .arg(image);
        let mut run = command
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = String::new();
        BufReader::new(run.stderr.take().unwrap())
            .read_line(&mut said)
            .unwrap();
        let port = said
            .rsplit(':')
            .next()
            .unwrap()
            .trim()
            .trim_end_matches('\'')
            .to_owned();
        let mut command = Command::new("avr-gdb");
        command
            .args(["--quiet", "--nx", "--interpreter=mi2"])
            .arg(image);
        let Ok(mut gdb) = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn() else {
            assert!(
                std::env::var_os("CI").is_none(),
                "avr-gdb is missing: install the package gdb-avr"
            );
            println!("skipped: avr-gdb is not installed");
            let _ = run.kill();
            let _ = run.wait();
            return None;
        };
        let (to, from) = (
            gdb.stdin.take().unwrap(),
            BufReader::new(gdb.stdout.take().unwrap()),
        );
        let mut gdb = Gdb {
            run,
            gdb,
            to,
            from,
            token: 0,
        };
        gdb.ask("-gdb-set width 0");
        gdb.ask("-gdb-set print entry-values no");
        gdb.ask(&format!("-target-select remote 127.0.0.1:{port}"));
        Some(gdb)
    }

    /// The line with which a command ends.
    fn ask(&mut self, command: &str) -> Value {
        self.token += 1;
        writeln!(self.to, "{}{command}", self.token).unwrap();
        let result = self.line(&format!("{}^", self.token));
        assert!(!result.starts_with("error"), "{command}: {result}");
        results(&mut result.split_once(',').map_or("", |(_, rest)| rest))
    }

    fn line(&mut self, start: &str) -> String {
        loop {
            let mut line = String::new();
            assert!(
                self.from.read_line(&mut line).unwrap() > 0,
                "avr-gdb is gone"
            );
            if let Some(rest) = line.trim_end().strip_prefix(start) {
                return rest.to_owned();
            }
        }
    }

    /// Goes on to an address.
    fn go_to(&mut self, address: &str) {
        self.ask(&format!("-break-insert -t *{address}"));
        self.ask("-exec-continue");
        self.line("*stopped");
    }

    /// Name, file, line of each frame, and its variables; of one name the inner one's.
    fn stack(&mut self) -> Vec<(String, i64, BTreeMap<String, String>)> {
        let frames = self.ask("-stack-list-frames");
        let frames = frames["stack"].as_array().unwrap().iter().take(DEEPEST);
        let frames = frames.map(|frame| {
            let line = frame["line"]
                .as_str()
                .map_or(0, |line| line.parse().unwrap());
            let asked = format!(
                "-stack-list-variables --thread 1 --frame {} --all-values",
                frame["level"].as_str().unwrap()
            );
            let mut values = BTreeMap::new();
            for one in self.ask(&asked)["variables"].as_array().unwrap() {
                let text = |key: &str| one[key].as_str().unwrap().to_owned();
                values.entry(text("name")).or_insert_with(|| text("value"));
            }
            (frame["func"].as_str().unwrap().to_owned(), line, values)
        });
        frames.collect()
    }
}

impl Drop for Gdb {
    fn drop(&mut self) {
        for child in [&mut self.gdb, &mut self.run] {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// `name=value,...` of the machine interface.
fn results(text: &mut &str) -> Value {
    let mut found = serde_json::Map::new();
    while let Some((name, rest)) = text
        .split_once('=')
        .filter(|(name, _)| !name.contains(['}', ']']))
    {
        *text = rest;
        found.insert(name.to_owned(), value(text));
        *text = text.strip_prefix(',').unwrap_or(text);
    }
    found.into()
}

fn value(text: &mut &str) -> Value {
    let (first, rest) = text.split_at(1);
    *text = rest;
    match first {
        "{" => {
            let inner = results(text);
            *text = &text[1..];
            inner
        }
        "[" => {
            let mut all = Vec::new();
            while !text.starts_with(']') {
                // The elements of a list of frames have a name each.
                let named = text
                    .find(['=', '{', '"'])
                    .filter(|at| text[*at..].starts_with('='));
                *text = &text[named.map_or(0, |at| at + 1)..];
                all.push(value(text));
                *text = text.strip_prefix(',').unwrap_or(text);
            }
            *text = &text[1..];
            all.into()
        }
        _ => quoted(text).into(),
    }
}

/// The rest of a text behind its first quote: a backslash quotes a quote or another; what is behind it stays as it is.
fn quoted(text: &mut &str) -> String {
    let (mut inner, mut escaped) = (String::new(), false);
    for (at, letter) in text.char_indices() {
        match (letter, escaped) {
            ('"', false) => {
                *text = &text[at + 1..];
                return inner;
            }
            ('\\', false) => escaped = true,
            (letter, true) if !"\"\\".contains(letter) => {
                inner.extend(['\\', letter]);
                escaped = false;
            }
            (letter, _) => {
                inner.push(letter);
                escaped = false;
            }
        }
    }
    panic!("no end: {text}");
}

/// The newest image of this name in the cache.
fn image(name: &str) -> PathBuf {
    let folders = std::fs::read_dir(folder().join("sketches"))
        .unwrap()
        .flatten();
    let images = folders
        .map(|folder| folder.path().join(format!("{name}.elf")))
        .filter(|path| path.is_file());
    images
        .max_by_key(|path| path.metadata().unwrap().modified().unwrap())
        .unwrap()
}

/// Stops at the lines of a file, each at most three times, and compares.
fn compare(sketch: &str, name: &str, file: &Path, scenario: &str, stops: usize) {
    let Some(mut editor) = Editor::launch(&[sketch, "--scenario", scenario], json!({})) else {
        return;
    };
    let Some(mut gdb) = Gdb::at(&image(name), scenario) else {
        return;
    };
    let all = json!({"source": {"path": file}, "line": 1, "endLine": 10_000});
    let all = editor.ask("breakpointLocations", all)["breakpoints"].take();
    let mut lines: Vec<i64> = all
        .as_array()
        .unwrap()
        .iter()
        .map(|one| one["line"].as_i64().unwrap())
        .collect();
    let mut reached = BTreeMap::<i64, u32>::new();
    editor.break_at(
        file,
        lines.iter().map(|line| json!({"line": line})).collect(),
    );
    editor.ask("configurationDone", json!({}));
    let mut compared = 0;
    while compared < stops {
        let stop = editor.stop();
        assert_eq!(
            stop["reason"], "breakpoint",
            "{name}: after {compared} stops"
        );
        let frames = editor.frames();
        let at = |frame: &Value| {
            (
                frame["name"].as_str().unwrap().to_owned(),
                frame["line"].as_i64().unwrap(),
            )
        };
        let named = |start: &str| frames.iter().any(|frame| at(frame).0.starts_with(start));
        if !named("__vector_") && !named("__do_global_ctors") {
            gdb.go_to(frames[0]["instructionPointerReference"].as_str().unwrap());
            let theirs = gdb.stack();
            let ours: Vec<_> = frames.iter().map(at).collect();
            let wanted: Vec<_> = theirs
                .iter()
                .map(|(name, line, _)| (name.clone(), *line))
                .collect();
            assert_eq!(ours, wanted, "{name}");
            for (frame, (.., values)) in frames.iter().zip(&theirs) {
                let own = editor.locals(frame);
                for (variable, value) in values.iter().filter(|(name, _)| !name.starts_with("__")) {
                    if value != "<optimized out>" {
                        assert_eq!(
                            own.get(variable),
                            Some(value),
                            "{variable} of {:?} in {ours:?}",
                            at(frame)
                        );
                    }
                }
            }
            compared += 1;
        }
        let line = at(&frames[0]).1;
        *reached.entry(line).or_default() += 1;
        if reached[&line] == 3 {
            lines.retain(|other| *other != line);
            editor.break_at(
                file,
                lines.iter().map(|line| json!({"line": line})).collect(),
            );
        }
        editor.ask("continue", json!({"threadId": 1}));
    }
    println!("{name}: {compared} stops at {} lines", reached.len());
}

#[test]
fn at_each_stop_frames_and_values_are_those_of_avr_gdb() {
    let (own, file) = kinds("kinds_beside_gdb");
    let examples = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples/arduino")
        .canonicalize()
        .unwrap();
    let few = |many: usize| if is_full() { many } else { 6 };
    compare(&own, "kinds_beside_gdb", &file, "free", few(30));
    for (sketch, file, scenario) in [
        ("memoria", "walls.cpp", "mode1"),
        ("wall", "wall.ino", "mode1"),
        ("line", "line.ino", "free"),
        ("RumboRobot/examples/Wall", "Wall.ino", "mode1"),
    ] {
        let folder = examples.join(sketch);
        let name = folder.file_name().unwrap().to_str().unwrap();
        if is_full() || name == "memoria" {
            compare(
                folder.to_str().unwrap(),
                name,
                &folder.join(file),
                scenario,
                few(20),
            );
        }
    }
}
