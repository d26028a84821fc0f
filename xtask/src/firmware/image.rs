//! The linked image: checked for forbidden content, stamped with its hash.

use object::{Object, ObjectSection, ObjectSegment, ObjectSymbol, SymbolKind};

/// Where the image keeps its hash.
const HASH_SYMBOL: &str = "RUMBO_IMAGE_HASH";
/// Symbols of panics and formatted text in the image.
const FORBIDDEN: [&str; 3] = ["panic", "core3fmt", "unwrap_failed"];

/// Refuses an image that can panic or format text.
pub(super) fn check(file: &object::File<'_>) -> Result<(), String> {
    let mut functions = file
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text);
    let forbidden = functions.find_map(|symbol| {
        let name = symbol.name().unwrap_or_default();
        FORBIDDEN
            .iter()
            .any(|word| name.contains(word))
            .then_some(name)
    });
    forbidden.map_or(Ok(()), |name| {
        Err(format!(
            "the image contains {:#}: the core must not be able to panic or format text",
            rustc_demangle::demangle(name)
        ))
    })
}

/// Writes the image's hash into it: FNV-1a of all that goes to the chip, the hash taken as zero.
pub(super) fn stamp(elf: &mut [u8]) -> Result<u32, String> {
    let (place, loaded) = places(elf).ok_or(format!("the linked image has no {HASH_SYMBOL}"))?;
    elf.get_mut(place..place + 4)
        .ok_or("the hash lies outside the file")?
        .fill(0);
    let bytes = loaded
        .iter()
        .flat_map(|(from, to)| elf.get(*from..*to).unwrap_or_default());
    let hash = bytes.fold(0x811C_9DC5_u32, |hash, byte| {
        (hash ^ u32::from(*byte)).wrapping_mul(0x0100_0193)
    });
    // Zero means an image without a hash.
    let hash = hash.max(1);
    if let Some(target) = elf.get_mut(place..place + 4) {
        target.copy_from_slice(&hash.to_le_bytes());
    }
    Ok(hash)
}

/// Places in the file: of the hash, and from where to where it is loaded.
fn places(elf: &[u8]) -> Option<(usize, Vec<(usize, usize)>)> {
    let file = object::File::parse(elf).ok()?;
    let symbol = file.symbol_by_name(HASH_SYMBOL)?;
    let section = file.section_by_index(symbol.section_index()?).ok()?;
    let (from, _) = section.file_range()?;
    let place = (from + symbol.address() - section.address()) as usize;
    let loaded = file.segments().filter_map(|segment| {
        let (from, size) = segment.file_range();
        (size > 0).then_some((from as usize, (from + size) as usize))
    });
    Some((place, loaded.collect()))
}
