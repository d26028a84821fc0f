//! Values as GDB writes them: `97 'a'`, `0x800208 <pts+6>`, `{x = 1, y = 2.5}`.

use crate::spot::Spot;
use crate::symbols::{Member, Symbols, Type, TypeId};
use gimli::constants;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::space::DATA;

/// Most elements and characters of an array or a text that are written.
const MOST_ELEMENTS: usize = 200;
/// So many equal elements in a row are counted instead.
const REPEATS: usize = 10;
/// Deepest structure in a structure that is written.
const DEEPEST: usize = 8;
/// What stands for a value that is nowhere.
pub(crate) const OPTIMISED_OUT: &str = "<optimized out>";

/// A typed value somewhere.
#[derive(Clone, Debug)]
pub(crate) struct Value {
    pub(crate) of: Option<TypeId>,
    /// `None`: it was optimised out.
    pub(crate) spot: Option<Spot>,
    /// Of a bit field: its lowest bit, and how many.
    pub(crate) bits: Option<(u64, u64)>,
}

impl Value {
    /// A whole one at this place, no bit field.
    pub(crate) fn new(of: Option<TypeId>, spot: Option<Spot>) -> Value {
        Value {
            of,
            spot,
            bits: None,
        }
    }

    /// One in memory.
    pub(crate) fn at(address: u32, of: Option<TypeId>) -> Value {
        Value::new(of, Some(Spot::Memory(address)))
    }

    /// A part of it, so many bytes from its beginning.
    fn part(&self, of: Option<TypeId>, offset: usize, bytes: usize) -> Value {
        let spot = self.spot.as_ref();
        Value::new(of, spot.map(|spot| spot.part(offset, bytes)))
    }

    /// An element of it as an array of elements of so many bytes.
    pub(crate) fn element(&self, of: Option<TypeId>, index: usize, bytes: usize) -> Value {
        self.part(of, index.saturating_mul(bytes), bytes)
    }
}

/// A number, to calculate with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Number {
    Integer(i64),
    Real(f64),
}

/// A chip and what its program calls things.
#[derive(Clone, Copy)]
pub(crate) struct Memory<'a> {
    pub(crate) chip: &'a Chip,
    pub(crate) symbols: &'a Symbols,
}

