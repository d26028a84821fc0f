//! Guarantees of the crates' code: no std on the chip, the same bits everywhere, lints, no machine paths.

use super::{Finding, Tree};

/// Crates that run on the chip.
const ON_THE_CHIP: [&str; 3] = ["control", "wire", "robot"];

/// Crates whose results must be the same bits on every machine.
const SAME_BITS: [&str; 4] = ["control", "wire", "robot", "plant"];

/// Methods of floats that the platform's mathematics library answers, differently from machine to machine.
const PLATFORM_MATHS: [&str; 17] = [
    "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "exp", "exp2", "ln", "log10",
    "powf", "powi", "cbrt", "hypot", "mul_add",
];

/// First folders of paths that exist on one machine only.
const MACHINE_FOLDERS: [&str; 7] = ["home", "root", "Users", "mnt", "media", "work", "workspace"];

/// Lines from which a Rust file is worth splitting.
const LONG_FILE_LINES: usize = 500;

/// Checks all texts of the project.
pub(crate) fn check(tree: &Tree) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (path, text) in tree.texts(|path| path.ends_with("Cargo.toml") && path.contains('/')) {
        findings.extend(lints(path, text));
    }
    for (path, text) in tree.texts(|path| path.ends_with(".rs")) {
        let lines = text.lines().count();
        if lines > LONG_FILE_LINES {
            findings.push(Finding::hint(
                path,
                lines,
                format!("more than {LONG_FILE_LINES} lines; one subject per file"),
            ));
        }
        if in_source_of(path, &ON_THE_CHIP) {
            findings.extend(no_std(path, text));
        }
        if in_source_of(path, &SAME_BITS) {
            findings.extend(same_bits(path, text));
        }
    }
    for (path, text) in tree.texts(|path| !path.ends_with(".lock") && !path.ends_with("-lock.json"))
    {
        findings.extend(machine_paths(path, text));
    }
    findings
}

/// Whether `path` is below `crates/<name>/src/` for one of `names`, files of tests aside.
fn in_source_of(path: &str, names: &[&str]) -> bool {
    let inside = |name: &&str| path.starts_with(&format!("crates/{name}/src/"));
    names.iter().any(inside) && !path.ends_with("tests.rs") && !path.contains("/tests/")
}

/// The lines of a Rust file before its tests, without comments, with their number.
pub(super) fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line));
    lines
        .take_while(|(_, line)| line.trim() != "#[cfg(test)]")
        .map(|(number, line)| (number, line.split("//").next().unwrap_or_default()))
}

fn lints(path: &str, text: &str) -> Option<Finding> {
    let mut lines = text
        .lines()
        .map(str::trim)
        .skip_while(|line| *line != "[lints]")
        .skip(1);
    let inherited = lines.find(|line| !line.is_empty()) == Some("workspace = true");
    let remedy = "add `[lints]` with `workspace = true`";
    // Other workspaces have a lint table of their own.
    let own = [
        "firmware/",
        "fuzz/Cargo.toml",
        "ros/",
        "tools/bindgen/",
        "tools/rapier/",
    ]
    .iter()
    .any(|other| path.starts_with(other));
    (!inherited && !own).then(|| {
        Finding::error(
            path,
            1,
            format!("the lints of the workspace do not apply; {remedy}"),
        )
    })
}

fn no_std(path: &str, text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    if path.ends_with("src/lib.rs") && !text.lines().any(|line| line.trim() == "#![no_std]") {
        findings.push(Finding::error(
            path,
            1,
            "this crate runs on the chip; add `#![no_std]`",
        ));
    }
    for (number, line) in code(text) {
        for name in ["std::", "alloc::", "extern crate std", "extern crate alloc"] {
            if starts_a_path(line, name) {
                let what = format!(
                    "`{name}` does not exist on the chip; use `core`, or move this off the chip"
                );
                findings.push(Finding::error(path, number, what));
            }
        }
    }
    findings
}

/// Whether `name` occurs in `line` and is not the end of a longer word or path.
fn starts_a_path(line: &str, name: &str) -> bool {
    line.match_indices(name)
        .any(|(at, _)| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':'))
}

fn same_bits(path: &str, text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (number, line) in code(text) {
        for method in PLATFORM_MATHS {
            if line.contains(&format!(".{method}("))
                || line.contains(&format!("f32::{method}"))
                || line.contains(&format!("f64::{method}"))
            {
                let remedy =
                    "use `rumbo_control::math` in the core and the `libm` crate in the plant";
                let what = format!("`{method}` differs from machine to machine; {remedy}");
                findings.push(Finding::error(path, number, what));
            }
        }
    }
    findings
}

fn machine_paths(path: &str, text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (index, line) in text.lines().enumerate() {
        for folder in MACHINE_FOLDERS {
            let absolute = line.match_indices(&format!("/{folder}/")).any(|(at, _)| {
                // Neither the rest of a longer path or address, nor a path made relative by the text before it.
                !line[..at].ends_with(|c: char| c.is_alphanumeric() || "._-/*~:}>)".contains(c))
            });
            if absolute {
                let what = format!(
                    "a path below `/{folder}` exists on one machine only; make it relative"
                );
                findings.push(Finding::error(path, index + 1, what));
            }
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<String> {
        check(&Tree::of(&[(path, text)]))
            .iter()
            .map(Finding::to_string)
            .collect()
    }

    #[test]
    fn the_chip_has_no_std() {
        let text = "#![no_std]\nuse core::f32;\nuse std::vec::Vec;\n";
        let found = found("crates/control/src/lib.rs", text);
        assert_eq!(found.len(), 1);
        assert!(
            found[0].starts_with("crates/control/src/lib.rs:3: `std::`"),
            "{found:?}"
        );
    }

    #[test]
    fn a_crate_of_the_chip_declares_no_std() {
        assert!(found("crates/wire/src/lib.rs", "//! Wire.\n")[0].contains("#![no_std]"));
        assert_eq!(
            found("crates/station/src/lib.rs", "use std::io;\n"),
            [""; 0]
        );
    }

    #[test]
    fn tests_and_comments_of_the_chip_may_name_std() {
        let text = "// std::io\nfn a() {}\n#[cfg(test)]\nmod tests { use std::vec::Vec; }\n";
        assert_eq!(found("crates/robot/src/tick.rs", text), [""; 0]);
    }

    #[test]
    fn platform_maths_is_found_in_the_plant() {
        let found = found(
            "crates/plant/src/sonar.rs",
            "let a = b.sin();\nlet c = libm::sin(b);\n",
        );
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("sonar.rs:1: `sin` differs"), "{found:?}");
    }

    #[test]
    fn a_crate_without_the_workspace_lints_is_found() {
        assert_eq!(
            found(
                "crates/a/Cargo.toml",
                "[package]\n\n[lints]\nworkspace = true\n"
            ),
            [""; 0]
        );
        assert_eq!(
            found("crates/a/Cargo.toml", "[lints.rust]\nworkspace = true\n").len(),
            1
        );
    }

    #[test]
    fn absolute_paths_are_found_and_addresses_are_not() {
        let folder = MACHINE_FOLDERS[0];
        assert_eq!(
            found("docs/a.md", &format!("see `/{folder}/me/rumbo`\n")).len(),
            1
        );
        assert_eq!(
            found("docs/a.md", &format!("https://example.org/{folder}/page\n")),
            [""; 0]
        );
    }

    #[test]
    fn a_long_file_is_a_hint_only() {
        let findings = check(&Tree::of(&[("crates/cli/src/main.rs", &"\n".repeat(501))]));
        assert_eq!((findings.len(), findings[0].hint), (1, true));
    }
}
