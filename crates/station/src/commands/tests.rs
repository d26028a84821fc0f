//! What the command manager promises.

use super::*;
use crate::round_trip::FIRST_TIMEOUT_US;
use proptest::prelude::*;
use rumbo_control::mode::ModeId;

const SESSION: u8 = 7;

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
    manager.submit(Command::Arm, 0).unwrap();
    let first = manager.poll(0).unwrap();
    assert_eq!(manager.poll(FIRST_TIMEOUT_US - 1), None);
    let again = manager.poll(FIRST_TIMEOUT_US).unwrap();
    assert_eq!(first, again);
    manager.acknowledge(&ack(number_of(first)), FIRST_TIMEOUT_US + 50_000);
    assert_eq!(
        manager.take_outcomes(),
        [Outcome {
            command: Command::Arm,
            fate: Fate::Applied(0.0)
        }]
    );
    assert_eq!(manager.poll(10_000_000), None);
}

#[test]
fn the_next_command_waits_for_the_acknowledgement() {
    let mut manager = CommandManager::new(SESSION);
    manager
        .submit(Command::Mode(ModeId::FrontDistance), 0)
        .unwrap();
    manager.submit(Command::Reference(0.5), 0).unwrap();
    let first = manager.poll(0).unwrap();
    assert_eq!(manager.poll(1_000), None);
    manager.acknowledge(&ack(number_of(first)), 60_000);
    let second = manager.poll(60_000).unwrap();
    assert_eq!(command_of(second), Command::Reference(0.5));
    assert_ne!(number_of(first), number_of(second));
}

#[test]
fn stop_goes_first_and_nothing_older_follows_it() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::Arm, 0).unwrap();
    manager.submit(Command::Reference(0.5), 0).unwrap();
    let arm = manager.poll(0).unwrap();
    manager.submit(Command::Stop, 10_000).unwrap();
    let stop = manager.poll(10_000).unwrap();
    assert_eq!(command_of(stop), Command::Stop);
    // The answer to the command that STOP overtook ends nothing.
    manager.acknowledge(&ack(number_of(arm)), 20_000);
    manager.take_outcomes();
    manager.acknowledge(&ack(number_of(stop)), 60_000);
    assert_eq!(
        manager.take_outcomes(),
        [Outcome {
            command: Command::Stop,
            fate: Fate::Applied(0.0)
        }]
    );
    assert_eq!(manager.poll(10_000_000), None);
}

#[test]
fn stop_is_taken_when_the_queue_is_full() {
    let mut manager = CommandManager::new(SESSION);
    for _ in 0..MAX_WAITING {
        manager.submit(Command::Arm, 0).unwrap();
    }
    assert_eq!(manager.submit(Command::Arm, 0), Err(QueueFull));
    manager.submit(Command::Stop, 0).unwrap();
    assert_eq!(command_of(manager.poll(0).unwrap()), Command::Stop);
}

#[test]
fn an_old_start_is_given_up_and_a_setting_is_not() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit(Command::Arm, 0).unwrap();
    manager.submit(Command::Reference(0.5), 0).unwrap();
    assert_eq!(command_of(manager.poll(0).unwrap()), Command::Arm);
    let next = manager.poll(MOTION_EXPIRY_US).unwrap();
    assert_eq!(command_of(next), Command::Reference(0.5));
    assert_eq!(
        manager.take_outcomes(),
        [Outcome {
            command: Command::Arm,
            fate: Fate::Expired
        }]
    );
    assert_eq!(manager.poll(100 * MOTION_EXPIRY_US), Some(next));
}

#[test]
fn reading_parameters_gives_way_to_the_operator() {
    let mut manager = CommandManager::new(SESSION);
    manager.submit_background(Command::GetParam { id: 0 });
    manager.submit_background(Command::GetParam { id: 1 });
    let read = manager.poll(0).unwrap();
    manager.submit(Command::ClearFault, 1_000).unwrap();
    manager.acknowledge(&ack(number_of(read)), 50_000);
    assert_eq!(
        command_of(manager.poll(50_000).unwrap()),
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
        }) = manager.poll(now_us)
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
    manager.submit(Command::Arm, 0).unwrap();
    manager.poll(0);
    manager.robot_restarted();
    assert_eq!(manager.poll(1_000_000), None);
    assert_eq!(
        manager.take_outcomes(),
        [Outcome {
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
    fn over_a_link_that_loses_frames_each_command_is_applied_once_and_in_order(
        lost in proptest::collection::vec(any::<(bool, bool)>(), 200),
    ) {
        let mut manager = CommandManager::new(SESSION);
        let mut robot = Robot::default();
        let asked: Vec<Command> = (0..10u8).map(|id| Command::SetParam { id, value: 1.0 }).collect();
        for command in &asked {
            manager.submit(*command, 0).unwrap();
        }
        let mut lost = lost.into_iter();
        let mut now_us = 0;
        while manager.unacknowledged() > 0 {
            if let Some(sent) = manager.poll(now_us) {
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
        prop_assert_eq!(robot.applied, asked);
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
        let asked = manager.poll(step * 100_000).unwrap();
        read.push(command_of(asked));
        manager.acknowledge(&ack(number_of(asked)), step * 100_000 + 50_000);
    }
    assert_eq!(read, [2, 0, 1, 3].map(|id| Command::GetParam { id }));
}
