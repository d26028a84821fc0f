//! Which crate may use which: the diagram of ARCHITECTURE.md as a table.
//!
//! A crate may use what its arrows reach, directly or through others; dev-dependencies count like any other unless
//! [`FOR_TESTS`] says why not. The plant and the emulator reach nothing: a mistake shared by the controller and by
//! what tests it would go unseen.

use serde_json::Value;

use super::Finding;

/// Each crate of the project and the crates it builds on.
const ARROWS: [(&str, &[&str]); 27] = [
    ("rumbo-control", &[]),
    ("rumbo-wire", &["rumbo-control"]),
    ("rumbo-robot", &["rumbo-wire"]),
    ("rumbo-plant", &[]),
    ("rumbo-emulator", &[]),
    ("rumbo-debug", &["rumbo-emulator"]),
    ("rumbo-flash", &[]),
    (
        "rumbo-sim",
        &["rumbo-robot", "rumbo-plant", "rumbo-emulator"],
    ),
    ("rumbo-experiment", &["rumbo-sim"]),
    ("rumbo-plot", &[]),
    // The logs of our robots are read by what reads all logs.
    (
        "rumbo-identify",
        &["rumbo-plant", "rumbo-plot", "rumbo-log"],
    ),
    ("rumbo-log", &["rumbo-wire"]),
    ("rumbo-session", &["rumbo-log"]),
    ("rumbo-ros", &["rumbo-log"]),
    ("rumbo-ros-node", &["rumbo-ros"]),
    ("rumbo-lab", &["rumbo-experiment", "rumbo-session"]),
    ("rumbo-browser", &["rumbo-lab", "rumbo-flash"]),
    ("rumbo-sketch", &[]),
    ("rumbo-station", &["rumbo-session", "rumbo-flash"]),
    ("rumbo-report", &["rumbo-experiment", "rumbo-identify"]),
    (
        "rumbo-cli",
        &[
            "rumbo-station",
            "rumbo-report",
            "rumbo-lab",
            "rumbo-debug",
            "rumbo-sketch",
            "rumbo-ros",
        ],
    ),
    (
        "rumbo-python",
        &["rumbo-lab", "rumbo-identify", "rumbo-sketch"],
    ),
    ("rumbo-firmware", &["rumbo-robot"]),
    ("rumbo-firmware-tests", &["rumbo-experiment"]),
    (
        "rumbo-tools",
        &[
            "rumbo-experiment",
            "rumbo-identify",
            "rumbo-lab",
            "rumbo-sketch",
        ],
    ),
    ("xtask", &["rumbo-sketch"]),
    ("rumbo-fuzz-claims", &["rumbo-experiment", "rumbo-session"]),
];

/// What tests may use besides, and why.
const FOR_TESTS: [(&str, &str); 2] = [
    // Programs are written to an emulated chip with the real boot loader.
    ("rumbo-flash", "rumbo-emulator"),
    // The session is tested against the real robot's side of the link.
    ("rumbo-session", "rumbo-robot"),
];

/// Crates that run on the chip, and the libraries they may use: each must work without std, allocation and panics.
const ON_THE_CHIP: [&str; 3] = ["rumbo-control", "rumbo-wire", "rumbo-robot"];
const CHIP_LIBRARIES: [&str; 3] = ["libm", "cobs", "crc"];

/// Checks the packages of one `cargo metadata`.
pub(crate) fn check(metadata: &Value) -> Vec<Finding> {
    let root = metadata["workspace_root"].as_str().unwrap_or_default();
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mut findings = Vec::new();
    for package in list(&metadata["packages"]) {
        let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        let (name, manifest) = (text("name"), text("manifest_path"));
        let manifest = manifest
            .strip_prefix(root)
            .unwrap_or(&manifest)
            .trim_start_matches(['/', '\\']);
        let Some(reach) = reach(&name) else {
            let remedy =
                "add it to the diagram of ARCHITECTURE.md and to xtask/src/tidy/dependencies.rs";
            findings.push(Finding::error(
                manifest,
                1,
                format!("crate `{name}` is not in the diagram; {remedy}"),
            ));
            continue;
        };
        for dependency in list(&package["dependencies"]) {
            let used = dependency["name"].as_str().unwrap_or_default();
            let for_tests = dependency["kind"] == "dev";
            if let Some(problem) = problem(&name, &reach, used, for_tests) {
                findings.push(Finding::error(manifest, 1, problem));
            }
        }
    }
    findings
}

