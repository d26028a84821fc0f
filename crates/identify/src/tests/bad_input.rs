//! Logs with damage, of two robots, or too short.

use super::{exercise, fitted, log, message, recorded};
use crate::{DriveLog, IdentifyError};
use rumbo_plant::params::Params;
use std::path::Path;

fn named(name: &str, text: &str) -> DriveLog {
    DriveLog::parse(Path::new(name), text.as_bytes()).unwrap()
}

#[test]
fn a_damaged_row_is_left_out_and_named() {
    let whole = recorded(&Params::default(), exercise, 9.0);
    let mut lines: Vec<&str> = whole.lines().collect();
    lines[30] = "41,fast,0,60,5,1,1";
    lines[50] = "41,1";
    let log = log(&lines.join("\n"));
    let said: Vec<String> = log.damaged.iter().map(ToString::to_string).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(
        said[0].contains("line 31, column speed_a_rpm: `fast`"),
        "{said:?}"
    );
    assert!(said[1].contains("line: 51"), "{said:?}");
    assert_eq!(log.rows.len(), lines.len() - 3);
    // The damaged row took its time.
    assert_eq!(log.rows[29].at_ms - log.rows[28].at_ms, 82);
}

#[test]
fn a_log_of_mostly_damaged_rows_is_refused() {
    let whole = recorded(&Params::default(), exercise, 3.0);
    let rows = whole.lines().enumerate();
    let rows = rows.map(|(i, row)| {
        if i > 0 && i % 5 == 0 {
            "41,x,0,60,5,1,1"
        } else {
            row
        }
    });
    let text: Vec<&str> = rows.collect();
    assert!(message(&text.join("\n")).contains("line 6, column speed_a_rpm: `x`"));
}

#[test]
fn logs_of_two_robots_are_refused_and_both_are_named() {
    let mut other = Params::default();
    other.motor.back_emf_v_s *= 1.5;
    other.wheels.left.coulomb_forward_n_m *= 2.0;
    let logs = [
        named("monday.csv", &recorded(&Params::default(), exercise, 9.0)),
        named("other.csv", &recorded(&other, exercise, 9.0)),
    ];
    let error = fitted(&logs).unwrap_err();
    assert!(
        matches!(error, IdentifyError::Contradiction { .. }),
        "{error}"
    );
    let said = error.to_string();
    assert!(
        said.contains("monday.csv") && said.contains("other.csv"),
        "{said}"
    );
}

#[test]
fn logs_of_two_wirings_are_refused() {
    // One wheel pushed harder than the other, and the columns of the motors swapped in the second log.
    let uneven = |at_s: f64| {
        let [left, right] = exercise(at_s);
        [0.8 * left, 1.2 * right]
    };
    let text = recorded(&Params::default(), uneven, 3.0);
    let swapped = text.replacen("pwm_a,pwm_b", "pwm_b,pwm_a", 1);
    let logs = [named("right.csv", &text), named("swapped.csv", &swapped)];
    let error = fitted(&logs).unwrap_err();
    assert!(
        matches!(error, IdentifyError::Contradiction { .. }),
        "{error}"
    );
}

#[test]
fn logs_of_two_days_of_one_robot_are_not_contradictory() {
    let mut tuesday = Params::default();
    tuesday.battery.open_circuit_v = 6.9;
    tuesday.floor.friction_scale = 1.15;
    let logs = [
        named("monday.csv", &recorded(&Params::default(), exercise, 9.0)),
        named("tuesday.csv", &recorded(&tuesday, exercise, 9.0)),
    ];
    let found = fitted(&logs).unwrap();
    let volts = [0, 1].map(|i| found.runs[i].nuisance.battery_v);
    assert!(volts[0] > volts[1], "{volts:?}");
}

#[test]
fn a_monotonous_log_says_what_it_hardly_shows_and_which_experiment_does() {
    let run = [log(&recorded(&Params::default(), |_| [90.0, 90.0], 6.0))];
    let found = fitted(&run).unwrap();
    let said = found.to_string();
    let line = |key: &str| {
        let mut lines = said
            .lines()
            .filter(|line| line.starts_with("these runs hardly show"));
        lines.any(|line| line.contains(key) && line.contains("; what does: "))
    };
    assert!(line("wheels.left.coulomb_backward_n_m"), "{said}");
    assert!(line("floor.scrub_n_m"), "{said}");
}
