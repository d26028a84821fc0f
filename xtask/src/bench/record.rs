//! Recording: sessions killed at random moments, an hour of log, the port pulled out and put back.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::{Figure, process};
use crate::lab::{Lab, Page};
use crate::project::{Project, run};

/// Sessions that are killed.
const KILLED: u32 = 50;
/// Length of the long log \[s\].
const HOUR_S: f64 = 3_600.0;
/// Seeks in it.
const SEEKS: u32 = 40;

/// All of it.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let folder = project.target.join("tmp/bench-record");
    // Of an earlier time.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut figures = vec![killed(project, &folder)?];
    figures.extend(an_hour(project, &folder)?);
    #[cfg(unix)]
    figures.push(pulled_out(project, &folder)?);
    Ok(figures)
}

/// Kills sessions, and measures what is missing in their logs.
fn killed(project: &Project, folder: &Path) -> Result<Figure, String> {
    let (mut worst_s, mut unreadable) = (0.0_f64, 0);
    for number in 0..KILLED {
        let logs = folder.join(format!("killed-{number}"));
        let mut lab = Lab::start_in(rumbo(project, &["lab"]), &logs)?;
        let mut page = lab.open()?;
        page.send(&json!({"type": "arm"}))?;
        // Scattered over 0.5 to 2.5 s.
        let lives = Duration::from_millis(500 + u64::from(number * 7_919 % 2_000));
        let until = Instant::now() + lives;
        let mut shown_s = 0.0;
        while Instant::now() < until {
            let message = page.read()?;
            shown_s = last_row_s(&message).unwrap_or(shown_s);
        }
        drop(lab);
        let csv = folder.join("csv");
        let log = only_file(&logs)?;
        let mut export = rumbo(project, &["export", "--format", "csv", "--out"]);
        export
            .arg(&csv)
            .arg(&log)
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        if run(&mut export).is_err() {
            unreadable += 1;
            continue;
        }
        let name = log
            .file_stem()
            .map(Path::new)
            .unwrap_or(&log)
            .with_extension("csv");
        let text = std::fs::read_to_string(csv.join(name)).map_err(|error| error.to_string())?;
        let last_s: f64 = text
            .lines()
            .last()
            .and_then(|row| row.split(',').next()?.parse().ok())
            .unwrap_or(0.0);
        worst_s = worst_s.max(shown_s - last_s);
    }
    Ok(Figure::new(
        format!("record: {KILLED} sessions killed (SIGKILL)"),
        format!("{unreadable} unreadable, at most {:.2} s missing", worst_s),
        "0, 1 s",
    ))
}

/// Records an hour, as fast as possible, and replays it.
fn an_hour(project: &Project, folder: &Path) -> Result<Vec<Figure>, String> {
    let logs = folder.join("hour");
    let start = rumbo(
        project,
        &["lab", "--scenario", "mode7-repeat", "--speed", "100"],
    );
    let mut lab = Lab::start_in(start, &logs)?;
    let mut page = lab.open()?;
    page.send(&json!({"type": "arm"}))?;
    while page.read()?["state"]["t_s"].as_f64().unwrap_or(0.0) < HOUR_S {}
    let resident_mb = process::resident_mb(lab.pid())?;
    drop(page);
    lab.end()?;
    let log = only_file(&logs)?;
    let size_mb = log.metadata().map_or(0.0, |data| data.len() as f64 / 1e6);

    let mut start = rumbo(project, &["replay", "--speed", "0"]);
    start.arg(&log);
    let begin = Instant::now();
    let mut replay = Lab::start_plain(start)?;
    replay.page()?;
    let opened = begin.elapsed();
    let mut page = replay.open()?;
    let mut took_ms: Vec<f64> = Vec::new();
    for number in 0..SEEKS {
        let t_s = f64::from(number * 7_919 % 3_500) + 60.0;
        let begin = Instant::now();
        page.send(&json!({"type": "seek", "t_s": t_s}))?;
        // The last row before that place.
        while last_row_s(&page.read()?).is_none_or(|row_s| (row_s - t_s).abs() > 0.1) {}
        took_ms.push(begin.elapsed().as_secs_f64() * 1e3);
    }
    took_ms.sort_by(f64::total_cmp);
    let p95 = took_ms[took_ms.len() * 95 / 100];
    let shown_mb = process::resident_mb(replay.pid())?;
    Ok(vec![
        Figure::new(
            "record: memory with an hour recorded",
            format!("{resident_mb:.0} MB"),
            "150 MB",
        ),
        Figure::new("record: an hour of log", format!("{size_mb:.0} MB"), ""),
        Figure::new(
            "replay: an hour of log, start to page",
            format!("{} ms", opened.as_millis()),
            "2 s",
        ),
        Figure::new(
            "replay: scrub in it to the last sample, p95",
            format!("{p95:.0} ms"),
            "100 ms",
        ),
        Figure::new(
            "replay: memory with an hour of log",
            format!("{shown_mb:.0} MB"),
            "",
        ),
    ])
}

