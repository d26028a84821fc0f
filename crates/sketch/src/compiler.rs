//! Compiles core, libraries and a sketch; products are cached by the hash of all inputs.
//!
//! ```text
//! build-XXXX/sketch/   copies of the sketch's files; those to compile once more, by names of ours
//!           /main/     the joined .ino
//!           /out/      products
//! ```
//!
//! The compiler takes names that begin with `-` or `@` as orders, so that no file's name of a sketch is an argument:
//! `src/pid.cpp` is compiled as `src/rumbo~3.cpp`, in its folder for what it includes, and begins with
//! `#line 1 "src/pid.cpp"` for messages.

use crate::board::Board;
use crate::diagnostics::{Diagnostic, Severity, parse};
use crate::error::SketchError;
use crate::limits::Limits;
use crate::preprocess;
use crate::product;
use crate::sandbox::{Sandbox, Task};
use crate::source::{Source, ending};
use crate::toolchain::Toolchain;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Options of every call besides the board's: the clock and the version macros for the sketch.
const COMMON: [&str; 4] = [
    "-DF_CPU=16000000L",
    "-DARDUINO=10819",
    "-DARDUINO_ARCH_AVR",
    "-Os",
];
/// For C, C++ and assembler.
const OBJECT: [&str; 5] = [
    "-c",
    "-g",
    "-flto",
    "-ffunction-sections",
    "-fdata-sections",
];
const C: [&str; 2] = ["-std=gnu11", "-fno-fat-lto-objects"];
/// Debian's compiler knows `DECIMAL_DIG` in C only; the core's strings want it.
const CPP: [&str; 6] = [
    "-DDECIMAL_DIG=__DECIMAL_DIG__",
    "-std=gnu++11",
    "-fpermissive",
    "-fno-exceptions",
    "-fno-threadsafe-statics",
    "-Wno-error=narrowing",
];
const LINK: [&str; 5] = [
    "-w",
    "-g",
    "-flto",
    "-fuse-linker-plugin",
    "-Wl,--gc-sections",
];
/// Folders of a build; the compiler runs in the first.
const SKETCH: &str = "sketch";
const MAIN: &str = "main";
const OUT: &str = "out";
/// The linker's product.
const IMAGE: &str = "sketch.elf";
/// Part of every key: products of another layout are another's.
const LAYOUT: &str = "own names";
/// Most headers that a sketch may include by different names.
const MOST_HEADERS: usize = 1_000;
/// Most complaints kept of a compilation.
const MOST_COMPLAINTS: usize = 200;

/// Compiles sketches.
#[derive(Clone, Debug)]
pub struct Compiler {
    board: Board,
    toolchain: Toolchain,
    sandbox: Sandbox,
    cache: PathBuf,
    /// The core as an archive, from which the linker takes what is used.
    core: PathBuf,
}

/// A compiled sketch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// The ELF file, in the cache.
    pub path: PathBuf,
    /// It was cached.
    pub fresh: bool,
    /// The compiler's warnings; none if it did not run.
    pub warnings: Vec<Diagnostic>,
}

impl Compiler {
    /// With the folder where products are kept. Compiles the core if need be.
    ///
    /// # Errors
    /// If the folder cannot be written, or the core does not compile.
    pub fn new(
        board: Board,
        toolchain: Toolchain,
        sandbox: Sandbox,
        cache: PathBuf,
    ) -> Result<Self, SketchError> {
        fs::create_dir_all(&cache).map_err(|error| SketchError::file(&cache, error))?;
        let cache = cache
            .canonicalize()
            .map_err(|error| SketchError::file(&cache, error))?;
        let mut compiler = Self {
            board,
            toolchain,
            sandbox,
            cache,
            core: PathBuf::new(),
        };
        compiler.core = compiler.build_core()?;
        Ok(compiler)
    }

    /// Compiler and core.
    #[must_use]
    pub fn toolchain(&self) -> &Toolchain {
        &self.toolchain
    }

