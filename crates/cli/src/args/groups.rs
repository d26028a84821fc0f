//! Options that several commands have.

use super::values::parameter;
use crate::failure::Failure;
use crate::sketch;
use clap::{Args, ValueEnum};
use rumbo_experiment::files::{FileError, Library, NativeProgram, Overrides};
use rumbo_sim::boards::Board;
use std::path::{Path, PathBuf};

/// The programs that can drive the simulated robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgramName {
    /// Ours
    #[default]
    Rumbo,
    /// The report's, as a baseline
    Baseline,
}

/// Options that replace values of the scenario.
#[derive(Args, Clone, Debug)]
pub(crate) struct SettingArgs {
    /// Robot: name or path [default: the scenario's]
    #[arg(long, value_name = "NAME")]
    pub(crate) robot: Option<String>,
    /// World: name or path [default: the scenario's]
    #[arg(long, value_name = "NAME")]
    pub(crate) world: Option<String>,
    /// Sensor layout (rig): which sonars there are, and where [default: the scenario's]
    #[arg(long, value_name = "NAME")]
    pub(crate) rig: Option<String>,
    /// Policy that drives mode 9: name or path of a file of `rumbo export-policy` [default: the scenario's]
    #[arg(long, value_name = "NAME")]
    pub(crate) policy: Option<String>,
}

impl SettingArgs {
    /// The overrides of a scenario by these options, a program and parameters.
    pub(crate) fn overrides(
        &self,
        program: ProgramName,
        image: &ImageArgs,
        parameters: &ParameterArgs,
    ) -> Overrides {
        Overrides {
            robot: self.robot.clone(),
            rig: self.rig.clone(),
            world: self.world.clone(),
            policy: self.policy.clone(),
            parameters: parameters.params.clone(),
            program: match program {
                ProgramName::Rumbo => NativeProgram::Rumbo,
                ProgramName::Baseline => NativeProgram::Baseline,
            },
            ..image.overrides()
        }
    }
}

/// The board of a robot, or else of the robot of a scenario.
pub(crate) fn board(
    robot: Option<&str>,
    scenario: Option<&str>,
) -> Result<&'static Board, FileError> {
    let library = Library::new();
    let robot = match (robot, scenario) {
        (Some(robot), _) => library.robot(robot)?,
        (None, Some(scenario)) => {
            let robot = library.scenario(scenario)?.robot;
            library.beside(scenario).robot(&robot)?
        }
        (None, None) => return Ok(<&Board>::default()),
    };
    Ok(robot.board)
}

/// A program for the robot's board.
#[derive(Args, Clone, Debug)]
pub(crate) struct ImageArgs {
    /// Firmware for the robot's board, ELF or Intel HEX, run on an emulated one (docs/emulator.md)
    #[arg(long, value_name = "IMAGE", group = "image")]
    pub(crate) firmware: Option<PathBuf>,
    /// Arduino sketch, compiled and then run as firmware: its folder or .ino, or example:NAME (`rumbo list sketches`)
    #[arg(long, value_name = "FOLDER", group = "image")]
    pub(crate) sketch: Option<String>,
    /// Folder of Arduino libraries, which come before those of the Arduino IDE; may be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) libraries: Vec<PathBuf>,
    /// Wiring of that board, of the robot file [default: the report's for the experiment; `final` for our own firmware]
    #[arg(long, value_name = "NAME", requires = "image")]
    pub(crate) wiring: Option<String>,
}

impl ImageArgs {
    /// Compiles the sketch, if one is given, for the board of the robot or of the scenario's: from here on it is the
    /// firmware.
    ///
    /// # Errors
    /// It is not there, or the compiler refuses it.
    pub(crate) fn compile(
        &mut self,
        robot: Option<&str>,
        scenario: Option<&str>,
    ) -> Result<(), Failure> {
        match &self.sketch {
            Some(given) => {
                sketch::take_libraries(&self.libraries)?;
                self.firmware = Some(sketch::image(given, board(robot, scenario)?)?);
            }
            None if self.libraries.is_empty() => {}
            None => {
                return Err(Failure::input(
                    "--libraries: there is no --sketch that they are for",
                ));
            }
        }
        Ok(())
    }

    /// What the user gave as the program.
    pub(crate) fn given(&self) -> Option<String> {
        let image = self.firmware.as_ref();
        let image = image.map(|path| path.display().to_string());
        self.sketch.clone().or(image)
    }

    /// Where to look for changes of it.
    pub(crate) fn watched(&self) -> Option<&Path> {
        match &self.sketch {
            Some(sketch) => sketch::path(sketch),
            None => self.firmware.as_deref(),
        }
    }

    /// The resulting overrides of a scenario.
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides {
            firmware: self.firmware.clone(),
            wiring: self.wiring.clone(),
            ..Overrides::default()
        }
    }
}

/// What may be overwritten.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct OverwriteArgs {
    /// Replace existing files; without it only those that Rumbo wrote for the same run or report
    #[arg(long)]
    pub(crate) force: bool,
}

/// The seed.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct SeedArgs {
    /// Random seed, robot-to-robot variation included
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
}

/// Parameters.
#[derive(Args, Clone, Debug)]
pub(crate) struct ParameterArgs {
    /// Parameter of the control core or the plant (`rumbo list`); may be repeated
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = parameter)]
    pub(crate) params: Vec<(String, f64)>,
}

/// Where the dashboard is served.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct ServeArgs {
    /// Port of the dashboard; 0 takes any free one
    #[arg(long, value_name = "N", default_value_t = rumbo_station::DEFAULT_PORT)]
    pub(crate) port: u16,
    /// Serve the dashboard to the network too, at this address of this computer; prints an address that opens once and one for viewers.
    /// Not encrypted (docs/security.md)
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) listen: Option<std::net::IpAddr>,
    /// Do not open the browser
    #[arg(long)]
    pub(crate) no_browser: bool,
}

impl ServeArgs {
    /// The address and port.
    pub(crate) fn at(self) -> rumbo_station::ServeAt {
        let here = rumbo_station::ServeAt::here(self.port);
        rumbo_station::ServeAt {
            address: self.listen.unwrap_or(here.address),
            ..here
        }
    }
}

/// A session with a robot.
#[derive(Args, Clone, Debug)]
pub(crate) struct SessionArgs {
    #[command(flatten)]
    pub(crate) serve: ServeArgs,
    /// Folder for the log, of a simulated robot one for each run; made if need be [default: rumbo/logs in the user's data folder]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}
