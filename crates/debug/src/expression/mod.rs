//! Expressions of a person at a stop: names, members, elements, `*p`, `&x`, `$r24`, arithmetic, comparisons; and
//! assignments. Nothing is called, and nothing happens before an expression has been understood.

mod calculate;
mod tokens;

use crate::spot::{Piece, Spot};
use crate::symbols::{Type, TypeId};
use crate::value::{Memory, Number, Value, real_text};
use calculate::{calculate, real, whole};
use gimli::constants;
use std::iter::Peekable;
use std::vec::IntoIter;
use tokens::{Token, tokens};

/// What an expression gives.
#[derive(Clone, Debug)]
pub(crate) enum Item {
    /// Something in the program, which may be assigned to.
    Value(Value),
    /// Something calculated.
    Number(Number),
    /// The address of something.
    Pointer(u32, Option<TypeId>),
}

/// What names mean where the program stands.
pub(crate) trait Names {
    /// The memory.
    fn memory(&self) -> Memory<'_>;
    /// What is called so.
    fn find(&self, name: &str) -> Option<Item>;
    /// Everything that has a name here, the nearest first.
    fn all(&self) -> Vec<String>;
}

/// Deepest nesting.
const DEEPEST: u32 = 50;
/// Most names of a message.
const SHOWN: usize = 20;
/// Operators of two sides by how tightly they bind, loosest first.
const LEVELS: [&[&str]; 10] = [
    &["||"],
    &["&&"],
    &["|"],
    &["^"],
    &["&"],
    &["==", "!="],
    &["<=", ">=", "<", ">"],
    &["<<", ">>"],
    &["+", "-"],
    &["*", "/", "%"],
];

/// Works out an expression; `Err` says what is wrong with it.
pub(crate) fn evaluate(text: &str, names: &dyn Names) -> Result<Item, String> {
    let mut parser = Parser {
        tokens: tokens(text)?.into_iter().peekable(),
        names,
        depth: 0,
    };
    let item = parser.level(0)?;
    match parser.tokens.next() {
        None => Ok(item),
        Some(token) => Err(format!(
            "`{text}`: `{}` is not understood there",
            token.text()
        )),
    }
}

/// An assignment in a text: its two sides.
pub(crate) fn assignment(text: &str) -> Option<(&str, &str)> {
    let at = text.char_indices().find(|(at, letter)| {
        let before = text[..*at].chars().next_back();
        *letter == '='
            && !text[at + 1..].starts_with('=')
            && !matches!(before, Some('=' | '!' | '<' | '>'))
    });
    at.map(|(at, _)| (text[..at].trim(), text[at + 1..].trim()))
}

/// Whether a condition holds.
pub(crate) fn is_true(item: &Item, memory: Memory<'_>) -> Result<bool, String> {
    Ok(real(number(item, memory)?) != 0.0)
}

/// The bytes of a value as one of a type.
pub(crate) fn encoded(
    item: &Item,
    of: Option<TypeId>,
    memory: Memory<'_>,
) -> Result<Vec<u8>, String> {
    let types = &memory.symbols.types;
    let bytes = types.bytes(of);
    if let (Item::Value(value), Some(Type::Record { .. } | Type::Array { .. })) =
        (item, types.plain(of))
    {
        let is_same = types.name(value.of) == types.name(of);
        let spot = value.spot.as_ref().filter(|_| is_same);
        let read = spot.and_then(|spot| spot.read(memory.chip, bytes));
        return read.ok_or_else(|| format!("only another {} can be put there", types.name(of)));
    }
    let number = number(item, memory)?;
    match types.plain(of) {
        Some(Type::Base {
            encoding: constants::DW_ATE_float,
            ..
        }) => Ok(match (bytes, real(number)) {
            (4, real) => (real as f32).to_le_bytes().into(),
            (_, real) => real.to_le_bytes().into(),
        }),
        Some(Type::Base {
            encoding: constants::DW_ATE_boolean,
            ..
        }) => Ok(vec![u8::from(real(number) != 0.0)]),
        Some(Type::Base { .. } | Type::Enumeration { .. } | Type::Pointer { .. }) => {
            Ok(whole(number).to_le_bytes()[..bytes.min(8)].into())
        }
        _ => Err(format!("a {} cannot be set", types.name(of))),
    }
}

fn number(item: &Item, memory: Memory<'_>) -> Result<Number, String> {
    match item {
        Item::Number(number) => Ok(*number),
        Item::Pointer(address, _) => Ok(Number::Integer((address & 0xFFFF).into())),
        Item::Value(value) => {
            let value = memory.referred(value.clone());
            memory.number(&value).ok_or_else(|| match value.spot {
                None => "it was optimised out".into(),
                Some(_) => format!("a {} is no number", memory.symbols.types.name(value.of)),
            })
        }
    }
}

