//! What opens the browser, and who can read it.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use support::{Page, Running, program};

/// Stands for the desktop's program that opens files: keeps its command line and a copy of the file.
const OPENER: &str = "#!/bin/sh\ncp -p \"$1\" \"$0.copy\"\necho \"$@\" > \"$0.line\"\n";
/// Long enough for any machine; nothing is judged by it.
const PATIENCE: Duration = Duration::from_secs(60);

fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let until = Instant::now() + PATIENCE;
    while !done() {
        assert!(Instant::now() < until, "never: {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A lab that opens the browser, with an opener in this folder; what the opener was given.
fn open(folder: &Path) -> (Running, PathBuf) {
    let opener = folder.join("xdg-open");
    std::fs::write(&opener, OPENER).unwrap();
    std::fs::set_permissions(&opener, PermissionsExt::from_mode(0o700)).unwrap();
    let path = std::env::var("PATH").unwrap();
    let lab = Running::of(
        program()
            .args(["lab", "--port", "0"])
            .env("PATH", format!("{}:{path}", folder.display()))
            .env("XDG_RUNTIME_DIR", folder)
            .env("HOME", folder),
    );
    let line = folder.join("xdg-open.line");
    wait_until("the browser is opened", || {
        std::fs::read_to_string(&line).is_ok_and(|line| line.ends_with('\n'))
    });
    let line = std::fs::read_to_string(line).unwrap();
    assert!(!line.contains("token"), "everybody can read: {line}");
    (lab, line.trim().into())
}

#[test]
fn the_token_is_in_a_file_that_only_the_user_can_read_until_it_is_used() {
    let folder = tempfile::tempdir().unwrap();
    let (lab, file) = open(folder.path());
    assert!(file.starts_with(folder.path()), "{}", file.display());
    let mode = file.metadata().unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600, "{}", file.display());
    let html = std::fs::read_to_string(folder.path().join("xdg-open.copy")).unwrap();
    assert!(html.contains(&format!("url={}\"", lab.said)), "{html}");

    let mut page = Page::open(&lab.said);
    page.wait_for_event("connected");
    wait_until("the file is gone", || !file.exists());
    lab.end();
}

#[test]
fn an_end_before_the_browser_came_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let (lab, file) = open(folder.path());
    lab.end();
    assert!(!file.exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_program_of_the_user_finds_the_key_by_the_port_as_long_as_the_session_lasts() {
    let folder = tempfile::tempdir().unwrap();
    let lab = Running::of(
        program()
            .args(["lab", "--no-browser", "--port", "0"])
            .env("XDG_RUNTIME_DIR", folder.path()),
    );
    let host = lab.said.split('/').nth(2).unwrap().to_owned();
    let (_, port) = host.rsplit_once(':').unwrap();
    let file = folder.path().join(format!("rumbo-{port}.key"));
    let mode = file.metadata().unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o600, "{}", file.display());
    let key = std::fs::read_to_string(&file).unwrap();
    Page::at(&host, "/ws", &key).wait_for_event("connected");
    lab.end();
    assert!(!file.exists());
}
