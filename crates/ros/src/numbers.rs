//! The numbers in a message of any type, by the text of its definition (`ros2msg`).
//!
//! ```text
//! sensor_msgs/msg/JointState     position of the joint `left_wheel`   left_wheel/position
//! nav_msgs/msg/Odometry          pose.pose.position.x                 pose/pose/position/x
//!                                pose.pose.orientation, as an angle   pose/pose/orientation/yaw
//! ```
//!
//! Names are those of PlotJuggler. Texts are passed over, but for a frame's, and so are stamps, covariances, and
//! sequences of more than [`LONGEST`] numbers.

use std::collections::HashMap;

/// Numbers of a sequence that are taken.
const LONGEST: usize = 16;
/// Messages within messages.
const DEEPEST: usize = 8;

/// Types that bags of older versions have without a definition: name, text.
const PLAIN: [(&str, &str); 12] = [
    ("std_msgs/msg/Bool", "bool data"),
    ("std_msgs/msg/Int8", "int8 data"),
    ("std_msgs/msg/UInt8", "uint8 data"),
    ("std_msgs/msg/Int16", "int16 data"),
    ("std_msgs/msg/UInt16", "uint16 data"),
    ("std_msgs/msg/Int32", "int32 data"),
    ("std_msgs/msg/UInt32", "uint32 data"),
    ("std_msgs/msg/Int64", "int64 data"),
    ("std_msgs/msg/UInt64", "uint64 data"),
    ("std_msgs/msg/Float32", "float32 data"),
    ("std_msgs/msg/Float64", "float64 data"),
    ("std_msgs/msg/String", "string data"),
];

/// The definition of a type that is known here, for bags without one.
#[must_use]
pub fn known_definition(name: &str) -> Option<String> {
    use crate::messages::{
        BatteryState, JointState, LaserScan, Odometry, Range, Twist, TwistStamped,
    };
    use crate::types::Message;
    let ours = [
        BatteryState::DEFINITION,
        JointState::DEFINITION,
        LaserScan::DEFINITION,
        Odometry::DEFINITION,
        Range::DEFINITION,
        Twist::DEFINITION,
        TwistStamped::DEFINITION,
    ];
    let ours = ours.iter().find(|definition| definition.name == name);
    let plain = || PLAIN.iter().find(|(plain, _)| *plain == name);
    ours.map(|definition| definition.text())
        .or_else(|| plain().map(|(_, text)| (*text).to_owned()))
}

/// A type of message, as its definition says.
#[derive(Debug)]
pub struct MessageShape {
    main: Vec<Field>,
    parts: HashMap<String, Vec<Field>>,
}

/// What is in a message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers {
    /// The frame that its header names.
    pub frame: String,
    /// Each number with its name.
    pub values: Vec<(String, f64)>,
}

#[derive(Debug)]
struct Field {
    name: String,
    kind: Kind,
    many: Many,
}

#[derive(Clone, Debug)]
enum Kind {
    /// Whole numbers and truth values: bytes, signed.
    Integer(usize, bool),
    /// Bytes.
    Float(usize),
    Text,
    /// By its short name.
    Message(String),
}

#[derive(Clone, Copy, Debug)]
enum Many {
    One,
    Always(usize),
    AsSent,
}

impl MessageShape {
    /// Reads a definition; `None` where it is in another language.
    #[must_use]
    pub fn of(name: &str, definition: &str) -> Option<Self> {
        let mut sections = definition.split("\n====");
        let package = |name: &str| name.split('/').next().unwrap_or_default().to_owned();
        let main = fields(sections.next()?, &package(name))?;
        let mut parts = HashMap::new();
        for section in sections {
            let text = section.trim_start_matches('=').trim_start();
            let (head, text) = text.split_once('\n').unwrap_or((text, ""));
            let name = short(head.strip_prefix("MSG:")?.trim());
            let part = fields(text, &package(&name))?;
            parts.insert(name, part);
        }
        Some(Self { main, parts })
    }

    /// The numbers of a message in CDR; `None` if it ends early or is no such message.
    #[must_use]
    pub fn read(&self, data: &[u8]) -> Option<Numbers> {
        let (header, body) = data.split_at_checked(4)?;
        let mut reader = Reader {
            shape: self,
            data: body,
            at: 0,
            is_little: header[1] & 1 == 1,
            // The second version of CDR.
            widest: if header[1] >= 6 { 4 } else { 8 },
            found: Numbers::default(),
        };
        reader.message(&self.main, "", true, 0)?;
        Some(reader.found)
    }
}

/// Without the folder: `std_msgs/Header`.
fn short(name: &str) -> String {
    name.replace("/msg/", "/")
}

