//! Nothing is lost: what a command reads it does not write, and what another run or a person wrote stays.

use super::{rumbo_in, scenario, status};
use crate::support::{stderr, stdout};
use std::path::Path;
use std::process::Output;

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

/// Refused before anything ran, with a line that says so.
fn assert_refused(output: &Output, said: &str) {
    let message = stderr(output);
    assert_eq!(status(output), 2, "{message}");
    assert!(
        message.contains(said) && message.lines().count() == 1,
        "{message}"
    );
    assert_eq!(stdout(output), "");
}

#[test]
fn two_results_of_one_name_are_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for name in ["a", "b"] {
        std::fs::create_dir(folder.join(name)).unwrap();
        std::fs::write(folder.join(name).join("task.toml"), scenario(name, 0.2)).unwrap();
    }
    let both = ["run", "a/task.toml", "b/task.toml", "--out", "o"];
    assert_refused(&rumbo_in(folder, &both), "both a/task.toml and b/task.toml");
    let forced = [&both[..], &["--force"]].concat();
    assert_refused(
        &rumbo_in(folder, &forced),
        "both a/task.toml and b/task.toml",
    );
    assert!(!folder.join("o").exists());

    // Neither does the one replace the other in a call of its own.
    assert!(status(&rumbo_in(folder, &["run", "a/task.toml", "--out", "o"])) < 2);
    let first = read(folder, "o/task-1.json");
    assert_refused(
        &rumbo_in(folder, &["run", "b/task.toml", "--out", "o"]),
        "task-1.json: is there already",
    );
    assert_eq!(read(folder, "o/task-1.json"), first);
    // The same again does, also with what was changed in it.
    std::fs::write(folder.join("a/task.toml"), scenario("a", 0.3)).unwrap();
    assert!(status(&rumbo_in(folder, &["run", "a/task.toml", "--out", "o"])) < 2);
    assert_ne!(read(folder, "o/task-1.truth.csv").len(), 0);
    assert_ne!(read(folder, "o/task-1.json"), first);
    let goal = include_str!("../../../../../policies/goal.toml");
    for name in ["goal", "other"] {
        std::fs::write(folder.join(format!("{name}.toml")), goal).unwrap();
    }
    let by = |policy| {
        let arguments = ["run", "mode9-random", "--out", "o", "--policy", policy];
        rumbo_in(folder, &arguments)
    };
    assert!(status(&by("goal.toml")) < 2);
    assert!(status(&by("goal.toml")) < 2);
    assert_refused(&by("other.toml"), "mode9-random-1.json: is there already");
    // With other options it is another run, also where the log that says so is gone.
    let mut other = vec!["run", "a/task.toml", "--out", "o", "--param", "kv=0.03"];
    let refused = "task-1.json: is there already";
    assert_refused(&rumbo_in(folder, &other), refused);
    std::fs::remove_file(folder.join("o/task-1.mcap")).unwrap();
    assert_refused(&rumbo_in(folder, &other), refused);
    other.push("--force");
    assert!(status(&rumbo_in(folder, &other)) < 2);
    other.pop();
    assert!(status(&rumbo_in(folder, &other)) < 2);
    assert_refused(&rumbo_in(folder, &other[..4]), refused);
    let forced = ["run", "b/task.toml", "--out", "o", "--force"];
    assert!(status(&rumbo_in(folder, &forced)) < 2);
}

#[test]
fn no_result_takes_the_place_of_what_it_is_made_of() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("task.toml"), scenario("t", 0.5)).unwrap();
    rumbo_in(folder, &["run", "task.toml", "--runs", "2", "--out", "."]);
    let csv = "dt_ms,speed_a_rpm,speed_b_rpm,reference_rpm,mode,pwm_a,pwm_b\n50,1,1,60,5,9,9\n50,2,2,60,5,9,9\n";
    std::fs::write(folder.join("v.csv"), csv).unwrap();
    let names = ["task-1.mcap", "task-2.mcap", "v.csv", "task.toml"];
    let before = names.map(|name| read(folder, name));
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.join("task-2.mcap"), folder.join("link.svg")).unwrap();
    std::fs::hard_link(folder.join("v.csv"), folder.join("hard.mcap")).unwrap();
    for arguments in [
        &[
            "compare",
            "task-1.mcap",
            "task-2.mcap",
            "--out",
            "task-2.mcap",
        ][..],
        #[cfg(unix)]
        &["compare", "task-1.mcap", "task-2.mcap", "--out", "link.svg"],
        &["import", "v.csv", "--out", "./v.csv"],
        &["import", "v.csv", "--out", "hard.mcap"],
    ] {
        for force in [&[][..], &["--force"]] {
            let output = rumbo_in(folder, &[arguments, force].concat());
            assert_refused(&output, "which this command reads");
        }
    }
    assert_eq!(names.map(|name| read(folder, name)), before);
}

