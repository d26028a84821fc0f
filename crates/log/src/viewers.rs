//! What viewers of MCAP draw, in Foxglove's schemas: poses, the robot's frames and body, walls and boxes.
//!
//! Frames: `world`; `odom`, the same as the robot believes it, so in the same place; in it `base_link`, the robot as it
//! estimates itself; on it the sonars. What moves is in the numbers of the pose beside it, which compresses well.

use crate::scene::{MapPose, Scene, SonarMount};
use serde_json::{Value, json};
use std::f64::consts::FRAC_1_SQRT_2;

/// The sonars' frames, by `SonarId` number.
const SONARS: [&str; 3] = ["sonar_left", "sonar_right", "sonar_front"];
/// Height of the sonars above the floor, and width of a wheel [m].
const SONAR_HEIGHT_M: f64 = 0.05;
const WHEEL_WIDTH_M: f64 = 0.026;
/// Connects the points; the second also connects the last with the first.
const LINE_STRIP: u8 = 0;
const LINE_LOOP: u8 = 1;

pub(crate) fn timestamp(t_us: u64) -> Value {
    json!({ "sec": t_us / 1_000_000, "nsec": t_us % 1_000_000 * 1_000 })
}

/// Place, at a height, and rotation.
fn place(at: MapPose, z_m: f64) -> [Value; 2] {
    // A heading in telemetry has four decimals.
    let [sin, cos] = [f64::sin, f64::cos].map(|of| (of(0.5 * at.heading_rad) * 1e6).round() / 1e6);
    [
        json!({ "x": at.x_m, "y": at.y_m, "z": z_m }),
        json!({ "x": 0.0, "y": 0.0, "z": sin, "w": cos }),
    ]
}

pub(crate) fn pose(at: MapPose) -> Value {
    let [position, orientation] = place(at, 0.0);
    json!({ "position": position, "orientation": orientation })
}

fn transform(t_us: u64, [parent, child]: [&str; 2], at: MapPose, z_m: f64) -> Value {
    let [translation, rotation] = place(at, z_m);
    json!({ "timestamp": timestamp(t_us), "parent_frame_id": parent, "child_frame_id": child, "translation": translation,
        "rotation": rotation })
}

/// A sonar's frame on the robot, with the servo turned by so much; `None` for one of another number.
pub(crate) fn sonar(t_us: u64, mount: &SonarMount, servo_rad: f64) -> Option<Value> {
    let frame = SONARS.get(usize::from(mount.id))?;
    let mut at = mount.at;
    at.heading_rad += if mount.on_servo { servo_rad } else { 0.0 };
    Some(transform(t_us, ["base_link", frame], at, SONAR_HEIGHT_M))
}

/// The robot's frame, as it estimates itself in the world.
pub(crate) fn robot(t_us: u64, at: MapPose) -> Value {
    transform(t_us, ["odom", "base_link"], at, 0.0)
}

/// The frames that do not move: of the world, and of the sonars that sit fast.
pub(crate) fn fixed(t_us: u64, sonars: &[SonarMount]) -> Value {
    let odom = transform(t_us, ["world", "odom"], MapPose::default(), 0.0);
    let mounts = sonars.iter().filter(|mount| !mount.on_servo);
    let sonars = mounts.filter_map(|mount| sonar(t_us, mount, 0.0));
    let transforms: Vec<Value> = [odom].into_iter().chain(sonars).collect();
    json!({ "transforms": transforms })
}

fn line(corners_m: &[[f64; 2]], closed: bool, z_m: f64, color: [f64; 3]) -> Value {
    let points = corners_m
        .iter()
        .map(|[x, y]| json!({ "x": x, "y": y, "z": z_m }));
    let points: Vec<Value> = points.collect();
    json!({ "type": if closed { LINE_LOOP } else { LINE_STRIP }, "pose": pose(MapPose::default()), "thickness": 0.01,
        "scale_invariant": false, "points": points, "color": shade(color), "colors": [], "indices": [] })
}

fn shade([r, g, b]: [f64; 3]) -> Value {
    json!({ "r": r, "g": g, "b": b, "a": 1.0 })
}

