//! The debugging information of an ELF file as a flat list of entries (DIEs), with what a debugger uses of each.
//!
//! Source: DWARF 4, sections 2 to 5 and 7; avr-gcc writes versions 2 to 4, and GNU's call sites before they had numbers.

use crate::location::{Bytes, Code, Place};
use gimli::{Attribute, AttributeValue, DwAt, DwTag, Unit, UnitOffset, constants};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

pub(super) type Dwarf<'a> = gimli::Dwarf<Bytes<'a>>;

/// An entry. References are indices of the list.
#[derive(Debug, Default)]
pub(super) struct Die {
    tag: u16,
    pub unit: usize,
    pub parent: Option<usize>,
    pub children: Vec<usize>,
    pub name: Option<String>,
    pub of: Option<usize>,
    /// What it completes: an abstract function, a declaration.
    pub origin: Option<usize>,
    pub bytes: Option<u64>,
    pub encoding: Option<gimli::DwAte>,
    /// Of a member: from the start of its structure [bytes].
    pub offset: u64,
    /// Of a member that is a bit field: bits from its lowest byte's lowest bit, and how many.
    pub bits: Option<(u64, u64)>,
    /// Elements of an array's dimension.
    pub count: Option<u64>,
    pub value: Option<i64>,
    pub place: Place,
    pub frame_base: Place,
    /// Of a parameter of a call: its value, in the frame of the caller.
    pub passed: Option<Code>,
    pub ranges: Vec<Range<u32>>,
    pub entry: Option<u32>,
    pub call_line: Option<u32>,
    pub call_file: Option<u64>,
    pub declaration: bool,
    pub artificial: bool,
}

impl Die {
    pub(super) fn tag(&self) -> DwTag {
        DwTag(self.tag)
    }
}

/// All entries, and the number of each by its offset in the file.
#[derive(Debug, Default)]
pub(super) struct Dies {
    pub all: Vec<Die>,
    numbers: HashMap<usize, usize>,
}

impl Dies {
    /// Reads all units.
    pub(super) fn read(dwarf: &Dwarf<'_>, units: &[Unit<Bytes<'_>>]) -> gimli::Result<Dies> {
        let mut dies = Dies::default();
        let mut references = Vec::new();
        for (number, unit) in units.iter().enumerate() {
            let mut reader = UnitReader {
                dwarf,
                unit,
                number,
                references: &mut references,
            };
            let mut tree = unit.entries_tree(None)?;
            dies.add(&mut reader, tree.root()?, None)?;
        }
        for (from, what, to) in references {
            let to = dies.numbers.get(&to).copied();
            match what {
                constants::DW_AT_type => dies.all[from].of = to,
                _ => dies.all[from].origin = to,
            }
        }
        Ok(dies)
    }

    fn add<'i>(
        &mut self,
        reader: &mut UnitReader<'_, 'i>,
        node: gimli::EntriesTreeNode<'_, '_, '_, Bytes<'i>>,
        parent: Option<usize>,
    ) -> gimli::Result<usize> {
        let number = self.all.len();
        self.numbers
            .insert(reader.offset(node.entry().offset()), number);
        let die = reader.die(number, node.entry())?;
        self.all.push(Die { parent, ..die });
        let mut children = node.children();
        while let Some(child) = children.next()? {
            let child = self.add(reader, child, Some(number))?;
            self.all[number].children.push(child);
        }
        Ok(number)
    }

    /// What an entry or the one that it completes says.
    pub(super) fn inherited<'a, T>(
        &'a self,
        mut number: usize,
        what: impl Fn(&'a Die) -> Option<T>,
    ) -> Option<T> {
        // A chain is short: concrete, abstract, declared.
        for _ in 0..4 {
            let die = &self.all[number];
            if let Some(found) = what(die) {
                return Some(found);
            }
            number = die.origin?;
        }
        None
    }
}

struct UnitReader<'a, 'i> {
    dwarf: &'a Dwarf<'i>,
    unit: &'a Unit<Bytes<'i>>,
    number: usize,
    /// From an entry, by which attribute, to the entry at an offset.
    references: &'a mut Vec<(usize, DwAt, usize)>,
}

