//! `rumbo lab`: a simulated robot behind the station's dashboard.

use crate::args::LabArgs;
use crate::browser;
use crate::calibrate;
use crate::failure::Failure;
use crate::logs;
use crate::output;
use crate::sketch;
use crate::tune;
use crate::wired;
use crate::workshop::{self, Workshop};
use rumbo_experiment::files::{Kind, Library, Overrides, ScenarioFile};
use rumbo_lab::{OwnProgram, SimulatedRobot};
use rumbo_log::Choice;
use rumbo_sim::debugging::Debugging;
use rumbo_station::{Lab, LabConfig, Named};

/// Serves the dashboard, prints its address first thing, and opens the browser.
pub(crate) fn lab(args: &mut LabArgs) -> Result<(), Failure> {
    #[cfg(unix)]
    if args.pty && fleet(args)?.is_none() {
        return crate::pty::offer(simulated(args)?, args.speed);
    }
    browser::show(serve(args)?, args.session.serve)
}

/// Serves the dashboard.
fn serve(args: &mut LabArgs) -> Result<Lab, Failure> {
    let robots = match fleet(args)? {
        Some(scenario) => several(args, &scenario)?,
        None => vec![simulated(args)?],
    };
    let named = |robot: SimulatedRobot| -> Named { (robot.name(), Box::new(robot)) };
    let robots = robots.into_iter().map(named).collect();
    rumbo_station::serve_all(config(args), robots, calibrate::in_dashboard())
        .map_err(Failure::input)
}

/// The scenario, if it is to have several robots.
fn fleet(args: &LabArgs) -> Result<Option<ScenarioFile>, Failure> {
    let scenario = Library::new().scenario(&args.scenario)?;
    Ok((args.robots > 1 || !scenario.fleet.is_empty()).then_some(scenario))
}

/// The simulated robot.
fn simulated(args: &mut LabArgs) -> Result<SimulatedRobot, Failure> {
    // The page's sketches may want them too.
    sketch::take_libraries(&std::mem::take(&mut args.image.libraries))?;
    let robot = args.setting.robot.as_deref();
    args.image.compile(robot, Some(&args.scenario))?;
    let mut robot = SimulatedRobot::new(overrides(args), choice(args, &args.scenario))?;
    robot.take_sketches(workshop::SKETCHES);
    if let (Some(given), Some(board)) = (args.image.given(), robot.chip_board()) {
        let watch = |path| Workshop::watch(path, board).map(|it| Box::new(it) as _);
        let workshop = args.image.watched().map(watch).transpose();
        let program = OwnProgram::new(&given, workshop.map_err(Failure::input)?);
        robot.own_program(program.from_source(move || workshop::files(&given)));
    }
    if let Some(port) = args.gdb {
        robot.debug(debugging(port, args)?);
    }
    #[cfg(unix)]
    if args.usb_pty {
        let board = robot.chip_board().unwrap_or_default();
        robot.plug_in(Box::new(crate::pty::UsbPort::offer(board.title)?));
    }
    Ok(robot)
}

fn choice(args: &LabArgs, scenario: &str) -> Choice {
    Choice {
        scenario: scenario.to_owned(),
        world: args.setting.world.clone(),
        rig: args.setting.rig.clone(),
        seed: args.seed.seed,
    }
}

fn overrides(args: &LabArgs) -> Overrides {
    Overrides {
        robot: args.setting.robot.clone(),
        policy: args.setting.policy.clone(),
        ..args.image.overrides()
    }
}

fn config(args: &LabArgs) -> LabConfig {
    LabConfig {
        at: args.session.serve.at(),
        speed: args.speed,
        recording: logs::recording(args.session.out.as_deref()),
        echo: None,
        tuner: Some(tune::in_dashboard(
            args.setting.robot.as_deref(),
            &args.scenario,
        )),
        wired: Some(wired::answer),
    }
}

/// Several robots in one world: those of the scenario, or as many as asked for.
fn several(args: &mut LabArgs, scenario: &ScenarioFile) -> Result<Vec<SimulatedRobot>, Failure> {
    #[cfg(unix)]
    let alone = args.pty || args.usb_pty || args.gdb.is_some();
    #[cfg(not(unix))]
    let alone = args.gdb.is_some();
    if alone {
        return Err(Failure::Input(
            "--gdb, --pty and --usb-pty are for one robot; leave --robots out, and choose a scenario with one robot".into(),
        ));
    }
    let kind = args.setting.robot.as_deref();
    args.image.compile(kind, Some(&args.scenario))?;
    if args.robots > 1 && !scenario.fleet.is_empty() {
        return Err(Failure::Input(format!(
            "--robots {}: scenario {} has robots of its own; leave --robots out",
            args.robots, scenario.name
        )));
    }
    let library = Library::new().beside(&args.scenario);
    let library = library.holding(Kind::Scenario, &scenario.name, &scenario.text);
    let choice = choice(args, &scenario.name);
    let robots = args.robots.into();
    Ok(SimulatedRobot::all(
        library,
        overrides(args),
        &choice,
        robots,
    )?)
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
    let image = args.image.firmware.as_deref();
    let image = image.map(output::quoted).unwrap_or_default();
    output::aside(&format!(
        "a debugger may come at any time: avr-gdb {image} -ex 'target remote :{port}'"
    ));
    Ok(debugging)
}
