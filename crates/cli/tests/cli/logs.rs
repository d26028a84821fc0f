//! Logs from the user's view: recordings, logs after a crash, and messages about files that are no logs.

#![cfg(test)]

use crate::support::{Running, only_file, program, rumbo_in};
use rumbo_log::{Burst, Truth};
use rumbo_session::headless::RunRecords;
use rumbo_station::headless::record_run;
use rumbo_station::log_file;
use rumbo_wire::message::Hello;
use rumbo_wire::{Decoder, FrameMessage, FromRobot, Received};
use std::path::Path;
use std::process::Command;
use std::time::Duration;

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A lab that records into a folder, once it is up.
fn lab(folder: &Path, speed: &str) -> Running {
    let folder = folder.to_str().unwrap();
    let with = [
        "lab",
        "--no-browser",
        "--port=0",
        "--speed",
        speed,
        "--out",
        folder,
    ];
    Running::start(&with)
}

#[test]
fn each_of_several_robots_has_a_log_with_the_others_that_runs_again() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = "title = \"t\"\nrobot = \"memoria\"\nrig = \"final\"\nworld = \"open\"\nmode = \"wheel_speed\"\nduration_s = 3\n\
        [[command]]\nat_s = 0.4\nspeed_rpm = 40\n[[command]]\nat_s = 0.5\narm = true\n\
        [[fleet]]\nname = \"east\"\n[[fleet]]\nname = \"west\"\nstart = { x_m = 0.7, heading_deg = 180 }\n";
    std::fs::write(folder.path().join("two.toml"), scenario).unwrap();
    let ran = rumbo_in(folder.path(), &["run", "two.toml", "--out", "out"]);
    assert_eq!(ran.status.code(), Some(0), "{}", text(&ran.stderr));
    let table = text(&ran.stdout);
    assert!(
        table.contains("robot_contacts") && table.contains("east-west"),
        "{table}"
    );
    for (own, other) in [("east", "west"), ("west", "east")] {
        let path = format!("out/two-1-{own}.mcap");
        let log = log_file::read(&folder.path().join(&path)).unwrap();
        assert_eq!(log.manifest.as_ref().unwrap().member.as_deref(), Some(own));
        let scene = log.scene.as_ref().unwrap();
        assert_eq!(
            (
                scene.choice.scenario.as_str(),
                scene.others[0].name.as_str()
            ),
            ("two", other)
        );
        let seen: Vec<f64> = log
            .readings
            .iter()
            .filter_map(|each| each.signal(&format!("{other}_x_m")))
            .collect();
        // 33 a second while the other drives, and before that as often as needed.
        assert!((75..100).contains(&seen.len()), "{}", seen.len());
        assert!(
            (seen[0] - seen[50]).abs() > 0.05,
            "the other drives: {seen:?}"
        );
        let again = rumbo_in(folder.path(), &["rerun", &path]);
        assert_eq!(
            again.status.code(),
            Some(0),
            "{}{}",
            text(&again.stdout),
            text(&again.stderr)
        );
    }
    // Files of another scenario of that name are kept.
    std::fs::write(folder.path().join("out/two-1-east.truth.csv"), "mine").unwrap();
    let refused = rumbo_in(folder.path(), &["run", "two.toml", "--out", "out"]);
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
}

#[test]
fn a_run_is_recorded_whole_and_the_same_run_is_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    for out in ["one", "two"] {
        let done = rumbo_in(
            folder.path(),
            &[
                "run", "mode1", "--seed", "7", "--param", "kv=0.03", "--out", out,
            ],
        );
        assert!(
            done.status.code().is_some_and(|status| status < 2),
            "{}",
            text(&done.stderr)
        );
    }
    let path = folder.path().join("one/mode1-7.mcap");
    assert_eq!(
        std::fs::read(&path).unwrap(),
        std::fs::read(folder.path().join("two/mode1-7.mcap")).unwrap()
    );
    let log = log_file::read(&path).unwrap();
    assert_eq!(log.cut, None);
    let manifest = log.manifest.as_ref().unwrap();
    assert_eq!(
        (manifest.scenario.as_deref(), manifest.seed),
        (Some("mode1"), Some(7))
    );
    assert_eq!(manifest.parameters, [("kv".to_owned(), 0.03)]);
    assert!(
        manifest.files["world"].contains("[[wall]]") || manifest.files["world"].contains("wall")
    );
    assert!(log.rows.len() > 200, "{}", log.rows.len());
    assert!(
        log.link.iter().any(|burst| burst.to_robot) && log.link.iter().any(|burst| !burst.to_robot)
    );
    assert!(
        log.events()
            .any(|(_, _, text)| text.starts_with("sent: ON"))
    );
    assert!(log.outcome.unwrap().metrics.len() > 3);
    let again = rumbo_in(folder.path(), &["rerun", "one/mode1-7.mcap"]);
    assert_eq!(
        again.status.code(),
        Some(0),
        "{}{}",
        text(&again.stdout),
        text(&again.stderr)
    );
    // Ground truth is there beside the measurements.
    let last = log.rows.last().unwrap();
    let (measured_m, true_m) = (
        last.signal("range_front_m").unwrap(),
        last.signal("true_range_front_m").unwrap(),
    );
    assert!((measured_m - true_m).abs() < 0.02, "{measured_m} {true_m}");
}

