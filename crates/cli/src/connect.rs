//! `rumbo connect`: a real robot behind the station's dashboard.

use crate::args::ConnectArgs;
use crate::browser;
use crate::calibrate;
use crate::failure::Failure;
use crate::ghost::WithGhost;
use crate::logs;
use crate::output;
use rumbo_session::Target;
use rumbo_station::port::{self, Port};
use rumbo_station::{Extras, Lab, LabConfig};

/// Opens the port, serves the dashboard, and shows it.
pub(crate) fn connect(args: &ConnectArgs) -> Result<(), Failure> {
    browser::show(serve(args)?, args.session.serve)
}

/// Opens the port and serves the dashboard.
fn serve(args: &ConnectArgs) -> Result<Lab, Failure> {
    if !args.address.starts_with(port::TCP) {
        let warning = rumbo_session::check_baud(args.baud)
            .map_err(|error| Failure::Input(format!("--baud: {error}")))?;
        if let Some(warning) = warning {
            output::note(&warning);
        }
    }
    let robot = Port::open(&args.address, args.baud).map_err(Failure::input)?;
    let config = LabConfig {
        at: args.session.serve.at(),
        speed: 1.0,
        recording: logs::recording(args.session.out.as_deref()),
        echo: Some(output::aside),
        tuner: None,
        wired: None,
    };
    let robot: Box<dyn Target> = match &args.ghost {
        Some(scenario) => Box::new(WithGhost::new(robot, scenario)?),
        None => Box::new(robot),
    };
    let extras = Extras {
        text: args.text,
        ..calibrate::in_dashboard()
    };
    rumbo_station::serve_all(config, vec![(String::new(), robot)], extras).map_err(Failure::input)
}
