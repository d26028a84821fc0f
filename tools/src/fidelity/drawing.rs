//! The table as a drawing: for each figure the drawn robots, 5 to 95 % and 25 to 75 %, in multiples of the recorded
//! value, which is the line at 1.

use crate::fidelity::place::Place;
use std::fmt::Write as _;

/// Pixels: a row's height, and where the axis begins and ends.
const ROW: f64 = 20.0;
const AXIS: [f64; 2] = [330.0, 880.0];
/// Multiples of the recorded value at both ends; the axis is logarithmic.
const ENDS: [f64; 2] = [0.1, 10.0];

pub(crate) fn svg(all: &[(&str, &str, Place)]) -> String {
    let height = ROW * (all.len() as f64 + 2.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 900 {height:.0}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for tick in [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0] {
        let (x, colour) = (at(tick), if tick == 1.0 { "#c33" } else { "#ddd" });
        let _ = writeln!(
            svg,
            "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"6\" y2=\"{:.1}\" stroke=\"{colour}\"/>\
             <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{tick}</text>",
            height - 1.4 * ROW,
            height - 0.6 * ROW
        );
    }
    for (index, (run, what, place)) in all.iter().enumerate() {
        let y = ROW * (index as f64 + 0.9);
        let x = |share: f64| at(place.quantile(share) / place.recorded);
        let colour = if place.within_ninety() {
            "#369"
        } else {
            "#b60"
        };
        let _ = writeln!(
            svg,
            "<text x=\"8\" y=\"{:.1}\">{run}: {}</text>\
             <line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"{colour}\"/>\
             <rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"8\" fill=\"{colour}\" fill-opacity=\"0.4\"/>\
             <circle cx=\"{:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{colour}\"/>",
            y + 4.0,
            what.replace('>', "&gt;"),
            x(0.05),
            x(0.95),
            x(0.25),
            y - 4.0,
            x(0.75) - x(0.25),
            x(0.5),
        );
    }
    svg + "</svg>\n"
}

/// Where a multiple of the recorded value stands; what is beyond an end stands there.
fn at(multiple: f64) -> f64 {
    let share = (multiple.clamp(ENDS[0], ENDS[1]) / ENDS[0]).ln() / (ENDS[1] / ENDS[0]).ln();
    AXIS[0] + share * (AXIS[1] - AXIS[0])
}
