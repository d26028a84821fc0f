//! Devices on the two-wire bus of a sketch's board, a remote control and a motor shield, driven register by register.

use super::kits::{
    column, drive, driven_by, is_repeated, kit, last, there_and_back, to_and_fro, usb,
};
use super::sketch::{ino, rumbo};
use crate::support::{stderr, stdout};
use std::path::Path;

pub(super) const DRIVES: &str = "left_enable = 5\nleft_forward = 7\nleft_backward = 8\nright_enable = 6\nright_forward = 12\n\
                      right_backward = 11\ndebug_tx = 1\ndebug_rx = 0\n";

/// What a display has shown, one content after the other.
pub(super) fn shown(bench: &Path, name: &str) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(bench.join("out/floor-1-displays.txt")).unwrap();
    let lines = text.lines().filter_map(|line| line.split_once('='));
    lines
        .filter(|(of, _)| *of == name)
        .map(|(_, content)| serde_json::from_str(content).unwrap())
        .collect()
}

#[test]
fn a_sketch_that_integrates_the_gyroscope_knows_how_far_the_robot_has_turned() {
    let wiring = format!("{DRIVES}parts.imu = {{ mpu6050 = 0x68 }}\n");
    let Some(bench) = kit("gyroscope", &wiring, &(ino("bus") + &ino("gyroscope"))) else {
        return;
    };
    let run = drive(&bench, &[]);
    let said = usb(&bench);
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines[..2], ["68", "nobody"], "{said}{}", stderr(&run));
    let turned = last(&bench, "heading_rad").to_degrees();
    let degrees: f64 = lines[2].parse().unwrap();
    assert!(turned > 30.0, "{turned}");
    assert!((degrees / turned - 1.0).abs() < 0.05, "{degrees} {turned}");
    let up: f64 = lines[3].parse().unwrap();
    assert!((up - 1.0).abs() < 0.12 && up != 1.0, "{up}");
    let told = stdout(&run) + &stderr(&run);
    for note in [
        "MPU-6050 by its data sheet, not identified",
        "nobody answers at 0x69 on the two-wire bus: there are imu at 0x68",
    ] {
        assert!(told.contains(note), "{told}");
    }
    is_repeated(&bench);
    let export = rumbo(&bench, &["export", "out/floor-1.mcap", "--format", "csv"]);
    assert!(export.status.success(), "{}", stderr(&export));
    let csv = std::fs::read_to_string(bench.join("floor-1.instruments.csv")).unwrap();
    assert!(
        csv.lines().next().unwrap().contains("imu_yaw_rad_s"),
        "{csv}"
    );
    assert!(!column(&bench, "heading_rad").is_empty());
}

#[test]
fn an_interrupt_comes_with_every_value_of_the_inertial_sensor() {
    let wiring = format!("{DRIVES}parts.imu = {{ mpu6050 = 0x68, interrupt = 2 }}\n");
    let Some(bench) = kit("data_ready", &wiring, &(ino("bus") + &ino("data_ready"))) else {
        return;
    };
    drive(&bench, &[]);
    let said = usb(&bench);
    let count: i64 = said.trim().parse().unwrap();
    assert!((99..=101).contains(&count), "{said}");
}

#[test]
fn a_screen_of_dots_shows_what_a_sketch_draws_and_the_run_says_so() {
    let wiring = format!("{DRIVES}parts.screen = {{ ssd1306 = 0x3c }}\n");
    let Some(bench) = kit("dots", &wiring, &(ino("bus") + &ino("dots"))) else {
        return;
    };
    let run = drive(&bench, &[]);
    let contents = shown(&bench, "screen");
    let dots = |content: &serde_json::Value| content["dots"].as_str().unwrap().to_owned();
    // Columns 8 to 11 of the rows 8 and 15.
    let mut expected = "0".repeat(64 * 32);
    for row in [8, 15] {
        expected.replace_range(row * 32 + 2..row * 32 + 3, "f");
    }
    assert_eq!(dots(contents.last().unwrap()), expected);
    let inverted: String = expected
        .chars()
        .map(|digit| if digit == '0' { 'f' } else { '0' })
        .collect();
    assert!(contents.iter().any(|content| dots(content) == inverted));
    let told = stdout(&run);
    assert!(
        told.contains("screen shows\n") && told.contains("\u{2809}\u{2809}"),
        "{told}{}",
        stderr(&run)
    );
    is_repeated(&bench);
}

