//! Infrared sensors for obstacles, and what else people's robots have that a new robot's options say.

use super::sketch::{bench, rumbo};
use crate::support::{stderr, stdout};
use serde_json::Value;
use std::path::PathBuf;

/// Drives until something is seen.
fn until(seen: &str) -> String {
    format!(
        "const byte pins[] = {{5, 6, 9, 10}};\nvoid setup() {{ for (byte pin : pins) pinMode(pin, OUTPUT); }}\n\
         void loop() {{ bool drives = !({seen}); analogWrite(5, drives ? 120 : 0); analogWrite(9, drives ? 120 : 0); }}\n"
    )
}

fn new(bench: &PathBuf, name: &str, driver: &str, more: &[&str]) {
    let of = ["new", "robot", name, "--board", "uno", "--driver", driver];
    let made = rumbo(bench, &[&of, more].concat());
    assert!(made.status.success(), "{}", stderr(&made));
}

/// The metrics of a run of a robot with a sketch, and what it noted.
fn run(bench: &PathBuf, robot: &str, sketch: &str, more: &[&str]) -> (Value, String) {
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let free = [
        "run",
        "free",
        "--world",
        "wall_front",
        "--sketch",
        "car.ino",
        "--json",
        "--no-record",
        "--robot",
    ];
    let run = rumbo(bench, &[&free, &[robot][..], more].concat());
    let result: Value = serde_json::from_str(&stdout(&run)).unwrap_or_default();
    (result["metrics"].clone(), stdout(&run) + &stderr(&run))
}

#[test]
fn a_switch_and_a_sharp_see_the_wall_in_time() {
    let Some(bench) = bench("obstacles") else {
        return;
    };
    let pins = |sensor: &str| {
        format!("--pins=left_forward=5,left_backward=6,right_forward=9,right_backward=10,{sensor}")
    };
    new(
        &bench,
        "switch",
        "l9110s",
        &[&pins("obstacle_front=A0"), "--battery=7.4"],
    );
    new(
        &bench,
        "sharp",
        "l9110s",
        &[&pins("sharp_front=A0"), "--battery=7.4"],
    );
    // 15 cm, and 30 cm: 0.92 V.
    for (robot, seen) in [
        ("switch.toml", "digitalRead(A0) == LOW"),
        ("sharp.toml", "analogRead(A0) > 188"),
    ] {
        let (metrics, said) = run(&bench, robot, &until(seen), &[]);
        assert_eq!(metrics["contacts"], 0.0, "{said}");
        assert!(metrics["path_m"].as_f64().unwrap() > 0.3, "{said}");
        assert!(said.contains("sensors for obstacles: by what"), "{said}");
    }
    let (metrics, said) = run(&bench, "switch.toml", &until("false"), &[]);
    assert!(metrics["contacts"].as_f64().unwrap() > 0.0, "{said}");
}

#[test]
fn a_button_to_the_supply_and_a_car_s_remote_are_options_of_a_new_robot() {
    let Some(bench) = bench("options") else {
        return;
    };
    let pins = "--pins=left_forward=5,left_backward=6,right_forward=9,right_backward=10";
    new(
        &bench,
        "own",
        "bts7960-jumpers",
        &[pins, "--parts=go=button:2:5v,remote=infrared:3:car"],
    );
    new(
        &bench,
        "floating",
        "bts7960-jumpers",
        &[pins, "--parts=go=button:2"],
    );
    let sketch = "bool on;\n".to_owned() + &until("on = on || digitalRead(2) == HIGH, !on");
    let press = ["--press", "go@1"];
    let (metrics, said) = run(&bench, "own.toml", &sketch, &press);
    assert!(metrics["path_m"].as_f64().unwrap() > 0.3, "{said}");
    let text = std::fs::read_to_string(bench.join("own.toml")).unwrap();
    assert!(text.contains("{ infrared = 3, keys = \"car\" }"), "{text}");
    let (metrics, said) = run(&bench, "floating.toml", &sketch, &press);
    assert_eq!(metrics["path_m"], Value::Null, "{said}");
    assert!(
        said.contains("go on pin 2 closes to GND, and the program switches no pull-up on"),
        "{said}"
    );
}
