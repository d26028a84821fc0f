//! Diagrams as inline SVG: panels over one axis, and maps.
//!
//! A plotting library writes colours into its picture. Here curves have classes that the page's style sheet colours, so
//! that one picture serves a light page, a dark one and paper; decimal marks follow the language, and legends stand
//! above the curves, never on them.

mod map;
#[cfg(test)]
mod tests;

use crate::text::{Language, Text, escape, put, word};
pub(crate) use map::{Map, Shape};

/// Points of a curve; what is not finite is a gap.
pub(crate) type Points = Vec<(f64, f64)>;

/// Width of every diagram [px].
pub(crate) const WIDTH: f64 = 680.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const LEGEND_ROW: f64 = 19.0;
/// Label of a panel without values: nothing was in range, or the program does not report it.
const NO_VALUE: Text = word("no-value");
/// Width of a letter of a legend, about [px].
const LETTER: f64 = 6.7;

/// How a curve looks. The first two differ in lightness as well as in hue; references are dashed, ground truth is
/// dash-dotted, one more is dotted: they remain distinguishable in grey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ink {
    /// The left wheel or sonar; our robot.
    First,
    /// The right wheel or sonar; the recorded robot.
    Second,
    /// The front sonar.
    Third,
    /// Ground truth, over what the robot reports.
    True,
    /// One more.
    Fourth,
    /// References and ideals.
    Reference,
}

impl Ink {
    const fn class(self) -> &'static str {
        match self {
            Self::First => "i1",
            Self::Second => "i2",
            Self::Third => "i3",
            Self::True => "it",
            Self::Fourth => "i4",
            Self::Reference => "ir",
        }
    }
}

/// A curve.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) name: String,
    pub(crate) ink: Ink,
    pub(crate) points: Points,
    /// A value holds until the next one.
    pub(crate) steps: bool,
}

impl Curve {
    pub(crate) fn new(name: &str, ink: Ink, points: Points) -> Self {
        Self {
            name: name.to_owned(),
            ink,
            points,
            steps: false,
        }
    }

    pub(crate) fn steps(name: &str, ink: Ink, points: Points) -> Self {
        Self {
            steps: true,
            ..Self::new(name, ink, points)
        }
    }
}

/// What is drawn over the common axis, below the panel before.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    /// What the axis shows, with its unit.
    pub(crate) y: String,
    pub(crate) curves: Vec<Curve>,
    /// What the axis shows at least; more where the curves need it.
    pub(crate) least_range: Option<[f64; 2]>,
    /// The fixed range of the axis; curves outside it are clipped.
    pub(crate) range: Option<[f64; 2]>,
    /// Names of the values 0, 1, 2 ... in place of numbers.
    pub(crate) names: Vec<String>,
}

impl Panel {
    pub(crate) fn new(y: &str, curves: Vec<Curve>) -> Self {
        Self {
            y: y.to_owned(),
            curves,
            ..Self::default()
        }
    }

    /// An axis that shows this at least.
    pub(crate) fn at_least(mut self, from: f64, to: f64) -> Self {
        self.least_range = Some([from, to]);
        self
    }