#[test]
fn a_log_has_what_the_control_loops_add_up_to() {
    let folder = tempfile::tempdir().unwrap();
    rumbo_in(folder.path(), &["run", "mode3", "--out", "."]);
    let done = rumbo_in(
        folder.path(),
        &["export", "mode3-1.mcap", "--format", "csv"],
    );
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let log = log_file::read(&folder.path().join("mode3-1.mcap")).unwrap();
    let (mut compared, mut steered) = (0, 0);
    for reading in &log.readings {
        let term = |name: &str| reading.signal(name);
        if let (Some(p), Some(d), Some(ref_rad_s)) = (
            term("heading_p_rad_s"),
            term("heading_d_rad_s"),
            term("yaw_ref_rad_s"),
        ) {
            steered += 1;
            let limited = ref_rad_s.abs() > (p + d).abs() + 0.01;
            assert!(!limited, "{p} {d} {ref_rad_s}");
        }
        // The terms are those of the tick before, in which the telemetry of that instant was measured.
        let row = log.rows.iter().find(|row| row.t_ms == reading.t_ms - 10);
        for side in ["left", "right"] {
            let parts = ["p_pwm", "i_pwm", "d_pwm", "feedforward_pwm"];
            let parts = parts.map(|part| term(&format!("{side}_{part}")));
            let [Some(p), Some(i), Some(d), Some(feedforward)] = parts else {
                continue;
            };
            let sum = p + i + d + feedforward;
            let Some(pwm) = row.and_then(|row| row.signal(&format!("{side}_pwm"))) else {
                continue;
            };
            // While it breaks away, a wheel gets its kick.
            if reading.t_ms > 1_000 && sum > 0.0 && sum < 255.0 {
                assert!((sum - pwm).abs() < 0.6, "{}: {sum} {pwm}", reading.t_ms);
                compared += 1;
            }
        }
    }
    assert!(compared > 200 && steered > 500, "{compared} {steered}");
    let csv = std::fs::read_to_string(folder.path().join("mode3-1.loops.csv")).unwrap();
    assert!(csv.starts_with("t_s,distance_i_rad,distance_p_rad,forward_ref_m_s"));
}

#[test]
fn a_figure_has_the_signals_and_the_time_that_were_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    rumbo_in(folder.path(), &["run", "mode5", "--out", "."]);
    let export = |more: &[&str]| {
        let all = [&["export", "mode5-1.mcap"], more].concat();
        rumbo_in(folder.path(), &all)
    };
    let picture = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(export(&["--format", "svg"]).status.code(), Some(0));
    // Each wheel has its reference in its own colour.
    let whole = picture("mode5-1.svg");
    assert!(whole.contains("class=\"i1 d\"") && whole.contains("class=\"i2 d\""));
    let some = [
        "--signals",
        "left_pwm,right_pwm",
        "--from",
        "1",
        "--to",
        "2",
        "--force",
    ];
    assert_eq!(export(&some).status.code(), Some(0));
    let part = picture("mode5-1.svg");
    assert!(part.contains("of 255") && !part.contains("rpm"), "{part}");
    let table = picture("mode5-1.csv");
    let times = table
        .lines()
        .skip(1)
        .map(|row| row.split(',').next().unwrap());
    assert!(
        times
            .map(|t_s| t_s.parse::<f64>().unwrap())
            .all(|t_s| (1.0..=2.0).contains(&t_s))
    );
    for (wrong, said) in [
        (
            ["--signals", "left_pmw"],
            "left_pmw: no signal that is plotted",
        ),
        (["--from", "1e4"], "holds nothing from"),
    ] {
        let refused = export(&wrong);
        assert!(
            text(&refused.stderr).contains(said),
            "{}",
            text(&refused.stderr)
        );
    }
    let explained = rumbo_in(folder.path(), &["explain", "mode5-1.mcap", "--from", "1e4"]);
    let said = text(&explained.stderr);
    assert_eq!(explained.status.code(), Some(2));
    assert!(said.contains("nothing from 10000 s to its end"), "{said}");
}

