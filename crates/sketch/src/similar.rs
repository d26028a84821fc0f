//! Which of many programs are alike, whoever wrote from whom: fingerprints of their tokens by winnowing (Schleimer,
//! Wilkerson and Aiken, *Winnowing: local algorithms for document fingerprinting*, SIGMOD 2003).
//!
//! Comments, layout, preprocessor lines, names and numbers do not matter, nor does the order of functions. What many of
//! the programs have in common, or all were given, is nobody's.

use crate::source::Source;
use std::collections::{BTreeMap, BTreeSet};

/// Tokens in a row that count as alike. From 38 published robots of 31 authors: with 12 and windows of 6 no two of
/// different authors share more than 0.17; their copies with other names, numbers and order at least 0.57.
const GRAM: usize = 12;
/// Of so many neighbouring rows of tokens at least one is kept.
const WINDOW: usize = 6;
/// Least share that is named.
const LEAST_SHARE: f64 = 0.45;
/// Fewer fingerprints in common are chance.
const LEAST_COMMON: usize = 8;
/// What more than this share of the programs have, and more than [`FEW`], is nobody's.
const COMMON: f64 = 0.1;
const FEW: usize = 3;
/// In any class.
const MANY: usize = 20;
/// So much of a program is looked at [bytes].
const LONGEST: usize = 1 << 20;

/// Words of C++ and of Arduino, which no author chooses; all others are names.
const WORDS: &str = "alignas auto bool break byte boolean case catch char class const constexpr continue default delete do \
    double else enum explicit extern false float for friend goto if inline int long mutable namespace new nullptr operator \
    private protected public register return short signed sizeof static struct switch template this throw true try typedef \
    typename union unsigned using virtual void volatile while word String size_t int8_t int16_t int32_t uint8_t uint16_t \
    uint32_t setup loop pinMode digitalWrite digitalRead analogRead analogWrite analogReference tone noTone shiftOut shiftIn \
    pulseIn pulseInLong millis micros delay delayMicroseconds min max abs constrain map pow sqrt sq sin cos tan random \
    randomSeed attachInterrupt detachInterrupt digitalPinToInterrupt interrupts noInterrupts Serial Serial1 Serial2 Serial3 \
    begin end available read peek write print println readString readStringUntil parseInt parseFloat flush HIGH LOW INPUT \
    OUTPUT INPUT_PULLUP RISING FALLING CHANGE ISR Servo attach writeMicroseconds SoftwareSerial Wire";

/// Two programs that are alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Their places in the list, the earlier one first.
    pub of: [usize; 2],
    /// The share of the shorter one's fingerprints that the other one has too, 0 to 1.
    pub share: f64,
    /// The lines of each that the other has too, from 0.
    pub lines: [BTreeSet<usize>; 2],
}

/// The text of a sketch, its files one after the other.
#[must_use]
pub fn text_of(source: &Source) -> String {
    let files = source.files.iter();
    let texts =
        files.map(|(name, bytes)| format!("// {name}\n{}\n", String::from_utf8_lossy(bytes)));
    texts.collect()
}

/// The pairs that are alike, most of all first. `given` are the programs that all began with.
#[must_use]
pub fn similar(programs: &[String], given: &[String]) -> Vec<Pair> {
    let given = given.iter().flat_map(|text| Prints::of(text).grams);
    let given: BTreeSet<u64> = given.map(|(hash, _)| hash).collect();
    let mut owners: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (program, text) in programs.iter().enumerate() {
        for hash in Prints::of(text).kept() {
            owners.entry(hash).or_default().push(program);
        }
    }
    let most = ((COMMON * programs.len() as f64) as usize).clamp(FEW, MANY);
    owners.retain(|hash, owners| owners.len() <= most && !given.contains(hash));
    let mut own = vec![0_usize; programs.len()];
    let mut common: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    for owners in owners.values() {
        for (place, one) in owners.iter().enumerate() {
            own[*one] += 1;
            for other in &owners[place + 1..] {
                *common.entry([*one, *other]).or_default() += 1;
            }
        }
    }
    let alike = common.into_iter().filter_map(|([one, other], common)| {
        let share = common as f64 / own[one].min(own[other]).max(1) as f64;
        let alike = common >= LEAST_COMMON && share >= LEAST_SHARE;
        alike.then(|| {
            let of = [one, other];
            let [one, other] = of.map(|program| Prints::of(&programs[program]));
            Pair {
                of,
                share,
                lines: [
                    one.shared_with(&other, &given),
                    other.shared_with(&one, &given),
                ],
            }
        })
    });
    let mut pairs: Vec<Pair> = alike.collect();
    pairs.sort_by(|one, other| {
        other
            .share
            .total_cmp(&one.share)
            .then(one.of.cmp(&other.of))
    });
    pairs
}

