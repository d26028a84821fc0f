//! Tables: a row of headings, and cells that may be good or bad news.

use crate::text::{escape, put};

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

/// A table.
pub(crate) fn table(header: &[&str], rows: &[Vec<Cell>]) -> String {
    let mut html = String::from("<div class=\"wide\" tabindex=\"0\"><table><thead><tr>");
    for cell in header {
        // A heading without words is none.
        let kind = if cell.is_empty() { "td" } else { "th" };
        html += &format!("<{kind}>{}</{kind}>", escape(cell));
    }
    html += "</tr></thead><tbody>\n";
    for row in rows {
        html += "<tr>";
        for Cell { html: cell, tone } in row {
            let class = match tone {
                Tone::Plain => "",
                Tone::Good => " class=\"good\"",
                Tone::Bad => " class=\"bad\"",
            };
            put(&mut html, format_args!("<td{class}>{cell}</td>"));
        }
        html += "</tr>\n";
    }
    html += "</tbody></table></div>\n";
    html
}
