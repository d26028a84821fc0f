//! Types from the debugging information (DWARF) of an image.

use gimli::{AttributeValue, EndianSlice, EntriesTreeNode, LittleEndian, Unit, UnitOffset};
use object::{Object, ObjectSection};

type Bytes<'a> = EndianSlice<'a, LittleEndian>;
type Dwarf<'a> = gimli::Dwarf<Bytes<'a>>;
type Entry<'e, 'a> = gimli::DebuggingInformationEntry<'e, 'e, Bytes<'a>>;

/// A number, and its bytes where there are several.
#[derive(Clone, Copy, Debug)]
pub(super) enum Number {
    Nothing,
    Bool,
    Float,
    Unsigned(usize),
    Signed(usize),
}

/// A type.
#[derive(Debug)]
pub(super) enum Shape {
    Number(Number),
    /// An enum without fields: its bytes, and the name of each number.
    Names {
        bytes: usize,
        names: Vec<(u64, String)>,
    },
    Array {
        element: Box<Shape>,
        /// Of one element.
        bytes: usize,
        count: usize,
    },
    /// A struct, tuple or variant: its name without parameters; name, place and type of each field.
    Fields {
        name: String,
        fields: Vec<(String, usize, Shape)>,
    },
    /// An enum: offset and size of the discriminant; its value in each variant, and the variant's content.
    Variants {
        tag: Option<(usize, usize)>,
        variants: Vec<(Option<u64>, Shape)>,
    },
}

impl Shape {
    /// The largest struct of this name in an ELF file, with its bytes.
    pub(super) fn named(elf: &[u8], name: &str) -> Result<(usize, Shape), gimli::Error> {
        let file = object::File::parse(elf).unwrap();
        let section = |id: gimli::SectionId| -> Result<Bytes<'_>, gimli::Error> {
            let section = file.section_by_name(id.name());
            let data = section.and_then(|section| section.data().ok());
            Ok(EndianSlice::new(data.unwrap_or_default(), LittleEndian))
        };
        let dwarf = Dwarf::load(section)?;
        let mut found: Option<(usize, Shape)> = None;
        let mut units = dwarf.units();
        while let Some(header) = units.next()? {
            let unit = dwarf.unit(header)?;
            let mut entries = unit.entries();
            while let Some((_, entry)) = entries.next_dfs()? {
                if entry.tag() != gimli::DW_TAG_structure_type {
                    continue;
                }
                let within = Within {
                    dwarf: &dwarf,
                    unit: &unit,
                };
                let bytes = within.size(entry)?;
                let larger = found.as_ref().is_none_or(|(largest, _)| bytes > *largest);
                if larger && within.name(entry)? == name {
                    found = Some((bytes, within.shape(entry.offset())?));
                }
            }
        }
        found.ok_or(gimli::Error::MissingUnitDie)
    }
}

/// A unit of the debugging information.
struct Within<'e, 'a> {
    dwarf: &'e Dwarf<'a>,
    unit: &'e Unit<Bytes<'a>>,
}

impl<'e, 'a> Within<'e, 'a> {
    fn shape(&self, at: UnitOffset) -> Result<Shape, gimli::Error> {
        let mut tree = self.unit.entries_tree(Some(at))?;
        let node = tree.root()?;
        let entry = node.entry();
        Ok(match entry.tag() {
            gimli::DW_TAG_base_type => Shape::Number(self.number(entry)?),
            gimli::DW_TAG_enumeration_type => self.names(node)?,
            gimli::DW_TAG_array_type => self.array(node)?,
            gimli::DW_TAG_structure_type => self.composed(node)?,
            other => panic!("{}: {other} is not known here", self.name(entry)?),
        })
    }

    fn number(&self, entry: &Entry<'_, 'a>) -> Result<Number, gimli::Error> {
        let bytes = self.size(entry)?;
        let encoding = match entry.attr_value(gimli::DW_AT_encoding)? {
            Some(AttributeValue::Encoding(encoding)) => encoding,
            _ => gimli::DW_ATE_unsigned,
        };
        Ok(match (encoding, bytes) {
            (_, 0) => Number::Nothing,
            (gimli::DW_ATE_boolean, _) => Number::Bool,
            (gimli::DW_ATE_float, 4) => Number::Float,
            (gimli::DW_ATE_signed, _) => Number::Signed(bytes),
            (gimli::DW_ATE_unsigned, _) => Number::Unsigned(bytes),
            other => panic!("{other:?} is not known here"),
        })
    }

    fn names(&self, node: EntriesTreeNode<'_, '_, '_, Bytes<'a>>) -> Result<Shape, gimli::Error> {
        let bytes = self.size(node.entry())?;
        let mut names = Vec::new();
        let mut children = node.children();
        while let Some(child) = children.next()? {
            let entry = child.entry();
            let value = self.value(entry, gimli::DW_AT_const_value, bytes)?;
            names.extend(value.map(|value| (value, self.name(entry).unwrap_or_default())));
        }
        Ok(Shape::Names { bytes, names })
    }

