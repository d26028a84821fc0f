//! *Go to goal* of ROS 2: mode 8 drives to the goal's position around obstacles, mode 7 straight to its pose.
//!
//! ```text
//! goal -> checked, in the robot's terms -> order -> acknowledged: accepted -> reached, unreachable, off: its end
//! ```
//!
//! A newer goal replaces the one on the way, which is aborted. Mode 8 makes each goal reached its origin, from which goals
//! count: near its goal the robot gets the next one when it stands there and the new origin is known.

use super::{Live, PATIENCE, report};
use crate::aim::{Aim, is_task, order};
use crate::bridge::Caller;
use crate::navigate::{Distribution, Goal, Goals, Id, NAME, Question, Status};
use crate::station::Order;
use rumbo_log::{End, Level, LoggedEvent};
use rumbo_ros::convert::stamp;
use rumbo_ros::geometry::{ODOM, pose};
use rumbo_ros::messages::{Duration as Lasting, Header, Time};
use rumbo_ros::service_messages::{
    Accepted, Ended, FeedbackMessage, NavigateFeedback, PoseStamped, Uuid,
};
use rumbo_ros::topics::Topic;
use std::time::{Duration, Instant};

/// Nearer than this the robot may be there before a new goal arrives: the way in a second, and a little [m].
const NEAR_M: f64 = 0.5;
/// Telemetry after the goal is reached until its origin is known.
const ROWS: u64 = 2;
/// A robot that is to stop has done so within this time, or nobody knows.
const STOPPING: Duration = Duration::from_secs(3);

/// A client's goal that is not accepted yet.
struct Asked {
    caller: Caller,
    goal: Goal,
}

/// A goal that the robot has not acknowledged yet.
struct Ordered {
    asked: Asked,
    aim: Aim,
    /// The number of its order.
    order: u64,
    since: Instant,
}

/// A goal on its way.
struct Active {
    id: Id,
    aim: Aim,
    /// Session time when it was accepted [s], and the distance then [m].
    since_s: f64,
    first_m: f64,
    /// A client wants it canceled, since then.
    canceling: Option<Instant>,
    /// It is reached: telemetry frames received until then.
    reached: Option<u64>,
}

/// The goals of a robot.
#[derive(Default)]
pub(super) struct Navigation {
    distribution: Distribution,
    goals: Goals,
    /// The next goal, which waits.
    next: Option<Asked>,
    /// A goal that the robot has not acknowledged yet.
    ordered: Option<Ordered>,
    active: Option<Active>,
}

impl Navigation {
    pub(super) fn new(distribution: Distribution) -> Self {
        Self {
            distribution,
            ..Self::default()
        }
    }

    /// The robot is on its way, or will be.
    pub(super) fn lasts(&self) -> bool {
        self.next.is_some() || self.ordered.is_some() || self.active.is_some()
    }
}

impl Live {
    /// Takes what a client of the action wants.
    pub(super) fn navigate(&mut self, caller: Caller, question: Question) {
        match question {
            Question::Send(goal) => self.consider(Asked { caller, goal }),
            Question::Cancel(cancel) => {
                let (answer, ids) = self.navigation.goals.cancel(cancel);
                for id in ids {
                    self.cancel(id);
                }
                let answered = self.node.reply(caller, &answer);
                report(answered, &mut self.reported);
                self.show_goals();
            }
            Question::Result(id) => {
                if let Some(ended) = self.navigation.goals.result(id, caller) {
                    self.answer_end(caller, &ended);
                }
            }
        }
    }

    /// Stops the robot: STOP needs no control, so that a client can always cancel.
    fn cancel(&mut self, id: Id) {
        if let Some(active) = &mut self.navigation.active
            && active.id == id
        {
            active.canceling.get_or_insert_with(Instant::now);
            let stopped = self.station.order(Order::Stop);
            if let Err(why) = stopped {
                self.note(&format!("{NAME}: {why}"));
            }
        }
    }

    /// Orders a goal, or keeps it for later; of those that wait the newest counts.
    fn consider(&mut self, asked: Asked) {
        if let Some(older) = self.navigation.next.take() {
            self.reject(&older, "a newer goal has come");
        }
        match self.may_order() {
            true => self.order(asked),
            false => self.navigation.next = Some(asked),
        }
    }

    /// Whether a goal means to the robot what it means here: its origin does not move meanwhile.
    fn may_order(&self) -> bool {
        let Some(active) = &self.navigation.active else {
            return self.navigation.ordered.is_none();
        };
        let is_moving = active.canceling.is_some()
            || active.reached.is_some()
            || self
                .left_m(&active.aim)
                .is_none_or(|left_m| left_m < NEAR_M);
        self.navigation.ordered.is_none() && !is_moving
    }

