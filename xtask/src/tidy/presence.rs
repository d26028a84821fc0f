//! Files that the binary embeds, that tests compare with, or that readers expect.

use super::{Finding, Tree};

/// Files and folders (with a `/` at the end) that must exist, and what for.
const EXPECTED: [(&str, &str); 20] = [
    ("README.md", "what the project is"),
    ("README.es.md", "what the project is, in Spanish"),
    ("ARCHITECTURE.md", "how it is built"),
    ("CONTRIBUTING.md", "how to change it"),
    ("CHANGELOG.md", "what changed"),
    ("LICENSE-MIT", "the licence"),
    ("LICENSE-APACHE", "the licence"),
    (".ci/run", "what CI runs"),
    ("Cargo.lock", "builds repeat"),
    ("docs/protocol.md", "the bytes of the link"),
    (
        "docs/figures.md",
        "what was measured; `cargo xtask memoria` writes into it",
    ),
    ("docs/theory/README.md", "the derivations"),
    ("docs/adr/", "the decisions"),
    ("docs/img/dashboard.png", "the picture of the README"),
    ("robots/memoria.toml", "embedded in the binary"),
    ("worlds/", "embedded in the binary"),
    ("scenarios/", "embedded in the binary"),
    ("web/index.html", "embedded in the binary"),
    ("web/package-lock.json", "the browser test repeats"),
    ("tests/golden/", "what tests compare metrics with"),
];

/// Checks that the expected files are there.
pub(crate) fn check(tree: &Tree) -> Vec<Finding> {
    let there = |path: &str| {
        if path.ends_with('/') {
            tree.has_folder(path)
        } else {
            tree.has_file(path)
        }
    };
    let missing = EXPECTED.iter().filter(|(path, _)| !there(path));
    missing
        .map(|(path, purpose)| Finding::error(path, 1, format!("missing: {purpose}")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_there_when_it_holds_a_file() {
        let findings = check(&Tree::of(&[("README.md", ""), ("worlds/open.toml", "")]));
        let missing = |path: &str| findings.iter().any(|finding| finding.path == path);
        assert!(!missing("README.md") && !missing("worlds/"));
        assert!(missing("scenarios/") && missing("LICENSE-MIT"));
    }
}
