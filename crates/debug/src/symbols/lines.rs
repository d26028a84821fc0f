//! The table of lines: which line of which file each instruction is of.

use super::dies::Dwarf;
use crate::location::Bytes;
use gimli::{ColumnType, Unit};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A file that the program was compiled from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SourceFile {
    /// As the compiler named it, relative to the folder that it ran in or whole.
    pub(crate) name: String,
    /// Where it is here, if it is found.
    pub(crate) path: Option<PathBuf>,
}

/// A line begins at an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LineRow {
    /// Of its first instruction [bytes].
    pub(crate) address: u32,
    /// Its file, in [`Lines::files`].
    pub(crate) file: usize,
    /// From 1; 0 where nothing is known from here on.
    pub(crate) line: u32,
    /// From 1; 0: unknown.
    pub(crate) column: u32,
    /// A place to stop at.
    pub(crate) is_stop: bool,
}

/// The table.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    /// The files.
    pub(crate) files: Vec<SourceFile>,
    /// By address.
    rows: Vec<LineRow>,
}

impl Lines {
    /// Reads the tables of all units; gives for each unit the files by the numbers that it uses.
    pub(super) fn read(
        dwarf: &Dwarf<'_>,
        units: &[Unit<Bytes<'_>>],
        find: &dyn Fn(&str) -> Option<PathBuf>,
    ) -> gimli::Result<(Lines, Vec<HashMap<u64, usize>>)> {
        let (mut lines, mut numbers) = (Lines::default(), Vec::new());
        for unit in units {
            let mut known = HashMap::new();
            if let Some(program) = unit.line_program.clone() {
                let mut rows = program.rows();
                let mut sequence = Vec::new();
                while let Some((header, row)) = rows.next_row()? {
                    let file = match known.get(&row.file_index()) {
                        Some(file) => *file,
                        None => {
                            let name = name(dwarf, unit, header, row.file_index())?;
                            let file = lines.file(name, find);
                            known.insert(row.file_index(), file);
                            file
                        }
                    };
                    let column = match row.column() {
                        ColumnType::LeftEdge => 0,
                        ColumnType::Column(column) => column.get() as u32,
                    };
                    let line = row.line().map_or(0, |line| line.get() as u32);
                    sequence.push(LineRow {
                        address: row.address() as u32,
                        file,
                        line: if row.end_sequence() { 0 } else { line },
                        column,
                        is_stop: row.is_stmt() && !row.end_sequence(),
                    });
                    if row.end_sequence() {
                        // What the linker left out is at 0.
                        let is_left_out = sequence.first().is_none_or(|row| row.address == 0);
                        if !is_left_out {
                            lines.rows.append(&mut sequence);
                        }
                        sequence.clear();
                    }
                }
            }
            numbers.push(known);
        }
        // An end comes before what begins there.
        lines.rows.sort_by_key(|row| (row.address, row.line != 0));
        Ok((lines, numbers))
    }

    fn file(&mut self, name: String, find: &dyn Fn(&str) -> Option<PathBuf>) -> usize {
        let known = self.files.iter().position(|file| file.name == name);
        known.unwrap_or_else(|| {
            let path = find(&name);
            self.files.push(SourceFile { name, path });
            self.files.len() - 1
        })
    }

    /// The row that an instruction is of: of several at one address the last.
    pub(crate) fn row(&self, address: u32) -> Option<LineRow> {
        let after = self.rows.partition_point(|row| row.address <= address);
        let row = self.rows.get(after.checked_sub(1)?)?;
        (row.line != 0).then_some(*row)
    }

    /// Rows in a range of addresses that begin a line: the row before is of another.
    pub(crate) fn begins(&self, addresses: std::ops::Range<u32>) -> impl Iterator<Item = LineRow> {
        self.numbers(addresses).filter_map(|at| {
            let row = self.rows[at];
            let before = at.checked_sub(1).map(|before| self.rows[before]);
            let continues =
                before.is_some_and(|before| before.line == row.line && before.file == row.file);
            let next = self.rows.get(at + 1);
            let is_last = next.is_none_or(|next| next.address != row.address);
            (row.line != 0 && row.is_stop && is_last && !continues).then_some(row)
        })
    }

    /// The rows that begin in a range of addresses.
    pub(crate) fn within(&self, addresses: std::ops::Range<u32>) -> &[LineRow] {
        &self.rows[self.numbers(addresses)]
    }

    fn numbers(&self, addresses: std::ops::Range<u32>) -> std::ops::Range<usize> {
        let below = |end| self.rows.partition_point(|row| row.address < end);
        let from = below(addresses.start);
        from..below(addresses.end).max(from)
    }

    /// The file that a user means: the one at the path, else the one that ends in most of the same names.
    pub(crate) fn file_named(&self, path: &Path) -> Option<usize> {
        let mut files = self.files.iter();
        let at = files.position(|file| file.path.as_deref() == Some(path));
        let common = |file: &SourceFile| {
            let own = Path::new(&file.name).components().rev();
            let both = own.zip(path.components().rev());
            both.take_while(|(own, given)| own == given).count()
        };
        at.or_else(|| {
            let files = self.files.iter().enumerate().rev();
            let files = files.map(|(number, file)| (common(file), number));
            let alike = files.filter(|(common, _)| *common > 0);
            alike
                .max_by_key(|(common, _)| *common)
                .map(|(_, number)| number)
        })
    }

    /// The lines of a file that have code.
    pub(crate) fn with_code(&self, file: usize) -> std::collections::BTreeSet<u32> {
        self.stops_from(file, 0).map(|row| row.line).collect()
    }

    /// The rows of a line, or of the next one that has any, by address.
    pub(crate) fn of_line(&self, file: usize, line: u32) -> Vec<LineRow> {
        let from = || self.stops_from(file, line.max(1));
        let first = from().map(|row| row.line).min();
        from()
            .filter(|row| Some(row.line) == first)
            .copied()
            .collect()
    }

    /// The places to stop at in a file from a line on.
    fn stops_from(&self, file: usize, line: u32) -> impl Iterator<Item = &LineRow> {
        let rows = self.rows.iter();
        rows.filter(move |row| row.file == file && row.is_stop && row.line >= line)
    }
}

/// The name of a file: in its folder, unless that is the one that the compiler ran in.
fn name(
    dwarf: &Dwarf<'_>,
    unit: &Unit<Bytes<'_>>,
    header: &gimli::LineProgramHeader<Bytes<'_>>,
    number: u64,
) -> gimli::Result<String> {
    let Some(file) = header.file(number) else {
        return Ok(String::new());
    };
    let text = |value| -> gimli::Result<String> {
        let text = dwarf.attr_string(unit, value)?;
        Ok(text.to_string_lossy().into_owned())
    };
    let name = text(file.path_name())?;
    let folder = match file.directory(header) {
        Some(folder) if file.directory_index() != 0 => text(folder)?,
        _ => return Ok(name),
    };
    Ok(Path::new(&folder).join(name).to_string_lossy().into_owned())
}
