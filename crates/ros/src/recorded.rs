//! Bags and logs that other programs recorded: the numbers of each topic over time.
//!
//! MCAP with messages in CDR (ROS 2) or JSON (Foxglove), and the SQLite files (`.db3`) of ROS 2 before Iron.

use crate::numbers::{MessageShape, known_definition};
use crate::sqlite::{Database, MAGIC};
use rumbo_log::read_foreign;
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};

/// Numbers that are taken of a file, all together.
const MOST: usize = 20_000_000;

/// One number over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Topic and field: `/odom/pose/pose/position/x`.
    pub name: String,
    /// The type of its messages.
    pub kind: String,
    /// The frame that their headers name.
    pub frame: String,
    /// Time since the first message \[s\], and value.
    pub samples: Vec<(f64, f64)>,
}

/// What a file holds.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    /// By name.
    pub series: Vec<Series>,
    /// What of it is not read, a line each.
    pub notes: Vec<String>,
}

/// Whether bytes are a bag or a log that [`recorded`] reads.
#[must_use]
pub fn is_recorded(bytes: &[u8]) -> bool {
    bytes.starts_with(rumbo_log::MAGIC) || bytes.starts_with(MAGIC)
}

/// Reads a file; `None` if it is damaged from the beginning or no bag.
#[must_use]
pub fn recorded(bytes: &[u8]) -> Option<Recorded> {
    let mut intake = Intake::default();
    let mut notes = match bytes.starts_with(MAGIC) {
        true => {
            intake.take_database(bytes)?;
            Vec::new()
        }
        false => {
            let stop = read_foreign(bytes, |message| {
                let definition = String::from_utf8_lossy(message.definition);
                intake.take(
                    message.topic,
                    (message.schema, message.encoding, &definition),
                    message.t_ns,
                    message.data,
                );
            });
            stop.map(|why| format!("it is read as far as it is whole: {why}"))
                .into_iter()
                .collect()
        }
    };
    for (topic, (kind, count)) in intake.unread {
        notes.push(format!("{topic} ({kind}): {count} messages are not read"));
    }
    if intake.left_out > 0 {
        notes.push(format!(
            "{} numbers are left out: more than {MOST}",
            intake.left_out
        ));
    }
    let first_ns = intake.first_ns.unwrap_or_default();
    let series = intake.series.into_iter().map(|(name, found)| Series {
        name,
        kind: found.kind,
        frame: found.frame,
        samples: found
            .samples
            .into_iter()
            .map(|(t_ns, value)| (t_ns.abs_diff(first_ns) as f64 / 1e9, value))
            .collect(),
    });
    let series = series.collect();
    Some(Recorded { series, notes })
}

#[derive(Default)]
struct Found {
    kind: String,
    frame: String,
    samples: Vec<(u64, f64)>,
}

#[derive(Default)]
struct Intake {
    shapes: HashMap<String, Option<MessageShape>>,
    series: BTreeMap<String, Found>,
    /// Topics whose messages cannot be read: their type, how many.
    unread: BTreeMap<String, (String, usize)>,
    first_ns: Option<u64>,
    taken: usize,
    left_out: usize,
}

impl Intake {
    /// A message; its type is a name, how its bytes are written, and a definition.
    fn take(&mut self, topic: &str, of: (&str, &str, &str), t_ns: u64, data: &[u8]) {
        let (kind, encoding, definition) = of;
        let found = match encoding {
            "json" => serde_json::from_slice(data).ok().map(|message| {
                let mut values = Vec::new();
                flatten("", &message, &mut values);
                (String::new(), values)
            }),
            "cdr" => {
                let shape = self.shapes.entry(kind.to_owned());
                let shape = shape.or_insert_with(|| MessageShape::of(kind, definition));
                let numbers = shape.as_ref().and_then(|shape| shape.read(data));
                numbers.map(|numbers| (numbers.frame, numbers.values))
            }
            _ => None,
        };
        let Some((frame, values)) = found else {
            let unread = self.unread.entry(topic.to_owned());
            unread.or_insert_with(|| (kind.to_owned(), 0)).1 += 1;
            return;
        };
        self.first_ns = Some(self.first_ns.map_or(t_ns, |first| first.min(t_ns)));
        for (name, value) in values {
            if self.taken >= MOST {
                self.left_out += 1;
                continue;
            }
            self.taken += 1;
            let found = self.series.entry(format!("{topic}/{name}")).or_default();
            if found.samples.is_empty() {
                kind.clone_into(&mut found.kind);
                found.frame.clone_from(&frame);
            }
            found.samples.push((t_ns, value));
        }
    }

