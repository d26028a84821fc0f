//! `cargo xtask bench`: the measured figures of docs/figures.md, as a table of measurement and budget.
//!
//! The figures are of the machine at hand and its present load: they are printed, never asserted.

mod batch;
pub(crate) mod counts;
mod emulator;
mod headless;
mod lab;
mod page;
mod process;
mod record;
mod viewers;

use crate::project::Project;

/// One line of the table.
pub(crate) struct Figure {
    what: String,
    measured: String,
    budget: &'static str,
}

impl Figure {
    fn new(what: impl Into<String>, measured: impl Into<String>, budget: &'static str) -> Self {
        Self {
            what: what.into(),
            measured: measured.into(),
            budget,
        }
    }
}

struct Part {
    name: &'static str,
    what: &'static str,
    measure: fn(&Project) -> Result<Vec<Figure>, String>,
}

const PARTS: [Part; 9] = [
    Part {
        name: "batch",
        what: "robots stepped together, beside rapier2d: some minutes",
        measure: batch::measure,
    },
    Part {
        name: "counts",
        what: "instructions of pieces of work, beside those of xtask/counts.toml",
        measure: counts::measure,
    },
    Part {
        name: "emulator",
        what: "simulated time over the processor's of firmware on the emulated Mega, beside simavr",
        measure: emulator::measure,
    },
    Part {
        name: "headless",
        what: "simulated time over wall time of `rumbo run`, one robot, one thread",
        measure: headless::measure,
    },
    Part {
        name: "lab",
        what: "start, CPU and memory of `rumbo lab` at real time",
        measure: lab::measure,
    },
    Part {
        name: "memoria",
        what: "the report's program beside ours on the emulated Mega, every scenario that it can do: some minutes",
        measure: memoria,
    },
    Part {
        name: "page",
        what: "the dashboard in Chromium: from start to live plots, age of what is drawn, STOP, frames per second",
        measure: page::measure,
    },
    Part {
        name: "record",
        what: "logs of killed sessions, an hour of log, the port out and back: some minutes",
        measure: record::measure,
    },
    Part {
        name: "viewers",
        what: "twenty pages at once",
        measure: viewers::measure,
    },
];

/// Prints a table of its own, which is also in docs/theory/baseline.md.
fn memoria(project: &Project) -> Result<Vec<Figure>, String> {
    crate::memoria::run(project, None, &[]).map(|_| Vec::new())
}

/// Text of `cargo xtask bench --help`.
pub(crate) fn help() -> String {
    let mut text = String::from("Usage: cargo xtask bench [--only PART]...\n\nParts, in order:\n");
    for part in &PARTS {
        text += &format!("  {:<9} {}\n", part.name, part.what);
    }
    text + "\nExamples:\n  cargo xtask bench\n  cargo xtask bench --only headless"
}

/// Measures the parts named in `only` (all if empty); true if all could be measured.
pub(crate) fn run(project: &Project, only: &[String]) -> Result<bool, String> {
    if let Some(unknown) = only
        .iter()
        .find(|name| PARTS.iter().all(|part| part.name != *name))
    {
        return Err(format!(
            "no part `{unknown}`; see `cargo xtask bench --help`"
        ));
    }
    let asked = |part: &&Part| only.is_empty() || only.iter().any(|name| name == part.name);
    let needs_rumbo = |part: &Part| !["batch", "counts"].contains(&part.name);
    if PARTS.iter().filter(asked).any(needs_rumbo) {
        project.release_binary()?;
    }
    let mut figures = Vec::new();
    let mut complete = true;
    for part in PARTS.iter().filter(asked) {
        eprintln!("{}: {} ...", part.name, part.what);
        match (part.measure)(project) {
            Ok(measured) => figures.extend(measured),
            Err(error) => {
                complete = false;
                figures.push(Figure::new(part.what, format!("not measured: {error}"), ""));
            }
        }
    }
    print!("{}", table(&figures));
    Ok(complete)
}

/// The figures as a Markdown table.
fn table(figures: &[Figure]) -> String {
    let mut rows = vec![["what", "measured", "budget"].map(str::to_owned)];
    rows.extend(figures.iter().map(|figure| {
        [
            figure.what.clone(),
            figure.measured.clone(),
            figure.budget.to_owned(),
        ]
    }));
    let width = |column: usize| {
        rows.iter()
            .map(|row| row[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths = [width(0), width(1), width(2)];
    let mut text = String::new();
    for (index, [what, measured, budget]) in rows.iter().enumerate() {
        let [a, b, c] = widths;
        text += &format!("| {what:<a$} | {measured:<b$} | {budget:<c$} |\n");
        if index == 0 {
            text += &format!("|{:-<1$}", "", a + 2);
            text += &format!("|{:-<1$}", "", b + 2);
            text += &format!("|{:-<1$}|\n", "", c + 2);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_aligned_markdown() {
        let figures = [
            Figure::new("a", "12 ms", "50 ms"),
            Figure::new("long name", "1", ""),
        ];
        let expected = "| what      | measured | budget |\n\
                        |-----------|----------|--------|\n\
                        | a         | 12 ms    | 50 ms  |\n\
                        | long name | 1        |        |\n";
        assert_eq!(table(&figures), expected);
    }
}