    /// The image of a sketch, with macros such as `-DMODE=1`.
    ///
    /// # Errors
    /// If the compiler rejects it, or it exceeds a limit.
    pub fn compile(&self, source: &Source, macros: &[&str]) -> Result<Image, SketchError> {
        source.check()?;
        let main =
            preprocess::join(source).ok_or_else(|| SketchError::NoSketch(source.name.clone()))?;
        let libraries = self.libraries_of(source)?;
        let mut key = self.key(macros);
        for (name, bytes) in &source.files {
            part(&mut key, name.as_bytes());
            part(&mut key, bytes);
        }
        part(&mut key, source.name.as_bytes());
        for file in libraries.iter().flat_map(|library| &library.files) {
            part(&mut key, &read(file)?);
        }
        let image = self.cache.join(hex(key)).join(file_name(&source.name));
        if image.is_file() {
            return Ok(Image {
                path: image,
                fresh: true,
                warnings: Vec::new(),
            });
        }
        let folders = libraries.iter().map(|library| library.folder.clone());
        let mut build = Build::new(self, folders.collect())?;
        for (name, bytes) in &source.files {
            build.put(SKETCH, name, bytes)?;
        }
        let own = [macros, &["-Wall", "-Wextra", "-I", "."]].concat();
        build.put(MAIN, "main.ino.cpp", main.as_bytes())?;
        build.object(Path::new(&seen(MAIN, "main.ino.cpp")), &own);
        for (name, bytes) in &source.files {
            // As the IDE has it: files beside the sketch, and all below `src`.
            if !name.contains('/') || name.starts_with("src/") {
                build.own(name, bytes, &own)?;
            }
        }
        let quiet = [macros, &["-w"]].concat();
        for file in libraries.iter().flat_map(|library| &library.files) {
            if source_ending(file).is_some() {
                build.object(file, &quiet);
            }
        }
        build.finish()?;
        build.link()?;
        build.keep(IMAGE, &image)?;
        Ok(Image {
            path: image,
            fresh: false,
            warnings: build.complaints,
        })
    }

    fn build_core(&self) -> Result<PathBuf, SketchError> {
        let files = files_of(&self.toolchain.core.join("cores/arduino"))?;
        let mut key = self.key(&[]);
        for file in &files {
            part(&mut key, &read(file)?);
        }
        let archive = self.cache.join(format!("core-{}.a", hex(key)));
        if archive.is_file() {
            return Ok(archive);
        }
        // Trusted source: no isolation, and a generous time limit.
        let trusting = Self {
            sandbox: Sandbox::trusting(Limits::default()),
            ..self.clone()
        };
        let mut build = Build::new(&trusting, Vec::new())?;
        for file in files.iter().filter(|file| source_ending(file).is_some()) {
            build.object(file, &["-w"]);
        }
        build.finish()?;
        let mut args: Vec<OsString> = vec!["rcs".into(), seen(OUT, "core.a")];
        args.extend(build.objects.iter().map(|object| seen(OUT, object)));
        build.run(&self.toolchain.archiver(), &args, "core.a", &[])?;
        build.finish()?;
        build.keep("core.a", &archive)?;
        Ok(archive)
    }

    /// The inputs common to all products.
    fn key(&self, flags: &[&str]) -> Sha256 {
        let mut key = Sha256::new();
        let board = &self.board.options[..];
        let fixed = [board, &COMMON, &OBJECT, &C, &CPP, &LINK, flags].concat();
        for text in fixed.into_iter().chain([
            self.toolchain.compiler.as_str(),
            self.toolchain.core_version.as_str(),
            &self.toolchain.gcc.to_string_lossy(),
            &self.core.to_string_lossy(),
            LAYOUT,
        ]) {
            part(&mut key, text.as_bytes());
        }
        key
    }

    /// The libraries that a sketch includes, and those that they include.
    fn libraries_of(&self, source: &Source) -> Result<Vec<Library>, SketchError> {
        let ours = self.cache.join("libraries");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let own = source.files.values().map(|bytes| text(bytes));
        let mut headers: BTreeSet<String> = BTreeSet::new();
        for text in own {
            headers.extend(
                preprocess::includes(&text)
                    .filter(|name| !source.files.contains_key(*name))
                    .map(str::to_owned),
            );
            if headers.len() > MOST_HEADERS {
                return Err(SketchError::Refused(format!(
                    "the sketch includes more than {MOST_HEADERS} different headers"
                )));
            }
        }
        let mut next: Vec<String> = headers.iter().cloned().collect();
        let mut found: BTreeMap<PathBuf, Library> = BTreeMap::new();
        while let Some(header) = next.pop() {
            let Some(folder) = self.toolchain.library(&header, &ours)? else {
                continue;
            };
            if found.contains_key(&folder) {
                continue;
            }
            let mut files = files_of(&folder)?;
            if folder.join("utility").is_dir() {
                files.extend(files_of(&folder.join("utility"))?);
            }
            for file in &files {
                let text = text(&read(file)?);
                let more =
                    preprocess::includes(&text).filter(|name| !source.files.contains_key(*name));
                next.extend(
                    more.filter(|name| headers.insert((*name).to_owned()))
                        .map(str::to_owned),
                );
            }
            found.insert(folder.clone(), Library { folder, files });
        }
        Ok(found.into_values().collect())
    }
}

