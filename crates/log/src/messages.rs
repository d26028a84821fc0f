//! Turns entries into messages; a [`Sink`] takes them.

use crate::entry::{Entry, Said};
use crate::event::{Level, LoggedEvent};
use crate::parameters::ParameterState;
use crate::reading::{Reading, ReadingSource};
use crate::scene::{MapPose, Scene, SonarMount, compose};
use crate::schema::Topic;
use crate::signals::Row;
use crate::state::{LinkState, ProgramState, RobotState, State};
use crate::viewers::{self, timestamp};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};

/// Takes messages.
pub(crate) trait Sink {
    /// Why it cannot.
    type Error;

    /// A message of this topic.
    ///
    /// # Errors
    /// Why it cannot.
    fn put(&mut self, topic: Topic, t_us: u64, data: &[u8]) -> Result<(), Self::Error>;

    /// The same of what matters only where it changes, and at most every so many microseconds: `what` says of it what
    /// there is to compare.
    ///
    /// # Errors
    /// Why it cannot.
    fn put_new(
        &mut self,
        topic: Topic,
        t_us: u64,
        every_us: u64,
        what: String,
        data: Vec<u8>,
    ) -> Result<(), Self::Error>;

    /// The sonars whose frames are written.
    fn mounts(&mut self) -> &mut Option<Vec<SonarMount>>;

    /// The messages of an entry; an outcome has none. Scene and parameters have no time of their own: they get the last
    /// time `now_us`, which a burst updates.
    ///
    /// # Errors
    /// Why it cannot.
    fn entry(&mut self, entry: &Entry, now_us: &mut u64) -> Result<(), Self::Error> {
        match entry {
            Entry::Burst(burst) => {
                *now_us = burst.t_us;
                self.link(burst.to_robot, burst.t_us, &burst.bytes, &[])
            }
            Entry::Said(said) => self.said(said),
            Entry::Rows(rows) => rows.iter().try_for_each(|row| self.row(row)),
            Entry::Readings(readings) => readings.iter().try_for_each(|each| self.reading(each)),
            Entry::Event(event) => self.event(event),
            Entry::State(state) => self.state(state),
            Entry::Scene(scene) => self.scene(*now_us, scene.as_deref()),
            Entry::Parameters(parameters) => self.parameters(*now_us, parameters),
            Entry::Outcome(_) => Ok(()),
        }
    }
}

/// Poses and frames, which telemetry has too, are for viewers: an eighth of its rate is smooth enough, since they draw
/// what is between two frames \[us\].
const POSES_US: u64 = 310_000;

/// The messages of one entry each.
pub(crate) trait Messages: Sink {
    fn put_json(&mut self, topic: Topic, t_us: u64, message: &Value) -> Result<(), Self::Error> {
        self.put(topic, t_us, message.to_string().as_bytes())
    }

    /// Raw bytes of the link, and the pieces in which they came: how long after the one before \[us\], and how many.
    fn link(
        &mut self,
        to_robot: bool,
        t_us: u64,
        bytes: &[u8],
        pieces: &[(u64, usize)],
    ) -> Result<(), Self::Error> {
        let topic = match to_robot {
            true => Topic::ToRobot,
            false => Topic::FromRobot,
        };
        let data = STANDARD.encode(bytes);
        let message = match pieces {
            [] | [_] => json!({ "data": data }),
            pieces => json!({ "data": data, "pieces": pieces }),
        };
        self.put_json(topic, t_us, &message)
    }

    /// What a USART sent, or was sent.
    fn said(&mut self, said: &Said) -> Result<(), Self::Error> {
        let data = STANDARD.encode(&said.bytes);
        let message = json!({ "usart": said.usart, "to_chip": said.to_chip, "data": data });
        self.put_json(Topic::Console, said.t_us, &message)
    }

    /// The signals of one instant, and the poses in them.
    fn row(&mut self, row: &Row) -> Result<(), Self::Error> {
        let t_us = to_us(row.t_ms);
        self.put(Topic::Telemetry, t_us, row_json(row).to_string().as_bytes())?;
        if let (Some(estimated), Some(origin)) = (row.pose(""), row.pose("origin_")) {
            self.pose(Topic::Estimated, t_us, compose(origin, estimated))?;
            self.frames(t_us, row, compose(origin, estimated))?;
        }
        if let Some(truth) = row.pose("true_") {
            self.pose(Topic::True, t_us, truth)?;
        }
        Ok(())
    }

    /// The frames of a robot that estimates itself there.
    fn frames(&mut self, t_us: u64, row: &Row, at: MapPose) -> Result<(), Self::Error> {
        if self.mounts().is_none() {
            self.fix(t_us, Vec::new())?;
        }
        let data = viewers::robot(t_us, at).to_string().into_bytes();
        let what = viewers::pose(at).to_string();
        self.put_new(Topic::Frames, t_us, POSES_US, what, data)?;
        let on_servo = |mount: &&SonarMount| mount.on_servo;
        let mount = self.mounts().iter().flatten().find(on_servo).copied();
        if let Some((mount, servo_rad)) = mount.zip(row.signal("servo_rad")) {
            let Some(frame) = viewers::sonar(t_us, &mount, servo_rad) else {
                return Ok(());
            };
            let data = frame.to_string().into_bytes();
            let what = servo_rad.to_string();
            self.put_new(Topic::ServoFrame, t_us, POSES_US, what, data)?;
        }
        Ok(())
    }

