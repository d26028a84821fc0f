//! Infrared sensors for obstacles, and what else people's robots have that a new robot's options say.

use super::sketch::{bench, ino, rumbo};
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
    let world = ["--world", "wall_front"];
    let free = [
        "run",
        "free",
        "--sketch",
        "car.ino",
        "--json",
        "--no-record",
        "--robot",
    ];
    let world = if more.contains(&"--world") {
        &[][..]
    } else {
        &world
    };
    let run = rumbo(bench, &[&free, &[robot][..], world, more].concat());
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
    let far = pins("sharp_front=A0,sharp_model=gp2y0a02");
    new(&bench, "far", "l9110s", &[&far, "--battery=7.4"]);
    // One that is high, beside one that looks back, as its name says.
    let both = pins("obstacle_front=A0,obstacle_rear=A1,obstacle_seen=high,obstacle_reach_m=0.3");
    new(&bench, "high", "l9110s", &[&both, "--battery=7.4"]);
    // 15 cm, and 30 cm: 0.92 V, 1.66 V.
    for (robot, seen) in [
        ("switch.toml", "digitalRead(A0) == LOW"),
        ("sharp.toml", "analogRead(A0) > 188"),
        ("far.toml", "analogRead(A0) > 340"),
        (
            "high.toml",
            "digitalRead(A0) == HIGH || digitalRead(A1) == HIGH",
        ),
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
fn a_maxsonar_that_nobody_triggers_sees_the_wall_in_time_unless_it_is_stopped() {
    let Some(bench) = bench("maxsonar") else {
        return;
    };
    let motors = "left_forward=5,left_backward=6,right_forward=9,right_backward=10";
    // 16 inches: 2352 us, 32 counts of the converter.
    let pulse =
        "([] { unsigned long us = pulseIn(7, HIGH, 60000); return us != 0 && us <= 2352; })()";
    for (name, sensor, seen) in [
        ("pulse", "maxsonar_front=7,maxsonar_rx=8", pulse),
        ("voltage", "maxsonar_front=A0", "analogRead(A0) <= 32"),
    ] {
        let pins = format!("--pins={motors},{sensor}");
        new(&bench, name, "l9110s", &[&pins, "--battery=7.4"]);
        let (metrics, said) = run(&bench, &format!("{name}.toml"), &until(seen), &[]);
        assert_eq!(metrics["contacts"], 0.0, "{said}");
        assert!(metrics["path_m"].as_f64().unwrap() > 0.3, "{said}");
        assert!(said.contains("range finders: LV-MaxSonar-EZ1 by"), "{said}");
    }
    // Its RX is low, so that it measures nothing.
    let stopped = until(pulse).replace("void setup() {", "void setup() { pinMode(8, OUTPUT);");
    let (metrics, said) = run(&bench, "pulse.toml", &stopped, &[]);
    assert!(metrics["contacts"].as_f64().unwrap() > 0.0, "{said}");
    let alone = format!("--pins={motors},front_echo=7");
    let refused = rumbo(
        &bench,
        &[
            "new",
            "robot",
            "alone",
            "--board=uno",
            "--driver=l9110s",
            &alone,
        ],
    );
    assert_eq!(refused.status.code(), Some(2));
    let said = stderr(&refused);
    assert!(
        said.contains("--pins front_echo=7: nothing triggers that sonar: give front_trigger too"),
        "{said}"
    );
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

#[test]
fn an_echo_that_the_program_drives_itself_is_named() {
    let Some(bench) = bench("own_echo") else {
        return;
    };
    let pins = "--pins=left_forward=5,left_backward=6,right_forward=9,right_backward=10,front_trigger=2,front_echo=3";
    new(&bench, "own", "bts7960-jumpers", &[pins]);
    let sketch = &ino("own_echo");
    let named = "front_echo: pin 3 is an output of the program";
    let (metrics, said) = run(&bench, "own.toml", &sketch.replace("MODE", "OUTPUT"), &[]);
    assert_eq!(metrics["path_m"], Value::Null, "{said}");
    assert!(said.contains(named), "{said}");
    let (metrics, said) = run(&bench, "own.toml", &sketch.replace("MODE", "INPUT"), &[]);
    assert!(metrics["path_m"].as_f64().unwrap() > 0.3, "{said}");
    assert!(!said.contains(named), "{said}");
}

#[test]
fn a_pair_of_sonars_and_what_was_measured_are_options_of_a_new_robot() {
    let Some(bench) = bench("measured") else {
        return;
    };
    let motors = "--pins=left_forward=5,left_backward=6,right_forward=9,right_backward=10";
    let pins = format!(
        "{motors},left_encoder=2,right_encoder=3,left_trigger=4,left_echo=A0,right_trigger=7,right_echo=A1"
    );
    let more = [
        &pins[..],
        "--sensors=left=0.08:0.07:90,right=-0.04:0.07:90",
        "--base=0.2",
        "--wheel=0.08",
        "--edges=748",
    ];
    new(&bench, "own", "bts7960-jumpers", &more);
    // A turn of the left wheel along a wall on the left, which both see.
    let sketch = &ino("along_a_wall");
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let run = rumbo(
        &bench,
        &[
            "run",
            "free",
            "--world",
            "wall_side",
            "--robot",
            "own.toml",
            "--sketch",
            "car.ino",
            "--json",
            "--no-record",
        ],
    );
    let result: Value = serde_json::from_str(&stdout(&run)).unwrap_or_default();
    let path_m = result["metrics"]["path_m"].as_f64();
    assert!(
        path_m.is_some_and(|path_m| (0.24..0.4).contains(&path_m)),
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    let servos = ["--pins=left_servo=5,right_servo=6", "--wheels=4"];
    new(&bench, "servos", "continuous-servos", &servos);
    let text = std::fs::read_to_string(bench.join("servos.toml")).unwrap();
    assert!(
        text.contains("scrub_n_m") && text.contains("gear_ratio = 250\n"),
        "{text}"
    );
}

#[test]
fn gears_of_metal_a_battery_s_divider_and_a_starter_kit_s_remote_are_options() {
    let Some(bench) = bench("metal") else {
        return;
    };
    let pins = "--pins=left_forward=5,left_backward=6,right_forward=9,right_backward=10,battery=A0,battery_ratio=4";
    let remote = "--parts=remote=infrared:2:starter";
    new(
        &bench,
        "metal",
        "bts7960-jumpers",
        &[pins, remote, "--motor=25d"],
    );
    let own = ["--motor=tt", "--battery=12"];
    new(
        &bench,
        "yellow",
        "bts7960-jumpers",
        &[&[pins, remote], &own[..]].concat(),
    );
    // Drives by a PWM of 20 while 12 V, divided by 4, are at A0, and for a moment by more.
    let sketch = &ino("weak");
    let press = ["--press", "remote=power@1"];
    let (metrics, said) = run(&bench, "metal.toml", sketch, &press);
    assert!(metrics["path_m"].as_f64().unwrap() > 0.1, "{said}");
    assert!(!said.contains("no wheel turned"), "{said}");
    let (_, said) = run(&bench, "yellow.toml", sketch, &press);
    assert!(
        said.contains("by a PWM of at most 21 of 255, and no wheel turned"),
        "{said}"
    );
    // One input high, the other by PWM: what is left of it stirs the wheels and turns none.
    new(&bench, "braked", "l298n-jumpers", &[pins]);
    let sketch = &ino("braked");
    let (_, said) = run(&bench, "braked.toml", sketch, &[]);
    assert!(said.contains("of 255, and no wheel turned"), "{said}");
}

#[test]
fn a_line_that_is_lost_is_told_with_the_speed() {
    let Some(bench) = bench("lost_line") else {
        return;
    };
    let pins = "--pins=left_forward=5,left_backward=6,right_forward=9,right_backward=10,line_left=2,line_right=3,\
                line_rear=4,line_pitch_m=0.03,obstacle_back_left=7,obstacle_back_right=8";
    new(&bench, "own", "l9110s", &[pins, "--battery=7.4"]);
    let text = std::fs::read_to_string(bench.join("own.toml")).unwrap();
    for place in [
        "left = { pin = 2, x_m = 0.09, y_m = 0.0150 }",
        "rear = { pin = 4, x_m = -0.08, y_m = 0.0000 }",
        "back_left = { pin = 7, x_m = -0.08, y_m = 0.0250, angle_deg = 165 }",
        "back_right = { pin = 8, x_m = -0.08, y_m = -0.0250, angle_deg = -165 }",
    ] {
        assert!(text.contains(place), "{text}");
    }
    let run = |more: &[&str]| {
        let all = [&["--world", "line_loop"], more].concat();
        run(&bench, "own.toml", &until("false"), &all)
    };
    let (metrics, said) = run(&["--duration", "6"]);
    assert!(metrics["line_lost_share"].as_f64().unwrap() > 0.2, "{said}");
    assert!(
        said.contains("it lost its line at ") && said.contains(" m/s; if yours is slower"),
        "{said}"
    );
    let (_, said) = run(&["--duration", "1.5"]);
    assert!(!said.contains("it lost its line"), "{said}");
    let late = run(&["--duration", "5", "--usb", "x@5"]).1;
    assert!(
        late.contains("lasts 5 s") && late.contains("--duration"),
        "{late}"
    );
}
