//! What is known of a robot as messages of ROS 2, by topic: of a log, or as it happens.

mod slow;

use crate::geometry::{
    BASE, BodyGeometry, LEAST_M, MAP, ODOM, Origin, SONARS, WHEELS, pose, seen_from, stamped,
    transform,
};
use crate::messages::{Clock, Header, JointState, Odometry, Range, Text, Time, Transforms};
use crate::surroundings::{self, Way};
use crate::topics::Topic;
use crate::types::{Covariance, Message, encode};
use rumbo_log::{Log, MapPose, Row, SceneObstacle, SonarMount, compose};
use std::time::UNIX_EPOCH;
use thiserror::Error;

/// The sonars' signals, by `SonarId` number.
const RANGES: [&str; 3] = ["range_left_m", "range_right_m", "range_front_m"];
/// The node that speaks in a bag, and a live one outside a namespace.
pub const SPEAKER: &str = "rumbo";

/// A message on its topic.
#[derive(Clone, Debug, PartialEq)]
pub struct TopicMessage {
    /// The topic.
    pub topic: Topic,
    /// Its time [ns]: since 1970, or since the start of a run that has no date.
    pub t_ns: u64,
    /// The message in CDR.
    pub data: Vec<u8>,
}

/// Why a log is no bag.
#[derive(Debug, Error)]
pub enum ConvertError {
    /// It has no telemetry.
    #[error(
        "holds no telemetry of a robot: no pose and no ranges; --format csv writes what there is"
    )]
    NoTelemetry,
    /// Nothing tells the size of wheels and base.
    #[error(
        "tells neither the radii of the wheels nor the distance between them: the robot's parameters were not \
         received"
    )]
    NoGeometry,
    /// A message could not be encoded.
    #[error("a message cannot be encoded: {0}")]
    Encoding(cdr_encoding::Error),
}

/// All messages of a log, in order of time; with the sonars as a scan besides, if it is wanted.
///
/// # Errors
/// [`ConvertError`].
pub fn messages(log: &Log, with_scan: bool) -> Result<Vec<TopicMessage>, ConvertError> {
    if log.rows.is_empty() {
        return Err(ConvertError::NoTelemetry);
    }
    let parameters = log.parameters();
    let geometry = BodyGeometry::new(log.scene(), |name| parameters.get(name).copied());
    let started_ns = log.manifest.as_ref().and_then(|manifest| {
        let started = humantime::parse_rfc3339(manifest.started.as_ref()?).ok()?;
        let since = started.duration_since(UNIX_EPOCH).ok()?;
        u64::try_from(since.as_nanos()).ok()
    });
    let robot = log.manifest.as_ref();
    let robot = robot.and_then(|manifest| manifest.robot.clone());
    let mut converter = Converter::new(SPEAKER, robot.unwrap_or_default(), started_ns.unwrap_or(0));
    converter.with_scan = with_scan;
    converter.know(geometry.ok_or(ConvertError::NoGeometry)?);
    if let Some(scene) = log.scene() {
        converter.surround(&scene.obstacles);
    }
    // A goal is counted from the origin that the robot has then.
    let mut states = log.states.iter().peekable();
    for row in &log.rows {
        while let Some(state) = states.next_if(|state| state.t_s * 1e3 <= row.t_ms as f64) {
            converter.state(state, Vec::new())?;
        }
        converter.row(row)?;
    }
    for state in states {
        converter.state(state, Vec::new())?;
    }
    for event in &log.events {
        converter.event(event)?;
    }
    let mut sent = converter.take();
    sent.sort_by_key(|message| message.t_ns);
    Ok(sent)
}

/// The time of a simulation or of a log \[ns\], as a message.
///
/// # Errors
/// [`ConvertError::Encoding`].
pub fn clock(t_ns: u64) -> Result<TopicMessage, ConvertError> {
    let clock = stamp(t_ns);
    let data = encode(&Clock { clock }).map_err(ConvertError::Encoding)?;
    let topic = Topic::Clock;
    Ok(TopicMessage { topic, t_ns, data })
}

