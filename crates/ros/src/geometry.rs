//! Frames and body of a robot, and its URDF.

use crate::messages::{Header, Pose, Quaternion, Time, Transform, TransformStamped, Vector3};
use rumbo_log::{MapPose, Scene, SonarMount, compose};
use std::fmt::Write;

/// The world, of a simulation.
pub const MAP: &str = "map";
/// Where odometry starts.
pub const ODOM: &str = "odom";
/// The robot.
pub const BASE: &str = "base_link";
/// The wheels' frames, left and right.
pub const WHEELS: [&str; 2] = ["left_wheel", "right_wheel"];
/// The sonars' frames, by `SonarId` number.
pub const SONARS: [&str; 3] = ["sonar_left", "sonar_right", "sonar_front"];

/// Shortest distance that the sonars measure [m]: HC-SR04.
pub(crate) const LEAST_M: f32 = 0.02;
/// Width of a wheel in drawings [m].
const WHEEL_WIDTH_M: f64 = 0.026;
/// Height of the body, and of the sonars above the floor, in drawings [m].
const BODY_HEIGHT_M: f64 = 0.06;
const SONAR_HEIGHT_M: f64 = 0.05;

/// What of a robot's body messages need.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyGeometry {
    /// Radii of the wheels, left and right [m].
    pub radius_m: [f64; 2],
    /// Distance between the wheels [m].
    pub base_m: f64,
    /// Outline in its own frame [m].
    pub footprint_m: Vec<[f64; 2]>,
    /// The sonars.
    pub sonars: Vec<SonarMount>,
}

impl BodyGeometry {
    /// That of a robot with these parameters, where they are known, or else of its scene. A real robot has no scene:
    /// neither outline nor sonars. `None` where neither has its sizes.
    #[must_use]
    pub fn new(scene: Option<&Scene>, parameter: impl Fn(&str) -> Option<f32>) -> Option<Self> {
        let parameter = |name: &str, else_m: Option<f64>| parameter(name).map(f64::from).or(else_m);
        let scene_radius_m = scene.map(|scene| scene.wheel_radius_m);
        Some(Self {
            radius_m: [
                parameter("radius_left_m", scene_radius_m)?,
                parameter("radius_right_m", scene_radius_m)?,
            ],
            base_m: parameter("base_m", scene.map(|scene| scene.base_m))?,
            footprint_m: scene
                .map(|scene| scene.footprint_m.clone())
                .unwrap_or_default(),
            sonars: scene.map(|scene| scene.sonars.clone()).unwrap_or_default(),
        })
    }

    /// Speeds forward [m/s] and about the vertical [rad/s], of the wheels' speeds [rad/s].
    #[must_use]
    pub fn velocity(&self, wheel_rad_s: [f64; 2]) -> [f64; 2] {
        let [left, right] = [0, 1].map(|side: usize| self.radius_m[side] * wheel_rad_s[side]);
        [0.5 * (left + right), (right - left) / self.base_m]
    }

    /// Where the wheels and sonars are, with the wheels turned by so much and the servo by so much [rad].
    pub fn parts(&self, wheel_rad: [f64; 2], servo_rad: f64) -> Vec<(&'static str, Transform)> {
        let wheel = |side: usize, sign: f64| {
            let translation = Vector3 {
                x: 0.0,
                y: sign * 0.5 * self.base_m,
                z: self.radius_m[side],
            };
            let half = 0.5 * wheel_rad[side];
            let rotation = Quaternion {
                y: half.sin(),
                w: half.cos(),
                ..Quaternion::default()
            };
            let transform = Transform {
                translation,
                rotation,
            };
            (WHEELS[side], transform)
        };
        let sonar = |mount: &SonarMount| {
            let turned = if mount.on_servo { servo_rad } else { 0.0 };
            let at = MapPose {
                heading_rad: mount.at.heading_rad + turned,
                ..mount.at
            };
            let mut transform = transform(at);
            transform.translation.z = SONAR_HEIGHT_M;
            Some((*SONARS.get(usize::from(mount.id))?, transform))
        };
        let sonars = self.sonars.iter().filter_map(sonar);
        [wheel(0, 1.0), wheel(1, -1.0)]
            .into_iter()
            .chain(sonars)
            .collect()
    }