fn fields(text: &str, package: &str) -> Option<Vec<Field>> {
    let lines = text.lines().filter_map(|line| {
        let line = line.split('#').next().unwrap_or_default().trim();
        let (kind, rest) = line.split_once(char::is_whitespace)?;
        let name = rest.split_whitespace().next()?;
        // A constant.
        let is_constant = name.contains('=')
            || rest.trim_start()[name.len()..]
                .trim_start()
                .starts_with('=');
        (!is_constant).then_some((kind, name))
    });
    lines
        .map(|(kind, name)| {
            let (of, many) = match kind.split_once('[') {
                None => (kind, Many::One),
                Some((of, count)) => {
                    let count = count.strip_suffix(']')?;
                    let many = count.parse().map_or(Many::AsSent, Many::Always);
                    (of, many)
                }
            };
            let kind = kind_of(of, package)?;
            let name = name.to_owned();
            Some(Field { name, kind, many })
        })
        .collect()
}

fn kind_of(name: &str, package: &str) -> Option<Kind> {
    Some(match name {
        "bool" | "byte" | "char" | "uint8" => Kind::Integer(1, false),
        "int8" => Kind::Integer(1, true),
        "int16" => Kind::Integer(2, true),
        "uint16" => Kind::Integer(2, false),
        "int32" => Kind::Integer(4, true),
        "uint32" => Kind::Integer(4, false),
        "int64" => Kind::Integer(8, true),
        "uint64" => Kind::Integer(8, false),
        "float32" => Kind::Float(4),
        "float64" => Kind::Float(8),
        _ if name.starts_with("string") => Kind::Text,
        "Header" => Kind::Message("std_msgs/Header".into()),
        _ if name.contains('/') => Kind::Message(short(name)),
        _ if name.starts_with(|c: char| c.is_ascii_uppercase()) => {
            Kind::Message(format!("{package}/{name}"))
        }
        _ => return None,
    })
}

struct Reader<'a> {
    shape: &'a MessageShape,
    data: &'a [u8],
    at: usize,
    is_little: bool,
    widest: usize,
    found: Numbers,
}

