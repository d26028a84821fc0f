//! Functions, those inlined into them, and blocks: what is visible at an instruction.

use super::dies::{Die, Dies};
use super::qualified;
use super::types::{TypeId, Types};
use crate::location::{Code, Place};
use gimli::constants;
use std::collections::HashMap;
use std::ops::Range;

/// What a scope is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ScopeKind {
    /// A function.
    Function,
    /// A function inlined at a line of a file.
    Inlined {
        /// The file, in [`super::Lines::files`].
        file: Option<usize>,
        /// The line of the call.
        line: u32,
    },
    /// Braces in one.
    Block,
}

/// A variable or parameter.
#[derive(Clone, Debug)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) of: Option<TypeId>,
    pub(crate) place: Place,
    pub(crate) unit: usize,
    pub(crate) is_parameter: bool,
    /// Of a file that is found, and not of the core or a library.
    pub(crate) is_own: bool,
}

/// A scope.
#[derive(Clone, Debug)]
pub(crate) struct Scope {
    /// What it is.
    pub(crate) kind: ScopeKind,
    /// With classes and namespaces; of a block empty.
    pub(crate) name: String,
    /// Its first instruction [bytes].
    pub(crate) entry: u32,
    /// Its instructions [bytes].
    pub(crate) ranges: Vec<Range<u32>>,
    pub(crate) variables: Vec<Variable>,
    pub(crate) inner: Vec<Scope>,
    pub(crate) frame_base: Place,
    /// What calls in it pass: the address behind, and registers with their values.
    pub(crate) calls: Vec<(u32, Vec<(u8, Code)>)>,
}

impl Scope {
    /// Whether an instruction is of it.
    pub(crate) fn contains(&self, address: u32) -> bool {
        self.ranges.iter().any(|range| range.contains(&address))
    }

    /// The scopes around an instruction, this one first.
    pub(crate) fn chain(&self, address: u32) -> Vec<&Scope> {
        let mut chain = vec![self];
        let mut at = self;
        while let Some(inner) = at.inner.iter().find(|inner| inner.contains(address)) {
            chain.push(inner);
            at = inner;
        }
        chain
    }

    /// What the call before an address passes in registers.
    pub(crate) fn call(&self, behind: u32) -> Option<&[(u8, Code)]> {
        let own = self.calls.iter().find(|(address, _)| *address == behind);
        own.map(|(_, passed)| &passed[..])
            .or_else(|| self.inner.iter().find_map(|inner| inner.call(behind)))
    }
}

/// All functions, and all global and static variables.
pub(super) fn read(
    dies: &Dies,
    types: &mut Types,
    files: &[HashMap<u64, usize>],
) -> (Vec<Scope>, Vec<Variable>) {
    let mut reader = ScopeReader { dies, types, files };
    let (mut functions, mut globals) = (Vec::new(), Vec::new());
    for (number, die) in dies.all.iter().enumerate() {
        match die.tag() {
            // What the linker left out is at 0.
            constants::DW_TAG_subprogram if die.ranges.iter().any(|range| range.start > 0) => {
                functions.push(reader.scope(number, ScopeKind::Function));
            }
            constants::DW_TAG_variable if is_global(dies, die) => {
                globals.extend(reader.variable(number, true))
            }
            _ => {}
        }
    }
    functions.sort_by_key(|function| function.entry);
    (functions, globals)
}

/// Whether it is outside all functions and somewhere: what the linker left out is at 0.
fn is_global(dies: &Dies, die: &Die) -> bool {
    let outside = [constants::DW_TAG_compile_unit, constants::DW_TAG_namespace];
    let parent = die.parent.map(|parent| dies.all[parent].tag());
    parent.is_some_and(|tag| outside.contains(&tag)) && !die.declaration && !die.place.is_nowhere()
}

struct ScopeReader<'a> {
    dies: &'a Dies,
    types: &'a mut Types,
    files: &'a [HashMap<u64, usize>],
}

impl<'a> ScopeReader<'a> {
    fn scope(&mut self, number: usize, kind: ScopeKind) -> Scope {
        let die = &self.dies.all[number];
        let start = die.ranges.iter().map(|range| range.start).min();
        let entry = die.entry.filter(|entry| *entry > 0).or(start);
        let kept = die.ranges.iter().filter(|range| range.start > 0);
        let mut scope = Scope {
            kind,
            name: match kind {
                ScopeKind::Block => String::new(),
                _ => qualified(self.dies, number),
            },
            entry: entry.unwrap_or(0),
            ranges: kept.cloned().collect(),
            variables: Vec::new(),
            inner: Vec::new(),
            frame_base: die.frame_base.clone(),
            calls: Vec::new(),
        };
        for child in &die.children {
            let inner = &self.dies.all[*child];
            match inner.tag() {
                constants::DW_TAG_formal_parameter | constants::DW_TAG_variable => {
                    scope.variables.extend(self.variable(*child, false));
                }
                constants::DW_TAG_lexical_block if !inner.ranges.is_empty() => {
                    scope.inner.push(self.scope(*child, ScopeKind::Block));
                }
                constants::DW_TAG_inlined_subroutine if !inner.ranges.is_empty() => {
                    let files = &self.files[inner.unit];
                    let kind = ScopeKind::Inlined {
                        file: inner.call_file.and_then(|file| files.get(&file).copied()),
                        line: inner.call_line.unwrap_or(0),
                    };
                    scope.inner.push(self.scope(*child, kind));
                }
                constants::DW_TAG_GNU_call_site | constants::DW_TAG_call_site => {
                    scope.calls.push(self.call(inner))
                }
                _ => {}
            }
        }
        scope
    }

    fn variable(&mut self, number: usize, is_global: bool) -> Option<Variable> {
        let die = &self.dies.all[number];
        // A declaration in a function is of a variable elsewhere; what the compiler made for itself is of no use.
        let artificial = self
            .dies
            .inherited(number, |die| die.artificial.then_some(()));
        let own = self.dies.inherited(number, |die| die.name.as_deref());
        if die.declaration || artificial.is_some() && own != Some("this") {
            return None;
        }
        let of = self.dies.inherited(number, |die| die.of);
        let place = |die: &'a Die| match &die.place {
            Place::None => None,
            place => Some(place.clone()),
        };
        Some(Variable {
            name: match is_global {
                true => qualified(self.dies, number),
                false => own?.to_owned(),
            },
            of: self.types.read(self.dies, of),
            place: self.dies.inherited(number, place).unwrap_or_default(),
            unit: die.unit,
            is_parameter: die.tag() == constants::DW_TAG_formal_parameter,
            is_own: false,
        })
    }

    fn call(&self, die: &Die) -> (u32, Vec<(u8, Code)>) {
        let passed = die.children.iter().filter_map(|child| {
            let parameter = &self.dies.all[*child];
            let Place::Code(Code { bytes, .. }) = &parameter.place else {
                return None;
            };
            // DW_OP_reg0 to DW_OP_reg31.
            let register = bytes
                .first()?
                .checked_sub(0x50)
                .filter(|register| *register < 32)?;
            Some((register, parameter.passed.clone()?))
        });
        (die.entry.unwrap_or(0), passed.collect())
    }
}
