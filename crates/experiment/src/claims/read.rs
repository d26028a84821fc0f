//! Reads a file of tests.

use super::{Act, Port, Pulses, Suite, Test, TestProgram, TestStep};
use crate::batch::TRUE;
use crate::files::read::{Allowed, Placed, Source, Table};
use crate::files::{
    FileError, Library, MetricBounds, Overrides, bounded, did_you_mean, near_or_all, read_bounds,
    read_press,
};
use rumbo_sim::mega::{ON_PINS, PARTS, USB};
use rumbo_wire::LineEnding;
use std::collections::BTreeSet;
use std::path::Path;

const MOST_TESTS: usize = 10_000;
const MOST_STEPS: usize = 1_000;
const SEED: Allowed = Allowed::new(0.0, 4_294_967_295.0, "count");
const WITHIN: Allowed = Allowed::new(0.0, 3_600.0, "s");
const OVER: Allowed = Allowed::new(0.01, 3_600.0, "s");
const VOLTS: Allowed = Allowed::new(0.0, 5.0, "V");
/// How long a step waits where it does not say.
const USUAL_S: f64 = 1.0;
/// The keys that select what a step does.
const ACTS: [&str; 9] = [
    "expect", "send", "press", "apply_v", "release", "high", "over_s", "truth", "run_s",
];

impl Suite {
    /// Reads a file.
    ///
    /// # Errors
    /// All that is wrong with it, by line.
    pub fn read(path: &str) -> Result<Self, FileError> {
        let unreadable =
            |error| FileError::unreadable(path.to_owned(), &error, "the path of a file of tests");
        let text = bounded::read_text(Path::new(path)).map_err(unreadable)?;
        Self::parse(path, &text)
    }

    /// Reads the text of a file; what it names is beside it.
    ///
    /// # Errors
    /// All that is wrong with it, by line.
    pub fn parse(path: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(path, text);
        let parsed = source.parse()?;
        let root = source.root(&parsed);
        let text = |key: &str| root.text(key).map(|placed| placed.value);
        let library = Library::new().beside(path);
        let beside = |name: String| match name.starts_with("example:") {
            true => name,
            false => library.path(Path::new(&name)).display().to_string(),
        };
        let (sketch, firmware) = (text("sketch"), text("firmware"));
        let program = match (sketch, firmware) {
            (Some(sketch), None) => TestProgram::Sketch(beside(sketch)),
            (None, Some(image)) => TestProgram::Image(beside(image).into()),
            (given, _) => {
                let what = match given {
                    None => "has no program: write sketch = \".\" or firmware = \"image.hex\"",
                    Some(_) => "has two programs: leave sketch or firmware out",
                };
                root.complain_here(what);
                TestProgram::Sketch(String::new())
            }
        };
        let overrides = Overrides {
            robot: text("robot"),
            world: text("world"),
            wiring: text("wiring"),
            ground_truth: true,
            ..Overrides::default()
        };
        let tables = root.tables("test", MOST_TESTS);
        if tables.is_empty() {
            root.complain_here("nothing is tested: write a [[test]] with a name and [[test.step]]");
        }
        let mut names = BTreeSet::new();
        let tests = tables.iter().map(|table| read_test(table, &mut names));
        let suite = Self {
            path: path.to_owned(),
            program,
            scenario: text("scenario").unwrap_or_else(|| "free".to_owned()),
            overrides,
            tests: tests.collect(),
        };
        root.finish();
        source.verdict()?;
        Ok(suite)
    }
}

fn read_test(table: &Table<'_, '_>, names: &mut BTreeSet<String>) -> Test {
    let name = table.required_text("name", "what the test claims, one line");
    if !name.value.is_empty() && !names.insert(name.value.clone()) {
        let remedy = "another test has that name; give each its own";
        table.complain("name", name.line, &name.value, remedy);
    }
    let steps = table.tables("step", MOST_STEPS);
    if steps.is_empty() {
        table.complain_here("claims nothing: write a [[test.step]], e.g. with expect = \"ready\"");
    }
    let test = Test {
        name: name.value,
        seed: table.number("seed", SEED).unwrap_or(1.0) as u64,
        steps: steps.iter().filter_map(read_step).collect(),
    };
    table.finish();
    test
}

fn read_step(table: &Table<'_, '_>) -> Option<TestStep> {
    let given: Vec<&str> = ACTS.into_iter().filter(|key| table.has(key)).collect();
    let line = table.keys().first().map_or(0, |key| key.line);
    let act = match given[..] {
        [key] => read_act(table, key),
        [] => {
            let all = ACTS.join(", ");
            table.complain_here(&format!("does nothing: it needs one of {all}"));
            None
        }
        [one, other, ..] => {
            table.complain_here(&format!("does both {one} and {other}: write two steps"));
            None
        }
    };
    // What it does not say of one action is no further problem.
    if given.len() == 1 {
        table.finish();
    }
    act.map(|act| TestStep { line, act })
}