/// One thing in place of that before; `is_locked`: it moves with its frame.
fn update(
    t_us: u64,
    [frame, id]: [&str; 2],
    is_locked: bool,
    lines: &[Value],
    cylinders: &[Value],
) -> Value {
    let entity = json!({ "timestamp": timestamp(t_us), "frame_id": frame, "id": id, "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": is_locked, "metadata": [], "arrows": [], "cubes": [], "spheres": [], "cylinders": cylinders,
        "lines": lines, "triangles": [], "texts": [], "models": [] });
    json!({ "deletions": [], "entities": [entity] })
}

/// Walls and boxes.
pub(crate) fn world(t_us: u64, scene: &Scene) -> Value {
    let lines = scene.obstacles.iter();
    let lines = lines.map(|each| line(&each.corners_m, each.closed, 0.0, [0.5; 3]));
    let lines: Vec<Value> = lines.collect();
    update(t_us, ["world", "world"], false, &lines, &[])
}

/// The robot's outline and wheels.
pub(crate) fn body(t_us: u64, scene: &Scene) -> Value {
    let radius_m = scene.wheel_radius_m;
    let wheel = |sign: f64| {
        json!({ "pose": { "position": { "x": 0.0, "y": sign * 0.5 * scene.base_m, "z": radius_m },
                // The axis lies across.
                "orientation": { "x": FRAC_1_SQRT_2, "y": 0.0, "z": 0.0, "w": FRAC_1_SQRT_2 } },
            "size": { "x": 2.0 * radius_m, "y": 2.0 * radius_m, "z": WHEEL_WIDTH_M }, "bottom_scale": 1.0, "top_scale": 1.0,
            "color": shade([0.2; 3]) })
    };
    let outline = line(&scene.footprint_m, true, radius_m, [0.1, 0.4, 0.8]);
    let wheels = [wheel(1.0), wheel(-1.0)];
    update(t_us, ["base_link", "robot"], true, &[outline], &wheels)
}

#[cfg(test)]
mod tests {
    use crate::frames::Frames;
    use crate::scene::{MapPose, Scene, SceneObstacle, SonarMount};
    use crate::{Entry, LogWriter, Manifest, Row};
    use mcap::parse_record;
    use mcap::records::Record;
    use mcap::sans_io::{LinearReadEvent, LinearReader};
    use serde_json::{Value, json};
    use std::io::{Cursor, Read};

    fn at(x_m: f64, y_m: f64, heading_rad: f64) -> MapPose {
        MapPose {
            x_m,
            y_m,
            heading_rad,
        }
    }

    /// A log of 2 s ahead and 3 s of rest, counted from (3, 1); its servo looks to the left.
    fn log() -> Vec<u8> {
        let sonar = |id, y_m, on_servo| SonarMount {
            id,
            at: at(0.1, y_m, 0.0),
            on_servo,
            ..SonarMount::default()
        };
        let scene = Scene {
            obstacles: vec![SceneObstacle::default()],
            footprint_m: vec![[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1]],
            base_m: 0.15,
            wheel_radius_m: 0.03,
            sonars: vec![sonar(0, 0.07, false), sonar(2, 0.0, true)],
            ..Scene::default()
        };
        let rows = (0..125).map(|number| {
            let mut row = Row::unknown(40 * number);
            row.set_pose("", at(0.01 * number.min(50) as f64, 0.0, 0.0));
            row.set_pose("origin_", at(3.0, 1.0, 0.0));
            row.set("servo_rad", 0.5);
            row
        });
        let into = Cursor::new(Vec::new());
        let mut log = LogWriter::new(into, &Manifest::default()).unwrap();
        log.record(&Entry::Scene(Some(scene.into()))).unwrap();
        log.record(&Entry::Rows(rows.collect())).unwrap();
        log.finish().unwrap().into_inner()
    }