    fn take_database(&mut self, bytes: &[u8]) -> Option<()> {
        let database = Database::open(bytes)?;
        // Newer ones have the definitions too.
        let definitions: HashMap<String, String> = database
            .rows("message_definitions")
            .unwrap_or_default()
            .iter()
            .filter_map(|row| {
                Some((
                    row.get(1)?.text()?.to_owned(),
                    row.get(3)?.text()?.to_owned(),
                ))
            })
            .collect();
        let topics: HashMap<i64, (String, String, String)> = database
            .rows("topics")?
            .iter()
            .filter_map(|row| {
                let text = |at: usize| Some(row.get(at)?.text()?.to_owned());
                Some((row.first()?.integer()?, (text(1)?, text(2)?, text(3)?)))
            })
            .collect();
        for row in database.rows("messages")? {
            let [_, topic, t_ns, crate::sqlite::Value::Blob(data), ..] = &row[..] else {
                continue;
            };
            let Some((name, kind, encoding)) = topic.integer().and_then(|id| topics.get(&id))
            else {
                continue;
            };
            if !self.shapes.contains_key(kind) {
                let known = definitions
                    .get(kind)
                    .cloned()
                    .filter(|text| !text.is_empty());
                let definition = known.or_else(|| known_definition(kind));
                let shape = definition.and_then(|text| MessageShape::of(kind, &text));
                self.shapes.insert(kind.clone(), shape);
            }
            let t_ns = u64::try_from(t_ns.integer()?).ok()?;
            self.take(name, (kind, encoding, ""), t_ns, data);
        }
        Some(())
    }
}

/// The numbers of a message in JSON.
fn flatten(path: &str, value: &Value, into: &mut Vec<(String, f64)>) {
    let below = |name: &str| match path {
        "" => name.to_owned(),
        path => format!("{path}/{name}"),
    };
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                flatten(&below(name), value, into);
            }
        }
        Value::Bool(value) => into.push((path.to_owned(), f64::from(u8::from(*value)))),
        Value::Number(value) => into.extend(value.as_f64().map(|value| (path.to_owned(), value))),
        Value::Null | Value::String(_) | Value::Array(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the recorder's format before Iron, with pages of 512 bytes: odometry, joints, a type of its own.
    const FOXY: &[u8] = include_bytes!("../tests/bags/foxy.db3");
    /// By the Python package `mcap-ros2-support`, which compresses with Zstandard: twist, range, a number.
    const ZSTD: &[u8] = include_bytes!("../tests/bags/zstd.mcap");

    fn last(recorded: &Recorded, name: &str) -> (f64, f64) {
        let found = recorded.series.iter().find(|series| series.name == name);
        let series = found.unwrap_or_else(|| panic!("{name}: {recorded:?}"));
        *series.samples.last().unwrap()
    }

    #[test]
    fn a_bag_of_an_older_ros_is_read_without_a_library_and_says_what_it_leaves() {
        let bag = recorded(FOXY).unwrap();
        assert_eq!(last(&bag, "/odom/pose/pose/position/x"), (0.55, 0.11));
        let (_, yaw_rad) = last(&bag, "/odom/pose/pose/orientation/yaw");
        assert!((yaw_rad - 1.1).abs() < 1e-9, "{yaw_rad}");
        assert_eq!(
            last(&bag, "/joint_states/right_wheel_joint/velocity").1,
            8.0
        );
        assert_eq!(bag.notes, ["/odd (mine/msg/Odd): 1 messages are not read"]);
    }

    #[test]
    fn chunks_in_zstandard_are_read() {
        let log = recorded(ZSTD).unwrap();
        assert_eq!(last(&log, "/cmd_vel/angular/z"), (1.95, -0.5));
        let range = log
            .series
            .iter()
            .find(|series| series.name == "/sonar/range");
        assert_eq!(range.unwrap().frame, "sonar_left");
        assert_eq!(
            (range.unwrap().samples.len(), &log.notes[..]),
            (40, &[][..])
        );
    }

    #[test]
    fn a_damaged_file_is_read_as_far_as_it_goes_and_ends() {
        for whole in [FOXY, ZSTD] {
            for at in (0..whole.len()).step_by(7) {
                let mut damaged = whole.to_vec();
                damaged[at] ^= 0xFF;
                let _ = recorded(&damaged);
                let _ = recorded(&whole[..at]);
            }
        }
        let cut = recorded(&ZSTD[..ZSTD.len() / 2]).unwrap();
        assert!(
            cut.notes[0].starts_with("it is read as far as it is whole"),
            "{:?}",
            cut.notes
        );
    }
}
