//! Types of messages: a Rust structure describes its ROS 2 type, from which the definition's text and its hash follow.
//!
//! The hash (REP 2016, `RIHS01`) is the SHA-256 of the description in JSON, as `rosidl` writes it. It makes sure that
//! both ends of a topic mean the same.

use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The type of a field.
#[derive(Clone, Copy, Debug)]
pub enum Type {
    /// `bool`.
    Bool,
    /// `byte`, eight bits without a meaning as a number.
    Byte,
    /// `int8`.
    I8,
    /// `uint8`.
    U8,
    /// `int16`.
    I16,
    /// `uint16`.
    U16,
    /// `int32`.
    I32,
    /// `uint32`.
    U32,
    /// `int64`.
    I64,
    /// `uint64`.
    U64,
    /// `float32`.
    F32,
    /// `float64`.
    F64,
    /// `string`.
    String,
    /// Another message.
    Message(&'static Definition),
    /// So many of them, of a primitive type.
    Array(&'static Type, usize),
    /// Any number of them.
    Sequence(&'static Type),
    /// None or one of them.
    Optional(&'static Type),
}

/// A message: its name and fields.
#[derive(Debug)]
pub struct Definition {
    /// Package and name: `std_msgs/msg/Header`.
    pub name: &'static str,
    /// The fields in order.
    pub fields: &'static [(&'static str, Type)],
}

/// What has a type in ROS 2.
pub trait Described {
    /// Its type.
    const TYPE: Type;
}

/// A message of its own, as topics carry it.
pub trait Message: Described + Serialize {
    /// What it is made of.
    const DEFINITION: &'static Definition;
}

macro_rules! primitives {
    ($($rust:ty => $type:ident),* $(,)?) => {
        $(impl Described for $rust { const TYPE: Type = Type::$type; })*
    };
}

primitives! {
    bool => Bool, Byte => Byte, i8 => I8, u8 => U8, i16 => I16, u16 => U16, i32 => I32, u32 => U32, i64 => I64, u64 => U64,
    f32 => F32, f64 => F64, String => String,
}

impl<T: Described> Described for Vec<T> {
    const TYPE: Type = Type::Sequence(&T::TYPE);
}

// In CDR a value that may be missing is what a sequence of at most one is.
impl<T: Described> Described for Option<T> {
    const TYPE: Type = Type::Optional(&T::TYPE);
}

impl<T: Described, const COUNT: usize> Described for [T; COUNT] {
    const TYPE: Type = Type::Array(&T::TYPE, COUNT);
}

/// `byte`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Byte(pub u8);

/// A matrix of 6 x 6 by rows: x, y, z, and rotations about them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance(pub [f64; 36]);

impl Default for Covariance {
    fn default() -> Self {
        Self([0.0; 36])
    }
}

impl Described for Covariance {
    const TYPE: Type = Type::Array(&Type::F64, 36);
}

// Serde has arrays of at most 32.
impl Serialize for Covariance {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeTuple;
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for value in &self.0 {
            tuple.serialize_element(value)?;
        }
        tuple.end()
    }
}

/// Declares messages: structures, and their types. A field whose name is a word of Rust has another one here.
macro_rules! messages {
    ($($(#[$about:meta])* $ros:literal $name:ident {
        $($(#[$meaning:meta])* $field:ident $(as $called:literal)?: $type:ty,)*
    })*) => {
        $(
            $(#[$about])*
            #[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
            pub struct $name { $($(#[$meaning])* pub $field: $type,)* }

            impl $crate::types::Described for $name {
                const TYPE: $crate::types::Type = $crate::types::Type::Message(
                    <Self as $crate::types::Message>::DEFINITION,
                );
            }

            impl $crate::types::Message for $name {
                const DEFINITION: &'static $crate::types::Definition = &$crate::types::Definition {
                    name: $ros,
                    fields: &[$(([$($called,)? stringify!($field)][0], <$type as $crate::types::Described>::TYPE),)*],
                };
            }
        )*
    };
}
pub(crate) use messages;

impl Type {
    /// As definitions write it; a message by package and name.
    fn text(self) -> String {
        match self {
            Self::Bool => "bool".into(),
            Self::Byte => "byte".into(),
            Self::I8 => "int8".into(),
            Self::U8 => "uint8".into(),
            Self::I16 => "int16".into(),
            Self::U16 => "uint16".into(),
            Self::I32 => "int32".into(),
            Self::U32 => "uint32".into(),
            Self::I64 => "int64".into(),
            Self::U64 => "uint64".into(),
            Self::F32 => "float32".into(),
            Self::F64 => "float64".into(),
            Self::String => "string".into(),
            Self::Message(message) => message.short_name(),
            Self::Array(of, count) => format!("{}[{count}]", of.text()),
            Self::Sequence(of) => format!("{}[]", of.text()),
            Self::Optional(of) => format!("{}[<=1]", of.text()),
        }
    }

    /// Number of the type in a description (`type_description_interfaces/msg/FieldType`).
    fn number(self) -> u8 {
        match self {
            Self::Message(_) => 1,
            Self::I8 => 2,
            Self::U8 => 3,
            Self::I16 => 4,
            Self::U16 => 5,
            Self::I32 => 6,
            Self::U32 => 7,
            Self::I64 => 8,
            Self::U64 => 9,
            Self::F32 => 10,
            Self::F64 => 11,
            Self::Bool => 15,
            Self::Byte => 16,
            Self::String => 17,
            Self::Array(of, _) => 48 + of.number(),
            Self::Optional(of) => 96 + of.number(),
            Self::Sequence(of) => 144 + of.number(),
        }
    }

    fn message(self) -> Option<&'static Definition> {
        match self {
            Self::Message(message) => Some(message),
            Self::Array(of, _) | Self::Sequence(of) | Self::Optional(of) => of.message(),
            _ => None,
        }
    }
}

impl Definition {
    /// Without the folder: `std_msgs/Header`.
    fn short_name(&self) -> String {
        self.name.replace("/msg/", "/")
    }

    /// The text of its definition, those of the messages in it after it.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = self.own_text();
        for message in self.parts().values() {
            let _ = write!(
                text,
                "{}\nMSG: {}\n{}",
                "=".repeat(80),
                message.short_name(),
                message.own_text()
            );
        }
        text
    }

    fn own_text(&self) -> String {
        let fields = self.fields.iter();
        let lines = fields.map(|(name, kind)| format!("{} {name}\n", kind.text()));
        lines.collect()
    }

    /// The messages in it, by name.
    fn parts(&self) -> BTreeMap<&'static str, &'static Definition> {
        let mut parts = BTreeMap::new();
        for (_, kind) in self.fields {
            if let Some(message) = kind.message() {
                parts.insert(message.name, message);
                parts.append(&mut message.parts());
            }
        }
        parts
    }

    /// Its hash: `RIHS01_` and 64 hexadecimal digits.
    #[must_use]
    pub fn hash(&self) -> String {
        let parts: Vec<String> = self.parts().values().map(|part| part.json()).collect();
        let description = format!(
            r#"{{"type_description": {}, "referenced_type_descriptions": [{}]}}"#,
            self.json(),
            parts.join(", ")
        );
        let digest = Sha256::digest(description);
        let digits = digest.iter().map(|byte| format!("{byte:02x}"));
        format!("RIHS01_{}", digits.collect::<String>())
    }

    /// Its description. Blanks count, since the text is hashed.
    fn json(&self) -> String {
        let fields = self.fields.iter().map(|(name, kind)| {
            let capacity = match kind {
                Type::Array(_, count) => *count,
                Type::Optional(_) => 1,
                _ => 0,
            };
            let nested = kind.message().map_or("", |message| message.name);
            format!(
                r#"{{"name": "{name}", "type": {{"type_id": {}, "capacity": {capacity}, "string_capacity": 0, "nested_type_name": "{nested}"}}}}"#,
                kind.number()
            )
        });
        let fields: Vec<String> = fields.collect();
        format!(
            r#"{{"type_name": "{}", "fields": [{}]}}"#,
            self.name,
            fields.join(", ")
        )
    }
}

/// A message as bytes: CDR, little-endian, with its header of four bytes.
///
/// # Errors
/// What CDR cannot express; none of the messages here.
pub fn encode<M: Message>(message: &M) -> Result<Vec<u8>, cdr_encoding::Error> {
    let body = cdr_encoding::to_vec::<M, byteorder::LittleEndian>(message)?;
    Ok([&[0, 1, 0, 0], &body[..]].concat())
}

/// The contents of a message, from its bytes in CDR with their header. A message is a tuple of its fields here: any type
/// of the same shape will do.
///
/// # Errors
/// Bytes that end early or hold something else.
pub fn decode<T: DeserializeOwned>(data: &[u8]) -> Result<T, cdr_encoding::Error> {
    let (header, body) = data.split_at_checked(4).unwrap_or_default();
    let decoded = match header {
        [0, 0, ..] => cdr_encoding::from_bytes::<T, byteorder::BigEndian>(body),
        _ => cdr_encoding::from_bytes::<T, byteorder::LittleEndian>(body),
    };
    decoded.map(|(content, _)| content)
}
