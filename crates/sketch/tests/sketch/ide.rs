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
    /// `compiles`, or `FILE:LINE` of the first error, or `refused` where the linker says so. Behind it ours, where we
    /// take what the IDE refuses: its parser of functions misses some, and it spells headers by their capitals.
    verdict: String,
    here: Option<String>,
    /// Those in `lib:` are of libraries.
    files: Vec<(String, String)>,
}

/// Compiled in the gate: one for each kind of difference that there was.
const ALWAYS: [&str; 5] = [
    "prototype_in_either_branch",
    "macro_made_function_before_its_definition",
    "library_of_another_chip",
    "library_in_a_dead_branch",
    "library_by_a_macro",
];
/// What each `library.properties` must say too.
const ABOUT: &str = "author=A\nmaintainer=A\nsentence=S\nparagraph=P\nurl=U\ncategory=Other\n";
/// Files of a library.
const LIBRARY: &str = "lib:";

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
            verdict: verdict
                .split_whitespace()
                .next()
                .unwrap_or_default()
                .to_owned(),
            here: verdict
                .split_once(" here ")
                .map(|(_, here)| here.trim().to_owned()),
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
            let mut text = text.clone();
            if name.ends_with("library.properties") {
                text += ABOUT;
            }
            std::fs::write(path, self.bytes(&text)).unwrap();
        }
    }

    fn ours(&self, compiler: &Compiler) -> String {
        let own = self
            .files
            .iter()
            .filter(|(name, _)| !name.starts_with(LIBRARY));
        let files: BTreeMap<String, Vec<u8>> = own
            .map(|(name, text)| (name.clone(), self.bytes(text)))
            .collect();
        let source = Source {
            name: self.name().into(),
            files,
        };
        match compiler.compile(&source, &[]) {
            Ok(_) => "compiles".into(),
            Err(SketchError::Rejected(errors)) => {
                let first = errors.iter().find_map(|error| {
                    error.column?;
                    Some(format!("{}:{}", base(error.file.as_ref()?), error.line?))
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
            "mega" => "mega:cpu=atmega2560",
            other => other,
        };
        let mut judge = Command::new("arduino-builder");
        judge.args([
            "-compile",
            "-tools",
            "/usr/bin",
            "-core-api-version",
            "10819",
            "-warnings",
            "none",
        ]);
        for hardware in ["/usr/share/arduino/hardware", "/usr/share/arduino-builder"] {
            judge.args(["-hardware", hardware]);
        }
        judge.args([
            "-built-in-libraries",
            "/usr/share/arduino/hardware/arduino/avr/libraries",
        ]);
        // Debian's compiler needs it for Debian's core, as ours does.
        judge.args([
            "-prefs",
            "compiler.cpp.extra_flags=-DDECIMAL_DIG=__DECIMAL_DIG__",
        ]);
        judge
            .arg("-libraries")
            .arg(&libraries)
            .arg("-build-path")
            .arg(&build)
            .arg("-build-cache")
            .arg(cache);
        judge.args(["-fqbn", &format!("arduino:avr:{board}")]);
        let main = self
            .files
            .iter()
            .find(|(name, _)| name.starts_with(self.name()))
            .unwrap();
        let done = judge
            .arg(folder.path().join(self.name()).join(&main.0))
            .output()
            .unwrap();
        if done.status.success() {
            return "compiles".into();
        }
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        let first = said.lines().find_map(|line| {
            let (place, _) = line
                .split_once(" error: ")
                .or_else(|| line.split_once(" Error: "))?;
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

/// The files of the folder, and their text.
fn texts() -> impl Iterator<Item = (PathBuf, String)> {
    let files = [
        "prototypes.txt",
        "files.txt",
        "language.txt",
        "libraries.txt",
    ];
    files.into_iter().map(|file| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/sketch/ide")
            .join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        (path, text)
    })
}

#[test]
fn verdicts_are_those_of_the_arduino_ide() {
    let full = std::env::var_os("RUMBO_FULL").is_some();
    let cache = tempfile::tempdir().unwrap();
    let mut wrong = String::new();
    for case in texts().flat_map(|(_, text)| cases(&text)) {
        if !full && !ALWAYS.contains(&case.name()) {
            continue;
        }
        let Ok(toolchain) = Toolchain::find() else {
            assert!(std::env::var_os("CI").is_none(), "no avr-gcc");
            return;
        };
        let folder = tempfile::tempdir().unwrap();
        case.write(folder.path());
        let toolchain = toolchain.with_libraries(&[folder.path().join("libraries")]);
        let sandbox = Sandbox::trusting(Limits::default());
        let compiler = Compiler::new(case.board(), toolchain, sandbox, cache.path().to_owned());
        let ours = case.ours(&compiler.unwrap());
        let verdict = case.here.as_ref().unwrap_or(&case.verdict);
        if ours != *verdict {
            writeln!(wrong, "{}: {ours}, expected {verdict}", case.name()).unwrap();
        }
    }
    assert_eq!(wrong, "");
}

/// The recorded verdicts are arduino-builder's.
#[test]
fn the_arduino_ide_s_verdicts_are_recorded() {
    let bless = std::env::var_os("RUMBO_BLESS").is_some();
    let full = std::env::var_os("RUMBO_FULL").is_some();
    if !(bless || full) || !Path::new("/usr/bin/arduino-builder").is_file() {
        return;
    }
    let cache = tempfile::tempdir().unwrap();
    let (mut wrong, mut now) = (String::new(), String::new());
    for (path, text) in texts() {
        now.clear();
        for case in cases(&text) {
            let verdict = case.judged(cache.path());
            if verdict != case.verdict {
                writeln!(
                    wrong,
                    "{}: {verdict}, recorded {}",
                    case.name(),
                    case.verdict
                )
                .unwrap();
            }
            let here = case.here.iter().map(|here| format!(" here {here}"));
            writeln!(
                now,
                "=== {}: {verdict}{}",
                case.words.join(" "),
                here.collect::<String>()
            )
            .unwrap();
            for (name, text) in &case.files {
                write!(now, "--- {name}\n{text}").unwrap();
            }
        }
        if bless {
            std::fs::write(&path, &now).unwrap();
        }
    }
    assert!(bless || wrong.is_empty(), "{wrong}");
}
