//! Beginnings and ends of functions, written once for all.
//!
//! A function pushes the registers that it uses and its caller may count on, r2 to r17 and r28, r29, and makes room for
//! its variables below them; Y points there. At its end all that is undone. Both take up to fifty bytes, and each function has its
//! own. Here a function goes to a common beginning with Z as the way back, and to a common end that returns in its place:
//!
//! ```text
//! ldi r26, 20                    ; bytes of variables
//! ldi r30, lo8(pm(body))
//! ldi r31, hi8(pm(body))
//! rjmp rumbo_enter_frame_8       ; pushes r8 to r17, r28, r29
//! body: ...
//! adiw r28, 20
//! rjmp rumbo_leave_frame_8       ; pops them, returns
//! ```
//!
//! X and Z are nobody's at both places: they carry neither arguments nor results. Registers are pushed from an even one
//! up without gaps, so a few are pushed in vain; not where arguments lie on the stack, above what is pushed. The way back
//! has 16 bits: the image stays within 128 KB.

use std::collections::BTreeSet;

use super::assembly::{Function, Instruction, Line, Program};
use super::stack_arguments::Shift;

/// Pushes that a common beginning must replace to be worth it: it takes four instructions.
const WORTH: usize = 5;
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

/// How a function begins and ends.
#[derive(Clone, Debug, PartialEq)]
struct Frame {
    /// Registers pushed below r28.
    pushed: Vec<u8>,
    /// Whether r28 and r29 are, and Y points to the stack.
    y: bool,
    /// Bytes of variables.
    bytes: i32,
    /// Lines of the beginning.
    lines: usize,
    /// Lines of each end, from where they begin.
    ends: Vec<(usize, usize, Kind)>,
}

/// What an end does beside taking registers from the stack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Kind {
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
fn moved(line: Option<&Line>, name: &str) -> Option<u8> {
    let instruction = line
        .and_then(Line::instruction)
        .filter(|instruction| instruction.name == name)?;
    instruction.operand(0).strip_prefix('r')?.parse().ok()
}

impl Frame {
    /// Reads how a function begins and ends; `None` where it is otherwise.
    fn read(function: &Function) -> Option<Self> {
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
        let pushes = self.pushed.len() + if self.y { 2 } else { 0 };
        let makes_room = if self.bytes > 0 { 5 } else { 0 };
        let plain = !self.y || (1..=LARGEST).contains(&self.bytes);
        plain && pushes + makes_room >= WORTH
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
    for (number, function) in program.functions.iter_mut().enumerate() {
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
        rewrite(function, &frame, begins, number, &mut enters, &mut leaves);
    }
    program.functions.extend(leaves.into_iter().map(leave));
    for y in [false, true] {
        let firsts: Vec<u8> = enters
            .iter()
            .filter(|(kind, _)| *kind == y)
            .map(|(_, first)| *first)
            .collect();
        if let Some(&first) = firsts.first() {
            program.functions.push(enter(y, first));
        }
    }
}

fn rewrite(
    function: &mut Function,
    frame: &Frame,
    begins: bool,
    number: usize,
    enters: &mut BTreeSet<(bool, u8)>,
    leaves: &mut BTreeSet<(Kind, u8)>,
) {
    let first = frame.first();
    let mut lines = Vec::with_capacity(function.lines.len());
    if begins {
        let body = format!(".Lbody_{number}");
        if frame.y {
            lines.push(Line::Do(Instruction::new(
                "ldi",
                &["r26", &frame.bytes.to_string()],
            )));
        }
        let [low, high] = ["lo8", "hi8"].map(|part| format!("{part}(pm({body}))"));
        lines.push(Line::Do(Instruction::new("ldi", &["r30", &low])));
        lines.push(Line::Do(Instruction::new("ldi", &["r31", &high])));
        lines.push(Line::Do(Instruction::new(
            "jmp",
            &[&enter_label(frame.y, first)],
        )));
        lines.push(Line::Label(body));
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

fn enter_label(y: bool, first: u8) -> String {
    format!("rumbo_enter_{}{first}", if y { "frame_" } else { "" })
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

/// The common beginning: pushes from a register on, with a label for each that one may begin at.
fn enter(y: bool, first: u8) -> Function {
    let mut lines = Vec::new();
    for register in first..18 {
        if register % 2 == 0 && register != first {
            lines.push(Line::Label(enter_label(y, register)));
        }
        lines.push(Line::Do(Instruction::new(
            "push",
            &[&format!("r{register}")],
        )));
    }
    if y {
        if first < 18 {
            lines.push(Line::Label(enter_label(y, 18)));
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
    Function::new(enter_label(y, first), lines)
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
