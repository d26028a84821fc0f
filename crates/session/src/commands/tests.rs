//! What the command manager promises.

use super::*;
use crate::round_trip::FIRST_TIMEOUT_US;
use proptest::prelude::*;
use rumbo_control::mode::ModeId;

const SESSION: u8 = 7;
const SEEN: RobotTime = RobotTime { start: 1, ms: 900 };

fn number_of(sent: ToRobot) -> u16 {
    match sent {
        ToRobot::Command { number, .. } => number,
        other => panic!("not a command: {other:?}"),
    }
}

fn command_of(sent: ToRobot) -> Command {
    match sent {
        ToRobot::Command { command, .. } => command,
        other => panic!("not a command: {other:?}"),
    }
}

fn ack(number: u16) -> Ack {
    Ack {
        session: SESSION,
        number,
        result: Ok(0.0),
    }
}

#[test]
fn a_command_is_repeated_with_its_number_until_it_is_acknowledged() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::Arm, SEEN, 0).unwrap();
    let first = manager.poll(SEEN, 0).unwrap();
    assert_eq!(manager.poll(SEEN, FIRST_TIMEOUT_US - 1), None);
    let again = manager.poll(SEEN, FIRST_TIMEOUT_US).unwrap();
    assert_eq!(first, again);
    manager.acknowledge(&ack(number_of(first)), FIRST_TIMEOUT_US + 50_000);
    assert_eq!(
        manager.take_outcomes(),
        [CommandOutcome {
            command: Command::Arm,
            fate: Fate::Applied(0.0)
        }]
    );
    assert_eq!(manager.poll(SEEN, 10_000_000), None);
}

#[test]
fn the_next_command_waits_for_the_acknowledgement() {
    let mut manager = CommandManager::new(SESSION);
    manager
        .submit(Command::Mode(ModeId::FrontDistance), SEEN, 0)
        .unwrap();
    manager.submit(Command::Reference(0.5), SEEN, 0).unwrap();
    let first = manager.poll(SEEN, 0).unwrap();
    assert_eq!(manager.poll(SEEN, 1_000), None);
    manager.acknowledge(&ack(number_of(first)), 60_000);
    let second = manager.poll(SEEN, 60_000).unwrap();
    assert_eq!(command_of(second), Command::Reference(0.5));
    assert_ne!(number_of(first), number_of(second));
}

#[test]
fn stop_goes_first_and_nothing_older_follows_it() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::Arm, SEEN, 0).unwrap();
    manager.submit(Command::Reference(0.5), SEEN, 0).unwrap();
    let arm = manager.poll(SEEN, 0).unwrap();
    manager.submit(Command::Stop, SEEN, 10_000).unwrap();
    let stop = manager.poll(SEEN, 10_000).unwrap();
    assert_eq!(command_of(stop), Command::Stop);
    // The answer to the command that STOP overtook ends nothing.
    manager.acknowledge(&ack(number_of(arm)), 20_000);
    manager.take_outcomes();
    manager.acknowledge(&ack(number_of(stop)), 60_000);
    assert_eq!(
        manager.take_outcomes(),
        [CommandOutcome {
            command: Command::Stop,
            fate: Fate::Applied(0.0)
        }]
    );
    assert_eq!(manager.poll(SEEN, 10_000_000), None);
}

#[test]
fn stop_is_taken_when_the_queue_is_full() {
    let mut manager = CommandManager::new(SESSION);
    for _ in 0..MAX_WAITING {
        manager.submit(Command::Arm, SEEN, 0).unwrap();
    }
    assert_eq!(manager.submit(Command::Arm, SEEN, 0), Err(QueueFull));
    manager.submit(Command::Stop, SEEN, 0).unwrap();
    assert_eq!(command_of(manager.poll(SEEN, 0).unwrap()), Command::Stop);
}

#[test]
fn an_order_is_given_up_2_s_after_it_was_given_whether_it_waits_or_is_under_way() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::ClearFault, SEEN, 0).unwrap();
    manager.submit(Command::Arm, SEEN, 500_000).unwrap();
    manager
        .submit(Command::Reference(0.5), SEEN, 1_900_000)
        .unwrap();
    assert_eq!(
        command_of(manager.poll(SEEN, 0).unwrap()),
        Command::ClearFault
    );
    let next = manager.poll(SEEN, EXPIRY_US).unwrap();
    assert_eq!(command_of(next), Command::Arm);
    let next = manager.poll(SEEN, 500_000 + EXPIRY_US).unwrap();
    assert_eq!(command_of(next), Command::Reference(0.5));
    assert_eq!(manager.poll(SEEN, 1_900_000 + EXPIRY_US), None);
    let given_up = [Command::ClearFault, Command::Arm, Command::Reference(0.5)];
    let given_up = given_up.map(|command| CommandOutcome {
        command,
        fate: Fate::Expired,
    });
    assert_eq!(manager.take_outcomes(), given_up);
    assert_eq!(manager.unacknowledged(), 0);
}

