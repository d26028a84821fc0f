//! The topics of a robot: names, types, quality of service.

use crate::messages::{
    BatteryState, Clock, Diagnostics, Event, JointState, LaserScan, Markers, OccupancyGrid,
    Odometry, Range, Text, Transforms,
};
use crate::service_messages::{EarlierFeedbackMessage, GoalStatusArray, ParameterEvent};
use crate::types::{Definition, Message};

/// A topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Topic {
    /// Pose and velocity, as the robot estimates them.
    Odometry,
    /// Frames that move.
    Transforms,
    /// Frames that do not.
    StaticTransforms,
    /// Wheels and servo.
    Joints,
    /// A sonar's distance, by `SonarId` number.
    Range(u8),
    /// Battery.
    Battery,
    /// State of robot and link.
    Diagnostics,
    /// What happened.
    Events,
    /// True pose and velocity, of a simulated robot.
    Truth,
    /// The robot's URDF.
    Description,
    /// The world of a simulated robot, as cells.
    Map,
    /// The same as walls and boxes, for displays.
    Walls,
    /// The goals, and the way driven, for displays.
    Way,
    /// The sonars as one scan, where it is wanted.
    Scan,
    /// The time of a simulation; no part of a bag, which has its own times.
    Clock,
    /// Changes of parameters; live only.
    ParameterEvents,
    /// How far the robot is on its way to a goal; live only.
    GoalFeedback,
    /// How the goals stand; live only.
    GoalStatus,
}

/// How a topic is carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quality {
    /// What is lost is sent again.
    pub reliable: bool,
    /// Those who come late get the last messages.
    pub latched: bool,
    /// Messages kept for a reader that is slow.
    pub depth: i32,
}

impl Topic {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Odometry => "/odom",
            Self::Transforms => "/tf",
            Self::StaticTransforms => "/tf_static",
            Self::Joints => "/joint_states",
            Self::Range(0) => "/sonar/left",
            Self::Range(1) => "/sonar/right",
            Self::Range(_) => "/sonar/front",
            Self::Battery => "/battery_state",
            Self::Diagnostics => "/diagnostics",
            Self::Events => "/rosout",
            Self::Truth => "/ground_truth/odom",
            Self::Description => "/robot_description",
            Self::Map => "/map",
            Self::Walls => "/markers/world",
            Self::Way => "/markers/way",
            Self::Scan => "/scan",
            Self::Clock => "/clock",
            Self::ParameterEvents => "/parameter_events",
            Self::GoalFeedback => "/rumbo/navigate_to_pose/_action/feedback",
            Self::GoalStatus => "/rumbo/navigate_to_pose/_action/status",
        }
    }

    /// Its name for a robot in a namespace (empty, or `/name`). What tools look for in one place stays there.
    #[must_use]
    pub fn name_in(self, namespace: &str) -> String {
        match self {
            Self::Diagnostics | Self::Events | Self::ParameterEvents => self.name().to_owned(),
            _ => format!("{namespace}{}", self.name()),
        }
    }

    /// The type of its messages.
    #[must_use]
    pub fn definition(self) -> &'static Definition {
        match self {
            Self::Odometry | Self::Truth => Odometry::DEFINITION,
            Self::Transforms | Self::StaticTransforms => Transforms::DEFINITION,
            Self::Joints => JointState::DEFINITION,
            Self::Range(_) => Range::DEFINITION,
            Self::Battery => BatteryState::DEFINITION,
            Self::Diagnostics => Diagnostics::DEFINITION,
            Self::Events => Event::DEFINITION,
            Self::Description => Text::DEFINITION,
            Self::Map => OccupancyGrid::DEFINITION,
            Self::Walls | Self::Way => Markers::DEFINITION,
            Self::Scan => LaserScan::DEFINITION,
            Self::Clock => Clock::DEFINITION,
            Self::ParameterEvents => ParameterEvent::DEFINITION,
            Self::GoalFeedback => EarlierFeedbackMessage::DEFINITION,
            Self::GoalStatus => GoalStatusArray::DEFINITION,
        }
    }

    /// How it is carried: reliably, since RViz asks for that.
    #[must_use]
    pub fn quality(self) -> Quality {
        let latched = matches!(
            self,
            Self::StaticTransforms
                | Self::Description
                | Self::Map
                | Self::Walls
                | Self::Way
                | Self::GoalStatus
        );
        let depth = match self {
            _ if latched => 1,
            Self::ParameterEvents => 100,
            _ => 10,
        };
        Quality {
            reliable: true,
            latched,
            depth,
        }
    }
}
