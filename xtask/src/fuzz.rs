//! `cargo xtask fuzz`: builds the targets of `fuzz/` for libFuzzer and runs them.
//!
//! cargo-fuzz needs a nightly compiler only for sanitizers: LLVM's coverage pass is enabled by codegen options of the
//! stable compiler. Without `unsafe` in the workspace there is nothing for a sanitizer to find. With `--target` the
//! options do not apply to build scripts.

use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Mutex;

use crate::project::{Project, metadata, output, run};

/// Seconds for each target by default.
const SECONDS: u32 = 60;
const FLAGS: [&str; 9] = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Ccodegen-units=1",
    "-Cdebug-assertions",
    "-Coverflow-checks",
    "--cfg=fuzzing",
];

/// Runs the targets named in `only` (all if empty), each for some seconds; true if none found anything.
pub(crate) fn campaign(
    project: &Project,
    seconds: Option<u32>,
    only: &[String],
) -> Result<bool, String> {
    let targets = targets(project)?;
    if let Some(unknown) = only.iter().find(|name| !targets.contains(name)) {
        return Err(format!(
            "no fuzz target `{unknown}`; targets: {}",
            targets.join(", ")
        ));
    }
    let programs = build(project)?;
    let chosen = targets
        .into_iter()
        .filter(|target| only.is_empty() || only.contains(target));
    let left = Mutex::new(chosen);
    let next = || left.lock().ok().and_then(|mut left| left.next());
    let seconds = seconds.unwrap_or(SECONDS);
    let worker = || {
        let mut clean = true;
        while let Some(target) = next() {
            clean &= fuzz(project, &programs, &target, seconds)?;
        }
        Ok::<_, String>(clean)
    };
    // A target is one thread.
    let count = std::thread::available_parallelism().map_or(1, NonZero::get);
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..count).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().try_fold(true, |clean, worker| {
            let found = worker
                .join()
                .map_err(|_| "a fuzz run panicked".to_owned())?;
            Ok(clean & found?)
        })
    })
}

/// Names of the targets.
fn targets(project: &Project) -> Result<Vec<String>, String> {
    let metadata = metadata(&project.root.join("fuzz/Cargo.toml"))?;
    let targets = metadata["packages"][0]["targets"].as_array();
    let names = targets
        .into_iter()
        .flatten()
        .filter_map(|target| target["name"].as_str());
    Ok(names.map(str::to_owned).collect())
}

/// Builds all targets; returns their folder.
fn build(project: &Project) -> Result<PathBuf, String> {
    let version = output(project.command("rustc").arg("-vV"))?;
    let host = version
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .ok_or("rustc -vV names no host")?;
    let folder = project.target.join("fuzz");
    let arguments = ["build", "--release", "--locked", "--target", host];
    run(project
        .cargo(&arguments)
        .args(["--manifest-path", "fuzz/Cargo.toml"])
        .env("CARGO_TARGET_DIR", &folder)
        .env("CARGO_ENCODED_RUSTFLAGS", FLAGS.join("\u{1f}")))?;
    Ok(folder.join(host).join("release"))
}

/// Runs one target; true if it found nothing.
fn fuzz(project: &Project, programs: &Path, target: &str, seconds: u32) -> Result<bool, String> {
    let folder = project.target.join("fuzz");
    let (corpus, findings) = (folder.join("corpus").join(target), folder.join("findings"));
    for folder in [&corpus, &findings] {
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let program = programs.join(format!("{target}{}", std::env::consts::EXE_SUFFIX));
    let prefix = format!("{}/{target}-", findings.display());
    // Inputs that reach new code go to the first folder; the other one is only read.
    let seeds = project.root.join("fuzz/seeds").join(target);
    let mut command = project.command(&program);
    command
        .arg(&corpus)
        .args(seeds.is_dir().then_some(&seeds))
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-artifact_prefix={prefix}"))
        .args(["-max_len=4096", "-timeout=20", "-print_final_stats=1"])
        .stdin(Stdio::null());
    let output = command
        .output()
        .map_err(|error| format!("{}: {error}", program.display()))?;
    let stderr = String::from_utf8_lossy(&output.stderr);
    if output.status.success() {
        let stat = |name: &str| {
            let line = stderr.lines().find_map(|line| line.strip_prefix(name));
            line.unwrap_or("?").trim().to_owned()
        };
        println!(
            "{target}: {} inputs in {seconds} s, {} of them reached new code, nothing found",
            stat("stat::number_of_executed_units:"),
            stat("stat::new_units_added:"),
        );
    } else {
        let lines: Vec<&str> = stderr.lines().collect();
        let last = lines.len().saturating_sub(40);
        println!("{}", lines[last..].join("\n"));
        println!(
            "{target}: the input is in {}, and `{} FILE` runs it again",
            findings.display(),
            program.display()
        );
    }
    Ok(output.status.success())
}
