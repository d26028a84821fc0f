//! `cargo xtask site`: the lab, and beside it lessons and documents, as static pages in `site/`, for any web server that
//! serves files.
//!
//! The crate `browser` is compiled to WebAssembly with the Rust of the firmware, which has the sources of the library:
//! no further target need be installed. Beside it stand the files of `web/`; `index.html` gets a content policy, which
//! the station sends as a header, and the note that its session runs in the page. [`pages`] are all the others; `api/` is
//! what rustdoc makes of the crates that others can use; [`search`] makes the index of both. The image for the Mega is part
//! of the site if it has been built.

mod links;
mod pages;
mod search;

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use sha2::{Digest, Sha256};

use crate::firmware::toolchain::Toolchain;
use crate::project::{Project, find_program, output, run as run_command};
use crate::tools::{self, Stop};

const TARGET: &str = "wasm32-unknown-unknown";
/// As in `Cargo.toml`.
const PROFILE: &str = "site";
/// What of `web/` the page loads.
const FILES: [&str; 5] = [
    "index.html",
    "style.css",
    "icon.svg",
    "app.webmanifest",
    OFFLINE,
];
/// Keeps the files for use without a network, by their list.
const OFFLINE: &str = "offline.js";
/// Kept with the lab: a class reads them where the network is slow.
const LESSONS: &str = "docs/lessons/";
const LIST: &str = "const FILES = [];\nconst VERSION = '';\n";
const FOLDERS: [&str; 5] = ["src", "src/spanish", "lab", "vendor/uplot", "pages"];
/// The program for the Mega, as `cargo xtask firmware` builds it, and how the page calls it.
const IMAGE: [&str; 2] = ["firmware/rumbo.hex", "rumbo.hex"];
/// The lab and the report as WebAssembly, each with its script.
const MODULES: [&str; 2] = ["rumbo", "rumbo_report"];
/// What stands between `<style>`, after a line break, and `</style>` of a report.
const STYLES: [&str; 2] = ["crates/plot/src/plot.css", "crates/report/src/style.css"];
/// Where the additions to `index.html` go.
const MARK: &str = "<meta charset=\"utf-8\">\n";
/// Everything comes from the site itself; blobs are what the page made: pictures, and reports, whose style stands in them.
/// Browsers count the compilation of WebAssembly as a kind of `eval`.
const HEAD: &str = r#"  <meta http-equiv="Content-Security-Policy" content="default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' '{style}'; img-src 'self' blob: data:; base-uri 'none'; form-action 'none'; object-src 'none'">
  <meta name="referrer" content="no-referrer">
  <meta name="rumbo-session" content="page">
  <link rel="manifest" href="app.webmanifest">
"#;

/// Builds the site, or reports the missing tool.
pub(crate) fn run(project: &Project) -> Result<bool, String> {
    println!("{}", build(project)?.display());
    Ok(true)
}

/// Builds the site anew and returns its folder.
pub(crate) fn build(project: &Project) -> Result<PathBuf, Stop> {
    let modules = compile(project)?;
    let site = project.root.join("site");
    match fs::remove_dir_all(&site) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(wrong(&site, &error).into());
        }
        _ => {}
    }
    let web = project.root.join("web");
    for folder in FOLDERS {
        copy_scripts(&web.join(folder), &site.join(folder))?;
    }
    for file in FILES {
        copy(&web.join(file), &site.join(file))?;
    }
    let head = HEAD.replace("{style}", &report_style(project)?) + &carry_image(project, &site)?;
    complete(&site.join("index.html"), &head)?;
    let lab = site.join("lab");
    let bindgen = bindgen(project)?;
    for (wasm, name) in modules.iter().zip(MODULES) {
        let mut bindgen = project.command(&bindgen);
        run_command(bindgen.arg(wasm).arg(&lab).arg(name))?;
    }
    let mut kept = names_below(&site)?;
    // Kept when it is asked for.
    kept.retain(|name| !name.starts_with(&format!("lab/{}", MODULES[1])));
    pages::write(project, &site)?;
    let lessons = names_below(&site.join(LESSONS))?;
    // A folder's first page is asked for by the folder.
    kept.extend(
        lessons
            .iter()
            .map(|name| format!("{LESSONS}{}", name.trim_end_matches("index.html"))),
    );
    document(project, &site.join("api"))?;
    search::write(&site)?;
    list_files(&site, kept)?;
    links::check(&site)?;
    Ok(site)
}

