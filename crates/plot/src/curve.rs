//! Curves: their points and their look.

use crate::WIDTH;

/// Points of a curve; what is not finite is a gap.
pub type Points = Vec<(f64, f64)>;

/// Most points of one run among many: the eye sees no more, and the files stay small.
const POINTS_OF_MANY: usize = 360;

/// How a curve looks. The first two differ in lightness as well as in hue; references are dashed, ground truth is
/// dash-dotted, the fourth is dotted: they remain distinguishable in grey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// The left wheel or sonar; our robot.
    First,
    /// The right wheel or sonar; the recorded robot, or the baseline.
    Second,
    /// The front sonar.
    Third,
    /// One more.
    Fourth,
    /// One more.
    Fifth,
    /// One more.
    Sixth,
    /// Ground truth, over what the robot reports.
    True,
    /// References and ideals.
    Reference,
    /// The reference of the first curve, where each has its own.
    FirstReference,
    /// That of the second.
    SecondReference,
}

impl Ink {
    /// For curves that have no other order.
    pub const PALETTE: [Self; 6] = [
        Self::First,
        Self::Second,
        Self::Third,
        Self::Fourth,
        Self::Fifth,
        Self::Sixth,
    ];

    pub(crate) const fn class(self) -> &'static str {
        match self {
            Self::First => "i1",
            Self::Second => "i2",
            Self::Third => "i3",
            Self::Fourth => "i4",
            Self::Fifth => "i5",
            Self::Sixth => "i6",
            Self::True => "it",
            Self::Reference => "ir",
            Self::FirstReference => "i1 d",
            Self::SecondReference => "i2 d",
        }
    }
}

/// The range of many runs at the same x: the lowest and the highest values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// The lowest values.
    pub low: Points,
    /// The highest values, at the same x.
    pub high: Points,
}

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// As in the legend; nothing: not in the legend.
    pub name: String,
    /// Its look.
    pub ink: Ink,
    /// In order.
    pub points: Points,
    /// A value holds until the next one.
    pub steps: bool,
    /// One of many: a thin line.
    pub thin: bool,
    /// The range around it.
    pub band: Option<Band>,
}

impl Curve {
    /// A line.
    #[must_use]
    pub fn new(name: &str, ink: Ink, points: Points) -> Self {
        Self {
            name: name.to_owned(),
            ink,
            points,
            steps: false,
            thin: false,
            band: None,
        }
    }

    /// Steps: a value holds until the next one.
    #[must_use]
    pub fn steps(name: &str, ink: Ink, points: Points) -> Self {
        Self {
            steps: true,
            ..Self::new(name, ink, points)
        }
    }

    /// The curves of many runs, each a thin line.
    #[must_use]
    pub fn each(name: &str, ink: Ink, runs: &[Points]) -> Self {
        let mut points = Points::new();
        for run in runs {
            points.extend(run.iter().step_by(stride(run.len())));
            points.push((f64::NAN, f64::NAN));
        }
        Self {
            thin: true,
            ..Self::new(name, ink, points)
        }
    }

    /// The median of many runs with values at the same x, and the range of all.
    #[must_use]
    pub fn median(name: &str, ink: Ink, runs: &[Points]) -> Self {
        let (mut median, mut band) = (Points::new(), Band::default());
        let length = runs.iter().map(Vec::len).min().unwrap_or(0);
        for index in (0..length).step_by(stride(length)) {
            let x = runs[0][index].0;
            let mut values: Vec<f64> = runs.iter().map(|points| points[index].1).collect();
            values.sort_by(f64::total_cmp);
            median.push((x, values[values.len() / 2]));
            band.low.push((x, values[0]));
            band.high.push((x, values[values.len() - 1]));
        }
        Self {
            band: Some(band),
            ..Self::new(name, ink, median)
        }
    }

    /// All points that must be visible.
    pub(crate) fn extent(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let band = self.band.iter();
        let band = band.flat_map(|band| band.low.iter().chain(&band.high));
        self.points.iter().chain(band).copied()
    }
}

fn stride(length: usize) -> usize {
    length.div_ceil(POINTS_OF_MANY).max(1)
}

/// Of all points on one column of pixels, the first, last, lowest and highest: a spike stays visible however many
/// points there are.
pub(crate) fn thinned(points: Points) -> Points {
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
