//! Where the cycles go: by function as folded stacks, and by interrupt.
//!
//! # Theory of operation
//!
//! A tree has a node for each chain of calls; the cycles of an instruction go to the node of the code that runs. A call goes
//! down, and remembers the stack pointer before it. A return goes up as far as the stack has: so a program that drops frames
//! (`longjmp`, a scheduler) loses no more than the chain it left. A jump to another function takes the place of the one that
//! jumped. Interrupts are separate roots, since they interrupt whatever is running; so are sleep and `main`.

mod summary;

use super::Moment;
use crate::cpu::{Cpu, Turn};
use crate::decode::{Code, FLASH_WORDS};
use crate::image::Image;
use crate::model::Model;
use std::collections::HashMap;

/// Deepest chain of calls that is followed.
const DEEPEST: usize = 512;
/// A function's number where the image has none.
const UNKNOWN: u16 = 0;
/// The root of the tree.
const ROOT: usize = 0;

/// Cycles by function and interrupt.
#[derive(Clone, Debug)]
pub struct Profile {
    pub(super) model: &'static Model,
    names: Vec<String>,
    calls: Vec<u64>,
    /// Number of the function at each word.
    function_at: Vec<u16>,
    /// Functions without symbols, by address.
    unnamed: HashMap<u32, u16>,
    has_symbols: bool,
    nodes: Vec<Node>,
    frames: Vec<Frame>,
    /// The node of what runs now.
    here: usize,
    asleep: u16,
    main: Option<u16>,
    interrupts: Vec<InterruptUse>,
    /// Cycles of the last entry of each, and of the end of its routine.
    served: Vec<(u64, u64)>,
    start: Option<u64>,
    end: u64,
}

#[derive(Clone, Debug)]
struct Node {
    function: u16,
    parent: usize,
    children: Vec<usize>,
    cycles: u64,
    /// It stands for an interrupt: its routine is below it.
    interrupt: bool,
}

/// A call or an interrupt that has not returned.
#[derive(Clone, Copy, Debug)]
struct Frame {
    stack_pointer: u16,
    caller: usize,
    /// Vector and the cycle of its entry.
    interrupt: Option<(u8, u64)>,
}

/// What an interrupt cost. Times are in cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InterruptUse {
    /// Its vector.
    pub vector: u8,
    /// How often its routine was entered.
    pub count: u64,
    /// From the entry, its 5 cycles included, to the end of RETI, all together; with the interrupts within.
    pub total: u64,
    /// The longest of them.
    pub longest: u64,
    /// The longest time from the request (flag raised and enabled) to the first instruction at the vector.
    pub worst_latency: u64,
}

impl InterruptUse {
    /// The mean of one time; 0 before the first has ended.
    #[must_use]
    pub fn mean(&self) -> u64 {
        self.total.checked_div(self.count).unwrap_or(0)
    }
}

/// What a function cost, cycles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FunctionUse {
    /// Its name.
    pub name: String,
    /// How often it was called.
    pub calls: u64,
    /// In itself.
    pub own: u64,
    /// With all that it calls.
    pub total: u64,
}

impl Profile {
    /// A profile of this image; names come from its symbols, else functions are called after their addresses.
    pub fn new(image: &Image) -> Profile {
        let mut profile = Profile {
            model: image.model(),
            names: vec!["(unknown)".to_owned()],
            calls: vec![0],
            function_at: vec![UNKNOWN; FLASH_WORDS],
            unnamed: HashMap::new(),
            has_symbols: !image.functions().is_empty(),
            nodes: Vec::new(),
            frames: Vec::new(),
            here: ROOT,
            asleep: UNKNOWN,
            main: None,
            interrupts: Vec::new(),
            served: Vec::new(),
            start: None,
            end: 0,
        };
        profile.nodes.push(Node {
            function: UNKNOWN,
            parent: ROOT,
            children: Vec::new(),
            cycles: 0,
            interrupt: false,
        });
        profile.asleep = profile.named("(asleep)".to_owned());
        let functions = image.functions();
        for (index, function) in functions.iter().enumerate() {
            let end = match functions.get(index + 1) {
                Some(next) => next.address as usize,
                None => image.flash().len().div_ceil(2),
            };
            let number = profile.named(function.name.clone());
            if function.name == "main" {
                profile.main = Some(number);
            }
            // The table of vectors belongs to the interrupts.
            let start = (function.address as usize).max(2 * profile.model.vectors.len());
            if let Some(words) = profile.function_at.get_mut(start..end) {
                words.fill(number);
            }
        }
        profile
    }

    fn named(&mut self, name: String) -> u16 {
        self.names.push(name);
        self.calls.push(0);
        u16::try_from(self.names.len() - 1).unwrap_or(UNKNOWN)
    }

    /// An instruction, sleep, or the entry of an interrupt has passed.
    pub(super) fn note(
        &mut self,
        cpu: &Cpu,
        before: &Moment,
        turn: Turn,
        requested: impl Fn(u8) -> u64,
    ) {
        self.start.get_or_insert(before.cycle);
        self.end = cpu.cycle();
        let cycles = cpu.cycle() - before.cycle;
        match turn {
            Turn::Slept => {
                let node = self.child(ROOT, self.asleep);
                self.nodes[node].cycles += cycles;
            }
            Turn::Held => self.nodes[self.here].cycles += cycles,
            Turn::Entered(vector) => self.enter(cpu, before, vector, requested(vector)),
            Turn::Ran | Turn::Breakpoint | Turn::Noticed => {
                self.find(before.program_counter);
                self.nodes[self.here].cycles += cycles;
                self.follow(cpu, before);
            }
        }
    }

