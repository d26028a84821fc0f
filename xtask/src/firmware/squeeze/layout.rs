//! How far each jump and each call has to reach.
//!
//! `rcall` and `rjmp` take two bytes and reach 4 KB, `call` and `jmp` take four and reach everything. What lies farther away is reached by
//! way of an island where there is one ([`islands`]), a `jmp` to which many a `rcall` goes. It costs three cycles.
//!
//! All begin short; what does not reach becomes longer, until nothing changes.

use std::collections::HashMap;

use super::assembly::{Flow, Function, Instruction, Line, Program};
use super::islands::{self, Islands};

/// How a jump or a call is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reach {
    /// One word.
    Near,
    /// One word, to an island.
    Island,
    /// A conditional jump: over an `rjmp`. A jump or call: two words.
    Far,
    /// A conditional jump over a `jmp`.
    Farthest,
}

/// The branch that is taken when another is not.
pub(super) fn opposite(branch: &str) -> Result<&'static str, String> {
    const PAIRS: [(&str, &str); 7] = [
        ("breq", "brne"),
        ("brlo", "brsh"),
        ("brcs", "brcc"),
        ("brlt", "brge"),
        ("brmi", "brpl"),
        ("brts", "brtc"),
        ("brvs", "brvc"),
    ];
    let both = PAIRS
        .iter()
        .flat_map(|&(one, other)| [(one, other), (other, one)]);
    let mut found = both
        .filter(|(one, _)| *one == branch)
        .map(|(_, other)| other);
    found
        .next()
        .ok_or_else(|| format!("`{branch}` has no opposite here"))
}

/// Makes islands, and writes every jump and call as short as it can be. Those of `direct` functions make no way round.
pub(super) fn arrange(
    program: &mut Program,
    direct: impl Fn(&Function) -> bool,
) -> Result<(), String> {
    let islands = islands::make(&mut program.functions, &direct);
    let settled = Layout::new(&program.functions, &islands, &direct).settle();
    write(&mut program.functions, settled)
}

/// A place that a jump is to: a line of the program, counted through.
struct Jump<'a> {
    flow: Flow,
    target: &'a str,
    /// Those that lead there, and the nearest of them.
    islands: &'a [String],
    island: Option<&'a str>,
    reach: Reach,
}

/// How a jump is to be written.
struct Settled {
    reach: Reach,
    /// The label of the island that it goes to.
    island: Option<String>,
}

enum Item<'a> {
    /// Names of the next place.
    Label(&'a str),
    Words(usize),
    Jump(Jump<'a>),
}

struct Layout<'a> {
    items: Vec<Item<'a>>,
}

impl<'a> Layout<'a> {
    fn new(
        functions: &'a [Function],
        islands: &'a Islands,
        direct: &impl Fn(&Function) -> bool,
    ) -> Self {
        let mut items = Vec::new();
        for function in functions {
            let no_islands = direct(function) || function.name().starts_with("rumbo_island");
            items.extend(function.names.iter().map(|name| Item::Label(name)));
            for line in &function.lines {
                items.push(match line {
                    Line::Label(label) => Item::Label(label),
                    Line::Do(instruction) => match instruction.target() {
                        None => Item::Words(instruction.words()),
                        Some(target) => Item::Jump(Jump {
                            flow: instruction.flow(),
                            target,
                            islands: islands
                                .get(target)
                                .filter(|_| !no_islands)
                                .map_or(&[], Vec::as_slice),
                            island: None,
                            reach: Reach::Near,
                        }),
                    },
                });
            }
        }
        Self { items }
    }

    fn words(item: &Item<'_>) -> i64 {
        match item {
            Item::Label(_) => 0,
            Item::Words(words) => *words as i64,
            Item::Jump(jump) => match (jump.reach, jump.flow) {
                (Reach::Near | Reach::Island, _) => 1,
                (Reach::Farthest, _) => 3,
                (Reach::Far, _) => 2,
            },
        }
    }

