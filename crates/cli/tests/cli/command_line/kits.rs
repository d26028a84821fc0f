//! Robots with other wirings, drivers and parts than the report's: a sketch as their authors write it, and a robot file.

use super::sketch::{bench, rumbo};
use crate::support::{stderr, stdout};
use std::path::PathBuf;
use std::process::Output;

/// A folder with a robot on a Uno, wired so, in an open world, and a sketch. `None` where no compiler is installed.
fn kit(name: &str, wiring: &str, sketch: &str) -> Option<PathBuf> {
    let bench = bench(name)?;
    let robot = format!(
        "title = \"A car\"\nboard = \"uno\"\n[rig.front_single.front]\nx_m = 0.13\n[wiring.car]\n{wiring}"
    );
    let scenario = "title = \"On the floor\"\nrobot = \"robot.toml\"\nrig = \"front_single\"\nworld = \"open\"\n\
                    mode = \"manual\"\nduration_s = 3\n[spread]\nnone = true\n";
    std::fs::write(bench.join("robot.toml"), robot).unwrap();
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    Some(bench)
}

fn drive(bench: &PathBuf, more: &[&str]) -> Output {
    let run = [
        "run",
        "floor.toml",
        "--sketch",
        "car.ino",
        "--out",
        "out",
        "--force",
    ];
    rumbo(bench, &[&run, more].concat())
}

/// The last value of a column of the true signals.
fn last(bench: &PathBuf, column: &str) -> f64 {
    let csv = std::fs::read_to_string(bench.join("out/floor-1.truth.csv")).unwrap();
    let mut lines = csv.lines();
    let at = lines
        .next()
        .unwrap()
        .split(',')
        .position(|each| each == column);
    let row: Vec<&str> = lines.last().unwrap().split(',').collect();
    row[at.unwrap()].parse().unwrap()
}

const LETTERS: &str = "
char letter;
void setup() {
  Serial.begin(9600);
  for (int pin = 5; pin <= 8; pin++) pinMode(pin, OUTPUT);
  digitalWrite(7, HIGH); digitalWrite(8, HIGH);
}
void loop() {
  if (Serial.available()) letter = Serial.read();
  analogWrite(5, letter == 'F' ? 150 : 0);
  analogWrite(6, letter == 'F' ? 150 : 0);
  delay(50);
}";
const LETTERS_WIRING: &str = "left_enable = 5\nleft_forward = 7\nright_enable = 6\nright_forward = 8\n\
                              debug_tx = 1\ndebug_rx = 0\n";

#[test]
fn a_letter_without_a_line_ending_is_obeyed_until_the_next_one() {
    let Some(bench) = kit("letters", LETTERS_WIRING, LETTERS) else {
        return;
    };
    let run = drive(&bench, &["--usb", "F@1"]);
    assert!(
        last(&bench, "x_m").abs() < 0.02,
        "LF stops it: {}",
        stdout(&run)
    );
    let run = drive(&bench, &["--usb", "F@1", "--line-ending", "none"]);
    assert!(
        last(&bench, "x_m") > 0.3,
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    let again = rumbo(&bench, &["rerun", "out/floor-1.mcap"]);
    assert!(
        again.status.success(),
        "{}{}",
        stdout(&again),
        stderr(&again)
    );
    // The same in the scenario.
    let scenario = std::fs::read_to_string(bench.join("floor.toml")).unwrap();
    let typed = "[[command]]\nat_s = 1\nusb = \"F\"\nline_ending = \"none\"\n";
    std::fs::write(bench.join("floor.toml"), format!("{scenario}{typed}")).unwrap();
    drive(&bench, &[]);
    assert!(last(&bench, "x_m") > 0.3);
    let wrong = typed.replace("none", "nl");
    std::fs::write(bench.join("floor.toml"), format!("{scenario}{wrong}")).unwrap();
    let refused = drive(&bench, &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused).contains("line_ending = \"nl\": known are `none`, `lf`, `cr`, `crlf`"),
        "{}",
        stderr(&refused)
    );
}
