//! Heat maps: a value for each pair of two others, as a colour.

use crate::WIDTH;
use crate::frame::{RIGHT, step, tick, ticks};
use crate::ramp::{colour, range, share};
use crate::sheet::Picture;
use crate::text::{Words, escape, put};

/// Space for the labels on the left \[px\].
const LEFT: f64 = 82.0;
/// Width of the colour scale with its labels \[px\].
const SCALE: f64 = 76.0;
/// Most labels along an axis.
const LABELS: usize = 12;

/// A value for each pair of two others.
#[derive(Clone, Debug, Default)]
pub struct Heat {
    /// What the axis shows, with its unit.
    pub x: String,
    /// The same of the other axis.
    pub y: String,
    /// What the colours show, with its unit.
    pub value: String,
    /// A label for each column, from left to right.
    pub columns: Vec<String>,
    /// A label for each row, from bottom to top.
    pub rows: Vec<String>,
    /// The values: rows of columns. Not a number: none.
    pub values: Vec<Vec<f64>>,
}

impl Heat {
    /// The picture, inline in a page.
    #[must_use]
    pub fn svg<'a>(&self, words: impl Into<Words<'a>>) -> String {
        let words = words.into();
        let (columns, rows) = (self.columns.len().max(1), self.rows.len().max(1));
        let width = WIDTH - LEFT - SCALE - RIGHT;
        let cell_width = width / columns as f64;
        let cell_height = (300.0 / rows as f64).clamp(4.0, 40.0);
        let (top, height) = (28.0, cell_height * rows as f64);
        let shown = range(self.values.iter().flatten().copied());
        let mut body = String::new();
        self.cells(&mut body, [top, height], [cell_width, cell_height], shown);
        self.labels(&mut body, [top, height], [cell_width, cell_height]);
        let scale_height = height.max(90.0);
        scale(
            &mut body,
            words,
            [WIDTH - SCALE + 12.0, top, scale_height],
            shown,
        );
        let bottom = top + height.max(scale_height);
        put(
            &mut body,
            format_args!(
                "<text class=\"s\" x=\"6\" y=\"16\">{}</text>\
                 <text class=\"e\" x=\"{:.1}\" y=\"16\">{}</text>\
                 <text class=\"m\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                escape(&self.y),
                WIDTH - RIGHT,
                escape(&self.value),
                LEFT + 0.5 * width,
                bottom + 35.0,
                escape(&self.x)
            ),
        );
        Picture::new(body, WIDTH, bottom + 42.0).inline()
    }

    /// A rectangle for each value, in its colour.
    fn cells(
        &self,
        body: &mut String,
        [top, height]: [f64; 2],
        [cell_width, cell_height]: [f64; 2],
        shown: [f64; 2],
    ) {
        for (row, values) in self.values.iter().enumerate() {
            let y = top + height - (row + 1) as f64 * cell_height;
            for (column, value) in values.iter().enumerate() {
                let x = LEFT + column as f64 * cell_width;
                let colour = colour(share(*value, shown));
                put(
                    body,
                    format_args!(
                        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{colour}\"/>",
                        cell_width + 0.3,
                        cell_height + 0.3
                    ),
                );
            }
        }
    }

    /// The labels of columns and rows, as many as there is room for.
    fn labels(
        &self,
        body: &mut String,
        [top, height]: [f64; 2],
        [cell_width, cell_height]: [f64; 2],
    ) {
        let every = |labels: &[String]| labels.len().div_ceil(LABELS).max(1);
        let columns = self.columns.iter().enumerate();
        for (column, label) in columns.step_by(every(&self.columns)) {
            let x = LEFT + (column as f64 + 0.5) * cell_width;
            let label = escape(label);
            put(
                body,
                format_args!(
                    "<text class=\"m\" x=\"{x:.1}\" y=\"{:.1}\">{label}</text>",
                    top + height + 16.0
                ),
            );
        }
        let rows = self.rows.iter().enumerate();
        for (row, label) in rows.step_by(every(&self.rows)) {
            let y = top + height - (row as f64 + 0.5) * cell_height + 4.0;
            let label = escape(label);
            put(
                body,
                format_args!(
                    "<text class=\"e\" x=\"{:.1}\" y=\"{y:.1}\">{label}</text>",
                    LEFT - 6.0
                ),
            );
        }
    }
}

/// A bar with the colours of a range and its ticks.
pub(crate) fn scale(svg: &mut String, words: Words<'_>, [x, y, height]: [f64; 3], shown: [f64; 2]) {
    const STEPS: usize = 48;
    let slice = height / STEPS as f64;
    for index in 0..STEPS {
        let colour = colour((index as f64 + 0.5) / STEPS as f64);
        let y = y + height - (index + 1) as f64 * slice;
        put(
            svg,
            format_args!(
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"14\" height=\"{:.1}\" fill=\"{colour}\"/>",
                slice + 0.3
            ),
        );
    }
    let every = step(shown, height / 40.0);
    for value in ticks(shown, every) {
        let y = y + height * (1.0 - share(value, shown));
        let label = tick(words, value, every);
        put(
            svg,
            format_args!(
                "<text class=\"s\" x=\"{:.1}\" y=\"{:.1}\">{label}</text>",
                x + 19.0,
                y + 4.0
            ),
        );
    }
}
