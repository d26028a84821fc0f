//! What the map shows: where the robot is, what surrounds it, and what could be chosen instead.

use rumbo_control::Pose;
use rumbo_control::Wheels;
use rumbo_control::mode::waypoints::Waypoint;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A place on the map: world frame, x east, y north, counter-clockwise heading (REP 103).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapPose {
    /// \[m\].
    pub x_m: f64,
    /// \[m\].
    pub y_m: f64,
    /// \[rad\].
    pub heading_rad: f64,
}

impl From<Pose> for MapPose {
    fn from(pose: Pose) -> Self {
        Self {
            x_m: pose.x_m.into(),
            y_m: pose.y_m.into(),
            heading_rad: pose.heading_rad.into(),
        }
    }
}

/// What is really the case with a simulated robot at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Truth {
    /// Pose in the world.
    pub pose: MapPose,
    /// Speeds of the wheels, forward positive [rad/s].
    pub wheel_rad_s: Wheels<f64>,
    /// Distance to the nearest thing in each sonar's cone, by `SonarId` number \[m\]; infinite when nothing is within
    /// reach, `None` where the rig has no such sonar.
    pub range_m: [Option<f64>; 3],
    /// Angle of the servo, 0 straight ahead, positive to the left \[rad\].
    pub servo_rad: f64,
    /// The body touches something.
    pub contact: bool,
    /// Battery at its terminals \[V\].
    pub battery_v: f64,
}

/// What surrounds a simulated robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// What is running.
    pub choice: Choice,
    /// The scenarios to choose from.
    #[serde(default)]
    pub experiments: Vec<ScenarioOffer>,
    /// Names of the worlds to choose from.
    pub worlds: Vec<String>,
    /// Their titles, by name: one line each for people.
    #[serde(default)]
    pub world_titles: BTreeMap<String, String>,
    /// Names of the rigs to choose from.
    pub rigs: Vec<String>,
    /// Name of the rig that the robot carries.
    pub rig: String,
    /// The goals of the experiment, from the origin \[m\].
    pub goals: Vec<[f32; 2]>,
    /// The routes of the experiment.
    pub routes: Vec<RoutePlan>,
    /// Name of the robot.
    pub robot: String,
    /// Pose of the odometry's origin in the world: the estimated pose is drawn from here.
    pub start: MapPose,
    /// Walls and boxes.
    pub obstacles: Vec<SceneObstacle>,
    /// Dark lines on the floor.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<FloorLine>,
    /// Lamps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lamps: Vec<SceneLamp>,
    /// What moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub movers: Vec<SceneMover>,
    /// The other robots in the world, if there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<Other>,
    /// Outline of the robot in its own frame \[m\], closed by itself.
    pub footprint_m: Vec<[f64; 2]>,
    /// Distance between the wheels \[m\].
    pub base_m: f64,
    /// Radius of the wheels \[m\].
    pub wheel_radius_m: f64,
    /// The rig's sonars.
    pub sonars: Vec<SonarMount>,
    /// The names of those from number 3 on, after left, right and front.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub other_sonars: Vec<String>,
    /// It is the ghost's: the robot itself is not simulated.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub of_ghost: bool,
}

/// A dark line on the floor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FloorLine {
    /// Its corners, in order \[m\].
    pub points_m: Vec<[f64; 2]>,
    /// Its width \[m\].
    pub width_m: f64,
}

/// A lamp.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneLamp {
    /// Where it is \[m\].
    pub at_m: [f64; 2],
    /// How much it shines \[lm\].
    pub lumen: f64,
}

/// A scenario to choose.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ScenarioOffer {
    /// Name of the scenario.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Its heading in the list.
    pub group: Option<String>,
    /// Number of its mode.
    pub mode: u8,
    /// It commands something in that mode: it shows what the mode does.
    pub shows_mode: bool,
}

/// The places of a route.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoutePlan {
    /// Starts over at the end.
    pub repeat: bool,
    /// As seen from where the robot starts, not from the origin.
    pub relative: bool,
    /// The places.
    pub waypoints: Vec<RoutePlace>,
}

/// A place of a route.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoutePlace {
    /// Forward of the origin \[m\].
    pub x_m: f32,
    /// Left of the origin \[m\].
    pub y_m: f32,
    /// Heading to turn to there \[rad\].
    pub heading_rad: Option<f32>,
}

impl From<Waypoint> for RoutePlace {
    fn from(waypoint: Waypoint) -> Self {
        let Waypoint {
            x_m,
            y_m,
            heading_rad,
        } = waypoint;
        Self {
            x_m,
            y_m,
            heading_rad,
        }
    }
}

/// A wall or a box, seen from above.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneObstacle {
    /// Corners in the world frame \[m\].
    pub corners_m: Vec<[f64; 2]>,
    /// The last corner joins the first: a box. Otherwise a wall along the corners.
    pub closed: bool,
}

/// An outline that moves, whatever the robot does.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SceneMover {
    /// Corners in its own frame \[m\], closed by itself.
    pub corners_m: Vec<[f64; 2]>,
    /// Poses and when they are reached, from its start, with even motion between them.
    pub waypoints: Vec<TimedPose>,
    /// What follows the last one.
    pub repeat: Repeat,
    /// When it starts \[s\].
    pub start_s: f64,
}

/// Another robot in the world. Where it is, readings of [`crate::ReadingSource::Others`] tell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Other {
    /// Its name.
    pub name: String,
    /// Its outline in its own frame \[m\], closed by itself.
    pub footprint_m: Vec<[f64; 2]>,
}

impl Other {
    /// The signals of where it stands: x and y in m, the heading in deg.
    pub fn signals(name: &str, at: MapPose) -> [(String, f64); 3] {
        [
            (format!("{name}_x_m"), at.x_m),
            (format!("{name}_y_m"), at.y_m),
            (format!("{name}_heading_deg"), at.heading_rad.to_degrees()),
        ]
    }
}

/// A pose with its time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimedPose {
    /// When \[s\].
    pub t_s: f64,
    /// Where.
    pub at: MapPose,
}

/// What follows the last waypoint of a mover.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Repeat {
    /// It stays there.
    #[default]
    Once,
    /// The first one, at the same place.
    Loop,
    /// The way back.
    BackAndForth,
}

/// Where a sonar sits and what it can see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SonarMount {
    /// `SonarId` number.
    pub id: u8,
    /// Place and direction in the robot's frame; with the servo straight ahead where it is on the servo.
    pub at: MapPose,
    /// Half the opening angle of the beam \[rad\].
    pub half_angle_rad: f64,
    /// Longest distance used \[m\].
    pub reach_m: f64,
    /// Turns with the servo.
    pub on_servo: bool,
}

/// Which simulation to run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Choice {
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the world; `None` for the scenario's own.
    pub world: Option<String>,
    /// Name of the rig; `None` for the scenario's own.
    pub rig: Option<String>,
    /// Seed of everything random.
    pub seed: u64,
}

/// A pose in `frame`, in the frame around it.
#[must_use]
pub fn compose(frame: MapPose, at: MapPose) -> MapPose {
    let (sin, cos) = frame.heading_rad.sin_cos();
    MapPose {
        x_m: frame.x_m + cos * at.x_m - sin * at.y_m,
        y_m: frame.y_m + sin * at.x_m + cos * at.y_m,
        heading_rad: frame.heading_rad + at.heading_rad,
    }
}
