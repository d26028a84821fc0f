//! Repairs how functions reach arguments that their caller left on the stack.
//!
//! LLVM 22 takes a return address for two bytes. On this chip it has three, and so a function without room for all
//! its arguments in registers reads the rest one byte too low (rust-lang/rust#149223 shows what comes of it). The
//! instructions are these, in functions whose prologue pushes `pushes` registers and makes a frame of `frame` bytes:
//!
//! - `ldd r, Y+q` and `std Y+q, r` with q at least `frame + pushes + 3`, where the return address still is;
//! - the same farther away, with Y moved there and back around it by `adiw`/`sbiw` or `subi`, `sbci`.
//!
//! All of them become one byte larger, in place. Whoever meets something else stops: a wrong image is worse than none.

use super::assembly::{Function, Instruction, Line};

/// What arguments lie above: the return address, and the byte that the stack pointer points at.
const RETURN_ADDRESS: i32 = 3 + 1;
/// Largest displacement of one instruction.
pub(super) const FARTHEST: i32 = 63;

/// A change of Y: in which line, by how much Y goes up, and in how many instructions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shift {
    at: usize,
    pub(super) by: i32,
    pub(super) lines: usize,
}

impl Shift {
    /// Reads a change of Y that begins at a line.
    pub(super) fn read(lines: &[Line], at: usize) -> Result<Option<Self>, String> {
        let Some(first) = lines.get(at).and_then(Line::instruction) else {
            return Ok(None);
        };
        let whole = |instruction: &Instruction| {
            let number = instruction.operand(1).parse::<i32>();
            number.map_err(|_| format!("`{instruction}`: by how much?"))
        };
        let (by, length) = match (first.name.as_str(), first.operand(0)) {
            ("adiw", "r28") => (whole(first)?, 1),
            ("sbiw", "r28") => (-whole(first)?, 1),
            ("subi", "r28") => {
                let second = lines.get(at + 1).and_then(Line::instruction);
                let second = second.filter(|next| next.name == "sbci" && next.operand(0) == "r29");
                let second = second.ok_or_else(|| format!("`{first}` without `sbci r29`"))?;
                let [low, high] = [whole(first)? as u8, whole(second)? as u8];
                (-i32::from(i16::from_le_bytes([low, high])), 2)
            }
            _ => return Ok(None),
        };
        Ok(Some(Self {
            at,
            by,
            lines: length,
        }))
    }

    /// The same change, one byte larger.
    fn grow(self, lines: &mut [Line]) -> Result<(), String> {
        let by = self.by + self.by.signum();
        if self.lines == 2 {
            let [low, high] = ((-by) as i16).to_le_bytes();
            lines[self.at] = Line::Do(Instruction::new("subi", &["r28", &low.to_string()]));
            lines[self.at + 1] = Line::Do(Instruction::new("sbci", &["r29", &high.to_string()]));
            return Ok(());
        }
        if by.abs() > FARTHEST {
            return Err(format!("no room to move Y by {by}"));
        }
        let name = if by > 0 { "adiw" } else { "sbiw" };
        lines[self.at] = Line::Do(Instruction::new(name, &["r28", &by.abs().to_string()]));
        Ok(())
    }
}

/// Which operand of an instruction is at Y + q, and q.
pub(super) fn access(instruction: &Instruction) -> Option<(usize, i32)> {
    let place = match instruction.name.as_str() {
        "ldd" | "ld" => 1,
        "std" | "st" => 0,
        _ => return None,
    };
    let operand = instruction.operand(place);
    let q = if operand == "Y" {
        Some(0)
    } else {
        operand.strip_prefix("Y+").and_then(|q| q.parse().ok())
    };
    q.map(|q| (place, q))
}

/// An access to a byte farther up.
fn raise(line: &mut Line) {
    if let Line::Do(instruction) = line
        && let Some((place, q)) = access(instruction)
    {
        instruction.operands[place] = format!("Y+{}", q + 1);
        // At zero it is written without a displacement.
        for (short, long) in [("ld", "ldd"), ("st", "std")] {
            if instruction.name == short {
                instruction.name = long.to_owned();
            }
        }
    }
}

/// Says how often a function reaches for arguments on the stack, and repairs that if it is `wrong`.
pub(super) fn repair(function: &mut Function, wrong: bool) -> Result<usize, String> {
    let lines = &mut function.lines;
    let is = |line: Option<&Line>, name: &str, operands: &[&str]| {
        line.and_then(Line::instruction)
            .is_some_and(|instruction| instruction.is(name, operands))
    };
    let pushes = lines
        .iter()
        .take_while(|line| line.instruction().is_some_and(|it| it.name == "push"))
        .count();
    if !is(lines.get(pushes), "in", &["r28", "61"])
        || !is(lines.get(pushes + 1), "in", &["r29", "62"])
    {
        return Ok(0);
    }
    let mut at = pushes + 2;
    let mut frame = 0;
    if let Some(shift) = Shift::read(lines, at)?.filter(|shift| shift.by < 0) {
        frame = -shift.by;
        at += shift.lines;
        // The stack pointer follows; that is no epilogue.
        while at < lines.len() && !is(lines.get(at), "out", &["61", "r28"]) {
            at += 1;
        }
        at += 1;
    }
    let first = frame + pushes as i32 + RETURN_ADDRESS - i32::from(wrong);
    let mut repaired = 0;
    let mut open: Option<Shift> = None;
    let mut inside: Vec<usize> = Vec::new();
    while at < lines.len() {
        let access = lines[at].instruction().and_then(access);
        if let Some((_, q)) = access {
            if open.is_some() {
                inside.push(at);
            } else if q >= first {
                if wrong && q == FARTHEST {
                    return Err(format!("no room to reach beyond Y+{q}"));
                }
                if wrong {
                    raise(&mut lines[at]);
                }
                repaired += 1;
            }
        } else if is(lines.get(at), "out", &["61", "r28"]) {
            (open, inside) = (None, Vec::new());
        } else if let Some(shift) = Shift::read(lines, at)? {
            if let Some(opening) = open.take() {
                if opening.by + shift.by != 0 {
                    return Err(format!("Y moves by {} and by {}", opening.by, shift.by));
                }
                repaired += repair_far(lines, opening, shift, &inside, first, wrong)?;
                inside.clear();
            } else {
                open = Some(shift);
            }
            at += shift.lines - 1;
        }
        at += 1;
    }
    Ok(repaired)
}

/// Accesses between two moves of Y.
fn repair_far(
    lines: &mut [Line],
    there: Shift,
    back: Shift,
    accesses: &[usize],
    first: i32,
    wrong: bool,
) -> Result<usize, String> {
    let displacement = |line: &Line| line.instruction().and_then(access).map_or(0, |(_, q)| q);
    let beyond = accesses
        .iter()
        .filter(|at| there.by + displacement(&lines[**at]) >= first)
        .count();
    if beyond == 0 || !wrong && beyond == accesses.len() {
        return Ok(beyond);
    }
    if beyond != accesses.len() {
        return Err("an access across the border of the frame".to_owned());
    }
    if accesses
        .iter()
        .all(|at| displacement(&lines[*at]) < FARTHEST)
    {
        for at in accesses {
            raise(&mut lines[*at]);
        }
    } else {
        there.grow(lines)?;
        back.grow(lines)?;
    }
    Ok(beyond)
}
