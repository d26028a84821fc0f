//! `cargo xtask release`: what a version is published as, in `dist/`, for the machine that it is built on.
//!
//! An archive and, on Debian, a package, both with the command, which carries the image for the Mega, on Linux the node
//! of ROS 2, manual pages, completions and the licences of what is linked in; the image as a file of its own; a bill of
//! materials (CycloneDX); installers; checksums. `.github/workflows/release.yml` does it on each system.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::project::{Project, all_metadata, find_program, output, run as run_command};
use crate::tools::{self, Stop};

/// Names that texts of licences have.
const LICENCE_FILES: [&str; 5] = ["LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE"];
/// The shells that completions are for, and their places below the prefix.
const COMPLETIONS: [(&str, &str); 3] = [
    ("bash", "share/bash-completion/completions/rumbo"),
    ("zsh", "share/zsh/site-functions/_rumbo"),
    ("fish", "share/fish/vendor_completions.d/rumbo.fish"),
];
/// The workspace of the node of ROS 2, and its package.
const NODE: [&str; 2] = ["ros/Cargo.toml", "rumbo-ros-node"];
/// The crates that others can use alone.
const CRATES: [&str; 4] = [
    "rumbo-control",
    "rumbo-wire",
    "rumbo-plant",
    "rumbo-emulator",
];
/// The installers; `@VERSION@` becomes the version, `@FILES@` the address of the release's files.
const INSTALLERS: [(&str, &str); 2] = [
    ("install.sh", include_str!("release/install.sh")),
    ("install.ps1", include_str!("release/install.ps1")),
];

/// A crate that is linked into the command.
struct Linked {
    name: String,
    version: String,
    licence: String,
    /// Its folder.
    folder: PathBuf,
    /// It is of the registry, not of this project.
    is_foreign: bool,
}

/// Builds the release, or reports the missing tool.
pub(crate) fn run(project: &Project) -> Result<bool, String> {
    println!("{}", build(project)?.display());
    Ok(true)
}

/// Builds the release anew and returns its folder.
pub(crate) fn build(project: &Project) -> Result<PathBuf, Stop> {
    let image = match std::env::var_os("RUMBO_IMAGE") {
        Some(image) => project.root.join(image),
        None => {
            crate::firmware::build(project)?;
            project.target.join("firmware/rumbo.hex")
        }
    };
    let mut build = project.cargo(&["build", "--release", "--locked"]);
    run_command(build.env("RUMBO_IMAGE", &image))?;
    let mut linked = linked(project, ["Cargo.toml", "rumbo-cli"])?;
    let mut commands = vec![project.release_binary_path()];
    // Where ROS 2 is.
    if cfg!(target_os = "linux") {
        let folder = project.target.join("rumbo-ros");
        let mut build = project.cargo(&["build", "--release", "--locked", "--manifest-path"]);
        run_command(build.arg(NODE[0]).env("CARGO_TARGET_DIR", &folder))?;
        commands.push(folder.join("release/rumbo-ros"));
        linked.append(&mut self::linked(project, NODE)?);
    }
    let linked: Vec<Linked> = linked.into_values().collect();
    let version = env!("CARGO_PKG_VERSION");
    let name = stem(version, std::env::consts::ARCH, std::env::consts::OS);
    let dist = project.root.join("dist");
    clear(&dist)?;
    let prefix = dist.join(&name);
    fill(project, &prefix, &commands, &linked)?;

    let archive = format!("{name}.tar.gz");
    let tar = ["--sort=name", "--owner=0", "--group=0", "--numeric-owner"];
    let tar = if cfg!(target_os = "linux") {
        &tar[..]
    } else {
        &[]
    };
    let mut pack = project.command("tar");
    run_command(
        pack.current_dir(&dist)
            .args(tar)
            .args(["-czf", &archive, &name]),
    )?;
    if find_program("dpkg-deb").is_some() {
        package(project, &dist, &prefix, version)?;
    }
    fs::remove_dir_all(&prefix).map_err(|error| wrong(&prefix, &error))?;
    copy(&image, &dist.join("rumbo.hex"))?;
    write(&dist.join("rumbo.cdx.json"), &bill(&linked, version))?;
    let files = std::env::var("RUMBO_FILES").unwrap_or_default();
    for (file, text) in INSTALLERS {
        let text = text
            .replace("@VERSION@", version)
            .replace("@FILES@", &files);
        write(&dist.join(file), &text)?;
    }
    checksums(project, &dist)?;
    Ok(dist)
}

/// The name of an archive without its ending, and of the folder in it.
fn stem(version: &str, machine: &str, system: &str) -> String {
    format!("rumbo-{version}-{machine}-{system}")
}