#[test]
fn a_display_of_letters_shows_text_and_characters_of_the_sketch_s_own() {
    let wiring = format!("{DRIVES}parts.text = {{ hd44780 = 0x27, size = \"20x4\" }}\n");
    let Some(bench) = kit("letters_shown", &wiring, &(ino("bus") + &ino("text"))) else {
        return;
    };
    let run = drive(&bench, &[]);
    let content = shown(&bench, "text").pop().unwrap();
    let rows = ["Rumbo", "\u{e000}°", "third row", ""].map(|row| format!("{row:20}"));
    assert_eq!(content["rows"], serde_json::json!(rows), "{content}");
    assert_eq!(content["drawn"]["0"], "040e1f0404040000");
    assert_eq!(content["light"], true);
    let told = stdout(&run);
    assert!(told.contains("|Rumbo               |"), "{told}");
    assert!(told.contains("|▯°                  |"), "{told}");
    let tests = "sketch = \"car.ino\"\nscenario = \"floor.toml\"\n[[test]]\nname = \"says where it is\"\n\
                 step = [{ expect = \"third row\", port = \"displays\" }]\n";
    std::fs::write(bench.join("tests.toml"), tests).unwrap();
    let checked = rumbo(&bench, &["check", "tests.toml"]);
    assert!(
        checked.status.success(),
        "{}{}",
        stdout(&checked),
        stderr(&checked)
    );
}

