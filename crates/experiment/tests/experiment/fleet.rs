//! Scenarios with several robots.

use rumbo_experiment::batch::{Batch, DrivenBy};
use rumbo_experiment::files::{
    FileError, Kind, Library, NativeProgram, Overrides, Setup, StartPose, fleet_around,
};
use rumbo_experiment::run::{RunResult, run, run_all_on};

/// To a wall 1.5 m ahead, without the robot.
const TO_THE_WALL: &str = "title = \"t\"\nrobot = \"memoria\"\nrig = \"final\"\nworld = \"open\"\nmode = \"wheel_speed\"\nduration_s = 4\n\
    [[command]]\nat_s = 0.4\nspeed_rpm = 40\n[[command]]\nat_s = 0.5\narm = true\n";

fn setup_of(text: &str) -> Result<Setup, FileError> {
    let library = Library::new().holding(Kind::Scenario, "several", text);
    library.setup("several", &Overrides::default())
}

/// Why the scenario with these robots is refused.
fn refusal(robots: &str) -> String {
    let refused = setup_of(&format!("{TO_THE_WALL}{robots}"));
    refused
        .err()
        .map(|error| error.to_string())
        .unwrap_or_default()
}

#[test]
fn a_fleet_of_one_runs_as_the_robot_alone() {
    let alone = run(&setup_of(TO_THE_WALL).unwrap(), 5).unwrap();
    let one = setup_of(&format!("{TO_THE_WALL}[[fleet]]\nname = \"only\"\n")).unwrap();
    let one = run(&one, 5).unwrap();
    assert_eq!(one.trace, alone.trace);
    assert!(alone.trace.samples.last().unwrap().x_m > 0.2);
    assert_eq!(one.metrics.len(), alone.metrics.len());
}

/// Two that drive at each other, and one that drives away; the second by the report's program.
const THREE: &str = "[[fleet]]\nname = \"east\"\n\
    [[fleet]]\nname = \"west\"\nprogram = \"baseline\"\nstart = { x_m = 0.7, heading_deg = 180 }\n\
    [[fleet]]\nname = \"away\"\nstart = { y_m = 1.5, heading_deg = 90 }\n\
    [fleet.plant]\nbattery.open_circuit_v = 7.0\n\
    [[fleet.command]]\nat_s = 1\nspeed_rpm = 30\n[[fleet.command]]\nat_s = 1.5\narm = true\n";

#[test]
fn each_has_its_own_program_start_commands_and_noise() {
    let setup = setup_of(&format!("{TO_THE_WALL}{THREE}")).unwrap();
    let [east, west, away] = &setup.fleet[..] else {
        panic!("{}", setup.fleet.len())
    };
    assert_eq!(
        (east.program, west.program),
        (NativeProgram::Rumbo, NativeProgram::Baseline)
    );
    assert_eq!(
        (east.scenario.commands.len(), away.scenario.commands[0].at_s),
        (2, 1.0)
    );
    assert!((west.scenario.start.heading_rad - std::f64::consts::PI).abs() < 1e-9);
    let params = |setup: &Setup| setup.config(3).unwrap().plant;
    let (one, other) = (params(east), params(away));
    assert_ne!(one.wheels.left.radius_m, other.wheels.left.radius_m);
    assert!((other.battery.open_circuit_v - 7.0).abs() < 1e-9);
    // Values given on the command line are for all of them.
    let lower = setup
        .with_parameters(&[("battery.open_circuit_v", 6.5)])
        .unwrap();
    let volts = lower
        .fleet
        .iter()
        .map(|robot| robot.scenario.plant["battery.open_circuit_v"]);
    assert_eq!(volts.collect::<Vec<_>>(), [6.5; 3]);
}

#[test]
fn metrics_tell_of_each_robot_of_each_pair_and_of_all() {
    let setup = setup_of(&format!("{TO_THE_WALL}{THREE}")).unwrap();
    let result = run(&setup, 3).unwrap();
    let metric = |name: &str| *result.metrics.get(name).unwrap_or_else(|| panic!("{name}"));
    assert!(metric("east.contacts") > 0.0 && metric("west.contacts") > 0.0);
    assert_eq!(metric("away.contacts"), 0.0);
    assert!(metric("east-west.contacts") > 0.0);
    assert!(metric("east-west.contact_speed_m_s") > 0.1, "both drive");
    assert_eq!(
        metric("contact_speed_m_s"),
        metric("east-west.contact_speed_m_s")
    );
    assert_eq!(
        (metric("east-west.closest_m"), metric("closest_m")),
        (0.0, 0.0)
    );
    assert!(metric("west-away.closest_m") > 0.5);
    assert_eq!(metric("east-away.contacts"), 0.0);
    assert_eq!(metric("robot_contacts"), metric("east-west.contacts"));
    assert_eq!(result.robots.len(), 3);
    assert!(result.pass, "{:?}", result.failures);
    let strict = format!(
        "{TO_THE_WALL}{THREE}[limits]\n\"closest_m\" = {{ min = 0.1 }}\n\"east.contacts\" = {{ max = 0 }}\n"
    );
    let result = run(&setup_of(&strict).unwrap(), 3).unwrap();
    assert_eq!(result.failures.len(), 2, "{:?}", result.failures);
}

