//! The calibration of a simulated robot behind a session.
#![allow(clippy::unwrap_used, clippy::panic)]

use rumbo_experiment::files::Overrides;
use rumbo_lab::SimulatedRobot;
use rumbo_log::{CalibrationPhase, Choice, Entry, Level, Manifest};
use rumbo_session::{Event, Extras, Host, Order, SLICE_US, SessionDriver};
use rumbo_wire::GUEST_SESSION;

/// Draws the session of the calibration itself, and keeps what is shown of it.
#[derive(Default)]
struct Unlucky(Option<CalibrationPhase>);

impl Host for Unlucky {
    fn random_id(&mut self) -> u8 {
        GUEST_SESSION
    }

    fn publish(&mut self, event: Event) {
        if let Event::Entry(entry) = event
            && let Entry::State(state) = &*entry
        {
            self.0 = state.calibration.as_ref().map(|it| it.phase.clone());
        }
    }

    fn begin_run(&mut self, _: Manifest) -> Option<(Level, String)> {
        None
    }
}

#[test]
fn a_robot_calibrates_itself_whatever_session_the_station_draws() {
    let choice = Choice {
        scenario: "calibration".into(),
        world: None,
        rig: None,
        seed: 1,
    };
    let robot = SimulatedRobot::new(Overrides::default(), choice).unwrap();
    let extras = Extras {
        calibration: Some(rumbo_lab::calibration),
        ..Extras::default()
    };
    let mut driver = SessionDriver::new(Box::new(robot), Unlucky::default(), 1.0, extras);
    driver.begin(0);
    // The session has read all parameters when it begins.
    for slice in 0..180_000_000 / SLICE_US {
        let wall_us = slice * SLICE_US;
        driver.wall_passed(wall_us);
        while driver.slice(wall_us).unwrap() {}
        driver.update(wall_us);
        if wall_us == 10_000_000 {
            driver.obey([Order::Calibrate], wall_us).unwrap();
        }
    }
    let shown = &driver.host().0;
    assert!(
        matches!(shown, Some(CalibrationPhase::Done { .. })),
        "{shown:?}"
    );
}
