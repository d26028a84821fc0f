//! Panels over one axis, such as signals over time.

use crate::WIDTH;
use crate::curve::Curve;
use crate::frame::{Frame, LEFT, LETTER, RIGHT, legend};
use crate::sheet::Picture;
use crate::text::{Words, escape, put};

/// What is drawn over the common axis, below the panel before.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// What the axis shows, with its unit.
    pub y: String,
    /// What is drawn, the first below the others.
    pub curves: Vec<Curve>,
    /// What the axis shows at least; more where the curves need it.
    pub least_range: Option<[f64; 2]>,
    /// The fixed range of the axis; curves outside it are clipped.
    pub range: Option<[f64; 2]>,
    /// Names of the values 0, 1, 2 ... in place of numbers.
    pub names: Vec<String>,
}

impl Panel {
    /// With an axis for all values.
    #[must_use]
    pub fn new(y: &str, curves: Vec<Curve>) -> Self {
        Self {
            y: y.to_owned(),
            curves,
            ..Self::default()
        }
    }

    /// An axis that shows this at least.
    #[must_use]
    pub fn at_least(mut self, from: f64, to: f64) -> Self {
        self.least_range = Some([from, to]);
        self
    }

    /// An axis that shows exactly this.
    #[must_use]
    pub fn exactly(mut self, from: f64, to: f64) -> Self {
        self.range = Some([from, to]);
        self
    }

    fn height(&self) -> f64 {
        if self.names.is_empty() {
            190.0
        } else {
            24.0 + 20.0 * self.names.len() as f64
        }
    }

    fn y_range(&self, x_range: [f64; 2]) -> [f64; 2] {
        if let Some(range) = self.range {
            return range;
        }
        if !self.names.is_empty() {
            return [-0.5, self.names.len() as f64 - 0.5];
        }
        let shown = |point: &(f64, f64)| {
            point.1.is_finite() && (x_range[0]..=x_range[1]).contains(&point.0)
        };
        let [mut low, mut high] = self
            .least_range
            .unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
        for (_, y) in self.curves.iter().flat_map(Curve::extent).filter(shown) {
            low = low.min(y);
            high = high.max(y);
        }
        if low > high {
            return [0.0, 1.0];
        }
        // A constant signal lies in the middle of a range around it.
        let margin = (0.06 * (high - low)).max(0.01 * high.abs().max(1.0));
        [low - margin, high + margin]
    }
}

/// Panels over one axis.
#[derive(Clone, Debug)]
pub struct Plot {
    /// What the axis shows, with its unit.
    pub x: String,
    /// What the axis shows; else all there is.
    pub x_range: Option<[f64; 2]>,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

impl Plot {
    /// Signals over time in seconds.
    #[must_use]
    pub fn over_time(panels: Vec<Panel>) -> Self {
        Self {
            x: "time, s".into(),
            x_range: None,
            panels,
        }
    }

    /// The picture, inline in a page.
    #[must_use]
    pub fn svg<'a>(&self, words: impl Into<Words<'a>>) -> String {
        self.picture(words, WIDTH).inline()
    }

    /// The same in a width \[px\], for a sheet.
    #[must_use]
    pub fn picture<'a>(&self, words: impl Into<Words<'a>>, width: f64) -> Picture {
        let words = words.into();
        let x_range = self.x_range.unwrap_or_else(|| self.all_x());
        let longest = self
            .panels
            .iter()
            .flat_map(|panel| &panel.names)
            .map(|name| name.chars().count());
        let left = LEFT.max(30.0 + LETTER * longest.max().unwrap_or(0) as f64);
        let mut body = String::new();
        let mut y = 4.0;
        for (index, panel) in self.panels.iter().enumerate() {
            y += legend(&mut body, &panel.curves, [left, width], y);
            let frame = Frame {
                x: left,
                y,
                width: width - left - RIGHT,
                height: panel.height(),
                x_range,
                y_range: panel.y_range(x_range),
            };
            let last = index + 1 == self.panels.len();
            frame.axes(&mut body, words, &panel.names, last);
            frame.inside(&mut body, |svg| frame.curves(svg, &panel.curves));
            let finite = |curve: &Curve| curve.points.iter().any(|point| point.1.is_finite());
            if !panel.curves.iter().any(finite) {
                let (x, y) = (left + 0.5 * frame.width, y + 0.5 * frame.height);
                put(
                    &mut body,
                    format_args!(
                        "<text class=\"m\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>",
                        escape(words.no_value)
                    ),
                );
            }
            put(
                &mut body,
                format_args!(
                    "<text class=\"m\" transform=\"translate(13 {:.1}) rotate(-90)\">{}</text>",
                    y + 0.5 * frame.height,
                    escape(&panel.y)
                ),
            );
            y += frame.height + if last { 0.0 } else { 16.0 };
        }
        put(
            &mut body,
            format_args!(
                "<text class=\"m\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                0.5 * (left + width - RIGHT),
                y + 35.0,
                escape(&self.x)
            ),
        );
        Picture::new(body, width, y + 42.0)
    }

    fn all_x(&self) -> [f64; 2] {
        let all = self
            .panels
            .iter()
            .flat_map(|panel| &panel.curves)
            .flat_map(|curve| &curve.points);
        let finite = all.filter(|point| point.1.is_finite() && point.0.is_finite());
        let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (x, _)| {
            [low.min(*x), high.max(*x)]
        });
        if low < high { [low, high] } else { [0.0, 1.0] }
    }
}
