//! One compilation, in a folder of its own.
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
use crate::options::{C, CPP, Options};
use crate::product;
use crate::sandbox::{Sandbox, Task};
use crate::source::ending;
use crate::toolchain::Toolchain;
use std::ffi::OsString;
use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Folders of a build; the compiler runs in the first.
pub(crate) const SKETCH: &str = "sketch";
pub(crate) const MAIN: &str = "main";
pub(crate) const OUT: &str = "out";
/// The linker's product.
pub(crate) const IMAGE: &str = "sketch.elf";
/// Most complaints kept of a compilation.
const MOST_COMPLAINTS: usize = 200;

/// How far a build is.
#[derive(Clone, Copy, Default)]
pub(crate) struct Mark {
    objects: usize,
    complaints: usize,
}

/// One compilation, in its own folder: the sketch beside its products.
pub(crate) struct Build<'a> {
    board: Board,
    options: Options,
    toolchain: &'a Toolchain,
    sandbox: &'a Sandbox,
    folder: tempfile::TempDir,
    /// Folders of the installed libraries that the sketch includes.
    libraries: Vec<PathBuf>,
    /// Folders in the sketch that have headers.
    own: Vec<String>,
    deadline: Instant,
    /// Their names in the folder of products.
    pub(crate) objects: Vec<String>,
    pub(crate) complaints: Vec<Diagnostic>,
}

impl<'a> Build<'a> {
    /// A build in a new folder in `within`.
    pub(crate) fn new(
        (board, options): (Board, Options),
        toolchain: &'a Toolchain,
        sandbox: &'a Sandbox,
        within: &Path,
    ) -> Result<Self, SketchError> {
        let wrong = |error| SketchError::file(within, error);
        let folder = tempfile::Builder::new()
            .prefix("build-")
            .tempdir_in(within)
            .map_err(wrong)?;
        for inner in [SKETCH, MAIN, OUT] {
            fs::create_dir(folder.path().join(inner)).map_err(wrong)?;
        }
        Ok(Self {
            board,
            options,
            toolchain,
            sandbox,
            folder,
            libraries: Vec::new(),
            own: Vec::new(),
            deadline: Instant::now() + sandbox.limits().time,
            objects: Vec::new(),
            complaints: Vec::new(),
        })
    }

    pub(crate) fn put(&self, inner: &str, name: &str, bytes: &[u8]) -> Result<(), SketchError> {
        let path = self.folder.path().join(inner).join(name);
        let write = || {
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            fs::File::create_new(&path)?.write_all(bytes)
        };
        write().map_err(|error| SketchError::file(&path, error))
    }

    /// Puts a file of the sketch, if it is one to be compiled, by a name that no file of a sketch may have.
    pub(crate) fn own(&self, name: &str, bytes: &[u8]) -> Result<Option<PathBuf>, SketchError> {
        let path = Path::new(name);
        let Some(ending) = source_ending(path) else {
            return Ok(None);
        };
        let ours = path.with_file_name(format!("rumbo~{}.{ending}", self.objects.len()));
        let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
        let line = format!("#line 1 \"{name}\"\n");
        let bytes = [line.as_bytes(), text].concat();
        self.put(SKETCH, &ours.to_string_lossy(), &bytes)?;
        Ok(Some(ours))
    }

    /// Headers of the sketch are looked for in this folder of it too.
    pub(crate) fn look_in(&mut self, folder: String) {
        self.own.push(folder);
    }

    /// Headers are looked for in these folders of a library too.
    pub(crate) fn look_in_library(&mut self, folders: &[PathBuf]) {
        self.libraries.extend_from_slice(folders);
    }

    /// How far it is.
    pub(crate) fn mark(&self) -> Mark {
        Mark {
            objects: self.objects.len(),
            complaints: self.complaints.len(),
        }
    }

    /// Takes back what came after a mark.
    pub(crate) fn back_to(&mut self, mark: Mark) {
        self.objects.truncate(mark.objects);
        self.complaints.truncate(mark.complaints);
    }

    /// What was said after a mark.
    pub(crate) fn said_since(&self, mark: Mark) -> &[Diagnostic] {
        self.complaints.get(mark.complaints..).unwrap_or_default()
    }

    /// The options for a file, and where headers are.
    fn args(&self, flags: &[&str], file: &Path) -> Vec<OsString> {
        let language: &[&str] = match ending(file) {
            Some("c") => &C,
            Some("S") => &["-x", "assembler-with-cpp"],
            _ => &CPP,
        };
        let core = &self.toolchain.core;
        let folders = [
            core.join("cores/arduino"),
            core.join("variants").join(self.board.variant),
        ];
        // A project may ask for another standard, of one of the languages.
        let is_cpp = !matches!(ending(file), Some("c" | "S"));
        let suits = |flag: &&str| !flag.starts_with("-std=") || flag.contains("++") == is_cpp;
        let flags: Vec<&str> = flags.iter().copied().filter(suits).collect();
        let board = &self.board.options[..];
        let options = [board, self.options.common, language, &flags[..]].concat();
        let mut args: Vec<OsString> = options.into_iter().map(OsString::from).collect();
        for folder in folders.iter().chain(&self.libraries) {
            args.extend(["-I".into(), OsString::from(folder)]);
        }
        for folder in &self.own {
            args.extend(["-I".into(), OsString::from(folder)]);
        }
        args
    }

