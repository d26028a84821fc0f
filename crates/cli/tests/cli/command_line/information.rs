//! Information from the command: help, lists, the address of the lab.

use crate::support::{Running, program, rumbo, stderr, stdout};
use std::process::Stdio;

#[test]
fn every_subcommand_shows_an_example_in_its_help() {
    for subcommand in [
        "lab", "run", "identify", "import", "list", "connect", "replay", "export", "compare",
        "rerun", "flash",
    ] {
        let help = stdout(&rumbo(&[subcommand, "--help"]));
        let (_, examples) = help.split_once("Examples:").unwrap();
        assert!(examples.contains(&format!("rumbo {subcommand}")), "{help}");
    }
}

#[test]
fn list_names_what_there_is() {
    let all = stdout(&rumbo(&["list"]));
    for name in [
        "mode1",
        "obstacles",
        "memoria",
        "front_distance",
        "wall_uno",
    ] {
        assert!(all.contains(name), "{name} is not in\n{all}");
    }
    let widest = all.lines().map(|line| line.chars().count()).max();
    assert!(
        all.lines().count() <= 35 && widest <= Some(100),
        "more than a screen:\n{all}"
    );
    let policies = stdout(&rumbo(&["list", "policies"]));
    assert!(
        policies.contains("\n  goal  Goals among boxes"),
        "{policies}"
    );
    let scenarios = stdout(&rumbo(&["list", "scenarios"]));
    let (_, movements) = scenarios.split_once("\nMovements\n").unwrap();
    assert!(movements.contains("manual-turn-left"), "{scenarios}");
    assert!(
        scenarios.contains("\nMode 1: front distance\n  mode1 "),
        "{scenarios}"
    );
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&rumbo(&["list", "robots", "--json"]))).unwrap();
    assert_eq!(json["robots"][0]["name"], "memoria");
    assert!(
        json["robots"][0]["rigs"]
            .as_array()
            .unwrap()
            .contains(&"front_single".into())
    );
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&rumbo(&["list", "modes", "--json"]))).unwrap();
    let modes = json["modes"].as_array().unwrap();
    assert_eq!(modes.len(), 11);
    for mode in modes {
        assert!(!mode["help"].as_str().unwrap().is_empty(), "{mode}");
        assert!(!mode["states"].as_array().unwrap().is_empty(), "{mode}");
    }
    let reference = serde_json::json!(
        {"what": "distance", "unit": "cm", "min": 5.0, "max": 200.0, "commanded": true});
    assert_eq!(modes[1]["reference"], reference);
    assert_eq!(
        modes[1]["rigs"],
        serde_json::json!(["front_single", "final"])
    );
    assert_eq!(
        modes[1]["parameters"][0]["parameters"][0],
        "front_cruise_m_s"
    );
    let modes = stdout(&rumbo(&["list", "modes"]));
    assert!(modes.contains("distance 5..200 cm"), "{modes}");
    assert!(modes.contains("rigs: front_single, final"), "{modes}");
    let parameters = stdout(&rumbo(&["list", "parameters"]));
    let line = parameters
        .lines()
        .find(|line| line.contains("waypoint_tracker"));
    assert!(
        line.is_some_and(|line| line.contains("choice") && line.ends_with("straight, pure_pursuit")),
        "{line:?}"
    );
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&rumbo(&["list", "parameters", "--json"]))).unwrap();
    let parameters = json["parameters"].as_array().unwrap();
    let find = |name: &str| parameters.iter().find(|each| each["name"] == name).unwrap();
    assert_eq!(find("mission_reset_origin")["type"], "switch");
    assert_eq!(find("rig")["choices"][4], "final");
    assert_eq!(find("rig")["modes"], serde_json::json!([]));
    assert_eq!(
        find("wall_kp")["modes"],
        serde_json::json!(["wall_hold", "wall_follow"])
    );
    let rigs = stdout(&rumbo(&["list", "rigs"]));
    assert!(rigs.contains("front looks ahead, on the servo"), "{rigs}");
}

#[test]
fn the_lab_reports_a_taken_port_and_prints_its_address_otherwise() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let output = rumbo(&["lab", "--no-browser", "--port", &port]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains(&format!("port {port} on 127.0.0.1 is in use")),
        "{}",
        stderr(&output)
    );

    let lab = Running::of(program().args(["--no-browser", "--port", "0"]));
    let address = &lab.said;
    assert!(address.starts_with("http://127.0.0.1:"), "{address}");
}

#[test]
fn a_reader_who_stops_reading_ends_the_command_quietly() {
    let mut child = program()
        .args(["list", "plant"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(
        (stderr(&output).as_str(), output.status.code()),
        ("", Some(0))
    );
}
