//! What a program does inside counts as the emulator saw it: sketches whose text shows nothing of it are caught.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::grade::{bench, results};
use crate::support::{folder, program, stderr};
use std::fs;

const SCENARIO: &str = r#"
title = "S"
robot = "memoria"
rig = "front_single"
world = "open"
mode = "manual"
duration_s = 2
[[command]]
at_s = 0.4
arm = true
"#;

const ASSIGNMENT: &str = r#"
title = "T"
statement = "S"
points = 7
[[scenario]]
scenario = "scenario.toml"
wiring = "mode_1"
public_seeds = [1]
[[criterion]]
title = "Waits"
metric = "program.wait_longest_s"
points = 1
full = 0.004
none = 0.008
advice = "Compare millis() with a time that you keep."
[[criterion]]
title = "Share"
metric = "program.wait_share"
points = 1
full = 0.1
none = 0.5
[[criterion]]
title = "Stack"
metric = "program.stack_bytes"
points = 1
full = 300
none = 600
[[criterion]]
title = "Turns"
metric = "program.turn_longest_s"
points = 1
full = 0.004
none = 0.008
[[criterion]]
title = "Interrupts"
metric = "program.interrupt_longest_s"
points = 1
full = 0.0001
none = 0.0002
[[criterion]]
title = "Floats"
metric = "program.interrupt_float_s"
points = 1
full = 0
none = 0.001
[[criterion]]
title = "Heap"
metric = "program.heap_calls"
points = 1
full = 0
none = 1
"#;

const DRIVES: &str = "void setup() { pinMode(5, OUTPUT); pinMode(4, OUTPUT); digitalWrite(4, HIGH); analogWrite(5, 90); begin(); }\n";
const TIMER: &str = "void begin() { TCCR1A = 0; TCCR1B = 0x0B; OCR1A = 2499; TIMSK1 = 2; }\n";

/// Sketches, the lines on which they lose points, and a word of where that was.
const SKETCHES: [(&str, &str, &[&str], &str); 9] = [
    (
        "polls",
        "unsigned long last; int duty; void begin() { last = millis(); }
         void loop() { if (millis() - last < 20) return; last += 20; analogWrite(5, 90 + (duty = (duty + 1) % 9)); }",
        &[],
        "",
    ),
    (
        "pasted",
        "void begin() {}
         #define A(x, y) x##y
         void loop() { analogWrite(5, 90); A(de, lay)(30); }",
        &["Waits", "Share", "Turns"],
        "it waits",
    ),
    (
        "own",
        "void begin() {}
         void loop() { analogWrite(5, 90); unsigned long since = millis(); while (millis() - since < 30) {} }",
        &["Waits", "Share", "Turns"],
        "it waits",
    ),
    (
        "counts",
        "void begin() {}
         void loop() { analogWrite(5, 90); for (volatile long i = 0; i < 20000; i++) {} }",
        &["Waits", "Share", "Turns"],
        "it waits",
    ),
    (
        "pin",
        "void begin() {}
         unsigned long us; void loop() { us = pulseIn(13, HIGH, 30000); analogWrite(5, 90); }",
        &["Waits", "Share", "Turns"],
        "it waits",
    ),
    (
        "float",
        "volatile int speed = 3; volatile int out;
         __attribute__((noinline)) int filter(int x) { return x * 0.37 + 1.5; }
         ISR(TIMER1_COMPA_vect) { out = filter(speed); }
         void loop() {}",
        &["Floats"],
        "is called by filter",
    ),
    (
        "long",
        "volatile int n; ISR(TIMER1_COMPA_vect) { for (int i = 0; i < 900; i++) n++; }
         void loop() {}",
        &["Interrupts"],
        "interrupt TIMER1_COMPA takes",
    ),
    (
        "deep",
        "void begin() {}
         void loop() { volatile byte read[700]; read[millis() % 700] = 1; analogWrite(5, 90 + read[0] % 2); }",
        &["Stack"],
        "",
    ),
    (
        "heap",
        "void begin() {}
         int length; void loop() { String text = String(millis()) + \"ms\"; length = text.length(); }",
        &["Heap"],
        "is called by",
    ),
];

#[test]
fn what_a_text_hides_the_emulator_sees() {
    let Some(bench) = bench("program") else {
        return;
    };
    fs::write(bench.join("assignment.toml"), ASSIGNMENT).unwrap();
    fs::write(bench.join("scenario.toml"), SCENARIO).unwrap();
    for (name, text, _, _) in SKETCHES {
        let timer = if text.contains("begin") { "" } else { TIMER };
        fs::create_dir(bench.join("in").join(name)).unwrap();
        let path = bench.join("in").join(name).join("a.ino");
        fs::write(path, format!("{DRIVES}{timer}{text}\n")).unwrap();
    }
    let mut command = program();
    command.current_dir(&bench);
    command.args(["grade", "assignment.toml", "in", "--language", "en"]);
    command.args(["--out", "out"]);
    command.env("RUMBO_CACHE", folder().join("sketches"));
    let output = command.output().unwrap();
    assert!(output.status.code() != Some(2), "{}", stderr(&output));
    let results = results(&bench.join("out"));
    for (name, _, loses, place) in SKETCHES {
        let lines = results[name]["tests"].as_array().unwrap();
        let lost = lines.iter().filter(|line| line["status"] == "failed");
        let lost: Vec<&str> = lost.map(|line| line["name"].as_str().unwrap()).collect();
        assert_eq!(lost, loses, "{name}: {:#}", results[name]);
        for line in lines
            .iter()
            .filter(|line| loses.first().is_some_and(|one| line["name"] == *one))
        {
            let said = line["output"].as_str().unwrap();
            assert!(said.contains(place), "{name}: {said}");
        }
    }
    let page = fs::read_to_string(bench.join("out/students/own.html")).unwrap();
    assert!(
        page.contains("It waits ") && page.contains("Compare millis()"),
        "{page}"
    );

    fs::write(
        bench.join("assignment.toml"),
        ASSIGNMENT.replace("heap_calls", "heap_cals"),
    )
    .unwrap();
    let said = stderr(&command.output().unwrap());
    assert!(
        said.contains("no such metric of a program; did you mean `program.heap_calls`"),
        "{said}"
    );
}