/// What is known of a robot, in order of time, as messages.
#[derive(Debug)]
pub struct Converter {
    /// The node that says it.
    speaker: String,
    /// Name of the robot.
    robot: String,
    started_ns: u64,
    /// Once it is known.
    geometry: Option<BodyGeometry>,
    /// Walls and boxes in the world.
    obstacles: Vec<SceneObstacle>,
    /// Description, fixed frames and world are still to be sent.
    is_new: bool,
    way: Way,
    /// The sonars become a scan too.
    pub with_scan: bool,
    /// Where odometry started in the world, of a simulated robot, as its first row has it.
    odom_in_map: Option<Option<MapPose>>,
    origin: Origin,
    /// How far the wheels have turned: the sum of the measured speeds.
    wheel_rad: [f64; 2],
    last_ms: Option<i64>,
    sent: Vec<TopicMessage>,
}

impl Converter {
    /// For the robot of this name; `speaker` is the node, `started_ns` the time of its time 0 \[ns\].
    #[must_use]
    pub fn new(speaker: &str, robot: String, started_ns: u64) -> Self {
        Self {
            speaker: speaker.to_owned(),
            robot,
            started_ns,
            geometry: None,
            obstacles: Vec::new(),
            is_new: true,
            way: Way::default(),
            with_scan: false,
            odom_in_map: None,
            origin: Origin::default(),
            wheel_rad: [0.0; 2],
            last_ms: None,
            sent: Vec::new(),
        }
    }

    /// Takes the robot's body; without it no row becomes messages. Description and fixed frames follow with the next
    /// row if it is another one.
    pub fn know(&mut self, geometry: BodyGeometry) {
        self.is_new |= self.geometry.as_ref() != Some(&geometry);
        self.geometry = Some(geometry);
    }

    /// Takes what stands in the world of a simulated robot; map and markers of it follow with the next row.
    pub fn surround(&mut self, obstacles: &[SceneObstacle]) {
        if self.obstacles != obstacles {
            self.is_new = true;
            self.obstacles = obstacles.to_vec();
        }
    }

    /// The robot's pose in `odom`, as it was last reported.
    #[must_use]
    pub fn pose_in_odom(&self) -> Option<MapPose> {
        self.origin.last_pose()
    }

    /// A pose of a frame in `odom`: of `map` in simulation, of `base_link`, of `odom` itself (or of no frame).
    ///
    /// # Errors
    /// Why it is nowhere, for a person.
    pub fn in_odom(&self, frame: &str, at: MapPose) -> Result<MapPose, String> {
        match frame.trim_start_matches('/') {
            "" | ODOM => Ok(at),
            BASE => {
                let robot = self.pose_in_odom().ok_or("the robot has no pose yet")?;
                Ok(compose(robot, at))
            }
            MAP => {
                let odom = self.odom_in_map.flatten();
                let odom =
                    odom.ok_or("only a simulated robot knows where it is in map; use odom")?;
                Ok(seen_from(odom, at))
            }
            other => {
                let known = match self.odom_in_map.flatten() {
                    Some(_) => "odom, base_link or map",
                    None => "odom or base_link",
                };
                Err(format!("there is no frame `{other}`; use {known}"))
            }
        }
    }

    /// A pose in `odom` as the robot counts it: from its own origin, which moves.
    #[must_use]
    pub fn from_origin(&self, in_odom: MapPose) -> MapPose {
        seen_from(self.origin.in_odom(), in_odom)
    }

    /// The messages since the last call.
    pub fn take(&mut self) -> Vec<TopicMessage> {
        std::mem::take(&mut self.sent)
    }

    fn put<M: Message>(
        &mut self,
        topic: Topic,
        t_ns: u64,
        message: &M,
    ) -> Result<(), ConvertError> {
        let data = encode(message).map_err(ConvertError::Encoding)?;
        self.sent.push(TopicMessage { topic, t_ns, data });
        Ok(())
    }

    fn at_ms(&self, t_ms: i64) -> u64 {
        self.started_ns + u64::try_from(t_ms).unwrap_or(0) * 1_000_000
    }

    fn header(&self, t_ns: u64, frame: &str) -> Header {
        Header {
            stamp: stamp(t_ns),
            frame_id: frame.to_owned(),
        }
    }

