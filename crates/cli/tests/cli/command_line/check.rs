//! `rumbo check`: claims about a sketch.

use super::sketch::{bench, rumbo};
use crate::support::{stderr, stdout};
use std::path::PathBuf;

const SKETCH: &str = "
void setup() { Serial.begin(115200); Serial1.begin(9600); pinMode(7, OUTPUT); delay(100); Serial.println(\"ready\"); }
void loop() {
  if (Serial.read() == 'P') {
    digitalWrite(7, HIGH); delayMicroseconds(500); digitalWrite(7, LOW);
    Serial.println(analogRead(A0));
  }
  int got = Serial1.read();
  if (got >= 0) { Serial1.print(\"got \"); Serial1.println(char(got)); analogWrite(9, 128); }
}";

/// A folder with the sketch and a file of tests, or `None` where no compiler is installed.
fn with(name: &str, tests: &str) -> Option<PathBuf> {
    let bench = bench(name)?;
    std::fs::write(bench.join("it.ino"), SKETCH).unwrap();
    std::fs::write(bench.join("tests.toml"), tests).unwrap();
    Some(bench)
}

#[test]
fn claims_that_hold_pass_and_one_that_does_not_says_what_came_instead() {
    let tests = "\
sketch = \"it.ino\"
[[test]]
name = \"answers a letter with a pulse and a reading\"
step = [
  { expect = \"ready\" },
  { pin = \"A0\", apply_v = 2.5 },
  { send = \"P\", line_ending = \"none\" },
  { pin = 7, over_s = 0.1, pulses = { min = 1, max = 1 }, width_us = { min = 499, max = 515 } },
  { expect = \"512\" },
]
[[test]]
name = \"modulates what the module asks for\"
step = [
  { run_s = 0.2 },
  { send = \"x\", port = \"link\" },
  { expect = \"got x\", port = \"link\" },
  { pin = 9, over_s = 0.5, period_us = { min = 2039, max = 2041 }, duty = { min = 0.49, max = 0.51 } },
  { truth = \"forward_m_s\", max = 0.01 },
]
[[test]]
name = \"is steady\"
[[test.step]]
expect = \"ready\"
[[test.step]]
expect = \"steady\"
within_s = 0.2
";
    let Some(bench) = with("check", tests) else {
        return;
    };
    let words = ["check", "tests.toml", "--junit", "r.xml", "--out", "failed"];
    let done = rumbo(&bench, &words);
    assert_eq!(done.status.code(), Some(1), "{}", stderr(&done));
    let said = stdout(&done);
    assert!(said.contains("passed  answers a letter with a pulse and a reading"));
    assert!(
        said.contains("passed  modulates what the module asks for"),
        "{said}"
    );
    assert!(
        said.contains(
            "FAILED  is steady\n        step 2 (tests.toml:25): Serial (USB) did not send \"steady\", but \"\\n\" \
             within 0.2 s\n        rumbo replay failed/test3.mcap; gtkwave failed/test3.vcd\n\n3 tests: 1 failed\n"
        ),
        "{said}"
    );
    let xml = std::fs::read_to_string(bench.join("r.xml")).unwrap();
    assert!(xml.contains("tests=\"3\" failures=\"1\""), "{xml}");
    assert!(xml.contains("did not send &quot;steady&quot;"), "{xml}");
    let waves = std::fs::read_to_string(bench.join("failed/test3.vcd")).unwrap();
    assert!(waves.contains("$timescale") && waves.contains("pin_07"));
    let shown = rumbo(&bench, &["export", "failed/test3.mcap", "--force"]);
    assert!(shown.status.success(), "{}", stderr(&shown));
    let again = rumbo(&bench, &["check", "tests.toml", "--only", "letter"]);
    assert!(again.status.success(), "{}", stdout(&again));
    assert!(stdout(&again).contains("1 test: all passed\n"));
}

#[test]
fn each_mistake_of_a_file_is_named_by_its_line_before_anything_is_driven() {
    let tests = "\
sketch = \"it.ino\"
firmware = \"it.elf\"
[[test]]
name = \"one\"
step = [
  { wait = 1 },
  { expect = \"a\", send = \"b\" },
  { pin = 7, over_s = 1 },
  { truth = \"x_mm\", min = 1 },
  { apply_v = 7, pin = 3 },
  { send = \"b\", port = \"usb2\" },
]
[[test]]
name = \"one\"
";
    let Some(bench) = with("check-wrong", tests) else {
        return;
    };
    let done = rumbo(&bench, &["check", "tests.toml"]);
    assert_eq!(done.status.code(), Some(2));
    let said = stderr(&done);
    for wrong in [
        "has two programs",
        "tests.toml:6",
        "it needs one of expect, send, press",
        "does both expect and send",
        "judges nothing",
        "did you mean `x_m`",
        "must be within 0..5 V",
        "must be \"usb\", \"link\"",
        "another test has that name",
        "claims nothing",
    ] {
        assert!(said.contains(wrong), "{wrong}: {said}");
    }
    let tests = "sketch = \"it.ino\"\n[[test]]\nname = \"one\"\n[[test.step]]\npin = \"lef_enable\"\nhigh = true\n";
    std::fs::write(bench.join("tests.toml"), tests).unwrap();
    let said = stderr(&rumbo(&bench, &["check", "tests.toml"]));
    assert!(
        said.contains("tests.toml:5: unknown pin `lef_enable`; did you mean `left_enable`"),
        "{said}"
    );
}

#[test]
fn the_example_s_claims_hold() {
    let Some(bench) = bench("check-example") else {
        return;
    };
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/checks/wall.toml"
    );
    let done = rumbo(&bench, &["check", file]);
    assert!(done.status.success(), "{}{}", stdout(&done), stderr(&done));
}
