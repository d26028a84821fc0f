//! `--sketch` and `rumbo new sketch`: Arduino sketches as programs of the robot.

use crate::failure::Failure;
use crate::output;
use crate::place;
use rumbo_experiment::files::Library;
use rumbo_lab::manifest::crc32;
use rumbo_sim::boards::Board;
use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{
    BOARDS, Board as Target, Compiler, EXAMPLE, SketchError, Toolchain, cache, example, starter,
};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Duration;

/// Time for compiling a sketch that was dropped; the next one waits for it.
const DROPPED: Duration = Duration::from_secs(30);

/// What VS Code needs to debug a sketch: what to launch, and an extension that says by what.
const EDITOR: [(&str, &str); 2] = [
    (".vscode/launch.json", include_str!("editor/launch.json")),
    (
        ".vscode/extensions/rumbo-debug/package.json",
        include_str!("editor/package.json"),
    ),
];

impl From<SketchError> for Failure {
    fn from(error: SketchError) -> Self {
        match error {
            SketchError::Rejected(diagnostics) => {
                let lines = diagnostics.iter().flat_map(|one| {
                    let text = one.to_string();
                    text.lines().map(str::to_owned).collect::<Vec<_>>()
                });
                Self::Rejected(lines.collect())
            }
            other => Self::input(other),
        }
    }
}

/// The board as the compiler knows it.
pub(crate) fn target(board: &Board) -> Target {
    Target::named(board.name).unwrap_or(BOARDS[0])
}

/// The path that a user gave, to look for changes there; none for an example.
pub(crate) fn path(name: &str) -> Option<&Path> {
    (!name.starts_with(EXAMPLE)).then(|| Path::new(name))
}

/// The folders of `--libraries`.
static LIBRARIES: OnceLock<Vec<PathBuf>> = OnceLock::new();

/// Takes folders of libraries for the user's own sketches, from here on.
pub(crate) fn take_libraries(folders: &[PathBuf]) -> Result<(), Failure> {
    let whole = |folder: &PathBuf| {
        // The compiler works in a folder of its own.
        let whole = std::fs::canonicalize(folder)
            .ok()
            .filter(|whole| whole.is_dir());
        whole.ok_or_else(|| {
            Failure::Input(format!(
                "--libraries {}: no such folder; give the one that has a folder for each library",
                folder.display()
            ))
        })
    };
    let folders = folders.iter().map(whole).collect::<Result<Vec<_>, _>>()?;
    LIBRARIES.get_or_init(|| folders);
    Ok(())
}

/// Those that were taken.
fn libraries() -> &'static [PathBuf] {
    LIBRARIES.get().map_or(&[], Vec::as_slice)
}

/// A compiler for the user's own sketches.
pub(crate) fn compiler(board: &Board) -> Result<Compiler, SketchError> {
    Compiler::trusting(target(board), libraries())
}

/// A compiler for sketches of others, in the sandbox; for a debugger or to run.
pub(crate) fn walled_compiler(board: &Board, debug: bool) -> Result<Compiler, SketchError> {
    let toolchain = Toolchain::find()?.with_libraries(libraries());
    let limits = Limits {
        time: DROPPED,
        ..Limits::default()
    };
    let sandbox = Sandbox::walled(&toolchain, limits)?;
    let compiler = match debug {
        true => Compiler::to_debug,
        false => Compiler::new,
    };
    compiler(target(board), toolchain, sandbox, cache())
}

/// Keeps an image that was given as bytes beside the compiled sketches, by its checksum.
pub(crate) fn keep_image(content: &[u8], kind: &str) -> std::io::Result<PathBuf> {
    let folder = cache().join("dropped");
    std::fs::create_dir_all(&folder)?;
    let path = folder.join(format!("{:08x}.{kind}", crc32(content)));
    std::fs::write(&path, content)?;
    Ok(path)
}

/// The image of a user's sketch, compiled if need be: a folder, an `.ino`, or an example by name.
pub(crate) fn image(name: &str, board: &Board) -> Result<PathBuf, Failure> {
    let image = rumbo_sketch::image_of(name, target(board), libraries())?;
    for warning in &image.warnings {
        warning.to_string().lines().for_each(output::aside);
    }
    Ok(image.path)
}

