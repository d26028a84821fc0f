//! State machines: states as boxes, transitions as arrows with their conditions.

use super::sketch::{Anchor, Sketch, height_of};
use crate::text::{Language, Text};

/// A state, its box around a place.
pub(crate) struct State {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) width: f64,
    pub(crate) lines: &'static [Text],
}

/// A transition: the arrow's corners, and the condition beside a place.
pub(crate) struct Transition {
    pub(crate) way: &'static [(f64, f64)],
    pub(crate) at: (f64, f64),
    pub(crate) condition: &'static [Text],
}

/// A machine.
pub(crate) struct Machine {
    pub(crate) size: (f64, f64),
    pub(crate) states: &'static [State],
    pub(crate) transitions: &'static [Transition],
}

impl Machine {
    /// The drawing.
    pub(crate) fn svg(&self, language: Language) -> String {
        let mut sketch = Sketch::new();
        for Transition { way, .. } in self.transitions {
            sketch.arrow(way);
        }
        for State { x, y, width, lines } in self.states {
            let lines: Vec<&str> = lines.iter().map(|line| line.of(language)).collect();
            sketch.block((*x, *y), (*width, height_of(lines.len())), &lines);
        }
        for Transition { at, condition, .. } in self.transitions {
            for (index, line) in condition.iter().enumerate() {
                sketch.text(
                    (at.0, at.1 + 14.0 * index as f64),
                    line.of(language),
                    Anchor::Start,
                );
            }
        }
        sketch.finish(self.size.0, self.size.1)
    }
}
