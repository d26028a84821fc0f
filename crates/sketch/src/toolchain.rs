//! The compiler and the Arduino core: those that arduino-cli has installed, else the system's.

use crate::bundled;
use crate::error::SketchError;
use crate::libraries::{self, Library};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Where Debian's `arduino-core-avr` puts it.
const SYSTEM_CORE: &str = "/usr/share/arduino/hardware/arduino/avr";

/// A compiler with an Arduino core.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Toolchain {
    /// `avr-gcc`.
    pub(crate) gcc: PathBuf,
    /// The core's folder, with `cores`, `variants` and `libraries`.
    pub(crate) core: PathBuf,
    /// Folders of libraries besides the core's, first come first served.
    pub(crate) libraries: Vec<PathBuf>,
    /// What a sandbox must show for the compiler to run.
    pub(crate) visible: Vec<PathBuf>,
    /// Version of the compiler: `5.4.0`.
    pub compiler: String,
    /// Version of the core: `1.8.7`.
    pub core_version: String,
}

impl Toolchain {
    /// The one that arduino-cli has installed, else the system's.
    ///
    /// # Errors
    /// There is none.
    pub fn find() -> Result<Self, SketchError> {
        let installed = [arduino_cli(), arduino_ide()].into_iter().flatten();
        installed
            .clone()
            .find_map(|folders| Self::of_arduino(&folders))
            .or_else(|| {
                let mut system = Self::of_system(Path::new(SYSTEM_CORE))?;
                let mut users: Vec<PathBuf> =
                    installed.flat_map(|folders| folders.libraries()).collect();
                users.append(&mut system.libraries);
                system.libraries = users;
                Some(system)
            })
            .ok_or(SketchError::NoCompiler)
    }

    /// With folders of libraries that come before all others.
    #[must_use]
    pub fn with_libraries(mut self, folders: &[PathBuf]) -> Self {
        self.libraries.splice(0..0, folders.iter().cloned());
        self
    }

    /// Compiler and core in words: `avr-gcc 5.4.0, Arduino AVR core 1.8.7`.
    #[must_use]
    pub fn in_words(&self) -> String {
        format!(
            "avr-gcc {}, Arduino AVR core {}",
            self.compiler, self.core_version
        )
    }

    fn of_system(core: &Path) -> Option<Self> {
        let gcc = on_path("avr-gcc")?;
        // Its parts: cc1plus and the like, and the assembler with the headers of the chip.
        let install = line_of(&gcc, &["-print-search-dirs"])?;
        let install = install.strip_prefix("install: ")?;
        let assembler = line_of(&gcc, &["-print-prog-name=as"])?;
        let parts = [
            Path::new(install).canonicalize().ok()?.parent()?.to_owned(),
            Path::new(&assembler)
                .canonicalize()
                .ok()?
                .parent()?
                .parent()?
                .to_owned(),
        ];
        let visible = std::iter::once(gcc.clone()).chain(parts).collect();
        Self::new(gcc, core.to_owned(), Vec::new(), visible)
    }

    /// The newest core and compiler below the folder of data of arduino-cli or the IDE; libraries that its user has
    /// installed come first.
    fn of_arduino(folders: &Folders) -> Option<Self> {
        let packages = folders.data.join("packages/arduino");
        let core = newest(&packages.join("hardware/avr"))?;
        let tools = newest(&packages.join("tools/avr-gcc"))?;
        let gcc = tools.join("bin/avr-gcc");
        Self::new(gcc, core, folders.libraries(), vec![tools])
    }

    fn new(
        gcc: PathBuf,
        core: PathBuf,
        libraries: Vec<PathBuf>,
        visible: Vec<PathBuf>,
    ) -> Option<Self> {
        let platform = fs::read_to_string(core.join("platform.txt")).ok()?;
        let core_version = platform
            .lines()
            .find_map(|line| line.strip_prefix("version="))?
            .trim()
            .to_owned();
        Some(Self {
            compiler: line_of(&gcc, &["-dumpversion"])?,
            gcc,
            libraries: libraries
                .into_iter()
                .chain([core.join("libraries")])
                .collect(),
            core,
            visible,
            core_version,
        })
    }

    /// The archiver that knows the compiler's objects.
    pub(crate) fn archiver(&self) -> PathBuf {
        self.gcc.with_file_name("avr-gcc-ar")
    }