impl Item {
    /// As a whole number.
    pub(crate) fn integer(&self, memory: Memory<'_>) -> Result<i64, String> {
        number(self, memory).map(whole)
    }

    /// Its text, type, and the value in the program behind it.
    pub(crate) fn shown(&self, memory: Memory<'_>) -> (String, String, Option<Value>) {
        let types = &memory.symbols.types;
        match self {
            Item::Value(value) => {
                let text = memory.text(value);
                (text, types.name(value.of), Some(value.clone()))
            }
            Item::Number(Number::Integer(value)) => (value.to_string(), "int".into(), None),
            Item::Number(Number::Real(value)) => (real_text(*value, 9), "double".into(), None),
            Item::Pointer(address, to) => {
                let (text, of) = (format!("0x{address:x}"), format!("{} *", types.name(*to)));
                (text, of, Some(Value::at(*address, *to)))
            }
        }
    }
}

struct Parser<'a> {
    tokens: Peekable<IntoIter<Token>>,
    names: &'a dyn Names,
    depth: u32,
}

impl Parser<'_> {
    fn sign(&mut self, signs: &[&'static str]) -> Option<&'static str> {
        let found = signs
            .iter()
            .find(|sign| self.tokens.peek() == Some(&Token::Sign(sign)))
            .copied()?;
        self.tokens.next();
        Some(found)
    }

    fn level(&mut self, level: usize) -> Result<Item, String> {
        let Some(signs) = LEVELS.get(level) else {
            return self.prefixed();
        };
        let mut left = self.level(level + 1)?;
        while let Some(sign) = self.sign(signs) {
            let right = self.level(level + 1)?;
            left = self.calculated(&left, sign, &right)?;
        }
        Ok(left)
    }

    fn prefixed(&mut self) -> Result<Item, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("the expression is nested too deeply".into());
        }
        let memory = self.names.memory();
        let item = match self.sign(&["-", "+", "!", "~", "*", "&"]) {
            None => self.postfixed(),
            Some("*") => {
                let pointer = self.prefixed()?;
                self.at(&pointer, 0)
            }
            Some("&") => match self.prefixed()? {
                Item::Value(value) => match value.spot {
                    Some(Spot::Memory(address)) => Ok(Item::Pointer(address, value.of)),
                    _ => Err("it is in a register, and has no address".into()),
                },
                _ => Err("only something of the program has an address".into()),
            },
            Some(sign) => {
                let inner = self.prefixed()?;
                Ok(Item::Number(match (sign, number(&inner, memory)?) {
                    ("-", Number::Integer(value)) => Number::Integer(value.wrapping_neg()),
                    ("-", Number::Real(value)) => Number::Real(-value),
                    ("!", value) => Number::Integer((real(value) == 0.0).into()),
                    ("~", Number::Integer(value)) => Number::Integer(!value),
                    (_, value) => value,
                }))
            }
        };
        self.depth -= 1;
        item
    }

    fn postfixed(&mut self) -> Result<Item, String> {
        let mut item = match self.tokens.next() {
            Some(Token::Number(number)) => Item::Number(number),
            Some(Token::Name(name)) => self.names.find(&name).ok_or_else(|| self.unknown(&name))?,
            Some(Token::Sign("(")) => {
                let inner = self.level(0)?;
                self.sign(&[")"]).ok_or("a `)` is missing")?;
                inner
            }
            Some(token) => return Err(format!("`{}` is not understood there", token.text())),
            None => return Err("the expression ends too early".into()),
        };
        while let Some(sign) = self.sign(&["[", ".", "->"]) {
            item = match sign {
                "[" => {
                    let Number::Integer(index) = number(&self.level(0)?, self.names.memory())?
                    else {
                        return Err("an index is a whole number".into());
                    };
                    self.sign(&["]"]).ok_or("a `]` is missing")?;
                    self.at(&item, index)?
                }
                _ => {
                    let Some(Token::Name(name)) = self.tokens.next() else {
                        return Err(format!("behind `{sign}` comes the name of a member"));
                    };
                    let whole = match sign {
                        "->" => self.at(&item, 0)?,
                        _ => item,
                    };
                    self.member(&whole, &name)?
                }
            };
        }
        Ok(item)
    }

    fn unknown(&self, name: &str) -> String {
        let mut all = self.names.all();
        let more = if all.len() > SHOWN { ", ..." } else { "" };
        all.truncate(SHOWN);
        format!(
            "nothing is called `{name}` here; in scope: {}{more}",
            all.join(", ")
        )
    }

    /// An element of an array, or what lies behind a pointer.
    fn at(&self, item: &Item, index: i64) -> Result<Item, String> {
        let memory = self.names.memory();
        let types = &memory.symbols.types;
        let (address, of) = match item {
            Item::Pointer(address, of) => (*address, *of),
            Item::Value(value) => {
                let value = memory.referred(value.clone());
                match types.plain(value.of) {
                    Some(Type::Array { of, .. }) => {
                        let bytes = types.bytes(*of);
                        let index =
                            usize::try_from(index).map_err(|_| "an index is not negative")?;
                        return Ok(Item::Value(value.element(*of, index, bytes)));
                    }
                    Some(Type::Pointer { .. }) => memory
                        .target(&value)
                        .ok_or("the pointer was optimised out")?,
                    _ => return Err(format!("a {} is no pointer or array", types.name(value.of))),
                }
            }
            Item::Number(_) => return Err("a number is no pointer".into()),
        };
        let offset = index.wrapping_mul(types.bytes(of) as i64);
        let address = address.wrapping_add(offset as u32);
        Ok(Item::Value(Value::at(address, of)))
    }

    fn member(&self, item: &Item, name: &str) -> Result<Item, String> {
        let memory = self.names.memory();
        let Item::Value(value) = item else {
            return Err(format!("a number has no member `{name}`"));
        };
        let value = memory.referred(value.clone());
        if let Some(found) = member(memory, &value, name) {
            return Ok(Item::Value(found));
        }
        let of = memory.symbols.types.name(value.of);
        Err(match memory.symbols.types.plain(value.of) {
            Some(Type::Record { members, .. }) => {
                let names: Vec<_> = members.iter().map(|member| &*member.name).collect();
                format!("{of} has no member `{name}`; it has {}", names.join(", "))
            }
            _ => format!("a {of} has no members; `->` follows a pointer to a structure"),
        })
    }

    fn calculated(&self, left: &Item, sign: &str, right: &Item) -> Result<Item, String> {
        let memory = self.names.memory();
        // A pointer moves by elements.
        if let ("+" | "-", Some((address, of))) = (sign, pointer(left, memory))
            && let Number::Integer(count) = number(right, memory)?
        {
            let bytes = count.wrapping_mul(memory.symbols.types.bytes(of).max(1) as i64) as u32;
            let address = match sign {
                "-" => address.wrapping_sub(bytes),
                _ => address.wrapping_add(bytes),
            };
            return Ok(Item::Pointer(address, of));
        }
        let (left, right) = (number(left, memory)?, number(right, memory)?);
        calculate(left, sign, right).map(Item::Number)
    }
}

