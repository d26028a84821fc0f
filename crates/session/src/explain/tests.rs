use super::*;

/// Five seconds of telemetry with what `set` gives at each time [s].
fn rows(set: impl Fn(f64, &mut Row)) -> Vec<Row> {
    let row = |index: i64| {
        let mut row = Row::unknown(40 * index);
        set(0.04 * index as f64, &mut row);
        row
    };
    (0..125).map(row).collect()
}

fn found(rows: &[Row], events: &[LoggedEvent]) -> Vec<(CauseKind, String)> {
    let all = causes((rows, &[], events), BTreeMap::new(), 0.0, 5.0);
    all.into_iter()
        .map(|cause| (cause.kind, cause.text))
        .collect()
}

fn said(t_s: f64, level: Level, text: &str) -> LoggedEvent {
    LoggedEvent {
        t_s,
        level,
        text: text.into(),
    }
}

#[test]
fn a_restart_explains_more_than_the_fault_and_the_stop_that_follow() {
    let dipped = "the robot's program started again: the supply dipped; it needs a new ON";
    let events = [
        said(1.0, Level::Info, "sent: STOP"),
        said(0.9, Level::Fault, "fault: link lost"),
        said(0.8, Level::Warning, dipped),
        said(0.1, Level::Info, "sent: ON"),
        said(7.0, Level::Fault, "fault: beyond the stretch"),
    ];
    let kinds: Vec<CauseKind> = found(&[], &events).iter().map(|(kind, _)| *kind).collect();
    assert_eq!(
        kinds,
        [CauseKind::Restart, CauseKind::Fault, CauseKind::Stopped]
    );
}

#[test]
fn a_wheel_that_stands_is_held_at_a_high_pwm_and_in_its_dead_zone_at_a_low_one() {
    for (pwm, kind) in [(200.0, CauseKind::Held), (40.0, CauseKind::DeadZone)] {
        let rows = rows(|t_s, row| {
            let stands = (1.0..1.5).contains(&t_s);
            row.set("left_pwm", pwm);
            row.set("true_left_rad_s", if stands { 0.0 } else { 6.0 });
            row.set("left_rad_s", if stands { 0.0 } else { 6.0 });
        });
        let found = found(&rows, &[]);
        assert_eq!((found.len(), found[0].0), (1, kind), "{found:?}");
    }
}

#[test]
fn a_sonar_that_hears_nothing_of_a_wall_is_told_with_where_the_wall_was() {
    let rows = rows(|t_s, row| {
        let deaf = (2.0..2.6).contains(&t_s);
        row.set("true_range_left_m", 0.8);
        row.set("range_left_m", if deaf { f64::INFINITY } else { 0.8 });
    });
    let told = "the left sonar heard nothing for 0.56 s, though something was at 80.0 cm";
    assert_eq!(found(&rows, &[]), [(CauseKind::Sonar, told.to_owned())]);
}

#[test]
fn of_a_real_robot_whose_truth_nobody_knows_nothing_is_said_of_its_sensors() {
    let rows = rows(|t_s, row| {
        row.set("range_left_m", if t_s < 2.0 { 0.8 } else { 2.4 });
        row.set("left_rad_s", 6.0 * t_s);
        row.set("left_pwm", 100.0);
    });
    assert_eq!(found(&rows, &[]), []);
}
