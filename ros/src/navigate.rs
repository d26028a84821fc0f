//! *Go to goal* as an action: goals that clients send, and how they stand.
//!
//! ```text
//! ~/navigate_to_pose/_action/send_goal, cancel_goal, get_result   services
//! ~/navigate_to_pose/_action/feedback, status                     topics
//! ```
//!
//! The type is Nav2's, which installations have. What later distributions have added to it stands at its end: a client
//! reads as much of the feedback as its own definition has. Its result has a fixed size in earlier ones, and is cut to it.

use crate::bridge::Caller;
use clap::ValueEnum;
use rumbo_log::MapPose;
use rumbo_ros::messages::Time;
use rumbo_ros::service_messages::{
    Canceled, Ended, GoalInfo, GoalStatus, GoalStatusArray, NavigateResult, Uuid,
};
use rumbo_ros::types::{decode, encode};
use std::collections::VecDeque;

/// Name of the action below that of the node.
pub(crate) const NAME: &str = "navigate_to_pose";
/// Names and types of its services, in the order of [`question`].
pub(crate) const SERVICES: [(&str, &str); 3] = [
    ("send_goal", "nav2_msgs/action/NavigateToPose_SendGoal"),
    ("cancel_goal", "action_msgs/srv/CancelGoal"),
    ("get_result", "nav2_msgs/action/NavigateToPose_GetResult"),
];
/// Goals that are remembered.
const KEPT: usize = 20;
/// Clients that may wait for results.
const MOST_WAITING: usize = 100;
/// `UNKNOWN` of Nav2's errors: the text says more.
const FAILED: u16 = 9000;

/// A goal's identity.
pub(crate) type Id = [u8; 16];

/// Where a client wants the robot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Goal {
    /// Its identity.
    pub(crate) id: Id,
    /// The frame of the pose.
    pub(crate) frame: String,
    /// The pose.
    pub(crate) at: MapPose,
    /// The pose has a heading: its quaternion is one.
    pub(crate) has_heading: bool,
}

/// Goals that somebody wants canceled: that of an identity, and all up to a time. Without both all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Cancel {
    /// This one; zeros: by time.
    pub(crate) id: Id,
    /// Accepted up to then: seconds and nanoseconds; zeros: by identity.
    pub(crate) until: (i32, u32),
}

/// What somebody wants of the action.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Question {
    /// The robot is to go there.
    Send(Goal),
    /// It is not to go on.
    Cancel(Cancel),
    /// How it ends.
    Result(Id),
}

/// The question in a request to the service of this number; `None`: it cannot be decoded.
#[must_use]
pub(crate) fn question(service: usize, data: &[u8]) -> Option<Question> {
    type Header = ((i32, u32), String);
    type Pose = ([f64; 3], [f64; 4]);
    match service {
        0 => {
            let (id, ((_, frame), (position, turn)), _) =
                decode::<(Id, (Header, Pose), String)>(data).ok()?;
            let [x, y, z, w] = turn;
            let at = MapPose {
                x_m: position[0],
                y_m: position[1],
                heading_rad: (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)),
            };
            let has_heading = turn != [0.0; 4];
            Some(Question::Send(Goal {
                id,
                frame,
                at,
                has_heading,
            }))
        }
        1 => {
            let (id, until) = decode::<(Id, (i32, u32))>(data).ok()?;
            Some(Question::Cancel(Cancel { id, until }))
        }
        2 => decode(data).ok().map(|(id,)| Question::Result(id)),
        _ => None,
    }
}

/// Whose definition of the result clients have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Distribution {
    /// An empty result
    Humble,
    /// An error's number; Iron too
    #[default]
    Jazzy,
    /// Its text too; and newer
    Kilted,
}

impl Distribution {
    /// The bytes of a result.
    ///
    /// # Errors
    /// What CDR cannot express.
    pub(crate) fn encode(self, ended: &Ended) -> Result<Vec<u8>, cdr_encoding::Error> {
        let mut data = encode(ended)?;
        // Behind the header of four bytes: the status; what stands for nothing, or the number from the next even place.
        data.truncate(match self {
            Self::Humble => 4 + 2,
            Self::Jazzy => 4 + 4,
            Self::Kilted => data.len(),
        });
        Ok(data)
    }
}