    /// The library that has a header: one that is installed, else one of ours, put below `ours`.
    pub(crate) fn library(
        &self,
        header: &str,
        ours: &Path,
    ) -> Result<Option<Library>, SketchError> {
        if let Some(found) = libraries::find(&self.libraries, header)? {
            return Ok(Some(found));
        }
        let is_plain = |c: char| c.is_alphanumeric() || "_-+ ".contains(c);
        let name = header.strip_suffix(".h");
        let ours = match name.filter(|name| !name.is_empty() && name.chars().all(is_plain)) {
            Some(name) => bundled::unpack(name, ours)?,
            None => None,
        };
        ours.map(|folder| Library::of(folder, false)).transpose()
    }

    /// How a library spells a header, with other capitals.
    pub(crate) fn spelled(&self, header: &str) -> Option<String> {
        libraries::spelled_in(&self.libraries, header)
    }

    /// Where libraries are looked for, in words, a person's own folder as `~`.
    pub(crate) fn libraries_in_words(&self) -> String {
        let home = std::env::home_dir();
        let short = |folder: &PathBuf| match home.as_ref().map(|home| folder.strip_prefix(home)) {
            Some(Ok(below)) => Path::new("~").join(below).display().to_string(),
            _ => folder.display().to_string(),
        };
        let folders: Vec<String> = self.libraries.iter().map(short).collect();
        folders.join(", ")
    }
}

/// Where arduino-cli or the IDE keeps what it has installed.
#[derive(Clone, Debug)]
struct Folders {
    data: PathBuf,
    user: Option<PathBuf>,
}

impl Folders {
    /// Of the user's libraries, then of those that came with the IDE.
    fn libraries(&self) -> Vec<PathBuf> {
        let user = self.user.iter().chain([&self.data]);
        user.map(|folder| folder.join("libraries")).collect()
    }
}

fn arduino_cli() -> Option<Folders> {
    let cli = on_path("arduino-cli")?;
    let folder = |key: &str| line_of(&cli, &["config", "get", key]).map(PathBuf::from);
    Some(Folders {
        data: folder("directories.data")?,
        user: folder("directories.user"),
    })
}

/// The IDE's folders where nobody has chosen others.
fn arduino_ide() -> Option<Folders> {
    let home = std::env::home_dir()?;
    let (data, user) = match std::env::consts::OS {
        "windows" => ("AppData/Local/Arduino15", "Documents/Arduino"),
        "macos" => ("Library/Arduino15", "Documents/Arduino"),
        _ => (".arduino15", "Arduino"),
    };
    Some(Folders {
        data: home.join(data),
        user: Some(home.join(user)),
    })
}

/// The folder with the highest version for its name.
fn newest(folder: &Path) -> Option<PathBuf> {
    let version = |path: &PathBuf| -> Vec<u32> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.split(|c: char| !c.is_ascii_digit())
            .filter_map(|part| part.parse().ok())
            .collect()
    };
    let inside = fs::read_dir(folder).ok()?.flatten();
    inside
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .max_by_key(version)
}

/// A program on the search path.
pub(crate) fn on_path(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let name = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&path)
        .map(|folder| folder.join(&name))
        .find(|file| file.is_file())
}

/// The first line that a program prints.
fn line_of(program: &Path, args: &[impl AsRef<OsStr>]) -> Option<String> {
    let output = Command::new(program)
        .args(args)
        .env("LC_ALL", "C")
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.lines().next()?.trim().to_owned()).filter(|line| !line.is_empty())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn what_arduino_cli_has_installed_is_found_with_the_newest_versions() {
        let Some(system) = Toolchain::of_system(Path::new(SYSTEM_CORE)) else {
            return;
        };
        let data = tempfile::tempdir().unwrap();
        let packages = data.path().join("packages/arduino");
        for version in ["1.8.6", "1.8.10"] {
            let core = packages.join("hardware/avr").join(version);
            fs::create_dir_all(&core).unwrap();
            fs::write(core.join("platform.txt"), format!("version={version}\n")).unwrap();
        }
        let bin = packages.join("tools/avr-gcc/7.3.0-atmel3.6.1-arduino7/bin");
        fs::create_dir_all(&bin).unwrap();
        symlink(&system.gcc, bin.join("avr-gcc")).unwrap();
        let folders = Folders {
            data: data.path().to_owned(),
            user: Some("ana/Arduino".into()),
        };
        let found = Toolchain::of_arduino(&folders).unwrap();
        assert_eq!(found.core_version, "1.8.10");
        assert_eq!(found.compiler, system.compiler);
        assert!(found.libraries[0].ends_with("Arduino/libraries"));
        // Those that are named come before all that are installed.
        let found = found.with_libraries(&["mine".into(), "yours".into()]);
        let first = found.libraries[..2]
            .iter()
            .map(|path| path.to_str().unwrap());
        assert!(first.eq(["mine", "yours"]));
    }
}
