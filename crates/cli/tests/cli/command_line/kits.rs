//! Robots with other wirings, drivers and parts than the report's: a sketch as their authors write it, and a robot file.

use super::sketch::{bench, ino, rumbo};
use crate::support::{is_full, stderr, stdout};
use std::path::{Path, PathBuf};
use std::process::Output;

/// A folder with a robot on a Uno, wired so, in an open world, and a sketch. `None` where no compiler is installed.
pub(super) fn kit(name: &str, wiring: &str, sketch: &str) -> Option<PathBuf> {
    driven_by("l298n", name, wiring, sketch)
}

/// The same with another driver.
pub(super) fn driven_by(driver: &str, name: &str, wiring: &str, sketch: &str) -> Option<PathBuf> {
    let bench = bench(name)?;
    let robot = format!(
        "title = \"A car\"\nboard = \"uno\"\ndriver = \"{driver}\"\n[rig.front_single.front]\nx_m = 0.13\n[wiring.car]\n{wiring}"
    );
    let scenario = "title = \"On the floor\"\nrobot = \"robot.toml\"\nrig = \"front_single\"\nworld = \"open\"\n\
                    mode = \"manual\"\nduration_s = 3\n[spread]\nnone = true\n";
    std::fs::write(bench.join("robot.toml"), robot).unwrap();
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    Some(bench)
}

