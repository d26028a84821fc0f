//! Jumps that another way does without.
//!
//! The compiler jumps around a jump when it cannot know how far a branch will have to reach, and leaves labels that nothing
//! goes to. The layout decides about reach; here each branch goes where it wants.

use std::collections::{HashMap, HashSet};

use super::assembly::{Flow, Function, Instruction, Line};
use super::layout::opposite;

/// Simplifies a function until there is nothing left to do.
pub(super) fn simplify(function: &mut Function) {
    if function.is_handler() {
        return;
    }
    loop {
        let before = function.lines.len();
        thread(function);
        around(function);
        unreachable(function);
        unused(function);
        if function.lines.len() == before {
            break;
        }
    }
}

/// What goes to a jump goes to where that goes.
fn thread(function: &mut Function) {
    let mut onward: HashMap<String, String> = HashMap::new();
    for (at, line) in function.lines.iter().enumerate() {
        if let Line::Label(label) = line {
            let next = function.lines[at..].iter().find_map(Line::instruction);
            if let Some(next) =
                next.filter(|next| next.flow() == Flow::Jump && next.operand(0) != label)
            {
                onward.insert(label.clone(), next.operand(0).to_owned());
            }
        }
    }
    for line in &mut function.lines {
        if let Line::Do(instruction) = line
            && matches!(instruction.flow(), Flow::Branch | Flow::Jump)
        {
            // Two jumps in a circle go on for ever.
            for _ in 0..8 {
                match onward.get(instruction.operand(0)) {
                    Some(target) => instruction.operands[0].clone_from(target),
                    None => break,
                }
            }
        }
    }
}

/// `branch a; jump b; a:` is `opposite b; a:`, and a jump to what follows is none.
fn around(function: &mut Function) {
    let mut lines: Vec<Line> = Vec::with_capacity(function.lines.len());
    let old = std::mem::take(&mut function.lines);
    let mut at = 0;
    while at < old.len() {
        let follows = |from: usize, label: &str| {
            let mut labels = old[from..].iter().map_while(|line| match line {
                Line::Label(label) => Some(label),
                Line::Do(_) => None,
            });
            labels.any(|found| found == label)
        };
        if let Line::Do(first) = &old[at] {
            let target = first.operand(0);
            if first.flow() == Flow::Branch
                && let Some(Line::Do(second)) = old.get(at + 1)
                && second.flow() == Flow::Jump
                && follows(at + 2, target)
                && let Ok(name) = opposite(&first.name)
            {
                lines.push(Line::Do(Instruction::new(name, &[second.operand(0)])));
                at += 2;
                continue;
            }
            if matches!(first.flow(), Flow::Jump | Flow::Branch) && follows(at + 1, target) {
                at += 1;
                continue;
            }
        }
        lines.push(old[at].clone());
        at += 1;
    }
    function.lines = lines;
}

/// What follows a jump, up to a label, is never reached.
fn unreachable(function: &mut Function) {
    let mut dead = false;
    function.lines.retain(|line| match line {
        Line::Label(_) => {
            dead = false;
            true
        }
        Line::Do(instruction) => {
            let keep = !dead;
            dead |= instruction.ends();
            keep
        }
    });
}

/// Labels that nothing goes to.
fn unused(function: &mut Function) {
    // A label may be named in an operand that is an address, too.
    let used: HashSet<String> = function
        .instructions()
        .flat_map(|it| it.operands.iter())
        .map(|operand| {
            let start = operand.find(".L").unwrap_or(operand.len());
            operand[start..].trim_end_matches(')').to_owned()
        })
        .collect();
    function.lines.retain(|line| match line {
        Line::Label(label) => used.contains(label),
        Line::Do(_) => true,
    });
}
