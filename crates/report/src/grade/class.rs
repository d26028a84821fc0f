//! The teacher's page: marks, their distribution, the rubric's shares, hand-ins that are alike.

use super::{ASKED, NOTES, POINTS, list, of};
use crate::summary::{figure, heading, shell};
use crate::table::{Cell, Tone, table};
use crate::text::{Language, Text, escape, word};
use rumbo_experiment::grade::{Assignment, Mark};
use rumbo_experiment::note::Note;
use rumbo_plot::{Curve, Ink, Panel, Plot, Points};

pub(super) const CLASS: Text = word("class");
const MARKS: Text = word("marks");
const DISTRIBUTION: Text = word("distribution");
const HAND_INS: Text = word("hand-ins");
const HAND_IN: Text = word("hand-in");
const RUBRIC: Text = word("rubric-of-the-class");
const CLASS_FACTS: Text = word("class-facts");
const MEAN_SHARE: Text = word("mean-share");
const SIMILAR: Text = word("similar-hand-ins");

/// The page of the class. `links` are the addresses of the hand-ins' pages, `alike` what is said of hand-ins that are alike
/// and the addresses of those pages.
#[must_use]
pub fn class(
    assignment: &Assignment,
    marks: &[Mark],
    notes: &[Note],
    language: Language,
    links: &[String],
    alike: &[(String, String)],
) -> String {
    let mut body = list(language, NOTES, notes);
    body += &heading(DISTRIBUTION.of(language));
    body += &distribution(assignment, marks, language);
    body += &heading(MARKS.of(language));
    let mut header = vec![HAND_IN.of(language), POINTS.of(language)];
    header.extend(
        assignment
            .criteria
            .iter()
            .map(|one| of(language, &one.title)),
    );
    let rows = std::iter::zip(marks, links);
    let rows = rows.map(|(mark, link)| row(assignment, mark, language, link));
    body += &table(&header, &rows.collect::<Vec<_>>());
    if !alike.is_empty() {
        body += &heading(SIMILAR.of(language));
        let items = alike.iter();
        let items = items.map(|(words, link)| format!("<li>{}</li>\n", anchor(link, words)));
        body += &format!("<ul>\n{}</ul>\n", items.collect::<String>());
    }
    body += &heading(RUBRIC.of(language));
    body += &rubric(assignment, marks, language);
    shell(
        language,
        of(language, &assignment.title),
        CLASS.of(language),
        &body,
    )
}

fn anchor(link: &str, words: &str) -> String {
    let (link, words) = (escape(link), escape(words));
    format!("<a href=\"{link}#class\">{words}</a>")
}

/// A hand-in in the table of the class.
fn row(assignment: &Assignment, mark: &Mark, language: Language, link: &str) -> Vec<Cell> {
    let tone = if mark.pass { Tone::Good } else { Tone::Bad };
    let points = |number: usize| {
        let own = mark.lines.iter().filter(|line| line.criterion == number);
        let points: f64 = own.map(|line| line.points).sum();
        match mark.refused.is_empty() {
            true => Cell::text(&language.number(points, 2)),
            false => Cell::text("–"),
        }
    };
    let name = Cell::html(anchor(link, &mark.name));
    let sum = Cell::text(&language.number(mark.points, 2)).tone(tone);
    let parts = (0..assignment.criteria.len()).map(points);
    [name, sum].into_iter().chain(parts).collect()
}

/// Distribution of the hand-ins over the points, in tenths of the full mark.
fn distribution(assignment: &Assignment, marks: &[Mark], language: Language) -> String {
    const BINS: usize = 10;
    let mut counts = [0usize; BINS];
    for mark in marks {
        let bin = (BINS as f64 * mark.points / assignment.points) as usize;
        counts[bin.min(BINS - 1)] += 1;
    }
    let width = assignment.points / BINS as f64;
    let mut bars = Points::new();
    for (bin, count) in counts.iter().enumerate() {
        let (from, to) = (bin as f64 * width, (bin + 1) as f64 * width);
        let count = *count as f64;
        bars.extend([(from, 0.0), (from, count), (to, count), (to, 0.0)]);
    }
    let highest = counts.iter().max().copied().unwrap_or(0).max(1) as f64;
    let panel = Panel::new(
        HAND_INS.of(language),
        vec![Curve::new("", Ink::First, bars)],
    );
    let svg = Plot {
        x: POINTS.of(language).to_owned(),
        x_range: Some([0.0, assignment.points]),
        panels: vec![panel.exactly(0.0, 1.08 * highest)],
    }
    .svg(language);
    let mut points: Vec<f64> = marks.iter().map(|mark| mark.points).collect();
    points.sort_by(f64::total_cmp);
    let count = points.len().max(1);
    let mean = points.iter().sum::<f64>() / count as f64;
    let median =
        0.5 * (points.get((count - 1) / 2).unwrap_or(&0.0) + points.get(count / 2).unwrap_or(&0.0));
    let pass = marks.iter().filter(|mark| mark.pass).count();
    let facts = [
        ("count", marks.len().to_string()),
        ("mean", language.number(mean, 2)),
        ("median", language.number(median, 2)),
        ("pass", pass.to_string()),
    ];
    let facts = CLASS_FACTS.with(language, &facts);
    format!("<p>{}</p>\n{}", escape(&facts), figure(&svg, &facts))
}

/// The class's share of the points of each criterion, the most lost first.
fn rubric(assignment: &Assignment, marks: &[Mark], language: Language) -> String {
    let share = |number: usize| {
        let lines = marks.iter().flat_map(|mark| &mark.lines);
        let own = lines.filter(|line| line.criterion == number);
        let (points, of) = own.fold((0.0, 0.0), |(points, of), line| {
            (points + line.points, of + line.of)
        });
        if of > 0.0 { points / of } else { 0.0 }
    };
    let mut shares: Vec<(usize, f64)> = (0..assignment.criteria.len())
        .map(|number| (number, share(number)))
        .collect();
    shares.sort_by(|one, other| one.1.total_cmp(&other.1));
    let rows: Vec<Vec<Cell>> = shares
        .into_iter()
        .map(|(number, share)| {
            let title = of(language, &assignment.criteria[number].title);
            let share = format!("{} %", language.number(100.0 * share, 0));
            vec![Cell::text(title), Cell::text(&share)]
        })
        .collect();
    table(&[ASKED.of(language), MEAN_SHARE.of(language)], &rows)
}