    fn order(&mut self, asked: Asked) {
        let aim = match self.aim(&asked.goal) {
            Ok(aim) => aim,
            Err(why) => return self.reject(&asked, &why),
        };
        let order = order(&aim, self.mode());
        let order = order.ok_or_else(|| {
            "the robot is in another mode; call mode/mission, or mode/waypoints".to_owned()
        });
        match order.and_then(|order| self.station.order(order)) {
            Ok(order) => {
                self.navigation.ordered = Some(Ordered {
                    asked,
                    aim,
                    order,
                    since: Instant::now(),
                });
            }
            Err(why) => self.reject(&asked, &why),
        }
    }

    /// A goal in the robot's terms, or why it cannot be one.
    fn aim(&self, goal: &Goal) -> Result<Aim, String> {
        if self.navigation.goals.knows(goal.id) {
            return Err("there was a goal with this identity".into());
        }
        if !self.state.robot.armed {
            return Err("the robot is off; call arm".into());
        }
        let in_odom = self.converter.in_odom(&goal.frame, goal.at)?;
        let at = self.converter.from_origin(in_odom);
        let aim = Aim {
            in_odom,
            x_m: at.x_m as f32,
            y_m: at.y_m as f32,
            heading_rad: goal
                .has_heading
                .then_some(at.heading_rad.sin().atan2(at.heading_rad.cos()) as f32),
        };
        let numbers = [aim.x_m, aim.y_m, aim.heading_rad.unwrap_or(0.0)];
        match numbers.iter().all(|number| number.is_finite()) {
            true => Ok(aim),
            false => Err("its pose has a number that is not finite".into()),
        }
    }

    fn reject(&mut self, asked: &Asked, why: &str) {
        self.say(&format!("{NAME}: refused, {why}"));
        let answered = self.node.reply(asked.caller, &Accepted::default());
        report(answered, &mut self.reported);
    }

    /// Says something of the action: a client sees only that its goal is refused or aborted.
    fn say(&mut self, text: &str) {
        self.note(text);
        let event = LoggedEvent {
            t_s: self.state.t_s,
            level: Level::Warning,
            text: text.to_owned(),
        };
        // It is encoded as all others are.
        let _ = self.converter.event(&event);
    }

    /// Follows the robot on its way; `has_state`: the state is new.
    pub(super) fn follow(&mut self, has_state: bool) {
        if has_state {
            self.confirm();
            self.look();
        }
        if self.may_order()
            && let Some(asked) = self.navigation.next.take()
        {
            self.order(asked);
        }
    }

    /// Accepts the goal that the robot has acknowledged.
    fn confirm(&mut self) {
        let Some(ordered) = self.navigation.ordered.take() else {
            return;
        };
        let Ordered { asked, aim, .. } = &ordered;
        let is_taken = self.station.has_taken(ordered.order);
        let is_known = is_taken && self.state.link.unacknowledged == 0;
        if is_taken && let Some(why) = self.state.refused.clone() {
            return self.reject(asked, &why);
        }
        if is_known && is_task(aim, &self.state.robot) {
            return self.accept(asked, *aim);
        }
        if ordered.since.elapsed() < PATIENCE {
            self.navigation.ordered = Some(ordered);
            return;
        }
        // It may still arrive: nobody would know of it.
        self.reject(asked, "the robot has not confirmed it; it is stopped");
        let _ = self.station.order(Order::Stop);
    }

    fn accept(&mut self, asked: &Asked, aim: Aim) {
        if let Some(before) = self.navigation.active.take() {
            self.end(before.id, Status::Aborted, "a newer goal has come");
        }
        let id = asked.goal.id;
        let stamp = stamp(self.now_ns());
        let accepted = Accepted {
            accepted: true,
            stamp: stamp.clone(),
        };
        self.navigation.goals.begin(id, stamp);
        self.navigation.active = Some(Active {
            id,
            aim,
            since_s: self.state.t_s,
            first_m: self.left_m(&aim).unwrap_or(0.0),
            canceling: None,
            reached: None,
        });
        let answered = self.node.reply(asked.caller, &accepted);
        report(answered, &mut self.reported);
        self.show_goals();
    }

    /// Looks how the goal on the way stands, and says it.
    fn look(&mut self) {
        let Some(mut active) = self.navigation.active.take() else {
            return;
        };
        match self.outcome_of(&mut active) {
            Some((status, why)) => {
                if !self.state.link.connected {
                    // Its messages are lost; ours may still arrive.
                    let _ = self.station.order(Order::Stop);
                }
                self.end(active.id, status, &why);
            }
            None => {
                self.feed_back(&active);
                self.navigation.active = Some(active);
            }
        }
    }