impl Reader<'_> {
    fn bytes<const COUNT: usize>(&mut self) -> Option<[u8; COUNT]> {
        let aligned = COUNT.min(self.widest);
        self.at = self.at.next_multiple_of(aligned);
        let bytes = *self.data.get(self.at..)?.first_chunk::<COUNT>()?;
        self.at += COUNT;
        let mut bytes = bytes;
        if !self.is_little {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn length(&mut self) -> Option<usize> {
        let length = u32::from_le_bytes(self.bytes()?) as usize;
        // Everything takes a byte at least.
        (length <= self.data.len()).then_some(length)
    }

    fn text(&mut self) -> Option<String> {
        let length = self.length()?;
        let text = self.data.get(self.at..self.at + length)?;
        self.at += length;
        Some(
            String::from_utf8_lossy(text)
                .trim_end_matches('\0')
                .to_owned(),
        )
    }

    fn number(&mut self, kind: &Kind) -> Option<f64> {
        Some(match kind {
            Kind::Integer(1, false) => f64::from(u8::from_le_bytes(self.bytes()?)),
            Kind::Integer(1, true) => f64::from(i8::from_le_bytes(self.bytes()?)),
            Kind::Integer(2, false) => f64::from(u16::from_le_bytes(self.bytes()?)),
            Kind::Integer(2, true) => f64::from(i16::from_le_bytes(self.bytes()?)),
            Kind::Integer(4, false) => f64::from(u32::from_le_bytes(self.bytes()?)),
            Kind::Integer(4, true) => f64::from(i32::from_le_bytes(self.bytes()?)),
            Kind::Integer(_, false) => u64::from_le_bytes(self.bytes()?) as f64,
            Kind::Integer(_, true) => i64::from_le_bytes(self.bytes()?) as f64,
            Kind::Float(4) => f64::from(f32::from_le_bytes(self.bytes()?)),
            Kind::Float(_) => f64::from_le_bytes(self.bytes()?),
            Kind::Text | Kind::Message(_) => return None,
        })
    }

    fn put(&mut self, name: String, value: f64, is_wanted: bool) {
        if is_wanted && value.is_finite() {
            self.found.values.push((name, value));
        }
    }

    /// The fields of a message; the names of a message that has some are those of its numbers.
    fn message(
        &mut self,
        fields: &[Field],
        path: &str,
        is_wanted: bool,
        deep: usize,
    ) -> Option<()> {
        if deep > DEEPEST {
            return None;
        }
        let mut names: Vec<String> = Vec::new();
        for field in fields {
            let name = match path {
                "" => field.name.clone(),
                path => format!("{path}/{}", field.name),
            };
            let wanted = is_wanted && !field.name.contains("covariance");
            let count = match field.many {
                Many::One => 1,
                Many::Always(count) => count,
                Many::AsSent => self.length()?,
            };
            let is_one = matches!(field.many, Many::One);
            match &field.kind {
                Kind::Text => {
                    for _ in 0..count {
                        let text = self.text()?;
                        match field.name.as_str() {
                            "frame_id" if wanted => self.found.frame = text,
                            "name" if !is_one => names.push(text),
                            _ => {}
                        }
                    }
                }
                Kind::Message(part) => {
                    let part = self.shape.parts.get(part);
                    // Of the messages that come without their definition: a stamp.
                    let wanted = wanted && is_one && field.name != "stamp";
                    for _ in 0..count {
                        self.part(part?, &name, wanted, deep)?;
                    }
                }
                kind => {
                    let wanted = wanted && (is_one || count <= LONGEST);
                    for index in 0..count {
                        let value = self.number(kind)?;
                        let of = match (is_one, names.get(index)) {
                            (true, _) => name.clone(),
                            (false, Some(owner)) if path.is_empty() => format!("{owner}/{name}"),
                            (false, _) => format!("{name}[{index}]"),
                        };
                        self.put(of, value, wanted);
                    }
                }
            }
        }
        Some(())
    }

    /// A message in a message; a rotation has its angle about the vertical besides.
    fn part(&mut self, fields: &[Field], name: &str, is_wanted: bool, deep: usize) -> Option<()> {
        let from = self.found.values.len();
        self.message(fields, name, is_wanted, deep + 1)?;
        let is_rotation = fields.len() == 4 && fields.last().is_some_and(|field| field.name == "w");
        if let (true, [x, y, z, w]) = (is_rotation, self.found.values.get(from..)?) {
            let (x, y, z, w) = (x.1, y.1, z.1, w.1);
            let yaw_rad = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z));
            self.put(format!("{name}/yaw"), yaw_rad, true);
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::messages::{JointState, Odometry, Range};
    use crate::types::{Message, encode};

    fn numbers<M: Message>(message: &M) -> Numbers {
        let definition = M::DEFINITION;
        let shape = MessageShape::of(definition.name, &definition.text()).unwrap();
        let data = encode(message).unwrap();
        for end in 0..data.len() {
            // What ends early is no message, and no panic.
            let _ = shape.read(&data[..end]);
        }
        shape.read(&data).unwrap()
    }

    fn value(numbers: &Numbers, name: &str) -> f64 {
        let found = numbers.values.iter().find(|(each, _)| each == name);
        found.unwrap_or_else(|| panic!("{name}: {numbers:?}")).1
    }

    #[test]
    fn a_rotation_is_a_heading_and_a_covariance_is_no_signal() {
        let mut odometry = Odometry::default();
        odometry.header.frame_id = "odom".into();
        odometry.pose.pose.position.x = 1.5;
        odometry.pose.pose.orientation.z = (-0.5_f64).sin();
        odometry.pose.pose.orientation.w = (-0.5_f64).cos();
        odometry.twist.twist.angular.z = 0.25;
        let found = numbers(&odometry);
        assert_eq!(found.frame, "odom");
        assert_eq!(value(&found, "pose/pose/position/x"), 1.5);
        assert!((value(&found, "pose/pose/orientation/yaw") + 1.0).abs() < 1e-12);
        assert_eq!(value(&found, "twist/twist/angular/z"), 0.25);
        assert!(
            found
                .values
                .iter()
                .all(|(name, _)| !name.contains("covariance") && !name.contains("stamp"))
        );
    }

    #[test]
    fn joints_have_their_names_and_a_clear_range_is_no_number() {
        let joints = JointState {
            name: vec!["left_wheel".into(), "right_wheel".into()],
            velocity: vec![1.0, -2.0],
            ..JointState::default()
        };
        assert_eq!(value(&numbers(&joints), "right_wheel/velocity"), -2.0);
        let range = |range| {
            numbers(&Range {
                range,
                ..Range::default()
            })
        };
        assert_eq!(value(&range(0.5), "range"), 0.5);
        assert!(
            range(f32::INFINITY)
                .values
                .iter()
                .all(|(name, _)| name != "range")
        );
    }

    #[test]
    fn definitions_as_people_write_them_are_read() {
        let text = "# about\nint8 MOST=3\nint8 LEAST = -3\nHeader header  # when\nfloat32[3] gains\nPart part\nstring<=8 note \"none\"\n\
            ================\nMSG: std_msgs/Header\nuint32 seq\nstring frame_id\n================\nMSG: mine/Part\nint16 count 5\n";
        let shape = MessageShape::of("mine/msg/Whole", text).unwrap();
        let mut data = vec![0, 1, 0, 0, 7, 0, 0, 0, 2, 0, 0, 0, b'b', 0, 0, 0];
        for gain in [1.0_f32, 2.0, 3.0] {
            data.extend(gain.to_le_bytes());
        }
        data.extend([4, 1, 0, 0, 1, 0, 0, 0, 0]);
        let found = shape.read(&data).unwrap();
        assert_eq!(
            (value(&found, "gains[1]"), value(&found, "part/count")),
            (2.0, 260.0)
        );
        assert_eq!(found.frame, "b");
        assert!(MessageShape::of("x/msg/Y", "module x { struct Y { double z; }; };").is_none());
    }
}
