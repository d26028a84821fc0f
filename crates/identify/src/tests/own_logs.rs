//! Logs of our own program, cut into stretches.

use super::NOMINAL;
use crate::replay::{Correct, Replay};
use crate::{BATTERY, IN_THE_AIR, ON_THE_FLOOR, Stretches, stretches};
use rumbo_log::{Level, Log, LoggedEvent, Row};
use rumbo_plant::params::Params;
use std::path::Path;

/// A frame of mode 0 that drives, with ground truth that is far off.
fn frame(t_ms: i64, pwm: f64, speed_rad_s: f64) -> Row {
    let mut row = Row::unknown(t_ms);
    for (name, value) in [
        ("mode", 0.0),
        ("armed", 1.0),
        ("left_pwm", pwm),
        ("right_pwm", pwm),
        ("left_rad_s", speed_rad_s),
        ("right_rad_s", speed_rad_s),
        ("left_ref_rad_s", 0.0),
        ("right_ref_rad_s", 0.0),
        ("true_left_rad_s", 99.0),
        ("true_right_rad_s", 99.0),
    ] {
        row.set(name, value);
    }
    row
}

fn driven(times_ms: impl Iterator<Item = i64>) -> Vec<Row> {
    times_ms.map(|t_ms| frame(t_ms, 102.0, 6.0)).collect()
}

fn cut(rows: Vec<Row>, events: &[(f64, String)]) -> Stretches {
    let mut log = Log::default();
    log.rows = rows;
    let event = |(t_s, text): &(f64, String)| LoggedEvent {
        t_s: *t_s,
        level: Level::Info,
        text: text.clone(),
    };
    log.events = events.iter().map(event).collect();
    stretches(Path::new("logs/robot.mcap"), &log).unwrap()
}

#[test]
fn the_last_speed_of_a_prediction_changes_as_the_one_before() {
    let log = cut(driven(at(0, 4_000)), &[]).logs.remove(0);
    let replay = Replay::new(&log, &Params::default(), NOMINAL);
    let observed = replay.observe(Correct::Speeds);
    let last = log.rows.len() - 1;
    let span = replay.span(20, &observed[20], last);
    let [.., before, end] = &span[..] else {
        panic!("{} rows", span.len());
    };
    assert_eq!(end.row, last);
    for wheel in [0, 1] {
        let change_rad_s2 = end.slope_rad_s2[wheel] - before.slope_rad_s2[wheel];
        assert!(change_rad_s2.abs() < 1.0, "{change_rad_s2}");
    }
}

#[test]
fn a_wheel_that_starts_or_is_about_to_stand_has_too_few_edges() {
    let mut rows = driven(at(0, 4_000));
    for row in &mut rows {
        if row.t_ms < 1_000 || row.t_ms >= 3_000 {
            row.set("left_rad_s", 0.0);
        }
    }
    let log = cut(rows, &[]).logs.remove(0);
    let edgeless = |wheel: usize| -> Vec<usize> {
        let rows = log.rows.iter().enumerate();
        let rows = rows.filter(|(_, row)| row.edgeless[wheel]);
        rows.map(|(index, _)| index).collect()
    };
    // 6 rad/s and 40 ms are nearly two motor turns.
    assert_eq!(edgeless(0), [0, 25, 73, 74, 75]);
    assert_eq!(edgeless(1), [0, 1]);
}

fn at(from_ms: i64, until_ms: i64) -> impl Iterator<Item = i64> {
    (from_ms..until_ms).step_by(40)
}

#[test]
fn pwm_and_speed_of_a_frame_are_a_row_and_ground_truth_is_not_looked_at() {
    let found = cut(driven(at(5_000, 8_000)), &[]);
    let row = found.logs[0].rows[10];
    assert_eq!(row.duty, [0.4; 2]);
    assert_eq!(row.speed_rad_s, [6.0; 2]);
    // The mean of a motor turn, 131 mrad at 6 rad/s, up to the last edge; and the duty is older than its frame.
    assert_eq!(row.window[0].length_ms, 22);
    assert!(row.at_ms < row.measured_ms(), "{row:?}");
}

#[test]
fn lost_frames_and_a_clock_that_jumps_end_a_stretch() {
    let rows = [at(0, 3_000), at(3_200, 6_000), at(60_000, 63_000)];
    let found = cut(driven(rows.into_iter().flatten()), &[]);
    assert_eq!(found.logs.len(), 3);
    assert!(
        found.logs[2].name.contains("from 60.0 s"),
        "{}",
        found.logs[2].name
    );
}

#[test]
fn another_mode_and_a_robot_that_is_off_end_a_stretch() {
    let mut rows = driven(at(0, 12_000));
    for row in &mut rows {
        if row.t_ms >= 8_000 {
            row.set("mode", 5.0);
        } else if row.t_ms >= 3_000 {
            row.set("armed", 0.0);
            row.set("left_pwm", 0.0);
            row.set("right_pwm", 0.0);
        }
    }
    let found = cut(rows, &[]);
    assert_eq!(found.logs.len(), 2);
    // It rolls out for a second.
    assert!((3_900..4_300).contains(&found.logs[0].duration_ms()));
}

#[test]
fn events_say_when_the_wheels_are_in_the_air_and_what_the_battery_has() {
    let events = [
        (0.0, format!("{BATTERY}7.620")),
        (0.0, IN_THE_AIR.to_owned()),
        (4.0, ON_THE_FLOOR.to_owned()),
    ];
    let found = cut(driven(at(0, 8_000)), &events);
    let on_floor: Vec<bool> = found.logs.iter().map(|log| log.on_floor).collect();
    assert_eq!(on_floor, [false, true]);
    assert_eq!(found.logs[1].battery_v, Some((7.62, 0.03)));
}

#[test]
fn a_frame_without_speeds_is_left_out_and_named() {
    let mut rows = driven(at(0, 4_000));
    rows[50].set("left_rad_s", f64::NAN);
    let found = cut(rows, &[]);
    assert_eq!(found.logs.len(), 1);
    assert!(
        found.notes[0].contains("left out: 1, ") && found.notes[0].contains("2.00 s"),
        "{:?}",
        found.notes
    );
}

#[test]
fn a_log_that_never_drives_is_refused_with_the_remedy() {
    let mut log = Log::default();
    log.rows = vec![frame(0, 0.0, 0.0)];
    let error = stretches(Path::new("logs/robot.mcap"), &log).unwrap_err();
    assert!(
        error.to_string().contains("record a run with ON"),
        "{error}"
    );
}
