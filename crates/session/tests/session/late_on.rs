//! An order that its robot cannot get at once is never obeyed later: the port is gone, or the robot is, or it starts
//! again.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use rumbo_session::Target;
use rumbo_session::client::{KnownTable, LinkEvent, RobotClient};
use rumbo_wire::Command;
use support::Toy;

const STEP_US: u64 = 5_000;

/// A station and a robot, and a link between them that can be cut.
struct Bench {
    client: RobotClient,
    toy: Toy,
    events: Vec<LinkEvent>,
}

impl Bench {
    fn new(table: KnownTable) -> Self {
        Self {
            client: RobotClient::new(3, false, table),
            toy: Toy::default(),
            events: Vec::new(),
        }
    }

    /// Lets `seconds` pass; while `cut`, nothing arrives at either end.
    fn pass(&mut self, seconds: f64, cut: bool) {
        let until_us = self.toy.now_us() + (seconds * 1e6) as u64;
        let mut bytes = Vec::new();
        while self.toy.now_us() < until_us {
            self.toy.advance(STEP_US).unwrap();
            let now_us = self.toy.now_us();
            bytes.clear();
            self.toy.receive(&mut bytes);
            if !cut {
                self.client.receive(&bytes, now_us, &mut self.events);
            }
            bytes.clear();
            self.client.poll(now_us, &mut bytes, &mut self.events);
            if !cut {
                self.toy.send(&bytes).unwrap();
            }
        }
    }

    /// Gives an order; a refusal is as good as an order that is given up.
    fn order(&mut self, command: Command) {
        let now_us = self.toy.now_us();
        let _ = self.client.submit(command, now_us);
    }

    #[track_caller]
    fn never_armed(&self) {
        let applied = &self.toy.applied;
        assert!(!applied.contains(&Command::Arm), "{applied:?}");
    }
}

const NO_TABLE: KnownTable = KnownTable { schema: 0, len: 0 };

#[test]
fn a_reference_and_on_given_while_the_link_is_cut_are_not_obeyed_32_s_later() {
    for cut_before_s in [0.05, 3.0] {
        let mut bench = Bench::new(NO_TABLE);
        bench.pass(2.0, false);
        bench.pass(cut_before_s, true);
        bench.order(Command::Reference(0.5));
        bench.order(Command::Arm);
        bench.pass(32.0, true);
        bench.pass(5.0, false);
        bench.never_armed();
    }
}

#[test]
fn on_behind_two_settings_is_not_obeyed_62_s_later() {
    let mut bench = Bench::new(NO_TABLE);
    bench.pass(2.0, false);
    bench.pass(0.05, true);
    bench.order(Command::SetParam { id: 0, value: 0.03 });
    bench.order(Command::ClearFault);
    bench.order(Command::Arm);
    bench.pass(62.0, true);
    bench.pass(5.0, false);
    bench.never_armed();
}

#[test]
fn on_behind_the_reading_of_parameters_is_not_obeyed_22_s_later() {
    let mut bench = Bench::new(KnownTable::OURS);
    bench.pass(0.5, false);
    bench.pass(0.05, true);
    bench.order(Command::Arm);
    bench.pass(22.0, true);
    bench.pass(5.0, false);
    bench.never_armed();
}

#[test]
fn a_robot_that_starts_again_and_says_so_at_once_needs_a_new_on() {
    let mut bench = Bench::new(NO_TABLE);
    bench.pass(2.0, false);
    bench.pass(0.05, true);
    bench.order(Command::Reference(0.5));
    bench.order(Command::Arm);
    bench.pass(11.0, true);
    bench.toy.restart();
    bench.pass(5.0, false);
    bench.never_armed();
}