impl Memory<'_> {
    fn bytes(&self, value: &Value) -> Option<Vec<u8>> {
        let bytes = self.symbols.types.bytes(value.of);
        value.spot.as_ref()?.read(self.chip, bytes)
    }

    /// The value of a scalar.
    pub(crate) fn number(&self, value: &Value) -> Option<Number> {
        let bytes = self.bytes(value)?;
        let raw = wide(&bytes);
        let (raw, bits) = match value.bits {
            Some((low, count)) => (raw >> low & !(u64::MAX << count), count as usize),
            None => (raw, 8 * bytes.len()),
        };
        let signed = || match bits {
            0 => 0,
            _ => (raw << (64 - bits)) as i64 >> (64 - bits),
        };
        let is_signed = match self.symbols.types.plain(value.of)? {
            Type::Base {
                encoding, bytes, ..
            } => match (*encoding, bytes) {
                (constants::DW_ATE_float, 4) => {
                    return Some(Number::Real(f32::from_bits(raw as u32).into()));
                }
                (constants::DW_ATE_float, 8) => return Some(Number::Real(f64::from_bits(raw))),
                (of, _) => [constants::DW_ATE_signed, constants::DW_ATE_signed_char].contains(&of),
            },
            Type::Enumeration { values, .. } => values.iter().any(|(_, value)| *value < 0),
            Type::Pointer { .. } => false,
            _ => return None,
        };
        Some(Number::Integer(match is_signed {
            true => signed(),
            false => raw as i64,
        }))
    }

    /// Where a pointer points; into the flash if it is one to a function.
    pub(crate) fn target(&self, value: &Value) -> Option<(u32, Option<TypeId>)> {
        let Some(Type::Pointer { to, .. }) = self.symbols.types.plain(value.of) else {
            return None;
        };
        let Number::Integer(pointer) = self.number(value)? else {
            return None;
        };
        let pointer = pointer as u32 & 0xFFFF;
        match self.symbols.types.plain(*to) {
            Some(Type::Function { .. }) => Some((2 * pointer, *to)),
            _ => Some((DATA | pointer, *to)),
        }
    }

    /// What a reference refers to; any other value as it is.
    pub(crate) fn referred(&self, value: Value) -> Value {
        match self.symbols.types.plain(value.of) {
            Some(Type::Pointer {
                is_reference: true, ..
            }) => match self.target(&value) {
                Some((address, of)) => Value::at(address, of),
                None => value,
            },
            _ => value,
        }
    }

    /// Its parts: members, elements, what it points to.
    pub(crate) fn parts(&self, value: &Value) -> Vec<(String, Value)> {
        let types = &self.symbols.types;
        match types.plain(value.of) {
            Some(Type::Record { members, .. }) => {
                let part = |member: &Member| {
                    let bytes = types.bytes(member.of);
                    let mut part = value.part(member.of, member.offset, bytes);
                    part.bits = member.bits;
                    (member.name.clone(), part)
                };
                members.iter().map(part).collect()
            }
            Some(Type::Array { of, count }) => {
                let bytes = types.bytes(*of);
                let element = |index| (format!("[{index}]"), value.element(*of, index, bytes));
                (0..*count).map(element).collect()
            }
            Some(Type::Pointer { .. }) => match self.target(value) {
                Some((address, of)) if types.bytes(of) > 0 => {
                    vec![("*".into(), Value::at(address, of))]
                }
                _ => Vec::new(),
            },
            _ => Vec::new(),
        }
    }

    /// Whether it has any.
    pub(crate) fn has_parts(&self, value: &Value) -> bool {
        match self.symbols.types.plain(value.of) {
            Some(Type::Record { members, .. }) => !members.is_empty(),
            Some(Type::Array { count, .. }) => *count > 0,
            Some(Type::Pointer { to, .. }) => {
                let is_null = self
                    .number(value)
                    .is_none_or(|number| number == Number::Integer(0));
                !is_null && self.symbols.types.bytes(*to) > 0
            }
            _ => false,
        }
    }

    /// Its text.
    pub(crate) fn text(&self, value: &Value) -> String {
        self.text_within(value, 0)
    }

    fn text_within(&self, value: &Value, depth: usize) -> String {
        let types = &self.symbols.types;
        if value.spot.is_none() {
            return OPTIMISED_OUT.into();
        }
        match types.plain(value.of) {
            _ if depth > DEEPEST => "{...}".into(),
            Some(Type::Record { members, .. }) => {
                let parts = self.parts(value).into_iter().zip(members);
                let texts = parts.map(|((name, part), member)| {
                    let text = self.text_within(&part, depth + 1);
                    match (member.is_base, name.is_empty()) {
                        (true, _) => format!("<{name}> = {text}"),
                        (false, true) => text,
                        (false, false) => format!("{name} = {text}"),
                    }
                });
                format!("{{{}}}", texts.collect::<Vec<_>>().join(", "))
            }
            Some(Type::Array { of, count }) => self.array_text(value, *of, *count, depth),
            _ => self
                .scalar_text(value)
                .unwrap_or_else(|| OPTIMISED_OUT.into()),
        }
    }

    fn array_text(&self, value: &Value, of: Option<TypeId>, count: usize, depth: usize) -> String {
        if self.is_character(of)
            && let Some(bytes) = self.bytes(value)
        {
            return quoted(&bytes);
        }
        let bytes = self.symbols.types.bytes(of);
        let element = |index| self.text_within(&value.element(of, index, bytes), depth + 1);
        let (mut texts, mut index) = (Vec::new(), 0);
        while index < count && texts.len() < MOST_ELEMENTS {
            let text = element(index);
            let mut equal = 1;
            while index + equal < count && element(index + equal) == text {
                equal += 1;
            }
            match equal {
                REPEATS.. => texts.push(format!("{text} <repeats {equal} times>")),
                _ => texts.extend(std::iter::repeat_n(text, equal)),
            }
            index += equal;
        }
        let more = if index < count { "..." } else { "" };
        format!("{{{}{more}}}", texts.join(", "))
    }

    fn is_character(&self, of: Option<TypeId>) -> bool {
        let character = [
            constants::DW_ATE_signed_char,
            constants::DW_ATE_unsigned_char,
        ];
        matches!(self.symbols.types.plain(of), Some(Type::Base { encoding, bytes: 1, .. }) if character.contains(encoding))
    }

    fn scalar_text(&self, value: &Value) -> Option<String> {
        let types = &self.symbols.types;
        match types.plain(value.of)? {
            Type::Pointer { to, is_reference } => {
                let (address, _) = self.target(value)?;
                Some(match is_reference {
                    true => {
                        let target = self.text_within(&Value::at(address, *to), 1);
                        format!("@0x{address:x}: {target}")
                    }
                    false => self.pointer_text(address, *to),
                })
            }
            Type::Enumeration { values, .. } => {
                let Number::Integer(number) = self.number(value)? else {
                    return None;
                };
                let named = values.iter().find(|(_, value)| *value == number);
                Some(named.map_or_else(|| number.to_string(), |(name, _)| name.clone()))
            }
            Type::Base {
                encoding, bytes, ..
            } => Some(match self.number(value)? {
                Number::Real(real) => real_text(real, if *bytes == 8 { 17 } else { 9 }),
                Number::Integer(number) if *encoding == constants::DW_ATE_boolean => match number {
                    0 => "false".into(),
                    1 => "true".into(),
                    other => other.to_string(),
                },
                Number::Integer(number) if self.is_character(value.of) && value.bits.is_none() => {
                    format!("{number} '{}'", escaped(number as u8, b'\''))
                }
                Number::Integer(number) => number.to_string(),
            }),
            _ => None,
        }
    }

    fn pointer_text(&self, address: u32, to: Option<TypeId>) -> String {
        // Null is 0 in any space.
        let mut text = match address & 0xFFFF {
            0 => "0x0".into(),
            _ => format!("0x{address:x}"),
        };
        match self.symbols.named(address) {
            Some((name, 0)) => text += &format!(" <{name}>"),
            Some((name, offset)) => text += &format!(" <{name}+{offset}>"),
            None => {}
        }
        if self.is_character(to) && address & 0xFFFF != 0 {
            let bytes = (address..)
                .map_while(|address| self.chip.read_space(address))
                .take(MOST_ELEMENTS + 1);
            text += &format!(" {}", quoted(&bytes.collect::<Vec<_>>()));
        }
        text
    }
}

