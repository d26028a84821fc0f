//! Wrong input: one line with the remedy, and status 2.

use crate::support::{file, rumbo, stderr, stdout};

#[test]
fn wrong_input_gets_one_line_with_the_remedy_and_status_2() {
    file(
        "no_number.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n69,107,1O7,30,1,115,115\n",
    );
    file(
        "too_short.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n\n69,107,107,30,1,115\n",
    );
    file(
        "pwm.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n69,107,107,30,1,115,300\n",
    );
    file(
        "empty.csv",
        "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n",
    );
    file(
        "far.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 1\n[start]\nx_m = -400\n",
    );
    file(
        "typos.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = \"font_distance\"\nduration_s = 9\n[[command]]\nat_s = 2\nreference_m = 0.3\n",
    );
    file(
        "comma.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 0,5\n",
    );
    let cases: [(&[&str], &str); 35] = [
        (
            &["run", "mode1", "--policy", "goal"],
            "error: --policy goal: scenario mode1 drives in mode 1 (front_distance), and only mode 9 (policy) is driven by one; leave --policy out, or choose a scenario of that mode, as mode9-random",
        ),
        (
            &["run", "typos.toml"],
            "error: typos.toml:5: mode = font_distance: unknown mode; did you mean `front_distance` (1)?",
        ),
        (
            &["run", "comma.toml"],
            "error: comma.toml:6: not valid TOML: unexpected key or value, expected newline, `#`; write decimals with a point",
        ),
        (
            &["import", "far.toml"],
            "error: far.toml:1: `title = \"t\"` is neither the beginning of a table nor a line of a capture; `rumbo import --help` shows what is read",
        ),
        (
            &["connect", ""],
            "error: a value is required for '<PORT>' but none was supplied; see `rumbo connect --help`",
        ),
        (
            &["fly"],
            "error: unrecognized subcommand 'fly'; see `rumbo --help`",
        ),
        (
            &["run"],
            "error: the following required arguments were not provided: <SCENARIO>...; see `rumbo run --help`",
        ),
        (
            &["run", "mode1", "--sed", "7"],
            "error: unexpected argument '--sed' found; tip: a similar argument exists: '--seed'; see `rumbo run --help`",
        ),
        (
            &["run", "fre"],
            "error: unknown scenario `fre`; did you mean `free`?",
        ),
        (
            &["run", "mode1", "--world", "opne"],
            "error: unknown world `opne`; did you mean `open`?",
        ),
        (
            &["run", "mode1", "--robot", "memory"],
            "error: unknown robot `memory`; did you mean `memoria`?",
        ),
        (
            &["run", "mode1", "--rig", "front"],
            "error: unknown rig `front`; did you mean `front_pair` or `front_single`?",
        ),
        (
            &["lab", "--rig", "fnal"],
            "error: unknown rig `fnal`; did you mean `final`?",
        ),
        (
            &["lab", "--world", "opne"],
            "error: unknown world `opne`; did you mean `open`?",
        ),
        (
            &["run", "far.toml"],
            "error: far.toml:8: start.x_m = -400: must be within -50..50 m",
        ),
        (
            &["run", "nowhere.toml"],
            "error: nowhere.toml: cannot be read (No such file or directory (os error 2)); give the path of an existing file",
        ),
        (
            &["run", "mode1", "--param", "battery.open_circuit_v=90"],
            "error: parameter battery.open_circuit_v = 90: must be within 5..13 V",
        ),
        (
            &["run", "mode7", "--param", "waypoint_tracker=pursuit"],
            "error: invalid value 'waypoint_tracker=pursuit' for '--param <NAME=VALUE>': waypoint_tracker must be `straight` or `pure_pursuit`, not `pursuit`; see `rumbo run --help`",
        ),
        (
            &["run", "mode7", "--param", "waypoint_tracker=0.5"],
            "error: parameter waypoint_tracker = 0.5: must be `straight` or `pure_pursuit`",
        ),
        (
            &["run", "mode1", "--param", "battery"],
            "error: invalid value 'battery' for '--param <NAME=VALUE>': write it as name=value, e.g. battery.open_circuit_v=6.9; see `rumbo run --help`",
        ),
        (
            &[
                "run",
                "mode1",
                "--command",
                "REF 40@6",
                "--command",
                "OFF@9",
            ],
            "error: scenario mode1: lasts 9 s, and `OFF` is to be sent at 9 s; send it earlier",
        ),
        (
            &["lab", "--speed", "-1"],
            "error: invalid value '-1' for '--speed <X>': must be a number of times real time, within 0..100, e.g. 4 or 0.5; see `rumbo lab --help`",
        ),
        (
            &["export", "a.mcap", "--from", "1,5"],
            "error: invalid value '1,5' for '--from <S>': must be a number, with a point before decimals, e.g. 1.5; see `rumbo export --help`",
        ),
        (
            &["identify", "--drive", "lab", "--battery", "76"],
            "error: invalid value '76' for '--battery <VOLTS>': must be 5 to 13 V, e.g. 7.62; see `rumbo identify --help`",
        ),
        (
            &[
                "new",
                "robot",
                "x",
                "--pins",
                "left_forward=7,left_forward=4",
            ],
            "error: --pins: left_forward is given twice; give each signal once",
        ),
        (
            &["lab", "--seed", "-1"],
            "error: invalid value '-1' for '--seed <N>': must be a whole number from 0 on; see `rumbo lab --help`",
        ),
        (
            &["run", "mode1", "--language", "es"],
            "error: unexpected argument '--language' found; see `rumbo run --help`",
        ),
        (
            &["run", "mode1", "--runs", "-1"],
            "error: invalid value '-1' for '--runs <N>': must be a whole number within 1..1000000; see `rumbo run --help`",
        ),
        (
            &["identify", "no_number.csv", "--check", "memoria"],
            "error: no_number.csv, line 2, column right_cm: `1O7`, allowed is a number",
        ),
        (
            &["identify", "pwm.csv", "--check", "memory"],
            "error: unknown robot `memory`; did you mean `memoria`?",
        ),
        (
            &["import", "no_number.csv"],
            "error: no_number.csv:2: right_cm = `1O7`: must be a number within -1000000..1000000",
        ),
        (
            &["import", "too_short.csv"],
            "error: too_short.csv:3: 6 values in a row of 7 columns; expected dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b",
        ),
        (
            &["import", "pwm.csv"],
            "error: pwm.csv:2: pwm_b = `300`: must be a number within -255..255",
        ),
        (
            &["import", "empty.csv"],
            "error: empty.csv:1: no rows under the header; is the recording complete?",
        ),
        (
            &["import", "nowhere.csv"],
            "error: nowhere.csv: cannot be read (No such file or directory (os error 2)); give the path of a table, a bag or a log",
        ),
    ];
    for (arguments, expected) in cases {
        let output = rumbo(arguments);
        assert_eq!(stderr(&output), format!("{expected}\n"), "{arguments:?}");
        assert_eq!(stdout(&output), "", "{arguments:?}");
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    }
}

#[test]
fn a_file_that_is_all_one_line_is_not_shown_whole() {
    let header = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b ";
    file(
        "one_line.csv",
        &(header.to_owned() + &"69,107,107,30,1,115,115 ".repeat(1_000)),
    );
    let output = rumbo(&["import", "one_line.csv"]);
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(
        said.contains("is no header of the original program"),
        "{said}"
    );
    assert!(said.len() < 500, "{}", said.len());
}

#[test]
fn the_node_of_ros_is_named_with_the_program_that_is_it() {
    let output = rumbo(&["ros", "lab"]);
    let said = stderr(&output);
    assert!(
        said.starts_with("error: ros: ") && said.contains("rumbo-ros"),
        "{said}"
    );
    assert_eq!(output.status.code(), Some(2));
}
