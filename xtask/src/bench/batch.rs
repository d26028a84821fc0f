//! Many robots on the common task: the plant alone and with the whole control program, beside rapier2d, and several in one world, by `crates/experiment/examples/batch_speed.rs` and `tools/rapier/`.
//!
//! The programs run by turns, one thread counts by its time on a processor, and each figure is the median of its rounds:
//! ratios hold on a machine with other work. What two threads gain is by the clock on the wall, and needs an idle one.

use std::collections::BTreeMap;

use super::Figure;
use crate::project::{Project, output, run};

/// How often each program runs.
const ROUNDS: usize = 5;
/// Simulated time of each measurement [s].
const SECONDS: &str = "10";
/// Robots of rapier2d, and their steps.
const RAPIER: [&str; 2] = ["64", "500"];

/// What was measured, on how many threads, each round.
type Rounds = BTreeMap<(String, u32), Vec<f64>>;

pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let target = project.target.join("rapier");
    run(&mut project.cargo(&[
        "build",
        "--release",
        "--locked",
        "-p",
        "rumbo-experiment",
        "--example",
        "batch_speed",
    ]))?;
    run(project
        .cargo(&["build", "--release", "--locked"])
        .args(["--manifest-path", "tools/rapier/Cargo.toml"])
        .arg("--target-dir")
        .arg(&target))?;
    let ours = project.target.join("release/examples/batch_speed");
    let rapier = target.join("release/rumbo-rapier");
    let mut rounds = Rounds::new();
    for _ in 0..ROUNDS {
        let steps = output(project.command(&rapier).args(RAPIER))?;
        read(&format!("rapier2d 1 {steps}"), &mut rounds)?;
        read(&output(project.command(&ours).arg(SECONDS))?, &mut rounds)?;
    }
    figures(rounds)
}

/// Lines of what, threads, value.
fn read(text: &str, rounds: &mut Rounds) -> Result<(), String> {
    for line in text.lines() {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let [what, threads, value] = fields[..] else {
            return Err(format!("cannot read `{line}`"));
        };
        let (Ok(threads), Ok(value)) = (threads.parse(), value.parse()) else {
            return Err(format!("cannot read the numbers of `{line}`"));
        };
        let key = (what.to_owned(), threads);
        rounds.entry(key).or_default().push(value);
    }
    Ok(())
}

fn figures(mut rounds: Rounds) -> Result<Vec<Figure>, String> {
    let mut median = |what: &str, threads| {
        let key = (what.to_owned(), threads);
        let values = rounds
            .get_mut(&key)
            .ok_or_else(|| format!("no `{what} {threads}`"))?;
        values.sort_by(f64::total_cmp);
        Ok::<f64, String>(values[values.len() / 2])
    };
    let rapier = median("rapier2d", 1)?;
    let mut figures = vec![Figure::new(
        "rapier2d, no noise: steps of 10 ms a second, one thread",
        format!("{:.2} M", rapier / 1e6),
        "",
    )];
    for (what, name, budget) in [
        ("plant", "plant, all noise, ten steps of 1 ms", "0.78 M"),
        (
            "caller",
            "whole control program, commanded by the caller",
            "1.5 M",
        ),
        (
            "scenario",
            "whole control program, by its scenario over the link",
            "",
        ),
    ] {
        let here = median(what, 1)?;
        figures.push(Figure::new(
            name,
            format!("{:.2} M, {:.1} x rapier2d", here / 1e6, here / rapier),
            budget,
        ));
    }
    let ns = |per_second: f64| 1e9 / per_second;
    let plant = ns(median("plant", 1)?);
    let caller = ns(median("caller", 1)?);
    let scenario = ns(median("scenario", 1)?);
    figures.push(Figure::new(
        "where a tick's time goes",
        format!(
            "plant {plant:.0} ns; robot, observations {:.0} ns; link, operator {:.0} ns",
            caller - plant,
            scenario - caller
        ),
        "",
    ));
    let scaling = median("caller-wall", 2)? / median("caller-wall", 1)? / 2.0;
    figures.push(Figure::new(
        "from one thread to two",
        format!("{:.0} %", 100.0 * scaling),
        "95 %",
    ));
    let alone = median("together-1", 1)?;
    for robots in [4, 16] {
        let each = median(&format!("together-{robots}"), 1)?;
        figures.push(Figure::new(
            format!(
                "{robots} robots in one world, the whole control program of each by its scenario"
            ),
            format!(
                "{:.0} x real time; a robot takes {:.2} x the time of one alone",
                each / 100.0 / f64::from(robots),
                alone / each
            ),
            "",
        ));
    }
    let bytes = median("memory", 1)?;
    figures.push(Figure::new(
        "memory of a robot in a batch",
        format!("{:.1} KB", bytes / 1024.0),
        "4 KB",
    ));
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_of_the_rounds_become_ratios() {
        let mut rounds = Rounds::new();
        for [slow, fast] in [[1, 2], [3, 9], [2, 5]] {
            let mut text = format!("rapier2d 1 {slow}00000\nmemory 1 3072\n");
            for (robots, speed) in [(1, 8), (4, 4), (16, 2)] {
                text += &format!("together-{robots} 1 {speed}00000\n");
            }
            for what in ["plant", "caller", "scenario", "caller-wall"] {
                for threads in [1, 2] {
                    text += &format!("{what} {threads} {fast}00000\n");
                }
            }
            read(&text, &mut rounds).unwrap();
        }
        let figures = figures(rounds).unwrap();
        let plant = figures.iter().find(|figure| figure.what.ends_with("1 ms"));
        assert_eq!(plant.unwrap().measured, "0.50 M, 2.5 x rapier2d");
        let fleet = figures.iter().find(|figure| figure.what.starts_with("4 "));
        assert_eq!(
            fleet.unwrap().measured,
            "1000 x real time; a robot takes 2.00 x the time of one alone"
        );
        assert!(read("plant 1", &mut Rounds::new()).is_err());
    }
}
