//! The built-in files are valid, and errors in others are reported line by line.

use rumbo_control::mode::Movement;
use rumbo_control::params::ParamId;
use rumbo_experiment::files::{
    FileError, Kind, Library, Overrides, PolicyFile, RobotFile, ScenarioFile, WorldFile,
};
use rumbo_experiment::note::Note;
use rumbo_wire::message::{Command, MovementLevel};

#[test]
fn every_built_in_file_can_be_set_up() {
    let library = Library::new();
    for name in library.list(Kind::Robot) {
        library.robot(&name).unwrap();
    }
    for name in library.list(Kind::World) {
        library.world(&name).unwrap().world().unwrap();
    }
    let scenarios = library.list(Kind::Scenario);
    assert!(scenarios.len() >= 20);
    for name in scenarios {
        library.setup(&name, &Overrides::default()).unwrap();
    }
}

#[test]
fn the_front_sonar_of_mode_1_starts_107_cm_from_the_wall() {
    let setup = Library::new()
        .setup("mode1", &Overrides::default())
        .unwrap();
    let sonar_x_m = setup.scenario.start.x_m + setup.rig.front.unwrap().x_m;
    assert!((setup.world.walls[0].from_m[0] - sonar_x_m - 1.07).abs() < 1e-9);
}

#[test]
fn a_ramp_is_one_command_per_count_of_pwm() {
    let scenario = Library::new()
        .scenario("manual-deadzone-left-forward")
        .unwrap();
    let duties: Vec<f32> = scenario
        .commands
        .iter()
        .filter_map(|timed| match timed.command {
            Command::Move {
                movement: Movement::PivotRightForward,
                level: MovementLevel::Duty(duty),
            } => Some(duty * 255.0),
            _ => None,
        })
        .collect();
    assert_eq!(duties.len(), 78);
    assert!(
        duties
            .iter()
            .enumerate()
            .all(|(count, duty)| (duty - count as f32).abs() < 1e-3)
    );
}

#[test]
fn a_scenario_may_let_sonars_fail() {
    use rumbo_sim::sonar_fault::{SonarFault, TimedSonarFault};
    let text = format!(
        "{SCENARIO}[[sonar_fault]]\nat_s = 2\nsonar = \"left\"\nkind = \"spiking\"\nshare = 0.5\n"
    );
    let scenario = ScenarioFile::parse("x", "x.toml", &text).unwrap();
    let expected = TimedSonarFault {
        at_s: 2.0,
        sonar: rumbo_control::SonarId::Left,
        fault: SonarFault::Spiking(0.5),
    };
    assert_eq!(scenario.sonar_faults, [expected]);
}

#[test]
fn a_scenario_may_let_wires_fail() {
    use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};
    let text = format!(
        "{SCENARIO}[[wire_fault]]\nat_s = 2\nwire = \"right_encoder\"\nkind = \"noisy\"\nrate_hz = 200\n"
    );
    let scenario = ScenarioFile::parse("x", "x.toml", &text).unwrap();
    let expected = TimedWireFault {
        at_s: 2.0,
        wire: Wire::Encoder(rumbo_plant::drivetrain::Side::Right),
        fault: WireFault::Noisy(200.0),
    };
    assert_eq!(scenario.wire_faults, [expected]);
}

#[test]
fn a_wire_that_fails_stops_the_native_robot_too() {
    let library = Library::new();
    let faults = |wire: &str, kind: &str| {
        let mut setup = library.setup("mode1-final", &Overrides::default()).unwrap();
        let text =
            format!("{SCENARIO}[[wire_fault]]\nat_s = 1.4\nwire = \"{wire}\"\nkind = \"{kind}\"\n");
        let parsed = ScenarioFile::parse("x", "x.toml", &text).unwrap();
        setup.scenario.wire_faults = parsed.wire_faults;
        let result = rumbo_experiment::run::run(&setup, 1).unwrap();
        assert_eq!(result.metrics["contacts"], 0.0);
        let said: Vec<_> = result.failures.iter().map(Note::to_string).collect();
        said.join("; ")
    };
    for level in ["high", "low"] {
        let said = faults("front_echo", level);
        assert!(said.contains("fault: sonar"), "{said}");
    }
    let said = faults("left_encoder", "low");
    assert!(said.contains("fault: left encoder silent"), "{said}");
}

#[test]
fn the_robot_with_an_uno_has_the_body_and_motors_of_the_report_s() {
    let library = Library::new();
    let [report, uno] = ["memoria", "uno"].map(|name| library.robot(name).unwrap());
    assert_eq!(
        uno.plant, report.plant,
        "copy [plant] of robots/memoria.toml"
    );
    assert_eq!((report.board.name, uno.board.name), ("mega", "uno"));
}