#[test]
fn a_remote_control_drives_the_robot_and_repeats_while_its_key_is_held() {
    let wiring = format!("{DRIVES}parts.remote = {{ infrared = 2 }}\n");
    let Some(bench) = kit("remote", &wiring, &ino("remote")) else {
        return;
    };
    let run = drive(
        &bench,
        &["--press", "remote=up@0.5", "--press", "remote=0@2"],
    );
    let said = || usb(&bench);
    assert_eq!(
        said(),
        "18\nagain\n19\nagain\n",
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    let (way_m, speed) = (last(&bench, "x_m"), last(&bench, "left_rad_s"));
    assert!(way_m > 0.3 && speed.abs() < 0.1, "{way_m} {speed}");
    is_repeated(&bench);
    let tests = "sketch = \"car.ino\"\nscenario = \"floor.toml\"\n[[test]]\nname = \"drives\"\n\
                 step = [{ press = \"remote\", to = \"up\" }, { expect = \"18\" }, { press = \"remote\", to = 5, for_s = 0.5 }, { expect = \"40\" }, \
                 { expect = \"again\" }, { expect = \"again\" }, { expect = \"again\" }]\n";
    std::fs::write(bench.join("tests.toml"), tests).unwrap();
    let checked = rumbo(&bench, &["check", "tests.toml"]);
    assert!(
        checked.status.success(),
        "{}{}",
        stdout(&checked),
        stderr(&checked)
    );
    std::fs::write(bench.join("tests.toml"), tests.replace("up", "walk")).unwrap();
    let refused = stderr(&rumbo(&bench, &["check", "tests.toml"]));
    assert!(refused.contains("and walk none of its keys"), "{refused}");
    let in_vain = stderr(&drive(&bench, &["--command", "F@0.1"]));
    assert!(
        in_vain.contains("the robot has no Bluetooth module"),
        "{in_vain}"
    );
    // Held, by an option and in the scenario.
    let held = || assert_eq!(said(), format!("1C\n{}", "again\n".repeat(5)));
    drive(&bench, &["--press", "remote=ok@1-1.6"]);
    held();
    let scenario = std::fs::read_to_string(bench.join("floor.toml")).unwrap();
    let press = "[[command]]\nat_s = 1\npress = \"remote\"\nto = \"ok\"\nfor_s = 0.6\n";
    std::fs::write(bench.join("floor.toml"), format!("{scenario}{press}")).unwrap();
    drive(&bench, &[]);
    held();
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    for (press, why) in [
        (
            "remote=walk@1",
            "`remote` is a remote control, and walk none of its keys: 1, 2,",
        ),
        ("remote@1", "and on none of its keys"),
        ("remote=up@3-1", "NAME@FROM-TO holds it"),
    ] {
        let refused = drive(&bench, &["--press", press]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(stderr(&refused).contains(why), "{}", stderr(&refused));
    }
}

#[test]
fn a_remote_of_a_car_radio_is_read_by_samples_of_the_line() {
    // As the common library does: a timer looks at the line every 50 us.
    let wiring = "left_enable = 5\nleft_forward = 7\ndebug_tx = 1\ndebug_rx = 0\n\
                  parts.remote = { infrared = 11, keys = 21 }\n";
    let Some(bench) = kit("radio", wiring, &ino("radio")) else {
        return;
    };
    let keys = [
        "--press",
        "remote=ch-@0.5",
        "--press",
        "remote=100+@1",
        "--press",
        "remote=9@1.5",
    ];
    let run = drive(&bench, &keys);
    let said = usb(&bench);
    assert_eq!(
        said,
        "FFA25D\nFF9867\nFF52AD\n",
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    let robot = std::fs::read_to_string(bench.join("robot.toml")).unwrap();
    let with = |keys: &str, options: &[&str]| {
        let robot = robot.replace("keys = 21", keys);
        std::fs::write(bench.join("robot.toml"), robot).unwrap();
        drive(&bench, options)
    };
    // A television's, in the two orders in which libraries give a code; and a command alone.
    let go = ["--press", "remote=go@0.5", "--press", "remote=mute@1"];
    for keys in [
        "keys = { go = 551492580, mute = 0x45 }",
        "raw_keys = { go = 0x27D8FB04, mute = 0xBA45FF00 }",
    ] {
        with(keys, &go);
        let said = usb(&bench);
        assert_eq!(said, "20DF1BE4\nFFA25D\n", "{keys}");
    }
}

#[test]
fn a_motor_shield_drives_the_motors_that_the_wheels_are_on() {
    // M3 and M4, and then the other way.
    let sketch = to_and_fro(
        "4, 5, 6, 7, 8, 12",
        "put(0x21); analogWrite(6, 150); analogWrite(5, 150);",
        "put(0xC0);",
    );
    let sketch = ino("shift") + &sketch;
    let wiring = "left_forward = \"M3\"\nright_forward = \"M4\"\n";
    there_and_back(driven_by("motor-shield", "shield", wiring, &sketch));
    // One motor's wires exchanged: it turns on the spot.
    let wiring = "left_forward = \"M3\"\nright_backward = \"M4\"\n";
    let Some(bench) = driven_by("motor-shield", "shield_turns", wiring, &sketch) else {
        return;
    };
    let run = drive(&bench, &[]);
    let heading = column(&bench, "heading_rad");
    let farthest = heading.iter().copied().fold(0.0, f64::min);
    assert!(farthest < -1.0, "{farthest} {}", stderr(&run));
    // While pin 7 is high nothing moves, and a run says which motor.
    let asleep = sketch.replace("digitalWrite(7, LOW);", "digitalWrite(7, HIGH);");
    std::fs::write(bench.join("car.ino"), asleep).unwrap();
    let run = drive(&bench, &[]);
    let told = stdout(&run) + &stderr(&run);
    assert!(
        told.contains("it never drove the left motor: left_forward of M3"),
        "{told}"
    );
}

#[test]
fn a_new_robot_with_a_motor_shield_has_its_wheels_on_motors() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().to_path_buf();
    let new = [
        "new",
        "robot",
        "car",
        "--board",
        "uno",
        "--driver",
        "motor-shield",
        "--pins",
        "left_forward=M3,right_backward=M4,servo=10,front_trigger=A0,front_echo=A1",
        "--parts",
        "remote=infrared:2:raw:go=0xBA45FF00:100+=7,knob=potentiometer:A2,screen=ssd1306:0x3c",
    ];
    let made = rumbo(&folder, &new);
    assert!(made.status.success(), "{}", stderr(&made));
    let text = std::fs::read_to_string(folder.join("car.toml")).unwrap();
    assert!(
        text.contains(
            "right_backward = \"M4\"   # motor of the right wheel: FORWARD drives it backward"
        ),
        "{text}"
    );
    let parts = "parts.remote = { infrared = 2, raw_keys = { go = 0xBA45FF00, \"100+\" = 7 } }\nparts.knob = { potentiometer = \"A2\" }\nparts.screen = { ssd1306 = 0x3c }\n";
    assert!(text.contains(parts), "{text}");
}

#[test]
fn a_new_robot_on_continuous_servos_drives_at_the_speed_of_their_data_sheet() {
    let Some(bench) = super::sketch::bench("servos") else {
        return;
    };
    let new =
        "new robot car --board uno --driver continuous-servos --pins left_servo=13,right_servo=12";
    let made = rumbo(&bench, &new.split(' ').collect::<Vec<_>>());
    assert!(made.status.success(), "{}", stderr(&made));
    std::fs::write(bench.join("car.ino"), ino("servos")).unwrap();
    let scenario =
        "title = \"On the floor\"\nrobot = \"car.toml\"\nworld = \"open\"\nduration_s = 3\n";
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    let run = drive(&bench, &[]);
    assert!(run.status.success(), "{}", stderr(&run));
    let x_m = column(&bench, "x_m");
    // 50 rpm without a load are 0.17 m/s.
    let speed_m_s = x_m[190] - x_m[90];
    assert!((0.13..0.17).contains(&speed_m_s), "{speed_m_s}");
    assert!((x_m[290] - x_m[240]).abs() < 1e-4);
}

#[test]
fn a_motor_shield_on_the_two_wire_bus_drives_and_turns_as_it_is_told() {
    // M3 and M4: PWM, and the inputs of forward and backward.
    let sketch = ino("bus") + &ino("shield_v2");
    let wiring = "left_forward = \"M3\"\nright_forward = \"M4\"\n";
    there_and_back(driven_by("motor-shield-v2", "shield_v2", wiring, &sketch));
}

#[test]
fn a_car_on_four_wheels_goes_straight_as_one_on_two_and_turns_less() {
    let Some(bench) = super::sketch::bench("four_wheels") else {
        return;
    };
    let sketch = to_and_fro(
        "5, 6, 7, 8, 9, 11",
        "digitalWrite(7, HIGH); digitalWrite(9, HIGH); analogWrite(5, 150); analogWrite(6, 150);",
        "digitalWrite(9, LOW); digitalWrite(11, HIGH);",
    );
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let scenario =
        "title = \"On the floor\"\nrobot = \"car.toml\"\nworld = \"open\"\nduration_s = 3\n";
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    let driven = |wheels: &str| {
        let _ = std::fs::remove_file(bench.join("car.toml"));
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
                "--wheels",
                wheels,
                "--battery",
                "7.4",
                "--pins",
                "left_enable=5,left_forward=7,left_backward=8,right_enable=6,right_forward=9,right_backward=11",
            ],
        );
        assert!(made.status.success(), "{}", stderr(&made));
        let run = drive(&bench, &[]);
        assert!(run.status.success(), "{}", stderr(&run));
        let x_m = column(&bench, "x_m").into_iter().fold(0.0, f64::max);
        let headings = column(&bench, "heading_rad");
        let pairs = headings.windows(2);
        let turned = pairs.map(|pair| {
            let turned = pair[1] - pair[0];
            turned - (turned / std::f64::consts::TAU).round() * std::f64::consts::TAU
        });
        (x_m, turned.sum::<f64>().abs())
    };
    let (two_m, two_turn) = driven("2");
    let (four_m, four_turn) = driven("4");
    assert!((four_m / two_m - 1.0).abs() < 0.4, "{two_m} {four_m}");
    assert!(
        four_turn > 0.5 && four_turn < 0.7 * two_turn,
        "{two_turn} {four_turn}"
    );
}