#[test]
fn a_log_is_exported_with_units_and_compared_with_another() {
    let folder = tempfile::tempdir().unwrap();
    let done = rumbo_in(
        folder.path(),
        &["run", "mode1", "--runs", "2", "--out", "."],
    );
    assert!(
        done.status.code().is_some_and(|status| status < 2),
        "{}",
        text(&done.stderr)
    );
    let done = rumbo_in(
        folder.path(),
        &[
            "export",
            "mode1-1.mcap",
            "--out",
            "x",
            "--format",
            "csv",
            "--format",
            "svg",
        ],
    );
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    let csv = std::fs::read_to_string(folder.path().join("x/mode1-1.csv")).unwrap();
    let (header, rows) = csv.split_once('\n').unwrap();
    assert!(
        header.starts_with("t_s,mode,state,") && header.contains(",range_front_m,"),
        "{header}"
    );
    assert!(
        rows.lines()
            .all(|row| row.split(',').count() == header.split(',').count())
    );
    assert!(
        std::fs::read_to_string(folder.path().join("x/mode1-1.events.csv"))
            .unwrap()
            .contains(",\"sent: ON\"")
    );
    assert!(
        std::fs::read_to_string(folder.path().join("x/mode1-1.svg"))
            .unwrap()
            .contains("Distances")
    );

    let pair = [
        "compare",
        "mode1-1.mcap",
        "mode1-2.mcap",
        "--json",
        "--out",
        "both.svg",
    ];
    let done = rumbo_in(folder.path(), &pair);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("\"log.way_m\":"));
    assert!(folder.path().join("both.svg").exists());
    let other = rumbo_in(folder.path(), &[&pair[..], &["--tolerance", "0"]].concat());
    assert_eq!(other.status.code(), Some(1));
    let same = rumbo_in(
        folder.path(),
        &[
            "compare",
            "mode1-1.mcap",
            "mode1-1.mcap",
            "--tolerance",
            "0",
        ],
    );
    assert_eq!(same.status.code(), Some(0), "{}", text(&same.stdout));
}

#[test]
fn parameters_that_differ_are_shown_beside_the_metrics() {
    let folder = tempfile::tempdir().unwrap();
    for value in ["0.03", "0.04"] {
        let parameter = format!("kv={value}");
        let run = ["run", "mode5", "--param", &parameter, "--out", value];
        assert!(rumbo_in(folder.path(), &run).status.code().unwrap() < 2);
    }
    let pair = ["compare", "0.03/mode5-1.mcap", "0.04/mode5-1.mcap"];
    let said = text(&rumbo_in(folder.path(), &pair).stdout);
    let (_, parameters) = said.split_once("parameters that differ:\n").unwrap();
    assert_eq!(parameters, "  kv  0.03  0.04\n");
    // A robot that calibrated itself before the run knows what it found.
    rumbo_in(folder.path(), &["run", "mode7", "--out", "."]);
    let calibrated = log_file::read(&folder.path().join("mode7-1.mcap")).unwrap();
    let plain = log_file::read(&folder.path().join("0.03/mode5-1.mcap")).unwrap();
    assert_ne!(
        calibrated.parameters()["base_m"],
        plain.parameters()["base_m"]
    );
    let same = ["compare", "0.03/mode5-1.mcap", "0.03/mode5-1.mcap"];
    assert!(!text(&rumbo_in(folder.path(), &same).stdout).contains("differ:"));
}

