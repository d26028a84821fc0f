//! The frame of a picture: axes with their ticks, the curves' paths inside, the legend above.

use crate::curve::{Band, Curve, Points, thinned};
use crate::text::{Words, escape, number, put};

/// Width of the labels on the left \[px\].
pub(crate) const LEFT: f64 = 62.0;
/// Margin on the right \[px\].
pub(crate) const RIGHT: f64 = 14.0;
/// Height of a row of the legend \[px\].
pub(crate) const LEGEND_ROW: f64 = 19.0;
/// Width of a letter of a legend, about \[px\].
pub(crate) const LETTER: f64 = 6.7;

/// Where a panel's values lie in the picture.
pub(crate) struct Frame {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) x_range: [f64; 2],
    pub(crate) y_range: [f64; 2],
}

impl Frame {
    /// Seen from the frame's upper left corner.
    pub(crate) fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let share = |value: f64, [from, to]: [f64; 2]| (value - from) / (to - from);
        (
            self.width * share(x, self.x_range),
            self.height * (1.0 - share(y, self.y_range)),
        )
    }

    /// Grid, ticks and axes; labels along x only below the last panel.
    pub(crate) fn axes(&self, svg: &mut String, words: Words<'_>, names: &[String], last: bool) {
        let (right, bottom) = (self.x + self.width, self.y + self.height);
        let every = step(self.x_range, self.width / 75.0);
        for value in ticks(self.x_range, every) {
            let x = self.x + self.place((value, 0.0)).0;
            put(
                svg,
                format_args!(
                    "<path class=\"g\" d=\"M{x:.1} {:.1}V{bottom:.1}\"/>",
                    self.y
                ),
            );
            if last {
                let label = tick(words, value, every);
                put(
                    svg,
                    format_args!(
                        "<text class=\"m\" x=\"{x:.1}\" y=\"{:.1}\">{label}</text>",
                        bottom + 16.0
                    ),
                );
            }
        }
        if names.is_empty() {
            let every = step(self.y_range, self.height / 34.0);
            for value in ticks(self.y_range, every) {
                let y = self.y + self.place((0.0, value)).1;
                let label = tick(words, value, every);
                put(
                    svg,
                    format_args!(
                        "<path class=\"g\" d=\"M{:.1} {y:.1}H{right:.1}\"/><text class=\"e\" x=\"{:.1}\" y=\"{:.1}\">{label}</text>",
                        self.x,
                        self.x - 6.0,
                        y + 4.0
                    ),
                );
            }
        }
        for (value, name) in names.iter().enumerate() {
            let y = self.y + self.place((0.0, value as f64)).1;
            put(
                svg,
                format_args!(
                    "<path class=\"g\" d=\"M{:.1} {y:.1}H{right:.1}\"/><text class=\"e\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                    self.x,
                    self.x - 6.0,
                    y + 4.0,
                    escape(name)
                ),
            );
        }
        put(
            svg,
            format_args!(
                "<path class=\"a\" d=\"M{:.1} {:.1}V{bottom:.1}H{right:.1}\"/>",
                self.x, self.y
            ),
        );
    }

    /// The curves, the first below the others.
    pub(crate) fn curves(&self, svg: &mut String, curves: &[Curve]) {
        for curve in curves {
            let ink = curve.ink.class();
            if let Some(Band { low, high }) = &curve.band {
                let outline: Points = high.iter().chain(low.iter().rev()).copied().collect();
                let path = path(self, &outline, false);
                put(svg, format_args!("<path class=\"{ink} r\" d=\"{path}\"/>"));
            }
            let path = path(self, &curve.points, curve.steps);
            if !path.is_empty() {
                let thin = if curve.thin { " t" } else { "" };
                put(
                    svg,
                    format_args!("<path class=\"{ink}{thin}\" d=\"{path}\"/>"),
                );
            }
        }
    }

    /// What is drawn inside is cut off at the frame.
    pub(crate) fn inside(&self, svg: &mut String, draw: impl FnOnce(&mut String)) {
        put(
            svg,
            format_args!(
                "<svg x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\">",
                self.x, self.y, self.width, self.height
            ),
        );
        draw(svg);
        *svg += "</svg>";
    }
}

/// The names of the curves in rows above them; each name once. Returns the height used.
pub(crate) fn legend(svg: &mut String, curves: &[Curve], [left, right]: [f64; 2], top: f64) -> f64 {
    let (mut x, mut y) = (left, top);
    let mut said: Vec<&str> = Vec::new();
    for curve in curves {
        if curve.name.is_empty() || said.contains(&curve.name.as_str()) {
            continue;
        }
        let width = 34.0 + LETTER * curve.name.chars().count() as f64;
        if x + width > right && x > left {
            (x, y) = (left, y + LEGEND_ROW);
        }
        put(
            svg,
            format_args!(
                "<path class=\"{}\" d=\"M{x:.1} {:.1}h22\"/><text class=\"s\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                curve.ink.class(),
                y + 9.0,
                x + 27.0,
                y + 13.0,
                escape(&curve.name)
            ),
        );
        x += width + 10.0;
        said.push(&curve.name);
    }
    if said.is_empty() {
        4.0
    } else {
        y - top + LEGEND_ROW + 4.0
    }
}

/// The curve's path.
pub(crate) fn path(frame: &Frame, points: &Points, steps: bool) -> String {
    let mut text = String::new();
    for part in points.split(|(x, y)| !x.is_finite() || !y.is_finite()) {
        let mut before: Option<(f64, f64)> = None;
        for (x, y) in thinned(part.iter().map(|point| frame.place(*point)).collect()) {
            // Far outside nothing is seen, but numbers grow long.
            let (x, y) = (x.clamp(-2_000.0, 4_000.0), y.clamp(-2_000.0, 4_000.0));
            match before {
                None => put(&mut text, format_args!("M{x:.1} {y:.1}")),
                Some(_) if steps => put(&mut text, format_args!("H{x:.1}V{y:.1}")),
                Some(last) if (last.0 - x).abs() < 0.05 && (last.1 - y).abs() < 0.05 => continue,
                Some(_) => put(&mut text, format_args!("L{x:.1} {y:.1}")),
            }
            before = Some((x, y));
        }
    }
    text
}

/// The distance between ticks: 1, 2 or 5 times a power of ten, for about `count` of them.
pub(crate) fn step([from, to]: [f64; 2], count: f64) -> f64 {
    let raw = (to - from) / count.max(2.0);
    let power = 10f64.powf(raw.log10().floor());
    let times = [1.0, 2.0, 5.0, 10.0];
    times
        .iter()
        .map(|times| times * power)
        .find(|step| *step >= raw * 0.999)
        .unwrap_or(10.0 * power)
}

pub(crate) fn ticks([from, to]: [f64; 2], every: f64) -> impl Iterator<Item = f64> {
    let slack = 1e-6 * (to - from);
    let first = ((from - slack) / every).ceil() as i64;
    let last = ((to + slack) / every).floor() as i64;
    (first..=last.min(first + 60)).map(move |number| number as f64 * every)
}

pub(crate) fn tick(words: Words<'_>, value: f64, every: f64) -> String {
    number(
        value,
        (-every.log10().floor()).max(0.0) as usize,
        words.comma,
    )
}
