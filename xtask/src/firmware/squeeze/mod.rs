//! Makes the program smaller, in its assembly.
//!
//! The compiler writes each function as if it were alone. Here all are known, and so is what each reads and changes ([`liveness`]). What
//! they do in vain is left out ([`branches`], [`saves`], [`shifts`], [`values`], [`copies`]), what they have in common is written once ([`frames`],
//! [`tails`], [`repeats`]), and everything is put where short jumps reach it ([`order`], [`islands`], [`layout`]). Before that, arguments on
//! the stack are repaired if the compiler needs it ([`stack_arguments`]).
//! What is not understood is refused: a wrong image is worse than none.

mod assembly;
mod branches;
mod copies;
mod debugging;
mod effects;
mod frames;
mod graph;
mod heat;
mod islands;
mod layout;
mod liveness;
mod operands;
mod order;
mod repeats;
mod saves;
mod shifts;
mod stack_arguments;
mod tails;
#[cfg(test)]
mod tests;
mod values;
mod webs;

use std::collections::HashSet;

use assembly::{Function, Program};
use heat::Heat;
use liveness::Whole;

/// What to do, and for whom.
pub(crate) struct Options<'a> {
    /// Whether the compiler reads arguments on the stack one byte too low.
    pub(crate) repair: bool,
    /// Parts of the names of functions in which cycles count,
    pub(crate) hot: &'a [String],
    /// and of those in which they count less.
    pub(crate) warm: &'a [String],
}

impl Options<'_> {
    fn is_hot(&self, function: &Function) -> bool {
        function.is_handler()
            || self
                .hot
                .iter()
                .any(|part| function.name().contains(part.as_str()))
    }
}

/// The program, smaller.
#[derive(Debug)]
pub(crate) struct Squeezed {
    pub(crate) assembly: String,
    /// Accesses to arguments on the stack that were wrong.
    pub(crate) repaired: usize,
}

/// Makes the program smaller.
pub(crate) fn squeeze(text: &str, options: &Options<'_>) -> Result<Squeezed, String> {
    let mut program = Program::parse(text)?;
    let mut repaired = 0;
    let mut has_stack_arguments = HashSet::new();
    for function in &mut program.functions {
        let count = stack_arguments::repair(function, options.repair)
            .map_err(|error| format!("{}: arguments on the stack: {error}", function.name()))?;
        if count > 0 {
            has_stack_arguments.insert(function.name().to_owned());
            repaired += if options.repair { count } else { 0 };
        }
        branches::simplify(function);
    }
    leave_out(&mut program, &has_stack_arguments)?;
    frames::share(
        &mut program,
        |function| has_stack_arguments.contains(function.name()),
        |function| options.is_hot(function),
    );
    share(&mut program, options, &has_stack_arguments);
    layout::arrange(&mut program, Function::is_handler)?;
    Ok(Squeezed {
        assembly: program.print(),
        repaired,
    })
}

/// What functions do in vain.
fn leave_out(program: &mut Program, has_stack_arguments: &HashSet<String>) -> Result<(), String> {
    saves::drop_vain(program, has_stack_arguments)?;
    let whole = Whole::of(program)?;
    for function in program.functions.iter_mut().filter(|it| !it.is_handler()) {
        shifts::gather(function, &whole)?;
    }
    let whole = Whole::of(program)?;
    for function in program.functions.iter_mut().filter(|it| !it.is_handler()) {
        values::simplify(function, &whole)?;
    }
    copies::leave_out(program)?;
    saves::drop_vain(program, has_stack_arguments)?;
    let whole = Whole::of(program)?;
    for function in &mut program.functions {
        shifts::spread(function, &whole)?;
    }
    Ok(())
}

/// What they have in common, beside how they begin and end.
fn share(program: &mut Program, options: &Options<'_>, has_stack_arguments: &HashSet<String>) {
    for function in &mut program.functions {
        tails::jump(function, has_stack_arguments);
    }
    tails::merge(&mut program.functions);
    let heat = Heat::of(&program.functions, |it| options.is_hot(it), options.warm);
    let least = |function: &Function| {
        let is_ours = ["rumbo_enter", "rumbo_leave"]
            .iter()
            .any(|name| function.name().starts_with(name));
        let stays = is_ours || function.is_handler() || repeats::touches_hardware(function);
        (!stays).then(|| heat.least_words(function))
    };
    let all = &mut program.functions;
    repeats::share(all, least, has_stack_arguments);
    tails::merge(all);
    tails::follow(all);
    order::order(all, Function::is_handler);
}
