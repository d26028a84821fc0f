//! Beginnings and ends of functions, written once for all.
//!
//! A function pushes the registers that it uses and its caller may count on, r2 to r17 and r28, r29, and makes room for
//! its variables below them; Y points there. At its end all that is undone. Both take up to fifty bytes, and each function has its
//! own. Here a function calls a common beginning, which takes the way back from the stack into Z, and goes to a common end that
//! returns in its place:
//!
//! ```text
//! ldi r26, 20                    ; bytes of variables
//! rcall rumbo_enter_frame_8      ; pushes r8 to r17, r28, r29
//! ...
//! adiw r28, 20
//! rjmp rumbo_leave_frame_8       ; pops them, returns
//! ```
//!
//! X, Z and r0 are nobody's at both places: they carry neither arguments nor results. Registers are pushed from an even one
//! up without gaps, so a few are pushed in vain; not where arguments lie on the stack, above what is pushed. The way back
//! has 16 bits: the image stays within 128 KB.

use std::collections::BTreeSet;

use super::assembly::{Function, Instruction, Line, Program};
use super::stack_arguments::Shift;

/// Pushes that a common beginning must replace to be worth it.
const WORTH: usize = 3;
/// Instructions of a function in which cycles count that make a common beginning cheap beside them.
const LONG: usize = 120;
/// Largest frame that one register holds.
const LARGEST: i32 = 255;

/// Moves the stack pointer to Y.
const TO_Y: [&str; 5] = [
    "in r0, 63",
    "cli",
    "out 62, r29",
    "out 63, r0",
    "out 61, r28",
];

/// Takes the address to return to from the stack, of which 16 bits say all.
const TAKE_WAY_BACK: [&str; 3] = ["pop r0", "pop r31", "pop r30"];

/// How a function begins and ends.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frame {
    /// Registers pushed below r28.
    pub(super) pushed: Vec<u8>,
    /// Whether r28 and r29 are, and Y points to the stack.
    pub(super) y: bool,
    /// Bytes of variables.
    bytes: i32,
    /// Lines of the beginning.
    lines: usize,
    /// Lines of each end, from where they begin.
    pub(super) ends: Vec<(usize, usize, Kind)>,
}

/// What an end does beside taking registers from the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Kind {
    /// Nothing.
    Plain,
    /// r28 and r29 are taken too.
    Pointer,
    /// Before, the stack pointer is moved to Y.
    Frame,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Kind::Plain => "plain",
            Kind::Pointer => "pointer",
            Kind::Frame => "frame",
        }
    }
}

fn shows(line: Option<&Line>, text: &str) -> bool {
    line.and_then(Line::instruction)
        .is_some_and(|instruction| instruction.to_string() == text)
}

fn all_show(lines: &[Line], at: usize, texts: &[&str]) -> bool {
    texts
        .iter()
        .enumerate()
        .all(|(place, text)| shows(lines.get(at + place), text))
}

/// The register that a line pushes or pops.
pub(super) fn moved(line: Option<&Line>, name: &str) -> Option<u8> {
    let instruction = line
        .and_then(Line::instruction)
        .filter(|instruction| instruction.name == name)?;
    instruction.operand(0).strip_prefix('r')?.parse().ok()
}

impl Frame {
    /// Reads how a function begins and ends; `None` where it is otherwise.
    pub(super) fn read(function: &Function) -> Option<Self> {
        let lines = &function.lines;
        let mut pushed: Vec<u8> = (0..).map_while(|at| moved(lines.get(at), "push")).collect();
        let mut at = pushed.len();
        let y = pushed.ends_with(&[28, 29]) && all_show(lines, at, &["in r28, 61", "in r29, 62"]);
        let mut bytes = 0;
        if y {
            pushed.truncate(pushed.len() - 2);
            at += 2;
            let shift = Shift::read(lines, at).ok()?;
            if let Some(shift) =
                shift.filter(|shift| shift.by < 0 && all_show(lines, at + shift.lines, &TO_Y))
            {
                bytes = -shift.by;
                at += shift.lines + TO_Y.len();
            }
        }
        let in_order = pushed.windows(2).all(|two| two[0] < two[1]);
        if !in_order || pushed.iter().any(|register| !(2..=17).contains(register)) {
            return None;
        }
        let mut frame = Self {
            pushed,
            y,
            bytes,
            lines: at,
            ends: Vec::new(),
        };
        frame.ends = frame.read_ends(lines)?;
        Some(frame)
    }

