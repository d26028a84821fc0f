//! A line that was lost: by a robot that is faster than its author's, or sees it elsewhere.

use crate::files::Setup;
use crate::metrics::floor::{LOST_M, places, way_m};
use crate::note::Note;
use rumbo_sim::floor::Nearest;
use rumbo_sim::trace::Trace;

/// For so long a robot may leave its line without a word, turning at a corner [s].
const LONG_S: f64 = 2.0;
/// So far along a line a robot follows it [m].
const FOLLOWED_M: f64 = 0.1;
/// A wider one is a ring or a field [m].
const TAPE_M: f64 = 0.05;
/// Its speed is that of this time before [s].
const BEFORE_S: f64 = 0.3;

/// When a robot that followed a line left it for long, and how fast it was.
pub(super) fn its_line(setup: &Setup, trace: &Trace) -> Option<Note> {
    let places = places(setup, trace);
    let is_on = |(_, place): &(f64, Nearest)| place.distance_m <= LOST_M;
    let left = |pair: &[(f64, Nearest)]| is_on(&pair[0]) && !is_on(&pair[1]);
    let mut leavings = (1..places.len()).filter(|at| left(&places[at - 1..=*at]));
    let at = leavings.find(|at| {
        let back = places[*at..].iter().find(|place| is_on(place));
        let until_s = back.or(places.last()).map_or(0.0, |(t_s, _)| *t_s);
        until_s - places[*at].0 > LONG_S
    })?;
    let (before, _) = places.split_at(at);
    let followed: Vec<Nearest> = before.iter().map(|(_, place)| *place).collect();
    let is_tape = followed.last()?.width_m <= TAPE_M;
    let at_s = places[at].0;
    let just_before = trace.between(at_s - BEFORE_S, at_s);
    let way_before_m: f64 = just_before
        .windows(2)
        .map(|pair| (pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m))
        .sum();
    (is_tape && way_m(&setup.world.lines, &followed) > FOLLOWED_M).then_some(Note::LostLine {
        at_s,
        speed_m_s: way_before_m / BEFORE_S,
    })
}
