//! Preprocesses `.ino` files as the Arduino IDE does: joins them, includes `Arduino.h`, declares every function before
//! the first.
//!
//! Functions are those behind the compiler's own preprocessor: what stands in a branch that is not compiled is none, and
//! its braces do not count; what a macro makes is one. Where the preprocessor fails, the text itself is looked at, and
//! the compiler says what is wrong.

use crate::source::Source;

/// The `.ino` files directly in a folder of a sketch, which ends with `/` or is empty, as one text: that of the sketch's
/// name first, the others after it; `None` if there is none.
pub(crate) fn join(source: &Source, folder: &str) -> Option<String> {
    let inside = |name: &str| {
        let name = name.strip_prefix(folder)?;
        (!name.contains('/') && (name.ends_with(".ino") || name.ends_with(".pde"))).then_some(())
    };
    let files = source.files.iter();
    let mut parts: Vec<(&String, &Vec<u8>)> =
        files.filter(|(name, _)| inside(name).is_some()).collect();
    let main = format!("{folder}{}.ino", source.name);
    let is_named = parts.iter().any(|(name, _)| **name == main);
    // A folder that was renamed, as one that GitHub packs, has none of its name.
    let is_main = |(name, bytes): &(&String, &Vec<u8>)| match is_named {
        true => **name == main,
        false => has_setup(bytes),
    };
    parts.sort_by_key(|part| !is_main(part));
    let mut text = String::from("#include <Arduino.h>\n");
    for (name, bytes) in &parts {
        let bytes = String::from_utf8_lossy(bytes);
        text += &format!(
            "#line 1 \"{name}\"\n{}\n",
            bytes.trim_start_matches('\u{feff}')
        );
    }
    (!parts.is_empty()).then_some(text)
}

/// Whether a part of a sketch is that with `setup()`.
fn has_setup(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text.lines();
    lines.any(|line| line.trim_start().starts_with("void setup("))
}

/// Headers that a source includes, or imports, which the compiler takes too, or names in a macro.
pub(crate) fn includes(text: &str) -> impl Iterator<Item = &str> {
    let directives = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix('#'));
    let rests = directives.filter_map(|line| {
        let line = line.trim_start();
        let named = || {
            line.strip_prefix("define")?
                .find(['<', '"'])
                .map(|at| &line["define".len() + at..])
        };
        let included = line.strip_prefix("include");
        included
            .or_else(|| line.strip_prefix("import"))
            .or_else(named)
    });
    rests.filter_map(|rest| {
        let quoted = rest.trim().strip_prefix(['<', '"'])?;
        quoted.split(['>', '"']).next()
    })
}

/// The joined text with declarations of its functions, by what it is behind the preprocessor, if that is known.
pub(crate) fn with_declarations(joined: &str, preprocessed: Option<&str>) -> String {
    let places = Places::of(joined);
    let found: Vec<(Place<'_>, String)> = match preprocessed {
        Some(text) => {
            let (text, lines) = own_lines(text, &places);
            let head = |(at, head): (usize, String)| {
                Some((*lines.get(text[..at].matches('\n').count())?, head))
            };
            functions(&text).into_iter().filter_map(head).collect()
        }
        None => functions(joined)
            .into_iter()
            .filter_map(|(at, head)| Some((places.of_offset(at)?, head)))
            .collect(),
    };
    let Some(((file, line), _)) = found.first() else {
        return joined.to_owned();
    };
    // What is wrong with a declaration is wrong where its function is.
    let declarations = found
        .iter()
        .map(|((file, line), head)| format!("#line {line} \"{file}\"\n{head};\n"));
    let (before, after) = joined.split_at(places.offset((file, *line)));
    format!(
        "{before}{}#line {line} \"{file}\"\n{after}",
        declarations.collect::<String>()
    )
}

/// A line of a file of the sketch, from 1 on.
type Place<'a> = (&'a str, usize);

/// Where the files begin in the joined text.
struct Places<'a> {
    joined: &'a str,
    /// Name and offset of the first line of each.
    files: Vec<(&'a str, usize)>,
}

impl<'a> Places<'a> {
    fn of(joined: &'a str) -> Self {
        let mut at = 0;
        let mut files = Vec::new();
        for line in joined.split_inclusive('\n') {
            at += line.len();
            let name = line.strip_prefix("#line 1 \"");
            files.extend(name.and_then(|name| Some((name.strip_suffix("\"\n")?, at))));
        }
        Self { joined, files }
    }

    /// A file's text, to the beginning of the next one's.
    fn text(&self, file: &str) -> Option<(usize, &'a str)> {
        let index = self.files.iter().position(|(name, _)| *name == file)?;
        let begin = self.files[index].1;
        let end = self.files.get(index + 1).map(|(_, at)| *at);
        Some((begin, &self.joined[begin..end.unwrap_or(self.joined.len())]))
    }

