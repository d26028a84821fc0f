//! Metrics of every scenario at three seeds, kept in `tests/golden/`: a change of behaviour is a readable difference.
//!
//! After a change that is meant: `RUMBO_BLESS=1 cargo test -p rumbo-scenario --test golden`, and read the difference.

#![cfg(test)]

use rumbo_scenario::files::{Kind, Library, Overrides};
use rumbo_scenario::run::run;
use std::fmt::Write as _;
use std::path::Path;

#[test]
fn metrics_are_those_of_the_golden_files() {
    let library = Library::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden");
    let bless = std::env::var_os("RUMBO_BLESS").is_some();
    let mut wrong = Vec::new();
    for name in library.list(Kind::Scenario) {
        let setup = library.setup(&name, &Overrides::default()).unwrap();
        let mut text = String::new();
        for seed in 1..=3 {
            writeln!(text, "[seed.{seed}]").unwrap();
            for (metric, value) in run(&setup, seed).unwrap().metrics {
                writeln!(text, "\"{metric}\" = {value:.4}").unwrap();
            }
        }
        let path = folder.join(format!("{name}.toml"));
        if bless {
            std::fs::write(&path, &text).unwrap();
        } else if std::fs::read_to_string(&path).unwrap_or_default() != text {
            wrong.push(name);
        }
    }
    assert!(
        wrong.is_empty(),
        "other metrics than in tests/golden: {wrong:?}; if that is meant, run with RUMBO_BLESS=1 and read the difference"
    );
}
