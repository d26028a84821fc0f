//! Sensors of distance by light and compasses on the two-wire bus, and a display of letters on pins, driven by sketches that
//! write to their registers and lines.

use super::devices::{DRIVES, shown};
use super::kits::{drive, is_repeated, kit, last};
use super::sketch::{ino, rumbo};
use crate::support::{stderr, stdout};
use std::path::{Path, PathBuf};

/// A sketch that reads and writes registers of devices.
fn on_bus(name: &str) -> String {
    ["bus", "registers", name].map(ino).concat()
}

/// Walls 0.8 m ahead and 0.5 m to the left of the start.
const WALLS: &str = "title = \"A corner\"\n[arena]\nfrom_m = [-1, -1]\nto_m = [1, 1]\n[[wall]]\nfrom_m = [0.8, -1]\n\
                     to_m = [0.8, 1]\n[[wall]]\nfrom_m = [-1, 0.5]\nto_m = [0.8, 0.5]\n";

/// Puts the robot into another world.
fn into_world(bench: &Path, world: &str) {
    std::fs::write(bench.join("here.toml"), world).unwrap();
    let scenario = std::fs::read_to_string(bench.join("floor.toml")).unwrap();
    let scenario = scenario.replace("world = \"open\"", "world = \"here.toml\"");
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
}

