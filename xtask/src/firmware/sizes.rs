//! Flash and static SRAM of each crate and module.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::AddAssign;

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf::SHF_ALLOC};

/// Owner of what has no name of ours: the C library, `float.S`, constants.
const OTHER: &str = "other (C library, assembly, constants)";

/// Bytes of flash and of static SRAM.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bytes {
    pub(super) flash: u64,
    pub(super) sram: u64,
}

impl AddAssign for Bytes {
    fn add_assign(&mut self, other: Self) {
        self.flash += other.flash;
        self.sram += other.sram;
    }
}

/// Sizes of an image.
#[derive(Debug, Default)]
pub(super) struct Sizes {
    pub(super) whole: Bytes,
    crates: BTreeMap<String, Bytes>,
    modules: BTreeMap<(String, String), Bytes>,
}

impl Sizes {
    /// Measures a linked image: each symbol reaches to the next one.
    pub(super) fn of(file: &object::File<'_>) -> Result<Self, object::read::Error> {
        let mut sizes = Self::default();
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else {
                continue;
            };
            if sh_flags & u64::from(SHF_ALLOC) == 0 {
                continue;
            }
            let kind = section.kind();
            let symbols = file
                .symbols()
                .filter(|symbol| symbol.section_index() == Some(section.index()));
            let mut starts: BTreeMap<u64, &str> = BTreeMap::new();
            for symbol in symbols {
                let name = symbol.name()?;
                let known = starts.entry(symbol.address()).or_insert(name);
                if name.starts_with("_R") {
                    *known = name;
                }
            }
            starts.entry(section.address()).or_default();
            let end = section.address() + section.size();
            let ends = starts.keys().skip(1).copied().chain([end]);
            for ((start, name), next) in starts.iter().zip(ends) {
                let bytes = next - start;
                let in_flash = kind != SectionKind::UninitializedData;
                let in_sram = kind != SectionKind::Text;
                sizes.add(
                    name,
                    Bytes {
                        flash: u64::from(in_flash) * bytes,
                        sram: u64::from(in_sram) * bytes,
                    },
                );
            }
        }
        Ok(sizes)
    }

    fn add(&mut self, symbol: &str, bytes: Bytes) {
        let (of, module) = owner(symbol);
        self.whole += bytes;
        *self.crates.entry(of.clone()).or_default() += bytes;
        if !module.is_empty() {
            *self.modules.entry((of, module)).or_default() += bytes;
        }
    }
}

impl fmt::Display for Sizes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  flash   SRAM")?;
        let mut line = |bytes: &Bytes, name: fmt::Arguments<'_>| {
            writeln!(f, "{:>7} {:>6}  {name}", bytes.flash, bytes.sram)
        };
        let mut crates: Vec<_> = self.crates.iter().collect();
        crates.sort_by_key(|(_, bytes)| std::cmp::Reverse(bytes.flash));
        for (name, bytes) in crates {
            line(bytes, format_args!("{name}"))?;
            let mut modules: Vec<_> = self
                .modules
                .iter()
                .filter(|((of, _), _)| of == name)
                .collect();
            modules.sort_by_key(|(_, bytes)| std::cmp::Reverse(bytes.flash));
            for ((_, module), bytes) in modules {
                line(bytes, format_args!("  {module}"))?;
            }
        }
        line(&self.whole, format_args!("in all"))
    }
}

/// Crate and module of a symbol: of `<a::b::Type<c::D>>::function`, `a` and `b`.
fn owner(symbol: &str) -> (String, String) {
    if symbol.to_ascii_lowercase().starts_with("rumbo_") {
        return ("rumbo".to_owned(), "(exported)".to_owned());
    }
    if symbol.starts_with("__vector_") {
        return ("rumbo".to_owned(), "(interrupts)".to_owned());
    }
    if !symbol.starts_with("_R") {
        return (OTHER.to_owned(), String::new());
    }
    let name = format!("{:#}", rustc_demangle::demangle(symbol));
    // A method of a type that belongs to no crate belongs to its trait: `<f32 as a::b::Trait>::function`.
    let path = name
        .split(" as ")
        .map(|path| {
            path.trim_start_matches(['<', '&', '[', '(', '*'])
                .trim_start_matches("mut ")
        })
        .find(|path| {
            path.split(['<', '>', ','])
                .next()
                .is_some_and(|path| path.contains("::"))
        })
        .unwrap_or(&name);
    let is_module = |word: &&str| {
        let mut letters = word.chars();
        letters.all(|it| it.is_ascii_lowercase() || it.is_ascii_digit() || it == '_')
    };
    let mut words: Vec<&str> = path.split("::").take_while(is_module).collect();
    let next = path.split("::").nth(words.len());
    let is_in_type = next.is_some_and(|word| word.starts_with(|it: char| it.is_ascii_uppercase()));
    if !is_in_type {
        // The function itself.
        words.pop();
    }
    let of = words.first().copied().unwrap_or(OTHER);
    (of.to_owned(), words.get(1..).unwrap_or_default().join("::"))
}

#[cfg(test)]
mod tests {
    use super::owner;

    #[test]
    fn a_symbol_belongs_to_the_crate_and_module_of_its_path() {
        for (symbol, expected) in [
            (
                "_RNvNtCs1234_13rumbo_control4math9is_finite",
                ("rumbo_control", "math"),
            ),
            (
                "_RNvMs_NtCs1234_13rumbo_control3pidNtB4_8PidState5reset",
                ("rumbo_control", "pid"),
            ),
            (
                "_RNvMNtCs1234_13rumbo_control3pidNtB2_3Pid4step",
                ("rumbo_control", "pid"),
            ),
            (
                "_RNCNvNtCs1234_13rumbo_control3pid4step0B5_",
                ("rumbo_control", "pid"),
            ),
            ("__vector_5", ("rumbo", "(interrupts)")),
            ("RUMBO_ROBOT", ("rumbo", "(exported)")),
            ("__addsf3", (super::OTHER, "")),
        ] {
            let (of, module) = owner(symbol);
            assert_eq!((of.as_str(), module.as_str()), expected, "{symbol}");
        }
    }
}