pub(super) fn drive(bench: &PathBuf, more: &[&str]) -> Output {
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

/// The run is repeated from its log alone.
pub(super) fn is_repeated(bench: &PathBuf) {
    let again = rumbo(bench, &["rerun", "out/floor-1.mcap"]);
    let said = stdout(&again) + &stderr(&again);
    assert!(again.status.success(), "{said}");
}

/// What the sketch printed on USB.
pub(super) fn usb(bench: &Path) -> String {
    std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap()
}

/// A column of the true signals.
pub(super) fn column(bench: &Path, name: &str) -> Vec<f64> {
    let csv = std::fs::read_to_string(bench.join("out/floor-1.truth.csv")).unwrap();
    let mut lines = csv.lines().map(|line| line.split(','));
    let at = lines.next().unwrap().position(|each| each == name).unwrap();
    lines
        .map(|mut cells| cells.nth(at).unwrap().parse().unwrap())
        .collect()
}

/// The last value of a column of the true signals.
pub(super) fn last(bench: &Path, name: &str) -> f64 {
    *column(bench, name).last().unwrap()
}

const LETTERS_WIRING: &str = "left_enable = 5\nleft_forward = 7\nright_enable = 6\nright_forward = 8\n\
                              debug_tx = 1\ndebug_rx = 0\n";

#[test]
fn a_letter_without_a_line_ending_is_obeyed_until_the_next_one() {
    let Some(bench) = kit("letters", LETTERS_WIRING, &ino("letters")) else {
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
    is_repeated(&bench);
    // A car that is driven by bytes: 0x46 is that letter.
    drive(&bench, &["--usb", "\\x46@1", "--line-ending", "none"]);
    assert!(last(&bench, "x_m") > 0.3);
    // The same in the scenario.
    let scenario = std::fs::read_to_string(bench.join("floor.toml")).unwrap();
    let typed = "[[command]]\nat_s = 1\nusb = \"F\"\nline_ending = \"none\"\n";
    std::fs::write(bench.join("floor.toml"), format!("{scenario}{typed}")).unwrap();
    drive(&bench, &[]);
    assert!(last(&bench, "x_m") > 0.3);
}

/// Forward for a second and a half, then backward.
pub(super) fn to_and_fro(pins: &str, forward: &str, backward: &str) -> String {
    format!(
        "const byte pins[] = {{{pins}}};\nvoid setup() {{ for (byte pin : pins) pinMode(pin, OUTPUT); }}\n\
         void loop() {{ {forward} delay(1500); {backward} delay(100000); }}\n"
    )
}

#[test]
fn an_l298n_whose_jumpers_hold_the_enables_drives_by_pwm_on_its_inputs() {
    let sketch = to_and_fro(
        "5, 6, 9, 10",
        "analogWrite(5, 150); analogWrite(9, 150); analogWrite(6, 0); analogWrite(10, 0);",
        "analogWrite(5, 0); analogWrite(9, 0); analogWrite(6, 150); analogWrite(10, 150);",
    );
    let wiring = "left_enable = \"high\"\nleft_forward = 5\nleft_backward = 6\n\
                  right_enable = \"high\"\nright_forward = 9\nright_backward = 10\n";
    there_and_back(kit("jumpers", wiring, &sketch));
}

#[test]
fn a_driver_with_one_direction_input_drives_both_ways() {
    // As an mBot has it: one wheel's high is forward, the other's backward.
    let sketch = to_and_fro(
        "4, 5, 6, 7",
        "digitalWrite(7, HIGH); digitalWrite(4, LOW); analogWrite(6, 120); analogWrite(5, 120);",
        "digitalWrite(7, LOW); digitalWrite(4, HIGH);",
    );
    let wiring = "left_enable = 6\nleft_forward = 7\nright_enable = 5\nright_backward = 4\n";
    there_and_back(driven_by("dir-pwm", "dir_pwm", wiring, &sketch));
}

#[test]
fn a_tb6612_drives_when_its_standby_is_high() {
    let run = "digitalWrite(7, HIGH); digitalWrite(8, LOW); digitalWrite(2, HIGH); digitalWrite(4, LOW); \
               analogWrite(5, 120); analogWrite(6, 120);";
    let back =
        "digitalWrite(7, LOW); digitalWrite(8, HIGH); digitalWrite(2, LOW); digitalWrite(4, HIGH);";
    let sketch = to_and_fro(
        "2, 3, 4, 5, 6, 7, 8",
        &format!("digitalWrite(3, HIGH); {run}"),
        back,
    );
    let wiring = "left_enable = 5\nleft_forward = 7\nleft_backward = 8\nright_enable = 6\nright_forward = 2\n\
                  right_backward = 4\nstandby = 3\n";
    there_and_back(driven_by("tb6612", "tb6612", wiring, &sketch));
    let Some(bench) = driven_by("tb6612", "standby", wiring, &to_and_fro("3", run, back)) else {
        return;
    };
    drive(&bench, &[]);
    assert_eq!(last(&bench, "x_m"), 0.0);
}

#[test]
fn a_drv8833_drives_by_pwm_on_its_inputs_and_has_no_enable() {
    let sketch = to_and_fro(
        "5, 6, 9, 10",
        // The left wheel brakes between the pulses, the right one coasts.
        "digitalWrite(5, HIGH); analogWrite(6, 105); analogWrite(9, 150);",
        "analogWrite(5, 105); digitalWrite(6, HIGH); analogWrite(9, 0); analogWrite(10, 150);",
    );
    let wiring = "left_forward = 5\nleft_backward = 6\nright_forward = 9\nright_backward = 10\n";
    let Some(bench) = driven_by("drv8833", "drv8833", wiring, &sketch) else {
        return;
    };
    drive(&bench, &[]);
    // Nothing brakes the one that coasts.
    let (left, right) = (last(&bench, "left_rad_s"), last(&bench, "right_rad_s"));
    assert!(left < -2.0 && right < 1.2 * left, "{left} {right}");
}

/// It drives forward for half of the run and back in the other half.
pub(super) fn there_and_back(bench: Option<PathBuf>) {
    let Some(bench) = bench else { return };
    let run = drive(&bench, &[]);
    let x_m = column(&bench, "x_m");
    let farthest_m = x_m.iter().copied().fold(0.0, f64::max);
    let end_m = *x_m.last().unwrap();
    assert!(
        farthest_m > 0.3 && end_m < 0.7 * farthest_m,
        "{farthest_m} {end_m} {}{}",
        stdout(&run),
        stderr(&run)
    );
}

/// The numbers that it printed.
fn printed(bench: &Path) -> Vec<i64> {
    let said = usb(bench);
    let numbers = said.lines().filter_map(|line| line.trim().parse().ok());
    numbers.collect()
}

#[test]
fn an_encoder_with_two_outputs_counts_up_forward_and_down_backward() {
    let sketch = &ino("quadrature");
    let wiring = "left_enable = 5\nleft_forward = 7\nleft_backward = 8\nleft_encoder = 2\nleft_encoder_b = 4\n\
                  debug_tx = 1\ndebug_rx = 0\n";
    let Some(bench) = kit("quadrature", wiring, sketch) else {
        return;
    };
    drive(&bench, &[]);
    let counts = printed(&bench);
    assert!(counts[0] > 100 && counts[1] < counts[0] - 100, "{counts:?}");
}

#[test]
fn a_disc_of_twenty_slots_counts_twenty_a_turn() {
    let sketch = &ino("slots");
    let wiring =
        "left_enable = 5\nleft_forward = 7\nleft_encoder = 3\ndebug_tx = 1\ndebug_rx = 0\n";
    let Some(bench) = kit("slots", wiring, sketch) else {
        return;
    };
    let robot = std::fs::read_to_string(bench.join("robot.toml")).unwrap();
    let disc = "[plant.encoder]\nslots = 20\n";
    std::fs::write(bench.join("robot.toml"), format!("{robot}{disc}")).unwrap();
    drive(&bench, &[]);
    let turns = mean(&bench, "left_rad_s") * 2.9 / std::f64::consts::TAU;
    let counted = printed(&bench)[0] as f64 / 20.0;
    assert!((counted - turns).abs() < 0.1, "{counted} {turns}");
}

/// The mean of a column of the true signals over the first 2.9 s.
fn mean(bench: &Path, name: &str) -> f64 {
    let values = column(bench, name);
    let first = &values[..290.min(values.len())];
    first.iter().sum::<f64>() / first.len() as f64
}

#[test]
fn a_bluetooth_module_on_any_two_pins_is_heard_and_hears_at_its_own_rate() {
    let sketch = &ino("bluetooth");
    let wiring = "left_enable = 5\nleft_forward = 7\nlink_rx = 2\nlink_tx = 3\nlink_baud = 38400\n";
    let Some(bench) = kit("bluetooth", wiring, sketch) else {
        return;
    };
    let letter = ["--command", "F@1", "--line-ending", "none"];
    let run = drive(&bench, &letter);
    let said =
        || std::fs::read_to_string(bench.join("out/floor-1-bluetooth.txt")).unwrap_or_default();
    assert_eq!(said(), "Forward\n", "{}{}", stdout(&run), stderr(&run));
    assert!(last(&bench, "left_rad_s") > 1.0);
    is_repeated(&bench);
    // One that only obeys is on the right pins; a module on others gets nothing.
    std::fs::write(
        bench.join("car.ino"),
        sketch.replace("phone.println(\"Forward\");", ""),
    )
    .unwrap();
    let robot = std::fs::read_to_string(bench.join("robot.toml")).unwrap();
    let silent = "nothing came over the Bluetooth link";
    for (pins, is_silent) in [
        ("link_rx = 2\nlink_tx = 3", false),
        ("link_rx = 9\nlink_tx = 12", true),
    ] {
        let wired = robot.replace("link_rx = 2\nlink_tx = 3", pins);
        std::fs::write(bench.join("robot.toml"), wired).unwrap();
        let run = drive(&bench, &letter);
        let told = stdout(&run) + &stderr(&run);
        assert_eq!(told.contains(silent), is_silent, "{told}");
    }
    // The module as it is sold, and a sketch that sends faster.
    std::fs::write(
        bench.join("robot.toml"),
        robot.replace("link_baud = 38400\n", ""),
    )
    .unwrap();
    let eager = sketch.replace("digitalWrite(7, HIGH); }", "phone.println(\"Ready\"); }");
    std::fs::write(bench.join("car.ino"), eager).unwrap();
    let run = drive(&bench, &letter);
    assert!(!said().contains("Ready"));
    let told = stdout(&run) + &stderr(&run);
    assert!(told.contains("is not at 9600 baud"), "{told}");
}

#[test]
fn a_sketch_of_one_s_own_needs_neither_mode_nor_rig_and_gets_the_metrics_of_its_way() {
    let sketch = to_and_fro(
        "5, 6, 7, 8",
        "digitalWrite(7, HIGH); digitalWrite(8, HIGH); analogWrite(5, 150); analogWrite(6, 150);",
        "",
    );
    let Some(bench) = kit("no_mode", LETTERS_WIRING, &sketch) else {
        return;
    };
    let robot = std::fs::read_to_string(bench.join("robot.toml")).unwrap();
    let robot = robot.replace("[rig.front_single.front]\nx_m = 0.13\n", "");
    std::fs::write(bench.join("robot.toml"), robot).unwrap();
    let scenario =
        "title = \"On the floor\"\nrobot = \"robot.toml\"\nworld = \"open\"\nduration_s = 3\n";
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    let run = drive(&bench, &["--json"]);
    let result: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert!(
        result["metrics"]["path_m"].as_f64().unwrap() > 0.3,
        "{result}"
    );
    assert!(run.status.success());
    is_repeated(&bench);
    // In a room that is there already, and in an experiment for another program.
    let own = [
        "--robot",
        "robot.toml",
        "--sketch",
        "car.ino",
        "--no-record",
    ];
    let free = rumbo(&bench, &[&["run", "free"][..], &own].concat());
    assert!(free.status.success(), "{}{}", stdout(&free), stderr(&free));
    let judged = rumbo(&bench, &[&["run", "mode1"][..], &own].concat());
    let told = stdout(&judged) + &stderr(&judged);
    assert!(
        told.contains("scenario mode1 judges mode front_distance"),
        "{told}"
    );
    // Ours has nothing to do there.
    let refused = rumbo(&bench, &["run", "floor.toml"]);
    assert!(
        stderr(&refused).contains("has no mode, so it is for a sketch"),
        "{}",
        stderr(&refused)
    );
}

#[test]
fn a_wheel_that_was_never_driven_is_named_with_what_was_missing() {
    let sketch = to_and_fro(
        "5, 7, 8, 12",
        "digitalWrite(7, HIGH); digitalWrite(8, HIGH); analogWrite(12, 200); analogWrite(11, 30);",
        "",
    );
    let wiring = "left_enable = 5\nleft_forward = 7\nright_enable = 12\nright_forward = 8\n";
    let Some(bench) = kit("one_wheel", wiring, &sketch) else {
        return;
    };
    let told = |run: Output| stdout(&run) + &stderr(&run);
    let said = told(drive(&bench, &[]));
    assert!(
        said.contains("it never drove the left motor: left_enable (pin 5) was never high"),
        "{said}"
    );
    assert!(
        said.contains("right_enable is on pin 12, which has no PWM on the Arduino Uno"),
        "{said}"
    );
    assert!(!said.contains("never drove a motor"), "{said}");
    // One motor's wires exchanged.
    let sketch = to_and_fro(
        "5, 6, 7, 8",
        "digitalWrite(7, HIGH); digitalWrite(8, HIGH); analogWrite(5, 150); analogWrite(6, 150);",
        "",
    );
    let wiring = LETTERS_WIRING.replace("right_forward", "right_backward");
    let Some(bench) = kit("exchanged", &wiring, &sketch) else {
        return;
    };
    let said = told(drive(&bench, &[]));
    assert!(
        said.contains("drove the wheels against each other all the time"),
        "{said}"
    );
    std::fs::write(bench.join("car.ino"), sketch.replace("150", "15")).unwrap();
    let said = told(drive(&bench, &[]));
    assert!(said.contains("of 255, and no wheel turned"), "{said}");
}

#[test]
fn a_new_robot_is_checked_told_what_it_looks_like_and_drives() {
    let Some(bench) = bench("new_robot") else {
        return;
    };
    let new = |name: &str, more: &[&str]| rumbo(&bench, &[&["new", "robot", name], more].concat());
    let pins = "--pins=left_enable=5,left_forward=7,left_backward=8,right_enable=6,right_forward=11,right_backward=10,\
                servo=3,front_trigger=A5,front_echo=A4";
    let made = new("my_car", &["--board", "uno", "--driver", "l298n", pins]);
    assert!(made.status.success(), "{}", stderr(&made));
    let said = stdout(&made);
    assert!(
        said.contains("those of the robot kit_elegoo_v3: 8 of 9; right_backward is 9 there"),
        "{said}"
    );
    let sketch = to_and_fro(
        "5, 6, 7, 11",
        "digitalWrite(7, HIGH); digitalWrite(11, HIGH); analogWrite(5, 150); analogWrite(6, 150);",
        "",
    );
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let run = rumbo(
        &bench,
        &[
            "run",
            "free",
            "--robot",
            "my_car.toml",
            "--sketch",
            "car.ino",
            "--json",
            "--no-record",
        ],
    );
    let result: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert!(
        result["metrics"]["path_m"].as_f64().unwrap() > 0.3,
        "{result}{}",
        stderr(&run)
    );
    // A file that is there is kept.
    let again = new("my_car", &["--like", "kit_elegoo_v3"]);
    assert!(
        stderr(&again).contains("my_car.toml: is there already"),
        "{}",
        stderr(&again)
    );
    assert!(new("elegoo", &["--like", "kit_elegoo_v3"]).status.success());
    let listed = stdout(&rumbo(&bench, &["list", "robots", "kit_elegoo_v3"]));
    assert_eq!(
        listed,
        std::fs::read_to_string(bench.join("elegoo.toml")).unwrap()
    );
}

#[test]
fn a_new_robot_s_pins_that_cannot_do_what_they_are_for_are_noted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().to_path_buf();
    let pins = "--pins=left_enable=4,left_forward=7,right_enable=9,right_forward=8,servo=11,left_encoder=12";
    let new = ["new", "robot", "car", "--board=uno", "--driver=l298n", pins];
    let unable = rumbo(&folder, &new);
    assert!(unable.status.success(), "{}", stderr(&unable));
    let notes = stderr(&unable);
    for note in [
        "left_enable = 4: no PWM on that pin",
        "right_enable = 9: no PWM there while the Servo library",
        "left_encoder = 12: attachInterrupt() has none on that pin, only on 2, 3",
    ] {
        assert!(notes.contains(note), "{notes}");
    }
    let said = stdout(&unable);
    assert!(said.contains("a turn of a wheel gives 40 edges"), "{said}");
}

#[test]
fn a_sonar_with_one_line_for_trigger_and_echo_measures() {
    let sketch = &ino("one_line");
    let Some(bench) = bench("one_line") else {
        return;
    };
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let run = [
        "run", "mode1", "--robot", "kit_mbot", "--sketch", "car.ino", "--out", "out",
    ];
    rumbo(&bench, &run);
    let said = std::fs::read_to_string(bench.join("out/mode1-1-usart0.txt")).unwrap();
    let read: Vec<i64> = said
        .lines()
        .filter_map(|line| line.trim().parse().ok())
        .collect();
    let mut sorted = read.clone();
    sorted.sort_unstable();
    // 1.20 m from the axis to the wall, 11 cm of it before the sonar.
    assert!(
        sorted.len() > 20 && (104..114).contains(&sorted[sorted.len() / 2]),
        "{said}"
    );
}

#[test]
fn a_button_starts_the_robot_a_knob_sets_its_speed_and_a_buzzer_sounds() {
    let sketch = &ino("parts");
    let parts = "left_enable = 5\nleft_forward = 7\nparts.start = { button = 8 }\nparts.speed = { potentiometer = \"A0\" }\n\
                 parts.go = { switch = 4, to = \"5v\" }\nparts.horn = { buzzer = 11 }\nparts.lamp = { led = 12 }\n";
    let Some(bench) = kit("parts", parts, sketch) else {
        return;
    };
    let speed = |presses: &[&str]| {
        let presses: Vec<&str> = presses
            .iter()
            .flat_map(|press| ["--press", press])
            .collect();
        let run = drive(&bench, &presses);
        assert!(run.status.success(), "{}", stderr(&run));
        last(&bench, "left_rad_s")
    };
    assert_eq!(speed(&[]), 0.0, "it waits for its button");
    assert_eq!(speed(&["start@0.5"]), 0.0, "and for its switch");
    let half = speed(&["start@0.5", "go=1@0.6"]);
    let full = speed(&["start@0.5", "go=1@0.6", "speed=1@0.7"]);
    assert!(half > 2.0 && full > 1.2 * half, "{half} {full}");
    is_repeated(&bench);
    let export = rumbo(&bench, &["export", "out/floor-1.mcap", "--format", "csv"]);
    assert!(export.status.success(), "{}", stderr(&export));
    let csv = std::fs::read_to_string(bench.join("floor-1.instruments.csv")).unwrap();
    let header: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let row: Vec<&str> = csv.lines().last().unwrap().split(',').collect();
    let value = |name: &str| -> f64 {
        let at = header.iter().position(|each| *each == name);
        row[at.unwrap_or_else(|| panic!("{header:?}"))]
            .parse()
            .unwrap()
    };
    assert!(
        (value("horn_hz") - 440.0).abs() < 20.0,
        "{}",
        value("horn_hz")
    );
    assert_eq!(value("pin_lamp_led"), 1.0);
    // The same in the scenario.
    let scenario = std::fs::read_to_string(bench.join("floor.toml")).unwrap();
    let pressed = "[[command]]\nat_s = 0.5\npress = \"start\"\n[[command]]\nat_s = 0.6\npress = \"go\"\nto = 1\n";
    std::fs::write(bench.join("floor.toml"), format!("{scenario}{pressed}")).unwrap();
    assert_eq!(speed(&[]), half);
    let unknown = stderr(&drive(&bench, &["--press", "begin@1"]));
    assert!(
        unknown.contains("`begin` is to be pressed") && unknown.contains("there are"),
        "{unknown}"
    );
}

#[test]
fn line_followers_keep_to_their_line_with_levels_and_with_voltages() {
    for (robot, sketch) in [
        ("kit_elegoo_v3", "line_levels"),
        ("kit_elegoo_v4", "line_voltages"),
    ] {
        let Some(bench) = bench(&format!("line_{robot}")) else {
            return;
        };
        std::fs::write(bench.join("car.ino"), ino(sketch)).unwrap();
        let scenario = format!(
            "title = \"A loop\"\nrobot = \"{robot}\"\nworld = \"line_loop\"\nduration_s = 25\n"
        );
        std::fs::write(bench.join("floor.toml"), scenario).unwrap();
        let run = drive(&bench, &["--json"]);
        let result: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
        let metric = |name: &str| result["metrics"][name].as_f64().unwrap_or(f64::NAN);
        assert!(
            metric("line_rms_m") < 0.02,
            "{robot} {result}{}",
            stderr(&run)
        );
        assert!(
            metric("path_m") > 1.5 && metric("line_lost_share") == 0.0,
            "{robot} {result}"
        );
    }
}

#[test]
fn a_follower_is_calibrated_by_hand_over_its_line_and_put_on_it() {
    let Some(bench) = bench("by_hand") else {
        return;
    };
    let sketch = &ino("calibrated");
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let head =
        "title = \"By hand\"\nrobot = \"kit_elegoo_v4\"\nworld = \"line_loop\"\nduration_s = 8\n";
    let hand = "[[command]]\nat_s = 0.5\nplace = [0.2, 0.12]\n[[command]]\nat_s = 1\nplace = [0.2, 0.08]\n\
                [[command]]\nat_s = 2\nplace = [0.3, 0.1, 10]\n";
    let ways = |scenario: String, more: &[&str]| {
        std::fs::write(bench.join("floor.toml"), scenario).unwrap();
        let run = drive(&bench, &[&["--json"], more].concat());
        let result: serde_json::Value =
            serde_json::from_str(&stdout(&run)).unwrap_or_else(|_| panic!("{}", stderr(&run)));
        let metric = |name: &str| result["metrics"][name].as_f64().unwrap_or(0.0);
        [metric("line_way_m"), metric("line_lost_share")]
    };
    let own = ways(head.to_owned(), &[]);
    assert!(own[0] < 0.2, "nobody has calibrated it: {own:?}");
    let by_scenario = ways(head.to_owned() + hand, &[]);
    assert!(
        by_scenario[0] > 0.5 && by_scenario[1] == 0.0,
        "{by_scenario:?}"
    );
    let options = "--place 0.2,0.12@0.5 --place 0.2,0.08@1 --place 0.3,0.1,10@2";
    let options: Vec<&str> = options.split(' ').collect();
    assert_eq!(ways(head.to_owned(), &options), by_scenario);
}

#[test]
fn the_model_line_follower_goes_once_around_within_1_cm_of_the_line_with_every_drawn_robot() {
    let Some(bench) = bench("line_model") else {
        return;
    };
    let assignment = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/assignments/line");
    let [scenario, model] = ["scenario.toml", "model"].map(|name| assignment.join(name));
    let runs = if is_full() { "100" } else { "4" };
    let [scenario, model] = [&scenario, &model].map(|path| path.to_str().unwrap());
    let run = rumbo(
        &bench,
        &[
            "run",
            scenario,
            "--sketch",
            model,
            "--runs",
            runs,
            "--no-record",
            "--json",
        ],
    );
    let results = stdout(&run);
    assert_eq!(
        results.lines().count().to_string(),
        runs,
        "{}",
        stderr(&run)
    );
    for result in results.lines() {
        let result: serde_json::Value = serde_json::from_str(result).unwrap();
        let metric = |name: &str| result["metrics"][name].as_f64().unwrap();
        let (rms_m, way_m) = (metric("line_rms_m"), metric("line_way_m"));
        assert!(
            rms_m < 0.01 && way_m > 5.14,
            "seed {}: {rms_m} m, {way_m} m",
            result["seed"]
        );
    }
}

#[test]
fn a_sketch_begun_like_an_example_says_how_to_drive_it_and_does() {
    let Some(bench) = bench("like_line") else {
        return;
    };
    let begun = stdout(&rumbo(
        &bench,
        &["new", "sketch", "my_line", "--like", "line"],
    ));
    let command = "rumbo run free --robot kit_elegoo_v3 --world line_loop --sketch my_line";
    assert!(begun.contains(command), "{begun}");
    let args: Vec<&str> = command
        .split(' ')
        .skip(1)
        .chain(["--json", "--no-record"])
        .collect();
    let run = rumbo(&bench, &args);
    let result: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    let metric = |name: &str| result["metrics"][name].as_f64().unwrap();
    assert!(
        metric("line_rms_m") < 0.01 && metric("line_way_m") > 0.5,
        "{result}"
    );
}

#[test]
fn a_new_robot_has_line_sensors_buttons_and_lights_by_names_of_its_own() {
    let Some(bench) = bench("new_accessories") else {
        return;
    };
    let pins = "left_enable=5,left_forward=7,left_backward=8,right_enable=6,right_forward=11,right_backward=9,\
                line_left=2,line_middle=4,line_right=A0,";
    // A level, or the time for which a charged pin stays high.
    for (kind, is_dark) in [
        ("line_dark=low", "!digitalRead(pin)"),
        ("line_rc=true", "lasts_us(pin) > 1000"),
    ] {
        let made = rumbo(
            &bench,
            &[
                "new",
                "robot",
                "car",
                "--board",
                "uno",
                "--driver",
                "l298n",
                "--pins",
                &format!("{pins}{kind}"),
                "--parts",
                "start=button:12,lamp=led:13",
            ],
        );
        assert!(made.status.success(), "{}", stderr(&made));
        let sketch = ino("accessories").replace("IS_DARK", is_dark);
        std::fs::write(bench.join("car.ino"), sketch).unwrap();
        let args = "run free --robot car.toml --world line_loop --sketch car.ino --press start@0.5 --json --no-record";
        let args: Vec<&str> = args.split(' ').collect();
        let run = rumbo(&bench, &args);
        let result: serde_json::Value =
            serde_json::from_str(&stdout(&run)).unwrap_or_else(|_| panic!("{}", stderr(&run)));
        let metric = |name: &str| result["metrics"][name].as_f64().unwrap();
        assert!(
            metric("line_way_m") > 0.5 && metric("line_rms_m") < 0.02,
            "{kind} {result}"
        );
        std::fs::remove_file(bench.join("car.toml")).unwrap();
    }
}

#[test]
fn a_program_that_begins_again_and_again_is_told_why() {
    let by_new = "#include <new.h>\nstruct Part { int a, b; };\nPart *volatile part;\n\
                  void setup() { part = new Part; }\nvoid loop() { }\n";
    let by_interrupt = "void setup() { TCCR2B = 1; TIMSK2 = 1; }\nvoid loop() { }\n";
    for (name, sketch, why) in [
        (
            "restart_new",
            by_new,
            "in main: a function that is not there was called",
        ),
        (
            "restart_interrupt",
            by_interrupt,
            ": an interrupt was on that no function handles",
        ),
    ] {
        let Some(bench) = kit(name, LETTERS_WIRING, sketch) else {
            return;
        };
        let said = stdout(&drive(&bench, &[]));
        assert!(
            said.contains("it restarted") && said.contains(why),
            "{said}"
        );
    }
}
