//! What the source calls things: lines, functions with their scopes, variables and types, of an ELF file.
//!
//! All of it is read once, into tables of their own ([`dies`] is only the way there): the file may be forgotten.

mod dies;
mod lines;
mod scopes;
mod types;

pub(crate) use lines::{LineRow, Lines, SourceFile};
pub(crate) use scopes::Variable;
pub(crate) use scopes::{Scope, ScopeKind};
pub(crate) use types::{Member, Type, TypeId, Types};

use crate::location::{Bytes, Place};
use crate::unwind::Unwinder;
use dies::Dies;
use gimli::{EndianSlice, LittleEndian, SectionId, constants};
use object::{Object, ObjectSection};
use rumbo_emulator::image::Image;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why an image cannot be debugged.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SymbolError {
    /// It is no ELF file, or a broken one.
    #[error("it is no ELF file ({0}); give the .elf that the linker made")]
    Elf(String),
    /// It has no lines.
    #[error(
        "it has no debugging information; compile and link it with -gdwarf-4 -Og (plain -g of gcc-avr 5.4 writes \
         an older kind), or give the folder of the sketch"
    )]
    NoDebugInformation,
    /// They cannot be read.
    #[error("its debugging information cannot be read: {0}")]
    Dwarf(String),
}

/// The symbols of a program.
#[derive(Debug)]
pub struct Symbols {
    /// Lines.
    pub(crate) lines: Lines,
    /// Functions by their first address.
    pub(crate) functions: Vec<Scope>,
    pub(crate) globals: Vec<Variable>,
    /// The chip's registers, as avr-libc names them.
    pub(crate) registers: Vec<Variable>,
    pub(crate) types: Types,
    pub(crate) unwinder: Unwinder,
    pub(crate) image: Image,
}

impl Symbols {
    /// Reads an ELF file; `find` gives the path of a file that the compiler named.
    ///
    /// # Errors
    /// It is none, or has no debugging information.
    pub fn read(
        elf: &[u8],
        find: &dyn Fn(&str) -> Option<PathBuf>,
    ) -> Result<Symbols, SymbolError> {
        let file = object::File::parse(elf).map_err(|error| SymbolError::Elf(error.to_string()))?;
        let section = |name: &str| {
            let section = file.section_by_name(name);
            let data = section.and_then(|section| section.data().ok());
            data.unwrap_or_default()
        };
        let image = Image::parse(elf).map_err(|error| SymbolError::Elf(error.to_string()))?;
        let symbols = Symbols::of_sections(&section, image, find);
        let symbols = symbols.map_err(|error| SymbolError::Dwarf(error.to_string()))?;
        match symbols.functions.is_empty() {
            true => Err(SymbolError::NoDebugInformation),
            false => Ok(symbols),
        }
    }

