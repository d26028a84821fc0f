//! The sketch of the lab, compiled again whenever it is saved. A thread looks at its files and compiles; the lab asks for
//! what it has made.
//!
//! The files are read and compared, not their times or the system's notices: an editor may write in place, or a new file
//! that it renames, and a file saved without a change changes nothing.

use crate::in_hand::attach;
use crate::sketch;
use rumbo_lab::{Made, Sketches, problem};
use rumbo_log::Complaint;
use rumbo_session::{GivenProgram, TargetError};
use rumbo_sim::boards::Board;
use rumbo_sketch::{
    Compiler, Diagnostic, EXAMPLE, Given, SketchError, Source, example, examples, given,
};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

/// The files are looked at this often. What has changed is compiled when it is the same twice: whole, that is.
const LOOK: Duration = Duration::from_millis(150);
/// Errors shown: the first ones matter.
const MOST: usize = 12;

/// One program that was dropped is compiled at a time: the session goes on meanwhile, and needs the processor.
static TURN: Mutex<()> = Mutex::new(());

/// A program that is watched.
pub(crate) struct Workshop {
    made: Receiver<Made>,
    /// Lives as long as the workshop.
    _wanted: Arc<()>,
}

/// A program as it stands in its files.
#[derive(Clone, PartialEq)]
enum Contents {
    Sketch(Source),
    Image(PathBuf, Option<(u64, SystemTime)>),
}

impl Workshop {
    /// Watches a sketch or an image as it is now; ends when it is dropped.
    pub(crate) fn watch(path: &Path, board: &'static Board) -> std::io::Result<Self> {
        let path = path.to_owned();
        // Now, and not when the thread comes to it: what is saved from here on is a change.
        let built = contents(&path);
        let (sender, made) = channel();
        std::thread::Builder::new()
            .name("workshop".into())
            .spawn(move || work(&path, board, built, &sender))?;
        Ok(Self {
            made,
            _wanted: Arc::default(),
        })
    }

    /// Makes something once, when nothing else is being made.
    fn once(make: impl FnOnce() -> Made + Send + 'static) -> std::io::Result<Self> {
        let (sender, made) = channel();
        let wanted = Arc::new(());
        let still = Arc::downgrade(&wanted);
        std::thread::Builder::new()
            .name("workshop".into())
            .spawn(move || {
                let _ = sender.send(Made::Begun);
                let turn = TURN.lock();
                // The next one may have been dropped meanwhile.
                if still.strong_count() > 0 {
                    let _ = sender.send(make());
                }
                drop(turn);
            })?;
        Ok(Self {
            made,
            _wanted: wanted,
        })
    }
}

impl rumbo_lab::Workshop for Workshop {
    fn next(&mut self) -> Option<Made> {
        self.made.try_recv().ok()
    }
}

/// What the lab knows of sketches.
pub(crate) const SKETCHES: Sketches = Sketches {
    make: make_given,
    examples: || examples().into_iter().map(|(name, _)| name).collect(),
    example: |name| Some(example(name).ok()?.files.into_iter().collect()),
};

/// The files of a user's sketch as they are now; none of an image.
pub(crate) fn files(name: &str) -> Vec<(String, Vec<u8>)> {
    let source = match name.strip_prefix(EXAMPLE) {
        Some(name) => example(name).ok(),
        None => match given(Path::new(name), true) {
            Ok(Given::Sketch(source)) => Some(source),
            _ => None,
        },
    };
    source.map_or_else(Vec::new, |source| source.files.into_iter().collect())
}

/// Compiles a sketch of somebody else's once, in the sandbox, or keeps an image; by the names of its files.
fn make_given(
    board: &'static Board,
    program: GivenProgram,
) -> Result<Box<dyn rumbo_lab::Workshop>, TargetError> {
    match Workshop::once(move || given_by_page(board, program)) {
        Ok(workshop) => Ok(Box::new(workshop)),
        Err(error) => Err(TargetError::Setup(error.to_string())),
    }
}