    /// An axis that shows exactly this.
    pub(crate) fn exactly(mut self, from: f64, to: f64) -> Self {
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
        let shown = |point: &&(f64, f64)| {
            point.1.is_finite() && (x_range[0]..=x_range[1]).contains(&point.0)
        };
        let [mut low, mut high] = self
            .least_range
            .unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
        for (_, y) in self
            .curves
            .iter()
            .flat_map(|curve| &curve.points)
            .filter(shown)
        {
            low = low.min(*y);
            high = high.max(*y);
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
pub(crate) struct Plot {
    /// What the axis shows, with its unit.
    pub(crate) x: String,
    /// What the axis shows; else all there is.
    pub(crate) x_range: Option<[f64; 2]>,
    pub(crate) panels: Vec<Panel>,
}

/// Where a panel's values lie in the picture.
struct Frame {
    x: f64,
    y: f64,
    width: f64,
    height: f64,
    x_range: [f64; 2],
    y_range: [f64; 2],
}

impl Frame {
    /// Seen from the frame's upper left corner.
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let share = |value: f64, [from, to]: [f64; 2]| (value - from) / (to - from);
        (
            self.width * share(x, self.x_range),
            self.height * (1.0 - share(y, self.y_range)),
        )
    }

    fn axes(&self, svg: &mut String, language: Language, names: &[String], last: bool) {
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
                let label = tick(language, value, every);
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
                let label = tick(language, value, every);
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

    fn curves(&self, svg: &mut String, curves: &[Curve]) {
        for curve in curves {
            let path = path(self, curve);
            if !path.is_empty() {
                put(
                    svg,
                    format_args!("<path class=\"{}\" d=\"{path}\"/>", curve.ink.class()),
                );
            }
        }
    }

    /// What is drawn inside is cut off at the frame.
    fn inside(&self, svg: &mut String, draw: impl FnOnce(&mut String)) {
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

impl Plot {
    /// The picture.
    pub(crate) fn svg(&self, language: Language) -> String {
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
            y += legend(&mut body, &panel.curves, left, y);
            let frame = Frame {
                x: left,
                y,
                width: WIDTH - left - RIGHT,
                height: panel.height(),
                x_range,
                y_range: panel.y_range(x_range),
            };
            let last = index + 1 == self.panels.len();
            frame.axes(&mut body, language, &panel.names, last);
            frame.inside(&mut body, |svg| frame.curves(svg, &panel.curves));
            let finite = |curve: &Curve| curve.points.iter().any(|point| point.1.is_finite());
            if !panel.curves.iter().any(finite) {
                let (x, y) = (left + 0.5 * frame.width, y + 0.5 * frame.height);
                put(
                    &mut body,
                    format_args!(
                        "<text class=\"m\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>",
                        NO_VALUE.of(language)
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
                0.5 * (left + WIDTH - RIGHT),
                y + 35.0,
                escape(&self.x)
            ),
        );
        wrap(&body, y + 42.0)
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

fn wrap(body: &str, height: f64) -> String {
    format!("<svg class=\"plot\" viewBox=\"0 0 {WIDTH} {height:.0}\">{body}</svg>")
}

/// The names of the curves in rows above them; each name once. Returns the height used.
fn legend(svg: &mut String, curves: &[Curve], left: f64, top: f64) -> f64 {
    let (mut x, mut y) = (left, top);
    let mut said: Vec<&str> = Vec::new();
    for curve in curves {
        if curve.name.is_empty() || said.contains(&curve.name.as_str()) {
            continue;
        }
        let width = 34.0 + LETTER * curve.name.chars().count() as f64;
        if x + width > WIDTH && x > left {
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

/// The curve's path. Of all points on one column of pixels, the first, last, lowest and highest are kept: a spike
/// stays visible however many points there are.
fn path(frame: &Frame, curve: &Curve) -> String {
    let mut text = String::new();
    for part in curve
        .points
        .split(|(x, y)| !x.is_finite() || !y.is_finite())
    {
        let mut before: Option<(f64, f64)> = None;
        for (x, y) in thinned(part.iter().map(|point| frame.place(*point)).collect()) {
            // Far outside nothing is seen, but numbers grow long.
            let (x, y) = (x.clamp(-2_000.0, 4_000.0), y.clamp(-2_000.0, 4_000.0));
            match before {
                None => put(&mut text, format_args!("M{x:.1} {y:.1}")),
                Some(_) if curve.steps => put(&mut text, format_args!("H{x:.1}V{y:.1}")),
                Some(last) if (last.0 - x).abs() < 0.05 && (last.1 - y).abs() < 0.05 => continue,
                Some(_) => put(&mut text, format_args!("L{x:.1} {y:.1}")),
            }
            before = Some((x, y));
        }
    }
    text
}

fn thinned(points: Points) -> Points {
    if (points.len() as f64) < 2.0 * WIDTH {
        return points;
    }
    let mut kept = Points::new();
    let columns = points.chunk_by(|one, other| one.0.floor() == other.0.floor());
    for column in columns {
        let index = |best: fn(f64, f64) -> bool| {
            (0..column.len()).fold(0, |found, at| {
                if best(column[at].1, column[found].1) {
                    at
                } else {
                    found
                }
            })
        };
        let mut chosen = [
            0,
            index(|one, other| one < other),
            index(|one, other| one > other),
            column.len() - 1,
        ];
        chosen.sort_unstable();
        let mut last = None;
        for at in chosen {
            if last.replace(at) != Some(at) {
                kept.push(column[at]);
            }
        }
    }
    kept
}

/// The distance between ticks: 1, 2 or 5 times a power of ten, for about `count` of them.
fn step([from, to]: [f64; 2], count: f64) -> f64 {
    let raw = (to - from) / count.max(2.0);
    let power = 10f64.powf(raw.log10().floor());
    let times = [1.0, 2.0, 5.0, 10.0];
    times
        .iter()
        .map(|times| times * power)
        .find(|step| *step >= raw * 0.999)
        .unwrap_or(10.0 * power)
}

fn ticks([from, to]: [f64; 2], every: f64) -> impl Iterator<Item = f64> {
    let slack = 1e-6 * (to - from);
    let first = ((from - slack) / every).ceil() as i64;
    let last = ((to + slack) / every).floor() as i64;
    (first..=last.min(first + 60)).map(move |number| number as f64 * every)
}

fn tick(language: Language, value: f64, every: f64) -> String {
    language.number(value, (-every.log10().floor()).max(0.0) as usize)
}
