//! What drawings are made of: boxes, circles, lines with or without an arrow, texts.

use crate::text::{escape, put};

/// A drawing under way.
pub(super) struct Sketch {
    body: String,
}

/// Where a text is held.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

impl Sketch {
    pub(super) fn new() -> Self {
        Self {
            body: String::new(),
        }
    }

    /// The drawing, of this size.
    pub(super) fn finish(self, width: f64, height: f64) -> String {
        format!(
            "<svg class=\"plot\" viewBox=\"0 0 {width:.0} {height:.0}\">{}</svg>",
            self.body
        )
    }

    pub(super) fn rectangle(
        &mut self,
        (x, y): (f64, f64),
        (width, height): (f64, f64),
        class: &str,
    ) {
        put(
            &mut self.body,
            format_args!(
                "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"4\"/>"
            ),
        );
    }

    pub(super) fn circle(&mut self, (x, y): (f64, f64), radius: f64, class: &str) {
        put(
            &mut self.body,
            format_args!(
                "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\"/>"
            ),
        );
    }

    pub(super) fn text(&mut self, (x, y): (f64, f64), text: &str, anchor: Anchor) {
        let class = match anchor {
            Anchor::Start => "s",
            Anchor::Middle => "m",
            Anchor::End => "e",
        };
        put(
            &mut self.body,
            format_args!(
                "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>",
                escape(text)
            ),
        );
    }

    /// A line through points.
    pub(super) fn line(&mut self, points: &[(f64, f64)], class: &str) {
        let mut path = String::new();
        for (index, (x, y)) in points.iter().enumerate() {
            put(
                &mut path,
                format_args!("{}{x:.1} {y:.1}", if index == 0 { 'M' } else { 'L' }),
            );
        }
        put(
            &mut self.body,
            format_args!("<path class=\"{class}\" d=\"{path}\"/>"),
        );
    }

    pub(super) fn polygon(&mut self, corners: &[(f64, f64)], class: &str) {
        let points: Vec<String> = corners
            .iter()
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        put(
            &mut self.body,
            format_args!(
                "<polygon class=\"{class}\" points=\"{}\"/>",
                points.join(" ")
            ),
        );
    }

    /// A line that ends in an arrow.
    pub(super) fn arrow(&mut self, points: &[(f64, f64)]) {
        self.line(points, "l");
        if let [.., from, tip] = points {
            self.head(*from, *tip);
        }
    }

    /// The arrow's head at the end of a way from `from` to `tip`.
    pub(super) fn head(&mut self, from: (f64, f64), tip: (f64, f64)) {
        let (dx, dy) = (tip.0 - from.0, tip.1 - from.1);
        let length = (dx * dx + dy * dy).sqrt().max(1e-6);
        let (dx, dy) = (dx / length, dy / length);
        let back = (tip.0 - 8.0 * dx, tip.1 - 8.0 * dy);
        let corner = |side: f64| (back.0 - 3.6 * side * dy, back.1 + 3.6 * side * dx);
        self.polygon(&[tip, corner(1.0), corner(-1.0)], "h");
    }

    /// A line with an arrow at either end, and what it measures beside its middle.
    pub(super) fn measure(
        &mut self,
        from: (f64, f64),
        to: (f64, f64),
        name: &str,
        beside: (f64, f64),
    ) {
        self.line(&[from, to], "l");
        self.head(from, to);
        self.head(to, from);
        let middle = (
            0.5 * (from.0 + to.0) + beside.0,
            0.5 * (from.1 + to.1) + beside.1,
        );
        self.text(middle, name, Anchor::Middle);
    }
}
