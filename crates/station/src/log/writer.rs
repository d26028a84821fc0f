//! Writes a log: manifest and files first, then messages as they come.

use super::schema::Topic;
use super::{Burst, Manifest, Outcome, Said};
use crate::board::{Level, LoggedEvent, State};
use crate::catalogue::ParameterState;
use crate::row::Row;
use crate::target::{MapPose, Scene};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, Compression, McapResult, WriteOptions, Writer};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

/// A log being written.
pub(super) struct LogWriter<W: Write + Seek> {
    log: Writer<W>,
    channels: [u16; Topic::ALL.len()],
    sequences: [u32; Topic::ALL.len()],
}

impl<W: Write + Seek> LogWriter<W> {
    /// A log that begins with its manifest.
    pub(super) fn new(into: W, manifest: &Manifest) -> McapResult<Self> {
        let mut log = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            // The file only grows: killed at any moment, all chunks but the last are whole.
            .disable_seeking(true)
            .profile("")
            .library(concat!("rumbo ", env!("CARGO_PKG_VERSION")))
            .create(into)?;
        log.write_metadata(&Metadata {
            name: "manifest".into(),
            metadata: manifest.to_metadata(),
        })?;
        for (name, text) in &manifest.files {
            log.attach(&Attachment {
                log_time: 0,
                create_time: 0,
                name: format!("{name}.toml"),
                media_type: "application/toml".into(),
                data: Cow::Borrowed(text.as_bytes()),
            })?;
        }
        let mut channels = [0; Topic::ALL.len()];
        for topic in Topic::ALL {
            let (name, schema) = topic.schema();
            let schema = log.add_schema(name, "jsonschema", schema.to_string().as_bytes())?;
            channels[topic as usize] =
                log.add_channel(schema, topic.name(), "json", &BTreeMap::new())?;
        }
        Ok(Self {
            log,
            channels,
            sequences: [0; Topic::ALL.len()],
        })
    }

