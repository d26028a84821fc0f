//! Control schemes as block diagrams: a row of sums and blocks, laid out by the length of their texts, with loops below and above.

use super::sketch::{Anchor, LETTER, Sketch, height_of, width_of};
use crate::text::{Language, Text};

/// A part of the row.
pub(crate) enum Part {
    /// A sum, with the signs of what comes from the left, from below and from above.
    Sum(&'static str, &'static str, &'static str),
    /// A block, a line each.
    Block(&'static [Text]),
}

/// A way back (below the row) or forward (above it) past other parts.
pub(crate) struct Path {
    /// Index of the part whose output it takes.
    pub(crate) from: usize,
    /// Index of the part that it goes into.
    pub(crate) to: usize,
    /// What stands in it; none: only a line.
    pub(crate) block: &'static [Text],
    /// 1, 2 below, the farther the larger; -1 above.
    pub(crate) level: i8,
}

/// A scheme.
pub(crate) struct Scheme {
    /// What comes in from the left.
    pub(crate) input: Text,
    /// The parts, each with the name of its output.
    pub(crate) row: &'static [(Part, Text)],
    pub(crate) paths: &'static [Path],
    /// What comes in from above, by the index of its sum.
    pub(crate) from_above: &'static [(usize, Text)],
}

const SUM: f64 = 11.0;
const GAP: f64 = 30.0;

impl Scheme {
    /// The drawing.
    pub(crate) fn svg(&self, language: Language) -> String {
        let mut sketch = Sketch::new();
        let above = if self.paths.iter().any(|path| path.level < 0) {
            78.0
        } else if self.from_above.is_empty() {
            18.0
        } else {
            50.0
        };
        let tallest = self.row.iter().map(|(part, _)| match part {
            Part::Sum(..) => 2.0 * SUM,
            Part::Block(lines) => height_of(lines.len()),
        });
        let half = 0.5 * tallest.fold(0.0, f64::max);
        let y = above + half + 6.0;

        let places = self.places(language);
        let mut x = 4.0;
        for ((part, output), place) in self.row.iter().zip(&places) {
            sketch.arrow(&[(x, y), (place.left, y)]);
            self.draw_part(&mut sketch, language, part, place, y);
            x = place.right;
            sketch.text((x + 6.0, y - 6.0), output.of(language), Anchor::Start);
        }
        sketch.text((4.0, y - 6.0), self.input.of(language), Anchor::Start);
        let end = places.last().map_or(0.0, |place| place.next);
        sketch.arrow(&[(x, y), (end, y)]);

        for (index, name) in self.from_above {
            let middle = places[*index].middle();
            sketch.arrow(&[(middle, y - 50.0), (middle, y - SUM)]);
            sketch.text((middle + 6.0, y - 42.0), name.of(language), Anchor::Start);
        }
        let mut lowest = y + half;
        for path in self.paths {
            let lines: Vec<&str> = path.block.iter().map(|line| line.of(language)).collect();
            let tap = places[path.from].next - 10.0;
            let into = places[path.to].middle();
            let level = if path.level < 0 {
                y - half - 30.0
            } else {
                y + half + 36.0 + 66.0 * (f64::from(path.level) - 1.0)
            };
            let reach = match &self.row[path.to].0 {
                Part::Sum(..) => SUM,
                Part::Block(lines) => 0.5 * height_of(lines.len()),
            };
            let edge = if path.level < 0 { y - reach } else { y + reach };
            sketch.arrow(&[(tap, y), (tap, level), (into, level), (into, edge)]);
            sketch.circle((tap, y), 2.5, "k");
            let size = (width_of(&lines) + 16.0, height_of(lines.len()));
            if !lines.is_empty() {
                sketch.block((0.5 * (tap + into), level), size, &lines);
            }
            lowest = f64::max(lowest, level + 0.5 * size.1);
        }
        sketch.finish((end + 6.0).max(560.0), lowest + 8.0)
    }

    fn draw_part(
        &self,
        sketch: &mut Sketch,
        language: Language,
        part: &Part,
        place: &Place,
        y: f64,
    ) {
        match part {
            Part::Sum(left, below, above) => {
                let x = place.middle();
                sketch.circle((x, y), SUM, "b");
                sketch.text((x, y + 4.5), "Σ", Anchor::Middle);
                sketch.text((place.left - 5.0, y + 14.0), left, Anchor::End);
                sketch.text((x + 6.0, y + SUM + 13.0), below, Anchor::Start);
                sketch.text((x - 14.0, y - SUM - 5.0), above, Anchor::Middle);
            }
            Part::Block(lines) => {
                let lines: Vec<&str> = lines.iter().map(|line| line.of(language)).collect();
                let size = (place.right - place.left, height_of(lines.len()));
                sketch.block((place.middle(), y), size, &lines);
            }
        }
    }

    /// Where each part lies, from its texts.
    fn places(&self, language: Language) -> Vec<Place> {
        let room = |text: Text| GAP.max(24.0 + LETTER * text.of(language).chars().count() as f64);
        let mut left = 4.0 + room(self.input);
        let mut places = Vec::new();
        for (part, output) in self.row {
            let width = match part {
                Part::Sum(..) => 2.0 * SUM,
                Part::Block(lines) => {
                    let lines: Vec<&str> = lines.iter().map(|line| line.of(language)).collect();
                    width_of(&lines) + 16.0
                }
            };
            let right = left + width;
            let next = right + room(*output);
            places.push(Place { left, right, next });
            left = next;
        }
        places
    }
}

struct Place {
    left: f64,
    right: f64,
    /// Where the next part begins.
    next: f64,
}

impl Place {
    fn middle(&self) -> f64 {
        0.5 * (self.left + self.right)
    }
}