/// A program as rows of tokens.
struct Prints {
    /// Each row of [`GRAM`] tokens: what it is, and the place of its first token.
    grams: Vec<(u64, usize)>,
    /// The line of each token.
    lines: Vec<usize>,
}

impl Prints {
    fn of(text: &str) -> Self {
        let text = &text[..text.floor_char_boundary(LONGEST)];
        let tokens = tokens(text);
        let rows = tokens.windows(GRAM).enumerate();
        Self {
            grams: rows
                .map(|(place, row)| (hash(row.iter().map(|(token, _)| *token)), place))
                .collect(),
            lines: tokens.iter().map(|(_, line)| *line).collect(),
        }
    }

    /// The fingerprints: the least of each window.
    fn kept(&self) -> BTreeSet<u64> {
        let hashes: Vec<u64> = self.grams.iter().map(|(hash, _)| *hash).collect();
        match hashes.len() {
            0..=WINDOW => hashes.into_iter().min().into_iter().collect(),
            _ => {
                let windows = hashes.windows(WINDOW);
                windows
                    .filter_map(|window| window.iter().min().copied())
                    .collect()
            }
        }
    }

    /// The lines with rows of tokens that another program has too, but for those that were given.
    fn shared_with(&self, other: &Self, given: &BTreeSet<u64>) -> BTreeSet<usize> {
        let theirs: BTreeSet<u64> = other.grams.iter().map(|(hash, _)| *hash).collect();
        let shared = self.grams.iter();
        let shared = shared.filter(|(hash, _)| theirs.contains(hash) && !given.contains(hash));
        shared
            .flat_map(|(_, place)| self.lines[*place..place + GRAM].iter().copied())
            .collect()
    }
}

/// The tokens of a text that matter, each with its line; names are `i`, numbers and characters `0`, texts `"`.
fn tokens(text: &str) -> Vec<(&str, usize)> {
    let words: BTreeSet<&str> = WORDS.split_whitespace().collect();
    let mut tokens = Vec::new();
    let (mut rest, mut line, mut begins) = (text, 0, true);
    while let Some(c) = rest.chars().next() {
        let end = match c {
            '#' if begins => directive(rest),
            _ if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            _ if rest.starts_with("/*") => rest[2..].find("*/").map_or(rest.len(), |at| at + 4),
            '"' | '\'' => quoted(rest, c),
            c if is_inner(c) => {
                let has_point = c.is_ascii_digit();
                let inner = |c: char| is_inner(c) || (has_point && c == '.');
                rest.find(|c| !inner(c)).unwrap_or(rest.len())
            }
            c => c.len_utf8(),
        };
        let (token, after) = rest.split_at(end);
        let kind = match c {
            '#' if begins => None,
            _ if token.starts_with("//") || token.starts_with("/*") => None,
            c if c.is_whitespace() => None,
            '"' => Some("\""),
            '\'' => Some("0"),
            c if c.is_ascii_digit() => Some("0"),
            c if c.is_alphabetic() || c == '_' => Some(words.get(token).copied().unwrap_or("i")),
            _ => Some(token),
        };
        tokens.extend(kind.map(|kind| (kind, line)));
        let lines = token.matches('\n').count();
        line += lines;
        begins = lines > 0 || (begins && c.is_whitespace());
        rest = after;
    }
    tokens
}