    fn of_offset(&self, at: usize) -> Option<Place<'a>> {
        let (name, begin) = self.files.iter().rfind(|(_, begin)| *begin <= at)?;
        Some((name, self.joined[*begin..at].matches('\n').count() + 1))
    }

    fn offset(&self, (file, line): Place<'_>) -> usize {
        let (begin, text) = self.text(file).unwrap_or_default();
        let lines = text.split_inclusive('\n').take(line - 1);
        begin + lines.map(str::len).sum::<usize>()
    }
}

/// The lines of the sketch's own files in a preprocessed text, and where each is from.
fn own_lines<'a>(preprocessed: &str, places: &Places<'a>) -> (String, Vec<Place<'a>>) {
    let (mut text, mut lines) = (String::new(), Vec::new());
    let mut at: Option<Place<'a>> = None;
    for line in preprocessed.split_inclusive('\n') {
        if let Some(mark) = line.strip_prefix("# ") {
            let parsed = mark.split_once(" \"").and_then(|(number, rest)| {
                let name = rest.split('"').next()?;
                let file = places.files.iter().find(|(file, _)| *file == name)?.0;
                Some((file, number.parse().ok()?))
            });
            at = parsed;
        } else if let Some((file, number)) = &mut at {
            text += line;
            lines.push((*file, *number));
            *number += 1;
        }
    }
    (text, lines)
}

/// Where each function at the outermost level starts, and its head up to the parenthesis that closes.
fn functions(text: &str) -> Vec<(usize, String)> {
    let blank = blanked(text);
    let mut found = Vec::new();
    // Where the declaration before began, and where this one does.
    let (mut before, mut start) = (0, 0);
    let mut depth = 0usize;
    for (at, character) in blank.char_indices() {
        match character {
            '{' => {
                // Heads at the outermost level do not overlap: each character is looked at once.
                let head = if depth == 0 {
                    blank[start..at].trim_start()
                } else {
                    ""
                };
                let begin = at - head.len();
                let declared = behind_attributes(head).trim_end();
                // ISR() declares its function as C's before, on the same line.
                let is_own = depth != 0 || text[start..begin].contains('\n');
                let from = if is_own { begin } else { before };
                if is_function(declared) && !text[from..at].contains("extern \"") {
                    let words: Vec<&str> = declared.split_whitespace().collect();
                    found.push((begin, words.join(" ")));
                }
                depth += 1;
            }
            '}' => {
                depth = depth.saturating_sub(1);
                (before, start) = (at + 1, at + 1);
            }
            ';' if depth == 0 => (before, start) = (start, at + 1),
            _ => {}
        }
    }
    found
}

/// `type name(arguments)`, and neither a class, an interrupt routine, an initialiser, a member nor a type; the brace of
/// `QTRSensorsRC lines((byte[]) {2, 4}, 2)` stands within the parentheses.
fn is_function(head: &str) -> bool {
    let name = head.split('(').next().unwrap_or_default();
    let own = name.split_whitespace().next_back().unwrap_or_default();
    let count = |character| head.matches(character).count();
    head.ends_with(')')
        && count('(') == count(')')
        && !head.starts_with("typedef")
        && !name.ends_with("__attribute__")
        && !name.ends_with("__attribute__ ")
        && name.split_whitespace().count() >= 2
        && !head.contains('=')
        && !own.contains("::")
}