    /// Makes longer what does not reach.
    fn settle(mut self) -> Vec<Settled> {
        loop {
            let mut addresses: HashMap<&str, i64> = HashMap::new();
            let mut address = 0;
            for item in &self.items {
                if let Item::Label(label) = item {
                    addresses.insert(label, address);
                }
                address += Self::words(item);
            }
            let mut changed = false;
            let mut address = 0;
            for item in &mut self.items {
                let here = address;
                address += Self::words(item);
                if let Item::Jump(jump) = item {
                    let distance = |target: &str, from: i64| {
                        addresses
                            .get(target)
                            .map_or(i64::MAX, |target| target - from - 1)
                    };
                    while !jump.reaches(here, &distance) {
                        jump.lengthen();
                        changed = true;
                    }
                }
            }
            if !changed {
                break;
            }
        }
        let jumps = self.items.into_iter().filter_map(|item| match item {
            Item::Jump(jump) => Some(Settled {
                reach: jump.reach,
                island: jump
                    .island
                    .filter(|_| jump.reach == Reach::Island)
                    .map(str::to_owned),
            }),
            Item::Label(_) | Item::Words(_) => None,
        });
        jumps.collect()
    }
}

impl Jump<'_> {
    fn reaches(&mut self, here: i64, distance: &impl Fn(&str, i64) -> i64) -> bool {
        let relative = |distance: i64| (-2_048..2_048).contains(&distance);
        match (self.flow, self.reach) {
            (Flow::Branch, Reach::Near) => (-64..64).contains(&distance(self.target, here)),
            (Flow::Branch, Reach::Far) => relative(distance(self.target, here + 1)),
            (_, Reach::Near) => relative(distance(self.target, here)),
            (_, Reach::Island) => {
                let near = |island: &&String| distance(island, here).saturating_abs();
                self.island = self.islands.iter().min_by_key(near).map(String::as_str);
                self.island
                    .is_some_and(|island| relative(distance(island, here)))
            }
            (_, Reach::Far | Reach::Farthest) => true,
        }
    }

    fn lengthen(&mut self) {
        self.reach = match (self.flow, self.reach) {
            (Flow::Branch, Reach::Near) | (_, Reach::Island) => Reach::Far,
            (Flow::Branch, _) => Reach::Farthest,
            (_, Reach::Near) => Reach::Island,
            (_, reach) => reach,
        };
    }
}

/// Writes jumps as they were settled.
fn write(functions: &mut [Function], settled: Vec<Settled>) -> Result<(), String> {
    let mut settled = settled.into_iter();
    let mut skips = 0;
    for function in functions {
        let mut lines = Vec::with_capacity(function.lines.len());
        for line in std::mem::take(&mut function.lines) {
            let jump = line
                .instruction()
                .filter(|instruction| instruction.target().is_some())
                .cloned();
            let Some(jump) = jump else {
                lines.push(line);
                continue;
            };
            let Settled { reach, island } = settled.next().ok_or("a jump that was not settled")?;
            let target = island.as_deref().unwrap_or(jump.operand(0));
            let near = matches!(reach, Reach::Near | Reach::Island);
            let name = match (jump.flow(), near) {
                (Flow::Call, true) => "rcall",
                (Flow::Call, false) => "call",
                (Flow::Branch, true) => &jump.name,
                (Flow::Branch, false) => {
                    let skip = format!(".Lskip_{skips}");
                    skips += 1;
                    let over = Line::Do(Instruction::new(opposite(&jump.name)?, &[&skip]));
                    let name = if reach == Reach::Far { "rjmp" } else { "jmp" };
                    lines.extend([
                        over,
                        Line::Do(Instruction::new(name, &[target])),
                        Line::Label(skip),
                    ]);
                    continue;
                }
                (_, true) => "rjmp",
                (_, false) => "jmp",
            };
            lines.push(Line::Do(Instruction::new(name, &[target])));
        }
        function.lines = lines;
    }
    Ok(())
}
