//! Rebuilds the crate when a built-in robot, world or scenario is added, changed or removed.

fn main() {
    for folder in ["robots", "worlds", "scenarios"] {
        println!("cargo::rerun-if-changed=../../{folder}");
    }
}
