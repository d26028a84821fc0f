//! What mode 8 promises.

use super::{seeds, setup, twenty, worst};

#[test]
fn four_goals_are_reached_in_24_s_within_4_cm_and_2_percent_of_the_way() {
    let runs = twenty("mode8-goals");
    assert!(runs.iter().all(|run| run.metrics["reached"] == 4.0));
    assert!(worst(&runs, "total_time_s") <= 24.0);
    for goal in 1..=4 {
        for run in &runs {
            let excess_m = run.metrics[&format!("goal{goal}.excess_m")];
            assert!(
                excess_m <= 0.0,
                "seed {}, goal {goal}: {excess_m}",
                run.seed
            );
        }
    }
}

#[test]
fn the_goal_behind_the_boxes_is_reached_in_35_s_and_3_6_m_without_a_touch() {
    let runs = twenty("mode8-obstacles");
    assert!(runs.iter().all(|run| run.metrics["reached"] == 1.0));
    assert!(worst(&runs, "total_time_s") <= 35.0);
    assert!(worst(&runs, "path_m") <= 3.6);
    assert_eq!(worst(&runs, "contacts"), 0.0);
}

#[test]
fn a_goal_in_a_random_world_is_reached_or_called_unreachable_rightly() {
    for run in seeds(&setup("mode8-random"), 1..41) {
        let metric = |name: &str| run.metrics[name];
        assert_eq!(metric("reached"), metric("reachable"), "seed {}", run.seed);
        assert_eq!(
            metric("unreachable_reported"),
            1.0 - metric("reachable"),
            "seed {}",
            run.seed
        );
        assert!(metric("time_s") <= 180.0, "seed {}", run.seed);
    }
}