    /// The messages of a topic, with their times \[ms\].
    fn messages(mut log: &[u8], topic: &str) -> Vec<(u64, Value)> {
        let mut reader = LinearReader::new();
        reader.add_decompressor(Frames::lz4(1 << 20)).unwrap();
        let (mut channel, mut messages) = (None, Vec::new());
        while let Some(event) = reader.next_event() {
            match event.unwrap() {
                LinearReadEvent::ReadRequest(count) => {
                    let read = log.read(reader.insert(count)).unwrap();
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => match parse_record(opcode, data) {
                    Ok(Record::Channel(found)) if found.topic == topic => channel = Some(found.id),
                    Ok(Record::Message { header, data }) if Some(header.channel_id) == channel => {
                        let content = serde_json::from_slice(&data).unwrap();
                        messages.push((header.log_time / 1_000_000, content));
                    }
                    _ => {}
                },
            }
        }
        messages
    }

    #[test]
    fn every_channel_of_a_log_has_a_message() {
        let log = log();
        let summary = mcap::Summary::read(&log).unwrap().unwrap();
        let counts = summary.stats.unwrap().channel_message_counts;
        let topics = summary.channels.values();
        let mut topics: Vec<&str> = topics.map(|channel| &channel.topic[..]).collect();
        topics.sort_unstable();
        let expected = [
            "/digest",
            "/frames",
            "/frames/fixed",
            "/frames/servo",
            "/pose/estimated",
            "/robot",
            "/scene",
            "/telemetry",
            "/world",
        ];
        assert_eq!(topics, expected);
        assert!(summary.channels.keys().all(|id| counts[id] > 0));
    }

    #[test]
    fn robot_and_sonars_have_frames_that_lead_to_the_world() {
        let log = log();
        let last = |topic: &str| {
            let message = messages(&log, topic).pop().unwrap().1;
            let one = [message.clone()];
            let transforms = message["transforms"].as_array();
            let transforms = transforms.map_or(&one[..], |all| all).iter();
            let named = transforms.map(|each| {
                let names = ["parent_frame_id", "child_frame_id"].map(|of| each[of].clone());
                (names, each["translation"].clone(), each["rotation"].clone())
            });
            named.collect::<Vec<_>>()
        };
        let [odom, left] = &last("/frames/fixed")[..] else {
            panic!("two that do not move");
        };
        assert_eq!(odom.0, ["world", "odom"]);
        assert_eq!(odom.1, json!({ "x": 0.0, "y": 0.0, "z": 0.0 }));
        assert_eq!(left.0, ["base_link", "sonar_left"]);
        let [robot] = &last("/frames")[..] else {
            panic!("the robot");
        };
        assert_eq!(robot.0, ["odom", "base_link"]);
        // It counts from (3, 1).
        assert_eq!(robot.1, json!({ "x": 3.5, "y": 1.0, "z": 0.0 }));
        let [front] = &last("/frames/servo")[..] else {
            panic!("the sonar on the servo");
        };
        assert_eq!(front.0, ["base_link", "sonar_front"]);
        // Half of 0.5 rad.
        assert_eq!(front.2["z"], json!(0.247404));
    }

    #[test]
    fn a_robot_without_a_scene_has_a_frame_in_the_world_too() {
        let mut row = Row::unknown(40);
        row.set_pose("", at(0.5, 0.0, 0.0));
        row.set_pose("origin_", MapPose::default());
        let into = Cursor::new(Vec::new());
        let mut log = LogWriter::new(into, &Manifest::default()).unwrap();
        log.record(&Entry::Rows(vec![row])).unwrap();
        let log = log.finish().unwrap().into_inner();
        let topics = ["/frames/fixed", "/frames"];
        let [fixed, robot] = topics.map(|topic| messages(&log, topic).remove(0).1);
        assert_eq!(fixed["transforms"][0]["parent_frame_id"], "world");
        assert_eq!(robot["parent_frame_id"], "odom");
    }

    #[test]
    fn frames_are_written_where_they_change_and_where_a_rest_begins_and_ends() {
        let frames = messages(&log(), "/frames");
        let times_ms: Vec<u64> = frames.iter().map(|each| each.0).collect();
        // It stands from 2 s on, and the log ends at 4.96 s.
        let expected = [0, 320, 640, 960, 1280, 1600, 1920, 2240, 4960];
        assert_eq!(times_ms, expected);
    }

    #[test]
    fn the_robots_body_moves_with_its_frame() {
        let log = log();
        let [(_, body)] = &messages(&log, "/robot")[..] else {
            panic!("one message");
        };
        let entity = &body["entities"][0];
        assert_eq!(entity["frame_id"], "base_link");
        assert_eq!(entity["frame_locked"], true);
        assert_eq!(entity["lines"][0]["points"].as_array().unwrap().len(), 3);
        assert_eq!(entity["cylinders"].as_array().unwrap().len(), 2);
        let [(_, world)] = &messages(&log, "/world")[..] else {
            panic!("one message");
        };
        assert_eq!(world["entities"][0]["frame_id"], "world");
    }
}
