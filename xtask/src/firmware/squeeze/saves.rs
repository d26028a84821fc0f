//! Registers that are saved for nobody.
//!
//! A function gives back the registers r2 to r17 as it found them, by the convention. Where none of its callers has anything in
//! one when it calls, nor theirs, saving it is in vain.

use std::collections::HashSet;

use super::assembly::{Function, Program};
use super::effects::Set;
use super::frames::{Frame, moved};
use super::liveness::Whole;

/// Leaves out what is saved in vain. Functions with arguments on the stack keep all: these lie above what is saved.
pub(super) fn drop_vain(
    program: &mut Program,
    has_stack_arguments: &HashSet<String>,
) -> Result<(), String> {
    // One after the other: a caller that saves what it does not change itself may do that for a function which it calls, so a function
    // may leave to its callers only what these still save then.
    for why in [Why::Unchanged, Why::Unwanted] {
        let whole = Whole::of(program)?;
        for function in &mut program.functions {
            if !function.is_handler() && !has_stack_arguments.contains(function.name()) {
                drop_of(function, &whole, why)?;
            }
        }
    }
    Ok(())
}

/// Why saving a register is in vain.
#[derive(Clone, Copy)]
enum Why {
    /// Neither the function nor what it calls changes it.
    Unchanged,
    /// No caller has anything in it.
    Unwanted,
}

fn drop_of(function: &mut Function, whole: &Whole, why: Why) -> Result<(), String> {
    let Some(frame) = Frame::read(function) else {
        return Ok(());
    };
    let mut at = 0;
    let saves = |at: usize| {
        at < frame.pushed.len()
            || frame
                .ends
                .iter()
                .any(|(from, to, _)| (*from..*to).contains(&at))
    };
    let effects = whole.about(function)?.effects.into_iter().enumerate();
    let changed = effects
        .filter(|(at, _)| !saves(*at))
        .fold(Set::NONE, |all, (_, effect)| all | effect.writes);
    let needed = match why {
        Why::Unchanged => changed,
        Why::Unwanted => whole.wanted(function),
    };
    let vain = frame.pushed.iter().map(|number| Set::register(*number));
    let vain = vain
        .filter(|register| !needed.has(*register))
        .fold(Set::NONE, |all, register| all | register);
    function.lines.retain(|line| {
        let number = moved(Some(line), "push").or(moved(Some(line), "pop"));
        let keep = !saves(at) || number.is_none_or(|number| !vain.has(Set::register(number)));
        at += 1;
        keep
    });
    function.lost |= vain & changed;
    Ok(())
}