#[test]
fn a_wiring_may_have_a_divider_for_the_battery() {
    use rumbo_sim::wiring::Divider;
    let text = |pin: &str| {
        format!(
            "title = \"t\"\n[rig.a.front]\nx_m = 0.1\n[wiring.final]\nbattery = {{ pin = {pin}, ratio = 2.5 }}\n"
        )
    };
    let divider = Divider {
        input: 3,
        ratio: 2.5,
    };
    for pin in ["57", "\"A3\""] {
        let robot = RobotFile::parse("x", "x.toml", &text(pin)).unwrap();
        assert_eq!(robot.wirings["final"].battery, Some(divider), "{pin}");
    }
    // Only pins with an analogue input will do.
    let error = RobotFile::parse("x", "x.toml", &text("3"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains(
            "wiring.final.battery.pin = 3: must be an analogue input of the Arduino Mega"
        ),
        "{error}"
    );
}

#[test]
fn a_sonar_of_another_name_needs_a_place_and_pins() {
    let parsed = |rig: &str, wiring: &str| {
        let text =
            format!("title = \"t\"\n[rig.a]\nfront.x_m = 0.1\n{rig}\n[wiring.a]\n{wiring}\n");
        RobotFile::parse("x", "x.toml", &text)
    };
    let rear = "rear_trigger = 4\nrear_echo = 5";
    let robot = parsed("rear = { x_m = -0.08, angle_deg = 180 }", rear).unwrap();
    assert_eq!(robot.other_sonars, ["rear"]);
    assert!(robot.rigs["a"].others[0].is_some() && robot.rigs["a"].front.is_some());
    let many: String = "bcdefg"
        .chars()
        .map(|c| format!("{c}.x_m = 0.1\n"))
        .collect();
    for (rig, wiring, expected) in [
        ("", rear, "give it a table, [rig.NAME.rear] with x_m"),
        ("", "frnt_echo = 5", "did you mean `front`"),
        (
            "frnt.x_m = 0.1",
            "",
            "frnt = {...}: no wiring has frnt_trigger; did you mean `front`",
        ),
        (&many, "", "at most 5 other sonars"),
        (
            "\"a,b\".x_m = 0.1",
            "",
            "\"a,b\": a sonar's name has small letters",
        ),
    ] {
        let error = parsed(rig, wiring).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_line_sensor_gives_a_level_a_voltage_or_a_time() {
    use rumbo_sim::floor::FloorReading;
    let parsed = |sensor: &str| {
        let text = format!(
            "title = \"t\"\nboard = \"uno\"\n[rig.a.front]\nx_m = 0.1\n[wiring.own.line]\nleft = {{ x_m = 0.08, {sensor} }}\n"
        );
        RobotFile::parse("x", "x.toml", &text)
    };
    for (sensor, reading) in [
        ("pin = 2", FloorReading::Level),
        (
            "pin = \"A1\", analogue = true",
            FloorReading::Volts([0.4, 4.4]),
        ),
        (
            "pin = \"A1\", analogue = true, dark_v = 4.8",
            FloorReading::Volts([0.4, 4.8]),
        ),
        ("pin = \"A1\", rc = true", FloorReading::Discharge),
    ] {
        let robot = parsed(sensor).unwrap();
        assert_eq!(robot.wirings["own"].line_sensors[0].reading, reading);
    }
}

#[test]
fn a_route_is_its_beginning_and_a_command_per_waypoint() {
    use rumbo_wire::message::Waypoint;
    let text = SCENARIO.replace("\"manual\"", "\"waypoints\"")
        + "[[command]]\nat_s = 1\nroute_m = [[1, 0], [1, 0.5, 90]]\nrepeat = true\nframe = \"relative\"\n";
    let scenario = ScenarioFile::parse("x", "scenarios/x.toml", &text).unwrap();
    let waypoint = |x_m, y_m, heading_rad| {
        Command::Waypoint(Waypoint {
            x_m,
            y_m,
            heading_rad,
        })
    };
    let sent: Vec<Command> = scenario
        .commands
        .iter()
        .map(|timed| timed.command)
        .collect();
    assert_eq!(
        sent,
        [
            Command::Route {
                repeat: true,
                relative: true
            },
            waypoint(1.0, 0.0, None),
            waypoint(1.0, 0.5, Some(std::f32::consts::FRAC_PI_2)),
        ]
    );
}

#[test]
fn a_file_on_disk_works_as_well_as_a_name() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/mode1.toml");
    let library = Library::new();
    let mut from_disk = library.setup(path, &Overrides::default()).unwrap();
    assert_eq!(from_disk.scenario.path.take().as_deref(), Some(path));
    assert_eq!(
        from_disk,
        library.setup("mode1", &Overrides::default()).unwrap()
    );
}

const SCENARIO: &str = r#"title = "t"
robot = "memoria"
rig = "front_single"
world = "open"
mode = "manual"
duration_s = 5
"#;

fn scenario_error(text: &str) -> String {
    ScenarioFile::parse("x", "scenarios/x.toml", text)
        .map_or_else(|error| error.to_string(), |_| "no problem".into())
}

/// Additions to a valid file, and the errors that each gives, as `tests/wrong` lists them.
fn wrong(list: &str, parse: impl Fn(&str) -> Result<(), FileError>) {
    let mut blocks = list.split("\n\n");
    let valid = blocks.next().unwrap();
    let blocks: Vec<&str> = blocks.map(str::trim_end).collect();
    let now = blocks.iter().map(|block| {
        let (added, _) = block.split_once("\n=> ").unwrap();
        let error = parse(&format!("{valid}\n{added}\n"))
            .map_or_else(|error| error.to_string(), |()| "none".into());
        format!("{added}\n=> {}", error.replace('\n', "\n=> "))
    });
    let others: Vec<String> = std::iter::zip(&blocks, now)
        .filter_map(|(block, now)| (now != *block).then_some(now))
        .collect();
    assert!(blocks.len() > 5);
    assert!(others.is_empty(), "now so:\n\n{}", others.join("\n\n"));
}

#[test]
fn errors_in_files_name_line_key_value_and_what_is_allowed() {
    wrong(include_str!("../wrong/scenarios.txt"), |text| {
        ScenarioFile::parse("x", "x.toml", text).map(drop)
    });
    wrong(include_str!("../wrong/robots.txt"), |text| {
        RobotFile::parse("x", "x.toml", text).map(drop)
    });
    wrong(include_str!("../wrong/worlds.txt"), |text| {
        WorldFile::parse("x", "x.toml", text).map(drop)
    });
}

#[test]
fn a_switch_or_a_choice_is_given_by_name_or_number() {
    let parsed = |parameters: &str| {
        let text = format!("{SCENARIO}[parameters]\n{parameters}\n");
        ScenarioFile::parse("x", "scenarios/x.toml", &text)
            .unwrap()
            .parameters
    };
    let expected = [
        (ParamId::BatteryInput, 3.0),
        (ParamId::WaypointTracker, 1.0),
        (ParamId::MissionResetOrigin, 0.0),
    ];
    for values in [
        ["\"A3\"", "\"pure_pursuit\"", "false"],
        ["3", "1", "\"no\""],
    ] {
        let [input, tracker, reset] = values;
        let text = format!(
            "battery_input = {input}\nwaypoint_tracker = {tracker}\nmission_reset_origin = {reset}"
        );
        assert_eq!(parsed(&text), expected);
    }
}

#[test]
fn all_problems_of_a_file_are_reported_at_once_in_the_order_of_lines() {
    let text = "title = 1\nrobot = \"memoria\"\nrig = \"final\"\nworld = \"open\"\nmode = \"weel_speed\"\nduration_s = -1\n";
    assert_eq!(
        scenario_error(text),
        "scenarios/x.toml:1: title = 1: must be text in quotes\n\
         scenarios/x.toml:5: mode = weel_speed: unknown mode; did you mean `wheel_speed` (5)?\n\
         scenarios/x.toml:6: duration_s = -1: must be within 0.1..3600 s"
    );
}

#[test]
fn what_is_missing_is_named_with_what_belongs_there() {
    let error = scenario_error("title = \"t\"\n");
    assert!(
        error.contains("scenarios/x.toml: duration_s is missing: must be within 0.1..3600 s"),
        "{error}"
    );
    assert!(
        error.contains("scenarios/x.toml: robot is missing: name of a robot, e.g. \"memoria\""),
        "{error}"
    );
}

#[test]
fn what_moves_is_where_its_file_says() {
    let text = "title = \"t\"\n\
        [[mover]]\nsize_m = [0.8, 0.04]\nhinge_m = [2, 1]\nangles_deg = [0, 90]\nspeed_deg_s = 45\nrepeat = \"back_and_forth\"\npause_s = 1\n\
        [[mover]]\ndiameter_m = 0.3\npath_m = [[0, 0], [3, 0], [3, 4]]\nspeed_m_s = 0.5\nrepeat = \"loop\"\nstart_s = 2\n";
    let world = WorldFile::parse("x", "x.toml", text)
        .unwrap()
        .world()
        .unwrap();
    let [door, person] = world.bodies() else {
        panic!("{:?}", world.bodies());
    };
    let tip = |t_us| {
        door.outline(&door.at(t_us).pose)
            .corners()
            .map(|[x, y]| [x - 2.0, y - 1.0])
            .fold([0.0_f64; 2], |most, [x, y]| {
                [most[0].max(x), most[1].max(y)]
            })
    };
    let near = |one: [f64; 2], other: [f64; 2]| {
        assert!(
            (one[0] - other[0]).abs() < 1e-9 && (one[1] - other[1]).abs() < 1e-9,
            "{one:?} {other:?}"
        );
    };
    near(tip(500_000), [0.8, 0.02]);
    near(tip(3_500_000), [0.02, 0.8]);
    let middle = |t_us| {
        let pose = person.at(t_us).pose;
        [pose.x_m, pose.y_m]
    };
    near(middle(1_000_000), [0.0, 0.0]);
    near(middle(10_000_000), [3.0, 1.0]);
    near(middle(21_000_000), [1.5, 2.0]);
    near(middle(26_000_000), [0.0, 0.0]);
}

#[test]
fn a_fixed_world_has_no_goal_to_give() {
    let overrides = Overrides {
        world: Some("room".into()),
        ..Overrides::default()
    };
    let error = Library::new()
        .setup("mode8-random", &overrides)
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "scenario mode8-random: its goal is that of the world, and world room has none; give a world with goal_m or [random], or goal_m in place of goal"
    );
}

#[test]
fn a_random_world_without_room_is_an_error() {
    let mut setup = Library::new()
        .setup("mode8-random", &Overrides::default())
        .unwrap();
    setup.world.arena.to_m = [0.5, 0.5];
    let error = setup.of_seed(1).unwrap_err().to_string();
    assert!(
        error.starts_with("world random: no room for boxes and a goal with seed 1;"),
        "{error}"
    );
}

#[test]
fn the_goal_of_the_world_is_sent_relative_to_the_start() {
    let mut setup = Library::new()
        .setup("mode8-random", &Overrides::default())
        .unwrap();
    setup.scenario.start.y_m = 0.5;
    setup.scenario.start.heading_rad = std::f64::consts::FRAC_PI_2;
    let own = setup.of_seed(4).unwrap();
    let [goal_x_m, goal_y_m] = own.world.journey.as_ref().unwrap().goal_m;
    let Command::Goal { x_m, y_m } = own.scenario.commands[1].command else {
        panic!("{:?}", own.scenario.commands);
    };
    assert!(
        (f64::from(x_m) - (goal_y_m - 0.5)).abs() < 1e-6,
        "ahead is the world's y"
    );
    assert!(
        (f64::from(y_m) + goal_x_m).abs() < 1e-6,
        "left is against the world's x"
    );
}

#[test]
fn a_rig_of_the_scenario_that_the_robot_lacks_is_said_with_both() {
    let overrides = Overrides {
        robot: Some("uno".into()),
        ..Overrides::default()
    };
    let error = Library::new().setup("mode2", &overrides).unwrap_err();
    assert_eq!(
        error.to_string(),
        "scenario mode2: robot uno has no rig `front_pair`; did you mean `front_servo`?"
    );
}

#[test]
fn a_file_that_powershell_redirected_is_read() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("utf16.toml");
    let units = [0xFEFF].into_iter().chain(SCENARIO.encode_utf16());
    let bytes: Vec<u8> = units.flat_map(u16::to_le_bytes).collect();
    std::fs::write(&path, bytes).unwrap();
    Library::new().scenario(path.to_str().unwrap()).unwrap();
}

