//! A front sonar with false readings stops the robot before it touches anything, or lets it touch gently; a sound one
//! is trusted.

use rumbo_experiment::campaign::faults::{Verdict, drive_all};
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
    let verdict = Verdict::of(&drives);
    println!("{verdict:?}");
    for drive in drives.iter().filter(|drive| drive.touch.is_some()) {
        println!("{drive:?}");
    }
    assert!(verdict.runs > 60);
    assert_eq!(verdict.hard, 0);
    assert!(verdict.touches <= verdict.runs / 20);
}
