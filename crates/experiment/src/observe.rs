//! A run with its program observed: a profile, pins over time, a debugger.
//!
//! None of it changes the run: robot and world are frozen while a debugger holds the program.

use crate::files::FileError;
use crate::run::{Run, Waves};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::gdb::{self, Farewell, Machine};
use rumbo_emulator::observe::profile::Profile;
use rumbo_sim::mega::Mega;
use std::fs::File;
use std::io::{self, BufWriter};
use std::net::TcpStream;

/// What to observe of the program.
#[derive(Debug, Default)]
pub struct Wanted {
    /// Cycles by function.
    pub profile: bool,
    /// A file for the pins over time, for waveform viewers.
    pub vcd: Option<File>,
    /// A debugger that is connected.
    pub debugger: Option<TcpStream>,
}

/// The observations.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Observations {
    /// The profile in tables.
    pub profile: Option<String>,
    /// The profile in the format of flame-graph tools.
    pub folded: Option<String>,
    /// The debugger ended the run early.
    pub ended: bool,
}

/// Runs to the end and returns the observations.
///
/// # Errors
/// There is no image in the robot, the file cannot be written, or the line to the debugger broke.
pub fn go_on(run: &mut Run<'_>, wanted: Wanted) -> Result<Observations, FileError> {
    let Some(mega) = run.sim().mega_mut() else {
        let what = "nothing of the program can be seen without --firmware";
        return Err(FileError::Setting(what.into()));
    };
    let image = mega.firmware().image().clone();
    let signals = mega.firmware().signals();
    if wanted.profile {
        mega.chip_mut()
            .observers_mut()
            .profile(Profile::new(&image));
    }
    let drawn = wanted.vcd.is_some();
    if let Some(file) = wanted.vcd {
        mega.chip_mut().record_levels();
        let waves = Waves::new(BufWriter::new(file), &signals);
        run.draw(waves.map_err(|error| unwritten(&error))?);
    }
    let mut seen = Observations::default();
    if let Some(connection) = wanted.debugger {
        let farewell = gdb::serve(&mut DebuggedRun(run), connection);
        let farewell = farewell.map_err(|error| FileError::Setting(error.to_string()))?;
        seen.ended = farewell == Farewell::Ended && !run.is_over();
    }
    while !seen.ended && !run.is_over() {
        run.advance();
    }
    if drawn {
        run.finish_drawing().map_err(|error| unwritten(&error))?;
    }
    if let Some(profile) = run
        .mega()
        .and_then(|mega| mega.chip().observers().profiled())
    {
        seen.folded = Some(profile.folded());
        seen.profile = Some(profile.report());
    }
    Ok(seen)
}

fn unwritten(error: &io::Error) -> FileError {
    FileError::Setting(format!(
        "the pins over time cannot be written ({error}); choose another file"
    ))
}

/// A run with an emulated Mega in it, in the hands of a debugger.
struct DebuggedRun<'r, 'a>(&'r mut Run<'a>);

impl DebuggedRun<'_, '_> {
    fn mega(&mut self) -> &mut Mega {
        match self.0.sim().mega_mut() {
            Some(mega) => mega,
            None => unreachable!("there was one at the beginning"),
        }
    }

    fn go_on(&mut self) -> Stopped {
        self.0.advance();
        if let Some(stopped) = self.mega().take_halt() {
            return stopped;
        }
        match self.chip().cpu().verdict() {
            Some(verdict) => Stopped::Ended(verdict.clone()),
            None => Stopped::Reached,
        }
    }
}

impl Machine for DebuggedRun<'_, '_> {
    fn chip(&self) -> &Chip {
        match self.0.mega() {
            Some(mega) => mega.chip(),
            None => unreachable!("there was one at the beginning"),
        }
    }

    fn chip_mut(&mut self) -> &mut Chip {
        self.mega().chip_mut()
    }

    fn go(&mut self) -> Stopped {
        self.go_on()
    }

    fn step(&mut self) -> Stopped {
        self.mega().step();
        self.go_on()
    }

    fn is_over(&self) -> bool {
        self.0.is_over()
    }
}
