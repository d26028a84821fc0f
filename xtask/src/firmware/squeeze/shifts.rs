//! Variables farther from Y than one instruction reaches.
//!
//! An instruction reaches 63 bytes beyond Y. For what lies farther away the compiler moves Y there and back for each access, and keeps
//! the flags meanwhile, whether they matter or not. Between [`gather`] and [`spread`] an access says its whole distance; then
//! Y moves once for as many accesses as it can.

use super::assembly::{Flow, Function, Instruction, Line};
use super::effects::{Set, pair, register};
use super::frames::Frame;
use super::liveness::{Known, Whole};
use super::stack_arguments::{FARTHEST, Shift, access};

/// Whether a line counts on Y being where it belongs.
fn is_other_use_of_y(line: &Line, reads: Set, writes: Set) -> bool {
    let it = line.instruction();
    it.is_none_or(|it| {
        it.flow() != Flow::Next || access(it).is_none() && (reads | writes).meets(pair(28))
    })
}

fn is(line: Option<&Line>, text: &str) -> bool {
    line.and_then(Line::instruction)
        .is_some_and(|it| it.to_string() == text)
}

/// Makes one instruction of each access to what is far from Y.
pub(super) fn gather(function: &mut Function, whole: &Whole) -> Result<(), String> {
    if !Frame::read(function).is_some_and(|frame| frame.has_variables()) {
        return Ok(());
    }
    let lines = &function.lines;
    let mut groups = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        at = match Group::read(lines, at)? {
            Some(group) => {
                let end = group.end;
                groups.push(group);
                end
            }
            None => at + 1,
        };
    }
    // What they do to the flags comes to nothing.
    let known = whole.about_where(function, |effects| {
        for group in groups.iter().filter(|group| group.keeps_flags) {
            for effect in &mut effects[group.from..group.end] {
                effect.reads = effect.reads.without(Set::FLAGS);
                effect.writes = effect.writes.without(Set::FLAGS);
            }
        }
    })?;
    for group in groups.into_iter().rev() {
        let after = known.live[group.end - 1];
        let lost = if group.keeps_flags {
            Set::FLAGS | Set::register(0)
        } else {
            Set::FLAGS
        };
        if !after.meets(lost) {
            function.lines.splice(group.from..group.end, group.accesses);
        }
    }
    Ok(())
}

/// Accesses between two moves of Y, with their whole distance.
struct Group {
    from: usize,
    end: usize,
    keeps_flags: bool,
    accesses: Vec<Line>,
}

impl Group {
    fn read(lines: &[Line], from: usize) -> Result<Option<Self>, String> {
        let keeps_flags = is(lines.get(from), "in r0, 63");
        let Some((accesses, end)) = far(lines, from + usize::from(keeps_flags))? else {
            return Ok(None);
        };
        if is(lines.get(end), "out 63, r0") != keeps_flags {
            return Ok(None);
        }
        Ok(Some(Self {
            from,
            end: end + usize::from(keeps_flags),
            keeps_flags,
            accesses,
        }))
    }
}

/// Accesses between two moves of Y, with their whole distance, and where they end.
fn far(lines: &[Line], at: usize) -> Result<Option<(Vec<Line>, usize)>, String> {
    let Some(there) = Shift::read(lines, at)?.filter(|shift| shift.by > 0) else {
        return Ok(None);
    };
    let mut accesses = Vec::new();
    let mut at = at + there.lines;
    while let Some(Line::Do(it)) = lines.get(at)
        && let Some((place, distance)) = access(it)
        && register(it.operand(1 - place)).is_some_and(|it| !(28..30).contains(&it))
    {
        accesses.push(Line::Do(reaching(it, place, distance + there.by)));
        at += 1;
    }
    let back = Shift::read(lines, at)?.filter(|back| back.by == -there.by);
    Ok(back
        .filter(|_| !accesses.is_empty())
        .map(|back| (accesses, at + back.lines)))
}

/// The same access at another distance.
fn reaching(it: &Instruction, place: usize, distance: i32) -> Instruction {
    let mut it = it.clone();
    it.operands[place] = format!("Y+{distance}");
    for (short, long) in [("ld", "ldd"), ("st", "std")] {
        if it.name == short {
            long.clone_into(&mut it.name);
        }
    }
    it
}

/// Moves Y for accesses to what is far from it.
pub(super) fn spread(function: &mut Function, whole: &Whole) -> Result<(), String> {
    let distance = |line: &Line| line.instruction().and_then(access).map(|(_, q)| q);
    if !function
        .lines
        .iter()
        .filter_map(distance)
        .any(|q| q > FARTHEST)
    {
        return Ok(());
    }
    let known = whole.about(function)?;
    let lines = &function.lines;
    let mut new = Vec::with_capacity(lines.len());
    let mut moved = 0;
    for (at, line) in lines.iter().enumerate() {
        if let Some(q) = distance(line) {
            let within = |moved: i32| (0..=FARTHEST).contains(&(q - moved));
            if !within(moved) {
                // As many as one place of Y serves, from here on.
                let (mut low, mut high) = (q - FARTHEST, q);
                for q in run(lines, at, &known) {
                    if q - FARTHEST > high || q < low {
                        break;
                    }
                    (low, high) = (low.max(q - FARTHEST), high.min(q));
                }
                new.extend(shift(low.max(0) - moved));
                moved = low.max(0);
            }
            if let Line::Do(it) = line
                && let Some((place, q)) = access(it)
            {
                new.push(Line::Do(if moved == 0 {
                    it.clone()
                } else {
                    reaching(it, place, q - moved)
                }));
            }
            // Back, unless what comes next goes on here.
            let next = run(lines, at, &known).nth(1);
            if moved != 0 && next.is_none() {
                new.extend(shift(-moved));
                moved = 0;
            }
        } else {
            new.push(line.clone());
        }
    }
    function.lines = new;
    Ok(())
}

/// Distances of the accesses from a line on, as far as Y may move before each of them.
fn run<'a>(lines: &'a [Line], at: usize, known: &'a Known) -> impl Iterator<Item = i32> + 'a {
    let rest = lines.iter().enumerate().skip(at);
    let straight = rest.take_while(|(at, line)| {
        !is_other_use_of_y(line, known.effects[*at].reads, known.effects[*at].writes)
    });
    straight
        .filter_map(|(at, line)| {
            let (_, q) = line.instruction().and_then(access)?;
            Some((at, q))
        })
        .take_while(move |(place, _)| *place == at || !known.live[*place].meets(Set::FLAGS))
        .map(|(_, q)| q)
}

/// Moves Y by so many bytes.
fn shift(by: i32) -> Vec<Line> {
    let line = |name: &str, register: &str, number: i32| {
        Line::Do(Instruction::new(name, &[register, &number.to_string()]))
    };
    match by {
        0 => Vec::new(),
        1..=FARTHEST => vec![line("adiw", "r28", by)],
        _ if -by <= FARTHEST && by < 0 => vec![line("sbiw", "r28", -by)],
        _ => {
            let [low, high] = ((-by) as i16).to_le_bytes();
            vec![
                line("subi", "r28", low.into()),
                line("sbci", "r29", high.into()),
            ]
        }
    }
}
