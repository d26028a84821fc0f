//! An assignment's file: the task, its scenarios and seeds, and the rubric.
//!
//! ```toml
//! title = "Drive to a wall"
//! statement = "Stop 30 cm before the wall."
//! points = 10                  # the full mark
//! pass = 5                     # the least that passes
//! contact_penalty = 2          # points lost if every run touches something
//! compiler = "5.4.0"
//! core = "1.8.7"
//! given = ["start"]            # sketches that all began with: no sign that one is copied
//! [es]                         # the same in Spanish, if wanted
//! title = "Avanzar hasta una pared"
//! [[scenario]]
//! scenario = "mode1"           # built in, or the path of a file beside this one
//! public_seeds = [1, 2]
//! hidden_seeds = [101, 102]
//! visibility = "after_due_date"    # on Gradescope
//! [[criterion]]
//! title = "Stops at 30 cm"
//! metric = "step1.steady_error_m"
//! points = 4
//! full = 0.01                  # all points up to here ...
//! none = 0.05                  # ... none from here on, and in between in proportion
//! advice = "Look at the dead zone of the motors."
//! ```

use super::program;
use super::visibility::Visibility;
use crate::files::read::{Allowed, Placed, Source, Table};
use crate::files::{FileError, Library, Overrides, Setup, bounded, did_you_mean, near};
use crate::metrics::Metrics;
use crate::run::run;
use std::path::{Path, PathBuf};

/// A text in both languages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bilingual {
    /// As written in the file.
    pub text: String,
    /// In Spanish, if the file has it.
    pub spanish: Option<String>,
}

/// An assignment.
#[derive(Clone, Debug, PartialEq)]
pub struct Assignment {
    /// The file's name without `.toml`.
    pub name: String,
    /// One line.
    pub title: Bilingual,
    /// What the students read, in Markdown.
    pub statement: Bilingual,
    /// The full mark.
    pub points: f64,
    /// The least that passes.
    pub pass: f64,
    /// Points lost if every run touches something.
    pub contact_penalty: f64,
    /// Version of the compiler that marks are given with.
    pub compiler: Option<String>,
    /// Version of the Arduino core that marks are given with.
    pub core: Option<String>,
    /// Paths of the sketches that all began with.
    pub given: Vec<PathBuf>,
    /// How long a hand-in may take to compile [s].
    pub compile_s: f64,
    /// The tests.
    pub tests: Vec<GradedTest>,
    /// The rubric.
    pub criteria: Vec<Criterion>,
}

/// A scenario with its seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct GradedTest {
    /// Its name.
    pub name: String,
    /// One line.
    pub title: Bilingual,
    /// What is driven, without a program.
    pub setup: Setup,
    /// Wiring of the Mega; without it, the scenario's own.
    pub wiring: Option<String>,
    /// How much it counts beside the others.
    pub weight: f64,
    /// When students see what it earned, if the file says it.
    pub visibility: Option<Visibility>,
    /// Public seeds.
    pub public: Vec<u64>,
    /// Hidden seeds.
    pub hidden: Vec<u64>,
}

impl GradedTest {
    /// All its seeds, the public ones first.
    pub fn seeds(&self) -> impl Iterator<Item = u64> {
        self.public.iter().chain(&self.hidden).copied()
    }
}

/// A line of the rubric.
#[derive(Clone, Debug, PartialEq)]
pub struct Criterion {
    /// What is asked.
    pub title: Bilingual,
    /// Advice where it is missed.
    pub advice: Bilingual,
    /// What is measured.
    pub metric: String,
    /// The test it is measured in, by its place; all of them if none is named.
    pub test: Option<usize>,
    /// Its points.
    pub points: f64,
    /// The value that earns all of them.
    pub full: f64,
    /// The value that earns none.
    pub none: f64,
    /// When students see what it earned, if the file says it; otherwise as its test.
    pub visibility: Option<Visibility>,
}