/// Everything below the prefix, `/usr` or `~/.local`; the first command is `rumbo`.
fn fill(
    project: &Project,
    prefix: &Path,
    commands: &[PathBuf],
    linked: &[Linked],
) -> Result<(), String> {
    for command in commands {
        let name = command.file_name().unwrap_or_default();
        copy(command, &prefix.join("bin").join(name))?;
    }
    let command = &commands[0];
    for (shell, place) in COMPLETIONS {
        let script = output(project.command(command).args(["completions", shell]))?;
        write(&prefix.join(place), &script)?;
    }
    let manual = prefix.join("share/man/man1");
    fs::create_dir_all(&manual).map_err(|error| wrong(&manual, &error))?;
    run_command(project.command(command).arg("manual").arg(&manual))?;
    let papers = prefix.join("share/doc/rumbo");
    for file in ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"] {
        copy(&project.root.join(file), &papers.join(file))?;
    }
    write(&papers.join("THIRD-PARTY.txt"), &licences(linked)?)
}

/// What is linked into a package's command, by name and version.
fn linked(
    project: &Project,
    [manifest, package]: [&str; 2],
) -> Result<BTreeMap<(String, String), Linked>, String> {
    let metadata = all_metadata(&project.root.join(manifest))?;
    let mut folders = BTreeMap::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
        let folder = PathBuf::from(text("manifest_path"))
            .parent()
            .map(Path::to_owned);
        let known = (
            folder.unwrap_or_default(),
            text("license"),
            !package["source"].is_null(),
        );
        folders.insert((text("name"), text("version")), known);
    }
    let tree = project.cargo(&[
        "tree",
        "--locked",
        "--manifest-path",
        manifest,
        "--package",
        package,
        "--edges",
        "normal",
        "--prefix",
        "none",
        "--format",
        "{p}",
    ]);
    let tree = output(&mut { tree })?;
    let mut linked = BTreeMap::new();
    for line in tree.lines() {
        let mut words = line.split_whitespace();
        let (Some(name), Some(version)) = (words.next(), words.next()) else {
            continue;
        };
        let key = (name.to_owned(), version.trim_start_matches('v').to_owned());
        if let Some((folder, licence, is_foreign)) = folders.get(&key) {
            let (name, version) = key.clone();
            let one = Linked {
                name,
                version,
                licence: licence.clone(),
                folder: folder.clone(),
                is_foreign: *is_foreign,
            };
            linked.insert(key, one);
        }
    }
    Ok(linked)
}

/// The licences of the crates of others: a list, then each text once, with the crates that it is of.
fn licences(linked: &[Linked]) -> Result<String, String> {
    let foreign = || linked.iter().filter(|one| one.is_foreign);
    let mut text =
        String::from("The commands `rumbo` and `rumbo-ros` contain these crates of crates.io.\n\n");
    for one in foreign() {
        let _ = writeln!(text, "{} {}: {}", one.name, one.version, one.licence);
    }
    let mut of: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for one in foreign() {
        for path in licence_files(&one.folder)? {
            let bytes = fs::read(&path).map_err(|error| wrong(&path, &error))?;
            let words = String::from_utf8_lossy(&bytes).trim().replace('\r', "");
            let name = format!("{} {}", one.name, one.version);
            of.entry(words).or_default().push(name);
        }
    }
    for (words, mut names) in of {
        names.dedup();
        let _ = write!(
            text,
            "\n{}\n{}\n\n{words}\n",
            "-".repeat(80),
            names.join(", ")
        );
    }
    Ok(text)
}

fn licence_files(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(folder).map_err(|error| wrong(folder, &error))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .to_uppercase();
        path.is_file() && LICENCE_FILES.iter().any(|known| name.starts_with(known))
    });
    files.sort();
    Ok(files)
}

/// The bill of materials, CycloneDX 1.5.
fn bill(linked: &[Linked], version: &str) -> String {
    let component = |one: &Linked| {
        let mut component = json!({
            "type": "library",
            "bom-ref": format!("pkg:cargo/{}@{}", one.name, one.version),
            "name": one.name,
            "version": one.version,
        });
        if one.is_foreign {
            component["purl"] = component["bom-ref"].clone();
        }
        if spdx::Expression::parse(&one.licence).is_ok() {
            component["licenses"] = json!([{ "expression": one.licence }]);
        }
        component
    };
    let components: Vec<Value> = linked.iter().map(component).collect();
    let bill = json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": { "component": { "type": "application", "name": "rumbo", "version": version } },
        "components": components,
    });
    format!("{bill:#}\n")
}

