//! What debuggers are told.
//!
//! Types and variables stay as the compiler describes them, and functions by their names. Its description has 16 bits for an
//! address, which do not reach all code, and its places within functions move: functions have none in it, and lists of places are
//! empty. The assembler makes a table of lines anew, with the line at which each function begins.

/// A section of the description.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kept {
    /// As it is.
    Whole,
    /// An empty list, which all its labels are.
    Labels,
    /// Nothing of it.
    No,
}

/// The description of the whole program.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Debugging {
    pub(super) files: Vec<String>,
    pub(super) lines: Vec<String>,
}

impl Debugging {
    /// Begins a section; says how much of it is kept.
    pub(super) fn begin(&mut self, name: &str, line: &str) -> Kept {
        let is = |names: &[&str]| names.iter().any(|it| name.starts_with(it));
        let kept = if is(&[".debug_loc", ".debug_ranges", ".debug_line"]) {
            Kept::Labels
        } else if is(&[".debug_aranges"]) {
            Kept::No
        } else {
            Kept::Whole
        };
        if kept != Kept::No {
            self.lines.push(line.to_owned());
        }
        kept
    }

    /// A line of a section.
    pub(super) fn read(&mut self, line: &str, kept: Kept) {
        let is_place = [".Ltmp", ".Lfunc_"]
            .iter()
            .any(|label| line.contains(label));
        if is_place && kept == Kept::Whole {
            let directive = line.split_whitespace().next().unwrap_or_default();
            self.lines.push(format!("{directive} 0"));
        } else if kept == Kept::Whole || kept == Kept::Labels && line.ends_with(':') {
            self.lines.push(line.to_owned());
        }
    }

    /// Takes in `.file number "folder" "name"`, which avr-gcc's assembler wants as one path.
    pub(super) fn file(&mut self, line: &str) {
        let numbered = line
            .trim_start_matches(".file")
            .trim_start()
            .starts_with(|first: char| first.is_ascii_digit());
        if numbered {
            self.files.push(line.replace("\" \"", "/"));
        }
    }

    /// The end of what was empty: lists end with two zeros.
    pub(super) fn finish(&mut self) {
        for section in [".debug_loc", ".debug_ranges"] {
            self.lines.extend([
                format!(".section {section},\"\",@progbits"),
                ".long 0".to_owned(),
            ]);
        }
    }
}