impl Criterion {
    /// The share of the points that a value earns; a value that is none, none.
    pub fn share(&self, value: Option<f64>) -> f64 {
        match value {
            Some(value) if value.is_finite() => {
                ((value - self.none) / (self.full - self.none)).clamp(0.0, 1.0)
            }
            _ => 0.0,
        }
    }

    /// Whether it is about this test.
    pub fn is_of(&self, test: usize) -> bool {
        self.test.is_none_or(|own| own == test)
    }
}

const POINTS: Allowed = Allowed::new(0.01, 10_000.0, "");
const PENALTY: Allowed = Allowed::new(0.0, 10_000.0, "");
const VALUE: Allowed = Allowed::new(-1e9, 1e9, "");
const WEIGHT: Allowed = Allowed::new(0.01, 1_000.0, "");
const SECONDS: Allowed = Allowed::new(1.0, 600.0, "s");
const MOST_TESTS: usize = 50;
const MOST_CRITERIA: usize = 100;
const MOST_SEEDS: usize = 1_000;

impl Assignment {
    /// Reads an assignment and all that it names, and drives each of its scenarios once to see what can be measured.
    ///
    /// # Errors
    /// Everything that is wrong with it, by line.
    pub fn read(path: &str) -> Result<Self, FileError> {
        let unreadable =
            |error| FileError::unreadable(path.to_owned(), &error, "the path of an existing file");
        let text = bounded::read_text(Path::new(path)).map_err(unreadable)?;
        Self::parse(path, &text)
    }

    pub(super) fn parse(path: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(path, text);
        let parsed = source.parse()?;
        let root = source.root(&parsed);
        let spanish = root.table("es");
        let library = Library::new().beside(path);
        let tests: Vec<GradedTest> = root
            .tables("scenario", MOST_TESTS)
            .into_iter()
            .filter_map(|table| read_test(&table, &library))
            .collect();
        if tests.is_empty() {
            root.complain_here("nothing is driven: write a [[scenario]] with public_seeds");
        }
        let known: Vec<Metrics> = tests.iter().map(measurable).collect();
        let criteria: Vec<Criterion> = root
            .tables("criterion", MOST_CRITERIA)
            .into_iter()
            .map(|table| read_criterion(&table, &tests, &known))
            .collect();
        if criteria.is_empty() {
            root.complain_here("nothing earns points: write a [[criterion]]");
        }
        let points = root.number("points", POINTS).unwrap_or(100.0);
        let assignment = Self {
            name: Path::new(path)
                .file_stem()
                .map(|stem| stem.to_string_lossy().into_owned())
                .unwrap_or_default(),
            title: words(&root, &spanish, "title", true),
            statement: words(&root, &spanish, "statement", true),
            points,
            pass: root.number("pass", PENALTY).unwrap_or(0.5 * points),
            contact_penalty: root.number("contact_penalty", PENALTY).unwrap_or(0.0),
            compiler: root.text("compiler").map(|placed| placed.value),
            core: root.text("core").map(|placed| placed.value),
            given: read_given(&root, &library),
            compile_s: root.number("compile_s", SECONDS).unwrap_or(30.0),
            tests,
            criteria,
        };
        check_board(&root, &assignment.tests);
        spanish.finish();
        root.finish();
        source.verdict()?;
        Ok(assignment)
    }

    /// When students see a line: as its criterion says, else its test.
    #[must_use]
    pub fn visibility(&self, line: &super::RubricLine) -> Visibility {
        let own = self.criteria[line.criterion].visibility;
        own.or(self.tests[line.test].visibility).unwrap_or_default()
    }

    /// Runs of each hand-in.
    pub fn runs(&self) -> usize {
        self.tests.iter().map(|test| test.seeds().count()).sum()
    }
}

