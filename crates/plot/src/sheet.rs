//! Pictures as an SVG file: with titles, in rows and columns, in the colours of a light page.

use crate::STYLE;
use crate::text::{escape, put};

/// Height of a title \[px\].
const TITLE: f64 = 26.0;
/// Space around a picture \[px\].
const MARGIN: f64 = 8.0;
/// The values of the style sheet's variables on a light page.
const COLOURS: [(&str, &str); 9] = [
    ("paper", "#fbfbf9"),
    ("ink", "#1c2024"),
    ("soft", "#5a626b"),
    ("line", "#d5d9de"),
    ("i1", "#004f8b"),
    ("i2", "#dd6b00"),
    ("i3", "#00875f"),
    ("i4", "#a8478b"),
    ("ir", "#4a4f55"),
];

/// A picture that was drawn.
#[derive(Clone, Debug)]
pub struct Picture {
    body: String,
    width: f64,
    height: f64,
}

impl Picture {
    pub(crate) fn new(body: String, width: f64, height: f64) -> Self {
        Self {
            body,
            width,
            height,
        }
    }

    /// Inline in a page, which has the style sheet.
    pub(crate) fn inline(&self) -> String {
        let Self {
            body,
            width,
            height,
        } = self;
        format!("<svg class=\"plot\" viewBox=\"0 0 {width} {height:.0}\">{body}</svg>")
    }
}

/// Pictures in rows, as a file.
#[derive(Clone, Debug)]
pub struct Sheet {
    columns: usize,
    pictures: Vec<(String, Picture)>,
}

impl Sheet {
    /// With so many pictures in a row.
    #[must_use]
    pub fn new(columns: usize) -> Self {
        Self {
            columns: columns.max(1),
            pictures: Vec::new(),
        }
    }

    /// Adds a picture below its title, if it has one.
    #[must_use]
    pub fn with(mut self, title: &str, picture: Picture) -> Self {
        self.pictures.push((title.to_owned(), picture));
        self
    }

    /// Nothing was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.pictures.is_empty()
    }

    /// The file.
    #[must_use]
    pub fn svg(&self) -> String {
        let (mut body, mut y, mut right) = (String::new(), MARGIN, 0.0f64);
        for row in self.pictures.chunks(self.columns) {
            let (mut x, mut height) = (MARGIN, 0.0f64);
            for (title, picture) in row {
                let top = if title.is_empty() { 0.0 } else { TITLE };
                if !title.is_empty() {
                    let (x, y) = (x + 0.5 * picture.width, y + 17.0);
                    let title = escape(title);
                    put(
                        &mut body,
                        format_args!(
                            "<text class=\"c\" x=\"{x:.1}\" y=\"{y:.1}\">{title}</text>\n"
                        ),
                    );
                }
                put(
                    &mut body,
                    format_args!(
                        "<g transform=\"translate({x:.1} {:.1})\">{}</g>\n",
                        y + top,
                        picture.body
                    ),
                );
                x += picture.width + MARGIN;
                height = height.max(top + picture.height);
            }
            right = right.max(x);
            y += height + MARGIN;
        }
        let mut style = STYLE.to_owned();
        for (name, colour) in COLOURS {
            style = style.replace(&format!("var(--{name})"), colour);
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" width=\"{right:.0}\" height=\"{y:.0}\" viewBox=\"0 0 {right:.0} {y:.0}\" \
             font-family=\"system-ui, 'Segoe UI', 'Noto Sans', 'DejaVu Sans', Arial, sans-serif\" font-size=\"12.5\">\n\
             <style>\n{style}</style>\n<rect class=\"p\" width=\"100%\" height=\"100%\"/>\n{body}</svg>\n"
        )
    }
}