#[test]
fn every_robot_stands_in_a_scenario_that_asks_nothing_of_it() {
    let library = Library::new();
    for robot in library.list(Kind::Robot) {
        let overrides = Overrides {
            robot: Some(robot.clone()),
            ..Overrides::default()
        };
        let setup = library.setup("free", &overrides);
        assert!(setup.is_ok(), "{robot}: {:?}", setup.err());
    }
}

#[test]
fn a_sonar_that_the_rig_lacks_cannot_fail() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("no_sonar.toml");
    let setup = |text: String| {
        std::fs::write(&path, text).unwrap();
        let setup = Library::new().setup(path.to_str().unwrap(), &Overrides::default());
        setup.map(|_| ()).map_err(|error| error.to_string())
    };
    for fault in [
        "[[sonar_fault]]\nat_s = 1\nsonar = \"SONAR\"\nkind = \"cut\"\n",
        "[[wire_fault]]\nat_s = 1\nwire = \"SONAR_echo\"\nkind = \"low\"\n",
    ] {
        let text = |sonar: &str| SCENARIO.to_owned() + &fault.replace("SONAR", sonar);
        assert_eq!(setup(text("front")), Ok(()));
        assert_eq!(
            setup(text("left")).unwrap_err(),
            "scenario no_sonar: its sonar `left` is to fail, and rig front_single has none of that name; \
             name another sonar, or choose another rig"
        );
    }
}