/// What rustdoc makes of the crates that others can use.
fn document(project: &Project, folder: &Path) -> Result<(), String> {
    // Apart: the usual folder has all crates.
    let target = project.target.join("api");
    let mut doc = project.cargo(&["doc", "--quiet", "--locked", "--no-deps", "--lib"]);
    doc.args(pages::API.map(|name| format!("--package=rumbo-{name}")));
    run_command(doc.arg("--target-dir").arg(&target))?;
    let made = target.join("doc");
    for name in names_below(&made)? {
        copy(&made.join(&name), &folder.join(&name))?;
    }
    Ok(())
}

/// Gives the service worker the list of the files that it keeps from the start, and a version that changes with what is in
/// any file of the site.
fn list_files(site: &Path, mut kept: Vec<String>) -> Result<(), String> {
    let mut hasher = DefaultHasher::new();
    for name in names_below(site)? {
        let path = site.join(&name);
        let content = fs::read(&path).map_err(|error| wrong(&path, &error))?;
        (&name, content).hash(&mut hasher);
    }
    kept.retain(|name| name != OFFLINE && !name.ends_with(".d.ts"));
    // The page itself is asked for by its folder.
    kept.insert(0, "./".to_owned());
    let offline = site.join(OFFLINE);
    let text = fs::read_to_string(&offline).map_err(|error| wrong(&offline, &error))?;
    let Some((before, after)) = text.split_once(LIST) else {
        return Err(format!("{}: no line {LIST:?}", offline.display()));
    };
    let list = serde_json::json!(kept);
    let version = hasher.finish();
    let text = format!("{before}const FILES = {list};\nconst VERSION = '{version:016x}';\n{after}");
    fs::write(&offline, text).map_err(|error| wrong(&offline, &error))
}

/// Paths of all files below a folder, relative to it, in order.
fn names_below(folder: &Path) -> Result<Vec<String>, String> {
    let name = |path: PathBuf| {
        let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy();
        name.replace('\\', "/")
    };
    let mut names: Vec<String> = files_below(folder)?.into_iter().map(name).collect();
    names.sort();
    Ok(names)
}

fn files_below(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| wrong(folder, &error))? {
        let path = entry.map_err(|error| wrong(folder, &error))?.path();
        match path.is_dir() {
            true => files.extend(files_below(&path)?),
            false => files.push(path),
        }
    }
    Ok(files)
}

/// The lab and the report as WebAssembly, in the order of [`MODULES`]: the report is loaded when it is asked for.
pub(crate) fn compile(project: &Project) -> Result<[PathBuf; 2], Stop> {
    cargo(project, "build", &["--profile", PROFILE])?;
    let folder = project.target.join("wasm").join(TARGET).join(PROFILE);
    Ok(["rumbo_browser.wasm", "rumbo_report.wasm"].map(|file| folder.join(file)))
}

/// Whether they compile.
pub(crate) fn check(project: &Project) -> Result<(), Stop> {
    cargo(project, "check", &[])
}

/// A command of cargo on them.
fn cargo(project: &Project, command: &str, words: &[&str]) -> Result<(), Stop> {
    let toolchain = Toolchain::find(project)?;
    // Apart, so that this compiler and the usual one do not build each other's crates again.
    let target = project.target.join("wasm");
    let mut build = toolchain.command("cargo");
    build.current_dir(&project.root).args([
        command,
        "--quiet",
        "--locked",
        "--lib",
        "--no-default-features",
        "--package=rumbo-browser",
        "--package=rumbo-report",
        "-Zbuild-std=std,panic_abort",
        // No backtraces: there are none in a browser.
        "-Zbuild-std-features=",
    ]);
    build.args(words).args(["--target", TARGET]);
    build.arg("--target-dir").arg(&target);
    if matches!(toolchain, Toolchain::Debian) {
        build.env(
            "CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER",
            linker(project)?,
        );
    }
    Ok(run_command(&mut build)?)
}