    /// The code at `word` runs: a jump may have led to another function.
    fn find(&mut self, word: u32) {
        let function = self.function_at[word as usize % FLASH_WORDS];
        let Node {
            function: now,
            parent,
            interrupt,
            ..
        } = self.nodes[self.here];
        if function == UNKNOWN || function == now {
            return;
        }
        // Below the interrupt that led here; in place of the function that jumped.
        let above = if interrupt || self.here == ROOT {
            self.here
        } else {
            parent
        };
        self.here = self.child(above, function);
    }

    fn follow(&mut self, cpu: &Cpu, before: &Moment) {
        match before.operation.code {
            Code::Call | Code::Rcall | Code::Icall | Code::Eicall => {
                // `rcall .` makes room on the stack and calls nothing.
                let next = before.program_counter + 1;
                if cpu.program_counter() != next {
                    self.call(cpu.program_counter(), before);
                }
            }
            Code::Ret | Code::Reti | Code::Ijmp | Code::Eijmp => {
                self.unwind(cpu.stack_pointer(), cpu.cycle());
            }
            _ => {}
        }
    }

    fn call(&mut self, target: u32, before: &Moment) {
        self.unwind(before.stack_pointer, before.cycle);
        let function = self.function(target);
        self.push(before.stack_pointer, None);
        let before_target = target.wrapping_sub(1) as usize % FLASH_WORDS;
        let inside = function != UNKNOWN && self.function_at[before_target] == function;
        if inside && self.nodes[self.here].function == function {
            // A piece of itself that a function written in assembly calls.
            return;
        }
        self.calls[usize::from(function)] += 1;
        let above = if Some(function) == self.main {
            ROOT
        } else {
            self.here
        };
        self.here = self.child(above, function);
    }

    fn enter(&mut self, cpu: &Cpu, before: &Moment, vector: u8, requested: u64) {
        let index = self.interrupt(vector);
        // A request that has stood since before the last entry is a level that lasts: it waits from the routine's end on.
        let since = match self.served[index] {
            (entry, end) if requested <= entry => end,
            _ => requested,
        };
        self.served[index].0 = before.cycle;
        let latency = cpu.cycle().saturating_sub(since);
        let interrupt = &mut self.interrupts[index];
        interrupt.count += 1;
        interrupt.worst_latency = interrupt.worst_latency.max(latency);
        self.push(before.stack_pointer, Some((vector, before.cycle)));
        let name = format!("interrupt {}", self.model.vector_name(vector));
        let known = self.nodes[ROOT].children.iter().copied().find(|child| {
            let node = &self.nodes[*child];
            node.interrupt && self.names[usize::from(node.function)] == name
        });
        self.here = match known {
            Some(node) => node,
            None => {
                let function = self.named(name);
                let node = self.child(ROOT, function);
                self.nodes[node].interrupt = true;
                node
            }
        };
        self.nodes[self.here].cycles += cpu.cycle() - before.cycle;
    }

    fn interrupt(&mut self, vector: u8) -> usize {
        let found = self
            .interrupts
            .iter()
            .position(|known| known.vector == vector);
        found.unwrap_or_else(|| {
            self.interrupts.push(InterruptUse {
                vector,
                count: 0,
                total: 0,
                longest: 0,
                worst_latency: 0,
            });
            self.served.push((0, 0));
            self.interrupts.len() - 1
        })
    }

    fn push(&mut self, stack_pointer: u16, interrupt: Option<(u8, u64)>) {
        if self.frames.len() < DEEPEST {
            self.frames.push(Frame {
                stack_pointer,
                caller: self.here,
                interrupt,
            });
        }
    }

    /// Leaves all calls whose frames the stack has given up.
    fn unwind(&mut self, stack_pointer: u16, cycle: u64) {
        while let Some(frame) = self
            .frames
            .pop_if(|frame| frame.stack_pointer <= stack_pointer)
        {
            self.here = frame.caller;
            if let Some((vector, start)) = frame.interrupt {
                let index = self.interrupt(vector);
                let interrupt = &mut self.interrupts[index];
                interrupt.total += cycle - start;
                interrupt.longest = interrupt.longest.max(cycle - start);
                self.served[index].1 = cycle;
            }
        }
    }

    /// The function that starts at, or contains, a word.
    fn function(&mut self, word: u32) -> u16 {
        let known = self.function_at[word as usize % FLASH_WORDS];
        if known != UNKNOWN || self.has_symbols {
            return known;
        }
        if let Some(known) = self.unnamed.get(&word) {
            return *known;
        }
        let number = self.named(format!("0x{:05x}", 2 * word));
        self.unnamed.insert(word, number);
        number
    }

    fn child(&mut self, parent: usize, function: u16) -> usize {
        let known = self.nodes[parent].children.iter().copied();
        if let Some(node) = known
            .into_iter()
            .find(|child| self.nodes[*child].function == function)
        {
            return node;
        }
        let node = self.nodes.len();
        self.nodes.push(Node {
            function,
            parent,
            children: Vec::new(),
            cycles: 0,
            interrupt: false,
        });
        self.nodes[parent].children.push(node);
        node
    }

    /// Functions from the root to a node.
    fn chain(&self, node: usize) -> Vec<u16> {
        let mut chain = Vec::new();
        let mut at = node;
        while at != ROOT {
            chain.push(self.nodes[at].function);
            at = self.nodes[at].parent;
        }
        chain.reverse();
        chain
    }

    fn name(&self, function: u16) -> &str {
        &self.names[usize::from(function)]
    }
}
