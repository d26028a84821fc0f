//! Compiles core, libraries and a sketch; products are cached by the hash of all inputs.

use crate::board::Board;
use crate::build::{Build, IMAGE, MAIN, Mark, OUT, SKETCH, seen, source_ending};
use crate::diagnostics::Diagnostic;
use crate::error::SketchError;
use crate::examples::example;
use crate::headers::{Found, MISSING, Search, mentioned};
use crate::layout::Layout;
use crate::libraries::read;
use crate::limits::Limits;
use crate::options::{C, CPP, DEBUG, Options, RUN};
use crate::platformio::Project;
use crate::preprocess;
use crate::sandbox::Sandbox;
use crate::source::{Given, Source, given};
use crate::toolchain::Toolchain;
use sha2::{Digest, Sha256};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Part of every key: products of another layout are another's.
const LAYOUT: &str = "missed headers";

/// Standards of C++ that a compiler knows from this version on.
const LATE: [&str; 4] = ["++17", "++1z", "++20", "++2a"];
const KNOWS_LATE: u32 = 7;

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
        let unkept = |error: std::io::Error| {
            let what = "compiled sketches cannot be kept there";
            let remedy = format!("name another folder in the environment's {CACHE}");
            SketchError::file(&cache, format!("{what} ({error}); {remedy}"))
        };
        fs::create_dir_all(&cache).map_err(unkept)?;
        let cache = cache.canonicalize().map_err(unkept)?;
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
        let project = Project::of(source);
        let flags: Vec<&str> = project.flags.iter().map(String::as_str).collect();
        let macros = &[&flags[..], macros].concat();
        let layout = Layout::of(source, &project);
        let main = preprocess::join(source, layout.main);
        if main.is_none() && !layout.own.iter().any(|name| is_source(name)) {
            return Err(SketchError::NoSketch(source.name.clone()));
        }
        let key = self.key_of(source, &layout, macros)?;
        let image = self.cache.join(hex(key)).join(file_name(&source.name));
        if image.is_file() {
            return Ok(Image {
                path: image,
                fresh: true,
                warnings: Vec::new(),
            });
        }
        let mut build = self.build(&self.sandbox)?;
        for (name, bytes) in &source.files {
            build.put(SKETCH, name, bytes)?;
        }
        self.objects(&mut build, source, &layout, main.as_deref(), macros)?;
        build
            .finish()
            .map_err(|error| self.with_advice(error, macros))?;
        build.link(&self.core)?;
        build.keep(IMAGE, &image)?;
        Ok(Image {
            path: image,
            fresh: false,
            warnings: build.complaints,
        })
    }

    /// Compiles a sketch, and the libraries whose headers the compiler misses.
    fn objects(
        &self,
        build: &mut Build<'_>,
        source: &Source,
        layout: &Layout<'_>,
        main: Option<&str>,
        macros: &[&str],
    ) -> Result<(), SketchError> {
        let mut search = Search::new(&self.toolchain, self.own_libraries(), source, layout);
        let headers = layout.headers.iter().flat_map(|folder| ["-I", *folder]);
        let seen_by_own: Vec<&str> = macros.iter().copied().chain(headers).collect();
        let own = [&seen_by_own[..], &["-Wall", "-Wextra"]].concat();
        if let Some(joined) = main {
            build.put(MAIN, "joined.cpp", joined.as_bytes())?;
            let preprocessed = search.step(build, |build| {
                build.preprocessed("joined.cpp", &seen_by_own)
            })?;
            // What is wrong the compiler says again, at its place in the sketch.
            build.back_to(Mark::default());
            let text = preprocess::with_declarations(joined, preprocessed.as_deref());
            build.put(MAIN, "main.ino.cpp", text.as_bytes())?;
            let file = seen(MAIN, "main.ino.cpp");
            search.step(build, |build| build.object(Path::new(&file), &own))?;
        }
        let compile =
            |search: &mut Search<'_>, build: &mut Build<'_>, name: &str, flags: &[&str]| {
                let bytes = source.files.get(name).map_or(&[][..], Vec::as_slice);
                match build.own(name, bytes)? {
                    Some(file) => search.step(build, |build| build.object(&file, flags)),
                    None => Ok(()),
                }
            };
        for name in &layout.own {
            compile(&mut search, build, name, &own)?;
        }
        // Nobody mends a library's warnings here.
        let quiet = [macros, &["-w"]].concat();
        while let Some(library) = search.next() {
            match library {
                Found::Beside(index) => {
                    for name in &layout.libraries[index].files {
                        compile(&mut search, build, name, &quiet)?;
                    }
                }
                Found::Installed(library) => {
                    for file in library
                        .files
                        .iter()
                        .filter(|file| source_ending(file).is_some())
                    {
                        search.step(build, |build| build.object(file, &quiet))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Where our libraries are put.
    fn own_libraries(&self) -> PathBuf {
        self.cache.join("libraries")
    }

    fn build<'a>(&'a self, sandbox: &'a Sandbox) -> Result<Build<'a>, SketchError> {
        Build::new(
            (self.board, self.options),
            &self.toolchain,
            sandbox,
            &self.cache,
        )
    }

    /// The error, with where a missing header was looked for, or that the compiler is older than what the project wants.
    fn with_advice(&self, error: SketchError, flags: &[&str]) -> SketchError {
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
        let is_late = |flag: &&&str| LATE.iter().any(|late| flag.ends_with(*late));
        let version = &self.toolchain.compiler;
        let major = version
            .split('.')
            .next()
            .and_then(|major| major.parse().ok());
        if let (Some(standard), Some(first)) = (flags.iter().find(is_late), errors.first_mut())
            && major.is_some_and(|major: u32| major < KNOWS_LATE)
        {
            first.text += &format!(
                "; the project's {standard} is more than avr-gcc {version} knows: Arduino's does, \
                 `arduino-cli core install arduino:avr`"
            );
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
        let mut build = self.build(&trusting)?;
        for file in files.iter().filter(|file| source_ending(file).is_some()) {
            build.object(file, &["-w"])?;
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

    /// The key of a sketch's image: all files that it mentions.
    fn key_of(
        &self,
        source: &Source,
        layout: &Layout<'_>,
        macros: &[&str],
    ) -> Result<Sha256, SketchError> {
        let mut key = self.key(macros);
        for (name, bytes) in &source.files {
            part(&mut key, name.as_bytes());
            part(&mut key, bytes);
        }
        part(&mut key, source.name.as_bytes());
        for file in mentioned(&self.toolchain, &self.own_libraries(), source, layout)? {
            part(&mut key, &read(&file)?);
        }
        Ok(key)
    }
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
