//! Preprocesses `.ino` files as the Arduino IDE does: joins them, includes `Arduino.h`, declares every function before
//! the first.

use crate::source::Source;

/// The C++ file of a sketch: the `.ino` of its name first, the others after it; `None` if there is none.
pub(crate) fn join(source: &Source) -> Option<String> {
    let mut parts: Vec<(&String, &Vec<u8>)> = source
        .files
        .iter()
        .filter(|(name, _)| {
            !name.contains('/') && (name.ends_with(".ino") || name.ends_with(".pde"))
        })
        .collect();
    let main = format!("{}.ino", source.name);
    parts.sort_by_key(|(name, _)| **name != main);
    let mut text = String::new();
    for (name, bytes) in &parts {
        let bytes = String::from_utf8_lossy(bytes);
        text += &format!(
            "#line 1 \"{name}\"\n{}\n",
            bytes.trim_start_matches('\u{feff}')
        );
    }
    (!parts.is_empty()).then(|| with_declarations(&text))
}

/// Headers that a source includes.
pub(crate) fn includes(text: &str) -> impl Iterator<Item = &str> {
    let rests = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("#include"));
    rests.filter_map(|rest| {
        let quoted = rest.trim().strip_prefix(['<', '"'])?;
        quoted.split(['>', '"']).next()
    })
}

fn with_declarations(text: &str) -> String {
    let functions = functions(text);
    let declarations: String = functions
        .iter()
        .map(|(_, head)| format!("{head};\n"))
        .collect();
    let (before, after) = text.split_at(functions.first().map_or(text.len(), |(at, _)| *at));
    // The rest continues with its line number.
    let file = before.rfind("#line 1 ").unwrap_or(0);
    let name = before[file..]
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("#line 1 "))
        .unwrap_or("\"sketch\"");
    let line = before[file..].matches('\n').count();
    format!("#include <Arduino.h>\n{before}{declarations}#line {line} {name}\n{after}")
}

/// Where each function at the outermost level starts, and its head up to the parenthesis that closes.
fn functions(text: &str) -> Vec<(usize, String)> {
    let blank = blanked(text);
    let mut found = Vec::new();
    let (mut depth, mut start) = (0usize, 0);
    for (at, character) in blank.char_indices() {
        match character {
            '{' => {
                // Heads at the outermost level do not overlap: each character is looked at once.
                let head = if depth == 0 {
                    blank[start..at].trim_start()
                } else {
                    ""
                };
                if is_function(head.trim_end()) {
                    let begin = at - head.len();
                    let words: Vec<&str> = head.split_whitespace().collect();
                    found.push((begin, words.join(" ")));
                }
                depth += 1;
            }
            '}' => {
                depth = depth.saturating_sub(1);
                start = at + 1;
            }
            ';' if depth == 0 => start = at + 1,
            _ => {}
        }
    }
    found
}

/// `type name(arguments)`, and neither a class, an interrupt routine, an initialiser nor a member.
fn is_function(head: &str) -> bool {
    let name = head.split('(').next().unwrap_or_default();
    head.ends_with(')')
        && name.split_whitespace().count() >= 2
        && !head.contains('=')
        && !name.contains("::")
}

/// The text with comments, strings and preprocessor lines made blank, each character in its place.
fn blanked(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    let mut line_start = true;
    while let Some(character) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if line_start && character == '#' {
            directive(rest)
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if character == '"' || character == '\'' {
            literal(rest, character)
        } else {
            line_start = character == '\n' || (line_start && character.is_whitespace());
            out.push(character);
            rest = &rest[character.len_utf8()..];
            continue;
        };
        let (skipped, after) = rest.split_at(length);
        out.extend(skipped.bytes().map(|b| if b == b'\n' { '\n' } else { ' ' }));
        rest = after;
    }
    out
}

/// Length of a preprocessor line, with those that a backslash joins to it.
fn directive(text: &str) -> usize {
    let mut ends = text.match_indices('\n').map(|(at, _)| at);
    let end = ends.find(|at| !text[..*at].trim_end_matches('\r').ends_with('\\'));
    end.unwrap_or(text.len())
}

/// Length of a literal with its quotes.
fn literal(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, character) in text.char_indices().skip(1) {
        match character {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if character == quote => return at + 1,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_macro_of_several_lines_is_no_function() {
        let text =
            "#line 1 \"a.ino\"\n#define BOTH(a) \\\n  void a() { \\\n    b(); }\nint f() { }\n";
        let made = with_declarations(text);
        assert!(made.contains("b(); }\nint f();\n#line 4"), "{made}");
    }

    #[test]
    fn every_function_is_declared_before_the_first() {
        let text = "#line 1 \"a.ino\"\n#include <Servo.h>\nint x = f('{');\n\
                    // void no() {\nvoid setup() {\n  g(1);\n}\nISR(INT0_vect) { }\n\
                    struct S { void m() { } };\nstatic long g(int a,\n  S *b) { return 1; }\n";
        let made = with_declarations(text);
        let expected = "// void no() {\nvoid setup();\nstatic long g(int a, S *b);\n\
                        #line 4 \"a.ino\"\nvoid setup() {";
        assert!(made.starts_with("#include <Arduino.h>\n#line 1"), "{made}");
        assert!(made.contains(expected), "{made}");
        assert!(!made.contains("m();") && !made.contains("vect);"), "{made}");
    }

    #[test]
    fn a_text_is_read_once_whatever_it_is_made_of() {
        // Each of these took hours while a head was looked at again at every brace.
        for (open, many) in [
            ("{", 800_000),
            ("{}", 400_000),
            ("f(", 400_000),
            ("\"", 800_001),
            ("/*", 400_000),
            ("#\\\n", 250_000),
        ] {
            let text = format!(
                "void setup(){{}}\n{}{}",
                " ".repeat(800_000),
                open.repeat(many)
            );
            assert_eq!(functions(&text), [(0, "void setup()".to_owned())], "{open}");
        }
    }

    #[test]
    fn libraries_are_known_by_what_is_included() {
        assert_eq!(
            includes("#include <Servo.h>\n  #include \"pid.h\" // x\nint a;\n").collect::<Vec<_>>(),
            ["Servo.h", "pid.h"]
        );
    }
}