    /// What does not change.
    fn begin(&mut self, first: &Row, geometry: &BodyGeometry) -> Result<(), ConvertError> {
        let t_ns = self.at_ms(first.t_ms);
        let is_fixed = |mount: &&SonarMount| !mount.on_servo;
        let fixed: Vec<&str> = geometry
            .sonars
            .iter()
            .filter(is_fixed)
            .filter_map(frame)
            .collect();
        let parts = geometry.parts([0.0; 2], 0.0).into_iter();
        let parts = parts.filter(|(part, _)| fixed.contains(part));
        let parts = parts.map(|(part, at)| stamped(&stamp(t_ns), BASE, part, at));
        let mut transforms: Vec<_> = parts.collect();
        let odom = *self.odom_in_map.get_or_insert_with(|| {
            let origin = first.pose("origin_").unwrap_or_default();
            first.pose("true_").map(|_| origin)
        });
        if let Some(odom) = odom {
            transforms.push(stamped(&stamp(t_ns), MAP, ODOM, transform(odom)));
        }
        if !transforms.is_empty() {
            self.put(Topic::StaticTransforms, t_ns, &Transforms { transforms })?;
        }
        let data = geometry.urdf(&self.robot);
        self.put(Topic::Description, t_ns, &Text { data })?;
        let Some(start) = odom else {
            return Ok(());
        };
        let stamp = stamp(t_ns);
        let map = surroundings::map(&stamp, &self.obstacles, start);
        self.put(Topic::Map, t_ns, &map)?;
        let walls = surroundings::walls(&stamp, &self.obstacles);
        self.put(Topic::Walls, t_ns, &walls)
    }

    /// The signals of an instant.
    ///
    /// # Errors
    /// [`ConvertError::Encoding`].
    pub fn row(&mut self, row: &Row) -> Result<(), ConvertError> {
        let Some(geometry) = self.geometry.clone() else {
            return Ok(());
        };
        if std::mem::take(&mut self.is_new) {
            self.begin(row, &geometry)?;
        }
        let t_ns = self.at_ms(row.t_ms);
        let speeds = |prefix: &str| {
            ["left", "right"]
                .map(|side| row.signal(&format!("{prefix}{side}_rad_s")).unwrap_or(0.0))
        };
        let last_ms = self.last_ms.replace(row.t_ms).unwrap_or(row.t_ms);
        let elapsed_s = (row.t_ms - last_ms).max(0) as f64 / 1e3;
        let (before, now) = (speeds_before(row), speeds(""));
        for side in 0..2 {
            self.wheel_rad[side] += 0.5 * elapsed_s * (before[side] + now[side]);
        }
        let servo_rad = row.signal("servo_rad").unwrap_or(0.0);
        let mut frames = Vec::new();
        if let Some(at) = row.pose("") {
            let at = self.origin.pose(row.pose("origin_"), at);
            let turned_rad = self.origin.in_odom().heading_rad;
            let velocity = geometry.velocity(now);
            let odometry = self.odometry(t_ns, ODOM, at, velocity, covariance(row, turned_rad));
            self.put(Topic::Odometry, t_ns, &odometry)?;
            frames.push(stamped(&stamp(t_ns), ODOM, BASE, transform(at)));
            self.way.step(at);
            if let Some(markers) = self.way.markers(row.t_ms, &stamp(t_ns)) {
                self.put(Topic::Way, t_ns, &markers)?;
            }
        }
        let moving = geometry.sonars.iter().filter(|mount| mount.on_servo);
        let moving: Vec<&str> = moving.filter_map(frame).chain(WHEELS).collect();
        let parts = geometry.parts(self.wheel_rad, servo_rad).into_iter();
        let parts = parts.filter(|(part, _)| moving.contains(part));
        frames.extend(parts.map(|(part, at)| stamped(&stamp(t_ns), BASE, part, at)));
        self.put(Topic::Transforms, t_ns, &Transforms { transforms: frames })?;
        self.joints(t_ns, &geometry, now, servo_rad)?;
        for mount in &geometry.sonars {
            self.range(t_ns, row, mount)?;
        }
        if self.with_scan {
            let ranges_m = RANGES.map(|name| row.signal(name));
            let scan = surroundings::scan(&stamp(t_ns), &geometry, servo_rad, ranges_m);
            self.put(Topic::Scan, t_ns, &scan)?;
        }
        if let Some(at) = row.pose("true_") {
            let velocity = geometry.velocity(speeds("true_"));
            let truth = self.odometry(t_ns, MAP, at, velocity, Covariance::default());
            self.put(Topic::Truth, t_ns, &truth)?;
        }
        Ok(())
    }

