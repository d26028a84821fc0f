//! The original's text protocol and files, both ways.

use crate::common;
use common::wheels;
use proptest::prelude::*;
use rumbo_control::{Duty, Range, Side, Wheels};
use rumbo_wire::csv;
use rumbo_wire::text::*;

/// Values that two decimals hold exactly.
fn hundredths() -> impl Strategy<Value = f32> + Clone {
    (-1_000_000i32..1_000_000).prop_map(|n| n as f32 / 100.0)
}

fn row() -> impl Strategy<Value = TextRow> {
    let n = hundredths;
    let pwm = || wheels(-255i16..=255);
    let distance = (0u32..60_000, n(), n(), n(), 1u8..5, pwm()).prop_map(
        |(dt_ms, left_cm, right_cm, reference_cm, mode, pwm)| {
            TextRow::Distance(DistanceRow {
                dt_ms,
                left_cm,
                right_cm,
                reference_cm,
                mode,
                pwm,
            })
        },
    );
    let mode = prop::sample::select(vec![0u8, 5, 6]);
    let speed = (0u32..60_000, wheels(n()), n(), mode, pwm()).prop_map(
        |(dt_ms, wheel_rpm, reference_rpm, mode, pwm)| {
            TextRow::Speed(SpeedRow {
                dt_ms,
                wheel_rpm,
                reference_rpm,
                mode,
                pwm,
            })
        },
    );
    let waypoints = (
        0u32..60_000,
        wheels(n()),
        wheels(n()),
        [n(), n(), n()],
        pwm(),
    )
        .prop_map(
            |(dt_ms, wheel_rpm, reference_rpm, [x_m, y_m, heading_deg], pwm)| {
                TextRow::Waypoints(WaypointsRow {
                    dt_ms,
                    wheel_rpm,
                    reference_rpm,
                    x_m,
                    y_m,
                    heading_deg,
                    pwm,
                })
            },
        );
    let mission = (
        0u32..60_000,
        wheels(n()),
        prop::array::uniform6(n()),
        0u8..11,
        [n(), n(), n()],
    )
        .prop_map(
            |(
                dt_ms,
                reference_rpm,
                [
                    heading_reference_deg,
                    goal_x_m,
                    goal_y_m,
                    x_m,
                    y_m,
                    heading_deg,
                ],
                state,
                ranges,
            )| {
                let [right_cm, left_cm, front_cm] = ranges;
                TextRow::Mission(MissionRow {
                    dt_ms,
                    reference_rpm,
                    heading_reference_deg,
                    goal_x_m,
                    goal_y_m,
                    x_m,
                    y_m,
                    heading_deg,
                    state,
                    right_cm,
                    left_cm,
                    front_cm,
                })
            },
        );
    prop_oneof![distance, speed, waypoints, mission]
}

/// The row as a line.
fn line(row: &TextRow) -> String {
    let a_then_b = |wheels: Wheels<f32>| [wheels.right, wheels.left];
    let (dt_ms, numbers) = match row {
        TextRow::Distance(row) => (
            row.dt_ms,
            vec![row.left_cm, row.right_cm, row.reference_cm, row.mode.into()],
        ),
        TextRow::Speed(row) => {
            let mut numbers = a_then_b(row.wheel_rpm).to_vec();
            numbers.extend([row.reference_rpm, row.mode.into()]);
            (row.dt_ms, numbers)
        }
        TextRow::Waypoints(row) => {
            let mut numbers = a_then_b(row.wheel_rpm).to_vec();
            numbers.extend(a_then_b(row.reference_rpm));
            numbers.extend([row.x_m, row.y_m, row.heading_deg]);
            (row.dt_ms, numbers)
        }
        TextRow::Mission(row) => {
            let mut numbers = a_then_b(row.reference_rpm).to_vec();
            numbers.extend([row.heading_reference_deg, row.goal_x_m, row.goal_y_m]);
            numbers.extend([row.x_m, row.y_m, row.heading_deg, row.state.into()]);
            numbers.extend([row.right_cm, row.left_cm, row.front_cm]);
            (row.dt_ms, numbers)
        }
    };
    let mut line = TextLine::new(dt_ms);
    for number in numbers {
        line.number(number);
    }
    if let TextRow::Distance(DistanceRow { pwm, .. })
    | TextRow::Speed(SpeedRow { pwm, .. })
    | TextRow::Waypoints(WaypointsRow { pwm, .. }) = row
    {
        line.pwm(&pwm.map(Duty::new));
    }
    line.end();
    String::from_utf8_lossy(line.bytes()).into_owned()
}

fn command() -> impl Strategy<Value = TextCommand> {
    let n = -1e4f32..1e4;
    let side = prop::sample::select(vec![Side::Left, Side::Right]);
    prop_oneof![
        Just(TextCommand::On),
        Just(TextCommand::Off),
        Just(TextCommand::Save),
        Just(TextCommand::Reset),
        n.clone().prop_map(TextCommand::Reference),
        (side.clone(), n.clone())
            .prop_map(|(side, value)| TextCommand::WheelReference(side, value)),
        (n.clone(), n.clone()).prop_map(|(x_m, y_m)| TextCommand::Goal { x_m, y_m }),
        (side, n.clone(), 1e-6f32..1.0, n).prop_map(|(side, kp, ki, kd)| TextCommand::Gains {
            side,
            kp,
            ki,
            kd
        }),
        (0u8..10).prop_map(TextCommand::Mode),
    ]
}

