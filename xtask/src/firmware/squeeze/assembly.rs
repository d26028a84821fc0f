//! The compiler's assembly, read and written.
//!
//! What rustc writes with `--emit=asm` is a list of functions, each in a section of its own, and data. Functions become
//! lists of labels and instructions; data and what is not in a section `.text` stay as they are.

use std::collections::HashMap;
use std::fmt;

use super::debugging::{Debugging, Kept};
use super::effects::Set;

/// One instruction: its name, and its operands as they are written, without spaces.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Instruction {
    pub(super) name: String,
    pub(super) operands: Vec<String>,
}

/// What an instruction does to the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flow {
    /// The next one follows.
    Next,
    /// To its operand or to the next one.
    Branch,
    /// To its operand.
    Jump,
    /// To its operand and back.
    Call,
    /// To whoever called.
    Return,
}

/// Instructions that are read, by what they do to the flow; others are refused. None may skip the next one, or go where no
/// operand says: the passes would have to know.
const KNOWN: [(Flow, &[&str]); 5] = [
    (
        Flow::Next,
        &[
            "adc", "add", "adiw", "and", "andi", "asr", "bld", "bst", "cbi", "clc", "cli", "clr",
            "clt", "com", "cp", "cpc", "cpi", "dec", "eor", "in", "inc", "ld", "ldd", "ldi", "lds",
            "lpm", "lsl", "lsr", "mov", "movw", "mul", "muls", "mulsu", "neg", "nop", "or", "ori",
            "out", "pop", "push", "rol", "ror", "sbc", "sbci", "sbi", "sbiw", "sec", "sei", "set",
            "sleep", "st", "std", "sts", "sub", "subi", "swap", "tst", "wdr",
        ],
    ),
    (
        Flow::Branch,
        &[
            "breq", "brne", "brlo", "brsh", "brcs", "brcc", "brlt", "brge", "brmi", "brpl", "brts",
            "brtc", "brvs", "brvc",
        ],
    ),
    (Flow::Jump, &["jmp", "rjmp"]),
    (Flow::Call, &["call", "rcall"]),
    (Flow::Return, &["ret", "reti", "ijmp"]),
];

impl Instruction {
    /// An instruction of the passes' own.
    pub(super) fn new(name: &str, operands: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            operands: operands.iter().map(|&operand| operand.to_owned()).collect(),
        }
    }

    /// Reads a line without comment.
    pub(super) fn parse(line: &str) -> Result<Self, String> {
        let (name, operands) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let operands = operands
            .split(',')
            .map(|operand| operand.replace([' ', '\t'], ""));
        let instruction = Self {
            name: name.to_owned(),
            operands: operands.filter(|operand| !operand.is_empty()).collect(),
        };
        if !KNOWN.iter().any(|(_, names)| names.contains(&name)) {
            return Err(format!(
                "`{instruction}`: not an instruction that is known here"
            ));
        }
        let target = instruction.target();
        if target.is_some_and(|target| !is_symbol(target)) {
            return Err(format!("`{instruction}`: where does it go?"));
        }
        Ok(instruction)
    }

    /// What it does to the flow.
    pub(super) fn flow(&self) -> Flow {
        let known = KNOWN
            .iter()
            .find(|(_, names)| names.contains(&self.name.as_str()));
        known.map_or(Flow::Next, |(flow, _)| *flow)
    }

    /// Where it goes, if it says so.
    pub(super) fn target(&self) -> Option<&str> {
        match self.flow() {
            Flow::Branch | Flow::Jump | Flow::Call => self.operands.first().map(String::as_str),
            Flow::Next | Flow::Return => None,
        }
    }

    /// An operand; empty where there is none.
    pub(super) fn operand(&self, place: usize) -> &str {
        self.operands.get(place).map_or("", String::as_str)
    }

    /// Whether it has this name and these operands.
    pub(super) fn is(&self, name: &str, operands: &[&str]) -> bool {
        self.name == name && self.operands == operands
    }

    /// Words of two bytes that it takes.
    pub(super) fn words(&self) -> usize {
        match self.name.as_str() {
            "call" | "jmp" | "lds" | "sts" => 2,
            _ => 1,
        }
    }

    /// Whether what follows it is not reached from it.
    pub(super) fn ends(&self) -> bool {
        matches!(self.flow(), Flow::Jump | Flow::Return)
    }
}

