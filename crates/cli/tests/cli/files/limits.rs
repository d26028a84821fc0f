//! Readers have limits: they report data that is too long, too late or too much, and stop reading.

use super::{rumbo_in, scenario, status};
use crate::support::stderr;
use rumbo_log::{Burst, Manifest, Truth};
use rumbo_session::headless::RunRecords;
use rumbo_station::headless::record_run;
use rumbo_station::log_file;
use std::path::Path;

/// A log of a session in the lab with this manifest, and something sent at a time \[us\].
fn session(path: &Path, manifest: &Manifest, t_us: u64) {
    let link = [Burst {
        t_us,
        to_robot: true,
        bytes: vec![0],
    }];
    let run = RunRecords {
        truths: &[(t_us, Truth::default())],
        link: &link,
        ..RunRecords::default()
    };
    record_run(path, manifest, run).unwrap();
}

/// The manifest of a run of a moment, as a session of the lab has it.
fn manifest(folder: &Path) -> Manifest {
    std::fs::write(folder.join("task.toml"), scenario("t", 0.2)).unwrap();
    rumbo_in(folder, &["run", "task.toml", "--out", "o"]);
    let log = log_file::read(&folder.join("o/task-1.mcap")).unwrap();
    Manifest {
        kind: rumbo_log::LogKind::Lab,
        ..log.manifest.unwrap()
    }
}

#[test]
fn a_file_of_more_than_it_can_hold_is_refused_with_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let commands = "[[command]]\nat_s = 0.1\nspeed_rpm = 60\n".repeat(10_001);
    std::fs::write(folder.join("many.toml"), scenario("t", 0.2) + &commands).unwrap();
    let message = stderr(&rumbo_in(folder, &["run", "many.toml"]));
    assert!(
        message.contains("command = 10003 tables: at most 10000"),
        "{message}"
    );
    let walls = "[[wall]]\nfrom_m = [0, 0]\nto_m = [1, 0]\n".repeat(1_001);
    std::fs::write(folder.join("walls.toml"), format!("title = \"w\"\n{walls}")).unwrap();
    let message = stderr(&rumbo_in(
        folder,
        &["run", "mode5", "--world", "walls.toml"],
    ));
    assert!(
        message.contains("wall = 1001 tables: at most 1000"),
        "{message}"
    );
}

#[cfg(unix)]
#[test]
fn a_log_names_no_program_but_the_one_that_ran() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let manifest = manifest(folder);
    for (program, image) in [
        ("/dev/zero", Some("00000000")),
        ("/dev/zero", None),
        ("o/task-1.json", None),
    ] {
        let manifest = Manifest {
            program: program.into(),
            image: image.map(str::to_owned),
            ..manifest.clone()
        };
        session(&folder.join("x.mcap"), &manifest, 10_000);
        let output = rumbo_in(folder, &["rerun", "x.mcap"]);
        let message = stderr(&output);
        assert_eq!(status(&output), 2, "{message}");
        assert!(
            message.contains("is gone or is another one now"),
            "{message}"
        );
    }
}

#[test]
fn times_and_steps_that_no_run_had_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let manifest = manifest(folder);
    let changed = |change: &dyn Fn(&mut Manifest)| {
        let mut manifest = manifest.clone();
        change(&mut manifest);
        session(&folder.join("x.mcap"), &manifest, 10_000);
        let output = rumbo_in(folder, &["rerun", "x.mcap"]);
        assert_eq!(status(&output), 2);
        stderr(&output)
    };
    let message = changed(&|manifest| manifest.step_us = u64::MAX);
    assert!(
        message.contains(
            "step_us = 18446744073709551615 in its manifest: must be within 1000..100000"
        ),
        "{message}"
    );
    let message = changed(&|manifest| manifest.step_us = 0);
    assert!(message.contains("step_us = 0 "), "{message}");
    let message = changed(&|manifest| manifest.texts = vec![(1e9, "ON".into())]);
    assert!(
        message.contains("texts = 1000000000 in its manifest: must be within 0..3600 s"),
        "{message}"
    );
    let message = changed(&|manifest| manifest.eeprom = Some("00".repeat(5_000)));
    assert!(
        message.contains("eeprom = 5000 in its manifest: must be at most 4096 bytes"),
        "{message}"
    );
    // A link with twelve days of traffic.
    session(&folder.join("x.mcap"), &manifest, 1_000_000 * 1_000_000);
    let output = rumbo_in(folder, &["rerun", "x.mcap"]);
    let message = stderr(&output);
    assert_eq!(status(&output), 2, "{message}");
    assert!(message.contains("must be within 0..604800 s"), "{message}");
}
