//! Where everything lies, and how far each jump and each call has to reach.
//!
//! `rcall` and `rjmp` take two bytes and reach 4 KB, `call` and `jmp` take four and reach everything. So callers and what
//! they call are put together, and what lies farther away, the arithmetic of floats most of all, is reached by way of an
//! island: a `jmp` in the middle of each few kilobytes, to which many a `rcall` goes. It costs two cycles.
//!
//! Jumps within a function begin short; what does not reach becomes longer, until nothing changes.

use std::collections::HashMap;

use super::assembly::{Flow, Function, Instruction, Line, Program};

/// Words of code in which equal sequences are looked for: short calls from the middle reach either end when these are found.
pub(super) const REGION: usize = 4_100;
/// Words of code with islands in the middle: what is at either end reaches them.
const ISLANDS: usize = 3_800;
/// Calls that make an island worth its two words.
const WORTH: usize = 3;

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

/// Puts the functions in order, makes islands, and writes every jump and call as short as it can be. Those of `direct`
/// functions make no way round.
pub(super) fn arrange(
    program: &mut Program,
    direct: impl Fn(&Function) -> bool,
) -> Result<(), String> {
    let regions = make_islands(&mut program.functions, &direct);
    let settled = Layout::new(&program.functions, &regions, &direct).settle();
    write(&mut program.functions, settled)
}

/// Callers beside what they call.
pub(super) fn order(functions: &mut Vec<Function>) {
    let places: HashMap<String, usize> = functions
        .iter()
        .enumerate()
        .map(|(place, function)| (function.name().to_owned(), place))
        .collect();
    let mut edges: HashMap<(usize, usize), usize> = HashMap::new();
    for (caller, function) in functions.iter().enumerate() {
        for instruction in function.instructions() {
            if let Some(&callee) = instruction.target().and_then(|target| places.get(target))
                && callee != caller
            {
                *edges
                    .entry((caller.min(callee), caller.max(callee)))
                    .or_default() += 1;
            }
        }
    }
    let mut edges: Vec<_> = edges.into_iter().collect();
    edges.sort_by_key(|&((one, other), calls)| (std::cmp::Reverse(calls), one, other));
    let mut group_of: Vec<usize> = (0..functions.len()).collect();
    let mut groups: Vec<Vec<usize>> = group_of.iter().map(|&function| vec![function]).collect();
    let mut words: Vec<usize> = functions
        .iter()
        .map(|function| function.instructions().map(Instruction::words).sum())
        .collect();
    for ((one, other), _) in edges {
        let (to, from) = (group_of[one], group_of[other]);
        if to != from && words[to] + words[from] <= REGION {
            let moved = std::mem::take(&mut groups[from]);
            moved.iter().for_each(|&function| group_of[function] = to);
            groups[to].extend(moved);
            words[to] += std::mem::take(&mut words[from]);
        }
    }
    let mut rank = vec![0; functions.len()];
    groups
        .into_iter()
        .flatten()
        .enumerate()
        .for_each(|(place, function)| rank[function] = place);
    let mut ranked: Vec<_> = rank.into_iter().zip(std::mem::take(functions)).collect();
    ranked.sort_by_key(|(rank, _)| *rank);
    functions.extend(ranked.into_iter().map(|(_, function)| function));
}

/// Words that a function takes where calls are short.
fn size(function: &Function) -> usize {
    let words = |it: &Instruction| if it.name == "call" { 1 } else { it.words() };
    function.instructions().map(words).sum()
}

/// Functions in their order, in regions small enough for short calls from the middle to either end. None goes on in the next.
pub(super) fn split(functions: Vec<Function>, most: usize) -> Vec<Vec<Function>> {
    let mut regions: Vec<Vec<Function>> = vec![Vec::new()];
    let mut words = 0;
    let mut ended = false;
    for function in functions {
        if words + size(&function) > most && ended {
            regions.push(Vec::new());
            words = 0;
        }
        words += size(&function);
        let last = function.lines.last().and_then(Line::instruction);
        ended = last.is_some_and(Instruction::ends);
        if let Some(region) = regions.last_mut() {
            region.push(function);
        }
    }
    regions
}

