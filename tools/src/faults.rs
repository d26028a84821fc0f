//! Breaks sensors and wires in thousands of drives, and prints contacts and reported faults.
//!
//! `cargo xtask campaign --only faults` builds and starts it, natively and on the image. Arguments: `--seeds N` (50),
//! `--instants N` per drive (5), `--image` (the built one, on the emulated Mega), `--list` (each run that touched
//! something), `--write` (the table of docs/faults.md). Exit status 1 if more happens than is allowed; the page stays as it
//! is then.

use crate::arguments::Arguments;
use crate::pages;
use rumbo_experiment::campaign::faults::{
    Class, DRIVES, DetectionSummary, Failure, FaultDrive, GENTLE_M_S, INSTANTS, Named, drive_all,
};
use rumbo_experiment::files::{FileError, Overrides};
use std::process::ExitCode;

pub(crate) fn main() -> ExitCode {
    crate::ended("faults", campaign())
}

fn campaign() -> Result<bool, FileError> {
    let numbers = ["--seeds", "--instants"];
    let args = Arguments::read(&numbers, &["--image", "--list", "--write"], &[])?;
    let overrides = Overrides {
        firmware: args
            .has("--image")
            .then(|| pages::built("firmware/rumbo.elf")),
        ..Overrides::default()
    };
    let instants = args.number("--instants", INSTANTS as u64) as usize;
    let seeds = 1..1 + args.number("--seeds", 50);
    let drives = drive_all(&overrides, seeds, instants, |_, _| true)?;
    let table = table(&drives);
    println!("{table}");
    if args.has("--list") {
        for drive in drives.iter().filter(|drive| drive.touch.is_some()) {
            println!("{}", line(drive));
        }
    }
    let (summary, met) = summary(&drives);
    println!("{summary}");
    let writes = args.has("--write");
    if writes && !met {
        println!("docs/faults.md stays as it is: more happened than is allowed");
    } else if writes {
        let place = if args.has("--image") {
            "campaign-image"
        } else {
            "campaign"
        };
        pages::write("docs/faults.md", place, &format!("{table}\n{summary}"))?;
    }
    Ok(met)
}

fn line(drive: &FaultDrive) -> String {
    let FaultDrive {
        seed,
        at_s,
        failure,
        class,
        ..
    } = drive;
    let (touch_s, touch_m_s) = drive.touch.unwrap_or_default();
    let named = drive
        .named
        .map_or("nothing named".to_owned(), |(named_s, named)| match named {
            Named::Fault(fault) => format!("{fault:?} at {named_s:.2} s"),
            Named::Restart => format!("restart at {named_s:.2} s"),
        });
    format!(
        "{} seed {seed}, {failure} at {at_s} s ({class:?}): touch at {touch_s:.2} s, {touch_m_s:.3} m/s; {named}",
        DRIVES[drive.drive].0
    )
}

/// Rows of failures, columns of drives: runs, those with a contact, and the fastest contact. A failure without a contact
/// has no row.
fn table(drives: &[FaultDrive]) -> String {
    let columns: Vec<usize> = (0..DRIVES.len())
        .filter(|column| drives.iter().any(|drive| drive.drive == *column))
        .collect();
    let mut text = String::from("| what fails |");
    for column in &columns {
        text += &format!(" {} |", DRIVES[*column].0);
    }
    text += &format!("\n|---|{}\n", "---|".repeat(columns.len()));
    let (mut rows, mut quiet) = (0, 0);
    for class in [Class::Knowable, Class::FreeFloor] {
        for failure in Failure::all() {
            let of_row = |drive: &&FaultDrive| drive.failure == failure && drive.class == class;
            let row: Vec<&FaultDrive> = drives.iter().filter(of_row).collect();
            if row.is_empty() {
                continue;
            }
            rows += 1;
            if row.iter().all(|drive| drive.touch.is_none()) {
                quiet += 1;
                continue;
            }
            let free = if class == Class::FreeFloor {
                ", floor free before"
            } else {
                ""
            };
            text += &format!("| {failure}{free} |");
            for column in &columns {
                let here = row.iter().filter(|drive| drive.drive == *column);
                text += &format!(" {} |", cell(&here.copied().collect::<Vec<_>>()));
            }
            text += "\n";
        }
    }
    text +=
        &format!("\n{quiet} of {rows} failures have no contact in any drive and are left out.\n");
    text
}

fn cell(drives: &[&FaultDrive]) -> String {
    let touches: Vec<f64> = drives
        .iter()
        .filter_map(|drive| Some(drive.touch?.1))
        .collect();
    let fastest = touches.iter().copied().fold(0.0, f64::max);
    match (drives.len(), touches.len()) {
        (0, _) => String::new(),
        (all, 0) => format!("0 of {all}"),
        (all, count) => format!("{count} of {all} ({fastest:.2} m/s)"),
    }
}

/// What the page says below its table, and whether no more happened than it allows.
fn summary(drives: &[FaultDrive]) -> (String, bool) {
    let verdict = DetectionSummary::of(drives);
    let DetectionSummary {
        runs,
        touches,
        hard,
    } = verdict;
    let (allowed, allowed_hard) = (verdict.allowed(), verdict.allowed_hard());
    let last = drives
        .iter()
        .map(|drive| drive.seed)
        .max()
        .unwrap_or_default();
    let text = format!(
        "Seeds up to {last}. Of {runs} runs {touches} touched something (at most {allowed} allowed), {hard} of them\n\
         faster than {GENTLE_M_S} m/s (at most {allowed_hard} allowed)."
    );
    (text, verdict.is_met())
}

#[cfg(test)]
mod tests {
    /// The first number in a text.
    fn number(text: &str) -> Option<u32> {
        text.split([' ', '(']).find_map(|word| word.parse().ok())
    }

    #[test]
    fn the_page_prints_no_figure_above_the_bar_beside_it() {
        let page = include_str!("../../docs/faults.md").replace('\n', " ");
        let summaries: Vec<&str> = page.split("Seeds up to ").skip(1).collect();
        assert_eq!(summaries.len(), 2, "natively and on the image");
        for summary in summaries {
            // "50. Of 1000 runs 3 touched something (at most 5 allowed), 1 of them ... (at most 2 allowed)."
            let (_, rest) = summary.split_once(" runs ").unwrap();
            let bars: Vec<(&str, &str)> = (rest.split(" allowed)").take(2))
                .map(|bar| bar.split_once("(at most ").unwrap())
                .collect();
            assert_eq!(bars.len(), 2);
            for (figure, bar) in bars {
                let (figure, bar) = (number(figure).unwrap(), number(bar).unwrap());
                assert!(figure <= bar, "{figure} (at most {bar}): {rest}");
            }
        }
    }
}
