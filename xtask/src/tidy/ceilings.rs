//! What the house may weigh, by `xtask/ceilings.toml`: packages, units and executables of the gate, lines of each crate,
//! and the processor's seconds of each step, which depend on the machine and only warn.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use serde_json::Value;

use super::{Finding, Tree};
use crate::cost::Cost;
use crate::project::Project;

const FILE: &str = "xtask/ceilings.toml";
/// The program whose packages are counted as users build it.
const PROGRAM: &str = "rumbo-cli";

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Ceilings {
    /// The processor's time by step \[s\].
    seconds: BTreeMap<String, u64>,
    packages: Packages,
    /// What the tests are built from.
    pub(crate) gate: Gate,
    /// Lines by crate, without blank ones, comments and tests.
    lines: BTreeMap<String, usize>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Packages {
    /// In the lock file.
    lock: usize,
    /// In the program as users build it.
    rumbo: usize,
}

/// What the compiler makes for the tests of the gate.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub(crate) struct Gate {
    /// Libraries, programs, build scripts and tests, each as often as it is compiled.
    pub(crate) units: usize,
    /// Programs with tests.
    pub(crate) executables: usize,
}

impl Ceilings {
    pub(crate) fn read(project: &Project) -> Result<Self, String> {
        let text = std::fs::read_to_string(project.root.join(FILE))
            .map_err(|error| format!("{FILE}: {error}"))?;
        Self::parse(&text)
    }

    fn parse(text: &str) -> Result<Self, String> {
        toml::from_str(text).map_err(|error| format!("{FILE}: {error}"))
    }

    /// Steps that took more of the processor than they may.
    pub(crate) fn warnings(&self, costs: &[(&str, Cost)]) -> Vec<String> {
        let over = costs.iter().filter_map(|(name, cost)| {
            let ceiling = *self.seconds.get(*name)?;
            let took = cost.processor.as_secs();
            (took > ceiling).then(|| {
                format!("warning: {name} took {took} s of the processor, {FILE} has {ceiling}")
            })
        });
        over.collect()
    }
}

impl Gate {
    /// From the messages of cargo that built the tests.
    pub(crate) fn of(messages: &str) -> Self {
        let mut gate = Self {
            units: 0,
            executables: 0,
        };
        for line in messages.lines() {
            let Ok(message) = serde_json::from_str::<Value>(line) else {
                continue;
            };
            if message["reason"] == "compiler-artifact" {
                gate.units += 1;
                let is_test = message["profile"]["test"] == true;
                gate.executables += usize::from(is_test && message["executable"].is_string());
            }
        }
        gate
    }

    /// What is more than it may be.
    pub(crate) fn above(self, ceiling: Self) -> Option<String> {
        let over = |what: &str, now: usize, most: usize| {
            (now > most).then(|| format!("{now} {what}, {FILE} has {most}; {REMEDY}"))
        };
        over("units", self.units, ceiling.units)
            .or_else(|| over("executables", self.executables, ceiling.executables))
    }
}

const REMEDY: &str = "do with less, or raise it there with the reason in the commit";

/// Compares packages and lines with the file.
pub(super) fn check(project: &Project, tree: &Tree) -> Result<Vec<Finding>, String> {
    let ceilings = Ceilings::read(project)?;
    let lock = tree.text("Cargo.lock").unwrap_or_default();
    let lock = lock.lines().filter(|line| *line == "[[package]]").count();
    let rumbo = packages_of(&crate::project::host_metadata(project)?, PROGRAM);
    let mut now = vec![
        (
            "packages in Cargo.lock".to_owned(),
            lock,
            ceilings.packages.lock,
        ),
        (
            "packages in rumbo as users build it".to_owned(),
            rumbo,
            ceilings.packages.rumbo,
        ),
    ];
    let mut findings = Vec::new();
    for (name, lines) in lines_by_crate(tree) {
        match ceilings.lines.get(name) {
            Some(most) => now.push((format!("lines of code in {name}"), lines, *most)),
            None => findings.push(Finding::error(
                FILE,
                1,
                format!("{name} has no ceiling in `lines`; it has {lines}"),
            )),
        }
    }
    let over = now.into_iter().filter(|(_, now, most)| now > most);
    findings.extend(over.map(|(what, now, most)| {
        Finding::error(FILE, 1, format!("{now} {what}, not {most}; {REMEDY}"))
    }));
    Ok(findings)
}

