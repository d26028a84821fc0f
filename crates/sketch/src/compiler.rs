//! Compiles core, libraries and a sketch; products are cached by the hash of all inputs.

use crate::board::Board;
use crate::diagnostics::{Diagnostic, Severity, parse};
use crate::error::SketchError;
use crate::preprocess;
use crate::sandbox::{Limits, Sandbox};
use crate::source::{Source, ending};
use crate::toolchain::Toolchain;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
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
/// The sketch's own files and the build's, as the compiler sees them; it runs in the first.
const SKETCH: &str = "sketch";
const OUT: &str = "out";

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
        build.put(OUT, "main.ino.cpp", main.as_bytes())?;
        let own = [macros, &["-Wall", "-Wextra", "-I", "."]].concat();
        build.object("../out/main.ino.cpp".as_ref(), &own);
        for name in source.files.keys().filter(|name| {
            // As the IDE has it: files beside the sketch, and all below `src`.
            (!name.contains('/') || name.starts_with("src/")) && is_source(Path::new(name))
        }) {
            build.object(name.as_ref(), &own);
        }
        let quiet = [macros, &["-w"]].concat();
        for file in libraries.iter().flat_map(|library| &library.files) {
            if is_source(file) {
                build.object(file, &quiet);
            }
        }
        build.finish()?;
        build.link()?;
        build.keep("sketch.elf", &image)?;
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
        for file in files.iter().filter(|file| is_source(file)) {
            build.object(file, &["-w"]);
        }
        build.finish()?;
        let mut args: Vec<OsString> = vec!["rcs".into(), "../out/core.a".into()];
        args.extend(build.objects.iter().map(OsString::from));
        build.run(&self.toolchain.archiver(), &args)?;
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
        ]) {
            part(&mut key, text.as_bytes());
        }
        key
    }

    /// The libraries that a sketch includes, and those that they include.
    fn libraries_of(&self, source: &Source) -> Result<Vec<Library>, SketchError> {
        let ours = self.cache.join("libraries");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let mut texts: Vec<String> = source.files.values().map(|bytes| text(bytes)).collect();
        let mut found: BTreeMap<PathBuf, Library> = BTreeMap::new();
        while let Some(next) = texts.pop() {
            for header in preprocess::includes(&next) {
                if source.files.contains_key(&header) {
                    continue;
                }
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
                    texts.push(text(&read(file)?));
                }
                found.insert(folder.clone(), Library { folder, files });
            }
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
    /// As the compiler, running in the sketch's folder, names them.
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
        for inner in [SKETCH, OUT] {
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
            fs::write(&path, bytes)
        };
        write().map_err(|error| SketchError::file(&path, error))
    }

    /// Compiles one file; an error does not keep the others from being compiled, so that all errors are seen.
    fn object(&mut self, file: &Path, flags: &[&str]) {
        let object = format!("../out/{}.o", self.objects.len());
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
        args.extend([OsString::from(file), "-o".into(), object.clone().into()]);
        self.objects.push(object);
        if self.failed.is_none()
            && let Err(error) = self.run(&self.compiler.toolchain.gcc.clone(), &args)
        {
            self.failed = Some(error);
        }
    }

    fn link(&mut self) -> Result<(), SketchError> {
        let toolchain = &self.compiler.toolchain;
        let board = &self.compiler.board.options[..];
        let options = [board, &COMMON, &LINK].concat();
        let mut args: Vec<OsString> = options.into_iter().map(OsString::from).collect();
        args.extend(["-o", "../out/sketch.elf"].map(OsString::from));
        args.extend(self.objects.iter().map(OsString::from));
        // A copy in the build's folder: the sandbox shows no other of ours, and nobody's sketch may change the core's.
        let core = self.folder.path().join(OUT).join("core.a");
        fs::copy(&self.compiler.core, &core).map_err(|error| SketchError::file(&core, error))?;
        args.extend(["../out/core.a", "-lm"].map(OsString::from));
        let gcc = toolchain.gcc.clone();
        self.run(&gcc, &args)?;
        self.finish()
    }

    /// Runs a tool and keeps its diagnostics.
    fn run(&mut self, program: &Path, args: &[OsString]) -> Result<(), SketchError> {
        let done = self.compiler.sandbox.run(
            (self.folder.path(), Path::new(SKETCH)),
            &self.libraries,
            program,
            args,
            self.deadline,
        )?;
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
        // The linker's cause is reported, not that it failed.
        if complaints.iter().filter(|one| is_error(one)).count() > 1 {
            complaints.retain(|one| !one.text.contains("ld returned"));
        }
        self.complaints.extend(complaints);
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

    /// Puts a product into the cache, whole or not at all.
    fn keep(&self, name: &str, to: &Path) -> Result<(), SketchError> {
        let from = self.folder.path().join(OUT).join(name);
        to.parent()
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| fs::rename(&from, to))
            .map_err(|error| SketchError::file(to, error))
    }
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

fn is_source(file: &Path) -> bool {
    matches!(ending(file), Some("c" | "cpp" | "cc" | "cxx" | "S"))
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