/// The numbers of a command, for comparison within the reading's rounding.
fn values(command: &TextCommand) -> Vec<f32> {
    match *command {
        TextCommand::On | TextCommand::Off | TextCommand::Save | TextCommand::Reset => vec![],
        TextCommand::Mode(number) => vec![number.into()],
        TextCommand::Reference(value) => vec![value],
        TextCommand::WheelReference(side, value) => vec![f32::from(side == Side::Left), value],
        TextCommand::Goal { x_m, y_m } => vec![x_m, y_m],
        TextCommand::Gains { side, kp, ki, kd } => vec![f32::from(side == Side::Left), kp, ki, kd],
    }
}

proptest! {
    #[test]
    fn a_row_comes_back_from_its_line(row in row()) {
        let text = line(&row);
        prop_assert_eq!(TextRow::parse(text.strip_suffix("\r\n").unwrap()), Ok(row));
        prop_assert_eq!(TextRow::parse_as(row.kind(), &text), Ok(row));
        prop_assert_eq!(text.split(',').count(), row.kind().columns().len());
    }

    #[test]
    fn a_command_comes_back_from_its_line(command in command()) {
        let back = TextCommand::parse(command.to_string()).unwrap();
        prop_assert_eq!(core::mem::discriminant(&back), core::mem::discriminant(&command));
        for (back, sent) in values(&back).into_iter().zip(values(&command)) {
            prop_assert!((back - sent).abs() <= sent.abs() * 3e-7, "{} came back as {}", sent, back);
        }
    }

    #[test]
    fn any_line_is_a_command_or_an_error(line in "(ON|REF|PID|GOAL|MODE)?[ -~]{0,40}") {
        let _ = TextCommand::parse(&line);
        let _ = TextRow::parse(&line);
    }
}

#[test]
fn the_widest_row_fits_its_line() {
    let far = -1e30;
    let row = TextRow::Mission(MissionRow {
        dt_ms: u32::MAX,
        reference_rpm: Wheels::both(far),
        heading_reference_deg: far,
        goal_x_m: far,
        goal_y_m: far,
        x_m: far,
        y_m: far,
        heading_deg: far,
        state: 255,
        right_cm: far,
        left_cm: far,
        front_cm: far,
    });
    assert!(line(&row).len() < MAX_LINE);
    assert!(line(&row).ends_with("\r\n"));
}

#[test]
fn commands_of_the_original_are_understood() {
    let parse = TextCommand::parse;
    assert_eq!(parse("ON"), Ok(TextCommand::On));
    assert_eq!(parse(" off "), Ok(TextCommand::Off));
    assert_eq!(parse("REF 30"), Ok(TextCommand::Reference(30.0)));
    assert_eq!(
        parse("REF A -70.5"),
        Ok(TextCommand::WheelReference(Side::Right, -70.5))
    );
    assert_eq!(
        parse("REF B 40"),
        Ok(TextCommand::WheelReference(Side::Left, 40.0))
    );
    assert_eq!(
        parse("GOAL 0.5 -0.5"),
        Ok(TextCommand::Goal {
            x_m: 0.5,
            y_m: -0.5
        })
    );
    let gains = TextCommand::Gains {
        side: Side::Right,
        kp: 1.0,
        ki: 0.001,
        kd: 0.0,
    };
    assert_eq!(parse("PID A 1 0.001 0"), Ok(gains));
    assert_eq!(parse("MODE 5"), Ok(TextCommand::Mode(5)));
}

#[test]
fn what_is_wrong_with_a_line_is_reported() {
    for (line, error) in [
        ("", TextError::UnknownCommand),
        ("ONE", TextError::UnknownCommand),
        ("ON 1", TextError::Extra),
        ("REF", TextError::Missing),
        ("REF A", TextError::Missing),
        ("REF C 1", TextError::NotANumber(1)),
        ("REF nan", TextError::NotANumber(1)),
        ("REF 1 2", TextError::Extra),
        ("GOAL 1 x", TextError::NotANumber(2)),
        ("PID 1 2 3", TextError::UnknownMotor),
        ("PID A 1 2", TextError::Missing),
        ("MODE 12", TextError::NotANumber(1)),
    ] {
        assert_eq!(TextCommand::parse(line), Err(error), "{line}");
    }
    for (line, error) in [
        ("", TextError::Columns),
        ("1,2,3", TextError::Columns),
        ("1,2,3,4,5,6,x", TextError::NotANumber(7)),
        ("1,2,,4,5,6,7", TextError::NotANumber(3)),
        ("1,2,3,4,5,6,700", TextError::OutOfRange(7)),
        ("-1,2,3,4,5,6,7", TextError::OutOfRange(1)),
    ] {
        assert_eq!(TextRow::parse(line), Err(error), "{line}");
    }
    assert_eq!(
        TextRow::parse_as(RowKind::Distance, "1,2,3"),
        Err(TextError::Missing)
    );
    assert_eq!(
        TextRow::parse_as(RowKind::Distance, "1,2,3,4,1,6,7,8"),
        Err(TextError::Extra)
    );
}

