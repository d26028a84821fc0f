//! A compiler's diagnostics, parsed from GCC's output.
//!
//! ```text
//! wall.ino:12:3: error: 'speed' was not declared in this scope      a place, how bad, what
//! wall.ino:4:5: note: suggested alternative: 'sped'                 a note on it
//! wall.ino:12: undefined reference to `drive(int)'                  the linker's
//! ```

use serde::Serialize;
use std::fmt;

/// Its severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The image is still built.
    Warning,
    /// There is no image.
    Error,
}

/// One diagnostic.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Its severity.
    pub severity: Severity,
    /// The student's file, relative to the sketch's folder; `None` where the tool names none.
    pub file: Option<String>,
    /// Line, from 1.
    pub line: Option<u32>,
    /// Column, from 1.
    pub column: Option<u32>,
    /// What is wrong.
    pub text: String,
    /// The compiler's notes on it, a line each.
    pub notes: Vec<String>,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(file) = &self.file {
            f.write_str(file)?;
            for number in [self.line, self.column].into_iter().flatten() {
                write!(f, ":{number}")?;
            }
            f.write_str(": ")?;
        }
        let severity = match self.severity {
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        write!(f, "{severity}: {}", self.text)?;
        self.notes
            .iter()
            .try_for_each(|note| write!(f, "\n  {note}"))
    }
}

/// Most diagnostics kept of one compilation; the first ones matter.
const MOST: usize = 50;
/// Most notes kept of one diagnostic.
const MOST_NOTES: usize = 8;

/// All diagnostics in a compiler's output.
pub(crate) fn parse(output: &str) -> Vec<Diagnostic> {
    let mut found: Vec<Diagnostic> = Vec::new();
    for line in output.lines().map(str::trim_end) {
        if let Some(diagnostic) = complaint(line) {
            if found.len() == MOST {
                break;
            }
            if !found.contains(&diagnostic) {
                found.push(diagnostic);
            }
        } else if let Some((place, note)) = line.split_once(": note: ")
            && let Some(last) = found.last_mut()
            && last.notes.len() < MOST_NOTES
        {
            last.notes.push(format!("{}: {note}", cleaned(place)));
        }
    }
    found
}

/// The diagnostic that a line begins, if any.
fn complaint(line: &str) -> Option<Diagnostic> {
    for (mark, severity) in [
        (": fatal error: ", Severity::Error),
        (": error: ", Severity::Error),
        (": warning: ", Severity::Warning),
        // The assembler's.
        (": Fatal error: ", Severity::Error),
        (": Error: ", Severity::Error),
        (": Warning: ", Severity::Warning),
    ] {
        if let Some((place, text)) = line.split_once(mark) {
            return Some(at(place, severity, text.to_owned()));
        }
    }
    for (region, text) in [
        (
            "region `text'",
            "the program is larger than the board's flash memory",
        ),
        (
            "region `data'",
            "the global variables are larger than the board's RAM",
        ),
    ] {
        if line.contains("ld: ") && line.contains(region) {
            return Some(at("", Severity::Error, text.to_owned()));
        }
    }
    let quoted = |name: &str| name.trim_matches(['`', '\'']).to_owned();
    if let Some((_, name)) = line.split_once(": multiple definition of ") {
        let name = name.split("'; ").next().unwrap_or(name);
        return Some(at("", Severity::Error, twice(&quoted(name))));
    }
    let (place, name) = line.split_once(": undefined reference to ")?;
    let name = quoted(name);
    let name = name.as_str();
    let text = match name {
        // It is the core that calls them, from a file that nobody has to see.
        "setup" | "loop" => {
            let text =
                format!("the sketch has no function `void {name}()`; write one, if an empty one");
            return Some(at("", Severity::Error, text));
        }
        _ => format!("`{name}` is declared and used, but defined nowhere"),
    };
    Some(at(place, Severity::Error, text))
}

