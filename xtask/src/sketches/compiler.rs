//! avr-gcc on core, libraries and sketches.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{files_of, preprocess, read};
use crate::project::{output, run};

/// Options of every call: the Mega and the version that a sketch may test for.
const CHIP: [&str; 6] = [
    "-mmcu=atmega2560",
    "-DF_CPU=16000000L",
    "-DARDUINO=10819",
    "-DARDUINO_AVR_MEGA2560",
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

/// The compiler with the Arduino core.
pub(super) struct Compiler {
    includes: Vec<PathBuf>,
    core: PathBuf,
    libraries: Vec<PathBuf>,
    out: PathBuf,
    /// Common inputs of all products.
    version: String,
}

/// Files that go into one image.
struct Sources {
    includes: Vec<PathBuf>,
    files: Vec<PathBuf>,
}

impl Compiler {
    /// With the core's folder `avr`, folders of libraries, and the folder of the products.
    pub(super) fn new(
        core: &Path,
        libraries: Vec<PathBuf>,
        out: PathBuf,
    ) -> Result<Compiler, String> {
        let version = output(Command::new("avr-gcc").arg("--version"))?;
        let platform = read(&core.join("platform.txt"))?;
        let sources = core.join("cores/arduino");
        Ok(Compiler {
            includes: vec![sources.clone(), core.join("variants/mega")],
            core: sources,
            libraries,
            out,
            version: version + &platform,
        })
    }

    /// The core as an archive, from which the linker takes what is used.
    pub(super) fn build_core(&self) -> Result<(), String> {
        let files: Vec<PathBuf> = files_of(&self.core)?;
        let archive = self.archive();
        let key = self.key(&files, &[])?;
        if is_fresh(&archive, &key) {
            return Ok(());
        }
        let folder = self.out.join("core");
        let mut objects = Vec::new();
        for file in files.iter().filter(|file| is_source(file)) {
            objects.push(self.compile(file, &folder, &self.includes, &["-w"])?);
        }
        let _ = std::fs::remove_file(&archive);
        run(Command::new("avr-gcc-ar")
            .arg("rcs")
            .arg(&archive)
            .args(objects))?;
        note(&archive, &key)
    }

    /// The image of a sketch; returns whether it had to be built.
    pub(super) fn build_sketch(
        &self,
        sketch: &Path,
        name: &str,
        macros: &[&str],
    ) -> Result<bool, String> {
        let image = self.out.join(format!("{name}.elf"));
        let sources = self.sources(sketch)?;
        let key = self.key(&sources.files, macros)?;
        if is_fresh(&image, &key) {
            return Ok(false);
        }
        let folder = self.out.join(name);
        let joined = folder.join(format!("{name}.ino.cpp"));
        std::fs::create_dir_all(&folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?;
        std::fs::write(&joined, preprocess::join(sketch, &sources.files)?)
            .map_err(|error| format!("{}: {error}", joined.display()))?;
        let flags = [macros, &["-Wall", "-Wextra"]].concat();
        let quiet = [macros, &["-w"]].concat();
        let mut objects = vec![self.compile(&joined, &folder, &sources.includes, &flags)?];
        for file in sources.files.iter().filter(|file| is_source(file)) {
            let own = file.starts_with(sketch);
            let flags = if own { &flags } else { &quiet };
            objects.push(self.compile(file, &folder, &sources.includes, flags)?);
        }
        run(Command::new("avr-gcc")
            .args(CHIP)
            .args(LINK)
            .arg("-o")
            .arg(&image)
            .args(objects)
            .arg(self.archive())
            .arg("-lm"))?;
        note(&image, &key)?;
        Ok(true)
    }

    fn archive(&self) -> PathBuf {
        self.out.join("core.a")
    }

    /// The sketch's own files and those of the libraries it includes.
    fn sources(&self, sketch: &Path) -> Result<Sources, String> {
        let mut includes = self.includes.clone();
        includes.push(sketch.to_owned());
        let mut files = files_of(sketch)?;
        files.retain(|file| file.is_file() && file.extension().is_none_or(|ending| ending != "md"));
        let mut next = 0;
        while let Some(file) = files.get(next) {
            let headers = preprocess::includes(&read(file)?);
            for folder in headers.iter().filter_map(|header| self.library(header)) {
                if !includes.contains(&folder) {
                    let parts = [folder.clone(), folder.join("utility")];
                    for part in parts.iter().filter(|part| part.is_dir()) {
                        files.extend(files_of(part)?.into_iter().filter(|file| file.is_file()));
                    }
                    includes.push(folder);
                }
            }
            next += 1;
        }
        Ok(Sources { includes, files })
    }

    /// The folder of the library that has this header.
    fn library(&self, header: &str) -> Option<PathBuf> {
        let name = header.strip_suffix(".h")?;
        self.libraries
            .iter()
            .flat_map(|folder| [folder.join(name).join("src"), folder.join(name)])
            .find(|folder| folder.join(header).is_file())
    }

    /// Compiles one file; returns its object.
    fn compile(
        &self,
        file: &Path,
        folder: &Path,
        includes: &[PathBuf],
        flags: &[&str],
    ) -> Result<PathBuf, String> {
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let object = folder.join(format!("{name}.o"));
        let language: &[&str] = match file.extension().and_then(|ending| ending.to_str()) {
            Some("c") => &C,
            Some("cpp") => &CPP,
            _ => &["-x", "assembler-with-cpp"],
        };
        let mut command = Command::new("avr-gcc");
        command.args(CHIP).args(OBJECT).args(flags).args(language);
        for include in includes {
            command.arg("-I").arg(include);
        }
        run(command.arg(file).arg("-o").arg(&object))?;
        Ok(object)
    }

    /// Hash of the compiler, of `flags` and of what is in the files.
    fn key(&self, files: &[PathBuf], flags: &[&str]) -> Result<String, String> {
        let mut hasher = DefaultHasher::new();
        (&self.version, CHIP, OBJECT, C, CPP, LINK, flags).hash(&mut hasher);
        for file in files.iter().filter(|file| file.is_file()) {
            (file, read(file)?).hash(&mut hasher);
        }
        Ok(format!("{:016x}", hasher.finish()))
    }
}

/// The compiler takes it by itself.
fn is_source(file: &Path) -> bool {
    file.extension()
        .is_some_and(|ending| ending == "c" || ending == "cpp" || ending == "S")
}

fn key_file(product: &Path) -> PathBuf {
    product.with_extension("key")
}

fn is_fresh(product: &Path, key: &str) -> bool {
    product.is_file() && std::fs::read_to_string(key_file(product)).is_ok_and(|noted| noted == key)
}

fn note(product: &Path, key: &str) -> Result<(), String> {
    let file = key_file(product);
    std::fs::write(&file, key).map_err(|error| format!("{}: {error}", file.display()))
}
