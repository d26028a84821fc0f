//! Types of C and C++, as their declarations have them.

use super::dies::{Die, Dies};
use gimli::{DwAte, constants};
use std::collections::HashMap;

/// A type, as a number in [`Types`].
pub(crate) type TypeId = usize;

/// A type; `None` in place of another one is void.
#[derive(Clone, Debug)]
pub(crate) enum Type {
    Base {
        name: String,
        bytes: usize,
        encoding: DwAte,
    },
    /// With the address size of the chip, whatever the information says of others.
    Pointer {
        to: Option<TypeId>,
        is_reference: bool,
    },
    /// A structure, a class or a union.
    Record {
        name: String,
        bytes: usize,
        members: Vec<Member>,
    },
    Array {
        of: Option<TypeId>,
        count: usize,
    },
    Enumeration {
        name: String,
        bytes: usize,
        values: Vec<(String, i64)>,
    },
    /// A name for another.
    Alias {
        name: String,
        of: Option<TypeId>,
    },
    Qualified {
        word: &'static str,
        of: Option<TypeId>,
    },
    Function {
        returns: Option<TypeId>,
    },
}

/// A member, or a base class.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    /// Empty: it has none, and its own members are members.
    pub(crate) name: String,
    pub(crate) of: Option<TypeId>,
    pub(crate) offset: usize,
    /// Of a bit field: the lowest bit from there, and how many.
    pub(crate) bits: Option<(u64, u64)>,
    pub(crate) is_base: bool,
}

/// All types of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Types {
    all: Vec<Type>,
    /// Those that have been read, by their entries.
    known: HashMap<usize, TypeId>,
}

/// Bytes of a pointer.
pub(crate) const POINTER: usize = 2;

impl Types {
    pub(super) fn read(&mut self, dies: &Dies, number: Option<usize>) -> Option<TypeId> {
        let number = number?;
        if let Some(known) = self.known.get(&number) {
            return Some(*known);
        }
        let id = self.all.len();
        self.known.insert(number, id);
        // What refers to itself on the way finds this.
        self.all.push(Type::Function { returns: None });
        self.all[id] = self.made(dies, number);
        Some(id)
    }

    fn made(&mut self, dies: &Dies, number: usize) -> Type {
        let die = &dies.all[number];
        let name = || die.name.clone().unwrap_or_default();
        let bytes = die.bytes.unwrap_or(0) as usize;
        match die.tag() {
            tag @ (constants::DW_TAG_pointer_type
            | constants::DW_TAG_reference_type
            | constants::DW_TAG_rvalue_reference_type) => Type::Pointer {
                to: self.read(dies, die.of),
                is_reference: tag != constants::DW_TAG_pointer_type,
            },
            constants::DW_TAG_structure_type
            | constants::DW_TAG_class_type
            | constants::DW_TAG_union_type => {
                let members = die.children.iter().map(|child| &dies.all[*child]);
                Type::Record {
                    name: super::qualified(dies, number),
                    bytes,
                    members: members.filter_map(|die| self.member(dies, die)).collect(),
                }
            }
            constants::DW_TAG_array_type => self.array(dies, die),
            constants::DW_TAG_enumeration_type => {
                let values = die.children.iter().map(|child| &dies.all[*child]);
                let values = values.filter_map(|die| Some((die.name.clone()?, die.value?)));
                Type::Enumeration {
                    name: super::qualified(dies, number),
                    bytes,
                    values: values.collect(),
                }
            }
            constants::DW_TAG_typedef => Type::Alias {
                name: name(),
                of: self.read(dies, die.of),
            },
            tag @ (constants::DW_TAG_const_type | constants::DW_TAG_volatile_type) => {
                let is_const = tag == constants::DW_TAG_const_type;
                Type::Qualified {
                    word: if is_const { "const" } else { "volatile" },
                    of: self.read(dies, die.of),
                }
            }
            constants::DW_TAG_subroutine_type => Type::Function {
                returns: self.read(dies, die.of),
            },
            _ => Type::Base {
                name: name(),
                bytes,
                encoding: die.encoding.unwrap_or(constants::DW_ATE_unsigned),
            },
        }
    }

