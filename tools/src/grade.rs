//! Grades a class of a hundred, thirty of whom are hostile, and compares every mark with that of a class without them.
//!
//! `cargo xtask campaign --only grade` builds and starts it in the project's root. Arguments: hand-ins (100), scenarios
//! (5), seeds of each (10). Exit status 1 if a mark differs by a byte, a hostile program earns a point, or the model
//! solution does not have them all.

use rayon::prelude::*;
use rumbo_experiment::grade::{Assignment, HandIn, Mark, grade};
use rumbo_sketch::limits::Limits;
use rumbo_sketch::sandbox::Sandbox;
use rumbo_sketch::{BOARDS, Compiler, Given, Source, Toolchain, given};
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const ASSIGNMENT: &str = "examples/assignments/speed";
/// Of ten hand-ins so many are hostile.
const HOSTILE_OF_TEN: usize = 3;

/// Programs and sources that do harm: what they are called, and what they are.
const HOSTILE: [(&str, &str); 12] = [
    (
        "hang",
        "void setup() { cli(); for (;;); }\nvoid loop() { }\n",
    ),
    (
        "toggle",
        "void setup() { DDRE = DDRG = DDRH = 0xff; for (;;) { PORTE ^= 0xff; PORTG ^= 0xff; PORTH ^= 0xff; } }\nvoid loop() { }\n",
    ),
    (
        "timers",
        "void setup() { TCCR3A = 0x54; TCCR3B = 9; OCR3A = 1; TCCR4A = 0x54; TCCR4B = 9; OCR4A = 1; DDRE = DDRH = 0xff; for (;;); }\n\
         void loop() { }\n",
    ),
    (
        "interrupts",
        "ISR(TIMER1_COMPA_vect) { }\nvoid setup() { TCCR1B = 9; OCR1A = 40; TIMSK1 = 2; DDRE = 0xff; sei(); for (;;) PORTE ^= 255; }\n\
         void loop() { }\n",
    ),
    (
        "flood",
        "void setup() { Serial.begin(2000000); Serial1.begin(2000000); Serial2.begin(2000000); }\n\
         void loop() { Serial.write(85); Serial1.write(85); Serial2.write(85); }\n",
    ),
    (
        "frames",
        "void setup() { Serial1.begin(9600); }\nvoid loop() { for (int i = 0; i < 64; i++) Serial1.write(i); Serial1.write((byte)0); }\n",
    ),
    (
        "lies",
        "void setup() { Serial1.begin(9600); }\nvoid loop() { Serial1.println(\"50, 60.0, 60.0, 60.0, 5, 120, 120\"); delay(50); }\n",
    ),
    (
        "reset",
        "#include <avr/wdt.h>\nvoid setup() { wdt_enable(WDTO_15MS); for (;;); }\nvoid loop() { }\n",
    ),
    (
        "crash",
        "void setup() { void (*f)() = (void (*)())0x1f000; f(); }\nvoid loop() { }\n",
    ),
    (
        "stack",
        "int f(int n) { volatile char b[100]; b[0] = n; return f(n + 1) + b[0]; }\nvoid setup() { f(0); }\nvoid loop() { }\n",
    ),
    (
        "passwords",
        "#include \"/etc/passwd\"\nvoid setup() { }\nvoid loop() { }\n",
    ),
    (
        "templates",
        "template<unsigned long long N, int D> struct T { static const int v = T<2 * N, D - 1>::v + T<2 * N + 1, D - 1>::v; };\n\
         template<unsigned long long N> struct T<N, 0> { static const int v = 1; };\nint x = T<1, 60>::v;\nvoid setup() { }\nvoid loop() { }\n",
    ),
];

pub(crate) fn main() -> ExitCode {
    crate::ended("grade", run())
}

