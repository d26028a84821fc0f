//! The whole state of the robot in the chip's SRAM, formatted as `{:?}` formats the native one.
//!
//! The image's debugging information gives the layout ([`shape`]), with the names that `derive(Debug)` prints. So both
//! texts are generated and can be compared: a new field is in both. `{:?}` of a float represents all its bits, except
//! for non-finite values, which the core never has.

mod shape;

use rumbo_emulator::image::Image;
use shape::{Number, Shape};
use std::fmt::{self, Write};
use std::ops::Range;

/// Distinguishes the robot from other types of its name.
const ROBOT: &str = "Robot";

/// Address and type of the robot.
pub(crate) struct State {
    shape: Shape,
    bytes: usize,
    pointer: usize,
}

impl State {
    /// From the bytes of an ELF file.
    pub(crate) fn of(elf: &[u8], image: &Image) -> State {
        let pointer = image.variable("RUMBO_ROBOT").unwrap().address;
        let (bytes, shape) = Shape::named(elf, ROBOT).unwrap();
        State {
            shape,
            bytes,
            pointer: pointer as usize,
        }
    }

    /// The robot as text; `data` is the chip's data space from address `start` on.
    pub(crate) fn write(&self, text: &mut String, data: &[u8], start: usize) {
        let held = Held {
            shape: &self.shape,
            bytes: &data[self.place(data, start)],
        };
        write!(text, "{held:?}").unwrap();
    }

    /// Where in `data` it lies.
    pub(crate) fn place(&self, data: &[u8], start: usize) -> Range<usize> {
        let at = self.pointer - start;
        let robot = usize::from(u16::from_le_bytes([data[at], data[at + 1]])) - start;
        robot..robot + self.bytes
    }
}

/// A type of the image, by its name with its parameters.
pub(crate) struct Variable(Shape);

impl Variable {
    /// From the bytes of an ELF file.
    pub(crate) fn of(elf: &[u8], name: &str) -> Variable {
        Variable(Shape::named(elf, name).unwrap().1)
    }

    /// What these bytes hold, as `{:?}` writes it.
    pub(crate) fn text(&self, bytes: &[u8]) -> String {
        let shape = &self.0;
        format!("{:?}", Held { shape, bytes })
    }
}

/// Something of a shape, at the beginning of these bytes.
struct Held<'a> {
    shape: &'a Shape,
    bytes: &'a [u8],
}

impl fmt::Debug for Held<'_> {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let held = |shape, at: usize| Held {
            shape,
            bytes: &self.bytes[at..],
        };
        match self.shape {
            Shape::Number(number) => self.number(*number, to),
            Shape::Names { bytes, names } => {
                let value = unsigned(&self.bytes[..*bytes]);
                let name = names.iter().find(|(number, _)| *number == value);
                to.write_str(name.map_or("(no such name)", |(_, name)| name))
            }
            Shape::Array {
                element,
                bytes,
                count,
            } => {
                let elements = (0..*count).map(|index| held(element, index * bytes));
                to.debug_list().entries(elements).finish()
            }
            Shape::Variants { tag, variants } => {
                let value = tag.map(|(at, bytes)| unsigned(&self.bytes[at..at + bytes]));
                let is_it = |number: &Option<u64>| *number == value;
                let it = variants.iter().find(|(number, _)| is_it(number));
                // A value without a number is the variant without one.
                let it = it.or_else(|| variants.iter().find(|(number, _)| number.is_none()));
                match it {
                    Some((_, shape)) => fmt::Debug::fmt(&held(shape, 0), to),
                    None => to.write_str("(no such variant)"),
                }
            }
            Shape::Fields { name, fields } => {
                let is_tuple = fields.iter().all(|(name, ..)| name.starts_with("__"));
                if fields.is_empty() {
                    to.write_str(name)
                } else if is_tuple {
                    let mut tuple = to.debug_tuple(name);
                    for (_, at, shape) in fields {
                        tuple.field(&held(shape, *at));
                    }
                    tuple.finish()
                } else {
                    let mut all = to.debug_struct(name);
                    for (field, at, shape) in fields {
                        all.field(field, &held(shape, *at));
                    }
                    all.finish()
                }
            }
        }
    }
}

impl Held<'_> {
    fn number(&self, number: Number, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match number {
            Number::Nothing => to.write_str("()"),
            Number::Bool => write!(to, "{}", self.bytes[0] != 0),
            Number::Float => {
                let bytes = self.bytes[..4].try_into().map_err(|_| fmt::Error)?;
                write!(to, "{:?}", f32::from_le_bytes(bytes))
            }
            Number::Unsigned(bytes) => write!(to, "{}", unsigned(&self.bytes[..bytes])),
            Number::Signed(bytes) => {
                let unused = 64 - 8 * bytes as u32;
                let value = unsigned(&self.bytes[..bytes]) << unused;
                write!(to, "{}", value.cast_signed() >> unused)
            }
        }
    }
}

/// A little-endian number.
fn unsigned(bytes: &[u8]) -> u64 {
    let shifted = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
    bytes.iter().rev().fold(0, shifted)
}
