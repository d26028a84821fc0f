//! The JSON schemas of the log's messages. Viewers know those named `foxglove.*`; of these only the fields in use are
//! here.

use crate::signals::Row;
use serde_json::{Map, Value, json};

/// Where messages of one kind go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Topic {
    /// The signals.
    Telemetry,
    /// What changes slowly.
    State,
    /// The parameters' values.
    Parameters,
    /// What happened.
    Events,
    /// The estimated pose.
    Estimated,
    /// The true pose.
    True,
    /// Walls and boxes.
    World,
    /// Outline and wheels of the robot.
    Body,
    /// Where the robot is.
    Frames,
    /// Where the sonar on the servo looks.
    ServoFrame,
    /// Where the other sonars sit.
    FixedFrames,
    /// What the dashboard draws around the robot.
    Scene,
    /// Raw bytes from the robot.
    FromRobot,
    /// Raw bytes to the robot.
    ToRobot,
    /// What crossed the USARTs of an emulated chip.
    Console,
    /// Checksums of the metadata.
    Digest,
    /// Ground truth and pins of an emulated robot.
    Truth,
    /// Numbers that a program printed.
    Printed,
    /// Terms of our simulated robot's control loops.
    Loops,
    /// Where the other robots in the world are.
    Others,
}

impl Topic {
    /// All of them, in the order of their numbers, each with its name in the log.
    pub(crate) const ALL: [(Self, &str); 20] = [
        (Self::Telemetry, "/telemetry"),
        (Self::State, "/state"),
        (Self::Parameters, "/parameters"),
        (Self::Events, "/events"),
        (Self::Estimated, "/pose/estimated"),
        (Self::True, "/pose/true"),
        (Self::World, "/world"),
        (Self::Body, "/robot"),
        (Self::Frames, "/frames"),
        (Self::ServoFrame, "/frames/servo"),
        (Self::FixedFrames, "/frames/fixed"),
        (Self::Scene, "/scene"),
        (Self::FromRobot, "/link/from_robot"),
        (Self::ToRobot, "/link/to_robot"),
        (Self::Console, "/console"),
        (Self::Digest, "/digest"),
        (Self::Truth, "/truth"),
        (Self::Printed, "/printed"),
        (Self::Loops, "/loops"),
        (Self::Others, "/pose/others"),
    ];

    /// Its name in the log.
    #[must_use]
    pub(crate) fn name(self) -> &'static str {
        let (_, name) = Self::ALL[self as usize];
        name
    }

    /// The topic of this name.
    #[must_use]
    pub(crate) fn find(name: &str) -> Option<Self> {
        let found = Self::ALL.into_iter().find(|(_, known)| *known == name);
        found.map(|(topic, _)| topic)
    }

    /// Whether it is written again where nothing changes, for who looks at a part of a log: viewers keep frames.
    pub(crate) fn is_repeated(self) -> bool {
        !matches!(self, Self::Frames | Self::ServoFrame)
    }

    /// Name and text of its schema.
    #[must_use]
    pub(crate) fn schema(self) -> (&'static str, Value) {
        match self {
            Self::Telemetry => ("rumbo.Telemetry", telemetry()),
            Self::State => ("rumbo.State", state()),
            Self::Parameters => ("rumbo.Parameters", parameters()),
            Self::Events => ("foxglove.Log", log()),
            Self::Estimated | Self::True => ("foxglove.PoseInFrame", pose_in_frame()),
            Self::World | Self::Body => ("foxglove.SceneUpdate", scene_update()),
            Self::Frames | Self::ServoFrame => ("foxglove.FrameTransform", frame_transform()),
            Self::FixedFrames => ("foxglove.FrameTransforms", frame_transforms()),
            // What it holds is for the dashboard.
            Self::Scene => ("rumbo.Scene", object("rumbo.Scene", json!({}))),
            Self::FromRobot | Self::ToRobot => ("rumbo.Bytes", bytes()),
            Self::Console => ("rumbo.Console", console()),
            Self::Digest => ("rumbo.Digest", digest()),
            // Which signals there are depends on the wiring.
            Self::Truth => ("rumbo.Truth", object("rumbo.Truth", json!({}))),
            Self::Printed => ("rumbo.Printed", printed()),
            Self::Loops => ("rumbo.Loops", object("rumbo.Loops", json!({}))),
            Self::Others => ("rumbo.Others", object("rumbo.Others", json!({}))),
        }
    }
}