/// Packages that a program is built from on this machine: of dependencies and build scripts, its own included.
fn packages_of(metadata: &Value, name: &str) -> usize {
    let list = |value: &'_ Value| value.as_array().cloned().unwrap_or_default();
    let nodes: BTreeMap<String, Value> = list(&metadata["resolve"]["nodes"])
        .into_iter()
        .filter_map(|node| Some((node["id"].as_str()?.to_owned(), node)))
        .collect();
    let packages = list(&metadata["packages"]);
    let root = packages.iter().find(|package| package["name"] == name);
    let mut open: Vec<String> = root
        .and_then(|package| package["id"].as_str())
        .map(str::to_owned)
        .into_iter()
        .collect();
    let mut seen = BTreeSet::new();
    while let Some(id) = open.pop() {
        let Some(node) = nodes.get(&id).filter(|_| !seen.contains(&id)) else {
            continue;
        };
        for dependency in list(&node["deps"]) {
            let kinds = list(&dependency["dep_kinds"]);
            if kinds.iter().any(|kind| kind["kind"] != "dev") {
                open.extend(dependency["pkg"].as_str().map(str::to_owned));
            }
        }
        seen.insert(id);
    }
    seen.len()
}

/// Lines of code below `src/` of each crate of `crates/`.
fn lines_by_crate(tree: &Tree) -> BTreeMap<&str, usize> {
    let mut lines = BTreeMap::new();
    for (path, text) in tree.texts(|path| path.starts_with("crates/") && path.ends_with(".rs")) {
        let Some((name, file)) = path["crates/".len()..].split_once("/src/") else {
            continue;
        };
        if file.ends_with("tests.rs") || file.contains("tests/") {
            continue;
        }
        let code = super::source::code(text).filter(|(_, line)| !line.trim().is_empty());
        *lines.entry(name).or_default() += code.count();
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::time::Duration;

    #[test]
    fn lines_are_code_only() {
        let text = "//! Doc.\n\nfn f() {\n    // Why.\n    g();\n}\n\n#[cfg(test)]\nmod tests {}\n";
        let tree = Tree::of(&[
            ("crates/a/src/lib.rs", text),
            ("crates/a/src/b/tests.rs", "fn f() {}\n"),
            ("crates/a/tests/a/main.rs", "fn f() {}\n"),
        ]);
        assert_eq!(lines_by_crate(&tree), BTreeMap::from([("a", 3)]));
    }

    #[test]
    fn packages_for_tests_only_are_not_part_of_the_program() {
        let needs = |id: &str, kind: Value| json!({ "pkg": id, "dep_kinds": [{ "kind": kind }] });
        let metadata = json!({
            "packages": [{ "id": "1", "name": "rumbo-cli" }],
            "resolve": { "nodes": [
                { "id": "1", "deps": [needs("2", Value::Null), needs("3", "dev".into()), needs("4", "build".into())] },
                { "id": "2", "deps": [needs("4", Value::Null)] },
                { "id": "3", "deps": [] },
                { "id": "4", "deps": [] },
            ]}
        });
        assert_eq!(packages_of(&metadata, "rumbo-cli"), 3);
    }

    #[test]
    fn units_and_executables_are_those_that_cargo_names() {
        let messages = "\
{\"reason\":\"compiler-artifact\",\"profile\":{\"test\":false},\"executable\":null}
{\"reason\":\"compiler-artifact\",\"profile\":{\"test\":true},\"executable\":\"/a\"}
{\"reason\":\"build-finished\",\"success\":true}
";
        let gate = Gate::of(messages);
        assert_eq!((gate.units, gate.executables), (2, 1));
        assert_eq!(gate.above(gate), None);
        let less = Gate { units: 1, ..gate };
        assert!(
            gate.above(less)
                .is_some_and(|what| what.starts_with("2 units"))
        );
    }

    #[test]
    fn a_dear_step_is_a_warning() {
        let text = "seconds = { fmt = 10 }\npackages = { lock = 1, rumbo = 1 }\n\
                    gate = { units = 1, executables = 1 }\nlines = {}\n";
        let ceilings = Ceilings::parse(text).unwrap();
        let cost = |seconds| Cost {
            processor: Duration::from_secs(seconds),
            ..Cost::default()
        };
        assert_eq!(
            ceilings.warnings(&[("fmt", cost(10)), ("other", cost(99))]),
            [""; 0]
        );
        assert_eq!(ceilings.warnings(&[("fmt", cost(11))]).len(), 1);
    }
}
