//! A text of the content as HTML: Markdown, with formulas in TeX, and places filled by what the runs gave.
//!
//! | in the text | what becomes of it |
//! |---|---|
//! | `# Title` | the chapter's heading, with its number |
//! | `## Title {.name}` | a section that is shown only in runs that have it |
//! | `{{name}}` | a value; a table where it stands alone in its paragraph |
//! | `![caption](run:name)` | a figure of the runs, numbered |
//! | `![caption](../drawings/name.svg)` | a drawing, numbered |
//! | `$...$`, `$$...$$` | a formula in TeX, in the line or standing alone |
//!
//! The library parses and writes HTML; between the two its events are filled in. What cannot be done is an error with its
//! file and line.

use crate::content::{ContentError, Source};
use crate::drawing::file as drawing_file;
use crate::page::Page;
use crate::places::{Place, Places};
use crate::text::escape;
use math_core::MathDisplay;
use pulldown_cmark::{
    CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, TextMergeWithOffset, html,
};
use std::collections::BTreeSet;
use std::ops::Range;

#[cfg(test)]
mod tests;

type Inside<'a> = Vec<(Event<'a>, Range<usize>)>;

/// A text being turned into HTML.
struct Writer<'a> {
    page: &'a mut Page,
    source: &'a Source,
    places: &'a Places,
    /// Names that the text has used.
    used: BTreeSet<String>,
    /// Level of the section that is left out.
    hidden: Option<HeadingLevel>,
    html: Vec<Event<'a>>,
}

/// A chapter as HTML: the text of this name.
pub(crate) fn chapter(
    page: &mut Page,
    number: &str,
    name: &str,
    places: &Places,
) -> Result<String, ContentError> {
    page.begin(number);
    let source = places.source(name)?;
    write(page, &source, places, |page, title| {
        let title = format!("{number}. {title}");
        let heading = format!("<h2 id=\"{name}\">{title}</h2>\n");
        page.enter(name, title);
        heading
    })
}

/// What stands before the chapters.
pub(crate) fn front(page: &mut Page, places: &Places) -> Result<String, ContentError> {
    let source = places.source("front")?;
    write(page, &source, places, |_, title| {
        format!("<h2 class=\"on\">{title}</h2>\n")
    })
}

/// A text as HTML. `title` makes HTML of a heading of the first level.
fn write(
    page: &mut Page,
    source: &Source,
    places: &Places,
    title: impl Fn(&mut Page, &str) -> String,
) -> Result<String, ContentError> {
    let mut writer = Writer {
        page,
        source,
        places,
        used: BTreeSet::new(),
        hidden: None,
        html: Vec::new(),
    };
    let options =
        Options::ENABLE_MATH | Options::ENABLE_TABLES | Options::ENABLE_HEADING_ATTRIBUTES;
    let parser = Parser::new_ext(&source.text, options).into_offset_iter();
    let mut events = TextMergeWithOffset::new(parser);
    while let Some((event, range)) = events.next() {
        let end = match &event {
            Event::Start(tag @ (Tag::Paragraph | Tag::Heading { .. })) => tag.to_end(),
            _ => {
                writer.pass(event, range)?;
                continue;
            }
        };
        let inside: Inside<'_> = events
            .by_ref()
            .take_while(|(event, _)| *event != Event::End(end))
            .collect();
        match event {
            Event::Start(Tag::Heading { level, classes, .. }) => {
                writer.heading(level, &classes, inside, range, &title)?;
            }
            _ => writer.paragraph(inside, range)?,
        }
    }
    let Writer { used, html, .. } = writer;
    if let Some(name) = places.left(&used) {
        let what = format!("the program fills a place `{name}` that this text lacks; add it");
        return Err(source.error(source.text.len(), what));
    }
    Ok(html_of(html))
}

fn html_of(events: Vec<Event<'_>>) -> String {
    let mut text = String::new();
    html::push_html(&mut text, events.into_iter());
    text
}

impl<'a> Writer<'a> {
    fn error<T>(&self, range: &Range<usize>, what: String) -> Result<T, ContentError> {
        Err(self.source.error(range.start, what))
    }

