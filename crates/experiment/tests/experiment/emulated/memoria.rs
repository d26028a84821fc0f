//! `examples/arduino/memoria` on the plant: every mode drives as the report's program does in its native form, on the same robot.

use super::rig::image;
use rumbo_experiment::files::{Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run};
use rumbo_sim::trace::TruthSample;
use rumbo_wire::FromRobot;

/// rad/s in one rpm.
const RPM: f64 = std::f64::consts::TAU / 60.0;

fn setup(scenario: &str, duration_s: f64, overrides: Overrides) -> Setup {
    let mut setup = Library::new().setup(scenario, &overrides).unwrap();
    setup.scenario.duration_s = duration_s;
    setup
}

/// The first seconds of a scenario, with the sketch and natively; `None` where the sketches have not been built.
fn both(scenario: &str, sketch: &str, duration_s: f64) -> Option<[RunResult; 2]> {
    let on_the_chip = Overrides {
        firmware: Some(image(&format!("memoria-{sketch}"))?),
        ..Overrides::default()
    };
    let natively = Overrides {
        program: NativeProgram::Baseline,
        ..Overrides::default()
    };
    let results = [on_the_chip, natively]
        .map(|overrides| run(&setup(scenario, duration_s, overrides), 1).unwrap());
    let ran_s = end(&results[0]).t_s;
    assert!(
        (ran_s - duration_s).abs() < 0.02,
        "{:?}",
        results[0].failures
    );
    let strange = results[0]
        .notes
        .iter()
        .find(|note| note.to_string().contains("register"));
    assert_eq!(strange, None);
    Some(results)
}

fn end(result: &RunResult) -> TruthSample {
    *result.trace.samples.last().unwrap()
}

/// How far the two robots are from each other in the end [m].
fn apart_m([chip, native]: &[RunResult; 2]) -> f64 {
    let (a, b) = (end(chip), end(native));
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m)
}

/// How far the robot is from where it started [m].
fn way_m(result: &RunResult) -> f64 {
    let (a, b) = (result.trace.samples[0], end(result));
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m)
}

/// Mean period of the lines of telemetry [s], without those of standing still.
fn period_s(result: &RunResult) -> f64 {
    let times = result.trace.messages.iter();
    let times: Vec<f64> = times.map(|message| message.t_s).collect();
    let steps = times.windows(2).map(|two| two[1] - two[0]);
    let steps: Vec<f64> = steps.filter(|step| *step < 0.2).collect();
    steps.iter().sum::<f64>() / steps.len() as f64
}

/// States in the telemetry, each change once.
fn states(result: &RunResult) -> Vec<u8> {
    let messages = result.trace.messages.iter();
    let mut states: Vec<u8> = messages
        .filter_map(|message| match message.what {
            FromRobot::Telemetry(telemetry) => Some(telemetry.state),
            _ => None,
        })
        .collect();
    states.dedup();
    states
}

#[test]
fn mode_2_drives_up_to_the_wall() {
    let Some(results) = both("mode2", "mode2", 2.5) else {
        return;
    };
    assert!(way_m(&results[0]) > 0.5, "{}", way_m(&results[0]));
    assert!(apart_m(&results) < 0.1, "{}", apart_m(&results));
    // 60 ms of delay, two echoes, and the call.
    let period_s = period_s(&results[0]);
    assert!((0.066..0.082).contains(&period_s), "{period_s}");
}

#[test]
fn modes_3_and_4_drive_along_the_wall() {
    for (scenario, sketch) in [("mode3", "mode3"), ("mode4", "mode4")] {
        let Some(results) = both(scenario, sketch, 5.0) else {
            return;
        };
        assert!(way_m(&results[0]) > 0.35, "{}", way_m(&results[0]));
        assert!(apart_m(&results) < 0.15, "{}", apart_m(&results));
        assert_eq!(results[0].metrics["contacts"], 0.0);
        let period_s = period_s(&results[0]);
        assert!((0.066..0.095).contains(&period_s), "{period_s}");
    }
}

