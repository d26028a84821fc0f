//! Which hand-ins are alike.

use super::hand_ins::Found;
use crate::failure::Failure;
use rumbo_experiment::grade::Assignment;
use rumbo_report::alike::{AlikeHandIns, pair};
use rumbo_report::text::Language;
use rumbo_sketch::similar::{Pair, similar, text_of};
use rumbo_sketch::{Given, given};

/// The pairs of hand-ins that are alike.
pub(super) struct Likeness {
    names: Vec<String>,
    texts: Vec<String>,
    pairs: Vec<Pair>,
}

impl Likeness {
    /// Looks for them, without what all were given.
    pub(super) fn among(found: &[Found], assignment: &Assignment) -> Result<Self, Failure> {
        let mut start = Vec::new();
        for path in &assignment.given {
            if let Given::Sketch(source) = given(path, true)? {
                start.push(text_of(&source));
            }
        }
        let sketches = found
            .iter()
            .filter_map(|one| Some((one.name().to_owned(), one.text()?)));
        let (names, texts): (Vec<_>, Vec<_>) = sketches.unzip();
        let pairs = similar(&texts, &start);
        Ok(Self {
            names,
            texts,
            pairs,
        })
    }

    fn all(&self) -> impl Iterator<Item = AlikeHandIns<'_>> {
        self.pairs.iter().map(|Pair { of, share, lines }| {
            let side = |at: usize| {
                let own = of[at];
                (
                    self.names[own].as_str(),
                    self.texts[own].as_str(),
                    &lines[at],
                )
            };
            AlikeHandIns {
                of: [side(0), side(1)],
                share: *share,
            }
        })
    }

    /// A line for each pair.
    pub(super) fn in_words(&self, language: Language) -> impl Iterator<Item = String> {
        self.all().map(move |alike| alike.in_words(language))
    }

    /// The same with a page for each.
    pub(super) fn pages(
        &self,
        assignment: &Assignment,
        language: Language,
    ) -> impl Iterator<Item = (String, String)> {
        self.all()
            .map(move |alike| (alike.in_words(language), pair(assignment, &alike, language)))
    }
}
