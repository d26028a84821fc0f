//! What functions end in.
//!
//! A function that ends in calling another jumps there instead, and lets that return in its place; one that does nothing else is
//! another name of it. Two that do the same are one. And what a function jumps to at its end follows it where that can be.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::assembly::{Flow, Function, Line};
use super::frames;

/// `call a; ret` is `jmp a`, if `a` finds no arguments on the stack.
pub(super) fn jump(function: &mut Function, stack_arguments: &HashSet<String>) {
    if function.is_handler() {
        return;
    }
    let mut at = 0;
    while at + 1 < function.lines.len() {
        let returns = function.lines[at + 1]
            .instruction()
            .is_some_and(|it| it.name == "ret");
        if let Line::Do(it) = &mut function.lines[at]
            && it.flow() == Flow::Call
            && returns
            && !stack_arguments.contains(it.operand(0))
            && !it.operand(0).starts_with(frames::ENTER)
        {
            "jmp".clone_into(&mut it.name);
            function.lines.remove(at + 1);
        }
        at += 1;
    }
}

/// Where a function only goes to another.
fn onward(function: &Function) -> Option<&str> {
    match function.lines.as_slice() {
        [Line::Do(it)] if it.flow() == Flow::Jump => it.target(),
        _ => None,
    }
}

/// Makes functions that do the same one with several names, until all differ.
pub(super) fn merge(functions: &mut Vec<Function>) {
    loop {
        let mut first: HashMap<Vec<String>, usize> = HashMap::new();
        let by_name: HashMap<&str, usize> = functions
            .iter()
            .enumerate()
            .flat_map(|(place, function)| {
                function
                    .names
                    .iter()
                    .map(move |name| (name.as_str(), place))
            })
            .collect();
        let mut same: BTreeMap<usize, usize> = BTreeMap::new();
        for (place, function) in functions.iter().enumerate() {
            if function.is_handler() {
                continue;
            }
            let other = match onward(function).and_then(|name| by_name.get(name)) {
                Some(&other) => Some(other),
                None => first.insert(shape(function), place),
            };
            // One at a time: what it leads to may itself go.
            if let Some(other) = other.filter(|&other| other != place && !same.contains_key(&other))
            {
                first.insert(shape(&functions[other]), other);
                if !same.values().any(|it| *it == place) {
                    same.insert(place, other);
                }
            }
        }
        if same.is_empty() {
            return;
        }
        let mut to: HashMap<String, String> = HashMap::new();
        for (&place, &other) in &same {
            let name = functions[other].name().to_owned();
            let names = std::mem::take(&mut functions[place].names);
            to.extend(names.iter().map(|old| (old.clone(), name.clone())));
            functions[other].names.extend(names);
        }
        functions.retain(|function| !function.names.is_empty());
        for line in functions
            .iter_mut()
            .flat_map(|function| &mut function.lines)
        {
            if let Line::Do(it) = line
                && let Some(name) = it.target().and_then(|target| to.get(target))
            {
                it.operands[0].clone_from(name);
            }
        }
    }
}

/// What a function does, whatever its labels are called.
fn shape(function: &Function) -> Vec<String> {
    let labels: HashMap<&str, usize> = function
        .lines
        .iter()
        .enumerate()
        .filter_map(|(at, line)| match line {
            Line::Label(label) => Some((label.as_str(), at)),
            Line::Do(_) => None,
        })
        .collect();
    function
        .lines
        .iter()
        .map(|line| match line {
            Line::Label(label) => format!("{}:", labels[label.as_str()]),
            Line::Do(it) => match it.target().and_then(|target| labels.get(target)) {
                Some(at) => format!("{} {at}", it.name),
                None => it.to_string(),
            },
        })
        .collect()
}

/// Puts what a function jumps to at its end behind it, and leaves out the jump.
pub(super) fn follow(region: &mut Vec<Function>) {
    let place: HashMap<String, usize> = region
        .iter()
        .enumerate()
        .flat_map(|(place, function)| function.names.iter().map(move |name| (name.clone(), place)))
        .collect();
    let mut next: Vec<Option<usize>> = vec![None; region.len()];
    let mut is_next = vec![false; region.len()];
    for at in 0..region.len() {
        let target = match region[at].lines.last() {
            Some(Line::Do(it)) if it.flow() == Flow::Jump && !region[at].is_handler() => {
                it.target()
            }
            _ => None,
        };
        let Some(&target) = target.and_then(|target| place.get(target)) else {
            continue;
        };
        let in_circle = std::iter::successors(Some(target), |at| next[*at]).any(|it| it == at);
        if !in_circle && !is_next[target] {
            next[at] = Some(target);
            is_next[target] = true;
        }
    }
    let mut old: Vec<Option<Function>> = std::mem::take(region).into_iter().map(Some).collect();
    // A chain stands where its last stood.
    let mut first: Vec<usize> = (0..old.len()).collect();
    for start in (0..old.len()).filter(|start| !is_next[*start]) {
        let last = std::iter::successors(Some(start), |at| next[*at])
            .last()
            .unwrap_or(start);
        first[last] = start;
    }
    for last in (0..old.len()).filter(|last| next[*last].is_none()) {
        for at in std::iter::successors(Some(first[last]), |at| next[*at]) {
            if let Some(mut function) = old[at].take() {
                if next[at].is_some() {
                    function.lines.pop();
                }
                region.push(function);
            }
        }
    }
}
