//! simavr as a separate program: what an image reports there.

use rumbo_emulator::model::Model;
use std::path::Path;
use std::process::Command;

/// Digits of a report: 37 bytes of registers, 2 of a hash.
const DIGITS: usize = 2 * 39;

/// The reports that a program sends over USART0, a line each; `None` where simavr is not installed.
pub(crate) fn reports(model: &Model, image: &Path) -> Option<Vec<String>> {
    let output = Command::new("simavr")
        .args(["-m", model.name, "-f", "16000000"])
        .arg(image)
        .output();
    let Ok(output) = output else {
        assert!(
            std::env::var_os("CI").is_none(),
            "simavr is missing: install the package simavr"
        );
        println!("skipped: simavr is not installed");
        return None;
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    let is_report =
        |line: &&str| line.len() == DIGITS && line.bytes().all(|b| b.is_ascii_hexdigit());
    Some(
        text.lines()
            // It colours what it prints: the text follows the last `m` and ends in a dot for the line feed.
            .map(|line| line.rsplit('m').next().unwrap_or("").trim_end_matches('.'))
            .filter(is_report)
            .map(str::to_owned)
            .collect(),
    )
}
