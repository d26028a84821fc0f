//! `rumbo lab` at real time: its response times, and its CPU without and with a connected page.

use std::time::{Duration, Instant};

use super::{Figure, process};
use crate::lab::Lab;
use crate::project::Project;

/// Duration of the CPU measurement.
const WATCH: Duration = Duration::from_secs(10);

/// Start times, CPU and memory.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let mut start = project.command(project.release_binary_path());
    start.arg("lab");
    let begin = Instant::now();
    let mut lab = Lab::start(start)?;
    let address = begin.elapsed();
    lab.page()?;
    let page = begin.elapsed();
    let mut socket = lab.socket()?;
    let first = loop {
        if samples(
            &socket
                .read()
                .map_err(|error| format!("WebSocket: {error}"))?,
        ) > 0
        {
            break begin.elapsed();
        }
    };
    let reader = std::thread::spawn(move || {
        let (mut rows, mut bytes) = (0, 0);
        let end = Instant::now() + WATCH;
        while Instant::now() < end {
            let Ok(message) = socket.read() else { break };
            rows += samples(&message);
            bytes += message.len();
        }
        (rows, bytes)
    });
    let watched = process::cpu_percent(lab.pid(), WATCH)?;
    let (rows, bytes) = reader
        .join()
        .map_err(|_| "the WebSocket client failed".to_owned())?;
    let resident = process::resident_mb(lab.pid())?;
    let alone = process::cpu_percent(lab.pid(), WATCH)?;
    let per_s = |count: usize| count as f64 / WATCH.as_secs_f64();
    Ok(vec![
        Figure::new(
            "lab: start to address printed",
            format!("{} ms", address.as_millis()),
            "",
        ),
        Figure::new(
            "lab: start to page fetched",
            format!("{} ms", page.as_millis()),
            "",
        ),
        Figure::new(
            "lab: start to first telemetry on the WebSocket",
            format!("{} ms", first.as_millis()),
            "1 s",
        ),
        Figure::new(
            "lab: telemetry on the WebSocket",
            format!(
                "{:.1} samples/s, {:.1} kB/s",
                per_s(rows),
                per_s(bytes) / 1e3
            ),
            "25 samples/s",
        ),
        Figure::new(
            "lab: CPU, no page",
            format!("{alone:.1} % of a core"),
            "10 %",
        ),
        Figure::new(
            "lab: CPU, one client",
            format!("{watched:.1} % of a core"),
            "10 %",
        ),
        Figure::new("lab: memory", format!("{resident:.0} MB"), "100 MB"),
    ])
}

/// How many samples of the signals a message carries.
fn samples(message: &tungstenite::Message) -> usize {
    let message = message
        .to_text()
        .ok()
        .and_then(|text| serde_json::from_str::<serde_json::Value>(text).ok());
    message
        .and_then(|message| message["rows"].as_array().map(Vec::len))
        .unwrap_or(0)
}