    fn array(&self, node: EntriesTreeNode<'_, '_, '_, Bytes<'a>>) -> Result<Shape, gimli::Error> {
        let element = self.type_of(node.entry())?;
        let mut count = 0;
        let mut children = node.children();
        while let Some(child) = children.next()? {
            count = self.at(child.entry(), gimli::DW_AT_count)?;
        }
        Ok(Shape::Array {
            element: Box::new(self.shape(element)?),
            bytes: self.size_at(element)?,
            count,
        })
    }

    fn composed(
        &self,
        node: EntriesTreeNode<'_, '_, '_, Bytes<'a>>,
    ) -> Result<Shape, gimli::Error> {
        let name = self.name(node.entry())?;
        let mut fields = Vec::new();
        let mut children = node.children();
        while let Some(child) = children.next()? {
            match child.entry().tag() {
                gimli::DW_TAG_variant_part => return self.variants(child),
                gimli::DW_TAG_member => fields.push(self.field(child.entry())?),
                _ => {}
            }
        }
        // `Wheels<f32>` is printed as `Wheels`, a tuple without a name.
        let name = name.split('<').next().unwrap_or_default();
        let name = if name.starts_with('(') { "" } else { name };
        Ok(Shape::Fields {
            name: name.to_owned(),
            fields,
        })
    }

    fn field(&self, entry: &Entry<'_, 'a>) -> Result<(String, usize, Shape), gimli::Error> {
        let at = self.at(entry, gimli::DW_AT_data_member_location)?;
        Ok((self.name(entry)?, at, self.shape(self.type_of(entry)?)?))
    }

    fn variants(
        &self,
        part: EntriesTreeNode<'_, '_, '_, Bytes<'a>>,
    ) -> Result<Shape, gimli::Error> {
        let tag = match part.entry().attr_value(gimli::DW_AT_discr)? {
            Some(AttributeValue::UnitRef(at)) => {
                let entry = self.unit.entry(at)?;
                let place = self.at(&entry, gimli::DW_AT_data_member_location)?;
                Some((place, self.size_at(self.type_of(&entry)?)?))
            }
            _ => None,
        };
        let bytes = tag.map_or(8, |(_, bytes)| bytes);
        let mut variants = Vec::new();
        let mut children = part.children();
        while let Some(variant) = children.next()? {
            if variant.entry().tag() != gimli::DW_TAG_variant {
                continue;
            }
            let value = self.value(variant.entry(), gimli::DW_AT_discr_value, bytes)?;
            let mut members = variant.children();
            if let Some(member) = members.next()? {
                variants.push((value, self.shape(self.type_of(member.entry())?)?));
            }
        }
        Ok(Shape::Variants { tag, variants })
    }

    fn name(&self, entry: &Entry<'_, 'a>) -> Result<String, gimli::Error> {
        let Some(name) = entry.attr_value(gimli::DW_AT_name)? else {
            return Ok(String::new());
        };
        let name = self.dwarf.attr_string(self.unit, name)?;
        Ok(name.to_string_lossy().into_owned())
    }

    fn type_of(&self, entry: &Entry<'_, 'a>) -> Result<UnitOffset, gimli::Error> {
        match entry.attr_value(gimli::DW_AT_type)? {
            Some(AttributeValue::UnitRef(at)) => Ok(at),
            _ => Err(gimli::Error::MissingUnitDie),
        }
    }

    /// A small number that counts or places something; 0 where there is none.
    fn at(&self, entry: &Entry<'_, 'a>, what: gimli::DwAt) -> Result<usize, gimli::Error> {
        let value = entry.attr_value(what)?;
        let value = value.and_then(|value| value.udata_value());
        Ok(value.map_or(0, |value| value as usize))
    }

    fn size(&self, entry: &Entry<'_, 'a>) -> Result<usize, gimli::Error> {
        self.at(entry, gimli::DW_AT_byte_size)
    }

    fn size_at(&self, at: UnitOffset) -> Result<usize, gimli::Error> {
        let mut tree = self.unit.entries_tree(Some(at))?;
        let node = tree.root()?;
        if node.entry().tag() != gimli::DW_TAG_array_type {
            return self.size(node.entry());
        }
        let Shape::Array { bytes, count, .. } = self.array(node)? else {
            return Ok(0);
        };
        Ok(bytes * count)
    }

    /// A number of this many bytes, signed or not.
    fn value(
        &self,
        entry: &Entry<'_, 'a>,
        what: gimli::DwAt,
        bytes: usize,
    ) -> Result<Option<u64>, gimli::Error> {
        let Some(value) = entry.attr_value(what)? else {
            return Ok(None);
        };
        let value = value
            .udata_value()
            .or_else(|| value.sdata_value().map(i64::cast_unsigned));
        let unused = 64 - 8 * bytes as u32;
        Ok(value.map(|value| value << unused >> unused))
    }
}