#[test]
fn the_same_on_any_number_of_threads() {
    let setup = setup_of(&format!("{TO_THE_WALL}{THREE}")).unwrap();
    let on = |threads: usize| {
        let jobs: Vec<_> = (1..5).map(|seed| (&setup, seed)).collect();
        let mut results: Vec<RunResult> = Vec::new();
        run_all_on::<FileError>(
            threads,
            &jobs,
            || Ok(()),
            |_, result| {
                results.push(result);
                Ok(())
            },
        )
        .unwrap();
        let robots = results.into_iter().flat_map(|result| result.robots);
        robots.map(|robot| robot.trace).collect::<Vec<_>>()
    };
    let one = on(1);
    assert_eq!(one.len(), 12);
    assert_eq!(one, on(3));
    assert_ne!(one[0], one[3], "seeds differ");
}

#[test]
fn robots_that_cannot_be_together_are_refused_by_name() {
    let two = |second: &str| format!("[[fleet]]\nname = \"a\"\n[[fleet]]\n{second}\n");
    assert_eq!(
        refusal(&two("name = \"b\"\nstart = { x_m = 0.1 }")),
        "scenario several: robots a and b start inside each other; move the start of one"
    );
    let text = refusal(&two("name = \"a\"\nstart = { x_m = 1 }"));
    assert!(
        text.contains("fleet[2].name = a: the robot of line 14 has that name"),
        "{text}"
    );
    let text = refusal(&two("name = \"North!\""));
    assert!(
        text.contains("North!: write at most 20 of a to z"),
        "{text}"
    );
    let text = refusal(&two(
        "name = \"b\"\nstart = { x_m = 1 }\nprogram = \"mine\"",
    ));
    assert!(
        text.contains("program = mine: write \"rumbo\" or \"baseline\""),
        "{text}"
    );
    let text = refusal(&two("name = \"b\"\nstrat = { x_m = 1 }"));
    assert!(text.contains("strat") && text.contains("start"), "{text}");
    let text = refusal(&two("start = { x_m = 1 }"));
    assert!(text.contains("name is missing"), "{text}");
    let room = TO_THE_WALL.replace("\"open\"", "\"room\"");
    let text = setup_of(&format!(
        "{room}{}",
        two("name = \"b\"\nstart = { x_m = 1.6 }")
    ));
    assert_eq!(
        text.unwrap_err().to_string(),
        "robot b: its start x_m = 1.6, y_m = 0 is inside a wall or box of world room; move [start] or choose another world"
    );
    let random = TO_THE_WALL.replace("\"open\"", "\"random\"");
    let text = setup_of(&format!(
        "{random}{}",
        two("name = \"b\"\nstart = { y_m = 0.4 }")
    ));
    assert!(
        text.unwrap_err()
            .to_string()
            .contains("a fleet cannot use world random")
    );
    let many = (0..33)
        .map(|number| format!("[[fleet]]\nname = \"r{number}\"\nstart = {{ x_m = {number} }}\n"));
    let text = refusal(&many.collect::<String>());
    assert!(text.contains("32"), "{text}");
}

#[test]
fn copies_of_a_robot_stand_free_on_a_grid_around_it() {
    let room = TO_THE_WALL.replace("\"open\"", "\"room\"");
    let setup = setup_of(&room).unwrap();
    let entries = fleet_around(&setup, 6).unwrap();
    let fleet = setup_of(&(room + &entries)).unwrap().fleet;
    let starts: Vec<_> = fleet.iter().map(|robot| robot.scenario.start).collect();
    assert_eq!(starts[0], setup.scenario.start);
    assert_eq!(fleet[5].scenario.name, "robot6");
    let apart =
        |one: &StartPose, other: &StartPose| (one.x_m - other.x_m).hypot(one.y_m - other.y_m);
    for (index, start) in starts.iter().enumerate() {
        assert!(
            starts[..index]
                .iter()
                .all(|other| apart(start, other) > 0.49),
            "{starts:?}"
        );
    }
    let error = fleet_around(&setup, 60).unwrap_err().to_string();
    assert!(
        error.starts_with("world room: has room for ") && error.contains("of 60 robots"),
        "{error}"
    );
}

#[test]
fn where_one_robot_is_driven_a_fleet_is_refused() {
    let setup = setup_of(&format!("{TO_THE_WALL}{THREE}")).unwrap();
    let error = setup.sim(1).map(drop).unwrap_err().to_string();
    assert!(
        error.contains("has robots of its own, and here one is driven"),
        "{error}"
    );
}

#[test]
fn stepped_by_a_caller_each_robot_is_that_of_the_run_and_again_by_what_was_done_to_it() {
    let setup = setup_of(&format!("{TO_THE_WALL}{THREE}")).unwrap();
    let result = run(&setup, 3).unwrap();
    let mut batch = Batch::new(&setup, DrivenBy::Scenario, &[2, 3]).unwrap();
    batch.robot_mut(4).unwrap().record().unwrap();
    batch.advance(100);
    batch.advance(150);
    let drivers = vec![DrivenBy::Scenario; 3];
    let again = Batch::of_lives(&setup, drivers, &batch.lives(), &|| Ok(())).unwrap();
    for batch in [batch, again] {
        for (robot, run) in batch.robots().skip(3).zip(&result.robots) {
            let (pose, sample) = (robot.sim().truth().pose, &run.trace.samples[249]);
            assert_eq!([pose.x_m, pose.y_m], [sample.x_m, sample.y_m]);
        }
        let recorded = batch.robots().nth(4).unwrap().trace().unwrap();
        assert_eq!(recorded.samples, result.robots[1].trace.samples[..250]);
    }
}
