//! The dashboard: its types by `tsc --checkJs`, and its behaviour in Chromium. Node is needed for these tests only.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use super::{Stop, tools};
use crate::project::{Project, run};

/// More files than these fail for a reason of their own.
const MOST_TRIED_AGAIN: usize = 3;

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

/// Runs `web/test` against the release build of `rumbo`, and against the site. Files with a test that failed run once
/// more, alone: two browsers, a station and a robot on a busy machine can each come too late for the other. A test that
/// passes only then is named, to be mended.
pub(crate) fn browser(project: &Project) -> Result<(), Stop> {
    let node = tools::node(project)?;
    let chromium = tools::chromium(project)?;
    let rumbo = project.release_binary()?;
    let site = crate::site::build(project)?;
    let hashes = project.program("hashes")?;
    let web = project.root.join("web");
    let folder = project.target.join("tmp");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let failures = folder.join("browser-failures.txt");
    let tests = |at_once: usize, files: &[PathBuf]| {
        let mut test = project.command(&node);
        test.current_dir(&web)
            .env("RUMBO_BIN", &rumbo)
            .env("CHROMIUM", &chromium)
            .env("SKETCHES", project.target.join("sketches"))
            .env("SITE", &site)
            .env("FIRMWARE", project.target.join("firmware/rumbo.elf"))
            .env("HASHES", &hashes)
            .arg("--test")
            .arg(format!("--test-concurrency={at_once}"))
            .args(["--test-reporter=spec", "--test-reporter-destination=stdout"])
            .arg("--test-reporter=./test/failed.mjs")
            .arg(format!(
                "--test-reporter-destination={}",
                failures.display()
            ))
            .args(files);
        run(&mut test)
    };
    let Err(error) = tests(3, &test_files(&web.join("test"))?) else {
        return Ok(());
    };
    let failed = std::fs::read_to_string(&failures).unwrap_or_default();
    let failed: BTreeSet<_> = failed.lines().map(PathBuf::from).collect();
    if failed.is_empty() || failed.len() > MOST_TRIED_AGAIN {
        return Err(Stop::Failed(error));
    }
    let failed: Vec<_> = failed.into_iter().collect();
    println!("once more, alone: {failed:?}");
    tests(1, &failed)?;
    println!("FLAKY, passed alone and not beside others: {failed:?}");
    Ok(())
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
