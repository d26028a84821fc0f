//! Maps: paths, walls and boxes in metres, both axes to the same scale.

use crate::WIDTH;
use crate::curve::{Curve, Points};
use crate::frame::{Frame, LEFT, RIGHT, legend};
use crate::sheet::Picture;
use crate::text::{Words, escape, put};

/// Something that stands on the floor of a map.
#[derive(Clone, Debug)]
pub struct Shape {
    /// In order \[m\].
    pub corners: Points,
    /// A body, not a line.
    pub filled: bool,
}

/// A map in metres: a metre is as long in x as in y.
#[derive(Clone, Debug, Default)]
pub struct Map {
    /// What the axis shows, with its unit.
    pub x: String,
    /// The same of the other axis.
    pub y: String,
    /// What stands there, below the curves.
    pub shapes: Vec<Shape>,
    /// The trajectories.
    pub curves: Vec<Curve>,
    /// Places with a name.
    pub marks: Vec<(f64, f64, String)>,
    /// What must be visible; by default everything.
    pub range: Option<[[f64; 2]; 2]>,
}

impl Map {
    /// Walls, boxes and trajectories in the world.
    #[must_use]
    pub fn of(shapes: Vec<Shape>, curves: Vec<Curve>) -> Self {
        Self {
            x: "x, m".into(),
            y: "y, m".into(),
            shapes,
            curves,
            ..Self::default()
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
        let (words, whole) = (words.into(), width);
        let [x_all, y_all] = self.range.unwrap_or_else(|| self.all());
        let width = whole - LEFT - RIGHT;
        // As large as the page is wide, unless that is higher than a screen.
        let height = (width * (y_all[1] - y_all[0]) / (x_all[1] - x_all[0])).clamp(150.0, 430.0);
        let metre = (width / (x_all[1] - x_all[0])).min(height / (y_all[1] - y_all[0]));
        let widen = |[from, to]: [f64; 2], pixels: f64| {
            let more = 0.5 * (pixels / metre - (to - from));
            [from - more, to + more]
        };
        let mut body = String::new();
        let top = 4.0 + legend(&mut body, &self.curves, [LEFT, whole], 4.0);
        let frame = Frame {
            x: LEFT,
            y: top,
            width,
            height,
            x_range: widen(x_all, width),
            y_range: widen(y_all, height),
        };
        frame.axes(&mut body, words, &[], true);
        frame.inside(&mut body, |svg| {
            for shape in &self.shapes {
                let corners = shape.corners.iter().map(|corner| frame.place(*corner));
                let points: Vec<String> = corners.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
                let kind = if shape.filled { ("polygon", "o") } else { ("polyline", "w") };
                put(svg, format_args!("<{} class=\"{}\" points=\"{}\"/>", kind.0, kind.1, points.join(" ")));
            }
            frame.curves(svg, &self.curves);
            for (x, y, name) in &self.marks {
                let (x, y) = frame.place((*x, *y));
                put(svg, format_args!("<circle class=\"k\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/><text class=\"s\" x=\"{:.1}\" y=\"{:.1}\">{}</text>", x + 7.0, y - 6.0, escape(name)));
            }
        });
        let bottom = top + height;
        put(
            &mut body,
            format_args!(
                "<text class=\"m\" transform=\"translate(13 {:.1}) rotate(-90)\">{}</text>",
                top + 0.5 * height,
                escape(&self.y)
            ),
        );
        put(
            &mut body,
            format_args!(
                "<text class=\"m\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                LEFT + 0.5 * width,
                bottom + 35.0,
                escape(&self.x)
            ),
        );
        Picture::new(body, whole, bottom + 42.0)
    }

    fn all(&self) -> [[f64; 2]; 2] {
        let curves = self.curves.iter().flat_map(Curve::extent);
        let shapes = self.shapes.iter().flat_map(|shape| &shape.corners).copied();
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (x, y) in curves
            .chain(shapes)
            .filter(|(x, y)| x.is_finite() && y.is_finite())
        {
            for (axis, value) in range.iter_mut().zip([x, y]) {
                *axis = [axis[0].min(value), axis[1].max(value)];
            }
        }
        range.map(|[low, high]| {
            let margin = 0.08 * (high - low).max(0.2);
            if low <= high {
                [low - margin, high + margin]
            } else {
                [0.0, 1.0]
            }
        })
    }
}