#[test]
fn another_table_of_parameters_and_the_end_of_a_truncated_log_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    rumbo_in(folder.path(), &["run", "mode5", "--out", "."]);
    let path = folder.path().join("mode5-1.mcap");
    let log = log_file::read(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    let cut = rumbo_in(folder.path(), &["rerun", "cut.mcap"]);
    assert_eq!(cut.status.code(), Some(0));
    assert!(text(&cut.stderr).contains("cut.mcap ends at"));

    // What ends within its head has nothing to compare, show or draw.
    for (bytes, said) in [
        (0, "ends before its first record"),
        (5, "ends before its first record"),
        (150, "ends before its first record"),
        (5_000, "`rumbo run mode5 --seed 1` makes such a run again"),
    ] {
        std::fs::write(folder.path().join("head.mcap"), &whole[..bytes]).unwrap();
        for command in ["rerun", "export", "compare", "replay"] {
            let log = ["head.mcap", "head.mcap"];
            let log = &log[..1 + usize::from(command == "compare")];
            let output = rumbo_in(folder.path(), &[&[command], log].concat());
            assert_eq!(output.status.code(), Some(2), "{command}, {bytes} bytes");
            assert!(
                text(&output.stderr).contains(said),
                "{}",
                text(&output.stderr)
            );
            let said = text(&output.stderr);
            let lines = said
                .lines()
                .filter(|line| !line.contains("a whole log now"));
            assert_eq!(lines.count(), 1, "{said}");
        }
    }

    // Damaged where nothing was recorded, it is as good as whole.
    let damaged = |at: usize| {
        let mut damaged = whole.clone();
        damaged[at..at + 8].fill(0x7f);
        std::fs::write(folder.path().join("damaged.mcap"), &damaged).unwrap();
    };
    damaged(9);
    let shown = rumbo_in(folder.path(), &["export", "damaged.mcap"]);
    assert_eq!(shown.status.code(), Some(0), "{}", text(&shown.stderr));
    let said = text(&shown.stderr);
    assert!(
        said.starts_with("note: damaged.mcap: it is damaged where nothing"),
        "{said}"
    );
    let rows = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    rumbo_in(folder.path(), &["export", "mode5-1.mcap"]);
    assert_eq!(rows("damaged.csv"), rows("mode5-1.csv"));
    let again = rumbo_in(folder.path(), &["rerun", "damaged.mcap"]);
    assert_eq!(again.status.code(), Some(0));
    // Damaged in the middle, the rest is read, but the run cannot be compared.
    let index = mcap::Summary::read(&whole).unwrap().unwrap();
    let chunk = &index.chunk_indexes[index.chunk_indexes.len() / 2];
    damaged(chunk.chunk_start_offset as usize + 1_000);
    let shown = rumbo_in(folder.path(), &["export", "damaged.mcap", "--force"]);
    assert_eq!(shown.status.code(), Some(0), "{}", text(&shown.stderr));
    assert!(text(&shown.stderr).starts_with("note: damaged.mcap is damaged: "));
    let count = |name: &str| rows(name).lines().count();
    assert!(count("damaged.csv") > count("mode5-1.csv") / 2);
    assert!(count("damaged.csv") < count("mode5-1.csv"));
    let again = rumbo_in(folder.path(), &["rerun", "damaged.mcap"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("parts of it are missing"));

    let mut manifest = log.manifest.unwrap();
    manifest.version = "0.0.7".into();
    let from_robot = log.link.iter().filter(|burst| !burst.to_robot);
    let said: Vec<u8> = from_robot.flat_map(|burst| burst.bytes.clone()).collect();
    let link = [Burst {
        bytes: another_table(&said),
        to_robot: false,
        t_us: 20_000,
    }];
    let run = RunRecords {
        truths: &[(60_000_000, Truth::default())],
        link: &link,
        ..RunRecords::default()
    };
    record_run(&path, &manifest, run).unwrap();
    let other = rumbo_in(folder.path(), &["rerun", "mode5-1.mcap"]);
    let said = text(&other.stdout);
    assert_eq!(other.status.code(), Some(1));
    for part in ["another table of parameters", "by version 0.0.7"] {
        assert!(said.contains(part), "{said}");
    }
}

/// The first message of a robot with one parameter more.
fn another_table(bytes: &[u8]) -> Vec<u8> {
    let mut decoder = Decoder::<160>::default();
    let body = bytes.iter().find_map(|byte| match decoder.push(*byte) {
        Some(Received::Frame(body)) => Some(body),
        _ => None,
    });
    let Ok(FromRobot::Hello(hello)) = FromRobot::from_body(&body.unwrap()) else {
        panic!("no HELLO")
    };
    let hello = Hello {
        schema: !hello.schema,
        ..hello
    };
    FromRobot::Hello(hello).frame(0).bytes().to_vec()
}

#[test]
fn a_lab_that_is_killed_leaves_a_log_that_the_next_command_makes_whole() {
    for lived_ms in [300, 1_400, 2_700] {
        let folder = tempfile::tempdir().unwrap();
        let list = || {
            let mut list = program();
            list.args(["list", "logs"]).env("RUMBO_LOGS", folder.path());
            let output = list.output().unwrap();
            (text(&output.stdout), text(&output.stderr))
        };
        let lab = lab(folder.path(), "8");
        std::thread::sleep(Duration::from_millis(lived_ms));
        // What somebody still writes is let be.
        assert_eq!(list().1, "");
        let path = only_file(folder.path());
        let living = log_file::read(&path).unwrap();
        // Killed, without a chance to complete it.
        drop(lab);
        let before = log_file::read(&path).unwrap();
        assert!(before.manifest.is_some());
        assert!(living.cut.is_some() && before.cut.is_some());
        assert!(before.link.len() >= living.link.len());
        assert!(lived_ms < 1_000 || !before.rows.is_empty());
        assert!(mcap::Summary::read(&std::fs::read(&path).unwrap()).is_err());

        let (listed, said) = list();
        assert!(listed.contains("cut off"), "{listed}");
        assert!(
            said.contains("it is a whole log now") && said.lines().count() == 1,
            "{said}"
        );
        let bytes = std::fs::read(only_file(folder.path())).unwrap();
        let index = mcap::Summary::read(&bytes).unwrap().unwrap();
        assert!(index.stats.unwrap().message_count > 0);
        let after = log_file::read(&path).unwrap();
        assert_eq!((after.cut, after.link), (before.cut, before.link));
        assert!(format!("{:?}", after.rows) == format!("{:?}", before.rows));
        assert_eq!(list().1, "");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_among_the_logs_keeps_nobody_waiting() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.mcap");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let mut list = program();
    list.args(["list", "logs"]).env("RUMBO_LOGS", folder.path());
    let output = list.output().unwrap();
    assert!(text(&output.stdout).contains("unreadable"));
    let mut read = program();
    let output = read.arg("export").arg(&pipe).output().unwrap();
    assert!(text(&output.stderr).contains("a pipe or a device"));
}

#[cfg(unix)]
#[test]
fn a_lab_that_is_asked_to_end_completes_its_log() {
    completes_its_log("-TERM");
    // Where the tests themselves outlive their terminal, so does the lab.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.map(|mask| u64::from_str_radix(mask.trim(), 16).unwrap());
    if ignored.is_some_and(|mask| mask & 1 == 0) {
        completes_its_log("-HUP");
    }
}

#[cfg(unix)]
fn completes_its_log(signal: &str) {
    let folder = tempfile::tempdir().unwrap();
    let lab = lab(folder.path(), "8");
    std::thread::sleep(Duration::from_millis(1_200));
    lab.end_by(signal);
    let log = log_file::read(&only_file(folder.path())).unwrap();
    assert_eq!(log.cut, None);
    assert!(log.rows.len() > 20, "{}", log.rows.len());
    let stop = log.link.iter().rev().find(|burst| burst.to_robot).unwrap();
    assert!(!stop.bytes.is_empty());
    drop(log);
    let path = only_file(folder.path());
    let again = rumbo_in(folder.path(), &["rerun", path.to_str().unwrap()]);
    assert_eq!(
        again.status.code(),
        Some(0),
        "{}{}",
        text(&again.stdout),
        text(&again.stderr)
    );
}

#[test]
fn a_lab_that_cannot_record_runs_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a_file");
    std::fs::write(&file, "").unwrap();
    let mut lab = lab(&file, "1");
    std::thread::sleep(Duration::from_millis(300));
    assert!(lab.is_alive());
}

#[cfg(unix)]
#[test]
fn a_simulated_robot_behind_a_pseudo_terminal_is_connected_to_and_recorded_like_a_real_one() {
    let folder = tempfile::tempdir().unwrap();
    let robot = Running::start(&["lab", "--pty", "--scenario", "mode5"]);
    let port = robot.said.clone();
    assert!(port.starts_with("/dev/"), "{port}");
    let out = folder.path().to_str().unwrap();
    let connect = ["connect", &port, "--no-browser", "--port=0", "--out", out];
    let station = Running::start(&connect);
    let address = &station.said;
    assert!(address.starts_with("http://127.0.0.1:"), "{address}");
    std::thread::sleep(Duration::from_millis(2_500));
    station.end();
    drop(robot);
    let log = log_file::read(&only_file(folder.path())).unwrap();
    assert!(log.rows.len() > 10, "{}", log.rows.len());
    assert!(log.rows.iter().all(|row| row.signal("armed") == Some(0.0)));
    assert_eq!(log.manifest.unwrap().port, Some(port));
    let again = rumbo_in(
        folder.path(),
        &["rerun", only_file(folder.path()).to_str().unwrap()],
    );
    assert_eq!(again.status.code(), Some(2));
}
