//! Instructions of pieces of work (`tools/src/counts.rs`), which creep unseen in times: by callgrind, beside those of
//! `xtask/counts.toml`.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Deserialize;

use super::Figure;
use crate::project::{Project, output, run};
use crate::tools::{self, Stop};

const FILE: &str = "xtask/counts.toml";
/// The largest change that is none, as a share.
const STILL: f64 = 0.02;
const HEAD: &str = "\
# Instructions of pieces of work, as `cargo xtask test --full` compares them; more or less by 2 % is renewed in the commit
# that changes them: `RUMBO_BLESS=1 cargo xtask bench --only counts`.
";

/// The file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Counts {
    /// The compiler's version.
    rustc: String,
    instructions: BTreeMap<String, u64>,
}

/// Counts, and writes the file where that is asked for.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let found = count(project)?;
    let known = read(project).map(|known| known.instructions);
    if std::env::var_os("RUMBO_BLESS").is_some() {
        let mut text = format!("{HEAD}rustc = \"{}\"\n\n[instructions]\n", found.rustc);
        for (piece, count) in &found.instructions {
            let _ = writeln!(text, "{piece} = {count}");
        }
        std::fs::write(project.root.join(FILE), text)
            .map_err(|error| format!("{FILE}: {error}"))?;
    }
    let known = known.unwrap_or_default();
    let figure = |(piece, count): (&String, &u64)| {
        let change = known.get(piece).map_or(String::new(), |old| {
            format!(" ({:+.2} %)", 100.0 * change(*old, *count))
        });
        let measured = format!("{:.2} M instructions{change}", *count as f64 / 1e6);
        Figure::new(piece.clone(), measured, "within 2 %")
    };
    Ok(found.instructions.iter().map(figure).collect())
}

/// Nothing has crept.
pub(crate) fn check(project: &Project) -> Result<(), Stop> {
    let (known, found) = (read(project)?, count(project)?);
    let problems = problems(&known, &found);
    match problems.is_empty() {
        true => Ok(()),
        false => Err(Stop::Failed(format!(
            "{}; if that is meant: `RUMBO_BLESS=1 cargo xtask bench --only counts`",
            problems.join("; ")
        ))),
    }
}

fn problems(known: &Counts, found: &Counts) -> Vec<String> {
    let (old, new) = (&known.instructions, &found.instructions);
    let mut problems = Vec::new();
    for (piece, count) in new {
        match old.get(piece) {
            None => problems.push(format!("{piece} is not in {FILE}")),
            Some(before) if change(*before, *count).abs() > STILL => problems.push(format!(
                "{piece}: {before} instructions before, {count} now ({:+.1} %)",
                100.0 * change(*before, *count)
            )),
            Some(_) => {}
        }
    }
    let gone = old.keys().filter(|piece| !new.contains_key(*piece));
    problems.extend(gone.map(|piece| format!("{piece} of {FILE} is no piece")));
    if !problems.is_empty() && known.rustc != found.rustc {
        problems.push(format!("before by {}, now {}", known.rustc, found.rustc));
    }
    problems
}

fn change(before: u64, now: u64) -> f64 {
    now as f64 / before as f64 - 1.0
}

fn read(project: &Project) -> Result<Counts, String> {
    let text = std::fs::read_to_string(project.root.join(FILE));
    let text = text.map_err(|error| format!("{FILE}: {error}"))?;
    toml::from_str(&text).map_err(|error| format!("{FILE}: {error}"))
}

fn count(project: &Project) -> Result<Counts, Stop> {
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return Err(Stop::Missing(
            "the counts are those of Linux on x86-64".into(),
        ));
    }
    let valgrind = tools::valgrind(project)?;
    run(&mut project.cargo(&["build", "--release", "--locked", "-p", "rumbo-tools"]))?;
    let program = project.target.join("release/rumbo-tools");
    let pieces = output(project.command(&program).arg("counts"))?;
    let mut instructions = BTreeMap::new();
    for piece in pieces.lines() {
        let log = project.target.join("counts.log");
        output(
            project
                .command(&valgrind)
                .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
                .arg(format!("--log-file={}", log.display()))
                .arg(&program)
                .args(["counts", piece])
                .env("RAYON_NUM_THREADS", "1"),
        )?;
        let log = std::fs::read_to_string(log).map_err(|error| error.to_string())?;
        let count = collected(&log).ok_or_else(|| format!("valgrind says `{log}`"))?;
        instructions.insert(piece.to_owned(), count);
    }
    let rustc = output(project.command("rustc").arg("--version"))?;
    Ok(Counts {
        rustc: rustc.trim().to_owned(),
        instructions,
    })
}

/// The count at the end of callgrind's log.
fn collected(log: &str) -> Option<u64> {
    let line = log.lines().find_map(|line| line.split_once("Collected : "));
    line?.1.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(instructions: &[(&str, u64)]) -> Counts {
        let instructions = instructions.iter();
        Counts {
            rustc: "rustc 1".into(),
            instructions: instructions
                .map(|(piece, n)| ((*piece).into(), *n))
                .collect(),
        }
    }

    #[test]
    fn a_change_beyond_two_percent_is_named_with_both_counts() {
        let known = counts(&[("a", 1_000), ("b", 1_000), ("gone", 1)]);
        let found = counts(&[("a", 1_019), ("b", 970), ("new", 1)]);
        let expected = [
            "b: 1000 instructions before, 970 now (-3.0 %)",
            "new is not in xtask/counts.toml",
            "gone of xtask/counts.toml is no piece",
        ];
        assert_eq!(problems(&known, &found), expected);
    }

    #[test]
    fn the_count_is_what_callgrind_collected() {
        assert_eq!(
            collected("==7== Events    : Ir\n==7== Collected : 1234\n"),
            Some(1234)
        );
        assert_eq!(collected("==7== killed"), None);
    }
}