/// The package for Debian.
fn package(project: &Project, dist: &Path, prefix: &Path, version: &str) -> Result<(), String> {
    let architecture = output(project.command("dpkg").arg("--print-architecture"))?;
    let architecture = architecture.trim();
    // What it was built with, or newer.
    let libc = output(
        project
            .command("dpkg-query")
            .args(["-W", "-f=${Version}", "libc6"]),
    )?;
    let libc = libc.split('-').next().unwrap_or_default();
    let root = dist.join("root");
    fs::create_dir_all(root.join("DEBIAN")).map_err(|error| wrong(&root, &error))?;
    let mut copied = project.command("cp");
    run_command(copied.arg("-a").arg(prefix).arg(root.join("usr")))?;
    let control = format!(
        "Package: rumbo\nVersion: {version}\nArchitecture: {architecture}\nSection: science\nPriority: optional\n\
         Maintainer: The maintainers of Rumbo <maintainers@rumbo.invalid>\n\
         Depends: libc6 (>= {libc}), libgcc-s1\nSuggests: bubblewrap\n\
         Description: laboratory for a small differential-drive robot\n \
         Control program, simulator, emulated Arduino Mega and Uno, dashboard in the\n \
         browser, recording, sweeps, tuning, grading, a node of ROS 2.\n"
    );
    write(&root.join("DEBIAN/control"), &control)?;
    let file = dist.join(format!("rumbo_{version}_{architecture}.deb"));
    let mut build = project.command("dpkg-deb");
    run_command(
        build
            .args(["--root-owner-group", "--build"])
            .arg(&root)
            .arg(file),
    )?;
    fs::remove_dir_all(&root).map_err(|error| wrong(&root, &error))
}

fn checksums(project: &Project, dist: &Path) -> Result<(), String> {
    let entries = fs::read_dir(dist).map_err(|error| wrong(dist, &error))?;
    let mut names: Vec<_> = entries.flatten().map(|entry| entry.file_name()).collect();
    names.sort();
    let program = match find_program("sha256sum") {
        Some(_) => vec!["sha256sum"],
        None => vec!["shasum", "-a", "256"],
    };
    let mut sums = project.command(program[0]);
    let sums = output(sums.current_dir(dist).args(&program[1..]).args(names))?;
    write(&dist.join("SHA256SUMS"), &sums)
}

/// Installs the Debian package in a system with nothing else on it and no network, and has it do its main job.
pub(crate) fn try_it(project: &Project) -> Result<(), Stop> {
    let dist = build(project)?;
    let root = clean_system(project, "bookworm", &[])?;
    for entry in fs::read_dir(&dist)
        .map_err(|error| wrong(&dist, &error))?
        .flatten()
    {
        let name = entry.file_name();
        if name.to_string_lossy().ends_with(".deb") {
            copy(&entry.path(), &root.join("tmp/rumbo.deb"))?;
        }
    }
    for words in [
        &["dpkg", "--install", "/tmp/rumbo.deb"][..],
        &["rumbo", "--version"],
        &["rumbo-ros", "--version"],
        &["rumbo", "run", "mode1", "--runs", "20", "--out", "/tmp/out"],
        &["rumbo", "rerun", "/tmp/out/mode1-7.mcap"],
        // It has an image, and no port.
        &[
            "sh",
            "-c",
            "rumbo flash /dev/null 2>&1 | grep 'cannot be opened'",
        ],
    ] {
        inside(project, &root, words)?;
    }
    Ok(())
}

/// A system of this Debian with nothing on it but these packages; returns its root.
pub(crate) fn clean_system(
    project: &Project,
    suite: &str,
    packages: &[&str],
) -> Result<PathBuf, Stop> {
    tools::debootstrap(project)?;
    let root = project.target.join(format!("tmp/clean-{suite}"));
    let _ = fs::remove_dir_all(&root);
    let mut bootstrap = project.command("debootstrap");
    bootstrap.arg("--variant=minbase");
    if !packages.is_empty() {
        bootstrap.arg(format!("--include={}", packages.join(",")));
    }
    run_command(bootstrap.arg(suite).arg(&root))?;
    Ok(root)
}

/// Runs a command in such a system, without a network, among its own processes.
pub(crate) fn inside(project: &Project, root: &Path, words: &[&str]) -> Result<(), String> {
    let mut proc = OsString::from("--mount-proc=");
    proc.push(root.join("proc"));
    let mut inside = project.command("unshare");
    inside.args(["--net", "--pid", "--fork"]).arg(proc);
    run_command(inside.arg("chroot").arg(root).args(words))
}

/// Has cargo pack the crates that others can use alone, and build them from what it packed.
pub(crate) fn try_crates(project: &Project) -> Result<(), String> {
    let mut publish = project.cargo(&["publish", "--dry-run", "--locked", "--allow-dirty"]);
    for name in CRATES {
        publish.args(["--package", name]);
    }
    run_command(&mut publish)
}

fn clear(folder: &Path) -> Result<(), String> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(wrong(folder, &error)),
        _ => fs::create_dir_all(folder).map_err(|error| wrong(folder, &error)),
    }
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    make_folder(to)?;
    fs::copy(from, to).map_err(|error| wrong(from, &error))?;
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    make_folder(path)?;
    fs::write(path, text).map_err(|error| wrong(path, &error))
}

fn make_folder(of: &Path) -> Result<(), String> {
    let folder = of.parent().unwrap_or(of);
    fs::create_dir_all(folder).map_err(|error| wrong(folder, &error))
}

fn wrong(path: &Path, error: &std::io::Error) -> String {
    format!("{}: {error}", path.display())
}

#[cfg(test)]
mod tests;
