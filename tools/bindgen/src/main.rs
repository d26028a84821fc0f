//! Writes the JavaScript module around a compiled `.wasm`, as `cargo xtask site` starts it: `rumbo-bindgen WASM FOLDER
//! NAME` makes `NAME.js` and `NAME_bg.wasm`.
//!
//! This is `wasm-bindgen --target web`, by its library of the version that the code was compiled with.

use std::process::ExitCode;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [wasm, folder, name] = &arguments[..] else {
        eprintln!("usage: rumbo-bindgen WASM FOLDER NAME");
        return ExitCode::from(2);
    };
    match write(wasm, folder, name) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("rumbo-bindgen: {wasm}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn write(wasm: &str, folder: &str, name: &str) -> Result<(), String> {
    let mut bindgen = Bindgen::new();
    let wrong = |error| format!("{error:#}");
    bindgen.input_path(wasm).out_name(name);
    // The module finds the other one beside it.
    bindgen.omit_default_module_path(false);
    bindgen.typescript(false).remove_name_section(true);
    bindgen.web(true).map_err(wrong)?;
    bindgen.generate(folder).map_err(wrong)
}
