//! Marks for other programs: a gradebook's CSV, JUnit XML for continuous integration. Both are English.

use crate::export::text_cell;
use crate::junit::{Case, Suite, document};
use rumbo_experiment::grade::{Assignment, Mark};
use rumbo_report::FileStamp;
use rumbo_report::grade::earned_in_words;
use rumbo_report::text::Language;

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
        row.push(mark.why_not().unwrap_or_default());
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
pub(super) fn junit(assignment: &Assignment, marks: &[Mark], stamp: &FileStamp) -> String {
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
