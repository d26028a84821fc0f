//! The dashboard: its types by `tsc --checkJs`, and its behaviour in Node and in Chromium. Node is needed for these tests
//! only.

use std::path::{Path, PathBuf};

use crate::project::{Project, run};
use crate::tools::{self, Stop};

/// Checks the types that the JSDoc comments of `web/` declare.
pub(crate) fn types(project: &Project) -> Result<(), Stop> {
    let node = tools::node(project)?;
    let web = project.root.join("web");
    Ok(run(project.command(node).current_dir(&web).args([
        "node_modules/typescript/bin/tsc",
        "--project",
        ".",
    ]))?)
}

/// Runs the tests of `web/test` that need no browser, then those of `web/test/browser` against `rumbo` as the tests
/// build it.
pub(crate) fn browser(project: &Project) -> Result<(), Stop> {
    let node = tools::node(project)?;
    let web = project.root.join("web");
    let files = test_files(&web.join("test"))?;
    run(project
        .command(&node)
        .current_dir(&web)
        .args(["--test", "--test-reporter=spec"])
        .args(files))?;
    Ok(run(
        in_chromium(project, &node)?.args(["test/run.mjs", "test/browser"])
    )?)
}

/// Runs all tests in the browser, the rare paths and those of the site too, which it builds.
pub(crate) fn browser_full(project: &Project) -> Result<(), Stop> {
    let node = tools::node(project)?;
    let site = crate::site::build(project)?;
    let tools = project.program("rumbo-tools")?;
    Ok(run(in_chromium(project, &node)?
        .env("FULL", "1")
        .env("SITE", site)
        .env("SKETCHES", project.target.join("sketches"))
        .env("FIRMWARE", project.target.join("firmware/rumbo.elf"))
        .env("TOOLS", tools)
        .args(["test/run.mjs", "test/browser", "test/full"]))?)
}

/// Node with what every test in the browser takes.
fn in_chromium(project: &Project, node: &Path) -> Result<std::process::Command, Stop> {
    let chromium = tools::chromium(project)?;
    let rumbo = project.program("rumbo")?;
    let mut test = project.command(node);
    test.current_dir(project.root.join("web"))
        .env("RUMBO_BIN", rumbo)
        .env("CHROMIUM", chromium)
        .arg("--test-reporter=spec");
    Ok(test)
}

/// The test files, named one by one: what `node --test` makes of a folder differs between its versions.
fn test_files(folder: &Path) -> Result<Vec<PathBuf>, Stop> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut files: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.to_string_lossy().ends_with(".test.mjs"));
    files.sort();
    if files.is_empty() {
        return Err(Stop::Failed(format!("{}: no *.test.mjs", folder.display())));
    }
    Ok(files)
}
