//! Parallel coordinates: each point of many dimensions is a line across one axis for each.

use crate::WIDTH;
use crate::frame::{step, tick, ticks};
use crate::heat::scale;
use crate::ramp::{colour, range, share};
use crate::sheet::Picture;
use crate::text::{Words, escape, put};

const HEIGHT: f64 = 300.0;
const TOP: f64 = 48.0;
const SIDE: f64 = 56.0;
const SCALE: f64 = 70.0;

/// Points of many dimensions.
#[derive(Clone, Debug, Default)]
pub struct Parallel {
    /// What each axis shows, with its unit.
    pub axes: Vec<String>,
    /// The points, each a value for every axis; what is not a number is a gap. Later ones lie above earlier ones.
    pub points: Vec<Vec<f64>>,
    /// The axis whose values colour the lines.
    pub colour: usize,
}

impl Parallel {
    /// The picture, inline in a page.
    #[must_use]
    pub fn svg<'a>(&self, words: impl Into<Words<'a>>) -> String {
        let words = words.into();
        let ranges: Vec<[f64; 2]> = (0..self.axes.len())
            .map(|axis| {
                range(
                    self.points
                        .iter()
                        .filter_map(|point| point.get(axis).copied()),
                )
            })
            .collect();
        let mut body = String::new();
        let shown = ranges.get(self.colour).copied().unwrap_or([0.0, 1.0]);
        self.lines(&mut body, &ranges, shown);
        self.scales(&mut body, words, &ranges);
        scale(&mut body, words, [WIDTH - SCALE + 8.0, TOP, HEIGHT], shown);
        Picture::new(body, WIDTH, TOP + HEIGHT + 12.0).inline()
    }

    /// Where an axis stands.
    fn x(&self, axis: usize) -> f64 {
        let gap = (WIDTH - 2.0 * SIDE - SCALE) / (self.axes.len().max(2) - 1) as f64;
        SIDE + axis as f64 * gap
    }

    /// A line for each point.
    fn lines(&self, body: &mut String, ranges: &[[f64; 2]], shown: [f64; 2]) {
        for point in &self.points {
            let value = point.get(self.colour).copied().unwrap_or(f64::NAN);
            let mut path = String::new();
            let mut drawing = false;
            for (axis, (value, range)) in point.iter().zip(ranges).enumerate() {
                if value.is_finite() {
                    let command = if drawing { 'L' } else { 'M' };
                    put(
                        &mut path,
                        format_args!("{command}{:.1} {:.1}", self.x(axis), y(*value, *range)),
                    );
                }
                drawing = value.is_finite();
            }
            let colour = colour(share(value, shown));
            put(
                body,
                format_args!(
                    "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.2\" stroke-opacity=\"0.75\"/>"
                ),
            );
        }
    }

    /// The axes with their names and ticks.
    fn scales(&self, body: &mut String, words: Words<'_>, ranges: &[[f64; 2]]) {
        for (axis, (name, range)) in self.axes.iter().zip(ranges).enumerate() {
            let x = self.x(axis);
            // Three rows: long names of neighbours do not meet.
            let row = 12.0 + 14.0 * (axis % 3) as f64;
            put(
                body,
                format_args!(
                    "<path class=\"a\" d=\"M{x:.1} {TOP}v{HEIGHT}\"/><text class=\"m\" x=\"{x:.1}\" y=\"{row}\">{}</text>",
                    escape(name)
                ),
            );
            let every = step(*range, HEIGHT / 50.0);
            for value in ticks(*range, every) {
                let label = tick(words, value, every);
                put(
                    body,
                    format_args!(
                        "<text class=\"e h\" x=\"{:.1}\" y=\"{:.1}\">{label}</text>",
                        x - 4.0,
                        y(value, *range) + 4.0
                    ),
                );
            }
        }
    }
}

fn y(value: f64, range: [f64; 2]) -> f64 {
    TOP + HEIGHT * (1.0 - share(value, range))
}
