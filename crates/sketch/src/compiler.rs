//! Compiles core, libraries and a sketch; products are cached by the hash of all inputs.

use crate::board::Board;
use crate::build::{Build, IMAGE, MAIN, OUT, SKETCH, seen, source_ending};
use crate::diagnostics::Diagnostic;
use crate::error::SketchError;
use crate::examples::example;
use crate::layout::{Beside, Layout};
use crate::libraries::{Library, spelled};
use crate::limits::Limits;
use crate::options::{C, CPP, DEBUG, Options, RUN};
use crate::preprocess;
use crate::sandbox::Sandbox;
use crate::source::{Given, Source, given};
use crate::toolchain::Toolchain;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Part of every key: products of another layout are another's.
const LAYOUT: &str = "preprocessed";
/// How the compiler ends that it misses a header.
const MISSING: &str = ": No such file or directory";
/// Folder of a build with headers that include others.
const SPELLED: &str = "rumbo~spelled";
/// Headers as they are included, and as they are called.
type Spelled = BTreeMap<String, String>;
/// Most headers that a sketch may include by different names: FastLED has some thousands.
const MOST_HEADERS: usize = 10_000;

/// Compiles sketches.
#[derive(Clone, Debug)]
pub struct Compiler {
    board: Board,
    options: Options,
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

/// Environment variable that names another folder for compiled files.
const CACHE: &str = "RUMBO_CACHE";
/// Prefix of an example's name.
pub const EXAMPLE: &str = "example:";

/// Folder of compiled cores and sketches: that of `RUMBO_CACHE`, else in the user's cache folder.
#[must_use]
pub fn cache() -> PathBuf {
    let named = std::env::var_os(CACHE).filter(|folder| !folder.is_empty());
    named.map(PathBuf::from).unwrap_or_else(|| {
        let usual = dirs::cache_dir().unwrap_or_else(std::env::temp_dir);
        usual.join("rumbo").join("sketches")
    })
}

/// The image of a user's sketch, compiled if need be: of a folder, an `.ino`, or an example by its name; an `.elf` or `.hex`
/// is one. `libraries` are folders with a folder for each library.
///
/// # Errors
/// There is none, no compiler, or it rejects the sketch.
pub fn image_of(name: &str, board: Board, libraries: &[PathBuf]) -> Result<Image, SketchError> {
    compiled(name, board, libraries, RUN)
}

/// The same for a debugger: hardly optimised, so that each line has code and each variable a place.
///
/// # Errors
/// As [`image_of`].
pub fn image_to_debug(
    name: &str,
    board: Board,
    libraries: &[PathBuf],
) -> Result<Image, SketchError> {
    compiled(name, board, libraries, DEBUG)
}

fn compiled(
    name: &str,
    board: Board,
    libraries: &[PathBuf],
    options: Options,
) -> Result<Image, SketchError> {
    let source = match name.strip_prefix(EXAMPLE) {
        Some(name) => example(name)?,
        None => match given(Path::new(name), true)? {
            Given::Image(path) => {
                return Ok(Image {
                    path,
                    fresh: true,
                    warnings: Vec::new(),
                });
            }
            Given::Sketch(source) => source,
        },
    };
    let compiler = Compiler::of_user(board, libraries, options)?;
    compiler.compile(&source, &[])
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
        Self::with(board, RUN, toolchain, sandbox, cache)
    }

    /// The same for a debugger, as [`image_to_debug`].
    ///
    /// # Errors
    /// As [`Compiler::new`].
    pub fn to_debug(
        board: Board,
        toolchain: Toolchain,
        sandbox: Sandbox,
        cache: PathBuf,
    ) -> Result<Self, SketchError> {
        Self::with(board, DEBUG, toolchain, sandbox, cache)
    }

