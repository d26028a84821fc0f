//! The page of two hand-ins that are alike.

use crate::grade::{back, of};
use crate::summary::shell;
use crate::text::{Language, Text, escape, put, word};
use rumbo_experiment::grade::Assignment;
use std::collections::BTreeSet;

const SIMILAR_OF: Text = word("similar-of");
const PROVES_NOTHING: Text = word("similar-proves-nothing");

/// Two hand-ins that are alike.
#[derive(Clone, Debug)]
pub struct AlikeHandIns<'a> {
    /// Name, text, and the lines that the other has too, from 0, of each.
    pub of: [(&'a str, &'a str, &'a BTreeSet<usize>); 2],
    /// The share of the shorter text that the other has too, 0 to 1.
    pub share: f64,
}

impl AlikeHandIns<'_> {
    /// Who and how much, in a line.
    #[must_use]
    pub fn in_words(&self, language: Language) -> String {
        let [(one, ..), (other, ..)] = self.of;
        let share = self.percent(language);
        SIMILAR_OF.with(
            language,
            &[("one", one), ("other", other), ("share", &share)],
        )
    }

    fn percent(&self, language: Language) -> String {
        language.number(100.0 * self.share, 0)
    }
}

/// The page of two hand-ins that are alike: both texts side by side, what they have in common marked.
#[must_use]
pub fn pair(assignment: &Assignment, alike: &AlikeHandIns<'_>, language: Language) -> String {
    let share = alike.percent(language);
    let said = PROVES_NOTHING.with(language, &[("share", &share)]);
    let mut body = format!(
        "{}<p class=\"note\">{}</p>\n<div class=\"side\">\n",
        back(language),
        escape(&said)
    );
    for (name, text, common) in alike.of {
        let lines = text.lines().enumerate().map(|(number, line)| {
            // What a terminal would obey is shown as what it is: no text.
            let plain = |c: char| {
                if c.is_control() && c != '\t' {
                    '\u{fffd}'
                } else {
                    c
                }
            };
            let line: String = line.chars().map(plain).collect();
            let line = escape(&line);
            match common.contains(&number) {
                true => format!("<mark>{line}</mark>\n"),
                false => line + "\n",
            }
        });
        let lines: String = lines.collect();
        put(
            &mut body,
            format_args!(
                "<section><h2>{}</h2><pre>{lines}</pre></section>\n",
                escape(name)
            ),
        );
    }
    body += "</div>\n";
    let title = of(language, &assignment.title);
    shell(language, title, &alike.in_words(language), &body)
}
