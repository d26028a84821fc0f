//! The logs that pile up.

use super::{rumbo_in, scenario, status};
use crate::support::{stderr, stdout};
use std::fs::File;
use std::time::{Duration, SystemTime};

#[test]
fn old_logs_go_when_that_is_asked_for_and_nothing_else_does() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("task.toml"), scenario("t", 0.2)).unwrap();
    rumbo_in(folder, &["run", "task.toml", "--runs", "3"]);
    let logs = folder.join("logs");
    std::fs::write(logs.join("thesis.mcap"), "no log").unwrap();
    std::fs::write(logs.join("notes.txt"), "mine").unwrap();
    let days_ago = |name: &std::path::Path, days: u64| {
        let then = SystemTime::now() - Duration::from_secs(86_400 * days);
        File::options()
            .write(true)
            .open(name)
            .unwrap()
            .set_modified(then)
            .unwrap();
    };
    let names = || {
        let files = std::fs::read_dir(&logs).unwrap();
        let mut names: Vec<_> = files.map(|file| file.unwrap().path()).collect();
        names.sort();
        names
    };
    let all = names();
    assert_eq!(all.len(), 5);
    days_ago(&all[0], 40);
    days_ago(&all[1], 20);
    days_ago(&logs.join("thesis.mcap"), 400);
    days_ago(&logs.join("notes.txt"), 400);
    let listed = stdout(&rumbo_in(folder, &["list", "logs"]));
    assert!(
        listed.lines().last().unwrap().starts_with("4 logs, 0."),
        "{listed}"
    );

    let tried = rumbo_in(folder, &["prune", "--keep-days", "30", "--dry-run"]);
    assert!(
        stdout(&tried).contains("1 log would be removed"),
        "{}",
        stdout(&tried)
    );
    assert_eq!(names(), all);
    let pruned = rumbo_in(folder, &["prune", "--keep-days", "30"]);
    assert_eq!(status(&pruned), 0, "{}", stderr(&pruned));
    assert_eq!(
        stdout(&pruned).lines().next().unwrap(),
        all[0].display().to_string()
    );
    assert_eq!(names(), all[1..]);
    assert_eq!(status(&rumbo_in(folder, &["prune"])), 2);
}
