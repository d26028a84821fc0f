//! The page under way: headings with their places in the table of contents, paragraphs, formulas, tables, numbered figures.

use crate::text::{Language, Text, escape, put, t};
use math_core::{LatexToMathML, MathCoreConfig, MathDisplay};

/// A page under way.
pub(crate) struct Page {
    /// What it is written in.
    pub(crate) language: Language,
    body: String,
    contents: Vec<(String, String)>,
    chapter: String,
    figures: usize,
    /// Each figure's identifier.
    ids: Vec<String>,
    math: Option<LatexToMathML>,
}

const FIGURE: Text = t("Figure", "Figura");

/// Whether a cell is good news.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tone {
    Plain,
    Good,
    Bad,
}

/// A cell of a table.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    /// HTML.
    html: String,
    tone: Tone,
}

impl Cell {
    pub(crate) fn text(text: &str) -> Self {
        Self {
            html: escape(text),
            tone: Tone::Plain,
        }
    }

    pub(crate) fn html(html: String) -> Self {
        Self {
            html,
            tone: Tone::Plain,
        }
    }

    pub(crate) fn tone(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }
}

impl Page {
    pub(crate) fn new(language: Language) -> Self {
        Self {
            language,
            body: String::new(),
            contents: Vec::new(),
            chapter: String::new(),
            figures: 0,
            ids: Vec::new(),
            math: LatexToMathML::new(spanish_functions()).ok(),
        }
    }

    /// What of a text this page shows.
    pub(crate) fn say(&self, text: Text) -> &'static str {
        text.of(self.language)
    }

    /// A chapter; its number counts its figures.
    pub(crate) fn chapter(&mut self, number: &str, id: &str, title: Text) {
        number.clone_into(&mut self.chapter);
        self.figures = 0;
        let title = format!("{number}. {}", escape(self.say(title)));
        put(
            &mut self.body,
            format_args!("<h2 id=\"{id}\">{title}</h2>\n"),
        );
        self.contents.push((id.to_owned(), title));
    }

    pub(crate) fn section(&mut self, title: Text) {
        put(
            &mut self.body,
            format_args!("<h3>{}</h3>\n", escape(title.of(self.language))),
        );
    }

    pub(crate) fn subsection(&mut self, title: &str) {
        put(&mut self.body, format_args!("<h4>{}</h4>\n", escape(title)));
    }

    /// A paragraph. Between dollar signs stands a formula, between backquotes a name of the program, between asterisks what is stressed.
    pub(crate) fn p(&mut self, text: Text) {
        let html = self.rich(text.of(self.language));
        put(&mut self.body, format_args!("<p>{html}</p>\n"));
    }

    /// A paragraph made up at run time.
    pub(crate) fn said(&mut self, text: &str) {
        let html = self.rich(text);
        put(&mut self.body, format_args!("<p>{html}</p>\n"));
    }

    pub(crate) fn list(&mut self, items: &[Text]) {
        let items = items.iter().map(|item| item.of(self.language).to_owned());
        self.list_of(items.collect());
    }

    /// A list of what was put together for this robot.
    pub(crate) fn list_of(&mut self, items: Vec<String>) {
        self.body += "<ul>\n";
        for item in items {
            let html = self.rich(&item);
            put(&mut self.body, format_args!("<li>{html}</li>\n"));
        }
        self.body += "</ul>\n";
    }

    /// A formula that stands alone, in TeX.
    pub(crate) fn formula(&mut self, tex: Text) {
        let html = self.mathml(tex.of(self.language), MathDisplay::Block);
        put(
            &mut self.body,
            format_args!("<div class=\"formula\">{html}</div>\n"),
        );
    }

    /// A figure. Its identifier is the same in every language.
    pub(crate) fn figure(&mut self, id: &str, svg: &str, caption: Text) {
        self.figures += 1;
        let caption = self.rich(caption.of(self.language));
        let number = format!(
            "{} {}.{}",
            FIGURE.of(self.language),
            self.chapter,
            self.figures
        );
        put(
            &mut self.body,
            format_args!(
                "<figure id=\"fig-{id}\"><div class=\"wide\">{svg}</div><figcaption><b>{number}.</b> {caption}</figcaption></figure>\n"
            ),
        );
        self.ids.push(id.to_owned());
    }

    /// A table.
    pub(crate) fn table(&mut self, header: &[&str], rows: &[Vec<Cell>]) {
        self.body += "<div class=\"wide\"><table><thead><tr>";
        for cell in header {
            put(&mut self.body, format_args!("<th>{}</th>", escape(cell)));
        }
        self.body += "</tr></thead><tbody>\n";
        for row in rows {
            self.body += "<tr>";
            for Cell { html, tone } in row {
                let class = match tone {
                    Tone::Plain => "",
                    Tone::Good => " class=\"good\"",
                    Tone::Bad => " class=\"bad\"",
                };
                put(&mut self.body, format_args!("<td{class}>{html}</td>"));
            }
            self.body += "</tr>\n";
        }
        self.body += "</tbody></table></div>\n";
    }

    /// HTML as it is.
    pub(crate) fn html(&mut self, html: &str) {
        self.body += html;
    }

    /// Each figure's identifier, in order.
    pub(crate) fn figure_ids(&self) -> &[String] {
        &self.ids
    }

    /// What was written so far, and the table of contents.
    pub(crate) fn finish(self) -> (String, String) {
        let mut contents = String::from("<ul>\n");
        for (id, title) in &self.contents {
            put(
                &mut contents,
                format_args!("<li><a href=\"#{id}\">{title}</a></li>\n"),
            );
        }
        contents += "</ul>\n";
        (self.body, contents)
    }

    /// Text with formulas between dollar signs and names between backquotes.
    pub(crate) fn rich(&self, text: &str) -> String {
        let mut html = String::new();
        for (index, part) in text.split('$').enumerate() {
            if index % 2 == 1 {
                html += &self.mathml(part, MathDisplay::Inline);
                continue;
            }
            for (index, piece) in part.split('`').enumerate() {
                match index % 2 {
                    0 => html += &emphasised(piece),
                    _ => put(
                        &mut html,
                        format_args!("<code translate=\"no\">{}</code>", escape(piece)),
                    ),
                }
            }
        }
        html
    }

    fn mathml(&self, tex: &str, display: MathDisplay) -> String {
        let made = self
            .math
            .as_ref()
            .map(|math| math.convert_with_local_state(tex, display));
        match made {
            Some(Ok(result)) => result.mathml,
            // Tests see to it that every formula can be converted.
            _ => format!("<code>{}</code>", escape(tex)),
        }
    }
}

/// Text with what stands between asterisks stressed.
fn emphasised(text: &str) -> String {
    let mut html = String::new();
    // One alone is a sign of its own, as in φ*.
    if text.matches('*').count() % 2 == 1 {
        return escape(text);
    }
    for (index, part) in text.split('*').enumerate() {
        match index % 2 {
            0 => html += &escape(part),
            _ => put(&mut html, format_args!("<em>{}</em>", escape(part))),
        }
    }
    html
}

/// Names of functions that TeX has in English only.
fn spanish_functions() -> MathCoreConfig {
    let named = |name: &str| (name.to_owned(), format!(r"\operatorname{{{name}}}"));
    MathCoreConfig {
        macros: vec![named("sen"), named("arcsen")],
        ..MathCoreConfig::default()
    }
}
