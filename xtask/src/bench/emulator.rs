//! How much faster than real time a firmware runs: the emulated Mega with the simulated robot around it, and simavr with the same
//! image and nothing around it.
//!
//! Then CPUs alone, with an image that only computes: ours, simavr, and fastavr and CUzeBox where `FASTAVR` and `CUZEBOX` name
//! programs that take an image in Intel HEX and end with it: fastavr's `tester`, and what calls CUzeBox's `cu_avr_run` until
//! GPIOR0 is 0xA5.
//!
//! All are measured in processor time, which other load on the machine changes little.

use std::path::{Path, PathBuf};

use super::Figure;
use crate::project::{Project, output, run};

/// Simulated seconds: what the scenario lasts, and a little more than that for the image, which then ends simavr.
const SCENARIO: &str = "free";
const SCENARIO_S: f64 = 10.0;
/// Runs in one go, for the clock of `times` is coarse.
const RUNS: u32 = 5;
const IMAGE_S: f64 = 11.0;
/// What the computing image takes on a Mega.
const COMPUTE_S: f64 = 33.59;
/// The shortest of several measurements is the least disturbed one.
const TIMES: usize = 5;

/// Factors over real time of a firmware that waits in a loop, and of ones that sleep.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let busy = image(project, "atmega2560", "busy", 1000)?;
    let start_s = shortest(|| cpu_s(project, &project.release_binary_path(), &["list"]))?;
    let ours = |image: &Path| {
        let path = image.display().to_string();
        let runs = RUNS.to_string();
        let head = [
            "run",
            SCENARIO,
            "--threads",
            "1",
            "--json",
            "--no-record",
            "--runs",
            &runs,
        ];
        let arguments = [&head[..], &["--firmware", &path]].concat();
        shortest(|| cpu_s(project, &project.release_binary_path(), &arguments))
            .map(|cpu_s| f64::from(RUNS) * SCENARIO_S / (cpu_s - start_s).max(0.001))
    };
    let what = |how, hertz| {
        format!(
            "`rumbo run {SCENARIO} --firmware`: float PID and odometry at {hertz} Hz, {how} between"
        )
    };
    let busy_factor = ours(&busy)?;
    let times = |factor| format!("{factor:.0} x real time");
    let mut figures = vec![Figure::new(
        what("waiting", 1000),
        times(busy_factor),
        "20 x",
    )];
    // A thousand times a second it computes for three quarters of the time.
    for (hertz, budget) in [(1000, ""), (100, "60 x")] {
        let factor = ours(&image(project, "atmega2560", "sleepy", hertz)?)?;
        figures.push(Figure::new(what("asleep", hertz), times(factor), budget));
    }
    let path = busy.display().to_string();
    let arguments = ["-m", "atmega2560", "-f", "16000000", &path];
    let simavr_s = shortest(|| cpu_s(project, Path::new("simavr"), &arguments))?;
    let factor = IMAGE_S / simavr_s.max(0.001);
    figures.push(Figure::new(
        "the same image, waiting, on simavr without a robot",
        format!("{factor:.1} x real time"),
        "",
    ));
    figures.push(Figure::new(
        "ours over simavr's",
        format!("{:.1}", busy_factor / factor),
        "3",
    ));
    figures.extend(computing(project)?);
    Ok(figures)
}

/// The CPU alone.
fn computing(project: &Project) -> Result<Vec<Figure>, String> {
    run(&mut project.cargo(&["build", "--release", "--locked", "-p", "rumbo-tools"]))?;
    let elf = image(project, "atmega2560", "compute", 1000)?;
    let shown = elf.display().to_string();
    let ours = project.target.join("release/rumbo-tools");
    let mut programs = vec![
        (
            "ours",
            ours,
            vec!["alone".to_owned(), shown.clone(), "34".to_owned()],
        ),
        (
            "simavr",
            PathBuf::from("simavr"),
            ["-m", "atmega2560", "-f", "16000000", &shown]
                .map(str::to_owned)
                .to_vec(),
        ),
    ];
    let others = [
        ("fastavr", "FASTAVR", "atmega2560"),
        ("CUzeBox", "CUZEBOX", "atmega644"),
    ];
    for (name, variable, chip) in others {
        if let Some(program) = std::env::var_os(variable) {
            let elf = image(project, chip, "compute", 1000)?;
            let hex = elf.with_extension("hex");
            run(project
                .command("avr-objcopy")
                .args(["-O", "ihex"])
                .args([&elf, &hex]))?;
            programs.push((name, program.into(), vec![hex.display().to_string()]));
        }
    }
    let figure = |(name, program, arguments): (&str, PathBuf, Vec<String>)| {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let cpu_s = shortest(|| cpu_s(project, &program, &arguments))?;
        Ok(Figure::new(
            format!("an image that only computes, CPU alone: {name}"),
            format!("{:.1} x real time", COMPUTE_S / cpu_s.max(0.001)),
            "",
        ))
    };
    programs.into_iter().map(figure).collect()
}

/// Builds a program of the emulator's tests.
fn image(project: &Project, chip: &str, name: &str, hertz: u32) -> Result<PathBuf, String> {
    let folder = project.target.join("bench");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let image = folder.join(format!("{name}{hertz}-{chip}.elf"));
    let source = project
        .root
        .join("crates/emulator/tests/programs")
        .join(format!("{name}.c"));
    let mmcu = format!("-mmcu={chip}");
    let (seconds, hertz) = (format!("-DSECONDS={IMAGE_S}"), format!("-DHERTZ={hertz}"));
    let options = [
        &mmcu,
        "-Os",
        "-std=gnu11",
        "-DF_CPU=16000000UL",
        &seconds,
        &hertz,
    ];
    run(project
        .command("avr-gcc")
        .args(options)
        .arg(source)
        .arg("-o")
        .arg(&image)
        .arg("-lm"))
    .map_err(|error| format!("{error}; `apt-get install gcc-avr avr-libc simavr`"))?;
    Ok(image)
}

fn shortest(mut measure: impl FnMut() -> Result<f64, String>) -> Result<f64, String> {
    let times: Result<Vec<f64>, String> = (0..TIMES).map(|_| measure()).collect();
    Ok(times?.into_iter().fold(f64::INFINITY, f64::min))
}

/// The processor's time that a program takes; how it ends does not matter.
fn cpu_s(project: &Project, program: &Path, arguments: &[&str]) -> Result<f64, String> {
    let mut shell = project.command("sh");
    // The shell reports its children's times.
    shell
        .args(["-c", "\"$@\" >/dev/null 2>&1; times", "sh"])
        .arg(program)
        .args(arguments);
    let text = output(&mut shell)?;
    children_s(&text).ok_or_else(|| format!("`times` says `{text}`"))
}

/// The second line of what `times` prints: user and system time of the children, such as `0m1.42s 0m0.07s`.
fn children_s(text: &str) -> Option<f64> {
    let seconds = |word: &str| {
        let (minutes, rest) = word.strip_suffix('s')?.split_once('m')?;
        Some(60.0 * minutes.parse::<f64>().ok()? + rest.parse::<f64>().ok()?)
    };
    text.lines().nth(1)?.split_whitespace().map(seconds).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_childrens_time_is_the_second_line() {
        assert_eq!(
            children_s("0m0.00s 0m0.01s\n1m2.50s 0m0.25s\n"),
            Some(62.75)
        );
        assert_eq!(children_s("0m0.00s 0m0.01s\n"), None);
    }
}