struct Library {
    folder: PathBuf,
    files: Vec<PathBuf>,
}

/// One compilation, in its own folder: the sketch beside its products.
struct Build<'a> {
    compiler: &'a Compiler,
    folder: tempfile::TempDir,
    /// Folders of the libraries that the sketch includes.
    libraries: Vec<PathBuf>,
    deadline: Instant,
    /// Their names in the folder of products.
    objects: Vec<String>,
    complaints: Vec<Diagnostic>,
    failed: Option<SketchError>,
}

impl<'a> Build<'a> {
    fn new(compiler: &'a Compiler, libraries: Vec<PathBuf>) -> Result<Self, SketchError> {
        let wrong = |error| SketchError::file(&compiler.cache, error);
        let folder = tempfile::Builder::new()
            .prefix("build-")
            .tempdir_in(&compiler.cache)
            .map_err(wrong)?;
        for inner in [SKETCH, MAIN, OUT] {
            fs::create_dir(folder.path().join(inner)).map_err(wrong)?;
        }
        Ok(Self {
            compiler,
            folder,
            libraries,
            deadline: Instant::now() + compiler.sandbox.limits().time,
            objects: Vec::new(),
            complaints: Vec::new(),
            failed: None,
        })
    }

    fn put(&self, inner: &str, name: &str, bytes: &[u8]) -> Result<(), SketchError> {
        let path = self.folder.path().join(inner).join(name);
        let write = || {
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            fs::File::create_new(&path)?.write_all(bytes)
        };
        write().map_err(|error| SketchError::file(&path, error))
    }

    /// Compiles a file of the sketch, if it is one to be compiled, by a name that no file of a sketch may have.
    fn own(&mut self, name: &str, bytes: &[u8], flags: &[&str]) -> Result<(), SketchError> {
        let path = Path::new(name);
        let Some(ending) = source_ending(path) else {
            return Ok(());
        };
        let ours = format!("rumbo~{}.{ending}", self.objects.len());
        let ours = path.with_file_name(ours).to_string_lossy().into_owned();
        let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
        let line = format!("#line 1 \"{name}\"\n");
        self.put(SKETCH, &ours, &[line.as_bytes(), text].concat())?;
        self.object(ours.as_ref(), flags);
        Ok(())
    }

    /// Compiles one file, of ours or of a library; an error does not keep the others from being compiled, so that all errors are seen.
    fn object(&mut self, file: &Path, flags: &[&str]) {
        let object = format!("{}.o", self.objects.len());
        let language: &[&str] = match ending(file) {
            Some("c") => &C,
            Some("S") => &["-x", "assembler-with-cpp"],
            _ => &CPP,
        };
        let core = &self.compiler.toolchain.core;
        let folders = [
            core.join("cores/arduino"),
            core.join("variants").join(self.compiler.board.variant),
        ];
        let board = &self.compiler.board.options[..];
        let mut args: Vec<OsString> = [board, &COMMON, &OBJECT, flags, language]
            .concat()
            .into_iter()
            .map(OsString::from)
            .collect();
        for folder in folders.iter().chain(&self.libraries) {
            args.extend(["-I".into(), OsString::from(folder)]);
        }
        args.extend([OsString::from(file), "-o".into(), seen(OUT, &object)]);
        if self.failed.is_none()
            && let Err(error) = self.run(&self.compiler.toolchain.gcc, &args, &object, &[])
        {
            self.failed = Some(error);
        }
        self.objects.push(object);
    }

    fn link(&mut self) -> Result<(), SketchError> {
        let toolchain = &self.compiler.toolchain;
        let board = &self.compiler.board.options[..];
        let options = [board, &COMMON, &LINK].concat();
        let mut args: Vec<OsString> = options.into_iter().map(OsString::from).collect();
        args.extend(["-o".into(), seen(OUT, IMAGE)]);
        args.extend(self.objects.iter().map(|object| seen(OUT, object)));
        let core = &self.compiler.core;
        args.extend([core.into(), "-lm".into()]);
        self.run(&toolchain.gcc, &args, IMAGE, &[core])?;
        self.finish()
    }

