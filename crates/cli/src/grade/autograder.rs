//! Gradescope's autograder: an archive with this command, the assignment and two scripts, and what it does there.
//!
//! ```text
//! setup.sh          once, with a network: avr-gcc, avr-libc, the Arduino core
//! run_autograder    for each submission, without one: `rumbo grade --autograder /autograder`
//! rumbo
//! assignment/       assignment.toml, and what it names, by the paths that it names
//! ```
//!
//! A container there allows no namespaces, so that a submission is compiled as another user, who sees nothing of this.

use super::{class_notes, compiler, gradescope, hand_ins};
use crate::args::GradeArgs;
use crate::experiments::language;
use crate::failure::Failure;
use crate::output;
use crate::place::{self, Guard};
use crate::run::set_threads;
use rumbo_experiment::grade::{Assignment, grade};
use rumbo_report::FileStamp;
use rumbo_report::text::Language;
use rumbo_sketch::archive::{Bounds, Entry, pack as zip, unpack};
use rumbo_sketch::sandbox::Sandbox;
use std::fs;
use std::path::{Path, PathBuf};

const SETUP: &str = include_str!("setup.sh");
const RUN: &str = include_str!("run_autograder.sh");
/// The assignment's name in the archive.
const ASSIGNMENT: &str = "assignment.toml";
/// Most files beside an assignment.
const MOST_FILES: usize = 500;
/// Depth of folders beside it.
const DEEPEST: usize = 4;

/// Grades the submission of Gradescope's container.
pub(super) fn run(args: &GradeArgs, place: &Path) -> Result<(), Failure> {
    let assignment = Assignment::read(&output::shown(&args.assignment))?;
    set_threads(args.threads)?;
    let found = [hand_ins::only(&place.join("submission"))];
    let compiler = match found[0].is_sketch() {
        true => Some(compiler(&assignment, |toolchain, limits| {
            Sandbox::walled(toolchain, limits).or_else(|_| Sandbox::as_nobody(toolchain, limits))
        })?),
        false => None,
    };
    let notes = class_notes(&assignment, compiler.as_ref());
    let hand_ins = hand_ins::compile(&found, compiler.as_ref(), || true).unwrap_or_default();
    let marks = grade(&assignment, &hand_ins, || true).unwrap_or_default();
    let stamp = FileStamp::of("grade", std::slice::from_ref(&assignment.name));
    let language = language(args.language);
    for mark in &marks {
        let json = gradescope::results(&assignment, mark, &notes, language, &stamp)?;
        place::write(&place.join("results/results.json"), json)?;
    }
    Ok(())
}

/// Writes the archive, and reads the assignment back from it.
pub(super) fn pack(args: &GradeArgs, archive: &Path) -> Result<(), Failure> {
    let assignment = Assignment::read(&output::shown(&args.assignment))?;
    let command = match &args.linux {
        Some(file) => file.clone(),
        None => std::env::current_exe().map_err(Failure::input)?,
    };
    let program = fs::read(&command)
        .map_err(|error| Failure::Input(format!("{}: {error}", command.display())))?;
    if !is_for_linux(&program) {
        return Err(Failure::Input(format!(
            "{}: no program for Linux on x86-64, which Gradescope has: give the path of such a `rumbo` with --linux",
            command.display()
        )));
    }
    let name = match language(args.language) {
        Language::English => "en",
        Language::Spanish => "es",
    };
    let entry = |name: &str, bytes: Vec<u8>, runs| Entry {
        name: name.to_owned(),
        bytes,
        runs,
    };
    let mut entries = vec![
        entry("setup.sh", SETUP.into(), true),
        entry(
            "run_autograder",
            RUN.replace("@LANGUAGE@", name).into(),
            true,
        ),
        entry("rumbo", program, true),
    ];
    for (name, bytes) in files(&args.assignment, &assignment)? {
        entries.push(entry(&format!("assignment/{name}"), bytes, false));
    }
    let guard = Guard::new([args.assignment.clone(), command], args.overwrite.force);
    guard.make_equal(archive, |part| {
        zip(part, &entries).map_err(|error| place::unwritable(archive, &error))?;
        read_back(part, &assignment)
    })?;
    output::line(&output::shown(archive))
}

/// A program for the machines of Gradescope: ELF of 64 bits for x86-64.
fn is_for_linux(program: &[u8]) -> bool {
    program.starts_with(b"\x7fELF\x02\x01") && program.get(18..20) == Some(&[62, 0])
}

/// The assignment's file, and of its folder what it may name: files of TOML, and the sketches that were given.
fn files(path: &Path, assignment: &Assignment) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let unreadable = |path: &Path, error| Failure::Input(format!("{}: {error}", path.display()));
    let folder = path
        .canonicalize()
        .map_err(|error| unreadable(path, error))?;
    let folder = folder.parent().unwrap_or(Path::new("/")).to_owned();
    let mut paths = Vec::new();
    below(&folder, DEEPEST, &mut paths);
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    for given in &assignment.given {
        let given = given
            .canonicalize()
            .map_err(|error| unreadable(given, error))?;
        match given.is_dir() {
            true => below(&given, DEEPEST, &mut paths),
            false => paths.push(given),
        }
    }
    paths.sort();
    paths.dedup();
    if paths.len() > MOST_FILES {
        return Err(Failure::Input(format!(
            "{}: more than {MOST_FILES} files are beside it; put it in a folder of its own",
            path.display()
        )));
    }
    let read = |path: &Path| fs::read(path).map_err(|error| unreadable(path, error));
    let mut files = vec![(ASSIGNMENT.to_owned(), read(path)?)];
    for path in paths {
        let inner = path.strip_prefix(&folder).map_err(|_| {
            Failure::Input(format!(
                "{}: is not in the assignment's folder",
                path.display()
            ))
        })?;
        let parts: Vec<_> = inner.iter().map(|part| part.to_string_lossy()).collect();
        let name = parts.join("/");
        if name != ASSIGNMENT {
            files.push((name, read(&path)?));
        }
    }
    Ok(files)
}

/// Regular files in a folder and below, without links and what is hidden.
fn below(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) {
    let inside = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in inside {
        let (path, kind) = (entry.path(), entry.file_type());
        let is_hidden = super::name_of(&path).starts_with('.');
        match kind {
            Ok(kind) if kind.is_dir() && depth > 0 && !is_hidden => below(&path, depth - 1, files),
            Ok(kind) if kind.is_file() && files.len() <= MOST_FILES => files.push(path),
            _ => {}
        }
    }
}

/// Whether the archive's assignment is this one.
fn read_back(archive: &Path, assignment: &Assignment) -> Result<(), Failure> {
    let place = tempfile::tempdir()?;
    unpack(archive, place.path(), Bounds::CLASS)?;
    let inner = place.path().join("assignment").join(ASSIGNMENT);
    let read = Assignment::read(&output::shown(&inner));
    match read {
        Ok(read) if read.criteria == assignment.criteria && read.runs() == assignment.runs() => {
            Ok(())
        }
        Ok(_) => Err(Failure::Input(
            "the archive holds another assignment".into(),
        )),
        Err(error) => Err(Failure::Input(format!(
            "what the assignment names must be in its folder: {error}"
        ))),
    }
}