    /// A file of ours after the preprocessor, with marks of where each line is from; `None` if it complains.
    pub(crate) fn preprocessed(
        &mut self,
        file: &str,
        flags: &[&str],
    ) -> Result<Option<String>, SketchError> {
        let product = "preprocessed.ii";
        let from = seen(MAIN, file);
        let mut args = self.args(&[&["-E", "-w"], flags].concat(), Path::new(&from));
        args.extend([from, "-o".into(), seen(OUT, product)]);
        let before = self.mark();
        self.run(&self.toolchain.gcc, &args, product, &[])?;
        if !self.said_since(before).is_empty() {
            return Ok(None);
        }
        let mut text = Vec::new();
        let file = self.product(product)?;
        (&file)
            .read_to_end(&mut text)
            .map_err(|error| SketchError::file(Path::new(product), error))?;
        Ok(Some(String::from_utf8_lossy(&text).into_owned()))
    }

    /// Compiles one file, of ours or of a library; an error does not keep the others from being compiled, so that all errors are seen.
    pub(crate) fn object(&mut self, file: &Path, flags: &[&str]) -> Result<(), SketchError> {
        let object = format!("{}.o", self.objects.len());
        let mut args = self.args(&[self.options.object, flags].concat(), file);
        args.extend([OsString::from(file), "-o".into(), seen(OUT, &object)]);
        self.run(&self.toolchain.gcc, &args, &object, &[])?;
        self.objects.push(object);
        Ok(())
    }

    /// Links all products with an archive of the core.
    pub(crate) fn link(&mut self, core: &Path) -> Result<(), SketchError> {
        let toolchain = self.toolchain;
        let board = &self.board.options[..];
        let options = [board, self.options.common, self.options.link].concat();
        let mut args: Vec<OsString> = options.into_iter().map(OsString::from).collect();
        args.extend(["-o".into(), seen(OUT, IMAGE)]);
        args.extend(self.objects.iter().map(|object| seen(OUT, object)));
        args.extend([core.into(), "-lm".into()]);
        self.run(&toolchain.gcc, &args, IMAGE, &[core])?;
        self.finish()
    }

    /// Runs a tool that makes a product, and keeps its diagnostics; it sees the libraries and `more`.
    pub(crate) fn run(
        &mut self,
        program: &Path,
        args: &[OsString],
        makes: &str,
        more: &[&Path],
    ) -> Result<(), SketchError> {
        let product = Path::new(OUT).join(makes);
        // That of the same step before.
        let path = self.folder.path().join(&product);
        if path.symlink_metadata().is_ok() {
            fs::remove_file(&path).map_err(|error| SketchError::file(&path, error))?;
        }
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
        let done = self.sandbox.run(task, program, args, self.deadline)?;
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
    pub(crate) fn finish(&self) -> Result<(), SketchError> {
        let errors = self.complaints.iter();
        let errors: Vec<Diagnostic> = errors
            .filter(|one| one.severity == Severity::Error)
            .map(|one| self.board.explained(one.clone()))
            .collect();
        match errors.is_empty() {
            true => Ok(()),
            false => Err(SketchError::Rejected(errors)),
        }
    }

    fn product(&self, name: &str) -> Result<fs::File, SketchError> {
        let path = self.folder.path().join(OUT).join(name);
        product::open(&path, self.sandbox.limits().file_mb << 20)
    }

    /// Puts a copy of a product into the cache, whole or not at all.
    pub(crate) fn keep(&self, name: &str, to: &Path) -> Result<(), SketchError> {
        let from = self.product(name)?;
        let copy = |mut from: fs::File| {
            let folder = to.parent().unwrap_or(to);
            fs::create_dir_all(folder)?;
            let mut part = tempfile::Builder::new();
            #[cfg(unix)]
            {
                use std::os::unix::fs::PermissionsExt;
                // As any new file: the next tool may be another user's.
                part.permissions(fs::Permissions::from_mode(0o666));
            }
            let mut file = part.tempfile_in(folder)?;
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
pub(crate) fn seen(folder: &str, name: &str) -> OsString {
    format!("../{folder}/{name}").into()
}

/// The ending of what is compiled by itself.
pub(crate) fn source_ending(file: &Path) -> Option<&str> {
    ending(file).filter(|ending| ["c", "cpp", "cc", "cxx", "S"].contains(ending))
}
