//! Gives the linker avr-libc's and libgcc's own arithmetic.
use std::path::PathBuf;
use std::process::Command;
const LIBM: &[&str] = &[
    "addsf3",
    "addsf3x",
    "mulsf3",
    "mulsf3x",
    "divsf3",
    "divsf3x",
    "cmpsf2",
    "gesf2",
    "unordsf2",
    "negsf2",
    "floatsisf",
    "fixsfsi",
    "fixunssfsi",
    "fp_cmp",
    "fp_inf",
    "fp_nan",
    "fp_pscA",
    "fp_pscB",
    "fp_round",
    "fp_split3",
    "fp_zero",
    "fp_mintl",
    "fp_mpack",
    "fp_norm2",
    "fp_trunc",
];
const LIBC: &[&str] = &["memcpy", "memmove", "memset", "memcmp"];
const LIBGCC: &[&str] = &[
    "_udivmodsi4",
    "_divmodsi4",
    "_negsi2",
    "_udivmodhi4",
    "_divmodhi4",
    "_udivmodqi4",
    "_divmodqi4",
    "_muldi3",
    "_muldi3_6",
];
fn file(name: &str) -> PathBuf {
    let o = Command::new("avr-gcc")
        .args(["-mmcu=atmega2560", &format!("-print-file-name={name}")])
        .output()
        .unwrap();
    PathBuf::from(String::from_utf8(o.stdout).unwrap().trim())
}
fn main() {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap());
    let libgcc = Command::new("avr-gcc")
        .args(["-mmcu=atmega2560", "-print-libgcc-file-name"])
        .output()
        .unwrap();
    let libgcc = PathBuf::from(String::from_utf8(libgcc.stdout).unwrap().trim());
    for (lib, names) in [
        (file("libm.a"), LIBM),
        (file("libc.a"), LIBC),
        (libgcc, LIBGCC),
    ] {
        for n in names {
            assert!(
                Command::new("avr-ar")
                    .current_dir(&out)
                    .arg("x")
                    .arg(&lib)
                    .arg(format!("{n}.o"))
                    .status()
                    .unwrap()
                    .success()
            );
            println!(
                "cargo::rustc-link-arg={}",
                out.join(format!("{n}.o")).display()
            );
        }
    }
}
