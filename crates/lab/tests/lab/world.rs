//! Worlds that a page edits: what it gets, what is refused, and the run in the edited one.
#![allow(clippy::unwrap_used, reason = "helpers of tests too")]

use rumbo_experiment::files::{Kind, Library, Overrides, Setup};
use rumbo_experiment::run;
use rumbo_lab::{EDITED, SimulatedRobot, edited_world};
use rumbo_log::Choice;
use rumbo_session::Target;
use serde_json::{Value, json};

fn robot(scenario: &str, seed: u64) -> SimulatedRobot {
    let choice = Choice {
        scenario: scenario.into(),
        world: None,
        rig: None,
        seed,
    };
    SimulatedRobot::new(Overrides::default(), choice).unwrap()
}

/// What is wrong with a world of this JSON, in mode 1.
fn problem(model: &Value) -> String {
    let world = robot("mode1", 1).world(Some(&model.to_string()));
    world.problem.unwrap()
}

fn in_world(scenario: &str, toml: &str) -> Setup {
    let library = Library::new().holding(Kind::World, EDITED, toml);
    let overrides = Overrides {
        world: Some(EDITED.into()),
        ..Overrides::default()
    };
    library.setup(scenario, &overrides).unwrap()
}

#[test]
fn what_the_page_gets_is_the_world_and_unchanged_it_is_the_same() {
    for scenario in Library::new().list(Kind::Scenario) {
        let mut robot = robot(&scenario, 3);
        let shown = robot.world(None);
        assert_eq!(shown.problem, None, "{scenario}");
        let again = robot.world(Some(&shown.model.to_string()));
        assert_eq!(again, shown, "{scenario}");
        let file = robot.world(Some(&shown.toml));
        assert_eq!(file, shown, "{scenario}");
        let before = robot.scene().unwrap();
        robot.drive_in(&shown.toml).unwrap();
        let after = robot.scene().unwrap();
        assert_eq!(after.choice.world.as_deref(), Some(EDITED));
        assert_eq!(after.obstacles.len(), before.obstacles.len(), "{scenario}");
        let corners = |scene: &rumbo_log::Scene| -> Vec<[f64; 2]> {
            let obstacles = scene.obstacles.iter();
            obstacles.flat_map(|it| it.corners_m.clone()).collect()
        };
        for (one, other) in corners(&before).iter().zip(corners(&after)) {
            let apart_m = (one[0] - other[0]).hypot(one[1] - other[1]);
            assert!(apart_m < 1e-5, "{scenario}: {one:?}, {other:?}");
        }
    }
}

#[test]
fn a_random_world_is_frozen_with_the_goal_of_its_seed() {
    let mut robot = robot("mode8-random", 7);
    let goals = robot.scene().unwrap().goals;
    let frozen = robot.world(None);
    assert!(frozen.model.get("random").is_none() && frozen.model.get("goal_m").is_some());
    // Another seed draws no other boxes there.
    let setup = in_world("mode8-random", &frozen.toml);
    let own = setup.of_seed(8).unwrap();
    assert_eq!(own.world.boxes.len(), setup.world.boxes.len());
    let shortest = own.world.journey.as_ref().unwrap().shortest.as_ref();
    let drawn = Library::new()
        .setup("mode8-random", &Overrides::default())
        .unwrap();
    let drawn = drawn.of_seed(7).unwrap();
    let expected = drawn.world.journey.as_ref().unwrap().shortest.as_ref();
    assert_eq!(shortest.is_some(), expected.is_some());
    let result = run::run(&setup, 7).unwrap();
    assert!(result.metrics.contains_key("path_ratio"));
    robot.drive_in(&frozen.toml).unwrap();
    let scene = robot.scene().unwrap();
    for (one, other) in scene.goals[0].iter().zip(goals[0]) {
        assert!((one - other).abs() < 1e-5, "{:?}, {goals:?}", scene.goals);
    }
}

#[test]
fn a_world_that_no_file_may_hold_is_refused_in_the_words_for_files() {
    let mut world = json!({
        "title": "Mine",
        "box": [{ "centre_m": [0, 0], "size_m": [0.4, 0.4] }],
        "start": { "x_m": 0.1 },
    });
    assert_eq!(
        problem(&world),
        "world edited: its start x_m = 0.1, y_m = 0 is inside a wall or box of world edited; move [start] or choose another world"
    );
    world["start"]["x_m"] = json!(1.5);
    world["box"][0]["size_m"] = json!([0, 0.4]);
    assert!(
        problem(&world).contains("size_m = 0: must be within 0.01..50 m"),
        "{}",
        problem(&world)
    );
    world["box"] = json!([]);
    world["wall"] = json!([{ "from_m": [1, 1], "to_m": [1, 1] }]);
    assert!(problem(&world).contains("a wall needs two different ends"));
    world["wall"] = json!([]);
    world["moat"] = json!({ "depth_m": 1 });
    assert!(problem(&world).contains("moat"), "{}", problem(&world));
    let two_goals = json!({ "title": "Two", "random": {}, "goal_m": [1, 1] });
    assert!(problem(&two_goals).contains("leave one of them out"));
    let text = "title = 0,5";
    let problem = robot("mode1", 1).world(Some(text)).problem.unwrap();
    assert!(
        problem.contains("world edited:1: not valid TOML"),
        "{problem}"
    );
}

#[test]
fn one_that_is_refused_leaves_the_robot_where_it_is() {
    let mut robot = robot("mode1", 1);
    let before = robot.scene().unwrap();
    let why = robot.drive_in("title = 1").unwrap_err().to_string();
    assert!(why.contains("title"), "{why}");
    assert_eq!(robot.scene().unwrap(), before);
    assert_eq!(edited_world(&robot.manifest()), None);
}

#[test]
fn the_edited_world_stays_in_the_list_and_its_text_in_the_manifest() {
    let mut robot = robot("mode1", 1);
    let mut model = robot.world(None).model;
    model["title"] = json!("Mine");
    model["box"] = json!([{ "centre_m": [0.5, 0.7], "size_m": [0.2, 0.2], "angle_deg": 30 }]);
    model["start"] = json!({ "x_m": 0.1, "heading_deg": 5 });
    let choice = robot.drive_in(&model.to_string()).unwrap();
    assert_eq!((choice.scenario.as_str(), choice.seed), ("mode1", 1));
    let text = robot.manifest().files["world"].clone();
    assert_eq!(edited_world(&robot.manifest()), Some(text.as_str()));
    assert!(
        text.contains("title = \"Mine\"") && text.contains("[[box]]"),
        "{text}"
    );
    let own = |world: Option<&str>| Choice {
        world: world.map(str::to_owned),
        ..choice.clone()
    };
    robot.reset(&own(None)).unwrap();
    assert_eq!(edited_world(&robot.manifest()), None);
    robot.reset(&own(Some(EDITED))).unwrap();
    let scene = robot.scene().unwrap();
    assert_eq!(scene.world_titles[EDITED], "Mine");
    assert!((scene.start.x_m - 0.1).abs() < 1e-12);
    assert_eq!(robot.manifest().files["world"], text);
    // A link opens it with its text.
    let library = Library::new().holding(Kind::World, EDITED, &text);
    let linked = SimulatedRobot::of(library, Overrides::default(), own(Some(EDITED))).unwrap();
    assert_eq!(linked.scene().unwrap().obstacles, scene.obstacles);
}