/// The image of a program to debug, and the compiler's warnings; as it is to run, if it is to be `optimised`.
pub(crate) fn image_to_debug(
    name: &str,
    board: &Board,
    optimised: bool,
) -> Result<(PathBuf, Vec<String>), Failure> {
    let compile = match optimised {
        true => rumbo_sketch::image_of,
        false => rumbo_sketch::image_to_debug,
    };
    let image = compile(name, target(board), libraries())?;
    let warnings = image.warnings.iter().map(ToString::to_string);
    Ok((image.path, warnings.collect()))
}

/// Makes a folder with a sketch to start from: for a board, or as an example has it.
pub(crate) fn begin(
    folder: &Path,
    board: &'static Board,
    like: Option<&str>,
) -> Result<(), Failure> {
    let name = folder.file_name().map(|name| name.to_string_lossy());
    let Some(name) = name.filter(|name| is_name(name)) else {
        return Err(Failure::Input(format!(
            "{}: a sketch's name has letters, digits, _ and - only",
            folder.display()
        )));
    };
    let files = match like {
        Some(like) => example(like)?.files,
        None => [(format!("{name}.ino"), starter(target(board))?.into_bytes())].into(),
    };
    let main = like.map(|like| format!("{like}.ino"));
    if let Some(parent) = folder.parent() {
        place::folder(parent)?;
    }
    // An existing folder may hold somebody's work.
    std::fs::create_dir(folder).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::Input(format!(
            "{}: is there already; choose another name",
            folder.display()
        )),
        _ => place::unwritable(folder, &error),
    })?;
    let begun = folder.join(format!("{name}.ino"));
    for (file, bytes) in &files {
        let path = match main.as_ref() == Some(file) {
            true => begun.clone(),
            false => folder.join(file),
        };
        std::fs::write(&path, bytes)
            .map_err(|error| out_of_the_way(folder, place::unwritable(&path, &error)))?;
    }
    let robot = match Library::new().robot_with(|robot| robot.board == board) {
        Some(robot) if board != <&Board>::default() => Some(robot),
        _ => None,
    };
    write_for_editors(folder, robot.as_deref()).map_err(|why| out_of_the_way(folder, why))?;
    let (file, folder) = (output::shown(&begun), output::quoted(folder));
    // An example says in its first line how to drive it.
    let first = files.iter().find(|(file, _)| main.as_ref() == Some(file));
    let command = first.and_then(|(_, bytes)| {
        let line = str::from_utf8(bytes).ok()?.lines().next()?;
        let command = line.get(line.find("rumbo run ")?..)?;
        Some(command.replace(&format!("{EXAMPLE}{}", like?), &folder))
    });
    if let Some(command) = command {
        return output::line(&format!("{file}: edit it, then `{command}`"));
    }
    // Without a Bluetooth module a line at the USB port is the second setpoint.
    let usb = robot.as_ref().map_or("", |_| " --usb 'REF 50@5.5'");
    let robot = robot.map_or(String::new(), |robot| format!(" --robot {robot}"));
    output::line(&format!(
        "{file}: `rumbo lab --scenario mode1{robot} --sketch {folder}` shows it drive, also while it is edited; \
         `rumbo run mode1{robot}{usb} --sketch {folder}` judges it"
    ))
}

/// Removes the folder of a sketch that could not be begun: it would be in the way of the next attempt.
fn out_of_the_way(folder: &Path, why: Failure) -> Failure {
    let _ = std::fs::remove_dir_all(folder);
    why
}

/// What VS Code needs, for a robot that is not the scenario's.
fn write_for_editors(folder: &Path, robot: Option<&str>) -> Result<(), Failure> {
    for (file, text) in EDITOR {
        let path = folder.join(file);
        let robot = robot.map(|robot| {
            format!("\"program\": \"${{workspaceFolder}}\",\n      \"robot\": \"{robot}\",")
        });
        let text = match robot {
            Some(robot) if file.ends_with("launch.json") => {
                text.replace("\"program\": \"${workspaceFolder}\",", &robot)
            }
            _ => text.to_owned(),
        };
        place::folder(path.parent().unwrap_or(folder))?;
        std::fs::write(&path, text).map_err(|error| place::unwritable(&path, &error))?;
    }
    Ok(())
}

fn is_name(name: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    !name.is_empty() && name.chars().all(is_plain)
}
