//! The linked image: stamped with its hash, measured.

use std::fmt;

use object::LittleEndian;
use object::elf::{FileHeader32, SHF_ALLOC, SHF_WRITE, SHT_NOBITS, STT_FUNC};
use object::read::elf::{FileHeader, SectionHeader, Sym};

/// Where the image keeps its hash.
const HASH_SYMBOL: &str = "RUMBO_IMAGE_HASH";
/// What says that a panic or formatted text is in the image.
const FORBIDDEN: [&str; 3] = ["panic", "core3fmt", "unwrap_failed"];

/// What the image takes.
#[derive(Debug)]
pub(crate) struct Report {
    sections: Vec<(String, u64, bool, bool)>,
    hash: u32,
}

impl Report {
    /// Code, constants, and the initial values of variables.
    pub(crate) fn flash_bytes(&self) -> u64 {
        self.sum(|in_file, _| in_file)
    }

    /// Variables.
    pub(crate) fn sram_bytes(&self) -> u64 {
        self.sum(|_, in_sram| in_sram)
    }

    fn sum(&self, wanted: impl Fn(bool, bool) -> bool) -> u64 {
        let sections = self.sections.iter();
        sections
            .filter(|(_, _, in_file, in_sram)| wanted(*in_file, *in_sram))
            .map(|(_, size, ..)| size)
            .sum()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, size, in_file, in_sram) in &self.sections {
            let flash = if *in_file { *size } else { 0 };
            let sram = if *in_sram { *size } else { 0 };
            writeln!(f, "{name:<8} {flash:>7} bytes of flash {sram:>6} of SRAM")?;
        }
        write!(f, "hash {:08x}", self.hash)
    }
}

/// Writes the image's hash into it, and measures it.
pub(crate) fn finish(bytes: &mut [u8]) -> Result<Report, String> {
    let wrong = |error: object::read::Error| format!("the linked image: {error}");
    let layout = Layout::read(bytes).map_err(wrong)?;
    if let Some(name) = layout.forbidden.first() {
        return Err(format!(
            "the image contains {name}: the core must not be able to panic or format text"
        ));
    }
    let place = layout
        .hash
        .ok_or(format!("the image has no {HASH_SYMBOL}"))?;
    let target = bytes
        .get_mut(place..place + 4)
        .ok_or("the hash lies outside the file")?;
    target.fill(0);
    let hash = layout.loaded.iter().fold(0x811C_9DC5, |hash, (from, to)| {
        let loaded = bytes.get(*from..*to).unwrap_or_default();
        loaded.iter().fold(hash, |hash: u32, byte| {
            (hash ^ u32::from(*byte)).wrapping_mul(0x0100_0193)
        })
    });
    // Zero stands for an image that has none.
    let hash = hash.max(1);
    if let Some(target) = bytes.get_mut(place..place + 4) {
        target.copy_from_slice(&hash.to_le_bytes());
    }
    Ok(Report {
        sections: layout.sections,
        hash,
    })
}

/// What the file holds.
#[derive(Default)]
struct Layout {
    forbidden: Vec<String>,
    /// Places in the file of what is loaded into flash.
    loaded: Vec<(usize, usize)>,
    hash: Option<usize>,
    sections: Vec<(String, u64, bool, bool)>,
}

impl Layout {
    fn read(bytes: &[u8]) -> Result<Self, object::read::Error> {
        let mut layout = Layout::default();
        let header = FileHeader32::<LittleEndian>::parse(bytes)?;
        let endian = LittleEndian;
        let sections = header.sections(endian, bytes)?;
        for (_, section) in sections.enumerate() {
            let flags = section.sh_flags(endian);
            let size = u64::from(section.sh_size(endian));
            if flags & SHF_ALLOC == 0 || size == 0 {
                continue;
            }
            let in_file = section.sh_type(endian) != SHT_NOBITS;
            let in_sram = flags & SHF_WRITE != 0;
            let name =
                String::from_utf8_lossy(sections.section_name(endian, section)?).into_owned();
            layout.sections.push((name, size, in_file, in_sram));
            if in_file {
                let from = section.sh_offset(endian) as usize;
                layout.loaded.push((from, from + size as usize));
            }
        }
        let symbols = sections.symbols(endian, bytes, object::elf::SHT_SYMTAB)?;
        for symbol in symbols.iter() {
            let name =
                String::from_utf8_lossy(symbol.name(endian, symbols.strings())?).into_owned();
            let Ok(section) =
                sections.section(object::SectionIndex(usize::from(symbol.st_shndx(endian))))
            else {
                continue;
            };
            let place = (symbol.st_value(endian)
                - section.sh_addr(endian).min(symbol.st_value(endian))
                + section.sh_offset(endian)) as usize;
            if name == HASH_SYMBOL {
                layout.hash = Some(place);
            }
            if symbol.st_type() == STT_FUNC && FORBIDDEN.iter().any(|word| name.contains(word)) {
                layout.forbidden.push(name);
            }
        }
        Ok(layout)
    }
}
