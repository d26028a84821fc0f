//! A hand that carries the robot.

use rumbo_experiment::files::{Library, Overrides};
use rumbo_lab::{HAND, type_to};

#[test]
fn the_robot_is_put_down_where_there_is_room_and_nowhere_else() {
    let library = Library::new();
    let setup = library.setup("mode1", &Overrides::default()).unwrap();
    let mut sim = setup.sim(1).unwrap();
    let mut put = |line: &str| {
        assert!(type_to(&mut sim, HAND, line.as_bytes()));
        let at = sim.truth().pose;
        [at.x_m, at.y_m, at.heading_rad]
    };
    let there = [0.2, -0.1, 1.5];
    assert_eq!(put("robot=0.2 -0.1 1.5"), there);
    // In the wall, beyond reach, and what is no pose.
    let wrong = [
        "robot=1.2 0 0",
        "robot=1e6 0 0",
        "robot=0 0",
        "robot=0 0 nan",
        "box=0 0 0",
        "",
    ];
    for line in wrong {
        assert_eq!(put(line), there, "{line}");
    }
}
