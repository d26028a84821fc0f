//! `rumbo check`: claims about a sketch.

use super::sketch::{bench, rumbo};
use crate::support::{stderr, stdout};
use std::path::{Path, PathBuf};

/// A folder with the sketch and a file of tests, or `None` where no compiler is installed.
fn with(name: &str, tests: &str) -> Option<PathBuf> {
    let bench = bench(name)?;
    let given = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs/check");
    for (from, to) in [("it.ino", "it.ino"), (tests, "tests.toml")] {
        std::fs::copy(given.join(from), bench.join(to)).unwrap();
    }
    Some(bench)
}

#[test]
fn claims_that_hold_pass_and_one_that_does_not_says_what_came_instead() {
    let Some(bench) = with("check", "claims.toml") else {
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
    let Some(bench) = with("check-wrong", "wrong.toml") else {
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