/// How a goal stands, by the numbers of `action_msgs`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i8)]
pub(crate) enum Status {
    /// The robot is on its way.
    Executing = 2,
    /// It is to stop.
    Canceling = 3,
    /// It is there.
    Succeeded = 4,
    /// It was stopped by a client of the action.
    Canceled = 5,
    /// It is not there, and will not go on.
    Aborted = 6,
}

#[derive(Debug)]
struct Known {
    info: GoalInfo,
    status: Status,
    why: String,
}

impl Known {
    fn is_over(&self) -> bool {
        !matches!(self.status, Status::Executing | Status::Canceling)
    }

    fn ended(&self) -> Ended {
        let failed = self.status == Status::Aborted;
        Ended {
            status: self.status as i8,
            result: NavigateResult {
                error_code: if failed { FAILED } else { 0 },
                error_msg: self.why.clone(),
            },
        }
    }
}

/// The goals that were accepted, and those who wait for their ends.
#[derive(Debug, Default)]
pub(crate) struct Goals {
    known: VecDeque<Known>,
    waiting: Vec<(Id, Caller)>,
}

impl Goals {
    fn find(&self, id: Id) -> Option<&Known> {
        self.known
            .iter()
            .find(|known| known.info.goal_id.uuid == id)
    }

    /// Whether there has been this goal.
    #[must_use]
    pub(crate) fn knows(&self, id: Id) -> bool {
        self.find(id).is_some()
    }

    /// A goal is accepted: the robot is on its way.
    pub(crate) fn begin(&mut self, id: Id, stamp: Time) {
        let info = GoalInfo {
            goal_id: Uuid { uuid: id },
            stamp,
        };
        if self.known.len() >= KEPT {
            self.known.pop_front();
        }
        self.known.push_back(Known {
            info,
            status: Status::Executing,
            why: String::new(),
        });
    }

    /// What to answer to a wish to cancel, and the goals that are now being canceled.
    pub(crate) fn cancel(&mut self, cancel: Cancel) -> (Canceled, Vec<Id>) {
        let Cancel { id, until } = cancel;
        let (by_id, by_time) = (id != Id::default(), until != (0, 0));
        let mut answer = Canceled::default();
        if by_id {
            answer.return_code = match self.find(id) {
                None => 2,
                Some(known) if known.is_over() => 3,
                Some(_) => 0,
            };
        }
        let mut ids = Vec::new();
        for known in self.known.iter_mut().filter(|known| !known.is_over()) {
            let own = known.info.goal_id.uuid;
            let is_early = (known.info.stamp.sec, known.info.stamp.nanosec) <= until;
            if (by_id && own == id) || (by_time && is_early) || !(by_id || by_time) {
                known.status = Status::Canceling;
                answer.goals_canceling.push(known.info.clone());
                ids.push(own);
            }
        }
        (answer, ids)
    }

    /// A goal has ended, and why if it was not reached. Those who wait for it are to be answered.
    pub(crate) fn end(&mut self, id: Id, status: Status, why: &str) -> Vec<(Caller, Ended)> {
        let own = |known: &&mut Known| known.info.goal_id.uuid == id;
        let Some(known) = self.known.iter_mut().find(own) else {
            return Vec::new();
        };
        known.status = status;
        known.why = why.to_owned();
        let ended = known.ended();
        let waiting = self.waiting.extract_if(.., |(waits, _)| *waits == id);
        waiting.map(|(_, caller)| (caller, ended.clone())).collect()
    }

    /// The end of a goal for one who asks; `None` while it lasts: the answer comes with [`Goals::end`].
    pub(crate) fn result(&mut self, id: Id, caller: Caller) -> Option<Ended> {
        match self.find(id) {
            None => Some(Ended::default()),
            Some(known) if known.is_over() => Some(known.ended()),
            // Too many wait: they are not answered.
            Some(_) => {
                if self.waiting.len() < MOST_WAITING {
                    self.waiting.push((id, caller));
                }
                None
            }
        }
    }

    /// How all stand.
    #[must_use]
    pub(crate) fn status(&self) -> GoalStatusArray {
        let status_list = self.known.iter().map(|known| GoalStatus {
            goal_info: known.info.clone(),
            status: known.status as i8,
        });
        GoalStatusArray {
            status_list: status_list.collect(),
        }
    }
}
