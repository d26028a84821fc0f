//! A front sonar with false readings stops the robot before it touches anything, or lets it touch gently; a sound one
//! is trusted.

use rumbo_experiment::campaign::faults::{DetectionSummary, drive_all};
use rumbo_experiment::files::Overrides;

/// Two seeds at three instants; about 2 % of the campaign of all failures (`cargo xtask campaign --only faults`).
#[test]
fn a_front_sonar_that_lies_drives_the_robot_into_nothing() {
    let lies = [
        "nothing in reach",
        "last answer",
        "30 % random",
        "100 % random",
    ];
    let drives = drive_all(&Overrides::default(), 1..3, 3, |drive, failure| {
        let failure = failure.to_string();
        let front = failure.starts_with("front sonar:");
        drive.starts_with("mode8") && front && lies.iter().any(|lie| failure.contains(lie))
    });
    let drives = drives.unwrap();
    let verdict = DetectionSummary::of(&drives);
    println!("{verdict:?}");
    for drive in drives.iter().filter(|drive| drive.touch.is_some()) {
        println!("{drive:?}");
    }
    assert!(verdict.runs > 60);
    assert_eq!(verdict.hard, 0);
    assert!(verdict.touches <= verdict.runs / 20);
}

/// Drives in which the silence of a side sonar beside an obstacle led to a fast touch.
#[test]
fn a_sonar_that_falls_silent_lets_the_robot_touch_gently_at_most() {
    let silent = [
        ("mode8-obstacles", 23, "right sonar: nothing in reach"),
        ("mode8-random", 1, "left sonar: nothing in reach"),
    ];
    for (scenario, seed, fails) in silent {
        let drives = drive_all(
            &Overrides::default(),
            seed..seed + 1,
            4,
            |drive, failure| drive == scenario && failure.to_string().starts_with(fails),
        );
        let verdict = DetectionSummary::of(&drives.unwrap());
        println!("{scenario}, seed {seed}, {fails}: {verdict:?}");
        assert!(verdict.runs >= 3);
        assert_eq!(verdict.hard, 0);
    }
}
