//! A hand that carries the robot, and moves what is around it.

use rumbo_experiment::files::{Library, Overrides};
use rumbo_lab::{HAND, SimulatedRobot, type_to};
use rumbo_log::{Choice, ReadingSource};
use rumbo_session::Target;

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

/// The robot of a scenario, and what its hand does.
fn lab(scenario: &str) -> SimulatedRobot {
    let choice = Choice {
        scenario: scenario.into(),
        seed: 1,
        ..Choice::default()
    };
    SimulatedRobot::new(Overrides::default(), choice).unwrap()
}

fn front_m(robot: &SimulatedRobot) -> f64 {
    robot.truth().unwrap().range_m[2].unwrap()
}

#[test]
fn a_wall_that_is_moved_is_where_sonars_see_it_and_logs_have_it() {
    let mut robot = lab("mode1");
    let was_m = front_m(&robot);
    robot.type_in(HAND, "thing=0 0.4 0").unwrap();
    assert!((front_m(&robot) - was_m - 0.4).abs() < 1e-9);
    robot.advance(100_000).unwrap();
    let moved = robot
        .shown()
        .into_iter()
        .find(|(source, _)| *source == ReadingSource::Others);
    let (_, signals) = moved.unwrap();
    assert_eq!(signals[0], ("thing0_x_m".into(), 0.4));
    // Onto the robot, beyond reach, what there is not, and what is no place.
    let onto = format!("thing=0 {} 0", -was_m - 0.1);
    for line in [
        &*onto,
        "thing=0 1e6 0",
        "thing=7 0 0",
        "thing=-1 0 0",
        "thing=0 0",
        "thing=0 nan 0",
    ] {
        robot.type_in(HAND, line).unwrap();
        assert!((front_m(&robot) - was_m - 0.4).abs() < 1e-9, "{line}");
    }
}

#[test]
fn a_person_who_is_moved_goes_on_beside_the_old_path() {
    let library = Library::new();
    let crossing = Overrides {
        world: Some("crossing".into()),
        ..Overrides::default()
    };
    let setup = library.setup("mode8-goals", &crossing).unwrap();
    let (still, mut moved) = (setup.sim(1).unwrap(), setup.sim(1).unwrap());
    let standing = still.world().obstacles().len();
    assert!(type_to(
        &mut moved,
        HAND,
        format!("thing={standing} 0.3 -0.2").as_bytes()
    ));
    for t_us in [1_000_000, 4_000_000] {
        let at = |sim: &rumbo_sim::Sim| sim.world().bodies()[0].at(t_us);
        let (was, is) = (at(&still), at(&moved));
        assert!((is.pose.x_m - was.pose.x_m - 0.3).abs() < 1e-12);
        assert!((is.pose.y_m - was.pose.y_m + 0.2).abs() < 1e-12);
        assert_eq!(is.velocity, was.velocity);
    }
}