/// What follows the attributes at the beginning of a head; the definition has them.
fn behind_attributes(mut head: &str) -> &str {
    while let Some(rest) = head.strip_prefix("__attribute__") {
        let mut depth = 0;
        let end = rest.find(|character| {
            depth += i32::from(character == '(') - i32::from(character == ')');
            depth == 0 && character == ')'
        });
        let Some(end) = end else { break };
        head = rest[end + 1..].trim_start();
    }
    head
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
        } else if let Some(length) = raw_literal(rest).filter(|_| !out.ends_with(is_of_word)) {
            length
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

fn is_of_word(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// Length of a raw string, `R"end(text)end"`, if the text begins with one; all of the text if it does not end.
fn raw_literal(text: &str) -> Option<usize> {
    /// The longest end.
    const LONGEST: usize = 16;
    let rest = text.strip_prefix("R\"")?.as_bytes();
    let length = rest
        .iter()
        .take(LONGEST + 1)
        .position(|byte| *byte == b'(')?;
    let close = format!("){}\"", text.get(2..2 + length)?);
    Some(text.find(&close).map_or(text.len(), |at| at + close.len()))
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
    fn the_part_of_the_folder_s_name_is_first_or_that_with_setup() {
        let files = [("a.ino", "int a;"), ("car.ino", "void setup() { }")];
        let first = |folder: &str, more: &str| {
            let files = files.into_iter().chain([(more, "int more;")]);
            let source = Source {
                name: folder.into(),
                files: files
                    .map(|(name, text)| (name.into(), text.into()))
                    .collect(),
            };
            let joined = join(&source, "").unwrap();
            joined.lines().nth(1).unwrap().to_owned()
        };
        assert_eq!(first("car-main", "b.ino"), "#line 1 \"car.ino\"");
        assert_eq!(first("b", "b.ino"), "#line 1 \"b.ino\"");
    }

    #[test]
    fn a_macro_of_several_lines_is_no_function() {
        let text =
            "#line 1 \"a.ino\"\n#define BOTH(a) \\\n  void a() { \\\n    b(); }\nint f() { }\n";
        let made = with_declarations(text, None);
        assert!(
            made.contains("b(); }\n#line 4 \"a.ino\"\nint f();\n#line 4"),
            "{made}"
        );
    }

    #[test]
    fn a_list_among_arguments_is_no_function_s_body() {
        let text = "#line 1 \"a.ino\"\nLine border ((byte[]) {8, 12}, 2);\nvoid setup() { }\n";
        assert_eq!(functions(text).len(), 1);
    }

    #[test]
    fn every_function_is_declared_before_the_first() {
        let text = "#line 1 \"a.ino\"\n#include <Servo.h>\nint x = f('{');\n\
                    // void no() {\nvoid setup() {\n  g(1);\n}\nISR(INT0_vect) { }\n\
                    struct S { void m() { } };\nstatic long g(int a,\n  S *b) { return 1; }\n";
        let made = with_declarations(text, None);
        let expected = "// void no() {\n#line 4 \"a.ino\"\nvoid setup();\n#line 9 \"a.ino\"\n\
                        static long g(int a, S *b);\n#line 4 \"a.ino\"\nvoid setup() {";
        assert!(made.contains(expected), "{made}");
        assert!(!made.contains("m();") && !made.contains("vect);"), "{made}");
    }

    #[test]
    fn an_attribute_and_a_raw_string_hide_no_function() {
        let text = "#line 1 \"a.ino\"\nconst char page[] = R\"(say \"{ )\";\n\
                    __attribute__((noinline)) __attribute__((optimize(\"O3\"))) int f() { return 1; }\n\
                    int g() { return 2; }\n";
        let made = with_declarations(text, None);
        assert!(
            made.contains("\nint f();\n") && made.contains("\nint g();\n"),
            "{made}"
        );
    }

    #[test]
    fn functions_are_those_behind_the_preprocessor() {
        let text = "#include <Arduino.h>\n#line 1 \"a.ino\"\n#if ESP\nvoid IRAM tick() {\n#else\nvoid tick() {\n#endif\n}\n\
                    ISR(TIMER) { }\nextern \"C\" void c() { }\ntypedef struct __attribute__((packed)) { int x; } T;\n\
                    template <class N> N twice(N n) { return 2 * n; }\nvoid loop() { later(); }\nvoid later() { }\n";
        let preprocessed = "# 1 \"main.ino.cpp\"\n# 1 \"Arduino.h\" 1\nvoid init();\nint of_core() { return 1; }\n\
                            # 1 \"a.ino\"\n\n\n\nvoid tick() {\n# 6 \"a.ino\"\n}\n\
                            extern \"C\" void __vector_9 (void) ; void __vector_9 (void) { }\nextern \"C\" void c() { }\n\
                            typedef struct __attribute__((packed)) { int x; } T;\n\
                            template <class N> N twice(N n) { return 2 * n; }\nvoid loop() { later(); }\nvoid later() { }\n";
        let made = with_declarations(text, Some(preprocessed));
        let expected = "#else\n#line 4 \"a.ino\"\nvoid tick();\n#line 10 \"a.ino\"\n\
                        template <class N> N twice(N n);\n#line 11 \"a.ino\"\nvoid loop();\n#line 12 \"a.ino\"\n\
                        void later();\n#line 4 \"a.ino\"\nvoid tick() {";
        assert!(made.contains(expected), "{made}");
        assert!(
            !made.contains("vector") && !made.contains("c();\n"),
            "{made}"
        );
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
            ("R\"(", 250_000),
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
            includes("#include <Servo.h>\n  # include \"pid.h\" // x\n#import <Wire.h>\nint a;\n")
                .collect::<Vec<_>>(),
            ["Servo.h", "pid.h", "Wire.h"]
        );
    }
}
