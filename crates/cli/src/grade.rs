//! `rumbo grade`: each hand-in compiled in the sandbox, driven with every seed, and marked.
//!
//! The output does not depend on time, path or number of threads: the same hand-in gets the same bytes.

mod autograder;
mod exports;
mod gradescope;
mod hand_ins;
mod likeness;

use crate::args::GradeArgs;
use crate::experiments::language;
use crate::failure::Failure;
use crate::interrupt;
use crate::mark;
use crate::output;
use crate::place::{self, Guard};
use crate::run::set_threads;
use indicatif::{ProgressBar, ProgressStyle};
use likeness::Likeness;
use rumbo_experiment::grade::{Assignment, Mark, grade as grade_all};
use rumbo_experiment::note::Note;
use rumbo_report::FileStamp;
use rumbo_report::grade::{class, student};
use rumbo_report::text::Language;
use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{Compiler, SketchError, Toolchain};
use std::collections::BTreeSet;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// What is written: the class page, the tables, and in folders the students' pages and Gradescope's files.
const PAGE: &str = "index.html";
const TABLE: &str = "marks.csv";
const SUITES: &str = "junit.xml";
const STUDENTS: (&str, &str) = ("students", "html");
const GRADESCOPE: (&str, &str) = ("gradescope", "json");
const SIMILAR: (&str, &str) = ("similar", "html");
/// Most names said of what is no hand-in.
const MOST_NAMED: usize = 20;

/// Compiles, drives, marks, writes, and prints a line for each hand-in; or is Gradescope's autograder, or writes it.
pub(crate) fn grade(args: &GradeArgs) -> Result<(), Failure> {
    match (&args.gradescope, &args.autograder, &args.folder) {
        (Some(archive), _, _) => autograder::pack(args, archive),
        (_, Some(place), _) => autograder::run(args, place),
        (_, _, Some(folder)) => grade_class(args, folder),
        (None, None, None) => Err(Failure::Input("give the folder with the hand-ins".into())),
    }
}

fn grade_class(args: &GradeArgs, folder: &Path) -> Result<(), Failure> {
    let assignment = Assignment::read(&output::shown(&args.assignment))?;
    let stamp = check_places(args, &assignment)?;
    set_threads(args.threads)?;
    let hand_ins::Class { found, others, .. } = &hand_ins::find(folder)?;
    let files = file_names(found.iter().map(hand_ins::Found::name));
    check_files(args, &assignment, &stamp, &files)?;
    note_others(others);
    let sketches = found.iter().filter(|one| one.is_sketch()).count();
    // Images need no compiler.
    let compiler = match sketches {
        0 => None,
        _ => Some(compiler(&assignment, |toolchain, limits| {
            match args.trust {
                true => Ok(Sandbox::trusting(limits)),
                false => Sandbox::walled(toolchain, limits),
            }
        })?),
    };
    let notes = class_notes(&assignment, compiler.as_ref());
    let asked = interrupt::asked();
    let goes_on = |progress: &ProgressBar| {
        progress.inc(1);
        !asked.load(Ordering::Relaxed)
    };
    let progress = progress_bar(sketches, "{bar:40} {pos}/{len} compiled, {eta} left");
    let hand_ins = hand_ins::compile(found, compiler.as_ref(), || goes_on(&progress));
    let hand_ins = finish(hand_ins, &progress, "sketch")?;
    let runs = assignment.runs() * hand_ins.iter().filter(|one| one.program.is_ok()).count();
    if !std::io::stderr().is_terminal() {
        let count = hand_ins.len();
        output::aside(&format!("hand-ins: {count}, runs: {runs}"));
    }
    let progress = progress_bar(runs, "{bar:40} {pos}/{len} runs, {eta} left");
    let marks = grade_all(&assignment, &hand_ins, || goes_on(&progress));
    let marks = finish(marks, &progress, "run")?;
    let likeness = Likeness::among(found, &assignment)?;
    write(
        args,
        &assignment,
        (&marks, &files),
        &notes,
        &likeness,
        &stamp,
    )?;
    for line in likeness.in_words(Language::English) {
        output::note(&format!(
            "alike: {line}; see {}",
            output::shown(&args.out.join(SIMILAR.0))
        ));
    }
    report(args, &marks, &notes)
}

