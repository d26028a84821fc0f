use super::*;

fn one(name: &str, licence: &str, is_foreign: bool) -> Linked {
    Linked {
        name: name.into(),
        version: "1.2.3".into(),
        licence: licence.into(),
        folder: PathBuf::new(),
        is_foreign,
    }
}

#[test]
fn the_bill_names_every_crate_with_its_licence() {
    let linked = [
        one("a", "MIT OR Apache-2.0", true),
        one("rumbo-plant", "MIT", false),
    ];
    let bill: Value = serde_json::from_str(&bill(&linked, "0.2.0")).expect("JSON");
    assert_eq!(bill["components"][0]["purl"], "pkg:cargo/a@1.2.3");
    assert_eq!(
        bill["components"][0]["licenses"][0]["expression"],
        "MIT OR Apache-2.0"
    );
    assert_eq!(bill["components"][1]["purl"], Value::Null);
}

#[test]
fn cargo_binstall_looks_for_these_archives() {
    let manifest = include_str!("../../../crates/cli/Cargo.toml");
    for system in ["linux", "macos", "windows"] {
        let stem = stem("{ version }", "{ target-arch }", system);
        for part in [
            format!("/{stem}.tar.gz\""),
            format!("\"{stem}/bin/{{ bin }}"),
        ] {
            assert!(manifest.contains(&part), "{part}");
        }
    }
}

#[test]
fn licences_are_of_the_crates_of_others() {
    let text = licences(&[one("rumbo-plant", "MIT", false)]).expect("text");
    assert!(!text.contains("rumbo-plant"));
}
