//! The report as a whole: complete, self-contained, translated, and the same each time.

#![allow(clippy::unwrap_used)]

use rumbo_experiment::files::{Library, NativeProgram, Overrides};
use rumbo_report::real::{NotShown, Real, read};
use rumbo_report::text::Language;
use rumbo_report::{Data, Plan, Request, html};
use rumbo_wire::text::RowKind;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;

/// Figures of the original report, each by the chapter in which ours must have it.
const FIGURES: &str = include_str!("figures.txt");

/// All experiments, run once for all tests.
fn data() -> &'static Data {
    static DATA: OnceLock<Data> = OnceLock::new();
    DATA.get_or_init(run)
}

fn run() -> Data {
    run_beside(Real::default())
}

fn run_beside(real: Real) -> Data {
    let request = Request {
        seed: 1,
        real,
        ..Request::default()
    };
    Plan::new(&Library::new(), request)
        .unwrap()
        .run(|_| {})
        .unwrap()
}

/// The texts between tags, style sheet, formulas and names of the program left out.
fn texts(page: &str) -> Vec<String> {
    let mut texts = Vec::new();
    let (mut rest, mut hidden) = (page, None::<&str>);
    while let Some(open) = rest.find('<') {
        let text = rest[..open].trim();
        if hidden.is_none() && !text.is_empty() {
            texts.push(text.to_owned());
        }
        let close = rest[open..].find('>').unwrap() + open;
        let tag = &rest[open + 1..close];
        for name in ["style", "code", "math", "title"] {
            if tag.split(' ').next() == Some(name) {
                hidden = hidden.or(Some(name));
            } else if tag.strip_prefix('/') == Some(name) && hidden == Some(name) {
                hidden = None;
            }
        }
        if let Some(label) = tag.split("aria-label=\"").nth(1) {
            texts.push(label.split('"').next().unwrap().to_owned());
        }
        rest = &rest[close + 1..];
    }
    texts
}

#[test]
fn both_languages_have_every_figure_of_the_original_report() {
    for language in [Language::English, Language::Spanish] {
        let (page, figures) = html(data(), language).unwrap();
        for figure in FIGURES.lines() {
            assert!(
                figures.iter().any(|id| id == figure),
                "{language:?}: {figure}"
            );
            assert_eq!(
                page.matches(&format!("id=\"fig-{figure}\"")).count(),
                1,
                "{figure}"
            );
        }
    }
}

#[test]
fn every_experiment_meets_its_limits() {
    for outcome in data().outcomes.values() {
        assert!(
            outcome.result.pass,
            "{}: {:?}",
            outcome.result.scenario, outcome.result.failures
        );
    }
}

#[test]
fn the_report_of_another_program_has_no_word_of_our_controller() {
    let request = Request {
        only: ["mode1", "mode5", "mode6"].map(str::to_owned).into(),
        seed: 1,
        overrides: Overrides {
            program: NativeProgram::Baseline,
            ..Overrides::default()
        },
        ..Request::default()
    };
    let plan = Plan::new(&Library::new(), request).unwrap();
    let data = plan.run(|_| {}).unwrap();
    let ours = ["scheme", "law", "variable"];
    for (language, words, note) in [
        (
            Language::English,
            [
                "Control scheme",
                "speed loop",
                "feedforward",
                "far and a near part",
            ],
            "Another program than Rumbo",
        ),
        (
            Language::Spanish,
            [
                "Esquema de control",
                "lazo de velocidad",
                "prealimentación",
                "parte lejana",
            ],
            "un programa que no es de Rumbo",
        ),
    ] {
        let (page, figures) = html(&data, language).unwrap();
        let shown = figures
            .iter()
            .find(|name| ours.iter().any(|part| name.ends_with(part)));
        assert_eq!(shown, None, "{language:?}");
        for word in words {
            assert!(!page.contains(word), "{language:?}: {word}");
            assert!(page.contains(note), "{language:?}");
        }
        assert!(html(self::data(), language).unwrap().0.contains(words[0]));
    }
}

/// A recorded run of each experiment that can have one, and a file that is shown nowhere.
fn recordings() -> Real {
    let folder = tempfile::tempdir().unwrap();
    for (name, kind, row) in [
        ("mode1", RowKind::Distance, "900,60,60,50,1,80,80"),
        ("mode2", RowKind::Distance, "900,60,60,50,2,80,80"),
        ("mode3", RowKind::Distance, "900,60,60,60,3,80,80"),
        ("mode4", RowKind::Distance, "900,60,60,50,4,80,80"),
        ("mode5", RowKind::Speed, "900,50,50,60,5,80,80"),
        ("mode6", RowKind::Speed, "900,40,40,40,6,80,80"),
        ("mode7", RowKind::Waypoints, "900,40,40,40,40,0,0,0,80,80"),
        (
            "goals",
            RowKind::Mission,
            "900,40,40,0,1,1,0,0,0,3,90,90,90",
        ),
        ("lane", RowKind::Mission, "900,40,40,0,0,0,0,0,0,0,30,30,90"),
        ("boxes", RowKind::Mission, "900,0,0,0,1,1,0,0,0,4,90,90,30"),
    ] {
        let columns: Vec<_> = kind.columns().iter().map(|column| column.name).collect();
        let text = format!("{}\n{row}\n{row}\n{row}\n", columns.join(","));
        std::fs::write(folder.path().join(format!("{name}.csv")), text).unwrap();
    }
    std::fs::write(folder.path().join("other.csv"), "time,value\n1,2\n").unwrap();
    read(folder.path(), |_| Err(NotShown::NoLog)).unwrap()
}