    /// The frames that do not move, of a robot with these sonars.
    fn fix(&mut self, t_us: u64, sonars: Vec<SonarMount>) -> Result<(), Self::Error> {
        let frames = viewers::fixed(t_us, &sonars);
        *self.mounts() = Some(sonars);
        self.put_json(Topic::FixedFrames, t_us, &frames)
    }

    /// Signals beside the telemetry.
    fn reading(&mut self, reading: &Reading) -> Result<(), Self::Error> {
        let topic = match reading.source {
            ReadingSource::Truth => Topic::Truth,
            ReadingSource::Loops => Topic::Loops,
            ReadingSource::Others => Topic::Others,
            ReadingSource::Usart(_) => Topic::Printed,
        };
        let (t_us, message) = (to_us(reading.t_ms), reading.json());
        match topic {
            Topic::Printed => self.put_json(topic, t_us, &message),
            _ => {
                let what = message.to_string();
                let data = what.clone().into_bytes();
                self.put_new(topic, t_us, 0, what, data)
            }
        }
    }

    fn pose(&mut self, topic: Topic, t_us: u64, at: MapPose) -> Result<(), Self::Error> {
        let pose = viewers::pose(at);
        let what = pose.to_string();
        let message = json!({ "timestamp": timestamp(t_us), "frame_id": "world", "pose": pose });
        self.put_new(
            topic,
            t_us,
            POSES_US,
            what,
            message.to_string().into_bytes(),
        )
    }

    /// Something that happened.
    fn event(&mut self, event: &LoggedEvent) -> Result<(), Self::Error> {
        let t_us = to_us((event.t_s * 1e3).round() as i64);
        // The numbers of `foxglove.Log`; success has no level of its own there, and keeps its name.
        let (level, name) = match event.level {
            Level::Info => (2, "info"),
            Level::Good => (2, "good"),
            Level::Warning => (3, "warning"),
            Level::Fault => (4, "fault"),
        };
        let message = json!({ "timestamp": timestamp(t_us), "level": level, "message": event.text, "name": name, "file": "", "line": 0 });
        self.put_json(Topic::Events, t_us, &message)
    }

    /// The slow state.
    fn state(&mut self, state: &State) -> Result<(), Self::Error> {
        match serde_json::to_value(state) {
            Ok(mut message) => {
                leave_out_unknown(&mut message);
                let t_us = to_us((state.t_s * 1e3).round() as i64);
                let data = message.to_string().into_bytes();
                self.put_new(Topic::State, t_us, 0, what_is_new(state), data)
            }
            Err(_) => Ok(()),
        }
    }

    /// The parameters' values, as far as they are known.
    fn parameters(&mut self, t_us: u64, parameters: &[ParameterState]) -> Result<(), Self::Error> {
        let known = parameters.iter().filter_map(|parameter| {
            Some((parameter.entry.name.to_owned(), json!(parameter.value?)))
        });
        let known: Map<String, Value> = known.collect();
        if known.is_empty() {
            return Ok(());
        }
        self.put_json(Topic::Parameters, t_us, &Value::Object(known))
    }

    /// What surrounds the robot.
    fn scene(&mut self, t_us: u64, scene: Option<&Scene>) -> Result<(), Self::Error> {
        if let Some(scene) = scene {
            self.put_json(Topic::World, t_us, &viewers::world(t_us, scene))?;
            self.put_json(Topic::Body, t_us, &viewers::body(t_us, scene))?;
            self.fix(t_us, scene.sonars.clone())?;
        }
        match serde_json::to_vec(&json!({ "scene": scene })) {
            Ok(message) => self.put(Topic::Scene, t_us, &message),
            Err(_) => Ok(()),
        }
    }
}

impl<S: Sink + ?Sized> Messages for S {}

/// What of a state is worth another message at once: all but times, voltages, angles and what is measured of the link.
fn what_is_new(state: &State) -> String {
    let link = LinkState {
        connected: state.link.connected,
        baud: state.link.baud,
        ..LinkState::default()
    };
    let robot = RobotState {
        battery_v: None,
        true_battery_v: None,
        servo_rad: 0.0,
        ..state.robot.clone()
    };
    let program = state.program.clone().map(|program| ProgramState {
        profile: None,
        ..program
    });
    let state = State {
        t_s: 0.0,
        achieved_speed: 0.0,
        link,
        robot,
        program,
        ..state.clone()
    };
    serde_json::to_string(&state).unwrap_or_default()
}

/// Unknown values are left out, as in all messages: viewers expect the type in the schema.
fn leave_out_unknown(message: &mut Value) {
    if let Value::Object(fields) = message {
        fields.retain(|_, value| !value.is_null());
        fields.values_mut().for_each(leave_out_unknown);
    }
}

fn to_us(t_ms: i64) -> u64 {
    // Telemetry from before the run is skipped.
    u64::try_from(t_ms).unwrap_or_default() * 1_000
}

/// Unknown values are left out; a clear range has a field of its own, since viewers plot numbers.
fn row_json(row: &Row) -> Value {
    let mut message = Map::new();
    for (column, name) in Row::names().enumerate() {
        match row.get(column) {
            Some(value) if value.is_finite() => drop(message.insert(name.to_owned(), json!(value))),
            Some(_) => drop(message.insert(format!("{name}_clear"), json!(true))),
            None => {}
        }
    }
    Value::Object(message)
}
