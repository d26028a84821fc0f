//! Sketches of every odd kind compile, or are refused at a place, as with the Arduino IDE.
//!
//! The files beside hold them, each with its verdict: that of `arduino-builder`, which the full check asks again where it
//! is installed (`apt install arduino-builder`). `RUMBO_BLESS=1` writes down what it says.

use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{BOARDS, Board, Compiler, SketchError, Source, Toolchain};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One sketch.
struct Case {
    /// Its name, and words: the board, how its files are written.
    words: Vec<String>,
    /// `compiles`, or `FILE:LINE` of the first error, or `refused` where the linker says so.
    verdict: String,
    /// Those in `lib:` are of libraries.
    files: Vec<(String, String)>,
}

/// Compiled in the gate: one for each kind of difference that there was.
const ALWAYS: [&str; 1] = ["prototype_in_either_branch"];
/// Files of a library.
const LIBRARY: &str = "lib:";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sketch/ide")
}

fn cases(text: &str) -> Vec<Case> {
    let cases = text.split("=== ").skip(1);
    let case = |text: &str| {
        let mut parts = text.split("--- ");
        let head = parts.next().unwrap();
        let (words, verdict) = head.split_once(':').unwrap_or((head, ""));
        let file = |part: &str| {
            let (name, text) = part.split_once('\n').unwrap();
            (name.to_owned(), text.to_owned())
        };
        Case {
            words: words.split_whitespace().map(str::to_owned).collect(),
            verdict: verdict.trim().to_owned(),
            files: parts.map(file).collect(),
        }
    };
    cases.map(case).collect()
}

impl Case {
    fn name(&self) -> &str {
        &self.words[0]
    }

    fn board(&self) -> Board {
        let named = self.words.iter().find_map(|word| Board::named(word));
        named.unwrap_or(BOARDS[1])
    }

    fn bytes(&self, text: &str) -> Vec<u8> {
        let has = |word: &str| self.words.iter().any(|own| own == word);
        let text = match has("crlf") {
            true => text.replace('\n', "\r\n"),
            false => text.to_owned(),
        };
        let mark = if has("bom") { "\u{feff}" } else { "" };
        format!("{mark}{text}").into_bytes()
    }

    /// Writes its files: the sketch in a folder of its name, its libraries beside.
    fn write(&self, to: &Path) {
        for (name, text) in &self.files {
            let path = match name.strip_prefix(LIBRARY) {
                Some(name) => to.join("libraries").join(name),
                None => to.join(self.name()).join(name),
            };
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, self.bytes(text)).unwrap();
        }
    }

    fn ours(&self, compiler: &Compiler) -> String {
        let own = self.files.iter().filter(|(name, _)| !name.starts_with(LIBRARY));
        let files: BTreeMap<String, Vec<u8>> = own.map(|(name, text)| (name.clone(), self.bytes(text))).collect();
        let source = Source { name: self.name().into(), files };
        match compiler.compile(&source, &[]) {
            Ok(_) => "compiles".into(),
            Err(SketchError::Rejected(errors)) => {
                let first = errors.iter().find_map(|error| {
                    let file = error.file.as_ref().filter(|_| !error.text.starts_with('`'))?;
                    Some(format!("{}:{}", base(file), error.line?))
                });
                first.unwrap_or_else(|| "refused".into())
            }
            Err(other) => format!("{other:?}"),
        }
    }

    /// What arduino-builder says of it.
    fn judged(&self, cache: &Path) -> String {
        let folder = tempfile::tempdir().unwrap();
        self.write(folder.path());
        let build = folder.path().join("build");
        let libraries = folder.path().join("libraries");
        for new in [&build, &libraries, &cache.to_owned()] {
            std::fs::create_dir_all(new).unwrap();
        }
        let board = match self.board().name {
            "nano" => "nano:cpu=atmega328",
            other => other,
        };
        let mut judge = Command::new("arduino-builder");
        judge.args(["-compile", "-tools", "/usr/bin", "-core-api-version", "10819", "-warnings", "none"]);
        for hardware in ["/usr/share/arduino/hardware", "/usr/share/arduino-builder"] {
            judge.args(["-hardware", hardware]);
        }
        judge.args(["-built-in-libraries", "/usr/share/arduino/hardware/arduino/avr/libraries"]);
        // Debian's compiler needs it for Debian's core, as ours does.
        judge.args(["-prefs", "compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__"]);
        judge.arg("-libraries").arg(&libraries).arg("-build-path").arg(&build).arg("-build-cache").arg(cache);
        judge.args(["-fqbn", &format!("arduino:avr:{board}")]);
        let done = judge.arg(folder.path().join(self.name())).output().unwrap();
        if done.status.success() {
            return "compiles".into();
        }
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        if std::env::var_os("SAY").is_some() {
            eprintln!("{}: {said}", self.name());
        }
        let first = said.lines().find_map(|line| {
            let (place, _) = line.split_once(" error: ").or_else(|| line.split_once(" Error: "))?;
            let mut parts = place.trim_end_matches(':').split(':');
            let (file, line) = (parts.next()?, parts.next()?);
            line.parse::<u32>().ok()?;
            Some(format!("{}:{line}", base(file)))
        });
        first.unwrap_or_else(|| "refused".into())
    }
}

fn base(file: &str) -> &str {
    file.rsplit('/').next().unwrap_or(file)
}

#[test]
fn verdicts_are_the_arduino_ide_s() {
    let full = std::env::var_os("RUMBO_FULL").is_some();
    let bless = std::env::var_os("RUMBO_BLESS").is_some();
    let only = std::env::var("ONLY").unwrap_or_default();
    let judged = (full || bless) && Path::new("/usr/bin/arduino-builder").is_file();
    let cache = tempfile::tempdir().unwrap();
    let mut wrong = String::new();
    for file in ["prototypes.txt", "files.txt", "language.txt", "libraries.txt"] {
        let path = folder().join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        let mut blessed = String::new();
        for case in cases(&text) {
            if !only.is_empty() && !case.name().contains(&only) { continue; }
            if !full && !bless && only.is_empty() && !ALWAYS.contains(&case.name()) {
                continue;
            }
            let libraries = tempfile::tempdir().unwrap();
            case.write(libraries.path());
            let Ok(toolchain) = Toolchain::find() else { return };
            let toolchain = toolchain.with_libraries(&[libraries.path().join("libraries")]);
            let sandbox = Sandbox::trusting(Limits::default());
            let compiler = Compiler::new(case.board(), toolchain, sandbox, cache.path().to_owned()).unwrap();
            let judge = judged.then(|| case.judged(&cache.path().join("judge")));
            let (verdict, ours) = (judge.clone().unwrap_or(case.verdict.clone()), case.ours(&compiler));
            if ours != verdict || judge.is_some_and(|judge| judge != case.verdict && !bless) {
                writeln!(wrong, "{}: {ours}, the IDE: {verdict}, recorded: {}", case.name(), case.verdict).unwrap();
            }
            writeln!(blessed, "=== {}: {verdict}", case.words.join(" ")).unwrap();
            for (name, text) in &case.files {
                write!(blessed, "--- {name}\n{text}").unwrap();
            }
        }
        if bless && only.is_empty() {
            std::fs::write(&path, blessed).unwrap();
        }
    }
    assert_eq!(wrong, "");
}