#[test]
fn every_chapter_has_its_place_for_a_recorded_run_in_both_languages() {
    let real = recordings();
    let recorded: Vec<_> = real.runs.keys().copied().collect();
    assert_eq!(recorded.len(), 10, "{recorded:?}");
    let data = run_beside(real);
    for language in [Language::English, Language::Spanish] {
        let (page, figures) = html(&data, language).unwrap();
        for scenario in &recorded {
            assert!(
                figures.contains(&format!("{scenario}-real")),
                "{language:?}: {scenario}"
            );
        }
        assert!(
            page.contains("other.csv") && !page.contains("{{"),
            "{language:?}"
        );
    }
}

#[test]
fn figures_have_the_same_numbers_in_both_languages() {
    let [english, spanish] =
        [Language::English, Language::Spanish].map(|language| html(data(), language).unwrap().1);
    assert_eq!(english, spanish);
}

#[test]
fn nothing_in_the_page_comes_from_elsewhere() {
    for language in [Language::English, Language::Spanish] {
        let (page, _) = html(data(), language).unwrap();
        for outside in [
            "http:", "https:", "//", "src=", "@import", "url(", "<script",
        ] {
            assert!(!page.contains(outside), "{outside}");
        }
    }
}

#[test]
fn the_same_runs_give_the_same_bytes() {
    let again = run();
    for language in [Language::English, Language::Spanish] {
        assert!(html(data(), language).unwrap() == html(&again, language).unwrap());
    }
}

/// Words that are the same in both languages.
const SAME: &[&str] = &[
    "Arduino Mega 2560",
    "Robot",
    "memoria",
    "robot",
    "error (cm)",
    "error (rpm)",
    "anti-windup",
    "motor",
    "ideal",
    "TRIG",
    "ECHO",
    "L298N",
    "L298N,",
    "TRIG",
    "ECHO",
    "L298N",
    concat!("Rumbo ", env!("CARGO_PKG_VERSION")),
];

#[test]
fn no_text_is_left_in_the_other_language() {
    let [english, spanish] = [Language::English, Language::Spanish]
        .map(|language| texts(&html(data(), language).unwrap().0));
    let english: BTreeSet<_> = english.into_iter().collect();
    let words = |text: &str| {
        text.split(|letter: char| !letter.is_alphabetic())
            .any(|word| word.chars().count() > 3)
    };
    let mut left: Vec<_> = spanish
        .iter()
        .filter(|text| words(text) && english.contains(*text) && !SAME.contains(&text.as_str()))
        .collect();
    left.dedup();
    assert!(left.is_empty(), "in both languages: {left:#?}");
}

#[test]
fn spanish_has_one_word_for_one_thing() {
    // lazo for a control loop, referencia for a setpoint, punto de paso for a waypoint.
    let others = ["bucle", "consigna", "ordenada ", "waypoint"];
    for text in texts(&html(data(), Language::Spanish).unwrap().0) {
        let text = text.to_lowercase();
        assert!(!others.iter().any(|other| text.contains(other)), "{text}");
    }
}

#[test]
fn spanish_numbers_have_decimal_commas() {
    let digit = |letter: Option<char>| letter.is_some_and(|letter| letter.is_ascii_digit());
    for text in texts(&html(data(), Language::Spanish).unwrap().0) {
        let letters: Vec<char> = text.chars().collect();
        let point = (1..letters.len()).find(|at| {
            letters[*at] == '.'
                && digit(letters.get(at - 1).copied())
                && digit(letters.get(at + 1).copied())
        });
        // Numbers of figures and of the version have points.
        let allowed = text.starts_with("Figura ") || text.starts_with("Rumbo ");
        assert!(point.is_none() || allowed, "{text}");
    }
}

#[test]
fn every_formula_is_set() {
    for language in [Language::English, Language::Spanish] {
        let (page, _) = html(data(), language).unwrap();
        // What could not be converted would stand there as TeX.
        assert!(
            !page.contains('\\') && page.contains("<math"),
            "{language:?}"
        );
    }
}

/// The page's text without numbers: a change shows as a small readable difference. `RUMBO_BLESS=1` rewrites it.
#[test]
fn the_outline_is_as_before() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden");
    for language in [Language::English, Language::Spanish] {
        let path = folder.join(format!("report-{}.txt", language.tag()));
        let mut outline = String::new();
        for text in texts(&html(data(), language).unwrap().0) {
            let text = text.replace(
                |letter: char| letter.is_ascii_digit() || ".,\u{2212}".contains(letter),
                "",
            );
            if text.chars().filter(|letter| letter.is_alphabetic()).count() > 3 {
                writeln!(outline, "{}", text.trim()).unwrap();
            }
        }
        if std::env::var_os("RUMBO_BLESS").is_some() {
            std::fs::write(&path, &outline).unwrap();
        }
        let golden = std::fs::read_to_string(&path).unwrap_or_default();
        let differs = outline
            .lines()
            .zip(golden.lines())
            .find(|(now, before)| now != before);
        assert!(
            outline == golden,
            "{}: first difference {differs:?}; if it is meant, run with RUMBO_BLESS=1",
            path.display()
        );
    }
}
