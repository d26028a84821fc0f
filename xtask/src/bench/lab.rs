//! `rumbo lab` at real time: how soon it answers, and what it costs with nobody looking and with a page connected.

use std::time::{Duration, Instant};

use super::{Figure, process};
use crate::lab::Lab;
use crate::project::Project;

/// How long CPU time is watched.
const WATCH: Duration = Duration::from_secs(10);

/// Start times, CPU and memory.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let mut start = project.command(project.release_binary_path());
    start.arg("lab");
    let begin = Instant::now();
    let lab = Lab::start(start)?;
    let address = begin.elapsed();
    lab.page()?;
    let page = begin.elapsed();
    let mut socket = lab.socket()?;
    let first = loop {
        if is_telemetry(
            &socket
                .read()
                .map_err(|error| format!("WebSocket: {error}"))?,
        ) {
            break begin.elapsed();
        }
    };
    let reader = std::thread::spawn(move || {
        let (mut messages, mut bytes) = (0_u32, 0_usize);
        let end = Instant::now() + WATCH;
        while Instant::now() < end {
            let Ok(message) = socket.read() else { break };
            messages += u32::from(is_telemetry(&message));
            bytes += message.len();
        }
        (messages, bytes)
    });
    let watched = process::cpu_percent(lab.pid(), WATCH)?;
    let (messages, bytes) = reader
        .join()
        .map_err(|_| "the WebSocket client failed".to_owned())?;
    let resident = process::resident_mb(lab.pid())?;
    let alone = process::cpu_percent(lab.pid(), WATCH)?;
    let per_s = |count: f64| count / WATCH.as_secs_f64();
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
                "{:.1} messages/s, {:.1} kB/s",
                per_s(messages.into()),
                per_s(bytes as f64) / 1e3
            ),
            "25 frames/s",
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

/// Whether a message carries samples of the signals.
fn is_telemetry(message: &tungstenite::Message) -> bool {
    message
        .to_text()
        .is_ok_and(|text| text.contains("\"samples\""))
}
