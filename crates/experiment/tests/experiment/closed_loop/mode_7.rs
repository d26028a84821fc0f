//! Mode 7: routes by odometry, with turn - drive - turn and with pure pursuit.

use super::*;
use rumbo_control::mode::ModeId;
use rumbo_wire::EventKind;
use rumbo_wire::message::Waypoint;

#[test]
fn the_square_is_driven_within_2_5_cm_of_itself_by_odometry_and_in_20_s() {
    let runs = twenty("mode7");
    assert!(worst(&runs, "odometry_worst_m") <= 0.025);
    assert!(worst(&runs, "finish_s") <= 20.0);
    assert_eq!(worst(&runs, "contacts"), 0.0);
}

#[test]
fn a_robot_that_has_calibrated_itself_closes_the_square_within_5_cm_and_others_do_not() {
    let mut setup = setup("mode7");
    assert!(worst(&driven("mode7"), "end_error_m") <= 0.05);
    setup.scenario.calibrated = false;
    assert!(worst(&seeds(&setup, 1..51), "end_error_m") > 0.1);
}

#[test]
fn pure_pursuit_drives_a_curve_without_stopping_and_nearer_to_it_than_the_baseline_to_its_square() {
    for scenario in ["pursuit-line", "pursuit-curve"] {
        let runs = seeds(&setup(scenario), 1..21);
        assert!(worst(&runs, "odometry_worst_m") <= 0.03, "{scenario}");
        assert!(worst(&runs, "odometry_rms_m") <= 0.015, "{scenario}");
        for run in &runs {
            // Where a wheel slows down to the end it may cross a bound twice: in between half of it counts.
            let faster = |sample: &rumbo_sim::trace::TruthSample, than_rad_s: f64| {
                sample.wheel_rad_s.iter().all(|rad_s| *rad_s > than_rad_s)
            };
            let samples = &run.trace.samples;
            let first = samples.iter().position(|s| faster(s, 1.0)).unwrap();
            let last = samples.iter().rposition(|s| faster(s, 1.0)).unwrap();
            assert!(
                samples[first..last].iter().all(|s| faster(s, 0.5)),
                "{scenario}, seed {}",
                run.seed
            );
        }
    }
}

/// A person whose robot is armed in mode 7, with nothing to do.
fn waiting() -> Person {
    let mut person = Person::at("mode7");
    person.wait_s(0.5);
    let none = Command::Route {
        repeat: false,
        relative: false,
    };
    for command in [Command::Mode(ModeId::Waypoints), none, Command::Arm] {
        person.command(command);
        person.wait_s(0.2);
    }
    person
}

fn waypoint(x_m: f32, y_m: f32, heading_rad: Option<f32>) -> Command {
    Command::Waypoint(Waypoint {
        x_m,
        y_m,
        heading_rad,
    })
}

/// Distance of the robot from a position [m].
fn off_m(person: &Person, x_m: f64, y_m: f64) -> f64 {
    let pose = person.sim.truth().pose;
    (pose.x_m - x_m).hypot(pose.y_m - y_m)
}

fn reports_reached(received: &[FromRobot]) -> bool {
    received.iter().any(
        |message| matches!(message, FromRobot::Event(event) if event.kind == EventKind::Reached),
    )
}

#[test]
fn an_empty_route_waits_and_a_waypoint_starts_it() {
    let mut person = waiting();
    let received = person.wait_s(1.0);
    assert!(off_m(&person, 0.0, 0.0) < 1e-3 && !reports_reached(&received));
    person.command(waypoint(0.5, 0.0, Some(1.0)));
    let received = person.wait_s(5.0);
    assert!(reports_reached(&received));
    assert!(off_m(&person, 0.5, 0.0) < 0.03);
    let heading_rad = person.sim.truth().pose.heading_rad;
    assert!((heading_rad - 1.0).abs() < 0.08, "{heading_rad}");
}

#[test]
fn a_goal_on_the_way_takes_the_place_of_the_route() {
    let mut person = waiting();
    person.command(waypoint(2.0, 0.0, None));
    person.wait_s(2.5);
    assert!(person.sim.truth().forward_m_s > 0.3, "on its way");
    person.command(Command::Goal { x_m: 0.0, y_m: 0.5 });
    let received = person.wait_s(8.0);
    assert!(reports_reached(&received));
    let off_m = off_m(&person, 0.0, 0.5);
    assert!(off_m < 0.08, "{off_m}");
}

#[test]
fn a_new_route_on_the_way_stops_the_robot_until_it_has_a_waypoint() {
    let mut person = waiting();
    person.command(waypoint(2.0, 0.0, None));
    person.wait_s(2.5);
    person.command(Command::Route {
        repeat: false,
        relative: true,
    });
    person.wait_s(2.0);
    let before = person.sim.truth();
    assert_eq!(before.wheel_rad_s, [0.0; 2]);
    person.command(waypoint(-0.3, 0.0, None));
    person.wait_s(5.0);
    let (sin, cos) = before.pose.heading_rad.sin_cos();
    let (x_m, y_m) = (before.pose.x_m - 0.3 * cos, before.pose.y_m - 0.3 * sin);
    assert!(
        off_m(&person, x_m, y_m) < 0.03,
        "as seen from where it stood"
    );
}

#[test]
fn a_waypoint_out_of_range_is_refused_and_the_route_goes_on() {
    let mut person = waiting();
    person.command(waypoint(0.8, 0.0, None));
    person.wait_s(1.0);
    for wrong in [waypoint(f32::NAN, 0.0, None), waypoint(0.0, 50.0, None)] {
        person.command(wrong);
        let received = person.wait_s(0.3);
        assert!(
            received
                .iter()
                .any(|message| matches!(message, FromRobot::Ack(ack) if ack.result.is_err()))
        );
    }
    person.wait_s(4.0);
    assert!(off_m(&person, 0.8, 0.0) < 0.03);
}