    fn of_sections<'a>(
        section: &impl Fn(&str) -> &'a [u8],
        image: Image,
        find: &dyn Fn(&str) -> Option<PathBuf>,
    ) -> gimli::Result<Symbols> {
        let load = |id: SectionId| -> gimli::Result<Bytes<'a>> {
            Ok(EndianSlice::new(section(id.name()), LittleEndian))
        };
        let dwarf = gimli::Dwarf::load(load)?;
        let (mut units, mut headers) = (Vec::new(), dwarf.units());
        while let Some(header) = headers.next()? {
            units.push(dwarf.unit(header)?);
        }
        let (lines, files) = Lines::read(&dwarf, &units, find)?;
        let dies = Dies::read(&dwarf, &units)?;
        let mut types = Types::default();
        let (functions, mut globals) = scopes::read(&dies, &mut types, &files);
        for global in &mut globals {
            let mut of_unit = files[global.unit].values();
            global.is_own = of_unit.any(|file| lines.files[*file].path.is_some());
        }
        // Those of the chip are in a unit of avr-libc's own, without a file.
        let of_chip = |variable: &Variable| units[variable.unit].name.is_none();
        let (mut registers, globals): (Vec<_>, _) = globals.into_iter().partition(of_chip);
        registers.retain(|register| !register.name.starts_with("__"));
        let unwinder = Unwinder::read(section(SectionId::DebugFrame.name()), image.flash())?;
        Ok(Symbols {
            lines,
            functions,
            globals,
            registers,
            types,
            unwinder,
            image,
        })
    }

    /// The function at an address.
    pub(crate) fn function(&self, address: u32) -> Option<&Scope> {
        let mut functions = self.functions.iter();
        functions.find(|function| function.contains(address))
    }

    /// The functions of this name, with or without its classes and namespaces.
    pub(crate) fn functions_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Scope> {
        let name = name.trim_end_matches("()");
        self.functions.iter().filter(move |function| {
            let outer = function.name.strip_suffix(name);
            outer.is_some_and(|outer| outer.is_empty() || outer.ends_with("::"))
        })
    }

    /// Where a program begins for who wrote it: `setup`, or else `main`.
    pub(crate) fn entry(&self) -> Option<&Scope> {
        let mut entries = ["setup", "main"].into_iter();
        entries.find_map(|name| self.functions_named(name).next())
    }

    /// The files beside and below that of a sketch's `setup`: not those of the core and of libraries. None of an image
    /// without it, whose parts may lie anywhere.
    pub(crate) fn files_of_program(&self) -> BTreeSet<usize> {
        let setup = self.functions_named("setup").next();
        let row = setup.and_then(|setup| self.lines.row(self.body(setup)));
        let Some(folder) = row.and_then(|row| Path::new(&self.lines.files[row.file].name).parent())
        else {
            return BTreeSet::new();
        };
        let is_below =
            |name: &Path| name.starts_with(folder) && name.is_absolute() == folder.is_absolute();
        let files = self.lines.files.iter().enumerate();
        let own = files.filter(|(_, file)| is_below(Path::new(&file.name)));
        own.map(|(number, _)| number).collect()
    }

    /// The globals to list: each name once, and not the constants of headers, which every file has.
    pub(crate) fn listed(&self) -> impl Iterator<Item = &Variable> {
        let has = |globals: &[Variable], name: &str| globals.iter().any(|one| one.name == name);
        let numbered = self.globals.iter().enumerate();
        let listed = numbered.filter(move |(index, variable)| {
            let is_constant = matches!(variable.place, Place::Constant(_));
            let (before, after) = (&self.globals[..*index], &self.globals[index + 1..]);
            let is_of_all = is_constant && has(after, &variable.name);
            !has(before, &variable.name) && !is_of_all
        });
        listed.map(|(_, variable)| variable)
    }

    /// Where the lines of a function begin.
    pub(crate) fn begins(&self, function: &Scope) -> impl Iterator<Item = LineRow> {
        let ranges = function.ranges.iter();
        ranges.flat_map(|range| self.lines.begins(range.clone()))
    }

    /// Where the body of a function begins: at its second line, behind what saves registers, or the first behind what is inlined
    /// there.
    pub(crate) fn body(&self, function: &Scope) -> u32 {
        let end = function.ranges.first().map(|range| range.end);
        let range = function.entry..end.unwrap_or(function.entry);
        let is_inlined = |scope: &&Scope| matches!(scope.kind, ScopeKind::Inlined { .. });
        // Where a function begins, the one before ends.
        let rows = self.lines.within(range).iter().filter(|row| row.line != 0);
        let mut later = rows.skip(1).map(|row| row.address);
        let found = later.find(|address| !function.chain(*address).iter().any(is_inlined));
        found.unwrap_or(function.entry)
    }

    /// The addresses for a breakpoint at a line or the next with code, and which line that is: in each scope the first, and
    /// where that is the beginning of a function, that of its body.
    pub(crate) fn stops_of_line(&self, file: usize, line: u32) -> (Vec<u32>, Option<u32>) {
        let rows = self.lines.of_line(file, line);
        let (mut seen, mut stops) = (Vec::new(), Vec::new());
        for LineRow { address, .. } in rows.iter().copied() {
            let function = self.function(address);
            let scope = function.and_then(|function| function.chain(address).pop());
            let scope = scope.map(std::ptr::from_ref);
            if !seen.contains(&scope) {
                seen.push(scope);
                stops.push(match function {
                    Some(function) if function.entry == address => self.body(function),
                    _ => address,
                });
            }
        }
        (stops, rows.first().map(|row| row.line))
    }
}

/// A name with those of its classes and namespaces.
fn qualified(dies: &Dies, number: usize) -> String {
    let mut declared = number;
    while let Some(origin) = dies.all[declared].origin {
        declared = origin;
    }
    let mut name = dies.all[declared].name.clone().unwrap_or_default();
    let mut parent = dies.all[declared].parent;
    while let Some(number) = parent {
        let die = &dies.all[number];
        match (die.tag(), &die.name) {
            (constants::DW_TAG_namespace, None) => name = format!("(anonymous namespace)::{name}"),
            (
                constants::DW_TAG_namespace
                | constants::DW_TAG_structure_type
                | constants::DW_TAG_class_type
                | constants::DW_TAG_union_type,
                Some(outer),
            ) => name = format!("{outer}::{name}"),
            _ => {}
        }
        parent = die.parent;
    }
    name
}