    fn with(
        board: Board,
        options: Options,
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
            options,
            toolchain,
            sandbox,
            cache,
            core: PathBuf::new(),
        };
        compiler.core = compiler.build_core()?;
        Ok(compiler)
    }

    /// For the user's own sketches.
    ///
    /// # Errors
    /// There is none, or as [`Compiler::new`].
    pub fn trusting(board: Board, libraries: &[PathBuf]) -> Result<Self, SketchError> {
        Self::of_user(board, libraries, RUN)
    }

    fn of_user(board: Board, libraries: &[PathBuf], options: Options) -> Result<Self, SketchError> {
        let sandbox = Sandbox::trusting(Limits::default());
        let toolchain = Toolchain::find()?.with_libraries(libraries);
        Self::with(board, options, toolchain, sandbox, cache())
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
        let mut spelled = Spelled::new();
        loop {
            let result = self.attempt(source, macros, &spelled);
            let more = match &result {
                Err(SketchError::Rejected(errors)) => self.other_spellings(source, errors),
                _ => Spelled::new(),
            };
            let before = spelled.len();
            spelled.extend(more);
            if spelled.len() == before {
                return result;
            }
        }
    }

    /// Headers that were not found, and how they are spelled where there is one: on Windows and macOS `servo.h` is `Servo.h`,
    /// and many sketches are from there.
    fn other_spellings(&self, source: &Source, errors: &[Diagnostic]) -> Spelled {
        let missing = errors
            .iter()
            .filter_map(|error| error.text.split_once(MISSING));
        let found = missing.filter_map(|(header, _)| {
            let mut own = source.files.keys();
            let own = own.find(|name| name.eq_ignore_ascii_case(header)).cloned();
            let core = || spelled(&self.toolchain.core.join("cores/arduino"), header);
            let library = || self.toolchain.spelled(header);
            let real = own.or_else(core).or_else(library)?;
            Some((header.to_owned(), real))
        });
        found.collect()
    }

    /// Compiles once, with headers by other names.
    fn attempt(
        &self,
        source: &Source,
        macros: &[&str],
        spelled: &Spelled,
    ) -> Result<Image, SketchError> {
        let layout = Layout::of(source);
        let main = preprocess::join(source, layout.main);
        if main.is_none() && !layout.own.iter().any(|name| is_source(name)) {
            return Err(SketchError::NoSketch(source.name.clone()));
        }
        let needed = self.libraries_of(source, &layout, spelled)?;
        let mut key = self.key(macros);
        for (name, bytes) in &source.files {
            part(&mut key, name.as_bytes());
            part(&mut key, bytes);
        }
        part(&mut key, source.name.as_bytes());
        for file in needed.installed.iter().flat_map(|library| &library.files) {
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
        let folders = needed
            .installed
            .iter()
            .flat_map(|library| library.include.clone());
        let mut build = self.build(&self.sandbox, folders.collect())?;
        for (name, bytes) in &source.files {
            build.put(SKETCH, name, bytes)?;
        }
        for library in &needed.beside {
            build.look_in(library.headers.clone());
        }
        for (header, real) in spelled {
            build.put(
                SKETCH,
                &format!("{SPELLED}/{header}"),
                format!("#include <{real}>\n").as_bytes(),
            )?;
            build.look_in(SPELLED.to_owned());
        }
        let headers = layout.headers.iter().flat_map(|folder| ["-I", *folder]);
        let seen_by_own: Vec<&str> = macros.iter().copied().chain(headers).collect();
        let own = [&seen_by_own[..], &["-Wall", "-Wextra"]].concat();
        if let Some(joined) = main {
            build.put(MAIN, "joined.cpp", joined.as_bytes())?;
            let preprocessed = build.preprocessed("joined.cpp", &seen_by_own)?;
            let text = preprocess::with_declarations(&joined, preprocessed.as_deref());
            build.put(MAIN, "main.ino.cpp", text.as_bytes())?;
            build.object(Path::new(&seen(MAIN, "main.ino.cpp")), &own);
        }
        let compile = |build: &mut Build<'_>, name: &str, flags: &[&str]| {
            build.own(
                name,
                source.files.get(name).map_or(&[], Vec::as_slice),
                flags,
            )
        };
        for name in &layout.own {
            compile(&mut build, name, &own)?;
        }
        // Nobody mends a library's warnings here.
        let quiet = [macros, &["-w"]].concat();
        for name in needed.beside.iter().flat_map(|library| &library.files) {
            compile(&mut build, name, &quiet)?;
        }
        for file in needed.installed.iter().flat_map(|library| &library.files) {
            if source_ending(file).is_some() {
                build.object(file, &quiet);
            }
        }
        build.finish().map_err(|error| self.with_places(error))?;
        build.link(&self.core)?;
        build.keep(IMAGE, &image)?;
        Ok(Image {
            path: image,
            fresh: false,
            warnings: build.complaints,
        })
    }

    fn build<'a>(
        &'a self,
        sandbox: &'a Sandbox,
        folders: Vec<PathBuf>,
    ) -> Result<Build<'a>, SketchError> {
        Build::new(
            (self.board, self.options),
            &self.toolchain,
            sandbox,
            &self.cache,
            folders,
        )
    }

    /// The error, with where a missing header was looked for.
    fn with_places(&self, error: SketchError) -> SketchError {
        let SketchError::Rejected(mut errors) = error else {
            return error;
        };
        for error in &mut errors {
            if error.file.is_some() && error.text.ends_with(MISSING) {
                error.text += &format!(
                    "; no library has it: they are looked for in `libraries` in the sketch's folder, {}; install it with the \
                     Arduino IDE, or name its folder's folder by --libraries",
                    self.toolchain.libraries_in_words()
                );
            }
        }
        SketchError::Rejected(errors)
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
        let trusting = Sandbox::trusting(Limits::default());
        let mut build = self.build(&trusting, Vec::new())?;
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
        let fixed = [
            board,
            self.options.common,
            self.options.object,
            &C,
            &CPP,
            self.options.link,
            flags,
        ]
        .concat();
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
    fn libraries_of<'a>(
        &self,
        source: &Source,
        layout: &'a Layout<'_>,
        spelled: &Spelled,
    ) -> Result<Needed<'a>, SketchError> {
        let ours = self.cache.join("libraries");
        let mut headers = Headers::default();
        let own = |names: &[&str], headers: &mut Headers| {
            let files = names.iter().filter_map(|name| source.files.get(*name));
            files
                .into_iter()
                .try_for_each(|bytes| headers.note(bytes, source))
        };
        own(&layout.own, &mut headers)?;
        let (mut beside, mut installed) = (BTreeSet::new(), Vec::<Library>::new());
        while let Some(header) = headers.next.pop() {
            let header = spelled.get(&header).cloned().unwrap_or(header);
            if let Some(index) = layout.library(&header) {
                if beside.insert(index) {
                    own(&layout.libraries[index].files, &mut headers)?;
                }
                continue;
            }
            let Some(library) = self.toolchain.library(&header, &ours)? else {
                continue;
            };
            if installed.contains(&library) {
                continue;
            }
            for file in &library.files {
                headers.note(&read(file)?, source)?;
            }
            installed.push(library);
        }
        installed.sort_by(|a, b| a.include.cmp(&b.include));
        Ok(Needed {
            beside: beside
                .into_iter()
                .map(|index| &layout.libraries[index])
                .collect(),
            installed,
        })
    }
}

/// The headers that are included somewhere.
#[derive(Default)]
struct Headers {
    all: BTreeSet<String>,
    /// Those not looked for yet.
    next: Vec<String>,
}

impl Headers {
    /// Notes those of a file but for the sketch's own.
    fn note(&mut self, file: &[u8], source: &Source) -> Result<(), SketchError> {
        let text = String::from_utf8_lossy(file);
        for name in preprocess::includes(&text) {
            if !source.files.contains_key(name) && self.all.insert(name.to_owned()) {
                self.next.push(name.to_owned());
            }
        }
        match self.all.len() > MOST_HEADERS {
            true => Err(SketchError::Refused(format!(
                "the sketch includes more than {MOST_HEADERS} different headers"
            ))),
            false => Ok(()),
        }
    }
}

/// The libraries that a sketch needs.
struct Needed<'a> {
    /// Those beside it.
    beside: Vec<&'a Beside<'a>>,
    installed: Vec<Library>,
}

/// Whether a file is compiled by itself.
fn is_source(name: &str) -> bool {
    source_ending(Path::new(name)).is_some()
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