    fn read_ends(&self, lines: &[Line]) -> Option<Vec<(usize, usize, Kind)>> {
        let mut popped: Vec<u8> = self.pushed.iter().copied().rev().collect();
        if self.y {
            popped.splice(0..0, [29, 28]);
        }
        let mut ends = Vec::new();
        let mut at = self.lines;
        while at < lines.len() {
            if moved(lines.get(at), "push").is_some() {
                return None;
            }
            if moved(lines.get(at), "pop").is_some() || shows(lines.get(at), "ret") {
                let matches = popped.iter().enumerate().all(|(place, register)| {
                    moved(lines.get(at + place), "pop") == Some(*register)
                });
                if !matches || !shows(lines.get(at + popped.len()), "ret") {
                    return None;
                }
                let moves = at
                    .checked_sub(TO_Y.len())
                    .filter(|&from| all_show(lines, from, &TO_Y));
                let (from, kind) = match (self.y, moves) {
                    (true, Some(from)) => (from, Kind::Frame),
                    (true, None) => (at, Kind::Pointer),
                    (false, _) => (at, Kind::Plain),
                };
                let to = at + popped.len() + 1;
                ends.push((from, to, kind));
                at = to;
            } else {
                at += 1;
            }
        }
        Some(ends)
    }

    /// Registers pushed, with Y.
    pub(super) fn pushes(&self) -> usize {
        self.pushed.len() + if self.y { 2 } else { 0 }
    }

    /// Lines of the beginning.
    pub(super) fn beginning(&self) -> usize {
        self.lines
    }

    /// Whether it has room for variables, to which Y points.
    pub(super) fn has_variables(&self) -> bool {
        self.y && self.bytes > 0
    }

    /// The first of the registers that the common code moves, from there to r17 without gaps.
    fn first(&self) -> u8 {
        self.pushed.first().map_or(18, |first| first & !1)
    }

    /// Whether the common code moves just these.
    fn is_exact(&self) -> bool {
        self.pushed.len() == usize::from(18 - self.first())
    }

    /// Whether the common beginning is for it.
    fn begins_alike(&self) -> bool {
        let makes_room = if self.bytes > 0 { 5 } else { 0 };
        let plain = !self.y || (1..=LARGEST).contains(&self.bytes);
        plain && self.pushes() + makes_room >= WORTH
    }
}

/// Gives functions common beginnings and ends. Of those with arguments on the stack nothing that lies above may move; of those in
/// which cycles count only long ones take part.
pub(super) fn share(
    program: &mut Program,
    has_stack_arguments: impl Fn(&Function) -> bool,
    is_hot: impl Fn(&Function) -> bool,
) {
    let mut enters = BTreeSet::new();
    let mut leaves = BTreeSet::new();
    for function in &mut program.functions {
        let short = function.instructions().count() < LONG;
        if function.is_handler() || is_hot(function) && short {
            continue;
        }
        let Some(frame) = Frame::read(function) else {
            continue;
        };
        let begins = frame.begins_alike() && (frame.is_exact() || !has_stack_arguments(function));
        if !begins && !frame.is_exact() || frame.pushed.is_empty() && !frame.y {
            continue;
        }
        rewrite(function, &frame, begins, &mut enters, &mut leaves);
    }
    program.functions.extend(leaves.into_iter().map(leave));
    for y in [false, true] {
        let firsts = enters.iter().filter(|(kind, _)| *kind == y);
        let firsts: Vec<u8> = firsts.map(|(_, first)| *first).collect();
        program.functions.extend(enter(y, &firsts));
    }
}