#[test]
fn a_repetition_carries_the_time_at_which_the_order_was_given() {
    let later = RobotTime {
        start: 1,
        ms: 9_000,
    };
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::ClearFault, SEEN, 0).unwrap();
    manager.submit(Command::Arm, SEEN, 0).unwrap();
    let clear = manager.poll(SEEN, 0).unwrap();
    manager.acknowledge(&ack(number_of(clear)), 50_000);
    for now_us in [50_000, 1_500_000] {
        let Some(ToRobot::Command { command, seen, .. }) = manager.poll(later, now_us) else {
            panic!("nothing is sent");
        };
        assert_eq!((command, seen), (Command::Arm, SEEN));
    }
}

#[test]
fn a_part_of_a_route_has_its_time_from_when_it_is_its_turn() {
    let later = RobotTime {
        start: 1,
        ms: 9_000,
    };
    let mut manager = CommandManager::new(SESSION);
    manager.submit_in_turn([Command::Lane, Command::Mode(ModeId::Mission)]);
    let first = manager.poll(SEEN, 0).unwrap();
    manager.acknowledge(&ack(number_of(first)), 1_900_000);
    let Some(ToRobot::Command { command, seen, .. }) = manager.poll(later, 3_000_000) else {
        panic!("nothing is sent");
    };
    assert_eq!((command, seen), (Command::Mode(ModeId::Mission), later));
    assert_eq!(manager.poll(later, 3_000_000 + EXPIRY_US), None);
}

#[test]
fn when_the_link_is_lost_everything_is_given_up_but_stop() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::ClearFault, SEEN, 0).unwrap();
    manager.submit(Command::Arm, SEEN, 0).unwrap();
    manager.submit_background(Command::GetParam { id: 0 });
    manager.poll(SEEN, 0);
    manager.give_up(Fate::LinkLost);
    assert_eq!(manager.poll(SEEN, 60_000_000), None);
    let given_up = [Command::Arm, Command::ClearFault].map(|command| CommandOutcome {
        command,
        fate: Fate::LinkLost,
    });
    assert_eq!(manager.take_outcomes(), given_up);
    manager.submit(Command::Stop, SEEN, 60_000_000).unwrap();
    manager.give_up(Fate::LinkLost);
    let stop = manager.poll(SEEN, 90_000_000).unwrap();
    assert_eq!(command_of(stop), Command::Stop);
    assert_eq!(manager.stop_since_us(), Some(60_000_000));
}

#[test]
fn off_goes_first_too_and_gives_way_to_stop_alone() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::Arm, SEEN, 0).unwrap();
    manager.submit(Command::Reference(0.5), SEEN, 0).unwrap();
    manager.poll(SEEN, 0);
    manager.submit(Command::Disarm, SEEN, 10_000).unwrap();
    assert_eq!(
        command_of(manager.poll(SEEN, 10_000).unwrap()),
        Command::Disarm
    );
    assert_eq!(
        command_of(manager.poll(SEEN, 90_000_000).unwrap()),
        Command::Disarm
    );
    manager.submit(Command::Stop, SEEN, 90_000_000).unwrap();
    assert_eq!(
        command_of(manager.poll(SEEN, 90_000_000).unwrap()),
        Command::Stop
    );
    manager.submit(Command::Disarm, SEEN, 90_000_001).unwrap();
    assert_eq!(
        command_of(manager.poll(SEEN, 90_000_001).unwrap()),
        Command::Stop
    );
    let superseded = manager.take_outcomes();
    assert_eq!(superseded.len(), 3, "{superseded:?}");
}

#[test]
fn a_read_that_is_not_answered_does_not_keep_an_order_waiting() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit_background(Command::GetParam { id: 0 });
    manager.poll(SEEN, 0);
    manager.submit(Command::Arm, SEEN, 1_000).unwrap();
    assert_eq!(manager.poll(SEEN, 2_000), None);
    let next = manager.poll(SEEN, FIRST_TIMEOUT_US).unwrap();
    assert_eq!(command_of(next), Command::Arm);
    manager.acknowledge(&ack(number_of(next)), 300_000);
    let next = manager.poll(SEEN, 300_000).unwrap();
    assert_eq!(command_of(next), Command::GetParam { id: 0 });
}

#[test]
fn reading_parameters_gives_way_to_the_operator() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit_background(Command::GetParam { id: 0 });
    manager.submit_background(Command::GetParam { id: 1 });
    let read = manager.poll(SEEN, 0).unwrap();
    manager.submit(Command::ClearFault, SEEN, 1_000).unwrap();
    manager.acknowledge(&ack(number_of(read)), 50_000);
    assert_eq!(
        command_of(manager.poll(SEEN, 50_000).unwrap()),
        Command::ClearFault
    );
}

