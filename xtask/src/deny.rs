//! Licences, sources and bans of every dependency, as `deny.toml` has them: `cargo xtask test --only deny`.
//!
//! `cargo deny` checks the same plus the advisories, in .github/workflows/ci.yml. Building it takes six minutes of
//! processor time; what needs no list from the network is therefore checked here, from `cargo metadata`.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;
use spdx::{Expression, ParseMode};

use crate::project::{Project, all_metadata};

/// The workspaces.
const MANIFESTS: [&str; 5] = [
    "Cargo.toml",
    "firmware/Cargo.toml",
    "fuzz/Cargo.toml",
    "ros/Cargo.toml",
    "tools/bindgen/Cargo.toml",
];

/// The part of `deny.toml` used here.
#[derive(Deserialize)]
struct Rules {
    licenses: Licenses,
    sources: Sources,
    bans: Bans,
}

#[derive(Deserialize)]
struct Licenses {
    allow: Vec<String>,
    exceptions: Vec<Exception>,
}

#[derive(Deserialize)]
struct Exception {
    #[serde(rename = "crate")]
    name: String,
    allow: Vec<String>,
}

#[derive(Deserialize)]
struct Sources {
    #[serde(rename = "allow-registry")]
    registries: Vec<String>,
}

#[derive(Deserialize)]
struct Bans {
    deny: Vec<Banned>,
}

#[derive(Deserialize)]
struct Banned {
    #[serde(rename = "crate")]
    name: String,
}

/// Checks the workspaces and prints what is found; true if nothing.
pub(crate) fn check(project: &Project) -> Result<bool, String> {
    let path = project.root.join("deny.toml");
    let rules = read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let (mut seen, mut found) = (0, 0);
    for manifest in MANIFESTS {
        let metadata = all_metadata(&project.root.join(manifest))?;
        for package in metadata["packages"].as_array().into_iter().flatten() {
            seen += 1;
            if let Some(problem) = rules.problem(package) {
                found += 1;
                let (name, version) = (text(package, "name"), text(package, "version"));
                println!("{manifest}: {name} {version}: {problem}");
            }
        }
    }
    println!("deny: {seen} packages, {found} not as deny.toml has them");
    Ok(found == 0)
}

fn read(path: &Path) -> Result<Rules, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    toml::from_str(&text).map_err(|error| error.to_string())
}

fn text<'a>(package: &'a Value, key: &str) -> &'a str {
    package[key].as_str().unwrap_or_default()
}

impl Rules {
    /// The problem of a package of `cargo metadata`, and the remedy.
    fn problem(&self, package: &Value) -> Option<String> {
        let name = text(package, "name");
        if self.bans.deny.iter().any(|banned| banned.name == name) {
            return Some("banned; deny.toml says why, `cargo tree -i` who needs it".into());
        }
        let source = text(package, "source");
        let registry = source.strip_prefix("registry+").unwrap_or(source);
        // Without a source it is ours.
        if !source.is_empty()
            && !self
                .sources
                .registries
                .iter()
                .any(|known| known == registry)
        {
            return Some(format!("comes from {source}; use a release of crates.io"));
        }
        self.license_problem(name, text(package, "license"))
    }

    fn license_problem(&self, name: &str, license: &str) -> Option<String> {
        let exception = self.licenses.exceptions.iter().find(|one| one.name == name);
        let allowed: Vec<&String> = exception
            .map(|one| &one.allow)
            .into_iter()
            .chain([&self.licenses.allow])
            .flatten()
            .collect();
        match Expression::parse_mode(license, ParseMode::LAX) {
            Ok(expression) => {
                let fits = expression
                    .evaluate(|one| allowed.iter().any(|known| **known == one.to_string()));
                (!fits).then(|| {
                    format!("licence `{license}` is none of deny.toml; choose another crate, or allow it there with the reason")
                })
            }
            Err(_) => Some(format!(
                "licence `{license}` is no SPDX expression; choose another crate"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn problem(name: &str, license: &str, source: Option<&str>) -> Option<String> {
        let rules = r#"
            [licenses]
            allow = ["MIT", "Apache-2.0"]
            exceptions = [{ crate = "tool", allow = ["GPL-3.0-only"] }]
            [sources]
            allow-registry = ["https://registry"]
            [bans]
            deny = [{ crate = "banned" }]
        "#;
        let rules: Rules = toml::from_str(rules).expect("rules");
        rules.problem(&json!({ "name": name, "license": license, "source": source }))
    }

    #[test]
    fn a_licence_fits_if_one_of_its_choices_does() {
        for license in [
            "MIT",
            "GPL-2.0-only OR MIT",
            "Apache-2.0/MIT",
            "MIT AND Apache-2.0",
        ] {
            assert_eq!(problem("a", license, None), None, "{license}");
        }
        for license in ["GPL-3.0-only", "MIT AND GPL-3.0-only", "", "my own"] {
            assert!(problem("a", license, None).is_some(), "{license}");
        }
        assert_eq!(problem("tool", "GPL-3.0-only", None), None);
    }

    #[test]
    fn what_is_not_of_the_registry_or_is_banned_is_named() {
        assert_eq!(problem("a", "MIT", Some("registry+https://registry")), None);
        for source in ["registry+https://other", "git+https://registry"] {
            assert!(problem("a", "MIT", Some(source)).is_some_and(|said| said.contains(source)));
        }
        assert!(problem("banned", "MIT", None).is_some());
    }
}