#[test]
fn a_robot_cannot_start_inside_a_box() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("inside.toml");
    let text = SCENARIO.replace("\"open\"", "\"room\"") + "[start]\nx_m = 1.6\n";
    std::fs::write(&path, text).unwrap();
    let error = Library::new()
        .setup(path.to_str().unwrap(), &Overrides::default())
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "scenario inside: its start x_m = 1.6, y_m = 0 is inside a wall or box of world room; move [start] or choose another world"
    );
}

#[test]
fn a_robot_cannot_start_inside_what_moves() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let world = "title = \"t\"\n[[mover]]\nname = \"cat\"\ndiameter_m = 0.3\npath_m = [[0.2, 0], [2, 0]]\nspeed_m_s = 0.3\n";
    std::fs::write(folder.join("cat.toml"), world).unwrap();
    let path = folder.join("inside_cat.toml");
    std::fs::write(&path, SCENARIO.replace("\"open\"", "\"cat.toml\"")).unwrap();
    let error = Library::new()
        .setup(path.to_str().unwrap(), &Overrides::default())
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "scenario inside_cat: its start x_m = 0, y_m = 0 is inside mover \"cat\" of world cat; move [start] or choose another world"
    );
}

#[test]
fn unknown_names_list_the_near_ones() {
    let library = Library::new();
    assert_eq!(
        library.scenario("fre").unwrap_err().to_string(),
        "unknown scenario `fre`; did you mean `free`?"
    );
    let error = library.world("x").unwrap_err().to_string();
    assert!(
        error.starts_with("unknown world `x`; known are `") && error.contains("`wall_front`"),
        "{error}"
    );
    let overrides = Overrides {
        rig: Some("front".into()),
        ..Overrides::default()
    };
    assert_eq!(
        library.setup("mode1", &overrides).unwrap_err().to_string(),
        "unknown rig `front`; did you mean `front_pair` or `front_single`?"
    );
}