    /// What fills a place; `None` in a section that is left out.
    fn place(
        &mut self,
        name: &str,
        range: &Range<usize>,
    ) -> Result<Option<&'a Place>, ContentError> {
        self.used.insert(name.to_owned());
        let place = self.places.get(name);
        if place.is_none() && self.hidden.is_none() {
            let known = self.places.names();
            let what = format!("`{name}` is no word and no place of this text, which are {known}");
            return self.error(range, what);
        }
        Ok(place)
    }

    fn show(&mut self, events: impl IntoIterator<Item = Event<'a>>) {
        if self.hidden.is_none() {
            self.html.extend(events);
        }
    }

    fn pass(&mut self, event: Event<'a>, range: Range<usize>) -> Result<(), ContentError> {
        let event = self.inline(event, &range)?;
        self.show([event]);
        Ok(())
    }

    fn heading(
        &mut self,
        level: HeadingLevel,
        classes: &[CowStr<'_>],
        inside: Inside<'a>,
        range: Range<usize>,
        title: &impl Fn(&mut Page, &str) -> String,
    ) -> Result<(), ContentError> {
        if self.hidden.is_some_and(|hidden| level <= hidden) {
            self.hidden = None;
        }
        for class in classes {
            match self.places.shown(class) {
                Some(true) => {}
                Some(false) => self.hidden = self.hidden.or(Some(level)),
                None => {
                    let what = format!("no section of this text is called `{class}`");
                    return self.error(&range, what);
                }
            }
        }
        let text = self.inlines(inside)?;
        let html = match level {
            HeadingLevel::H1 if self.hidden.is_none() => title(self.page, &text),
            HeadingLevel::H1 | HeadingLevel::H2 => format!("<h3>{text}</h3>\n"),
            _ => format!("<h4>{text}</h4>\n"),
        };
        self.show([Event::Html(html.into())]);
        Ok(())
    }

    /// A paragraph, or what stands alone in one: a formula, a figure, a table.
    fn paragraph(&mut self, inside: Inside<'a>, range: Range<usize>) -> Result<(), ContentError> {
        let html = match inside.as_slice() {
            [(Event::DisplayMath(tex), _)] => {
                let formula = self.formula(tex, MathDisplay::Block, &range)?;
                format!("<div class=\"formula\">{formula}</div>\n")
            }
            [(Event::Text(text), _)] if alone(text).is_some() => {
                let name = alone(text).unwrap_or_default().to_owned();
                match self.place(&name, &range)? {
                    Some(Place::Block(html)) => html.clone(),
                    Some(Place::Value(value)) => format!("<p>{}</p>\n", escape(value)),
                    Some(Place::Figure(_)) => {
                        return self.error(&range, figure_needs_caption(&name));
                    }
                    Some(Place::Nothing) | None => return Ok(()),
                }
            }
            [
                (Event::Start(Tag::Image { dest_url, .. }), _),
                caption @ ..,
                (Event::End(TagEnd::Image), _),
            ] => {
                let (name, caption) = (dest_url.to_string(), caption.to_vec());
                let description = plain(&caption);
                let caption = self.inlines(caption)?;
                let Some((id, svg)) = self.image(&name, &range)? else {
                    return Ok(());
                };
                self.page.figure(&id, &svg, &caption, &description)
            }
            _ => format!("<p>{}</p>\n", self.inlines(inside)?),
        };
        self.show([Event::Html(html.into())]);
        Ok(())
    }

    /// Identifier and SVG of a figure of the runs or of a drawing; `None` where it is not shown.
    fn image(
        &mut self,
        name: &str,
        range: &Range<usize>,
    ) -> Result<Option<(String, String)>, ContentError> {
        if let Some(file) = name.strip_prefix("../drawings/") {
            let svg = drawing_file::svg(self.page.language(), file)?;
            let id = file.trim_end_matches(".svg").to_owned();
            return Ok(self.hidden.is_none().then_some((id, svg)));
        }
        let Some(name) = name.strip_prefix("run:") else {
            let what = format!("`{name}` is no figure: write run:name or ../drawings/name.svg");
            return self.error(range, what);
        };
        match self.place(name, range)? {
            Some(Place::Figure(svg)) if self.hidden.is_none() => {
                Ok(Some((name.to_owned(), svg.clone())))
            }
            Some(Place::Figure(_) | Place::Nothing) | None => Ok(None),
            Some(Place::Value(_) | Place::Block(_)) => self.error(
                range,
                format!("`{name}` is no figure: write {{{{{name}}}}}"),
            ),
        }
    }

    fn inlines(&mut self, inside: Inside<'a>) -> Result<String, ContentError> {
        let events: Result<_, _> = inside
            .into_iter()
            .map(|(event, range)| self.inline(event, &range))
            .collect();
        events.map(html_of)
    }

    /// An event with its places filled.
    fn inline(
        &mut self,
        event: Event<'a>,
        range: &Range<usize>,
    ) -> Result<Event<'a>, ContentError> {
        Ok(match event {
            Event::Text(text) if text.contains('$') => {
                return self.error(
                    range,
                    "`$` begins no formula here; check its end and its braces".into(),
                );
            }
            Event::Text(text) => Event::Text(self.filled(&text, range)?.into()),
            Event::Code(text) => {
                let text = escape(&self.filled(&text, range)?);
                Event::InlineHtml(format!("<code translate=\"no\">{text}</code>").into())
            }
            Event::InlineMath(tex) => {
                Event::InlineHtml(self.formula(&tex, MathDisplay::Inline, range)?.into())
            }
            Event::DisplayMath(_) => {
                let what =
                    "a formula between $$ stands alone in its paragraph: put empty lines around it";
                return self.error(range, what.into());
            }
            Event::Start(Tag::Image { dest_url, .. }) => {
                let what = format!("figure `{dest_url}` stands alone in its paragraph");
                return self.error(range, what);
            }
            Event::Html(_) | Event::InlineHtml(_) => {
                return self.error(range, "HTML is not taken here; write Markdown".into());
            }
            // Where a line of the file ends means nothing.
            Event::SoftBreak => Event::Text(" ".into()),
            event => event,
        })
    }

    fn formula(
        &self,
        tex: &str,
        display: MathDisplay,
        range: &Range<usize>,
    ) -> Result<String, ContentError> {
        match self.page.mathml(tex, display) {
            Some(mathml) => Ok(mathml),
            None => self.error(range, format!("`{tex}` is no formula in TeX")),
        }
    }

    /// A text with the values at their places.
    fn filled(&mut self, text: &str, range: &Range<usize>) -> Result<String, ContentError> {
        let mut pieces = text.split("{{");
        let mut filled = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let Some((name, rest)) = piece.split_once("}}") else {
                return self.error(range, "a place that begins with {{ ends with }}".into());
            };
            match self.place(name, range)? {
                Some(Place::Value(value)) => filled += value,
                Some(Place::Nothing) | None => {}
                Some(Place::Block(_)) => {
                    let what = format!("`{name}` is a table: it stands alone in its paragraph");
                    return self.error(range, what);
                }
                Some(Place::Figure(_)) => return self.error(range, figure_needs_caption(name)),
            }
            filled += rest;
        }
        Ok(filled)
    }
}

/// The name of the place that a paragraph is.
fn alone(text: &str) -> Option<&str> {
    let name = text.strip_prefix("{{")?.strip_suffix("}}")?;
    (!name.contains("}}")).then_some(name)
}

fn figure_needs_caption(name: &str) -> String {
    format!("`{name}` is a figure: write ![its caption](run:{name}), alone in its paragraph")
}

/// The words of a caption, for screen readers.
fn plain(inside: &[(Event<'_>, Range<usize>)]) -> String {
    let words = inside.iter().map(|(event, _)| match event {
        Event::Text(text) | Event::Code(text) | Event::InlineMath(text) => text,
        Event::SoftBreak => " ",
        _ => "",
    });
    words.collect()
}
