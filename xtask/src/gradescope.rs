//! Gradescope's autograder as Gradescope uses it: set up with a network in a system with nothing on it, then run for
//! submissions without one, as root and without namespaces, as in its container.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::project::{Project, run};
use crate::release::{clean_system, inside};
use crate::tools::{self, Stop};

const ASSIGNMENT: &str = "examples/assignments/wall/assignment.toml";
const MODEL: &str = "examples/assignments/wall/model/model.ino";
/// What nobody may read who hands something in: seeds, results of others' tries, files of root.
const CLOSED: [&str; 4] = [
    "/autograder/source/assignment/assignment.toml",
    "/autograder/submission_metadata.json",
    "/autograder/results/results.json",
    "/etc/shadow",
];

/// Writes the archive, sets it up and grades: the model, and submissions that read what is closed to them.
pub(crate) fn try_it(project: &Project) -> Result<(), Stop> {
    let unzip = tools::unzip(project)?;
    run(&mut project.cargo(&["build", "--locked", "--package", "rumbo-cli"]))?;
    let rumbo = project.target.join("debug/rumbo");
    let root = clean_system(project, "bookworm", &[])?;
    let place = root.join("autograder");
    let (source, submission) = (place.join("source"), place.join("submission"));
    for folder in [&source, &submission] {
        fs::create_dir_all(folder).map_err(|error| wrong(folder, &error))?;
    }
    let archive = root.join("tmp/autograder.zip");
    let mut pack = project.command(rumbo);
    pack.args(["grade", ASSIGNMENT, "--language", "en", "--gradescope"]);
    run(pack.arg(&archive))?;
    run(project
        .command(unzip)
        .arg("-q")
        .arg(&archive)
        .arg("-d")
        .arg(&source))?;
    run(project
        .command("chroot")
        .arg(&root)
        .arg("/autograder/source/setup.sh"))?;
    let script = place.join("run_autograder");
    fs::copy(source.join("run_autograder"), &script).map_err(|error| wrong(&script, &error))?;
    write(&place.join("submission_metadata.json"), "{}")?;
    let model = fs::read_to_string(project.root.join(MODEL)).map_err(|error| error.to_string())?;
    let graded = |text: &str| -> Result<Value, String> {
        write(&submission.join("wall.ino"), text)?;
        inside(project, &root, &["/autograder/run_autograder"])?;
        let path = place.join("results/results.json");
        let results = fs::read_to_string(&path).map_err(|error| wrong(&path, &error))?;
        serde_json::from_str(&results).map_err(|error| wrong(&path, &error))
    };
    let results = graded(&model)?;
    if results["score"] != 10.0 {
        return Err(format!("the model earns less than all points: {results:#}").into());
    }
    for path in CLOSED {
        for text in [
            format!("#include \"{path}\"\n{model}"),
            format!("__asm__(\".incbin \\\"{path}\\\"\");\n{model}"),
        ] {
            let results = graded(&text)?;
            // Nothing of it was compiled, and nothing is quoted.
            if results["score"] != 0.0 || results.to_string().contains("hidden_seeds") {
                return Err(format!("{path} can be read: {results:#}").into());
            }
        }
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    fs::write(path, text).map_err(|error| wrong(path, &error))
}

fn wrong(path: &Path, error: &impl std::fmt::Display) -> String {
    format!("{}: {error}", path.display())
}