proptest::proptest! {
    #[test]
    fn a_damaged_file_gets_an_answer_and_never_a_panic(at in 0_usize..600, cut in 0_usize..20, put in "[ -~\n]{0,6}") {
        for kind in [Kind::Robot, Kind::World, Kind::Scenario, Kind::Policy] {
            let library = Library::new();
            let text = match kind {
                Kind::Robot => library.robot("memoria").unwrap().text,
                Kind::World => library.world("room").unwrap().text,
                Kind::Scenario => library.scenario("manual-deadzone-left-forward").unwrap().text,
                Kind::Policy => library.policy("goal").unwrap().text,
            };
            let (from, to) = (at % text.len(), (at % text.len() + cut).min(text.len()));
            let damaged = format!("{}{put}{}", &text[..from], &text[to..]);
            let complaint = match kind {
                Kind::Robot => RobotFile::parse("x", "x.toml", &damaged).err(),
                Kind::World => WorldFile::parse("x", "x.toml", &damaged).err(),
                Kind::Scenario => ScenarioFile::parse("x", "x.toml", &damaged).err(),
                Kind::Policy => PolicyFile::parse("x", "x.toml", &damaged).err(),
            };
            for line in complaint.iter().flat_map(|error| error.to_string().lines().map(String::from).collect::<Vec<_>>()) {
                proptest::prop_assert!(line.starts_with("x.toml:"), "{line}");
            }
        }
    }
}

#[test]
fn the_example_of_the_scenario_page_runs_and_passes() {
    let page = include_str!("../../../../docs/scenarios.md");
    let example = page
        .split("```toml")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let path = std::env::temp_dir().join(format!("rumbo-example-{}.toml", std::process::id()));
    std::fs::write(&path, example).unwrap();
    let setup = Library::new().setup(path.to_str().unwrap(), &Overrides::default());
    std::fs::remove_file(&path).unwrap();
    let run = rumbo_experiment::run::run(&setup.unwrap(), 1).unwrap();
    assert!(run.pass, "{:?}", run.failures);
}
