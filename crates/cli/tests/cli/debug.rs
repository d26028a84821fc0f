//! `rumbo debug` as an editor uses it, and beside avr-gdb at the same stops.

mod beside_gdb;

use crate::support::{folder, program};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};

/// Every kind of value, function and scope.
const KINDS: &str = include_str!("debug/kinds.ino");
/// Frames that are compared at each stop.
const DEEPEST: usize = 6;

/// An editor at the adapter's other end.
struct Editor {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    seq: i64,
    events: Vec<Value>,
}

impl Editor {
    /// With a program launched; `None` where no compiler is.
    fn launch(arguments: &[&str], launch: Value) -> Option<Editor> {
        let mut command = program();
        command.env("RUMBO_CACHE", folder().join("sketches"));
        command
            .arg("debug")
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let (to, from) = (
            child.stdin.take().unwrap(),
            BufReader::new(child.stdout.take().unwrap()),
        );
        let mut editor = Editor {
            child,
            to,
            from,
            seq: 0,
            events: Vec::new(),
        };
        let able = editor.ask("initialize", json!({"adapterID": "rumbo"}));
        assert_eq!(able["supportsStepBack"], true);
        match editor.request("launch", launch) {
            Ok(_) => Some(editor),
            Err(error) => {
                assert!(
                    error.contains("compiler") && std::env::var_os("CI").is_none(),
                    "{error}"
                );
                println!("skipped: {error}");
                None
            }
        }
    }