#[test]
fn what_a_person_wrote_stays_unless_it_is_to_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("task.toml"), scenario("t", 0.5)).unwrap();
    rumbo_in(folder, &["run", "task.toml", "--runs", "2", "--out", "."]);
    let csv = "dt_ms,speed_a_rpm,speed_b_rpm,reference_rpm,mode,pwm_a,pwm_b\n50,1,1,60,5,9,9\n50,2,2,60,5,9,9\n";
    std::fs::write(folder.join("v.csv"), csv).unwrap();
    let commands: [(&[&str], &[&str]); 6] = [
        (
            &["run", "task.toml", "--out", "o"],
            &["o/task-1.json", "o/task-1.truth.csv", "o/task-1.mcap"],
        ),
        (
            &[
                "export",
                "task-1.mcap",
                "--format",
                "csv",
                "--format",
                "svg",
            ],
            &["task-1.csv", "task-1.events.csv", "task-1.svg"],
        ),
        (
            &["compare", "task-1.mcap", "task-2.mcap", "--out", "both.svg"],
            &["both.svg"],
        ),
        (&["import", "v.csv"], &["v.mcap"]),
        (
            &[
                "identify", "v.csv", "--check", "memoria", "--plots", "plots",
            ],
            &["plots/v.svg"],
        ),
        (
            &[
                "experiments",
                "--only",
                "mode5",
                "--out",
                "report",
                "--data",
            ],
            &[
                "report/report.html",
                "report/mode5-1.json",
                "report/mode5-1.truth.csv",
                "report/mode5-1.mcap",
            ],
        ),
    ];
    for (command, files) in commands {
        for file in files {
            let path = folder.join(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, "a thesis").unwrap();
            assert_refused(
                &rumbo_in(folder, command),
                &format!("{}: is there already", file.rsplit('/').next().unwrap()),
            );
            assert_eq!(read(folder, file), b"a thesis");
            std::fs::remove_file(&path).unwrap();
        }
        std::fs::write(folder.join(files[0]), "a thesis").unwrap();
        let forced = rumbo_in(folder, &[command, &["--force"]].concat());
        assert!(status(&forced) < 2, "{}", stderr(&forced));
        assert_ne!(read(folder, files[0]), b"a thesis");
        // What Rumbo wrote of the same it writes again.
        let again = rumbo_in(folder, command);
        assert!(status(&again) < 2, "{command:?}: {}", stderr(&again));
    }
    // A figure of other logs, or of a part of one, and a report in another language, are others.
    let part = ["export", "task-1.mcap", "--from", "0.2"];
    assert_refused(&rumbo_in(folder, &part), "task-1.svg: is there already");
    let before = read(folder, "task-1.csv");
    let part = [&part[..], &["--format", "csv"]].concat();
    assert_refused(&rumbo_in(folder, &part), "task-1.csv: is there already");
    assert_eq!(read(folder, "task-1.csv"), before);
    assert_refused(
        &rumbo_in(
            folder,
            &["compare", "task-2.mcap", "task-1.mcap", "--out", "both.svg"],
        ),
        "is there already",
    );
    let spanish = [
        "experiments",
        "--only",
        "mode5",
        "--out",
        "report",
        "--language",
        "es",
    ];
    assert_refused(&rumbo_in(folder, &spanish), "is there already");
}

#[test]
fn runs_at_once_into_one_place_leave_one_whole_result() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("task.toml"), scenario("t", 2.0)).unwrap();
    let run = || rumbo_in(folder, &["run", "task.toml", "--out", "o", "--json"]);
    let outputs: Vec<Output> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(run)).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap())
            .collect()
    });
    for output in &outputs {
        assert!(status(output) < 2, "{}", stderr(output));
        assert_eq!(stderr(output), "");
    }
    assert_eq!(
        stdout(&outputs[0]).into_bytes(),
        read(folder, "o/task-1.json")
    );
    assert_eq!(status(&rumbo_in(folder, &["rerun", "o/task-1.mcap"])), 0);
    assert_eq!(std::fs::read_dir(folder.join("o")).unwrap().count(), 3);
}

#[cfg(unix)]
#[test]
fn a_result_has_the_rights_that_any_new_file_has() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("task.toml"), scenario("t", 0.2)).unwrap();
    rumbo_in(folder, &["run", "task.toml", "--out", "o"]);
    let rights = |name: &str| {
        let about = std::fs::metadata(folder.join(name)).unwrap();
        about.permissions().mode() & 0o777
    };
    assert_eq!(rights("o/task-1.json"), rights("task.toml"));
    assert_eq!(rights("o/task-1.mcap"), rights("task.toml"));
}

#[test]
fn a_calibration_replaces_no_parameters_but_those_of_a_calibration() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let robot = rumbo_experiment::files::Library::new()
        .robot("memoria")
        .unwrap();
    let own = robot
        .text
        .replace("[parameters]\n", "[parameters]\nkv = 0.03\n");
    std::fs::write(folder.join("mine.toml"), &own).unwrap();
    let into_mine = ["calibrate", "--out", "mine.toml"];
    assert_refused(
        &rumbo_in(folder, &into_mine),
        "that were not found by this command",
    );
    assert_eq!(read(folder, "mine.toml"), own.as_bytes());
    // Its own robot's are meant, and then they are a calibration's.
    for command in [
        &["--robot", "./mine.toml", "--out", "mine.toml"][..],
        &["--out", "mine.toml"],
    ] {
        let output = rumbo_in(folder, &[&["calibrate"], command].concat());
        assert_eq!(status(&output), 0, "{}", stderr(&output));
    }
}

#[cfg(unix)]
#[test]
fn what_is_begun_and_cannot_be_written_is_not_in_the_way_of_the_next_attempt() {
    let folder = tempfile::tempdir().unwrap();
    // A file may have 1 KB at most, as on a disk that is full.
    let limited = "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"";
    for (what, name) in [("robot", "mine.toml"), ("sketch", "mine")] {
        let output = std::process::Command::new("sh")
            .args(["-c", limited, env!("CARGO_BIN_EXE_rumbo")])
            .args(["new", what, name])
            .args(["--like", if what == "robot" { "uno" } else { "wall" }])
            .current_dir(&folder)
            .output()
            .unwrap();
        assert_eq!(status(&output), 2, "{}", stderr(&output));
        assert!(!folder.path().join(name).exists(), "{what}");
    }
}