/// A robot behind a name that is taken away and given to another.
#[cfg(unix)]
fn pulled_out(project: &Project, folder: &Path) -> Result<Figure, String> {
    let port = folder.join("port");
    let mut robot = Robot::at(project, &port)?;
    let mut connect = rumbo(project, &["connect"]);
    connect.arg(&port);
    let mut lab = Lab::start_in(connect, &folder.join("port-logs"))?;
    let mut page = lab.open()?;
    let connected = |page: &mut Page, wanted: bool| -> Result<Value, String> {
        loop {
            let state = page.read()?["state"].take();
            if state["link"]["connected"] == wanted {
                return Ok(state);
            }
        }
    };
    let mut worst = Duration::ZERO;
    let mut armed = false;
    for _ in 0..5 {
        connected(&mut page, true)?;
        page.send(&json!({"type": "arm"}))?;
        while page.read()?["state"]["robot"]["armed"] != true {}
        drop(robot);
        connected(&mut page, false)?;
        robot = Robot::at(project, &port)?;
        let begin = Instant::now();
        let state = connected(&mut page, true)?;
        worst = worst.max(begin.elapsed());
        armed |= state["robot"]["armed"] == true && state["t_s"].is_null();
        let later = Instant::now() + Duration::from_millis(500);
        while Instant::now() < later {
            armed |= page.read()?["rows"]
                .as_array()
                .is_some_and(|rows| rows.iter().any(|row| row[3] == 1.0));
        }
    }
    let armed = if armed {
        "ARMED BY ITSELF"
    } else {
        "never armed by that"
    };
    Ok(Figure::new(
        "connect: port back to first frame, worst of 5",
        format!("{} ms, {armed}", worst.as_millis()),
        "2 s",
    ))
}

/// A simulated robot behind a pseudo terminal, under a name.
#[cfg(unix)]
struct Robot(Child, PathBuf);

#[cfg(unix)]
impl Robot {
    fn at(project: &Project, port: &Path) -> Result<Self, String> {
        use std::io::{BufRead, BufReader};
        let mut command = rumbo(project, &["lab", "--pty", "--scenario", "mode5"]);
        let child = command.stdout(Stdio::piped()).spawn();
        let mut child = child.map_err(|error| format!("rumbo lab --pty: {error}"))?;
        let mut name = String::new();
        let stdout = child.stdout.take().ok_or("no output")?;
        let read = BufReader::new(stdout).read_line(&mut name);
        read.map_err(|error| error.to_string())?;
        let linked = std::os::unix::fs::symlink(name.trim(), port);
        linked.map_err(|error| format!("{}: {error}", port.display()))?;
        Ok(Self(child, port.to_owned()))
    }
}

#[cfg(unix)]
impl Drop for Robot {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
        let _ = std::fs::remove_file(&self.1);
    }
}

fn rumbo(project: &Project, arguments: &[&str]) -> Command {
    let mut command = project.command(project.release_binary_path());
    command.args(arguments);
    command
}

/// Time of the last row in a message \[s\].
fn last_row_s(message: &Value) -> Option<f64> {
    message["rows"].as_array()?.last()?[0].as_f64()
}

fn only_file(folder: &Path) -> Result<PathBuf, String> {
    let error = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut files = std::fs::read_dir(folder).map_err(error)?;
    let file = files
        .next()
        .ok_or_else(|| format!("{}: is empty", folder.display()))?;
    Ok(file.map_err(error)?.path())
}
