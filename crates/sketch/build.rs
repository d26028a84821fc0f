//! Rebuilds the crate when an example or a library is added, changed or removed.

fn main() {
    for folder in ["libraries", "../../examples/arduino"] {
        println!("cargo::rerun-if-changed={folder}");
    }
}