#[test]
fn a_robot_that_takes_the_numbers_for_old_ones_is_met_in_another_session() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit_background(Command::GetParam { id: 0 });
    let mut answered = None;
    for step in 0..1_000 {
        let now_us = step * 10_000;
        if let Some(ToRobot::Command {
            session, number, ..
        }) = manager.poll(SEEN, now_us)
            && session != SESSION
        {
            answered = Some(session);
            manager.acknowledge(
                &Ack {
                    session,
                    number,
                    result: Ok(1.0),
                },
                now_us,
            );
        }
    }
    assert_eq!(answered, Some(SESSION + 1));
    assert_eq!(manager.take_outcomes().len(), 1);
}

#[test]
fn a_restarted_robot_is_not_asked_to_arm() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::Arm, SEEN, 0).unwrap();
    manager.poll(SEEN, 0);
    manager.give_up(Fate::RobotRestarted);
    assert_eq!(manager.poll(SEEN, 1_000_000), None);
    assert_eq!(
        manager.take_outcomes(),
        [CommandOutcome {
            command: Command::Arm,
            fate: Fate::RobotRestarted
        }]
    );
}

/// The other end of a link that loses frames: applies a number once, acknowledges every arrival.
#[derive(Default)]
struct Robot {
    last: Option<u16>,
    applied: Vec<Command>,
}

impl Robot {
    fn take(&mut self, sent: ToRobot) -> Ack {
        let (number, command) = (number_of(sent), command_of(sent));
        if self.last != Some(number) {
            self.last = Some(number);
            self.applied.push(command);
        }
        ack(number)
    }
}

proptest! {
    #[test]
    fn over_a_link_that_loses_frames_each_command_is_applied_once_at_most_and_in_order(
        lost in proptest::collection::vec(any::<(bool, bool)>(), 200),
    ) {
        let mut manager = CommandManager::new(SESSION);
        let mut robot = Robot::default();
        let asked: Vec<Command> = (0..10u8).map(|id| Command::SetParam { id, value: 1.0 }).collect();
        manager.submit_in_turn(asked.iter().copied());
        let mut lost = lost.into_iter();
        let mut now_us = 0;
        while manager.unacknowledged() > 0 {
            if let Some(sent) = manager.poll(SEEN, now_us) {
                let (lost_there, lost_back) = lost.next().unwrap_or_default();
                if !lost_there {
                    let answer = robot.take(sent);
                    if !lost_back {
                        manager.acknowledge(&answer, now_us + 40_000);
                    }
                }
            }
            now_us += 50_000;
        }
        let mut left = asked.iter();
        prop_assert!(robot.applied.iter().all(|applied| left.any(|asked| asked == applied)));
        let outcomes = manager.take_outcomes();
        prop_assert_eq!(outcomes.len(), asked.len());
        for outcome in outcomes {
            let known = matches!(outcome.fate, Fate::Applied(_) | Fate::Expired);
            let applied = robot.applied.contains(&outcome.command);
            prop_assert!(known && (applied || outcome.fate == Fate::Expired));
        }
    }
}

#[test]
fn what_is_wanted_first_is_read_first_and_the_rest_as_it_came() {
    let mut manager = CommandManager::new(SESSION);
    (0..4).for_each(|id| manager.submit_background(Command::GetParam { id }));
    manager.read_first(|command| match command {
        Command::GetParam { id: 2 } => 0,
        _ => 1,
    });
    let mut read = Vec::new();
    for step in 0..4u64 {
        let asked = manager.poll(SEEN, step * 100_000).unwrap();
        read.push(command_of(asked));
        manager.acknowledge(&ack(number_of(asked)), step * 100_000 + 50_000);
    }
    assert_eq!(read, [2, 0, 1, 3].map(|id| Command::GetParam { id }));
}

#[test]
fn a_velocity_does_not_outlive_stop_nor_the_link() {
    let velocity = Velocity {
        forward_m_s: 0.2,
        yaw_rad_s: 0.0,
    };
    let endings: [fn(&mut CommandManager); 3] = [
        |manager| manager.submit(Command::Stop, SEEN, 0).unwrap(),
        |manager| manager.submit(Command::Disarm, SEEN, 0).unwrap(),
        |manager| manager.give_up(Fate::LinkLost),
    ];
    for end in endings {
        let mut manager = CommandManager::new(SESSION);
        manager.submit_velocity(velocity, SEEN);
        end(&mut manager);
        assert_eq!(manager.poll_velocity(100_000), None);
        manager.submit_velocity(velocity, SEEN);
        let sent = ToRobot::Velocity {
            velocity,
            seen: SEEN,
        };
        assert_eq!(manager.poll_velocity(100_000), Some(sent));
    }
}
