//! The protocol side alone, without threads or web: a client and the toy over a link that loses bytes.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use proptest::prelude::*;
use rumbo_session::Target;
use rumbo_session::client::{KnownTable, LinkEvent, RobotClient};
use rumbo_session::commands::Fate;
use rumbo_wire::Command;
use support::Toy;

const STEP_US: u64 = 5_000;

/// No parameters are read, so that every command is the test's.
const NO_TABLE: KnownTable = KnownTable { schema: 0, len: 0 };

/// Advances both by one step; `lose` says which bytes of each direction are lost.
fn step(
    client: &mut RobotClient,
    toy: &mut Toy,
    lose: &mut impl FnMut() -> bool,
    events: &mut Vec<LinkEvent>,
) {
    toy.advance(STEP_US).unwrap();
    let mut from_robot = Vec::new();
    toy.receive(&mut from_robot);
    from_robot.retain(|_| !lose());
    client.receive(&from_robot, toy.now_us(), events);
    let mut to_robot = Vec::new();
    client.poll(toy.now_us(), &mut to_robot, events);
    to_robot.retain(|_| !lose());
    toy.send(&to_robot).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]
    #[test]
    fn each_command_is_applied_once_at_most_and_in_order_though_bytes_get_lost(seed in any::<u32>()) {
        let mut random = seed;
        // One byte in fifty: a third of the telemetry frames fail their CRC.
        let mut lose = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            random >> 16 < 65_536 / 50
        };
        let mut toy = Toy::default();
        let mut client = RobotClient::new(3, true, NO_TABLE);
        let (mut events, mut asked) = (Vec::new(), Vec::new());
        while asked.len() < 20 && toy.now_us() < 200_000_000 {
            step(&mut client, &mut toy, &mut lose, &mut events);
            if client.connected() && client.link(toy.now_us()).unacknowledged == 0 {
                let command = Command::Reference(asked.len() as f32);
                client.submit(command, toy.now_us()).unwrap();
                asked.push(command);
            }
        }
        // One that is given up may have been applied.
        let mut left = asked.iter();
        prop_assert!(toy.applied.iter().all(|applied| left.any(|asked| asked == applied)), "{:?}", toy.applied);
        let done = events.iter().filter_map(|item| match item {
            LinkEvent::Ended(ended) if matches!(ended.fate, Fate::Applied(_)) => Some(ended.command),
            _ => None,
        });
        let done: Vec<Command> = done.collect();
        prop_assert!(done.iter().all(|command| toy.applied.contains(command)));
        prop_assert!(done.len() > 10, "{}", done.len());
    }
}

#[test]
fn silence_is_noticed_and_the_answer_after_it_too() {
    let mut toy = Toy::default();
    let mut client = RobotClient::new(3, true, NO_TABLE);
    let mut events = Vec::new();
    let mut run = |client: &mut RobotClient, toy: &mut Toy, cut: bool| {
        events.clear();
        (0..400).for_each(|_| step(client, toy, &mut || cut, &mut events));
        events
            .iter()
            .filter(|item| matches!(item, LinkEvent::Connected(_) | LinkEvent::Lost))
            .copied()
            .collect::<Vec<_>>()
    };
    assert!(matches!(
        run(&mut client, &mut toy, false)[..],
        [LinkEvent::Connected(_)]
    ));
    assert_eq!(run(&mut client, &mut toy, true), [LinkEvent::Lost]);
    assert!(!client.connected());
    assert!(matches!(
        run(&mut client, &mut toy, false)[..],
        [LinkEvent::Connected(_)]
    ));
}

#[test]
fn telemetry_keeps_its_time_over_the_link() {
    let mut toy = Toy::default();
    let mut client = RobotClient::new(3, true, NO_TABLE);
    let mut events = Vec::new();
    // Longer than a wrap of the robot's 16 bits.
    (0..70_000_000 / STEP_US).for_each(|_| step(&mut client, &mut toy, &mut || false, &mut events));
    let times: Vec<i64> = events
        .iter()
        .filter_map(|item| {
            if let LinkEvent::Telemetry(t_ms, _) = item {
                Some(*t_ms)
            } else {
                None
            }
        })
        .collect();
    assert_eq!(times.first(), Some(&40));
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] == 40));
}