    fn message(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(
                self.from.read_line(&mut line).unwrap() > 0,
                "the adapter is gone"
            );
            match line.trim().strip_prefix("Content-Length: ") {
                Some(digits) => length = digits.parse().unwrap(),
                None => break,
            }
        }
        let mut body = vec![0; length];
        self.from.read_exact(&mut body).unwrap();
        serde_json::from_slice(&body).unwrap()
    }

    fn request(&mut self, command: &str, arguments: Value) -> Result<Value, String> {
        self.seq += 1;
        let body =
            json!({"seq": self.seq, "type": "request", "command": command, "arguments": arguments})
                .to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{body}", body.len()).unwrap();
        loop {
            let mut message = self.message();
            if message["type"] != "response" {
                self.events.push(message);
                continue;
            }
            assert_eq!(message["request_seq"], self.seq);
            return match message["success"].as_bool().unwrap() {
                true => Ok(message["body"].take()),
                false => Err(message["message"].as_str().unwrap().to_owned()),
            };
        }
    }

    fn ask(&mut self, command: &str, arguments: Value) -> Value {
        self.request(command, arguments)
            .unwrap_or_else(|error| panic!("{command}: {error}"))
    }

    /// The next stop.
    fn stop(&mut self) -> Value {
        loop {
            let at = self
                .events
                .iter()
                .position(|event| event["event"] == "stopped");
            if let Some(at) = at {
                return self.events.remove(at)["body"].take();
            }
            let next = self.message();
            self.events.push(next);
        }
    }

    /// Asks for a movement, and gives the reason of the stop and the line.
    fn go(&mut self, command: &str) -> (String, i64) {
        self.ask(command, json!({"threadId": 1}));
        let reason = self.stop()["reason"].as_str().unwrap().to_owned();
        (reason, self.frames()[0]["line"].as_i64().unwrap())
    }

    fn break_at(&mut self, file: &Path, breakpoints: Value) -> Value {
        self.ask(
            "setBreakpoints",
            json!({"source": {"path": file}, "breakpoints": breakpoints}),
        )["breakpoints"]
            .take()
    }

    fn frames(&mut self) -> Vec<Value> {
        let frames = self.ask("stackTrace", json!({"threadId": 1, "levels": DEEPEST}));
        frames["stackFrames"].as_array().unwrap().clone()
    }

    fn locals(&mut self, frame: &Value) -> BTreeMap<String, String> {
        let scopes = self.ask("scopes", json!({"frameId": frame["id"]}));
        let locals = self.ask(
            "variables",
            json!({"variablesReference": scopes["scopes"][0]["variablesReference"]}),
        );
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        let all = locals["variables"].as_array().unwrap().iter();
        all.map(|one| (text(&one["name"]), text(&one["value"])))
            .collect()
    }

    fn value(&mut self, expression: &str) -> String {
        let asked = json!({"expression": expression, "frameId": 0, "context": "watch"});
        match self.request("evaluate", asked) {
            Ok(shown) => shown["result"].as_str().unwrap().to_owned(),
            Err(error) => error,
        }
    }

    /// What was written to the console so far.
    fn console(&self) -> String {
        let outputs = self
            .events
            .iter()
            .filter(|event| event["event"] == "output");
        outputs
            .map(|event| event["body"]["output"].as_str().unwrap())
            .collect()
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The line of the sketch that contains a text.
fn line_of(text: &str) -> i64 {
    1 + KINDS.lines().position(|line| line.contains(text)).unwrap() as i64
}

/// A folder with the sketch, and its file.
fn kinds(name: &str) -> (String, PathBuf) {
    let sketch = folder().join(name);
    std::fs::create_dir_all(&sketch).unwrap();
    let file = sketch.join(format!("{name}.ino"));
    std::fs::write(&file, KINDS).unwrap();
    (
        sketch.to_str().unwrap().to_owned(),
        file.canonicalize().unwrap(),
    )
}

#[test]
fn an_editor_breaks_steps_reads_and_changes_a_sketch() {
    let (sketch, file) = kinds("kinds");
    let Some(mut editor) = Editor::launch(
        &[],
        json!({"program": sketch, "scenario": "free", "stopOnEntry": true}),
    ) else {
        return;
    };
    let (call, comment) = (line_of("reached = depth"), line_of("// Every kind"));
    let set = editor.break_at(
        &file,
        json!([{"line": call, "condition": "round_ == 3"}, {"line": comment}, {"line": 9_999}]),
    );
    assert_eq!(
        (&set[0]["verified"], &set[0]["line"]),
        (&json!(true), &json!(call))
    );
    // A line without code is that of the next one that has some; behind the last there is none.
    assert!(
        set[1]["line"].as_i64().unwrap() > comment && set[1]["verified"] == true,
        "{set}"
    );
    assert_eq!(set[2]["verified"], false);
    let first = editor.break_at(&file, json!([{"line": call, "condition": "round_ == 3"}]));
    assert_eq!(first.as_array().unwrap().len(), 1);
    editor.ask("configurationDone", json!({}));
    assert_eq!(editor.stop()["reason"], "entry");
    assert_eq!(editor.frames()[0]["name"], "setup");
    assert_eq!(editor.go("continue"), ("breakpoint".into(), call));
    for (expression, value) in [
        ("round_", "3 '\\003'"),
        ("values", "{3, 2, -3, 40, 500}"),
        ("path[1].y", "1.875"),
        ("(&path[2])->x", "3"),
        ("mode == DRIVE", "1"),
        ("round_ != 4", "1"),
        (
            "filter",
            "{<Base> = {made = true}, share = 0.25, state = 369.722656, count = 4}",
        ),
        ("lab::shared + 1", "8"),
        ("flags", "{low = 3, high = 0}"),
        ("$r1", "0"),
        ("OCR3A", "1999"),
    ] {
        assert_eq!(editor.value(expression), value, "{expression}");
    }
    let unknown = editor.value("rounds");
    assert!(
        unknown.contains("nothing is called `rounds`") && unknown.contains("round_, values"),
        "{unknown}"
    );
    // Into the call, as deep as it goes, and out again.
    assert_eq!(
        editor.go("stepIn"),
        ("step".into(), line_of("int inner = level"))
    );
    editor.break_at(
        &file,
        json!([{"line": line_of("return inner"), "condition": "level == 0"}]),
    );
    editor.go("continue");
    let names: Vec<_> = editor
        .frames()
        .iter()
        .map(|frame| frame["name"].clone())
        .collect();
    assert_eq!(names, ["depth", "depth", "depth", "depth", "loop", "main"]);
    editor.break_at(&file, json!([]));
    assert_eq!(
        (editor.go("stepOut").0, editor.frames().len()),
        ("step".into(), 5)
    );
    // What is set is what the program reads.
    for _ in 0..3 {
        editor.go("stepOut");
    }
    assert_eq!(editor.value("values[0] = 30"), "30");
    editor.go("next");
    assert_eq!(editor.value("best"), "37");
    // A data breakpoint, at the access.
    let watched = editor.ask("dataBreakpointInfo", json!({"name": "pair", "frameId": 0}));
    editor.ask(
        "setDataBreakpoints",
        json!({"breakpoints": [{"dataId": watched["dataId"], "accessType": "write"}]}),
    );
    assert_eq!(editor.go("continue").0, "data breakpoint");
    editor.ask("setDataBreakpoints", json!({"breakpoints": []}));
    // A log point writes and does not stop; the program's end is a stop from which there is a way back.
    editor.break_at(&file, json!([{"line": line_of("round_++"), "logMessage": "round {round_}", "hitCondition": "> 2"}]));
    editor.events.clear();
    let (reason, _) = editor.go("continue");
    let console = editor.console();
    assert_eq!(reason, "pause");
    let logged = console.lines().find(|line| line.starts_with("round"));
    assert_eq!(logged, Some("round 6 '\\006'"), "{console}");
    assert!(console.contains("The scenario's time is over"));
    editor.ask("disconnect", json!({}));
    assert!(editor.child.wait().unwrap().success());
}

#[test]
fn steps_lead_from_setup_to_loop_and_into_the_core_only_if_asked() {
    let (sketch, _) = kinds("own_code");
    // The functions and files of steps from the beginning on, until one is in another function.
    let walk = |arguments: Value, step: &str| {
        let mut editor = Editor::launch(&[&sketch], arguments)?;
        editor.ask("configurationDone", json!({}));
        editor.stop();
        let mut seen = Vec::new();
        while seen.last().is_none_or(|(name, _)| name == "setup") {
            let frame = editor.frames().remove(0);
            let text = |value: &Value| value.as_str().unwrap().to_owned();
            seen.push((text(&frame["name"]), text(&frame["source"]["name"])));
            assert!(seen.len() < 50, "{seen:?}");
            editor.go(step);
        }
        Some((editor, seen))
    };
    let own = json!({"stopOnEntry": true});
    let Some((mut editor, over)) = walk(own.clone(), "next") else {
        return;
    };
    let there = ("loop".to_owned(), "own_code.ino".to_owned());
    assert_eq!(over.last(), Some(&there));
    let back: Vec<_> = (0..2)
        .map(|_| {
            editor.go("stepBack");
            editor.frames().remove(0)["name"].take()
        })
        .collect();
    assert_eq!(back, ["loop", "setup"]);
    let (_, into) = walk(own, "stepIn").unwrap();
    assert!(
        into.iter().all(|(_, file)| file == "own_code.ino"),
        "{into:?}"
    );
    let all = json!({"stopOnEntry": true, "justMyCode": false});
    let (_, into) = walk(all, "stepIn").unwrap();
    assert!(
        into.iter().any(|(_, file)| file != "own_code.ino"),
        "{into:?}"
    );
}

#[test]
fn steps_back_are_the_steps_forward_in_reverse_with_the_same_values() {
    let (sketch, file) = kinds("kinds");
    let Some(mut editor) = Editor::launch(&[&sketch], json!({})) else {
        return;
    };
    editor.break_at(
        &file,
        json!([{"line": line_of("int values[5]"), "condition": "round_ == 6"}]),
    );
    editor.ask("configurationDone", json!({}));
    editor.stop();
    editor.break_at(&file, json!([]));
    let state = |editor: &mut Editor| {
        let frame = editor.frames().remove(0);
        (
            frame["name"].clone(),
            frame["line"].clone(),
            editor.locals(&frame),
            editor.value("$cycle"),
        )
    };
    // With calls and a wait of 20 ms in it, and interrupts everywhere.
    let mut forward = vec![state(&mut editor)];
    for _ in 0..14 {
        editor.go("next");
        forward.push(state(&mut editor));
    }
    for there in forward.iter().rev().skip(1) {
        assert_eq!(editor.go("stepBack").0, "step");
        assert_eq!(state(&mut editor), *there);
    }
    // Back to a breakpoint of an earlier round, and forward again to the same cycle.
    editor.break_at(&file, json!([{"line": line_of("round_++")}]));
    assert_eq!(
        editor.go("reverseContinue"),
        ("breakpoint".into(), line_of("round_++"))
    );
    assert_eq!(editor.value("round_"), "5 '\\005'");
    let (here, _) = (state(&mut editor), editor.go("continue"));
    editor.go("reverseContinue");
    assert_eq!(state(&mut editor), here);
    editor.break_at(&file, json!([]));
    assert_eq!(editor.go("reverseContinue").0, "entry");
}

#[test]
fn what_cannot_be_debugged_says_why() {
    let text = folder().join("no_debug.hex");
    std::fs::write(&text, ":020000000C945E\n:00000001FF\n").unwrap();
    let Some(mut editor) = Editor::launch(&["example:wall"], json!({})) else {
        return;
    };
    for (launch, what) in [
        (json!({"program": text}), "it is no ELF file"),
        (json!({"program": "nowhere"}), "nowhere"),
        (json!({"scenario": "mode8-two"}), "mode8-two"),
        (json!({"seed": "one"}), "its arguments"),
    ] {
        let error = editor.request("launch", launch).unwrap_err();
        assert!(error.contains(what), "{error}");
    }
    let error = editor.request("levitate", json!({})).unwrap_err();
    assert!(error.contains("levitate is not supported"), "{error}");
}