/// Looks and compiles until nobody listens.
fn work(path: &Path, board: &Board, mut built: Option<Contents>, sender: &Sender<Made>) {
    let mut compiler = None;
    let mut before = None;
    loop {
        std::thread::sleep(LOOK);
        // Gone for a moment while an editor renames.
        let now = contents(path);
        let whole = now.is_some() && now == before;
        before.clone_from(&now);
        let Some(changed) = now.filter(|_| whole && built != before) else {
            // An empty message would wake nobody; the lab's end is noticed at the next change.
            continue;
        };
        built.clone_from(&before);
        let made = |made| sender.send(made).is_ok();
        if !made(Made::Begun) || !made(make(&changed, board, &mut compiler)) {
            return;
        }
    }
}

fn contents(path: &Path) -> Option<Contents> {
    match given(path, true).ok()? {
        Given::Sketch(source) => Some(Contents::Sketch(source)),
        Given::Image(path) => {
            let about = std::fs::metadata(&path).ok();
            let about = about.and_then(|about| Some((about.len(), about.modified().ok()?)));
            Some(Contents::Image(path, about))
        }
    }
}

fn make(contents: &Contents, board: &Board, compiler: &mut Option<Compiler>) -> Made {
    let source = match contents {
        Contents::Sketch(source) => source,
        Contents::Image(path, _) => return Made::Image(path.clone()),
    };
    let mut compile = || {
        let compiler = match compiler {
            Some(compiler) => compiler,
            None => compiler.insert(sketch::compiler(board)?),
        };
        compiler.compile(source, &[])
    };
    match compile() {
        Ok(image) => Made::Image(image.path),
        Err(error) => rejected(error, source),
    }
}

fn given_by_page(board: &Board, program: GivenProgram) -> Made {
    let kind = |name: &str| {
        let kind = Path::new(name).extension().and_then(|kind| kind.to_str());
        kind.filter(|kind| matches!(*kind, "elf" | "hex"))
            .map(str::to_owned)
    };
    let made = match &program.files[..] {
        [(name, content)] if kind(name).is_some() => {
            sketch::keep_image(content, &kind(name).unwrap_or_default()).map(Made::Image)
        }
        _ => {
            let stem = Path::new(&program.name).file_stem().unwrap_or_default();
            let source = Source {
                name: stem.to_string_lossy().into_owned(),
                files: program.files.into_iter().collect(),
            };
            let compiled = sketch::walled_compiler(board, program.debug);
            match compiled.and_then(|compiler| compiler.compile(&source, &[])) {
                Err(error) => Ok(rejected(error, &source)),
                Ok(image) if program.debug => in_hand(image.path, &source),
                Ok(image) => Ok(Made::Image(image.path)),
            }
        }
    };
    made.unwrap_or_else(|error: std::io::Error| Made::Rejected(vec![problem(error.to_string())]))
}

/// An image with its debugger.
fn in_hand(image: PathBuf, source: &Source) -> std::io::Result<Made> {
    let files: Vec<String> = source.files.keys().cloned().collect();
    Ok(match attach(&std::fs::read(&image)?, &files) {
        Ok(attach) => Made::Debugged(image, attach),
        Err(error) => Made::Rejected(vec![problem(error.to_string())]),
    })
}

fn rejected(error: SketchError, source: &Source) -> Made {
    match error {
        SketchError::Rejected(errors) => {
            let errors = errors.iter().take(MOST);
            Made::Rejected(errors.map(|error| complaint(error, source)).collect())
        }
        // Which file that is, and in whose folder, no page says.
        SketchError::File { reason, .. } => Made::Rejected(vec![problem(format!(
            "a file of the compilation cannot be read or written: {reason}"
        ))]),
        error => Made::Rejected(vec![problem(error.to_string())]),
    }
}