impl<'i> UnitReader<'_, 'i> {
    fn offset(&self, offset: UnitOffset) -> usize {
        offset
            .to_debug_info_offset(&self.unit.header)
            .map_or(usize::MAX, |offset| offset.0)
    }

    fn die(
        &mut self,
        number: usize,
        entry: &gimli::DebuggingInformationEntry<'_, '_, Bytes<'i>>,
    ) -> gimli::Result<Die> {
        let mut die = Die {
            tag: entry.tag().0,
            unit: self.number,
            ..Die::default()
        };
        let mut ranges = self.dwarf.die_ranges(self.unit, entry)?;
        while let Some(range) = ranges.next()? {
            if range.begin < range.end {
                die.ranges.push(range.begin as u32..range.end as u32);
            }
        }
        let mut attributes = entry.attrs();
        let (mut bit_size, mut bit_offset) = (None, None);
        while let Some(attribute) = attributes.next()? {
            match attribute.name() {
                constants::DW_AT_bit_size => bit_size = attribute.udata_value(),
                // From the highest bit of the storage unit; the chip is little-endian.
                constants::DW_AT_bit_offset => bit_offset = attribute.udata_value(),
                _ => self.take(&mut die, number, &attribute)?,
            }
        }
        if let Some(size) = bit_size {
            let unit_bits = 8 * die.bytes.unwrap_or(2);
            die.bits = Some((
                unit_bits.saturating_sub(bit_offset.unwrap_or(0) + size),
                size,
            ));
        }
        Ok(die)
    }

    fn take(
        &mut self,
        die: &mut Die,
        number: usize,
        attribute: &Attribute<Bytes<'i>>,
    ) -> gimli::Result<()> {
        let value = attribute.value();
        match attribute.name() {
            constants::DW_AT_name => {
                let name = self.dwarf.attr_string(self.unit, value)?;
                die.name = Some(name.to_string_lossy().into_owned());
            }
            name @ (constants::DW_AT_type
            | constants::DW_AT_abstract_origin
            | constants::DW_AT_specification) => {
                let to = match value {
                    AttributeValue::UnitRef(offset) => self.offset(offset),
                    AttributeValue::DebugInfoRef(offset) => offset.0,
                    _ => return Ok(()),
                };
                self.references.push((number, name, to));
            }
            constants::DW_AT_byte_size => die.bytes = attribute.udata_value(),
            constants::DW_AT_encoding => {
                if let AttributeValue::Encoding(encoding) = value {
                    die.encoding = Some(encoding);
                }
            }
            constants::DW_AT_data_member_location => die.offset = self.member_offset(attribute),
            constants::DW_AT_count => die.count = attribute.udata_value(),
            constants::DW_AT_upper_bound => {
                die.count = attribute.udata_value().map(|last| last.saturating_add(1))
            }
            constants::DW_AT_const_value => self.take_constant(die, attribute),
            constants::DW_AT_location => die.place = self.place(value)?,
            constants::DW_AT_frame_base => die.frame_base = self.place(value)?,
            constants::DW_AT_GNU_call_site_value | constants::DW_AT_call_value => {
                die.passed = value.exprloc_value().map(|code| self.code(code.0));
            }
            constants::DW_AT_low_pc => {
                die.entry = self
                    .dwarf
                    .attr_address(self.unit, value)?
                    .map(|address| address as u32);
            }
            constants::DW_AT_call_line => {
                die.call_line = attribute.udata_value().map(|line| line as u32)
            }
            constants::DW_AT_call_file => {
                die.call_file = match value {
                    AttributeValue::FileIndex(file) => Some(file),
                    _ => attribute.udata_value(),
                }
            }
            constants::DW_AT_declaration => die.declaration = true,
            constants::DW_AT_artificial => die.artificial = true,
            _ => {}
        }
        Ok(())
    }

    fn take_constant(&self, die: &mut Die, attribute: &Attribute<Bytes<'i>>) {
        die.value = attribute
            .sdata_value()
            .or_else(|| attribute.udata_value().map(|value| value as i64));
        die.place = match (attribute.value(), die.value) {
            (AttributeValue::Block(bytes), _) => Place::Constant(bytes.slice().into()),
            (_, Some(value)) => Place::Constant(value.to_le_bytes().into()),
            _ => return,
        };
    }

    /// A number, or in DWARF 2 an expression that adds one.
    fn member_offset(&self, attribute: &Attribute<Bytes<'i>>) -> u64 {
        if let Some(offset) = attribute.udata_value() {
            return offset;
        }
        let mut operations = attribute
            .exprloc_value()
            .map(|code| code.operations(self.unit.encoding()));
        match operations.as_mut().map(|operations| operations.next()) {
            Some(Ok(Some(gimli::Operation::PlusConstant { value }))) => value,
            _ => 0,
        }
    }

    fn place(&self, value: AttributeValue<Bytes<'i>>) -> gimli::Result<Place> {
        if let Some(code) = value.exprloc_value() {
            return Ok(Place::Code(self.code(code.0)));
        }
        let Some(mut list) = self.dwarf.attr_locations(self.unit, value)? else {
            return Ok(Place::None);
        };
        let mut places = Vec::new();
        while let Some(entry) = list.next()? {
            let range = entry.range.begin as u32..entry.range.end as u32;
            places.push((range, self.code(entry.data.0)));
        }
        Ok(Place::List(places))
    }

    fn code(&self, bytes: Bytes<'i>) -> Code {
        Code {
            bytes: Arc::from(bytes.slice()),
            encoding: self.unit.encoding(),
            base_types: self.base_types(bytes),
        }
    }

    /// The base types that an expression refers to, by their offsets in the unit.
    fn base_types(&self, bytes: Bytes<'i>) -> Vec<(usize, gimli::ValueType)> {
        let mut found = Vec::new();
        let mut operations = gimli::Expression(bytes).operations(self.unit.encoding());
        while let Ok(Some(operation)) = operations.next() {
            use gimli::Operation as Op;
            match operation {
                Op::RegisterOffset { base_type, .. }
                | Op::Deref { base_type, .. }
                | Op::TypedLiteral { base_type, .. }
                | Op::Convert { base_type }
                | Op::Reinterpret { base_type }
                    if base_type.0 != 0 =>
                {
                    found.extend(self.value_type(base_type).map(|of| (base_type.0, of)));
                }
                Op::EntryValue { expression } => found.extend(self.base_types(expression)),
                _ => {}
            }
        }
        found
    }

    fn value_type(&self, offset: UnitOffset) -> Option<gimli::ValueType> {
        let entry = self.unit.entry(offset).ok()?;
        let size = entry
            .attr(constants::DW_AT_byte_size)
            .ok()??
            .udata_value()?;
        match entry.attr_value(constants::DW_AT_encoding).ok()?? {
            AttributeValue::Encoding(encoding) => gimli::ValueType::from_encoding(encoding, size),
            _ => None,
        }
    }
}