/// A member, also of a base class or of a member without a name.
pub(crate) fn member(memory: Memory<'_>, value: &Value, name: &str) -> Option<Value> {
    let Some(Type::Record { members, .. }) = memory.symbols.types.plain(value.of) else {
        return None;
    };
    let parts = memory.parts(value);
    let parts = || parts.iter().map(|(_, part)| part).zip(members);
    let own = parts().find(|(_, member)| member.name == name && !member.is_base);
    own.map(|(part, _)| part.clone()).or_else(|| {
        let mut inner = parts().filter(|(_, member)| member.is_base || member.name.is_empty());
        inner.find_map(|(part, _)| member(memory, part, name))
    })
}

fn pointer(item: &Item, memory: Memory<'_>) -> Option<(u32, Option<TypeId>)> {
    match item {
        Item::Pointer(address, of) => Some((*address, *of)),
        Item::Value(value) => memory.target(&memory.referred(value.clone())),
        Item::Number(_) => None,
    }
}

/// A register of the CPU, by the name that GDB has for it.
pub(crate) fn register(
    name: &str,
    memory: Memory<'_>,
    registers: impl Fn(usize) -> Piece,
) -> Option<Item> {
    let name = name.strip_prefix('$')?;
    let number = name
        .strip_prefix('r')
        .and_then(|number| number.parse::<usize>().ok());
    let cpu = memory.chip.cpu();
    let value: i64 = match (name, number) {
        (_, Some(number @ 0..32)) => registers(number).read(memory.chip)?.into(),
        ("x" | "y" | "z", _) => {
            let low = 26 + 2 * usize::from(name.as_bytes()[0] - b'x');
            let byte = |number| registers(number).read(memory.chip);
            u16::from_le_bytes([byte(low)?, byte(low + 1)?]).into()
        }
        ("sp" | "SP", _) => cpu.stack_pointer().into(),
        ("pc" | "PC", _) => (2 * cpu.program_counter()).into(),
        ("sreg" | "SREG", _) => cpu.status().bits().into(),
        ("cycle", _) => memory.chip.cycle() as i64,
        _ => return None,
    };
    Some(Item::Number(Number::Integer(value)))
}
