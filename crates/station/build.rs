//! Rebuilds the crate when a module of the page or a lesson is added, changed or removed.

fn main() {
    for folder in ["web/src", "docs/lessons"] {
        println!("cargo::rerun-if-changed=../../{folder}");
    }
}