/// Names what lies among the hand-ins and is none.
fn note_others(others: &[String]) {
    if others.is_empty() {
        return;
    }
    let more = match others.len().saturating_sub(MOST_NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    output::note(&format!(
        "not graded: {}{more}; a hand-in is a folder with a sketch, an .ino, an .elf, a .hex, or a .zip of these; it is no link, and its name begins with no full stop",
        others[..others.len().min(MOST_NAMED)].join(", ")
    ));
}

/// What was done, all of it; says how much, where it was interrupted.
fn finish<T>(done: Option<T>, progress: &ProgressBar, what: &str) -> Result<T, Failure> {
    let (count, all) = (progress.position(), progress.length().unwrap_or_default());
    progress.finish_and_clear();
    done.ok_or_else(|| {
        let all = output::counted(all as usize, what);
        output::note(&format!(
            "interrupted after {count} of {all}; nobody is marked, and what was there stays"
        ));
        Failure::Interrupted
    })
}

/// The compiler, in a sandbox.
fn compiler(
    assignment: &Assignment,
    sandbox: impl FnOnce(&Toolchain, Limits) -> Result<Sandbox, SketchError>,
) -> Result<Compiler, SketchError> {
    let robot = assignment.tests.first().map(|test| &test.setup.robot);
    let board = robot.map(|robot| robot.board).unwrap_or_default();
    let toolchain = Toolchain::find()?;
    let limits = Limits {
        time: Duration::from_secs_f64(assignment.compile_s),
        ..Limits::default()
    };
    let sandbox = sandbox(&toolchain, limits)?;
    let cache = rumbo_sketch::cache();
    Compiler::new(crate::sketch::target(board), toolchain, sandbox, cache)
}

/// Deviations from the assignment's compiler and core.
fn class_notes(assignment: &Assignment, compiler: Option<&Compiler>) -> Vec<Note> {
    let Some(toolchain) = compiler.map(Compiler::toolchain) else {
        return Vec::new();
    };
    let differs = |what, wanted: &Option<String>, is: &String| {
        let (wanted, is) = (wanted.clone().filter(|wanted| wanted != is)?, is.clone());
        Some(Note::OtherCompiler { what, is, wanted })
    };
    [
        differs("avr-gcc", &assignment.compiler, &toolchain.compiler),
        differs("Arduino core", &assignment.core, &toolchain.core_version),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Refuses, before anything runs, to write among files that are not its own.
fn check_places(args: &GradeArgs, assignment: &Assignment) -> Result<FileStamp, Failure> {
    let stamp = FileStamp::of("grade", std::slice::from_ref(&assignment.name));
    let guard = Guard::new([args.assignment.clone()], args.overwrite.force);
    let page = args.out.join(PAGE);
    guard.check(&page, &mark::Mark::of(&stamp))?;
    let is_filled = std::fs::read_dir(&args.out).is_ok_and(|mut inside| inside.next().is_some());
    if is_filled && !page.is_file() && !args.overwrite.force {
        let out = args.out.display();
        return Err(Failure::Input(format!(
            "{out}: other files are there; choose another folder with --out, or write among them with --force"
        )));
    }
    place::try_folder(&args.out)?;
    Ok(stamp)
}

/// Refuses, before anything runs, to write over files that are not its own.
fn check_files(
    args: &GradeArgs,
    assignment: &Assignment,
    stamp: &FileStamp,
    files: &[String],
) -> Result<(), Failure> {
    let guard = Guard::new([args.assignment.clone()], args.overwrite.force);
    let table = mark::Mark::table(&exports::csv(assignment, &[]));
    guard.check(&args.out.join(TABLE), &table)?;
    let stamped = mark::Mark::of(stamp);
    guard.check(&args.out.join(SUITES), &stamped)?;
    for (folder, ending) in [STUDENTS, GRADESCOPE] {
        for file in files {
            let path = args.out.join(folder).join(format!("{file}.{ending}"));
            guard.check(&path, &stamped)?;
        }
    }
    Ok(())
}

/// On stderr, and only where that is a terminal.
fn progress_bar(count: usize, template: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(template);
    ProgressBar::new(count as u64)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn write(
    args: &GradeArgs,
    assignment: &Assignment,
    (marks, files): (&[Mark], &[String]),
    notes: &[Note],
    likeness: &Likeness,
    stamp: &FileStamp,
) -> Result<(), Failure> {
    let language = language(args.language);
    let out = |name: &str| args.out.join(name);
    for (folder, ending) in [STUDENTS, GRADESCOPE, SIMILAR] {
        let folder = out(folder);
        remove_own(&folder, ending, &mark::Mark::of(stamp))?;
        place::folder(&folder)?;
    }
    let inner = |(folder, ending): (&str, &str), file: &str| format!("{folder}/{file}.{ending}");
    for (mark, file) in marks.iter().zip(files) {
        let page = student(assignment, mark, notes, language);
        place::write(&out(&inner(STUDENTS, file)), stamp.put_on(page))?;
        let json = gradescope::results(assignment, mark, notes, language, stamp)?;
        place::write(&out(&inner(GRADESCOPE, file)), json)?;
    }
    let links: Vec<String> = files.iter().map(|file| inner(STUDENTS, file)).collect();
    let mut alike = Vec::new();
    for (number, (words, page)) in (1..).zip(likeness.pages(assignment, language)) {
        let link = inner(SIMILAR, &format!("pair{number}"));
        place::write(&out(&link), stamp.put_on(page))?;
        alike.push((words, link));
    }
    let page = class(assignment, marks, notes, language, &links, &alike);
    place::write(&out(TABLE), exports::csv(assignment, marks))?;
    place::write(&out(SUITES), exports::junit(assignment, marks, stamp))?;
    place::write(&out(PAGE), stamp.put_on(page))
}

/// Removes the pages of an earlier time, some of hand-ins that are gone: what carries the mark, and nothing else.
fn remove_own(folder: &Path, ending: &str, mark: &mark::Mark) -> Result<(), Failure> {
    let Ok(inside) = std::fs::read_dir(folder) else {
        return Ok(());
    };
    for path in inside.flatten().map(|entry| entry.path()) {
        let is_file = path.symlink_metadata().is_ok_and(|about| about.is_file());
        if is_file && path.extension().is_some_and(|own| own == ending) && mark.is_on(&path) {
            std::fs::remove_file(&path).map_err(|error| place::unwritable(&path, &error))?;
        }
    }
    Ok(())
}

/// A file name for each hand-in: its name, restricted to letters and digits of any script; where another one has that, whatever
/// its capitals, with the first number that makes it another.
fn file_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let is_plain = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    let mut taken = BTreeSet::new();
    names
        .map(|name| {
            let name = name.chars().take(80);
            let name: String = name.map(|c| if is_plain(c) { c } else { '_' }).collect();
            let numbered = (1..).map(|number| format!("{name}-{number}"));
            std::iter::once(name.clone())
                .chain(numbered)
                .find(|free| taken.insert(free.to_lowercase()))
                .unwrap_or(name)
        })
        .collect()
}

fn report(args: &GradeArgs, marks: &[Mark], notes: &[Note]) -> Result<(), Failure> {
    let rows: Vec<Vec<String>> = marks
        .iter()
        .map(|mark| {
            let mut row = vec![
                mark.name.clone(),
                format!("{:.2} / {}", mark.points, output::figure(mark.of)),
                if mark.pass { "ok" } else { "MISSED" }.to_owned(),
            ];
            row.extend(mark.why_not());
            row
        })
        .collect();
    output::table(&rows)?;
    notes
        .iter()
        .for_each(|note| output::note(&note.to_string()));
    output::line(&output::shown(&args.out.join(PAGE)))?;
    match marks.iter().all(|mark| mark.pass) {
        true => Ok(()),
        false => Err(Failure::LimitMissed),
    }
}

/// The name of a file or folder, as text.
fn name_of(path: &Path) -> String {
    path.file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default()
}
