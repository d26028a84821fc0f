//! Copies that need not be.
//!
//! Where both sides of a copy can be in one register, none is needed. The compiler gives registers to the values of one function before it knows
//! what its own repairs leave of them, and keeps many copies. One side changes places with what is in the register of the other ([`super::webs`]);
//! then the two stay together.

use super::assembly::{Function, Program};
use super::effects::{Set, pair};
use super::frames::Frame;
use super::liveness::Whole;
use super::webs::{Copy, Webs};

/// Leaves out what copies of all functions but interrupts' can be spared.
pub(super) fn leave_out(program: &mut Program) -> Result<(), String> {
    let whole = Whole::of(program)?;
    for function in program.functions.iter_mut().filter(|it| !it.is_handler()) {
        let Some(may) = may(function, &whole) else {
            continue;
        };
        let mut webs = Webs::read(function, &whole.about(function)?, may);
        for copy in webs.copies.clone() {
            if !copy.iter().any(|&(to, from)| webs.meets(to, from)) {
                unite(&mut webs, &copy);
            }
        }
        webs.write(function);
    }
    Ok(())
}

/// Registers that a function may write as it is: what it saves, and what it may write already, so that for its callers nothing changes. `None`
/// where it begins or ends in a way that is not known.
fn may(function: &Function, whole: &Whole) -> Option<Set> {
    let frame = Frame::read(function)?;
    let free = whole.call(function.name()).writes & Set::FREE;
    let saved = frame.pushed.iter().map(|number| Set::register(*number));
    let may = saved.fold(free | function.lost, |all, register| all | register);
    Some(may.without(pair(0) | pair(28)))
}

/// Brings both sides of a copy into one register, if that can be.
fn unite(webs: &mut Webs, copy: &Copy) {
    let is_one = |webs: &Webs| {
        let mut halves = copy.iter();
        halves.all(|&(to, from)| webs.register[to] == webs.register[from])
    };
    let ways = copy.first().map(|&(to, from)| [(from, to), (to, from)]);
    for (moved, stays) in ways.into_iter().flatten() {
        if !is_one(webs)
            && let Some(chain) = webs.go(moved, webs.register[stays])
            && !is_one(webs)
        {
            webs.back(&chain);
        }
    }
    if is_one(webs) {
        copy.iter().for_each(|&(to, from)| webs.tie(to, from));
    }
}