/// A hand-in is compiled once, for the board that all robots of the scenarios have.
fn check_board(root: &Table<'_, '_>, tests: &[GradedTest]) {
    let mut boards = tests.iter().map(|test| test.setup.robot.board.name);
    let named = root.text("board");
    let Some(board) = boards.next() else {
        return;
    };
    if boards.any(|other| other != board) {
        root.complain_here(
            "the robots of its scenarios have different boards: write an assignment for each",
        );
    }
    if let Some(named) = named
        && named.value != board
        && !(named.value == "mega2560" && board == "mega")
    {
        let must = format!("the robots of its scenarios have the board \"{board}\"");
        root.complain("board", named.line, &named.value, &must);
    }
}

/// The paths of `given`, beside the file.
fn read_given(root: &Table<'_, '_>, library: &Library) -> Vec<PathBuf> {
    let what = "a list of paths, e.g. [\"start\"]";
    let Some((_, items)) = root.items("given", what) else {
        return Vec::new();
    };
    let paths = items.iter().filter_map(|item| {
        let path = item
            .value
            .as_str()
            .map(|name| library.path(Path::new(name)));
        if !path.as_ref().is_some_and(|path| path.exists()) {
            let shown = item.value.as_str().unwrap_or("that");
            root.complain(
                "given",
                item.line,
                shown,
                "no such file or folder beside this one",
            );
        }
        path
    });
    paths.collect()
}

/// A text and its Spanish.
fn words(table: &Table<'_, '_>, spanish: &Table<'_, '_>, key: &str, needed: bool) -> Bilingual {
    let text = match needed {
        true => table.required_text(key, "text in quotes").value,
        false => table
            .text(key)
            .map(|placed| placed.value)
            .unwrap_or_default(),
    };
    Bilingual {
        text,
        spanish: spanish.text(key).map(|placed| placed.value),
    }
}

fn read_test(table: &Table<'_, '_>, library: &Library) -> Option<GradedTest> {
    let spanish = table.table("es");
    let named = table.required_text("scenario", "name of a scenario, or the path of its file");
    let title = words(table, &spanish, "title", false);
    let weight = table.number("weight", WEIGHT).unwrap_or(1.0);
    let wiring = table.text("wiring");
    let visibility = Visibility::read(table);
    let public = seeds(table, "public_seeds");
    let hidden = seeds(table, "hidden_seeds");
    if public.is_empty() && table.has("public_seeds") {
        table.complain_here("has no public seed: students need one to try");
    }
    table.require("public_seeds", "a list of whole numbers, e.g. [1, 2]");
    spanish.finish();
    table.finish();
    if named.value.is_empty() {
        return None;
    }
    let overrides = Overrides {
        ground_truth: true,
        ..Overrides::default()
    };
    let setup = match library.setup(&named.value, &overrides) {
        Ok(setup) => setup,
        Err(error) => {
            for line in error.to_string().lines() {
                table.complain("scenario", named.line, &named.value, line);
            }
            return None;
        }
    };
    if let Some(Placed { value, line }) = &wiring
        && !setup.robot.wirings.contains_key(value)
    {
        let known: Vec<String> = setup.robot.wirings.keys().cloned().collect();
        table.complain("wiring", *line, value, &did_you_mean(&known));
    }
    Some(GradedTest {
        name: setup.scenario.name.clone(),
        title: match title.text.is_empty() {
            true => Bilingual {
                text: setup.scenario.title.clone(),
                ..title
            },
            false => title,
        },
        setup,
        wiring: wiring.map(|placed| placed.value),
        weight,
        visibility,
        public,
        hidden,
    })
}

fn seeds(table: &Table<'_, '_>, key: &str) -> Vec<u64> {
    let Some((line, items)) = table.items(key, "a list of whole numbers, e.g. [1, 2]") else {
        return Vec::new();
    };
    if items.len() > MOST_SEEDS {
        let remedy = format!("at most {MOST_SEEDS} of them are driven");
        table.complain(key, line, &format!("{} seeds", items.len()), &remedy);
        return Vec::new();
    }
    let allowed = Allowed::new(0.0, 4_294_967_295.0, "");
    let mut seeds = Vec::new();
    for item in items {
        match table.judge_number(key, item.line, item.value, allowed) {
            Some(seed) if seed.fract() == 0.0 => seeds.push(seed as u64),
            Some(seed) => table.complain(key, item.line, &seed.to_string(), "must be whole"),
            None => {}
        }
    }
    seeds
}