/// What writes the scripts.
fn bindgen(project: &Project) -> Result<PathBuf, String> {
    let target = project.target.join("bindgen");
    let build = ["build", "--quiet", "--locked", "--manifest-path"];
    let mut build = project.cargo(&build);
    build.arg("tools/bindgen/Cargo.toml");
    run_command(build.arg("--target-dir").arg(&target))?;
    let name = format!("rumbo-bindgen{}", std::env::consts::EXE_SUFFIX);
    Ok(target.join("debug").join(name))
}

/// Debian's compiler has no linker for WebAssembly: that of the Rust in use, or else LLVM's.
fn linker(project: &Project) -> Result<PathBuf, Stop> {
    let of_rust = || {
        let root = output(project.command("rustc").args(["--print", "sysroot"])).ok()?;
        let host = output(project.command("rustc").args(["--print", "host-tuple"])).ok()?;
        let library = Path::new(root.trim()).join("lib/rustlib");
        Some(library.join(host.trim()).join("bin/rust-lld"))
    };
    let find = || {
        let found = of_rust().filter(|path| path.is_file());
        found.or_else(|| find_program("wasm-ld"))
    };
    tools::install(
        project,
        "a linker for WebAssembly",
        &["lld"],
        "or a Rust of rustup, which has one",
        find,
    )
}

/// Puts the image for the Mega into the site, if it has been built; returns what the page is to know of it.
fn carry_image(project: &Project, site: &Path) -> Result<String, String> {
    let [built, name] = IMAGE;
    let built = project.target.join(built);
    if !built.exists() {
        println!("without the program for the Mega: `cargo xtask firmware` builds it");
        return Ok(String::new());
    }
    copy(&built, &site.join(name))?;
    let content = fs::read(&built).map_err(|error| wrong(&built, &error))?;
    let digits = Sha256::digest(content)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect::<String>();
    Ok(format!(
        "  <meta name=\"rumbo-image\" content=\"{digits}\">\n"
    ))
}

/// The style of reports as a content policy names it: by its hash. They are shown by the policy of the page that made them.
fn report_style(project: &Project) -> Result<String, String> {
    let mut hasher = Sha256::new();
    hasher.update("\n");
    for file in STYLES {
        let path = project.root.join(file);
        hasher.update(fs::read(&path).map_err(|error| wrong(&path, &error))?);
    }
    Ok(format!("sha256-{}", BASE64.encode(hasher.finalize())))
}

/// The additions to the page.
fn complete(page: &Path, head: &str) -> Result<(), String> {
    let text = fs::read_to_string(page).map_err(|error| wrong(page, &error))?;
    let Some((before, after)) = text.split_once(MARK) else {
        return Err(format!("{}: no line {}", page.display(), MARK.trim()));
    };
    let text = format!("{before}{MARK}{head}{after}");
    fs::write(page, text).map_err(|error| wrong(page, &error))
}

/// Copies what a page loads; declarations of types it does not.
fn copy_scripts(from: &Path, to: &Path) -> Result<(), String> {
    let entries = fs::read_dir(from).map_err(|error| wrong(from, &error))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default();
        if path.is_file() && !name.to_string_lossy().ends_with(".d.ts") {
            copy(&path, &to.join(name))?;
        }
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder).map_err(|error| wrong(folder, &error))?;
    }
    fs::copy(from, to).map_err(|error| wrong(from, &error))?;
    Ok(())
}

fn wrong(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_the_site_has_its_policy_before_anything_that_it_loads() {
        let page = Project::find().unwrap().root.join("web/index.html");
        let text = fs::read_to_string(page).unwrap();
        let (before, after) = text.split_once(MARK).unwrap();
        assert!(!before.contains("href") && !before.contains("src"));
        // In a folder of any name.
        assert!(!after.contains("=\"/"), "an absolute path");
    }
}