    /// The robot for drawings and transforms: a body, two wheels, the sonars. Joints are named after their part.
    #[must_use]
    pub fn urdf(&self, name: &str) -> String {
        let name: String = name
            .chars()
            .filter(|c| c.is_alphanumeric() || *c == '_')
            .collect();
        // A robot of URDF has a name.
        let name = if name.is_empty() { "robot" } else { &name };
        let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{name}\">\n");
        let [low, high] = self.extent();
        let [x, y] = [0, 1].map(|axis: usize| 0.5 * (low[axis] + high[axis]));
        let [length, width] = [0, 1].map(|axis: usize| high[axis] - low[axis]);
        let height = self.radius_m[0] + 0.5 * BODY_HEIGHT_M;
        let body = format!(
            "<origin xyz=\"{x} {y} {height}\"/><geometry><box size=\"{length} {width} {BODY_HEIGHT_M}\"/></geometry>"
        );
        let _ = writeln!(
            text,
            "  <link name=\"{BASE}\">\n    <visual>{body}</visual>\n    <collision>{body}</collision>\n  </link>"
        );
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            let (wheel, radius) = (WHEELS[side], self.radius_m[side]);
            let y = sign * 0.5 * self.base_m;
            let _ = writeln!(
                text,
                "  <link name=\"{wheel}\">\n    <visual><origin rpy=\"1.570796 0 0\"/><geometry><cylinder radius=\"{radius}\" \
                 length=\"{WHEEL_WIDTH_M}\"/></geometry></visual>\n  </link>\n  <joint name=\"{wheel}_joint\" type=\"continuous\">\n    \
                 <parent link=\"{BASE}\"/><child link=\"{wheel}\"/>\n    <origin xyz=\"0 {y} {radius}\"/><axis xyz=\"0 1 0\"/>\n  </joint>"
            );
        }
        for mount in &self.sonars {
            let Some(sonar) = SONARS.get(usize::from(mount.id)) else {
                continue;
            };
            let kind = if mount.on_servo { "revolute" } else { "fixed" };
            let turns = match mount.on_servo {
                true => {
                    "<axis xyz=\"0 0 1\"/><limit lower=\"-1.5708\" upper=\"1.5708\" effort=\"0\" velocity=\"10\"/>"
                }
                false => "",
            };
            let MapPose {
                x_m,
                y_m,
                heading_rad,
            } = mount.at;
            let _ = writeln!(
                text,
                "  <link name=\"{sonar}\"/>\n  <joint name=\"{sonar}_joint\" type=\"{kind}\">\n    <parent link=\"{BASE}\"/>\
                 <child link=\"{sonar}\"/>\n    <origin xyz=\"{x_m} {y_m} {SONAR_HEIGHT_M}\" rpy=\"0 0 {heading_rad}\"/>{turns}\n  </joint>"
            );
        }
        text + "</robot>\n"
    }

    /// The least and the largest x and y of the outline [m]; without an outline, the wheels'.
    fn extent(&self) -> [[f64; 2]; 2] {
        let half_m = 0.5 * self.base_m;
        let wheels = [[-self.radius_m[0], -half_m], [self.radius_m[0], half_m]];
        let outline = match self.footprint_m.is_empty() {
            true => &wheels[..],
            false => &self.footprint_m,
        };
        let fold = |of: fn(f64, f64) -> f64, from: f64| {
            [0, 1].map(|axis: usize| outline.iter().map(|point| point[axis]).fold(from, of))
        };
        [
            fold(f64::min, f64::INFINITY),
            fold(f64::max, f64::NEG_INFINITY),
        ]
    }
}

/// A rotation about the vertical.
#[must_use]
pub fn rotation(heading_rad: f64) -> Quaternion {
    let half = 0.5 * heading_rad;
    Quaternion {
        z: half.sin(),
        w: half.cos(),
        ..Quaternion::default()
    }
}

/// A pose on the floor.
#[must_use]
pub fn pose(at: MapPose) -> Pose {
    let mut pose = Pose {
        orientation: rotation(at.heading_rad),
        ..Pose::default()
    };
    (pose.position.x, pose.position.y) = (at.x_m, at.y_m);
    pose
}

/// A frame on the floor.
#[must_use]
pub fn transform(at: MapPose) -> Transform {
    Transform {
        translation: Vector3 {
            x: at.x_m,
            y: at.y_m,
            z: 0.0,
        },
        rotation: rotation(at.heading_rad),
    }
}

/// A frame in another, at an instant.
#[must_use]
pub fn stamped(stamp: &Time, parent: &str, child: &str, transform: Transform) -> TransformStamped {
    TransformStamped {
        header: Header {
            stamp: stamp.clone(),
            frame_id: parent.to_owned(),
        },
        child_frame_id: child.to_owned(),
        transform,
    }
}

/// A pose as seen from another.
#[must_use]
pub fn seen_from(frame: MapPose, at: MapPose) -> MapPose {
    let (sin, cos) = frame.heading_rad.sin_cos();
    let (x_m, y_m) = (at.x_m - frame.x_m, at.y_m - frame.y_m);
    MapPose {
        x_m: cos * x_m + sin * y_m,
        y_m: cos * y_m - sin * x_m,
        heading_rad: at.heading_rad - frame.heading_rad,
    }
}

/// The robot's origin in the frame `odom`, in which its pose never jumps (REP 105): it does when the robot begins to count
/// from somewhere else, as at each goal.
#[derive(Debug, Default)]
pub(crate) struct Origin {
    in_odom: MapPose,
    /// Where the log has it, and the last pose.
    last: Option<(Option<MapPose>, MapPose)>,
}

impl Origin {
    /// The pose in `odom` of a pose from the robot's origin, which the log has there.
    pub(crate) fn pose(&mut self, logged: Option<MapPose>, from_origin: MapPose) -> MapPose {
        if let Some((before, at)) = self.last
            && before != logged
        {
            self.in_odom = compose(at, seen_from(from_origin, MapPose::default()));
        }
        let at = compose(self.in_odom, from_origin);
        self.last = Some((logged, at));
        at
    }

    /// Where it is.
    pub(crate) fn in_odom(&self) -> MapPose {
        self.in_odom
    }

    /// The last pose in `odom`.
    pub(crate) fn last_pose(&self) -> Option<MapPose> {
        let (_, at) = self.last?;
        Some(at)
    }
}