fn rewrite(
    function: &mut Function,
    frame: &Frame,
    begins: bool,
    enters: &mut BTreeSet<(bool, u8)>,
    leaves: &mut BTreeSet<(Kind, u8)>,
) {
    let first = frame.first();
    let mut lines = Vec::with_capacity(function.lines.len());
    if begins {
        if frame.y {
            lines.push(Line::Do(Instruction::new(
                "ldi",
                &["r26", &frame.bytes.to_string()],
            )));
        }
        lines.push(Line::Do(Instruction::new(
            "call",
            &[&enter_label(frame.y, first)],
        )));
        enters.insert((frame.y, first));
    } else {
        lines.extend_from_slice(&function.lines[..frame.lines]);
    }
    let mut at = frame.lines;
    for &(from, to, kind) in &frame.ends {
        lines.extend_from_slice(&function.lines[at..from]);
        lines.push(Line::Do(Instruction::new(
            "jmp",
            &[&leave_label(kind, first)],
        )));
        leaves.insert((kind, first));
        at = to;
    }
    lines.extend_from_slice(&function.lines[at..]);
    function.lines = lines;
}

/// What a common beginning is called.
pub(super) const ENTER: &str = "rumbo_enter_";

fn enter_label(y: bool, first: u8) -> String {
    format!("{ENTER}{}{first}", if y { "frame_" } else { "" })
}

fn leave_label(kind: Kind, first: u8) -> String {
    format!("rumbo_leave_{}_{first}", kind.name())
}

fn parsed(texts: &[&str]) -> Vec<Line> {
    texts
        .iter()
        .filter_map(|text| Instruction::parse(text).ok())
        .map(Line::Do)
        .collect()
}

/// The common beginning: pushes from a register on, with a way in for each that one may begin at.
fn enter(y: bool, firsts: &[u8]) -> Option<Function> {
    let (&first, others) = firsts.split_first()?;
    let pushes = |register: u8| format!(".Lpushes_{}{register}", if y { "frame_" } else { "" });
    let mut lines = Vec::new();
    for &other in others {
        lines.push(Line::Label(enter_label(y, other)));
        lines.extend(parsed(&TAKE_WAY_BACK));
        lines.push(Line::Do(Instruction::new("jmp", &[&pushes(other)])));
    }
    lines.push(Line::Label(enter_label(y, first)));
    lines.extend(parsed(&TAKE_WAY_BACK));
    for register in first..18 {
        if others.contains(&register) {
            lines.push(Line::Label(pushes(register)));
        }
        lines.push(Line::Do(Instruction::new(
            "push",
            &[&format!("r{register}")],
        )));
    }
    if y {
        if others.contains(&18) {
            lines.push(Line::Label(pushes(18)));
        }
        lines.extend(parsed(&[
            "push r28",
            "push r29",
            "in r28, 61",
            "in r29, 62",
            "sub r28, r26",
            "sbc r29, r1",
        ]));
        lines.extend(parsed(&TO_Y));
    }
    lines.extend(parsed(&["ijmp"]));
    let name = format!("{ENTER}{}", if y { "frame" } else { "plain" });
    Some(Function::new(name, lines))
}

/// A common end.
fn leave((kind, first): (Kind, u8)) -> Function {
    let mut lines = if kind == Kind::Frame {
        parsed(&TO_Y)
    } else {
        Vec::new()
    };
    if kind != Kind::Plain {
        lines.extend(parsed(&["pop r29", "pop r28"]));
    }
    lines.extend(
        (first..18)
            .rev()
            .map(|register| Line::Do(Instruction::new("pop", &[&format!("r{register}")]))),
    );
    lines.extend(parsed(&["ret"]));
    Function::new(leave_label(kind, first), lines)
}