#[test]
fn mode_5_brings_both_wheels_to_60_rpm() {
    let Some(results) = both("mode5", "mode5", 5.4) else {
        return;
    };
    let metrics = results.each_ref().map(|result| &result.metrics);
    let [chip_s, native_s] = metrics.map(|metrics| metrics["step1.settling_s"]);
    assert!((chip_s - native_s).abs() < 0.6, "{chip_s} {native_s}");
    for wheel_rad_s in end(&results[0]).wheel_rad_s {
        let rpm = wheel_rad_s / RPM;
        assert!((rpm - 60.0).abs() < 4.0, "{rpm}");
    }
    // A line of 36 to 40 bytes at 960 bytes a second sets the period.
    let period_s = period_s(&results[0]);
    assert!((0.036..0.042).contains(&period_s), "{period_s}");
}

#[test]
fn mode_6_drives_straight_on() {
    let Some(results) = both("mode6", "mode6", 8.0) else {
        return;
    };
    assert!(way_m(&results[0]) > 0.7, "{}", way_m(&results[0]));
    assert!(apart_m(&results) < 0.05, "{}", apart_m(&results));
    assert!(end(&results[0]).heading_rad.abs() < 0.15);
}

#[test]
fn mode_7_drives_to_the_first_corner_and_turns() {
    let Some(results) = both("mode7", "mode7", 9.0) else {
        return;
    };
    let corner = results[0].trace.samples.iter();
    let nearest_m = corner
        .map(|sample| (sample.x_m - 1.0).hypot(sample.y_m))
        .fold(f64::INFINITY, f64::min);
    assert!(nearest_m < 0.15, "{nearest_m}");
    let turned = end(&results[0]).heading_rad.to_degrees();
    assert!((75.0..110.0).contains(&turned), "{turned}");
    let period_s = period_s(&results[0]);
    assert!((0.058..0.070).contains(&period_s), "{period_s}");
}

#[test]
fn mode_8_turns_to_its_goal_and_gets_there() {
    let Some(results) = both("mode8-goals", "mode8", 20.0) else {
        return;
    };
    // Initialise, first turn, go; and wait for the next goal.
    let states = states(&results[0]);
    assert_eq!(states[..4], [2, 1, 3, 0]);
    assert!(results[0].metrics["goal1.error_m"] < 0.2);
    let period_s = period_s(&results[0]);
    assert!((0.080..0.095).contains(&period_s), "{period_s}");
}

#[test]
fn mode_8_finds_the_box_and_looks_to_both_sides() {
    let Some(results) = both("mode8-obstacles", "mode8", 32.0) else {
        return;
    };
    // Go, both sweeps, decide, turn, seek.
    let states = states(&results[0]);
    let sweep = states.iter().position(|state| *state == 4).unwrap();
    assert_eq!(states[sweep - 1..sweep + 5], [3, 4, 5, 6, 7, 8]);
    let samples = &results[0].trace.samples;
    let angles = samples.iter().map(|sample| sample.servo_rad.to_degrees());
    let (right, left) = angles.fold((0.0, 0.0), |(right, left): (f64, f64), angle| {
        (right.min(angle), left.max(angle))
    });
    assert!(right < -10.0 && left > 10.0, "{right} {left}");
    // The report's program turns beside the box; it may graze it.
    assert!(results[0].metrics["contact_speed_m_s"] < 0.1);
}

#[test]
fn the_lane_is_swept_and_turned_into() {
    let Some(results) = both("mode8-lane", "lane", 22.0) else {
        return;
    };
    let states = states(&results[0]);
    assert_eq!(states[..4], [0, 1, 2, 3]);
    assert_eq!(results[0].metrics["contacts"], 0.0);
    assert!(way_m(&results[0]) > 0.3);
}