impl fmt::Display for Instruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.name)?;
        for (place, operand) in self.operands.iter().enumerate() {
            write!(f, "{} {operand}", if place == 0 { "" } else { "," })?;
        }
        Ok(())
    }
}

/// A line of a function.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Line {
    Label(String),
    Do(Instruction),
}

impl Line {
    /// The instruction, if it is one.
    pub(super) fn instruction(&self) -> Option<&Instruction> {
        match self {
            Line::Label(_) => None,
            Line::Do(instruction) => Some(instruction),
        }
    }
}

/// A function: its names and its lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Function {
    /// The first is the one by which debuggers know it.
    pub(super) names: Vec<String>,
    pub(super) lines: Vec<Line>,
    /// File and line at which it begins, for debuggers.
    pub(super) source: Option<String>,
    /// Registers that it changes although the convention would have it keep them.
    pub(super) lost: Set,
}

impl Function {
    /// A function of the passes' own.
    pub(super) fn new(name: String, lines: Vec<Line>) -> Self {
        Self {
            names: vec![name],
            lines,
            source: None,
            lost: Set::NONE,
        }
    }

    /// The name by which debuggers know it.
    pub(super) fn name(&self) -> &str {
        self.names.first().map_or("", String::as_str)
    }

    /// An interrupt's handler: hardware calls it, at any time.
    pub(super) fn is_handler(&self) -> bool {
        self.name().starts_with("__vector")
    }

    /// Its labels and the lines where they are.
    pub(super) fn places(&self) -> HashMap<&str, usize> {
        let lines = self.lines.iter().enumerate();
        let labels = lines.filter_map(|(at, line)| match line {
            Line::Label(label) => Some((label.as_str(), at)),
            Line::Do(_) => None,
        });
        labels.collect()
    }

    /// Its instructions.
    pub(super) fn instructions(&self) -> impl Iterator<Item = &Instruction> {
        self.lines.iter().filter_map(Line::instruction)
    }
}

/// The whole program.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Program {
    pub(super) functions: Vec<Function>,
    /// Names that others link to.
    pub(super) global: Vec<String>,
    /// Data, and code in sections of its own, as the compiler wrote it.
    pub(super) rest: Vec<String>,
    pub(super) debugging: Debugging,
}

/// Whether it is a name and nothing more.
fn is_symbol(text: &str) -> bool {
    let mut letters = text.chars();
    letters
        .next()
        .is_some_and(|first| first.is_ascii_alphabetic() || "._$".contains(first))
        && letters.all(|letter| letter.is_ascii_alphanumeric() || "._$".contains(letter))
}

/// Where a line of the compiler's belongs.
#[derive(Clone, Copy, PartialEq)]
enum Section {
    Code,
    Debugging(Kept),
    Rest,
}

/// Directives that have nothing to say any more.
const DROPPED: [&str; 2] = [".ident", ".cfi"];
/// Directives that the printed program has anew.
const OF_CODE: [&str; 3] = [".p2align", ".type", ".size"];

