//! The hand of the page ([`rumbo_experiment::hand`]).
//!
//! Its lines take the way of text typed to a USART: over the page, into logs, and again from there, so that a rerun
//! repeats them.

use rumbo_log::{MapPose, Other, ReadingSource};
use rumbo_session::Shown;
use rumbo_sim::Sim;

/// In place of a USART.
pub const HAND: u8 = 6;
/// Where things are that the hand has moved, as [`Other::signals`] of `thingN`: how far from where the world has them.
pub(crate) fn moved(sim: &Sim) -> Option<Shown> {
    let signals = sim.shifted().iter().flat_map(|(thing, &[x_m, y_m])| {
        let at = MapPose {
            x_m,
            y_m,
            heading_rad: 0.0,
        };
        Other::signals(&format!("thing{thing}"), at)
    });
    let signals: Vec<_> = signals.collect();
    (!signals.is_empty()).then_some((ReadingSource::Others, signals))
}
