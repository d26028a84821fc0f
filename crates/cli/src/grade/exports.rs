//! Marks for other programs: a gradebook's CSV, JUnit XML for continuous integration, Gradescope's `results.json`. Keys
//! and what programs read are English; Gradescope shows students its texts, which are in the language of the pages.

use crate::export::text_cell;
use crate::failure::Failure;
use crate::junit::{Case, Suite, document};
use rumbo_experiment::grade::{Assignment, Mark};
use rumbo_report::Stamp;
use rumbo_report::grade::{earned_in_words, noted, of, seeds_in_words};
use rumbo_report::text::Language;
use serde_json::json;

/// A row for each hand-in: points, and those of each criterion.
pub(super) fn csv(assignment: &Assignment, marks: &[Mark]) -> String {
    let mut header: Vec<String> = ["name", "points", "of", "passed"].map(str::to_owned).into();
    header.extend(assignment.criteria.iter().map(|one| one.title.text.clone()));
    header.extend(["contact_penalty", "note"].map(str::to_owned));
    let mut rows = vec![header];
    for mark in marks {
        let mut row = vec![
            mark.name.clone(),
            format!("{:.2}", mark.points),
            format!("{}", mark.of),
            mark.pass.to_string(),
        ];
        row.extend((0..assignment.criteria.len()).map(|number| {
            let own = mark.lines.iter().filter(|line| line.criterion == number);
            format!("{:.2}", own.map(|line| line.points).sum::<f64>())
        }));
        row.push(format!("{:.2}", mark.penalty));
        let note = mark.refused.iter().chain(&mark.ended).next();
        row.push(note.cloned().unwrap_or_default());
        rows.push(row);
    }
    let line = |row: &Vec<String>| {
        row.iter()
            .map(|text| text_cell(text))
            .collect::<Vec<_>>()
            .join(",")
    };
    rows.iter().map(|row| line(row) + "\r\n").collect()
}

/// A suite for each hand-in, a case for each line of the rubric; one without all its points has failed.
pub(super) fn junit(assignment: &Assignment, marks: &[Mark], stamp: &Stamp) -> String {
    let suites = marks.iter().map(|mark| {
        let cases = mark.lines.iter().map(|line| {
            let refused = mark.refused.first().cloned();
            let why = || earned_in_words(assignment, line, Language::English);
            Case {
                class: assignment.tests[line.test].name.clone(),
                name: assignment.criteria[line.criterion].title.text.clone(),
                failure: refused.or_else(|| (!line.is_full()).then(why)),
            }
        });
        Suite {
            name: mark.name.clone(),
            cases: cases.collect(),
        }
    });
    let suites: Vec<Suite> = suites.collect();
    document(&assignment.title.text, &suites, stamp)
}

/// A hand-in's `results.json`, its texts in a language.
pub(super) fn gradescope(
    assignment: &Assignment,
    mark: &Mark,
    notes: &[String],
    language: Language,
    stamp: &Stamp,
) -> Result<String, Failure> {
    let tests: Vec<_> = mark
        .lines
        .iter()
        .map(|line| {
            let criterion = &assignment.criteria[line.criterion];
            let advice = match line.is_full() {
                true => "",
                false => of(language, &criterion.advice),
            };
            let earned = earned_in_words(assignment, line, language);
            json!({
                "name": of(language, &criterion.title),
                "score": cents(line.points),
                "max_score": cents(line.of),
                "status": if line.is_full() { "passed" } else { "failed" },
                "extra_data": { "metric": criterion.metric },
                "output": format!("{earned}\n{advice}").trim_end(),
            })
        })
        .collect();
    let text = [notes, &mark.notes, &mark.refused, &mark.ended].concat();
    let text = text.iter().map(|line| noted(language, line));
    let seeds = std::iter::once(seeds_in_words(assignment, language));
    let text: Vec<_> = seeds.chain(text).collect();
    let results = json!({
        "extra_data": { "made_by": stamp.text() },
        "score": mark.points,
        "output": text.join("\n"),
        "visibility": "visible",
        "tests": tests,
    });
    let mut text = serde_json::to_string_pretty(&results).map_err(Failure::input)?;
    text.push('\n');
    Ok(text)
}

fn cents(points: f64) -> f64 {
    (100.0 * points).round() / 100.0
}