fn problem(name: &str, reach: &[&str], used: &str, for_tests: bool) -> Option<String> {
    let ours = ARROWS.iter().any(|(known, _)| *known == used);
    if ours {
        let allowed = reach.contains(&used) || (for_tests && FOR_TESTS.contains(&(name, used)));
        let remedy = "turn the arrow round, or move the code to where both may use it";
        (!allowed).then(|| format!("`{name}` must not depend on `{used}`; {remedy}"))
    } else {
        let allowed = for_tests || !ON_THE_CHIP.contains(&name) || CHIP_LIBRARIES.contains(&used);
        let remedy = format!("there it may use {} only", CHIP_LIBRARIES.join(", "));
        (!allowed)
            .then(|| format!("`{name}` runs on the chip and must not depend on `{used}`; {remedy}"))
    }
}

/// The crates that the arrows of `name` reach; nothing if it is not in the diagram.
fn reach(name: &str) -> Option<Vec<&'static str>> {
    let direct = |name: &str| {
        ARROWS
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(_, uses)| uses.to_vec())
    };
    let mut reached = direct(name)?;
    let mut next = 0;
    while let Some(&one) = reached.get(next) {
        for further in direct(one).unwrap_or_default() {
            if !reached.contains(&further) {
                reached.push(further);
            }
        }
        next += 1;
    }
    Some(reached)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn findings(name: &str, used: &str, kind: Option<&str>) -> Vec<String> {
        let metadata = json!({
            "workspace_root": "/p",
            "packages": [{
                "name": name,
                "manifest_path": format!("/p/crates/{name}/Cargo.toml"),
                "dependencies": [{ "name": used, "kind": kind }],
            }],
        });
        check(&metadata).iter().map(Finding::to_string).collect()
    }

    #[test]
    fn arrows_may_be_followed_any_distance() {
        assert_eq!(findings("rumbo-cli", "rumbo-control", None), [""; 0]);
    }

    #[test]
    fn an_arrow_turned_round_is_an_error_with_its_place() {
        let found = findings("rumbo-wire", "rumbo-robot", None);
        assert_eq!(found.len(), 1);
        assert!(found[0].starts_with(
            "crates/rumbo-wire/Cargo.toml:1: `rumbo-wire` must not depend on `rumbo-robot`"
        ));
    }

    #[test]
    fn the_plant_must_not_know_the_controller_even_in_its_tests() {
        assert_eq!(
            findings("rumbo-plant", "rumbo-control", Some("dev")).len(),
            1
        );
    }

    #[test]
    fn identification_knows_the_plant_and_no_simulator() {
        assert_eq!(findings("rumbo-identify", "rumbo-plant", None), [""; 0]);
        assert_eq!(findings("rumbo-identify", "rumbo-sim", None).len(), 1);
    }

    #[test]
    fn the_session_may_meet_the_robot_in_its_tests_only() {
        assert_eq!(
            findings("rumbo-session", "rumbo-robot", Some("dev")),
            [""; 0]
        );
        assert_eq!(findings("rumbo-session", "rumbo-robot", None).len(), 1);
    }

    #[test]
    fn libraries_on_the_chip_are_chosen_one_by_one() {
        assert_eq!(findings("rumbo-control", "rand", None).len(), 1);
        assert_eq!(findings("rumbo-control", "libm", None), [""; 0]);
        assert_eq!(findings("rumbo-control", "proptest", Some("dev")), [""; 0]);
    }

    #[test]
    fn a_new_crate_must_be_put_in_the_diagram() {
        assert!(findings("rumbo-extra", "libm", None)[0].contains("not in the diagram"));
    }
}