fn said(bench: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn two_sensors_of_distance_that_xshut_tells_apart_measure_the_walls_before_them() {
    let sketch = on_bus("distance_by_light");
    let wiring = format!(
        "{DRIVES}parts.ahead = {{ vl53l0x = 0x29, x_m = 0.1, xshut = 2 }}\n\
         parts.aside = {{ vl53l0x = 0x29, y_m = 0.05, angle_deg = 90, xshut = 3 }}\n"
    );
    let Some(bench) = kit("light", &wiring, &sketch) else {
        return;
    };
    into_world(&bench, WALLS);
    let run = drive(&bench, &[]);
    let lines = said(&bench);
    assert_eq!(
        lines[..5],
        ["0", "0", "1", "5", "5"],
        "{lines:?}{}",
        stderr(&run)
    );
    let [aside, ahead] = [5, 6].map(|at| lines[at].parse::<f64>().unwrap());
    assert!((aside - 450.0).abs() < 30.0, "{aside}");
    assert!((ahead - 700.0).abs() < 45.0, "{ahead}");
    let told = stdout(&run) + &stderr(&run);
    assert!(
        told.contains("VL53L0X by its data sheet, not identified"),
        "{told}"
    );
    is_repeated(&bench);
    let export = rumbo(&bench, &["export", "out/floor-1.mcap", "--format", "csv"]);
    assert!(export.status.success(), "{}", stderr(&export));
    let csv = std::fs::read_to_string(bench.join("floor-1.instruments.csv")).unwrap();
    assert!(
        csv.lines().next().unwrap().contains("ahead_range_m"),
        "{csv}"
    );
    // Both at once answer as one, and a run says so.
    let sketch = sketch.replace("pinMode(2, OUTPUT); pinMode(3, OUTPUT);", "");
    std::fs::write(
        bench.join("car.ino"),
        sketch.replace("pinMode(3, INPUT)", "put(0x30, 0x8A, 0x29)"),
    )
    .unwrap();
    let run = drive(&bench, &[]);
    let told = stdout(&run) + &stderr(&run);
    assert!(told.contains("several answer at once at 0x29"), "{told}");
}

#[test]
fn a_sensor_of_distance_on_the_servo_looks_where_that_points() {
    let wiring = format!("{DRIVES}servo = 10\nparts.eye = {{ vl53l0x = 0x29, on_servo = true }}\n");
    let Some(bench) = kit("eye", &wiring, &on_bus("eye")) else {
        return;
    };
    into_world(&bench, WALLS);
    let run = drive(&bench, &[]);
    let read = said(&bench);
    let read: Vec<f64> = read.iter().map(|line| line.parse().unwrap()).collect();
    let [ahead, left, right] = read[..] else {
        panic!("{read:?}{}", stderr(&run))
    };
    assert!((ahead - 800.0).abs() < 110.0, "{read:?}");
    assert!((left - 500.0).abs() < 80.0, "{read:?}");
    assert_eq!(right, 8190.0);
}

fn with_compasses(name: &str, more: &str) -> Option<PathBuf> {
    let wiring = format!(
        "{DRIVES}parts.q = {{ qmc5883l = 0x0d{more} }}\nparts.h = {{ hmc5883l = 0x1e{more} }}\n"
    );
    kit(name, &wiring, &on_bus("compasses"))
}

#[test]
fn compasses_turn_with_the_robot_against_the_north_of_the_world() {
    let Some(bench) = with_compasses("compass", "") else {
        return;
    };
    let off = |azimuth: f64, expected: f64| ((azimuth - expected + 540.0) % 360.0 - 180.0).abs();
    for north_deg in [90.0, -30.0] {
        let north = match north_deg {
            90.0 => String::new(),
            other => format!("north_deg = {other}\n"),
        };
        into_world(&bench, &(north + WALLS));
        let run = drive(&bench, &[]);
        let read: Vec<f64> = said(&bench)
            .iter()
            .map(|line| line.parse().unwrap())
            .collect();
        let turned = last(&bench, "heading_rad").to_degrees();
        assert!(turned.abs() > 30.0, "{turned}{}", stderr(&run));
        for (at, heading) in [0.0, 0.0, turned, turned].into_iter().enumerate() {
            let expected = north_deg - heading;
            assert!(off(read[at], expected) < 6.0, "{read:?} {expected}");
        }
        let told = stdout(&run) + &stderr(&run);
        assert!(
            told.contains("compass: QMC5883L and HMC5883L by their data sheets"),
            "{told}"
        );
    }
}

#[test]
fn iron_of_the_robot_draws_a_compass_to_it() {
    let Some(bench) = with_compasses("iron", ", iron_x_ut = 25, axes = \"backward right up\"")
    else {
        return;
    };
    drive(&bench, &[]);
    // East is ahead, and as much of the robot's own field as of the Earth's: half way, seen from behind.
    for line in &said(&bench)[..2] {
        let azimuth: f64 = line.parse().unwrap();
        assert!((azimuth - 225.0).abs() < 6.0, "{azimuth}");
    }
}

#[test]
fn a_display_on_six_pins_shows_what_is_written_to_its_lines() {
    let lines = "rs = 2, e = 3, d4 = 4, d5 = 9, d6 = 10, d7 = 13";
    let wiring = format!("{DRIVES}parts.text = {{ hd44780 = {{ {lines} }} }}\n");
    let Some(bench) = kit("on_pins", &wiring, &ino("on_pins")) else {
        return;
    };
    let run = drive(&bench, &[]);
    let content = shown(&bench, "text").pop().unwrap();
    let rows = ["on pins", "   !"].map(|row| format!("{row:16}"));
    assert_eq!(content["rows"], serde_json::json!(rows), "{}", stderr(&run));
    assert_eq!(content["light"], true);
}

#[test]
fn a_new_robot_takes_sensors_of_the_bus_with_their_places_and_a_display_with_its_pins() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().to_path_buf();
    let new = [
        "new",
        "robot",
        "car",
        "--board",
        "nano",
        "--driver",
        "l298n-jumpers",
        "--pins",
        "left_forward=5,left_backward=6,right_forward=9,right_backward=10",
        "--parts",
        "tof=vl53l0x:0x29:7,north=qmc5883l:0x0d,text=hd44780:12:11:4:3:2:A0:20x4",
        "--sensors",
        "tof=0.1:0.02:30",
    ];
    let made = rumbo(&folder, &new);
    assert!(made.status.success(), "{}", stderr(&made));
    let text = std::fs::read_to_string(folder.join("car.toml")).unwrap();
    for part in [
        "parts.tof = { vl53l0x = 0x29, xshut = 7, x_m = 0.1, y_m = 0.02, angle_deg = 30 }",
        "parts.north = { qmc5883l = 0x0d }",
        "parts.text = { hd44780 = { rs = 12, e = 11, d4 = 4, d5 = 3, d6 = 2, d7 = \"A0\" }, size = \"20x4\" }",
    ] {
        assert!(text.contains(part), "{text}");
    }
}