    /// Runs a tool that makes a product, and keeps its diagnostics; it sees the libraries and `more`.
    fn run(
        &mut self,
        program: &Path,
        args: &[OsString],
        makes: &str,
        more: &[&Path],
    ) -> Result<(), SketchError> {
        let product = Path::new(OUT).join(makes);
        let task = Task {
            build: self.folder.path(),
            inner: SKETCH,
            writes: Some(&product),
            reads: self
                .libraries
                .iter()
                .map(PathBuf::as_path)
                .chain(more.iter().copied()),
        };
        let done = self
            .compiler
            .sandbox
            .run(task, program, args, self.deadline)?;
        if done.status.success() {
            // What the next tool reads.
            self.product(makes)?;
        }
        let mut complaints = parse(&done.output);
        let is_error = |one: &Diagnostic| one.severity == Severity::Error;
        if !done.status.success() && !complaints.iter().any(is_error) {
            let last = done.output.lines().rfind(|line| !line.trim().is_empty());
            complaints.push(Diagnostic {
                severity: Severity::Error,
                file: None,
                line: None,
                column: None,
                text: match last {
                    Some(line) => line.trim().to_owned(),
                    None => format!("the compiler ended with {}", done.status),
                },
                notes: Vec::new(),
            });
        }
        // The cause is reported, not that the tools that called the one which said it have failed too.
        let is_echo = |one: &Diagnostic| {
            let ends = [" exit status", "lto-wrapper failed"];
            one.file.is_none() && ends.iter().any(|end| one.text.ends_with(end))
        };
        if complaints.iter().any(|one| is_error(one) && !is_echo(one)) {
            complaints.retain(|one| !is_echo(one));
        }
        let room = MOST_COMPLAINTS.saturating_sub(self.complaints.len());
        // However many warnings there are, an error is an error.
        let is_kept = |(number, one): &(usize, Diagnostic)| *number < room || is_error(one);
        let kept = complaints.into_iter().enumerate().filter(is_kept);
        self.complaints.extend(kept.map(|(_, one)| one));
        Ok(())
    }

    /// Whether there was no error so far.
    fn finish(&mut self) -> Result<(), SketchError> {
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        let errors = self.complaints.iter();
        let errors: Vec<Diagnostic> = errors
            .filter(|one| one.severity == Severity::Error)
            .cloned()
            .collect();
        match errors.is_empty() {
            true => Ok(()),
            false => Err(SketchError::Rejected(errors)),
        }
    }

    fn product(&self, name: &str) -> Result<fs::File, SketchError> {
        let path = self.folder.path().join(OUT).join(name);
        product::open(&path, self.compiler.sandbox.limits().file_mb << 20)
    }

    /// Puts a copy of a product into the cache, whole or not at all.
    fn keep(&self, name: &str, to: &Path) -> Result<(), SketchError> {
        let from = self.product(name)?;
        let copy = |mut from: fs::File| {
            let folder = to.parent().unwrap_or(&self.compiler.cache);
            fs::create_dir_all(folder)?;
            let mut file = tempfile::NamedTempFile::new_in(folder)?;
            std::io::copy(&mut from, &mut file)?;
            file.persist(to).map_err(|error| error.error)
        };
        match copy(from) {
            Ok(_) => Ok(()),
            Err(error) => Err(SketchError::file(to, error)),
        }
    }
}

/// A file of a build as the compiler names it.
fn seen(folder: &str, name: &str) -> OsString {
    format!("../{folder}/{name}").into()
}

fn part(key: &mut Sha256, bytes: &[u8]) {
    key.update((bytes.len() as u64).to_le_bytes());
    key.update(bytes);
}

fn hex(key: Sha256) -> String {
    let digest = key.finalize();
    digest[..12]
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// The file name of a sketch's image, restricted to portable characters.
fn file_name(name: &str) -> String {
    let is_plain = |c: &char| c.is_ascii_alphanumeric() || "-_".contains(*c);
    let plain: String = name.chars().filter(is_plain).take(60).collect();
    format!("{}.elf", if plain.is_empty() { "sketch" } else { &plain })
}

/// The ending of what is compiled by itself.
fn source_ending(file: &Path) -> Option<&str> {
    ending(file).filter(|ending| ["c", "cpp", "cc", "cxx", "S"].contains(ending))
}

/// The files in a folder, sorted.
fn files_of(folder: &Path) -> Result<Vec<PathBuf>, SketchError> {
    let entries = fs::read_dir(folder).map_err(|error| SketchError::file(folder, error))?;
    let mut files: Vec<PathBuf> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.is_file())
        .collect();
    files.sort();
    Ok(files)
}

fn read(path: &Path) -> Result<Vec<u8>, SketchError> {
    fs::read(path).map_err(|error| SketchError::file(path, error))
}
