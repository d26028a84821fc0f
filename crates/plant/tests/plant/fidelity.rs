//! docs/fidelity.md has a row for each parameter of the plant and each part of the chip, with a test that is one.

use rumbo_plant::params::Params;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The rows of a page's tables, as cells.
fn rows(page: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join("docs").join(page)).unwrap();
    let lines = text.lines().filter(|line| line.starts_with("| "));
    let cells = lines.map(|line| line.trim_matches('|').split(" | "));
    cells
        .map(|cells| cells.map(|cell| cell.trim().to_owned()).collect())
        .collect()
}

/// What stands in backticks.
fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

/// The sources of all crates.
fn sources(folder: &Path, all: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.extension() {
            None if path.is_dir() => sources(&path, all),
            Some(ending) if ending == "rs" => *all += &fs::read_to_string(&path).unwrap(),
            _ => {}
        }
    }
}

#[test]
fn each_parameter_has_one_row_and_each_row_a_test_that_shows_it() {
    let mut tests = String::new();
    sources(&root().join("crates"), &mut tests);
    let rows = rows("fidelity.md");
    let is_test = |name: &str| tests.contains(&format!("fn {name}("));
    let effects: Vec<_> = rows.iter().filter(|row| row.len() == 5).collect();
    let meant: Vec<&str> = effects.iter().flat_map(|row| quoted(&row[0])).collect();
    let is_meant = |key: &str, by: &str| {
        let key = key.replace("wheels.left", "wheels.*");
        let key = key.replace("wheels.right", "wheels.*");
        key == by
            || key
                .strip_prefix(by)
                .is_some_and(|rest| rest.starts_with('.'))
    };
    for limit in Params::limits() {
        let of_it = meant.iter().filter(|by| is_meant(&limit.key, by)).count();
        assert_eq!(of_it, 1, "docs/fidelity.md: rows about {}", limit.key);
    }
    for by in &meant {
        let mut keys = Params::limits().into_iter();
        assert!(
            keys.any(|limit| is_meant(&limit.key, by)),
            "docs/fidelity.md: {by}: no parameter"
        );
    }
    let proofs = rows.iter().filter(|row| row.len() == 2 && row[0] != "part");
    for (what, shown) in effects
        .iter()
        .filter(|row| row[0] != "parameters")
        .map(|row| (&row[0], &row[4]))
        .chain(proofs.clone().map(|row| (&row[0], &row[1])))
    {
        let proof = quoted(shown).next().unwrap_or_default();
        assert!(
            is_test(proof),
            "docs/fidelity.md: {what}: no test `{proof}`"
        );
    }
    let parts: Vec<&String> = proofs.map(|row| &row[0]).collect();
    for row in self::rows("atmega2560.md") {
        let is_part = row.len() == 3 && row[0] != "part" && !row[0].contains("`");
        assert!(
            !is_part || parts.contains(&&row[0]),
            "docs/fidelity.md: no row about {}",
            row[0]
        );
    }
}
