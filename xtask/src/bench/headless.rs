//! How much faster than real time `rumbo run --no-record` is: one robot, one thread, all noise on.

use std::time::{Duration, Instant};

use super::Figure;
use crate::project::{Project, output};

const SCENARIOS: [&str; 3] = ["mode1", "mode5", "mode8-random"];

/// Wall time to measure over.
const LONG_ENOUGH: Duration = Duration::from_secs(4);

/// Simulated seconds per wall second of each scenario; the start of the program is measured apart and taken off.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let start = wall_time(project, &["list"])?;
    let mut figures = vec![Figure::new(
        "`rumbo list`, start to end",
        format!("{} ms", start.as_millis()),
        "",
    )];
    for scenario in SCENARIOS {
        let duration_s = duration_s(project, scenario)?;
        let mut runs = 1;
        let (wall, runs) = loop {
            let seeds = runs.to_string();
            let wall = wall_time(
                project,
                &[
                    "run",
                    scenario,
                    "--runs",
                    &seeds,
                    "--threads",
                    "1",
                    "--json",
                    "--no-record",
                ],
            )?;
            let wall = wall.saturating_sub(start);
            if wall >= LONG_ENOUGH / 2 {
                break (wall, runs);
            }
            let times = LONG_ENOUGH.as_secs_f64() / wall.as_secs_f64().max(0.001);
            runs = ((f64::from(runs) * times).ceil() as u32).clamp(runs * 2, 100_000);
        };
        let ratio = f64::from(runs) * duration_s / wall.as_secs_f64();
        let what = format!("`rumbo run {scenario} --threads 1`, {runs} runs of {duration_s} s");
        figures.push(Figure::new(
            what,
            format!("{ratio:.0} x real time"),
            "1,000 x (aim 5,000 x)",
        ));
    }
    Ok(figures)
}

/// Runs `rumbo` and gives the time it took; a missed limit (exit status 1) is a result like any other here.
fn wall_time(project: &Project, args: &[&str]) -> Result<Duration, String> {
    let rumbo = project.release_binary_path();
    let start = Instant::now();
    match output(project.command(rumbo).args(args)) {
        Err(error) if !error.contains("exit status: 1") => Err(error),
        _ => Ok(start.elapsed()),
    }
}

/// `duration_s` of a scenario file.
fn duration_s(project: &Project, scenario: &str) -> Result<f64, String> {
    let path = project
        .root
        .join("scenarios")
        .join(format!("{scenario}.toml"));
    let text =
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let value = text.lines().find_map(|line| {
        line.strip_prefix("duration_s")?
            .trim_start()
            .strip_prefix('=')
    });
    let number = value.and_then(|value| value.split('#').next()?.trim().parse().ok());
    number.ok_or_else(|| format!("{}: no `duration_s`", path.display()))
}