/// The metrics that a run of a test yields; none if it cannot be run, which its hand-ins will report.
fn measurable(test: &GradedTest) -> Metrics {
    let seed = test.seeds().next().unwrap_or(1);
    run(&test.setup, seed)
        .map(|result| result.metrics)
        .unwrap_or_default()
}

fn read_criterion(table: &Table<'_, '_>, tests: &[GradedTest], known: &[Metrics]) -> Criterion {
    let spanish = table.table("es");
    let metric = table.required_text("metric", "name of a metric, e.g. \"step1.settling_s\"");
    let of = table.text("scenario");
    let test = of.as_ref().and_then(|of| {
        let found = tests.iter().position(|test| test.name == of.value);
        if found.is_none() {
            let names = tests.iter().map(|test| test.name.as_str());
            let near: Vec<String> = near::near_or_all(&of.value, names);
            let remedy = format!("no [[scenario]] of this name; {}", did_you_mean(&near));
            table.complain("scenario", of.line, &of.value, &remedy);
        }
        found
    });
    let criterion = Criterion {
        title: words(table, &spanish, "title", true),
        advice: words(table, &spanish, "advice", false),
        metric: metric.value.clone(),
        test,
        points: table.required_number("points", POINTS),
        full: table.required_number("full", VALUE),
        none: table.required_number("none", VALUE),
        visibility: Visibility::read(table),
    };
    if criterion.full == criterion.none && table.has("full") && table.has("none") {
        table.complain_here("full and none are the same: nothing lies between");
    }
    if let Some(remedy) = not_measured(&criterion, known) {
        table.complain("metric", metric.line, &metric.value, &remedy);
    }
    spanish.finish();
    table.finish();
    criterion
}

/// Suggestion for a metric that some test lacks, or that the program reports itself.
fn not_measured(criterion: &Criterion, known: &[Metrics]) -> Option<String> {
    let metric = criterion.metric.as_str();
    if metric == "telemetry_hz" || metric.contains("odometry") {
        return Some("is what the program says of itself; marks come from ground truth".into());
    }
    if program::is_of_program(metric) {
        return program::unknown(metric);
    }
    let tests = known.iter().enumerate();
    let lacking = tests
        .filter(|(test, metrics)| criterion.is_of(*test) && !metrics.is_empty())
        .find(|(_, metrics)| !metric.is_empty() && !metrics.contains_key(metric));
    let (_, metrics) = lacking?;
    let names = near::near_or_all(metric, metrics.keys().map(String::as_str));
    Some(format!(
        "no such metric in its scenario; {}",
        did_you_mean(&names)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fall_from_full_to_none_whichever_is_larger_and_never_earns_none() {
        let criterion = |full, none| Criterion {
            title: Bilingual::default(),
            advice: Bilingual::default(),
            metric: "m".into(),
            test: None,
            points: 1.0,
            full,
            none,
            visibility: None,
        };
        let less_is_better = criterion(1.0, 3.0);
        let shares = [0.0, 1.0, 1.5, 3.0, 9.0].map(|value| less_is_better.share(Some(value)));
        assert_eq!(shares, [1.0, 1.0, 0.75, 0.0, 0.0]);
        let more_is_better = criterion(1.0, 0.0);
        let shares = [0.0, 0.5, 1.0, 2.0].map(|value| more_is_better.share(Some(value)));
        assert_eq!(shares, [0.0, 0.5, 1.0, 1.0]);
        for never in [None, Some(f64::NAN), Some(f64::INFINITY)] {
            assert_eq!(more_is_better.share(never), 0.0);
        }
    }
}
