//! Services of ROS 2 without a question: each call is an order. It is answered when the robot's state shows what was
//! asked for, or the robot has refused it.

use super::{Live, PATIENCE, report};
use crate::node::Call;
use crate::station::{Mode, Order};
use rumbo_log::RobotState;
use std::time::Instant;

/// What a service is for: the order, and how the robot's state shows that it was done.
pub(super) enum Service {
    Robot(Order, fn(&RobotState) -> bool),
    Mode(u8),
    /// It does not reach the robot.
    Control(Order),
}

/// The services by name.
pub(super) fn services(modes: &[Mode]) -> Vec<(String, Service)> {
    let off: fn(&RobotState) -> bool = |robot| !robot.armed;
    let services = [
        ("arm", Service::Robot(Order::Arm, |robot| robot.armed)),
        ("disarm", Service::Robot(Order::Disarm, off)),
        ("stop", Service::Robot(Order::Stop, off)),
        (
            "clear_fault",
            Service::Robot(Order::ClearFault, |robot| robot.fault.is_none()),
        ),
        ("reset_pose", Service::Robot(Order::ResetPose, |_| true)),
        ("take_control", Service::Control(Order::TakeControl)),
        ("release_control", Service::Control(Order::ReleaseControl)),
    ];
    let services = services.map(|(name, service)| (name.to_owned(), service));
    let modes = modes
        .iter()
        .map(|mode| (format!("mode/{}", mode.name), Service::Mode(mode.id)));
    services.into_iter().chain(modes).collect()
}

/// A call that waits for the robot.
pub(super) struct Waiting {
    call: Call,
    order: u64,
    since: Instant,
}

impl Live {
    /// Gives the order of a call; one that does not reach the robot is answered at once.
    pub(super) fn begin(&mut self, call: Call) {
        let Some((_, service)) = self.services.get(call.service) else {
            return;
        };
        let order = match service {
            Service::Robot(order, _) | Service::Control(order) => *order,
            Service::Mode(mode) => Order::Mode { mode: *mode },
        };
        let for_robot = !matches!(service, Service::Control(_));
        match self.station.order(order) {
            Ok(order) if for_robot => self.waiting.push(Waiting {
                call,
                order,
                since: Instant::now(),
            }),
            given => self.answer(call, given.map(drop)),
        }
    }

    fn answer(&mut self, call: Call, done: Result<(), String>) {
        let answered = self.node.answer(call, done);
        report(answered, &mut self.reported);
    }

    /// Answers the calls whose outcome is known; `has_state`: the state is new.
    pub(super) fn settle(&mut self, has_state: bool) {
        for waiting in std::mem::take(&mut self.waiting) {
            let lasts = waiting.since.elapsed();
            let known = has_state && self.station.has_taken(waiting.order);
            let outcome = known.then(|| self.outcome(waiting.call)).flatten();
            let late = || Err("the robot has not confirmed it".to_owned());
            match outcome.or_else(|| (lasts > PATIENCE).then(late)) {
                None => self.waiting.push(waiting),
                Some(done) => self.answer(waiting.call, done),
            }
        }
    }

    /// The outcome of a call by the robot's state, if it is known.
    fn outcome(&self, call: Call) -> Option<Result<(), String>> {
        if let Some(why) = &self.state.refused {
            return Some(Err(why.clone()));
        }
        let robot = &self.state.robot;
        let is_done = match self.services.get(call.service)? {
            (_, Service::Robot(_, shows)) => shows(robot),
            (_, Service::Mode(mode)) => robot.mode == *mode,
            (_, Service::Control(_)) => true,
        };
        (is_done && self.state.link.unacknowledged == 0).then_some(Ok(()))
    }
}
