//! The page being built: chapters with their entries in the table of contents, numbered figures, formulas.

use crate::text::{Language, Text, escape, word};
use math_core::{LatexToMathML, MathCoreConfig, MathDisplay};

/// A page being built.
pub(crate) struct Page {
    language: Language,
    contents: Vec<(String, String)>,
    chapter: String,
    figures: usize,
    /// Each figure's identifier.
    ids: Vec<String>,
    math: Option<LatexToMathML>,
}

const FIGURE: Text = word("figure");

impl Page {
    pub(crate) fn new(language: Language) -> Self {
        Self {
            language,
            contents: Vec::new(),
            chapter: String::new(),
            figures: 0,
            ids: Vec::new(),
            math: LatexToMathML::new(spanish_functions()).ok(),
        }
    }

    pub(crate) fn language(&self) -> Language {
        self.language
    }

    /// A chapter begins: its number counts the figures from here on.
    pub(crate) fn begin(&mut self, number: &str) {
        number.clone_into(&mut self.chapter);
        self.figures = 0;
    }

    /// A chapter's place in the table of contents.
    pub(crate) fn enter(&mut self, name: &str, title: String) {
        self.contents.push((name.to_owned(), title));
    }

    /// A figure; `caption` is HTML, `description` its text for screen readers. Its identifier is the same in every
    /// language.
    pub(crate) fn figure(
        &mut self,
        id: &str,
        svg: &str,
        caption: &str,
        description: &str,
    ) -> String {
        self.figures += 1;
        self.ids.push(id.to_owned());
        let label = format!("<svg role=\"img\" aria-label=\"{}\"", escape(description));
        let svg = svg.replacen("<svg", &label, 1);
        let name = FIGURE.of(self.language);
        let number = format!("{name} {}.{}", self.chapter, self.figures);
        format!(
            "<figure id=\"fig-{id}\"><div class=\"wide\" tabindex=\"0\">{svg}</div><figcaption><b>{number}.</b> {caption}</figcaption></figure>\n"
        )
    }

    /// Each figure's identifier, in order.
    pub(crate) fn figure_ids(&self) -> &[String] {
        &self.ids
    }

    /// Links to the chapters so far.
    pub(crate) fn contents(&self) -> String {
        let entries = self
            .contents
            .iter()
            .map(|(id, title)| format!("<li><a href=\"#{id}\">{title}</a></li>\n"));
        format!("<nav><ul>\n{}</ul>\n</nav>\n", entries.collect::<String>())
    }

    /// A formula in TeX as MathML; `None` where it is none.
    pub(crate) fn mathml(&self, tex: &str, display: MathDisplay) -> Option<String> {
        let converted = self.math.as_ref()?.convert_with_local_state(tex, display);
        converted.ok().map(|result| result.mathml)
    }
}

/// Names of functions that TeX has in English only.
fn spanish_functions() -> MathCoreConfig {
    let named = |name: &str| (name.to_owned(), format!(r"\operatorname{{{name}}}"));
    MathCoreConfig {
        macros: vec![named("sen"), named("arcsen")],
        ..MathCoreConfig::default()
    }
}
