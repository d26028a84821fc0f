//! The dashboard: its types by `tsc --checkJs`, and its behaviour in Chromium. Node is needed for these tests only.

use super::{Stop, tools};
use crate::project::{Project, run};

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

/// Runs `web/test` against the release build of `rumbo`, and against the site.
pub(crate) fn browser(project: &Project) -> Result<(), Stop> {
    let node = tools::node(project)?;
    let chromium = tools::chromium(project)?;
    let rumbo = project.release_binary()?;
    let site = crate::site::build(project)?;
    let hashes = project.program("hashes")?;
    let web = project.root.join("web");
    let tests = test_files(&web.join("test"))?;
    let mut test = project.command(node);
    test.current_dir(&web)
        .env("RUMBO_BIN", rumbo)
        .env("CHROMIUM", chromium)
        .env("SKETCHES", project.target.join("sketches"))
        .env("SITE", site)
        .env("FIRMWARE", project.target.join("firmware/rumbo.elf"))
        .env("HASHES", hashes);
    Ok(run(test
        .args(["--test", "--test-concurrency=2", "--test-reporter=spec"])
        .args(tests))?)
}

/// The test files, named one by one: what `node --test` makes of a folder differs between its versions.
fn test_files(folder: &std::path::Path) -> Result<Vec<std::path::PathBuf>, Stop> {
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