/// Little-endian bytes as a number; the first eight.
pub(crate) fn wide(bytes: &[u8]) -> u64 {
    let bytes = bytes.iter().take(8).rev();
    bytes.fold(0, |number, byte| number << 8 | u64::from(*byte))
}

/// A text up to its end.
fn quoted(bytes: &[u8]) -> String {
    let mut texts = bytes.split(|byte| *byte == 0);
    let whole = texts.next().unwrap_or_default();
    let shown = whole.iter().take(MOST_ELEMENTS);
    let text: String = shown.map(|byte| escaped(*byte, b'"')).collect();
    let more = if whole.len() > MOST_ELEMENTS {
        "..."
    } else {
        ""
    };
    format!("\"{text}\"{more}")
}

/// A character as C writes it between these quotes.
fn escaped(byte: u8, quote: u8) -> String {
    match byte {
        b'\n' => "\\n".into(),
        b'\r' => "\\r".into(),
        b'\t' => "\\t".into(),
        0x07 => "\\a".into(),
        0x08 => "\\b".into(),
        0x0B => "\\v".into(),
        0x0C => "\\f".into(),
        0x1B => "\\033".into(),
        b'\\' => "\\\\".into(),
        _ if byte == quote => format!("\\{}", char::from(byte)),
        0x20..0x7F => char::from(byte).to_string(),
        _ => format!("\\{byte:03o}"),
    }
}

/// A real number with so many digits at most, as `%g` writes it.
pub(crate) fn real_text(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        let sign = if value.is_sign_negative() { "-" } else { "" };
        return format!("{sign}{}", if value.is_nan() { "nan" } else { "inf" });
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if (-4..digits as i32).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent) as usize;
        return trimmed(&format!("{value:.decimals$}"));
    }
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{}e{sign}{:02}", trimmed(mantissa), exponent.abs())
}
