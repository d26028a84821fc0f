//! Logs as messages.

use rumbo_log::{Log, MapPose, Row, Scene};
use rumbo_ros::convert::{ConvertError, messages};
use rumbo_ros::topics::Topic;

/// A log of rows with these poses and origins: x [m].
fn log(rows: &[(f64, f64)]) -> Log {
    let rows = rows.iter().zip(0..).map(|((x_m, origin_m), number)| {
        let mut row = Row::unknown(40 * number);
        let at = |x_m| MapPose {
            x_m,
            ..MapPose::default()
        };
        row.set_pose("", at(*x_m));
        row.set_pose("origin_", at(*origin_m));
        row
    });
    let mut log = Log::default();
    log.rows = rows.collect();
    log.scene = Some(Scene {
        base_m: 0.1,
        wheel_radius_m: 0.03,
        ..Scene::default()
    });
    log
}

#[test]
fn a_log_that_tells_too_little_is_refused_with_what_is_missing() {
    assert!(matches!(
        messages(&Log::default(), false),
        Err(ConvertError::NoTelemetry)
    ));
    let mut log = log(&[(0.0, 0.0)]);
    log.scene = None;
    assert!(matches!(
        messages(&log, false),
        Err(ConvertError::NoGeometry)
    ));
}

#[test]
fn the_pose_in_odom_goes_on_where_the_robot_moves_its_origin() {
    // At its goal, 1 m ahead, it begins to count from there; the world has it 2 cm short of that.
    let log = log(&[(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (0.0, 0.98), (0.1, 0.98)]);
    let all = messages(&log, false).unwrap();
    let odometry = all.iter().filter(|sent| sent.topic == Topic::Odometry);
    // The place is the first of the message's numbers of eight bytes, after header and frames.
    let x_m: Vec<f64> = odometry
        .map(|sent| f64::from_le_bytes(sent.data[44..52].try_into().unwrap()))
        .collect();
    for (x_m, expected_m) in x_m.iter().zip([0.0, 0.5, 1.0, 1.0, 1.1]) {
        assert!((x_m - expected_m).abs() < 1e-6, "{x_m}");
    }
}
