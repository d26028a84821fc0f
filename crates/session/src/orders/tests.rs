use super::*;

fn parse(text: &str) -> Result<Order, BadOrder> {
    text.parse()
}

#[test]
fn each_order_of_the_page_is_understood() {
    let reference = parse(r#"{"type":"reference","value":0.5}"#).unwrap();
    assert_eq!(reference, Order::Robot(Command::Reference(0.5)));
    assert_eq!(
        parse(r#"{"type":"stop"}"#).unwrap(),
        Order::Robot(Command::Stop)
    );
    assert_eq!(
        parse(r#"{"type":"mode","mode":1}"#).unwrap(),
        Order::Robot(Command::Mode(ModeId::FrontDistance))
    );
    let reset = parse(r#"{"type":"reset","scenario":"mode1","world":null,"seed":3}"#).unwrap();
    assert_eq!(
        reset,
        Order::Reset(Choice {
            scenario: "mode1".into(),
            world: None,
            rig: None,
            seed: 3
        })
    );
}

#[test]
fn a_goal_a_lane_and_a_rig_are_commands_and_a_route_is_several() {
    let robot = |text| match parse(text).unwrap() {
        Order::Robot(command) => command,
        other => panic!("{other:?}"),
    };
    let goal = Command::Goal {
        x_m: 1.0,
        y_m: -0.5,
    };
    assert_eq!(robot(r#"{"type":"goal","x_m":1,"y_m":-0.5}"#), goal);
    assert_eq!(robot(r#"{"type":"lane"}"#), Command::Lane);
    let rig = Command::SetParam {
        id: ParamId::Rig as u8,
        value: 1.0,
    };
    assert_eq!(robot(r#"{"type":"rig","rig":"front_pair"}"#), rig);
    let turned = Waypoint {
        x_m: 1.0,
        y_m: 2.0,
        heading_rad: Some(1.5),
    };
    let appended = robot(r#"{"type":"waypoint","x_m":1,"y_m":2,"heading_rad":1.5}"#);
    assert_eq!(appended, Command::Waypoint(turned));
    let route = r#"{"type":"route","repeat":true,"relative":false,
        "waypoints":[{"x_m":1,"y_m":2,"heading_rad":1.5},{"x_m":0,"y_m":0}]}"#;
    let begin = Command::Route {
        repeat: true,
        relative: false,
    };
    let last = Command::Waypoint(Waypoint::default());
    let expected = vec![begin, Command::Waypoint(turned), last];
    assert_eq!(parse(route).unwrap(), Order::Route(expected));
}

#[test]
fn a_seed_that_a_page_cannot_count_to_is_refused() {
    let reset = |seed| {
        parse(&format!(
            r#"{{"type":"reset","scenario":"mode1","world":null,"seed":{seed}}}"#
        ))
    };
    assert!(reset("9007199254740991").is_ok());
    for seed in ["9007199254740992", "18446744073709552000", "-1", "0.5"] {
        let said = reset(seed).unwrap_err().to_string();
        assert!(
            said.contains("is no whole number from 0 to 9007199254740991"),
            "{said}"
        );
    }
}

#[test]
fn a_movement_is_held_only_when_the_page_says_so() {
    let text = r#"{"type":"move_duty","movement":1,"duty":0.3}"#;
    assert!(matches!(parse(text).unwrap(), Order::Robot(_)));
    let text = r#"{"type":"move_duty","movement":1,"duty":0.3,"held":true}"#;
    assert!(matches!(parse(text).unwrap(), Order::Hold(_)));
    let world = |text: &str| {
        parse(&format!(
            r#"{{"type":"world","ticket":7,"act":"check","text":"{text}"}}"#
        ))
    };
    let long = " ".repeat(2 * SHORT_ORDER);
    let Order::World(order) = world(&long).unwrap() else {
        panic!("no world");
    };
    assert_eq!((order.ticket, order.act), (7, WorldAct::Check));
    assert_eq!(order.text, long);
    let longer = world(&" ".repeat(WORLD_ORDER)).unwrap_err().to_string();
    assert!(longer.contains("longer than 100000 bytes"), "{longer}");
}

#[test]
fn nothing_asked_before_stop_is_done_after_it() {
    let robot = Order::Robot;
    let waiting = vec![
        robot(Command::Arm),
        Order::Hold(Command::Arm),
        Order::Route(vec![Command::Lane]),
        Order::Speed(2.0),
        robot(Command::Stop),
        robot(Command::ClearFault),
    ];
    let obeyed = [
        robot(Command::Stop),
        Order::Speed(2.0),
        robot(Command::ClearFault),
    ];
    assert_eq!(stop_first(waiting, true), obeyed);
    assert_eq!(
        stop_first(vec![robot(Command::Arm)], true),
        [robot(Command::Stop)]
    );
    assert_eq!(
        stop_first(vec![robot(Command::Arm)], false),
        [robot(Command::Arm)]
    );
}

#[test]
fn of_resets_that_wait_only_the_last_one_counts() {
    let reset = |seed| {
        Order::Reset(Choice {
            scenario: "mode1".into(),
            world: None,
            rig: None,
            seed,
        })
    };
    let waiting: Vec<Order> = (0..250).map(reset).chain([Order::Speed(2.0)]).collect();
    let stopped = [Order::Robot(Command::Stop), reset(249), Order::Speed(2.0)];
    assert_eq!(stop_first(waiting.clone(), true), stopped);
    assert_eq!(stop_first(waiting, false), stopped[1..]);
}

#[test]
fn what_is_no_order_says_why() {
    for (text, why) in [
        ("\u{0}\u{1}", "expected value"),
        ("{}", "missing field `type`"),
        (r#"{"type":"fly"}"#, "unknown variant `fly`"),
        (r#"{"type":"f\nly"}"#, "unknown variant `f\u{fffd}ly`"),
        (r#"{"type":"stop","now":true}"#, "unknown field `now`"),
        (r#"{"type":"mode","mode":11}"#, "no mode 11"),
        (r#"{"type":"mode","mode":-1}"#, "invalid value"),
        (r#"{"type":"reference","value":"NaN"}"#, "invalid type"),
        (r#"{"type":"reference","value":1e300}"#, "too large"),
        (r#"{"type":"speed","factor":-1}"#, "not within"),
        (
            r#"{"type":"move_duty","movement":99,"duty":0.1}"#,
            "no movement 99",
        ),
        (r#"{"type":"goal","x_m":1}"#, "missing field `y_m`"),
        (r#"{"type":"goal","x_m":1,"y_m":1e300}"#, "y_m is too large"),
        (
            r#"{"type":"route","repeat":true,"relative":true,"waypoints":[]}"#,
            "1 to 16 waypoints, not 0",
        ),
        (
            r#"{"type":"waypoint","x_m":1,"y_m":1,"z_m":1}"#,
            "unknown field `z_m`",
        ),
        (
            r#"{"type":"rig","rig":"front"}"#,
            "no rig `front`; known are front_single",
        ),
    ] {
        let said = parse(text).unwrap_err().to_string();
        assert!(said.contains(why), "{text}: {said}");
    }
}
