//! Drawings that are no diagrams of values: control schemes, wirings, rigs, state machines, geometry. All inline SVG, coloured by the page.

pub(crate) mod geometry;
pub(crate) mod machine;
pub(crate) mod rig;
pub(crate) mod scheme;
mod sketch;
pub(crate) mod wiring;
