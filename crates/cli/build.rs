//! A release carries the image for the Mega: `RUMBO_IMAGE` names it, Intel HEX. Other builds carry none.

fn main() {
    println!("cargo::rerun-if-env-changed=RUMBO_IMAGE");
    println!("cargo::rustc-check-cfg=cfg(carries_image)");
    if let Ok(path) = std::env::var("RUMBO_IMAGE") {
        println!("cargo::rerun-if-changed={path}");
        println!("cargo::rustc-env=RUMBO_IMAGE={path}");
        println!("cargo::rustc-cfg=carries_image");
    }
}