fn object(title: &str, properties: Value) -> Value {
    json!({ "title": title, "type": "object", "properties": properties })
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn text() -> Value {
    json!({ "type": "string" })
}

fn telemetry() -> Value {
    let signals = Row::names().map(|name| (name.to_owned(), number()));
    let nothing = Row::ranges().map(|name| (format!("{name}_clear"), json!({ "type": "boolean" })));
    let properties: Map<String, Value> = signals.chain(nothing).collect();
    object("rumbo.Telemetry", Value::Object(properties))
}

fn state() -> Value {
    let flag = || json!({ "type": "boolean" });
    let link = [
        "telemetry_hz",
        "down_load",
        "up_load",
        "baud",
        "round_trip_ms",
        "crc_errors_down",
        "crc_errors_up",
        "frames_lost",
        "dropped",
        "unacknowledged",
        "clock_offset_ms",
        "clock_fast_ppm",
    ];
    let mut link: Map<String, Value> = link
        .map(|name| (name.to_owned(), number()))
        .into_iter()
        .collect();
    link.insert("connected".into(), flag());
    let robot = json!({ "mode": number(), "armed": flag(), "fault": text(), "battery_v": number(), "true_battery_v": number(),
        "servo_rad": number(), "rig": text() });
    object(
        "rumbo.State",
        json!({ "t_s": number(), "speed": number(), "achieved_speed": number(), "link": object("link", Value::Object(link)),
            "robot": object("robot", robot) }),
    )
}

fn parameters() -> Value {
    let properties: Map<String, Value> = crate::parameters::parameters()
        .map(|entry| (entry.name.to_owned(), number()))
        .collect();
    object("rumbo.Parameters", Value::Object(properties))
}

fn time() -> Value {
    object(
        "time",
        json!({ "sec": { "type": "integer" }, "nsec": { "type": "integer" } }),
    )
}

fn log() -> Value {
    object(
        "foxglove.Log",
        json!({ "timestamp": time(), "level": { "type": "integer" }, "message": text(), "name": text(), "file": text(),
            "line": { "type": "integer" } }),
    )
}

fn vector(title: &str) -> Value {
    object(
        title,
        json!({ "x": number(), "y": number(), "z": number() }),
    )
}

fn quaternion() -> Value {
    let numbers = json!({ "x": number(), "y": number(), "z": number(), "w": number() });
    object("foxglove.Quaternion", numbers)
}

fn pose() -> Value {
    object(
        "foxglove.Pose",
        json!({ "position": vector("foxglove.Vector3"), "orientation": quaternion() }),
    )
}

fn frame_transform() -> Value {
    object(
        "foxglove.FrameTransform",
        json!({ "timestamp": time(), "parent_frame_id": text(), "child_frame_id": text(),
            "translation": vector("foxglove.Vector3"), "rotation": quaternion() }),
    )
}

fn frame_transforms() -> Value {
    let transforms = json!({ "type": "array", "items": frame_transform() });
    object(
        "foxglove.FrameTransforms",
        json!({ "transforms": transforms }),
    )
}

fn pose_in_frame() -> Value {
    object(
        "foxglove.PoseInFrame",
        json!({ "timestamp": time(), "frame_id": text(), "pose": pose() }),
    )
}

fn scene_update() -> Value {
    let color = object(
        "foxglove.Color",
        json!({ "r": number(), "g": number(), "b": number(), "a": number() }),
    );
    let line = json!({ "type": { "type": "integer" }, "pose": pose(), "thickness": number(), "scale_invariant": { "type": "boolean" },
        "points": { "type": "array", "items": vector("foxglove.Point3") }, "color": color,
        "colors": { "type": "array", "items": color }, "indices": { "type": "array", "items": { "type": "integer" } } });
    let cylinder = json!({ "pose": pose(), "size": vector("foxglove.Vector3"), "bottom_scale": number(), "top_scale": number(),
        "color": color });
    let nothing = || json!({ "type": "array", "items": object("nothing", json!({})) });
    let entity = json!({ "timestamp": time(), "frame_id": text(), "id": text(), "lifetime": time(),
        "frame_locked": { "type": "boolean" }, "metadata": nothing(), "arrows": nothing(), "cubes": nothing(), "spheres": nothing(),
        "cylinders": { "type": "array", "items": object("foxglove.CylinderPrimitive", cylinder) }, "lines": { "type": "array", "items": object("foxglove.LinePrimitive", line) }, "triangles": nothing(),
        "texts": nothing(), "models": nothing() });
    object(
        "foxglove.SceneUpdate",
        json!({ "deletions": nothing(), "entities": { "type": "array", "items": object("foxglove.SceneEntity", entity) } }),
    )
}

fn bytes() -> Value {
    object(
        "rumbo.Bytes",
        json!({ "data": { "type": "string", "contentEncoding": "base64" },
            "pieces": { "type": "array", "items": { "type": "array", "items": { "type": "integer" } } } }),
    )
}

fn digest() -> Value {
    object(
        "rumbo.Digest",
        json!({ "name": text(), "crc32": { "type": "integer" } }),
    )
}

fn printed() -> Value {
    // The program gives the names.
    let values = object("values", json!({}));
    object(
        "rumbo.Printed",
        json!({ "usart": { "type": "integer" }, "values": values }),
    )
}

fn console() -> Value {
    object(
        "rumbo.Console",
        json!({ "usart": { "type": "integer" }, "to_chip": { "type": "boolean" },
            "data": { "type": "string", "contentEncoding": "base64" } }),
    )
}
