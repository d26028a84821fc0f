//! Gradescope's `results.json` of a hand-in. Keys are English; its texts, which students read, are in the language of the
//! pages. Form: <https://gradescope-autograders.readthedocs.io/en/latest/specs/>.

use crate::failure::Failure;
use rumbo_experiment::grade::{Assignment, Mark};
use rumbo_experiment::note::Note;
use rumbo_report::FileStamp;
use rumbo_report::grade::{earned_in_words, noted, of, place_in_words, seeds_in_words};
use rumbo_report::text::Language;
use serde_json::json;

/// A hand-in's `results.json`, its texts in a language.
pub(super) fn results(
    assignment: &Assignment,
    mark: &Mark,
    notes: &[Note],
    language: Language,
    stamp: &FileStamp,
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
            let place = place_in_words(line, language);
            let mut said = vec![earned.as_str(), &place, advice];
            said.retain(|line| !line.is_empty());
            json!({
                "name": of(language, &criterion.title),
                "score": cents(line.points),
                "max_score": cents(line.of),
                "status": if line.is_full() { "passed" } else { "failed" },
                "extra_data": { "metric": criterion.metric },
                "visibility": assignment.visibility(line).name(),
                "output": said.join("\n"),
            })
        })
        .collect();
    let mut text = vec![seeds_in_words(assignment, language)];
    let said = |note: &Note| noted(language, note);
    text.extend(notes.iter().chain(&mark.notes).map(said));
    text.extend(mark.refused.iter().cloned());
    text.extend(mark.ended.iter().map(said));
    let results = json!({
        "extra_data": { "made_by": stamp.text() },
        "score": mark.points,
        "output": text.join("\n"),
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "tests": tests,
    });
    let mut text = serde_json::to_string_pretty(&results).map_err(Failure::input)?;
    text.push('\n');
    Ok(text)
}

fn cents(points: f64) -> f64 {
    (100.0 * points).round() / 100.0
}