    fn member(&mut self, dies: &Dies, die: &Die) -> Option<Member> {
        let is_base = die.tag() == constants::DW_TAG_inheritance;
        // A static member is a variable of its own.
        if die.declaration || !is_base && die.tag() != constants::DW_TAG_member {
            return None;
        }
        let of = self.read(dies, die.of);
        Some(Member {
            name: match is_base {
                true => self.name(of),
                false => die.name.clone().unwrap_or_default(),
            },
            of,
            offset: die.offset as usize,
            bits: die.bits,
            is_base,
        })
    }

    /// Of several dimensions, arrays of arrays.
    fn array(&mut self, dies: &Dies, die: &Die) -> Type {
        let mut of = self.read(dies, die.of);
        let ranges = die.children.iter().map(|child| &dies.all[*child]);
        let ranges = ranges.filter(|die| die.tag() == constants::DW_TAG_subrange_type);
        let counts: Vec<usize> = ranges.map(|die| die.count.unwrap_or(0) as usize).collect();
        for count in counts.iter().skip(1).rev() {
            self.all.push(Type::Array { of, count: *count });
            of = Some(self.all.len() - 1);
        }
        Type::Array {
            of,
            count: counts.first().copied().unwrap_or(0),
        }
    }

    pub(crate) fn get(&self, id: TypeId) -> &Type {
        &self.all[id]
    }

    /// The type behind its names and qualifiers.
    pub(crate) fn plain(&self, id: Option<TypeId>) -> Option<&Type> {
        let mut of = id;
        loop {
            match self.get(of?) {
                Type::Alias { of: next, .. } | Type::Qualified { of: next, .. } => of = *next,
                plain => return Some(plain),
            }
        }
    }

    /// The value of an enumeration's constant.
    pub(crate) fn enumerator(&self, name: &str) -> Option<i64> {
        self.all.iter().find_map(|of| match of {
            Type::Enumeration { values, .. } => {
                let named = values.iter().find(|(own, _)| own == name)?;
                Some(named.1)
            }
            _ => None,
        })
    }

    /// Its size.
    pub(crate) fn bytes(&self, id: Option<TypeId>) -> usize {
        match self.plain(id) {
            Some(
                Type::Base { bytes, .. }
                | Type::Record { bytes, .. }
                | Type::Enumeration { bytes, .. },
            ) => *bytes,
            Some(Type::Pointer { .. }) => POINTER,
            Some(Type::Array { of, count }) => self.bytes(*of).saturating_mul(*count),
            _ => 0,
        }
    }

    /// As C++ writes it.
    pub(crate) fn name(&self, id: Option<TypeId>) -> String {
        let Some(id) = id else { return "void".into() };
        match self.get(id) {
            Type::Base { name, .. } | Type::Alias { name, .. } => name.clone(),
            Type::Record { name, .. } if name.is_empty() => "struct {...}".into(),
            Type::Enumeration { name, .. } if name.is_empty() => "enum {...}".into(),
            Type::Record { name, .. } | Type::Enumeration { name, .. } => name.clone(),
            Type::Pointer { to, is_reference } => {
                let sign = if *is_reference { '&' } else { '*' };
                match to.map(|to| self.get(to)) {
                    Some(Type::Function { returns }) => {
                        format!("{} ({sign})(...)", self.name(*returns))
                    }
                    _ => format!("{} {sign}", self.name(*to)),
                }
            }
            Type::Array { .. } => {
                let (mut of, mut counts) = (Some(id), String::new());
                while let Some(Type::Array { of: inner, count }) = of.map(|of| self.get(of)) {
                    counts += &format!("[{count}]");
                    of = *inner;
                }
                format!("{} {counts}", self.name(of))
            }
            Type::Qualified { word, of } => match of.map(|of| self.get(of)) {
                Some(Type::Pointer { .. }) => format!("{} {word}", self.name(*of)),
                _ => format!("{word} {}", self.name(*of)),
            },
            Type::Function { returns } => format!("{} (...)", self.name(*returns)),
        }
    }
}