impl Program {
    /// Reads what the compiler wrote.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut program = Program::default();
        let mut section = Section::Rest;
        for (number, line) in text.lines().enumerate() {
            // Text may have a semicolon, code has them before remarks only.
            let remark = if line.contains('"') {
                None
            } else {
                line.find(';')
            };
            let line = line
                .get(..remark.unwrap_or(line.len()))
                .unwrap_or_default()
                .trim();
            if !line.is_empty() {
                program
                    .read(line, &mut section)
                    .map_err(|error| format!("line {} of the assembly: {error}", number + 1))?;
            }
        }
        // A label at the end of a function is where its code ended.
        for function in &mut program.functions {
            while function
                .lines
                .last()
                .is_some_and(|last| matches!(last, Line::Label(name) if name.starts_with(".L")))
            {
                function.lines.pop();
            }
        }
        program.debugging.finish();
        program
            .functions
            .retain(|function| !function.lines.is_empty());
        Ok(program)
    }

    fn read(&mut self, line: &str, section: &mut Section) -> Result<(), String> {
        let is = |directives: &[&str]| directives.iter().any(|it| line.starts_with(it));
        if is(&[".section"]) {
            *section = self.section(line);
        } else if let Section::Debugging(kept) = section {
            self.debugging.read(line, *kept);
        } else if let Some(name) = line.strip_prefix(".globl") {
            self.global.push(name.trim().to_owned());
        } else if is(&[".file"]) {
            self.debugging.file(line);
        } else if is(&[".loc"]) {
            self.line_of_source(line);
        } else if is(&DROPPED) {
            // Nothing.
        } else if line.starts_with("__vector") && line.contains(" = ") {
            self.second_name(line)?;
        } else if *section == Section::Rest || line.ends_with("@object") {
            // A variable's type stands before its section.
            self.rest.push(line.to_owned());
        } else if let Some(label) = line.strip_suffix(':') {
            self.label(label)?;
        } else if !is(&OF_CODE) {
            let function = self.functions.last_mut();
            let function = function.ok_or("an instruction outside of a function")?;
            function.lines.push(Line::Do(Instruction::parse(line)?));
        }
        Ok(())
    }

    fn section(&mut self, line: &str) -> Section {
        let name = line
            .trim_start_matches(".section")
            .trim()
            .trim_start_matches('"');
        if name.starts_with(".text") {
            return Section::Code;
        }
        if name.starts_with(".debug") {
            return Section::Debugging(self.debugging.begin(name, line));
        }
        // What is to be kept is kept anyway, and the assembler does not know the letter.
        self.rest.push(line.replace("\"aR\"", "\"a\""));
        Section::Rest
    }

    /// `one = pm(other)`.
    fn second_name(&mut self, line: &str) -> Result<(), String> {
        let (alias, name) = line.split_once(" = ").unwrap_or_default();
        let name = name.trim_start_matches("pm(").trim_end_matches(')');
        let same = self
            .functions
            .iter_mut()
            .find(|function| function.name() == name);
        let same = same.ok_or_else(|| format!("`{line}`: no such function"))?;
        same.names.push(alias.to_owned());
        Ok(())
    }

    /// The first line of source of a function is where it begins.
    fn line_of_source(&mut self, line: &str) {
        if let Some(function) = self.functions.last_mut()
            && function.source.is_none()
        {
            let place: Vec<&str> = line.split_whitespace().take(3).collect();
            function.source = Some(place.join(" "));
        }
    }

    fn label(&mut self, label: &str) -> Result<(), String> {
        if !is_symbol(label) {
            return Err(format!("`{label}:`: not a label that is known here"));
        }
        if !label.starts_with(".L") {
            self.functions
                .push(Function::new(label.to_owned(), Vec::new()));
            return Ok(());
        }
        // Others are for debuggers.
        if label.starts_with(".LBB") {
            let function = self.functions.last_mut();
            let function = function.ok_or("a label outside of a function")?;
            function.lines.push(Line::Label(label.to_owned()));
        }
        Ok(())
    }

    /// Writes it for the assembler: the functions in one section, in their order.
    pub(super) fn print(&self) -> String {
        let mut text = String::new();
        let mut line = |line: &str| {
            text.push_str(line);
            text.push('\n');
        };
        self.debugging.files.iter().for_each(|file| line(file));
        line(".section .text.rumbo,\"ax\",@progbits");
        self.global
            .iter()
            .for_each(|name| line(&format!(".globl {name}")));
        for function in &self.functions {
            for name in &function.names {
                line(&format!(".type {name},@function\n{name}:"));
            }
            function.source.iter().for_each(|place| line(place));
            for it in &function.lines {
                line(&match it {
                    Line::Label(label) => format!("{label}:"),
                    Line::Do(instruction) => format!("\t{instruction}"),
                });
            }
            for name in &function.names {
                line(&format!(".size {name}, .-{name}"));
            }
        }
        self.rest
            .iter()
            .chain(&self.debugging.lines)
            .for_each(|it| line(it));
        text
    }
}
