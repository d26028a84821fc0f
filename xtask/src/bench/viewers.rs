//! Twenty pages at once: their cost, and their effect on the session.

use std::time::{Duration, Instant};

use serde_json::json;

use super::{Figure, process};
use crate::lab::{Lab, Page};
use crate::project::Project;

const PAGES: usize = 20;
/// How long it is watched.
const WATCH: Duration = Duration::from_secs(10);
/// Presses of STOP.
const STOPS: usize = 20;

/// With one page and with twenty, one of which reads nothing at all.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let mut start = project.command(project.release_binary_path());
    start.arg("lab");
    let mut lab = Lab::start(start)?;
    let mut driver = lab.open()?;
    let alone_ms = stops(&mut driver)?;
    // Kept open, never read.
    let _stuck = lab.open()?;
    let mut readers = Vec::new();
    let end = Instant::now() + WATCH + Duration::from_secs(15);
    for _ in 0..PAGES - 2 {
        let mut page = lab.open()?;
        readers.push(std::thread::spawn(move || -> Result<usize, String> {
            let mut rows = 0;
            while Instant::now() < end {
                rows += page.read()?["rows"].as_array().map_or(0, Vec::len);
            }
            Ok(rows)
        }));
    }
    let together_ms = stops(&mut driver)?;
    let cpu = process::cpu_percent(lab.pid(), WATCH)?;
    let mut slowest = f64::INFINITY;
    let until = Instant::now() + Duration::from_secs(4);
    while Instant::now() < until {
        let message = driver.read()?;
        if let Some(speed) = message["state"]["achieved_speed"].as_f64() {
            slowest = slowest.min(speed);
        }
    }
    let resident_mb = process::resident_mb(lab.pid())?;
    let mut fewest = usize::MAX;
    for reader in readers {
        let rows = reader.join().map_err(|_| "a page failed".to_owned())??;
        fewest = fewest.min(rows);
    }
    let per_s = fewest as f64 / (WATCH.as_secs_f64() + 15.0);
    Ok(vec![
        Figure::new(
            format!("lab: {PAGES} pages, one of them stuck"),
            format!("simulated time x {slowest:.2}, {cpu:.0} % of a core, {resident_mb:.0} MB"),
            "undisturbed",
        ),
        Figure::new(
            format!("lab: samples to the slowest of {PAGES} pages"),
            format!("{per_s:.1} samples/s and the past"),
            "25 samples/s",
        ),
        Figure::new(
            format!(
                "lab: STOP to its acknowledgement on the page, median: one page, {PAGES} pages"
            ),
            format!("{alone_ms:.0} ms, {together_ms:.0} ms"),
            "",
        ),
    ])
}

/// Median time from STOP to its acknowledgement [ms].
fn stops(page: &mut Page) -> Result<f64, String> {
    let mut took_ms = Vec::new();
    for _ in 0..STOPS {
        let begin = Instant::now();
        page.send(&json!({"type": "stop"}))?;
        let done = |message: &serde_json::Value| {
            let mut events = message["events"].as_array().into_iter().flatten();
            events.any(|event| event["text"] == "STOP: done")
        };
        while !done(&page.read()?) {}
        took_ms.push(begin.elapsed().as_secs_f64() * 1e3);
        let rest = Instant::now() + Duration::from_millis(130);
        while Instant::now() < rest {
            page.read()?;
        }
    }
    took_ms.sort_by(f64::total_cmp);
    Ok(took_ms[STOPS / 2])
}
