use super::*;
use crate::mode::ActiveMode;
use crate::mode::ModeId;
use crate::types::{AgedRange, Pose, Range, SonarId, SonarReading, SonarView};

/// A network of one layer that drives straight on by its biases, and its bytes.
fn network() -> (NetworkShape, impl Fn(u16) -> u8) {
    let shape = NetworkShape::new(1, &[3]).unwrap();
    let neurons = [(0, 60), (0, 30), (0, -127)];
    let read = move |at: u16| {
        let first = shape.first_neuron();
        let place = at.wrapping_sub(first);
        let (_, bias): (u8, i32) = neurons[usize::from(place / 6).min(2)];
        match (at < first, place % 6) {
            (true, _) | (false, 0 | 5) => 0,
            (false, byte) => bias.to_le_bytes()[usize::from(byte) - 1],
        }
    };
    (shape, read)
}

/// A robot whose sonars answer by turns.
fn estimate(tick: u8) -> Estimate {
    let sonar = SonarId::ALL[usize::from(tick) / 4 % 3];
    let range = Range::Valid(1.0);
    let mut estimate = Estimate {
        ranges: [AgedRange::fresh(range); 3],
        ..Estimate::default()
    };
    estimate.reading = tick.is_multiple_of(4).then_some(SonarReading {
        sonar,
        range,
        view: SonarView::default(),
        servo_rad: 0.0,
    });
    estimate
}

/// Actions of as many ticks, with observations of zero.
fn driven(mode: &mut ActiveMode, ticks: u8) -> Action {
    let (shape, read) = network();
    let mut action = Action::default();
    for tick in 0..ticks {
        action = mode.step(&Params::default(), &estimate(tick)).unwrap();
        mode.decide(&shape, &read, |_| Observation::default());
    }
    action
}

#[test]
fn without_a_goal_the_wheels_are_released() {
    let mut mode = ActiveMode::new(ModeId::Policy);
    let action = driven(&mut mode, 60);
    assert_eq!(
        (action.drive, action.state),
        (Drive::Release, Phase::Wait as u8)
    );
}

#[test]
fn what_the_network_decides_drives_from_the_next_decision_on() {
    let mut mode = ActiveMode::new(ModeId::Policy);
    mode.set_goal(2.0, 0.0).unwrap();
    let first = driven(&mut mode, DECISION_TICKS + 1);
    assert_eq!(
        (first.drive, first.state),
        (Drive::Release, Phase::Seek as u8)
    );
    let next = driven(&mut mode, 1);
    let wheels = Wheels {
        left: 60.0,
        right: 30.0,
    }
    .map(|share: f32| share * (1.0 / 127.0) * WHEEL_RAD_S);
    assert_eq!(next.drive, Drive::WheelSpeed(wheels));
    assert_eq!(next.look.servo, ServoAngle(-SERVO_RAD));
}

#[test]
fn at_the_goal_the_wheels_are_released_until_another_is_given() {
    let mut mode = ActiveMode::new(ModeId::Policy);
    mode.set_goal(0.04, 0.0).unwrap();
    let action = driven(&mut mode, 30);
    let half = Wheels {
        left: 30.0,
        right: 15.0,
    };
    let half = half.map(|share: f32| share * (1.0 / 127.0) * WHEEL_RAD_S);
    assert_eq!(action.drive, Drive::WheelSpeed(half), "half the way");
    // It does not get nearer.
    let action = driven(&mut mode, 80);
    assert_eq!((action.drive, action.reached), (Drive::Release, true));
    // Somebody pushes it.
    let pushed = Estimate {
        pose: Pose {
            x_m: 0.5,
            ..Pose::default()
        },
        ..estimate(0)
    };
    let action = mode.step(&Params::default(), &pushed).unwrap();
    assert_eq!((action.drive, action.reached), (Drive::Release, true));
    mode.set_goal(1.0, 0.0).unwrap();
    let action = driven(&mut mode, 30);
    assert!(matches!(action.drive, Drive::WheelSpeed(_)) && !action.reached);
    assert_eq!(mode.reference().numbers(), [1.0, 0.0]);
}

#[test]
fn the_robot_stops_where_the_way_left_grows_again() {
    let mut mode = ActiveMode::new(ModeId::Policy);
    mode.set_goal(1.0, 0.0).unwrap();
    let reached = |x_m: f32, mode: &mut ActiveMode| {
        let at = Estimate {
            pose: Pose {
                x_m,
                ..Pose::default()
            },
            ..estimate(0)
        };
        mode.step(&Params::default(), &at).unwrap().reached
    };
    for x_m in [0.9, 0.93, 0.96, 0.99, 1.0, 1.002] {
        assert!(!reached(x_m, &mut mode), "{x_m}");
    }
    assert!(reached(1.004, &mut mode));
}

#[test]
fn a_silent_or_faulty_sonar_stops_the_robot() {
    for (range, fault) in [
        (None, Fault::SonarStale),
        (Some(Range::Faulty), Fault::SonarFaulty),
    ] {
        let mut mode = ActiveMode::new(ModeId::Policy);
        mode.set_goal(2.0, 0.0).unwrap();
        driven(&mut mode, 60);
        let stopped = (0..200).find_map(|tick| {
            let mut estimate = estimate(tick);
            estimate.reading = match (estimate.reading, range) {
                (Some(reading), Some(range)) => Some(SonarReading { range, ..reading }),
                _ => None,
            };
            mode.step(&Params::default(), &estimate).err()
        });
        assert_eq!(stopped, Some(fault));
    }
}