    fn put(&mut self, topic: Topic, t_us: u64, data: &[u8]) -> McapResult<()> {
        let sequence = self.sequences[topic as usize];
        self.sequences[topic as usize] = sequence.wrapping_add(1);
        let time_ns = t_us.saturating_mul(1_000);
        let header = MessageHeader {
            channel_id: self.channels[topic as usize],
            sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.log.write_to_known_channel(&header, data)
    }

    fn put_json(&mut self, topic: Topic, t_us: u64, message: &Value) -> McapResult<()> {
        self.put(topic, t_us, message.to_string().as_bytes())
    }

    /// Raw bytes of the link.
    pub(super) fn burst(&mut self, burst: &Burst) -> McapResult<()> {
        let topic = if burst.to_robot {
            Topic::ToRobot
        } else {
            Topic::FromRobot
        };
        self.put_json(
            topic,
            burst.t_us,
            &json!({ "data": STANDARD.encode(&burst.bytes) }),
        )
    }

    /// What a USART sent, or was sent.
    pub(super) fn said(&mut self, said: &Said) -> McapResult<()> {
        let data = STANDARD.encode(&said.bytes);
        let message = json!({ "usart": said.usart, "to_chip": said.to_chip, "data": data });
        self.put_json(Topic::Console, said.t_us, &message)
    }

    /// The signals of one instant, and the poses in them.
    pub(super) fn row(&mut self, row: &Row) -> McapResult<()> {
        let t_us = to_us(row.t_ms);
        self.put(Topic::Telemetry, t_us, row_json(row).to_string().as_bytes())?;
        let pose = |names: [&str; 3]| {
            let [x_m, y_m, heading_rad] = names.map(|name| row.signal(name));
            Some(MapPose {
                x_m: x_m?,
                y_m: y_m?,
                heading_rad: heading_rad?,
            })
        };
        let told = pose(["x_m", "y_m", "heading_rad"]);
        let origin = pose(["origin_x_m", "origin_y_m", "origin_heading_rad"]);
        if let (Some(told), Some(origin)) = (told, origin) {
            self.pose(Topic::Estimated, t_us, crate::origin::compose(origin, told))?;
        }
        if let Some(truth) = pose(["true_x_m", "true_y_m", "true_heading_rad"]) {
            self.pose(Topic::True, t_us, truth)?;
        }
        Ok(())
    }

    fn pose(&mut self, topic: Topic, t_us: u64, at: MapPose) -> McapResult<()> {
        let message =
            json!({ "timestamp": timestamp(t_us), "frame_id": "world", "pose": pose_json(at) });
        self.put_json(topic, t_us, &message)
    }

    /// Something that happened.
    pub(super) fn event(&mut self, event: &LoggedEvent) -> McapResult<()> {
        let t_us = to_us((event.t_s * 1e3).round() as i64);
        // The numbers of `foxglove.Log`; what was achieved is news like any other there, and keeps its name.
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
    pub(super) fn state(&mut self, state: &State) -> McapResult<()> {
        match serde_json::to_value(state) {
            Ok(mut message) => {
                leave_out_unknown(&mut message);
                let t_us = to_us((state.t_s * 1e3).round() as i64);
                self.put_json(Topic::State, t_us, &message)
            }
            Err(_) => Ok(()),
        }
    }

    /// The parameters' values, as far as they are known.
    pub(super) fn parameters(
        &mut self,
        t_us: u64,
        parameters: &[ParameterState],
    ) -> McapResult<()> {
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
    pub(super) fn scene(&mut self, t_us: u64, scene: Option<&Scene>) -> McapResult<()> {
        if let Some(scene) = scene {
            self.put_json(Topic::World, t_us, &world_json(t_us, scene))?;
        }
        match serde_json::to_vec(&json!({ "scene": scene })) {
            Ok(message) => self.put(Topic::Scene, t_us, &message),
            Err(_) => Ok(()),
        }
    }

    /// How the run ended.
    pub(super) fn outcome(&mut self, outcome: &Outcome) -> McapResult<()> {
        self.log.write_metadata(&Metadata {
            name: "outcome".into(),
            metadata: outcome.to_metadata(),
        })
    }

    /// Closes the chunk and hands everything to the system.
    pub(super) fn flush(&mut self) -> McapResult<()> {
        self.log.flush()
    }

    /// Writes the index.
    pub(super) fn finish(mut self) -> McapResult<()> {
        self.log.finish()?;
        self.log.into_inner().flush().map_err(Into::into)
    }
}

/// What is not known is left out, as in all messages: viewers take a field for what its schema says.
fn leave_out_unknown(message: &mut Value) {
    if let Value::Object(fields) = message {
        fields.retain(|_, value| !value.is_null());
        fields.values_mut().for_each(leave_out_unknown);
    }
}

fn to_us(t_ms: i64) -> u64 {
    // Telemetry of before the run began is none.
    u64::try_from(t_ms).unwrap_or_default() * 1_000
}

fn timestamp(t_us: u64) -> Value {
    json!({ "sec": t_us / 1_000_000, "nsec": t_us % 1_000_000 * 1_000 })
}

fn pose_json(at: MapPose) -> Value {
    let (sin, cos) = (0.5 * at.heading_rad).sin_cos();
    json!({ "position": { "x": at.x_m, "y": at.y_m, "z": 0.0 }, "orientation": { "x": 0.0, "y": 0.0, "z": sin, "w": cos } })
}

/// What is unknown is left out; a clear range is told by a field of its own, since viewers plot numbers.
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

fn world_json(t_us: u64, scene: &Scene) -> Value {
    /// Connects the points; the second also connects the last with the first.
    const LINE_STRIP: u8 = 0;
    const LINE_LOOP: u8 = 1;
    let lines: Vec<Value> = scene
        .obstacles
        .iter()
        .map(|obstacle| {
            let points: Vec<Value> =
                obstacle.corners_m.iter().map(|[x, y]| json!({ "x": x, "y": y, "z": 0.0 })).collect();
            json!({ "type": if obstacle.closed { LINE_LOOP } else { LINE_STRIP }, "pose": pose_json(MapPose::default()),
                "thickness": 0.01, "scale_invariant": false, "points": points,
                "color": { "r": 0.5, "g": 0.5, "b": 0.5, "a": 1.0 }, "colors": [], "indices": [] })
        })
        .collect();
    let entity = json!({ "timestamp": timestamp(t_us), "frame_id": "world", "id": "world", "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": false, "metadata": [], "arrows": [], "cubes": [], "spheres": [], "cylinders": [], "lines": lines,
        "triangles": [], "texts": [], "models": [] });
    json!({ "deletions": [], "entities": [entity] })
}