/// The place in a region that is nearest to both its ends, where nothing goes on from one function to the next.
pub(super) fn middle(region: &[Function]) -> usize {
    let whole: usize = region.iter().map(size).sum();
    let mut before = 0;
    let middle = region.iter().position(|function| {
        before += size(function);
        let ends = function.lines.last().and_then(Line::instruction);
        before * 2 >= whole && ends.is_some_and(Instruction::ends)
    });
    middle.map_or(0, |middle| middle + 1)
}

/// The region of each function and, of each region, the labels of its islands by where they lead.
struct Regions {
    of: Vec<usize>,
    islands: Vec<HashMap<String, String>>,
}

/// Puts islands into the middle of each region.
fn make_islands(functions: &mut Vec<Function>, direct: &impl Fn(&Function) -> bool) -> Regions {
    let regions = split(std::mem::take(functions), ISLANDS);
    let mut result = Regions {
        of: Vec::new(),
        islands: Vec::new(),
    };
    for (number, mut region) in regions.into_iter().enumerate() {
        let within: std::collections::HashSet<String> =
            region.iter().flat_map(labels).map(str::to_owned).collect();
        let mut wanted: HashMap<String, usize> = HashMap::new();
        for function in region.iter().filter(|function| !direct(function)) {
            for instruction in function.instructions() {
                if let (Flow::Call | Flow::Jump, Some(target)) =
                    (instruction.flow(), instruction.target())
                    && !within.contains(target)
                {
                    *wanted.entry(target.to_owned()).or_default() += 1;
                }
            }
        }
        wanted.retain(|_, calls| *calls >= WORTH);
        let mut targets: Vec<String> = wanted.into_keys().collect();
        targets.sort();
        let mut island = Function::new(format!("rumbo_island_{number}"), Vec::new());
        let mut labels = HashMap::new();
        for (place, target) in targets.into_iter().enumerate() {
            let label = format!(".Lisland_{number}_{place}");
            island.lines.push(Line::Label(label.clone()));
            island
                .lines
                .push(Line::Do(Instruction::new("jmp", &[&target])));
            labels.insert(target, label);
        }
        if !labels.is_empty() {
            let middle = middle(&region);
            region.insert(middle, island);
        }
        result.of.extend(region.iter().map(|_| number));
        result.islands.push(labels);
        functions.extend(region);
    }
    result
}

/// What of a function can be jumped to.
fn labels(function: &Function) -> impl Iterator<Item = &str> {
    let inner = function.lines.iter().filter_map(|line| match line {
        Line::Label(label) => Some(label.as_str()),
        Line::Do(_) => None,
    });
    function.names.iter().map(String::as_str).chain(inner)
}

/// A place that a jump is to: a line of the program, counted through.
struct Jump<'a> {
    flow: Flow,
    target: &'a str,
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
        regions: &'a Regions,
        direct: &impl Fn(&Function) -> bool,
    ) -> Self {
        let mut items = Vec::new();
        for (function, &region) in functions.iter().zip(&regions.of) {
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
                            island: regions.islands[region]
                                .get(target)
                                .filter(|_| !no_islands)
                                .map(String::as_str),
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
    fn reaches(&self, here: i64, distance: &impl Fn(&str, i64) -> i64) -> bool {
        let relative = |distance: i64| (-2_048..2_048).contains(&distance);
        match (self.flow, self.reach) {
            (Flow::Branch, Reach::Near) => (-64..64).contains(&distance(self.target, here)),
            (Flow::Branch, Reach::Far) => relative(distance(self.target, here + 1)),
            (_, Reach::Near) => relative(distance(self.target, here)),
            (_, Reach::Island) => self
                .island
                .is_some_and(|island| relative(distance(island, here))),
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
