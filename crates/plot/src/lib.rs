//! Rumbo's plots: panels over one axis ([`Plot`]), maps ([`Map`]), heat maps ([`Heat`]), parallel coordinates
//! ([`Parallel`]) and box plots ([`Boxes`]), inline in a page or as a file of their own ([`Sheet`]).
//!
//! Curves have classes, which a style sheet colours, so that one picture serves a light page, a dark one and paper. A
//! page brings its own values for the variables of [`STYLE`]; a sheet contains those of a light page. Legends stand
//! above the curves, never on them.

mod boxes;
mod curve;
mod frame;
mod heat;
mod map;
mod panels;
mod parallel;
mod ramp;
mod sheet;
#[cfg(test)]
mod tests;
mod text;

pub use boxes::Boxes;
pub use curve::{Band, Curve, Ink, Points};
pub use heat::Heat;
pub use map::{Map, Shape};
pub use panels::{Panel, Plot};
pub use parallel::Parallel;
pub use sheet::{Picture, Sheet};
pub use text::{Words, escape, number, put};

/// Width of a picture in a page \[px\].
pub const WIDTH: f64 = 680.0;
/// The style sheet of pictures; its colours are variables.
pub const STYLE: &str = include_str!("plot.css");