/// Whether a name or a number goes on with it.
fn is_inner(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Where a preprocessor's line ends, with those that a backslash joins to it.
fn directive(text: &str) -> usize {
    let mut from = 0;
    while let Some(at) = text[from..].find('\n') {
        let end = from + at;
        if !text[..end].trim_end_matches('\r').ends_with('\\') {
            return end;
        }
        from = end + 1;
    }
    text.len()
}

/// Where a text in quotes ends; one that is never closed ends with its line.
fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '\n' => return at,
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            c if c == quote => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// FNV-1a of tokens.
fn hash<'a>(tokens: impl Iterator<Item = &'a str>) -> u64 {
    let bytes = tokens.flat_map(|token| token.bytes().chain([0]));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    const WALL: &str = include_str!("../../../examples/assignments/wall/model/model.ino");
    const BOX: &str = include_str!("../../../examples/assignments/box/model/model.ino");
    const SPEED: &str = include_str!("../../../examples/assignments/speed/model/model.ino");

    /// The same with names of its own, other layout and comments, and functions in the opposite order.
    fn disguised(text: &str) -> String {
        let mut out = String::new();
        let (mut depth, mut parts, mut part) = (0, Vec::new(), String::new());
        for token in raw(text) {
            depth += i32::from(token == "{") - i32::from(token == "}");
            let known = WORDS.split_whitespace().any(|word| word == token);
            let is_name = token.starts_with(|c: char| c.is_alphabetic() || c == '_');
            match is_name && !known {
                true => write!(part, "my_{} ", token.to_uppercase()).unwrap(),
                false => writeln!(part, "{token} // so").unwrap(),
            }
            if depth == 0 && token == "}" {
                parts.push(std::mem::take(&mut part));
            }
        }
        parts.reverse();
        parts.iter().for_each(|part| out += part);
        out + &part
    }

    /// The tokens as they are written.
    fn raw(text: &str) -> Vec<String> {
        let mut all = Vec::new();
        let without: String = (text.lines())
            .map(|line| line.split("//").next().unwrap_or_default())
            .filter(|line| !line.trim_start().starts_with('#'))
            .fold(String::new(), |all, line| all + line + "\n");
        let mut rest = without.trim_start();
        while let Some(c) = rest.chars().next() {
            let is_word = |c: char| is_inner(c) || c == '.';
            let end = match c {
                '"' | '\'' => quoted(rest, c),
                c if is_word(c) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
                c => c.len_utf8(),
            };
            all.push(rest[..end].to_owned());
            rest = rest[end..].trim_start();
        }
        all
    }

    /// A program of its own: statements drawn by a number.
    fn drawn(seed: u64) -> String {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut draw = |count: usize| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 33) as usize % count
        };
        let pieces = [
            "if (a < b) {",
            "} else {",
            "}",
            "a = b + c * 2;",
            "digitalWrite(p, HIGH);",
            "delay(d);",
            "f(a, b[2]);",
            "while (x > 0) x--;",
            "analogWrite(q, v);",
            "Serial.println(a - b);",
            "c += analogRead(A0) / 4;",
            "for (int i = 0; i < n; i++)",
            "return a;",
            "v = constrain(v, 0, 255);",
            "last = millis();",
        ];
        let body: Vec<&str> = (0..60).map(|_| pieces[draw(pieces.len())]).collect();
        format!(
            "void setup() {{}}\nvoid loop() {{\n{}\n}}\n",
            body.join("\n")
        )
    }

    #[test]
    fn five_copies_among_a_hundred_are_found_and_nobody_else() {
        let mut class: Vec<String> = (1..=92).map(drawn).collect();
        class.extend([WALL, BOX, SPEED].map(str::to_owned));
        let copied = [3, 40, 92, 93, 94];
        class.extend(copied.map(|of| disguised(&class[of])));
        let found = similar(&class, &[]);
        let mut of: Vec<[usize; 2]> = found.iter().map(|pair| pair.of).collect();
        of.sort_unstable();
        assert_eq!(of, [[3, 95], [40, 96], [92, 97], [93, 98], [94, 99]]);
        let lines = class[92].lines().count();
        let wall = found.iter().find(|pair| pair.of == [92, 97]).unwrap();
        assert!(wall.lines[0].iter().all(|line| *line < lines) && wall.lines[0].len() > lines / 3);
    }

    #[test]
    fn what_all_were_given_is_nobody_s() {
        let with = |own: &str| format!("{WALL}\n{own}");
        let class = [with(&drawn(1)), with(&drawn(2))];
        assert_eq!(similar(&class, &[]).len(), 1);
        assert!(similar(&class, &[WALL.to_owned()]).is_empty());
    }

    #[test]
    fn comments_directives_and_unclosed_quotes_are_no_tokens_and_end_where_they_end() {
        let text = "#define A \\\n 1\nint a = 0x1F; // b\n/* c\n */ s = \"x\\\"y\"; t = 'q\nz";
        let shown: Vec<&str> = tokens(text).iter().map(|(token, _)| *token).collect();
        assert_eq!(shown.join(" "), "int i = 0 ; i = \" ; i = 0 i");
        assert_eq!(tokens(text).last(), Some(&("i", 5)));
    }
}
