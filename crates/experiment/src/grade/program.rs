//! What a program does inside, by what the emulator saw and not by its text: waits, interrupts, memory. Metrics
//! `program.*`, of the run with the first public seed of each test.

use crate::files::{did_you_mean, near};
use crate::metrics::Metrics;
use crate::note::Note;
use rumbo_emulator::image::Image;
use rumbo_emulator::observe::profile::{InterruptUse, Profile};
use rumbo_emulator::observe::wait::{Waited, Waits};
use rumbo_sim::mega::Mega;
use std::collections::BTreeMap;

const HERTZ: f64 = 16e6;

/// The longest busy wait, and the share of the time in busy waits.
const WAIT: &str = "program.wait_longest_s";
const WAITING: &str = "program.wait_share";
/// The longest turn of the main loop.
const TURN: &str = "program.turn_longest_s";
/// The longest interrupt, from its request being served to its end.
const INTERRUPT: &str = "program.interrupt_longest_s";
/// Time in floating-point arithmetic within interrupts.
const FLOAT: &str = "program.interrupt_float_s";
/// Depth of the stack.
const STACK: &str = "program.stack_bytes";
/// Pieces of memory taken from the heap.
const HEAP: &str = "program.heap_calls";

/// All of them.
const METRICS: [&str; 7] = [WAIT, WAITING, TURN, INTERRUPT, FLOAT, STACK, HEAP];
/// What takes memory from the heap; `new` and `String` call them.
const ALLOCATORS: [&str; 2] = ["malloc", "realloc"];

/// Whether a metric is one of a program.
#[must_use]
pub(super) fn is_of_program(metric: &str) -> bool {
    metric.starts_with("program.")
}

/// Suggestion for a metric that is none of a program's.
pub(super) fn unknown(metric: &str) -> Option<String> {
    let near = near::near_or_all(metric, METRICS);
    let remedy = format!("no such metric of a program; {}", did_you_mean(&near));
    (!METRICS.contains(&metric)).then_some(remedy)
}

/// What was seen: metrics, and for each what a person wants to know of where it was.
#[derive(Debug, Default)]
pub(super) struct Seen {
    pub(super) metrics: Metrics,
    pub(super) places: BTreeMap<&'static str, Note>,
}

/// Begins to watch.
pub(super) fn watch(mega: &mut Mega) {
    let image = mega.firmware().image().clone();
    let observers = mega.chip_mut().observers_mut();
    observers.measure_stack();
    // Without symbols nobody knows where its functions are.
    if let Some(waits) = Waits::of(&image) {
        observers.profile(Profile::new(&image));
        observers.wait(waits);
    }
}

/// What was seen of the program.
pub(super) fn seen(mega: &Mega) -> Seen {
    let (image, observers) = (mega.firmware().image(), mega.chip().observers());
    let mut seen = Seen::default();
    if let Some(lowest) = observers.lowest_stack_pointer() {
        seen.stack(image, lowest);
    }
    if let Some(waits) = observers.waited() {
        seen.waits(&waits.waited());
    }
    if let Some(profile) = observers.profiled() {
        seen.interrupts(profile);
        let chains = profile.folded();
        let chains: Vec<Chain<'_>> = chains.lines().filter_map(Chain::of).collect();
        seen.floats(&chains);
        seen.heap(profile, &chains);
    }
    seen
}

impl Seen {
    fn put(&mut self, metric: &'static str, value: f64, place: Option<Note>) {
        self.metrics.insert(metric.to_owned(), value);
        if let Some(place) = place {
            self.places.insert(metric, place);
        }
    }

    fn stack(&mut self, image: &Image, lowest: u16) {
        let depth = image.model().ram_end.saturating_sub(lowest);
        self.put(STACK, f64::from(depth), None);
    }

    fn waits(&mut self, waited: &Waited) {
        let all = waited.cycles.max(1) as f64;
        let place = waited.function.as_ref().map(|function| {
            let (count, function) = (waited.count, function.to_string());
            Note::BusyWaits { count, function }
        });
        self.put(WAIT, seconds(waited.longest), place.clone());
        self.put(WAITING, waited.total as f64 / all, place);
        if let Some(turn) = waited.longest_turn {
            self.put(TURN, seconds(turn), None);
        }
    }

    fn interrupts(&mut self, profile: &Profile) {
        let interrupts = profile.interrupts();
        let longest = interrupts.iter().max_by_key(|one| one.longest);
        let place = longest.map(|one: &InterruptUse| Note::LongInterrupt {
            name: profile.vector_name(one.vector).to_string(),
            cycles: one.longest,
            count: one.count,
        });
        self.put(
            INTERRUPT,
            seconds(longest.map_or(0, |one| one.longest)),
            place,
        );
    }

    fn floats(&mut self, chains: &[Chain<'_>]) {
        let floats = chains.iter().filter(|chain| {
            chain.names[0].starts_with("interrupt ")
                && chain.names.iter().any(|name| is_float(name))
        });
        let (mut cycles, mut most) = (0, (0, None));
        for chain in floats {
            cycles += chain.cycles;
            if chain.cycles > most.0 {
                most = (chain.cycles, chain.before(is_float));
            }
        }
        let place = most.1.map(|[caller, function]| {
            let (function, caller) = (function.into(), caller.into());
            Note::CalledForCycles {
                function,
                caller,
                cycles,
            }
        });
        self.put(FLOAT, seconds(cycles), place);
    }

    fn heap(&mut self, profile: &Profile, chains: &[Chain<'_>]) {
        let functions = profile.functions();
        let own = functions
            .iter()
            .filter(|one| ALLOCATORS.contains(&one.name.as_str()));
        let calls: u64 = own.map(|one| one.calls).sum();
        let mut callers = chains.iter();
        let caller = callers.find_map(|chain| chain.before(|name| ALLOCATORS.contains(&name)));
        let place = caller.map(|[caller, function]| {
            let (function, caller) = (function.into(), caller.into());
            Note::CalledTimes {
                function,
                caller,
                calls,
            }
        });
        self.put(HEAP, calls as f64, place);
    }
}

/// A chain of calls and its cycles.
struct Chain<'a> {
    names: Vec<&'a str>,
    cycles: u64,
}

impl<'a> Chain<'a> {
    fn of(line: &'a str) -> Option<Self> {
        let (names, cycles) = line.rsplit_once(' ')?;
        Some(Self {
            names: names.split(';').collect(),
            cycles: cycles.parse().ok()?,
        })
    }

    /// The first function that is meant, and who called it.
    fn before(&self, is: impl Fn(&str) -> bool) -> Option<[&'a str; 2]> {
        let at = self.names.iter().position(|name| is(name))?;
        Some([self.names[at.checked_sub(1)?], self.names[at]])
    }
}

/// Whether a function is of the arithmetic with floating point, of libgcc and avr-libc: `__mulsf3`, `__fp_splitA`.
fn is_float(name: &str) -> bool {
    name.starts_with("__fp_") || name.starts_with("__") && name.contains("sf")
}

fn seconds(cycles: u64) -> f64 {
    cycles as f64 / HERTZ
}
