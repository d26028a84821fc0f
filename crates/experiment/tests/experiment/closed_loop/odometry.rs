//! The odometry's estimate of its error, against the true error.

use super::setup;
use rumbo_control::Pose;
use rumbo_control::odometry::{PathStep, Uncertainty};
use rumbo_control::params::Params;
use rumbo_experiment::files::Setup;
use rumbo_experiment::run::{prepare, run};
use rumbo_wire::FromRobot;

/// The pose in the last telemetry frame of a run, its covariance by the same theory as in the lab, and the true pose.
fn end_of(setup: &Setup, seed: u64) -> (Pose, [[f64; 3]; 3], [f64; 3]) {
    let mut params = Params::default();
    for (id, value) in &setup.scenario.parameters {
        params.set(*id, *value).unwrap();
    }
    let errors = params.odometry_errors();
    let result = run(setup, seed).unwrap();
    let (mut pose, mut uncertainty) = (Pose::default(), Uncertainty::default());
    for message in &result.trace.messages {
        let FromRobot::Telemetry(telemetry) = message.what else {
            continue;
        };
        let step = PathStep::between(&pose, &telemetry.pose, errors.base_m);
        uncertainty.advance(&errors, &step);
        pose = telemetry.pose;
    }
    let last = result.trace.samples.last().unwrap();
    let start = &setup.scenario.start;
    let (sin, cos) = start.heading_rad.sin_cos();
    let (dx, dy) = (last.x_m - start.x_m, last.y_m - start.y_m);
    let truth = [
        cos * dx + sin * dy,
        cos * dy - sin * dx,
        last.heading_rad - start.heading_rad,
    ];
    let covariance = uncertainty
        .covariance(&errors)
        .map(|row| row.map(f64::from));
    (pose, covariance, truth)
}

/// Square of an error in units of its covariance: 3 in the mean for three numbers with a correct covariance.
fn normalised(error: [f64; 3], covariance: [[f64; 3]; 3]) -> f64 {
    // Cholesky, row by row: L z = error; the result is |z|^2.
    let (mut l, mut z, mut sum) = ([[0.0; 3]; 3], [0.0; 3], 0.0);
    for i in 0..3 {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
            l[i][j] = if i == j {
                (covariance[i][i] - known).sqrt()
            } else {
                (covariance[i][j] - known) / l[j][j]
            };
        }
        let known: f64 = (0..i).map(|k| l[i][k] * z[k]).sum();
        z[i] = (error[i] - known) / l[i][i];
        sum += z[i] * z[i];
    }
    sum
}

/// Over the seeds: mean square of each error in units of its own deviation, and of all three in units of their covariance.
fn mean_squares(scenario: &str, calibrated: bool, seeds: u64) -> ([f64; 3], f64) {
    let mut setup = setup(scenario);
    setup.scenario.calibrated = calibrated;
    let (mut each, mut all) = ([0.0; 3], 0.0);
    for seed in 1..=seeds {
        let mut own = prepare(&setup, seed).unwrap().into_owned();
        own.scenario.calibrated = false;
        let (pose, covariance, truth) = end_of(&own, seed);
        let heading_rad = f64::from(pose.heading_rad);
        let turns = ((truth[2] - heading_rad) / std::f64::consts::TAU).round();
        let error = [
            f64::from(pose.x_m) - truth[0],
            f64::from(pose.y_m) - truth[1],
            heading_rad + std::f64::consts::TAU * turns - truth[2],
        ];
        for index in 0..3 {
            each[index] += error[index] * error[index] / covariance[index][index] / seeds as f64;
        }
        all += normalised(error, covariance) / 3.0 / seeds as f64;
    }
    (each, all)
}

#[test]
fn a_calibrated_robot_knows_how_far_its_pose_is_off() {
    for scenario in ["mode6", "mode7"] {
        let (each, all) = mean_squares(scenario, true, 60);
        println!("{scenario}, calibrated: {each:.2?}, together {all:.2}");
        assert!((0.7..1.4).contains(&all), "{scenario}: {all}");
    }
}

#[test]
fn an_uncalibrated_one_does_as_far_as_small_angles_go() {
    // Its heading is off by up to 25 degrees, where a covariance no longer describes the relation of x, y and heading;
    // and mode 6's x by the arc's second order. Each of the others alone has the variance that it claims.
    for (scenario, judged) in [("mode6", 1..3), ("mode7", 0..3)] {
        let (each, _) = mean_squares(scenario, false, 200);
        println!("{scenario}: {each:.2?}");
        for square in &each[judged] {
            assert!((0.7..1.45).contains(square), "{scenario}: {each:?}");
        }
    }
}