    /// The end of a goal, once it is known.
    fn outcome_of(&self, active: &mut Active) -> Option<(Status, String)> {
        let robot = &self.state.robot;
        let aborted = |why: &str| Some((Status::Aborted, why.to_owned()));
        if let Some(reached) = active.reached {
            let is_settled = self.rows >= reached + ROWS || !self.state.link.connected;
            return is_settled.then(|| (Status::Succeeded, String::new()));
        }
        if robot.task.end == Some(End::Reached) {
            active.reached = Some(self.rows);
            return None;
        }
        if !robot.armed {
            return match (active.canceling, &robot.fault) {
                (Some(_), _) => Some((Status::Canceled, String::new())),
                (None, Some(fault)) => aborted(fault),
                (None, None) => aborted("the robot was stopped, or switched off"),
            };
        }
        if active
            .canceling
            .is_some_and(|since| since.elapsed() > STOPPING)
        {
            return aborted("the robot has not confirmed that it stands");
        }
        if !self.state.link.connected {
            return aborted("the robot does not answer; it is stopped");
        }
        // A newer goal of ours is on its way to the robot.
        let is_replaced = self.navigation.ordered.is_none() && !is_task(&active.aim, robot);
        match robot.task.end {
            Some(End::Unreachable) => aborted("there is no way to the goal"),
            Some(End::GaveUp) => aborted("no way to the goal was found in time"),
            _ if is_replaced => aborted("the robot was given something else to do"),
            _ => None,
        }
    }

    fn end(&mut self, id: Id, status: Status, why: &str) {
        if status == Status::Aborted {
            self.say(&format!("{NAME}: aborted, {why}"));
        }
        for (caller, ended) in self.navigation.goals.end(id, status, why) {
            self.answer_end(caller, &ended);
        }
        self.show_goals();
    }

    /// The run is another one: its goals are over.
    pub(super) fn end_run(&mut self) {
        let navigation = &mut self.navigation;
        let asked = navigation.next.take().into_iter();
        let ordered = navigation.ordered.take().map(|ordered| ordered.asked);
        for asked in asked.chain(ordered).collect::<Vec<_>>() {
            self.reject(&asked, "the simulation was started again");
        }
        if let Some(active) = self.navigation.active.take() {
            self.end(
                active.id,
                Status::Aborted,
                "the simulation was started again",
            );
        }
    }

    fn answer_end(&mut self, caller: Caller, ended: &Ended) {
        if let Ok(data) = self.navigation.distribution.encode(ended) {
            let answered = self.node.reply_bytes(caller, &data);
            report(answered, &mut self.reported);
        }
    }

    fn show_goals(&mut self) {
        let status = self.navigation.goals.status();
        let sent = self.node.send(Topic::GoalStatus, &status);
        report(sent, &mut self.reported);
    }

    /// Distance to a goal in a straight line [m].
    fn left_m(&self, aim: &Aim) -> Option<f64> {
        let at = self.converter.pose_in_odom()?;
        Some((aim.in_odom.x_m - at.x_m).hypot(aim.in_odom.y_m - at.y_m))
    }

    fn feed_back(&mut self, active: &Active) {
        let (Some(at), Some(left_m)) = (self.converter.pose_in_odom(), self.left_m(&active.aim))
        else {
            return;
        };
        let lasts_s = self.state.t_s - active.since_s;
        let made_m = active.first_m - left_m;
        let remaining_s = match made_m > 0.0 {
            true => lasts_s * left_m / made_m,
            false => 0.0,
        };
        let header = Header {
            stamp: stamp(self.now_ns()),
            frame_id: ODOM.to_owned(),
        };
        let feedback = NavigateFeedback {
            current_pose: PoseStamped {
                header,
                pose: pose(at),
            },
            navigation_time: lasting(lasts_s),
            estimated_time_remaining: lasting(remaining_s),
            distance_remaining: left_m as f32,
            ..NavigateFeedback::default()
        };
        let message = FeedbackMessage {
            goal_id: Uuid { uuid: active.id },
            feedback,
        };
        let sent = self.node.send(Topic::GoalFeedback, &message);
        report(sent, &mut self.reported);
    }
}

fn lasting(seconds: f64) -> Lasting {
    let Time { sec, nanosec } = stamp((seconds.max(0.0) * 1e9) as u64);
    Lasting { sec, nanosec }
}