/// That two files define one name.
fn twice(name: &str) -> String {
    match name.strip_prefix("__vector_") {
        Some(number) => format!(
            "two libraries want the same interrupt, vector {number}, and its timer: the sketch can use only one of them (on a Uno \
             tone() takes vector 7, Servo 11)"
        ),
        None => format!("`{name}` is defined twice; one definition must go, or be `static`"),
    }
}

fn at(place: &str, severity: Severity, text: String) -> Diagnostic {
    let mut parts = place.rsplitn(3, ':');
    let numbers: Vec<Option<u32>> = parts
        .by_ref()
        .take(2)
        .map(|part| part.trim().parse().ok())
        .collect();
    let (file, line, column) = match numbers[..] {
        [Some(column), Some(line)] => (parts.next().unwrap_or_default(), Some(line), Some(column)),
        [Some(line), None] => (
            place.rsplit_once(':').map_or(place, |(file, _)| file),
            Some(line),
            None,
        ),
        _ => (place, None, None),
    };
    // The compiler's own, with a name that is another every time.
    let is_intermediate = file.starts_with('/') && file.ends_with(".s");
    let file = cleaned(file);
    // The driver and the linker speak for themselves; objects of a link by the compiler are no files of the student.
    let is_tool = [
        "avr-gcc",
        "avr-g++",
        "collect2",
        "lto1",
        "cc1",
        "lto-wrapper",
    ]
    .iter()
    .any(|tool| file.starts_with(tool))
        || is_intermediate
        || file.contains(".ltrans")
        || file.ends_with("/ld")
        || file.ends_with(".o");
    Diagnostic {
        severity,
        file: (!is_tool && !file.is_empty()).then_some(file),
        line: line.filter(|_| !is_intermediate),
        column,
        text,
        notes: Vec::new(),
    }
}

/// The name of a file without the folder of the build; of the core and of libraries without theirs.
fn cleaned(path: &str) -> String {
    let path = path.trim().trim_start_matches("./");
    match path.starts_with('/') {
        true => path.rsplit('/').next().unwrap_or(path).to_owned(),
        false => path.trim_start_matches("../main/").to_owned(),
    }
}