/// An error with the line that it is about.
fn complaint(error: &Diagnostic, source: &Source) -> Complaint {
    let numbers = [error.line, error.column].into_iter().flatten();
    let place = error.file.as_ref().map(|file| {
        let numbers = numbers.map(|number| format!(":{number}"));
        file.clone() + &numbers.collect::<String>()
    });
    let line = error
        .file
        .as_ref()
        .zip(error.line)
        .and_then(|(file, line)| {
            let text = String::from_utf8_lossy(source.files.get(file)?);
            let line = text.lines().nth(line.checked_sub(1)? as usize)?;
            let shown = line.chars().filter(|c| !c.is_control() || *c == '\t');
            Some(shown.take(200).collect())
        });
    Complaint {
        place,
        text: error.text.clone(),
        line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_sketch::Severity;

    #[test]
    fn an_error_comes_with_the_line_that_it_is_about() {
        let source = Source {
            name: "wall".into(),
            files: [("wall.ino".into(), b"void setup() {}\nint x = 1\n".to_vec())].into(),
        };
        let error = |file: &str, line: u32| Diagnostic {
            severity: Severity::Error,
            file: Some(file.into()),
            line: Some(line),
            column: Some(10),
            text: "expected ';'".into(),
            notes: Vec::new(),
        };
        let seen = complaint(&error("wall.ino", 2), &source);
        assert_eq!(seen.place.as_deref(), Some("wall.ino:2:10"));
        assert_eq!(seen.line.as_deref(), Some("int x = 1"));
        assert_eq!(complaint(&error("Servo.h", 2), &source).line, None);
        assert_eq!(complaint(&error("wall.ino", 9), &source).line, None);
    }

    #[test]
    fn programs_are_made_one_at_a_time_and_those_replaced_meanwhile_not_at_all() {
        static AT_WORK: Mutex<()> = Mutex::new(());
        let make = |name: &'static str| {
            Workshop::once(move || {
                let alone = AT_WORK.try_lock();
                std::thread::sleep(Duration::from_millis(1));
                match alone {
                    Ok(_) => Made::Image(name.into()),
                    Err(_) => Made::Rejected(Vec::new()),
                }
            })
            .unwrap()
        };
        let turn = TURN.lock().unwrap();
        let replaced = Workshop::once(|| panic!("nobody wants it")).unwrap();
        assert!(matches!(replaced.made.recv(), Ok(Made::Begun)));
        drop(replaced);
        let thirty: Vec<_> = (0..30).map(|_| make("a.elf")).collect();
        for one in &thirty {
            assert!(matches!(one.made.recv(), Ok(Made::Begun)));
            assert!(one.made.try_recv().is_err());
        }
        drop(turn);
        for one in &thirty {
            assert!(matches!(one.made.recv(), Ok(Made::Image(_))));
        }
        assert!(TURN.lock().is_ok(), "the replaced one was made");
    }

    #[test]
    fn a_file_that_is_written_by_a_rename_is_seen_and_one_saved_unchanged_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let image = folder.path().join("a.elf");
        std::fs::write(&image, "one").unwrap();
        let workshop = Workshop::watch(&image, <&Board>::default()).unwrap();
        let next = || workshop.made.recv_timeout(Duration::from_secs(30)).unwrap();
        let beside = folder.path().join("a.elf~");
        std::fs::write(&beside, "another").unwrap();
        std::fs::rename(&beside, &image).unwrap();
        assert!(matches!(next(), Made::Begun));
        assert!(matches!(next(), Made::Image(path) if path == image));

        let sketch = folder.path().join("b.ino");
        std::fs::write(&sketch, "x").unwrap();
        let before = contents(&sketch);
        std::fs::write(&sketch, "x").unwrap();
        assert!(contents(&sketch) == before);
        std::fs::write(&sketch, "y").unwrap();
        assert!(contents(&sketch) != before);
    }
}
