//! The report's own program on the plant: it drives much like the report's robot. The recorded runs are one robot on
//! one day; the medians of 20 drawn robots are near them.

use super::{RPM, seeds};
use rumbo_experiment::files::{Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run};
use rumbo_wire::{EventKind, FromRobot};

fn baseline(scenario: &str) -> Setup {
    let overrides = Overrides {
        program: NativeProgram::Baseline,
        ..Overrides::default()
    };
    Library::new().setup(scenario, &overrides).unwrap()
}

/// The median of a metric; an event that never happened counts as infinitely late.
fn median(runs: &[RunResult], metric: &str) -> f64 {
    let mut values: Vec<f64> = runs.iter().map(|run| run.metrics[metric]).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn assert_within(value: f64, range: std::ops::RangeInclusive<f64>) {
    assert!(range.contains(&value), "{value} is not within {range:?}");
}

#[test]
fn the_baseline_takes_about_3_s_to_30_cm_from_a_wall_at_15_passes_a_second() {
    let runs = seeds(&baseline("mode1"), 1..21);
    // Recorded: 3.0 s, then 1.2 s; 65.5 ms a pass.
    assert_within(median(&runs, "step1.settling_s"), 2.2..=3.8);
    assert_within(median(&runs, "step2.settling_s"), 0.8..=2.5);
    assert_within(median(&runs, "control_period_s"), 0.065_2..=0.065_8);
}

#[test]
fn the_baseline_keeps_to_its_wall_within_5_cm() {
    let runs = seeds(&baseline("mode3"), 1..21);
    // Recorded: 1.2 cm rms, 4.6 cm at worst; 70.7 ms a pass.
    assert_within(median(&runs, "control_period_s"), 0.070_4..=0.071_0);
    assert_within(median(&runs, "distance_rms_m"), 0.008..=0.03);
    assert_within(median(&runs, "distance_worst_m"), 0.02..=0.07);
}

#[test]
fn the_baseline_reaches_its_four_goals_in_about_32_s() {
    let mut setup = baseline("mode8-goals");
    setup.scenario.duration_s = 60.0;
    let runs = seeds(&setup, 1..21);
    // Recorded: 32 s, 4.3 m.
    assert_within(median(&runs, "total_time_s"), 26.0..=38.0);
    assert_within(median(&runs, "path_m"), 4.1..=4.7);
}

#[test]
fn the_baseline_drives_all_four_straights_of_the_lane_on_many_robots_but_not_on_all() {
    let mut setup = baseline("mode8-lane");
    setup.scenario.duration_s = 120.0;
    let mut finished: Vec<f64> = seeds(&setup, 1..21)
        .iter()
        .map(|run| run.metrics["finish_s"])
        .filter(|finish_s| finish_s.is_finite())
        .collect();
    finished.sort_by(f64::total_cmp);
    // Recorded: 57.8 s. On the others it does not come to the end in 120 s.
    assert!((7..=15).contains(&finished.len()), "{finished:?}");
    assert_within(finished[0], 55.0..=75.0);
}

#[test]
fn the_baseline_takes_about_4_s_to_a_wheel_speed_and_ripples_by_1_to_2_rpm() {
    let runs = seeds(&baseline("mode5"), 1..21);
    // Recorded: 3.7, 1.8, 5.3 and 5.5 s; ripple 0.9 to 2.1 rpm; 41 ms a pass.
    for step in ["step1", "step3", "step6", "step9"] {
        assert_within(median(&runs, &format!("{step}.settling_s")), 1.5..=6.0);
        assert_within(
            median(&runs, &format!("{step}.ripple_rad_s")) / RPM,
            0.6..=2.5,
        );
    }
    assert_within(median(&runs, "control_period_s"), 0.038..=0.048);
}

#[test]
fn the_baseline_drives_a_square_in_about_30_s_and_5_cm_beside_it_by_its_odometry() {
    let mut setup = baseline("mode7");
    setup.scenario.duration_s = 60.0;
    let runs = seeds(&setup, 1..21);
    // Recorded: 30 s, 6 cm; 67 ms a pass.
    assert_within(median(&runs, "finish_s"), 24.0..=40.0);
    assert_within(median(&runs, "odometry_worst_m"), 0.02..=0.10);
    assert_within(median(&runs, "control_period_s"), 0.060..=0.072);
}

#[test]
fn the_baseline_s_loop_of_mode_8_stands_while_its_servo_steps() {
    let mut setup = baseline("mode8-random");
    setup.scenario.duration_s = 30.0;
    let result = run(&setup, 1).unwrap();
    let telemetry = result
        .trace
        .messages
        .iter()
        .filter(|message| matches!(message.what, FromRobot::Telemetry(_)));
    let times: Vec<f64> = telemetry.map(|message| message.t_s).collect();
    let gaps: Vec<f64> = times.windows(2).map(|two| two[1] - two[0]).collect();
    // Recorded: 82 to 91 ms driving, 317 ms a step of a sweep.
    assert!(gaps.iter().any(|gap| (0.08..0.1).contains(gap)));
    assert!(gaps.iter().any(|gap| (0.30..0.33).contains(gap)));
}

#[test]
fn the_baseline_goes_to_a_goal_nothing_stands_before() {
    let mut setup = baseline("mode8-random");
    setup.scenario.duration_s = 30.0;
    let reached = (1..21).filter(|&seed| {
        let result = run(&setup, seed).unwrap();
        result.metrics["blocked"] == 0.0
            && result.trace.messages.iter().any(|message| {
                matches!(message.what, FromRobot::Event(event) if event.kind == EventKind::Reached)
            })
    });
    assert!(reached.count() >= 2);
}

#[test]
fn the_baseline_is_refused_where_it_has_no_program() {
    for (scenario, mode) in [
        ("manual-straight", "manual"),
        ("mode2-final", "front_align"),
    ] {
        let error = run(&baseline(scenario), 1).unwrap_err().to_string();
        assert!(
            error.contains(mode) && error.contains("leave out the program baseline"),
            "{error}"
        );
    }
}

#[test]
fn a_seed_of_the_baseline_is_one_run_bit_for_bit() {
    let setup = baseline("mode7");
    assert_eq!(run(&setup, 5).unwrap().trace, run(&setup, 5).unwrap().trace);
}
