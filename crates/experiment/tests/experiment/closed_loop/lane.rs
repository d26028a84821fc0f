//! Mode 8: a lane of boxes.

use super::*;

#[test]
fn the_lane_of_the_report_is_driven_in_30_s_without_a_touch() {
    let runs = twenty("mode8-lane");
    assert!(worst(&runs, "finish_s") <= 30.0);
    assert_eq!(worst(&runs, "contacts"), 0.0);
    for run in &runs {
        let turns = ["turn1_rad", "turn2_rad", "turn3_rad"].map(|name| run.metrics[name] > 0.0);
        assert_eq!(turns, [true, false, false], "seed {}", run.seed);
    }
}
