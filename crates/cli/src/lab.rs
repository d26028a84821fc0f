//! `rumbo lab`: a simulated robot behind the station's dashboard.

use crate::args::LabArgs;
use crate::browser;
use crate::calibrate;
use crate::failure::Failure;
use crate::logs;
use crate::output;
use crate::workshop::{self, Workshop};
use rumbo_experiment::files::Overrides;
use rumbo_lab::{OwnProgram, SimulatedRobot};
use rumbo_log::Choice;
use rumbo_sim::debugging::Debugging;
use rumbo_station::{Lab, LabConfig, Print};

/// Serves the dashboard, prints its address first thing, and opens the browser.
pub(crate) fn lab(args: &mut LabArgs) -> Result<(), Failure> {
    let robot = simulated(args)?;
    #[cfg(unix)]
    if args.pty {
        return crate::pty::offer(robot, args.speed);
    }
    browser::show(served(args, robot, None)?, args.session.serve)
}

/// Serves the dashboard, for one who may be looking at the terminal.
#[cfg(feature = "ros")]
pub(crate) fn serve(args: &mut LabArgs) -> Result<Lab, Failure> {
    let robot = simulated(args)?;
    served(args, robot, Some(output::aside))
}

/// The simulated robot.
fn simulated(args: &mut LabArgs) -> Result<SimulatedRobot, Failure> {
    let robot = args.setting.robot.as_deref();
    args.image.compile(robot, Some(&args.scenario))?;
    let choice = Choice {
        scenario: args.scenario.clone(),
        world: args.setting.world.clone(),
        rig: args.setting.rig.clone(),
        seed: args.seed.seed,
    };
    let overrides = Overrides {
        robot: args.setting.robot.clone(),
        ..args.image.overrides()
    };
    let mut robot = SimulatedRobot::new(overrides, choice)?;
    robot.make_dropped_by(workshop::make_dropped);
    if let (Some(given), Some(board)) = (args.image.given(), robot.chip_board()) {
        let watch = |path| Workshop::watch(path, board).map(|it| Box::new(it) as _);
        let workshop = args.image.watched().map(watch).transpose();
        robot.own_program(OwnProgram::new(&given, workshop.map_err(Failure::input)?));
    }
    if let Some(port) = args.gdb {
        robot.debug(debugging(port, args)?);
    }
    #[cfg(unix)]
    if args.usb_pty {
        robot.plug_in(Box::new(crate::pty::UsbPort::offer()?));
    }
    Ok(robot)
}

fn served(args: &LabArgs, robot: SimulatedRobot, echo: Option<Print>) -> Result<Lab, Failure> {
    let config = LabConfig {
        at: args.session.serve.at(),
        speed: args.speed,
        recording: logs::recording(args.session.out.as_deref()),
        echo,
        #[cfg(feature = "foxglove")]
        bridge: bridge(args.session.bridge)?,
    };
    rumbo_station::serve_with(config, Box::new(robot), calibrate::in_dashboard())
        .map_err(Failure::input)
}

/// The port for a debugger, printed to stderr.
fn debugging(port: u16, args: &LabArgs) -> Result<Debugging, Failure> {
    let refused = |error: std::io::Error| {
        Failure::Input(format!(
            "--gdb {port}: cannot listen there ({error}); choose another port, or 0 for any"
        ))
    };
    let debugging = Debugging::at(port).map_err(refused)?;
    let port = debugging.port().map_err(refused)?;
    let image = args.image.firmware.as_ref();
    let image = image.map_or_else(String::new, |path| path.display().to_string());
    output::aside(&format!(
        "a debugger may come at any time: avr-gdb {image} -ex 'target remote :{port}'"
    ));
    Ok(debugging)
}

/// Starts the bridge, if requested, and prints its address.
#[cfg(feature = "foxglove")]
pub(crate) fn bridge(
    args: crate::args::BridgeArgs,
) -> Result<Option<rumbo_station::Bridge>, Failure> {
    let Some(port) = args.foxglove else {
        return Ok(None);
    };
    let bridge = rumbo_station::Bridge::start(port).map_err(Failure::input)?;
    output::aside(&format!("for Foxglove or Lichtblick: {}", bridge.address()));
    Ok(Some(bridge))
}