fn read_act(table: &Table<'_, '_>, key: &str) -> Option<Act> {
    let within = || table.number("within_s", WITHIN).unwrap_or(USUAL_S);
    match key {
        "expect" => {
            let text = table.required_text(key, "the text that is to come").value;
            Some(Act::Expect(read_port(table), text, within()))
        }
        "send" => {
            let text = table.required_text(key, "the text that is typed").value;
            let ending = read_ending(table);
            let bytes = [text.as_str(), ending.text()].concat().into_bytes();
            Some(Act::Send(read_port(table), bytes))
        }
        "press" => {
            table.require(key, "the name of a part");
            Some(Act::Press(read_press(table, 0.0)))
        }
        "apply_v" => Some(Act::Apply(
            read_pin(table)?,
            Some(table.number(key, VOLTS)?),
        )),
        "release" => {
            let pin = read_pin(table)?;
            table.flag(key).map(|_| Act::Apply(pin, None))
        }
        "high" => {
            let pin = read_pin(table)?;
            Some(Act::Level(pin, table.flag(key)?.value, within()))
        }
        "over_s" => read_pulses(table, key).map(Act::Judge),
        "truth" => read_truth(table, key),
        _ => table.number(key, OVER).map(Act::Run),
    }
}

fn read_pulses(table: &Table<'_, '_>, key: &str) -> Option<Pulses> {
    let bounds = |key: &str| table.has(key).then(|| read_bounds(table, key));
    let judged = Pulses {
        pin: read_pin(table)?,
        over_s: table.number(key, OVER)?,
        count: bounds("pulses"),
        width_us: bounds("width_us"),
        period_us: bounds("period_us"),
        duty: bounds("duty"),
    };
    let all = [judged.count, judged.width_us, judged.period_us, judged.duty];
    if all.iter().all(Option::is_none) {
        table.complain_here("judges nothing: it needs one of pulses, width_us, period_us, duty");
    }
    Some(judged)
}

fn read_truth(table: &Table<'_, '_>, key: &str) -> Option<Act> {
    let name = table.required_text(key, "what is true of the robot, e.g. \"x_m\"");
    let bounds = MetricBounds {
        min: table.number("min", Allowed::new(-1e9, 1e9, "")),
        max: table.number("max", Allowed::new(-1e9, 1e9, "")),
    };
    if bounds == MetricBounds::default() {
        table.complain_here("has neither min nor max: write e.g. min = 0.5");
    }
    // Which sonars there are the robot says.
    let is_range = name.value.starts_with("range_") && name.value.ends_with("_m");
    let is_known = is_range || TRUE.contains(&name.value.as_str());
    if !is_known && !name.value.is_empty() {
        let remedy = did_you_mean(&near_or_all(&name.value, TRUE));
        table.complain(key, name.line, &name.value, &remedy);
    }
    // Without a time it is judged as it is.
    let within_s = table.number("within_s", WITHIN).unwrap_or(0.0);
    is_known.then_some(Act::Truth(name.value, bounds, within_s))
}

fn read_pin(table: &Table<'_, '_>) -> Option<String> {
    table.require("pin", "a number, or a name as \"A0\" or \"left_enable\"");
    table.word("pin").map(|word| word.value)
}

fn read_port(table: &Table<'_, '_>) -> Port {
    let Some(Placed { value, line }) = table.word("port") else {
        return Port::Usart(USB);
    };
    match (value.as_str(), value.parse::<u8>()) {
        ("usb", _) => Port::Usart(USB),
        ("link", _) => Port::Link,
        ("displays", _) => Port::Usart(PARTS),
        (_, Ok(number)) if number < ON_PINS => Port::Usart(number),
        _ => {
            let remedy = "must be \"usb\", \"link\" for the Bluetooth module, \"displays\", or a USART, 0 to 3";
            table.complain("port", line, &value, remedy);
            Port::Link
        }
    }
}

fn read_ending(table: &Table<'_, '_>) -> LineEnding {
    let Some(name) = table.text("line_ending") else {
        return LineEnding::default();
    };
    LineEnding::named(&name.value).unwrap_or_else(|| {
        let known = LineEnding::ALL.map(LineEnding::name);
        let remedy = did_you_mean(&near_or_all(&name.value, known));
        table.complain("line_ending", name.line, &name.value, &remedy);
        LineEnding::default()
    })
}