/// A tool's output without control characters and a terminal's escape sequences: a source may put any into a message.
pub(crate) fn plain(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        let opens = match character {
            '\u{1b}' => characters.next_if(|next| !next.is_control()),
            '\u{9b}' => Some('['),
            '\u{9d}' => Some(']'),
            _ => None,
        };
        match (character, opens) {
            // A control sequence: parameters, and one final character.
            (_, Some('[')) => {
                while characters
                    .next_if(|next| (' '..='?').contains(next))
                    .is_some()
                {}
                characters.next_if(|next| ('@'..='~').contains(next));
            }
            // A command: a text up to a bell or another escape, within the line.
            (_, Some(']' | 'P' | '^' | '_' | 'X')) => {
                while characters.next_if(|next| !next.is_control()).is_some() {}
                characters.next_if_eq(&'\u{7}');
            }
            ('\n' | '\t', _) => out.push(character),
            // These change the direction of what is around them.
            ('\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}', _) => {}
            _ if character.is_control() => {}
            _ => out.push(character),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_has_its_place_and_its_notes() {
        let found = parse(
            "wall.ino: In function 'void loop()':\n\
             wall.ino:12:3: error: 'speed' was not declared in this scope\n   speed = 3;\n   ^\n\
             /usr/share/arduino/cores/Arduino.h:4:5: note: suggested alternative: 'sped'\n\
             pid.h:2:10: fatal error: pad.h: No such file or directory\n compilation terminated.\n",
        );
        let shown: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(
            shown,
            [
                "wall.ino:12:3: error: 'speed' was not declared in this scope\n  \
                 Arduino.h:4:5: suggested alternative: 'sped'",
                "pid.h:2:10: error: pad.h: No such file or directory",
            ]
        );
    }

    #[test]
    fn what_each_file_says_again_is_said_once() {
        let (header, own) = ("pid.h:2:1: error: one\n", "b.cpp:3:1: error: other\n");
        assert_eq!(parse(&[header, own, header].concat()).len(), 2);
    }

    #[test]
    fn a_function_that_is_missing_is_named_by_the_linker() {
        let found = parse(
            "/tmp/ccA.ltrans0.ltrans.o: In function `main':\n\
             /usr/share/arduino/cores/arduino/main.cpp:46: undefined reference to `loop'\n\
             <artificial>:(.text.startup+0x1e): undefined reference to `drive(int)'\n\
             collect2: error: ld returned 1 exit status\n",
        );
        assert_eq!(
            found[0].to_string(),
            "error: the sketch has no function `void loop()`; write one, if an empty one"
        );
        assert_eq!(
            found[1].text,
            "`drive(int)` is declared and used, but defined nowhere"
        );
        assert_eq!(found[2].file, None);
    }

    #[test]
    fn what_is_defined_twice_is_named_by_the_linker() {
        let found = parse(
            "../out/1.o (symbol from plugin): In function `ping()':\n\
             (.text+0x0): multiple definition of `__vector_7'\n\
             ../out/0.o (symbol from plugin):(.text+0x0): first defined here\n\
             /usr/bin/ld: ../out/2.o:/a/b.cpp:3: multiple definition of `speed'; ../out/0.o:c.cpp:1: first defined here\n\
             collect2: error: ld returned 1 exit status\n",
        );
        assert!(
            found[0]
                .text
                .starts_with("two libraries want the same interrupt, vector 7")
        );
        assert!(found[1].text.starts_with("`speed` is defined twice"));
    }

    #[test]
    fn a_program_that_is_too_large_is_told_so_once() {
        let found = parse(
            "/usr/lib/avr/bin/ld: address 0x805194 of ../out/sketch.elf section `.bss' is not within region `data'\n\
             /usr/lib/avr/bin/ld: address 0x805194 of ../out/sketch.elf section `.noinit' is not within region `data'\n\
             /usr/lib/avr/bin/ld: ../out/sketch.elf section `.text' will not fit in region `text'\n",
        );
        let shown: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(
            shown,
            [
                "error: the global variables are larger than the board's RAM",
                "error: the program is larger than the board's flash memory"
            ]
        );
    }

    #[test]
    fn the_assembler_s_errors_have_a_place_where_the_student_wrote_them() {
        let found = parse(
            "src/a.S: Assembler messages:\nsrc/a.S:3: Error: unknown opcode `nope'\n\
             /tmp/ccX1.s: Assembler messages:\n/tmp/ccX1.s:12: Error: file not found: /etc/passwd\n",
        );
        let shown: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(
            shown,
            [
                "src/a.S:3: error: unknown opcode `nope'",
                "error: file not found: /etc/passwd"
            ]
        );
    }

    #[test]
    fn a_message_has_no_escape_sequences_and_no_other_text_is_lost() {
        for (text, expected) in [
            (
                "a.ino:1: error: \u{1b}[31;1mred\u{1b}[0m",
                "a.ino:1: error: red",
            ),
            ("\u{1b}]0;title\u{7}a\u{1b}]8;;http://x\u{1b}\\b", "ab"),
            ("\u{9b}2Ja\u{8}\u{8}\rb\tc\nd", "ab\tc\nd"),
            ("\u{1b}cnot ended \u{1b}[12\nnext", "not ended \nnext"),
            ("\u{1b}]swallows its line\nnot the next", "\nnot the next"),
            ("ñ \u{202e}leaves\u{2069} 'x'", "ñ leaves 'x'"),
        ] {
            assert_eq!(plain(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_flood_of_errors_is_cut() {
        let flood: String = (1..1000)
            .map(|line| format!("a.ino:{line}:1: error: no\n"))
            .collect();
        assert_eq!(parse(&flood).len(), MOST);
    }
}
