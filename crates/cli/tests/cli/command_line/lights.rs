//! Light sensors of people's robots, in worlds with lamps.

use super::sketch::{bench, rumbo};
use crate::support::{stderr, stdout};
use serde_json::Value;
use std::path::PathBuf;

/// An L298N: left wheel enable 5, forward 7, backward 8; right wheel enable 6, forward 9, backward 10.
const MOTORS: &str =
    "left_enable=5,left_forward=7,left_backward=8,right_enable=6,right_forward=9,right_backward=10";

fn new(bench: &PathBuf, name: &str, pins: &str) -> String {
    let pins = format!("--pins={MOTORS},{pins}");
    let of = ["new", "robot", name, "--board=uno", "--driver=l298n"];
    let made = rumbo(bench, &[&of[..], &["--battery=7.4", &pins]].concat());
    assert!(made.status.success(), "{}", stderr(&made));
    std::fs::read_to_string(bench.join(format!("{name}.toml"))).unwrap()
}

/// The metrics of a run in a world with a lamp, of a robot whose sketch sets `left` and `right`, the wheels' PWM.
fn run(bench: &PathBuf, robot: &str, steer: &str, (start, seed): (&str, &str)) -> (Value, String) {
    let sketch = format!(
        "void setup() {{ for (byte pin = 5; pin <= 10; pin++) pinMode(pin, OUTPUT); digitalWrite(7, HIGH); digitalWrite(9, HIGH); }}\n\
         void loop() {{\n  int left = 0, right = 0;\n  {steer}\n  analogWrite(5, constrain(left, 0, 255)); analogWrite(6, constrain(right, 0, 255));\n\
         \x20 delay(20);\n}}\n"
    );
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let scenario = format!(
        "title = \"To the lamp\"\nrobot = \"memoria\"\nworld = \"lamps\"\nduration_s = 20\n\n[start]\n{start}\n"
    );
    std::fs::write(bench.join("lamp.toml"), scenario).unwrap();
    let words = [
        "run",
        "lamp.toml",
        "--sketch=car.ino",
        "--json",
        "--no-record",
        "--seed",
        seed,
        "--robot",
        robot,
    ];
    let run = rumbo(bench, &words);
    let result: Value = serde_json::from_str(&stdout(&run)).unwrap_or_default();
    (result["metrics"].clone(), stdout(&run) + &stderr(&run))
}

/// Each sensor drives the wheel across, so that it turns to the brighter side, and stands where it is bright.
const BRAITENBERG: &str = "int l = analogRead(A0), r = analogRead(A1);\n  if (max(l, r) < 900) { left = 100 + (r - l); right = 100 + (l - r); }";

#[test]
fn a_light_follower_drives_to_the_lamp_and_stops_there() {
    let Some(bench) = bench("lights") else {
        return;
    };
    let text = new(&bench, "follower", "light_left=A0,light_right=A1");
    assert!(text.contains("[wiring.own.light]"), "{text}");
    // Whether it looks that way or not, the lamp is 2.5 m away.
    for from in [
        ("heading_deg = 20", "1"),
        ("heading_deg = -60", "2"),
        ("heading_deg = 110", "3"),
    ] {
        let (metrics, said) = run(&bench, "follower.toml", BRAITENBERG, from);
        assert!(metrics["lamp_m"].as_f64().unwrap() < 0.5, "{said}");
        assert_eq!(metrics["contacts"], 0.0, "{said}");
        assert!(
            said.contains("light sensors: GL5528 by its data sheet"),
            "{said}"
        );
    }
}

#[test]
fn a_module_is_low_at_the_lamp_and_a_divider_may_be_the_other_way_round() {
    let Some(bench) = bench("light_modules") else {
        return;
    };
    // Straight on to the lamp, until it is so bright.
    for (name, pins, stops) in [
        (
            "module",
            "light_front=4,light_switch_lux=60",
            "digitalRead(4) == LOW",
        ),
        (
            "divider",
            "light_front=A0,light_bright=low,light_rated_kohm=14",
            "analogRead(A0) < 340",
        ),
    ] {
        let text = new(&bench, name, pins);
        assert!(text.contains("angle_deg = 0"), "{text}");
        let steer = format!("if (!({stops})) {{ left = right = 110; }}");
        let (metrics, said) = run(
            &bench,
            &format!("{name}.toml"),
            &steer,
            ("x_m = 0.8\ny_m = 0.9", "1"),
        );
        let lamp_m = metrics["lamp_m"].as_f64().unwrap();
        assert!((0.8..1.3).contains(&lamp_m), "{name} {lamp_m}: {said}");
    }
}
