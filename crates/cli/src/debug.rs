//! `rumbo debug`: the debugger of a program on the emulated chip, for editors, over stdin and stdout or a port.

use crate::args::{DebugArgs, board};
use crate::failure::Failure;
use crate::output;
use crate::sketch;
use rumbo_debug::control::Debugger;
use rumbo_debug::dap::{Adapter, Launch, LaunchHost};
use rumbo_debug::symbols::Symbols;
use rumbo_experiment::debugged::Debugged;
use rumbo_experiment::files::{Library, Overrides};
use std::io::{IsTerminal, Read, Write};
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, TryRecvError};

/// Chunks of a client's bytes that wait to be read.
const WAITING: usize = 64;

/// Serves one editor.
pub(crate) fn debug(args: &DebugArgs) -> Result<(), Failure> {
    sketch::take_libraries(&args.libraries)?;
    let Some(port) = args.port else {
        if std::io::stdin().is_terminal() {
            output::aside(
                "waiting for an editor to speak the Debug Adapter Protocol on stdin; `rumbo debug --help` says more",
            );
        }
        return serve(args, std::io::stdin(), std::io::stdout());
    };
    let refused = |error: std::io::Error| {
        Failure::Input(format!(
            "--port {port}: cannot listen there ({error}); choose another port, or 0 for any"
        ))
    };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
    let port = listener.local_addr().map_err(refused)?.port();
    output::aside(&format!(
        "waiting for an editor at port {port} of 127.0.0.1"
    ));
    let (connection, _) = listener.accept().map_err(refused)?;
    serve(args, connection.try_clone().map_err(refused)?, connection)
}

/// Passes bytes between the client and the adapter until one of them ends.
fn serve(
    args: &DebugArgs,
    from: impl Read + Send + 'static,
    mut to: impl Write,
) -> Result<(), Failure> {
    let received = read(from);
    let mut adapter = Adapter::new(Launcher(args));
    while !adapter.is_done() {
        let bytes = match adapter.is_running() {
            true => match received.try_recv() {
                Ok(bytes) => Some(bytes),
                Err(TryRecvError::Empty) => None,
                Err(TryRecvError::Disconnected) => break,
            },
            false => match received.recv() {
                Ok(bytes) => Some(bytes),
                Err(_) => break,
            },
        };
        match bytes {
            Some(bytes) => adapter.receive(&bytes).map_err(Failure::Input)?,
            None => adapter.turn(),
        }
        let output = adapter.take_output();
        if !output.is_empty() {
            to.write_all(&output)?;
            to.flush()?;
        }
    }
    Ok(())
}

/// Reads on a thread of its own, so that the program runs meanwhile.
fn read(mut from: impl Read + Send + 'static) -> Receiver<Vec<u8>> {
    let (sender, receiver) = mpsc::sync_channel(WAITING);
    std::thread::spawn(move || {
        let mut bytes = [0; 4096];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            if sender.send(bytes[..count].to_vec()).is_err() {
                return;
            }
        }
    });
    receiver
}

/// What the command line says, unless the client says otherwise.
struct Launcher<'a>(&'a DebugArgs);

impl LaunchHost for Launcher<'_> {
    type World = Debugged;

    fn launch(&mut self, launch: &Launch) -> Result<(Debugger<Debugged>, Vec<String>), String> {
        self.prepare(launch).map_err(|failure| failure.to_string())
    }
}

impl Launcher<'_> {
    fn prepare(&self, launch: &Launch) -> Result<(Debugger<Debugged>, Vec<String>), Failure> {
        let args = self.0;
        let Some(program) = launch.program.as_ref().or(args.program.as_ref()) else {
            return Err(Failure::Input(
                "no program: name the folder of a sketch or an image, as `rumbo debug my_sketch` or as `program` of the launch"
                    .into(),
            ));
        };
        let scenario = launch.scenario.as_ref().unwrap_or(&args.scenario);
        let robot = launch.robot.as_ref().or(args.setting.robot.as_ref());
        let board = board(robot.map(String::as_str), Some(scenario))?;
        let (image, notes) =
            sketch::image_to_debug(program, board, launch.optimised.unwrap_or(args.optimised))?;
        let overrides = Overrides {
            robot: robot.cloned(),
            world: launch.world.clone().or(args.setting.world.clone()),
            rig: args.setting.rig.clone(),
            firmware: Some(image.clone()),
            wiring: launch.wiring.clone().or(args.wiring.clone()),
            ..Overrides::default()
        };
        let setup = Arc::new(Library::new().setup(scenario, &overrides)?);
        let unread =
            |error: std::io::Error| Failure::Input(format!("{}: {error}", image.display()));
        let elf = std::fs::read(&image).map_err(unread)?;
        let folders = folders(program, &image);
        let symbols = Symbols::read(&elf, &|name| find(name, &folders))
            .map_err(|error| Failure::Input(format!("{program}: {error}")))?;
        let world = Debugged::new(&setup, launch.seed.unwrap_or(args.seed.seed))?;
        Ok((Debugger::new(symbols, world), notes))
    }
}

/// Where the files of a program may be: beside its source, beside the image, in the current folder.
fn folders(program: &str, image: &Path) -> Vec<PathBuf> {
    let whole = |path: &Path| path.canonicalize().ok();
    let given = whole(Path::new(program)).map(|path| match path.is_dir() {
        true => path,
        false => path.parent().map(Path::to_owned).unwrap_or(path),
    });
    let beside = whole(image).and_then(|path| path.parent().map(Path::to_owned));
    given
        .into_iter()
        .chain(beside)
        .chain(std::env::current_dir().ok())
        .collect()
}

/// The file that the compiler named.
fn find(name: &str, folders: &[PathBuf]) -> Option<PathBuf> {
    let places = folders.iter().map(|folder| folder.join(name));
    places
        .filter(|path| path.is_file())
        .find_map(|path| path.canonicalize().ok())
}