fn run() -> Result<bool, Box<dyn Error>> {
    let numbers: Result<Vec<usize>, _> = crate::arguments().map(|text| text.parse()).collect();
    let numbers = numbers?;
    let number = |index: usize, usual| numbers.get(index).copied().unwrap_or(usual);
    let (count, scenarios, seeds) = (number(0, 100), number(1, 5), number(2, 10));
    let assignment = assignment(scenarios, seeds)?;
    let toolchain = Toolchain::find()?;
    let limits = Limits {
        time: Duration::from_secs_f64(assignment.compile_s),
        ..Limits::default()
    };
    let sandbox = Sandbox::walled(&toolchain, limits)?;
    let cache = Path::new("target/sketches/class");
    // What is measured is a class that comes for the first time.
    let _ = std::fs::remove_dir_all(cache);
    let compiler = Compiler::new(BOARDS[0], toolchain, sandbox, cache.to_owned())?;
    let Given::Sketch(model) = given(&Path::new(ASSIGNMENT).join("model"), true)? else {
        return Err("the model is no sketch".into());
    };

    let begun = Instant::now();
    let sources: Vec<(bool, Source)> = (0..count).map(|index| source(&model, index)).collect();
    let all: Vec<(bool, HandIn)> = sources
        .par_iter()
        .map(|(hostile, source)| (*hostile, compiled(&compiler, source)))
        .collect();
    let compiled_s = begun.elapsed().as_secs_f64();
    let (hostile, honest): (Vec<_>, Vec<_>) = all.into_iter().partition(|(hostile, _)| *hostile);
    let honest: Vec<HandIn> = honest.into_iter().map(|(_, one)| one).collect();
    let all_of =
        |hand_ins: &[HandIn]| grade(&assignment, hand_ins, || true).ok_or("a run was left out");
    let alone = all_of(&honest)?;
    let alone_s = begun.elapsed().as_secs_f64() - compiled_s;
    let bad = hostile.len();
    let together: Vec<HandIn> = hostile
        .into_iter()
        .map(|(_, one)| one)
        .chain(honest)
        .collect();
    let begun = Instant::now();
    let marks = all_of(&together)?;
    let graded_s = begun.elapsed().as_secs_f64();

    println!(
        "{count} hand-ins, {bad} of them hostile; {scenarios} scenarios x {seeds} seeds of {} s",
        assignment.tests[0].setup.scenario.duration_s
    );
    println!(
        "compiled in {compiled_s:.0} s, driven in {graded_s:.0} s; without the hostile in {alone_s:.0} s"
    );
    let same = same(&alone, &marks[bad..])?;
    println!(
        "marks that the hostile changed: {}",
        if same { "none" } else { "SOME" }
    );
    let gained = marks[..bad].iter().filter(|mark| mark.points > 0.0);
    let gained: Vec<_> = gained.map(|mark| mark.name.as_str()).collect();
    println!("hostile programs with points: {gained:?}");
    Ok(same && gained.is_empty())
}

/// The assignment with so many scenarios and seeds.
fn assignment(scenarios: usize, seeds: usize) -> Result<Assignment, Box<dyn Error>> {
    let mut assignment = Assignment::read(&format!("{ASSIGNMENT}/assignment.toml"))?;
    let mut test = assignment.tests[0].clone();
    // The first are those whose marks the model has in full.
    let known: Vec<u64> = test.seeds().collect();
    test.public = known.iter().copied().chain(1000..).take(seeds).collect();
    test.hidden = Vec::new();
    assignment.tests = vec![test; scenarios.max(1)];
    Ok(assignment)
}

/// A hand-in: hostile ones between models that each have a comment of their own.
fn source(model: &Source, index: usize) -> (bool, Source) {
    let hostile = index % 10 < HOSTILE_OF_TEN;
    let name = format!("hand-in-{index}");
    if !hostile {
        let mut own = model.clone();
        for bytes in own.files.values_mut() {
            bytes.extend(format!("// {index}\n").bytes());
        }
        return (false, Source { name, ..own });
    }
    let number = HOSTILE_OF_TEN * (index / 10) + index % 10;
    let (what, text) = HOSTILE[number % HOSTILE.len()];
    let files = [(
        "bad.ino".to_owned(),
        format!("{text}// {index}\n").into_bytes(),
    )];
    let name = format!("{name}-{what}");
    (
        true,
        Source {
            name,
            files: files.into(),
        },
    )
}

fn compiled(compiler: &Compiler, source: &Source) -> HandIn {
    let image = compiler
        .compile(source, &[])
        .map_err(|error| error.to_string());
    let bytes =
        image.and_then(|image| std::fs::read(image.path).map_err(|error| error.to_string()));
    HandIn {
        name: source.name.clone(),
        program: bytes.map_err(|error| vec![error]),
        notes: Vec::new(),
    }
}

fn same(one: &[Mark], other: &[Mark]) -> Result<bool, serde_json::Error> {
    Ok(serde_json::to_string(one)? == serde_json::to_string(other)?)
}
