//! Box plots: the middle half of many values as a box, the median in it, and how far the rest reaches.

use crate::WIDTH;
use crate::frame::{RIGHT, step, tick, ticks};
use crate::sheet::Picture;
use crate::text::{Words, escape, put};

const ROW: f64 = 34.0;
const LETTER: f64 = 6.7;
/// A whisker ends at the farthest value within so many lengths of its box (Tukey 1977).
const REACH: f64 = 1.5;

/// Many values of one thing under several conditions.
#[derive(Clone, Debug, Default)]
pub struct Boxes {
    /// What the axis shows, with its unit.
    pub x: String,
    /// Name and values of each condition, from top to bottom; what is not a number is left out.
    pub groups: Vec<(String, Vec<f64>)>,
}

impl Boxes {
    /// The picture, inline in a page.
    #[must_use]
    pub fn svg<'a>(&self, words: impl Into<Words<'a>>) -> String {
        let words = words.into();
        let longest = self.groups.iter().map(|(name, _)| name.chars().count());
        let left = 20.0 + LETTER * longest.max().unwrap_or(0).min(40) as f64;
        let all = || self.groups.iter().flat_map(|(_, values)| values).copied();
        let [low, high] = crate::ramp::range(all());
        let margin = 0.04 * (high - low);
        let shown = [low - margin, high + margin];
        let width = WIDTH - left - RIGHT;
        let place = |value: f64| left + width * crate::ramp::share(value, shown);
        let bottom = 8.0 + ROW * self.groups.len() as f64;
        let mut body = String::new();
        let every = step(shown, width / 75.0);
        for value in ticks(shown, every) {
            let (x, label) = (place(value), tick(words, value, every));
            put(
                &mut body,
                format_args!(
                    "<path class=\"g\" d=\"M{x:.1} 4V{bottom:.1}\"/><text class=\"m\" x=\"{x:.1}\" y=\"{:.1}\">{label}</text>",
                    bottom + 16.0
                ),
            );
        }
        for (row, (name, values)) in self.groups.iter().enumerate() {
            let y = 8.0 + (row as f64 + 0.5) * ROW;
            put(
                &mut body,
                format_args!(
                    "<text class=\"e\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                    left - 8.0,
                    y + 4.0,
                    escape(name)
                ),
            );
            one(&mut body, values, y, &place);
        }
        put(
            &mut body,
            format_args!(
                "<text class=\"m\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                left + 0.5 * width,
                bottom + 35.0,
                escape(&self.x)
            ),
        );
        Picture::new(body, WIDTH, bottom + 42.0).inline()
    }
}

fn one(svg: &mut String, values: &[f64], y: f64, place: &dyn Fn(f64) -> f64) {
    let mut sorted: Vec<f64> = values
        .iter()
        .copied()
        .filter(|value| value.is_finite())
        .collect();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return;
    };
    let at = |share: f64| {
        let index = share * last as f64;
        let (below, part) = (index as usize, index.fract());
        let above = sorted[(below + 1).min(last)];
        sorted[below] + part * (above - sorted[below])
    };
    let [low, median, high] = [at(0.25), at(0.5), at(0.75)];
    let reach = REACH * (high - low);
    let inside = |value: &f64| (low - reach..=high + reach).contains(value);
    let ends = [
        sorted.iter().copied().find(inside).unwrap_or(low),
        sorted.iter().rev().copied().find(inside).unwrap_or(high),
    ];
    let [from, to] = ends.map(place);
    let [low, median, high] = [low, median, high].map(place);
    put(
        svg,
        format_args!(
            "<path class=\"a\" d=\"M{from:.1} {y:.1}H{low:.1}M{high:.1} {y:.1}H{to:.1}\"/>\
             <rect class=\"o\" x=\"{low:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"18\"/>\
             <path class=\"i1\" d=\"M{median:.1} {:.1}v18\" stroke-width=\"3\"/>",
            y - 9.0,
            (high - low).max(0.5),
            y - 9.0
        ),
    );
    for value in sorted.iter().filter(|value| !inside(value)) {
        put(
            svg,
            format_args!(
                "<circle class=\"a\" cx=\"{:.1}\" cy=\"{y:.1}\" r=\"2.5\"/>",
                place(*value)
            ),
        );
    }
}