    fn odometry(
        &self,
        t_ns: u64,
        frame: &str,
        at: MapPose,
        [forward_m_s, yaw_rad_s]: [f64; 2],
        covariance: Covariance,
    ) -> Odometry {
        let mut odometry = Odometry {
            header: self.header(t_ns, frame),
            child_frame_id: BASE.to_owned(),
            ..Odometry::default()
        };
        odometry.pose.pose = pose(at);
        odometry.pose.covariance = covariance;
        odometry.twist.twist.linear.x = forward_m_s;
        odometry.twist.twist.angular.z = yaw_rad_s;
        odometry
    }

    fn joints(
        &mut self,
        t_ns: u64,
        geometry: &BodyGeometry,
        wheel_rad_s: [f64; 2],
        servo_rad: f64,
    ) -> Result<(), ConvertError> {
        let mut joints = JointState {
            header: self.header(t_ns, ""),
            name: WHEELS.map(|wheel| format!("{wheel}_joint")).to_vec(),
            position: self.wheel_rad.to_vec(),
            velocity: wheel_rad_s.to_vec(),
            effort: Vec::new(),
        };
        let on_servo = geometry.sonars.iter().filter(|mount| mount.on_servo);
        for sonar in on_servo.filter_map(frame) {
            joints.name.push(format!("{sonar}_joint"));
            joints.position.push(servo_rad);
            joints.velocity.push(0.0);
        }
        self.put(Topic::Joints, t_ns, &joints)
    }

    fn range(&mut self, t_ns: u64, row: &Row, mount: &SonarMount) -> Result<(), ConvertError> {
        let name = RANGES.get(usize::from(mount.id));
        let range_m = name.and_then(|name| row.signal(name));
        let (Some(range_m), Some(sonar)) = (range_m, frame(mount)) else {
            return Ok(());
        };
        let range = Range {
            header: self.header(t_ns, sonar),
            radiation_type: 0,
            field_of_view: (2.0 * mount.half_angle_rad) as f32,
            min_range: LEAST_M,
            max_range: mount.reach_m as f32,
            range: range_m as f32,
            variance: 0.0,
        };
        self.put(Topic::Range(mount.id), t_ns, &range)
    }
}

/// The frame of a sonar.
fn frame(mount: &SonarMount) -> Option<&'static str> {
    SONARS.get(usize::from(mount.id)).copied()
}

/// The wheels' speeds in the middle of the time since the row before [rad/s].
fn speeds_before(row: &Row) -> [f64; 2] {
    ["left_before_rad_s", "right_before_rad_s"].map(|name| row.signal(name).unwrap_or(0.0))
}

/// A time in the terms of ROS 2.
#[must_use]
pub fn stamp(t_ns: u64) -> Time {
    Time {
        sec: i32::try_from(t_ns / 1_000_000_000).unwrap_or(i32::MAX),
        nanosec: (t_ns % 1_000_000_000) as u32,
    }
}

/// Covariance of the pose; the robot estimates it in the frame of its own origin, turned by so much.
fn covariance(row: &Row, turned_rad: f64) -> Covariance {
    let deviation = |name: &str| row.signal(name).unwrap_or(0.0);
    let (x, y) = (deviation("x_deviation_m"), deviation("y_deviation_m"));
    let xy = deviation("xy_correlation") * x * y;
    let (sin, cos) = turned_rad.sin_cos();
    let mut all = [0.0; 36];
    all[0] = cos * cos * x * x + sin * sin * y * y - 2.0 * sin * cos * xy;
    all[7] = sin * sin * x * x + cos * cos * y * y + 2.0 * sin * cos * xy;
    all[1] = sin * cos * (x * x - y * y) + (cos * cos - sin * sin) * xy;
    all[6] = all[1];
    all[35] = deviation("heading_deviation_rad").powi(2);
    Covariance(all)
}