#[test]
fn a_recorded_file_is_recognised_by_its_header() {
    let header = "dt_ms,speed_a_rpm,speed_b_rpm,reference_rpm,mode,pwm_a,pwm_b\r";
    assert_eq!(csv::recognise(header), Some(RowKind::Speed));
    let Ok(TextRow::Speed(row)) = TextRow::parse_as(RowKind::Speed, "40,15.63,-12.5,60,5,100,-103")
    else {
        panic!("no row")
    };
    assert_eq!(
        row.wheel_rpm,
        Wheels {
            left: -12.5,
            right: 15.63
        }
    );
    assert_eq!(
        (row.dt_ms, row.pwm),
        (
            40,
            Wheels {
                left: -103,
                right: 100
            }
        )
    );
    for kind in RowKind::ALL {
        let names: Vec<_> = kind.columns().iter().map(|column| column.name).collect();
        assert_eq!(csv::recognise(&names.join(", ")), Some(kind));
        for column in kind.columns() {
            assert!(column.name.ends_with(column.unit));
        }
    }
    assert_eq!(csv::recognise("time,left,right"), None);
    assert_eq!(csv::recognise(""), None);
}

#[test]
fn clear_and_faulty_keep_their_meaning_in_centimetres() {
    for range in [Range::Valid(0.5), Range::Clear, Range::Faulty] {
        assert_eq!(range_from_cm(cm_from_range(range)), range);
    }
}

/// The recordings of the real robot, if the variable points to them.
#[test]
fn every_row_of_the_real_recordings_is_read() {
    let Some(folder) = std::env::var_os("RUMBO_DATA") else {
        return;
    };
    let mut rows = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            let text = std::fs::read_to_string(&path).unwrap();
            let (header, body) = text.split_once('\n').unwrap();
            let kind = csv::recognise(header).unwrap();
            for line in body.lines() {
                TextRow::parse_as(kind, line)
                    .unwrap_or_else(|error| panic!("{}: {line}: {error}", path.display()));
                rows += 1;
            }
        }
    }
    assert!(rows > 0);
}

/// Rows of the report's sketches as they are published: no time, a blank after each comma.
#[test]
fn rows_of_the_published_sketches_are_known_by_their_columns() {
    let Ok(TextRow::Distance(row)) = TextRow::parse("30, 106.40, -76.40, 115") else {
        panic!("mode 1");
    };
    assert_eq!(
        (row.mode, row.dt_ms, row.left_cm, row.reference_cm),
        (1, 0, 106.4, 30.0)
    );
    assert_eq!(row.pwm, Wheels::both(115));

    let Ok(TextRow::Distance(row)) =
        TextRow::parse("30, 118.49, 120.38, 0, 119.20, 8.95, -89.20, 115, 124")
    else {
        panic!("mode 2");
    };
    // The first sonar is the right one there.
    assert_eq!((row.mode, row.left_cm, row.right_cm), (2, 120.38, 118.49));
    assert_eq!(
        row.pwm,
        Wheels {
            left: 124,
            right: 115
        }
    );

    let Ok(TextRow::Distance(row)) =
        TextRow::parse("58.58, 57.52, 57.49, 57.85, 0.00, 4.33, 74, 70")
    else {
        panic!("mode 3");
    };
    // And the front one here, `left` of the rig.
    assert_eq!((row.mode, row.left_cm, row.right_cm), (3, 58.58, 57.52));

    let Ok(TextRow::Speed(row)) = TextRow::parse("15.63, 12.50, 60.00, 60.00, 100, 103") else {
        panic!("mode 5");
    };
    assert_eq!(
        (row.wheel_rpm, row.reference_rpm),
        (
            Wheels {
                left: 12.5,
                right: 15.63
            },
            60.0
        )
    );

    let Ok(TextRow::Waypoints(row)) =
        TextRow::parse("78.00, 86.00, 0.98, 1.20, 0.98, 0.02, 0.01, -0.02, 0.91, 1")
    else {
        panic!("mode 7");
    };
    assert_eq!(
        row.reference_rpm,
        Wheels {
            left: 86.0,
            right: 78.0
        }
    );
    assert_eq!((row.x_m, row.y_m, row.heading_deg), (0.01, -0.02, 0.91));
}

#[test]
fn numbers_that_only_look_like_a_published_row_are_none() {
    for line in [
        "1,2,3,4",
        "30, 106.40, 76.40, 115",
        "30, 106.40, -76.40, 400",
        "30, 1, 2, 3, 4, 5, 6, 7, 8",
    ] {
        assert!(TextRow::parse(line).is_err(), "{line}");
    }
    // A row with a time has as many columns as the published one of mode 7.
    let Ok(TextRow::Waypoints(row)) = TextRow::parse("64,28.12,25,78,86,0.01,0,0.91,122,134")
    else {
        panic!("mode 7");
    };
    assert_eq!(row.dt_ms, 64);
}
